//! A tube full of discs, pushed both ways.

use std::f64::consts::TAU;

use corpuscle_checkpoint::resume;
use corpuscle_core::placement::maxwell;
use corpuscle_core::{Axis, Boundary, Contact, Engine, Failure, Invalid, Meeting, Particles, Random};
use corpuscle_event::{EventDriven, Rules};
use corpuscle_observe::theory;

use super::hydrodynamics::Wave;
use crate::Settings;
use crate::gas::{self, Species};
use crate::replicas::{Member, Watch};

/// Bins of the density along the tube.
pub(super) const BINS: usize = 24;
/// Length of the tube over its width.
const ASPECT: f64 = 4.0;
/// Collisions of a disc before the push: a lattice is no equilibrium.
const COLLISIONS_BEFORE: f64 = 25.0;
/// Share of the push's profile `((1 + cos)/2)^2` in its mean, the longest wave and the next.
const MODES: [f64; 3] = [0.375, 0.5, 0.125];

/// What all tubes have in common.
pub(super) struct Set {
    seed: u64,
    particles: usize,
    packing: f64,
    temperature: f64,
    boundary: Boundary<2>,
    /// Speed of sound by the equation of state.
    pub(super) speed: f64,
    /// Speed of the push in its middle.
    pub(super) push: f64,
}

impl Set {
    pub(super) fn new(settings: &Settings) -> Result<Self, Invalid> {
        let (particles, packing, temperature) =
            (settings.whole("particles"), settings.real("packing_fraction"), settings.real("temperature"));
        let width = gas::side::<2>(particles, 0.5, packing) / ASPECT.sqrt();
        if width < 3.0 {
            return Err(
                settings.invalid("particles", format!("enough for a tube three diameters wide; this one is {width:.2} wide"))
            );
        }
        let speed = theory::speed_of_sound::<2>(packing, temperature, 1.0);
        Ok(Self {
            seed: settings.seed,
            particles,
            packing,
            temperature,
            boundary: Boundary::new([0.0; 2], [ASPECT * width, width], Axis::Periodic),
            speed,
            push: settings.real("push") * speed,
        })
    }

    pub(super) fn particles(&self) -> usize {
        self.particles
    }

    pub(super) fn packing(&self) -> f64 {
        self.packing
    }

    pub(super) fn temperature(&self) -> f64 {
        self.temperature
    }

    pub(super) fn length(&self) -> f64 {
        self.boundary.upper[0]
    }

    pub(super) fn wave_number(&self) -> f64 {
        TAU / self.length()
    }

    /// Collisions of a disc per time.
    pub(super) fn collision_rate(&self) -> f64 {
        theory::hard_discs::collision_rate_of_few(self.packing, self.particles) * self.temperature.sqrt()
    }

    /// The wave that is `j` times as short as the tube, by linear hydrodynamics.
    pub(super) fn wave(&self, j: f64) -> Wave {
        Wave::new(self.packing, self.temperature, j * self.wave_number())
    }

    /// `delta n / n` against the distance from the middle of the push, by linear hydrodynamics.
    pub(super) fn density_change(&self, time: f64) -> impl Fn(f64) -> f64 {
        let k = self.wave_number();
        let amplitude = |j: f64, share: f64| {
            let [_, density, _] = self.wave(j).samples(time / 64.0, 65);
            self.push * share * density[64]
        };
        let (first, second) = (amplitude(1.0, MODES[1]), amplitude(2.0, MODES[2]));
        move |x| first * libm::sin(k * x) + second * libm::sin(2.0 * k * x)
    }
}

/// Half the difference of both tubes.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub(super) struct Sample {
    /// `sum v_x cos(k x)` and `sum sin(k x)`, `x` counted from the middle of the push.
    pub(super) current: f64,
    pub(super) density: f64,
    /// `sum (v^2/2 - kT) sin(k x)`.
    pub(super) heat: f64,
    /// Numbers in each bin.
    pub(super) bins: Vec<f64>,
}

/// What was seen of the gas before the push, in equilibrium.
struct Still {
    /// `sum J s` over the collisions.
    virial: f64,
    collisions: f64,
    time: f64,
    energy: f64,
}

/// Two tubes alike but for the sign of the push.
pub(super) struct Tube {
    engines: [EventDriven<2>; 2],
    pub(super) samples: Vec<Sample>,
    still: Still,
    energies: [f64; 2],
    length: f64,
    temperature: f64,
    started: f64,
}

resume!(Tube { values: [engines, samples], set_up: [still, energies, length, temperature, started] });

