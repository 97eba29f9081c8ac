//! Soft discs: so few neighbours that what is around the force counts.

use corpuscle_experiments::{Kind, Parameter};
use corpuscle_time::WeeksChandlerAndersen;

use super::fluid::Fluid;
use crate::{Case, SECONDS, THREADS};

pub(crate) static CASE: Case = Case {
    name: "wca",
    summary: "Purely repulsive soft discs in the plane (Weeks-Chandler-Andersen, density 0.6, step 0.005): particles times steps \
              per second.",
    parameters: &[
        Parameter {
            name: "particles",
            unit: "",
            help: "Number of discs.",
            // Half the box must hold the cutoff.
            kind: Kind::Whole { default: 10_000, least: 16, most: 100_000_000 },
        },
        THREADS,
        SECONDS,
    ],
    run: |settings| {
        let potential = WeeksChandlerAndersen::new(1.0, 1.0);
        Fluid { potential, density: 0.6, temperature: 1.0 }.measure::<2>(&CASE, settings)
    },
};
