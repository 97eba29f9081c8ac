//! `corpuscle list`: the experiments there are.

use std::fmt::Write;
use std::process::ExitCode;

use clap::Args;
use corpuscle_io::Registry;
use serde_json::json;

use crate::console;
use crate::trouble::Trouble;

#[derive(Args)]
pub(crate) struct Arguments {
    /// Print as JSON, for programs.
    #[arg(long)]
    json: bool,
}

pub(crate) fn list(arguments: &Arguments, registry: Registry) -> Result<ExitCode, Trouble> {
    let text = if arguments.json { for_programs(registry) } else { for_people(registry) };
    console::print(&text)?;
    Ok(ExitCode::SUCCESS)
}

fn for_programs(registry: Registry) -> String {
    let experiments = registry.iter().map(|experiment| {
        json!({
            "name": experiment.name,
            "title": experiment.title,
            "dimension": experiment.dimensions,
            "engines": experiment.engines,
            "summary": experiment.summary,
        })
    });
    format!("{:#}\n", experiments.collect::<serde_json::Value>())
}

fn for_people(registry: Registry) -> String {
    let widest = registry.iter().map(|experiment| experiment.name.len()).max().unwrap_or(0);
    let mut out = String::new();
    for experiment in registry {
        // Writing into a string cannot fail.
        let dimensions: Vec<String> = experiment.dimensions.iter().map(|d| format!("{d}-D")).collect();
        let _ = writeln!(out, "{:<widest$}  {} ({})", experiment.name, experiment.title, dimensions.join(", "));
        let _ = writeln!(out, "{:widest$}  {}\n", "", experiment.summary);
    }
    out + "To run one: corpuscle run NAME. Its parameters: corpuscle check NAME.\n"
}
