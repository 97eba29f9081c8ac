//! Short-range forces between all pairs, from one potential or from a table of them.

mod kernel;
mod tensor;

use corpuscle_core::{Axis, Boundary, Invalid, Particles, Vector};
use rayon::prelude::*;

use super::{Force, Tensor, massive, positive};
use crate::exact::{BITS, Quantum};
use crate::image::NearestImage;
use crate::instructions::Instructions;
use crate::neighbours::{Blocks, LANES, Neighbours, Share};
use kernel::{AddEnergies, AddForces, Forces, Law, NONE, Pairs, Sums, Table, Uniform};

/// How far typical pairs are below the bound of the sums' quantum: forces up to `2^14` times energy over length and energies
/// up to `2^14` times the energy are still summed with the finest one.
const HEADROOM: f64 = 16384.0;

/// A spherically symmetric potential of finite range. All that a new one needs is in its file: neighbour lists, vectors,
/// threads, virial and checks come with [`PairForce`].
///
/// `energy` and `force_over_distance` are compiled into loops over lanes: marked `#[inline(always)]`, and without branches
/// and calls, they become vector instructions. They are also called beyond the range, where their values do not count.
pub trait PairPotential: Copy + Send + Sync {
    /// Name, as a table of energies shows it.
    fn name(&self) -> &'static str;

    /// Range beyond which energy and force are zero.
    fn cutoff(&self) -> f64;

    /// The length on which the potential changes: the diameter of a particle.
    fn length(&self) -> f64;

    /// The energy on which it changes: the depth of a well, or the height at a length's distance.
    fn depth(&self) -> f64;

    /// Energy `U(r)` of a pair as the formula gives it: [`PairForce`] shifts it to zero at the range.
    fn energy(&self, r_squared: f64) -> f64;

    /// `-U'(r)/r` of a pair within the range, positive when it repels.
    fn force_over_distance(&self, r_squared: f64) -> f64;

    /// Checks the parameters.
    ///
    /// # Errors
    /// Names the parameter at fault.
    fn validate(&self) -> Result<(), Invalid>;
}

/// The force of a [`PairPotential`] between all pairs of particles.
///
/// Forces of pairs are rounded to multiples of a fixed quantum (`2^-37` of [`depth`](PairPotential::depth) over
/// [`length`](PairPotential::length), unless a force is too large for it) and added as integers. Their sums are therefore
/// exact: bits depend on positions alone, neither on the neighbour list nor on the number of threads nor on the machine,
/// and the forces of a closed system add up to exactly zero. An integrator that asks for precise accelerations gets what
/// the rounding leaves, too, summed in the same way.
///
/// Large systems are computed by the threads of the rayon pool the caller runs in.
pub struct PairForce<P, const D: usize> {
    /// A symmetric square, row by row.
    table: Vec<P>,
    species: usize,
    shifted: bool,
    neighbours: Neighbours<D>,
    instructions: Instructions,
    /// One array a share of the list.
    force: Vec<Vec<Forces<D, 1>>>,
    quantum: Quantum,
}

impl<P: PairPotential, const D: usize> PairForce<P, D> {
    /// The force of one potential between all particles, with a neighbour list that chooses its own skin.
    pub fn new(potential: P) -> Self {
        Self::with_table(vec![potential], 1, None)
    }

    /// The force of `potential`, with a list that reaches `skin` beyond its cutoff: a wider one is built less often and
    /// holds more pairs.
    pub fn with_skin(potential: P, skin: f64) -> Self {
        Self::with_table(vec![potential], 1, Some(skin))
    }

    /// Forces that depend on the species of both particles: `potential(a, b)`, asked for `a <= b`, acts between species `a`
    /// and `b`, each below `species`.
    pub fn between_species(species: u16, potential: impl Fn(u16, u16) -> P) -> Self {
        let table = (0..species).flat_map(|a| (0..species).map(move |b| (a.min(b), a.max(b)))).map(|(a, b)| potential(a, b));
        Self::with_table(table.collect(), species.into(), None)
    }

