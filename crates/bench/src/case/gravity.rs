//! Gravity of all pairs.

use corpuscle_experiments::{Kind, Parameter, Settings};
use corpuscle_time::Gravity;

use super::cluster;
use crate::threads::in_pool;
use crate::{Case, Figure, SECONDS, THREADS, Trouble};

pub(crate) static CASE: Case = Case {
    name: "gravity",
    summary: "Gravity of all pairs in a cluster of equal masses, leapfrog: unordered pairs per second.",
    parameters: &[
        Parameter {
            name: "particles",
            unit: "",
            help: "Number of masses.",
            kind: Kind::Whole { default: 1000, least: 2, most: 1_000_000 },
        },
        THREADS,
        SECONDS,
    ],
    run: |settings| in_pool(settings, || run(settings)),
};

/// Pairs between two looks at the clock: enough for it not to count.
const PAIRS_OF_GROUP: u64 = 1_000_000;

fn run(settings: &Settings) -> Result<Vec<Figure>, Trouble> {
    let count = settings.whole("particles") as u64;
    let pairs = count * (count - 1) / 2;
    let run = cluster::measure(&CASE, settings, Gravity::new(1.0, cluster::SOFTENING), PAIRS_OF_GROUP.div_ceil(pairs))?;
    let mut figures = vec![Figure::new("pairs_per_second", pairs as f64 * run.steps.per_second())];
    figures.extend(run.figures);
    Ok(figures)
}