impl Tube {
    /// # Errors
    /// [`Invalid`] when the discs do not fit.
    pub(super) fn new(set: &Set, stream: u64) -> Result<Self, Invalid> {
        let mut random = Random::new(set.seed, stream);
        let mut particles = Particles::new();
        let species = Species { count: set.particles, radius: 0.5, mass: 1.0, index: 0 };
        if set.packing < 0.3 {
            gas::add(&mut particles, &set.boundary, species, &mut random)?;
        } else {
            gas::grow(&mut particles, &set.boundary, set.particles, &mut random)?;
        }
        maxwell(&mut particles, set.temperature, true, &mut random);
        let mut engine = EventDriven::new(set.boundary.clone(), particles, Rules::default())?;
        let started = COLLISIONS_BEFORE / set.collision_rate();
        engine.advance(started, &mut ()).map_err(|failure| Invalid::new("particles", set.particles, failure.to_string()))?;
        let before = started;
        let started = before + set.length() / set.speed;
        let mut virial = [0.0; 2];
        let mut note = |contact: &Contact<2>| {
            if let Meeting::Pair(_) = contact.with {
                virial[0] += contact.impulse * contact.distance;
                virial[1] += 1.0;
            }
        };
        engine
            .advance(started, &mut Watch(&mut note))
            .map_err(|failure| Invalid::new("particles", set.particles, failure.to_string()))?;
        let still = Still { virial: virial[0], collisions: virial[1], time: started - before, energy: engine.kinetic_energy() };
        let (k, middle) = (set.wave_number(), 0.5 * set.length());
        let shape = |x: f64| {
            let lobe = 0.5 * (1.0 + libm::cos(k * (x - middle)));
            lobe * lobe - MODES[0]
        };
        let shapes: Vec<f64> = (0..set.particles).map(|i| shape(engine.position(i)[0])).collect();
        // No net momentum: the gas as a whole stays where it is.
        let mean = shapes.iter().sum::<f64>() / shapes.len() as f64;
        let pushed = |sign: f64| {
            let mut engine = engine.clone();
            engine.set_velocities(|i, velocity| velocity[0] += sign * set.push * (shapes[i] - mean));
            engine
        };
        let engines = [pushed(1.0), pushed(-1.0)];
        let energies = [engines[0].kinetic_energy(), engines[1].kinetic_energy()];
        Ok(Self { engines, samples: vec![], still, energies, length: set.length(), temperature: set.temperature, started })
    }

    /// The tube on show.
    pub(super) fn engine(&self) -> &EventDriven<2> {
        &self.engines[0]
    }

    pub(super) fn started(&self) -> f64 {
        self.started
    }

    /// Both engines with the energies they started with.
    pub(super) fn runs(&self) -> impl Iterator<Item = (&EventDriven<2>, Option<f64>)> {
        self.engines.iter().zip(self.energies).map(|(engine, energy)| (engine, Some(energy)))
    }

    /// `P V/(N k T) = 1 + sum J s/(D N k T t)` before the push, with `k T = E/(N - 1)`, as the momentum of all is fixed.
    pub(super) fn compressibility(&self) -> f64 {
        let count = self.engines[0].particle_count() as f64;
        1.0 + self.still.virial / (2.0 * self.still.energy * self.still.time) * (count - 1.0) / count
    }

    /// Collisions of a disc per time before the push.
    pub(super) fn collision_rate(&self) -> f64 {
        2.0 * self.still.collisions / (self.engines[0].particle_count() as f64 * self.still.time)
    }
}

/// Velocity along the tube of each disc, averaged over its own slice.
pub(super) fn drift(engine: &EventDriven<2>) -> Vec<f64> {
    const SLICES: usize = 32;
    let length = engine.boundary().extent()[0];
    let slice = |i: usize| ((engine.position(i)[0] / length * SLICES as f64) as usize).min(SLICES - 1);
    let mut sums = [(0.0, 0.0); SLICES];
    for i in 0..engine.particle_count() {
        let sum = &mut sums[slice(i)];
        *sum = (sum.0 + engine.velocity(i)[0], sum.1 + 1.0);
    }
    (0..engine.particle_count()).map(|i| sums[slice(i)].0 / sums[slice(i)].1).collect()
}

impl Member for Tube {
    fn advance(&mut self, time: f64) -> Result<(), Failure> {
        self.engines.iter_mut().try_for_each(|engine| engine.advance(self.started + time, &mut ()))
    }

    fn sample(&mut self) {
        let (k, middle) = (TAU / self.length, 0.5 * self.length);
        let mut sample = Sample { current: 0.0, density: 0.0, heat: 0.0, bins: vec![0.0; BINS] };
        for (engine, sign) in self.engines.iter().zip([0.5, -0.5]) {
            for i in 0..engine.particle_count() {
                let (place, velocity) = (engine.position(i)[0], engine.velocity(i));
                let (sine, cosine) = libm::sincos(k * (place - middle));
                sample.current += sign * velocity[0] * cosine;
                sample.density += sign * sine;
                sample.heat += sign * (0.5 * velocity.norm_squared() - self.temperature) * sine;
                sample.bins[((place / self.length * BINS as f64) as usize).min(BINS - 1)] += sign;
            }
        }
        self.samples.push(sample);
    }

    fn time(&self) -> f64 {
        self.engines[0].time() - self.started
    }
}
