//! How much of the normal speed a contact leaves.

use corpuscle_core::Invalid;

/// Coefficient of restitution `e`: the normal relative speed after a contact is `e` times that before.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Restitution {
    /// The same at all speeds, in `[0, 1]`. 1 is elastic.
    Constant(f64),
    /// Viscoelastic spheres: Hertz's force `rho xi^(3/2)` of the compression `xi`, with a dissipation in proportion to its
    /// rate, `(3/2) A rho sqrt(xi) dxi/dt`.
    ///
    /// With `beta = (3/2) A kappa^(2/5)`, `kappa = E sqrt(R_eff) / m_eff`, and `x = beta^(1/2) v^(1/10)`
    ///
    /// > `e(v) = (1 + c x) / (1 + c x + b2 x^2 + b3 x^3 + b4 x^4)`
    ///
    /// (Müller and Pöschel, Phys. Rev. E 84, 021302 (2011), doi:10.1103/PhysRevE.84.021302), which sums the series
    /// `1 - C1 beta v^(1/5) + C2 beta^2 v^(2/5) - ...` of Schwager and Pöschel, Phys. Rev. E 78, 051304 (2008),
    /// doi:10.1103/PhysRevE.78.051304, and is within 0.009 of the integrated equation of motion at all speeds. A wall
    /// counts as a sphere of infinite radius and mass. Points (`R = 0`) stay elastic.
    ///
    /// `e` tends to 1 for slow contacts, so that a free gas of these spheres does not collapse. Under gravity one still comes
    /// to rest on a floor in finite time after infinitely many contacts, `v ~ n^-5`, and needs `elastic_below`.
    Viscoelastic {
        /// `E = 2 Y / (3 (1 - nu^2))` with Young's modulus `Y` and Poisson's ratio `nu`, energy per volume.
        stiffness: f64,
        /// `A`, a function of the material's viscosities, a time.
        dissipation_time: f64,
    },
}

impl From<f64> for Restitution {
    fn from(constant: f64) -> Self {
        Self::Constant(constant)
    }
}

impl Restitution {
    /// Whether every contact keeps the energy.
    pub fn is_elastic(&self) -> bool {
        match *self {
            Self::Constant(e) => e == 1.0,
            Self::Viscoelastic { stiffness, dissipation_time } => stiffness * dissipation_time == 0.0,
        }
    }

    /// `e` of a contact approached at this normal speed, of two radii (infinity for a wall), with the reduced mass.
    #[inline]
    pub fn at(&self, speed: f64, radii: [f64; 2], mass: f64) -> f64 {
        match *self {
            Self::Constant(e) => e,
            Self::Viscoelastic { stiffness, dissipation_time } => {
                let effective = 1.0 / (1.0 / radii[0] + 1.0 / radii[1]);
                let kappa = stiffness * effective.sqrt() / mass;
                viscoelastic(1.5 * dissipation_time * libm::pow(kappa * kappa * speed.max(0.0), 0.2))
            }
        }
    }

    pub(crate) fn validate(&self) -> Result<(), Invalid> {
        match *self {
            Self::Constant(e) if !(0.0..=1.0).contains(&e) => Err(Invalid::new("restitution", e, "a number from 0 to 1")),
            Self::Viscoelastic { stiffness, dissipation_time } => {
                for (key, value) in [("stiffness", stiffness), ("dissipation_time", dissipation_time)] {
                    if !(value >= 0.0 && value.is_finite()) {
                        return Err(Invalid::new(key, value, "a finite number, zero or more"));
                    }
                }
                Ok(())
            }
            Self::Constant(_) => Ok(()),
        }
    }
}

/// `e` as a function of `beta v^(1/5)`.
fn viscoelastic(x_squared: f64) -> f64 {
    let x = x_squared.sqrt();
    let numerator = 1.0 + 0.501_086 * x;
    numerator / (numerator + x_squared * (1.153_45 + x * (0.577_977 + x * 0.532_178)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `x'' = -x^(3/2) - beta sqrt(x) x'` from contact at speed 1 until the force has fallen to zero; Runge-Kutta.
    fn integrated(beta: f64) -> f64 {
        let dt = 1e-4;
        let force = |x: f64, v: f64| -x.max(0.0).sqrt() * (x + beta * v);
        let (mut x, mut v) = (0.0, 1.0);
        while v > 0.0 || x + beta * v > 0.0 {
            let (v1, a1) = (v, force(x, v));
            let (v2, a2) = (v + 0.5 * dt * a1, force(x + 0.5 * dt * v1, v + 0.5 * dt * a1));
            let (v3, a3) = (v + 0.5 * dt * a2, force(x + 0.5 * dt * v2, v + 0.5 * dt * a2));
            let (v4, a4) = (v + dt * a3, force(x + dt * v3, v + dt * a3));
            x += dt / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
            v += dt / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
        }
        -v
    }

    /// The approximant's own error: of higher than the fourth power in `beta^(1/2)`, and below 0.009 everywhere.
    #[test]
    fn viscoelastic_restitution_follows_from_the_equation_of_motion() {
        for (beta, error) in [(0.01, 3e-7), (0.1, 6e-5), (0.5, 2e-3), (1.0, 5e-3), (2.0, 9e-3), (4.0, 9e-3)] {
            let (found, expected) = (viscoelastic(beta), integrated(beta));
            println!("beta {beta}: {found:.6}, equation of motion {expected:.6}");
            assert!((found - expected).abs() < error, "beta {beta}: {found}, expected {expected}");
        }
    }

    /// Everything follows from `beta v^(1/5)`: 32 times the speed is twice `A`.
    #[test]
    fn speed_scales_as_dimensions_say() {
        let law = |dissipation_time: f64| Restitution::Viscoelastic { stiffness: 50.0, dissipation_time };
        let (fast, lossy) = (law(0.01).at(32.0, [0.5, 0.5], 0.5), law(0.02).at(1.0, [0.5, 0.5], 0.5));
        assert!((fast - lossy).abs() < 1e-14);
        assert!(law(0.01).at(1e-12, [0.5, 0.5], 0.5) > law(0.01).at(1e-6, [0.5, 0.5], 0.5));
        assert_eq!(law(0.01).at(0.0, [0.5, 0.5], 0.5), 1.0);
    }
}
