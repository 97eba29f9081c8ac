//! Short-range forces between all pairs, from one potential or from a table of them.

mod energies;
mod kernel;
mod strides;
mod tensor;

use corpuscle_core::{Axis, Boundary, Instructions, Invalid, Particles, Vector};
use rayon::prelude::*;

use super::{Force, Tensor, massive, positive};
use crate::exact::Quantum;
use crate::image::NearestImage;
use crate::lanes;
use crate::neighbours::{Blocks, Neighbours, Rows};
use crate::strider::Strider;
use crate::threads::{self, CHUNK};
use energies::{AddEnergies, Totals};
use kernel::{AddForces, Law, Pairs, Table, Uniform};
use strides::InOrder;

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
    /// Of each place in the list's order.
    force: Vec<[f64; D]>,
    quantum: Quantum,
    order: InOrder<D>,
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
        Self {
            table,
            species,
            shifted: true,
            neighbours,
            instructions: Instructions::detect(),
            force: vec![],
            quantum,
            order: InOrder::default(),
        }
    }

    /// The potential; between particles of the first species, where it depends on that.
    pub fn potential(&self) -> &P {
        &self.table[0]
    }

    /// The neighbour list, as of the last evaluation.
    pub fn neighbours(&self) -> &Neighbours<D> {
        &self.neighbours
    }

    /// Adds the accelerations by the forces of all pairs.
    fn add_accelerations<const LEVELS: usize>(
        &mut self,
        boundary: &Boundary<D>,
        particles: &Particles<D>,
        acceleration: &mut [Vector<D>],
    ) {
        self.neighbours.update(boundary, &particles.position);
        let mut force = std::mem::take(&mut self.force);
        force.resize(self.neighbours.blocks.position.len(), [0.0; D]);
        let bound = if let [potential] = self.table[..] {
            self.find_forces::<_, LEVELS>(Uniform(potential), boundary, &mut force)
        } else {
            self.neighbours.blocks.load_species(&particles.species);
            let (table, species) = (self.table.clone(), self.species);
            self.find_forces::<_, LEVELS>(Table(&table, species), boundary, &mut force)
        };
        if bound.is_finite() {
            let (mass, place) = (&particles.mass, &self.neighbours.blocks.place);
            let one = |((acceleration, mass), place): ((&mut [Vector<D>], &[f64]), &[u32])| {
                for ((a, &mass), &place) in acceleration.iter_mut().zip(mass).zip(place) {
                    *a += Vector(force[place as usize]) * (1.0 / mass);
                }
            };
            if threads::are_worth_it(mass.len()) {
                let chunks = acceleration.par_chunks_mut(CHUNK).zip(mass.par_chunks(CHUNK)).zip(place.par_chunks(CHUNK));
                chunks.for_each(one);
            } else {
                one(((acceleration, mass), place));
            }
        } else {
            for i in self.lost(boundary, particles) {
                acceleration[i] = Vector([f64::NAN; D]);
            }
        }
        self.force = force;
    }

    /// Sums the forces on every place, with the quantum that suits the largest of them; returns the bound of all forces.
    fn find_forces<L: Law, const LEVELS: usize>(&mut self, law: L, boundary: &Boundary<D>, force: &mut [[f64; D]]) -> f64 {
        let cutoff = largest(&self.table, P::cutoff);
        let finest = finest(&self.table, |potential| potential.depth() / potential.length());
        let (blocks, shares) = (&self.neighbours.blocks, &self.neighbours.shares);
        let places = self.neighbours.places_a_share();
        loop {
            let quanta = [self.quantum, self.quantum.finer()];
            let one = |(force, rows): (&mut [[f64; D]], &Rows)| {
                let pairs = Self::pairs(law, boundary, blocks, rows);
                lanes::run(self.instructions, AddForces::<L, D, LEVELS> { pairs, quanta, force })
            };
            let scale = if self.neighbours.is_large {
                force.par_chunks_mut(places).zip(shares).map(one).reduce(|| 0.0, larger)
            } else {
                force.chunks_mut(places).zip(shares).map(one).fold(0.0, larger)
            };
            // The last quantum is only a guess, which saves time where it is right: the bits follow from the largest force.
            let quantum = finest.coarsened(scale * cutoff);
            if quantum == self.quantum {
                return scale * cutoff;
            }
            self.quantum = quantum;
        }
    }

    fn pairs<'a, L>(law: L, boundary: &Boundary<D>, blocks: &'a Blocks<D>, rows: &'a Rows) -> Pairs<'a, L, D> {
        Pairs { law, image: NearestImage::new(boundary), blocks, rows }
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
        let (instructions, shifted) = (self.instructions, self.shifted);
        let mut quanta = [finest; 2];
        loop {
            let one = |rows| -> Totals {
                let quanta = quanta.map(|quantum| [quantum, quantum.finer()]);
                if let [potential] = self.table[..] {
                    let pairs = Self::pairs(Uniform(potential), boundary, &blocks, rows);
                    lanes::run(instructions, AddEnergies { pairs, quanta, shifted })
                } else {
                    let pairs = Self::pairs(Table(&self.table, self.species), boundary, &blocks, rows);
                    lanes::run(instructions, AddEnergies { pairs, quanta, shifted })
                }
            };
            let parts: Vec<Totals> =
                if self.neighbours.is_large { shares.par_iter().map(one).collect() } else { shares.iter().map(one).collect() };
            let bounds = [0, 1].map(|number| parts.iter().map(|part| part.largest[number]).fold(0.0, larger));
            if !bounds.iter().all(|bound| bound.is_finite()) {
                return bounds;
            }
            let needed = bounds.map(|bound| finest.coarsened(bound));
            if needed == quanta {
                // Both sides of a pair have the same energy, bit by bit: half of the sum is a whole number of quanta.
                let sum = |number: usize| (parts.iter().map(|part| part.total[number]).sum::<i128>() / 2) as f64;
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
        self.add_accelerations::<1>(boundary, particles, acceleration);
    }

    fn accelerate_precisely(
        &mut self,
        _: f64,
        boundary: &Boundary<D>,
        particles: &Particles<D>,
        _: &[Vector<D>],
        acceleration: &mut [Vector<D>],
    ) {
        self.add_accelerations::<2>(boundary, particles, acceleration);
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

    fn strider(&mut self) -> Option<&mut dyn Strider<D>> {
        Some(self)
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
mod tests;
