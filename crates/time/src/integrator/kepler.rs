//! Motion of one body around a fixed centre, for any time and any orbit.

use corpuscle_core::Vector;

/// Place and velocity after the time `dt`, on an orbit around the origin with `mu = G M`, from place `r` and velocity `v`.
///
/// Kepler's equation in the universal variable `s`, `ds = dt/r`, one form for ellipses, parabolas and hyperbolas (Danby 1992,
/// Fundamentals of Celestial Mechanics, section 6.9): with `beta = 2 mu/r - v^2` and `G_n = s^n c_n(beta s^2)`, Stumpff's
/// functions, `dt = r G_1 + (r.v) G_2 + mu G_3`. Its slope is the distance from the centre and never negative, so that
/// Newton's iteration in a shrinking bracket always ends. `None` where the orbit leads through the centre, or the numbers are
/// none.
pub(super) fn kepler<const D: usize>(mu: f64, r: Vector<D>, v: Vector<D>, dt: f64) -> Option<(Vector<D>, Vector<D>)> {
    if dt < 0.0 {
        let (r, v) = kepler(mu, r, -v, -dt)?;
        return Some((r, -v));
    }
    let distance = r.norm();
    let radial = r.dot(v);
    let beta = 2.0 * mu / distance - v.norm_squared();
    if !(distance > 0.0 && distance.is_finite() && beta.is_finite()) {
        return None;
    }
    // Whole turns lead nowhere.
    let turn = std::f64::consts::TAU / beta.sqrt();
    let period = mu * turn / beta;
    let dt = if beta > 0.0 && dt > period { dt - period * (dt / period).floor() } else { dt };
    let functions = |s: f64| {
        let [c1, c2, c3] = stumpff(beta * s * s);
        let g = [s * c1, s * s * c2, s * s * s * c3];
        let time = distance * g[0] + radial * g[1] + mu * g[2];
        // r G_0 + (r.v) G_1 + mu G_2, where G_0 = 1 - beta G_2
        let now = distance + radial * g[0] + (mu - beta * distance) * g[1];
        (g, time, now)
    };
    let (mut low, mut high) = (0.0, if beta > 0.0 { turn } else { dt / distance });
    while functions(high).1 < dt {
        low = high;
        high *= 2.0;
        if !high.is_finite() {
            return None;
        }
    }
    let mut s = (dt / distance).clamp(low, high);
    let mut change = high - low;
    for _ in 0..MOST_ROUNDS {
        let (_, time, now) = functions(s);
        if time < dt {
            low = s;
        } else {
            high = s;
        }
        let newton = s - (time - dt) / now;
        // Newton's steps shrink in the end; where they do not yet, halving the bracket is faster.
        let shrinks = low <= newton && newton <= high && (newton - s).abs() <= 0.5 * change;
        let next = if shrinks { newton } else { 0.5 * (low + high) };
        change = (next - s).abs();
        s = next;
        if change <= 2.0 * f64::EPSILON * s {
            break;
        }
    }
    let (g, _, now) = functions(s);
    let (f, f_rate) = (1.0 - mu * g[1] / distance, -mu * g[0] / (distance * now));
    let (h, h_rate) = (dt - mu * g[2], 1.0 - mu * g[1] / now);
    let (place, velocity) = (r * f + v * h, r * f_rate + v * h_rate);
    (place.is_finite() && velocity.is_finite()).then_some((place, velocity))
}

/// Bisection alone needs no more than there are bits in a number, and as many to find the exponent.
const MOST_ROUNDS: u32 = 120;

