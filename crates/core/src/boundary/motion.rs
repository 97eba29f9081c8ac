//! Where a face that is driven from outside is at any time.

use crate::Invalid;

/// A prescribed motion along one axis: the coordinate as a function of physical time.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Motion {
    /// Along straight lines from point to point `(time, coordinate)`, times ascending; at rest before the first and after
    /// the last. Two points are a motion at constant velocity that stops.
    Path(Vec<(f64, f64)>),
    /// `x(t) = centre + amplitude sin(omega t + phase)`.
    Oscillation {
        /// Coordinate in the middle.
        centre: f64,
        /// Largest distance from there.
        amplitude: f64,
        /// Angular frequency `omega`, radians per time.
        angular_frequency: f64,
        /// Phase at time 0, radians.
        phase: f64,
    },
}

impl Motion {
    /// Coordinate `x` and velocity `dx/dt` at `time`; at a corner of a path the velocity just after.
    pub fn at(&self, time: f64) -> (f64, f64) {
        match self {
            Self::Path(points) => {
                let after = points.partition_point(|point| point.0 <= time);
                match (after.checked_sub(1).map(|before| points[before]), points.get(after)) {
                    (Some((t0, x0)), Some(&(t1, x1))) => {
                        let u = (x1 - x0) / (t1 - t0);
                        (x0 + u * (time - t0), u)
                    }
                    (Some((_, x)), None) | (None, Some(&(_, x))) => (x, 0.0),
                    (None, None) => (f64::NAN, 0.0),
                }
            }
            &Self::Oscillation { centre, amplitude, angular_frequency, phase } => {
                let (sine, cosine) = libm::sincos(angular_frequency * time + phase);
                (centre + amplitude * sine, amplitude * angular_frequency * cosine)
            }
        }
    }

    /// Lowest and highest coordinate ever reached.
    pub fn range(&self) -> (f64, f64) {
        match self {
            Self::Path(points) => points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), p| (a.min(p.1), b.max(p.1))),
            Self::Oscillation { centre, amplitude, .. } => (centre - amplitude.abs(), centre + amplitude.abs()),
        }
    }

    pub(super) fn validate(&self) -> Result<(), Invalid> {
        match self {
            Self::Path(points) => {
                if points.is_empty() || !points.iter().all(|point| point.0.is_finite() && point.1.is_finite()) {
                    return Err(Invalid::new("path", format!("{points:?}"), "at least one point (time, coordinate), all finite"));
                }
                if let Some(pair) = points.windows(2).find(|pair| pair[0].0 >= pair[1].0) {
                    return Err(Invalid::new("path", format!("{pair:?}"), "times in ascending order"));
                }
            }
            &Self::Oscillation { centre, amplitude, angular_frequency, phase } => {
                for (key, value) in [("centre", centre), ("amplitude", amplitude), ("phase", phase)] {
                    if !value.is_finite() {
                        return Err(Invalid::new(key, value, "a finite number"));
                    }
                }
                if !(angular_frequency > 0.0 && angular_frequency.is_finite()) {
                    return Err(Invalid::new("angular_frequency", angular_frequency, "a positive number"));
                }
            }
        }
        Ok(())
    }
}
