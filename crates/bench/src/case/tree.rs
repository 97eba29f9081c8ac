//! Gravity by a tree.

use corpuscle_experiments::{Kind, Parameter, Settings};
use corpuscle_time::TreeGravity;

use super::cluster;
use crate::threads::in_pool;
use crate::{Case, Figure, SECONDS, THREADS, Trouble};

pub(crate) static CASE: Case = Case {
    name: "tree",
    summary: "Gravity by a tree in a cluster of equal masses, leapfrog: seconds a step, beside the errors of its forces.",
    parameters: &[
        Parameter {
            name: "particles",
            unit: "",
            help: "Number of masses.",
            kind: Kind::Whole { default: 10_000, least: 2, most: 100_000_000 },
        },
        Parameter {
            name: "opening_angle",
            unit: "",
            help: "Side over distance below which a cell pulls as a whole.",
            kind: Kind::Real { default: 0.5, least: 0.0, most: 0.99 },
        },
        THREADS,
        SECONDS,
    ],
    run: |settings| in_pool(settings, || run(settings)),
};

fn run(settings: &Settings) -> Result<Vec<Figure>, Trouble> {
    let force = TreeGravity::new(1.0, cluster::SOFTENING, settings.real("opening_angle"));
    let run = cluster::measure(&CASE, settings, force, 1)?;
    let mut figures = vec![
        Figure::new("seconds_per_step", 1.0 / run.steps.per_second()),
        Figure::new("particle_steps_per_second", settings.whole("particles") as f64 * run.steps.per_second()),
    ];
    figures.extend(run.figures);
    Ok(figures)
}
