//! The melting of hard discs: no attraction, no energy but that of motion, and yet there is a crystal.
//!
//! The order of a disc's six nearest neighbours is `psi_6 = (1/6) sum exp(6 i theta)`, its mean over the sheet near 1 in a crystal and of
//! order `1/sqrt(N)` in a liquid. Between the two discs have a third phase, the hexatic, which knows directions but no places: liquid
//! and hexatic stand side by side from 0.700 to 0.716 at the pressure `P s^2/kT = 9.185`, and near 0.720 the hexatic becomes a
//! crystal (Bernard and Krauth 2011, doi:10.1103/PhysRevLett.107.155704; Engel et al. 2013, doi:10.1103/PhysRevE.87.042134). They used a
//! million discs, whose equilibrium takes weeks. Some hundred show a smeared transition, and a loop of the pressure that is the price
//! of an interface (Mayer and Wood 1965, doi:10.1063/1.1695931) and of a number that does not fluctuate (Kolafa and Rottner 2006,
//! doi:10.1080/00268970600967963).
//!
//! So each packing fraction is begun twice, as a crystal and without order: where both agree, the sheet may be in equilibrium;
//! where they do not, it is not. Judged is what is known: the liquid's pressure against the virial coefficients up to [`CERTAIN`], the
//! crystal's from [`CRYSTALLINE`] against its published fit, within the errors stated there; both with the `O(1/N)` of few discs
//! ([`hard_discs`]). What lies between stands beside the published plateau without a verdict.

mod charts;
mod order;
mod sheet;

use corpuscle_checkpoint::{Resume, resume};
use corpuscle_core::{Failure, Invalid};
use corpuscle_observe::theory::hard_discs;
use corpuscle_observe::{Chart, Check, Estimate};
use corpuscle_scene::{Colouring, Scene};

use crate::hand::{self, InHand};
use crate::replicas::{Replicas, energy_check, honesty};
use crate::tally::Tally;
use crate::{Action, Experiment, Frame, Honesty, Kind, Parameter, Probed, Settings, Simulation, Table, drawing, ensemble, peek};
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
            default: &[0.5, 0.56, 0.6, 0.66, 0.69, 0.7, 0.71, 0.72, 0.74, 0.77, 0.8, 0.83],
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
/// Packing fraction up to which the liquid is judged: beyond, it is no longer that of its virial coefficients.
const CERTAIN: f64 = 0.6;
/// Packing fraction from which the crystal is judged: below, near melting, its pressure lies above the fit.
const CRYSTALLINE: f64 = 0.76;
/// Discs from which a sheet is judged: with fewer, terms of order `1/N^2` show.
const MANY: usize = 144;
/// Samples before anything is said.
const FEWEST: usize = 8;

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
    in_hand: Option<InHand<2>>,
}

