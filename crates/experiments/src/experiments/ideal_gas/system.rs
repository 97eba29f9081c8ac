//! One gas in its own box, with its manometer and its speedometer.

use std::ops::ControlFlow;

use corpuscle_checkpoint::resume;
use corpuscle_core::placement::maxwell;
use corpuscle_core::{Axis, Boundary, Contact, Engine, Failure, Invalid, Meeting, Observer, Particles, Random, Vector};
use corpuscle_event::{EventDriven, Rules};
use corpuscle_observe::distribution::incomplete_beta;
use corpuscle_observe::theory::collision_rate;
use corpuscle_observe::{Drift, Schedule};

use crate::gas::{self, Species};
use crate::study::Vessel;
use crate::tally::Tally;

/// A state of the gas: what an experimenter sets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct State {
    pub(super) count: usize,
    pub(super) temperature: f64,
    /// Side of the cube (square).
    pub(super) side: f64,
    pub(super) radius: f64,
    pub(super) mass: f64,
    pub(super) axis: Axis,
}

impl State {
    /// Side of the cube open to the centres.
    pub(super) fn open_side(&self) -> f64 {
        self.side - if self.axis == Axis::Walls { 2.0 * self.radius } else { 0.0 }
    }

    /// Volume open to the centres.
    pub(super) fn volume<const D: usize>(&self) -> f64 {
        self.open_side().powi(D as i32)
    }

    /// Pressure of the ideal gas of centres, `N k T / V_acc`.
    pub(super) fn ideal_pressure<const D: usize>(&self) -> f64 {
        self.count as f64 * self.temperature / self.volume::<D>()
    }

    /// Thermal speed `sqrt(kT/m)`.
    pub(super) fn thermal_speed(&self) -> f64 {
        (self.temperature / self.mass).sqrt()
    }

    /// Collisions a particle suffers per time.
    pub(super) fn collision_rate<const D: usize>(&self) -> f64 {
        let density = self.count as f64 / self.volume::<D>();
        collision_rate::<D>(density, 2.0 * self.radius, self.temperature, self.mass)
    }

    /// Its box.
    pub(super) fn boundary<const D: usize>(&self) -> Boundary<D> {
        Boundary::new([0.0; D], [self.side; D], self.axis)
    }

    /// The particles in some box at exactly this temperature.
    pub(super) fn particles<const D: usize>(&self, boundary: &Boundary<D>, random: &mut Random) -> Result<Particles<D>, Invalid> {
        let mut particles = Particles::new();
        let species = Species { count: self.count, radius: self.radius, mass: self.mass, index: 0 };
        gas::add(&mut particles, boundary, species, random)?;
        if self.axis == Axis::Walls {
            gas::heat(&mut particles, self.temperature, random);
        } else {
            maxwell(&mut particles, self.temperature, true, random);
        }
        Ok(particles)
    }

    /// The gas in its box, watched from this time on.
    pub(super) fn vessel<const D: usize>(&self, wait: f64, random: &mut Random) -> Result<Vessel<D>, Invalid> {
        let boundary = self.boundary();
        let particles = self.particles(&boundary, random)?;
        Vessel::new(boundary, particles, wait, random)
    }

    fn start<const D: usize>(&self, random: &mut Random) -> Result<EventDriven<D>, Invalid> {
        let boundary = self.boundary();
        let particles = self.particles(&boundary, random)?;
        EventDriven::new(boundary, particles, Rules::default())
    }
}

/// What the manometers have counted since the start of the measurement.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Totals<const D: usize> {
    /// Sum of the impulses on both faces across each axis.
    #[serde(with = "corpuscle_core::array")]
    pub(super) walls: [f64; D],
    /// Hits on walls, and the sum of the squares of their impulses.
    pub(super) hits: u64,
    pub(super) squares: f64,
    /// Sum of impulse times distance over the collisions of pairs.
    pub(super) virial: f64,
    pub(super) collisions: u64,
}

impl<const D: usize> Totals<D> {
    pub(super) const ZERO: Self = Self { walls: [0.0; D], hits: 0, squares: 0.0, virial: 0.0, collisions: 0 };

