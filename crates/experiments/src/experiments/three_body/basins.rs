//! A map of fates: grains are released at rest (or all with one velocity) from every cell of a rectangle, and each cell is
//! coloured by what becomes of its grain: which star it hits, or that it escapes; the sooner the brighter.
//!
//! The grains fall through the same sky of moving stars, found once to rounding error, in parallel. Some hundred more, released
//! at random and advanced by another integrator, tell whether the map's shares of fates are right: single fates depend on the
//! last digits where the map is a fractal, shares do not.

mod flock;
mod probe;
mod report;
mod sky;

use corpuscle_checkpoint::{Resume, resume};
use corpuscle_core::instructions::Instructions;
use corpuscle_core::{Failure, Invalid, Random};
use corpuscle_observe::{Chart, Check};
use corpuscle_scene::{Body, Camera, Cell, Colouring, Label, Map, Scene};

use super::start::Start;
use crate::{Action, Honesty, Settings, Simulation, Table, ensemble};
use flock::{Fate, Flock, LANES, Ride, Rules};
use probe::Probe;
use sky::{Sky, Stars};

/// Stream of the random places of the probes.
const STREAM: u64 = 0xba51;
/// Grains released at random and followed by another integrator.
const PROBES: usize = 200;
/// Stretches of time handed to all threads together.
const BATCH: usize = 32;
/// A grain this many times the map's half side away may have escaped.
const FAR: f64 = 3.0;

/// The running map.
pub(super) struct Basins {
    start: Start,
    /// Middle and side of the map, and cells along a side.
    centre: [f64; 2],
    side: f64,
    cells: usize,
    stars: Stars,
    /// Row by row from below, eight neighbours each.
    flocks: Vec<Flock>,
    probes: Vec<Probe>,
    /// The fate of each probe's start as the map's own method finds it.
    doubles: Vec<Flock>,
    rules: Rules,
    time: f64,
}

resume!(Basins { values: [flocks, doubles, time], parts: [stars, probes], set_up: [start, centre, side, cells, rules] });

impl Basins {
    pub(super) fn new(settings: &Settings) -> Result<Self, Invalid> {
        let start = Start::new(settings)?.without_dust();
        let pair = |key: &str, value: [f64; 2]| match settings.list(key) {
            [] => Ok(value),
            &[x, y] => Ok([x, y]),
            _ => Err(settings.invalid(key, "two numbers, or none")),
        };
        let (centre, velocity) = (pair("map_centre", [0.0; 2])?, pair("release_velocity", [0.0; 2])?);
        let extent = settings.real("map_extent");
        let side = if extent > 0.0 { extent } else { 2.0 * start.view };
        let cells = settings.whole("resolution");
        let rules = Rules { capture: settings.real("capture_radius"), far: FAR * start.view };
        let stars = Stars::new(&start, 2.0 * start.interval)?;
        let at = std::array::from_fn(|star| start.particles.position[star].0);
        let strength = start.masses().map(|mass| start.constant * mass);
        let flocks = |places: &[[f64; 2]]| -> Vec<Flock> {
            places.chunks(LANES).map(|eight| Flock::released(eight, velocity, &rules, &at, &strength)).collect()
        };
        let place = |axis: usize, cell: usize| centre[axis] + side * ((cell as f64 + 0.5) / cells as f64 - 0.5);
        let row = |row: usize| flocks(&(0..cells).map(|column| [place(0, column), place(1, row)]).collect::<Vec<_>>());
        let mut random = Random::new(settings.seed, STREAM);
        let mut within = |middle: f64| middle + side * (random.uniform() - 0.5);
        let places: Vec<[f64; 2]> = (0..PROBES).map(|_| centre.map(&mut within)).collect();
        Ok(Self {
            probes: places.iter().map(|&place| Probe::new(&start, place, velocity, rules)).collect::<Result<_, _>>()?,
            doubles: flocks(&places),
            flocks: (0..cells).flat_map(row).collect(),
            stars,
            start,
            centre,
            side,
            cells,
            rules,
            time: 0.0,
        })
    }

    /// Fate and time of each cell, row by row from below.
    fn fates(&self) -> impl Iterator<Item = (Fate, f64)> {
        let flocks_in_row = self.cells.div_ceil(LANES);
        let of_flock = move |(index, flock): (usize, &Flock)| {
            let before = index % flocks_in_row * LANES;
            let lanes = LANES.min(self.cells - before);
            (0..lanes).map(|lane| (flock.fate[lane], flock.time[lane])).collect::<Vec<_>>()
        };
        self.flocks.iter().enumerate().flat_map(of_flock)
    }

