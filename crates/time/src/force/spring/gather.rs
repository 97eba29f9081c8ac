//! What pulls at the particles of a lattice, eight numbers at a time, and what is done with it.

use corpuscle_core::instructions::prefetch;

use crate::lanes::eight::{Eight, InEights, LANES};

/// A vector that begins where a line of the cache does is in one line; those that lie in two take longer.
pub(super) const LINE: usize = 64;

/// `a = (sum_n k_n (r_n - r)) / m`, number by number: whatever the dimension, neighbours are as far apart. The sum begins with the
/// first neighbour.
pub(super) struct Gather<'a, M, A, const N: usize> {
    pub(super) stiffness: [f64; N],
    pub(super) near: [&'a [f64]; N],
    pub(super) own: &'a [f64],
    pub(super) inverse_mass: M,
    /// What accelerations act on.
    pub(super) target: &'a mut [f64],
    pub(super) action: A,
}

/// What every sum is multiplied by.
pub(super) trait Factor {
    /// Those of eight numbers.
    fn eight<V: Eight>(&self, first: usize) -> V;
    /// That of a number.
    fn one(&self, n: usize) -> f64;
}

/// The same for all.
#[derive(Clone, Copy)]
pub(super) struct Alike(pub(super) f64);

impl Factor for Alike {
    #[inline(always)]
    fn eight<V: Eight>(&self, _: usize) -> V {
        V::splat(self.0)
    }

    #[inline(always)]
    fn one(&self, _: usize) -> f64 {
        self.0
    }
}

/// One for each number.
#[derive(Clone, Copy)]
pub(super) struct Each<'a>(pub(super) &'a [f64]);

impl Factor for Each<'_> {
    #[inline(always)]
    fn eight<V: Eight>(&self, first: usize) -> V {
        let eight = &self.0[first..first + LANES];
        V::new(std::array::from_fn(|lane| eight[lane]))
    }

    #[inline(always)]
    fn one(&self, n: usize) -> f64 {
        self.0[n]
    }
}

/// What an acceleration does to a number.
pub(super) trait Action: Copy {
    /// What becomes of `x`, and what is finite if all is well.
    fn act<V: Eight>(self, x: V, a: V) -> [V; 2];
    /// The same for one number.
    fn act_on_one(self, x: f64, a: f64) -> [f64; 2];
    /// Whatever there is to do before eight numbers.
    #[inline(always)]
    fn prepare(self, _first: usize) {}
    /// The same for numbers so much later.
    #[inline(always)]
    #[must_use]
    fn later(self, _by: usize) -> Self {
        self
    }
}

/// Numbers up to the first line of a cache, those in whole lines, and the rest.
#[inline(always)]
fn lines(numbers: &[f64]) -> [usize; 2] {
    let head = numbers.as_ptr().align_offset(LINE).min(numbers.len());
    [head, head + (numbers.len() - head) / LANES * LANES]
}

impl<M: Factor, A: Action, const N: usize> InEights for Gather<'_, M, A, N> {
    /// Whether all is well.
    type Output = bool;

    #[inline(always)]
    fn run<V: Eight>(self) -> bool {
        let Self { stiffness, near, own, inverse_mass, target, action } = self;
        let [head, tail] = lines(target);
        let mut doubt = 0.0;
        for n in (0..head).chain(tail..target.len()) {
            let mut a = 0.0;
            for k in 0..N {
                let pull = stiffness[k] * (near[k][n] - own[n]);
                a = if k == 0 { pull } else { a + pull };
            }
            let [x, seen] = action.act_on_one(target[n], a * inverse_mass.one(n));
            (target[n], doubt) = (x, doubt + seen);
        }
        let targets = target[head..tail].as_chunks_mut::<LANES>().0;
        let groups = targets.len();
        let (mut stiff, mut eights) = ([V::splat(0.0); N], [&[][..]; N]);
        for k in 0..N {
            (stiff[k], eights[k]) = (V::splat(stiffness[k]), &near[k][head..].as_chunks::<LANES>().0[..groups]);
        }
        let own = &own[head..].as_chunks::<LANES>().0[..groups];
        let mut doubts = V::splat(0.0);
        for g in 0..groups {
            let first = head + LANES * g;
            action.prepare(first);
            let (r, mut a) = (V::new(own[g]), V::splat(0.0));
            for k in 0..N {
                let pull = stiff[k].mul(V::new(eights[k][g]).sub(r));
                a = if k == 0 { pull } else { a.add(pull) };
            }
            let [x, seen] = action.act(V::new(targets[g]), a.mul(inverse_mass.eight(first)));
            targets[g] = x.lanes();
            doubts = doubts.add(seen);
        }
        (doubt + doubts.lanes().iter().sum::<f64>()).is_finite()
    }
}

