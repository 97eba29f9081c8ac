//! Periodic orbits of three equal stars, and Euler's line.

use corpuscle_core::Vector;

use super::start::Start;

/// A periodic orbit that starts in a row: stars at `x = -1, 1, 0`, the outer two with one velocity, the middle one with minus
/// twice that, for `G = m = 1`.
///
/// Found by Šuvakov and Dmitrašinović 2013 (doi:10.1103/PhysRevLett.110.114301), who print six decimals of the velocity.
/// Least squares on the distance from the start after a period lead from there to the digits here; the periods so
/// found differ from those printed by up to 0.02 per cent.
pub(super) struct Orbit {
    pub(super) name: &'static str,
    velocity: [f64; 2],
    period: f64,
    #[cfg_attr(not(test), allow(dead_code, reason = "what the digits are held against"))]
    published: [f64; 2],
}

const fn orbit(name: &'static str, velocity: [f64; 2], period: f64, published: [f64; 2]) -> Orbit {
    Orbit { name, velocity, period, published }
}

pub(super) const ORBITS: [Orbit; 7] = [
    orbit("butterfly", [0.306_893_420_455_515_76, 0.125_506_567_017_904_6], 6.234_674_838_653_063, [0.306_893, 0.125_507]),
    orbit("butterfly-2", [0.392_955_493_642_195_7, 0.097_578_968_460_014_71], 7.003_709_600_116_08, [0.392_955, 0.097_579]),
    orbit("moth", [0.464_445_172_818_044_65, 0.396_060_014_652_794_67], 14.894_305_175_018_626, [0.464_445, 0.396_060]),
    orbit("dragonfly", [0.080_584_225_540_117_38, 0.588_836_089_778_267_3], 21.272_337_394_611_21, [0.080_584, 0.588_836]),
    orbit("yin-yang", [0.513_938_537_458_177_7, 0.304_735_919_347_342_8], 17.328_834_018_450_493, [0.513_938, 0.304_736]),
    orbit("goggles", [0.083_300_071_849_166_37, 0.127_889_255_520_228_9], 10.464_849_525_875_277, [0.083_300, 0.127_889]),
    orbit("yarn", [0.559_064_254_491_942_4, 0.349_191_564_832_384_17], 55.502_423_388_397_11, [0.559_064, 0.349_192]),
];

impl Orbit {
    pub(super) fn find(name: &str) -> Option<&'static Self> {
        ORBITS.iter().find(|orbit| orbit.name == name)
    }

    /// The orbit for stars of a mean mass other than 1: lengths stay, velocities scale with `sqrt(G m)`.
    pub(super) fn start(&self, masses: [f64; 3], constant: f64, softening: f64) -> Start {
        let mean = masses.iter().sum::<f64>() / 3.0;
        let pace = (constant * mean).sqrt();
        let v = Vector(self.velocity) * pace;
        let stars = [(Vector([-1.0, 0.0]), v), (Vector([1.0, 0.0]), v), (Vector::ZERO, v * -2.0)];
        let mut start = Start::with_stars(self.name, masses, stars, constant, softening);
        let period = self.period / pace;
        // Fine enough for close passages, and a whole number of samples to a period.
        start.interval = period / (self.period / 0.01).round();
        start.duration = 1.5 * period;
        (start.view, start.trail) = (1.4, 1400);
        start.period = (masses == [mean; 3] && softening == 0.0).then_some(period);
        start
    }
}

/// Three stars in a row that turns rigidly (Euler 1767), 1 between the first two: the place of the third and the square of the
/// angular velocity.
///
/// Where all turn together, accelerations are `-omega^2` times the places, so that their differences between neighbours are as the
/// distances of these: `omega^2 = a_1 - a_2 = (a_2 - a_3)/x`. The second is the larger while the third star is too near.
pub(super) fn line_of_euler([a, b, c]: [f64; 3], constant: f64, softening: f64) -> (f64, f64) {
    let pull = |mass: f64, d: f64| constant * mass * d / (d * d + softening * softening).powi(3).sqrt();
    let squares = |x: f64| {
        let first = pull(b, 1.0) + pull(c, 1.0 + x);
        let second = pull(c, x) - pull(a, 1.0);
        let third = -pull(b, x) - pull(a, 1.0 + x);
        (first - second, (second - third) / x)
    };
    let (mut near, mut far) = (1e-6, 1e6);
    for _ in 0..200 {
        let middle = libm::sqrt(near * far);
        let (left, right) = squares(middle);
        if right > left { near = middle } else { far = middle }
    }
    (near, squares(near).0)
}

/// Rate at which a displacement of an unsoftened line grows, over its angular velocity.
///
/// Across the line displacements obey `y'' = -A y`, along it `x'' = 2 A x`, with the same matrix `A`, whose eigenvalues are 0 (the
/// line moves), `omega^2` (it turns) and a third, `c omega^2`, known from the trace `sum over pairs of G (m_i + m_j)/r^3`. With the
/// Coriolis force `lambda^4 + (2 - c) lambda^2 + (1 + 2 c)(1 - c) = 0`, as at the collinear points of the restricted problem.
pub(super) fn growth_of_line([a, b, c]: [f64; 3]) -> f64 {
    let (x, square) = line_of_euler([a, b, c], 1.0, 0.0);
    let trace = (a + b) + (b + c) / (x * x * x) + (a + c) / ((1.0 + x) * (1.0 + x) * (1.0 + x));
    let third = trace / square - 1.0;
    (0.5 * (third - 2.0 + (9.0 * third * third - 8.0 * third).sqrt())).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_decimals_are_found_again() {
        for orbit in &ORBITS {
            for axis in 0..2 {
                assert!((orbit.velocity[axis] - orbit.published[axis]).abs() < 0.55e-6, "{}", orbit.name);
            }
        }
    }

    /// Euler's quintic `(a+b) x^5 + (3a+2b) x^4 + (3a+b) x^3 - (b+3c) x^2 - (2b+3c) x - (b+c) = 0`.
    #[test]
    fn the_line_obeys_eulers_quintic() {
        for [a, b, c] in [[1.0, 1.0, 1.0], [3.0, 0.5, 0.1], [0.01, 2.0, 5.0], [1.0, 1e-9, 0.3]] {
            let (x, _) = line_of_euler([a, b, c], 1.0, 0.0);
            let terms = [-(b + c), -(2.0 * b + 3.0 * c), -(b + 3.0 * c), 3.0 * a + b, 3.0 * a + 2.0 * b, a + b];
            let value: f64 = terms.iter().rev().fold(0.0, |sum, k| sum * x + k);
            let scale: f64 = terms.iter().rev().fold(0.0, |sum, k| sum * x + k.abs());
            assert!(value.abs() < 1e-12 * scale, "{a} {b} {c}: x = {x}, {value}");
        }
        let (x, square) = line_of_euler([1.0; 3], 1.0, 0.0);
        assert!((x - 1.0).abs() < 1e-14 && (square - 1.25).abs() < 1e-13);
    }
}
