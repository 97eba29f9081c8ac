//! Eight numbers at once: a vector of AVX-512, two of AVX2, or an array. For kernels that treat all lanes alike.

use corpuscle_core::instructions::{Instructions, Kernel};

/// How many numbers.
pub(crate) const LANES: usize = 8;

/// Arithmetic on eight lanes; of every version the bits are those of IEEE 754, lane by lane.
pub(crate) trait Eight: Copy {
    fn new(lanes: [f64; LANES]) -> Self;
    fn splat(x: f64) -> Self;
    fn lanes(self) -> [f64; LANES];
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    /// `1/sqrt(x)` in single precision, root and quotient exactly rounded; infinite below the smallest normal number of that.
    fn rough_inverse_root(self) -> Self;
}

/// Smaller numbers are taken for zero in single precision.
const SMALLEST: f64 = f32::MIN_POSITIVE as f64;

/// [`Eight::rough_inverse_root`] of one number.
#[inline(always)]
pub(crate) fn rough_inverse_root(x: f64) -> f32 {
    let x = if x < SMALLEST { 0.0 } else { x };
    1.0 / (x as f32).sqrt()
}

/// Work on eight lanes, whatever they are made of; [`Kernel`] says what must be inlined.
pub(crate) trait InEights {
    type Output;

    fn run<V: Eight>(self) -> Self::Output;
}

/// Does the work with the vectors of this instruction set.
#[inline]
pub(crate) fn run<K: InEights>(instructions: Instructions, work: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    {
        if instructions.has_avx512() {
            return instructions.run(x86::WithAvx512(work));
        }
        if instructions.has_avx2() {
            return instructions.run(x86::WithAvx2(work));
        }
    }
    instructions.run(WithArrays(work))
}

struct WithArrays<K>(K);

impl<K: InEights> Kernel for WithArrays<K> {
    type Output = K::Output;

    #[inline(always)]
    fn run(self) -> K::Output {
        self.0.run::<Array>()
    }
}

/// For every machine.
#[derive(Clone, Copy)]
struct Array([f64; LANES]);

