//! The search for the earliest collisions of one particle among candidates: the kernel of the engine.
#![allow(clippy::inline_always, reason = "vector instructions are used only where everything ends up in one function")]

use corpuscle_core::Vector;

use crate::lanes::{LANES, Lanes, Plain};
use crate::law::Law;
use crate::motion::Flight;

/// A particle in one of its periodic images: where it is stored, and the number of the image.
///
/// Images are numbered in base three, a digit an axis: 0 is one box down, 1 the box itself, 2 one box up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub(crate) struct Neighbour(u32);

const SLOT_BITS: u32 = 27;

impl Neighbour {
    /// No neighbour at all.
    pub(crate) const NONE: Self = Self(u32::MAX);
    /// Particles an engine can hold.
    pub(crate) const LIMIT: usize = 1 << SLOT_BITS;

    #[inline]
    pub(crate) fn new(slot: u32, image: u8) -> Self {
        Self(slot | u32::from(image) << SLOT_BITS)
    }
    /// As a word: how candidates are stored.
    #[inline]
    pub(crate) fn word(self) -> u32 {
        self.0
    }
    #[inline]
    pub(crate) fn from_word(word: u32) -> Self {
        Self(word)
    }
    #[inline]
    pub(crate) fn slot(self) -> usize {
        (self.0 & ((1 << SLOT_BITS) - 1)) as usize
    }
    #[inline]
    pub(crate) fn image(self) -> usize {
        (self.0 >> SLOT_BITS) as usize
    }
}

/// The number of the box itself.
#[inline]
pub(crate) const fn home<const D: usize>() -> u8 {
    (3u8.pow(D as u32) - 1) / 2
}

/// What lies the same way in the other direction: if `b` is met by `a` in this image, `a` is met by `b` in the opposite.
#[inline]
pub(crate) const fn opposite<const D: usize>(image: u8) -> u8 {
    2 * home::<D>() - image
}

/// The shifts of all images, by number.
#[derive(Clone, Debug)]
pub(crate) struct Images<const D: usize>(pub(crate) [Vector<D>; 32]);

impl<const D: usize> Images<D> {
    pub(crate) fn new(extent: Vector<D>) -> Self {
        Self(std::array::from_fn(|number| {
            Vector::from_fn(|k| {
                let turns = (number / 3usize.pow(k as u32) % 3) as f64 - 1.0;
                // Not -0.0, which would show in the sign of a zero.
                if turns == 0.0 { 0.0 } else { turns * extent[k] }
            })
        }))
    }
    #[inline]
    pub(crate) fn shift(&self, neighbour: Neighbour) -> Vector<D> {
        self.0[neighbour.image() & 31]
    }
}

/// Two particles that are going to touch, seen from one of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Meet {
    pub(crate) time: f64,
    pub(crate) neighbour: Neighbour,
}

impl Meet {
    pub(crate) const NEVER: Self = Self { time: f64::INFINITY, neighbour: Neighbour::NONE };
}

/// What a search needs to know besides the candidates.
#[derive(Clone, Copy)]
pub(crate) struct View<'a, const D: usize> {
    pub(crate) flights: &'a [Flight<D>],
    pub(crate) images: &'a Images<D>,
    pub(crate) field: Vector<D>,
}

/// The instructions to use, asked once.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Instructions {
    #[cfg(target_arch = "x86_64")]
    avx2: bool,
}

impl Instructions {
    pub(crate) fn of_this_processor() -> Self {
        Self {
            #[cfg(target_arch = "x86_64")]
            avx2: corpuscle_core::instructions::Instructions::detect().has_avx2(),
        }
    }

    /// Only those every machine of the kind has: for tests.
    #[cfg(test)]
    pub(crate) fn plain() -> Self {
        Self {
            #[cfg(target_arch = "x86_64")]
            avx2: false,
        }
    }
}

