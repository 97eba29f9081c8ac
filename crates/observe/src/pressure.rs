//! Pressure, from the walls and from the virial.

use std::ops::ControlFlow;

use corpuscle_core::{Axis, Boundary, Contact, Meeting, Observer, Particles};

use crate::Estimate;
use crate::blocking::blocking;
use crate::time_blocks::TimeBlocks;

/// Pressure on the walls of a box: `P = sum J / (A t)` over the impulses `J` on the faces of total area `A`.
///
/// The area is the one open to the particles' centres (a length in 2-D): a face across axis `k` measures
/// `prod_(l != k) (L_l - 2 R)` where the other axes have walls, so that `P V_acc = N k T` holds for an ideal gas of centres.
/// Each hit carries an independent impulse; its relative standard error from `H` hits is `sqrt((4/pi) / H)` in an ideal gas,
/// whatever the dimension. Partitions are not counted.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct WallPressure<const D: usize> {
    #[serde(with = "corpuscle_core::array")]
    faces: [[TimeBlocks; 2]; D],
    #[serde(with = "corpuscle_core::array")]
    areas: [f64; D],
    hits: u64,
}

impl<const D: usize> WallPressure<D> {
    /// Watches the walls of `boundary`, hit by particles of this radius (0 for the area of the box itself), in time blocks
    /// of this length. A block should see some tens of hits; blocks that are correlated are joined in the analysis.
    pub fn new(boundary: &Boundary<D>, radius: f64, block: f64) -> Self {
        let extent = boundary.extent();
        let open = |k: usize| extent[k] - if boundary.axes[k] == Axis::Walls { 2.0 * radius } else { 0.0 };
        let area = |k: usize| (0..D).filter(|&l| l != k).map(open).product();
        Self {
            faces: std::array::from_fn(|_| std::array::from_fn(|_| TimeBlocks::new(block))),
            areas: std::array::from_fn(|k| if boundary.axes[k] == Axis::Walls { area(k) } else { 0.0 }),
            hits: 0,
        }
    }

    /// Pressure over all walls with its standard error from blocking.
    pub fn estimate(&self) -> Estimate {
        self.over((0..D).flat_map(|axis| [(axis, 0), (axis, 1)]))
    }

    /// Pressure on the lower or upper face across an axis; not a number where there is no wall.
    pub fn face(&self, axis: usize, upper: bool) -> Estimate {
        self.over(std::iter::once((axis, usize::from(upper))))
    }

    /// The pressure over all walls in each time block that is over, in their order.
    pub fn blocks(&self) -> Vec<f64> {
        let (force, area) = self.forces((0..D).flat_map(|axis| [(axis, 0), (axis, 1)]));
        force.into_iter().map(|force| force / area).collect()
    }

    /// Number of hits.
    pub fn hits(&self) -> u64 {
        self.hits
    }

    /// Time over which the pressure is averaged.
    pub fn duration(&self) -> f64 {
        self.faces[0][0].duration()
    }

    fn over(&self, faces: impl Iterator<Item = (usize, usize)>) -> Estimate {
        let (force, area) = self.forces(faces);
        blocking(&force).estimate / area
    }

    /// Force in each block, and the area it acts on.
    fn forces(&self, faces: impl Iterator<Item = (usize, usize)>) -> (Vec<f64>, f64) {
        let mut force = vec![];
        let mut area = 0.0;
        for (axis, side) in faces.filter(|&(axis, _)| self.areas[axis] > 0.0) {
            let rates = self.faces[axis][side].rates();
            force.resize(rates.len(), 0.0);
            force.iter_mut().zip(rates).for_each(|(sum, rate)| *sum += rate);
            area += self.areas[axis];
        }
        (force, area)
    }

    fn advance(&mut self, time: f64) {
        self.faces.iter_mut().flatten().for_each(|face| face.advance(time));
    }
}

impl<const D: usize> Observer<D> for WallPressure<D> {
    fn begin(&mut self, time: f64, _: &Particles<D>) {
        self.advance(time);
    }

