//! Waves on a chain of masses `m` joined by springs `kappa`, spacing `a`.

use std::f64::consts::PI;

/// Dispersion `omega(k) = 2 sqrt(kappa/m) |sin(k a/2)|`; none propagates above `2 sqrt(kappa/m)`.
pub fn chain_dispersion(wave_number: f64, spacing: f64, stiffness: f64, mass: f64) -> f64 {
    2.0 * (stiffness / mass).sqrt() * libm::sin(0.5 * wave_number * spacing).abs()
}

/// Wave number of a wave of angular frequency `omega` that runs to the right; none above the cut-off.
pub fn chain_wave_number(frequency: f64, spacing: f64, stiffness: f64, mass: f64) -> Option<f64> {
    let sine = 0.5 * frequency * (mass / stiffness).sqrt();
    (sine <= 1.0).then(|| 2.0 * libm::asin(sine) / spacing)
}

/// Group velocity `d omega/dk = a sqrt(kappa/m) cos(k a/2)` for `0 <= k a <= pi`.
pub fn chain_group_velocity(wave_number: f64, spacing: f64, stiffness: f64, mass: f64) -> f64 {
    long_wave_speed(spacing, stiffness, mass) * libm::cos(0.5 * wave_number * spacing)
}

/// Speed of long waves, `a sqrt(kappa/m)`; for a string under tension `T`, `kappa = T/a` and the speed is `sqrt(T/mu)`.
pub fn long_wave_speed(spacing: f64, stiffness: f64, mass: f64) -> f64 {
    spacing * (stiffness / mass).sqrt()
}

/// Amplitude reflected where the impedance `Z = sqrt(T mu)` changes, in the long-wave limit: `(Z1 - Z2)/(Z1 + Z2)`.
pub fn reflection(from_impedance: f64, to_impedance: f64) -> f64 {
    (from_impedance - to_impedance) / (from_impedance + to_impedance)
}

/// Amplitude transmitted where the impedance changes: `2 Z1/(Z1 + Z2)`.
pub fn transmission(from_impedance: f64, to_impedance: f64) -> f64 {
    2.0 * from_impedance / (from_impedance + to_impedance)
}

/// Share of the energy reflected at the joint of two half-chains of masses `m1`, `m2` with equal springs, at any frequency:
/// `(sin((k2 - k1) a/2) / sin((k1 + k2) a/2))^2`; 1 above the cut-off of the second.
///
/// Follows from continuing either side's wave by one mass beyond the joint: `1 + r = t` and
/// `exp(i k1 a) + r exp(-i k1 a) = t exp(i k2 a)`. Its long-wave limit is the square of [`reflection`]. None above the first
/// chain's own cut-off.
pub fn chain_energy_reflection(frequency: f64, stiffness: f64, from_mass: f64, to_mass: f64) -> Option<f64> {
    let k1 = chain_wave_number(frequency, 1.0, stiffness, from_mass)?;
    let Some(k2) = chain_wave_number(frequency, 1.0, stiffness, to_mass) else { return Some(1.0) };
    let r = libm::sin(0.5 * (k2 - k1)) / libm::sin(0.5 * (k1 + k2));
    Some(r * r)
}

/// Frequency at which velocity Verlet and leapfrog let a mode of true frequency `omega` swing:
/// `sin(omega' dt/2) = omega dt/2`; none at `omega dt > 2`, where they blow up.
pub fn verlet_frequency(frequency: f64, step: f64) -> Option<f64> {
    let half = 0.5 * frequency * step;
    if half == 0.0 {
        return Some(frequency);
    }
    (half <= 1.0).then(|| 2.0 * libm::asin(half) / step)
}

