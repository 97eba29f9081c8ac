//! Sums of many terms that do not depend on the order of the terms.
//!
//! Every term is rounded to a multiple of one quantum, a power of two, and the multiples are added as integers: the sum is
//! exact, hence associative, whatever the order, the number of threads and the width of vectors (compare Le Grand, Goetz
//! and Walker 2013, doi:10.1016/j.cpc.2012.09.022). Opposite terms cancel exactly.

/// Bits of a term: `|x| < 2^51` quanta, which leaves room for 2^12 terms of the largest size in a sum.
pub(crate) const BITS: i32 = 51;
/// Scales grow in steps of `2^8`, so that a coarser one is needed once and not at every new extreme.
const STRIDE: i32 = 8;

/// Rounds terms below a bound to integers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Quantum {
    exponent: i32,
    /// `3 * 2^51` quanta: in a sum with it a term's multiple of the quantum stands in the last bits.
    magic: f64,
}

impl Quantum {
    /// The quantum for terms up to `bound` at least; about `bound * 2^-51`.
    pub(crate) fn for_terms_up_to(bound: f64) -> Self {
        Self::with_exponent(exponent_above(bound) - BITS)
    }

    /// This quantum where it suffices for terms up to `bound`, else the next one that does.
    pub(crate) fn coarsened(self, bound: f64) -> Self {
        let missing = exponent_above(bound) - BITS - self.exponent;
        if missing <= 0 { self } else { Self::with_exponent(self.exponent + (missing + STRIDE - 1) / STRIDE * STRIDE) }
    }

    fn with_exponent(exponent: i32) -> Self {
        let exponent = exponent.clamp(-1000, 970);
        Self { exponent, magic: libm::scalbn(3.0, exponent + BITS) }
    }

    /// What a term `x` below the bound is added to: the last bits of the sum are the nearest multiple of the quantum, and the
    /// sum less this number is that multiple as a number. Terms beyond the bound give anything, never a trap.
    pub(crate) fn magic(self) -> f64 {
        self.magic
    }

    /// What the sum, which wraps around, of the bits of so many of those sums is larger by than the sum of their multiples.
    #[inline(always)]
    pub(crate) fn bias(self, terms: i64) -> i64 {
        terms.wrapping_mul(self.magic.to_bits() as i64)
    }

    /// The quantum for what terms leave: `2^-51` of this one.
    pub(crate) fn finer(self) -> Self {
        Self::with_exponent(self.exponent - BITS)
    }

    /// The quantum itself.
    pub(crate) fn unit(self) -> f64 {
        libm::scalbn(1.0, self.exponent)
    }
}

/// The smallest `e` with `|x| <= 2^e`, roughly: at most one too large.
fn exponent_above(x: f64) -> i32 {
    let biased = (x.to_bits() >> 52 & 0x7FF) as i32;
    biased - 1022
}

#[cfg(test)]
mod tests {
    use super::*;
    use corpuscle_core::Random;

    #[test]
    fn sums_do_not_depend_on_the_order_and_opposites_cancel() {
        let mut random = Random::new(1, 0);
        let quantum = Quantum::for_terms_up_to(1000.0);
        let mut terms: Vec<f64> = (0..1000).map(|_| 300.0 * random.normal().clamp(-3.0, 3.0)).collect();
        let sum = |terms: &[f64]| {
            let bits = terms.iter().fold(0i64, |sum, &x| sum.wrapping_add((x + quantum.magic()).to_bits() as i64));
            bits.wrapping_sub(quantum.bias(terms.len() as i64))
        };
        let forwards = sum(&terms);
        let plain: f64 = terms.iter().sum();
        // Each term is off by half a quantum at most, the plain sum by a rounding of up to 1e5 a term.
        let value = |multiple: i64| multiple as f64 * quantum.unit();
        let bound = 1000.0 * (0.5 * quantum.unit() + 1e5 * f64::EPSILON);
        assert!((value(forwards) - plain).abs() < bound, "{} {plain}", value(forwards));
        random.shuffle(&mut terms);
        assert_eq!(sum(&terms), forwards);
        for x in &mut terms {
            *x = -*x;
        }
        assert_eq!(sum(&terms), -forwards);
    }

    #[test]
    fn a_quantum_is_coarsened_only_where_it_must_and_in_strides() {
        let fine = Quantum::for_terms_up_to(1000.0);
        assert_eq!(fine.unit(), libm::scalbn(1.0, 10 - 51));
        assert_eq!(fine.coarsened(1023.0), fine);
        assert_eq!(fine.coarsened(1025.0).unit(), fine.unit() * 256.0);
        assert_eq!(fine.coarsened(1025.0).coarsened(1.0), fine.coarsened(1025.0));
        for x in [1e-300, 3.0, 1023.9, -777.0] {
            let shifted = x + fine.magic();
            let (multiple, left) = ((shifted.to_bits() as i64).wrapping_sub(fine.bias(1)), x - (shifted - fine.magic()));
            assert_eq!(multiple as f64 * fine.unit() + left, x);
            assert!(left.abs() <= 0.5 * fine.unit());
        }
    }
}
