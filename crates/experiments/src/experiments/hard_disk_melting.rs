//! The melting of hard discs: no attraction, no energy but that of motion, and yet there is a crystal.
//!
//! The order of a disc's six nearest neighbours is `psi_6 = (1/6) sum exp(6 i theta)`, its mean over the sheet near 1 in a crystal and of
//! order `1/sqrt(N)` in a liquid. Between the two discs have a third phase, the hexatic, which knows directions but no places: liquid
//! and hexatic stand side by side from 0.700 to 0.716 at the pressure `P s^2/kT = 9.185`, and near 0.720 the hexatic becomes a
//! crystal (Bernard and Krauth 2011, doi:10.1103/PhysRevLett.107.155704; Engel et al. 2013, doi:10.1103/PhysRevE.87.042134). They used a
//! million discs, whose equilibrium takes weeks. Some hundred show a smeared transition, and a loop of the pressure that is the price
//! of an interface (Mayer and Wood 1965, doi:10.1063/1.1695931).
//!
//! So each packing fraction is begun twice, as a crystal and without order: where both agree, the sheet may be in equilibrium;
//! where they do not, it is not. The pressure is held against virial coefficients only where equilibrium takes no time: far below the
//! transition. The free volume's, of the crystal, is drawn: measured values lie 0.03 in `Z` below it, which is what its rounded
//! constant leaves open.

mod sheet;
mod theory;

use corpuscle_checkpoint::{Resume, resume};
use corpuscle_core::{Failure, Invalid};
use corpuscle_observe::chart::{Axis, Scale, Series, Style};
use corpuscle_observe::{Chart, Check, Estimate};
use corpuscle_scene::{Colouring, Scene};

use crate::replicas::{Replicas, energy_check, honesty};
use crate::tally::Tally;
use crate::{Experiment, Honesty, Kind, Parameter, Settings, Simulation, Table, drawing, ensemble, peek};
use sheet::{DENSEST_GROWN, Job, PERIOD, Sheet, Start};

/// The registry's entry.
pub(crate) static EXPERIMENT: Experiment = Experiment {
    name: "hard-disk-melting",
    title: "Hard discs melt",
    summary: "Discs that only push order themselves when they are dense: the pressure and the order of directions through the \
              transition, begun as crystals and without order, beside published values.",
    dimensions: &[2],
    engines: &["event-driven"],
    parameters: PARAMETERS,
    start,
};

static PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "packing_fraction",
        unit: "",
        help: "Area of the discs on show over that of their sheet.",
        kind: Kind::Real { default: 0.71, least: 0.3, most: 0.85 },
    },
    Parameter {
        name: "begin",
        unit: "",
        help: "How the sheet on show begins: as a crystal, or without order.",
        kind: Kind::Choice { default: "crystal", options: &["crystal", "disorder"] },
    },
    Parameter {
        name: "side",
        unit: "",
        help: "Discs along a row and number of rows of the sheet on show, even.",
        kind: Kind::Whole { default: 40, least: 8, most: 300 },
    },
    Parameter {
        name: "small_side",
        unit: "",
        help: "The same of the sheets that are measured, even.",
        kind: Kind::Whole { default: 16, least: 8, most: 100 },
    },
    Parameter {
        name: "packings",
        unit: "",
        help: "Packing fractions at which the pressure is measured.",
        kind: Kind::List {
            default: &[0.56, 0.6, 0.66, 0.69, 0.7, 0.71, 0.72, 0.74, 0.77, 0.8],
            least: 0.3,
            most: 0.85,
            longest: 40,
        },
    },
    Parameter {
        name: "settling",
        unit: "",
        help: "How long sheets run before they are measured, in s sqrt(m/kT), in which a disc collides about twenty times.",
        kind: Kind::Real { default: 10.0, least: 0.0, most: 1e6 },
    },
    Parameter {
        name: "duration",
        unit: "",
        help: "How long is measured, in s sqrt(m/kT).",
        kind: Kind::Real { default: 24.0, least: 4.0, most: 1e6 },
    },
    Parameter {
        name: "replicas",
        unit: "",
        help: "Independent sheets of each kind; their scatter gives the error bars.",
        kind: Kind::Whole { default: 4, least: 2, most: 1000 },
    },
];

/// Stream of random numbers of the sheet on show.
const SHOWN: u64 = 1 << 33;

fn start(settings: &Settings) -> Result<Box<dyn Simulation>, Invalid> {
    Ok(Box::new(Melting::new(settings)?))
}

/// The running experiment.
struct Melting {
    packings: Vec<f64>,
    count: usize,
    duration: f64,
    shown: Replicas<Sheet>,
    sheets: Replicas<Sheet>,
}

resume!(Melting { values: [], parts: [shown, sheets], set_up: [packings, count, duration] });

