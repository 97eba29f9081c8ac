//! The growth of entropy: a partition opens and a gas expands or two gases mix; a gas leaks through a hole; all velocities are
//! reversed; few particles come back by themselves; speeds relax to Maxwell's; a demon sits at the hole.
//!
//! Every process is mechanics and nothing else, in a box twice as long as wide. What is measured and what theory says of it
//! stands with each: `opening`, `effusion`, `echo`, `recurrence`, `relaxation`, `demon`.

mod charts;
mod demon;
mod echo;
mod effusion;
mod opening;
mod recurrence;
mod relaxation;
mod room;

use corpuscle_core::{Boundary, Hole, Invalid, Partition, Random};
use corpuscle_observe::entropy::Cells;
use corpuscle_observe::theory;

use crate::gas;
use crate::study::Vessel;
use crate::{Experiment, Kind, Parameter, Settings, Simulation, Situation};
use opening::Entropy;
use room::Process;

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

const PROCESSES: &[Situation] = &[
    Situation::new("expansion", &[&["perturbations", "start", "rule"]]),
    Situation::new("mixing", &[&["perturbations", "start", "rule"]]),
    Situation::new("effusion", &[&["cells", "reverse_at", "perturbations", "start", "rule"]]),
    Situation::new("echo", &[&["hole_width", "cells", "reverse_at", "start", "rule"]]),
    Situation::new("recurrence", &[&["hole_width", "cells", "reverse_at", "perturbations", "start", "rule"]]),
    Situation::new("relaxation", &[&["hole_width", "cells", "reverse_at", "perturbations", "rule"]]),
    Situation::new("demon", &[&["cells", "reverse_at", "perturbations", "start"]]),
];

static PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "process",
        unit: "",
        help: "What happens: free expansion or mixing (both are measured, one is shown), effusion through a hole, Loschmidt's echo, \
               recurrence of few particles, relaxation of speeds (Boltzmann's H), Maxwell's demon.",
        kind: Kind::Situation { default: "expansion", options: PROCESSES },
    },
    gas::DIMENSION,
    Parameter {
        name: "particles",
        unit: "",
        help: "Number of particles in the box; recurrence takes every number from 2 up to this one or 10.",
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
        help: "Width of the hole that opens in the partition; 0 takes the whole partition away, and for effusion and the demon \
               stands for a fifth of it.",
        kind: Kind::Real { default: 0.0, least: 0.0, most: 1e6 },
    },
    Parameter {
        name: "cells",
        unit: "",
        help: "Number of cells along the box for the coarse-grained entropy; half as many across. An even number. Half, twice and \
               four times as many are shown beside.",
        kind: Kind::Whole { default: 8, least: 2, most: 200 },
    },
    Parameter {
        name: "reverse_at",
        unit: "",
        help: "Time at which all velocities of the room on show are reversed, in expansion and mixing; 0 for never.",
        kind: Kind::Real { default: 50.0, least: 0.0, most: 1e9 },
    },
    Parameter {
        name: "perturbations",
        unit: "",
        help: "Echo: how much velocities are disturbed before the reversal, in thermal speeds; the reversal without disturbance is \
               always among them.",
        kind: Kind::List { default: &[1e-12, 1e-8, 1e-4], least: 1e-15, most: 1e-1, longest: 6 },
    },
    Parameter {
        name: "start",
        unit: "",
        help: "Relaxation: what is shown, a gas of equal speeds or one of two temperatures. Both are measured.",
        kind: Kind::Choice { default: "equal-speeds", options: &["equal-speeds", "two-temperatures"] },
    },
    Parameter {
        name: "rule",
        unit: "",
        help: "Demon: whom it lets pass to the right. All of them makes a pressure; only the fast, and only the slow to the left, \
               a difference of temperatures.",
        kind: Kind::Choice { default: "all", options: &["all", "fast"] },
    },
    Parameter {
        name: "duration",
        unit: "",
        help: "How long the rooms are watched; the second half counts as equilibrium. 0 for as long as the process needs.",
        kind: Kind::Real { default: 0.0, least: 0.0, most: 1e9 },
    },
    Parameter {
        name: "replicas",
        unit: "",
        help: "Independent rooms measured for each process; their scatter gives the error bars.",
        kind: Kind::Whole { default: 100, least: 2, most: 10_000 },
    },
];

fn start(settings: &Settings) -> Result<Box<dyn Simulation>, Invalid> {
    match settings.word("dimension") {
        "3" => start_in::<3>(settings),
        _ => start_in::<2>(settings),
    }
}