/// Angular frequency of mode `(j, l)` of a square membrane of `N1 x N2` masses with fixed edges: the root of the sum of the
/// two directions' squares, each `2 sqrt(kappa/m) sin(j pi/(2 (N + 1)))`.
pub fn membrane_frequency(modes: [usize; 2], masses: [usize; 2], stiffness: f64, mass: f64) -> f64 {
    let direction = |k: usize| libm::sin(0.5 * PI * modes[k] as f64 / (masses[k] as f64 + 1.0));
    let (x, y) = (direction(0), direction(1));
    2.0 * (stiffness / mass * (x * x + y * y)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn group_velocity_is_the_slope_of_the_dispersion_and_the_wave_number_its_inverse() {
        let (a, kappa, m, h) = (0.5, 3.0, 2.0, 1e-5);
        for k in [0.2, 1.0, 4.0] {
            let slope = (chain_dispersion(k + h, a, kappa, m) - chain_dispersion(k - h, a, kappa, m)) / (2.0 * h);
            assert!((slope - chain_group_velocity(k, a, kappa, m)).abs() < 1e-9);
            let back = chain_wave_number(chain_dispersion(k, a, kappa, m), a, kappa, m).unwrap();
            assert!((back - k).abs() < 1e-13);
        }
        assert!(chain_wave_number(2.0 * (kappa / m).sqrt() * 1.01, a, kappa, m).is_none());
    }

    #[test]
    fn energy_adds_to_one_and_long_waves_see_the_string() {
        let (z1, z2) = (1.0, 2.5);
        let (r, t) = (reflection(z1, z2), transmission(z1, z2));
        assert!((r * r + z2 / z1 * t * t - 1.0).abs() < 1e-15);
        let long = chain_energy_reflection(1e-4, 1.0, 1.0, 6.25).unwrap();
        assert!((long / (r * r) - 1.0).abs() < 1e-6);
        assert_eq!(chain_energy_reflection(1.0, 1.0, 1.0, 6.25), Some(1.0));
    }

    /// The joint solved as equations of motion: mass 0 (m1) and mass 1 (m2) with the incoming, reflected and transmitted wave.
    #[test]
    fn the_reflected_wave_obeys_the_equations_of_motion_at_the_joint() {
        let (omega, kappa, m1, m2) = (0.6, 1.0, 1.0, 3.0);
        let k1 = chain_wave_number(omega, 1.0, kappa, m1).unwrap();
        let k2 = chain_wave_number(omega, 1.0, kappa, m2).unwrap();
        // Two complex unknowns r, t: kappa (u_(n-1) - 2 u_n + u_(n+1)) + m_n omega^2 u_n = 0 at n = 0 and n = 1.
        let unit = |phase: f64| (libm::cos(phase), libm::sin(phase));
        let mul = |x: (f64, f64), y: (f64, f64)| (x.0 * y.0 - x.1 * y.1, x.0 * y.1 + x.1 * y.0);
        let add = |x: (f64, f64), y: (f64, f64)| (x.0 + y.0, x.1 + y.1);
        let scale = |x: (f64, f64), s: f64| (x.0 * s, x.1 * s);
        let d1 = m1 * omega * omega - 2.0 * kappa;
        let d2 = m2 * omega * omega - 2.0 * kappa;
        // n = 0: kappa (e^(-ik1) + r e^(ik1)) + d1 (1 + r) + kappa t e^(ik2) = 0
        // n = 1: kappa (1 + r) + d2 t e^(ik2) + kappa t e^(2ik2) = 0
        let (a11, a12, b1) =
            (add(scale(unit(k1), kappa), (d1, 0.0)), scale(unit(k2), kappa), scale(add(scale(unit(-k1), kappa), (d1, 0.0)), -1.0));
        let (a21, a22, b2) = ((kappa, 0.0), add(scale(unit(k2), d2), scale(unit(2.0 * k2), kappa)), (-kappa, 0.0));
        let minus = |x: (f64, f64), y: (f64, f64)| add(x, scale(y, -1.0));
        let top = minus(mul(b1, a22), mul(a12, b2));
        let bottom = minus(mul(a11, a22), mul(a12, a21));
        let square = |x: (f64, f64)| x.0 * x.0 + x.1 * x.1;
        let share = square(top) / square(bottom);
        assert!((share - chain_energy_reflection(omega, kappa, m1, m2).unwrap()).abs() < 1e-13);
    }

    /// Velocity Verlet of one oscillator: the trace of its step's matrix is `2 cos(omega' dt) = 2 - (omega dt)^2`.
    #[test]
    fn verlets_frequency_is_that_of_its_step() {
        let (omega, dt) = (3.0, 0.4);
        let shifted = verlet_frequency(omega, dt).unwrap();
        assert!((2.0 * libm::cos(shifted * dt) - (2.0 - omega * omega * dt * dt)).abs() < 1e-14);
        assert!(verlet_frequency(5.1, 0.4).is_none() && verlet_frequency(0.0, 0.4) == Some(0.0));
    }
}
