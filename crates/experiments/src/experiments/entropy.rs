//! The growth of entropy: free expansion of a gas and mixing of two, through a partition that opens, and what happens when
//! all velocities are reversed.
//!
//! Coarse-grained configurational entropy over `K` equal cells of the accessible volume (Boltzmann's `k ln W`):
//! `S / k_B = ln(N! / prod n_i!)`, summed over species. In equilibrium the `n_i` are multinomial but for the hard cores,
//! which lower their variance by the reduced compressibility `chi_T = k_B T dn/dP`; expanding `ln n!` to second order,
//! `<S> = <S>_multinomial + (K - 1)(1 - chi_T)/2` for each species-blind gas. The thermodynamic limit of the rise is
//! `N k_B ln(V_2/V_1)` for the expansion and `k_B sum N_s ln(V/V_s)` for the mixing.

mod charts;
mod room;

use corpuscle_checkpoint::{Resume, resume};
use std::f64::consts::LN_2;

use corpuscle_core::{Boundary, Engine, Failure, Invalid, Vector};
use corpuscle_event::EventDriven;
use corpuscle_observe::entropy::{Cells, equilibrium_entropy};
use corpuscle_observe::{Chart, Check, Estimate, Schedule, theory};
use corpuscle_scene::{Colour, Colouring, Label, Region, Scene};

use crate::horizon::precision_horizon;
use crate::tally::Tally;
use crate::{Action, Experiment, Frame, Honesty, Kind, Parameter, Settings, Simulation, drawing, ensemble, gas, hand, peek};
use room::{Process, Room, Sample};

/// The registry's entry.
pub(crate) static EXPERIMENT: Experiment = Experiment {
    name: "entropy",
    title: "The growth of entropy",
    summary: "A partition opens: a gas expands, two gases mix, and the coarse-grained entropy rises to what theory says. \
              Reversed velocities run it back.",
    dimensions: &[2, 3],
    engines: &["event-driven"],
    parameters: PARAMETERS,
    start,
};

static PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "process",
        unit: "",
        help: "What is shown: a gas that expands into the empty half, or two gases that mix. Both are measured.",
        kind: Kind::Choice { default: "expansion", options: &["expansion", "mixing"] },
    },
    gas::DIMENSION,
    Parameter {
        name: "particles",
        unit: "",
        help: "Number of particles in the box.",
        kind: Kind::Whole { default: 160, least: 2, most: 100_000 },
    },
    Parameter {
        name: "packing_fraction",
        unit: "",
        help: "Volume of all particles over that of the whole box; twice as much while the gas is shut in on the left.",
        kind: Kind::Real { default: 0.005, least: 1e-6, most: 0.3 },
    },
    Parameter {
        name: "radius",
        unit: "",
        help: "Radius of every particle.",
        kind: Kind::Real { default: 0.5, least: 1e-3, most: 1e3 },
    },
    Parameter {
        name: "temperature",
        unit: "",
        help: "Temperature k_B T; it sets the pace, and stays as it is in a free expansion of hard particles.",
        kind: Kind::Real { default: 1.0, least: 1e-6, most: 1e6 },
    },
    Parameter {
        name: "hole_width",
        unit: "",
        help: "Width of the hole that opens in the partition; 0 takes the whole partition away.",
        kind: Kind::Real { default: 0.0, least: 0.0, most: 1e6 },
    },
    Parameter {
        name: "cells",
        unit: "",
        help: "Number of cells along the box for the coarse-grained entropy; half as many across. An even number.",
        kind: Kind::Whole { default: 8, least: 2, most: 200 },
    },
    Parameter {
        name: "reverse_at",
        unit: "",
        help: "Time at which all velocities of the room on show are reversed; 0 for never.",
        kind: Kind::Real { default: 50.0, least: 0.0, most: 1e9 },
    },
    Parameter {
        name: "duration",
        unit: "",
        help: "How long the rooms are watched; the second half counts as equilibrium.",
        kind: Kind::Real { default: 1600.0, least: 1e-3, most: 1e9 },
    },
    Parameter {
        name: "replicas",
        unit: "",
        help: "Independent rooms measured for each process; their scatter gives the error bars.",
        kind: Kind::Whole { default: 100, least: 2, most: 10_000 },
    },
];

