//! `corpuscle record`: a clip at an exact rate of pictures, drawn without a display.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use corpuscle_core::Invalid;
use corpuscle_io::number::significant;
use corpuscle_io::{Origin, Refusal, Registry};
use corpuscle_render::Clip;

use super::{Subject, physical_time, positive};
use crate::console;
use crate::picture::{Artist, PaletteName, Size};
use crate::progress::Progress;
use crate::signal::Stop;
use crate::trouble::Trouble;

/// Seconds that a clip lasts unless told otherwise.
const SECONDS: f64 = 12.0;

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    subject: Subject,
    /// The clip: a name that ends in .mp4 or .gif, or a folder for numbered pictures.
    #[arg(long, value_name = "FILE|DIR")]
    out: PathBuf,
    /// Overwrite a file that is there.
    #[arg(long)]
    force: bool,
    /// Width and height in pixels.
    #[arg(long, default_value = "1280x720")]
    size: Size,
    /// Pictures in a second of the clip.
    #[arg(long, default_value_t = 30.0, value_parser = positive)]
    fps: f64,
    /// Physical time shown in a second of the clip [default: the whole in 12 seconds].
    #[arg(long, value_parser = positive)]
    speed: Option<f64>,
    /// Physical time of the first picture.
    #[arg(long, default_value = "0", value_parser = physical_time)]
    from: f64,
    /// Physical time of the last picture [default: the experiment's end].
    #[arg(long, value_parser = physical_time)]
    to: Option<f64>,
    /// Ground and ink.
    #[arg(long, value_enum, default_value_t)]
    palette: PaletteName,
}

pub(crate) fn record(arguments: &Arguments, registry: Registry) -> Result<ExitCode, Trouble> {
    let scenario = arguments.subject.scenario(registry)?;
    let mut simulation = scenario.start()?;
    let from = arguments.from.max(simulation.time());
    let to = arguments.to.or(scenario.duration).unwrap_or_else(|| simulation.end());
    let refuse = |key: &str, value: String, expected: &str| {
        Trouble::from(Refusal::new(Origin::CommandLine, Invalid::new(key, value, expected)))
    };
    if to <= from {
        return Err(refuse("to", to.to_string(), &format!("a time after the first picture's, {from}")));
    }
    if arguments.out.is_file() && !arguments.force {
        return Err(refuse("out", arguments.out.display().to_string(), "a new file, or --force to overwrite this one"));
    }
    let Size { width, height } = arguments.size;
    let mut artist = Artist::new(arguments.size, arguments.palette.into())?;
    let mut clip = Clip::create(&arguments.out, width, height, arguments.fps)?;
    let step = arguments.speed.unwrap_or((to - from) / SECONDS) / arguments.fps;
    let count = ((to - from) / step).floor() as u64 + 1;
    console::print(&format!(
        "{} ({}), seed {}: {count} pictures from t = {} to {}\n",
        scenario.title(),
        scenario.name(),
        scenario.settings.seed,
        significant(from, 5),
        significant(to, 5)
    ))?;
    let mut progress = Progress::new(simulation.as_ref(), to, false, Stop::listen());
    // The way to the first picture is looked at as often as the rest, so that trails reach back.
    let mut before = simulation.time();
    while before < from && artist.look(simulation.as_ref()) {
        before = (before + step).min(from);
        if !progress.advance(simulation.as_mut(), before)? {
            return Err(Trouble::Interrupted("stopped before the first picture; nothing was written".into()));
        }
    }
    for frame in 0..count {
        let arrived = progress.advance(simulation.as_mut(), from + frame as f64 * step)?;
        clip.frame(&artist.draw(simulation.as_ref())?)?;
        if !arrived || progress.stopped() {
            clip.finish()?;
            progress.finish();
            return Err(Trouble::Interrupted(format!("stopped after {} of {count} pictures; the clip holds those", frame + 1)));
        }
    }
    clip.finish()?;
    progress.finish();
    console::print(&format!("{}\n", arguments.out.display()))?;
    Ok(ExitCode::SUCCESS)
}
