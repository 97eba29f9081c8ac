//! The nodes of order 15 and the coefficients that follow from them.

/// Number of coefficients of the acceleration's polynomial beyond the constant.
pub(super) const ORDER: usize = 7;

/// The left Gauss-Radau nodes on `[0, 1]`: `x = 2 h - 1` is a root of `P_7 + P_8`, Legendre's polynomials.
#[allow(clippy::excessive_precision)] // digits to check against other tables
pub(super) const NODES: [f64; ORDER + 1] = [
    0.0,
    0.056_262_560_536_922_146_465_652_191_031_8,
    0.180_240_691_736_892_364_987_579_942_780,
    0.352_624_717_113_169_637_373_907_769_648,
    0.547_153_626_330_555_383_001_448_554_766,
    0.734_210_177_215_410_531_523_210_605_558,
    0.885_320_946_839_095_768_090_359_771_030,
    0.977_520_613_561_287_501_891_174_488_626,
];

/// What the step's polynomial gives at its end: weights of `a(h_n) - a_0`, `n = 1..8`, in the velocity, `int L_n(h) dh`, and in the
/// position, `int (1 - h) L_n(h) dh`, where `L_n` is Lagrange's polynomial that is one at the node `h_n` as rounded above and
/// zero at the others. Each is the sum of two numbers.
///
/// A relative error `e` of such coefficients shifts the energy by about `e dt^2 <a^2>/2` in every step, the same way each time.
/// For `e = 1e-16` and 250 steps to an orbit that is `1e-20` of the energy, and after `10^5` steps more than all roundings at random.
pub(super) const END_WEIGHTS: [[[f64; 2]; 2]; ORDER] = [
    [[0.092_679_077_401_489_69, -6.925_059_727_783_487e-19], [0.087_464_715_198_682_25, 1.256_981_490_181_266_6e-18]],
    [[0.152_065_310_323_392_5, -8.888_714_727_577_061e-18], [0.124_656_953_601_519_06, -3.261_047_841_243_006e-18]],
    [[0.188_258_772_694_559_37, 7.391_856_311_445_767e-18], [0.121_874_076_229_067_85, -1.456_820_591_472_273e-18]],
    [[0.195_786_083_726_246_73, -6.629_769_515_866_781e-18], [0.088_661_018_030_373_11, -2.849_144_709_811_723e-19]],
    [[0.173_507_397_817_250_66, -5.640_490_253_701_852e-18], [0.046_116_500_517_662_31, -1.753_368_000_879_679_7e-18]],
    [[0.124_823_950_664_932_5, 2.438_802_808_274_561_3e-18], [0.014_314_692_474_057_89, -2.594_275_740_674_116_3e-22]],
    [[0.057_254_407_372_128_585, 1.094_082_703_513_491e-18], [0.001_287_043_948_637_545, -1.824_978_039_945_946e-20]],
];

/// `BINOMIAL[n][k]`.
pub(super) const BINOMIAL: [[f64; ORDER + 1]; ORDER + 1] = binomials();

const fn binomials() -> [[f64; ORDER + 1]; ORDER + 1] {
    let mut rows = [[0.0; ORDER + 1]; ORDER + 1];
    let mut n = 0;
    while n <= ORDER {
        rows[n][0] = 1.0;
        let mut k = 1;
        while k <= n {
            rows[n][k] = rows[n - 1][k - 1] + rows[n - 1][k];
            k += 1;
        }
        n += 1;
    }
    rows
}

/// Conversions between `sum b_k h^(k+1)` and `sum g_k h (h - h_1) ... (h - h_k)`, `k = 0..7`.
pub(super) struct Table {
    /// `1/(h_n - h_m)`, `m < n`.
    pub(super) inverse_gap: [[f64; ORDER + 1]; ORDER + 1],
    /// Row `j`: the powers in Newton's polynomial `j`.
    pub(super) power_from_newton: [[f64; ORDER]; ORDER],
    /// Row `j`: the Newton polynomials in the power `j`.
    pub(super) newton_from_power: [[f64; ORDER]; ORDER],
}

