//! The sums over pairs, the four particles of a block against one other at a time; and those of forces.

use crate::exact::{BITS, Quantum};
use crate::image::{NearestImage, NearestImages};
use crate::lanes::{InLanes, LANES, Lanes};
use crate::neighbours::{ALL, Blocks, Image, NONE, Near, Rows, column, norm_squared};

use super::PairPotential;

/// Which potential acts between two species.
pub(super) trait Law: Copy + Sync {
    type Potential: PairPotential;
    /// Whether species do not matter.
    const UNIFORM: bool;

    fn between(self, species: u16, other: u16) -> Self::Potential;
}

/// The same one between all.
#[derive(Clone, Copy)]
pub(super) struct Uniform<P>(pub(super) P);

impl<P: PairPotential> Law for Uniform<P> {
    type Potential = P;
    const UNIFORM: bool = true;

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
    const UNIFORM: bool = false;

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
    pub(super) rows: &'a Rows,
}

/// How many particles a block meets at once: a processor looks only so far ahead, and so it has something to do while it waits
/// for a quotient.
const TOGETHER: usize = 4;

/// The particles of a block, each against `N` others.
pub(super) struct Meeting<V, L, const D: usize, const N: usize> {
    law: L,
    own: [u16; LANES],
    other: [[u16; LANES]; N],
    /// From the others to the block's own.
    arrow: [[V; D]; N],
    pub(super) r_squared: [V; N],
}

impl<V: Lanes, L: Law, const D: usize, const N: usize> Meeting<V, L, D, N> {
    #[inline(always)]
    fn new<const IMAGE: usize>(law: L, image: &NearestImages<V, D>, block: &Block<V, D>, there: &[[V; D]; N]) -> Self {
        let mut meeting =
            Self { law, own: block.species, other: [block.species; N], arrow: [block.r; N], r_squared: [block.r[0]; N] };
        for n in 0..N {
            for k in 0..D {
                meeting.arrow[n][k] = block.r[k].sub(there[n][k]);
                if IMAGE == ALL || IMAGE == k {
                    meeting.arrow[n][k] = image.component(k, meeting.arrow[n][k]);
                }
            }
            meeting.r_squared[n] = norm_squared(&meeting.arrow[n]);
        }
        meeting
    }

    #[inline(always)]
    fn potential(&self, n: usize, lane: usize) -> L::Potential {
        self.law.between(self.own[lane], self.other[n][lane])
    }