    /// What was counted since an earlier reading.
    pub(super) fn since(&self, earlier: &Self) -> Self {
        Self {
            walls: std::array::from_fn(|k| self.walls[k] - earlier.walls[k]),
            hits: self.hits - earlier.hits,
            squares: self.squares - earlier.squares,
            virial: self.virial - earlier.virial,
            collisions: self.collisions - earlier.collisions,
        }
    }

    /// Sum of all impulses on walls.
    pub(super) fn impulse(&self) -> f64 {
        self.walls.iter().sum()
    }
}

impl<const D: usize> Observer<D> for Totals<D> {
    #[inline]
    fn contact(&mut self, contact: &Contact<D>) -> ControlFlow<()> {
        match contact.with {
            Meeting::Face { axis, .. } => {
                self.walls[axis] += contact.impulse;
                self.squares += contact.impulse * contact.impulse;
                self.hits += 1;
            }
            Meeting::Pair(_) => {
                self.virial += contact.impulse * contact.distance;
                self.collisions += 1;
            }
            Meeting::Partition { .. } | Meeting::Obstacle { .. } | Meeting::Piston { .. } => {}
        }
        ControlFlow::Continue(())
    }
}

/// Speeds and kinetic energies per axis, from snapshots that have forgotten each other.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Speeds {
    /// Counts in [`Speeds::CLASSES`] classes that are equally probable at constant energy.
    #[serde(with = "corpuscle_core::array")]
    pub(super) classes: [u64; Self::CLASSES],
    /// Counts in bins of [`Speeds::WIDTH`] thermal speeds.
    #[serde(with = "corpuscle_core::array")]
    pub(super) bins: [u64; Self::BINS],
    /// Sum over snapshots of `sum m v_k^2 / (N kT)`.
    pub(super) shares: [f64; 3],
    pub(super) snapshots: u64,
}

impl Speeds {
    pub(super) const CLASSES: usize = 24;
    pub(super) const BINS: usize = 40;
    pub(super) const WIDTH: f64 = 0.11;

    const NONE: Self = Self { classes: [0; Self::CLASSES], bins: [0; Self::BINS], shares: [0.0; 3], snapshots: 0 };

    /// At the energy `E = D N kT / 2` the part `m v^2 / 2E` of one particle follows the beta distribution of `D/2` and
    /// `D (N - 1)/2`; for large `N` that is Maxwell's.
    fn see<const D: usize>(&mut self, particles: &Particles<D>, state: &State) {
        let (n, d) = (particles.len() as f64, D as f64);
        let energy = 2.0 * particles.kinetic_energy();
        for &v in &particles.velocity {
            let part = state.mass * v.norm_squared() / energy;
            let probability = incomplete_beta(part.min(1.0), 0.5 * d, 0.5 * d * (n - 1.0));
            self.classes[((probability * Self::CLASSES as f64) as usize).min(Self::CLASSES - 1)] += 1;
            let place = v.norm() / (state.thermal_speed() * Self::WIDTH);
            if let Some(bin) = self.bins.get_mut(place as usize) {
                *bin += 1;
            }
            for k in 0..D {
                self.shares[k] += state.mass * v[k] * v[k] / (n * state.temperature);
            }
        }
        self.snapshots += 1;
    }
}

/// How a system samples: numbers of samples before the measurement, and between snapshots of the speeds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pace {
    /// Interval between samples, on the laboratory's clock.
    pub(super) interval: f64,
    /// Rate of the system's own clock: a dense gas needs less time for as many collisions.
    pub(super) clock: f64,
    pub(super) warm_up: u64,
    pub(super) between_snapshots: u64,
}

/// One gas in its own box.
#[derive(Clone, Debug)]
pub(super) struct System<const D: usize> {
    pub(super) state: State,
    pub(super) engine: EventDriven<D>,
    pub(super) speeds: Speeds,
    pub(super) energy: Drift<1>,
    /// Readings at the samples of the measurement, all of them or the last only; the first is zero.
    pub(super) readings: Vec<Totals<D>>,
    /// `sum m v . (r - centre)` at the first and at the last reading.
    pub(super) action: [f64; 2],
    /// Number of samples measured.
    pub(super) samples: u64,
    pace: Pace,
    schedule: Schedule,
    meter: Totals<D>,
    keep: bool,
    snapshot: Particles<D>,
    /// Collisions of each particle, where this system is on show.
    pub(super) tally: Tally,
}

