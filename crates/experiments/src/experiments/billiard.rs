//! A billiard with round scatterers: points that fly straight and are mirrored by fixed discs. Sinai's billiard, the Lorentz gas.
//!
//! Exact: the mean free path is `l = pi A / P`, with the free area `A` and the perimeter `P` of all discs (Santaló; Chernov 1997,
//! doi:10.1007/BF02508462), and impact parameters are uniform, so that `<b^2> = 1/3`. A front of rays that starts parallel has
//! the curvature `kappa`; in free flight over a distance `s` it spreads by `1 + kappa s` and flattens to
//! `kappa/(1 + kappa s)`, at a disc of radius `a` met under the angle `phi` it gains `2/(a cos phi)` (Sinai 1970,
//! doi:10.1070/RM1970v025n02ABEH003794). The mean logarithm of the spread per time is the Lyapunov exponent.
//!
//! For scattered discs and `n a^2 -> 0`, flights are independent and exponential, whence
//! `lambda = nu (ln(l/a) + 1 - C)` with the collision rate `nu = v/l` and Euler's constant `C` (van Beijeren and Dorfman 1995,
//! doi:10.1103/PhysRevLett.74.4412), and `D = 3 l v/8`. [`theory`] carries `lambda` one order further.

mod table;
mod theory;

use corpuscle_checkpoint::{Resume, resume};
use corpuscle_core::{Failure, Invalid, Vector};
use corpuscle_observe::chart::{Axis, Scale, Series, Style};
use corpuscle_observe::{Chart, Check, Curves, Estimate};
use corpuscle_scene::{Colour, Colouring, Scene, TrailPoint};

use crate::hand::{self, InHand};
use crate::replicas::{Replicas, energy_check, honesty};
use crate::tally::Tally;
use crate::{Action, Experiment, Frame, Honesty, Kind, Parameter, Settings, Simulation, Situation, drawing, ensemble, peek};
use table::{Layout, Table, Twins};

/// The registry's entry.
pub(crate) static EXPERIMENT: Experiment = Experiment {
    name: "billiard",
    title: "A billiard of Sinai's kind",
    summary: "A bundle of rays among round scatterers: it fans out exponentially. Its Lyapunov exponent by curvature, by twins \
              and by theory; the mean free path is exact geometry.",
    dimensions: &[2],
    engines: &["event-driven"],
    parameters: PARAMETERS,
    start,
};

const LAYOUTS: &[Situation] = &[
    Situation::new("random", &[]),
    Situation::new("square", &[&["scatterers"]]),
    Situation::new("triangular", &[&["scatterers"]]),
];

static PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "layout",
        unit: "",
        help: "Where the scatterers stand: anywhere (the Lorentz gas), on a square lattice (Sinai), on a triangular one.",
        kind: Kind::Situation { default: "random", options: LAYOUTS },
    },
    Parameter {
        name: "coverage",
        unit: "",
        help: "Part of the plane that the scatterers cover; their radius is 1. Theory is for a thin random layout.",
        kind: Kind::Real { default: 0.002, least: 1e-5, most: 0.85 },
    },
    Parameter {
        name: "scatterers",
        unit: "",
        help: "Number of scatterers of the random layout.",
        kind: Kind::Whole { default: 120, least: 8, most: 5000 },
    },
    Parameter {
        name: "particles",
        unit: "",
        help: "Number of points on each table; they do not meet each other.",
        kind: Kind::Whole { default: 40, least: 2, most: 10_000 },
    },
    Parameter {
        name: "duration",
        unit: "l/v",
        help: "How long is measured, in mean free times.",
        kind: Kind::Real { default: 40.0, least: 4.0, most: 1e6 },
    },
    Parameter {
        name: "replicas",
        unit: "",
        help: "Independent tables; their scatter gives the error bars. The first is on show.",
        kind: Kind::Whole { default: 24, least: 2, most: 10_000 },
    },
];

/// Samples a mean free time.
const RESOLUTION: f64 = 2.0;
/// Part of the run after which fronts have forgotten that they started flat.
const SETTLED: f64 = 0.25;
/// Coverage up to which theory for independent flights is held against the measurement.
const THIN: f64 = 0.005;
/// Points of each trail.
const TRAIL: usize = 2000;
/// Rays of the bundle that leave a trail.
const TRAILS: usize = 8;

fn start(settings: &Settings) -> Result<Box<dyn Simulation>, Invalid> {
    Ok(Box::new(Billiard::new(settings)?))
}

/// The running experiment.
struct Billiard {
    layout: Layout,
    duration: f64,
    tables: Replicas<Table>,
    twins: Twins,
    in_hand: Option<InHand<2>>,
}

resume!(Billiard { values: [], parts: [tables, twins], set_up: [layout, duration, in_hand] });

impl Billiard {
    fn new(settings: &Settings) -> Result<Self, Invalid> {
        let layout = Layout::new(settings)?;
        let streams: Vec<u64> = (0..settings.whole("replicas") as u64).collect();
        let members = ensemble::build(&streams, |&stream| Table::new(&layout, stream))?;
        let interval = layout.free_path() / RESOLUTION;
        let twins = Twins::new(&members[0], interval)?;
        let duration = settings.real("duration") * layout.free_path();
        Ok(Self { layout, duration, tables: Replicas::new(interval, members), twins, in_hand: None })
    }

