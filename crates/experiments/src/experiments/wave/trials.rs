//! Measurements on chains of their own, beside the one on show: modes, echoes, a density step, a travelling wave, and the
//! limit of stability. Each records a few numbers a step and is evaluated once, when it is done.

mod evaluation;

use std::f64::consts::TAU;

use corpuscle_checkpoint::resume;
use corpuscle_core::{Failure, Invalid, Random};
use corpuscle_time::{Integrator, Signal};

use super::chain::{Chain, Design, End, Ends, Polarisation};
use super::theory::{self, Modes};

/// What all trials share: the material of the chain on show and its step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Material {
    pub(super) stiffness: f64,
    pub(super) mass: f64,
    pub(super) spacing: f64,
    pub(super) polarisation: Polarisation,
    pub(super) time_step: f64,
    pub(super) seed: u64,
}

impl Material {
    /// `omega_0 = sqrt(kappa / m)`; its inverse is the time a long wave takes from mass to mass.
    pub(super) fn omega_0(&self) -> f64 {
        (self.stiffness / self.mass).sqrt()
    }

    /// Speed of long waves `c = a sqrt(kappa / m)`.
    pub(super) fn speed(&self) -> f64 {
        self.spacing * self.omega_0()
    }

    /// Small enough for the order of longitudinal masses; the equations are linear, so that the value does not matter.
    fn amplitude(&self) -> f64 {
        0.1 * self.spacing
    }

    /// Step of a trial whose lightest mass is `lightest` times the usual one: `omega dt` stays the user's, but a very fine
    /// step is not needed where its error is known exactly.
    fn step(&self, lightest: f64) -> f64 {
        self.time_step.max(0.02 / self.omega_0()) * lightest.min(1.0).sqrt()
    }

    /// Step of the trials on uniform chains.
    pub(super) fn trial_step(&self) -> f64 {
        self.step(1.0)
    }

    fn design(&self, masses: Vec<f64>, ends: Ends, dt: f64) -> Design {
        let integrator = Integrator::VelocityVerlet { dt };
        let Self { stiffness, spacing, polarisation, .. } = *self;
        Design { masses, stiffness, spacing, polarisation, ends, integrator, friction: vec![] }
    }

    /// Largest coordinate that gets rounded, over the amplitude.
    fn rounded(&self, design: &Design, amplitude: f64) -> f64 {
        match self.polarisation {
            Polarisation::Transverse => 2.0,
            Polarisation::Longitudinal => 2.0 + design.length() / amplitude,
        }
    }
}

/// One mode's frequency.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
pub(super) struct Tone {
    pub(super) number: usize,
    /// `k a`.
    pub(super) phase: f64,
    /// Fitted to the motion.
    pub(super) measured: f64,
    /// Of the chain in continuous time.
    pub(super) chain: f64,
    /// Of the chain advanced by velocity Verlet.
    pub(super) verlet: f64,
}

/// What a trial found.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub(super) enum Finding {
    /// Frequencies of all modes, and the bound of their relative error.
    Modes { tones: Vec<Tone>, bound: f64 },
    /// A pulse sent to an end: amplitude of its echo, and speed there and back, with the bounds of their errors (the
    /// speed's relative to itself).
    Echo { amplitude: f64, bound: f64, speed: f64, speed_bound: f64 },
    /// A pulse sent through a density step, over the incident amplitude, with the bounds of both errors.
    Step { ratio: f64, reflected: f64, transmitted: f64, bounds: (f64, f64) },
    /// Frequency and wavenumber of a running wave.
    Travel { frequency: f64, wavelength: f64 },
    /// Growth of the fastest mode: largest amplitude seen and growth rate a step.
    Growth { number: f64, largest: f64, rate: f64, steps: u64 },
}

#[derive(Clone, Copy, Debug)]
enum Purpose {
    Modes,
    Echo { end: End },
    Step { ratio: f64 },
    Travel,
    Growth { number: f64 },
}

#[derive(Clone, Debug)]
enum Probe {
    Place(usize),
    Shape(Vec<f64>),
}

/// A chain with probes.
pub(super) struct Trial {
    purpose: Purpose,
    material: Material,
    chain: Chain,
    dt: f64,
    steps: u64,
    probes: Vec<Probe>,
    series: Vec<Vec<f64>>,
    /// Standard deviation in time of the pulse sent, where one is.
    sigma: f64,
    finding: Option<Finding>,
}

