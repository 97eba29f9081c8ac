//! `corpuscle check`: what a scenario would run, without running it.

use std::fmt::Write;
use std::process::ExitCode;
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

use clap::Args;
use corpuscle_core::particles::ball_volume;
use corpuscle_experiments::{Parameter, Simulation, Value};
use corpuscle_io::number::significant;
use corpuscle_io::{Registry, Scenario};

use super::Subject;
use crate::table::{Align, table};
use crate::trouble::Trouble;
use crate::{console, memory};

/// A trial takes so long, and is given so long until it has made a beginning.
const TRIAL: Duration = Duration::from_millis(300);
const PATIENCE: Duration = Duration::from_secs(2);

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
    let engine = simulation.honesty().engine;
    let cost = crowd(simulation.as_ref()) + &cost(&scenario, time_needed(simulation, end));
    console::print(&explain(&scenario, &engine, end, &cost))?;
    Ok(ExitCode::SUCCESS)
}

/// How many particles there are, of replicas on show, and how much of the box they fill; nothing of an experiment without any.
fn crowd(simulation: &dyn Simulation) -> String {
    let Some(frame) = simulation.frame() else { return String::new() };
    let ball = if frame.dimension == 2 { ball_volume::<2> } else { ball_volume::<3> };
    let filled: f64 = frame.particles.radius.iter().map(|&radius| ball(radius)).sum();
    let room: f64 = (0..frame.dimension).map(|k| frame.upper[k] - frame.lower[k]).product();
    let packing = if filled > 0.0 { format!(", which fill {} of the box", significant(filled / room, 3)) } else { String::new() };
    format!("  particles   {}{packing}\n", frame.particles.len())
}

/// What a run would cost.
fn cost(scenario: &Scenario, time: Option<Duration>) -> String {
    let memory = memory::bytes(memory::needed(scenario));
    let of = memory::available().map_or_else(String::new, |bytes| format!(", of {} there are", memory::bytes(bytes)));
    let time = time.map_or_else(
        || "more than can be judged in two seconds".into(),
        |time| format!("about {} s on this machine, by its first steps", significant(time.as_secs_f64(), 2)),
    );
    format!("  memory      about {memory}{of}\n  time        {time}\n")
}

/// How long the whole would take on the clock, judged by a trial of a moment, of which nothing is kept. None when it is over in
/// no time, or not begun in two seconds.
fn time_needed(mut simulation: Box<dyn Simulation>, end: f64) -> Option<Duration> {
    let (sender, receiver) = mpsc::channel();
    thread::spawn(move || {
        let (start, clock) = (simulation.time(), Instant::now());
        let mut step = 1e-4 * (end - start);
        while clock.elapsed() < TRIAL && simulation.time() < end {
            if simulation.advance((simulation.time() + step).min(end)).is_err() {
                break;
            }
            step *= 1.5;
        }
        let share = (simulation.time() - start) / (end - start);
        // Nobody may be waiting any more.
        let _ = sender.send(clock.elapsed().as_secs_f64() / share);
    });
    let seconds = receiver.recv_timeout(PATIENCE).ok()?;
    Duration::try_from_secs_f64(seconds).ok()
}

fn explain(scenario: &Scenario, engine: &str, end: f64, cost: &str) -> String {
    let mut out = format!("{}\n{}\n\n", scenario.title(), scenario.summary());
    // Writing into a string cannot fail.
    let _ = writeln!(out, "  experiment  {}\n  engine      {engine}", scenario.name());
    let _ = writeln!(out, "  seed        {}\n  duration    {}", scenario.settings.seed, significant(end, 6));
    out += cost;
    out.push('\n');
    if scenario.parameters().next().is_none() {
        return out + "Valid. Nothing was written.\n";
    }
    let head = ["parameter", "value", "", "accepts", "meaning"].map(String::from).to_vec();
    let rows = scenario.parameters().map(|(parameter, value, given)| row(parameter, value, given));
    let rows: Vec<Vec<String>> = std::iter::once(head).chain(rows).collect();
    out += &table(&[Align::Left, Align::Right, Align::Left, Align::Left, Align::Left], &rows);
    out + "\nValid. Nothing was written.\n"
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
