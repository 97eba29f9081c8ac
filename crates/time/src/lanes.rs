//! Four numbers at once, with vector instructions or without.
//!
//! Plain arrays would do, if compilers did not split them into halves and shuffle them: for kernels that meet one number with
//! four, that costs more than half the speed. Every operation is that of IEEE 754, lane by lane: how it is done shows in no bit.
#![allow(unsafe_code, reason = "vector instructions; measured in docs/performance.md")]

pub(crate) mod eight;

use corpuscle_core::instructions::{Instructions, Kernel};

/// How many numbers.
pub(crate) const LANES: usize = 4;

/// Arithmetic on four lanes.
pub(crate) trait Lanes: Copy {
    /// An integer in each lane.
    type Integers: Copy;

    fn new(lanes: [f64; LANES]) -> Self;
    fn splat(x: f64) -> Self;
    fn lanes(self) -> [f64; LANES];
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    /// The larger one; `other` where either is no number.
    fn larger(self, other: Self) -> Self;
    /// The smaller one; `other` where either is no number.
    fn smaller(self, other: Self) -> Self;
    /// Lane `l` becomes lane `l + BY`, counted round.
    fn rotated<const BY: usize>(self) -> Self;
    /// Itself where `a < b`, else zero.
    fn where_less(self, a: Self, b: Self) -> Self;
    /// Whether it is less in any lane.
    fn any_less(self, other: Self) -> bool;

    /// Zero in every lane.
    fn zeros() -> Self::Integers;
    /// What the integers are.
    fn integers(integers: Self::Integers) -> [i64; LANES];
    /// The nearest numbers to integers less `bias`, which wrap around.
    fn numbers(integers: Self::Integers, bias: i64) -> Self;
    /// Adds the bits of the numbers to integers, which wrap around.
    fn add_bits(self, sum: Self::Integers) -> Self::Integers;
    /// The larger of the magnitudes' bits and `most`. Infinity is larger than all numbers, no number larger still.
    fn larger_bits(self, most: Self::Integers) -> Self::Integers;
}

/// Work on lanes, whatever they are made of; [`Kernel`] says what must be inlined.
pub(crate) trait InLanes {
    type Output;

    fn run<V: Lanes>(self) -> Self::Output;
}

/// Does the work with the vectors of this instruction set.
#[inline]
pub(crate) fn run<K: InLanes>(instructions: Instructions, work: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    if instructions.has_avx2() {
        return instructions.run(WithAvx2(work));
    }
    instructions.run(WithArrays(work))
}

struct WithArrays<K>(K);

impl<K: InLanes> Kernel for WithArrays<K> {
    type Output = K::Output;

    #[inline(always)]
    fn run(self) -> K::Output {
        self.0.run::<Array>()
    }
}

/// For every machine.
#[derive(Clone, Copy)]
pub(crate) struct Array([f64; LANES]);

impl Lanes for Array {
    type Integers = [i64; LANES];

    #[inline(always)]
    fn new(lanes: [f64; LANES]) -> Self {
        Self(lanes)
    }
    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self([x; LANES])
    }
    #[inline(always)]
    fn lanes(self) -> [f64; LANES] {
        self.0
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|l| self.0[l] + other.0[l]))
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(std::array::from_fn(|l| self.0[l] - other.0[l]))
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(std::array::from_fn(|l| self.0[l] * other.0[l]))
    }
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        Self(std::array::from_fn(|l| if self.0[l] > other.0[l] { self.0[l] } else { other.0[l] }))
    }
    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        Self(std::array::from_fn(|l| if self.0[l] < other.0[l] { self.0[l] } else { other.0[l] }))
    }
    #[inline(always)]
    fn rotated<const BY: usize>(self) -> Self {
        Self(std::array::from_fn(|l| self.0[(l + BY) % LANES]))
    }
    #[inline(always)]
    fn where_less(self, a: Self, b: Self) -> Self {
        Self(std::array::from_fn(|l| if a.0[l] < b.0[l] { self.0[l] } else { 0.0 }))
    }
    #[inline(always)]
    fn any_less(self, other: Self) -> bool {
        (0..LANES).map(|l| u8::from(self.0[l] < other.0[l])).sum::<u8>() > 0
    }
    #[inline(always)]
    fn zeros() -> [i64; LANES] {
        [0; LANES]
    }
    #[inline(always)]
    fn integers(integers: [i64; LANES]) -> [i64; LANES] {
        integers
    }
    #[inline(always)]
    fn numbers(integers: [i64; LANES], bias: i64) -> Self {
        Self(std::array::from_fn(|l| integers[l].wrapping_sub(bias) as f64))
    }
    #[inline(always)]
    fn add_bits(self, sum: [i64; LANES]) -> [i64; LANES] {
        std::array::from_fn(|l| sum[l].wrapping_add(self.0[l].to_bits() as i64))
    }
    #[inline(always)]
    fn larger_bits(self, most: [i64; LANES]) -> [i64; LANES] {
        std::array::from_fn(|l| most[l].max(self.0[l].abs().to_bits() as i64))
    }
}

