//! The ideal gas law, measured: hard particles between walls, one sweep each for Boyle, Charles and Avogadro.
//!
//! Every state point is run in several replicas, all of them independent; one more set of dense gases shows how the law fails.
//! Standard errors come from the replicas: the pressure of an isolated gas has a memory (see the chart `averaging`), so that
//! counting its hits would not give them.

use corpuscle_checkpoint::{Resume, resume};
use corpuscle_core::{Axis, Engine, Failure, Invalid, Random};
use corpuscle_event::EventDriven;
use corpuscle_observe::{Chart, Check, Estimate};
use corpuscle_scene::{Colouring, Scene};

use super::system::{Pace, State, System};
use super::{charts, checks, theory};
use crate::drawing::add_event_driven;
use crate::hand::{self, InHand};
use crate::horizon::precision_horizon;
use crate::probe::{self, Region};
use crate::simulation::{Honesty, Simulation, Table};
use crate::tally::Tally;
use crate::{Action, Frame, Probed, Settings, ensemble, gas, peek};

/// Samples a crossing of the box, `a / sqrt(kT/m)`.
const SAMPLES_PER_CROSSING: f64 = 20.0;
/// Crossings of the slowest gas before the measurement: the lattice of the start is forgotten.
const WARM_UP: f64 = 4.0;
/// Collisions of a particle between two snapshots of the speeds: they are independent then.
const COLLISIONS_BETWEEN_SNAPSHOTS: f64 = 10.0;

/// One of the three laws, each a sweep from the base state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Law {
    /// `P` against `1/V_acc`.
    Boyle,
    /// `P` against `T`; Gay-Lussac and Amontons at constant volume.
    Charles,
    /// `P` against `N`.
    Avogadro,
}

impl Law {
    pub(super) const ALL: [Self; 3] = [Self::Boyle, Self::Charles, Self::Avogadro];

    /// The state with this part of the base pressure.
    fn state<const D: usize>(self, base: State, part: f64) -> State {
        match self {
            Self::Boyle => {
                let packing = part * gas::packing::<D>(base.count, base.radius, base.side);
                State { side: gas::side::<D>(base.count, base.radius, packing), ..base }
            }
            Self::Charles => State { temperature: part * base.temperature, ..base },
            Self::Avogadro => State { count: (part * base.count as f64).round() as usize, ..base },
        }
    }

    /// What the law is about.
    pub(super) fn abscissa<const D: usize>(self, state: &State) -> f64 {
        match self {
            Self::Boyle => 1.0 / state.volume::<D>(),
            Self::Charles => state.temperature,
            Self::Avogadro => state.count as f64,
        }
    }
}

/// A state point with its replicas.
pub(super) struct Point<const D: usize> {
    pub(super) state: State,
    /// Compressibility factor that theory expects of this very box.
    pub(super) expected: f64,
    pub(super) replicas: Vec<System<D>>,
}

impl<const D: usize> Point<D> {
    /// Mean over the replicas.
    pub(super) fn estimate(&self, measure: impl Fn(&System<D>) -> f64) -> Estimate {
        Estimate::from_replicas(&self.replicas.iter().map(measure).collect::<Vec<_>>())
    }

    pub(super) fn wall_pressure(&self) -> Estimate {
        self.estimate(|system| system.wall_pressure(&system.totals(), system.duration()))
    }

    pub(super) fn virial_pressure(&self) -> Estimate {
        self.estimate(|system| system.virial_pressure(&system.totals(), system.duration()))
    }

    /// Pressure that theory expects.
    pub(super) fn expected_pressure(&self) -> f64 {
        self.expected * self.state.ideal_pressure::<D>()
    }
}

/// All state points.
pub(super) struct Laboratory<const D: usize> {
    /// The base state, in the window.
    pub(super) base: Point<D>,
    /// The sweeps without the base state, which belongs to all of them.
    pub(super) sweeps: Vec<(Law, Point<D>)>,
    /// Dense gases in periodic boxes, each with its packing fraction.
    pub(super) dense: Vec<(f64, Point<D>)>,
    pub(super) pace: Pace,
    /// Samples of a full measurement.
    samples: u64,
    time: f64,
    /// A copy of the system in the window, once a hand has touched it.
    in_hand: Option<InHand<D>>,
}

