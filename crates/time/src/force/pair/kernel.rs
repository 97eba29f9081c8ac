//! The sums over pairs: forces, energy and virial, a particle against a block of others at a time.

// A condition without `&&` is a mask; what a kernel accumulates stays apart so that it stays in registers.
#![allow(clippy::needless_bitwise_bool, clippy::too_many_arguments)]

use corpuscle_core::instructions::Kernel;

use crate::exact::{BITS, Quantum};
use crate::image::NearestImage;
use crate::neighbours::{Blocks, LANES, Lanes, Rows, Share};

use super::PairPotential;

/// Force on each particle of a block: in quanta and, on a second level, what that leaves in quanta of its own.
pub(super) type Forces<const D: usize, const LEVELS: usize> = [[Lanes<i64>; D]; LEVELS];

/// No force.
pub(super) const NONE: Lanes<i64> = Lanes([0; LANES]);

/// Which potential acts between two species.
pub(super) trait Law: Copy + Sync {
    type Potential: PairPotential;

    fn between(self, species: u16, other: u16) -> Self::Potential;
}

/// The same one between all.
#[derive(Clone, Copy)]
pub(super) struct Uniform<P>(pub(super) P);

impl<P: PairPotential> Law for Uniform<P> {
    type Potential = P;

    #[inline(always)]
    fn between(self, _: u16, _: u16) -> P {
        self.0
    }
}

/// One for each pair of species, row by row.
#[derive(Clone, Copy)]
pub(super) struct Table<'a, P>(pub(super) &'a [P], pub(super) usize);

impl<P: PairPotential> Law for Table<'_, P> {
    type Potential = P;

    #[inline(always)]
    fn between(self, species: u16, other: u16) -> P {
        self.0[usize::from(species) * self.1 + usize::from(other)]
    }
}

/// The pairs of one share, and what is needed to evaluate them.
pub(super) struct Pairs<'a, L, const D: usize> {
    pub(super) law: L,
    pub(super) image: NearestImage<D>,
    pub(super) blocks: &'a Blocks<D>,
    pub(super) share: &'a Share,
    /// Whether energies are shifted to vanish at the range.
    pub(super) shifted: bool,
}

/// In a block a particle meets only those in later lanes: every pair once.
const LATER: [[bool; LANES]; LANES] = {
    let mut later = [[false; LANES]; LANES];
    let mut lane = 0;
    while lane < LANES {
        let mut other = lane + 1;
        while other < LANES {
            later[lane][other] = true;
            other += 1;
        }
        lane += 1;
    }
    later
};

/// Vectors from `r` to the particles of a block, and their squares.
#[inline(always)]
fn arrows<const D: usize, const IMAGE: bool>(
    image: &NearestImage<D>,
    r: &[f64; D],
    there: &[Lanes<f64>; D],
) -> ([[f64; LANES]; D], [f64; LANES]) {
    let mut arrow = [[0.0; LANES]; D];
    let mut r_squared = [0.0; LANES];
    for k in 0..D {
        for lane in 0..LANES {
            let d = there[k][lane] - r[k];
            arrow[k][lane] = if IMAGE { image.component(k, d) } else { d };
            r_squared[lane] += arrow[k][lane] * arrow[k][lane];
        }
    }
    (arrow, r_squared)
}

/// Which lanes of its own block a particle meets.
#[inline(always)]
fn later(lane: usize, own: bool) -> [bool; LANES] {
    let mut later = LATER[lane];
    for other in 0..LANES {
        later[other] &= own;
    }
    later
}

/// Keeps the larger of two magnitudes, as bits: not a number counts as larger than infinity.
#[inline(always)]
fn keep_largest(largest: &mut [i64; LANES], x: &[f64; LANES]) {
    for lane in 0..LANES {
        let bits = x[lane].abs().to_bits() as i64;
        largest[lane] = if bits > largest[lane] { bits } else { largest[lane] };
    }
}

fn largest_of(bits: [i64; LANES]) -> f64 {
    f64::from_bits(bits.into_iter().max().unwrap_or(0) as u64)
}