/// Stumpff's functions `c_n(x) = sum_j (-x)^j/(n + 2 j)!`, `n = 1, 2, 3`.
fn stumpff(x: f64) -> [f64; 3] {
    if x.abs() <= 1.0 {
        // The first term left out is below 1/20!.
        let series =
            |n: f64| (0..9).rev().map(f64::from).fold(1.0, |sum, j| 1.0 - x * sum / ((2.0 * j + n + 1.0) * (2.0 * j + n + 2.0)));
        let c3 = series(3.0) / 6.0;
        return [1.0 - x * c3, 0.5 * series(2.0), c3];
    }
    let root = x.abs().sqrt();
    let (sine, cosine) = if x > 0.0 { libm::sincos(root) } else { (libm::sinh(root), libm::cosh(root)) };
    let c1 = sine / root;
    [c1, (1.0 - cosine) / x, (1.0 - c1) / x]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stumpff_s_functions_are_sines_and_their_hyperbolic_kin() {
        for step in 1..400 {
            let root = 0.03 * f64::from(step);
            for (x, sine, cosine) in [(root * root, root.sin(), root.cos()), (-root * root, root.sinh(), root.cosh())] {
                let [c1, c2, c3] = stumpff(x);
                let scale = if x > 0.0 { 1.0 } else { cosine };
                let bound = 8.0 * f64::EPSILON * scale;
                assert!((c1 * root - sine).abs() < bound * root, "{x}: {c1}");
                assert!((c2 * x - (1.0 - cosine)).abs() < bound, "{x}: {c2}");
                assert!((c3 * x - (1.0 - sine / root)).abs() < bound, "{x}: {c3}");
            }
        }
    }

    /// Ellipses up to 0.999, the parabola, hyperbolas; forwards over many turns and back.
    #[test]
    fn orbits_keep_energy_and_lead_back() {
        for e in [0.0, 0.3, 0.9, 0.999, 1.0, 1.5, 20.0] {
            let (r, v) = (Vector([1.0 - 0.5f64 * if e < 1.0 { e } else { 0.0 }, 0.0]), Vector([0.0, 1.0]));
            let mu = r.norm() / (1.0 + e); // perihelion: v^2 = mu (1 + e)/r
            for dt in [1e-3, 0.1, 1.0, 7.0, 300.0] {
                let (r2, v2) = kepler(mu, r, v, dt).unwrap();
                let energy = |r: Vector<2>, v: Vector<2>| 0.5 * v.norm_squared() - mu / r.norm();
                let size = 0.5 * v2.norm_squared() + mu / r2.norm() + 0.5;
                assert!(
                    (energy(r2, v2) - energy(r, v)).abs() < 100.0 * f64::EPSILON * size,
                    "e = {e}, dt = {dt}: {:e} of {size}",
                    energy(r2, v2) - energy(r, v)
                );
                let (r3, v3) = kepler(mu, r2, v2, -dt).unwrap();
                // A rounding of the velocity shifts the place by as much times the time; near the centre it counts more.
                let bound = 100.0 * f64::EPSILON * (1.0 + dt) * (1.0 + r2.norm()) / (1.0 - e).abs().clamp(1e-3, 1.0).powi(2);
                assert!((r3 - r).norm() < bound && (v3 - v).norm() < bound, "e = {e}, dt = {dt}: {:e}", (r3 - r).norm());
            }
        }
    }

    #[test]
    fn an_ellipse_obeys_kepler_s_own_equation() {
        let e = 0.6;
        let (r, v) = (Vector([1.0 - e, 0.0]), Vector([0.0, ((1.0 + e) / (1.0 - e)).sqrt()]));
        for step in 1..100 {
            let anomaly = 0.0628 * f64::from(step);
            let time = anomaly - e * f64::sin(anomaly);
            let expected = Vector([anomaly.cos() - e, (1.0 - e * e).sqrt() * anomaly.sin()]);
            let (found, _) = kepler(1.0, r, v, time).unwrap();
            assert!((found - expected).norm() < 1e-14, "{anomaly}: {:e}", (found - expected).norm());
        }
    }

    #[test]
    fn no_number_is_no_orbit() {
        assert!(kepler(1.0, Vector([0.0, 0.0]), Vector([1.0, 0.0]), 1.0).is_none());
        assert!(kepler(1.0, Vector([f64::NAN, 0.0]), Vector([1.0, 0.0]), 1.0).is_none());
    }
}