    /// Sample from which on fronts are those of an old path.
    fn settled(&self) -> usize {
        (SETTLED * (self.tables.times.len() - 1) as f64).ceil() as usize
    }

    fn exponent(&self) -> Estimate {
        let (from, to) = (self.settled(), self.tables.times.len() - 1);
        let time = self.tables.times[to] - self.tables.times[from];
        self.tables.mean(|table| (table.stretch[to] - table.stretch[from]) / time)
    }

    fn diffusion(&self) -> Estimate {
        let last = self.tables.times.len() - 1;
        let time = self.tables.times[last] - self.tables.times[last / 2];
        self.tables.mean(|table| (table.displacement[last] - table.displacement[last / 2]) / (4.0 * time))
    }

    fn is_thin(&self) -> bool {
        self.layout.is_random() && self.layout.coverage <= THIN
    }

    fn curve(&self, series: impl Fn(&Table) -> &[f64]) -> Curves {
        Curves { x: self.tables.times.clone(), y: self.tables.members.iter().map(|table| series(table).to_vec()).collect() }
    }

    fn stretch_chart(&self) -> Chart {
        let points = self.curve(|table| &table.stretch).points();
        let end = self.tables.sampled();
        let measured = points.iter().map(|(t, stretch)| (*t, stretch.mean, stretch.standard_error));
        let mut chart = Chart::new(
            "stretch",
            "How a front of rays spreads",
            Axis::linear("time t", ""),
            Axis::linear("mean of ln(separation / separation at the start)", ""),
        );
        if self.is_thin() {
            let exponent = self.layout.exponent();
            chart = chart.with(Series::theory("λ t, Lorentz gas", 0.0, end, 2, Scale::Linear, |t| exponent * t));
        }
        let twins = self.twins.separations.iter().map(|&(t, separation, _)| (t, separation));
        chart
            .with(Series::with_errors("curvature of the front, all tables", Style::Line, measured))
            .with(Series::new("two paths side by side, this table", Style::Points, twins))
            .noting("A straight line: separations grow as exp(λt), until they are as large as the table.")
    }

    fn flight_chart(&self) -> Chart {
        let bins = self.tables.members[0].flights.counts().len();
        let free_path = self.layout.free_path();
        let width = table::LONGEST / bins as f64;
        let densities = (0..bins).filter_map(|bin| {
            let density =
                self.tables.mean(|table| table.flights.counts()[bin] as f64 / (table.flights.total().max(1) as f64 * width));
            (density.mean > 0.0).then_some((width * (bin as f64 + 0.5), density.mean, density.standard_error))
        });
        let mut chart = Chart::new(
            "flights",
            "Lengths of free flights",
            Axis::linear("length over the mean free path", ""),
            Axis::logarithmic("probability density", ""),
        );
        if self.layout.is_random() {
            chart = chart.with(Series::theory("exp(−s/l), independent flights", 0.0, table::LONGEST, 80, Scale::Linear, |s| {
                libm::exp(-s)
            }));
        }
        chart
            .with(Series::with_errors("measured", Style::Points, densities))
            .noting(format!("The mean, {free_path:.4}, is geometry, π A/P, for any layout; the distribution is not."))
    }

    fn displacement_chart(&self) -> Chart {
        let points = self.curve(|table| &table.displacement).points();
        let measured = points.iter().skip(1).map(|(t, square)| (*t, square.mean, square.standard_error));
        let (free, end) = (self.layout.free_path(), self.tables.sampled());
        let mut chart = Chart::new(
            "displacement",
            "Mean squared displacement",
            Axis::logarithmic("time t", ""),
            Axis::logarithmic("⟨|Δr|²⟩", ""),
        )
        .with(Series::theory("ballistic, v² t²", 0.3 * free, 2.0 * free, 2, Scale::Logarithmic, |t| t * t));
        if self.layout.is_random() {
            let rate = 4.0 / (3.0 * free);
            // Velocities forget as exp(-rate t): rate = nu <1 - cos(angle)> = 4 nu/3 for discs.
            let law = |t: f64| 2.0 / (rate * rate) * (rate * t + libm::expm1(-rate * t));
            chart = chart.with(Series::theory("Boltzmann, D = 3 l v/8", 0.3 * free, end, 80, Scale::Logarithmic, law));
        }
        chart
            .with(Series::with_errors("measured", Style::Points, measured))
            .noting("Fixed discs and one moving point make a random walk: chaos does what chance would.")
    }
}

impl Simulation for Billiard {
    fn state(&self) -> Option<&dyn Resume> {
        Some(self)
    }

    fn state_mut(&mut self) -> Option<&mut dyn Resume> {
        Some(self)
    }

    fn time(&self) -> f64 {
        self.tables.time()
    }

    fn end(&self) -> f64 {
        self.duration
    }

