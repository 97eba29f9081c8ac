//! Four numbers at once: the same operations, and so the same bits, with vector instructions or without.
#![allow(clippy::inline_always, reason = "vector instructions are used only where everything ends up in one function")]
#![allow(unsafe_code, reason = "vector instructions; measured in docs/performance.md")]

use crate::motion::Flight;

/// How many candidates a search tests at once.
pub(crate) const LANES: usize = 4;

/// Arithmetic on four lanes. Every operation is that of IEEE 754, lane by lane: how it is done shows in no bit.
pub(crate) trait Lanes: Copy {
    /// A truth value for each lane.
    type Mask: Copy;

    fn splat(x: f64) -> Self;
    fn new(lanes: [f64; LANES]) -> Self;
    fn lanes(self) -> [f64; LANES];
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn div(self, other: Self) -> Self;
    fn sqrt(self) -> Self;
    /// The larger one of each lane; no lane may hold a NaN.
    fn max(self, other: Self) -> Self;
    fn less(self, other: Self) -> Self::Mask;
    fn equal(self, other: Self) -> Self::Mask;
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// One bit a lane, the first lane lowest.
    fn bits(mask: Self::Mask) -> u32;
    /// Numbers `2 pair` and `2 pair + 1` of each flight, counted in the order position, time, velocity, radius.
    fn columns<const D: usize>(flights: [&Flight<D>; LANES], pair: usize) -> [Self; 2];

    /// The smaller one of each lane; `other` where this one is NaN.
    fn min(self, other: Self) -> Self;
    /// The least of all lanes; none may hold a NaN.
    fn least(self) -> f64;
}

/// For every machine.
#[derive(Clone, Copy)]
pub(crate) struct Plain([f64; LANES]);

impl Plain {
    #[inline(always)]
    fn each(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self(std::array::from_fn(|l| f(self.0[l], other.0[l])))
    }
}