/// Adds the force of every pair of a share; returns the largest `|U'(r)/r|`.
pub(super) struct AddForces<'a, L, const D: usize, const LEVELS: usize> {
    pub(super) pairs: Pairs<'a, L, D>,
    pub(super) quanta: [Quantum; 2],
    pub(super) force: &'a mut [Forces<D, LEVELS>],
}

impl<L: Law, const D: usize, const LEVELS: usize> Kernel for AddForces<'_, L, D, LEVELS> {
    type Output = f64;

    #[inline(always)]
    fn run(self) -> f64 {
        let mut largest = [0; LANES];
        let share = self.pairs.share;
        add_forces::<L, D, LEVELS, false>(&self.pairs, &share.direct, self.quanta, self.force, &mut largest);
        add_forces::<L, D, LEVELS, true>(&self.pairs, &share.imaged, self.quanta, self.force, &mut largest);
        largest_of(largest)
    }
}

#[inline(always)]
fn add_forces<L: Law, const D: usize, const LEVELS: usize, const IMAGE: bool>(
    pairs: &Pairs<'_, L, D>,
    rows: &Rows,
    quanta: [Quantum; 2],
    force: &mut [Forces<D, LEVELS>],
    largest: &mut [i64; LANES],
) {
    let blocks = pairs.blocks;
    let mut most = *largest;
    for (place, own, row) in rows.iter() {
        let (block, lane) = (place / LANES, place % LANES);
        let mut r = [0.0; D];
        for k in 0..D {
            r[k] = blocks.position[block][k][lane];
        }
        let species = blocks.species[block][lane];
        let mut total = [[NONE; D]; LEVELS];
        meet::<L, D, LEVELS, IMAGE>(
            pairs,
            quanta,
            (&r, species),
            block,
            later(lane, own),
            &mut force[block],
            &mut total,
            &mut most,
        );
        for &other in row {
            let other = other as usize;
            meet::<L, D, LEVELS, IMAGE>(
                pairs,
                quanta,
                (&r, species),
                other,
                [true; LANES],
                &mut force[other],
                &mut total,
                &mut most,
            );
        }
        recoil(&mut force[block], lane, &total);
    }
    *largest = most;
}

/// Takes what one particle exerted off the force on it.
#[inline(never)] // the sums over lanes, where they can be seen, make the compiler give up on vectors in the loop before
fn recoil<const D: usize, const LEVELS: usize>(force: &mut Forces<D, LEVELS>, lane: usize, total: &Forces<D, LEVELS>) {
    for (force, total) in force.iter_mut().zip(total) {
        for k in 0..D {
            force[k][lane] = total[k].0.iter().fold(force[k][lane], |force, &f| force.wrapping_sub(f));
        }
    }
}

/// The forces of the particle at `r` on the particles of a block.
#[inline(always)]
fn meet<L: Law, const D: usize, const LEVELS: usize, const IMAGE: bool>(
    pairs: &Pairs<'_, L, D>,
    quanta: [Quantum; 2],
    (r, species): (&[f64; D], u16),
    other: usize,
    counts: [bool; LANES],
    force: &mut Forces<D, LEVELS>,
    total: &mut Forces<D, LEVELS>,
    most: &mut [i64; LANES],
) {
    let (arrow, r_squared) = arrows::<D, IMAGE>(&pairs.image, r, &pairs.blocks.position[other]);
    let mut scale = [0.0; LANES];
    for lane in 0..LANES {
        let potential = pairs.law.between(species, pairs.blocks.species[other][lane]);
        let f = potential.force_over_distance(r_squared[lane]);
        let within = counts[lane] & (r_squared[lane] < potential.cutoff() * potential.cutoff());
        scale[lane] = if within { f } else { 0.0 };
    }
    keep_largest(most, &scale);
    for k in 0..D {
        for lane in 0..LANES {
            let mut left = arrow[k][lane] * scale[lane];
            for level in 0..LEVELS {
                let f;
                (f, left) = quanta[level].split(left);
                force[level][k][lane] = force[level][k][lane].wrapping_add(f);
                total[level][k][lane] = total[level][k][lane].wrapping_add(f);
            }
        }
    }
}

