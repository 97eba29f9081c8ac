//! A face of the box that moves as prescribed.

use std::f64::consts::TAU;

use corpuscle_core::{Motion, Vector};

use crate::motion::{Flight, upward_passage};

/// A plane with a prescribed motion, met from below, moving up relative to it, if `from_below`.
#[derive(Clone, Debug)]
pub(super) struct Driven {
    pub(super) axis: usize,
    pub(super) from_below: bool,
    pub(super) motion: Motion,
}

/// A particle's way, upwards meaning towards the plane: `r + v t + g t^2 / 2` for its point next to the plane.
#[derive(Clone, Copy)]
struct Climb {
    r: f64,
    v: f64,
    g: f64,
}

impl Climb {
    fn at(&self, t: f64) -> Self {
        Self { r: self.r + self.v * t + 0.5 * self.g * t * t, v: self.v + self.g * t, g: self.g }
    }

    /// How long until it passes a place that moves at `u`.
    fn passage(&self, x: f64, u: f64) -> f64 {
        upward_passage(x - self.r, self.v - u, self.g)
    }
}

impl Driven {
    /// How long after its own time, which counts from `epoch`, the particle touches the plane.
    pub(super) fn contact_delay<const D: usize>(&self, particle: &Flight<D>, field: Vector<D>, epoch: f64) -> f64 {
        let sign = if self.from_below { 1.0 } else { -1.0 };
        let climb = Climb {
            r: sign * particle.position[self.axis] + particle.radius,
            v: sign * particle.velocity[self.axis],
            g: sign * field[self.axis],
        };
        match &self.motion {
            Motion::Path(points) => path_delay(points, sign, climb, epoch, particle.time),
            &Motion::Oscillation { centre, amplitude, angular_frequency, phase } => {
                let start = (angular_frequency * (epoch + particle.time) + phase).rem_euclid(TAU);
                Swing { climb, centre: sign * centre, amplitude: sign * amplitude, omega: angular_frequency, start }.contact_delay()
            }
        }
    }
}

/// Piece by piece of the path: on each the motion relative to the plane is a parabola.
fn path_delay(points: &[(f64, f64)], sign: f64, climb: Climb, epoch: f64, time: f64) -> f64 {
    // In this order the difference keeps its digits however late it is.
    let after = |t: f64| (t - epoch) - time;
    let mut next = points.partition_point(|point| after(point.0) <= 0.0);
    let mut begin = 0.0;
    loop {
        let (x, u) = match (next.checked_sub(1).map(|before| points[before]), points.get(next)) {
            (Some((t0, x0)), Some(&(t1, x1))) => {
                let u = (x1 - x0) / (t1 - t0);
                (x0 + u * (begin - after(t0)), u)
            }
            (Some((_, x)), None) | (None, Some(&(_, x))) => (x, 0.0),
            (None, None) => return f64::INFINITY,
        };
        let end = points.get(next).map_or(f64::INFINITY, |point| after(point.0));
        let contact = begin + climb.at(begin).passage(sign * x, sign * u);
        if contact <= end {
            return contact;
        }
        (begin, next) = (end, next + 1);
    }
}

/// A particle and an oscillating plane: the gap between them is `f(t) = centre + amplitude sin(start + omega t) - r(t)`.
struct Swing {
    climb: Climb,
    centre: f64,
    amplitude: f64,
    omega: f64,
    start: f64,
}

impl Swing {
    /// A contact needs a few half periods from where the particle comes within reach of the plane: the plane sweeps all of
    /// its reach in each. After so many, the particle is at the turning point to the last digit, and does not move by one.
    const MOST_PIECES: u32 = 100_000;

    fn gap(&self, t: f64) -> f64 {
        self.centre + self.amplitude * libm::sin(self.start + self.omega * t) - self.climb.at(t).r
    }

    fn slope(&self, t: f64) -> f64 {
        self.amplitude * self.omega * libm::cos(self.start + self.omega * t) - self.climb.at(t).v
    }

    fn contact_delay(&self) -> f64 {
        let nearest = self.centre - self.amplitude.abs();
        let mut t = 0.0;
        for _ in 0..Self::MOST_PIECES {
            let here = self.climb.at(t);
            if here.r <= nearest {
                t += here.passage(nearest, 0.0);
                if t == f64::INFINITY {
                    return t;
                }
            }
            let end = self.inflection_after(t);
            if let Some(contact) = first_fall(|t| self.gap(t), |t| self.slope(t), t, end) {
                return contact;
            }
            t = end;
        }
        f64::INFINITY
    }

