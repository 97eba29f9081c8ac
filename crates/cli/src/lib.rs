//! The `corpuscle` command, as a library: it takes the experiments it offers, so that a program of one's own can offer
//! others (see `examples/own_experiment.rs`).
//!
//! One file a subcommand under `command/`. Exit codes: 0 ran, and all checks passed; 1 could not finish; 2 bad input, and
//! nothing was written; 3 ran, and a check failed.

mod command;
mod console;
mod keeper;
mod memory;
mod picture;
mod progress;
mod session;
mod signal;
mod table;
mod trouble;
mod usage;
mod verdict;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use corpuscle_io::Registry;

use command::{bench, check, export, lab, list, record, resume, run, schema, verify, view};
use trouble::Trouble;

/// A physics laboratory: exact hard-particle dynamics, soft particles, gravity and waves, measured beside theory.
#[derive(Parser)]
#[command(name = "corpuscle", version, propagate_version = true, max_term_width = 110)]
struct Command {
    #[command(subcommand)]
    task: Option<Task>,
}

#[derive(Subcommand)]
enum Task {
    /// List the experiments.
    List(list::Arguments),
    /// Run an experiment or a scenario file, print its checks, and write its report.
    Run(run::Arguments),
    /// Go on with a run that was interrupted, from its newest checkpoint, to the same end to the last bit.
    Resume(resume::Arguments),
    /// Write the particles of a checkpoint into a file for other programs: extended XYZ, LAMMPS dump or GSD.
    Export(export::Arguments),
    /// Open the laboratory: a window with charts, parameters and a notebook. The same as `corpuscle` alone.
    Lab(lab::Arguments),
    /// Watch an experiment or a scenario file in the laboratory's window, or save what the window would show.
    View(view::Arguments),
    /// Record a clip: .mp4, .gif, or a folder of pictures. Needs no display.
    Record(record::Arguments),
    /// Time an engine, and show its physics beside its speed.
    Bench(bench::Arguments),
    /// Validate a scenario file and say what it would run, without running it.
    Check(check::Arguments),
    /// Run experiments over many seeds, and see whether their scores are those of right theory and right error bars.
    Verify(verify::Arguments),
    /// Print the JSON Schema of scenario files, for editors that complete and check them.
    Schema(schema::Arguments),
}

/// Runs the command with the arguments of the process.
///
/// A panic, which is always a fault of the program, ends with exit code 1 after its message.
pub fn main(registry: Registry<'_>) -> ExitCode {
    let outcome = catch_unwind(AssertUnwindSafe(|| match Command::try_parse() {
        Ok(command) => command.obey(registry),
        // What was asked for, help or version, goes to standard output.
        Err(error) if !error.use_stderr() => {
            console::unless_gone(error.print())?;
            Ok(ExitCode::SUCCESS)
        }
        Err(error) => Err(usage::refusal(&error)),
    }));
    match outcome {
        Ok(Ok(code)) => code,
        Ok(Err(trouble)) => {
            console::complain(&trouble.to_string());
            trouble.exit_code()
        }
        Err(_) => {
            console::complain("this is a fault of the program: please report it with the lines above");
            ExitCode::from(1)
        }
    }
}

impl Command {
    fn obey(&self, registry: Registry) -> Result<ExitCode, Trouble> {
        match &self.task {
            None => lab::welcome(registry),
            Some(Task::Lab(arguments)) => lab::lab(arguments, registry),
            Some(Task::List(arguments)) => list::list(arguments, registry),
            Some(Task::Run(arguments)) => run::run(arguments, registry),
            Some(Task::Resume(arguments)) => resume::resume(arguments, registry),
            Some(Task::Export(arguments)) => export::export(arguments, registry),
            Some(Task::View(arguments)) => view::view(arguments, registry),
            Some(Task::Record(arguments)) => record::record(arguments, registry),
            Some(Task::Bench(arguments)) => bench::bench(arguments),
            Some(Task::Check(arguments)) => check::check(arguments, registry),
            Some(Task::Verify(arguments)) => verify::verify(arguments, registry),
            Some(Task::Schema(arguments)) => schema::schema(arguments, registry),
        }
    }
}
