//! Coordinates that do not obey a force: held fixed, or moved as prescribed.

use std::ops::Range;

use corpuscle_core::{Invalid, Particles};

/// Coordinates of one particle that are held where they are: the ends of a string, a ring on a rod.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pin<const D: usize> {
    /// Index of the particle.
    pub particle: usize,
    /// Which of its coordinates are held.
    pub axes: [bool; D],
}

/// A coordinate moved as prescribed, whatever the forces say: the shaker at the end of a string.
///
/// The coordinate is `x(t) = x_rest + s(t)`, with `x_rest` such that the start is where the particle was put.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Index of the particle.
    pub particle: usize,
    /// The axis it is moved along.
    pub axis: usize,
    /// The displacement `s(t)`.
    pub signal: Signal,
}

/// A function of time that drives something.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Signal {
    /// `A sin(omega t + phi)`, switched on smoothly (twice differentiable) over the time `ramp`; 0 switches at once.
    Sine {
        /// Amplitude `A`.
        amplitude: f64,
        /// Angular frequency `omega`, radians per time.
        angular_frequency: f64,
        /// Phase `phi`, radians.
        phase: f64,
        /// Duration of the switching on.
        ramp: f64,
    },
    /// A Gaussian pulse `A exp(-(t - t_0)^2 / (2 w^2))`.
    Pulse {
        /// Height `A`.
        amplitude: f64,
        /// Time `t_0` of the maximum.
        centre: f64,
        /// Standard deviation `w > 0`, a time.
        width: f64,
    },
}

impl Signal {
    /// Value and rate of change at a time. Sine and exponential come from `libm`: the same bits on every platform.
    pub fn at(&self, time: f64) -> (f64, f64) {
        match *self {
            Self::Sine { amplitude, angular_frequency: omega, phase, ramp } => {
                let (sine, cosine) = libm::sincos(omega * time + phase);
                let (share, share_rate) = switched_on(time, ramp);
                (amplitude * share * sine, amplitude * (share_rate * sine + share * omega * cosine))
            }
            Self::Pulse { amplitude, centre, width } => {
                let u = (time - centre) / width;
                let value = amplitude * libm::exp(-0.5 * u * u);
                (value, -value * u / width)
            }
        }
    }

    /// The longest step of an adaptive integrator that cannot miss the signal.
    pub(crate) fn longest_step(&self) -> f64 {
        match *self {
            Self::Sine { angular_frequency, .. } => 1.0 / angular_frequency.abs(),
            Self::Pulse { width, .. } => width,
        }
    }

    pub(crate) fn validate(&self) -> Result<(), Invalid> {
        let (numbers, width) = match *self {
            Self::Sine { amplitude, angular_frequency, phase, ramp } => ([amplitude, angular_frequency, phase], ramp),
            Self::Pulse { amplitude, centre, width } => ([amplitude, centre, 0.0], width),
        };
        if numbers.iter().any(|x| !x.is_finite()) {
            return Err(Invalid::new("drive", format!("{self:?}"), "finite numbers"));
        }
        let pulse = matches!(self, Self::Pulse { .. });
        if !(width.is_finite() && (width > 0.0 || (width == 0.0 && !pulse))) {
            let (key, expected) = if pulse { ("pulse width", "a positive time") } else { ("ramp", "a time, zero or more") };
            return Err(Invalid::new(key, width, expected));
        }
        Ok(())
    }
}

/// The share `10 u^3 - 15 u^4 + 6 u^5`, `u = t / ramp`, with its rate.
fn switched_on(time: f64, ramp: f64) -> (f64, f64) {
    if time >= ramp {
        return (1.0, 0.0);
    }
    let u = (time / ramp).max(0.0);
    (u * u * u * (10.0 + u * (6.0 * u - 15.0)), 30.0 * u * u * (1.0 - u) * (1.0 - u) / ramp)
}

/// One held or driven coordinate.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
pub(crate) struct Held {
    pub(crate) particle: usize,
    pub(crate) axis: usize,
    rest: f64,
    signal: Option<Signal>,
}

impl Held {
    pub(crate) fn new<const D: usize>(
        particle: usize,
        axis: usize,
        signal: Option<Signal>,
        time: f64,
        particles: &Particles<D>,
    ) -> Result<Self, Invalid> {
        let key = if signal.is_some() { "drive" } else { "pin" };
        if particle >= particles.len() {
            return Err(Invalid::new(format!("{key} at particle"), particle, format!("an index below {}", particles.len())));
        }
        if axis >= D {
            return Err(Invalid::new(format!("{key} along axis"), axis, format!("an axis below {D}")));
        }
        signal.map_or(Ok(()), |signal| signal.validate())?;
        let mut held = Self { particle, axis, rest: 0.0, signal };
        held.settle(time, particles);
        Ok(held)
    }

    /// Takes the particle's present place as the one prescribed for this time.
    pub(crate) fn settle<const D: usize>(&mut self, time: f64, particles: &Particles<D>) {
        self.rest = particles.position[self.particle][self.axis] - self.signal.map_or(0.0, |signal| signal.at(time).0);
    }

    /// Coordinate and velocity prescribed for this time.
    pub(crate) fn at(&self, time: f64) -> (f64, f64) {
        let (displacement, rate) = self.signal.map_or((0.0, 0.0), |signal| signal.at(time));
        (self.rest + displacement, rate)
    }

    /// Puts the coordinate where it has to be at this time.
    pub(crate) fn apply<const D: usize>(&self, time: f64, particles: &mut Particles<D>) {
        (particles.position[self.particle][self.axis], particles.velocity[self.particle][self.axis]) = self.at(time);
    }

    /// Whether it moves.
    pub(crate) fn is_driven(&self) -> bool {
        self.signal.is_some()
    }

    pub(crate) fn longest_step(&self) -> f64 {
        self.signal.map_or(f64::INFINITY, |signal| signal.longest_step())
    }
}

/// What is held of these particles, where all that is held is in the order of the particles.
pub(crate) fn among(held: &[Held], particles: Range<usize>) -> &[Held] {
    let below = |particle: usize| held.partition_point(|held| held.particle < particle);
    &held[below(particles.start)..below(particles.end)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Central differences of the value give the rate: truncation error `h^2 s''' / 6`, here below `1e-8`.
    #[test]
    fn the_rate_is_the_derivative_of_the_value() {
        let signals = [
            Signal::Sine { amplitude: 0.3, angular_frequency: 2.0, phase: 0.4, ramp: 3.0 },
            Signal::Pulse { amplitude: 1.5, centre: 2.0, width: 0.7 },
        ];
        for signal in signals {
            for step in 1..50 {
                let (t, h) = (0.1 * f64::from(step), 1e-5);
                let difference = (signal.at(t + h).0 - signal.at(t - h).0) / (2.0 * h);
                assert!((difference - signal.at(t).1).abs() < 1e-8, "{signal:?} at {t}");
            }
        }
    }
}
