//! What pulls at the particles of a lattice, eight numbers at a time, and what is done with it.

use corpuscle_core::Vector;
use corpuscle_core::instructions::prefetch;

use crate::lanes::eight::{Eight, InEights, LANES};

/// `a = (sum_n k_n (r_n - r)) / m`, number by number: whatever the dimension, neighbours are as far apart. The sum begins with the
/// first neighbour.
pub(super) struct Gather<'a, M, S, const N: usize> {
    pub(super) stiffness: [f64; N],
    pub(super) near: [&'a [f64]; N],
    pub(super) own: &'a [f64],
    pub(super) inverse_mass: M,
    /// Where accelerations go.
    pub(super) sink: S,
}

/// What every sum is multiplied by.
pub(super) trait Factor {
    /// Group `g` of them.
    fn group<V: Eight>(&self, g: usize) -> V;
    /// One of them, by its number.
    fn one(&self, n: usize) -> f64;
}

/// The same for all.
pub(super) struct Alike(pub(super) f64);

impl Factor for Alike {
    #[inline(always)]
    fn group<V: Eight>(&self, _: usize) -> V {
        V::splat(self.0)
    }

    #[inline(always)]
    fn one(&self, _: usize) -> f64 {
        self.0
    }
}

/// One for each number.
pub(super) struct Each<'a>(pub(super) &'a [f64]);

impl Factor for Each<'_> {
    #[inline(always)]
    fn group<V: Eight>(&self, g: usize) -> V {
        V::new(*self.0[g..].first_chunk().unwrap())
    }

    #[inline(always)]
    fn one(&self, n: usize) -> f64 {
        self.0[n]
    }
}

/// What takes accelerations.
pub(super) trait Sink {
    /// What it has to tell of them all.
    type Output;

    /// How many it takes.
    fn len(&self) -> usize;
    fn head(&self) -> usize;
    /// Group `g` of them; `doubt` is zero at first.
    fn take<V: Eight>(&mut self, g: usize, a: V, doubt: &mut V);
    /// One of those after the groups, by its number.
    fn take_one(&mut self, n: usize, a: f64);
    /// After the last.
    fn finish(self, doubt: [f64; LANES]) -> Self::Output;
}

impl<M: Factor, S: Sink, const N: usize> InEights for Gather<'_, M, S, N> {
    type Output = S::Output;

    #[inline(always)]
    fn run<V: Eight>(self) -> S::Output {
        let Self { stiffness, near, own, inverse_mass, mut sink } = self;
        let head = sink.head();
        let (mut stiff, mut eights) = ([V::splat(0.0); N], [&[][..]; N]);
        let groups = (own.len() - head) / LANES;
        for n in 0..N {
            (stiff[n], eights[n]) = (V::splat(stiffness[n]), &near[n][head..].as_chunks::<LANES>().0[..groups]);
        }
        let own_eights = &own[head..].as_chunks::<LANES>().0[..groups];
        let mut doubt = V::splat(0.0);
        for last in (0..head).chain(head + groups * LANES..own.len()) {
            let mut a = 0.0;
            for n in 0..N {
                let pull = stiffness[n] * (near[n][last] - own[last]);
                a = if n == 0 { pull } else { a + pull };
            }
            sink.take_one(last, a * inverse_mass.one(last));
        }
        for g in 0..groups {
            let (r, mut a) = (V::new(own_eights[g]), V::splat(0.0));
            for n in 0..N {
                let pull = stiff[n].mul(V::new(eights[n][g]).sub(r));
                a = if n == 0 { pull } else { a.add(pull) };
            }
            sink.take(head + g * LANES, a.mul(inverse_mass.group(head + g * LANES)), &mut doubt);
        }
        sink.finish(doubt.lanes())
    }
}

/// Adds them to others.
pub(super) struct Add<'a>(pub(super) &'a mut [f64]);