    fn advance(&mut self, to: f64) -> Result<(), Failure> {
        self.tables.advance(to)?;
        self.twins.advance(to)?;
        InHand::advance_any(&mut self.in_hand, to)
    }

    fn draw(&self, scene: &mut Scene) {
        scene.clear();
        let bundle = self.twins.bundle();
        let engine = InHand::on_show(self.in_hand.as_ref(), bundle);
        drawing::add_event_driven(scene, engine, &Tally::default(), 0.0, |i| i as f64);
        scene.colouring = Colouring::Uniform(Colour::Accent(1));
        let boundary = bundle.boundary();
        // The trails are those of rays that no hand has turned.
        for ray in 0..TRAILS.min(bundle.particle_count()) {
            let trail = scene.trail(ray as u32, TRAIL, Colour::Accent((ray % 7) as u8));
            let drawn = trail.points().back().map_or(-1.0, |point| point.time);
            let mut before: Option<Vector<2>> = None;
            for &(time, path) in &self.twins.paths[ray] {
                if time > drawn {
                    let point = TrailPoint { position: boundary.wrap(path).to_three(), time };
                    let crossing = before.is_some_and(|last| {
                        (boundary.wrap(path) - boundary.wrap(last) - (path - last)).norm() > 1e-6 * boundary.extent().norm()
                    });
                    if crossing { trail.jump(point) } else { trail.push(point) }
                }
                before = Some(path);
            }
        }
        scene.title = EXPERIMENT.title.into();
        scene.caption = match self.tables.times.len() {
            0..=4 => "a narrow bundle of rays".into(),
            _ => format!(
                "λ = {:.4} v/l   the bundle doubles its width every {:.2} flights",
                self.exponent().mean * self.layout.free_path(),
                std::f64::consts::LN_2 / (self.exponent().mean * self.layout.free_path())
            ),
        };
    }

    fn frame(&self) -> Option<Frame> {
        Some(Frame::of_hard(self.twins.bundle(), 0.0, &["rays"]))
    }

    fn charts(&self) -> Vec<Chart> {
        if self.tables.times.len() < 3 {
            return vec![];
        }
        vec![self.stretch_chart(), self.flight_chart(), self.displacement_chart()]
    }

    fn checks(&self) -> Vec<Check> {
        let mut checks = vec![];
        let time = self.tables.sampled();
        if self.tables.times.len() > 4 {
            let rate = self.tables.mean(|table| table.rays.hits() as f64 / (table.rays.len() as f64 * time));
            checks.push(rate.check(
                "collision rate v/l",
                1.0 / self.layout.free_path(),
                "l = pi A/P, exact: Santaló; Chernov 1997",
            ));
            let squares: Vec<[f64; 2]> =
                self.tables.members.iter().map(|table| [table.rays.squares(), table.rays.hits() as f64]).collect();
            let impact = Estimate::jackknife(&squares, |[squares, hits]| squares / hits);
            checks.push(impact.check("mean square of the impact parameter", 1.0 / 3.0, "uniform from -1 to 1, exact"));
            if self.is_thin() {
                let reference = "Lorentz gas: van Beijeren and Dorfman 1995, doi:10.1103/PhysRevLett.74.4412, with the next order";
                checks.push(self.exponent().check("Lyapunov exponent λ", self.layout.exponent(), reference));
                let expected = 0.375 * self.layout.free_path();
                checks.push(self.diffusion().check("diffusion coefficient D", expected, "3 l v/8, Boltzmann's equation"));
            }
        }
        if let Some(difference) = self.twins.disagreement() {
            let reference = "rays 1e-9 apart against the curvature of the front, while no two are 1e-6 apart: rounding 1e-4, grazing contacts more";
            checks.push(Check::at_most("ln(separation) of twins less that of the front", difference, 1e-2, reference));
        }
        checks.extend(energy_check(&self.honesty()));
        checks
    }

    fn honesty(&self) -> Honesty {
        let tables = self.tables.members.iter().map(|table| (&table.engine, Some(0.5 * table.rays.len() as f64)));
        Honesty {
            // Sixteen digits, spent at the rate lambda.
            precision_horizon: (self.tables.times.len() > 4)
                .then(|| libm::log(1.0 / (f64::EPSILON * self.layout.free_path())) / self.exponent().mean)
                .filter(|horizon| horizon.is_finite() && *horizon > 0.0),
            ..honesty(tables)
        }
    }

    fn moments(&self) -> Vec<f64> {
        let free = self.layout.free_path();
        vec![0.5 * free, 2.0 * free, 5.0 * free]
    }

    fn next_event(&self) -> Option<f64> {
        peek::next_contact(InHand::on_show(self.in_hand.as_ref(), self.twins.bundle()), 1.5 * self.duration)
    }

    fn refusal(&self, action: Action) -> Option<&'static str> {
        hand::wanting_of_number(self.twins.bundle(), action)
    }

    fn act(&mut self, action: Action) -> Result<(), Invalid> {
        InHand::act(&mut self.in_hand, self.twins.bundle(), &Tally::default(), action)
    }
}
