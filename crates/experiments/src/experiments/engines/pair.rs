//! One gas, computed twice from the same start.

use corpuscle_checkpoint::resume;
use corpuscle_core::placement::maxwell;
use corpuscle_core::{Boundary, Contact, Engine, Failure, Invalid, Meeting, Particles, Random, Vector};
use corpuscle_event::{EventDriven, Rules};
use corpuscle_observe::theory;
use corpuscle_time::{Force, HarmonicRepulsion, Integrator, PairForce, TimeDriven};

use super::chords::Chords;
use crate::Settings;
use crate::gas::{self, Species};
use crate::replicas::{Member, Watch};

/// Collisions of a particle before the race starts.
const SETTLING: f64 = 15.0;
/// Samples in the mean time between collisions of a particle.
pub(super) const RESOLUTION: f64 = 10.0;
/// How much faster or slower the twin's particles start, each in a direction of its own.
const TWIN: f64 = 1e-9;
/// Packing fraction above which discs have to grow into their places.
const DENSE: f64 = 0.4;

/// What all pairs have in common. Diameters, masses and the temperature are 1.
pub(super) struct Set {
    seed: u64,
    pub(super) particles: usize,
    pub(super) packing: f64,
    /// Energy of two discs that have fallen together, in kT.
    pub(super) hardness: f64,
    pub(super) steps_per_contact: f64,
    pub(super) side: f64,
}

impl Set {
    pub(super) fn new(settings: &Settings) -> Self {
        let (particles, packing) = (settings.whole("particles"), settings.real("packing_fraction"));
        Self {
            seed: settings.seed,
            particles,
            packing,
            hardness: settings.real("hardness"),
            steps_per_contact: settings.real("steps_per_contact"),
            side: gas::side::<2>(particles, 0.5, packing),
        }
    }

    /// Collisions of a particle per time, Enskog.
    pub(super) fn rate(&self) -> f64 {
        theory::collision_rate::<2>(self.particles as f64 / (self.side * self.side), 1.0, 1.0, 1.0)
    }

    /// Stiffness of the harmonic repulsion: `k s^2/2` is its height.
    fn stiffness(&self) -> f64 {
        2.0 * self.hardness
    }

    /// Time in contact of two soft discs, half a period of their reduced mass 1/2: `pi sqrt(m/(2 k))`.
    pub(super) fn contact_time(&self) -> f64 {
        std::f64::consts::PI * (0.5 / self.stiffness()).sqrt()
    }

    /// Diameter of hard discs that have the pressure of these, `int (1 - exp(-U/kT)) dr = 1 - sqrt(pi kT/(2 k))` (Barker and
    /// Henderson 1967, doi:10.1063/1.1701689), to first order in what the potential is softer.
    pub(super) fn effective_diameter(&self) -> f64 {
        1.0 - (0.5 * std::f64::consts::PI / self.stiffness()).sqrt()
    }

    /// Time between samples, and the step: a whole number of them.
    pub(super) fn interval(&self) -> f64 {
        1.0 / (RESOLUTION * self.rate())
    }

    pub(super) fn step(&self) -> f64 {
        let wanted = self.contact_time() / self.steps_per_contact;
        self.interval() / (self.interval() / wanted).ceil()
    }
}

/// What is noted of a pair at one time.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
pub(super) struct Sample {
    /// Root mean square distance of a particle from itself in the other engine, and in the twin.
    pub(super) apart: f64,
    pub(super) twins: f64,
    /// Relative error of the time-driven engine's energy.
    pub(super) drift: f64,
    /// Sum of impulse times distance over all collisions of the event-driven engine so far.
    pub(super) work: f64,
    /// Twice the kinetic energy, and the virial, of the time-driven engine.
    pub(super) kinetic: f64,
    pub(super) virial: f64,
}

/// A gas in both engines, and in the event-driven one again, a hair beside.
pub(super) struct Pair {
    pub(super) hard: EventDriven<2>,
    pub(super) soft: TimeDriven<2>,
    twin: EventDriven<2>,
    pub(super) chords: Chords,
    /// Sum of the impulses times the distance over all collisions.
    virial: f64,
    pub(super) samples: Vec<Sample>,
    pub(super) energy: f64,
}

resume!(Pair { values: [hard, twin, chords, virial, samples], parts: [soft], set_up: [energy] });