    /// `U'(r)/r` of four pairs, with the sign of a repulsion; zero beyond the range.
    #[inline(always)]
    pub(super) fn force_over_distance(&self, n: usize) -> V {
        let squares = self.r_squared[n].lanes();
        let (mut force, mut range) = ([0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            let potential = self.potential(n, lane);
            force[lane] = potential.force_over_distance(squares[lane]);
            range[lane] = potential.cutoff() * potential.cutoff();
        }
        V::new(force).where_less(self.r_squared[n], V::new(range))
    }

    /// `U(r)` of four pairs, less its value at the range if `shifted`; zero beyond the range.
    #[inline(always)]
    pub(super) fn energy(&self, n: usize, shifted: bool) -> V {
        let squares = self.r_squared[n].lanes();
        let (mut energy, mut range) = ([0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            let potential = self.potential(n, lane);
            range[lane] = potential.cutoff() * potential.cutoff();
            energy[lane] = potential.energy(squares[lane]) - if shifted { potential.energy(range[lane]) } else { 0.0 };
        }
        V::new(energy).where_less(self.r_squared[n], V::new(range))
    }
}

/// A sum over the pairs of a block.
pub(super) trait Sum<V: Lanes, const D: usize> {
    /// Whether speed matters enough for code of their own for pairs in need of different images. What they do not need changes
    /// no bit.
    const HOT: bool;

    fn add<L: Law, const N: usize>(&mut self, meeting: &Meeting<V, L, D, N>);
}

/// The particles of a block.
struct Block<V, const D: usize> {
    r: [V; D],
    species: [u16; LANES],
}

impl<V: Lanes, const D: usize> Block<V, D> {
    #[inline(always)]
    fn new(blocks: &Blocks<D>, number: usize) -> Self {
        let places = number * LANES..(number + 1) * LANES;
        let (position, kinds) = (&blocks.position[places.clone()], &blocks.species[places]);
        let mut r = [V::splat(0.0); D];
        for k in 0..D {
            r[k] = column::<V, D>(position, k);
        }
        Self { r, species: [kinds[0], kinds[1], kinds[2], kinds[3]] }
    }

    /// The block against particles near it.
    #[inline(always)]
    fn meet<L: Law, S: Sum<V, D>, const IMAGE: usize>(
        &self,
        pairs: &Pairs<'_, L, D>,
        image: &NearestImages<V, D>,
        places: &[u32],
        sum: &mut S,
    ) {
        let (groups, rest) = if S::HOT { places.as_chunks::<TOGETHER>() } else { (&[][..], places) };
        for group in groups {
            self.meet_group::<L, S, IMAGE, TOGETHER>(pairs, image, group, sum);
        }
        for &place in rest {
            self.meet_group::<L, S, IMAGE, 1>(pairs, image, &[place], sum);
        }
    }

    #[inline(always)]
    fn meet_group<L: Law, S: Sum<V, D>, const IMAGE: usize, const N: usize>(
        &self,
        pairs: &Pairs<'_, L, D>,
        image: &NearestImages<V, D>,
        places: &[u32; N],
        sum: &mut S,
    ) {
        let mut there = [self.r; N];
        for n in 0..N {
            let position = &pairs.blocks.position[places[n] as usize];
            for k in 0..D {
                there[n][k] = V::splat(position[k]);
            }
        }
        let mut meeting = Meeting::new::<IMAGE>(pairs.law, image, self, &there);
        if !L::UNIFORM {
            for n in 0..N {
                meeting.other[n] = [pairs.blocks.species[places[n] as usize]; LANES];
            }
        }
        sum.add(&meeting);
    }

    /// Its particles against each other: each against the next, the one after that, and so on, counted round.
    #[inline(always)]
    fn meet_own<L: Law, const IMAGE: usize>(&self, law: L, image: &NearestImages<V, D>, sum: &mut impl Sum<V, D>) {
        let mut there = [self.r; LANES - 1];
        for k in 0..D {
            there[0][k] = self.r[k].rotated::<1>();
            there[1][k] = self.r[k].rotated::<2>();
            there[2][k] = self.r[k].rotated::<3>();
        }
        let mut meeting = Meeting::new::<IMAGE>(law, image, self, &there);
        for n in 0..LANES - 1 {
            for lane in 0..LANES {
                meeting.other[n][lane] = self.species[(lane + n + 1) % LANES];
            }
            for k in 0..D {
                // Where the block has no particle, the arrow would be no number, even times nothing.
                meeting.arrow[n][k] = meeting.arrow[n][k].where_less(meeting.r_squared[n], V::splat(f64::INFINITY));
            }
        }
        sum.add(&meeting);
    }
}

/// How many times four pairs [`add_up`] counts in a row.
pub(super) fn terms(near: &Near<'_>) -> i64 {
    (LANES - 1 + near.count) as i64
}

/// Adds all pairs of a block to a sum.
#[inline(always)]
pub(super) fn add_up<V: Lanes, L: Law, S: Sum<V, D>, const D: usize>(
    pairs: &Pairs<'_, L, D>,
    image: &NearestImages<V, D>,
    block: usize,
    near: &Near<'_>,
    sum: &mut S,
) {
    let block = Block::<V, D>::new(pairs.blocks, block);
    match near.own {
        Image::None if S::HOT => block.meet_own::<L, NONE>(pairs.law, image, sum),
        _ => block.meet_own::<L, ALL>(pairs.law, image, sum),
    }
    for (needed, places) in near.segments() {
        match needed {
            Image::None if S::HOT => block.meet::<L, S, NONE>(pairs, image, places, sum),
            Image::Along(0) if S::HOT && D > 1 => block.meet::<L, S, 0>(pairs, image, places, sum),
            Image::Along(1) if S::HOT && D > 1 => block.meet::<L, S, 1>(pairs, image, places, sum),
            Image::Along(2) if S::HOT && D > 2 => block.meet::<L, S, 2>(pairs, image, places, sum),
            _ => block.meet::<L, S, ALL>(pairs, image, places, sum),
        }
    }
}

/// Finds the forces on the particles of one block after another, and the largest `|U'(r)/r|`.
pub(super) struct Finder<'a, V: Lanes, L, const D: usize, const LEVELS: usize> {
    pairs: &'a Pairs<'a, L, D>,
    image: NearestImages<V, D>,
    quanta: [Quantum; 2],
    magic: [V; 2],
    unit: f64,
    most: V::Integers,
}

impl<'a, V: Lanes, L: Law, const D: usize, const LEVELS: usize> Finder<'a, V, L, D, LEVELS> {
    /// Forces are rounded to the first quantum; on a second level, what that leaves to the second.
    #[inline(always)]
    pub(super) fn new(pairs: &'a Pairs<'a, L, D>, quanta: [Quantum; 2]) -> Self {
        let magic = [V::splat(quanta[0].magic()), V::splat(quanta[1].magic())];
        Self { pairs, image: pairs.image.in_lanes(), quanta, magic, unit: quanta[LEVELS - 1].unit(), most: V::zeros() }
    }

