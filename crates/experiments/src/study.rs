//! A process of a hard-particle gas that is watched in replicas: what all such have in common, so that each says only what it
//! measures and what theory says of that.

use std::ops::ControlFlow;

use corpuscle_checkpoint::{Fault, Reader, Resume, Writer, resume};
use corpuscle_core::{Boundary, Contact, Engine, Failure, Invalid, Observer, Particles, Random, Vector};
use corpuscle_event::{EventDriven, Rules};
use corpuscle_observe::{Chart, Check};
use corpuscle_scene::Scene;

use crate::hand::{self, InHand};
use crate::horizon::precision_horizon;
use crate::probe::{self, Region};
use crate::replicas::{Member, Replicas, energy_check, honesty};
use crate::tally::Tally;
use crate::{Action, Frame, Honesty, Probed, Simulation, drawing, peek};

/// A gas in a box, its measurement begun at some time on the engine's clock.
pub(crate) struct Vessel<const D: usize> {
    pub(crate) engine: EventDriven<D>,
    /// Collisions of each particle, where this gas is on show.
    pub(crate) tally: Tally,
    started: f64,
    /// Energy at the start.
    energy: f64,
}

resume!(Vessel<const D> { values: [engine], set_up: [tally, started, energy] });

impl<const D: usize> Vessel<D> {
    /// A gas that has come to equilibrium for so long, its measurement begun.
    ///
    /// # Errors
    /// [`Invalid`] when the particles do not fit.
    pub(crate) fn new(boundary: Boundary<D>, particles: Particles<D>, wait: f64, random: &mut Random) -> Result<Self, Invalid> {
        let count = particles.len();
        // Each vessel has thermal walls of its own.
        let rules = Rules { seed: random.bits(), ..Rules::default() };
        let mut engine = EventDriven::new(boundary, particles, rules)?;
        engine.advance(wait, &mut ()).map_err(|failure| Invalid::new("particles", count, failure.to_string()))?;
        let energy = engine.kinetic_energy();
        Ok(Self { engine, tally: Tally::default(), started: wait, energy })
    }

    /// Time since the start of the measurement.
    pub(crate) fn time(&self) -> f64 {
        self.engine.time() - self.started
    }

    /// Time on the engine's clock at which the measurement started.
    pub(crate) fn started(&self) -> f64 {
        self.started
    }

    /// Energy at the start.
    pub(crate) fn energy(&self) -> f64 {
        self.energy
    }

    /// Changes velocities as the measurement starts, and with them the energy that is kept from here on.
    pub(crate) fn set_velocities(&mut self, change: impl FnMut(usize, &mut Vector<D>)) {
        self.engine.set_velocities(change);
        self.energy = self.engine.kinetic_energy();
    }

    /// Advances to `time` after the start of the measurement; `watch` sees every contact, and may stop there.
    ///
    /// # Errors
    /// [`Failure`] of the engine.
    pub(crate) fn advance(&mut self, time: f64, watch: &mut dyn FnMut(&Contact<D>) -> ControlFlow<()>) -> Result<(), Failure> {
        self.advance_to(self.started + time, watch)
    }

    /// The same to a time on the engine's clock.
    ///
    /// # Errors
    /// [`Failure`] of the engine.
    pub(crate) fn advance_to(&mut self, to: f64, watch: &mut dyn FnMut(&Contact<D>) -> ControlFlow<()>) -> Result<(), Failure> {
        self.engine.advance(to, &mut Seen { watch, tally: &mut self.tally })
    }
}

/// Who looks at the contacts of a vessel. One type for all: the engine's loop is compiled anew for every observer it meets.
struct Seen<'a, const D: usize> {
    watch: &'a mut dyn FnMut(&Contact<D>) -> ControlFlow<()>,
    tally: &'a mut Tally,
}

impl<const D: usize> Observer<D> for Seen<'_, D> {
    fn contact(&mut self, contact: &Contact<D>) -> ControlFlow<()> {
        let _: ControlFlow<()> = self.tally.contact(contact);
        (self.watch)(contact)
    }
}

/// A replica of a study.
pub(crate) trait Specimen<const D: usize>: Member {
    /// The gas.
    fn vessel(&self) -> &Vessel<D>;

    /// The same, to be put on show.
    fn vessel_mut(&mut self) -> &mut Vessel<D>;

    /// Whether nothing but elastic contacts changes the energy.
    fn conserves_energy(&self) -> bool {
        true
    }
}

/// What is asked of a gas: what to show, what to measure, what theory says. The first specimen is on show.
pub(crate) trait Study<const D: usize>: Send {
    /// Its replicas.
    type Specimen: Specimen<D>;

    /// Says what there is to see, in a scene that has the particles already.
    fn draw(&self, specimens: &Replicas<Self::Specimen>, scene: &mut Scene);

    /// What the study's own colouring reads of a particle of the specimen on show.
    fn shade(&self, _: &Self::Specimen, _: usize) -> f64 {
        0.0
    }

