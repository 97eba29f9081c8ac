//! Measurements on braked chains. Each runs twice, with a step of time and with twice that step, by Runge and Kutta's rule of order 4: the
//! error of the finer one is a fifteenth of their difference, and less than an eighth of it.

use std::f64::consts::TAU;

use corpuscle_checkpoint::resume;
use corpuscle_core::{Failure, Invalid};
use corpuscle_time::{Integrator, Signal};

use super::super::chain::{Chain, Design, End, Ends, Polarisation};
use super::super::theory::{Modes, project, rounding};
use super::{Material, theory};

/// Standard deviation of a test pulse, in the time from mass to mass; distances in these deviations, as for undamped chains.
const SIGMA: f64 = 8.0;
const CLEAR: f64 = 9.0;
/// Step of time, over the time from mass to mass.
const STEP: f64 = 0.1;
/// What is left of the start of a driven motion: `exp(-23) = 1e-10`.
const FORGOTTEN: f64 = 23.0;
/// Periods over which a driven motion is measured.
pub(super) const PERIODS: u64 = 4;

/// What is measured.
#[derive(Clone, Copy, Debug)]
pub(super) enum Purpose {
    /// The echo of a pulse from a damper of this impedance, over the chain's.
    Echo { impedance: f64 },
    /// Frequency and rate of decay of a mode under this friction.
    Decay { omega: f64, gamma: f64 },
    /// Parts of the motion of a mass in step with a shaker and a quarter of a period ahead.
    Response { mass: usize, omega: f64, gamma: f64 },
}

/// Two numbers and the bounds of their errors.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Finding {
    pub(super) measured: [f64; 2],
    pub(super) bound: [f64; 2],
}

/// A chain with the finer and with the coarser step.
pub(super) struct Trial {
    pub(super) purpose: Purpose,
    material: Material,
    chains: Vec<Chain>,
    /// Of the coarser one, as all steps here.
    dt: f64,
    steps: u64,
    /// First step recorded.
    first: u64,
    shape: Vec<f64>,
    series: Vec<Vec<f64>>,
    pub(super) finding: Option<Finding>,
}

resume!(Trial { values: [series, finding], parts: [chains], set_up: [purpose, material, dt, steps, first, shape] });

/// A design of a chain that is braked.
pub(super) fn design(material: Material, count: usize, ends: Ends, friction: Vec<f64>, dt: f64) -> Design {
    Design {
        masses: vec![material.mass; count],
        stiffness: material.stiffness,
        spacing: material.spacing,
        polarisation: Polarisation::Transverse,
        ends,
        integrator: Integrator::RungeKutta4 { dt },
        friction,
    }
}

/// Friction of a damper at the last of `count` masses.
pub(super) fn damper(material: Material, count: usize, impedance: f64) -> Vec<f64> {
    (0..count).map(|n| if n + 1 == count { impedance * material.omega_0() } else { 0.0 }).collect()
}

impl Trial {
    /// A pulse from a shaker to a damper and back.
    pub(super) fn echo(material: Material, impedance: f64) -> Result<Self, Invalid> {
        let sensor = (CLEAR * SIGMA) as usize;
        let (count, sigma) = (2 * sensor, SIGMA / material.omega_0());
        let shaker = End::Driven(Signal::Pulse { amplitude: 1.0, centre: CLEAR * sigma, width: sigma });
        // A strong damper is a stiff equation.
        let dt = STEP / (material.omega_0() * impedance.max(1.0));
        let chain = |dt| {
            let friction = damper(material, count, impedance);
            Chain::new(design(material, count, Ends::Between(shaker, End::Free), friction, dt), &[], &[])
        };
        let shape = (0..count).map(|n| if n + 1 == sensor { 1.0 } else { 0.0 }).collect();
        Ok(Self::new(
            Purpose::Echo { impedance },
            material,
            [chain(dt)?, chain(2.0 * dt)?],
            2.0 * dt,
            5.0 * CLEAR * sigma,
            0.0,
            shape,
        ))
    }

    /// A mode that is let go, with the friction `gamma`: a frequency and a half of it below the critical one.
    pub(super) fn decay(material: Material, count: usize, mode: usize, gamma: f64) -> Result<Self, Invalid> {
        let ends = Ends::Between(End::Fixed, End::Fixed);
        let make = |dt| design(material, count, ends, vec![gamma; count], dt);
        let Some(modes) = Modes::of(&make(1.0)) else { return Err(Invalid::new("ends", "unlike", "two alike")) };
        let (shape, omega) = (modes.shape(mode), super::super::theory::dispersion(material.omega_0(), modes.phase(mode)));
        let dt = STEP / material.omega_0();
        let chain = |dt| Chain::new(make(dt), &shape, &vec![0.0; count]);
        let chains = [chain(dt)?, chain(2.0 * dt)?];
        Ok(Self::new(Purpose::Decay { omega, gamma }, material, chains, 2.0 * dt, 1.5 * TAU / omega, 0.0, shape.clone()))
    }