impl Sink for Add<'_> {
    type Output = ();

    fn len(&self) -> usize {
        self.0.len()
    }
    #[inline(always)]
    fn head(&self) -> usize {
        self.0.as_ptr().align_offset(64).min(self.0.len())
    }

    #[inline(always)]
    fn take<V: Eight>(&mut self, g: usize, a: V, _: &mut V) {
        let sum = &mut *self.0[g..].first_chunk_mut().unwrap();
        *sum = V::new(*sum).add(a).lanes();
    }

    #[inline(always)]
    fn take_one(&mut self, n: usize, a: f64) {
        self.0[n] += a;
    }

    fn finish(self, _: [f64; LANES]) {}
}

/// `v += a first`, then `v += a second` if there are two kicks; asks for what will soon be needed.
pub(super) struct Kick<'a, const TWO: bool> {
    velocity: &'a mut [f64],
    first: f64,
    second: f64,
    soon: [&'a [f64]; 2],
    /// Sum of velocities: finite only if all of them are. That of groups is kept in registers.
    doubt: f64,
}

impl<'a> Kick<'a, false> {
    pub(super) fn once<const D: usize>(velocity: &'a mut [Vector<D>], kick: f64, soon: [&'a [Vector<D>]; 2]) -> Self {
        Self { velocity: Vector::components_mut(velocity), first: kick, second: 0.0, soon: soon.map(Vector::components), doubt: 0.0 }
    }

    pub(super) fn and(self, second: f64) -> Kick<'a, true> {
        let Self { velocity, first, soon, doubt, .. } = self;
        Kick { velocity, first, second, soon, doubt }
    }
}

impl<const TWO: bool> Sink for Kick<'_, TWO> {
    /// Whether every velocity is finite after the first kick.
    type Output = bool;

    fn len(&self) -> usize {
        self.velocity.len()
    }
    #[inline(always)]
    fn head(&self) -> usize {
        self.velocity.as_ptr().align_offset(64).min(self.velocity.len())
    }

    #[inline(always)]
    fn take<V: Eight>(&mut self, g: usize, a: V, doubt: &mut V) {
        prefetch(self.soon[0], g);
        prefetch(self.soon[1], g);
        let velocity = &mut *self.velocity[g..].first_chunk_mut::<LANES>().unwrap();
        let mut v = V::new(*velocity).add(a.mul(V::splat(self.first)));
        *doubt = doubt.add(v);
        if TWO {
            v = v.add(a.mul(V::splat(self.second)));
        }
        *velocity = v.lanes();
    }

    #[inline(always)]
    fn take_one(&mut self, n: usize, a: f64) {
        let v = &mut self.velocity[n];
        *v += a * self.first;
        self.doubt += *v;
        if TWO {
            *v += a * self.second;
        }
    }

    fn finish(self, doubt: [f64; LANES]) -> bool {
        (doubt.iter().sum::<f64>() + self.doubt).is_finite()
    }
}

/// `r += v drift`, number by number. Tells whether every `r` is finite.
pub(super) struct Drift<'a> {
    pub(super) position: &'a mut [f64],
    pub(super) velocity: &'a [f64],
    pub(super) drift: f64,
}

impl InEights for Drift<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<V: Eight>(self) -> bool {
        let Self { position, velocity, drift } = self;
        let mut doubt = 0.0;
        let head = position.as_ptr().align_offset(64).min(position.len());
        let ((head, position), (head_v, velocity)) = (position.split_at_mut(head), velocity.split_at(head));
        for (r, v) in head.iter_mut().zip(head_v) {
            *r += v * drift;
            doubt += *r;
        }
        let (positions, last_positions) = position.as_chunks_mut::<LANES>();
        let (velocities, last_velocities) = velocity.as_chunks::<LANES>();
        let (by, mut doubts) = (V::splat(drift), V::splat(0.0));
        for (position, velocity) in positions.iter_mut().zip(velocities) {
            let r = V::new(*position).add(V::new(*velocity).mul(by));
            doubts = doubts.add(r);
            *position = r.lanes();
        }
        for (r, v) in last_positions.iter_mut().zip(last_velocities) {
            *r += v * drift;
            doubt += *r;
        }
        (doubts.lanes().iter().sum::<f64>() + doubt).is_finite()
    }
}