impl<const D: usize> View<'_, D> {
    /// When `me` touches another particle: never is infinity or NaN.
    ///
    /// The states are compared at the later of the two own times. Every operation is odd under exchange of the two
    /// particles, so the time is the same bits whichever of them is searched for, and the same as that of
    /// [`earliest`](Self::earliest).
    pub(crate) fn contact<L: Law>(&self, me: &Flight<D>, other: Neighbour) -> f64 {
        let one = [other; LANES];
        self.approach::<Plain, L, false, true>(&Me::new(me), &one).contact().lanes()[0]
    }

    /// The earliest collision of `me` among candidates (words), whose number is a multiple of [`LANES`]; and whether more
    /// come at exactly the same time, in which case any of them may be the one.
    ///
    /// `FRESH`: `me` is at a time not earlier than that of any candidate. `images`: some candidates are periodic images.
    #[inline]
    pub(crate) fn earliest<L: Law, const FRESH: bool>(
        &self,
        instructions: Instructions,
        me: &Flight<D>,
        candidates: &[u32],
        images: bool,
    ) -> (Meet, bool) {
        #[cfg(target_arch = "x86_64")]
        if instructions.avx2 {
            #[allow(unsafe_code, reason = "entry to the vector kernel")]
            // SAFETY: the processor has AVX2.
            return unsafe {
                if images {
                    avx2::<D, L, FRESH, true>(*self, me, candidates)
                } else {
                    avx2::<D, L, FRESH, false>(*self, me, candidates)
                }
            };
        }
        let _ = instructions;
        if images {
            self.scan::<Plain, L, FRESH, true>(me, candidates)
        } else {
            self.scan::<Plain, L, FRESH, false>(me, candidates)
        }
    }

    #[inline(always)]
    fn scan<V: Lanes, L: Law, const FRESH: bool, const IMAGES: bool>(&self, me: &Flight<D>, candidates: &[u32]) -> (Meet, bool) {
        let me = Me::<V, D>::new(me);
        let (mut best, mut tied) = (Meet::NEVER, false);
        for part in candidates.chunks(4 * LANES) {
            // The number of blocks is known to the compiler, so that everything stays in registers.
            let (time, which) = match part.len() / LANES {
                1 => self.blocks::<V, L, FRESH, IMAGES, 1>(&me, part),
                2 => self.blocks::<V, L, FRESH, IMAGES, 2>(&me, part),
                3 => self.blocks::<V, L, FRESH, IMAGES, 3>(&me, part),
                _ => self.blocks::<V, L, FRESH, IMAGES, 4>(&me, part),
            };
            if time > best.time || time == f64::INFINITY {
                continue;
            }
            tied = time == best.time || which & (which - 1) != 0;
            best = Meet { time, neighbour: Neighbour::from_word(part[which.trailing_zeros() as usize % part.len()]) };
        }
        (best, tied)
    }

    /// The earliest collision among `N` blocks of candidates, and which of them it is: a bit for each.
    ///
    /// First all approaches, then all times: so the long chain from square root to division is paid once, not for each
    /// block, since a processor looks only so far ahead.
    #[inline(always)]
    fn blocks<V: Lanes, L: Law, const FRESH: bool, const IMAGES: bool, const N: usize>(
        &self,
        me: &Me<V, D>,
        candidates: &[u32],
    ) -> (f64, u32) {
        let blocks = candidates.as_chunks::<LANES>().0;
        // Loops, not closures: those are compiled as functions of their own, without vector instructions.
        let nothing = V::splat(0.0);
        let mut approaches = [Approach { reference: nothing, b: nothing, c: nothing, disc: nothing }; N];
        for (approach, block) in approaches.iter_mut().zip(blocks) {
            *approach = self.approach::<V, L, FRESH, IMAGES>(me, &block.map(Neighbour::from_word));
        }
        let (mut times, mut least) = ([nothing; N], V::splat(f64::INFINITY));
        for (time, approach) in times.iter_mut().zip(&approaches) {
            *time = approach.contact();
            least = time.min(least);
        }
        let time = least.least();
        let mut which = 0;
        for (number, block) in times.iter().enumerate() {
            which |= V::bits(block.equal(V::splat(time))) << (LANES * number);
        }
        (time, which)
    }

    /// How `me` approaches each of four others.
    ///
    /// With the distance `r` and relative velocity `v` at the later own time, `b = r.v`, `c = r.r - s^2`,
    /// `disc = b^2 - v.v c`, contact comes after `c / (-b + sqrt(disc))` if `b < 0` and `disc >= 0`: the smaller root, in
    /// the form without cancellation. Spheres that overlap by rounding touch at once while they approach, and never while
    /// they recede (Bannerman, Strobl, Formella, Pöschel, Comput. Part. Mech. 1, 191 (2014),
    /// doi:10.1007/s40571-014-0021-8). In a field the relative motion is the same. Points never touch.
    #[inline(always)]
    fn approach<V: Lanes, L: Law, const FRESH: bool, const IMAGES: bool>(
        &self,
        me: &Me<V, D>,
        four: &[Neighbour; LANES],
    ) -> Approach<V> {
        let flights = four.map(|neighbour| &self.flights[neighbour.slot()]);
        // Position, time, velocity, radius.
        let mut numbers = [[V::splat(0.0); 2]; 4];
        for (pair, columns) in numbers.iter_mut().enumerate().take(D + 1) {
            *columns = V::columns(flights, pair);
        }
        let number = |index: usize| numbers[index / 2][index % 2];
        let own_time = number(D);
        let reference = if FRESH { me.time } else { me.time.max(own_time) };
        let (mine, its) = (reference.sub(me.time), reference.sub(own_time));
        let half = V::splat(0.5);
        let (fall_mine, fall_its) = (half.mul(mine).mul(mine), half.mul(its).mul(its));
        let zero = V::splat(0.0);
        let (mut b, mut rr, mut vv) = (zero, zero, zero);
        for k in 0..D {
            let g = V::splat(self.field[k]);
            let (mut r1, mut r2) = (me.position[k], number(k).add(number(D + 1 + k).mul(its)));
            let mut v = number(D + 1 + k).sub(me.velocity[k]);
            if !FRESH {
                r1 = r1.add(me.velocity[k].mul(mine));
            }
            if L::FIELD {
                r1 = r1.add(g.mul(fall_mine));
                r2 = r2.add(g.mul(fall_its));
                v = number(D + 1 + k).add(g.mul(its)).sub(me.velocity[k].add(g.mul(mine)));
            }
            let mut r = r2.sub(r1);
            if IMAGES {
                r = r.add(V::new(four.map(|neighbour| self.images.shift(neighbour)[k])));
            }
            if k == 0 {
                (b, rr, vv) = (r.mul(v), r.mul(r), v.mul(v));
            } else {
                (b, rr, vv) = (b.add(r.mul(v)), rr.add(r.mul(r)), vv.add(v.mul(v)));
            }
        }
        let s = me.radius.add(number(2 * D + 1));
        let c = rr.sub(s.mul(s));
        let disc = b.mul(b).sub(vv.mul(c));
        // Points never touch.
        let b = V::select(zero.less(s), b, zero);
        Approach { reference, b, c, disc }
    }
}