#[cfg(target_arch = "x86_64")]
use x86::WithAvx2;

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::{
        __m256d, __m256i, _CMP_LT_OQ, _mm256_add_epi64, _mm256_add_pd, _mm256_and_pd, _mm256_andnot_pd, _mm256_blend_epi16,
        _mm256_blendv_pd, _mm256_castpd_si256, _mm256_castsi256_pd, _mm256_cmp_pd, _mm256_cmpgt_epi64, _mm256_loadu_pd,
        _mm256_max_pd, _mm256_min_pd, _mm256_movemask_pd, _mm256_mul_pd, _mm256_permute4x64_pd, _mm256_set1_epi64x, _mm256_set1_pd,
        _mm256_setzero_si256, _mm256_srai_epi32, _mm256_storeu_pd, _mm256_storeu_si256, _mm256_sub_epi64, _mm256_sub_pd,
    };

    use corpuscle_core::instructions::Kernel;

    use super::{InLanes, LANES, Lanes};

    /// Only ever run where the processor has AVX2.
    pub(super) struct WithAvx2<K>(pub(super) K);

    impl<K: InLanes> Kernel for WithAvx2<K> {
        type Output = K::Output;

        #[inline(always)]
        fn run(self) -> K::Output {
            self.0.run::<Avx2>()
        }
    }

    /// For x86-64 processors with AVX2 (2013 and later).
    ///
    /// SAFETY of every block below: values of this type are made only under [`WithAvx2`], where the processor has it.
    #[derive(Clone, Copy)]
    struct Avx2(__m256d);

    impl Lanes for Avx2 {
        type Integers = __m256i;

        #[inline(always)]
        fn new(lanes: [f64; LANES]) -> Self {
            // SAFETY: see the type; an array is as long as a vector.
            Self(unsafe { _mm256_loadu_pd(lanes.as_ptr()) })
        }
        #[inline(always)]
        fn splat(x: f64) -> Self {
            // SAFETY: see the type.
            Self(unsafe { _mm256_set1_pd(x) })
        }
        #[inline(always)]
        fn lanes(self) -> [f64; LANES] {
            let mut lanes = [0.0; LANES];
            // SAFETY: see the type; an array is as long as a vector.
            unsafe { _mm256_storeu_pd(lanes.as_mut_ptr(), self.0) };
            lanes
        }
        #[inline(always)]
        fn add(self, other: Self) -> Self {
            // SAFETY: see the type.
            Self(unsafe { _mm256_add_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn sub(self, other: Self) -> Self {
            // SAFETY: see the type.
            Self(unsafe { _mm256_sub_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn mul(self, other: Self) -> Self {
            // SAFETY: see the type.
            Self(unsafe { _mm256_mul_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn larger(self, other: Self) -> Self {
            // SAFETY: see the type.
            Self(unsafe { _mm256_max_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn smaller(self, other: Self) -> Self {
            // SAFETY: see the type.
            Self(unsafe { _mm256_min_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn rotated<const BY: usize>(self) -> Self {
            // SAFETY: see the type.
            unsafe {
                match BY {
                    0 => self,
                    1 => Self(_mm256_permute4x64_pd::<0b00_11_10_01>(self.0)),
                    2 => Self(_mm256_permute4x64_pd::<0b01_00_11_10>(self.0)),
                    _ => Self(_mm256_permute4x64_pd::<0b10_01_00_11>(self.0)),
                }
            }
        }
        #[inline(always)]
        fn where_less(self, a: Self, b: Self) -> Self {
            // SAFETY: see the type.
            Self(unsafe { _mm256_and_pd(self.0, _mm256_cmp_pd::<_CMP_LT_OQ>(a.0, b.0)) })
        }
        #[inline(always)]
        fn any_less(self, other: Self) -> bool {
            // SAFETY: see the type.
            unsafe { _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(self.0, other.0)) != 0 }
        }
        #[inline(always)]
        fn zeros() -> __m256i {
            // SAFETY: see the type.
            unsafe { _mm256_setzero_si256() }
        }
        #[inline(always)]
        fn integers(integers: __m256i) -> [i64; LANES] {
            let mut lanes = [0; LANES];
            // SAFETY: see the type; an array is as long as a vector.
            unsafe { _mm256_storeu_si256(lanes.as_mut_ptr().cast(), integers) };
            lanes
        }
        #[inline(always)]
        fn numbers(integers: __m256i, bias: i64) -> Self {
            // The upper half, signed, in the last bits of 3 * 2^67, whose last bit is worth 2^32 * 2^-16 and holds the half
            // shifted up by 16; the lower 48 bits in those of 2^52. Less what was added, their sum is rounded once.
            const UPPER: f64 = 3.0 * (1u128 << 67) as f64;
            const LOWER: f64 = (1u64 << 52) as f64;
            // SAFETY: see the type.
            unsafe {
                let x = _mm256_sub_epi64(integers, _mm256_set1_epi64x(bias));
                let upper = _mm256_blend_epi16::<0b0011_0011>(_mm256_srai_epi32::<16>(x), _mm256_setzero_si256());
                let upper = _mm256_add_epi64(upper, _mm256_castpd_si256(_mm256_set1_pd(UPPER)));
                let lower = _mm256_blend_epi16::<0b1000_1000>(x, _mm256_castpd_si256(_mm256_set1_pd(LOWER)));
                let upper = _mm256_sub_pd(_mm256_castsi256_pd(upper), _mm256_set1_pd(UPPER + LOWER));
                Self(_mm256_add_pd(upper, _mm256_castsi256_pd(lower)))
            }
        }
        #[inline(always)]
        fn add_bits(self, sum: __m256i) -> __m256i {
            // SAFETY: see the type.
            unsafe { _mm256_add_epi64(sum, _mm256_castpd_si256(self.0)) }
        }
        #[inline(always)]
        fn larger_bits(self, most: __m256i) -> __m256i {
            // SAFETY: see the type.
            unsafe {
                let size = _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0);
                let larger = _mm256_cmpgt_epi64(_mm256_castpd_si256(size), most);
                _mm256_castpd_si256(_mm256_blendv_pd(_mm256_castsi256_pd(most), size, _mm256_castsi256_pd(larger)))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every operation on numbers and what is none, as bits.
    struct Everything;

    impl InLanes for Everything {
        type Output = Vec<u64>;

        #[inline(always)]
        fn run<V: Lanes>(self) -> Vec<u64> {
            let all = [0.0, -0.0, 1.5, -2.0, 1e300, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 5e-324];
            let mut bits = vec![];
            for n in 0..all.len() * all.len() {
                let number = |l: usize| all[(n / (1 + l % 2 * (all.len() - 1)) + l) % all.len()];
                let (a, b) = (V::new(std::array::from_fn(number)), V::splat(all[n / all.len()]));
                for lanes in [a.larger(b), a.smaller(b), a.rotated::<1>(), a.rotated::<2>(), a.rotated::<3>(), a.where_less(a, b)] {
                    bits.extend(lanes.lanes().map(f64::to_bits));
                }
                // A sum that is no number has no sign to rely on.
                for lanes in [a.add(b), a.sub(b), a.mul(b)] {
                    bits.extend(lanes.lanes().map(|x| if x.is_nan() { 1 } else { x.to_bits() }));
                }
                for integers in [a.add_bits(b.add_bits(V::zeros())), a.larger_bits(b.larger_bits(V::zeros()))] {
                    bits.extend(V::integers(integers).map(|x| x as u64));
                }
                bits.push(a.any_less(b).into());
            }
            bits
        }
    }

    /// Integers as numbers.
    struct Conversion([i64; LANES], i64);

    impl InLanes for Conversion {
        type Output = [f64; LANES];

        #[inline(always)]
        fn run<V: Lanes>(self) -> [f64; LANES] {
            let none = V::integers(V::zeros());
            let bits = V::new(self.0.map(|x| f64::from_bits(x as u64))).add_bits(V::zeros());
            assert_eq!(none, [0; LANES]);
            V::numbers(bits, self.1).lanes()
        }
    }

    #[test]
    fn integers_become_the_nearest_numbers() {
        let mut random = corpuscle_core::Random::new(5, 0);
        for n in 0..20_000 {
            let mut word = || ((random.uniform() * 2f64.powi(52)) as i64).wrapping_mul(0x9E37_79B9_7F4A_7C15u64 as i64) >> (n % 63);
            let (integers, bias) = ([word(), word(), -word(), i64::MAX - word()], word());
            let expected = integers.map(|x| x.wrapping_sub(bias) as f64);
            for instructions in Instructions::all() {
                assert_eq!(run(instructions, Conversion(integers, bias)), expected, "{integers:?} {bias}");
            }
        }
    }

    #[test]
    fn vectors_do_what_arrays_do() {
        let plain = run(Instructions::PLAIN, Everything);
        assert!(plain.contains(&2.5f64.to_bits()) || plain.contains(&3.0f64.to_bits()));
        for instructions in Instructions::all() {
            assert!(run(instructions, Everything) == plain, "{instructions:?}");
        }
    }
}