/// Samples taken of each room in the whole duration.
const SAMPLES: usize = 400;
/// Streams of random numbers: replicas of expansion from 0, of mixing from here, the room on show after both.
const MIXING_STREAM: u64 = 1 << 32;
const SHOWN_STREAM: u64 = 1 << 33;

/// What all rooms have in common.
#[derive(Clone, Debug)]
struct Set<const D: usize> {
    seed: u64,
    particles: usize,
    radius: f64,
    packing_fraction: f64,
    temperature: f64,
    hole_width: f64,
    boundary: Boundary<D>,
    cells_along: usize,
    /// Collisions of a particle per time in the shut-in gas, by Enskog's theory.
    collision_rate: f64,
}

impl<const D: usize> Set<D> {
    fn new(settings: &Settings) -> Result<Self, Invalid> {
        let (particles, radius) = (settings.whole("particles"), settings.real("radius"));
        let packing_fraction = settings.real("packing_fraction");
        let boundary = room::boundary::<D>(particles, radius, packing_fraction);
        let width = boundary.upper[1];
        if width < 2.0 * radius {
            return Err(
                settings.invalid("particles", format!("enough for a box wider than a particle: this one is {width:.3} wide"))
            );
        }
        let hole_width = settings.real("hole_width");
        if hole_width > 0.0 && !(2.0 * radius < hole_width && hole_width <= width) {
            return Err(settings.invalid(
                "hole_width",
                format!("0, or more than a diameter {} and at most the box's width {width:.3}", 2.0 * radius),
            ));
        }
        let cells_along = settings.whole("cells");
        if cells_along % 2 == 1 {
            return Err(settings.invalid("cells", "an even number: half of the cells lie left of the partition"));
        }
        let temperature = settings.real("temperature");
        let density = particles as f64 / boundary.volume();
        let collision_rate = theory::collision_rate::<D>(2.0 * density, 2.0 * radius, temperature, 1.0);
        Ok(Self {
            seed: settings.seed,
            particles,
            radius,
            packing_fraction,
            temperature,
            hole_width,
            boundary,
            cells_along,
            collision_rate,
        })
    }

    /// Equal cells over the volume that the centres can reach.
    fn cells(&self) -> Cells<D> {
        let mut sides = [(self.cells_along / 2).max(1); D];
        sides[0] = self.cells_along;
        Cells::new(&self.boundary, self.radius, sides)
    }

    /// Reduced compressibility `chi_T` of the gas at a packing fraction: the variance of counts over that of an ideal gas.
    fn compressibility(packing_fraction: f64) -> f64 {
        theory::reduced_compressibility::<D>(packing_fraction)
    }

    /// Number of particles of each species, and how many fill the cells they are confined to at the start.
    fn species(&self, process: Process) -> Vec<usize> {
        match process {
            Process::Expansion => vec![self.particles],
            Process::Mixing => vec![self.particles.div_ceil(2), self.particles / 2],
        }
    }

    /// Expected rise of the coarse-grained entropy from behind the partition to equilibrium.
    ///
    /// The correction for hard cores belongs to the total count; a species that shares the cells with another carries its
    /// fraction `x` of it: `Var n_s = n_s (1 - x (1 - chi_T))`.
    fn expected_rise(&self, process: Process) -> f64 {
        let cells = self.cells().len();
        let species = self.species(process);
        let (before, after) = (2.0 * self.packing_fraction, self.packing_fraction);
        let start_packing = if process == Process::Expansion { before } else { after };
        let correction =
            |cells: usize, share: f64, packing: f64| 0.5 * (cells as f64 - 1.0) * share * (1.0 - Self::compressibility(packing));
        species
            .iter()
            .map(|&count| {
                let share = count as f64 / self.particles as f64;
                let end = equilibrium_entropy(count as u64, cells).0 + correction(cells, share, after);
                let start = equilibrium_entropy(count as u64, cells / 2).0 + correction(cells / 2, 1.0, start_packing);
                end - start
            })
            .sum()
    }
}

