//! The Lennard-Jones melt that codes of molecular dynamics are compared on.

use corpuscle_experiments::{Kind, Parameter};
use corpuscle_time::LennardJones;

use super::fluid::Fluid;
use crate::{Case, SECONDS, THREADS};

pub(crate) static CASE: Case = Case {
    name: "lennard-jones",
    summary: "The Lennard-Jones melt in space (density 0.8442, cutoff 2.5, step 0.005): particles times steps per second.",
    parameters: &[
        Parameter {
            name: "particles",
            unit: "",
            help: "Number of atoms; 4 c^3 of them (4000, 32000, 256000) fill the face-centred lattice.",
            // Half the box must hold the cutoff.
            kind: Kind::Whole { default: 4000, least: 108, most: 100_000_000 },
        },
        THREADS,
        SECONDS,
    ],
    run: |settings| {
        let potential = LennardJones { epsilon: 1.0, sigma: 1.0, cutoff: 2.5 };
        Fluid { potential, density: 0.8442, temperature: 1.44 }.measure::<3>(&CASE, settings)
    },
};