impl Lanes for Plain {
    type Mask = [bool; LANES];

    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self([x; LANES])
    }
    #[inline(always)]
    fn new(lanes: [f64; LANES]) -> Self {
        Self(lanes)
    }
    #[inline(always)]
    fn lanes(self) -> [f64; LANES] {
        self.0
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.each(other, |a, b| a + b)
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.each(other, |a, b| a - b)
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.each(other, |a, b| a * b)
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.each(other, |a, b| a / b)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.map(f64::sqrt))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.each(other, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn less(self, other: Self) -> Self::Mask {
        std::array::from_fn(|l| self.0[l] < other.0[l])
    }
    #[inline(always)]
    fn equal(self, other: Self) -> Self::Mask {
        std::array::from_fn(|l| self.0[l] == other.0[l])
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.each(other, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    fn least(self) -> f64 {
        let x = self.0;
        let min = |a: f64, b: f64| if b < a { b } else { a };
        min(min(x[0], x[1]), min(x[2], x[3]))
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        Self(std::array::from_fn(|l| if mask[l] { yes.0[l] } else { no.0[l] }))
    }
    #[inline(always)]
    fn bits(mask: Self::Mask) -> u32 {
        mask.iter().rev().fold(0, |bits, &lane| 2 * bits + u32::from(lane))
    }
    #[inline(always)]
    fn columns<const D: usize>(flights: [&Flight<D>; LANES], pair: usize) -> [Self; 2] {
        [0, 1].map(|side| Self(flights.map(|flight| flight.number(2 * pair + side))))
    }
}

#[cfg(target_arch = "x86_64")]
pub(crate) use x86::Avx2;

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::{
        __m256d, _CMP_EQ_OQ, _CMP_LT_OQ, _mm_loadu_pd, _mm256_add_pd, _mm256_blendv_pd, _mm256_castpd128_pd256, _mm256_cmp_pd,
        _mm256_cvtsd_f64, _mm256_div_pd, _mm256_insertf128_pd, _mm256_loadu_pd, _mm256_max_pd, _mm256_min_pd, _mm256_movemask_pd,
        _mm256_mul_pd, _mm256_permute_pd, _mm256_permute2f128_pd, _mm256_set1_pd, _mm256_sqrt_pd, _mm256_storeu_pd, _mm256_sub_pd,
        _mm256_unpackhi_pd, _mm256_unpacklo_pd,
    };

    use super::{LANES, Lanes};
    use crate::motion::Flight;

    /// For x86-64 processors with AVX2 (2013 and later).
    ///
    /// SAFETY of all calls below: a value of this type is made only inside functions compiled for, and entered only on,
    /// processors with AVX2 (see `search`).
    #[derive(Clone, Copy)]
    pub(crate) struct Avx2(__m256d);

    macro_rules! operations {
        ($($name:ident is $instruction:ident),*) => {
            $(#[inline(always)]
            fn $name(self, other: Self) -> Self {
                // SAFETY: see the type.
                Self(unsafe { $instruction(self.0, other.0) })
            })*
        };
    }

    impl Lanes for Avx2 {
        type Mask = __m256d;

        operations!(
            add is _mm256_add_pd, sub is _mm256_sub_pd, mul is _mm256_mul_pd, div is _mm256_div_pd, max is _mm256_max_pd,
            min is _mm256_min_pd
        );

        #[inline(always)]
        fn splat(x: f64) -> Self {
            // SAFETY: see the type.
            Self(unsafe { _mm256_set1_pd(x) })
        }
        #[inline(always)]
        fn new(lanes: [f64; LANES]) -> Self {
            // SAFETY: see the type; an unaligned load of four numbers.
            Self(unsafe { _mm256_loadu_pd(lanes.as_ptr()) })
        }
        #[inline(always)]
        fn lanes(self) -> [f64; LANES] {
            let mut lanes = [0.0; LANES];
            // SAFETY: see the type; an unaligned store of four numbers.
            unsafe { _mm256_storeu_pd(lanes.as_mut_ptr(), self.0) };
            lanes
        }
        #[inline(always)]
        fn sqrt(self) -> Self {
            // SAFETY: see the type.
            Self(unsafe { _mm256_sqrt_pd(self.0) })
        }
        #[inline(always)]
        fn less(self, other: Self) -> Self::Mask {
            // SAFETY: see the type.
            unsafe { _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, other.0) }
        }
        #[inline(always)]
        fn equal(self, other: Self) -> Self::Mask {
            // SAFETY: see the type.
            unsafe { _mm256_cmp_pd::<_CMP_EQ_OQ>(self.0, other.0) }
        }
        #[inline(always)]
        fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
            // SAFETY: see the type.
            Self(unsafe { _mm256_blendv_pd(no.0, yes.0, mask) })
        }
        #[inline(always)]
        fn bits(mask: Self::Mask) -> u32 {
            // SAFETY: see the type.
            unsafe { _mm256_movemask_pd(mask) as u32 }
        }
        #[inline(always)]
        fn columns<const D: usize>([a, b, c, d]: [&Flight<D>; LANES], pair: usize) -> [Self; 2] {
            debug_assert!(pair <= D, "a flight has 2 D + 2 numbers");
            // SAFETY: see the type. A flight is `repr(C)` and begins with 2 D + 2 numbers, of which two are loaded.
            unsafe {
                let start = |flight: &Flight<D>| std::ptr::from_ref(flight).cast::<f64>().add(2 * pair);
                let (a, b, c, d) = (start(a), start(b), start(c), start(d));
                let ac = _mm256_insertf128_pd::<1>(_mm256_castpd128_pd256(_mm_loadu_pd(a)), _mm_loadu_pd(c));
                let bd = _mm256_insertf128_pd::<1>(_mm256_castpd128_pd256(_mm_loadu_pd(b)), _mm_loadu_pd(d));
                [Self(_mm256_unpacklo_pd(ac, bd)), Self(_mm256_unpackhi_pd(ac, bd))]
            }
        }
        #[inline(always)]
        fn least(self) -> f64 {
            // SAFETY: see the type.
            unsafe {
                let halves = _mm256_min_pd(self.0, _mm256_permute2f128_pd::<1>(self.0, self.0));
                _mm256_cvtsd_f64(_mm256_min_pd(halves, _mm256_permute_pd::<5>(halves)))
            }
        }
    }
}
