//! Waves on a square lattice of masses: `omega^2 = 4 omega_0^2 (sin^2(k_x a/2) + sin^2(k_y a/2))`, in steps of velocity Verlet.

/// Wavenumber times spacing of waves in the direction `(cos, sin)`, for `s = sin(omega dt/2)/(omega_0 dt)`:
/// `sin^2(k cos/2) + sin^2(k sin/2) = s^2`.
pub(super) fn phase_in_direction(s: f64, cosine: f64, sine: f64) -> f64 {
    let excess = |k: f64| {
        let (x, y) = (libm::sin(0.5 * k * cosine), libm::sin(0.5 * k * sine));
        x * x + y * y - s * s
    };
    let (mut lower, mut upper) = (0.0, std::f64::consts::PI);
    for _ in 0..60 {
        let middle = 0.5 * (lower + upper);
        if excess(middle) < 0.0 { lower = middle } else { upper = middle }
    }
    0.5 * (lower + upper)
}

/// Frequency met ahead (`speed > 0`) or behind (`speed < 0`) of a shaker of frequency `omega` that moves along an axis at
/// `|speed|` spacings a unit of time: the `omega'` with `omega' - speed k(omega') = omega`, which is `omega/(1 - speed/c)` for long
/// waves. None where it does not exist.
pub(super) fn doppler(omega: f64, speed: f64, phase: impl Fn(f64) -> f64) -> Option<f64> {
    let excess = |candidate: f64| candidate - speed * phase(candidate) - omega;
    let (mut lower, mut upper) = (0.0, omega);
    while excess(upper) < 0.0 {
        upper *= 1.25;
        if !phase(upper).is_finite() {
            return None;
        }
    }
    for _ in 0..80 {
        let middle = 0.5 * (lower + upper);
        if excess(middle) < 0.0 { lower = middle } else { upper = middle }
    }
    Some(0.5 * (lower + upper))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_waves_have_no_direction_and_the_classical_shift() {
        let s = 1e-3;
        for angle in [0.0, 0.4, 0.785] {
            let (sine, cosine) = libm::sincos(angle);
            assert!((phase_in_direction(s, cosine, sine) / (2.0 * s) - 1.0).abs() < 1e-6);
        }
        let phase = |omega: f64| 2.0 * libm::asin(0.5 * omega);
        for speed in [0.4, -0.4] {
            let found = doppler(1e-3, speed, phase).unwrap();
            assert!((found * (1.0 - speed) / 1e-3 - 1.0).abs() < 1e-6, "{found}");
        }
    }
}
