//! The subcommands, one a file, and the arguments that several share.

pub(crate) mod bench;
pub(crate) mod check;
mod conduct;
pub(crate) mod export;
pub(crate) mod lab;
pub(crate) mod list;
pub(crate) mod record;
pub(crate) mod resume;
pub(crate) mod run;
pub(crate) mod schema;
mod target;
pub(crate) mod verify;
pub(crate) mod view;

use clap::Args;
use corpuscle_io::{Refusal, Registry, Scenario};

use crate::memory;

/// What to run, and how it differs from its defaults.
#[derive(Args)]
pub(crate) struct Subject {
    /// Name of an experiment, or a scenario file; `-` reads one from standard input.
    #[arg(value_name = "NAME|FILE")]
    name: String,
    /// Set a parameter; may be given several times.
    #[arg(long, value_name = "KEY=VALUE", value_parser = assignment, allow_hyphen_values = true)]
    set: Vec<(String, String)>,
    /// Seed of all random numbers [default: the file's, or 1].
    #[arg(long, value_parser = seed, allow_hyphen_values = true)]
    seed: Option<u64>,
}

impl Subject {
    /// The scenario these arguments describe.
    fn scenario(&self, registry: Registry) -> Result<Scenario, Refusal> {
        let mut scenario = Scenario::find(registry, &self.name)?;
        for (key, value) in &self.set {
            scenario.set(key, value)?;
        }
        if let Some(seed) = self.seed {
            scenario.settings.seed = seed;
        }
        memory::admit(&scenario)?;
        Ok(scenario)
    }
}

fn assignment(text: &str) -> Result<(String, String), String> {
    text.split_once('=')
        .map(|(key, value)| (key.trim().to_owned(), value.trim().to_owned()))
        .filter(|(key, _)| !key.is_empty())
        .ok_or_else(|| "expected KEY=VALUE, as in temperature=2.5".into())
}

fn seed(text: &str) -> Result<u64, String> {
    text.trim().parse().map_err(|_| format!("expected a whole number from 0 to {}", u64::MAX))
}

/// Reads a physical time: a number, with or without an `s`.
fn physical_time(text: &str) -> Result<f64, String> {
    let number = text.trim();
    let number = number.strip_suffix('s').unwrap_or(number).trim_end();
    number
        .parse()
        .ok()
        .filter(|time: &f64| time.is_finite() && *time >= 0.0)
        .ok_or_else(|| "expected a time from 0, as in 2.5s".into())
}

/// Reads a number above zero.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    text.trim()
        .parse()
        .ok()
        .filter(|number: &f64| number.is_finite() && *number > 0.0)
        .ok_or_else(|| "expected a number above 0".into())
}