resume!(System<const D> {
    values: [engine, speeds, energy, readings, action, samples, schedule, meter],
    set_up: [state, pace, keep, snapshot, tally],
});

impl<const D: usize> System<D> {
    /// A gas in this state. With `keep`, all readings are kept.
    pub(super) fn new(state: State, pace: Pace, keep: bool, random: &mut Random) -> Result<Self, Invalid> {
        Ok(Self {
            state,
            engine: state.start(random)?,
            speeds: Speeds::NONE,
            energy: Drift::new(),
            readings: vec![],
            action: [0.0; 2],
            samples: 0,
            pace,
            schedule: Schedule::new(pace.interval),
            meter: Totals::ZERO,
            keep,
            snapshot: Particles::new(),
            tally: Tally::default(),
        })
    }

    /// Advances to the laboratory's time `to`, reading the manometers at every sampling time.
    pub(super) fn advance(&mut self, to: f64) -> Result<(), Failure> {
        loop {
            let number = self.schedule.count();
            let Some(time) = self.schedule.due(to) else { break };
            self.engine.advance(time * self.pace.clock, &mut (&mut self.meter, &mut self.tally))?;
            if number >= self.pace.warm_up {
                self.read(number - self.pace.warm_up);
            }
        }
        self.engine.advance(to * self.pace.clock, &mut (&mut self.meter, &mut self.tally))
    }

    fn read(&mut self, sample: u64) {
        self.engine.snapshot_into(&mut self.snapshot);
        let centre = Vector::splat(0.5 * self.state.side);
        let of_each = self.snapshot.position.iter().zip(&self.snapshot.velocity);
        let action = of_each.map(|(&r, &v)| self.state.mass * v.dot(r - centre)).sum();
        if sample == 0 {
            self.meter = Totals::ZERO;
            self.action[0] = action;
        } else if !self.keep && self.readings.len() > 1 {
            self.readings.pop();
        }
        self.action[1] = action;
        self.readings.push(self.meter);
        self.samples = sample;
        self.energy.see_energy(self.snapshot.kinetic_energy());
        if sample.is_multiple_of(self.pace.between_snapshots) {
            self.speeds.see(&self.snapshot, &self.state);
        }
    }

    /// Time measured, on the system's own clock.
    pub(super) fn duration(&self) -> f64 {
        self.samples as f64 * self.pace.interval * self.pace.clock
    }

    /// The last reading.
    pub(super) fn totals(&self) -> Totals<D> {
        self.readings.last().copied().unwrap_or(Totals::ZERO)
    }

    /// Mean pressure on the walls: total impulse over time and the area open to the centres, `2 D a^(D-1)`.
    pub(super) fn wall_pressure(&self, totals: &Totals<D>, duration: f64) -> f64 {
        let side = self.state.open_side();
        totals.impulse() / (duration * 2.0 * D as f64 * self.state.volume::<D>() / side)
    }

    /// Mean pressure from the virial theorem, `(N kT + sum J s / (D t)) / V_acc`.
    pub(super) fn virial_pressure(&self, totals: &Totals<D>, duration: f64) -> f64 {
        self.state.ideal_pressure::<D>() + totals.virial / (D as f64 * duration * self.state.volume::<D>())
    }

    /// How far the virial theorem fails for this very path, relative to the sum of all impulse times distance:
    /// `G(t) - G(0) = D N kT t + sum J s - (a/2) sum J_wall` with `G = sum m v . (r - centre)` holds exactly.
    pub(super) fn virial_residual(&self) -> f64 {
        let totals = self.totals();
        let kinetic = (D * self.state.count) as f64 * self.state.temperature * self.duration();
        let walls = 0.5 * self.state.open_side() * totals.impulse();
        (self.action[1] - self.action[0] - (kinetic + totals.virial - walls)).abs() / (kinetic + totals.virial + walls)
    }
}