    /// Leaves energies as the formula gives them, so that they jump to zero at the range: forces are the same.
    #[must_use]
    pub fn unshifted(mut self) -> Self {
        self.shifted = false;
        self
    }

    fn with_table(table: Vec<P>, species: usize, skin: Option<f64>) -> Self {
        let cutoff = largest(&table, P::cutoff);
        let neighbours = Neighbours::new(cutoff, skin);
        let quantum = finest(&table, |potential| potential.depth() / potential.length());
        Self { table, species, shifted: true, neighbours, instructions: Instructions::detect(), force: vec![], quantum }
    }

    /// The potential; between particles of the first species, where it depends on that.
    pub fn potential(&self) -> &P {
        &self.table[0]
    }

    /// The neighbour list, as of the last evaluation.
    pub fn neighbours(&self) -> &Neighbours<D> {
        &self.neighbours
    }

    /// Adds the accelerations by the forces of all pairs, which `force` gathers.
    fn add_accelerations<const LEVELS: usize>(
        &mut self,
        boundary: &Boundary<D>,
        particles: &Particles<D>,
        force: &mut Vec<Vec<Forces<D, LEVELS>>>,
        acceleration: &mut [Vector<D>],
    ) {
        self.neighbours.update(boundary, &particles.position);
        let bound = if let [potential] = self.table[..] {
            self.add_forces(Uniform(potential), boundary, force)
        } else {
            self.neighbours.blocks.load_species(&particles.species);
            let (table, species) = (self.table.clone(), self.species);
            self.add_forces(Table(&table, species), boundary, force)
        };
        if !bound.is_finite() {
            for i in self.lost(boundary, particles) {
                acceleration[i] = Vector([f64::NAN; D]);
            }
            return;
        }
        let unit = if LEVELS == 1 { self.quantum.unit() } else { self.quantum.finer().unit() };
        let place = &self.neighbours.blocks.place;
        for ((a, &mass), &place) in acceleration.iter_mut().zip(&particles.mass).zip(place) {
            let (block, lane) = (place as usize / LANES, place as usize % LANES);
            let scale = unit / mass;
            for k in 0..D {
                let sum = |level: usize| force.iter().fold(0i64, |sum, force| sum.wrapping_add(force[block][level][k][lane]));
                a[k] +=
                    scale * if LEVELS == 1 { sum(0) as f64 } else { ((i128::from(sum(0)) << BITS) + i128::from(sum(1))) as f64 };
            }
        }
    }

    /// Sums the forces of all pairs, with the quantum that suits the largest of them; returns the bound of all forces.
    fn add_forces<L: Law, const LEVELS: usize>(
        &mut self,
        law: L,
        boundary: &Boundary<D>,
        force: &mut Vec<Vec<Forces<D, LEVELS>>>,
    ) -> f64 {
        let cutoff = largest(&self.table, P::cutoff);
        let finest = finest(&self.table, |potential| potential.depth() / potential.length());
        let (blocks, shares) = (&self.neighbours.blocks, &self.neighbours.shares);
        force.resize_with(shares.len(), Vec::new);
        loop {
            let one = |(force, share): (&mut Vec<Forces<D, LEVELS>>, &Share)| {
                force.clear();
                force.resize(blocks.position.len(), [[NONE; D]; LEVELS]);
                let pairs = self.pairs(law, boundary, blocks, share);
                self.instructions.run(AddForces { pairs, quanta: [self.quantum, self.quantum.finer()], force })
            };
            let scale = force.par_iter_mut().zip(shares).map(one).reduce(|| 0.0, larger);
            // The last quantum is only a guess, which saves time where it is right: the bits follow from the largest force.
            let quantum = finest.coarsened(scale * cutoff);
            if quantum == self.quantum {
                return scale * cutoff;
            }
            self.quantum = quantum;
        }
    }

    fn pairs<'a, L>(&self, law: L, boundary: &Boundary<D>, blocks: &'a Blocks<D>, share: &'a Share) -> Pairs<'a, L, D> {
        Pairs { law, image: NearestImage::new(boundary), blocks, share, shifted: self.shifted }
    }

