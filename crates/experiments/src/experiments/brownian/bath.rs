//! One bath with one heavy particle in it, and what is noted of that particle.

use std::ops::ControlFlow;

use corpuscle_checkpoint::resume;
use corpuscle_core::placement::maxwell;
use corpuscle_core::{Axis, Boundary, Contact, Engine, Failure, Invalid, Meeting, Observer, Particles, Random, Vector};
use corpuscle_event::{EventDriven, Rules};
use corpuscle_observe::{Curves, Drift, MeanSquaredDisplacement, VelocityAutocorrelation};

use super::set::Set;
use crate::gas::{self, Species};
use crate::tally::Tally;

/// Index of the heavy particle: it is placed first.
pub(super) const TRACER: usize = 0;
/// Collisions per bath particle before the measurement starts: a lattice is no equilibrium.
const COLLISIONS_BEFORE: f64 = 10.0;

/// The kicks the tracer gets: `sum |dV|^2` over its collisions.
#[derive(Clone, Copy, Debug, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Kicks {
    /// `sum |dV|^2`.
    pub(super) squares: f64,
    /// Number of collisions.
    pub(super) count: u64,
}

impl<const D: usize> Observer<D> for Kicks {
    #[inline]
    fn contact(&mut self, contact: &Contact<D>) -> ControlFlow<()> {
        if let Meeting::Pair(second) = contact.with {
            for party in [contact.first, second] {
                if party.index == TRACER {
                    self.squares += (party.after - party.before).norm_squared();
                    self.count += 1;
                }
            }
        }
        ControlFlow::Continue(())
    }
}

/// A bath under way.
pub(super) struct Bath<const D: usize> {
    pub(super) engine: EventDriven<D>,
    pub(super) kicks: Kicks,
    /// Unwrapped positions of the tracer at the sampling times.
    pub(super) path: Vec<Vector<D>>,
    /// Sum of `|V|^2` over the samples.
    pub(super) speed_squares: f64,
    pub(super) energy: Drift<1>,
    pub(super) momentum: Drift<3>,
    displacement: MeanSquaredDisplacement<D>,
    velocity: VelocityAutocorrelation<D>,
    /// Physical time of the engine at which the measurement started.
    started: f64,
    /// Collisions of each particle, where this bath is on show.
    pub(super) tally: Tally,
}

resume!(Bath<const D> {
    values: [engine, kicks, path, speed_squares, energy, momentum],
    parts: [displacement, velocity],
    set_up: [started, tally],
});

impl<const D: usize> Bath<D> {
    /// Fills the box, puts the tracer in its middle, and lets the bath come to equilibrium.
    ///
    /// # Errors
    /// [`Invalid`] when the particles do not fit.
    pub(super) fn new(set: &Set<D>, stream: u64) -> Result<Self, Invalid> {
        let mut random = Random::new(set.seed, stream);
        let boundary = Boundary::new([0.0; D], [set.side; D], set.faces);
        let mut particles = Particles::new();
        particles.push(Vector::splat(0.5 * set.side), Vector::ZERO, set.mass, set.radius, 1);
        let bath = Species { count: set.particles, radius: set.bath_radius, mass: 1.0, index: 0 };
        gas::add(&mut particles, &boundary, bath, &mut random)?;
        if set.faces == Axis::Periodic {
            maxwell(&mut particles, set.temperature, true, &mut random);
        } else {
            gas::heat(&mut particles, set.temperature, &mut random);
        }
        let mut engine = EventDriven::new(boundary, particles, Rules::default())?;
        let started = COLLISIONS_BEFORE / set.collision_rate;
        engine.advance(started, &mut ()).map_err(|failure| Invalid::new("particles", set.particles, failure.to_string()))?;
        let mut bath = Self {
            engine,
            kicks: Kicks::default(),
            path: vec![],
            speed_squares: 0.0,
            energy: Drift::new(),
            momentum: Drift::new(),
            displacement: MeanSquaredDisplacement::new(set.interval),
            velocity: VelocityAutocorrelation::new(set.interval, set.longest_lag),
            started,
            tally: Tally::of(if stream == 0 { set.particles + 1 } else { 0 }),
        };
        bath.sample(set);
        Ok(bath)
    }

    /// Time on the engine's clock at which the measurement started.
    pub(super) fn started(&self) -> f64 {
        self.started
    }

    /// Time since the measurement started.
    pub(super) fn time(&self) -> f64 {
        self.engine.time() - self.started
    }

    /// Advances to `time` after the start of the measurement.
    ///
    /// # Errors
    /// [`Failure`] of the engine.
    pub(super) fn advance(&mut self, time: f64) -> Result<(), Failure> {
        self.engine.advance(self.started + time, &mut (&mut self.kicks, &mut self.tally))
    }

    /// Notes the tracer now.
    pub(super) fn sample(&mut self, set: &Set<D>) {
        let (place, velocity) = (self.engine.unwrapped(TRACER), self.engine.velocity(TRACER));
        self.path.push(place);
        self.speed_squares += velocity.norm_squared();
        self.displacement.push(&[place]);
        self.velocity.push(&[velocity]);
        self.energy.see_energy(self.engine.kinetic_energy());
        // Scale of the momentum: each of N particles carries sqrt(m k T) or so.
        self.momentum.see(self.engine.momentum().to_three(), set.particles as f64 * set.temperature.sqrt());
    }

    /// Mean squared displacement against the lag.
    pub(super) fn displacement(&self) -> Curves {
        self.displacement.curves()
    }

    /// Velocity autocorrelation against the lag.
    pub(super) fn velocity(&self) -> Curves {
        self.velocity.curves()
    }
}
