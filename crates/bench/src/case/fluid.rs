//! What the fluids of soft particles share: start from a crystal, melting, and the physics of the fluid.

use corpuscle_core::placement::{close_packed, maxwell};
use corpuscle_core::{Boundary, Engine, Particles, Random, Vector};
use corpuscle_experiments::Settings;
use corpuscle_observe::{Drift, blocking};
use corpuscle_time::{Integrator, PairForce, PairPotential, TimeDriven};

use super::{gas, steps};
use crate::stretch::stretch;
use crate::threads::in_pool;
use crate::{Case, Figure, Trouble};

/// Length of a step.
const STEP: f64 = 0.005;
/// A crystal of this density and temperature has melted after this time, if the clock allows.
const MELTING_TIME: f64 = 10.0;
/// Steps between two looks at pressure and temperature.
const BETWEEN_LOOKS: u64 = 10;

/// A fluid of particles of mass 1 and diameter 1 at a number density, and a temperature before melting.
pub(super) struct Fluid<P> {
    pub(super) potential: P,
    pub(super) density: f64,
    pub(super) temperature: f64,
}

impl<P: PairPotential + 'static> Fluid<P> {
    /// Melts it, then measures it for the time asked for.
    pub(super) fn measure<const D: usize>(self, case: &Case, settings: &Settings) -> Result<Vec<Figure>, Trouble> {
        in_pool(settings, || {
            let (clock, seconds, count) = (case.clock(settings), settings.real("seconds"), settings.whole("particles"));
            let mut engine = self.start::<D>(count, settings.seed)?;
            let volume = engine.boundary().volume();
            stretch(&mut engine, &mut (), clock, 5.0 * seconds, STEP, MELTING_TIME)?;
            let melting = engine.time();

            let (mut temperature, mut pressure, mut drift) = (vec![], vec![], Drift::<1>::new());
            drift.see([engine.energy()], engine.kinetic_energy());
            let taken = steps::take(&mut engine, clock, seconds, BETWEEN_LOOKS, |engine| {
                let kinetic = engine.kinetic_energy();
                temperature.push(2.0 * kinetic / (D * (count - 1)) as f64);
                pressure.push((2.0 * kinetic + engine.virial()) / (D as f64 * volume));
                drift.see([engine.energy()], kinetic);
            })?;
            let mut figures = vec![Figure::new("particle_steps_per_second", count as f64 * taken.per_second())];
            figures.extend(taken.figures());
            figures.extend([
                Figure::new("time_before", melting),
                Figure::measured("temperature", blocking(&temperature).trusted(), None),
                Figure::measured("pressure", blocking(&pressure).trusted(), None),
                Figure::new("energy_drift_over_kinetic_energy", drift.largest().unwrap_or(f64::NAN)),
                Figure::new("momentum_per_particle", engine.momentum().norm() / count as f64),
            ]);
            Ok(figures)
        })
    }

    /// The crystal that packs closest, at this density.
    fn start<const D: usize>(self, count: usize, seed: u64) -> Result<TimeDriven<D>, Trouble> {
        let boundary = Boundary::<D>::periodic(gas::side::<D>(count as f64, self.density));
        let mut random = Random::new(seed, 0);
        let mut particles = Particles::new();
        for place in close_packed(&boundary, count, 0.5, &mut random)? {
            particles.push(place, Vector::ZERO, 1.0, 0.5, 0);
        }
        maxwell(&mut particles, self.temperature, true, &mut random);
        let force = PairForce::new(self.potential);
        Ok(TimeDriven::new(boundary, particles, vec![Box::new(force)], Integrator::VelocityVerlet { dt: STEP })?)
    }
}