impl Eight for Array {
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
    fn rough_inverse_root(self) -> Self {
        Self(std::array::from_fn(|l| f64::from(rough_inverse_root(self.0[l]))))
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::{
        __m256d, __m512d, _CMP_LT_OQ, _CMP_NLT_UQ, _mm256_add_pd, _mm256_andnot_pd, _mm256_castps256_ps128, _mm256_cmp_pd,
        _mm256_cvtpd_ps, _mm256_cvtps_pd, _mm256_div_ps, _mm256_extractf128_ps, _mm256_loadu_pd, _mm256_mul_pd, _mm256_set_m128,
        _mm256_set1_pd, _mm256_set1_ps, _mm256_sqrt_ps, _mm256_storeu_pd, _mm256_sub_pd, _mm512_add_pd, _mm512_cmp_pd_mask,
        _mm512_cvtpd_ps, _mm512_cvtps_pd, _mm512_loadu_pd, _mm512_maskz_mov_pd, _mm512_mul_pd, _mm512_set1_pd, _mm512_storeu_pd,
        _mm512_sub_pd,
    };

    use corpuscle_core::instructions::Kernel;

    use super::{Eight, InEights, LANES, SMALLEST};

    /// Only ever run where the processor has AVX2.
    pub(super) struct WithAvx2<K>(pub(super) K);

    impl<K: InEights> Kernel for WithAvx2<K> {
        type Output = K::Output;

        #[inline(always)]
        fn run(self) -> K::Output {
            self.0.run::<Avx2>()
        }
    }

    /// Only ever run where the processor has AVX-512.
    pub(super) struct WithAvx512<K>(pub(super) K);

    impl<K: InEights> Kernel for WithAvx512<K> {
        type Output = K::Output;

        #[inline(always)]
        fn run(self) -> K::Output {
            self.0.run::<Avx512>()
        }
    }

    /// SAFETY of every block below: values of this type are made only under [`WithAvx2`], where the processor has it.
    #[derive(Clone, Copy)]
    struct Avx2(__m256d, __m256d);

    impl Eight for Avx2 {
        #[inline(always)]
        fn new(lanes: [f64; LANES]) -> Self {
            // SAFETY: see the type; an array is as long as two vectors.
            unsafe { Self(_mm256_loadu_pd(lanes.as_ptr()), _mm256_loadu_pd(lanes.as_ptr().add(4))) }
        }
        #[inline(always)]
        fn splat(x: f64) -> Self {
            // SAFETY: see the type.
            unsafe { Self(_mm256_set1_pd(x), _mm256_set1_pd(x)) }
        }
        #[inline(always)]
        fn lanes(self) -> [f64; LANES] {
            let mut lanes = [0.0; LANES];
            // SAFETY: see the type; an array is as long as two vectors.
            unsafe {
                _mm256_storeu_pd(lanes.as_mut_ptr(), self.0);
                _mm256_storeu_pd(lanes.as_mut_ptr().add(4), self.1);
            }
            lanes
        }
        #[inline(always)]
        fn add(self, other: Self) -> Self {
            // SAFETY: see the type.
            unsafe { Self(_mm256_add_pd(self.0, other.0), _mm256_add_pd(self.1, other.1)) }
        }
        #[inline(always)]
        fn sub(self, other: Self) -> Self {
            // SAFETY: see the type.
            unsafe { Self(_mm256_sub_pd(self.0, other.0), _mm256_sub_pd(self.1, other.1)) }
        }
        #[inline(always)]
        fn mul(self, other: Self) -> Self {
            // SAFETY: see the type.
            unsafe { Self(_mm256_mul_pd(self.0, other.0), _mm256_mul_pd(self.1, other.1)) }
        }
        #[inline(always)]
        fn rough_inverse_root(self) -> Self {
            // SAFETY: see the type.
            unsafe {
                let smallest = _mm256_set1_pd(SMALLEST);
                let first = _mm256_cvtpd_ps(_mm256_andnot_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(self.0, smallest), self.0));
                let second = _mm256_cvtpd_ps(_mm256_andnot_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(self.1, smallest), self.1));
                let roots = _mm256_sqrt_ps(_mm256_set_m128(second, first));
                let y = _mm256_div_ps(_mm256_set1_ps(1.0), roots);
                Self(_mm256_cvtps_pd(_mm256_castps256_ps128(y)), _mm256_cvtps_pd(_mm256_extractf128_ps::<1>(y)))
            }
        }
    }

    /// SAFETY of every block below: values of this type are made only under [`WithAvx512`], where the processor has it.
    #[derive(Clone, Copy)]
    struct Avx512(__m512d);

    impl Eight for Avx512 {
        #[inline(always)]
        fn new(lanes: [f64; LANES]) -> Self {
            // SAFETY: see the type; an array is as long as a vector.
            Self(unsafe { _mm512_loadu_pd(lanes.as_ptr()) })
        }
        #[inline(always)]
        fn splat(x: f64) -> Self {
            // SAFETY: see the type.
            Self(unsafe { _mm512_set1_pd(x) })
        }
        #[inline(always)]
        fn lanes(self) -> [f64; LANES] {
            let mut lanes = [0.0; LANES];
            // SAFETY: see the type; an array is as long as a vector.
            unsafe { _mm512_storeu_pd(lanes.as_mut_ptr(), self.0) };
            lanes
        }
        #[inline(always)]
        fn add(self, other: Self) -> Self {
            // SAFETY: see the type.
            Self(unsafe { _mm512_add_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn sub(self, other: Self) -> Self {
            // SAFETY: see the type.
            Self(unsafe { _mm512_sub_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn mul(self, other: Self) -> Self {
            // SAFETY: see the type.
            Self(unsafe { _mm512_mul_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn rough_inverse_root(self) -> Self {
            // SAFETY: see the type.
            unsafe {
                let normal = _mm512_cmp_pd_mask::<_CMP_NLT_UQ>(self.0, _mm512_set1_pd(SMALLEST));
                let roots = _mm256_sqrt_ps(_mm512_cvtpd_ps(_mm512_maskz_mov_pd(normal, self.0)));
                Self(_mm512_cvtps_pd(_mm256_div_ps(_mm256_set1_ps(1.0), roots)))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Everything;

    impl InEights for Everything {
        type Output = Vec<u64>;

        #[inline(always)]
        fn run<V: Eight>(self) -> Vec<u64> {
            let all = [0.0, -0.0, 1.5, -2.0, 1e300, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 5e-324];
            let mut bits = vec![];
            for n in 0..all.len() {
                let (a, b) = (V::new(std::array::from_fn(|l| all[(n + l) % all.len()])), V::splat(all[n]));
                // What is no number has no sign to rely on.
                let plain = |x: f64| if x.is_nan() { 1 } else { x.to_bits() };
                let roots = [a, a.mul(a), V::splat(f64::from(f32::MIN_POSITIVE)).mul(a)].map(V::rough_inverse_root);
                bits.extend([a.add(b), a.sub(b), a.mul(b)].into_iter().chain(roots).flat_map(V::lanes).map(plain));
            }
            bits
        }
    }

    #[test]
    fn vectors_do_what_arrays_do() {
        let plain = run(Instructions::PLAIN, Everything);
        for instructions in Instructions::all() {
            assert!(run(instructions, Everything) == plain, "{instructions:?}");
        }
    }
}
