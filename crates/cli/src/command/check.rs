//! `corpuscle check`: what a scenario would run, without running it.

use std::fmt::Write;
use std::process::ExitCode;

use clap::Args;
use corpuscle_experiments::{Parameter, Value};
use corpuscle_io::number::significant;
use corpuscle_io::{Registry, Scenario};

use super::Subject;
use crate::console;
use crate::table::{Align, table};
use crate::trouble::Trouble;

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    subject: Subject,
}

pub(crate) fn check(arguments: &Arguments, registry: Registry) -> Result<ExitCode, Trouble> {
    let scenario = arguments.subject.scenario(registry)?;
    // Setting the system up is what tells whether the values go together: a box too small, spheres that overlap.
    let simulation = scenario.start()?;
    let end = scenario.duration.unwrap_or_else(|| simulation.end());
    console::print(&explain(&scenario, &simulation.honesty().engine, end))?;
    Ok(ExitCode::SUCCESS)
}

fn explain(scenario: &Scenario, engine: &str, end: f64) -> String {
    let mut out = format!("{}\n{}\n\n", scenario.title(), scenario.summary());
    // Writing into a string cannot fail.
    let _ = writeln!(out, "  experiment  {}\n  engine      {engine}", scenario.name());
    let _ = writeln!(out, "  seed        {}\n  duration    {}\n", scenario.settings.seed, significant(end, 6));
    if scenario.parameters().next().is_none() {
        return out + "Valid. Nothing was run.\n";
    }
    let head = ["parameter", "value", "", "accepts", "meaning"].map(String::from).to_vec();
    let rows = scenario.parameters().map(|(parameter, value, given)| row(parameter, value, given));
    let rows: Vec<Vec<String>> = std::iter::once(head).chain(rows).collect();
    out += &table(&[Align::Left, Align::Right, Align::Left, Align::Left, Align::Left], &rows);
    out + "\nValid. Nothing was run.\n"
}

fn row(parameter: &Parameter, value: &Value, given: bool) -> Vec<String> {
    let value = match value {
        Value::List(list) if list.is_empty() => "none".into(),
        value => value.to_string(),
    };
    let unit = if parameter.unit.is_empty() { String::new() } else { format!(" {}", parameter.unit) };
    let origin = if given { "set" } else { "default" };
    vec![parameter.name.into(), value + &unit, origin.into(), parameter.expected(), parameter.help.into()]
}