/// With the distance `r` and the relative velocity `v` at the time `reference`: `b = r.v`, `c = r.r - s^2`,
/// `disc = b^2 - v.v c`.
#[derive(Clone, Copy)]
struct Approach<V> {
    reference: V,
    b: V,
    c: V,
    disc: V,
}

impl<V: Lanes> Approach<V> {
    /// When they touch: never is infinity or NaN.
    #[inline(always)]
    fn contact(&self) -> V {
        let Self { reference, b, c, disc } = *self;
        let zero = V::splat(0.0);
        let delay = V::select(zero.less(c), c.div(disc.sqrt().sub(b)), zero);
        V::select(b.less(zero), reference.add(delay), V::splat(f64::INFINITY))
    }
}

/// The particle searched for, in every lane.
struct Me<V, const D: usize> {
    position: [V; D],
    velocity: [V; D],
    time: V,
    radius: V,
}

impl<V: Lanes, const D: usize> Me<V, D> {
    #[inline(always)]
    fn new(me: &Flight<D>) -> Self {
        let (mut position, mut velocity) = ([V::splat(0.0); D], [V::splat(0.0); D]);
        for k in 0..D {
            (position[k], velocity[k]) = (V::splat(me.position[k]), V::splat(me.velocity[k]));
        }
        Self { position, velocity, time: V::splat(me.time), radius: V::splat(me.radius) }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn avx2<const D: usize, L: Law, const FRESH: bool, const IMAGES: bool>(
    view: View<'_, D>,
    me: &Flight<D>,
    candidates: &[u32],
) -> (Meet, bool) {
    view.scan::<crate::lanes::Avx2, L, FRESH, IMAGES>(me, candidates)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::{Free, Hard, InField};
    use corpuscle_core::Random;

    /// Random flights and candidates, with images, in a field and without, many of them at exactly the same place in time.
    fn compare<const D: usize, L: Law>(random: &mut Random) {
        let flights: Vec<Flight<D>> = (0..40)
            .map(|_| Flight {
                position: Vector::from_fn(|_| 4.0 * random.uniform()),
                time: 0.1 * random.uniform(),
                velocity: Vector::from_fn(|_| random.normal()),
                radius: 0.5 * random.uniform(),
            })
            .collect();
        let images = Images::new(Vector::splat(4.0));
        let view = View { flights: &flights, images: &images, field: Vector::splat(0.3) };
        let candidates: Vec<u32> = (0..LANES as u32 * (1 + random.below(12)))
            .map(|_| Neighbour::new(random.below(40), random.below(3u32.pow(D as u32)) as u8).word())
            .collect();
        for me in &flights {
            let fast = view.earliest::<L, false>(Instructions::of_this_processor(), me, &candidates, true);
            let plain = view.earliest::<L, false>(Instructions::plain(), me, &candidates, true);
            assert_eq!(fast.0.time.to_bits(), plain.0.time.to_bits());
            assert_eq!(fast.1, plain.1);
            let times = candidates.iter().map(|&word| view.contact::<L>(me, Neighbour::from_word(word)));
            let first = times.filter(|time| !time.is_nan()).fold(f64::INFINITY, f64::min);
            assert_eq!(fast.0.time.to_bits(), first.to_bits());
            if first < f64::INFINITY {
                assert_eq!(view.contact::<L>(me, fast.0.neighbour), first);
                // Seen from the other side the time is the same bits.
                let (there, image) = (fast.0.neighbour.slot(), fast.0.neighbour.image() as u8);
                let number = flights.iter().position(|flight| std::ptr::eq(flight, me)).unwrap_or_default();
                let back = Neighbour::new(number as u32, opposite::<D>(image));
                assert_eq!(view.contact::<L>(&flights[there], back).to_bits(), first.to_bits());
            }
        }
    }

    #[test]
    fn the_search_gives_the_same_bits_whatever_the_instructions() {
        let mut random = Random::new(7, 0);
        for _ in 0..200 {
            compare::<2, Free<Hard>>(&mut random);
            compare::<2, InField<Hard>>(&mut random);
            compare::<3, Free<Hard>>(&mut random);
            compare::<3, InField<Hard>>(&mut random);
        }
    }
}