fn start(settings: &Settings) -> Result<Box<dyn Simulation>, Invalid> {
    Ok(match settings.word("dimension") {
        "3" => Box::new(Entropy::<3>::new(settings)?),
        _ => Box::new(Entropy::<2>::new(settings)?),
    })
}

/// The running experiment.
struct Entropy<const D: usize> {
    set: Set<D>,
    duration: f64,
    schedule: Schedule,
    time: f64,
    times: Vec<f64>,
    replicas: Vec<Room<D>>,
    shown: Room<D>,
    echo: Option<Echo<D>>,
    /// Somebody has done more to the room on show than turn it round: it says nothing of conservation any more.
    touched: bool,
}

/// The way out of the room on show, remembered, and how far the way back strays from it.
#[derive(serde::Serialize, serde::Deserialize)]
struct Echo<const D: usize> {
    /// Sample at which the velocities are reversed.
    turn: usize,
    /// Positions at each sample up to the turn.
    out: Vec<Vec<Vector<D>>>,
    /// Time and largest distance of a particle from its place on the way out.
    errors: Vec<(f64, f64)>,
}

impl<const D: usize> Entropy<D> {
    fn new(settings: &Settings) -> Result<Self, Invalid> {
        let set = Set::<D>::new(settings)?;
        let duration = settings.real("duration");
        let count = settings.whole("replicas") as u64;
        let jobs: Vec<(Process, u64)> = (0..count)
            .map(|replica| (Process::Expansion, replica))
            .chain((0..count).map(|replica| (Process::Mixing, MIXING_STREAM + replica)))
            .collect();
        let replicas = ensemble::build(&jobs, |&(process, stream)| Room::new(&set, process, stream))?;
        let shown_process = if settings.word("process") == "mixing" { Process::Mixing } else { Process::Expansion };
        let mut shown = Room::new(&set, shown_process, SHOWN_STREAM)?;
        shown.tally = Tally::of(set.particles);
        let interval = duration / SAMPLES as f64;
        let reverse_at = settings.real("reverse_at");
        if reverse_at > 0.5 * duration {
            return Err(settings
                .invalid("reverse_at", format!("at most half of the duration {duration}, so that there is time to come back")));
        }
        let turn = (reverse_at / interval).round() as usize;
        let echo = (turn > 0).then(|| Echo { turn, out: vec![shown.places()], errors: vec![] });
        // The rooms took their own first sample when they opened.
        let schedule = Schedule::new(interval).after_start();
        Ok(Self { set, duration, schedule, time: 0.0, times: vec![0.0], replicas, shown, echo, touched: false })
    }

    fn take_sample(&mut self, time: f64) {
        self.times.push(time);
        self.replicas.iter_mut().for_each(Room::sample);
        self.shown.sample();
        let Some(echo) = &mut self.echo else { return };
        let sample = self.times.len() - 1;
        if sample <= echo.turn {
            echo.out.push(self.shown.places());
            if sample == echo.turn {
                self.shown.engine.reverse_velocities();
            }
        } else if let Some(mirror) = (2 * echo.turn).checked_sub(sample) {
            let places = self.shown.places();
            let error = places.iter().zip(&echo.out[mirror]).map(|(a, b)| (*a - *b).norm()).fold(0.0, f64::max);
            echo.errors.push((time, error));
        }
    }

    fn rooms(&self, process: Process) -> impl Iterator<Item = &Room<D>> {
        self.replicas.iter().filter(move |room| room.process == process)
    }

    /// First sample that counts as equilibrium.
    const fn settled() -> usize {
        SAMPLES / 2
    }

    /// One number for each replica: the mean of `quantity` over the samples in equilibrium.
    fn settled_means(&self, process: Process, quantity: impl Fn(&Sample) -> f64) -> Vec<f64> {
        self.rooms(process)
            .map(|room| {
                let samples = &room.samples[Self::settled()..];
                samples.iter().map(&quantity).sum::<f64>() / samples.len() as f64
            })
            .collect()
    }

