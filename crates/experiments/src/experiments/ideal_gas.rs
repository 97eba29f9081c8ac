//! The ideal gas law, measured: hard particles in a box, and what an experimenter does to them.
//!
//! `laws` sweeps volume, temperature and number; `isotherms` holds the temperature or the volume, up to dense fluids, `isobars` the
//! pressure; `adiabat` compresses slowly and fast; `piston` lets a loaded piston swing;
//! `warm_walls` keeps the temperature instead of the energy; `mixture` has two gases in one box.

mod adiabat;
mod charts;
mod checks;
mod isobars;
mod isotherms;
mod laws;
mod mixture;
mod piston;
mod system;
mod theory;
mod warm_walls;

use corpuscle_core::{Axis, Invalid};

use crate::simulation::Simulation;
use crate::{Experiment, Kind, Parameter, Settings, Situation, gas};
use laws::Laboratory;
use system::State;

const PROCESSES: &[Situation] = &[
    Situation::new("laws", &[&["temperatures", "speeds", "piston_mass", "heavy_mass"]]),
    Situation::new("isotherms", &[&["span", "points", "speeds", "piston_mass", "heavy_mass"]]),
    Situation::new("isobars", &[&["dense_packings", "temperatures", "speeds", "heavy_mass"]]),
    Situation::new("adiabat", &[&["span", "points", "dense_packings", "temperatures", "piston_mass", "heavy_mass", "duration"]]),
    Situation::new("piston", &[&["span", "points", "dense_packings", "temperatures", "speeds", "heavy_mass", "duration"]]),
    Situation::new("warm-walls", &[&["span", "points", "dense_packings", "temperatures", "speeds", "piston_mass", "heavy_mass"]]),
    Situation::new("mixture", &[&["span", "points", "dense_packings", "temperatures", "speeds", "piston_mass"]]),
];

/// The experiment.
pub(crate) static EXPERIMENT: Experiment = Experiment {
    name: "ideal-gas",
    title: "Ideal gas law",
    summary: "Hard particles between walls: the pressure from wall hits and from the virial theorem, against volume, temperature \
              and number of particles, beside the laws of Boyle, Charles and Avogadro and the excess that the particles' size adds.",
    dimensions: &[2, 3],
    engines: &["event-driven"],
    parameters: &[
        Parameter {
            name: "process",
            unit: "",
            help: "What is done: the sweeps of the laws, temperatures or volumes held up to dense fluids (isotherms), pressure held by \
                   a loaded piston (isobars), a slow and a fast compression (adiabat), a piston under a constant force, walls with a \
                   temperature, a mixture of two gases.",
            kind: Kind::Situation { default: "laws", options: PROCESSES },
        },
        gas::DIMENSION,
        Parameter {
            name: "particles",
            unit: "",
            help: "Number N of particles at the base state, the one in the window.",
            kind: Kind::Whole { default: 200, least: 20, most: 20_000 },
        },
        Parameter {
            name: "packing_fraction",
            unit: "",
            help: "Part of the base volume that the particles fill; the gas is the more ideal, the smaller it is.",
            kind: Kind::Real { default: 0.01, least: 1e-4, most: 0.03 },
        },
        Parameter {
            name: "temperature",
            unit: "",
            help: "Temperature kT of the base state, as an energy.",
            kind: Kind::Real { default: 1.0, least: 1e-6, most: 1e6 },
        },
        Parameter {
            name: "mass",
            unit: "",
            help: "Mass m of a particle.",
            kind: Kind::Real { default: 1.0, least: 1e-6, most: 1e6 },
        },
        Parameter {
            name: "radius",
            unit: "",
            help: "Radius R of a particle.",
            kind: Kind::Real { default: 0.5, least: 1e-6, most: 1e6 },
        },
        Parameter {
            name: "span",
            unit: "",
            help: "Each sweep goes from the base state down to this part of its pressure: volume times, temperature and number over it.",
            kind: Kind::Real { default: 4.0, least: 1.5, most: 10.0 },
        },
        Parameter {
            name: "points",
            unit: "",
            help: "State points of each law, the base state among them.",
            kind: Kind::Whole { default: 5, least: 3, most: 20 },
        },
        Parameter {
            name: "dense_packings",
            unit: "",
            help: "Packing fractions of dense gases in periodic boxes, held against the equation of state up to 0.3.",
            kind: Kind::List { default: &[0.05, 0.1, 0.2, 0.3], least: 0.01, most: 0.6, longest: 10 },
        },
        Parameter {
            name: "temperatures",
            unit: "T",
            help: "Isotherms: their temperatures, over that of the base state.",
            kind: Kind::List { default: &[0.5, 1.0, 2.0], least: 1e-3, most: 1e3, longest: 6 },
        },
        Parameter {
            name: "speeds",
            unit: "sqrt(kT/m)",
            help: "Adiabat: speeds of the wall that halves the volume, the slowest first; the limit of slowness is extrapolated from \
                   the first two.",
            kind: Kind::List { default: &[0.025, 0.05, 0.2, 0.8, 3.2], least: 1e-3, most: 10.0, longest: 8 },
        },
        Parameter {
            name: "piston_mass",
            unit: "N m",
            help: "Piston and isobars: mass of the piston, in masses of all the gas.",
            kind: Kind::Real { default: 2.0, least: 1.0, most: 1e4 },
        },
        Parameter {
            name: "heavy_mass",
            unit: "m",
            help: "Mixture: mass of a particle of the heavy gas, which is half of the particles.",
            kind: Kind::Real { default: 4.0, least: 0.1, most: 100.0 },
        },
        Parameter {
            name: "replicas",
            unit: "",
            help: "Independent repetitions of every state point, which give the standard errors.",
            kind: Kind::Whole { default: 10, least: 3, most: 200 },
        },
        Parameter {
            name: "duration",
            unit: "a/sqrt(kT/m)",
            help: "Measuring time, in the times a thermal particle takes to cross the base box.",
            kind: Kind::Real { default: 40.0, least: 5.0, most: 10_000.0 },
        },
    ],
    start,
};

fn start(settings: &Settings) -> Result<Box<dyn Simulation>, Invalid> {
    match settings.word("dimension") {
        "3" => start_in::<3>(settings),
        _ => start_in::<2>(settings),
    }
}

fn start_in<const D: usize>(settings: &Settings) -> Result<Box<dyn Simulation>, Invalid> {
    Ok(match settings.word("process") {
        "isotherms" => Box::new(isotherms::start::<D>(settings)?),
        "isobars" => Box::new(isobars::start::<D>(settings)?),
        "adiabat" => Box::new(adiabat::start::<D>(settings)?),
        "piston" => Box::new(piston::start::<D>(settings)?),
        "warm-walls" => Box::new(warm_walls::start::<D>(settings)?),
        "mixture" => Box::new(mixture::start::<D>(settings)?),
        _ => Box::new(Laboratory::<D>::new(settings)?),
    })
}

impl State {
    /// The base state of the settings, between walls.
    fn base<const D: usize>(settings: &Settings) -> Self {
        let (count, radius) = (settings.whole("particles"), settings.real("radius"));
        let side = gas::side::<D>(count, radius, settings.real("packing_fraction"));
        let (temperature, mass) = (settings.real("temperature"), settings.real("mass"));
        Self { count, temperature, side, radius, mass, axis: Axis::Walls }
    }

    /// Time in which a thermal particle crosses the box.
    fn crossing(&self) -> f64 {
        self.open_side() / self.thermal_speed()
    }
}
