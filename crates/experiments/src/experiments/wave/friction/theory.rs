//! What friction does to a chain, exactly and in continuous time, on the lattice.

/// Amplitude that comes back from a last mass braked by the force `-Z' du/dt`, over the one sent, for a wave with the phase advance
/// `theta = k a` from mass to mass and `z = Z'/sqrt(kappa m)`: real and imaginary part, waves turning half a spacing behind the mass.
///
/// With `U_n = exp(i theta n) + R exp(-i theta n)` and `exp(-i omega t)`, the last mass at `n = -1/2` obeys the law of the others if
/// `kappa (U_{1/2} - U_{-1/2}) = i omega Z' U_{-1/2}`. So `R = (1 - z exp(-i theta/2))/(1 + z exp(i theta/2))`; of long waves it is
/// `(1 - z)/(1 + z) = (Z - Z')/(Z + Z')`.
pub(super) fn echo(impedance: f64, theta: f64) -> (f64, f64) {
    let (sine, cosine) = libm::sincos(0.5 * theta);
    quotient((1.0 - impedance * cosine, impedance * sine), (1.0 + impedance * cosine, impedance * sine))
}

/// Displacement at time `t` of an oscillator `q'' + gamma q' + omega^2 q = 0` that is let go at 1.
pub(super) fn release(omega: f64, gamma: f64, t: f64) -> f64 {
    let half = 0.5 * gamma;
    let square = omega * omega - half * half;
    let rate = square.abs().sqrt();
    // Below a hundredth of a radian the first terms of sine and hyperbolic sine are exact.
    let (even, odd) = if rate * t < 1e-9 {
        (1.0, t)
    } else if square > 0.0 {
        (libm::cos(rate * t), libm::sin(rate * t) / rate)
    } else {
        (libm::cosh(rate * t), libm::sinh(rate * t) / rate)
    };
    libm::exp(-half * t) * (even + half * odd)
}

/// Displacement of mass `n = 1..=count` of a chain that is shaken by `sin(omega t)` at 0 and held at `count + 1`, with the friction
/// `-m gamma v` on each mass, when all else has died away: the factors of `sin(omega t)` and `cos(omega t)`.
///
/// `sin(theta (count + 1 - n))/sin(theta (count + 1))` with the complex phase advance of `cos(theta) = 1 - (omega^2 - i gamma
/// omega)/(2 omega_0^2)`, by the recurrence of Chebyshev's polynomials in `cos(theta)`.
pub(super) fn response(omega: f64, gamma: f64, omega_0: f64, count: usize) -> Vec<(f64, f64)> {
    let scale = 0.5 / (omega_0 * omega_0);
    let cosine = (1.0 - omega * omega * scale, gamma * omega * scale);
    let mut sines = vec![(0.0, 0.0), (1.0, 0.0)];
    for k in 1..=count {
        let next = product((2.0 * cosine.0, 2.0 * cosine.1), sines[k]);
        sines.push((next.0 - sines[k - 1].0, next.1 - sines[k - 1].1));
    }
    (1..=count).map(|n| quotient(sines[count + 1 - n], sines[count + 1])).collect()
}

fn product(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

fn quotient(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    let square = b.0 * b.0 + b.1 * b.1;
    let (re, im) = product(a, (b.0, -b.1));
    (re / square, im / square)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_that_are_known() {
        assert_eq!(echo(0.0, 0.7), (1.0, 0.0)); // free
        let (re, im) = echo(1e12, 0.0);
        assert!((re + 1.0).abs() < 1e-11 && im.abs() < 1e-11); // held
        assert_eq!(echo(1.0, 0.0), (0.0, 0.0));
        // A matched end sends tan(theta/4) back.
        let (re, im) = echo(1.0, 0.8);
        assert!((re.hypot(im) - libm::tan(0.2)).abs() < 1e-15);
    }

    /// `q'' + gamma q' + omega^2 q = 0` by differences, below, at and above critical damping.
    #[test]
    fn a_release_obeys_its_equation() {
        for gamma in [0.1, 1.3, 2.6, 2.6 + 1e-12, 5.0] {
            let (omega, h) = (1.3, 1e-4);
            for t in [0.3, 1.0, 2.5] {
                let [a, b, c] = [t - h, t, t + h].map(|t| release(omega, gamma, t));
                let residual = (a - 2.0 * b + c) / (h * h) + gamma * (c - a) / (2.0 * h) + omega * omega * b;
                assert!(residual.abs() < 1e-6, "{gamma} {t} {residual}");
            }
            assert_eq!(release(omega, gamma, 0.0), 1.0);
        }
    }

    /// Each mass obeys `-omega^2 u_n = omega_0^2 (u_{n+1} - 2 u_n + u_{n-1}) - i gamma omega u_n`.
    #[test]
    fn a_response_obeys_the_chain() {
        let (omega, gamma, omega_0, count) = (0.4, 0.05, 1.1, 12);
        let mut u = vec![(1.0, 0.0)];
        u.extend(response(omega, gamma, omega_0, count));
        u.push((0.0, 0.0));
        for three in u.windows(3) {
            let bend = |pick: fn((f64, f64)) -> f64| omega_0 * omega_0 * (pick(three[0]) - 2.0 * pick(three[1]) + pick(three[2]));
            let re = omega * omega * three[1].0 + bend(|c| c.0) + gamma * omega * three[1].1;
            let im = omega * omega * three[1].1 + bend(|c| c.1) - gamma * omega * three[1].0;
            assert!(re.abs() < 1e-12 && im.abs() < 1e-12);
        }
    }
}
