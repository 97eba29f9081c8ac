//! What a free system notes at each sampling time.

use corpuscle_core::Particles;
use corpuscle_observe::{Histogram, VirialPressure, WallPressure};

use super::build::AnyEngine;
use super::run::Free;
use super::spec::Observable;

/// What is noted at each sampling time.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
pub(super) struct Sample {
    pub(super) time: f64,
    pub(super) kinetic: f64,
    pub(super) potential: f64,
    pub(super) temperature: f64,
    /// Instantaneous virial pressure of a time-driven system.
    pub(super) pressure: f64,
    /// Coordinate of the piston, if there is one.
    pub(super) piston: Option<f64>,
}

impl<const D: usize> Free<D> {
    pub(super) fn sample(&mut self) {
        let time = self.engine.time();
        let particles = self.engine.snapshot();
        let (kinetic, potential) = self.engine.energies();
        let temperature = self.temperature(&particles, kinetic);
        let volume = self.engine.boundary().accessible_volume(self.largest_radius());
        let pressure = match &self.engine {
            AnyEngine::Event(_) => f64::NAN,
            AnyEngine::Time(engine) => (particles.len() as f64 * temperature + engine.virial() / D as f64) / volume,
        };
        let piston = self.engine.piston().map(|piston| piston.position);
        self.samples.push(Sample { time, kinetic, potential, temperature, pressure, piston });
        let moving = particles.velocity.iter().zip(&particles.mass).map(|(v, m)| m * v.norm()).sum();
        self.momentum.see(particles.momentum().to_three(), moving);
        let arms =
            particles.position.iter().zip(&particles.velocity).zip(&particles.mass).map(|((r, v), m)| m * r.norm() * v.norm());
        self.angular_momentum.see(particles.angular_momentum(), arms.sum());
        let given = self.given.energy() - self.engine.bath_energy();
        let energy = kinetic + potential - given;
        self.energy.see([energy], kinetic + potential.abs() + given.abs());
        self.motion.see([energy], kinetic);
        self.lowest = self.lowest.min(energy);
        self.rise = self.rise.max(energy - self.lowest);
        if self.settled_from.is_none() && time >= self.settles_at {
            self.settle(time, temperature, &particles);
        }
        if self.settled_from.is_some() {
            if let Some(speeds) = &mut self.speeds {
                particles.velocity.iter().for_each(|v| speeds.add(v.norm()));
            }
            if let Some(structure) = &mut self.structure
                && (self.samples.len() as u64).is_multiple_of(self.structure_every)
            {
                structure.add(&particles);
            }
        }
        self.follow(&particles);
        if self.observe.contains(&Observable::MeanSquaredDisplacement) {
            let moved: f64 = (0..particles.len()).map(|i| (self.engine.unwrapped(i) - self.start[i]).norm_squared()).sum();
            self.displacement.push((time, moved / particles.len() as f64));
        }
    }

    /// From now on the system counts as in equilibrium: averages begin.
    fn settle(&mut self, time: f64, temperature: f64, particles: &Particles<D>) {
        self.settled_from = Some(self.samples.len() - 1);
        let block = (self.duration - time).max(0.0) / 256.0;
        let block = if block > 0.0 { block } else { self.duration };
        let (boundary, radius) = (self.engine.boundary(), self.largest_radius());
        self.wall_pressure = WallPressure::new(boundary, radius, block);
        self.virial_pressure = VirialPressure::new(particles.len(), boundary.accessible_volume(radius), temperature, block);
        self.watch(time);
        if self.observe.contains(&Observable::Speeds) && temperature > 0.0 {
            let lightest = particles.mass.iter().copied().filter(|&mass| mass > 0.0).fold(f64::INFINITY, f64::min);
            self.speeds = Some(Histogram::new(0.0, 5.0 * (temperature / lightest).sqrt(), 50));
        }
    }

    /// Kinetic temperature of the motion relative to the centre of mass where that moves freely, of all motion elsewhere.
    /// In Brownian dynamics, whose velocities are a mean drift, the bath's.
    fn temperature(&self, particles: &Particles<D>, kinetic: f64) -> f64 {
        if let Some(bath) = self.bath.filter(|bath| !bath.thermal) {
            return bath.temperature;
        }
        let mass: f64 = particles.mass.iter().sum();
        let drift =
            if self.closed && particles.len() > 1 && mass > 0.0 { 0.5 * particles.momentum().norm_squared() / mass } else { 0.0 };
        2.0 * (kinetic - drift).max(0.0) / self.degrees_of_freedom as f64
    }
}
