//! Arithmetic on a fixed number of lanes, the same bits on every machine.
//!
//! A loop over `[f64; LANES]` becomes one, two or four vector instructions, as wide as the processor allows; every lane
//! does the same operations whatever the width, so the choice made at run time shows in the time only.

/// Number of virtual lanes.
pub(super) const LANES: usize = 8;

/// One number a lane.
pub(super) type Lanes = [f64; LANES];

/// Squares of distances below this are taken for zero: single precision holds them no more.
const SMALLEST: f64 = f32::MIN_POSITIVE as f64;

/// `x^(-3/2)` for `x` from `2^-126` to `2^127`; smaller ones give no finite number.
///
/// The guess `y` of `x^(-1/2)` comes from square root and division in single precision, which are exactly rounded by IEEE
/// 754 and take a quarter of the time. Roundings of `x`, root and quotient leave `e = 1 - x y^2` below `5 * 2^-24`, and
/// `x^(-3/2) = y^3 (1 - e)^(-3/2) = y^3 (1 + 3/2 e + 15/8 e^2 + 35/16 e^3 + ...)` is cut off where terms are below `2^-63`.
/// `y^2` is exact in double precision. Rounding `x y^2` counts 3/2, the sum 1, the two products 2: in all the relative error
/// is below `4.5 * 2^-53` (root, product and quotient in double precision: 3).
#[inline(always)]
pub(super) fn inverse_cube_of_root(x: &Lanes) -> Lanes {
    let mut guess = [0.0f32; LANES];
    for lane in 0..LANES {
        let x = if x[lane] < SMALLEST { 0.0 } else { x[lane] };
        guess[lane] = 1.0 / (x as f32).sqrt();
    }
    let mut result = [0.0; LANES];
    for lane in 0..LANES {
        let y = f64::from(guess[lane]);
        let square = y * y;
        let e = 1.0 - x[lane] * square;
        result[lane] = (y * square) * (1.0 + e * (1.5 + 1.875 * e));
    }
    result
}

/// The sum over lanes, by halves.
#[inline(always)]
pub(super) fn sum(x: &Lanes) -> f64 {
    let half = [x[0] + x[4], x[1] + x[5], x[2] + x[6], x[3] + x[7]];
    (half[0] + half[2]) + (half[1] + half[3])
}

/// Compiles a function for the instruction sets worth having and calls the one the processor knows.
///
/// `dispatch! { fn name<const D: usize>(argument: Type) = body; }` where `body` is `#[inline(always)]`.
macro_rules! dispatch {
    ($(#[$attribute:meta])* $visibility:vis fn $name:ident <$(const $parameter:ident : $kind:ty),*> ($($argument:ident : $type:ty),* $(,)?) = $body:ident) => {
        $(#[$attribute])*
        $visibility fn $name<$(const $parameter: $kind),*>($($argument: $type),*) {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx512f,avx512vl,avx512dq")]
                fn widest<$(const $parameter: $kind),*>($($argument: $type),*) {
                    $body::<$($parameter),*>($($argument),*);
                }
                #[target_feature(enable = "avx2")]
                fn wide<$(const $parameter: $kind),*>($($argument: $type),*) {
                    $body::<$($parameter),*>($($argument),*);
                }
                match $crate::force::gravity::lanes::instruction_set() {
                    // SAFETY: the processor was asked and has these instructions.
                    #[allow(unsafe_code, reason = "the only way into a function compiled for them")]
                    $crate::force::gravity::lanes::InstructionSet::Avx512 => return unsafe { widest::<$($parameter),*>($($argument),*) },
                    // SAFETY: as above.
                    #[allow(unsafe_code, reason = "the only way into a function compiled for them")]
                    $crate::force::gravity::lanes::InstructionSet::Avx2 => return unsafe { wide::<$($parameter),*>($($argument),*) },
                    $crate::force::gravity::lanes::InstructionSet::Baseline => {}
                }
            }
            $body::<$($parameter),*>($($argument),*);
        }
    };
}
pub(super) use dispatch;

/// What the processor offers beyond what every one of its kind has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum InstructionSet {
    /// Nothing.
    Baseline,
    /// Four numbers at a time.
    Avx2,
    /// Eight numbers at a time.
    Avx512,
}

/// The best instruction set of this processor.
#[cfg(target_arch = "x86_64")]
pub(super) fn instruction_set() -> InstructionSet {
    #[cfg(test)]
    if let Some(set) = tests::FORCED.with(std::cell::Cell::get) {
        return set;
    }
    let widest = is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512vl") && is_x86_feature_detected!("avx512dq");
    if widest {
        InstructionSet::Avx512
    } else if is_x86_feature_detected!("avx2") {
        InstructionSet::Avx2
    } else {
        InstructionSet::Baseline
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use std::cell::Cell;

    thread_local! {
        /// The instruction set that a test wants on this thread.
        pub(super) static FORCED: Cell<Option<InstructionSet>> = const { Cell::new(None) };
    }

    /// Runs something with every instruction set that this processor has.
    pub(in crate::force::gravity) fn with_each_instruction_set<T>(mut run: impl FnMut() -> T) -> Vec<(InstructionSet, T)> {
        let best = instruction_set();
        let known = [InstructionSet::Baseline, InstructionSet::Avx2, InstructionSet::Avx512];
        let sets = known.into_iter().filter(|set| *set as u8 <= best as u8);
        let results = sets.map(|set| {
            FORCED.set(Some(set));
            (set, run())
        });
        let results = results.collect();
        FORCED.set(None);
        results
    }

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
        for _ in 0..100_000 {
            let x: Lanes = std::array::from_fn(|_| 2f64.powi(random.below(200) as i32 - 100) * (1.0 + random.uniform()));
            let w = inverse_cube_of_root(&x);
            for lane in 0..LANES {
                let (x, w) = ((x[lane], 0.0), (w[lane], 0.0));
                let (high, low) = double(double(double(x, w), double(x, w)), x);
                worst = worst.max(0.5 * ((high - 1.0) + low).abs());
            }
        }
        println!("worst relative error {:.3} of 2^-53", worst / (0.5 * f64::EPSILON));
        assert!(worst < 4.5 * 0.5 * f64::EPSILON, "{worst:e}");
        assert!(worst > 1.5 * 0.5 * f64::EPSILON, "no rounding at all, {worst:e}: is the comparison exact?");
    }

    #[test]
    fn distances_too_small_for_the_guess_give_no_number() {
        let w = inverse_cube_of_root(&[0.0, 1e-300, 1e-39, 1.0, 1.0, 1.0, 1.0, 1.0]);
        assert!(w[..3].iter().all(|w| !w.is_finite()) && w[3..] == [1.0; 5]);
    }
}