    /// Charts of what has been measured so far.
    fn charts(&self, specimens: &Replicas<Self::Specimen>) -> Vec<Chart>;

    /// Checks of what has been measured so far.
    fn checks(&self, specimens: &Replicas<Self::Specimen>) -> Vec<Check>;

    /// Times worth a picture.
    fn moments(&self, end: f64) -> Vec<f64> {
        vec![0.0, 0.1 * end]
    }
}

/// A study under way.
pub(crate) struct Running<const D: usize, S: Study<D>> {
    study: S,
    duration: f64,
    specimens: Replicas<S::Specimen>,
    /// A copy of the specimen on show, once a hand has touched it.
    in_hand: Option<InHand<D>>,
}

impl<const D: usize, S: Study<D>> Running<D, S> {
    /// Specimens that are sampled `samples` times in the duration. The end lies a hair behind the last sample, which rounding does
    /// not put off then.
    pub(crate) fn new(study: S, duration: f64, samples: usize, mut specimens: Vec<S::Specimen>) -> Self {
        if let Some(first) = specimens.first_mut() {
            let vessel = first.vessel_mut();
            vessel.tally = Tally::of(vessel.engine.particle_count());
        }
        let specimens = Replicas::new(duration / samples as f64, specimens);
        Self { study, duration: duration * (1.0 + 8.0 * f64::EPSILON), specimens, in_hand: None }
    }

    fn on_show(&self) -> &Vessel<D> {
        self.specimens.members[0].vessel()
    }
}

impl<const D: usize, S: Study<D>> Resume for Running<D, S> {
    fn save(&self, out: &mut Writer) -> Result<(), Fault> {
        self.specimens.save(out)
    }

    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), Fault> {
        self.specimens.load(from)
    }
}

impl<const D: usize, S: Study<D>> Simulation for Running<D, S> {
    fn state(&self) -> Option<&dyn Resume> {
        Some(self)
    }

    fn state_mut(&mut self) -> Option<&mut dyn Resume> {
        Some(self)
    }

    fn time(&self) -> f64 {
        self.specimens.time()
    }

    fn end(&self) -> f64 {
        self.duration
    }

    fn advance(&mut self, to: f64) -> Result<(), Failure> {
        self.specimens.advance(to)?;
        let started = self.on_show().started;
        self.in_hand.as_mut().map_or(Ok(()), |copy| copy.advance(started + to))
    }

    fn draw(&self, scene: &mut Scene) {
        scene.clear();
        let (first, vessel) = (&self.specimens.members[0], self.on_show());
        let (engine, tally) = self.in_hand.as_ref().map_or((&vessel.engine, &vessel.tally), |copy| (&copy.engine, &copy.tally));
        drawing::add_event_driven(scene, engine, tally, vessel.started, |i| self.study.shade(first, i));
        self.study.draw(&self.specimens, scene);
    }

    fn frame(&self) -> Option<Frame> {
        let vessel = self.on_show();
        Some(Frame::of_hard(&vessel.engine, vessel.started, &["particles"]))
    }

    fn charts(&self) -> Vec<Chart> {
        self.study.charts(&self.specimens)
    }

    fn checks(&self) -> Vec<Check> {
        let mut checks = self.study.checks(&self.specimens);
        checks.extend(energy_check(&self.honesty()));
        checks
    }

    fn honesty(&self) -> Honesty {
        let of_each = self.specimens.members.iter().map(|specimen| {
            let vessel = specimen.vessel();
            (&vessel.engine, specimen.conserves_energy().then_some(vessel.energy))
        });
        Honesty { precision_horizon: precision_horizon(&self.on_show().engine), ..honesty(of_each) }
    }

    fn moments(&self) -> Vec<f64> {
        self.study.moments(self.duration)
    }

    fn next_event(&self) -> Option<f64> {
        let vessel = self.on_show();
        let engine = self.in_hand.as_ref().map_or(&vessel.engine, |copy| &copy.engine);
        peek::next_contact(engine, 1.5 * self.duration).map(|time| time - vessel.started)
    }

    fn probe(&mut self, corners: Option<[[f64; 2]; 2]>) {
        let vessel = self.specimens.members[0].vessel_mut();
        let (engine, tally) =
            self.in_hand.as_mut().map_or((&vessel.engine, &mut vessel.tally), |copy| (&copy.engine, &mut copy.tally));
        tally.lay(corners.and_then(|corners| Region::lay(engine, corners)));
    }

    fn probed(&self) -> Option<Probed> {
        let vessel = self.on_show();
        let (engine, tally) = self.in_hand.as_ref().map_or((&vessel.engine, &vessel.tally), |copy| (&copy.engine, &copy.tally));
        probe::read(engine, tally)
    }

    fn refusal(&self, action: Action) -> Option<&'static str> {
        hand::wanting_of_number(&self.on_show().engine, action)
    }

    fn act(&mut self, action: Action) -> Result<(), Invalid> {
        let vessel = self.specimens.members[0].vessel();
        InHand::act(&mut self.in_hand, &vessel.engine, &vessel.tally, action)
    }
}