/// Masses of the chains whose modes are measured; odd, so that a ring has no mode that a cosine misses.
const MODE_MASSES: usize = 49;
/// Standard deviation of a test pulse, in the time from mass to mass.
const SIGMA: f64 = 12.0;
/// Distances in these deviations: from shaker to first sensor and from there to the end or step; a wave is then clear of
/// every other by 9 deviations, where a Gaussian is `exp(-40)`.
const CLEAR: f64 = 9.0;
/// From a density step to the sensor behind it.
const BEHIND: f64 = 2.0;
/// The running wave: masses and waves around the ring.
const RING: (usize, usize) = (80, 2);

resume!(Trial { values: [series, finding], parts: [chain], set_up: [purpose, material, dt, steps, probes, sigma] });

impl Trial {
    /// All modes of a uniform chain at once, at equal amplitudes and random phases.
    ///
    /// # Errors
    /// As [`Chain::new`].
    pub(super) fn modes(material: Material, ends: Ends, stream: u64) -> Result<Self, Invalid> {
        let dt = material.step(1.0);
        let design = material.design(vec![material.mass; MODE_MASSES], ends, dt);
        let mut random = Random::new(material.seed, stream);
        let (mut displacement, mut velocity) = (vec![0.0; MODE_MASSES], vec![0.0; MODE_MASSES]);
        let mut probes = vec![];
        let modes = Modes::of(&design);
        let amplitude = material.amplitude() / MODE_MASSES as f64;
        for j in 1..=modes.map_or(0, |modes| modes.highest()) {
            let Some(modes) = modes else { break };
            let (sine, cosine) = libm::sincos(TAU * random.uniform());
            let omega = theory::dispersion(material.omega_0(), modes.phase(j));
            let shape = modes.shape(j);
            for (n, s) in shape.iter().enumerate() {
                displacement[n] += amplitude * cosine * s;
                velocity[n] += amplitude * omega * sine * s;
            }
            probes.push(Probe::Shape(shape));
        }
        let chain = Chain::new(design, &displacement, &velocity)?;
        // Three periods of the slowest mode, at most 2 (N + 1) / omega_0 long.
        let steps = 6.0 * (MODE_MASSES + 1) as f64 / (material.omega_0() * dt);
        Ok(Self::new(Purpose::Modes, material, chain, dt, steps, probes, 0.0))
    }

    /// A pulse from a shaker to an end and back.
    ///
    /// # Errors
    /// As [`Chain::new`].
    pub(super) fn echo(material: Material, end: End) -> Result<Self, Invalid> {
        let dt = material.step(1.0);
        let sensor = (CLEAR * SIGMA) as usize;
        let shaker = Self::shaker(material, SIGMA);
        let design = material.design(vec![material.mass; 2 * sensor], Ends::Between(shaker, end), dt);
        let chain = Chain::new(design, &[], &[])?;
        let sigma = SIGMA / material.omega_0();
        let steps = 5.0 * CLEAR * sigma / dt;
        Ok(Self::new(Purpose::Echo { end }, material, chain, dt, steps, vec![Probe::Place(sensor - 1)], sigma))
    }

    /// A pulse from a shaker through a place where the density changes by `ratio`.
    ///
    /// # Errors
    /// As [`Chain::new`].
    pub(super) fn step(material: Material, ratio: f64) -> Result<Self, Invalid> {
        let dt = material.step(ratio);
        // A pulse is shortened in a denser part: it starts longer, to be a long wave everywhere.
        let wide = SIGMA * ratio.max(1.0).sqrt();
        let sensor = (CLEAR * wide) as usize;
        let behind = (BEHIND * wide / ratio.sqrt()) as usize;
        let beyond = ((BEHIND + CLEAR) * wide / ratio.sqrt()) as usize;
        let mut masses = vec![material.mass; 2 * sensor];
        masses.resize(2 * sensor + beyond, material.mass * ratio);
        let design = material.design(masses, Ends::Between(Self::shaker(material, wide), End::Fixed), dt);
        let chain = Chain::new(design, &[], &[])?;
        let sigma = wide / material.omega_0();
        let steps = 5.0 * CLEAR * sigma / dt;
        let probes = vec![Probe::Place(sensor - 1), Probe::Place(2 * sensor + behind)];
        Ok(Self::new(Purpose::Step { ratio }, material, chain, dt, steps, probes, sigma))
    }