impl Melting {
    fn new(settings: &Settings) -> Result<Self, Invalid> {
        for key in ["side", "small_side"] {
            if settings.whole(key) % 2 == 1 {
                return Err(settings.invalid(key, "an even number: rows of a triangular lattice come in pairs"));
            }
        }
        let (packing, crystal) = (settings.real("packing_fraction"), settings.word("begin") == "crystal");
        if !crystal && packing > DENSEST_GROWN {
            return Err(settings.invalid("packing_fraction", format!("at most {DENSEST_GROWN} without order: denser discs jam")));
        }
        let mut packings = settings.list("packings").to_vec();
        packings.sort_by(f64::total_cmp);
        packings.dedup();
        if packings.is_empty() {
            return Err(settings.invalid("packings", "one packing fraction at least"));
        }
        let side = settings.whole("small_side");
        let seed = settings.seed;
        let mut jobs = vec![];
        for &packing in &packings {
            for start in [Start::Crystal, Start::Disorder] {
                if start == Start::Crystal || packing <= DENSEST_GROWN {
                    for _ in 0..settings.whole("replicas") {
                        jobs.push(Job {
                            start,
                            packing,
                            side,
                            seed,
                            stream: jobs.len() as u64,
                            settling: settings.real("settling"),
                        });
                    }
                }
            }
        }
        let start = if crystal { Start::Crystal } else { Start::Disorder };
        let shown = Job { start, packing, side: settings.whole("side"), seed, stream: SHOWN, settling: 0.0 };
        Ok(Self {
            packings,
            count: side * side,
            // Between two samples: whether the last one is taken does not hang on a rounding.
            duration: ((settings.real("duration") / PERIOD).ceil() + 0.5) * PERIOD,
            shown: Replicas::new(PERIOD, vec![Sheet::new(&shown)?]),
            sheets: Replicas::new(PERIOD, ensemble::build(&jobs, Sheet::new)?),
        })
    }

    /// The mean of one number over the sheets of a kind, if there are some.
    fn mean(&self, packing: f64, start: Option<Start>, number: impl Fn(&Sheet) -> f64) -> Option<Estimate> {
        let alike = |sheet: &&Sheet| sheet.job.packing == packing && start.is_none_or(|start| sheet.job.start == start);
        let values: Vec<f64> = self.sheets.members.iter().filter(alike).map(number).collect();
        (values.len() > 1).then(|| Estimate::from_replicas(&values))
    }

    fn last(&self) -> usize {
        self.sheets.times.len() - 1
    }

    /// `Z` at a packing fraction.
    fn compressibility(&self, packing: f64, start: Option<Start>) -> Option<Estimate> {
        self.mean(packing, start, |sheet| sheet.compressibility(0, self.last()))
    }

    /// `P s^2/kT` of `Z` at a packing fraction.
    fn pressure(packing: f64) -> f64 {
        packing / corpuscle_core::particles::ball_volume::<2>(0.5)
    }

    fn points(&self, number: impl Fn(f64) -> Option<Estimate>) -> Vec<(f64, f64, f64)> {
        let point = |&packing: &f64| number(packing).map(|value| (packing, value.mean, value.standard_error));
        self.packings.iter().filter_map(point).collect()
    }

    fn pressure_chart(&self) -> Chart {
        let measured =
            |start: Start| self.points(|packing| Some(self.compressibility(packing, Some(start))? * Self::pressure(packing)));
        let (least, most) = (self.packings[0].min(0.6), self.packings[self.packings.len() - 1].max(0.76));
        let branch = |z: fn(f64) -> f64| move |packing: f64| Self::pressure(packing) * z(packing);
        Chart::new("pressure", "Pressure through the transition", Axis::linear("packing fraction", ""), Axis::linear("P σ²/kT", ""))
            .with(Series::theory("liquid: ten virial coefficients", least, 0.69, 80, Scale::Linear, branch(theory::liquid)))
            .with(Series::theory("liquid and hexatic side by side", theory::LIQUID, theory::HEXATIC, 2, Scale::Linear, |_| {
                theory::COEXISTENCE
            }))
            .with(Series::theory("crystal: free volume", 0.72, most, 80, Scale::Linear, branch(theory::crystal)))
            .with(Series::with_errors("begun as crystals", Style::Points, measured(Start::Crystal)))
            .with(Series::with_errors("begun without order", Style::Points, measured(Start::Disorder)))
            .noting("The level piece is of a million discs. A few hundred smear it out, and where the starts differ there is no equilibrium yet.")
    }

