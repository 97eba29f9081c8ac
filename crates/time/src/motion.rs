//! Kicks and drifts of whole arrays.

use corpuscle_core::instructions::{Instructions, Kernel};
use corpuscle_core::{Axis, Boundary, Vector};
use rayon::prelude::*;

use crate::lanes::{self, InLanes, Lanes};
use crate::threads::{self, CHUNK};

/// Numbers handled together.
const LANES: usize = 8;

/// `v += a dt`, component by component. Tells whether every result is a finite number.
struct Kick<'a> {
    velocity: &'a mut [f64],
    acceleration: &'a [f64],
    dt: f64,
}

impl Kernel for Kick<'_> {
    type Output = bool;

    #[inline(always)]
    fn run(self) -> bool {
        let (velocities, last_velocities) = self.velocity.as_chunks_mut::<LANES>();
        let (accelerations, last_accelerations) = self.acceleration.as_chunks::<LANES>();
        let mut doubt = Doubt::default();
        for (velocity, acceleration) in velocities.iter_mut().zip(accelerations) {
            let mut v = *velocity; // a copy, so that nothing read can depend on something written
            for lane in 0..LANES {
                v[lane] += acceleration[lane] * self.dt;
            }
            doubt.consider(&v);
            *velocity = v;
        }
        for (v, a) in last_velocities.iter_mut().zip(last_accelerations) {
            *v += a * self.dt;
            doubt.consider(&[*v; LANES]);
        }
        doubt.is_none()
    }
}

/// `v += a owed` if anything is, `v += a kick`, then `r += v drift`, component by component. Tells whether every `v` was a finite
/// number before the second, and whether every `r` is.
struct KickAndDrift<'a, const OWED: bool> {
    position: &'a mut [f64],
    velocity: &'a mut [f64],
    acceleration: &'a [f64],
    owed: f64,
    kick: f64,
    drift: f64,
}

impl<const OWED: bool> Kernel for KickAndDrift<'_, OWED> {
    type Output = [bool; 2];

    #[inline(always)]
    fn run(self) -> [bool; 2] {
        let Self { owed, kick, drift, .. } = self;
        let (positions, last_positions) = self.position.as_chunks_mut::<LANES>();
        let (velocities, last_velocities) = self.velocity.as_chunks_mut::<LANES>();
        let (accelerations, last_accelerations) = self.acceleration.as_chunks::<LANES>();
        let (mut doubt_before, mut doubt) = (Doubt::default(), Doubt::default());
        for ((position, velocity), acceleration) in positions.iter_mut().zip(velocities).zip(accelerations) {
            let (mut r, mut v) = (*position, *velocity);
            if OWED {
                for lane in 0..LANES {
                    v[lane] += acceleration[lane] * owed;
                }
                doubt_before.consider(&v);
            }
            for lane in 0..LANES {
                v[lane] += acceleration[lane] * kick;
                r[lane] += v[lane] * drift;
            }
            doubt.consider(&r);
            (*position, *velocity) = (r, v);
        }
        for ((r, v), a) in last_positions.iter_mut().zip(last_velocities).zip(last_accelerations) {
            if OWED {
                *v += a * owed;
                doubt_before.consider(&[*v; LANES]);
            }
            *v += a * kick;
            *r += *v * drift;
            doubt.consider(&[*r; LANES]);
        }
        [doubt_before.is_none(), doubt.is_none()]
    }
}

/// `v += a dt` for all; tells whether every `v` is finite.
pub(crate) fn kick<const D: usize>(velocity: &mut [Vector<D>], acceleration: &[Vector<D>], dt: f64) -> bool {
    let instructions = Instructions::detect();
    let one = |(velocity, acceleration): (&mut [Vector<D>], &[Vector<D>])| {
        let (velocity, acceleration) = (Vector::components_mut(velocity), Vector::components(acceleration));
        instructions.run(Kick { velocity, acceleration, dt })
    };
    if threads::are_worth_it(velocity.len()) {
        velocity.par_chunks_mut(CHUNK).zip(acceleration.par_chunks(CHUNK)).map(one).reduce(|| true, |a, b| a && b)
    } else {
        one((velocity, acceleration))
    }
}

/// Lengths of kicks and of a drift.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moves {
    /// The kick put off before.
    pub(crate) owed: Option<f64>,
    pub(crate) kick: f64,
    pub(crate) drift: f64,
}

/// A kick and a drift by accelerations that are found on the way.
#[derive(Clone, Copy, Debug)]
pub struct Stride {
    pub(crate) moves: Moves,
    /// The time of the positions it leads to.
    pub(crate) end: f64,
    /// Whether particles that left a periodic box come in again on the other side afterwards.
    pub(crate) confined: bool,
}

/// `v += a owed` if anything is, `v += a kick`, then `r += v drift` for all; tells whether every `v` was finite before the second,
/// and whether every `r` is.
pub(crate) fn kick_and_drift<const D: usize>(
    position: &mut [Vector<D>],
    velocity: &mut [Vector<D>],
    acceleration: &[Vector<D>],
    moves: Moves,
) -> [bool; 2] {
    if threads::are_worth_it(position.len()) {
        let chunks = position.par_chunks_mut(CHUNK).zip(velocity.par_chunks_mut(CHUNK)).zip(acceleration.par_chunks(CHUNK));
        let one = |((position, velocity), acceleration)| moves.apply(position, velocity, acceleration);
        chunks.map(one).reduce(|| [true; 2], both)
    } else {
        moves.apply(position, velocity, acceleration)
    }
}

