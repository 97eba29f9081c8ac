//! What pulls at the particles of a lattice, eight numbers at a time, and what is done with it.

use corpuscle_core::Vector;
use corpuscle_core::instructions::prefetch;

use crate::lanes::eight::{Eight, InEights, LANES};
use crate::motion::Moves;

/// `a = (sum_n k_n (r_n - r)) / m`, number by number: whatever the dimension, neighbours are as far apart. The sum begins with the
/// first neighbour.
pub(super) struct Gather<'a, S, const N: usize> {
    pub(super) stiffness: [f64; N],
    pub(super) near: [&'a [f64]; N],
    pub(super) own: &'a [f64],
    pub(super) inverse_mass: &'a [f64],
    /// Where accelerations go.
    pub(super) sink: S,
}

/// What takes accelerations.
pub(super) trait Sink {
    /// What it has to tell of them all.
    type Output;

    /// How many it takes.
    fn len(&self) -> usize;
    /// Group `g` of them, and where the particles are; `doubts` are zero at first.
    fn take<V: Eight>(&mut self, g: usize, r: V, a: V, doubts: &mut [V; 2]);
    /// One of those after the groups, by its number.
    fn take_one(&mut self, n: usize, r: f64, a: f64);
    /// After the last.
    fn finish(self, doubts: [[f64; LANES]; 2]) -> Self::Output;
}

impl<S: Sink, const N: usize> InEights for Gather<'_, S, N> {
    type Output = S::Output;

    #[inline(always)]
    fn run<V: Eight>(self) -> S::Output {
        let Self { stiffness, near, own, inverse_mass, mut sink } = self;
        let groups = own.len() / LANES;
        let (mut stiff, mut eights) = ([V::splat(0.0); N], [&[][..]; N]);
        for n in 0..N {
            (stiff[n], eights[n]) = (V::splat(stiffness[n]), &near[n].as_chunks::<LANES>().0[..groups]);
        }
        let (own_eights, inverse_masses) = (&own.as_chunks::<LANES>().0[..groups], &inverse_mass.as_chunks::<LANES>().0[..groups]);
        let mut doubts = [V::splat(0.0); 2];
        for g in 0..groups {
            let (r, mut a) = (V::new(own_eights[g]), V::splat(0.0));
            for n in 0..N {
                let pull = stiff[n].mul(V::new(eights[n][g]).sub(r));
                a = if n == 0 { pull } else { a.add(pull) };
            }
            sink.take(g, r, a.mul(V::new(inverse_masses[g])), &mut doubts);
        }
        for last in groups * LANES..own.len() {
            let mut a = 0.0;
            for n in 0..N {
                let pull = stiffness[n] * (near[n][last] - own[last]);
                a = if n == 0 { pull } else { a + pull };
            }
            sink.take_one(last, own[last], a * inverse_mass[last]);
        }
        sink.finish(doubts.map(V::lanes))
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
    fn take<V: Eight>(&mut self, g: usize, _: V, a: V, _: &mut [V; 2]) {
        let sum = &mut self.0.as_chunks_mut::<LANES>().0[g];
        *sum = V::new(*sum).add(a).lanes();
    }

    #[inline(always)]
    fn take_one(&mut self, n: usize, _: f64, a: f64) {
        self.0[n] += a;
    }

    fn finish(self, _: [[f64; LANES]; 2]) {}
}

/// Kicks and drifts, as [`Moves::apply`], and asks for what will soon be needed.
pub(super) struct Move<'a, const OWED: bool> {
    /// Where positions go.
    position: &'a mut [f64],
    velocity: &'a mut [f64],
    soon: [&'a [f64]; 2],
    owed: f64,
    kick: f64,
    drift: f64,
    /// Sums of velocities and of positions: finite only if all of them are. Those of groups are kept in registers.
    doubts: [f64; 2],
}

impl<'a, const OWED: bool> Move<'a, OWED> {
    pub(super) fn new<const D: usize>(
        position: &'a mut [Vector<D>],
        velocity: &'a mut [Vector<D>],
        soon: [&'a [Vector<D>]; 2],
        moves: Moves,
    ) -> Self {
        let Moves { owed, kick, drift } = moves;
        let (position, velocity) = (Vector::components_mut(position), Vector::components_mut(velocity));
        Self { position, velocity, soon: soon.map(Vector::components), owed: owed.unwrap_or(0.0), kick, drift, doubts: [0.0; 2] }
    }
}

impl<const OWED: bool> Sink for Move<'_, OWED> {
    /// Whether every velocity was finite before the kick that was not owed, and whether every position is.
    type Output = [bool; 2];

    fn len(&self) -> usize {
        self.position.len()
    }

    #[inline(always)]
    fn take<V: Eight>(&mut self, g: usize, r: V, a: V, doubts: &mut [V; 2]) {
        prefetch(self.soon[0], LANES * g);
        prefetch(self.soon[1], LANES * g);
        let velocity = &mut self.velocity.as_chunks_mut::<LANES>().0[g];
        let mut v = V::new(*velocity);
        if OWED {
            v = v.add(a.mul(V::splat(self.owed)));
            doubts[0] = doubts[0].add(v);
        }
        v = v.add(a.mul(V::splat(self.kick)));
        let r = r.add(v.mul(V::splat(self.drift)));
        doubts[1] = doubts[1].add(r);
        *velocity = v.lanes();
        self.position.as_chunks_mut::<LANES>().0[g] = r.lanes();
    }

    #[inline(always)]
    fn take_one(&mut self, n: usize, r: f64, a: f64) {
        let v = &mut self.velocity[n];
        if OWED {
            *v += a * self.owed;
            self.doubts[0] += *v;
        }
        *v += a * self.kick;
        self.position[n] = r + *v * self.drift;
        self.doubts[1] += self.position[n];
    }

    fn finish(self, doubts: [[f64; LANES]; 2]) -> [bool; 2] {
        [0, 1].map(|when| (doubts[when].iter().sum::<f64>() + self.doubts[when]).is_finite())
    }
}