    #[inline]
    fn contact(&mut self, contact: &Contact<D>) -> ControlFlow<()> {
        if let Meeting::Face { axis, upper } = contact.with {
            self.faces[axis][usize::from(upper)].add(contact.time, contact.impulse);
            self.hits += 1;
        }
        ControlFlow::Continue(())
    }

    fn sample(&mut self, time: f64, _: &Particles<D>) -> ControlFlow<()> {
        self.advance(time);
        ControlFlow::Continue(())
    }

    fn finish(&mut self, time: f64, _: &Particles<D>) {
        self.advance(time);
    }
}

/// Pressure from the collisions between particles, by Clausius' virial theorem:
/// `P V = N k T + (1/(D t)) sum (impulse on i) . (r_i - r_j)` over the collisions in the time `t`.
///
/// A [`Contact`] gives its first particle the impulse `-J n`, where `n` points to the second: `r_i - r_j = -s n`, and the
/// term is `+J s`, with `s` the distance of the centres. `k T = 2 E_kin / f` with `f = D (N - 1)` degrees of freedom in a
/// periodic box, `D N` between walls. Between walls `V` is the volume accessible to the centres.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct VirialPressure<const D: usize> {
    virial: TimeBlocks,
    ideal: f64,
    volume: f64,
}

impl<const D: usize> VirialPressure<D> {
    /// Watches the collisions between `particles` particles in this volume at this temperature, in time blocks of this
    /// length. Elastic hard particles keep their temperature exactly.
    pub fn new(particles: usize, volume: f64, temperature: f64, block: f64) -> Self {
        Self { virial: TimeBlocks::new(block), ideal: particles as f64 * temperature, volume }
    }

    /// The pressure with its standard error from blocking.
    pub fn estimate(&self) -> Estimate {
        self.compressibility() * (self.ideal / self.volume)
    }

    /// The pressure in each time block that is over, in their order.
    pub fn blocks(&self) -> Vec<f64> {
        self.virial.rates().into_iter().map(|work| (self.ideal + work / D as f64) / self.volume).collect()
    }

    /// The compressibility factor `Z = P V / (N k T)`.
    ///
    /// In a periodic box of `N` hard spheres it differs from that of the infinite system by terms of order `1/N`:
    /// [`finite_size_shift`](crate::theory::finite_size_shift).
    pub fn compressibility(&self) -> Estimate {
        let work = blocking(&self.virial.rates()).estimate / (D as f64 * self.ideal);
        Estimate { mean: 1.0 + work.mean, ..work }
    }

    /// Time over which the pressure is averaged.
    pub fn duration(&self) -> f64 {
        self.virial.duration()
    }
}

impl<const D: usize> Observer<D> for VirialPressure<D> {
    fn begin(&mut self, time: f64, _: &Particles<D>) {
        self.virial.advance(time);
    }

    #[inline]
    fn contact(&mut self, contact: &Contact<D>) -> ControlFlow<()> {
        if let Meeting::Pair(_) = contact.with {
            self.virial.add(contact.time, contact.impulse * contact.distance);
        }
        ControlFlow::Continue(())
    }

    fn sample(&mut self, time: f64, _: &Particles<D>) -> ControlFlow<()> {
        self.virial.advance(time);
        ControlFlow::Continue(())
    }

