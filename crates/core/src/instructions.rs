//! Run-time choice of the instruction set.

use std::sync::OnceLock;

/// Work that is compiled once for each instruction set. `run` must be `#[inline(always)]`, and so must what it calls: only
/// then does the compiler use the instructions of the function it ends up in.
///
/// All instruction sets must give the same bits: no fused operations, and no sums whose order depends on the width.
pub trait Kernel {
    /// What the work results in.
    type Output;

    /// Does the work.
    fn run(self) -> Self::Output;
}

/// An instruction set this machine has.
///
/// ```
/// use corpuscle_core::instructions::{Instructions, Kernel};
///
/// struct Sum<'a>(&'a [f64; 4], &'a [f64; 4]);
///
/// impl Kernel for Sum<'_> {
///     type Output = [f64; 4];
///
///     #[inline(always)]
///     fn run(self) -> [f64; 4] {
///         std::array::from_fn(|lane| self.0[lane] + self.1[lane])
///     }
/// }
///
/// assert_eq!(Instructions::detect().run(Sum(&[1.0, 2.0, 3.0, 4.0], &[4.0, 3.0, 2.0, 1.0])), [5.0; 4]);
/// ```
// Private inside: whoever could make a value the machine does not support could run what it cannot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Instructions(Set);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Set {
    Plain,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Instructions {
    /// What every machine of the target has.
    pub const PLAIN: Self = Self(Set::Plain);

    /// The best this machine has, or a plainer one where the environment asks for it: `CORPUSCLE_INSTRUCTIONS` may be `plain` or
    /// `avx2`. Results do not depend on it: to show that is what it is for.
    #[inline]
    pub fn detect() -> Self {
        static CHOSEN: OnceLock<Instructions> = OnceLock::new();
        *CHOSEN.get_or_init(|| {
            let best = Self::best();
            match std::env::var("CORPUSCLE_INSTRUCTIONS").as_deref() {
                Ok("plain") => Self::PLAIN,
                Ok("avx2") => best.without_avx512(),
                _ => best,
            }
        })
    }

    fn best() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512dq") && is_x86_feature_detected!("avx512vl") {
                return Self(Set::Avx512);
            }
            if is_x86_feature_detected!("avx2") {
                return Self(Set::Avx2);
            }
        }
        Self::PLAIN
    }

    /// Every one this machine has, the plainest first: for tests of their agreement.
    pub fn all() -> Vec<Self> {
        let mut all = vec![Self::PLAIN];
        #[cfg(target_arch = "x86_64")]
        {
            let best = Self::detect();
            if best != Self::PLAIN {
                all.push(Self(Set::Avx2));
            }
            if best == Self(Set::Avx512) {
                all.push(best);
            }
        }
        all
    }

    /// Whether there are vectors of 256 bits: AVX2.
    #[inline]
    pub fn has_avx2(self) -> bool {
        self != Self::PLAIN
    }

    /// Whether there are vectors of 512 bits: AVX-512.
    #[inline]
    pub fn has_avx512(self) -> bool {
        self != self.without_avx512()
    }

    /// This one without vectors or masks of AVX-512: for kernels that gain nothing from them.
    #[inline]
    #[must_use]
    pub fn without_avx512(self) -> Self {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => Self(Set::Avx2),
            set => Self(set),
        }
    }

    /// Runs `kernel`, compiled for this instruction set.
    #[inline]
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self.0 {
            Set::Plain => kernel.run(),
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code, reason = "the one way into code for an instruction set chosen at run time")]
            // SAFETY: `best`, from which all values come, makes these only where the machine has the instructions.
            Set::Avx2 => unsafe { with_avx2(kernel) },
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code, reason = "the one way into code for an instruction set chosen at run time")]
            // SAFETY: as above; AVX-512 never comes without AVX2.
            Set::Avx512 => unsafe { with_avx512(kernel) },
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn with_avx2<K: Kernel>(kernel: K) -> K::Output {
    kernel.run()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,avx512f,avx512dq,avx512vl")]
fn with_avx512<K: Kernel>(kernel: K) -> K::Output {
    kernel.run()
}

/// The larger of two numbers, the second where one is none: in a kernel instead of `f64::max`, of which Rust 1.95 (LLVM 22.1.2) makes
/// wrong code for AVX-512, as the test of this file shows when it is put there.
#[inline(always)]
#[allow(clippy::inline_always, reason = "else it is not compiled for the instruction set")]
pub fn larger(one: f64, other: f64) -> f64 {
    if one > other { one } else { other }
}

/// The smaller of two numbers, the second where one is none: in a kernel instead of `f64::min`, as [`larger`].
#[inline(always)]
#[allow(clippy::inline_always, reason = "else it is not compiled for the instruction set")]
pub fn smaller(one: f64, other: f64) -> f64 {
    if one < other { one } else { other }
}

/// Asks for an item that will soon be needed, without waiting for it; nothing happens where there is none. It is brought into the
/// second cache: from the first it would crowd out what is at work.
#[inline]
pub fn prefetch<T>(items: &[T], index: usize) {
    #[cfg(target_arch = "x86_64")]
    if let Some(item) = items.get(index) {
        use std::arch::x86_64::{_MM_HINT_T1, _mm_prefetch};
        #[allow(unsafe_code, reason = "there is no other way to say it; measured in docs/performance.md")]
        // SAFETY: every x86-64 processor has this instruction, and it has no effect but on speed.
        unsafe {
            _mm_prefetch::<_MM_HINT_T1>(std::ptr::from_ref(item).cast());
        };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (items, index);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sum over lanes, each in its own order.
    struct Norm<'a>(&'a [f64]);

    impl Kernel for Norm<'_> {
        type Output = f64;

        #[inline(always)]
        #[allow(clippy::inline_always, reason = "else it is not compiled for the instruction set")]
        fn run(self) -> f64 {
            let mut lanes = [0.0; 8];
            for chunk in self.0.as_chunks::<8>().0 {
                for lane in 0..8 {
                    lanes[lane] += chunk[lane].sqrt() * chunk[lane];
                }
            }
            lanes.iter().sum()
        }
    }

    /// The fastest of three flows past each of eight places: with `f64::max`, nine in ten came out too small with AVX-512.
    #[derive(Clone, Copy)]
    struct Fastest<'a> {
        place: &'a [[f64; 8]; 2],
        velocity: &'a [[f64; 8]; 2],
        centres: &'a [[f64; 4]; 3],
    }

    impl Kernel for Fastest<'_> {
        type Output = [f64; 8];

        #[inline(always)]
        #[allow(clippy::inline_always, reason = "else it is not compiled for the instruction set")]
        fn run(self) -> [f64; 8] {
            let mut rates = [0.0; 8];
            for [x, y, u, w] in self.centres {
                for (lane, rate) in rates.iter_mut().enumerate() {
                    let (x, y) = (x - self.place[0][lane], y - self.place[1][lane]);
                    let (u, w) = (u - self.velocity[0][lane], w - self.velocity[1][lane]);
                    let d2 = x * x + y * y;
                    *rate = larger((u * u + w * w + 1.0 / d2.sqrt()) / d2, *rate);
                }
            }
            rates
        }
    }

    #[test]
    fn the_largest_is_the_largest_with_every_instruction_set() {
        let mut random = crate::Random::new(2, 0);
        for round in 0..1000 {
            let mut numbers = || std::array::from_fn(|_| std::array::from_fn(|_| random.normal()));
            let (mut place, velocity) = (numbers(), numbers());
            let centres = std::array::from_fn(|_| std::array::from_fn(|_| random.normal()));
            if round % 3 == 0 {
                place[0][round % 8] = f64::NAN;
            }
            let work = Fastest { place: &place, velocity: &velocity, centres: &centres };
            for instructions in Instructions::all() {
                assert_eq!(instructions.run(work).map(f64::to_bits), work.run().map(f64::to_bits), "{instructions:?}");
            }
        }
        assert_eq!((larger(f64::NAN, 1.0), smaller(f64::NAN, 1.0), larger(2.0, 1.0), smaller(2.0, 1.0)), (1.0, 1.0, 2.0, 1.0));
    }

    #[test]
    fn every_instruction_set_gives_the_same_bits() {
        let mut random = crate::Random::new(1, 0);
        let numbers: Vec<f64> = (0..800).map(|_| random.uniform()).collect();
        let all = Instructions::all();
        assert_eq!(all[0], Instructions::PLAIN);
        assert_eq!(all.last(), Some(&Instructions::detect()));
        for instructions in all {
            assert_eq!(instructions.run(Norm(&numbers)), Norm(&numbers).run(), "{instructions:?}");
            assert!(Instructions::all().contains(&instructions.without_avx512()));
        }
    }
}
