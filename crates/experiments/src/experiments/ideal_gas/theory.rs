//! Equations of state sharp enough for measurements good to one part in ten thousand: what the walls and the finite number
//! of particles change, and the virial series where Henderson's and Carnahan and Starling's equations are too coarse.

use std::f64::consts::PI;

use corpuscle_core::particles::ball_volume;
use corpuscle_observe::distribution::ln_gamma;

use crate::gas;

/// Packing fraction up to which the virial series is as sharp as the measurements.
pub(super) const DENSEST: f64 = 0.3;

/// Coefficients `b_k` of `Z = 1 + sum b_k eta^(k-1)`, from `b_2` on: `B_k / B_2^(k-1)` times `2^((D-1)(k-1))`, with the
/// values to `B_10` of Clisby and McCoy 2006 (doi:10.1007/s10955-005-8080-0); beyond, to `b_16`, the differences of the last
/// three are continued in a straight line.
fn virial_coefficients<const D: usize>() -> [f64; 15] {
    const DISCS: [f64; 9] =
        [1.0, 0.782_004_4, 0.532_231_80, 0.333_556_04, 0.198_842_5, 0.114_872_8, 0.064_993_0, 0.036_219_3, 0.019_953_7];
    const SPHERES: [f64; 9] =
        [1.0, 0.625, 0.286_949_5, 0.110_252, 0.038_881_98, 0.013_023_54, 0.004_183_2, 0.001_309_4, 0.000_403_5];
    let (reduced, second): (_, f64) = if D == 2 { (DISCS, 2.0) } else { (SPHERES, 4.0) };
    let mut coefficients = [0.0; 15];
    for (k, ratio) in reduced.into_iter().enumerate() {
        coefficients[k] = ratio * second.powi(k as i32 + 1);
    }
    for k in reduced.len()..coefficients.len() {
        let [a, b, c] = [coefficients[k - 3], coefficients[k - 2], coefficients[k - 1]];
        coefficients[k] = 3.0 * c - 3.0 * b + a;
    }
    coefficients
}

/// `sum f(k) b_k eta^(k-1)` over the virial coefficients from `b_first` on.
fn series<const D: usize>(packing: f64, first: usize, f: impl Fn(f64) -> f64) -> f64 {
    let terms = virial_coefficients::<D>().into_iter().enumerate().skip(first - 2);
    terms.map(|(place, b)| f(place as f64 + 2.0) * b * packing.powi(place as i32 + 1)).sum()
}

/// Compressibility factor of the infinite fluid, from the virial series. Its rest is below 1e-4 up to `eta = 0.3`.
pub(super) fn bulk<const D: usize>(packing: f64) -> f64 {
    1.0 + series::<D>(packing, 2, |_| 1.0)
}

/// Compressibility factor of `N` hard spheres in a periodic box at constant energy and zero momentum, `k T = 2 E/(D (N - 1))`.
///
/// The free energy of exactly `N` particles exceeds the Legendre transform of the grand potential by `kT ln(2 pi <dN^2>)/2`
/// (Lebowitz and Percus 1961, doi:10.1103/PhysRev.124.1673), so that `Z_N = Z + (1/2N) d ln chi / d ln n` with the reduced
/// compressibility `chi = 1 / (d(n Z)/dn)`. At low density that is the `N - 1` partners of each particle.
pub(super) fn periodic<const D: usize>(count: usize, packing: f64) -> f64 {
    let slope = 1.0 + series::<D>(packing, 2, |k| k);
    let curvature = series::<D>(packing, 2, |k| k * (k - 1.0));
    bulk::<D>(packing) - curvature / slope / (2.0 * count as f64)
}

