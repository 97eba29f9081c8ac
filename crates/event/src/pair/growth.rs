//! Growing spheres (Lubachevsky and Stillinger, J. Stat. Phys. 60, 561 (1990), doi:10.1007/BF01025983).

use corpuscle_core::Vector;

/// How long until two points at distance vector `r`, closing with the relative velocity `v`, are as far apart as a contact
/// distance that is `s` now and grows at the rate `g >= 0`. Infinity when they never are.
///
/// With `a = v.v - g^2`, `b = r.v - s g` and `c = r.r - s^2`, the square of the distance less that of the contact distance
/// is `a t^2 + 2 b t + c`, and contact is where it falls through zero. While `b < 0` that is `t = c / (-b + sqrt(disc))`,
/// `disc = b^2 - a c`, whatever the sign of `a`. Spheres that recede at first are caught up, at
/// `t = (b + sqrt(disc)) / (-a)`, if the contact distance grows faster than they fly. The squares hide the sign of the
/// contact distance, but one that grows stays positive, so no root is spurious.
///
/// Spheres that overlap by rounding touch at once while the gap closes. While it opens they touch when it closes again.
pub(crate) fn growing_contact_delay<const D: usize>(r: Vector<D>, v: Vector<D>, s: f64, g: f64) -> f64 {
    let a = v.norm_squared() - g * g;
    let b = r.dot(v) - s * g;
    let c = r.norm_squared() - s * s;
    if b < 0.0 {
        if c <= 0.0 {
            return 0.0;
        }
        let disc = b * b - a * c;
        return if disc < 0.0 { f64::INFINITY } else { c / (disc.sqrt() - b) };
    }
    if a >= 0.0 { f64::INFINITY } else { (b + (b * b - a * c).max(0.0).sqrt()) / -a }
}

/// The normal relative velocity after an elastic contact approached at `v_n` (negative while approaching), when the
/// contact distance grows at the rate `g`: `2 g - v_n`, as at a wall that moves at `g`. They recede faster than
/// they grow, and have gained energy.
pub(crate) fn rebound(approach: f64, g: f64) -> f64 {
    2.0 * g - approach
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::contact_delay;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn growing_spheres_touch_at_the_predicted_time(
            r in prop::array::uniform3(-5.0..5.0f64), v in prop::array::uniform3(-2.0..2.0f64), s in 0.1..1.0f64, g in 0.0..3.0f64
        ) {
            let (r, v) = (Vector(r), Vector(v));
            prop_assume!(r.norm() > s * 1.0001 && (v.norm() - g).abs() > 1e-3);
            let t = growing_contact_delay(r, v, s, g);
            let gap = |t: f64| (r + v * t).norm() - (s + g * t);
            if t.is_finite() {
                let (place, scale) = (r + v * t, 1.0 + g * t + v.norm() * t);
                prop_assert!(gap(t).abs() < 1e-10 * scale);
                prop_assert!(place.dot(v) / place.norm() <= g + 1e-6, "the gap opens");
                for m in 1..20 {
                    prop_assert!(gap(t * f64::from(m) / 20.0) > -1e-10 * scale, "it is not the first contact");
                }
                // After the rebound they part.
                let k = place / place.norm();
                prop_assert!(rebound(v.dot(k), g) >= g - 1e-6);
            } else {
                for m in 0..200 {
                    prop_assert!(gap(0.1 * f64::from(m)) > 0.0);
                }
            }
        }

        #[test]
        fn spheres_that_do_not_grow_touch_as_ever(
            r in prop::array::uniform3(-5.0..5.0f64), v in prop::array::uniform3(-2.0..2.0f64), s in 0.1..1.0f64
        ) {
            let (r, v) = (Vector(r), Vector(v));
            prop_assert_eq!(growing_contact_delay(r, v, s, 0.0), contact_delay(r, v, s));
        }
    }

    #[test]
    fn spheres_that_recede_are_caught_up() {
        // Distance 2 + t, contact distance 1 + 2 t: after 1.
        assert_eq!(growing_contact_delay(Vector([2.0, 0.0]), Vector([1.0, 0.0]), 1.0, 2.0), 1.0);
        // At rest: distance 2, contact distance 1 + t / 2.
        assert_eq!(growing_contact_delay(Vector([2.0, 0.0]), Vector::ZERO, 1.0, 0.5), 2.0);
        // Faster than they grow: never.
        assert_eq!(growing_contact_delay(Vector([2.0, 0.0]), Vector([1.0, 0.0]), 1.0, 0.9), f64::INFINITY);
    }

    #[test]
    fn rounding_at_contact_neither_repeats_nor_loses_it() {
        let r = Vector([1.0 - 1e-15, 0.0]);
        // Just rebounded at 2 g - v_n: the gap opens, and closes again only by growth.
        assert_eq!(growing_contact_delay(r, Vector([0.7, 0.0]), 1.0, 0.5), f64::INFINITY);
        assert_eq!(growing_contact_delay(r, Vector([0.3, 0.0]), 1.0, 0.5), 0.0);
        let glancing = growing_contact_delay(r, Vector([0.5, 0.1]), 1.0, 0.5);
        assert!(glancing == 0.0 || glancing == f64::INFINITY, "{glancing}");
    }
}
