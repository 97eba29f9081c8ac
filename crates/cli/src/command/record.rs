//! `corpuscle record`: a clip at an exact rate of pictures, drawn without a display.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use corpuscle_experiments::Simulation;
use corpuscle_io::number::significant;
use corpuscle_io::{Refusal, Registry, Scenario};
use corpuscle_lab::language::Language;
use corpuscle_render::{Clip, RenderError};

use super::target::{extension, refuse, vacant};
use super::{Subject, physical_time, positive};
use crate::console;
use crate::picture::{Artist, Draws, PaletteName, Size, studio};
use crate::progress::Progress;
use crate::signal::Stop;
use crate::trouble::Trouble;

/// Seconds that a clip lasts unless told otherwise.
const SECONDS: f64 = 12.0;
/// Longest clip: almost an hour at the usual rate, and numbered pictures have five digits.
const MOST: f64 = 100_000.0;
/// Shortest side of a film in H.264 that OpenH264 encodes.
const SMALLEST: u32 = 16;
/// Its longest sides, the shorter first.
const LARGEST: [u32; 2] = [2160, 3840];

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    subject: Subject,
    /// The clip: a name that ends in .mp4 or .gif, or a folder for numbered pictures.
    #[arg(long, value_name = "FILE|DIR")]
    out: PathBuf,
    /// Overwrite a file that is there. A folder is always to be new or empty.
    #[arg(long)]
    force: bool,
    /// Width and height in pixels.
    #[arg(long, allow_hyphen_values = true, default_value = "1280x720")]
    size: Size,
    /// Pictures in a second of the clip.
    #[arg(long, allow_hyphen_values = true, default_value_t = 30.0, value_parser = positive)]
    fps: f64,
    /// Physical time shown in a second of the clip [default: the whole in 12 seconds].
    #[arg(long, allow_hyphen_values = true, value_parser = positive)]
    speed: Option<f64>,
    /// Physical time of the first picture.
    #[arg(long, allow_hyphen_values = true, default_value = "0", value_parser = physical_time)]
    from: f64,
    /// Physical time of the last picture [default: the experiment's end].
    #[arg(long, allow_hyphen_values = true, value_parser = physical_time)]
    to: Option<f64>,
    /// Ground and ink.
    #[arg(long, value_enum, default_value_t)]
    palette: PaletteName,
    /// The whole window, with its panels.
    #[arg(long)]
    panels: bool,
}

pub(crate) fn record(arguments: &Arguments, registry: Registry) -> Result<ExitCode, Trouble> {
    let scenario = arguments.subject.scenario(registry)?;
    check_target(arguments)?;
    let mut simulation = scenario.start()?;
    let plan = Plan::new(arguments, &scenario, simulation.as_ref())?;
    let Size { width, height } = arguments.size;
    let palette = arguments.palette;
    let mut artist: Box<dyn Draws> = if arguments.panels {
        Box::new(studio(registry, scenario.clone(), arguments.size, palette.into(), Language::English)?)
    } else {
        Box::new(Artist::new(arguments.size, palette.into())?)
    };
    let mut clip = Clip::create(&arguments.out, width, height, arguments.fps).map_err(|error| arguments.named(error))?;
    console::print(&format!(
        "{} ({}), seed {}: {} pictures from t = {} to {}\n",
        scenario.title(),
        scenario.name(),
        scenario.settings.seed,
        plan.count,
        significant(plan.from, 5),
        significant(plan.to, 5)
    ))?;
    let mut progress = Progress::new(simulation.as_ref(), plan.to, false, Stop::listen());
    // The way to the first picture is looked at as often as the rest, so that trails reach back.
    let mut before = simulation.time();
    while before < plan.from && artist.look(simulation.as_ref()) {
        before = (before + plan.step).min(plan.from);
        if !progress.advance(simulation.as_mut(), before)? {
            return Err(Trouble::Interrupted("stopped before the first picture; nothing was written".into()));
        }
    }
    for frame in 0..plan.count {
        let arrived = progress.advance(simulation.as_mut(), plan.time(frame))?;
        clip.frame(&artist.draw(simulation.as_ref())?).map_err(|error| arguments.named(error))?;
        if !arrived || progress.stopped() {
            clip.finish().map_err(|error| arguments.named(error))?;
            progress.finish();
            let (frames, count) = (frame + 1, plan.count);
            return Err(Trouble::Interrupted(format!("stopped after {frames} of {count} pictures; the clip holds those")));
        }
    }
    clip.finish().map_err(|error| arguments.named(error))?;
    progress.finish();
    console::print(&format!("{}\n", arguments.out.display()))?;
    Ok(ExitCode::SUCCESS)
}