impl Pair {
    /// # Errors
    /// [`Invalid`] when the discs do not fit.
    pub(super) fn new(set: &Set, stream: u64) -> Result<Self, Invalid> {
        let mut random = Random::new(set.seed, stream);
        let boundary = Boundary::<2>::periodic(set.side);
        let mut particles = Particles::new();
        let species = Species { count: set.particles, radius: 0.5, mass: 1.0, index: 0 };
        if set.packing < DENSE {
            gas::add(&mut particles, &boundary, species, &mut random)?;
        } else {
            gas::grow(&mut particles, &boundary, set.particles, &mut random)?;
        }
        maxwell(&mut particles, 1.0, true, &mut random);
        let mut mixed = EventDriven::new(boundary.clone(), particles, Rules::default())?;
        let settled = SETTLING / set.rate();
        mixed.advance(settled, &mut ()).map_err(|failure| Invalid::new("particles", set.particles, failure.to_string()))?;
        let start = mixed.snapshot();
        let mut beside = start.clone();
        for i in 0..set.particles {
            let (sine, cosine) = libm::sincos(std::f64::consts::TAU * random.uniform());
            beside.velocity[i] += Vector([cosine, sine]) * TWIN;
        }
        let force: Box<dyn Force<2>> = Box::new(PairForce::new(HarmonicRepulsion { stiffness: set.stiffness(), diameter: 1.0 }));
        let hard = EventDriven::new(boundary.clone(), start.clone(), Rules::default())?;
        Ok(Self {
            energy: hard.kinetic_energy(),
            hard,
            twin: EventDriven::new(boundary.clone(), beside, Rules::default())?,
            soft: TimeDriven::new(boundary, start, vec![force], Integrator::VelocityVerlet { dt: set.step() })?,
            chords: Chords::default(),
            virial: 0.0,
            samples: vec![],
        })
    }

    /// Distance of a particle from itself in the time-driven engine, both moved to the later one's time.
    pub(super) fn distance(&self, particle: usize) -> f64 {
        let soft = self.soft.particles();
        let place = soft.position[particle] + soft.velocity[particle] * (self.hard.time() - self.soft.time());
        self.hard.boundary().displacement(self.hard.position(particle), place).norm()
    }

    /// `P V/(N kT)` of the event-driven engine up to the last sample, at this time.
    pub(super) fn hard_compressibility(&self, time: f64) -> f64 {
        let work = self.samples.last().map_or(0.0, |sample| sample.work);
        1.0 + work / (2.0 * self.hard.particle_count() as f64 * time)
    }

    /// The same of the time-driven one, at the temperature it has.
    pub(super) fn soft_compressibility(&self) -> f64 {
        let sum = |number: fn(&Sample) -> f64| self.samples.iter().map(number).sum::<f64>();
        // N kT, of which the kinetic energy of N - 1 particles tells, as the momentum of all is fixed.
        let count = self.hard.particle_count() as f64;
        1.0 + sum(|sample| sample.virial) / sum(|sample| sample.kinetic) * (count - 1.0) / count
    }

    /// Temperature of the time-driven engine.
    pub(super) fn soft_temperature(&self) -> f64 {
        let freedom = 2.0 * (self.hard.particle_count() as f64 - 1.0);
        self.samples.iter().map(|sample| sample.kinetic).sum::<f64>() / (freedom * self.samples.len() as f64)
    }
}

impl Member for Pair {
    fn advance(&mut self, time: f64) -> Result<(), Failure> {
        let Self { hard, soft, twin, chords, virial, .. } = self;
        let mut meet = |contact: &Contact<2>| {
            if let Meeting::Pair(second) = contact.with {
                *virial += contact.impulse * contact.distance;
                let velocity = contact.first.before - second.before;
                chords.add(2.0 * velocity.dot(contact.normal).abs() / velocity.norm_squared());
            }
        };
        hard.advance(time, &mut Watch(&mut meet))?;
        twin.advance(time, &mut ())?;
        soft.advance(time, &mut ())
    }

    fn sample(&mut self) {
        let count = self.hard.particle_count();
        let mean = |square: &dyn Fn(usize) -> f64| ((0..count).map(square).sum::<f64>() / count as f64).sqrt();
        let boundary = self.hard.boundary();
        let twin = |i: usize| boundary.displacement(self.hard.position(i), self.twin.position(i)).norm_squared();
        self.samples.push(Sample {
            apart: mean(&|i| self.distance(i).powi(2)),
            twins: mean(&twin),
            work: self.virial,
            drift: (self.soft.energy() / self.energy - 1.0).abs(),
            kinetic: 2.0 * self.soft.kinetic_energy(),
            virial: self.soft.virial(),
        });
    }

    fn time(&self) -> f64 {
        self.hard.time()
    }
}
