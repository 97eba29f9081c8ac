//! A heavy sphere in a bath of light ones.

use std::f64::consts::PI;

/// Initial decay rate of the velocity autocorrelation of a sphere of mass `M` in a bath of hard spheres,
/// `gamma_0 = -C'(0) / C(0)`, exact given the contact value `chi` of the pair:
/// `2 n a chi sqrt(2 pi mu kT) / M` in 2-D, `(8/3) n a^2 chi sqrt(2 pi mu kT) / M` in 3-D, with the contact distance
/// `a = R_b + R` and the reduced mass `mu = m M / (m + M)` (Resibois and de Leener, Classical Kinetic Theory of Fluids,
/// 1977: binary collision term). For `M >> m` in a dilute bath the whole correlation is `exp(-gamma_0 t)`.
pub fn initial_friction<const D: usize>(
    density: f64,
    contact_distance: f64,
    contact_value: f64,
    bath_mass: f64,
    mass: f64,
    temperature: f64,
) -> f64 {
    let (n, a, chi) = (density, contact_distance, contact_value);
    let mu = bath_mass * mass / (bath_mass + mass);
    let momentum = (2.0 * PI * mu * temperature).sqrt();
    match const {
        assert!(D == 2 || D == 3, "known in two and three dimensions only");
        D
    } {
        2 => 2.0 * n * a * chi * momentum / mass,
        _ => 8.0 / 3.0 * n * a * a * chi * momentum / mass,
    }
}

/// Radial distribution of bath particles at contact with a single sphere of another size, to the accuracy of scaled-particle
/// theory: `1/(1 - eta) + A q eta/(1 - eta)^2 + B q^2 eta^2/(1 - eta)^3` with `q = s_B/a`, the tracer's diameter over the
/// contact distance, and the bath's packing fraction `eta`.
///
/// 2-D: `A = 9/16, B = 0` (Jenkins and Mancini 1987, doi:10.1115/1.3172990); 3-D: `A = 3/2, B = 1/2` (Boublik 1970,
/// doi:10.1063/1.1673824; Mansoori, Carnahan, Starling and Leland 1971, doi:10.1063/1.1675048). Equal sizes give
/// [`contact_value`](crate::theory::contact_value).
pub fn contact_value_of_tracer<const D: usize>(packing: f64, bath_radius: f64, radius: f64) -> f64 {
    let free = 1.0 - packing;
    let (first, second) = match const {
        assert!(D == 2 || D == 3, "known in two and three dimensions only");
        D
    } {
        2 => (9.0 / 16.0, 0.0),
        _ => (1.5, 0.5),
    };
    let crowding = 2.0 * radius / (radius + bath_radius) * packing / free;
    (1.0 + first * crowding + second * crowding * crowding) / free
}

/// Einstein's `D = kT / (M gamma)`.
pub fn diffusion_coefficient(temperature: f64, mass: f64, friction: f64) -> f64 {
    temperature / (mass * friction)
}

/// Mean squared displacement of an Ornstein-Uhlenbeck particle in `dimension` dimensions (Uhlenbeck and Ornstein 1930,
/// doi:10.1103/PhysRev.36.823): `2 d (kT/(M gamma)) (t - (1 - exp(-gamma t))/gamma)`, ballistic `d (kT/M) t^2` at first.
pub fn ornstein_uhlenbeck_displacement(dimension: usize, temperature: f64, mass: f64, friction: f64, time: f64) -> f64 {
    let x = friction * time;
    // x + expm1(-x) loses its digits where it is x^2/2: a few terms of its series serve there.
    let form = if x < 1e-3 { x * x * (0.5 - x / 6.0 + x * x / 24.0 - x * x * x / 120.0) } else { x + libm::expm1(-x) };
    2.0 * dimension as f64 * temperature / (mass * friction * friction) * form
}

/// Velocity autocorrelation of an Ornstein-Uhlenbeck particle: `d (kT/M) exp(-gamma t)`.
pub fn ornstein_uhlenbeck_velocity_correlation(dimension: usize, temperature: f64, mass: f64, friction: f64, time: f64) -> f64 {
    dimension as f64 * temperature / mass * libm::exp(-friction * time)
}

