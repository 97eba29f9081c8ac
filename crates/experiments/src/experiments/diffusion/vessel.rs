//! A vessel with its gas, of which the particles in the middle are marked.

use corpuscle_checkpoint::resume;
use corpuscle_core::placement::maxwell;
use corpuscle_core::{Boundary, Contact, Engine, Failure, Invalid, Meeting, Particles, Random, Vector};
use corpuscle_event::{EventDriven, Rules};
use corpuscle_observe::theory;

use super::wave::Drop;
use crate::Settings;
use crate::gas::{self, Species};
use crate::replicas::{Member, Watch};

/// Bins along each axis, in which marked particles are counted.
pub(super) const BINS: usize = 32;
/// Collisions of a particle before the drop is marked.
const SETTLING: f64 = 15.0;
/// Packing fraction above which particles have to grow into their places.
const DENSE: f64 = 0.3;

/// What all vessels have in common. Diameters and masses are 1.
pub(super) struct Set<const D: usize> {
    seed: u64,
    pub(super) particles: usize,
    pub(super) packing: f64,
    pub(super) temperature: f64,
    pub(super) drop: Drop<D>,
}

impl<const D: usize> Set<D> {
    pub(super) fn new(settings: &Settings) -> Result<Self, Invalid> {
        let (particles, packing) = (settings.whole("particles"), settings.real("packing_fraction"));
        let most = if D == 2 { 0.65 } else { 0.47 };
        if packing > most {
            return Err(settings
                .invalid("packing_fraction", format!("at most {most}: denser particles freeze, and a crystal does not mix")));
        }
        let drop = Drop { radius: settings.real("drop_radius"), side: gas::side::<D>(particles, 0.5, packing) };
        if drop.share() * (particles as f64) < 10.0 {
            return Err(settings.invalid("drop_radius", "so much that ten particles are in the drop"));
        }
        Ok(Self { seed: settings.seed, particles, packing, temperature: settings.real("temperature"), drop })
    }

    pub(super) fn density(&self) -> f64 {
        self.particles as f64 / self.drop.volume()
    }

    /// Enskog's coefficient of diffusion.
    pub(super) fn enskog(&self) -> f64 {
        theory::self_diffusion::<D>(self.density(), 1.0, self.temperature, 1.0)
    }

    /// Time in which the longest wave of the concentration fades to `1/e`.
    pub(super) fn fading(&self) -> f64 {
        1.0 / (self.enskog() * self.drop.wave_number(1).powi(2))
    }
}

/// What is noted of a vessel at one time.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub(super) struct Sample {
    /// Mean squared displacement along one axis, of particles that are not marked and of those that are.
    pub(super) spread: [f64; 2],
    /// Mean of `cos(k x)` of the marked ones over all axes, for the two longest waves.
    pub(super) waves: [f64; 2],
    /// Marked particles along each axis, all axes together.
    pub(super) bins: Vec<f64>,
    /// Sum of `(dv . n)^2` over all collisions so far.
    kicks: f64,
}

/// A vessel under way.
pub(super) struct Vessel<const D: usize> {
    pub(super) engine: EventDriven<D>,
    pub(super) samples: Vec<Sample>,
    /// Sum of `(dv . n)^2` over all collisions.
    kicks: f64,
    drop: Drop<D>,
    /// Places and times at which the drop was marked, and who belongs to it.
    origin: Vec<Vector<D>>,
    marked: Vec<bool>,
    pub(super) started: f64,
    pub(super) energy: f64,
}

resume!(Vessel<const D> { values: [engine, samples, kicks], set_up: [drop, origin, marked, started, energy] });

impl<const D: usize> Vessel<D> {
    /// A gas in equilibrium, and the drop in its middle.
    ///
    /// # Errors
    /// [`Invalid`] when the gas does not fit.
    pub(super) fn new(set: &Set<D>, stream: u64) -> Result<Self, Invalid> {
        let mut random = Random::new(set.seed, stream);
        let boundary = Boundary::<D>::periodic(set.drop.side);
        let mut particles = Particles::new();
        let species = Species { count: set.particles, radius: 0.5, mass: 1.0, index: 0 };
        if set.packing < DENSE {
            gas::add(&mut particles, &boundary, species, &mut random)?;
        } else {
            gas::grow(&mut particles, &boundary, set.particles, &mut random)?;
        }
        maxwell(&mut particles, set.temperature, true, &mut random);
        let mut engine = EventDriven::new(boundary, particles, Rules::default())?;
        let started = SETTLING / theory::collision_rate::<D>(set.density(), 1.0, set.temperature, 1.0);
        engine.advance(started, &mut ()).map_err(|failure| Invalid::new("particles", set.particles, failure.to_string()))?;
        let origin: Vec<Vector<D>> = (0..set.particles).map(|i| engine.unwrapped(i)).collect();
        let marked = (0..set.particles).map(|i| set.drop.holds(engine.position(i))).collect();
        let energy = engine.kinetic_energy();
        Ok(Self { engine, samples: vec![], kicks: 0.0, drop: set.drop, origin, marked, started, energy })
    }

    pub(super) fn is_marked(&self, particle: usize) -> bool {
        self.marked[particle]
    }

    /// Friction by the kicks of collisions up to a sample at this time, `-<v . dv>/(D kT dt)`: of two equal particles the sum of both `v . dv` is `-(dv . n)^2`.
    pub(super) fn friction(&self, sample: usize, time: f64, temperature: f64) -> f64 {
        self.samples[sample].kicks / ((self.marked.len() as f64 - 1.0) * D as f64 * temperature * time)
    }
}

impl<const D: usize> Member for Vessel<D> {
    fn advance(&mut self, time: f64) -> Result<(), Failure> {
        let kicks = &mut self.kicks;
        let mut feel = |contact: &Contact<D>| {
            if let Meeting::Pair(_) = contact.with {
                *kicks += contact.impulse * contact.impulse;
            }
        };
        self.engine.advance(self.started + time, &mut Watch(&mut feel))
    }

    fn sample(&mut self) {
        let (mut squares, mut counts) = ([0.0; 2], [0.0; 2]);
        let (mut waves, mut bins) = ([0.0; 2], vec![0.0; BINS]);
        let side = self.drop.side;
        for (i, (&origin, &marked)) in self.origin.iter().zip(&self.marked).enumerate() {
            let kind = usize::from(marked);
            squares[kind] += (self.engine.unwrapped(i) - origin).norm_squared();
            counts[kind] += 1.0;
            if marked {
                let place = self.engine.position(i);
                for k in 0..D {
                    for (wave, sum) in waves.iter_mut().enumerate() {
                        *sum += libm::cos(self.drop.wave_number(wave + 1) * (place[k] - 0.5 * side));
                    }
                    bins[((place[k] / side * BINS as f64) as usize).min(BINS - 1)] += 1.0;
                }
            }
        }
        let per_axis = |value: f64, count: f64| value / (D as f64 * count.max(1.0));
        self.samples.push(Sample {
            spread: std::array::from_fn(|kind| per_axis(squares[kind], counts[kind])),
            waves: waves.map(|wave| per_axis(wave, counts[1])),
            kicks: self.kicks,
            bins: bins.into_iter().map(|bin| per_axis(bin, counts[1])).collect(),
        });
    }

    fn time(&self) -> f64 {
        self.engine.time() - self.started
    }
}
