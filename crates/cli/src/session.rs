//! A run on its way: advanced, pictured, kept in checkpoints, and written down.

use std::fs;
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use corpuscle_core::Failure;
use corpuscle_experiments::Simulation;
use corpuscle_io::checkpoint::{Policy, Run};
use corpuscle_io::number::significant;
use corpuscle_io::trajectory::Plan;
use corpuscle_io::write::file_stem;
use corpuscle_io::{Ending, Folder, Origin, Picture, Record, Refusal, Scenario, Trajectory, WriteError, csv, report, summary};
use corpuscle_scene::Palette;

use crate::console;
use crate::keeper::Keeper;
use crate::picture::{Artist, Draws, Size};
use crate::progress::Progress;
use crate::signal::Stop;
use crate::trouble::Trouble;
use crate::verdict::{checks, verdict};

/// Size of the pictures in the report.
const SIZE: Size = Size { width: 1120, height: 720 };
/// They are shown at about half that width.
const SCALE: f32 = 1.6;
/// Bytes of a picture at most: those of its pixels.
const LARGEST: u64 = 4 * SIZE.width as u64 * SIZE.height as u64;
/// Looks at the system between start and end, for the trails.
const LOOKS: u32 = 600;

/// The file in the folder of a run that says what to run.
pub(crate) const SCENARIO: &str = "scenario.toml";

/// A run and all that belongs to it.
pub(crate) struct Session {
    pub(crate) scenario: Scenario,
    pub(crate) simulation: Box<dyn Simulation>,
    pub(crate) folder: Folder,
    pub(crate) keeper: Keeper,
    trajectory: Option<Trajectory>,
    pub(crate) quiet: bool,
    /// Time on the clock spent before.
    wall: Duration,
    /// Moments worth a picture that have passed, and the pictures.
    moments: usize,
    pictures: Vec<Picture>,
}

/// Why the way to the end ends.
enum Halt {
    Signal,
    Failure(Failure),
    Trouble(Trouble),
}

impl From<Failure> for Halt {
    fn from(failure: Failure) -> Self {
        Self::Failure(failure)
    }
}

impl Session {
    /// A run that begins: in its folder there is then its scenario, and nothing of another run that could be taken for its own.
    pub(crate) fn begin(
        scenario: Scenario,
        simulation: Box<dyn Simulation>,
        folder: Folder,
        policy: Policy,
        trajectory: Option<Plan>,
        quiet: bool,
    ) -> Result<Self, Trouble> {
        folder.clear()?;
        let (scenario, start) = scenario.portable();
        if let Some((name, bytes)) = start {
            folder.write(name, &bytes)?;
        }
        let keeper = Keeper::new(folder.path(), policy, simulation.as_ref(), None);
        let trajectory = trajectory.map(|plan| Trajectory::begin(folder.path(), plan)).transpose()?;
        let text = scenario.to_toml();
        let (moments, pictures) = (0, vec![]);
        let mut session = Self { scenario, simulation, folder, keeper, trajectory, quiet, wall: Duration::ZERO, moments, pictures };
        if session.trajectory.is_some() && session.keeper.is_on() {
            // The scenario does not say that there is a trajectory: whatever kills the run, its first checkpoint does.
            session.keep(Duration::ZERO, session.simulation.time())?;
        }
        session.folder.write(SCENARIO, text.as_bytes())?;
        Ok(session)
    }

    /// A run that goes on from a checkpoint, which the simulation has taken up. Pictures that are no longer there are left out.
    pub(crate) fn go_on(
        scenario: Scenario,
        simulation: Box<dyn Simulation>,
        folder: Folder,
        run: Run,
        policy: Policy,
        quiet: bool,
    ) -> Result<Self, Trouble> {
        let keeper = Keeper::new(folder.path(), policy, simulation.as_ref(), Some(run.time));
        let trajectory = run.trajectory.map(|kept| Trajectory::again(folder.path(), kept)).transpose();
        let trajectory = trajectory.map_err(|invalid| Refusal::new(Origin::Unknown, invalid))?;
        let of_file = |(index, (time, caption)): (usize, (f64, String))| {
            Some(Picture { time, caption, png: picture(&folder.path().join(file_of_picture(index)))? })
        };
        let pictures = run.pictures.into_iter().enumerate().filter_map(of_file).collect();
        let wall = Duration::try_from_secs_f64(run.wall).unwrap_or_default();
        Ok(Self { scenario, simulation, folder, keeper, trajectory, quiet, wall, moments: run.moments, pictures })
    }