/// Mean squared displacement of a diffusing point between reflecting walls `length` apart, along that axis, started
/// anywhere: `L^2/6 - (16 L^2/pi^4) sum_(j odd) exp(-(j pi/L)^2 D t) / j^4`. It saturates at `L^2/6`.
pub fn closed_box_displacement(length: f64, diffusion: f64, time: f64) -> f64 {
    let rate = (PI / length) * (PI / length) * diffusion * time;
    let term = |j: f64| libm::exp(-j * j * rate) / (j * j * j * j);
    // The remainder after j = 199 is below 1/(6 200^3), 2e-8 of the leading term.
    let sum: f64 = (0..100).rev().map(|k| term(f64::from(2 * k + 1))).sum();
    length * length * (1.0 / 6.0 - 16.0 / (PI * PI * PI * PI) * sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::theory::collision_rate;

    /// Among its like (`M = m`) a particle loses `(g.k) k` of its velocity per collision, `g` the relative velocity. As
    /// `v = V + g/2` with the pair's `V` independent of `g`, `-<v.dv> = <(g.k)^2>/2`; weighted by flux, `<(g.k)^2>` is twice
    /// its variance `2 kT/m`: `2 kT/m` a collision, of `C(0) = D kT/m`. So `gamma_0` is `2/D` of the collision rate.
    #[test]
    fn friction_among_equals_follows_from_the_collision_rate() {
        let (n, s) = (1e-9, 1.0); // dilute: contact value 1
        let flat = initial_friction::<2>(n, s, 1.0, 1.0, 1.0, 1.0) / collision_rate::<2>(n, s, 1.0, 1.0);
        let round = initial_friction::<3>(n, s, 1.0, 1.0, 1.0, 1.0) / collision_rate::<3>(n, s, 1.0, 1.0);
        assert!((flat - 1.0).abs() < 1e-8 && (round - 2.0 / 3.0).abs() < 1e-8);
    }

    #[test]
    fn a_tracer_like_the_bath_has_the_contact_value_of_the_bath() {
        use crate::theory::contact_value;
        for eta in [0.01, 0.2, 0.4] {
            assert!((contact_value_of_tracer::<2>(eta, 0.5, 0.5) / contact_value::<2>(eta) - 1.0).abs() < 1e-15 * 10.0);
            assert!((contact_value_of_tracer::<3>(eta, 0.5, 0.5) / contact_value::<3>(eta) - 1.0).abs() < 1e-15 * 10.0);
        }
    }

    #[test]
    fn displacement_is_ballistic_then_diffusive_and_smooth_between() {
        let (d, t, m, gamma) = (3, 1.4, 5.0, 0.3);
        let msd = |time| ornstein_uhlenbeck_displacement(d, t, m, gamma, time);
        assert!((msd(1e-6) / (3.0 * t / m * 1e-12) - 1.0).abs() < 1e-6);
        let slope = (msd(201.0) - msd(200.0)) / 6.0;
        assert!((slope / diffusion_coefficient(t, m, gamma) - 1.0).abs() < 1e-10);
        let (below, above) = (msd(1e-3 / gamma * (1.0 - 1e-9)), msd(1e-3 / gamma * (1.0 + 1e-9)));
        assert!((above / below - 1.0 - 4e-9).abs() < 1e-11);
    }

    /// The second derivative of the displacement is twice the velocity correlation.
    #[test]
    fn displacement_and_velocity_correlation_belong_together() {
        let (time, h) = (2.0, 1e-3);
        let msd = |time| ornstein_uhlenbeck_displacement(2, 1.1, 3.0, 0.7, time);
        let curvature = (msd(time + h) - 2.0 * msd(time) + msd(time - h)) / (h * h);
        let correlation = ornstein_uhlenbeck_velocity_correlation(2, 1.1, 3.0, 0.7, time);
        assert!((curvature / (2.0 * correlation) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_closed_box_bounds_the_displacement() {
        let (l, d) = (3.0, 0.5);
        assert!((closed_box_displacement(l, d, 1e3) - l * l / 6.0).abs() < 1e-12);
        // Free diffusion at first, less what the walls turn back: 2 D t (1 - (8/3) sqrt(D t/pi)/L ...).
        let t = 1e-3;
        let free = 2.0 * d * t;
        assert!((closed_box_displacement(l, d, t) / free - 1.0).abs() < 0.03);
        assert!(closed_box_displacement(l, d, 0.0).abs() < 1e-6);
    }
}
