//! What can be set, and to what.

use crate::{Kind, Parameter, Situation};

/// What only chains that lose energy read, only nonlinear ones, only membranes.
const FRICTION: &[&str] = &["end_impedance", "damping"];
const NONLINEAR: &[&str] = &["nonlinearity", "solitons"];
const MEMBRANE: &[&str] = &["wavelength", "slit_separation", "slit_width", "source_speed"];
/// What only the linear chain without friction reads.
const CHAIN: &[&str] = &["polarisation", "ends", "start", "density_ratio", "integrator"];
const START: &[&str] = &["pulse_width", "mode", "drive_frequency"];

/// A linear chain without friction.
const fn chain(name: &'static str) -> Situation {
    Situation::new(name, &[FRICTION, NONLINEAR, MEMBRANE])
}

const PRESETS: &[Situation] = &[
    chain("density-step"),
    chain("fixed-end").with(&[("density_ratio", "1")]),
    chain("free-end").with(&[("density_ratio", "1"), ("ends", "free")]),
    chain("ring").with(&[("density_ratio", "1"), ("ends", "periodic")]),
    chain("standing-wave").with(&[("density_ratio", "1"), ("start", "mode"), ("masses", "60")]),
    chain("shaker").with(&[("density_ratio", "1"), ("start", "drive")]),
    chain("longitudinal").with(&[("polarisation", "longitudinal")]),
    Situation::new("matched-end", &[CHAIN, NONLINEAR, MEMBRANE, &["mode", "drive_frequency", "time_step", "damping"]]),
    Situation::new("damped-mode", &[CHAIN, NONLINEAR, MEMBRANE, &["pulse_width", "drive_frequency", "time_step", "end_impedance"]])
        .with(&[("masses", "60")]),
    Situation::new("resonance", &[CHAIN, NONLINEAR, MEMBRANE, &["pulse_width", "time_step", "end_impedance"]]).with(&[
        ("masses", "30"),
        ("mode", "2"),
        ("drive_frequency", "0"),
    ]),
    Situation::new("dispersion", &[CHAIN, START, FRICTION, NONLINEAR, MEMBRANE, &["duration"]]).with(&[("masses", "96")]),
    Situation::new("fermi-pasta", &[CHAIN, &["pulse_width", "drive_frequency", "solitons"], FRICTION, MEMBRANE])
        .with(&[("masses", "31"), ("mode", "1")]),
    Situation::new("solitons", &[CHAIN, START, FRICTION, MEMBRANE, &["nonlinearity", "amplitude"]]).with(&[("masses", "300")]),
    Situation::new("two-sources", &[CHAIN, START, FRICTION, NONLINEAR, CHAINS, &["slit_width", "source_speed"]]),
    Situation::new("double-slit", &[CHAIN, START, FRICTION, NONLINEAR, CHAINS, &["source_speed"]]),
    Situation::new("single-slit", &[CHAIN, START, FRICTION, NONLINEAR, CHAINS, &["slit_separation", "source_speed"]])
        .with(&[("slit_width", "43")]),
    Situation::new("doppler", &[CHAIN, START, FRICTION, NONLINEAR, CHAINS, &["slit_separation", "slit_width"]]),
];
/// What all chains read and membranes do not.
const CHAINS: &[&str] = &["masses", "time_step", "duration"];

const STARTS: &[Situation] = &[
    Situation::new("pulse", &[&["mode", "drive_frequency"]]),
    Situation::new("mode", &[&["pulse_width", "drive_frequency"]]),
    Situation::new("drive", &[&["pulse_width", "mode"]]),
];