impl<const D: usize> Laboratory<D> {
    pub(super) fn new(settings: &Settings) -> Result<Self, Invalid> {
        let base = State::base::<D>(settings);
        let (count, radius) = (base.count, base.radius);

        let points = settings.whole("points");
        let least = 1.0 / settings.real("span");
        let parts = (0..points - 1).map(|k| least + (1.0 - least) * k as f64 / (points - 1) as f64);
        let sweeps: Vec<(Law, State)> =
            Law::ALL.iter().flat_map(|&law| parts.clone().map(move |part| (law, law.state::<D>(base, part)))).collect();

        let crossing = |state: &State| state.open_side() / state.thermal_speed();
        let slowest = sweeps.iter().map(|(_, state)| crossing(state)).fold(crossing(&base), f64::max);
        let interval = crossing(&base) / SAMPLES_PER_CROSSING;
        let pace = Pace {
            interval,
            clock: 1.0,
            warm_up: (WARM_UP * slowest / interval).ceil() as u64,
            between_snapshots: (COLLISIONS_BETWEEN_SNAPSHOTS / (base.collision_rate::<D>() * interval)).ceil() as u64,
        };
        let samples = (settings.real("duration") * SAMPLES_PER_CROSSING).round() as u64;

        let mut stream = 0;
        let mut point = |state: State, expected: f64, pace: Pace, keep: bool| -> Result<Point<D>, Invalid> {
            stream += 1;
            let replica = |r: u64| System::new(state, pace, keep, &mut Random::new(settings.seed, stream << 16 | r));
            let replicas = (0..settings.whole("replicas") as u64).map(replica).collect::<Result<_, _>>()?;
            Ok(Point { state, expected, replicas })
        };
        let walls = |state: &State| theory::between_walls::<D>(state.count, state.open_side(), 2.0 * state.radius);
        let mut base_point = point(base, walls(&base), pace, true)?;
        base_point.replicas[0].tally = Tally::of(count);
        Ok(Self {
            base: base_point,
            sweeps: sweeps
                .into_iter()
                .map(|(law, state)| Ok((law, point(state, walls(&state), pace, false)?)))
                .collect::<Result<_, Invalid>>()?,
            dense: settings
                .list("dense_packings")
                .iter()
                .map(|&packing| {
                    let state = State { side: gas::side::<D>(count, radius, packing), axis: Axis::Periodic, ..base };
                    let pace = Pace { clock: base.collision_rate::<D>() / state.collision_rate::<D>(), ..pace };
                    Ok((packing, point(state, theory::periodic::<D>(count, packing), pace, false)?))
                })
                .collect::<Result<_, Invalid>>()?,
            pace,
            samples,
            time: 0.0,
            in_hand: None,
        })
    }

    pub(super) fn points(&self) -> impl Iterator<Item = &Point<D>> {
        std::iter::once(&self.base)
            .chain(self.sweeps.iter().map(|(_, point)| point))
            .chain(self.dense.iter().map(|(_, point)| point))
    }

    /// The system in the window.
    fn on_show(&self) -> (&EventDriven<D>, &Tally) {
        let measured = &self.base.replicas[0];
        self.in_hand.as_ref().map_or((&measured.engine, &measured.tally), |copy| (&copy.engine, &copy.tally))
    }

    /// The points of a law, the base state last.
    pub(super) fn sweep(&self, law: Law) -> impl Iterator<Item = &Point<D>> {
        self.sweeps.iter().filter(move |(of, _)| *of == law).map(|(_, point)| point).chain(std::iter::once(&self.base))
    }

    /// Samples measured so far by every system.
    pub(super) fn measured(&self) -> u64 {
        self.points().flat_map(|point| &point.replicas).map(|system| system.samples).min().unwrap_or(0)
    }

    /// Whether enough has been measured to say something: a tenth of the whole.
    pub(super) fn is_telling(&self) -> bool {
        self.measured() > 0 && 10 * self.measured() >= self.samples
    }
}

resume!(Point<const D> { values: [], parts: [replicas], set_up: [state, expected] });
resume!(Laboratory<const D> { values: [time], parts: [base, sweeps, dense], set_up: [pace, samples, in_hand] });

impl<const D: usize> Simulation for Laboratory<D> {
    fn state(&self) -> Option<&dyn Resume> {
        Some(self)
    }