impl Table {
    pub(super) fn new() -> Self {
        let h = NODES;
        let (mut inverse_gap, mut power_from_newton, mut newton_from_power) =
            ([[0.0; ORDER + 1]; ORDER + 1], [[0.0; ORDER]; ORDER], [[0.0; ORDER]; ORDER]);
        for n in 1..=ORDER {
            for m in 0..n {
                inverse_gap[n][m] = 1.0 / (h[n] - h[m]);
            }
        }
        power_from_newton[0][0] = 1.0;
        newton_from_power[0][0] = 1.0;
        for j in 1..ORDER {
            for k in 0..=j {
                let lower = |row: &[f64; ORDER]| if k == 0 { 0.0 } else { row[k - 1] };
                // N_j = (h - h_j) N_(j-1), and h N_k = N_(k+1) + h_(k+1) N_k.
                power_from_newton[j][k] = lower(&power_from_newton[j - 1]) - h[j] * power_from_newton[j - 1][k];
                newton_from_power[j][k] = lower(&newton_from_power[j - 1]) + h[k + 1] * newton_from_power[j - 1][k];
            }
        }
        Self { inverse_gap, power_from_newton, newton_from_power }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn legendre(n: u32, x: f64) -> f64 {
        let (mut before, mut value) = (1.0, x);
        for k in 1..n {
            let k = f64::from(k);
            (before, value) = (value, ((2.0 * k + 1.0) * x * value - k * before) / (k + 1.0));
        }
        value
    }

    /// `|P_7 + P_8|` at a node is at most slope times the rounding of the node, plus the rounding of the recursion.
    /// The slope of `P_n` on `[-1, 1]` is at most `n (n + 1)/2`: together 64.
    #[test]
    fn nodes_are_the_roots_of_the_radau_polynomial() {
        for h in NODES {
            let x = 2.0 * h - 1.0;
            assert!((legendre(7, x) + legendre(8, x)).abs() < 64.0 * 2.0 * f64::EPSILON, "{h}");
        }
    }

    #[test]
    fn both_conversions_describe_the_same_polynomial() {
        let table = Table::new();
        let g = [0.3, -1.2, 0.7, 2.0, -0.4, 0.9, 1.1];
        let b: [f64; ORDER] = std::array::from_fn(|k| (k..ORDER).map(|j| g[j] * table.power_from_newton[j][k]).sum());
        for step in 0..=10 {
            let x = 0.1 * f64::from(step);
            let power = b.iter().rev().fold(0.0, |sum, b| (sum + b) * x);
            let newton: f64 = (0..ORDER).map(|k| g[k] * NODES[1..=k].iter().fold(x, |product, h| product * (x - h))).sum();
            assert!((power - newton).abs() < 50.0 * f64::EPSILON, "{power} {newton}");
        }
        for k in 0..ORDER {
            let back: f64 = (k..ORDER).map(|j| b[j] * table.newton_from_power[j][k]).sum();
            assert!((back - g[k]).abs() < 50.0 * f64::EPSILON);
        }
    }

    /// Sums of `w h^k` must be `1/(k + 1)` and `1/((k + 1)(k + 2))` far beyond the digits of one number: products and sums here
    /// keep what rounding takes (Dekker 1971, doi:10.1007/BF01397083).
    #[test]
    fn end_weights_integrate_powers_to_twice_the_precision() {
        type Double = (f64, f64);
        fn sum(a: f64, b: f64) -> Double {
            let s = a + b;
            let taken = s - a;
            (s, (a - (s - taken)) + (b - taken))
        }
        fn add(a: Double, b: Double) -> Double {
            let (s, lost) = sum(a.0, b.0);
            sum(s, lost + a.1 + b.1)
        }
        fn multiply(a: Double, b: f64) -> Double {
            let split = |x: f64| {
                let c = 134_217_729.0 * x;
                let high = c - (c - x);
                (high, x - high)
            };
            let (product, (ah, al), (bh, bl)) = (a.0 * b, split(a.0), split(b));
            sum(product, ((ah * bh - product) + ah * bl + al * bh) + al * bl + a.1 * b)
        }
        for power in 1..=7u32 {
            let k = f64::from(power);
            for (of, denominator) in [(0, k + 1.0), (1, (k + 1.0) * (k + 2.0))] {
                let mut total = (0.0, 0.0);
                for (n, weights) in END_WEIGHTS.iter().enumerate() {
                    let term = (0..power).fold((weights[of][0], weights[of][1]), |term, _| multiply(term, NODES[n + 1]));
                    total = add(total, term);
                }
                let (one, rest) = multiply(total, denominator);
                assert!(((one - 1.0) + rest).abs() < 1e-31, "{power}: {:e}", (one - 1.0) + rest);
            }
        }
    }

    /// The integral over the step of a force `h^d` sampled at the nodes is `1/(d + 1)` for `d <= 14` and no further: eight
    /// Radau nodes make a quadrature of degree 14, hence a method of order 15 (Butcher 1964).
    #[test]
    fn the_quadrature_has_degree_fourteen() {
        let table = Table::new();
        let integral = |degree: i32| {
            let mut g = [0.0; ORDER];
            for n in 1..=ORDER {
                let sample = NODES[n].powi(degree) - NODES[0].powi(degree);
                g[n - 1] = (1..n).fold(sample * table.inverse_gap[n][0], |g_n, m| (g_n - g[m - 1]) * table.inverse_gap[n][m]);
            }
            let b = |k: usize| (k..ORDER).map(|j| g[j] * table.power_from_newton[j][k]).sum::<f64>();
            NODES[0].powi(degree) + (0..ORDER).map(|k| b(k) / (k as f64 + 2.0)).sum::<f64>()
        };
        // Differences divided by the smallest gaps lose up to three digits.
        let rounding = 1e3 * f64::EPSILON;
        for degree in 0..=14 {
            assert!((integral(degree) - 1.0 / f64::from(degree + 1)).abs() < rounding, "{degree}: {}", integral(degree));
        }
        // The error at degree 15 is the integral of h (h - h_1)^2 ... (h - h_7)^2, of order 1e-9.
        let node_polynomial = |h: f64| NODES[1..].iter().fold(h, |product, node| product * (h - node) * (h - node));
        let expected = (0..100_000).map(|i| node_polynomial((f64::from(i) + 0.5) * 1e-5)).sum::<f64>() * 1e-5;
        let error = 1.0 / 16.0 - integral(15);
        println!("{error:e} {expected:e}");
        assert!((error - expected).abs() < rounding && expected > 10.0 * rounding, "{error:e} against {expected:e}");
    }
}