/// Adds it.
#[derive(Clone, Copy)]
pub(super) struct Add;

impl Action for Add {
    #[inline(always)]
    fn act<V: Eight>(self, x: V, a: V) -> [V; 2] {
        [x.add(a), V::splat(0.0)]
    }

    #[inline(always)]
    fn act_on_one(self, x: f64, a: f64) -> [f64; 2] {
        [x + a, 0.0]
    }
}

/// `v += a first`, which is to be finite, then `v += a second` if there are two kicks; asks for what will soon be needed.
#[derive(Clone, Copy)]
pub(super) struct Kick<'a, const TWO: bool> {
    pub(super) first: f64,
    pub(super) second: f64,
    pub(super) soon: Soon<'a>,
}

impl<'a> Kick<'a, false> {
    pub(super) fn one(kick: f64, soon: Soon<'a>) -> Self {
        Self { first: kick, second: 0.0, soon }
    }
}

/// What will soon be needed.
#[derive(Clone, Copy, Default)]
pub(super) struct Soon<'a> {
    pub(super) numbers: [&'a [f64]; 2],
    /// Each line of it is asked for after two to the power of this lines have been kicked.
    pub(super) rarity: u32,
}

impl<const TWO: bool> Action for Kick<'_, TWO> {
    #[inline(always)]
    fn act<V: Eight>(self, v: V, a: V) -> [V; 2] {
        let v = v.add(a.mul(V::splat(self.first)));
        [if TWO { v.add(a.mul(V::splat(self.second))) } else { v }, v]
    }

    #[inline(always)]
    fn act_on_one(self, v: f64, a: f64) -> [f64; 2] {
        let v = v + a * self.first;
        [if TWO { v + a * self.second } else { v }, v]
    }

    #[inline(always)]
    fn prepare(self, first: usize) {
        let Soon { numbers, rarity } = self.soon;
        if first & ((LANES << rarity) - LANES) == 0 {
            prefetch(numbers[0], first >> rarity);
            prefetch(numbers[1], first >> rarity);
        }
    }

    #[inline(always)]
    fn later(self, by: usize) -> Self {
        let Soon { numbers, rarity } = self.soon;
        Self { soon: Soon { numbers: numbers.map(|soon| soon.get(by >> rarity..).unwrap_or(&[])), rarity }, ..self }
    }
}

/// `r += v dt`, number by number.
pub(super) struct Drift<'a> {
    pub(super) position: &'a mut [f64],
    pub(super) velocity: &'a [f64],
    pub(super) dt: f64,
}

impl InEights for Drift<'_> {
    /// Whether every `r` is finite.
    type Output = bool;

    #[inline(always)]
    fn run<V: Eight>(self) -> bool {
        let Self { position, velocity, dt } = self;
        let [head, tail] = lines(position);
        let mut doubt = 0.0;
        for n in (0..head).chain(tail..position.len()) {
            position[n] += velocity[n] * dt;
            doubt += position[n];
        }
        let (eights, mut doubts) = (position[head..tail].as_chunks_mut::<LANES>().0, V::splat(0.0));
        for (r, &v) in eights.iter_mut().zip(velocity[head..tail].as_chunks::<LANES>().0) {
            let moved = V::new(*r).add(V::new(v).mul(V::splat(dt)));
            doubts = doubts.add(moved);
            *r = moved.lanes();
        }
        (doubt + doubts.lanes().iter().sum::<f64>()).is_finite()
    }
}