/// Energy and virial of a share, in `2^-51` quanta, and the largest terms of each.
pub(super) struct Sums {
    pub(super) total: [i128; 2],
    pub(super) largest: [f64; 2],
}

/// Adds up energy and virial of every pair of a share.
pub(super) struct AddEnergies<'a, L, const D: usize> {
    pub(super) pairs: Pairs<'a, L, D>,
    /// Of each sum, and of what its terms leave.
    pub(super) quanta: [[Quantum; 2]; 2],
}

impl<L: Law, const D: usize> Kernel for AddEnergies<'_, L, D> {
    type Output = Sums;

    #[inline(always)]
    fn run(self) -> Sums {
        let mut total = [0; 2];
        let mut largest = [[0; LANES]; 2];
        let share = self.pairs.share;
        add_energies::<L, D, false>(&self.pairs, &share.direct, self.quanta, &mut total, &mut largest);
        add_energies::<L, D, true>(&self.pairs, &share.imaged, self.quanta, &mut total, &mut largest);
        Sums { total, largest: largest.map(largest_of) }
    }
}

#[inline(always)]
fn add_energies<L: Law, const D: usize, const IMAGE: bool>(
    pairs: &Pairs<'_, L, D>,
    rows: &Rows,
    quanta: [[Quantum; 2]; 2],
    total: &mut [i128; 2],
    largest: &mut [[i64; LANES]; 2],
) {
    let blocks = pairs.blocks;
    for (place, own, row) in rows.iter() {
        let (block, lane) = (place / LANES, place % LANES);
        let mut r = [0.0; D];
        for k in 0..D {
            r[k] = blocks.position[block][k][lane];
        }
        let species = blocks.species[block][lane];
        let mut sums = [[[0i64; LANES]; 2]; 2];
        count::<L, D, IMAGE>(pairs, quanta, (&r, species), block, later(lane, own), &mut sums, largest);
        for &other in row {
            count::<L, D, IMAGE>(pairs, quanta, (&r, species), other as usize, [true; LANES], &mut sums, largest);
        }
        for number in 0..2 {
            for lane in 0..LANES {
                total[number] += (i128::from(sums[number][0][lane]) << BITS) + i128::from(sums[number][1][lane]);
            }
        }
    }
}

/// Energy and virial of the particle at `r` with the particles of a block.
#[inline(always)]
fn count<L: Law, const D: usize, const IMAGE: bool>(
    pairs: &Pairs<'_, L, D>,
    quanta: [[Quantum; 2]; 2],
    (r, species): (&[f64; D], u16),
    other: usize,
    counts: [bool; LANES],
    sums: &mut [[[i64; LANES]; 2]; 2],
    largest: &mut [[i64; LANES]; 2],
) {
    let (_, r_squared) = arrows::<D, IMAGE>(&pairs.image, r, &pairs.blocks.position[other]);
    let mut terms = [[0.0; LANES]; 2];
    for lane in 0..LANES {
        let potential = pairs.law.between(species, pairs.blocks.species[other][lane]);
        let range = potential.cutoff() * potential.cutoff();
        let energy = potential.energy(r_squared[lane]) - if pairs.shifted { potential.energy(range) } else { 0.0 };
        let virial = r_squared[lane] * potential.force_over_distance(r_squared[lane]);
        let within = counts[lane] & (r_squared[lane] < range);
        terms[0][lane] = if within { energy } else { 0.0 };
        terms[1][lane] = if within { virial } else { 0.0 };
    }
    for number in 0..2 {
        keep_largest(&mut largest[number], &terms[number]);
        for lane in 0..LANES {
            let (coarse, left) = quanta[number][0].split(terms[number][lane]);
            sums[number][0][lane] = sums[number][0][lane].wrapping_add(coarse);
            sums[number][1][lane] = sums[number][1][lane].wrapping_add(quanta[number][1].round(left));
        }
    }
}