    /// Mean over replicas and its error at each sampling time.
    fn curve(&self, process: Process, quantity: impl Fn(&Room<D>, &Sample) -> f64) -> Vec<(f64, f64, f64)> {
        let rooms: Vec<&Room<D>> = self.rooms(process).collect();
        self.times
            .iter()
            .enumerate()
            .map(|(k, &time)| {
                let values: Vec<f64> = rooms.iter().map(|room| quantity(room, &room.samples[k])).collect();
                let estimate = Estimate::from_replicas(&values);
                (time, estimate.mean, estimate.standard_error)
            })
            .collect()
    }

    fn rise_check(&self, process: Process) -> Check {
        let start: Vec<f64> = self.rooms(process).map(|room| room.samples[0].entropy).collect();
        let end = self.settled_means(process, |sample| sample.entropy);
        let rises: Vec<f64> = end.iter().zip(&start).map(|(a, b)| a - b).collect();
        let (name, limit) = match process {
            Process::Expansion => ("entropy of free expansion ΔS", "N k ln(V2/V1)"),
            Process::Mixing => ("entropy of mixing ΔS", "k sum N_s ln(V/V_s)"),
        };
        Estimate::from_replicas(&rises)
            .check(
                name,
                self.set.expected_rise(process),
                format!(
                    "ln(N!/prod n_i!) over {} cells, multinomial with hard-core correction; {limit} = {:.2} for N and K to infinity",
                    self.set.cells().len(),
                    self.set.particles as f64 * LN_2
                ),
            )
            .with_unit("k_B")
    }
}

resume!(Entropy<const D> {
    values: [schedule, time, times, echo],
    parts: [replicas, shown],
    set_up: [set, duration, touched],
});

