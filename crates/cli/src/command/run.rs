//! `corpuscle run`: an experiment from start to end, its checks on the terminal, its report in a folder.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use corpuscle_core::Failure;
use corpuscle_experiments::Simulation;
use corpuscle_io::number::{plain, rounded, significant};
use corpuscle_io::write::file_stem;
use corpuscle_io::{Ending, Folder, Picture, Record, Registry, Scenario, WriteError, csv, report, summary};
use corpuscle_observe::{Check, Verdict};
use corpuscle_scene::Palette;

use super::{Subject, positive};
use crate::console;
use crate::picture::{Artist, Draws, Size};
use crate::progress::Progress;
use crate::signal::Stop;
use crate::table::{Align, table};
use crate::trouble::Trouble;

/// Size of the pictures in the report.
const SIZE: Size = Size { width: 1120, height: 720 };
/// They are shown at about half that width.
const SCALE: f32 = 1.6;
/// Looks at the system between start and end, for the trails.
const LOOKS: u32 = 600;

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    subject: Subject,
    /// Folder to write into [default: results/NAME, or results/NAME-2, ... when that exists].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Overwrite files in a folder that is not empty.
    #[arg(long, requires = "out")]
    force: bool,
    /// Threads to use [default: all cores]. Results do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// How long to run, as the parameter `duration` where the experiment has one [default: what it needs].
    #[arg(long, value_name = "T", value_parser = positive, allow_hyphen_values = true)]
    duration: Option<f64>,
    /// Leave out the pictures.
    #[arg(long)]
    no_pictures: bool,
    /// Print one line only.
    #[arg(long)]
    quiet: bool,
}

pub(crate) fn run(arguments: &Arguments, registry: Registry) -> Result<ExitCode, Trouble> {
    let mut scenario = arguments.subject.scenario(registry)?;
    if let Some(duration) = arguments.duration {
        scenario.set_duration(duration)?;
    }
    if let Some(threads) = arguments.threads {
        // Fails only when a pool exists already; none does before this line.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build_global();
    }
    let mut simulation = scenario.start()?;
    let folder = match &arguments.out {
        Some(path) => Folder::at(path, arguments.force)?,
        None => Folder::fresh(Path::new("results"), scenario.name())?,
    };
    folder.write("scenario.toml", scenario.to_toml().as_bytes())?;
    let name = scenario.name();
    if !arguments.quiet {
        console::print(&format!("{} ({name}), seed {}\n", scenario.title(), scenario.settings.seed))?;
    }
    let mut artist = if arguments.no_pictures { None } else { artist() };
    let record = conduct(&scenario, simulation.as_mut(), artist.as_mut(), arguments.quiet);
    save(&record, &folder)?;
    let verdict = verdict(&record);
    if arguments.quiet {
        console::print(&format!("{name}, seed {}: {verdict}\n", scenario.settings.seed))?;
    } else {
        let seconds = significant(record.wall.as_secs_f64(), 3);
        let report = folder.path().join("report.html");
        console::print(&format!("\n{}\n{verdict}, after {seconds} s\n{}\n\n", checks(&record.checks), report.display()))?;
    }
    match record.ending {
        Ending::Failed(failure) => Err(failure.into()),
        Ending::Interrupted => Ok(ExitCode::from(1)),
        Ending::Finished if record.checks.iter().all(|check| check.passed) => Ok(ExitCode::SUCCESS),
        Ending::Finished => Ok(ExitCode::from(3)),
    }
}

/// Whoever draws; nobody, with the reason and the remedy said, where OpenGL is missing.
fn artist() -> Option<Artist> {
    let artist = Artist::new(SIZE, Palette::Dark).map(|artist| artist.enlarged(SCALE));
    artist.map_err(|error| console::complain(&format!("the pictures are left out: {}", Trouble::from(error)))).ok()
}

