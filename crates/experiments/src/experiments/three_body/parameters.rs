//! What can be set, and to what.

use corpuscle_time::Integrator;

use crate::{Kind, Parameter, Situation};

/// Of fixed steps, and the precise one they are measured against; the map for planets needs a heavy star.
const INTEGRATORS: &[&str] = Integrator::NAMES.split_at(8).0;

/// What only the restricted problem reads, and what only the map.
const RESTRICTED: &[&str] = &["jacobi_constant"];
const MAP: &[&str] = &["resolution", "map_centre", "map_extent", "capture_radius", "release_velocity"];

/// Three stars of equal masses without dust.
const fn stars(name: &'static str) -> Situation {
    Situation::new(name, &[RESTRICTED]).with(&[("masses", "1, 1, 1"), ("grains", "0")])
}

/// Masses of Sun, Earth and Moon are over the Sun's (IAU 2015 nominal values and DE440).
const PRESETS: &[Situation] = &[
    stars("paper").with(&[("masses", "1, 0.15, 0.1"), ("softening", "0.2")]),
    stars("figure-eight"),
    stars("lagrange").with(&[("masses", "1, 0.02, 0.01"), ("grains", "12")]),
    stars("euler"),
    stars("pythagorean").with(&[("masses", "3, 4, 5"), ("grains", "0")]),
    stars("sun-earth-moon").with(&[("masses", "1, 3.0034896e-6, 3.694303e-8"), ("grains", "0")]),
    Situation::new("restricted", &[MAP, &["integrator", "time_step", "grain_spacing", "softening", "gravity_constant"]])
        .with(&[("masses", "0.987849415, 0.012150585"), ("grains", "12")]),
    stars("butterfly"),
    stars("butterfly-2"),
    stars("moth"),
    stars("dragonfly"),
    stars("yin-yang"),
    stars("goggles"),
    stars("yarn"),
];

const VIEWS: &[Situation] = &[
    Situation::new("paths", &[MAP]),
    Situation::new("integrators", &[MAP]),
    Situation::new("basins", &[&["integrator", "time_step", "grains", "grain_spacing"]]),
];

pub(super) const PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "preset",
        unit: "",
        help: "Start: three stars and dust, a periodic orbit, Lagrange's triangle, Euler's line, Burrau's Pythagorean problem, Sun, \
               Earth and Moon, or dust about two stars on circles (restricted).",
        kind: Kind::Situation { default: "paper", options: PRESETS },
    },
    Parameter {
        name: "integrator",
        unit: "",
        help: "Rule that advances time; gauss-radau-15 chooses its own steps and is exact to rounding.",
        kind: Kind::Choice { default: "gauss-radau-15", options: INTEGRATORS },
    },
    Parameter {
        name: "time_step",
        unit: "",
        help: "Longest step of a fixed-step integrator; shortened so that a whole number of steps makes a sampling interval.",
        kind: Kind::Real { default: 0.001, least: 1e-6, most: 1.0 },
    },
    Parameter {
        name: "masses",
        unit: "",
        help: "Masses of the three stars; empty: those of the preset. The restricted problem takes the first two for its stars.",
        kind: Kind::List { default: &[], least: 1e-9, most: 1e6, longest: 3 },
    },
    Parameter {
        name: "grains",
        unit: "",
        help: "Number of dust grains, each with two unseen twins.",
        kind: Kind::Whole { default: 24, least: 0, most: 1000 },
    },
    Parameter {
        name: "grain_spacing",
        unit: "",
        help: "Difference between the starts of neighbouring grains, in one coordinate.",
        kind: Kind::Real { default: 0.1, least: 1e-12, most: 10.0 },
    },
    Parameter {
        name: "softening",
        unit: "",
        help: "Plummer's softening length of gravity.",
        kind: Kind::Real { default: 0.0, least: 0.0, most: 10.0 },
    },
    Parameter {
        name: "gravity_constant",
        unit: "",
        help: "Constant of gravity G.",
        kind: Kind::Real { default: 1.0, least: 1e-6, most: 1e6 },
    },
    Parameter {
        name: "duration",
        unit: "",
        help: "Physical time to run for; 0: as long as the preset needs.",
        kind: Kind::Real { default: 0.0, least: 0.0, most: 1e6 },
    },
    Parameter {
        name: "show",
        unit: "",
        help: "The paths of stars and dust; the same in two integrators, joined by lines; or a map (basins) of where dust ends that \
               is released all over the place.",
        kind: Kind::Situation { default: "paths", options: VIEWS },
    },
    Parameter {
        name: "jacobi_constant",
        unit: "",
        help: "Restricted problem: the constant C with which all grains start; forbidden to them is where the zero-velocity curve \
               closes.",
        kind: Kind::Real { default: 3.17, least: 0.1, most: 100.0 },
    },
    Parameter {
        name: "resolution",
        unit: "",
        help: "Cells along a side of the map; each is one grain.",
        kind: Kind::Whole { default: 320, least: 16, most: 4000 },
    },
    Parameter {
        name: "map_centre",
        unit: "",
        help: "Middle of the map, x and y; empty: the stars' centre of mass.",
        kind: Kind::List { default: &[], least: -1e6, most: 1e6, longest: 2 },
    },
    Parameter {
        name: "map_extent",
        unit: "",
        help: "Side of the map: make it small to look closer. 0: all of the stars' surroundings.",
        kind: Kind::Real { default: 0.0, least: 0.0, most: 1e6 },
    },
    Parameter {
        name: "capture_radius",
        unit: "",
        help: "A grain of the map that comes so close to a star has hit it.",
        kind: Kind::Real { default: 0.1, least: 1e-3, most: 10.0 },
    },
    Parameter {
        name: "release_velocity",
        unit: "",
        help: "Velocity, x and y, with which the grains of the map are released; empty: at rest.",
        kind: Kind::List { default: &[], least: -1e3, most: 1e3, longest: 2 },
    },
];
