//! What can be set, and to what.

use crate::{Kind, Parameter};

pub(super) static PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "preset",
        unit: "",
        help: "A ready-made set of the parameters below; those given beside it win.",
        kind: Kind::Choice {
            default: "density-step",
            options: &[
                "density-step",
                "fixed-end",
                "free-end",
                "ring",
                "standing-wave",
                "shaker",
                "longitudinal",
                "matched-end",
                "damped-mode",
                "resonance",
                "dispersion",
                "fermi-pasta",
                "solitons",
                "two-sources",
                "double-slit",
                "single-slit",
                "doppler",
            ],
        },
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
        kind: Kind::Choice { default: "pulse", options: &["pulse", "mode", "drive"] },
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
        help: "Frequency f of the shaker; waves longer than two spacings exist only below f = sqrt(stiffness/mass)/pi.",
        kind: Kind::Real { default: 0.025, least: 1e-6, most: 1e6 },
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

/// What each preset changes of the defaults, as one would write it on the command line.
pub(super) fn preset(name: &str) -> &'static [(&'static str, &'static str)] {
    match name {
        "fixed-end" | "matched-end" => &[("density_ratio", "1")],
        "free-end" => &[("density_ratio", "1"), ("ends", "free")],
        "ring" => &[("density_ratio", "1"), ("ends", "periodic")],
        "standing-wave" => &[("density_ratio", "1"), ("start", "mode"), ("masses", "60")],
        "shaker" => &[("density_ratio", "1"), ("start", "drive")],
        "longitudinal" => &[("polarisation", "longitudinal")],
        "damped-mode" => &[("density_ratio", "1"), ("masses", "60")],
        "resonance" => &[("density_ratio", "1"), ("masses", "30"), ("mode", "2")],
        "dispersion" => &[("masses", "96"), ("density_ratio", "1")],
        "fermi-pasta" => &[("masses", "31"), ("mode", "1"), ("density_ratio", "1")],
        "solitons" => &[("masses", "300"), ("density_ratio", "1")],
        "single-slit" => &[("slit_width", "43")],
        _ => &[],
    }
}