    /// Runs to the end, or as far as it gets, and writes everything down.
    pub(crate) fn conduct(mut self) -> Result<ExitCode, Trouble> {
        let mut artist = if self.keeper.policy().pictures { artist() } else { None };
        let end = self.end();
        let mut progress = Progress::new(self.simulation.as_ref(), end, self.quiet, Stop::listen());
        let way = self.go(&mut progress, end, &mut artist);
        progress.finish();
        let ending = match way {
            Ok(()) => Ending::Finished,
            Err(Halt::Signal) => {
                if self.keeper.is_on() {
                    self.keep(progress.wall(), progress.now())?;
                }
                Ending::Interrupted
            }
            Err(Halt::Failure(failure)) => Ending::Failed(failure),
            Err(Halt::Trouble(trouble)) => return Err(trouble),
        };
        self.take(&mut artist)?;
        if let Some(trajectory) = &mut self.trajectory {
            trajectory.flush().map_err(|error| self.keeper.lost(error, self.folder.path()))?;
        }
        let (pictures, wall) = (std::mem::take(&mut self.pictures), self.wall + progress.wall());
        let record = Record { pictures, ..Record::of(&self.scenario, self.simulation.as_ref(), end, ending, wall) };
        save(&record, &self.folder).map_err(|error| self.keeper.lost(error, self.folder.path()))?;
        self.conclude(&record)
    }

    /// Physical time at which it ends.
    fn end(&self) -> f64 {
        self.scenario.duration.unwrap_or_else(|| self.simulation.end())
    }

    /// The way to the end.
    fn go(&mut self, progress: &mut Progress, end: f64, artist: &mut Option<Artist>) -> Result<(), Halt> {
        let mut moments: Vec<f64> = self.simulation.moments().into_iter().filter(|&moment| moment < end).collect();
        moments.sort_by(f64::total_cmp);
        moments.dedup();
        self.film(self.simulation.time()).map_err(Halt::Trouble)?;
        let mut looking = artist.as_mut().is_some_and(|artist| artist.look(self.simulation.as_ref()));
        for look in 1..=LOOKS {
            let to = if look == LOOKS { end } else { end * f64::from(look) / f64::from(LOOKS) };
            while let Some(&moment) = moments.get(self.moments).filter(|&&moment| moment < to) {
                self.advance(progress, moment)?;
                self.take(artist).map_err(Halt::Trouble)?;
                self.moments += 1;
            }
            if to <= self.simulation.time() && look < LOOKS {
                continue;
            }
            self.advance(progress, to)?;
            looking = looking && artist.as_mut().is_some_and(|artist| artist.look(self.simulation.as_ref()));
        }
        self.hold_to_invariants().map_err(Halt::Failure)
    }

    /// Advances to the physical time `to`, with a checkpoint whenever one is due.
    fn advance(&mut self, progress: &mut Progress, to: f64) -> Result<(), Halt> {
        while progress.now() < to {
            if progress.stopped() {
                self.hold_to_invariants()?;
                return Err(Halt::Signal);
            }
            let frame = self.trajectory.as_ref().map_or(f64::INFINITY, Trajectory::next_time);
            progress.slice(self.simulation.as_mut(), to.min(self.keeper.next_time()).min(frame))?;
            self.film(progress.now()).map_err(Halt::Trouble)?;
            if self.keeper.is_due(self.simulation.as_ref(), progress.now()) {
                self.hold_to_invariants()?;
                self.keep(progress.wall(), progress.now()).map_err(Halt::Trouble)?;
            }
        }
        Ok(())
    }

    /// A state that breaks what its own dynamics conserves is neither kept nor reported as a result.
    fn hold_to_invariants(&self) -> Result<(), Failure> {
        let honesty = self.simulation.honesty();
        match honesty.broken() {
            None => Ok(()),
            Some(cause) => Err(Failure { time: self.simulation.time(), particle: None, cause }),
        }
    }

    /// Adds a frame to the trajectory if one is due, now that the simulation has been asked to advance to `time`.
    fn film(&mut self, time: f64) -> Result<(), Trouble> {
        let Some(trajectory) = &mut self.trajectory else { return Ok(()) };
        // The last one may be due at the end but for rounding.
        let last = self.scenario.duration.unwrap_or_else(|| self.simulation.end());
        let now = if time >= last { last * (1.0 + 1e-12) } else { time };
        if trajectory.next_time() > now {
            return Ok(());
        }
        let Some(frame) = self.simulation.frame() else { return Ok(()) };
        trajectory.add(&frame).map_err(|error| self.keeper.lost(error, self.folder.path()))
    }