    /// A chain shaken at one end, held at the other, watched at `mass` when its start is forgotten.
    pub(super) fn response(material: Material, count: usize, mass: usize, omega: f64, gamma: f64) -> Result<Self, Invalid> {
        let period = TAU / omega;
        let coarse = (period * material.omega_0() / (2.0 * STEP)).ceil().max(8.0);
        let dt = period / coarse;
        let signal = Signal::Sine { amplitude: 1.0, angular_frequency: omega, phase: 0.0, ramp: 2.0 * period };
        let chain = |dt| {
            let ends = Ends::Between(End::Driven(signal), End::Fixed);
            Chain::new(design(material, count, ends, vec![gamma; count], dt), &[], &[])
        };
        let settled = (settling(gamma) / period).ceil() + 2.0;
        let shape = (0..count).map(|n| if n == mass { 1.0 } else { 0.0 }).collect();
        let chains = [chain(0.5 * dt)?, chain(dt)?];
        let all = (settled + PERIODS as f64) * period;
        Ok(Self::new(Purpose::Response { mass, omega, gamma }, material, chains, dt, all, settled * period, shape))
    }

    fn new(purpose: Purpose, material: Material, chains: [Chain; 2], dt: f64, until: f64, from: f64, shape: Vec<f64>) -> Self {
        let step = |time: f64| (time / dt).round() as u64;
        let (chains, series, steps, first) = (chains.into(), vec![vec![]; 2], step(until), step(from));
        let mut trial = Self { purpose, material, chains, dt, steps, first, shape, series, finding: None };
        trial.record(0);
        trial
    }

    fn record(&mut self, step: u64) {
        if step < self.first {
            return;
        }
        for (chain, series) in self.chains.iter().zip(&mut self.series) {
            series.push(project(&chain.displacements(), &self.shape));
        }
    }

    /// Steps taken.
    pub(super) fn work(&self) -> u64 {
        self.chains.iter().map(Chain::steps).sum()
    }

    /// Advances to this share of the whole trial.
    ///
    /// # Errors
    /// As [`Chain::advance`].
    pub(super) fn advance(&mut self, share: f64) -> Result<(), Failure> {
        // A share may be rounded to just below the whole.
        let target = (self.steps as f64 * (share + 1e-12).clamp(0.0, 1.0)) as u64;
        for step in self.chains[1].steps() + 1..=target {
            // Half a fine step more, so that rounding leaves no step out.
            let to = (step as f64 + 0.25) * self.dt;
            for chain in &mut self.chains {
                chain.advance(to)?;
            }
            self.record(step);
        }
        if self.finding.is_none() && target >= self.steps {
            let [fine, coarse] = [0, 1].map(|which| self.evaluate(&self.series[which]));
            let rest = self.rest();
            // Of both as one complex number: either alone may be good by chance.
            let step = (fine[0] - coarse[0]).hypot(fine[1] - coarse[1]) / 8.0;
            let bound = |k: usize| step + rest[k];
            self.finding = Some(Finding { measured: fine, bound: [bound(0), bound(1)] });
        }
        Ok(())
    }

    fn evaluate(&self, series: &[f64]) -> [f64; 2] {
        match self.purpose {
            Purpose::Echo { .. } => [self.received(series), 0.0],
            Purpose::Decay { omega, .. } => {
                // Neighbours in the recurrence are an eighth of a turn apart.
                let stride = ((TAU / 8.0) / (omega * self.dt)).round().max(1.0) as usize;
                let (frequency, rate) = damped_sine(series, stride);
                [frequency / (stride as f64 * self.dt), rate / (stride as f64 * self.dt)]
            }
            Purpose::Response { omega, .. } => {
                let (mut sine, mut cosine) = (0.0, 0.0);
                // The last value is the first of the next period.
                let count = series.len() - 1;
                for (k, u) in series[..count].iter().enumerate() {
                    let (s, c) = libm::sincos(omega * self.dt * (self.first + k as u64) as f64);
                    (sine, cosine) = (sine + u * s, cosine + u * c);
                }
                [2.0 * sine / count as f64, 2.0 * cosine / count as f64]
            }
        }
    }