    /// Takes all grains through some stretches of time.
    fn ride(&mut self, skies: &[Sky]) -> Result<(), Failure> {
        let (rules, instructions) = (self.rules, Instructions::detect());
        let all = |flock: &mut Flock| {
            for sky in skies {
                if !flock.is_open() {
                    break;
                }
                instructions.run(Ride { flock: &mut *flock, sky, rules: &rules });
            }
            Ok(())
        };
        ensemble::for_each(&mut self.flocks, all)?;
        ensemble::for_each(&mut self.doubles, all)?;
        let to = self.stars.time();
        ensemble::for_each(&mut self.probes, |probe| probe.advance(to))
    }

    fn name_of(&self, fate: Fate) -> String {
        match fate {
            Fate::Hit(star) => format!("hits star {}, m = {}", star + 1, self.start.masses()[usize::from(star)]),
            Fate::Escaped => "escapes".into(),
            Fate::Open => "still on its way".into(),
        }
    }
}

impl Simulation for Basins {
    fn state(&self) -> Option<&dyn Resume> {
        Some(self)
    }

    fn state_mut(&mut self) -> Option<&mut dyn Resume> {
        Some(self)
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn end(&self) -> f64 {
        self.start.duration
    }

    fn advance(&mut self, to: f64) -> Result<(), Failure> {
        let mut skies = vec![];
        while let Some(sky) = self.stars.next(to)? {
            skies.push(sky);
            if skies.len() == BATCH {
                self.ride(&skies)?;
                skies.clear();
            }
        }
        self.ride(&skies)?;
        self.time = self.time.max(to);
        Ok(())
    }

    fn draw(&self, scene: &mut Scene) {
        scene.clear();
        let half = 0.5 * self.side;
        let [lower, upper] = [-half, half].map(|shift| self.centre.map(|x| x + shift));
        scene.time = self.stars.time();
        scene.title = "Where dust ends".into();
        scene.caption = self.caption();
        scene.camera = Camera::fit([lower[0], lower[1], 0.0], [upper[0], upper[1], 0.0]);
        let cells = self.fates().map(|(fate, time)| self.cell(fate, time)).collect();
        scene.map = Some(Map { lower, upper, columns: self.cells, cells });
        scene.colouring = Colouring::Species(Fate::ALL[..4].iter().map(|&fate| self.name_of(fate)).collect());
        let within = |r: [f64; 2]| (0..2).all(|axis| lower[axis] <= r[axis] && r[axis] <= upper[axis]);
        for (star, (r, v)) in self.stars.positions().iter().zip(self.stars.velocities()).enumerate() {
            if within(r.0) {
                let (position, velocity) = (r.to_three(), v.to_three());
                scene.bodies.push(Body { position, velocity, time: scene.time, radius: 0.011 * self.side, shade: 7.0 });
                let at = [position[0] + 0.03 * self.side, position[1] + 0.03 * self.side, 0.0];
                scene.labels.push(Label { at, text: (star + 1).to_string(), colour: corpuscle_scene::Colour::Ink });
            }
        }
    }

    fn charts(&self) -> Vec<Chart> {
        let mut charts = vec![self.chart_of_fates()];
        charts.extend(self.chart_of_uncertainty());
        charts
    }

    fn checks(&self) -> Vec<Check> {
        self.verdicts()
    }

    fn honesty(&self) -> Honesty {
        let flocks = self.flocks.iter().chain(&self.doubles);
        Honesty {
            engine: "time-driven, gauss-radau-15 for the stars, Nyström's fourth order for the grains".into(),
            work: self.stars.steps() + flocks.map(|flock| flock.steps).sum::<u64>(),
            work_unit: "steps",
            ..Honesty::default()
        }
    }

    fn tables(&self) -> Vec<Table> {
        self.all_tables()
    }

    fn moments(&self) -> Vec<f64> {
        vec![0.1 * self.end(), 0.3 * self.end()]
    }

    fn refusal(&self, _: Action) -> Option<&'static str> {
        Some("bodies: this is a map of where each start leads")
    }
}

impl Basins {
    /// The sooner the brighter, down to a third, evenly in the logarithm of the time.
    fn cell(&self, fate: Fate, time: f64) -> Cell {
        if fate == Fate::Open {
            return Cell::default();
        }
        let unit = 0.02 * self.end();
        let late = libm::log1p(time / unit) / libm::log1p(self.end() / unit);
        Cell { species: fate.index() as u8, strength: (255.0 * (1.0 - 0.67 * late.min(1.0))) as u8 }
    }

    fn caption(&self) -> String {
        let [one, two, three, escaped, open] = self.shares().map(|share| 100.0 * share);
        format!(
            "stars take {one:.1} %, {two:.1} %, {three:.1} %, {escaped:.1} % escape, {open:.1} % still on their way; bright: soon, dark: late"
        )
    }
}

#[cfg(test)]
mod tests;
