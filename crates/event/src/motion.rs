//! Free flight between two events, and when two spheres in free flight touch.

use corpuscle_core::Vector;

/// A particle in free flight, as it was at its own time: what pair prediction reads, one cache line in 3-D.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))] // the order of the fields is that of `number`
pub(crate) struct Flight<const D: usize> {
    pub(crate) position: Vector<D>,
    pub(crate) time: f64,
    pub(crate) velocity: Vector<D>,
    pub(crate) radius: f64,
}

impl<const D: usize> Flight<D> {
    /// One of the `2 D + 2` numbers, in the order position, time, velocity, radius.
    #[inline]
    pub(crate) fn number(&self, index: usize) -> f64 {
        if index < D {
            self.position[index]
        } else if index == D {
            self.time
        } else if index <= 2 * D {
            self.velocity[index - D - 1]
        } else {
            self.radius
        }
    }

    /// `r + v t + g t^2 / 2`, with `t` counted from the particle's own time.
    #[inline]
    pub(crate) fn position_at(&self, time: f64, field: Vector<D>) -> Vector<D> {
        let t = time - self.time;
        self.position + self.velocity * t + field * (0.5 * t * t)
    }

    /// `v + g t`.
    #[inline]
    pub(crate) fn velocity_at(&self, time: f64, field: Vector<D>) -> Vector<D> {
        self.velocity + field * (time - self.time)
    }

    /// Makes `time` the particle's own time.
    #[inline]
    pub(crate) fn bring_to(&mut self, time: f64, field: Vector<D>) {
        (self.position, self.velocity) = (self.position_at(time, field), self.velocity_at(time, field));
        self.time = time;
    }
}

/// How long until two points at distance vector `r`, closing with the relative velocity `v`, are `s` apart.
///
/// With `b = r.v`, `c = r.r - s^2`, `disc = b^2 - v.v c`, contact is at `t = c / (-b + sqrt(disc))` if `b < 0` and
/// `disc >= 0`: the smaller root, in the form without cancellation. Spheres that overlap by rounding touch at once
/// while they approach, and never while they recede (Bannerman, Strobl, Formella, Pöschel, Comput. Part. Mech. 1, 191
/// (2014), doi:10.1007/s40571-014-0021-8).
///
/// Answers infinity when they miss each other.
#[inline]
pub(crate) fn contact_delay<const D: usize>(r: Vector<D>, v: Vector<D>, s: f64) -> f64 {
    let b = r.dot(v);
    let c = r.norm_squared() - s * s;
    if b >= 0.0 {
        return f64::INFINITY;
    }
    if c <= 0.0 {
        return 0.0;
    }
    let disc = b * b - v.norm_squared() * c;
    if disc < 0.0 {
        return f64::INFINITY;
    }
    c / (disc.sqrt() - b)
}

/// How long until a point `h` below a plane passes it upwards, moving at `v` and accelerated by `a` (both upwards).
///
/// Of the two roots of `a t^2 / 2 + v t = h` it is the one at which the velocity, `sqrt(v^2 + 2 a h)`, points up. So a
/// particle just reflected downwards cannot meet the plane again at `t = 0` by rounding. One that is beyond the plane
/// already, by rounding, and moves up passes at once: the answer is then zero or slightly negative.
#[inline]
pub(crate) fn upward_passage(h: f64, v: f64, a: f64) -> f64 {
    if a == 0.0 {
        return if v > 0.0 { h / v } else { f64::INFINITY };
    }
    let disc = v * v + 2.0 * a * h;
    if disc < 0.0 {
        // It never is at the plane. Below it stays; beyond it, by rounding, it passes once it moves up.
        return if h < 0.0 && a > 0.0 { (-v / a).max(0.0) } else { f64::INFINITY };
    }
    if v > 0.0 {
        2.0 * h / (v + disc.sqrt())
    } else if a > 0.0 {
        (disc.sqrt() - v) / a
    } else {
        f64::INFINITY
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn spheres_touch_at_the_predicted_time(
            r in prop::array::uniform3(-5.0..5.0f64), v in prop::array::uniform3(-2.0..2.0f64), s in 0.1..1.0f64
        ) {
            let (r, v) = (Vector(r), Vector(v));
            prop_assume!(r.norm() > s);
            let t = contact_delay(r, v, s);
            if t.is_finite() {
                prop_assert!(((r + v * t).norm() - s).abs() < 1e-11);
                prop_assert!((r + v * t).dot(v) <= 1e-11);
                prop_assert_eq!(contact_delay(-r, -v, s), t);
            } else {
                // The closest approach, if it lies ahead, is outside the contact distance.
                let closest = (-r.dot(v) / v.norm_squared()).max(0.0);
                prop_assert!((r + v * closest).norm() >= s);
            }
        }

        #[test]
        fn planes_are_passed_upwards(h in -1.0..1.0f64, v in -2.0..2.0f64, a in -2.0..2.0f64) {
            let t = upward_passage(h, v, a);
            if t.is_finite() && v * v + 2.0 * a * h >= 0.0 {
                prop_assert!((v * t + 0.5 * a * t * t - h).abs() < 1e-9);
                prop_assert!(v + a * t >= -1e-9);
            }
        }
    }

    #[test]
    fn overlapping_spheres_collide_at_once_or_never() {
        let r = Vector([0.9, 0.0]);
        assert_eq!(contact_delay(r, Vector([-1.0, 0.0]), 1.0), 0.0);
        assert_eq!(contact_delay(r, Vector([1.0, 0.0]), 1.0), f64::INFINITY);
    }

    #[test]
    fn a_ball_thrown_from_the_floor_comes_back_after_its_whole_flight() {
        // Upwards means towards the floor here.
        assert_eq!(upward_passage(0.0, -3.0, 2.0), 3.0);
        assert_eq!(upward_passage(0.0, 3.0, -2.0), 0.0);
    }
}