    /// Bounds of errors that the step of time does not make: rounding, and what is left of the start.
    fn rest(&self) -> [f64; 2] {
        let most = self.series[0].iter().fold(1.0, |most: f64, u| most.max(u.abs()));
        let count = self.chains[0].design().count();
        let rounding = rounding(2 * self.steps, 4.0 * most, count, count as f64);
        match self.purpose {
            Purpose::Echo { .. } => [rounding; 2],
            // Errors of the values over the last of them, in the angle between two of them.
            Purpose::Decay { omega, gamma } => {
                let last = libm::exp(-0.5 * gamma * self.steps as f64 * self.dt);
                let sharp = (1.0 - 0.25 * gamma * gamma / (omega * omega)).max(1e-3);
                [8.0 * omega * rounding / (last * sharp); 2]
            }
            Purpose::Response { .. } => [rounding + 4.0 * most * libm::exp(-FORGOTTEN); 2],
        }
    }

    /// Amplitude of the echo over the pulse sent, by projection on the pulse when it is due.
    fn received(&self, series: &[f64]) -> f64 {
        let sigma = SIGMA / self.material.omega_0();
        let (out, back) = self.ways();
        let due = CLEAR * sigma + (out + back) / self.material.speed();
        let (mut overlap, mut square) = (0.0, 0.0);
        for (i, &u) in series.iter().enumerate() {
            let t = (i as f64 * self.dt - due) / sigma;
            if t.abs() <= CLEAR {
                let g = libm::exp(-0.5 * t * t);
                (overlap, square) = (overlap + u * g, square + g * g);
            }
        }
        overlap / square
    }

    /// From the shaker to the sensor, and from there to the damper and back.
    fn ways(&self) -> (f64, f64) {
        let design = self.chains[0].design();
        let sensor = self.shape.iter().position(|&s| s == 1.0).unwrap_or(0);
        (design.place(sensor), 2.0 * (design.length() - design.place(sensor)))
    }

    /// What theory says of the two numbers, on the lattice and in continuous time.
    pub(super) fn expected(&self) -> [f64; 2] {
        let omega_0 = self.material.omega_0();
        match self.purpose {
            // The average over the pulse's spectrum, with the lattice's dispersion on the way.
            Purpose::Echo { impedance } => {
                const PARTS: i32 = 4000;
                let (out, back) = self.ways();
                let sigma = SIGMA / omega_0;
                let (mut sum, mut weights) = (0.0, 0.0);
                for part in 0..=PARTS {
                    let u = 7.0 * f64::from(part) / f64::from(PARTS);
                    let weight = libm::exp(-u * u) * if part == 0 { 0.5 } else { 1.0 };
                    let theta = 2.0 * libm::asin((0.5 * u / SIGMA).min(1.0));
                    let lag = (theta - u / (sigma * omega_0)) * (out + back) / self.material.spacing;
                    let (re, im) = theory::echo(impedance, theta);
                    let (sine, cosine) = libm::sincos(lag);
                    (sum, weights) = (sum + weight * (re * cosine - im * sine), weights + weight);
                }
                [sum / weights, 0.0]
            }
            Purpose::Decay { omega, gamma } => [(omega * omega - 0.25 * gamma * gamma).sqrt(), 0.5 * gamma],
            Purpose::Response { mass, omega, gamma } => {
                let (sine, cosine) = theory::response(omega, gamma, omega_0, self.chains[0].design().count())[mass];
                [sine, cosine]
            }
        }
    }

    /// Largest deviation from theory over its bound, once there is something to say.
    pub(super) fn deviation(&self) -> Option<f64> {
        let Finding { measured, bound } = self.finding?;
        let expected = self.expected();
        let of = |k: usize| if measured[k] == expected[k] { 0.0 } else { (measured[k] - expected[k]).abs() / bound[k] };
        Some(of(0).max(of(1)))
    }
}

/// How long a driven chain takes to forget its start, when no mode is overdamped: all others decay as `exp(-gamma t/2)`.
pub(super) fn settling(gamma: f64) -> f64 {
    2.0 * FORGOTTEN / gamma
}

/// Angle and rate of decay from value to value, `stride` apart, of the `exp(-r k)(a cos(w k) + b sin(w k))` that fits best: of the
/// recurrence `y_{k+1} = 2 exp(-r) cos(w) y_k - exp(-2 r) y_{k-1}`, in the sense of least squares.
fn damped_sine(series: &[f64], stride: usize) -> (f64, f64) {
    let [mut aa, mut ab, mut bb, mut ya, mut yb] = [0.0; 5];
    for k in stride..series.len().saturating_sub(stride) {
        let (before, here, after) = (series[k - stride], series[k], series[k + stride]);
        (aa, ab, bb) = (aa + here * here, ab + here * before, bb + before * before);
        (ya, yb) = (ya + after * here, yb + after * before);
    }
    let determinant = aa * bb - ab * ab;
    let (first, second) = ((ya * bb - yb * ab) / determinant, (ya * ab - yb * aa) / determinant);
    let kept = second.sqrt();
    (libm::acos(0.5 * first / kept), -libm::log(kept))
}