/// A clip can be put where it is wanted, in a format there is.
fn check_target(arguments: &Arguments) -> Result<(), Refusal> {
    let (out, fps, Size { width, height }) = (arguments.out.display(), arguments.fps, arguments.size);
    let (shorter, longer) = (width.min(height), width.max(height));
    match extension(&arguments.out).as_deref() {
        None | Some("mp4") if fps > 1000.0 => Err(refuse("fps", fps, "at most 1000 pictures in a second")),
        Some("mp4") if shorter < SMALLEST || shorter > LARGEST[0] || longer > LARGEST[1] => {
            let [short, long] = LARGEST;
            let expected =
                format!("sides from {SMALLEST} up to {long}x{short} or {short}x{long}, which is what the encoder can do");
            Err(refuse("size", format!("{width}x{height}"), expected))
        }
        Some("gif") if fps > 50.0 => Err(refuse("fps", fps, "at most 50 pictures in a second, which is what GIF can show")),
        None if arguments.out.is_file() => Err(refuse("out", out, "a name that ends in .mp4 or .gif, or a folder; this is a file")),
        None | Some("mp4" | "gif") => vacant("out", &arguments.out, arguments.force),
        Some("png") => Err(refuse("out", out, "a name that ends in .mp4 or .gif, or a folder; for one picture, view --screenshot")),
        Some(_) => Err(refuse("out", out, "a name that ends in .mp4 or .gif, or a folder")),
    }
}

impl Arguments {
    /// The same trouble under the name the user gave: clips are written under another until they are whole.
    fn named(&self, error: RenderError) -> RenderError {
        let path = self.out.clone();
        match error {
            RenderError::Clip { expected, .. } => RenderError::Clip { path, expected },
            RenderError::Write { source, .. } => RenderError::Write { path, source },
            error => error,
        }
    }
}

/// When there is a picture.
struct Plan {
    from: f64,
    to: f64,
    step: f64,
    count: u64,
}

impl Plan {
    fn new(arguments: &Arguments, scenario: &Scenario, simulation: &dyn Simulation) -> Result<Self, Refusal> {
        let from = arguments.from.max(simulation.time());
        let to = arguments.to.or(scenario.duration).unwrap_or_else(|| simulation.end());
        if to <= from {
            return Err(refuse("to", to, format!("a time after the first picture's, {from}")));
        }
        let step = arguments.speed.unwrap_or((to - from) / SECONDS) / arguments.fps;
        // A last picture that rounding puts a hair after the end belongs to the clip.
        let count = ((to - from) / step * (1.0 + f64::EPSILON * 4.0)).floor() + 1.0;
        if count > MOST {
            let expected =
                format!("a speed at which {} to {} takes at most {MOST} pictures", significant(from, 5), significant(to, 5));
            let speed = arguments.speed.unwrap_or(step * arguments.fps);
            return Err(refuse("speed", significant(speed, 5), expected));
        }
        Ok(Self { from, to, step, count: count as u64 })
    }

    /// The time of a picture.
    fn time(&self, frame: u64) -> f64 {
        // The first picture is at `from` however long the step.
        if frame == 0 { self.from } else { (self.from + frame as f64 * self.step).min(self.to) }
    }
}