    fn finish(&mut self, time: f64, _: &Particles<D>) {
        self.virial.advance(time);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::tests::assert_standard_normal;
    use corpuscle_core::{Party, Random, Vector};

    const IDLE: Party<2> = Party { index: 0, mass: 1.0, position: Vector::ZERO, before: Vector::ZERO, after: Vector::ZERO };

    /// Hits in the order of time on faces drawn by area: a Poisson process of rate `n A sqrt(kT/(2 pi m))`, speeds from the
    /// flux-weighted Maxwell distribution `v exp(-v^2/2)`. Kinetic theory then has `P = n k T`, the flux times the mean `2 m v`.
    #[test]
    fn hits_of_an_ideal_gas_give_its_pressure() {
        let room = Boundary::<2>::new([0.0; 2], [12.0, 7.0], Axis::Walls);
        let (density, radius) = (0.8, 0.5);
        let flux = density / (2.0 * std::f64::consts::PI).sqrt();
        let (wide, tall) = (11.0, 6.0);
        let area = 2.0 * (wide + tall);
        let (mut scores, mut relative) = (vec![], vec![]);
        for seed in 0..400 {
            let mut random = Random::new(seed, 21);
            let mut pressure = WallPressure::new(&room, radius, 1.0);
            pressure.begin(0.0, &Particles::new());
            let mut time = 0.0;
            loop {
                time -= libm::log(random.uniform()) / (flux * area);
                if time > 300.0 {
                    break;
                }
                let speed = (-2.0 * libm::log(random.uniform())).sqrt();
                let axis = usize::from(random.uniform() * area < 2.0 * wide);
                let with = Meeting::Face { axis, upper: random.uniform() < 0.5 };
                let impulse = 2.0 * speed;
                let _ =
                    pressure.contact(&Contact { time, first: IDLE, with, normal: Vector::unit(axis), impulse, distance: radius });
            }
            pressure.finish(300.0, &Particles::new());
            assert_eq!(pressure.duration(), 300.0);
            scores.push(pressure.estimate().score(density));
            relative.push(pressure.estimate().relative_error() * (pressure.hits() as f64 * std::f64::consts::PI / 4.0).sqrt());
            assert!(pressure.face(1, true).score(density).abs() < 5.0);
        }
        assert_standard_normal("wall pressure", &scores);
        let ratio = Estimate::from_replicas(&relative);
        // Blocking's own error estimate has a relative bias of order 1/blocks = 1/300.
        assert!((ratio.mean - 1.0).abs() < 4.0 * ratio.standard_error + 1.0 / 300.0, "{ratio:?}");
    }

    #[test]
    fn a_periodic_box_has_no_wall_pressure() {
        let mut pressure = WallPressure::new(&Boundary::<3>::periodic(5.0), 0.5, 1.0);
        pressure.finish(10.0, &Particles::new());
        assert!(pressure.estimate().mean.is_nan());
    }

    /// Two particles bouncing head on along a line between walls: everything can be counted by hand, and the pressure on the
    /// walls must be that of the virial theorem.
    #[test]
    fn wall_and_virial_agree_for_two_particles_on_a_line() {
        // Room for the centres: 0.5 to 9.5, so V_acc = 9. Equal masses swap velocities v = 1 and -1: the left one moves
        // over (9 - 1)/2 = 4 and back, period 8; 2 wall hits and 1 pair collision a period, all with J = 2.
        let room = Boundary::<1>::new([0.0], [10.0], Axis::Walls);
        let party = |x: f64| Party { index: 0, mass: 1.0, position: Vector([x]), before: Vector([0.0]), after: Vector([0.0]) };
        let mut wall = WallPressure::new(&room, 0.5, 8.0);
        let mut virial = VirialPressure::<1>::new(2, room.accessible_volume(0.5), 1.0, 8.0);
        let none = Particles::new();
        wall.begin(0.0, &none);
        virial.begin(0.0, &none);
        for period in 0..100 {
            let start = 8.0 * f64::from(period);
            let normal = Vector([1.0]);
            for (time, with, distance) in [
                (start + 2.0, Meeting::Pair(party(5.5)), 1.0),
                (start + 6.0, Meeting::Face { axis: 0, upper: false }, 0.5),
                (start + 6.0, Meeting::Face { axis: 0, upper: true }, 0.5),
            ] {
                let contact = Contact { time, first: party(4.5), with, normal, impulse: 2.0, distance };
                let _ = (wall.contact(&contact), virial.contact(&contact));
            }
        }
        wall.finish(800.0, &none);
        virial.finish(800.0, &none);
        // kT = 2 E/f = 1; P V = 2 kT + 2 x 1 / 8 = 2.25 = 0.25 x 9.
        assert_eq!(wall.estimate().mean, 0.25);
        assert!((virial.estimate().mean - 0.25).abs() < 1e-15);
    }
}