impl Moves {
    /// For some particles, on this thread; tells what [`kick_and_drift`] does.
    pub(crate) fn apply<const D: usize>(
        self,
        position: &mut [Vector<D>],
        velocity: &mut [Vector<D>],
        acceleration: &[Vector<D>],
    ) -> [bool; 2] {
        let Self { owed, kick, drift } = self;
        let (position, velocity) = (Vector::components_mut(position), Vector::components_mut(velocity));
        let (acceleration, instructions) = (Vector::components(acceleration), Instructions::detect());
        match owed {
            Some(owed) => instructions.run(KickAndDrift::<true> { position, velocity, acceleration, owed, kick, drift }),
            None => instructions.run(KickAndDrift::<false> { position, velocity, acceleration, owed: 0.0, kick, drift }),
        }
    }
}

/// Whether what is true of some particles and of others is true of both.
pub(crate) fn both(one: [bool; 2], other: [bool; 2]) -> [bool; 2] {
    [one[0] && other[0], one[1] && other[1]]
}

/// Brings a position into the primary box and counts the faces it went through.
pub(crate) fn wrap<const D: usize>(boundary: &Boundary<D>, position: &mut Vector<D>, images: &mut [i64; D]) {
    let (r, wrapped) = (*position, boundary.wrap(*position));
    for k in 0..D {
        if wrapped[k] != r[k] {
            images[k] += ((r[k] - wrapped[k]) / (boundary.upper[k] - boundary.lower[k])).round() as i64;
        }
    }
    *position = wrapped;
}

/// Brings all positions into the primary box.
pub(crate) fn wrap_all<const D: usize>(boundary: &Boundary<D>, position: &mut [Vector<D>], images: &mut [[i64; D]]) {
    /// Particles looked at together: most of the time none of them is outside.
    const FEW: usize = 64;
    let instructions = Instructions::detect();
    let inside = Inside::new(boundary);
    let one = |(position, images): (&mut [Vector<D>], &mut [[i64; D]])| {
        for (position, images) in position.chunks_mut(FEW).zip(images.chunks_mut(FEW)) {
            if !lanes::run(instructions, All(&inside, position)) {
                for (r, images) in position.iter_mut().zip(images) {
                    if (0..D).any(|k| inside.is_outside(k, r[k])) {
                        wrap(boundary, r, images);
                    }
                }
            }
        }
    };
    if threads::are_worth_it(position.len()) {
        position.par_chunks_mut(CHUNK).zip(images.par_chunks_mut(CHUNK)).for_each(one);
    } else {
        one((position, images));
    }
}

/// The primary box: the least and the largest coordinate within, those of all numbers along axes that are not periodic.
pub(crate) struct Inside<const D: usize> {
    pub(crate) least: [f64; D],
    pub(crate) largest: [f64; D],
}

impl<const D: usize> Inside<D> {
    pub(crate) fn new(boundary: &Boundary<D>) -> Self {
        let periodic = |k: usize| boundary.axes[k] == Axis::Periodic;
        Self {
            least: std::array::from_fn(|k| if periodic(k) { boundary.lower[k] } else { f64::MIN }),
            largest: std::array::from_fn(|k| if periodic(k) { boundary.upper[k].next_down() } else { f64::MAX }),
        }
    }

    /// All of space.
    pub(crate) fn everywhere() -> Self {
        Self { least: [f64::MIN; D], largest: [f64::MAX; D] }
    }

    #[inline(always)]
    pub(crate) fn is_outside(&self, k: usize, x: f64) -> bool {
        x < self.least[k] || self.largest[k] < x
    }
}

/// Whether all of these positions are inside.
struct All<'a, const D: usize>(&'a Inside<D>, &'a [Vector<D>]);

impl<const D: usize> InLanes for All<'_, D> {
    type Output = bool;

    #[inline(always)]
    fn run<V: Lanes>(self) -> bool {
        let Self(inside, positions) = self;
        let (fours, rest) = positions.as_chunks::<{ lanes::LANES }>();
        // Four positions are D vectors: component n of them is along axis n modulo D.
        let mut bounds = [(V::splat(0.0), V::splat(0.0)); D];
        for n in 0..D {
            let axis: [usize; lanes::LANES] = std::array::from_fn(|lane| (n * lanes::LANES + lane) % D);
            bounds[n] = (V::new(axis.map(|k| inside.least[k])), V::new(axis.map(|k| inside.largest[k])));
        }
        let mut outside = false;
        for four in fours {
            let (vectors, _) = Vector::components(four).as_chunks::<{ lanes::LANES }>();
            for n in 0..D {
                let x = V::new(vectors[n]);
                outside |= x.any_less(bounds[n].0) | bounds[n].1.any_less(x);
            }
        }
        for r in rest {
            for k in 0..D {
                outside |= inside.is_outside(k, r[k]);
            }
        }
        !outside
    }
}

/// Sums of products with zero: they stay zero unless a factor is infinite or no number.
#[derive(Default)]
struct Doubt([f64; LANES]);

impl Doubt {
    #[inline(always)]
    fn consider(&mut self, numbers: &[f64; LANES]) {
        for lane in 0..LANES {
            self.0[lane] += numbers[lane] * 0.0;
        }
    }

    #[inline(always)]
    fn is_none(&self) -> bool {
        self.0.iter().sum::<f64>() == 0.0
    }
}
