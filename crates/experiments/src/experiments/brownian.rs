//! Brownian motion: a heavy sphere in a bath of light ones, from the collisions up.
//!
//! Kinetic theory of a dilute bath of `N` particles of mass `m` and a tracer of mass `M >> m`: its velocity obeys
//! `dV/dt = -gamma (V - V_bath) + noise`, with the Enskog friction `gamma_0` of
//! [`theory::initial_friction`]. In a periodic box total momentum stays zero, so that the bath drifts against the tracer,
//! `V_bath = -V M/(N m)`. With `s = N m / (N m + M)` this gives, for every finite `N`,
//! `<V^2> = s d kT/M` (exact), a velocity correlation that decays with `gamma_0 / s`, and `D = s^2 kT/(M gamma_0)`.
//! Between walls `s = 1`.
//!
//! The friction itself is measured from the kicks: in equilibrium `2 <V.dV> = -<|dV|^2>` per collision, so
//! `gamma_0 = <|dV|^2 per time> / (2 d kT/M)`, exact at any density and any mass.

mod bath;
mod charts;
mod path;
mod set;
mod sweep;

use corpuscle_core::Invalid;

use crate::{Experiment, Kind, Parameter, Settings, Simulation, Situation, gas};
use path::Brownian;
use set::Set;
use sweep::Sweep;

/// The registry's entry.
pub(crate) static EXPERIMENT: Experiment = Experiment {
    name: "brownian",
    title: "Brownian motion",
    summary: "A heavy particle in a bath of light ones: its zigzag path, how far it gets, how it forgets its velocity, and \
              Perrin's way from there to k T.",
    dimensions: &[2, 3],
    engines: &["event-driven"],
    parameters: PARAMETERS,
    start,
};

const SWEEPS: &[Situation] = &[
    Situation::new("none", &[&["masses", "radii"]]),
    Situation::new("mass", &[&["mass", "radii"]]),
    Situation::new("radius", &[&["radius", "masses"]]),
];

static PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "sweep",
        unit: "",
        help: "One heavy particle, or several kinds side by side, of different masses or radii.",
        kind: Kind::Situation { default: "none", options: SWEEPS },
    },
    gas::DIMENSION,
    Parameter {
        name: "boundary",
        unit: "",
        help: "A periodic box, or walls, between which the displacement saturates.",
        kind: Kind::Choice { default: "periodic", options: &["periodic", "walls"] },
    },
    Parameter {
        name: "particles",
        unit: "",
        help: "Number of bath particles.",
        kind: Kind::Whole { default: 200, least: 1, most: 100_000 },
    },
    Parameter {
        name: "packing_fraction",
        unit: "",
        help: "Volume of all bath particles over that of the box. Theory is for a dilute bath.",
        kind: Kind::Real { default: 0.004, least: 1e-6, most: 0.4 },
    },
    Parameter {
        name: "bath_radius",
        unit: "",
        help: "Radius of a bath particle; its mass is 1.",
        kind: Kind::Real { default: 0.5, least: 1e-3, most: 1e3 },
    },
    Parameter {
        name: "radius",
        unit: "",
        help: "Radius of the heavy particle.",
        kind: Kind::Real { default: 2.0, least: 1e-3, most: 1e4 },
    },
    Parameter {
        name: "mass",
        unit: "",
        help: "Mass of the heavy particle, in masses of a bath particle.",
        kind: Kind::Real { default: 30.0, least: 1.0, most: 1e6 },
    },
    Parameter {
        name: "masses",
        unit: "",
        help: "Masses of the sweep of masses.",
        kind: Kind::List { default: &[10.0, 20.0, 40.0, 80.0], least: 1.0, most: 1e6, longest: 8 },
    },
    Parameter {
        name: "radii",
        unit: "",
        help: "Radii of the sweep of radii.",
        kind: Kind::List { default: &[1.0, 2.0, 3.0, 4.0], least: 1e-3, most: 1e4, longest: 8 },
    },
    Parameter {
        name: "temperature",
        unit: "",
        help: "Temperature k_B T.",
        kind: Kind::Real { default: 1.0, least: 1e-6, most: 1e6 },
    },
    Parameter {
        name: "duration",
        unit: "1/γ",
        help: "How long is measured, in relaxation times of the heavy particle's velocity.",
        kind: Kind::Real { default: 60.0, least: 1.0, most: 1e6 },
    },
    Parameter {
        name: "replicas",
        unit: "",
        help: "Independent baths; their scatter gives the error bars. The first is on show.",
        kind: Kind::Whole { default: 48, least: 2, most: 10_000 },
    },
];

fn start(settings: &Settings) -> Result<Box<dyn Simulation>, Invalid> {
    match settings.word("dimension") {
        "3" => start_in::<3>(settings),
        _ => start_in::<2>(settings),
    }
}

fn start_in<const D: usize>(settings: &Settings) -> Result<Box<dyn Simulation>, Invalid> {
    Ok(match settings.word("sweep") {
        "none" => {
            let set = Set::<D>::new(settings, settings.real("radius"), settings.real("mass"))?;
            Box::new(Brownian::new(set, settings, 0)?)
        }
        sweep => Box::new(Sweep::<D>::new(settings, sweep == "mass")?),
    })
}