    /// Writes a checkpoint, and what has been measured so far, after `wall` on the clock, of a simulation that has been asked to
    /// advance to `time`.
    fn keep(&mut self, wall: Duration, time: f64) -> Result<(), Trouble> {
        let (clock, wall) = (Instant::now(), self.wall + wall);
        if let Some(trajectory) = &mut self.trajectory {
            trajectory.flush().map_err(|error| self.keeper.lost(error, self.folder.path()))?;
        }
        let run = Run {
            scenario: self.scenario.to_toml(),
            time: self.simulation.time(),
            wall: wall.as_secs_f64(),
            moments: self.moments,
            pictures: self.pictures.iter().map(|picture| (picture.time, picture.caption.clone())).collect(),
            policy: *self.keeper.policy(),
            trajectory: self.trajectory.as_ref().map(Trajectory::kept),
        };
        let simulation = self.simulation.as_ref();
        let kept = self.keeper.write(&run, simulation, time).and_then(|()| {
            let record = Record::of(&self.scenario, simulation, self.end(), Ending::Running, wall);
            Ok(save_numbers(&record, &self.folder)?)
        });
        self.keeper.took(clock.elapsed());
        kept.map_err(|trouble| match trouble {
            Trouble::Write(error) => self.keeper.lost(error, self.folder.path()),
            trouble => trouble,
        })
    }

    /// Takes a picture, if anybody draws.
    fn take(&mut self, artist: &mut Option<Artist>) -> Result<(), Trouble> {
        match artist.as_mut().map(|artist| artist.picture(self.simulation.as_ref())) {
            Some(Ok(picture)) => {
                let file = file_of_picture(self.pictures.len());
                let written = self.folder.write(&file, &picture.png);
                written.map_err(|error| self.keeper.lost(error, self.folder.path()))?;
                self.pictures.push(picture);
            }
            Some(Err(error)) => console::complain(&format!("a picture is left out: {}", Trouble::from(error))),
            None => {}
        }
        Ok(())
    }

    /// The last words, on the terminal and as exit code.
    fn conclude(&self, record: &Record) -> Result<ExitCode, Trouble> {
        let (name, seed, verdict) = (self.scenario.name(), self.scenario.settings.seed, verdict(record));
        if self.quiet {
            console::print(&format!("{name}, seed {seed}: {verdict}\n"))?;
        } else {
            let seconds = significant(record.wall.as_secs_f64(), 3);
            let report = self.folder.path().join("report.html");
            console::print(&format!("\n{}\n{verdict}, after {seconds} s\n{}\n\n", checks(&record.checks), report.display()))?;
        }
        let folder = self.folder.path().display();
        match &record.ending {
            Ending::Failed(failure) => {
                let last = self.keeper.newest().map_or_else(String::new, |time| {
                    format!("; the last good checkpoint, of t = {}, is kept in {folder}", significant(time, 5))
                });
                Err(Trouble::Stopped(format!("{failure}{last}")))
            }
            Ending::Interrupted | Ending::Running => {
                if self.keeper.newest().is_some() {
                    console::complain(&format!("to go on: corpuscle resume {folder}"));
                }
                Ok(ExitCode::from(1))
            }
            Ending::Finished => {
                self.keeper.finish();
                Ok(if record.checks.iter().all(|check| check.passed) { ExitCode::SUCCESS } else { ExitCode::from(3) })
            }
        }
    }
}

/// Whoever draws; nobody, with the reason and the remedy said, where OpenGL is missing.
fn artist() -> Option<Artist> {
    let artist = Artist::new(SIZE, Palette::Dark).map(|artist| artist.enlarged(SCALE));
    artist.map_err(|error| console::complain(&format!("the pictures are left out: {}", Trouble::from(error)))).ok()
}

fn file_of_picture(index: usize) -> String {
    format!("pictures/{:02}.png", index + 1)
}

/// A picture that was taken before. In a stranger's folder anything may have its name, a link to a private file as well, which
/// the report would take in.
fn picture(path: &Path) -> Option<Vec<u8>> {
    let there = fs::symlink_metadata(path).ok()?;
    let png = (there.is_file() && there.len() <= LARGEST).then(|| fs::read(path))?.ok()?;
    png.starts_with(b"\x89PNG\r\n").then_some(png)
}

/// Writes everything down, the report last: where there is a report, there is all the rest.
fn save(record: &Record, folder: &Folder) -> Result<(), WriteError> {
    save_numbers(record, folder)?;
    folder.write("report.html", report::html(record).as_bytes())
}

/// Series, tables and the summary.
fn save_numbers(record: &Record, folder: &Folder) -> Result<(), WriteError> {
    for chart in &record.charts {
        folder.write(&format!("{}.csv", file_stem(&chart.name)), &csv::chart(chart))?;
    }
    for table in &record.tables {
        // A table may have the name of the chart it goes with.
        let taken = record.charts.iter().any(|chart| file_stem(&chart.name) == file_stem(&table.name));
        let more = if taken { "-table" } else { "" };
        folder.write(&format!("{}{more}.csv", file_stem(&table.name)), &csv::table(table))?;
    }
    folder.write("summary.json", summary::json(record).as_bytes())
}

#[cfg(test)]
mod tests;