/// `ln Q` of `N` hard spheres whose centres have a box with these sides: pairs as in [`gas::ln_configurations`], the higher terms
/// of the fluid's free energy, `N sum b_k eta^(k-1)/(k-1)`.
pub(super) fn ln_configurations<const D: usize>(count: usize, sides: [f64; D], diameter: f64) -> f64 {
    let packing = count as f64 * ball_volume::<D>(0.5 * diameter) / sides.iter().product::<f64>();
    gas::ln_configurations(count, sides, diameter) - count as f64 * series::<D>(packing, 3, |k| 1.0 / (k - 1.0))
}

/// `P V_acc / (N k T)` on the walls of a cube (square) whose centres-accessible side is `a`, for `N` hard spheres of diameter
/// `s` at constant energy, `k T = 2 E/(D N)`.
///
/// From `Q = V^N (1 - N (N - 1) W / (2 V^2) + ...)`, where `W = integral over |u| < s of prod (a - |u_k|)` is the volume in
/// which two centres would overlap, walls and corners included: the second virial coefficient of this very box, exact. The
/// third and higher terms are those of the fluid, with the surface tension of a hard wall from scaled-particle theory (Reiss,
/// Frisch, Helfand and Lebowitz 1960, doi:10.1063/1.1700883; Helfand, Frisch and Lebowitz 1961, doi:10.1063/1.1731629):
/// `dZ = (A/N) (n gamma' - (D - 1) gamma / D)`. To second order in `s/a`, the particles that the walls adsorb, `Gamma A` of
/// them, are missing in the middle of a closed box, which costs `F/NkT = (Gamma A/N)^2 / (2 chi)`. What is left out, edges and
/// corners from the third coefficient on, is below 1e-4 for hundreds of particles up to `eta = 0.03`.
pub(super) fn between_walls<const D: usize>(count: usize, side: f64, diameter: f64) -> f64 {
    let (n, a, s, d) = (count as f64, side, diameter, D as f64);
    let volume = a.powi(D as i32);
    let packing = n * ball_volume::<D>(0.5 * s) / volume;
    let overlap: &[f64] = if D == 2 {
        &[PI, -8.0 / 3.0, 0.5] // whole disc, four sides, four corners
    } else {
        &[4.0 * PI / 3.0, -1.5 * PI, 1.6, -1.0 / 6.0] // whole ball, six faces, twelve edges, eight corners
    };
    let second: f64 = overlap.iter().enumerate().map(|(j, c)| c * (s / a).powi(j as i32) * (1.0 + j as f64 / d)).sum();
    let pairs = 0.5 * (n - 1.0) * second * s.powi(D as i32) / volume;
    let area = 2.0 * d * volume / a;
    let surface: f64 = (3..9)
        .map(|m| {
            let order = f64::from(m);
            let tension =
                if D == 2 { -2.0 / (PI * s) * (order - 1.0) } else { -4.5 / (PI * s * s) * (order - 1.0) * (order - 1.0) };
            (order - 1.0 + 1.0 / d) * tension * packing.powi(m)
        })
        .sum();
    // Gamma A/N = -(A/N) d gamma/d mu, to the two lowest orders in eta: (first (eta s/a))^2 (1 + next eta) / 2.
    let (first, next) = if D == 2 { (32.0 / (3.0 * PI), 2.0) } else { (9.0, 4.0) };
    let cost = 0.5 * (first * packing * s / a).powi(2);
    let closed = cost * ((2.0 * d + 2.0) / d + next * packing * (3.0 * d + 2.0) / d);
    let more = (1.0 - 1.0 / n) * (1.0 - 2.0 / n) * (series::<D>(packing, 3, |_| 1.0) + area / n * surface + closed);
    1.0 + pairs + more
}

/// `<J^2>/<J>^2` of the impulses on a wall when `f` velocity components share a constant energy: `4/pi` for many.
///
/// Hits are weighted by the normal speed, so this is `<|v|^3> <|v|> / <v^2>^2` of one component of a vector that is uniform on
/// the sphere in `f` dimensions, `<|v|^p> ~ Gamma((p + 1)/2) / Gamma((f + p)/2)`.
pub(super) fn impulse_moments(components: usize) -> f64 {
    let f = components as f64;
    let correction = 2.0 * ln_gamma(0.5 * f + 1.0) - ln_gamma(0.5 * (f + 3.0)) - ln_gamma(0.5 * (f + 1.0));
    4.0 / PI * libm::exp(correction)
}

