//! `corpuscle export`: the particles of a checkpoint for other programs.

use std::fs::OpenOptions;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use corpuscle_io::number::significant;
use corpuscle_io::trajectory::{EXPECTED, Format};
use corpuscle_io::{Registry, WriteError};

use super::resume::{newest_good, of_run};
use super::target::{refuse, vacant};
use crate::console;
use crate::session::SCENARIO;
use crate::trouble::Trouble;

#[derive(Args)]
pub(crate) struct Arguments {
    /// Folder of a run that has checkpoints, or one of its checkpoints.
    #[arg(value_name = "FOLDER|CHECKPOINT")]
    path: PathBuf,
    /// The file: extended XYZ (.xyz), LAMMPS dump (.dump) or GSD (.gsd).
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Overwrite a file that is there.
    #[arg(long)]
    force: bool,
}

pub(crate) fn export(arguments: &Arguments, registry: Registry) -> Result<ExitCode, Trouble> {
    let out = &arguments.out;
    let format = Format::of(out).ok_or_else(|| refuse("out", out.display(), EXPECTED))?;
    vacant("out", out, arguments.force)?;
    let (folder, files) = of_run(&arguments.path);
    let Some((checkpoint, _, simulation)) = newest_good(&files, registry, &folder.join(SCENARIO)) else {
        let expected = "a checkpoint that can be used, or the folder of a run that has one";
        return Err(refuse("export", arguments.path.display(), expected).into());
    };
    let Some(frame) = simulation.frame() else {
        let expected = "a run of particles: this experiment has none to show in files";
        return Err(refuse("export", arguments.path.display(), expected).into());
    };
    let mut options = OpenOptions::new();
    // Nothing that came into being meanwhile is overwritten unasked.
    let options = options.read(true).write(true).create(true).truncate(true).create_new(!arguments.force);
    let written = options.open(out).and_then(|mut file| format.write(&mut file, &frame));
    written.map_err(|source| WriteError::System { path: out.clone(), source })?;
    let time = significant(checkpoint.run.time, 5);
    console::print(&format!("{} particles at t = {time}: {}\n", frame.particles.len(), out.display()))?;
    Ok(ExitCode::SUCCESS)
}