    /// A sinusoidal wave that runs around a ring.
    ///
    /// # Errors
    /// As [`Chain::new`].
    pub(super) fn travel(material: Material) -> Result<Self, Invalid> {
        let (dt, (count, waves)) = (material.step(1.0), RING);
        let design = material.design(vec![material.mass; count], Ends::Ring, dt);
        let phase = TAU * waves as f64 / count as f64;
        let omega = theory::verlet_frequency(theory::dispersion(material.omega_0(), phase), dt);
        // The velocity of velocity Verlet is the central difference of its positions.
        let rate = material.amplitude() * libm::sin(omega * dt) / dt;
        let at = |n: usize| libm::sincos(phase * (n as f64 + 0.5));
        let displacement: Vec<f64> = (0..count).map(|n| material.amplitude() * at(n).1).collect();
        let velocity: Vec<f64> = (0..count).map(|n| rate * at(n).0).collect();
        let chain = Chain::new(design, &displacement, &velocity)?;
        let steps = 3.0 * TAU / (omega * dt);
        Ok(Self::new(Purpose::Travel, material, chain, dt, steps, vec![Probe::Place(0)], 0.0))
    }

    /// The fastest motion of a ring, neighbours against each other, at the stability number `omega dt`. It is transverse
    /// whatever the chain on show is: longitudinal masses that run away would pass through each other.
    ///
    /// # Errors
    /// As [`Chain::new`].
    pub(super) fn growth(mut material: Material, number: f64, steps: u64) -> Result<Self, Invalid> {
        material.polarisation = Polarisation::Transverse;
        let dt = number / (2.0 * material.omega_0());
        let design = material.design(vec![material.mass; 16], Ends::Ring, dt);
        let shape: Vec<f64> = (0..16).map(|n| if n % 2 == 0 { 1.0 } else { -1.0 }).collect();
        let chain = Chain::new(design, &shape, &[])?;
        Ok(Self::new(Purpose::Growth { number }, material, chain, dt, steps as f64, vec![Probe::Shape(shape)], 0.0))
    }

    fn new(purpose: Purpose, material: Material, chain: Chain, dt: f64, steps: f64, probes: Vec<Probe>, sigma: f64) -> Self {
        let series = vec![vec![]; probes.len()];
        let mut trial = Self { purpose, material, chain, dt, steps: steps.ceil() as u64, probes, series, sigma, finding: None };
        trial.record();
        trial
    }

    /// A shaker that sends a Gaussian pulse of `wide` times from mass to mass, at rest at the start but for `exp(-40)`.
    fn shaker(material: Material, wide: f64) -> End {
        let width = wide / material.omega_0();
        End::Driven(Signal::Pulse { amplitude: material.amplitude(), centre: CLEAR * width, width })
    }

    /// What was found, when the trial is done.
    pub(super) fn finding(&self) -> Option<&Finding> {
        self.finding.as_ref()
    }

    /// Steps taken.
    pub(super) fn work(&self) -> u64 {
        self.chain.steps()
    }

    /// Advances to this share of the whole trial.
    ///
    /// # Errors
    /// As [`Chain::advance`].
    pub(super) fn advance(&mut self, share: f64) -> Result<(), Failure> {
        let target = (self.steps as f64 * share.clamp(0.0, 1.0)) as u64;
        while self.chain.steps() < target {
            self.chain.advance((self.chain.steps() + 1) as f64 * self.dt)?;
            self.record();
        }
        if self.finding.is_none() && self.chain.steps() >= self.steps {
            self.finding = self.evaluate();
        }
        Ok(())
    }

    fn record(&mut self) {
        let all =
            if self.probes.iter().any(|probe| matches!(probe, Probe::Shape(_))) { self.chain.displacements() } else { vec![] };
        for (probe, series) in self.probes.iter().zip(&mut self.series) {
            series.push(match probe {
                Probe::Place(n) => self.chain.displacement(*n),
                Probe::Shape(shape) => theory::project(&all, shape),
            });
        }
    }
}