    /// Energy and virial.
    fn sums(&self, boundary: &Boundary<D>, particles: &Particles<D>) -> [f64; 2] {
        let mut rebuilt = Neighbours::new(largest(&self.table, P::cutoff), Some(0.0));
        let (mut blocks, shares) = if let Some(blocks) = self.neighbours.blocks_at(boundary, &particles.position) {
            (blocks, &self.neighbours.shares)
        } else {
            rebuilt.update(boundary, &particles.position);
            (std::mem::replace(&mut rebuilt.blocks, Blocks::empty()), &rebuilt.shares)
        };
        blocks.load_species(&particles.species);
        let finest = finest(&self.table, P::depth);
        let mut quanta = [finest; 2];
        loop {
            let one = |share| -> Sums {
                let quanta = quanta.map(|quantum| [quantum, quantum.finer()]);
                if let [potential] = self.table[..] {
                    let pairs = self.pairs(Uniform(potential), boundary, &blocks, share);
                    self.instructions.run(AddEnergies { pairs, quanta })
                } else {
                    let pairs = self.pairs(Table(&self.table, self.species), boundary, &blocks, share);
                    self.instructions.run(AddEnergies { pairs, quanta })
                }
            };
            let parts: Vec<Sums> = shares.par_iter().map(one).collect();
            let bounds = [0, 1].map(|number| parts.iter().map(|part| part.largest[number]).fold(0.0, larger));
            if !bounds.iter().all(|bound| bound.is_finite()) {
                return bounds;
            }
            let needed = bounds.map(|bound| finest.coarsened(bound));
            if needed == quanta {
                let sum = |number: usize| parts.iter().map(|part| part.total[number]).sum::<i128>() as f64;
                return [0, 1].map(|number| sum(number) * quanta[number].finer().unit());
            }
            quanta = needed;
        }
    }

    /// The particles of pairs with a force beyond all numbers.
    fn lost(&self, boundary: &Boundary<D>, particles: &Particles<D>) -> Vec<usize> {
        let image = NearestImage::new(boundary);
        let meets = |i: usize, j: usize| {
            let r_squared = image.displacement(particles.position[i], particles.position[j]).norm_squared();
            let potential = &self.table[usize::from(particles.species[i]) % self.species * self.species
                + usize::from(particles.species[j]) % self.species];
            let within = r_squared < potential.cutoff() * potential.cutoff();
            within && !(potential.force_over_distance(r_squared) * potential.cutoff()).is_finite()
        };
        (0..particles.len()).filter(|&i| (0..particles.len()).any(|j| j != i && meets(i, j))).collect()
    }
}

/// The largest of a quantity in a table.
fn largest<P>(table: &[P], quantity: impl Fn(&P) -> f64) -> f64 {
    table.iter().map(quantity).fold(0.0, f64::max)
}

/// The quantum sums start from, for a quantity of typical size.
fn finest<P>(table: &[P], size: impl Fn(&P) -> f64) -> Quantum {
    Quantum::for_terms_up_to(HEADROOM * largest(table, |potential| size(potential).abs()))
}

/// The larger of two magnitudes; one that is not a number counts as the largest.
fn larger(a: f64, b: f64) -> f64 {
    if a.to_bits() > b.to_bits() { a } else { b }
}

