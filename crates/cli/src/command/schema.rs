//! `corpuscle schema`: what a scenario file may hold, for programs.

use std::process::ExitCode;

use clap::Args;
use corpuscle_core::Invalid;
use corpuscle_io::refusal::one_of;
use corpuscle_io::{Origin, Refusal, Registry, schema as schemas};

use crate::console;
use crate::trouble::Trouble;

#[derive(Args)]
pub(crate) struct Arguments {
    /// The files of one experiment, or `free` for systems of one's own [default: all].
    name: Option<String>,
}

pub(crate) fn schema(arguments: &Arguments, registry: Registry) -> Result<ExitCode, Trouble> {
    let schema = match arguments.name.as_deref() {
        None => schemas::all(registry),
        Some("free") => schemas::free(),
        Some(name) => {
            let known = registry.iter().find(|experiment| experiment.name == name);
            schemas::experiment(known.ok_or_else(|| {
                let names = registry.iter().map(|experiment| experiment.name).chain(["free"]);
                Refusal::new(Origin::CommandLine, Invalid::new("schema", name, one_of(name, names)))
            })?)
        }
    };
    console::print(&format!("{schema:#}\n"))?;
    Ok(ExitCode::SUCCESS)
}
