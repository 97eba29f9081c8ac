//! A sheet of hard discs, begun as a crystal or without order.

use corpuscle_checkpoint::resume;
use corpuscle_core::particles::ball_volume;
use corpuscle_core::placement::{close_packed, maxwell};
use corpuscle_core::{Axis, Boundary, Contact, Engine, Failure, Invalid, Meeting, Particles, Random, Vector};
use corpuscle_event::{EventDriven, Rules};

use crate::gas;
use crate::replicas::{Member, Watch};

/// Packing fraction beyond which discs do not grow into places without order in any reasonable time.
pub(super) const DENSEST_GROWN: f64 = 0.74;
/// Time in which discs of diameter 1 at these densities collide about ten times, `sqrt(m/kT)`.
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
    /// Modulus of the mean of `psi_6` over all discs, and mean of the moduli.
    pub(super) order: f64,
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

    /// `psi_6 = (1/6) sum exp(6 i theta)` of each disc over its six nearest neighbours, real and imaginary part.
    pub(super) fn bond_order(&self) -> Vec<[f64; 2]> {
        let count = self.engine.particle_count();
        let places: Vec<_> = (0..count).map(|i| self.engine.position(i)).collect();
        let boundary = self.engine.boundary();
        // Six neighbours are within twice the distance of a crystal's, but for voids that do not occur at these densities.
        let extent = boundary.extent();
        let reach = 2.2 * (extent[0] * extent[1] / count as f64).sqrt();
        let cells: [usize; 2] = std::array::from_fn(|k| ((extent[k] / reach) as usize).max(1));
        let cell = |i: usize| -> [usize; 2] {
            std::array::from_fn(|k| ((places[i][k] / extent[k] * cells[k] as f64) as usize).min(cells[k] - 1))
        };
        let mut members = vec![vec![]; cells[0] * cells[1]];
        for i in 0..count {
            let [x, y] = cell(i);
            members[y * cells[0] + x].push(i);
        }
        let around = |at: usize, k: usize| -> Vec<usize> {
            let n = cells[k];
            if n < 3 { (0..n).collect() } else { vec![(at + n - 1) % n, at, (at + 1) % n] }
        };
        let of_one = |i: usize| {
            let [x, y] = cell(i);
            let mut bonds: Vec<(f64, Vector<2>)> = vec![];
            for row in around(y, 1) {
                for column in around(x, 0) {
                    for &j in members[row * cells[0] + column].iter().filter(|&&j| j != i) {
                        let bond = boundary.displacement(places[i], places[j]);
                        bonds.push((bond.norm_squared(), bond));
                    }
                }
            }
            bonds.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
            bonds.truncate(6);
            let sum = bonds.iter().fold([0.0; 2], |sum, &(square, bond)| {
                // exp(6 i theta) = (z^2/|z|^2)^3.
                let second = [(bond[0] * bond[0] - bond[1] * bond[1]) / square, 2.0 * bond[0] * bond[1] / square];
                let sixth = product(second, product(second, second));
                [sum[0] + sixth[0], sum[1] + sixth[1]]
            });
            sum.map(|part| part / bonds.len().max(1) as f64)
        };
        (0..count).map(of_one).collect()
    }

    /// `P V/(N k T)` between two samples.
    pub(super) fn compressibility(&self, from: usize, to: usize) -> f64 {
        let work = self.samples[to].virial - self.samples[from].virial;
        1.0 + work / (2.0 * self.engine.particle_count() as f64 * PERIOD * (to - from) as f64)
    }

    /// Mean of `|psi_6|` over the samples behind one.
    pub(super) fn order(&self, from: usize) -> f64 {
        let samples = &self.samples[from..];
        samples.iter().map(|sample| sample.order).sum::<f64>() / samples.len() as f64
    }
}

/// Product of two complex numbers.
fn product(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
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
        let orders = self.bond_order();
        let count = orders.len() as f64;
        let sum = orders.iter().fold([0.0; 2], |sum, order| [sum[0] + order[0], sum[1] + order[1]]);
        let local = orders.iter().map(|order| (order[0] * order[0] + order[1] * order[1]).sqrt()).sum::<f64>() / count;
        let order = (sum[0] * sum[0] + sum[1] * sum[1]).sqrt() / count;
        self.samples.push(Sample { order, local, virial: self.virial });
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
