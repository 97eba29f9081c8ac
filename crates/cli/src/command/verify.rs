//! `corpuscle verify`: every experiment over many seeds, and whether its scores are what chance makes of right theory and right
//! error bars.

use std::collections::BTreeMap;
use std::process::ExitCode;

use clap::Args;
use corpuscle_experiments::Experiment;
use corpuscle_io::{Registry, Scenario};
use corpuscle_observe::Check;
use corpuscle_observe::scores::{Scores, mean_square_over_runs};

use super::conduct::Threads;
use crate::console;
use crate::trouble::Trouble;

#[derive(Args)]
pub(crate) struct Arguments {
    /// Names of experiments [default: all].
    #[arg(value_name = "NAME")]
    names: Vec<String>,
    /// Number of seeds for each.
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u64).range(2..=100_000))]
    seeds: u64,
    /// The first seed; the others follow it.
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    first: u64,
    #[command(flatten)]
    threads: Threads,
}

/// Scores beyond which chance is no explanation, as for a single check.
const LIMIT: f64 = Check::Z_LIMIT;

pub(crate) fn verify(arguments: &Arguments, registry: Registry) -> Result<ExitCode, Trouble> {
    let chosen: Vec<&'static Experiment> = if arguments.names.is_empty() {
        registry.to_vec()
    } else {
        // The scenario of a name refuses unknown ones in the words of all commands.
        let find = |name: &String| {
            let scenario = Scenario::find(registry, name)?;
            let known = registry.iter().copied().find(|experiment| experiment.name == scenario.name());
            known.ok_or_else(|| Trouble::Usage(format!("{name} is a file: expected the name of an experiment")))
        };
        arguments.names.iter().map(find).collect::<Result<_, Trouble>>()?
    };
    arguments.threads.set();
    // The rows of each experiment follow as soon as it is done.
    console::print("| experiment | quantity | runs | mean z | mean z² | verdict |\n|---|---|---|---|---|---|\n")?;
    let mut sound = true;
    for experiment in chosen {
        let seeds = arguments.first..arguments.first.saturating_add(arguments.seeds);
        let tally = Tally::of(experiment, seeds)?;
        sound &= tally.is_sound();
        console::print(&tally.rows(experiment.name))?;
    }
    Ok(if sound { ExitCode::SUCCESS } else { ExitCode::from(3) })
}

/// The checks of one experiment over its runs.
#[derive(Default)]
struct Tally {
    scores: BTreeMap<String, Scores>,
    runs: Vec<Vec<f64>>,
    /// Checks against a bound: how many, and which of them failed.
    bounds: usize,
    broken: Vec<String>,
}

impl Tally {
    fn of(experiment: &'static Experiment, seeds: std::ops::Range<u64>) -> Result<Self, Trouble> {
        let mut tally = Self::default();
        for seed in seeds {
            let mut scenario = Scenario::new(experiment);
            scenario.settings.seed = seed;
            let mut simulation = scenario.start()?;
            simulation.advance(simulation.end())?;
            tally.add(seed, &simulation.checks());
        }
        Ok(tally)
    }

    fn add(&mut self, seed: u64, checks: &[Check]) {
        let mut run = vec![];
        for check in checks {
            match check.z {
                Some(z) => {
                    self.scores.entry(check.quantity.clone()).or_default().push(z);
                    run.push(z);
                }
                None => self.bounds += 1,
            }
            // A score beyond the limit counts by itself only where it is none at all: the spread tells of the others.
            if !check.passed && check.z.is_none_or(f64::is_nan) {
                self.broken.push(format!("{} (seed {seed})", check.quantity));
            }
        }
        self.runs.push(run);
    }

    fn verdict(scores: &Scores) -> &'static str {
        if scores.score_of_mean().abs() > LIMIT || scores.mean().is_nan() {
            "off"
        } else if scores.score_of_spread() > LIMIT {
            "error bars too small"
        } else if scores.score_of_spread() < -LIMIT {
            "error bars too large"
        } else {
            "✓"
        }
    }

    fn is_sound(&self) -> bool {
        self.broken.is_empty() && self.scores.values().all(|scores| Self::verdict(scores) == "✓")
    }

    /// Rows of a table in Markdown.
    fn rows(&self, name: &str) -> String {
        use std::fmt::Write;
        let mut out = String::new();
        for (quantity, scores) in &self.scores {
            let (count, mean, square) = (scores.count(), scores.mean(), scores.mean_square());
            // Writing into a string cannot fail. A bar would end the cell.
            let quantity = quantity.replace('|', "¦");
            let _ = writeln!(out, "| {name} | {quantity} | {count} | {mean:+.2} | {square:.2} | {} |", Self::verdict(scores));
        }
        if self.scores.len() > 1 {
            let together = mean_square_over_runs(&self.runs);
            let (mean, error) = (together.mean, together.standard_error);
            let _ = writeln!(out, "| {name} | all of these | {} | | {mean:.2} ± {error:.2} | |", self.runs.len());
        }
        if self.bounds > 0 {
            let verdict = if self.broken.is_empty() { "✓".into() } else { format!("broken: {}", self.broken.join(", ")) };
            let _ = writeln!(out, "| {name} | {} bounds in all runs | {} | | | {verdict} |", self.bounds, self.runs.len());
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corpuscle_core::Random;

    fn tally(width: f64) -> Tally {
        let mut random = Random::new(2, 0);
        let mut tally = Tally::default();
        for seed in 1..=40 {
            let check = |name: &str, z: f64| Check::agreement(name, z, 1.0, 0.0, "");
            let checks = [check("a", width * random.normal()), check("b", random.normal()), Check::at_most("drift", 0.5, 1.0, "")];
            tally.add(seed, &checks);
        }
        tally
    }

    #[test]
    fn right_errors_are_told_from_wrong_ones() {
        assert!(tally(1.0).is_sound());
        assert!(tally(2.5).rows("x").contains("| x | a | 40 |") && tally(2.5).rows("x").contains("too small"));
        assert!(tally(0.1).rows("x").contains("too large"));
        assert!(!tally(0.1).is_sound());
    }

    #[test]
    fn a_broken_bound_is_named_with_its_seed() {
        let mut tally = tally(1.0);
        tally.add(41, &[Check::at_most("drift", 2.0, 1.0, "")]);
        assert!(tally.rows("x").contains("drift (seed 41)") && !tally.is_sound());
    }
}