impl<P: PairPotential, const D: usize> Force<D> for PairForce<P, D> {
    fn name(&self) -> &'static str {
        self.potential().name()
    }

    fn accelerate(&mut self, _: f64, boundary: &Boundary<D>, particles: &Particles<D>, acceleration: &mut [Vector<D>]) {
        let mut force = std::mem::take(&mut self.force);
        self.add_accelerations(boundary, particles, &mut force, acceleration);
        self.force = force;
    }

    fn accelerate_precisely(
        &mut self,
        _: f64,
        boundary: &Boundary<D>,
        particles: &Particles<D>,
        _: &[Vector<D>],
        acceleration: &mut [Vector<D>],
    ) {
        self.add_accelerations::<2>(boundary, particles, &mut vec![], acceleration);
    }

    fn energy(&self, _: f64, boundary: &Boundary<D>, particles: &Particles<D>) -> f64 {
        self.sums(boundary, particles)[0]
    }

    fn virial(&self, _: f64, boundary: &Boundary<D>, particles: &Particles<D>) -> f64 {
        self.sums(boundary, particles)[1]
    }

    fn virial_tensor(&self, _: f64, boundary: &Boundary<D>, particles: &Particles<D>) -> Option<Tensor<D>> {
        Some(tensor::virial_tensor(&self.table, self.species, boundary, particles))
    }

    fn validate(&self, boundary: &Boundary<D>, particles: &Particles<D>) -> Result<(), Invalid> {
        if self.table.is_empty() {
            return Err(Invalid::new("species", 0, "at least one"));
        }
        for potential in &self.table {
            potential.validate()?;
            positive("cutoff", potential.cutoff())?;
            positive("length", potential.length())?;
            for k in (0..D).filter(|&k| boundary.axes[k] == Axis::Periodic) {
                let half = 0.5 * boundary.extent()[k];
                if potential.cutoff() > half {
                    return Err(Invalid::new(
                        format!("cutoff of {}", potential.name()),
                        potential.cutoff(),
                        format!(
                            "at most half the periodic box, {half} along axis {k}: a particle would meet two images of another"
                        ),
                    ));
                }
            }
        }
        let known = |i: &usize| self.species == 1 || usize::from(particles.species[*i]) < self.species;
        if let Some(i) = (0..particles.len()).find(|i| !known(i)) {
            let expected = format!("a species below {}", self.species);
            return Err(Invalid::new(format!("species of particle {i}"), particles.species[i], expected));
        }
        (0..particles.len()).try_for_each(|i| massive(self.potential().name(), i, particles))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::force::{LennardJones, WeeksChandlerAndersen};
    use corpuscle_core::Random;
    use proptest::prelude::*;

    fn gas<const D: usize>(axes: [Axis; D], side: f64, count: usize, seed: u64) -> (Boundary<D>, Particles<D>) {
        let mut boundary = Boundary::new([-1.0; D], [side - 1.0; D], Axis::Open);
        boundary.axes = axes;
        let mut random = Random::new(seed, 0);
        let mut particles = Particles::new();
        for _ in 0..count {
            let place = Vector::from_fn(|k| boundary.lower[k] + side * random.uniform());
            particles.push(place, Vector::ZERO, 1.0 + random.uniform(), 0.0, 0);
        }
        (boundary, particles)
    }

    fn accelerations<const D: usize>(
        force: &mut PairForce<impl PairPotential, D>,
        boundary: &Boundary<D>,
        particles: &Particles<D>,
    ) -> Vec<Vector<D>> {
        let mut acceleration = vec![Vector::ZERO; particles.len()];
        force.accelerate(0.0, boundary, particles, &mut acceleration);
        acceleration
    }

    /// Against a scan over all pairs that adds in quanta of its own; random places overlap, so forces are of any size.
    fn check<const D: usize>(axes: [Axis; D], side: f64, count: usize, seed: u64) {
        let (boundary, mut particles) = gas(axes, side, count, seed);
        let potential = WeeksChandlerAndersen::new(1.0, 0.9);
        let mut force = PairForce::new(potential);
        let mut random = Random::new(seed, 1);
        for _ in 0..3 {
            let found = accelerations(&mut force, &boundary, &particles);
            let mut expected = vec![Vector::<D>::ZERO; count];
            let mut size = vec![0.0; count];
            for i in 0..count {
                for j in (0..count).filter(|&j| j != i) {
                    let arrow = boundary.displacement(particles.position[i], particles.position[j]);
                    if arrow.norm_squared() < potential.cutoff() * potential.cutoff() {
                        let f = arrow * -potential.force_over_distance(arrow.norm_squared());
                        expected[i] += f * (1.0 / particles.mass[i]);
                        size[i] += f.norm();
                    }
                }
            }
            // A pair's force is off by half a quantum, and by the rounding of a power 14 of the distance.
            let bound = |i: usize| size[i] * 100.0 * f64::EPSILON + count as f64 * force.quantum.unit() * 2.0;
            for i in 0..count {
                assert!((found[i] - expected[i]).norm() <= bound(i), "{i}: {:?} against {:?}", found[i], expected[i]);
            }
            // A little further on the list still holds; or it must notice that it does not.
            particles.position.iter_mut().for_each(|r| {
                *r = boundary.wrap(*r + Vector::from_fn(|_| 0.06 * (random.uniform() - 0.5)));
            });
        }
    }

    fn axis() -> impl Strategy<Value = Axis> {
        prop_oneof![Just(Axis::Periodic), Just(Axis::Walls), Just(Axis::Open)]
    }

    proptest! {
        #[test]
        fn forces_are_what_a_scan_over_all_pairs_finds(
            axes in prop::array::uniform3(axis()), side in 2.1..9.0f64, count in 1..150usize, seed in any::<u64>()
        ) {
            check([axes[0], axes[1]], side, count, seed);
            check(axes, side, count, seed);
            check([axes[0]], side, count.min(12), seed);
        }
    }

    #[test]
    fn bits_depend_neither_on_the_instruction_set_nor_on_the_number_of_threads() {
        let (boundary, mut particles) = gas([Axis::Periodic; 3], 16.0, 4096, 3);
        for (i, r) in particles.position.iter_mut().enumerate() {
            *r = *r * 0.02 + Vector::from_fn(|k| (i / 16usize.pow(k as u32) % 16) as f64 - 0.9);
        }
        let run = |instructions, threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mut force = PairForce::<_, 3>::new(LennardJones { epsilon: 1.0, sigma: 1.0, cutoff: 2.5 });
                force.instructions = instructions;
                let accelerations = accelerations(&mut force, &boundary, &particles);
                assert_eq!(force.force.len(), threads);
                (accelerations, force.energy(0.0, &boundary, &particles), force.virial(0.0, &boundary, &particles))
            })
        };
        let plain = run(Instructions::Plain, 1);
        for instructions in Instructions::all() {
            for threads in [1, 2, 5] {
                assert!(run(instructions, threads) == plain, "{instructions:?} {threads}");
            }
        }
        let mut precise = vec![Vector::ZERO; particles.len()];
        let mut force = PairForce::<_, 3>::new(LennardJones { epsilon: 1.0, sigma: 1.0, cutoff: 2.5 });
        force.accelerate_precisely(0.0, &boundary, &particles, &[], &mut precise);
        let off = precise.iter().zip(&plain.0).map(|(a, b)| (*a - *b).norm()).fold(0.0, f64::max);
        assert!(off > 0.0 && off < 100.0 * force.quantum.unit(), "{off:e}");
    }

    #[test]
    fn the_forces_of_a_closed_system_add_up_to_nothing() {
        let (boundary, mut particles) = gas([Axis::Periodic; 2], 30.0, 500, 1);
        particles.mass.fill(1.0);
        let mut force = PairForce::<_, 2>::new(WeeksChandlerAndersen::new(1.0, 1.0));
        let accelerations = accelerations(&mut force, &boundary, &particles);
        // Unit masses: accelerations are multiples of the quantum, whose sum in quanta is exact.
        let unit = force.quantum.unit();
        for k in 0..2 {
            assert_eq!(accelerations.iter().map(|a| (a[k] / unit) as i128).sum::<i128>(), 0);
        }
    }

    #[test]
    fn two_particles_at_one_place_are_named_as_lost() {
        let (boundary, mut particles) = gas([Axis::Open; 2], 30.0, 9, 1);
        particles.position[7] = particles.position[2];
        let mut force = PairForce::<_, 2>::new(WeeksChandlerAndersen::new(1.0, 1.0));
        let accelerations = accelerations(&mut force, &boundary, &particles);
        let lost: Vec<usize> = (0..9).filter(|&i| !accelerations[i].is_finite()).collect();
        assert_eq!(lost, [2, 7]);
    }
}