    /// The next time after `t` at which `f'' = -amplitude omega^2 sin - g` changes its sign, or a period later.
    fn inflection_after(&self, t: f64) -> f64 {
        let sine = -self.climb.g / (self.amplitude * self.omega * self.omega);
        let phase = self.start + self.omega * t;
        let mut ahead = TAU;
        if sine.abs() < 1.0 {
            let angle = libm::asin(sine);
            for place in [angle, 0.5 * TAU - angle] {
                let distance = (place - phase).rem_euclid(TAU);
                // An inflection that is here, but for rounding, is the beginning of this piece.
                if distance > 1e-9 {
                    ahead = ahead.min(distance);
                }
            }
        }
        t + ahead / self.omega
    }
}

/// The first time in `[from, to]` at which `f` falls to zero or is there falling, where its slope is monotone: there `f`
/// falls on one stretch only, at the beginning, at the end, or between.
fn first_fall(f: impl Fn(f64) -> f64, slope: impl Fn(f64) -> f64, from: f64, to: f64) -> Option<f64> {
    let (from, to) = match (slope(from) < 0.0, slope(to) < 0.0) {
        (true, true) => (from, to),
        (false, false) => return None,
        (true, false) => (from, bisect(&slope, from, to)),
        (false, true) => (bisect(&slope, from, to), to),
    };
    if f(from) <= 0.0 {
        return Some(from);
    }
    (f(to) <= 0.0).then(|| bisect(&f, from, to))
}

/// Where `f` changes its sign in a bracket, to the last bit.
fn bisect(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let negative = f(high) < 0.0 || f(high) == 0.0 && f(low) > 0.0;
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return high;
        }
        let value = f(middle);
        if (value < 0.0 || value == 0.0 && negative) == negative { high = middle } else { low = middle }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn delay(motion: &Motion, r: f64, v: f64, g: f64) -> f64 {
        let particle = Flight { position: Vector([r]), velocity: Vector([v]), time: 0.25, radius: 0.1 };
        Driven { axis: 0, from_below: true, motion: motion.clone() }.contact_delay(&particle, Vector([g]), 0.5)
    }

    /// Against a walk in steps too small to miss more than a graze.
    fn holds(motion: &Motion, r: f64, v: f64, g: f64) -> Result<(), TestCaseError> {
        let gap = |t: f64| motion.at(0.75 + t).0 - (r + v * t + 0.5 * g * t * t) - 0.1;
        prop_assume!(gap(0.0) > 1e-6);
        let t = delay(motion, r, v, g);
        let first = (0..30_000).map(|step| f64::from(step) * 1e-3).find(|&t| gap(t) < -1e-9);
        if let Some(first) = first {
            prop_assert!(t <= first && t > first - 0.05, "contact at {t}, through at {first}");
        }
        if t.is_finite() {
            prop_assert!(gap(t).abs() < 1e-9, "{} away at {t}", gap(t));
            prop_assert!((0..1000).all(|step| gap(t * f64::from(step) / 1000.0) > -1e-9));
        }
        Ok(())
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(1000) })]
        #[test]
        fn an_oscillating_face_is_met_when_it_is_there(
            r in -3.0..3.0f64, v in -1.0..3.0f64, g in -2.0..2.0f64, amplitude in 0.0..1.0f64, omega in 0.1..20.0f64, phase in 0.0..6.3f64
        ) {
            let motion = Motion::Oscillation { centre: 2.0, amplitude, angular_frequency: omega, phase };
            holds(&motion, r, v, g)?;
            holds(&motion, r, v, 0.0)?;
        }

        #[test]
        fn a_face_on_a_path_is_met_when_it_is_there(
            r in -3.0..1.0f64, v in -1.0..3.0f64, g in -2.0..2.0f64, places in prop::collection::vec(0.0..3.0f64, 1..6)
        ) {
            let motion = Motion::Path(places.iter().enumerate().map(|(k, &x)| (0.7 * k as f64, x)).collect());
            holds(&motion, r, v, g)?;
            holds(&motion, r, v, 0.0)?;
        }
    }
}
