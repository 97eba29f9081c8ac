//! What the tests of the experiments share: setting one up, running it, and judging its scores over seeds.

#![allow(clippy::unwrap_used, dead_code)] // helpers of tests are tests too, and not every test uses all of them

use corpuscle_core::Invalid;
use corpuscle_experiments::{Settings, Simulation, find};
use corpuscle_observe::Check;
use corpuscle_observe::scores::Scores;

/// Starts an experiment with these values of its parameters.
pub(crate) fn start(experiment: &str, seed: u64, values: &[(&str, &str)]) -> Result<Box<dyn Simulation>, Invalid> {
    let experiment = find(experiment).unwrap();
    let mut settings = Settings::new(experiment.parameters, seed);
    for (key, text) in values {
        settings.set_text(key, text)?;
    }
    (experiment.start)(&settings)
}

/// Runs it to its end in `stops` advances.
pub(crate) fn run(experiment: &str, seed: u64, values: &[(&str, &str)], stops: u32) -> Box<dyn Simulation> {
    let mut simulation = start(experiment, seed, values).unwrap();
    for stop in 1..=stops {
        simulation.advance(simulation.end() * f64::from(stop) / f64::from(stops)).unwrap();
    }
    simulation
}

/// Its checks after a run on so many threads.
pub(crate) fn checks_on(threads: usize, experiment: &str, seed: u64, values: &[(&str, &str)]) -> Vec<Check> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| run(experiment, seed, values, 3).checks())
}

/// Ten seeds: all checks pass, and the scores look like standard normal deviates. Their sum of squares follows chi-squared,
/// held to four standard deviations either way (too small means error bars too large); their mean is held to four
/// standard errors.
pub(crate) fn agrees_over_seeds(experiment: &str, values: &[(&str, &str)]) {
    agrees_over_more_seeds(experiment, values, 10);
}

/// The same, with as many seeds as it takes for few checks.
pub(crate) fn agrees_over_more_seeds(experiment: &str, values: &[(&str, &str)], seeds: u64) {
    let mut scores = Scores::new();
    for seed in 1..=seeds {
        for check in run(experiment, seed, values, 1).checks() {
            assert!(check.passed, "seed {seed}: {check:?}");
            if let Some(z) = check.z {
                scores.push(z);
            }
        }
    }
    let (n, mean, square) = (scores.count() as f64, scores.mean(), scores.mean_square());
    assert!(n >= 40.0, "only {n} statistical checks in {seeds} runs");
    println!("{n} scores: mean {mean:.3}, mean square {square:.3}");
    assert!(mean.abs() * n.sqrt() < 4.0, "mean of z {mean}");
    assert!((square - 1.0).abs() < 4.0 * (2.0 / n).sqrt(), "mean square of z {square}");
}

/// The key under which an experiment refuses these values.
pub(crate) fn refused(experiment: &str, values: &[(&str, &str)]) -> String {
    start(experiment, 1, values).err().expect("these values make no sense").key
}