pub(super) static PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "preset",
        unit: "",
        help: "A ready-made set of the parameters below; those given beside it win.",
        kind: Kind::Situation { default: "density-step", options: PRESETS },
    },
    Parameter {
        name: "polarisation",
        unit: "",
        help: "Displacements across the chain (transverse, as on a string) or along it (longitudinal, as in sound).",
        kind: Kind::Choice { default: "transverse", options: &["transverse", "longitudinal"] },
    },
    Parameter {
        name: "ends",
        unit: "",
        help: "Both ends fixed, both free, or joined to a ring (periodic); with a shaker, the end opposite to it.",
        kind: Kind::Choice { default: "fixed", options: &["fixed", "free", "periodic"] },
    },
    Parameter {
        name: "start",
        unit: "",
        help: "A Gaussian pulse running to the right, a normal mode, or rest with a shaker (drive) at the left end.",
        kind: Kind::Situation { default: "pulse", options: STARTS },
    },
    Parameter {
        name: "masses",
        unit: "",
        help: "Number N of masses that can move.",
        kind: Kind::Whole { default: 100, least: 3, most: 2000 },
    },
    Parameter {
        name: "density_ratio",
        unit: "",
        help: "Mass of each mass in the right half over that in the left; 1 for a uniform chain. The steps measured beside \
               include this one.",
        kind: Kind::Real { default: 4.0, least: 0.0625, most: 16.0 },
    },
    Parameter {
        name: "amplitude",
        unit: "",
        help: "Height of the pulse, of the mode or of the shaker's motion.",
        kind: Kind::Real { default: 1.0, least: 1e-6, most: 1e6 },
    },
    Parameter {
        name: "pulse_width",
        unit: "spacings",
        help: "Standard deviation of the pulse, in spacings; the narrower, the more dispersion.",
        kind: Kind::Real { default: 5.0, least: 1.0, most: 100.0 },
    },
    Parameter {
        name: "mode",
        unit: "",
        help: "Number j of the mode to start with.",
        kind: Kind::Whole { default: 3, least: 1, most: 2000 },
    },
    Parameter {
        name: "drive_frequency",
        unit: "1/time",
        help: "Frequency f of the shaker; waves longer than two spacings exist only below f = sqrt(stiffness/mass)/pi. Resonance: 0 \
               for that of the mode.",
        kind: Kind::Real { default: 0.025, least: 0.0, most: 1e6 },
    },
    Parameter {
        name: "stiffness",
        unit: "",
        help: "Stiffness kappa of each spring; a transverse string is under the tension stiffness x spacing.",
        kind: Kind::Real { default: 1.0, least: 1e-6, most: 1e6 },
    },
    Parameter {
        name: "mass",
        unit: "",
        help: "Mass m of each mass in the left half.",
        kind: Kind::Real { default: 1.0, least: 1e-6, most: 1e6 },
    },
    Parameter {
        name: "spacing",
        unit: "",
        help: "Distance a of neighbours at rest.",
        kind: Kind::Real { default: 1.0, least: 1e-3, most: 1e3 },
    },
    Parameter {
        name: "integrator",
        unit: "",
        help: "How the chain on show is advanced; the measurements beside it use velocity Verlet, whose error is known exactly.",
        kind: Kind::Choice {
            default: "velocity-verlet",
            options: &["velocity-verlet", "symplectic-euler", "yoshida-4", "runge-kutta-4", "explicit-euler"],
        },
    },
    Parameter {
        name: "time_step",
        unit: "time",
        help: "Step of time; 0 for a tenth of sqrt(mass/stiffness). Velocity Verlet is stable below 2 over the highest frequency.",
        kind: Kind::Real { default: 0.0, least: 0.0, most: 1e6 },
    },
    Parameter {
        name: "duration",
        unit: "time",
        help: "How long to watch; 0 for one and a half crossings of a pulse, three of a driven wave, three periods of a mode.",
        kind: Kind::Real { default: 0.0, least: 0.0, most: 1e9 },
    },
    Parameter {
        name: "end_impedance",
        unit: "sqrt(T mu)",
        help: "matched-end: impedance of the damper at the right end, over that of the string; at 1 nothing comes back.",
        kind: Kind::Real { default: 1.0, least: 0.0, most: 100.0 },
    },
    Parameter {
        name: "damping",
        unit: "sqrt(stiffness/mass)",
        help: "damped-mode and resonance: rate gamma of the friction -m gamma v on every mass.",
        kind: Kind::Real { default: 0.02, least: 0.005, most: 2.0 },
    },
    Parameter {
        name: "nonlinearity",
        unit: "1/length",
        help: "fermi-pasta: alpha of the springs' tension, stiffness times (x + alpha x^2).",
        kind: Kind::Real { default: 0.25, least: -10.0, most: 10.0 },
    },
    Parameter {
        name: "solitons",
        unit: "",
        help: "solitons: inverse width of each, per spacing; the narrow ones are the fast ones and start behind.",
        kind: Kind::List { default: &[1.6, 0.8], least: 0.2, most: 1.7, longest: 3 },
    },
    Parameter {
        name: "wavelength",
        unit: "spacings",
        help: "Membrane: wavelength along its axes.",
        kind: Kind::Real { default: 12.0, least: 5.0, most: 60.0 },
    },
    Parameter {
        name: "slit_separation",
        unit: "spacings",
        help: "Membrane: distance of the two sources, or of the middles of the two slits.",
        kind: Kind::Whole { default: 40, least: 2, most: 110 },
    },
    Parameter {
        name: "slit_width",
        unit: "spacings",
        help: "Membrane: width of each slit.",
        kind: Kind::Whole { default: 5, least: 1, most: 110 },
    },
    Parameter {
        name: "source_speed",
        unit: "",
        help: "doppler: speed of the source over that of long waves; above 1 it draws a cone.",
        kind: Kind::Real { default: 0.4, least: 0.05, most: 2.0 },
    },
];
