//! Hard discs of one size through their phases, to the last digit that is known: `Z = P V/(N k T)` of the liquid and of the
//! crystal, and where they meet.

use super::finite_size_shift;

/// Closest packing, `pi/(2 sqrt3)`.
pub const CLOSEST: f64 = 0.906_899_682_117_089_2;

/// Pressure `P s^2/kT` at which liquid and hexatic phase stand side by side (Bernard and Krauth 2011,
/// doi:10.1103/PhysRevLett.107.155704; by three methods Engel et al. 2013, doi:10.1103/PhysRevE.87.042134).
pub const COEXISTENCE: f64 = 9.185;
/// Packing fraction of the liquid there.
pub const LIQUID: f64 = 0.700;
/// Packing fraction of the hexatic phase there.
pub const HEXATIC: f64 = 0.716;

/// Coefficients in `2 eta` above and below the line of the approximant.
const ABOVE: [f64; 5] =
    [1.0, 0.724_285_996_257_187, -0.340_359_759_053_664_33, 0.115_785_824_064_964_52, -0.012_602_164_012_313_871];
const BELOW: [f64; 6] = [
    1.0,
    -0.275_714_003_742_812_96,
    -0.846_649_755_310_851_4,
    0.645_813_233_158_710_6,
    -0.183_144_181_421_673_35,
    0.021_853_143_338_280_84,
];

/// `Z` of the liquid: the Padé approximant [4/5] in `2 eta` of the ten known virial coefficients, `B_2` to `B_10` of Clisby and McCoy
/// (2006, doi:10.1007/s10955-005-8080-0). Good to 0.1 % up to `eta = 0.6`. Neighbouring approximants agree as well beyond, but the liquid knows
/// of the transition before it comes: at 0.66 its pressure is lower by 0.7 %, at 0.68 by 2.5 % (`docs/experiments/hard-disk-melting.md`).
pub fn liquid(packing: f64) -> f64 {
    let polynomial = |coefficients: &[f64]| coefficients.iter().rev().fold(0.0, |sum, c| sum * 2.0 * packing + c);
    polynomial(&ABOVE) / polynomial(&BELOW)
}

/// The same of `count` discs in a periodic box ([`finite_size_shift`]).
pub fn liquid_of_few(packing: f64, count: usize) -> f64 {
    liquid(packing) + finite_size_shift::<2>(packing, count)
}

/// Collisions a disc suffers per time in units of `sqrt(kT/m)/s`, of `count` discs in a periodic box at a fixed energy with
/// `kT = E/(N - 1)`: the virial theorem with the mean impulse of a contact, `4 (Z_N - 1) sqrt(kT/(pi m))/s`, and the mean normal
/// velocity at fixed energy ([`super::closed_flux_factor`]).
pub fn collision_rate_of_few(packing: f64, count: usize) -> f64 {
    4.0 * (liquid_of_few(packing, count) - 1.0) / std::f64::consts::PI.sqrt()
        * super::closed_flux_factor(2.0 * (count as f64 - 1.0))
}

/// `Z` of the crystal: `2/a + 1.90 + 0.67 a` with the free area `a = A/A_0 - 1` over that at closest packing `A_0`. The first term is
/// exact at closest packing (Salsburg and Wood 1962, J. Chem. Phys. 37, 798), the others are measured (Alder, Hoover and Young
/// 1968, doi:10.1063/1.1670653).
pub fn crystal(packing: f64) -> f64 {
    let a = free_area(packing);
    2.0 / a + 1.90 + 0.67 * a
}

/// Standard error of [`crystal`], from `1.90 +- 0.01` and `0.67 +- 0.07`.
pub fn crystal_error(packing: f64) -> f64 {
    let slope: f64 = 0.07 * free_area(packing);
    (0.01 * 0.01 + slope * slope).sqrt()
}

/// `Z` of a crystal of `count` discs in a periodic box, without vacancies: `1/N + (1 - 1/N) Z`.
///
/// The two coordinates of the centre of mass have the whole box, the others shrink with the free area: the configurations
/// fill a volume `~ A a^(2(N - 1))` near closest packing. What is left out is of order 1 over `N`.
pub fn crystal_of_few(packing: f64, count: usize) -> f64 {
    let share = 1.0 / count as f64;
    share + (1.0 - share) * crystal(packing)
}

fn free_area(packing: f64) -> f64 {
    CLOSEST / packing - 1.0
}

/// `P s^2/kT` of `Z` at a packing fraction.
pub fn pressure(packing: f64, z: f64) -> f64 {
    z * packing / std::f64::consts::FRAC_PI_4
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::theory::{collision_rate, compressibility};

    /// Its series is that of the virial coefficients, `B_k/B_2^(k-1)`, as they stand here; they are rounded to six or seven digits.
    #[test]
    fn the_approximant_has_the_known_virial_coefficients() {
        let known =
            [1.0, 1.0, 0.782_004, 0.532_231_80, 0.333_556_04, 0.198_842_5, 0.114_872_8, 0.064_993_0, 0.036_219_3, 0.019_953_7];
        let mut series: Vec<f64> = vec![];
        for k in 0..known.len() {
            let carried: f64 = (1..=k.min(5)).map(|j| BELOW[j] * series[k - j]).sum();
            series.push(ABOVE.get(k).copied().unwrap_or(0.0) - carried);
        }
        for (found, known) in series.iter().zip(known) {
            assert!((found - known).abs() < 1e-8, "{found} {known}");
        }
    }

    /// Liquid and crystal meet the pressure of coexistence near the packing fractions of coexistence: the liquid's branch, which knows of
    /// no transition, crosses it before 0.70; the crystal's after 0.716, as the hexatic phase is no crystal.
    #[test]
    fn the_branches_lead_to_the_transition() {
        assert!((pressure(HEXATIC, crystal(HEXATIC)) / COEXISTENCE - 1.0).abs() < 0.05);
        assert!(pressure(0.68, liquid(0.68)) < COEXISTENCE && pressure(LIQUID, liquid(LIQUID)) > COEXISTENCE);
    }

    /// `P = -dF/dV`: with the volume of configurations `A (A/A_0 - 1)^(2(N - 1))`, by central differences.
    #[test]
    fn few_discs_near_closest_packing_have_the_pressure_of_their_free_area() {
        let (count, h) = (100, 1e-7);
        let packing = CLOSEST / 1.001;
        let ln_volume = |packing: f64| (CLOSEST / packing).ln() + 198.0 * (CLOSEST / packing - 1.0).ln();
        let z = -packing * (ln_volume(packing + h) - ln_volume(packing - h)) / (2.0 * h) / 100.0;
        assert!((crystal_of_few(packing, count) / z - 1.0).abs() < 1e-3, "{z}");
    }

    #[test]
    fn many_thin_discs_collide_as_enskog_says() {
        let (packing, density) = (0.05, 0.05 / std::f64::consts::FRAC_PI_4);
        let enskog = collision_rate::<2>(density, 1.0, 1.0, 1.0) * (liquid(packing) - 1.0) / (compressibility::<2>(packing) - 1.0);
        assert!((collision_rate_of_few(packing, 100_000_000) / enskog - 1.0).abs() < 1e-6);
    }
}
