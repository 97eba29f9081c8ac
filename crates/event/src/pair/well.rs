//! Square wells and shoulders around hard cores.
//!
//! Whether a pair is inside its well is remembered, not asked of its distance, which rounding leaves on either side of
//! the edge. So each pair is a small machine: outside, only the way in is open; inside, the core or the way out.

use corpuscle_core::Vector;

use crate::motion::contact_delay;

/// What a pair meets next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Event {
    /// The hard cores touch.
    Core,
    /// The edge of the well, from outside.
    Entry,
    /// The edge of the well, from inside.
    Exit,
}

/// How long until a pair of contact distance `s` at distance vector `r`, closing with the relative velocity `v`, has its
/// next event, and which. Infinity when there is none.
pub(crate) fn next_event<const D: usize>(r: Vector<D>, v: Vector<D>, s: f64, range: f64, inside: bool) -> (f64, Event) {
    if !inside {
        return (contact_delay(r, v, range * s), Event::Entry);
    }
    let core = contact_delay(r, v, s);
    if core < f64::INFINITY { (core, Event::Core) } else { (exit_delay(r, v, range * s), Event::Exit) }
}

/// How long until two points inside the distance `s` of one another are `s` apart: the larger root of
/// `q t^2 + 2 b t + c = 0` with `b = r.v`, `q = v.v` and `c = r.r - s^2`, in the form without cancellation.
///
/// Those that rounding has put beyond `s` leave at once while they recede; while they approach, by the far side, even
/// if rounding lets their path miss the sphere.
pub(crate) fn exit_delay<const D: usize>(r: Vector<D>, v: Vector<D>, s: f64) -> f64 {
    let (b, q, c) = (r.dot(v), v.norm_squared(), r.norm_squared() - s * s);
    if q == 0.0 {
        return f64::INFINITY;
    }
    let root = (b * b - q * c).max(0.0).sqrt();
    if b > 0.0 { (-c / (b + root)).max(0.0) } else { (root - b) / q }
}

/// The change of the normal relative velocity `v_n = v.k` (positive while receding) at the edge of a well, and whether the
/// pair is inside afterwards. It may be given per distance, `v.r / r.r`, with `mu r.r` in place of the reduced mass `mu`.
///
/// A pair passes if `mu v_n^2 / 2` pays for the step of the potential, and then `v_n'^2 = v_n^2 +- 2 depth / mu`, upper
/// sign on the way in; the change is that of `v_n^2` over `v_n' + v_n`, without cancellation. If not, it bounces:
/// `v_n' = -v_n`. Kinetic and potential energy together stay to rounding.
pub(crate) fn step(approach: f64, mu: f64, depth: f64, entry: bool) -> (f64, bool) {
    let gain = 2.0 * if entry { depth } else { -depth } / mu;
    let square = approach * approach + gain;
    let onwards = if entry { -1.0 } else { 1.0 };
    if square < 0.0 || approach == 0.0 && gain <= 0.0 {
        // Back, also where rounding has let a grazing pair seem to have turned already.
        return (-onwards * approach.abs() - approach, !entry);
    }
    (gain / (onwards * square.sqrt() + approach), entry)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn vector(x: [f64; 3]) -> Vector<3> {
        Vector(x)
    }

    proptest! {
        #[test]
        fn pairs_outside_meet_the_edge_only(
            r in prop::array::uniform3(-5.0..5.0f64), v in prop::array::uniform3(-2.0..2.0f64), range in 1.05..2.5f64
        ) {
            let (r, v) = (vector(r), vector(v));
            prop_assume!(r.norm() > range);
            let (t, event) = next_event(r, v, 1.0, range, false);
            prop_assert_eq!(event, Event::Entry);
            if t.is_finite() {
                prop_assert!(((r + v * t).norm() - range).abs() < 1e-11);
            }
        }

        #[test]
        fn pairs_inside_touch_or_leave(
            direction in prop::array::uniform3(-1.0..1.0f64), place in 0.0..1.0f64,
            v in prop::array::uniform3(-2.0..2.0f64), range in 1.05..2.5f64
        ) {
            let (direction, v) = (vector(direction), vector(v));
            prop_assume!(direction.norm() > 0.1 && v.norm() > 0.01);
            let r = direction * ((1.0 + place * (range - 1.0)) / direction.norm());
            let (t, event) = next_event(r, v, 1.0, range, true);
            let then = r + v * t;
            prop_assert!(t.is_finite() && t >= 0.0);
            let (distance, receding) = match event {
                Event::Core => (1.0, -1.0),
                Event::Exit => (range, 1.0),
                Event::Entry => return Err(TestCaseError::fail("it is inside")),
            };
            prop_assert!((then.norm() - distance).abs() < 1e-10);
            prop_assert!(receding * then.dot(v) >= -1e-7);
            // On the way there it is in the well.
            for m in 1..10 {
                let between = (r + v * (0.1 * f64::from(m) * t)).norm();
                prop_assert!(between > 1.0 - 1e-10 && between < range + 1e-10);
            }
        }

        #[test]
        fn energy_stays_at_the_edge(speed in 1e-6..3.0f64, mu in 0.01..100.0f64, depth in -3.0..3.0f64, entry: bool) {
            prop_assume!(depth.abs() > 1e-6);
            let approach = if entry { -speed } else { speed };
            let (change, inside) = step(approach, mu, depth, entry);
            let after = approach + change;
            // Inside, the potential is -depth.
            let before_energy = 0.5 * mu * approach * approach - if entry { 0.0 } else { depth };
            let after_energy = 0.5 * mu * after * after - if inside { depth } else { 0.0 };
            prop_assert!((before_energy - after_energy).abs() < 1e-14 * (before_energy.abs() + depth.abs() + 0.5 * mu * after * after));
            // It goes on to the side it is then on.
            prop_assert_eq!(after < 0.0, inside);
            // It bounces only where the step is too high.
            let price = if entry { -depth } else { depth };
            prop_assert_eq!(inside == entry, 0.5 * mu * speed * speed >= price);
            // The force of a well pulls and that of a shoulder pushes; a bounce turns round.
            let crossed = inside == entry;
            prop_assert_eq!(change < 0.0, if crossed { depth > 0.0 } else { approach > 0.0 });
        }
    }

    #[test]
    fn rounding_at_the_edge_decides_nothing() {
        let (range, edge) = (1.5, 1.5 * (1.0 + 1e-15));
        let (r, v) = (Vector([edge, 0.0]), Vector([1.0, 0.0]));
        // Captured, but still a hair outside: moving in, it crosses the whole well; moving out, it leaves at once.
        assert_eq!(next_event(r, -v, 1.0, range, true).1, Event::Core);
        assert_eq!(next_event(r, v, 1.0, range, true), (0.0, Event::Exit));
        let grazing = Vector([-1e-9, 1.0]);
        let (t, event) = next_event(r, grazing, 1.0, range, true);
        assert!(event == Event::Exit && (0.0..1e-6).contains(&t), "{t}");
        // Turned away, but a hair inside: it never comes back unless it turns.
        let r = Vector([1.5 * (1.0 - 1e-15), 0.0]);
        assert_eq!(next_event(r, v, 1.0, range, false).0, f64::INFINITY);
        assert_eq!(next_event(r, -v, 1.0, range, false), (0.0, Event::Entry));
    }

    #[test]
    fn a_pair_at_rest_in_its_well_stays() {
        assert_eq!(next_event(Vector([1.2, 0.0]), Vector::ZERO, 1.0, 1.5, true).0, f64::INFINITY);
    }
}