    /// The components of the forces.
    #[inline(always)]
    pub(super) fn forces(&mut self, block: usize, near: &Near<'_>) -> [V; D] {
        let mut sum = Forces::<V, D, LEVELS> { magic: self.magic, bits: [[V::zeros(); D]; LEVELS], most: self.most };
        add_up(self.pairs, &self.image, block, near, &mut sum);
        self.most = sum.most;
        let terms = terms(near);
        let bias = self.quanta.map(|quantum| quantum.bias(terms));
        let mut forces = [V::splat(self.unit); D];
        for k in 0..D {
            let numbers = if LEVELS == 1 {
                V::numbers(sum.bits[0][k], bias[0])
            } else {
                let (coarse, fine) = (V::integers(sum.bits[0][k]), V::integers(sum.bits[LEVELS - 1][k]));
                V::new(std::array::from_fn(|lane| {
                    let coarse = i128::from(coarse[lane].wrapping_sub(bias[0]));
                    ((coarse << BITS) + i128::from(fine[lane].wrapping_sub(bias[1]))) as f64
                }))
            };
            forces[k] = forces[k].mul(numbers);
        }
        forces
    }

    /// The largest `|U'(r)/r|` so far.
    #[inline(always)]
    pub(super) fn largest(&self) -> f64 {
        largest_of(V::integers(self.most))
    }
}

/// Force on each particle of a block, as sums of bits.
struct Forces<V: Lanes, const D: usize, const LEVELS: usize> {
    magic: [V; 2],
    bits: [[V::Integers; D]; LEVELS],
    most: V::Integers,
}

impl<V: Lanes, const D: usize, const LEVELS: usize> Sum<V, D> for Forces<V, D, LEVELS> {
    const HOT: bool = LEVELS == 1;

    #[inline(always)]
    fn add<L: Law, const N: usize>(&mut self, meeting: &Meeting<V, L, D, N>) {
        let mut scale = [V::splat(0.0); N];
        for n in 0..N {
            scale[n] = meeting.force_over_distance(n);
        }
        for n in 0..N {
            self.most = scale[n].larger_bits(self.most);
            for k in 0..D {
                let mut left = meeting.arrow[n][k].mul(scale[n]);
                for level in 0..LEVELS {
                    let shifted = left.add(self.magic[level]);
                    self.bits[level][k] = shifted.add_bits(self.bits[level][k]);
                    left = left.sub(shifted.sub(self.magic[level]));
                }
            }
        }
    }
}

/// Finds the force on every place of a share, and the largest `|U'(r)/r|`.
pub(super) struct AddForces<'a, L, const D: usize, const LEVELS: usize> {
    pub(super) pairs: Pairs<'a, L, D>,
    /// See [`Finder::new`].
    pub(super) quanta: [Quantum; 2],
    pub(super) force: &'a mut [[f64; D]],
}

impl<L: Law, const D: usize, const LEVELS: usize> InLanes for AddForces<'_, L, D, LEVELS> {
    type Output = f64;

    #[inline(always)]
    fn run<V: Lanes>(self) -> f64 {
        let Self { pairs, quanta, force } = self;
        let mut finder = Finder::<V, L, D, LEVELS>::new(&pairs, quanta);
        let rows = (pairs.rows.first..).zip(pairs.rows.iter());
        for ((block, near), force) in rows.zip(force.chunks_exact_mut(LANES)) {
            let found = finder.forces(block, &near).map(V::lanes);
            for k in 0..D {
                for lane in 0..LANES {
                    force[lane][k] = found[k][lane];
                }
            }
        }
        finder.largest()
    }
}

pub(super) fn largest_of(bits: [i64; LANES]) -> f64 {
    f64::from_bits(bits.into_iter().max().unwrap_or(0) as u64)
}