impl<const D: usize> Simulation for Entropy<D> {
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
        self.duration
    }

    fn advance(&mut self, to: f64) -> Result<(), Failure> {
        while let Some(time) = self.schedule.due(to) {
            ensemble::for_each(&mut self.replicas, |room| room.advance(time))?;
            self.shown.advance(time)?;
            self.take_sample(time);
        }
        self.shown.advance(to)?;
        self.time = to;
        Ok(())
    }

    fn draw(&self, scene: &mut Scene) {
        scene.clear();
        let room = &self.shown;
        drawing::add_event_driven(scene, &room.engine, &room.tally, room.opened(), |i| f64::from(room.species[i]));
        scene.colouring = match room.process {
            Process::Expansion => Colouring::Uniform(Colour::Accent(0)),
            Process::Mixing => Colouring::Species(vec!["started left".into(), "started right".into()]),
        };
        let count = self.set.particles;
        let middle = 0.5 * self.set.boundary.upper[0];
        let left = (0..count).filter(|&i| room.engine.position(i)[0] < middle).count();
        if D == 2 {
            let height = self.set.boundary.upper[1];
            scene.regions.push(Region { lower: [0.0, 0.0], upper: [middle, height], colour: Colour::Tint(0) });
            for (x, number) in [(0.5 * middle, left), (1.5 * middle, count - left)] {
                scene.labels.push(Label { at: [x, 0.045 * height, 0.0], text: number.to_string(), colour: Colour::Ink });
            }
        }
        let sample = room.samples.last().map_or(0.0, |sample| sample.entropy - room.samples[0].entropy);
        scene.title = EXPERIMENT.title.into();
        scene.caption = format!(
            "{left} left, {} right   S − S₀ = {sample:.1} k_B (equilibrium {:.1})",
            count - left,
            self.set.expected_rise(room.process)
        );
    }

    fn frame(&self) -> Option<Frame> {
        let room = &self.shown;
        let names: &[&str] = match room.process {
            Process::Expansion => &["particles"],
            Process::Mixing => &["started left", "started right"],
        };
        let species = room.species.iter().map(|&species| if names.len() > 1 { species } else { 0 });
        Some(Frame::of_hard(&room.engine, room.opened(), names).with_species(species))
    }

    fn charts(&self) -> Vec<Chart> {
        let other = if self.shown.process == Process::Expansion { Process::Mixing } else { Process::Expansion };
        let mut charts = vec![self.entropy_chart(self.shown.process), self.entropy_chart(other), self.left_chart()];
        charts.extend(self.fluctuation_chart());
        charts.extend(self.echo_chart());
        charts
    }

    fn checks(&self) -> Vec<Check> {
        let mut checks = vec![];
        let count = self.set.particles as f64;
        // A hole lets the gas through slowly: what is not in equilibrium is not held against it.
        let settled = self.times.len() > SAMPLES && self.set.hole_width == 0.0;
        if settled {
            checks.push(self.rise_check(Process::Expansion));
            checks.push(self.rise_check(Process::Mixing));
            let share = self.settled_means(Process::Expansion, |sample| sample.left as f64 / count);
            checks.push(Estimate::from_replicas(&share).check("share in the left half", 0.5, "equal accessible volumes"));
            let variance =
                self.settled_means(Process::Expansion, |sample| (sample.left as f64 - 0.5 * count).powi(2) / (0.25 * count));
            let compressibility = Set::<D>::compressibility(self.set.packing_fraction);
            checks.push(Estimate::from_replicas(&variance).check(
                "variance of the left count over N/4",
                compressibility,
                "binomial times the reduced compressibility of the gas",
            ));
        }
        if let Some(echo) = self.echo.as_ref().filter(|echo| echo.errors.len() == echo.turn)
            && let Some(&(time, error)) = echo.errors.last()
        {
            checks.push(Check::at_most(
                "largest distance from the start after reversal",
                error,
                self.set.radius,
                format!("mechanics is reversible: at t = {time:.1} every particle is back, to less than its own radius"),
            ));
            let back = &self.shown.samples[2 * echo.turn];
            let rise = (back.entropy - self.shown.samples[0].entropy).abs();
            checks.push(
                Check::at_most("entropy left over after reversal", rise, 0.0, "the same cells hold the same numbers again")
                    .with_unit("k_B"),
            );
        }
        let honesty = self.honesty();
        if let Some(drift) = honesty.energy_drift {
            checks.push(Check::at_most("relative energy drift", drift, 1e-11, "elastic collisions, double precision"));
        }
        checks
    }

    fn honesty(&self) -> Honesty {
        let rooms = || self.replicas.iter().chain((!self.touched).then_some(&self.shown));
        let drift = |room: &Room<D>| (room.engine.kinetic_energy() / room.initial_energy - 1.0).abs();
        let overlap = |engine: &EventDriven<D>| engine.boundary().largest_overlap(&engine.snapshot()) / (2.0 * self.set.radius);
        Honesty {
            engine: "event-driven".into(),
            work: rooms().map(|room| room.engine.counts().collisions).sum(),
            work_unit: "collisions",
            energy_drift: Some(rooms().map(drift).fold(0.0, f64::max)),
            largest_overlap: Some(rooms().map(|room| overlap(&room.engine)).fold(0.0, f64::max)),
            rejected_events: Some(rooms().map(|room| room.engine.counts().stale).sum()),
            precision_horizon: precision_horizon(&self.shown.engine),
            ..Honesty::default()
        }
    }

    fn next_event(&self) -> Option<f64> {
        peek::next_contact(&self.shown.engine, 1.5 * self.duration).map(|time| time - self.shown.opened())
    }

    fn moments(&self) -> Vec<f64> {
        match &self.echo {
            Some(echo) => {
                let turn = echo.turn as f64 * self.duration / SAMPLES as f64;
                vec![0.0, 0.3 * turn, turn, 1.7 * turn, 2.0 * turn]
            }
            None => vec![0.0, 0.05 * self.duration, 0.2 * self.duration],
        }
    }

    fn act(&mut self, action: Action) -> Result<(), Invalid> {
        hand::on_number(&mut self.shown.engine, action)?;
        self.touched |= action != Action::Reverse;
        // A hand on the system ends the comparison with the remembered way.
        self.echo = None;
        Ok(())
    }
}
