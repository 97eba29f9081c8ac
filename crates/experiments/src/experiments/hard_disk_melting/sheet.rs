//! A sheet of hard discs, begun as a crystal or without order.

use corpuscle_checkpoint::resume;
use corpuscle_core::particles::ball_volume;
use corpuscle_core::placement::{close_packed, maxwell};
use corpuscle_core::{Axis, Boundary, Contact, Engine, Failure, Invalid, Meeting, Particles, Random, Vector};
use corpuscle_event::{EventDriven, Rules};

use super::order::{self, Order};
use crate::gas;
use crate::replicas::{Member, Watch};

/// Packing fraction beyond which discs do not grow into places without order in any reasonable time.
pub(super) const DENSEST_GROWN: f64 = 0.74;
/// Between two samples, in `s sqrt(m/kT)`: a disc near the transition collides about ten times.
pub(super) const PERIOD: f64 = 0.4;

/// How a sheet begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Start {
    /// On a triangular lattice.
    Crystal,
    /// Grown from points.
    Disorder,
}

/// A sheet to be set up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Job {
    pub(super) start: Start,
    pub(super) packing: f64,
    /// Discs along a row, and rows.
    pub(super) side: usize,
    pub(super) seed: u64,
    pub(super) stream: u64,
    /// Time before the measurement.
    pub(super) settling: f64,
}

/// What is noted of a sheet at one time.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
pub(super) struct Sample {
    /// Modulus of the mean of `psi_6` over all discs.
    pub(super) order: f64,
    /// Mean of the moduli.
    pub(super) local: f64,
    /// Sum of impulse times distance over all collisions so far.
    pub(super) virial: f64,
}

/// A sheet under way.
pub(super) struct Sheet {
    pub(super) engine: EventDriven<2>,
    pub(super) samples: Vec<Sample>,
    virial: f64,
    pub(super) job: Job,
    pub(super) started: f64,
    pub(super) energy: f64,
}

resume!(Sheet { values: [engine, samples, virial], set_up: [job, started, energy] });

impl Sheet {
    /// # Errors
    /// [`Invalid`] when the discs do not fit.
    pub(super) fn new(job: &Job) -> Result<Self, Invalid> {
        let mut random = Random::new(job.seed, job.stream);
        let count = job.side * job.side;
        // Rows are sqrt(3)/2 of the distance of neighbours apart.
        let distance = (ball_volume::<2>(0.5) / job.packing / 0.75f64.sqrt()).sqrt();
        let width = job.side as f64 * distance;
        let boundary = Boundary::new([0.0; 2], [width, width * 0.75f64.sqrt()], Axis::Periodic);
        let mut particles = Particles::new();
        match job.start {
            Start::Crystal => {
                for place in close_packed(&boundary, count, 0.5, &mut random)? {
                    particles.push(place, Vector::ZERO, 1.0, 0.5, 0);
                }
            }
            Start::Disorder => gas::grow(&mut particles, &boundary, count, &mut random)?,
        }
        maxwell(&mut particles, 1.0, true, &mut random);
        let mut engine = EventDriven::new(boundary, particles, Rules::default())?;
        let broken = |failure: Failure| Invalid::new("packings", job.packing, failure.to_string());
        engine.advance(job.settling, &mut ()).map_err(broken)?;
        Ok(Self { energy: engine.kinetic_energy(), started: engine.time(), engine, samples: vec![], virial: 0.0, job: *job })
    }

    /// `P V/(N k T)` up to the last sample.
    pub(super) fn compressibility(&self) -> f64 {
        let (work, time) = (self.samples[self.samples.len() - 1].virial, PERIOD * (self.samples.len() - 1) as f64);
        1.0 + work / (2.0 * self.engine.particle_count() as f64 * time)
    }

    /// Means of `|psi_6|` and of its square over the later half of the samples.
    pub(super) fn order(&self) -> [f64; 2] {
        let late = &self.samples[self.samples.len() / 2..];
        let mean = |power: i32| late.iter().map(|sample| sample.order.powi(power)).sum::<f64>() / late.len() as f64;
        [mean(1), mean(2)]
    }
}

impl Member for Sheet {
    fn advance(&mut self, time: f64) -> Result<(), Failure> {
        let virial = &mut self.virial;
        let mut meet = |contact: &Contact<2>| {
            if let Meeting::Pair(_) = contact.with {
                *virial += contact.impulse * contact.distance;
            }
        };
        self.engine.advance(self.started + time, &mut Watch(&mut meet))
    }

    fn sample(&mut self) {
        let discs = order::of_discs(&self.engine);
        let local = discs.iter().map(Order::modulus).sum::<f64>() / discs.len() as f64;
        self.samples.push(Sample { order: Order::mean(&discs).modulus(), local, virial: self.virial });
    }

    fn time(&self) -> f64 {
        self.engine.time() - self.started
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sheet(start: Start, packing: f64, settling: f64) -> Sheet {
        Sheet::new(&Job { start, packing, side: 12, seed: 1, stream: 0, settling }).unwrap()
    }

    #[test]
    fn a_crystal_has_order_one() {
        let mut crystal = sheet(Start::Crystal, 0.7, 0.0);
        crystal.sample();
        assert!((crystal.samples[0].order - 1.0).abs() < 1e-12 && (crystal.samples[0].local - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_liquid_has_little() {
        let mut liquid = sheet(Start::Disorder, 0.5, 20.0);
        liquid.sample();
        assert!(liquid.samples[0].order < 0.3 && liquid.samples[0].local < 0.6, "{:?}", liquid.samples[0]);
    }
}