    fn order_chart(&self) -> Chart {
        let half = self.last() / 2;
        let measured = |start: Start| self.points(|packing| self.mean(packing, Some(start), |sheet| sheet.order(half)));
        let chance = 0.5 * (std::f64::consts::PI / (6.0 * self.count as f64)).sqrt();
        let (least, most) = (self.packings[0], self.packings[self.packings.len() - 1]);
        Chart::new("order", "Order of directions", Axis::linear("packing fraction", ""), Axis::linear("|ψ₆| of a sheet", ""))
            .with(Series::theory("discs that know nothing of each other", least, most, 2, Scale::Linear, |_| chance))
            .with(Series::with_errors("begun as crystals", Style::Points, measured(Start::Crystal)))
            .with(Series::with_errors("begun without order", Style::Points, measured(Start::Disorder)))
            .noting(
                "Grains that have grown in different directions cancel: a low value above the transition is a crystal in pieces.",
            )
    }

    fn time_chart(&self) -> Chart {
        let sheet = &self.shown.members[0];
        let series = |number: fn(&sheet::Sample) -> f64| {
            self.shown.times.iter().zip(&sheet.samples).map(move |(&time, sample)| (time, number(sample))).collect::<Vec<_>>()
        };
        Chart::new("time", "The sheet on show", Axis::linear("time t", "σ √(m/kT)"), Axis::linear("order", ""))
            .with(Series::new("of the whole sheet, |ψ₆|", Style::Line, series(|sample| sample.order)))
            .with(Series::new("mean of the discs' own", Style::Line, series(|sample| sample.local)))
            .noting("Near the transition the first wanders for ever so long: that is the time equilibrium takes.")
    }
}

impl Simulation for Melting {
    fn state(&self) -> Option<&dyn Resume> {
        Some(self)
    }

    fn state_mut(&mut self) -> Option<&mut dyn Resume> {
        Some(self)
    }

    fn time(&self) -> f64 {
        self.shown.time()
    }

    fn end(&self) -> f64 {
        self.duration
    }

    fn advance(&mut self, to: f64) -> Result<(), Failure> {
        self.sheets.advance(to)?;
        self.shown.advance(to)
    }

    fn draw(&self, scene: &mut Scene) {
        scene.clear();
        let sheet = &self.shown.members[0];
        let order: Vec<f64> = sheet.bond_order().iter().map(|part| (part[0] * part[0] + part[1] * part[1]).sqrt()).collect();
        drawing::add_event_driven(scene, &sheet.engine, &Tally::default(), sheet.started, |i| order[i]);
        scene.colouring =
            Colouring::Value { name: "order of the six neighbours |ψ₆|".into(), unit: String::new(), least: 0.2, most: 1.0 };
        scene.title = EXPERIMENT.title.into();
        let now = sheet.samples.last().map_or(0.0, |sample| sample.order);
        scene.caption = format!("packing {}   |ψ₆| of the sheet {now:.2}", sheet.job.packing);
    }

    fn charts(&self) -> Vec<Chart> {
        if self.last() < 2 {
            return vec![];
        }
        vec![self.pressure_chart(), self.order_chart(), self.time_chart()]
    }

    fn checks(&self) -> Vec<Check> {
        let mut checks = vec![];
        if self.last() as f64 * PERIOD >= 3.9 {
            for &packing in &self.packings {
                if packing <= theory::CERTAIN
                    && let Some(measured) = self.compressibility(packing, None)
                {
                    let name = format!("P V/(N k T) of the liquid at packing {packing}");
                    let reference = "ten virial coefficients, Clisby and McCoy 2006, doi:10.1007/s10955-005-8080-0";
                    checks.push(measured.check(name, theory::of_few(theory::liquid(packing), self.count), reference));
                }
            }
        }
        checks.extend(energy_check(&self.honesty()));
        checks
    }

    fn honesty(&self) -> Honesty {
        let sheets = self.shown.members.iter().chain(&self.sheets.members);
        honesty(sheets.map(|sheet| (&sheet.engine, Some(sheet.energy))))
    }

    fn tables(&self) -> Vec<Table> {
        let half = self.last() / 2;
        let kinds = self.packings.iter().flat_map(|&packing| [(packing, Start::Crystal, 1.0), (packing, Start::Disorder, 0.0)]);
        let row = |(packing, start, crystal): (f64, Start, f64)| {
            let z = self.compressibility(packing, Some(start)).filter(|_| self.last() > 0)?;
            let order = self.mean(packing, Some(start), |sheet| sheet.order(half))?;
            let pressure = Self::pressure(packing);
            Some(vec![packing, crystal, z.mean * pressure, z.standard_error * pressure, order.mean, order.standard_error])
        };
        vec![Table {
            name: "transition".into(),
            columns: ["packing_fraction", "begun_as_crystal", "pressure", "pressure_error", "order", "order_error"]
                .map(String::from)
                .to_vec(),
            rows: kinds.filter_map(row).collect(),
        }]
    }

    fn moments(&self) -> Vec<f64> {
        vec![0.0, 0.1 * self.duration, 0.5 * self.duration]
    }

    fn next_event(&self) -> Option<f64> {
        let sheet = &self.shown.members[0];
        peek::next_contact(&sheet.engine, 1.5 * self.duration).map(|time| time - sheet.started)
    }
}
