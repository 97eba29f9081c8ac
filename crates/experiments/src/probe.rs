//! The pressure inside a rectangle of a flat gas of hard particles, contact by contact.
//!
//! Momentum that two particles exchange goes along the line between their centres, and the part of that line inside counts (Irving
//! and Kirkwood 1950, doi:10.1063/1.1747782, averaged over a volume as by Lutsko 1988, doi:10.1063/1.341877): with the impulses `J`
//! and distances `s` of the contacts in a time `t`, and the shares `l` of their lines,
//! `P = sum m (v - u)^2 / (D V) + sum J s l / (D V t)`. A wall takes up momentum at its surface.

use corpuscle_core::{Contact, Engine};
use corpuscle_event::EventDriven;

use crate::tally::Tally;

/// What a probe has seen since it was laid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probed {
    /// Time it has lain there.
    pub time: f64,
    /// Contacts of which a part was inside.
    pub contacts: u64,
    /// Kinetic part of the pressure now, with the error of the temperature for normal velocities; none of fewer than two
    /// particles.
    pub kinetic: Option<(f64, f64)>,
    /// Part of collisions, a mean over the time, with the error of contacts that know nothing of each other; none before the
    /// first.
    pub collisional: Option<(f64, f64)>,
}

/// A rectangle with what was seen in it.
#[derive(Clone, Debug)]
pub(crate) struct Region {
    lower: [f64; 2],
    upper: [f64; 2],
    /// Sides of the box along periodic axes, or 0.
    period: [f64; 2],
    since: f64,
    contacts: u64,
    /// Sums of `J s l` and of its square.
    sums: [f64; 2],
}

impl Region {
    /// Lays a probe between two corners, as far as the box goes; none of a gas in space, or where nothing is left.
    pub(crate) fn lay<const D: usize>(engine: &EventDriven<D>, [a, b]: [[f64; 2]; 2]) -> Option<Self> {
        if D != 2 {
            return None;
        }
        let (boundary, time) = (engine.boundary(), engine.time());
        let side = |k: usize, upper: bool| boundary.face_at(k, upper, time).0;
        let lower = std::array::from_fn(|k| a[k].min(b[k]).max(side(k, false)));
        let upper = std::array::from_fn(|k| a[k].max(b[k]).min(side(k, true)));
        let periodic = |k: usize| boundary.axes[k] == corpuscle_core::Axis::Periodic;
        let period = std::array::from_fn(|k| if periodic(k) { boundary.extent()[k] } else { 0.0 });
        let something = (0..2).all(|k| lower[k] < upper[k]);
        something.then_some(Self { lower, upper, period, since: time, contacts: 0, sums: [0.0; 2] })
    }

    fn area(&self) -> f64 {
        (self.upper[0] - self.lower[0]) * (self.upper[1] - self.lower[1])
    }

    /// Takes note of a contact.
    pub(crate) fn note<const D: usize>(&mut self, contact: &Contact<D>) {
        let (from, way) = (contact.first.position, contact.normal * contact.distance);
        let (from, way) = ([from[0], from[1]], [way[0], way[1]]);
        // A line that leaves a periodic box comes in at the other side.
        let shifts = |k: usize| if self.period[k] > 0.0 { -1..=1 } else { 0..=0 };
        let mut share = 0.0;
        for (right, up) in shifts(0).flat_map(|right| shifts(1).map(move |up| (right, up))) {
            let shift = [f64::from(right) * self.period[0], f64::from(up) * self.period[1]];
            share += self.share([from[0] + shift[0], from[1] + shift[1]], way);
        }
        if share > 0.0 {
            let part = contact.impulse * contact.distance * share;
            self.contacts += 1;
            self.sums = [self.sums[0] + part, self.sums[1] + part * part];
        }
    }

    /// Share of a line that is inside.
    fn share(&self, from: [f64; 2], way: [f64; 2]) -> f64 {
        let (mut first, mut last) = (0.0f64, 1.0f64);
        for k in 0..2 {
            let [low, high] = [self.lower[k] - from[k], self.upper[k] - from[k]];
            if way[k] == 0.0 {
                if low > 0.0 || high <= 0.0 {
                    return 0.0;
                }
                continue;
            }
            let (enters, leaves) = if way[k] > 0.0 { (low / way[k], high / way[k]) } else { (high / way[k], low / way[k]) };
            (first, last) = (first.max(enters), last.min(leaves));
        }
        (last - first).max(0.0)
    }

