//! What is touched at a fixed distance from a point: rims of holes, and obstacles.

use corpuscle_core::{Vector, polynomial};

use crate::motion::contact_delay;

/// First `t >= 0` at which `|r + v t + g t^2 / 2|` falls to `s`; infinity for never.
pub(super) fn fall_delay<const D: usize>(r: Vector<D>, v: Vector<D>, g: Vector<D>, s: f64) -> f64 {
    if g == Vector::ZERO {
        return contact_delay(r, v, s);
    }
    let c = r.norm_squared() - s * s;
    if c <= 0.0 && r.dot(v) < 0.0 {
        return 0.0;
    }
    let Some((from, to)) = within_reach(r, v, g, s) else { return f64::INFINITY };
    // The distance squared, less that at contact: a quartic. `from` and `to` only save work, they bound no root.
    let quartic = [c, 2.0 * r.dot(v), v.norm_squared() + r.dot(g), v.dot(g), 0.25 * g.norm_squared()];
    // Where the distance falls, the contact; where it grows, the end of an overlap by rounding.
    let falling = |t: f64| (r + v * t + g * (0.5 * t * t)).dot(v + g * t) < 0.0;
    polynomial::roots(&quartic, from, to).iter().copied().find(|&t| falling(t)).unwrap_or(f64::INFINITY)
}

/// A stretch of time outside of which the parabola is certainly further than `s` away: across the field the motion is
/// uniform, along it `q + w t + a t^2 / 2`, and neither part may be larger than `s`.
fn within_reach<const D: usize>(r: Vector<D>, v: Vector<D>, g: Vector<D>, s: f64) -> Option<(f64, f64)> {
    let s = s * (1.0 + 1e-9);
    let a = g.norm();
    let along = g / a;
    let (q, w) = (r.dot(along), v.dot(along));
    // Once past the far side, `q = s`, the field takes it away for ever.
    let disc = w * w + 2.0 * a * (s - q);
    if disc < 0.0 {
        return None;
    }
    let (mut from, mut to) = (0.0, (disc.sqrt() - w) / a);
    let (p, u) = (r - along * q, v - along * w);
    let (pu, uu, beyond) = (p.dot(u), u.norm_squared(), p.norm_squared() - s * s);
    let disc = pu * pu - uu * beyond;
    if uu > 0.0 && disc >= 0.0 {
        from = ((-pu - disc.sqrt()) / uu).max(from);
        to = ((-pu + disc.sqrt()) / uu).min(to);
    } else if beyond > 0.0 {
        return None;
    }
    // Below the near side all the while?
    let q_at = |t: f64| q + w * t + 0.5 * a * t * t;
    (from < to && q_at(from).max(q_at(to)) >= -s).then_some((from, to))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(2000) })]
        /// Against a walk along the parabola in steps too small to miss more than a graze.
        #[test]
        fn no_contact_is_skipped(
            r in prop::array::uniform3(-3.0..3.0f64), v in prop::array::uniform3(-2.0..2.0f64),
            g in prop::array::uniform3(-1.0..1.0f64), s in 0.1..1.5f64
        ) {
            let (r, v, g) = (Vector(r), Vector(v), Vector(g));
            prop_assume!(r.norm() > s);
            let distance = |t: f64| (r + v * t + g * (0.5 * t * t)).norm() - s;
            let t = fall_delay(r, v, g, s);
            let first = (0..20_000).map(|step| f64::from(step) * 1e-3).find(|&t| distance(t) < -1e-9);
            if let Some(first) = first {
                prop_assert!(t <= first && t > first - 0.1, "contact at {t}, within at {first}");
            }
            if t.is_finite() {
                prop_assert!(distance(t).abs() < 1e-9, "{} away at {t}", distance(t));
                prop_assert!((0..1000).all(|step| distance(t * f64::from(step) / 1000.0) > -1e-9));
            }
        }
    }

    /// Thrown up through two contacts with a disc that is not there for the second time.
    #[test]
    fn a_ball_that_has_just_left_comes_back_down() {
        let (r, g) = (Vector([0.0, 1.0]), Vector([0.0, -2.0]));
        assert!((fall_delay(r, Vector([0.0, 3.0]), g, 1.0) - 3.0).abs() < 1e-14);
        assert_eq!(fall_delay(r, Vector([0.0, -3.0]), g, 1.0), 0.0);
    }
}
