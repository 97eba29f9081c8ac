//! One wave in linear hydrodynamics: Navier, Stokes and Fourier with Enskog's coefficients.
//!
//! Of `delta n/n = r sin(k x)`, `u = q cos(k x)` and `delta T = h sin(k x)`, with `kT` and the mass as units,
//! `r' = k q`, `q' = -k ((eta Z)' T r + Z h) - nu k^2 q`, `h' = T Z k q - (lambda/n) k^2 h`: the longitudinal viscosity
//! `nu = (eta_s + zeta)/rho` and the heat conductivity `lambda` damp the wave, and leave heat behind where it has been.

use std::f64::consts::PI;

use corpuscle_observe::theory;

/// A wave of discs of diameter and mass 1.
pub(super) struct Wave {
    k: f64,
    temperature: f64,
    /// `d(eta Z)/d eta`, `Z`.
    stiffness: f64,
    compressibility: f64,
    /// `(eta_s + zeta)/rho` and `lambda/n`.
    viscosity: f64,
    conductivity: f64,
}

impl Wave {
    /// Enskog's shear viscosity, bulk viscosity and heat conductivity of hard discs (Gass 1971, doi:10.1063/1.1675116): with
    /// `b n = 2 eta` and the contact value `chi`
    /// `eta_s = eta_0 (1/chi + b n + 0.8729 (b n)^2 chi)`, `zeta = 1.246 (b n)^2 chi eta_0`,
    /// `lambda = lambda_0 (1/chi + 3 b n/2 + 0.8718 (b n)^2 chi)`, where `eta_0 = 1.022 sqrt(kT/pi)/2`,
    /// `lambda_0 = 1.029 x 2 sqrt(kT/pi)`.
    pub(super) fn new(packing: f64, temperature: f64, k: f64) -> Self {
        let chi = theory::contact_value::<2>(packing);
        let (bn, density, root) = (2.0 * packing, 4.0 * packing / PI, (temperature / PI).sqrt());
        let (thin_viscosity, thin_conductivity) = (1.022 * 0.5 * root, 1.029 * 2.0 * root);
        let shear = thin_viscosity * (1.0 / chi + bn + 0.8729 * bn * bn * chi);
        let bulk = thin_viscosity * 1.246 * bn * bn * chi;
        let conductivity = thin_conductivity * (1.0 / chi + 1.5 * bn + 0.8718 * bn * bn * chi);
        Self {
            k,
            temperature,
            stiffness: 1.0 / theory::reduced_compressibility::<2>(packing),
            compressibility: theory::compressibility::<2>(packing),
            viscosity: (shear + bulk) / density,
            conductivity: conductivity / density,
        }
    }

    fn slope(&self, [r, q, h]: [f64; 3]) -> [f64; 3] {
        let k = self.k;
        let pressure = self.stiffness * self.temperature * r + self.compressibility * h;
        [
            k * q,
            -k * pressure - self.viscosity * k * k * q,
            self.temperature * self.compressibility * k * q - self.conductivity * k * k * h,
        ]
    }

    /// The longitudinal viscosity `nu`.
    #[cfg(test)]
    pub(super) fn viscosity(&self) -> f64 {
        self.viscosity
    }

    /// `q`, `r` and `h` at so many samples, this far apart in time, of a wave that starts with `q = 1` alone: Runge-Kutta of order 4,
    /// eight steps a sample.
    pub(super) fn samples(&self, interval: f64, count: usize) -> [Vec<f64>; 3] {
        const STEPS: u32 = 8;
        let h = interval / f64::from(STEPS);
        let mut state = [0.0, 1.0, 0.0];
        let (mut velocity, mut density, mut heat) = (vec![], vec![], vec![]);
        for _ in 0..count {
            velocity.push(state[1]);
            density.push(state[0]);
            heat.push(state[2]);
            for _ in 0..STEPS {
                let ahead = |slope: [f64; 3], part: f64| std::array::from_fn(|i| state[i] + part * h * slope[i]);
                let a = self.slope(state);
                let b = self.slope(ahead(a, 0.5));
                let c = self.slope(ahead(b, 0.5));
                let d = self.slope(ahead(c, 1.0));
                state = std::array::from_fn(|i| state[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
            }
        }
        [velocity, density, heat]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Long waves: the speed is that of the adiabat, and the damping `Gamma = (nu + (1 - c_T^2/c^2) lambda/n)/2`, from the
    /// expansion of the dispersion relation, `(gamma - 1) D_T` with `D_T = lambda/(n c_p)` being `(1 - 1/gamma) lambda/(n c_V)`.
    ///
    /// Looked at is the velocity: of the heat that stays behind, which the density shows in the first order of `k`, it knows in the
    /// second only.
    #[test]
    fn long_waves_run_with_the_speed_of_the_adiabat() {
        let (packing, temperature, k) = (0.3, 1.3, 1e-4);
        let wave = Wave::new(packing, temperature, k);
        let c = theory::speed_of_sound::<2>(packing, temperature, 1.0);
        let half = 0.5 * std::f64::consts::TAU / (c * k);
        let [velocity, ..] = wave.samples(half / 800.0, 801);
        let isothermal = wave.stiffness * temperature / (c * c);
        let damping = 0.5 * (wave.viscosity + (1.0 - isothermal) * wave.conductivity) * k * k * half;
        assert!(velocity[400].abs() < damping, "a quarter of a period: {} {damping}", velocity[400]);
        let measured = -libm::log(-velocity[800]);
        assert!((measured / damping - 1.0).abs() < 10.0 * damping, "{measured} {damping}");
    }
}
