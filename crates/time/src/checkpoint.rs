//! Checkpoints: what changes in an engine while it runs. Box, forces and integrator are set up again from their description,
//! neighbour lists are built anew: forces are functions of positions, velocities and time to the last bit.

use corpuscle_checkpoint::{Fault, Reader, Resume, Writer};

use crate::engine::TimeDriven;
use crate::integrator::Stepper;

impl<const D: usize> Resume for TimeDriven<D> {
    fn save(&self, out: &mut Writer) -> Result<(), Fault> {
        // `kept` is there for going back within a call.
        let Self { system, integrator: _, stepper, steps, time, kept: _ } = self;
        out.fields(5)?;
        out.value("steps", steps)?;
        out.value("time", time)?;
        out.value("images", &system.images.as_flattened())?;
        out.part("system", system)?;
        out.part("integrator", stepper)
    }

    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), Fault> {
        from.fields(5)?;
        (self.steps, self.time) = (from.value("steps")?, from.value("time")?);
        let images: Vec<i64> = from.value("images")?;
        self.system.images = images.as_chunks().0.to_vec();
        from.part("system", &mut self.system)?;
        from.part("integrator", &mut self.stepper)?;
        self.validate()?;
        (self.system.doubtful, self.system.at_once) = (true, None);
        self.keep();
        Ok(())
    }
}

impl<const D: usize> TimeDriven<D> {
    /// What a checksum does not tell: whether it is the state of this engine at all.
    fn validate(&self) -> Result<(), Fault> {
        let system = &self.system;
        system.boundary.validate().and_then(|()| system.particles.validate()).map_err(Fault::new)?;
        let n = system.particles.len();
        let remainder = if system.remainder.is_empty() { n } else { system.remainder.len() };
        let adaptive = if let Stepper::Adaptive(method) = &self.stepper { method.particle_count() } else { n };
        let counts = [system.images.len(), system.acceleration.len(), remainder, adaptive];
        if let Some(count) = counts.into_iter().find(|&count| count != n) {
            return Err(Fault::new(format!("something for {count} of {n} particles")));
        }
        if system.held.iter().any(|held| held.particle >= n || held.axis >= D) {
            return Err(Fault::new("a coordinate is held that does not exist"));
        }
        if !self.time.is_finite() {
            return Err(Fault::new("the time is not a finite number"));
        }
        system.forces.iter().try_for_each(|force| force.validate(&system.boundary, &system.particles)).map_err(Fault::new)
    }
}