#[cfg(test)]
mod tests {
    use super::*;
    use corpuscle_core::Random;
    use corpuscle_observe::theory::compressibility;

    #[test]
    fn the_series_lies_close_to_the_textbook_equations() {
        // Henderson and Carnahan-Starling are off by the errors of their virial coefficients, a fraction of a per cent.
        for packing in [0.01, 0.1, 0.2, 0.3] {
            assert!((bulk::<2>(packing) / compressibility::<2>(packing) - 1.0).abs() < 0.001 * packing / 0.3);
            assert!((bulk::<3>(packing) / compressibility::<3>(packing) - 1.0).abs() < 0.004 * packing / 0.3);
        }
        let kolafa = (1.0 + 0.3 + 0.09 - 2.0 / 3.0 * 0.027 * 1.3) / 0.343;
        assert!((bulk::<3>(0.3) / kolafa - 1.0).abs() < 3e-4);
    }

    #[test]
    fn few_particles_have_few_partners() {
        let (packing, n) = (1e-4, 50);
        assert!(((periodic::<2>(n, packing) - 1.0) / (2.0 * packing * 0.98) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn a_large_box_has_no_walls() {
        let side = 1e5;
        let count = 100_000_000;
        let packing = count as f64 * ball_volume::<2>(0.5) / (side * side);
        assert!((between_walls::<2>(count, side, 1.0) - bulk::<2>(packing)).abs() < 1e-6);
    }

    /// Two discs: the configuration integral by Monte Carlo, `P V/(2 k T) = d ln(V^2 - W) / d ln V / 2`, whose derivative is
    /// taken between two boxes with the same random numbers.
    fn two_spheres<const D: usize>() {
        let (side, step, draws) = (4.0, 0.05, 4_000_000);
        let mut free = [0u32; 2];
        let mut random = Random::new(1, 0);
        for _ in 0..draws {
            let gap: [f64; D] = std::array::from_fn(|_| random.uniform() - random.uniform());
            let distance = gap.iter().map(|x| x * x).sum::<f64>().sqrt();
            free[0] += u32::from(distance * (side - step) > 1.0);
            free[1] += u32::from(distance * (side + step) > 1.0);
        }
        let growth = libm::log(f64::from(free[1]) / f64::from(free[0])) / libm::log((side + step) / (side - step)) / D as f64;
        // Of the draws that decide between the two boxes there are k: the difference has the relative error 1/sqrt(k).
        let error = growth / f64::from(free[1] - free[0]).sqrt();
        // Two particles: ln(V^2 - W) itself, not its first-order expansion, which the gas of many particles needs.
        let (a, n) = (side, 2);
        let expansion = between_walls::<D>(n, a, 1.0) - 1.0;
        let overlap = if D == 2 {
            PI / 16.0 - 8.0 / 3.0 / 64.0 + 0.5 / 256.0
        } else {
            4.0 * PI / 3.0 / 64.0 - 1.5 * PI / 256.0 + 1.6 / 1024.0 - 1.0 / 6.0 / 4096.0
        };
        let exact = expansion / (1.0 - overlap);
        let z = (0.5 * growth - exact) / (0.5 * error);
        assert!(z.abs() < 4.0, "{growth} {exact} z = {z}");
    }

    #[test]
    fn the_second_virial_coefficient_of_the_box_is_exact() {
        two_spheres::<2>();
        two_spheres::<3>();
    }

    #[test]
    fn many_components_hit_as_maxwell_has_it() {
        assert!((impulse_moments(1_000_000) - 4.0 / PI).abs() < 1e-6);
        assert!((impulse_moments(2) - 32.0 / (3.0 * PI * PI)).abs() < 1e-14); // one particle on a circle
    }
}