resume!(Melting { values: [], parts: [shown, sheets], set_up: [packings, count, duration, in_hand] });

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
            in_hand: None,
        })
    }

    /// The sheets of a kind.
    fn alike(&self, packing: f64, start: Option<Start>) -> impl Iterator<Item = &Sheet> {
        let alike = move |sheet: &&Sheet| sheet.job.packing == packing && start.is_none_or(|start| sheet.job.start == start);
        self.sheets.members.iter().filter(alike)
    }

    /// The mean of one number over the sheets of a kind, if there are some.
    fn mean(&self, packing: f64, start: Option<Start>, number: impl Fn(&Sheet) -> f64) -> Option<Estimate> {
        let values: Vec<f64> = self.alike(packing, start).map(number).collect();
        (values.len() > 1).then(|| Estimate::from_replicas(&values))
    }

    /// `Z` at a packing fraction.
    fn compressibility(&self, packing: f64, start: Option<Start>) -> Option<Estimate> {
        (self.sheets.times.len() > 1).then(|| self.mean(packing, start, Sheet::compressibility))?
    }

    /// `|psi_6|` of a sheet.
    fn order(&self, packing: f64, start: Start) -> Option<Estimate> {
        self.mean(packing, Some(start), |sheet| sheet.order()[0])
    }

    /// Its susceptibility, `N (<|psi_6|^2> - <|psi_6|>^2)` over times and sheets.
    fn susceptibility(&self, packing: f64, start: Start) -> Option<Estimate> {
        let moments: Vec<[f64; 2]> = self.alike(packing, Some(start)).map(Sheet::order).collect();
        (moments.len() > 1).then(|| Estimate::jackknife(&moments, |[mean, square]| self.count as f64 * (square - mean * mean)))
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
        self.shown.advance(to)?;
        InHand::advance_any(&mut self.in_hand, self.shown.members[0].started + to)
    }

    fn draw(&self, scene: &mut Scene) {
        scene.clear();
        let sheet = &self.shown.members[0];
        let engine = InHand::on_show(self.in_hand.as_ref(), &sheet.engine);
        let discs = order::of_discs(engine);
        drawing::add_event_driven(scene, engine, &Tally::default(), sheet.started, |i| discs[i].direction());
        scene.colouring =
            Colouring::Angle { name: "direction of the six neighbours".into(), unit: "°".into(), least: -30.0, most: 30.0 };
        scene.title = EXPERIMENT.title.into();
        let now = sheet.samples.last().map_or(0.0, |sample| sample.order);
        scene.caption = format!("packing {}   |ψ₆| of the sheet {now:.2}", sheet.job.packing);
    }

    fn frame(&self) -> Option<Frame> {
        let sheet = &self.shown.members[0];
        Some(Frame::of_hard(&sheet.engine, sheet.started, &["discs"]))
    }

    fn charts(&self) -> Vec<Chart> {
        if self.sheets.times.len() < 3 {
            return vec![];
        }
        vec![self.pressure_chart(), self.residual_chart(), self.order_chart(), self.susceptibility_chart(), self.time_chart()]
    }

    fn checks(&self) -> Vec<Check> {
        let mut checks = vec![];
        if self.sheets.times.len() > FEWEST && self.count >= MANY {
            for &packing in &self.packings {
                if packing <= CERTAIN
                    && let Some(measured) = self.compressibility(packing, None)
                {
                    let name = format!("P V/(N k T) of the liquid at packing {packing}");
                    let reference =
                        "ten virial coefficients, Clisby and McCoy 2006, doi:10.1007/s10955-005-8080-0, of a fixed number";
                    checks.push(measured.check(name, hard_discs::liquid_of_few(packing, self.count), reference));
                }
                if packing >= CRYSTALLINE
                    && let Some(measured) = self.compressibility(packing, Some(Start::Crystal))
                {
                    // The fit's error is the same in every run: no score of chance, but a bound.
                    let name = format!("P V/(N k T) of the crystal at packing {packing}, distance from the published fit");
                    let far = (measured.mean - hard_discs::crystal_of_few(packing, self.count)).abs();
                    let reference =
                        "Alder, Hoover and Young 1968, doi:10.1063/1.1670653: twice its error and four times that measured";
                    let bound = 2.0 * hard_discs::crystal_error(packing) + 4.0 * measured.standard_error;
                    checks.push(Check::at_most(name, far, bound, reference));
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
        let kinds = self.packings.iter().flat_map(|&packing| [(packing, Start::Crystal, 1.0), (packing, Start::Disorder, 0.0)]);
        let row = |(packing, start, crystal): (f64, Start, f64)| {
            let z = self.compressibility(packing, Some(start))?;
            let estimates =
                [z * hard_discs::pressure(packing, 1.0), self.order(packing, start)?, self.susceptibility(packing, start)?];
            let pairs = estimates.iter().flat_map(|estimate| [estimate.mean, estimate.standard_error]);
            Some([packing, crystal].into_iter().chain(pairs).collect())
        };
        let columns = [
            "packing_fraction",
            "begun_as_crystal",
            "pressure",
            "pressure_error",
            "order",
            "order_error",
            "susceptibility",
            "susceptibility_error",
        ];
        vec![Table {
            name: "transition".into(),
            columns: columns.map(String::from).to_vec(),
            rows: kinds.filter_map(row).collect(),
        }]
    }

    fn moments(&self) -> Vec<f64> {
        vec![0.0, 0.1 * self.duration, 0.5 * self.duration]
    }

    fn next_event(&self) -> Option<f64> {
        let sheet = &self.shown.members[0];
        peek::next_contact(InHand::on_show(self.in_hand.as_ref(), &sheet.engine), 1.5 * self.duration)
            .map(|time| time - sheet.started)
    }

    fn probe(&mut self, corners: Option<[[f64; 2]; 2]>) {
        InHand::lay(&mut self.in_hand, &self.shown.members[0].engine, corners);
    }

    fn probed(&self) -> Option<Probed> {
        InHand::probed(self.in_hand.as_ref())
    }

    fn refusal(&self, action: Action) -> Option<&'static str> {
        hand::wanting_of_number(&self.shown.members[0].engine, action)
    }

    fn act(&mut self, action: Action) -> Result<(), Invalid> {
        InHand::act(&mut self.in_hand, &self.shown.members[0].engine, &Tally::default(), action)
    }
}