    fn state_mut(&mut self) -> Option<&mut dyn Resume> {
        Some(self)
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn end(&self) -> f64 {
        (self.pace.warm_up + self.samples) as f64 * self.pace.interval
    }

    fn advance(&mut self, to: f64) -> Result<(), Failure> {
        let sweeps = self.sweeps.iter_mut().map(|(_, point)| point);
        let all = std::iter::once(&mut self.base).chain(sweeps).chain(self.dense.iter_mut().map(|(_, point)| point));
        let mut systems: Vec<&mut System<D>> = all.flat_map(|point| &mut point.replicas).collect();
        ensemble::for_each(&mut systems, |system| system.advance(to))?;
        self.time = self.time.max(to);
        self.in_hand.as_mut().map_or(Ok(()), |copy| copy.advance(to))
    }

    fn draw(&self, scene: &mut Scene) {
        scene.clear();
        scene.title = super::EXPERIMENT.title.into();
        let state = self.base.state;
        let reading = if self.is_telling() {
            let z = self.base.wall_pressure() / state.ideal_pressure::<D>();
            let (mean, error, expected) = (z.mean, z.standard_error, self.base.expected);
            format!("P V_acc/(N kT) = {mean:.4} ± {error:.4} from the walls, {expected:.4} expected")
        } else {
            "warming up".into()
        };
        let (count, temperature, volume) = (state.count, state.temperature, state.volume::<D>());
        scene.caption = format!("N = {count}, kT = {temperature}, V_acc = {volume:.0}: {reading}");
        scene.colouring = Colouring::Speed { most: 3.0 * state.thermal_speed(), unit: String::new() };
        let (engine, tally) = self.on_show();
        add_event_driven(scene, engine, tally, 0.0, |_| 0.0);
    }

    fn frame(&self) -> Option<Frame> {
        Some(Frame::of_hard(&self.base.replicas[0].engine, 0.0, &["particles"]))
    }

    fn charts(&self) -> Vec<Chart> {
        charts::all(self)
    }

    fn checks(&self) -> Vec<Check> {
        checks::all(self)
    }

    fn tables(&self) -> Vec<Table> {
        vec![charts::table(self)]
    }

    fn honesty(&self) -> Honesty {
        let systems = || self.points().flat_map(|point| &point.replicas);
        let overlap = |system: &System<D>| {
            let depth = system.engine.boundary().largest_overlap(&system.engine.snapshot());
            depth / (2.0 * system.state.radius)
        };
        Honesty {
            engine: "event-driven".into(),
            work: systems().map(|system| system.engine.counts()).map(|counts| counts.collisions + counts.wall_collisions).sum(),
            work_unit: "collisions",
            energy_drift: systems().filter_map(|system| system.energy.largest()).reduce(f64::max),
            largest_overlap: self.base.replicas.iter().map(overlap).reduce(f64::max),
            rejected_events: Some(systems().map(|system| system.engine.counts().stale).sum()),
            precision_horizon: precision_horizon(&self.base.replicas[0].engine),
            ..Honesty::default()
        }
    }

    fn next_event(&self) -> Option<f64> {
        peek::next_contact(self.on_show().0, 1.5 * self.end())
    }

    fn moments(&self) -> Vec<f64> {
        vec![0.0, self.pace.warm_up as f64 * self.pace.interval]
    }
    fn probe(&mut self, corners: Option<[[f64; 2]; 2]>) {
        let measured = &mut self.base.replicas[0];
        let (engine, tally) =
            self.in_hand.as_mut().map_or((&measured.engine, &mut measured.tally), |copy| (&copy.engine, &mut copy.tally));
        tally.lay(corners.and_then(|corners| Region::lay(engine, corners)));
    }

    fn probed(&self) -> Option<Probed> {
        let measured = &self.base.replicas[0];
        let (engine, tally) = self.in_hand.as_ref().map_or((&measured.engine, &measured.tally), |copy| (&copy.engine, &copy.tally));
        probe::read(engine, tally)
    }

    fn refusal(&self, action: Action) -> Option<&'static str> {
        hand::wanting_of_number(&self.base.replicas[0].engine, action)
    }

    fn act(&mut self, action: Action) -> Result<(), Invalid> {
        let measured = &self.base.replicas[0];
        InHand::act(&mut self.in_hand, &measured.engine, &measured.tally, action)
    }
}