/// Runs the simulation to its end, or as far as it gets, with pictures on the way.
fn conduct<'a>(
    scenario: &'a Scenario,
    simulation: &mut dyn Simulation,
    mut artist: Option<&mut Artist>,
    quiet: bool,
) -> Record<'a> {
    let (start, end) = (simulation.time(), scenario.duration.unwrap_or_else(|| simulation.end()));
    let mut progress = Progress::new(simulation, end, quiet, Stop::listen());
    let mut pictures = vec![];
    let mut take = |artist: &mut Option<&mut Artist>, simulation: &dyn Simulation| match artist
        .as_mut()
        .map(|artist| artist.picture(simulation))
    {
        Some(Ok(picture)) => pictures.push(picture),
        Some(Err(error)) => console::complain(&format!("a picture is left out: {}", Trouble::from(error))),
        None => {}
    };
    let mut moments: Vec<f64> = simulation.moments().into_iter().filter(|&moment| moment < end).collect();
    moments.sort_by(f64::total_cmp);
    moments.dedup();
    let mut moments = moments.into_iter().peekable();
    let mut looking = artist.as_mut().is_some_and(|artist| artist.look(simulation));
    let mut go = || -> Result<bool, Failure> {
        for look in 1..=LOOKS {
            let to = if look == LOOKS { end } else { start + (end - start) * f64::from(look) / f64::from(LOOKS) };
            while let Some(moment) = moments.next_if(|&moment| moment < to) {
                if !progress.advance(simulation, moment)? {
                    return Ok(false);
                }
                take(&mut artist, simulation);
            }
            if !progress.advance(simulation, to)? {
                return Ok(false);
            }
            looking = looking && artist.as_mut().is_some_and(|artist| artist.look(simulation));
        }
        Ok(true)
    };
    let ending = match go() {
        Ok(true) => Ending::Finished,
        Ok(false) => Ending::Interrupted,
        Err(failure) => Ending::Failed(failure),
    };
    take(&mut artist, simulation);
    progress.finish();
    Record { pictures, ..Record::of(scenario, simulation, end, ending, progress.wall()) }
}

/// Writes everything down, the report last: where there is a report, there is all the rest.
fn save(record: &Record, folder: &Folder) -> Result<(), WriteError> {
    for chart in &record.charts {
        folder.write(&format!("{}.csv", file_stem(&chart.name)), &csv::chart(chart))?;
    }
    for table in &record.tables {
        // A table may have the name of the chart it goes with.
        let taken = record.charts.iter().any(|chart| file_stem(&chart.name) == file_stem(&table.name));
        let more = if taken { "-table" } else { "" };
        folder.write(&format!("{}{more}.csv", file_stem(&table.name)), &csv::table(table))?;
    }
    for (index, Picture { png, .. }) in record.pictures.iter().enumerate() {
        folder.write(&format!("pictures/{:02}.png", index + 1), png)?;
    }
    folder.write("summary.json", summary::json(record).as_bytes())?;
    folder.write("report.html", report::html(record).as_bytes())
}

fn verdict(record: &Record) -> String {
    let (passed, all) = (record.passed(), record.checks.len());
    let checks =
        if passed == all { format!("all {all} checks passed") } else { format!("{} of {all} checks failed", all - passed) };
    match record.ending {
        Ending::Finished => checks,
        Ending::Interrupted => format!("interrupted at t = {}; of what was measured, {checks}", significant(record.time, 5)),
        Ending::Failed(_) => {
            format!("could not be finished; of what was measured until t = {}, {checks}", significant(record.time, 5))
        }
    }
}

/// The checks as a table.
fn checks(checks: &[Check]) -> String {
    let head = ["", "quantity", "measured", "expected", "z"].map(String::from).to_vec();
    let rows = checks.iter().map(|check| {
        let unit = if check.unit.is_empty() { String::new() } else { format!(" {}", check.unit) };
        let sign = match check.verdict {
            Verdict::Agreement => "",
            Verdict::AtMost => "≤ ",
            Verdict::AtLeast => "≥ ",
        };
        vec![
            if check.passed { "✓" } else { "✗" }.into(),
            check.quantity.clone(),
            match check.verdict {
                Verdict::Agreement => plain(&rounded(check.measured, check.standard_error)),
                Verdict::AtMost | Verdict::AtLeast => significant(check.measured, 3),
            } + &unit,
            format!("{sign}{}{unit}", significant(check.expected, if check.verdict == Verdict::Agreement { 6 } else { 3 })),
            check.z.map(|z| format!("{z:+.2}")).unwrap_or_default(),
        ]
    });
    let rows: Vec<Vec<String>> = std::iter::once(head).chain(rows).collect();
    table(&[Align::Left, Align::Left, Align::Right, Align::Right, Align::Right], &rows)
}