    /// What there is to read now.
    fn read<const D: usize>(&self, engine: &EventDriven<D>) -> Probed {
        let inside = |i: &usize| (0..2).all(|k| (self.lower[k]..self.upper[k]).contains(&engine.position(*i)[k]));
        let within: Vec<usize> = (0..engine.particle_count()).filter(inside).collect();
        let (count, d) = (within.len() as f64, D as f64);
        let kinetic = (within.len() > 1).then(|| {
            let mass: f64 = within.iter().map(|&i| engine.mass(i)).sum();
            let flow =
                within.iter().fold(corpuscle_core::Vector::ZERO, |sum, &i| sum + engine.velocity(i) * (engine.mass(i) / mass));
            let squares: f64 = within.iter().map(|&i| engine.mass(i) * (engine.velocity(i) - flow).norm_squared()).sum();
            let mean = squares / (d * self.area()) * count / (count - 1.0);
            (mean, mean * (2.0 / (d * (count - 1.0))).sqrt())
        });
        let time = engine.time() - self.since;
        let scale = 1.0 / (d * self.area() * time);
        let collisional = (self.contacts > 0 && time > 0.0).then(|| (self.sums[0] * scale, self.sums[1].sqrt() * scale));
        Probed { time, contacts: self.contacts, kinetic, collisional }
    }
}

/// What the probe among the contacts of a gas has seen.
pub(crate) fn read<const D: usize>(engine: &EventDriven<D>, tally: &Tally) -> Option<Probed> {
    tally.probe().map(|region| region.read(engine))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)] // in the helpers too: a test that cannot be set up has failed

    use corpuscle_core::placement::{lattice, maxwell};
    use corpuscle_core::{Axis, Boundary, Particles, Random, Vector};
    use corpuscle_event::Rules;

    use super::*;

    /// A gas of packing fraction 0.31 that has come to equilibrium.
    fn gas(axis: Axis, seed: u64) -> EventDriven<2> {
        let boundary = Boundary::new([0.0; 2], [16.0; 2], axis);
        let mut random = Random::new(seed, 1);
        let mut particles = Particles::new();
        for site in lattice(&boundary, 100, 0.5, &mut random, |_| true).unwrap() {
            particles.push(site, Vector::ZERO, 1.0, 0.5, 0);
        }
        maxwell(&mut particles, 1.0, true, &mut random);
        let mut engine = EventDriven::new(boundary, particles, Rules::default()).unwrap();
        engine.advance(10.0, &mut ()).unwrap();
        engine
    }

    fn watched(engine: &mut EventDriven<2>, corners: [[f64; 2]; 2], time: f64) -> Probed {
        let mut tally = Tally::default();
        tally.lay(Region::lay(engine, corners));
        let to = engine.time() + time;
        engine.advance(to, &mut tally).unwrap();
        read(engine, &tally).unwrap()
    }

    /// Every line is somewhere: four parts of a box, periodic or not, have the pressure of the whole, exactly.
    #[test]
    fn parts_add_up_to_the_whole() {
        for axis in [Axis::Periodic, Axis::Walls] {
            let engine = gas(axis, 3);
            let of = |corners| watched(&mut engine.clone(), corners, 5.0).collisional.unwrap().0;
            let whole = of([[0.0; 2], [16.0; 2]]);
            let parts =
                [[[0.0, 0.0], [5.0, 7.0]], [[5.0, 0.0], [16.0, 7.0]], [[0.0, 7.0], [5.0, 16.0]], [[5.0, 7.0], [16.0, 16.0]]];
            let area = |[a, b]: [[f64; 2]; 2]| (b[0] - a[0]) * (b[1] - a[1]) / 256.0;
            let sum: f64 = parts.into_iter().map(|part| area(part) * of(part)).sum();
            assert!((sum / whole - 1.0).abs() < 1e-12, "{axis:?}: {sum}, {whole}");
        }
    }

    /// A part of an even gas has the pressure of the whole, kinetic and collisional, within the scatter of independent gases.
    #[test]
    fn a_part_of_an_even_gas_has_the_pressure_of_the_equation_of_state() {
        let corners = [[2.0, 3.0], [9.0, 14.0]];
        let readings: Vec<Probed> = (0..40).map(|seed| watched(&mut gas(Axis::Periodic, seed), corners, 20.0)).collect();
        let density = 100.0 / 256.0;
        let packing = density * std::f64::consts::FRAC_PI_4;
        // Of 100 discs each has 99 others to meet, and kT of a box at rest is by 1/100 higher in the degrees that are left.
        let excess = density * (corpuscle_observe::theory::compressibility::<2>(packing) - 1.0);
        let mean = |values: Vec<f64>| corpuscle_observe::Estimate::from_replicas(&values);
        let collisional = mean(readings.iter().map(|reading| reading.collisional.unwrap().0).collect());
        let z = (collisional.mean - excess * 0.99) / collisional.standard_error;
        assert!(z.abs() < 4.0, "{collisional:?}, expected {}", 0.99 * excess);
        let kinetic = mean(readings.iter().map(|reading| reading.kinetic.unwrap().0).collect());
        let z = (kinetic.mean - density) / kinetic.standard_error;
        assert!(z.abs() < 4.0, "{kinetic:?}, expected {density}");
    }
}
