//! What is known of the pressure of hard discs.

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
/// (2006, doi:10.1007/s10955-005-8080-0). Neighbouring approximants agree to 0.1 % up to [`CERTAIN`].
pub(super) fn liquid(packing: f64) -> f64 {
    let polynomial = |coefficients: &[f64]| coefficients.iter().rev().fold(0.0, |sum, c| sum * 2.0 * packing + c);
    polynomial(&ABOVE) / polynomial(&BELOW)
}

/// Packing fraction up to which it is.
pub(super) const CERTAIN: f64 = 0.6;

/// `Z` of the crystal by the free volume: `2/a + 1.90 + 0.67 a + 1.5 a^2`, `a = A/A_0 - 1` with the area `A_0` at closest packing (Alder,
/// Hoover and Young 1968, doi:10.1063/1.1670653).
pub(super) fn crystal(packing: f64) -> f64 {
    let a = CLOSEST / packing - 1.0;
    2.0 / a + 1.90 + 0.67 * a + 1.5 * a * a
}

/// Closest packing, `pi/(2 sqrt3)`.
const CLOSEST: f64 = 0.906_899_682_117_089_2;

/// Pressure `P s^2/kT` at which liquid and hexatic phase stand side by side, and their packing fractions (Bernard and Krauth
/// 2011, doi:10.1103/PhysRevLett.107.155704; by three methods Engel et al. 2013, doi:10.1103/PhysRevE.87.042134).
pub(super) const COEXISTENCE: f64 = 9.185;
pub(super) const LIQUID: f64 = 0.700;
pub(super) const HEXATIC: f64 = 0.716;

/// `Z` of `count` discs whose momentum is fixed, from that of many: of `N - 1` partners each, to first order.
pub(super) fn of_few(z: f64, count: usize) -> f64 {
    1.0 + (z - 1.0) * (1.0 - 1.0 / count as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Its series is that of the virial coefficients, `B_k/B_2^(k-1)`.
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
            assert!((found - known).abs() < 1e-9, "{found} {known}");
        }
    }

    /// Liquid and crystal meet the pressure of coexistence near the packing fractions of coexistence, to some percent.
    #[test]
    fn the_branches_lead_to_the_transition() {
        let pressure = |z: f64, packing: f64| z * packing / std::f64::consts::FRAC_PI_4;
        assert!((pressure(crystal(HEXATIC), HEXATIC) / COEXISTENCE - 1.0).abs() < 0.03);
        assert!((pressure(liquid(LIQUID), LIQUID) / COEXISTENCE - 1.0).abs() < 0.15);
    }
}
