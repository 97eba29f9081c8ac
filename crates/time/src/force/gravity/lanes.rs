//! Arithmetic on a fixed number of lanes, the same bits on every machine.
//!
//! A loop over `[f64; LANES]` becomes one, two or four vector instructions, as wide as the processor allows; every lane
//! does the same operations whatever the width, so the choice made at run time shows in the time only.

use crate::lanes::eight::{Eight, rough_inverse_root};

/// Number of virtual lanes.
pub(super) const LANES: usize = 8;

/// One number a lane.
pub(super) type Lanes = [f64; LANES];

/// A first guess of `x^(-1/2)` for `x` from `2^-126` to `2^127`; infinite for smaller ones.
///
/// Square root and division in single precision are exactly rounded by IEEE 754, hence the same everywhere, and take a quarter
/// of the time of those in double precision. A processor still waits some forty cycles for them, so kernels first make the
/// guesses for a whole block and then use them.
#[inline(always)]
pub(super) fn guess(x: f64) -> f32 {
    rough_inverse_root(x)
}

/// `x^(-3/2)` from the [`guess`] `y` for the same `x`; not finite where the guess is not.
///
/// Roundings of `x`, root and quotient leave `e = 1 - x y^2` below `5 * 2^-24`, and
/// `x^(-3/2) = y^3 (1 - e)^(-3/2) = y^3 (1 + 3/2 e + 15/8 e^2 + 35/16 e^3 + ...)` is cut off where terms are below `2^-63`.
/// `y^2` is exact in double precision. Rounding `x y^2` counts 3/2, the sum 1, the two products 2: in all the relative error
/// is below `4.5 * 2^-53` (root, product and quotient in double precision: 3).
#[inline(always)]
pub(super) fn inverse_cube_of_root(x: f64, guess: f32) -> f64 {
    let y = f64::from(guess);
    let square = y * y;
    let e = 1.0 - x * square;
    (y * square) * (1.0 + e * (1.5 + 1.875 * e))
}

/// The same of eight numbers.
#[inline(always)]
pub(super) fn inverse_cube_from<V: Eight>(x: V, guess: V) -> V {
    let square = guess.mul(guess);
    let e = V::splat(1.0).sub(x.mul(square));
    let series = V::splat(1.0).add(e.mul(V::splat(1.5).add(V::splat(1.875).mul(e))));
    guess.mul(square).mul(series)
}

/// `x^(-1/2)` from the [`guess`] `y` for the same `x`, as [`inverse_cube_of_root`] does it:
/// `y (1 - e)^(-1/2) = y (1 + e/2 + 3/8 e^2 + ...)`, relative error below `2 * 2^-53`.
#[inline(always)]
pub(super) fn inverse_root(x: f64, guess: f32) -> f64 {
    let y = f64::from(guess);
    let e = 1.0 - x * (y * y);
    y * (1.0 + e * (0.5 + 0.375 * e))
}

/// The sum over lanes, by halves.
#[inline(always)]
pub(super) fn sum(x: &Lanes) -> f64 {
    let half = [x[0] + x[4], x[1] + x[5], x[2] + x[6], x[3] + x[7]];
    (half[0] + half[2]) + (half[1] + half[3])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bound of the documentation against `1/(x sqrt x)` in quadruple effect: `x w^(2/3)` would lose digits, so the
    /// residual `x^3 w^2 - 1 = 2 error` is formed exactly, from products split in halves.
    #[test]
    fn the_inverse_cube_is_within_its_bound() {
        let exact = |a: f64, b: f64| {
            let split = |x: f64| {
                let c = 134_217_729.0 * x;
                let high = c - (c - x);
                (high, x - high)
            };
            let (p, (ah, al), (bh, bl)) = (a * b, split(a), split(b));
            (p, ((ah * bh - p) + ah * bl + al * bh) + al * bl)
        };
        let double = |(a, b): (f64, f64), (c, d): (f64, f64)| {
            let (p, e) = exact(a, c);
            let low = e + (a * d + b * c);
            let high = p + low;
            (high, low - (high - p))
        };
        let mut random = corpuscle_core::Random::new(3, 0);
        let mut worst: f64 = 0.0;
        for _ in 0..1_000_000 {
            let x = 2f64.powi(random.below(200) as i32 - 100) * (1.0 + random.uniform());
            let (x, w) = ((x, 0.0), (inverse_cube_of_root(x, guess(x)), 0.0));
            let (high, low) = double(double(double(x, w), double(x, w)), x);
            worst = worst.max(0.5 * ((high - 1.0) + low).abs());
        }
        println!("worst relative error {:.3} of 2^-53", worst / (0.5 * f64::EPSILON));
        assert!(worst < 4.5 * 0.5 * f64::EPSILON, "{worst:e}");
        assert!(worst > 1.5 * 0.5 * f64::EPSILON, "no rounding at all, {worst:e}: is the comparison exact?");
    }

    struct Cubes(Lanes);

    impl crate::lanes::eight::InEights for Cubes {
        type Output = Lanes;

        #[inline(always)]
        fn run<V: Eight>(self) -> Lanes {
            let x = V::new(self.0);
            inverse_cube_from(x, x.rough_inverse_root()).lanes()
        }
    }

    #[test]
    fn eight_at_once_are_the_same() {
        let mut random = corpuscle_core::Random::new(4, 0);
        for _ in 0..10_000 {
            let x: Lanes = std::array::from_fn(|_| 2f64.powi(random.below(260) as i32 - 130) * (1.0 + random.uniform()));
            for instructions in corpuscle_core::Instructions::all() {
                let found = crate::lanes::eight::run(instructions, Cubes(x));
                let bits = |x: f64| if x.is_nan() { 1 } else { x.to_bits() };
                assert_eq!(found.map(bits), x.map(|x| bits(inverse_cube_of_root(x, guess(x)))), "{instructions:?} {x:?}");
            }
        }
    }

    #[test]
    fn distances_too_small_for_the_guess_give_no_number() {
        for x in [0.0, 1e-300, 1e-39] {
            assert!(!inverse_cube_of_root(x, guess(x)).is_finite(), "{x}");
        }
        assert_eq!(inverse_cube_of_root(1.0, guess(1.0)), 1.0);
    }
}