fn start_in<const D: usize>(settings: &Settings) -> Result<Box<dyn Simulation>, Invalid> {
    let process = settings.word("process");
    if process == "recurrence" {
        return Ok(Box::new(recurrence::start::<D>(settings)?));
    }
    let set = Set::<D>::new(settings)?;
    Ok(match process {
        "effusion" => Box::new(effusion::start(set, settings)?),
        "echo" => Box::new(echo::start(set, settings)?),
        "relaxation" => Box::new(relaxation::start(set, settings)?),
        "demon" => Box::new(demon::start(set, settings)?),
        _ => Box::new(Entropy::new(set, settings)?),
    })
}

/// Collisions per particle behind the partition before anything is measured: the start is an equilibrium, not a lattice.
const COLLISIONS_BEFORE: f64 = 15.0;

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
        Self::of(settings, settings.whole("particles"))
    }

    fn of(settings: &Settings, particles: usize) -> Result<Self, Invalid> {
        let radius = settings.real("radius");
        let packing_fraction = settings.real("packing_fraction");
        let boundary = room::boundary::<D>(particles, radius, packing_fraction);
        let width = boundary.upper[1];
        if width < 2.0 * radius {
            return Err(
                settings.invalid("particles", format!("enough for a box wider than a particle: this one is {width:.3} wide"))
            );
        }
        let hole_width = settings.real("hole_width");
        let read = |key: &str| settings.idle_under(key).is_none();
        if read("hole_width") && hole_width > 0.0 && !(2.0 * radius < hole_width && hole_width <= width) {
            return Err(settings.invalid(
                "hole_width",
                format!("0, or more than a diameter {} and at most the box's width {width:.3}", 2.0 * radius),
            ));
        }
        let cells_along = settings.whole("cells");
        if read("cells") && cells_along % 2 == 1 {
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

    /// Equal cells over the volume that the centres can reach, so many along the box.
    fn cells(&self, along: usize) -> Cells<D> {
        let mut sides = [(along / 2).max(1); D];
        sides[0] = along;
        Cells::new(&self.boundary, self.radius, sides)
    }

    /// Reduced compressibility `chi_T` of the gas at a packing fraction: the variance of counts over that of an ideal gas.
    fn compressibility(packing_fraction: f64) -> f64 {
        theory::reduced_compressibility::<D>(packing_fraction)
    }

    fn thermal_speed(&self) -> f64 {
        self.temperature.sqrt()
    }

    /// Where the partition stands.
    fn middle(&self) -> f64 {
        0.5 * self.boundary.upper[0]
    }

    /// Time in which a thermal particle crosses half of the box.
    fn crossing(&self) -> f64 {
        self.boundary.upper[1] / self.thermal_speed()
    }

    /// Number of particles of each species.
    fn species(&self, process: Process) -> Vec<usize> {
        match process {
            Process::Expansion => vec![self.particles],
            Process::Mixing => vec![self.particles.div_ceil(2), self.particles / 2],
        }
    }

    /// The duration asked for, or this one.
    fn duration(settings: &Settings, automatic: f64) -> f64 {
        let given = settings.real("duration");
        if given > 0.0 { given } else { automatic }
    }

    /// A plate in the middle, with a hole in its own middle, or without.
    fn plate(&self, hole_width: Option<f64>) -> Partition {
        let centre = 0.5 * (self.boundary.lower[1] + self.boundary.upper[1]);
        let half = hole_width.map(|width| 0.5 * width);
        let hole = half.map(|half| Hole { along: 1, from: centre - half, to: centre + half });
        Partition { hole, ..Partition::new(0, self.middle()) }
    }

    /// The hole asked for, or a fifth of the plate.
    fn hole(&self, settings: &Settings) -> Result<f64, Invalid> {
        let width = if self.hole_width > 0.0 { self.hole_width } else { 0.2 * self.boundary.upper[1] };
        if width > 2.0 * self.radius {
            return Ok(width);
        }
        Err(settings
            .invalid("hole_width", format!("more than a diameter {}; a fifth of the plate is too small", 2.0 * self.radius)))
    }

    /// A gas in equilibrium in the whole box, half of it started on either side.
    fn vessel(&self, random: &mut Random) -> Result<Vessel<D>, Invalid> {
        let particles = room::apart(self, Process::Mixing, random)?;
        Vessel::new(self.boundary.clone(), particles, 2.0 * COLLISIONS_BEFORE / self.collision_rate, random)
    }
}
