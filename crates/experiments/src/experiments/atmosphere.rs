//! An atmosphere: two gases of hard particles in a uniform field, above a floor.
//!
//! In equilibrium at the temperature `T` a particle of species `s` is at the height `z` with the density
//! `n_s(z) = C_s exp(-(m_s g z + mu_ex(n))/kT)`: the barometric law of a thin gas (Laplace 1805; Boltzmann 1879), with the excess
//! chemical potential of the total density `n = n_1 + n_2` where particles have size. That is hydrostatic balance,
//! `dP/dz = -rho g` with `P = n kT Z(n)`, layer by layer: good while the density changes little over a diameter. As all have the
//! same size, `n_2/n_1` goes as `exp(-(m_2 - m_1) g z/kT)` at any density.
//!
//! Exact whatever the density: the mean force on the floor is the weight of all there is, and the temperature is the same at
//! every height, although each particle loses speed as it rises: the slow ones do not get there.

mod theory;

use corpuscle_checkpoint::{Resume, resume};
use corpuscle_core::{Axis as Faces, Boundary, Contact, Engine, Failure, Invalid, Meeting, Particles, Random, Vector, placement};
use corpuscle_event::{EventDriven, Rules};
use corpuscle_observe::chart::{Axis, Scale, Series, Style};
use corpuscle_observe::{Chart, Check, Estimate};
use corpuscle_scene::{Camera, Colouring, Scene};

use crate::gas::{self, Species};
use crate::hand::{self, InHand};
use crate::replicas::{Member, Replicas, Watch, energy_check, honesty};
use crate::tally::Tally;
use crate::{Action, Experiment, Frame, Honesty, Kind, Parameter, Probed, Settings, Simulation, drawing, ensemble, peek};
use theory::Profile;

/// The registry's entry.
pub(crate) static EXPERIMENT: Experiment = Experiment {
    name: "atmosphere",
    title: "An atmosphere",
    summary: "Two gases in gravity settle into the barometric law, each with its own scale height; the floor carries their weight, \
              and the temperature is the same at every height.",
    dimensions: &[2, 3],
    engines: &["event-driven"],
    parameters: PARAMETERS,
    start,
};

static PARAMETERS: &[Parameter] = &[
    gas::DIMENSION,
    Parameter {
        name: "particles",
        unit: "",
        help: "Number of particles of the light gas, of mass 1.",
        kind: Kind::Whole { default: 200, least: 1, most: 20_000 },
    },
    Parameter {
        name: "heavy_particles",
        unit: "",
        help: "Number of particles of the heavy gas.",
        kind: Kind::Whole { default: 100, least: 1, most: 20_000 },
    },
    Parameter {
        name: "heavy_mass",
        unit: "",
        help: "Mass of a particle of the heavy gas.",
        kind: Kind::Real { default: 3.0, least: 0.1, most: 20.0 },
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
        help: "Temperature k_B T of the floor, and so of the air.",
        kind: Kind::Real { default: 1.0, least: 1e-6, most: 1e6 },
    },
    Parameter {
        name: "gravity",
        unit: "",
        help: "Acceleration g; the scale height of the light gas is k_B T / g.",
        kind: Kind::Real { default: 0.02, least: 1e-9, most: 1e6 },
    },
    Parameter {
        name: "floor_packing",
        unit: "",
        help: "Packing fraction at the floor were the particles points: it sets the width of the box.",
        kind: Kind::Real { default: 0.03, least: 1e-5, most: 0.2 },
    },
    Parameter {
        name: "floor",
        unit: "",
        help: "A floor that keeps its temperature, or an insulating one, put in once the air has settled.",
        kind: Kind::Choice { default: "thermal", options: &["thermal", "insulating"] },
    },
    Parameter {
        name: "duration",
        unit: "√(kT/m)/g",
        help: "How long is measured, in times a particle of thermal speed rises.",
        kind: Kind::Real { default: 60.0, least: 1.0, most: 1e6 },
    },
    Parameter {
        name: "replicas",
        unit: "",
        help: "Independent columns of air; their scatter gives the error bars. The first is on show.",
        kind: Kind::Whole { default: 24, least: 2, most: 10_000 },
    },
];

/// Height of the box in scale heights of the lighter gas: beyond, `exp(-7)` of it is missing, which theory knows.
const HEIGHT: f64 = 7.0;
/// Samples in the time a particle of thermal speed rises.
const RESOLUTION: f64 = 4.0;
/// Times of rise before the measurement: the start has the right density but for what particles keep from each other.
const SETTLING: f64 = 15.0;
/// Bins of the measured profile.
const BINS: usize = 28;

/// What all columns have in common.
struct Set<const D: usize> {
    seed: u64,
    species: [Species; 2],
    temperature: f64,
    gravity: f64,
    insulating: bool,
    boundary: Boundary<D>,
    /// Time in which a light particle of thermal speed rises.
    rise: f64,
    profile: Profile,
}

impl<const D: usize> Set<D> {
    fn new(settings: &Settings) -> Result<Self, Invalid> {
        let (radius, temperature, gravity) = (settings.real("radius"), settings.real("temperature"), settings.real("gravity"));
        let masses = [1.0, settings.real("heavy_mass")];
        let counts = [settings.whole("particles"), settings.whole("heavy_particles")];
        let scales = masses.map(|mass| temperature / (mass * gravity));
        if scales[0].min(scales[1]) < 4.0 * radius {
            return Err(
                settings.invalid("gravity", "scale heights kT/(m g) of two diameters at least: otherwise it is a heap, not air")
            );
        }
        let height = HEIGHT * scales[0].max(scales[1]) + 2.0 * radius;
        let columns: f64 = (0..2).map(|s| counts[s] as f64 / scales[s]).sum();
        let area = columns * corpuscle_core::particles::ball_volume::<D>(radius) / settings.real("floor_packing");
        let width = if D == 2 { area } else { area.sqrt() };
        if width < 6.0 * radius {
            return Err(
                settings.invalid("floor_packing", format!("a box three diameters wide at least; this one is {width:.3} wide"))
            );
        }
        let mut upper = [width; D];
        upper[D - 1] = height;
        let mut boundary = Boundary::new([0.0; D], upper, Faces::Periodic);
        boundary.axes[D - 1] = Faces::Walls;
        boundary.faces[D - 1][0].temperature = Some(temperature);
        let species: [Species; 2] = std::array::from_fn(|s| Species { count: counts[s], radius, mass: masses[s], index: s as u16 });
        let profile = Profile::new::<D>(species, scales, height - 2.0 * radius, area);
        Ok(Self {
            seed: settings.seed,
            species,
            temperature,
            gravity,
            insulating: settings.word("floor") == "insulating",
            boundary,
            rise: (temperature / masses[0]).sqrt() / gravity,
            profile,
        })
    }

    /// Height of a particle above the lowest place of its centre.
    fn height(&self, position: Vector<D>) -> f64 {
        position[D - 1] - self.species[0].radius
    }
}

/// The impulses on floor and ceiling.
#[derive(Clone, Copy, Debug, Default, serde::Serialize, serde::Deserialize)]
struct Load {
    floor: f64,
    ceiling: f64,
}

/// Sums over the samples of one column.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
struct Sums {
    samples: f64,
    /// Heights of each species.
    heights: [f64; 2],
    /// Kinetic energies and numbers in each bin.
    energy: Vec<f64>,
    counts: [Vec<f64>; 2],
}

/// A column of air under way.
struct Column<const D: usize> {
    engine: EventDriven<D>,
    load: Load,
    sums: Sums,
    species: Vec<u16>,
    masses: Vec<f64>,
    radius: f64,
    bin: f64,
    energy: Option<f64>,
    started: f64,
}

resume!(Column<const D> { values: [engine, load, sums], set_up: [species, masses, radius, bin, energy, started] });

impl<const D: usize> Column<D> {
    fn new(set: &Set<D>, stream: u64) -> Result<Self, Invalid> {
        let mut random = Random::new(set.seed, stream);
        let mut particles = Particles::new();
        let extent = set.boundary.extent();
        for species in set.species {
            let scale = set.temperature / (species.mass * set.gravity);
            let room = extent[D - 1] - 2.0 * species.radius;
            let draw = || {
                // The barometric law below the ceiling, by inversion.
                let fall = -libm::expm1(-room / scale);
                let height = -scale * libm::log1p(-fall * random.uniform());
                let mut place = Vector::from_fn(|k| extent[k] * random.uniform());
                place[D - 1] = species.radius + height;
                place
            };
            gas::scatter(&mut particles, &set.boundary, species, draw)?;
        }
        placement::maxwell(&mut particles, set.temperature, false, &mut random);
        let (species, masses) = (particles.species.clone(), particles.mass.clone());
        let mut field = Vector::ZERO;
        field[D - 1] = -set.gravity;
        // Each column has thermal walls of its own.
        let rules = Rules { field, seed: random.bits(), ..Rules::default() };
        let mut engine = EventDriven::new(set.boundary.clone(), particles, rules)?;
        let started = SETTLING * set.rise;
        engine.advance(started, &mut ()).map_err(|failure| Invalid::new("gravity", set.gravity, failure.to_string()))?;
        if set.insulating {
            let mut boundary = set.boundary.clone();
            boundary.faces[D - 1][0].temperature = None;
            engine.set_boundary(boundary)?;
        }
        let energy = set.insulating.then(|| engine.kinetic_energy() + engine.potential_energy());
        let radius = set.species[0].radius;
        let bin = set.profile.height() / BINS as f64;
        let sums = Sums { energy: vec![0.0; BINS], counts: [vec![0.0; BINS], vec![0.0; BINS]], ..Sums::default() };
        Ok(Self { engine, load: Load::default(), sums, species, masses, radius, bin, energy, started })
    }
}

impl<const D: usize> Member for Column<D> {
    fn advance(&mut self, time: f64) -> Result<(), Failure> {
        let load = &mut self.load;
        let mut weigh = |contact: &Contact<D>| {
            if let Meeting::Face { upper, .. } = contact.with {
                *(if upper { &mut load.ceiling } else { &mut load.floor }) += contact.impulse;
            }
        };
        self.engine.advance(self.started + time, &mut Watch(&mut weigh))
    }

    fn sample(&mut self) {
        self.sums.samples += 1.0;
        for (i, (&species, &mass)) in self.species.iter().zip(&self.masses).enumerate() {
            let height = self.engine.position(i)[D - 1] - self.radius;
            let bin = ((height / self.bin) as usize).min(BINS - 1);
            self.sums.heights[usize::from(species)] += height;
            self.sums.counts[usize::from(species)][bin] += 1.0;
            self.sums.energy[bin] += 0.5 * mass * self.engine.velocity(i).norm_squared();
        }
    }

    fn time(&self) -> f64 {
        self.engine.time() - self.started
    }
}

fn start(settings: &Settings) -> Result<Box<dyn Simulation>, Invalid> {
    Ok(match settings.word("dimension") {
        "3" => Box::new(Atmosphere::<3>::new(settings)?),
        _ => Box::new(Atmosphere::<2>::new(settings)?),
    })
}

/// The running experiment.
struct Atmosphere<const D: usize> {
    set: Set<D>,
    duration: f64,
    columns: Replicas<Column<D>>,
    in_hand: Option<InHand<D>>,
}

resume!(Atmosphere<const D> { values: [], parts: [columns], set_up: [set, duration, in_hand] });

impl<const D: usize> Atmosphere<D> {
    fn new(settings: &Settings) -> Result<Self, Invalid> {
        let set = Set::<D>::new(settings)?;
        let streams: Vec<u64> = (0..settings.whole("replicas") as u64).collect();
        let members = ensemble::build(&streams, |&stream| Column::new(&set, stream))?;
        let duration = settings.real("duration") * set.rise;
        let columns = Replicas::new(set.rise / RESOLUTION, members);
        Ok(Self { set, duration, columns, in_hand: None })
    }

    /// Mean height of a species.
    fn mean_height(&self, species: usize) -> Estimate {
        let count = self.set.species[species].count as f64;
        self.columns.mean(|column| column.sums.heights[species] / (column.sums.samples * count))
    }

    /// Temperature of all particles between two bins.
    fn temperature(&self, bins: std::ops::Range<usize>) -> Estimate {
        let sums: Vec<[f64; 2]> = self
            .columns
            .members
            .iter()
            .map(|column| {
                let count: f64 = column.sums.counts.iter().flat_map(|counts| &counts[bins.clone()]).sum();
                [column.sums.energy[bins.clone()].iter().sum(), count]
            })
            .collect();
        Estimate::jackknife(&sums, |[energy, count]| 2.0 * energy / (D as f64 * count))
    }

    fn weight(&self) -> f64 {
        self.set.species.iter().map(|species| species.count as f64 * species.mass * self.set.gravity).sum()
    }

    fn profile_chart(&self) -> Chart {
        let (set, width) = (&self.set, self.columns.members[0].bin);
        let base = set.boundary.volume() / set.boundary.extent()[D - 1];
        let mut chart = Chart::new(
            "profile",
            "Density against height",
            Axis::linear("height z", ""),
            Axis::logarithmic("number density n", ""),
        );
        for (s, name) in ["light", "heavy"].into_iter().enumerate() {
            let measured = (0..BINS).map(|bin| {
                let density = self.columns.mean(|column| column.sums.counts[s][bin] / (column.sums.samples * base * width));
                (width * (bin as f64 + 0.5), density.mean, density.standard_error)
            });
            let measured: Vec<_> = measured.filter(|point| point.1 > 2.0 * point.2).collect();
            let reach = measured.last().map_or(width, |point| point.0);
            chart = chart
                .with(Series::theory(format!("{name}: hydrostatic balance"), 0.0, reach, 160, Scale::Linear, |z| {
                    set.profile.density(s, z)
                }))
                .with(Series::with_errors(format!("{name}: measured"), Style::Points, measured));
        }
        chart.noting(
            "Straight lines, three times as steep for three times the mass: the barometric law. Near the floor particles crowd.",
        )
    }

    fn temperature_chart(&self) -> Chart {
        let width = self.columns.members[0].bin;
        let measured = (0..BINS)
            .map(|bin| {
                let temperature = self.temperature(bin..bin + 1);
                (width * (bin as f64 + 0.5), temperature.mean, temperature.standard_error)
            })
            .filter(|point| point.1.is_finite() && point.2 < 0.3 * point.1);
        Chart::new("temperature", "Temperature against height", Axis::linear("height z", ""), Axis::linear("temperature", "k_B T"))
            .with(Series::theory("the floor's", 0.0, self.set.profile.height(), 2, Scale::Linear, |_| self.set.temperature))
            .with(Series::with_errors("measured", Style::Points, measured))
            .noting("Each particle slows down as it rises, but only the fast ones rise: the air is as warm above as below.")
    }

    fn mixture_chart(&self) -> Chart {
        let (set, width) = (&self.set, self.columns.members[0].bin);
        let ratios = (0..BINS).filter_map(|bin| {
            let pairs: Vec<[f64; 2]> =
                self.columns.members.iter().map(|column| [column.sums.counts[0][bin], column.sums.counts[1][bin]]).collect();
            let ratio = Estimate::jackknife(&pairs, |[light, heavy]| heavy / light);
            (ratio.mean > 2.0 * ratio.standard_error).then_some((width * (bin as f64 + 0.5), ratio.mean, ratio.standard_error))
        });
        let measured: Vec<_> = ratios.collect();
        let reach = measured.last().map_or(width, |point| point.0);
        Chart::new("mixture", "Heavy over light", Axis::linear("height z", ""), Axis::logarithmic("n heavy / n light", ""))
            .with(Series::theory("exp(−(m₂ − m₁) g z/kT)", 0.0, reach, 60, Scale::Linear, |z| {
                set.profile.density(1, z) / set.profile.density(0, z)
            }))
            .with(Series::with_errors("measured", Style::Points, measured))
            .noting("A straight line at any density: the sizes are equal, only the weights differ.")
    }
}

impl<const D: usize> Simulation for Atmosphere<D> {
    fn state(&self) -> Option<&dyn Resume> {
        Some(self)
    }

    fn state_mut(&mut self) -> Option<&mut dyn Resume> {
        Some(self)
    }

    fn time(&self) -> f64 {
        self.columns.time()
    }

    fn end(&self) -> f64 {
        self.duration
    }

    fn advance(&mut self, to: f64) -> Result<(), Failure> {
        self.columns.advance(to)?;
        InHand::advance_any(&mut self.in_hand, self.columns.members[0].started + to)
    }

    fn draw(&self, scene: &mut Scene) {
        scene.clear();
        let column = &self.columns.members[0];
        let engine = InHand::on_show(self.in_hand.as_ref(), &column.engine);
        drawing::add_event_driven(scene, engine, &Tally::default(), column.started, |i| f64::from(column.species[i]));
        scene.colouring = Colouring::Species(vec!["light".into(), "heavy".into()]);
        // The thin upper half is left out of the first view.
        let mut upper = self.set.boundary.upper.to_three();
        upper[D - 1] *= 0.6;
        scene.camera = Camera::fit(self.set.boundary.lower.to_three(), upper);
        scene.title = EXPERIMENT.title.into();
        let scale = |mass: f64| self.set.temperature / (mass * self.set.gravity);
        let mean = |s: u16| {
            let of_species = (0..column.species.len()).filter(|&i| column.species[i] == s);
            let heights = of_species.map(|i| self.set.height(engine.position(i)));
            heights.sum::<f64>() / self.set.species[usize::from(s)].count as f64
        };
        scene.caption = format!(
            "mean heights {:.1} and {:.1}, scale heights kT/mg {:.1} and {:.1}",
            mean(0),
            mean(1),
            scale(self.set.species[0].mass),
            scale(self.set.species[1].mass)
        );
    }

    fn frame(&self) -> Option<Frame> {
        let column = &self.columns.members[0];
        Some(Frame::of_hard(&column.engine, column.started, &["light", "heavy"]).with_species(column.species.iter().copied()))
    }

    fn charts(&self) -> Vec<Chart> {
        vec![self.profile_chart(), self.mixture_chart(), self.temperature_chart()]
    }

    fn checks(&self) -> Vec<Check> {
        let mut checks = vec![];
        let time = self.columns.sampled();
        if time >= 10.0 * self.set.rise {
            for (s, name) in ["mean height of the light gas", "mean height of the heavy gas"].into_iter().enumerate() {
                let expected = self.set.profile.mean_height(s);
                checks.push(self.mean_height(s).check(
                    name,
                    expected,
                    "dP/dz = -rho g with the equation of state of hard particles",
                ));
            }
            let load = self.columns.mean(|column| (column.load.floor - column.load.ceiling) / time);
            checks.push(load.check("force on the floor", self.weight(), "Newton: the floor carries the weight"));
            let half = (BINS as f64 / HEIGHT).round() as usize;
            let reference = "Maxwell and Boltzmann: isothermal at every height";
            checks.push(self.temperature(0..half).check("k_B T below one scale height", self.set.temperature, reference));
            checks.push(self.temperature(half..BINS).check("k_B T above one scale height", self.set.temperature, reference));
        }
        checks.extend(energy_check(&self.honesty()));
        checks
    }

    fn honesty(&self) -> Honesty {
        honesty(self.columns.members.iter().map(|column| (&column.engine, column.energy)))
    }

    fn next_event(&self) -> Option<f64> {
        let column = &self.columns.members[0];
        peek::next_contact(InHand::on_show(self.in_hand.as_ref(), &column.engine), 1.5 * self.duration)
            .map(|time| time - column.started)
    }

    fn probe(&mut self, corners: Option<[[f64; 2]; 2]>) {
        InHand::lay(&mut self.in_hand, &self.columns.members[0].engine, corners);
    }

    fn probed(&self) -> Option<Probed> {
        InHand::probed(self.in_hand.as_ref())
    }

    fn refusal(&self, action: Action) -> Option<&'static str> {
        hand::wanting_of_number(&self.columns.members[0].engine, action)
    }

    fn act(&mut self, action: Action) -> Result<(), Invalid> {
        InHand::act(&mut self.in_hand, &self.columns.members[0].engine, &Tally::default(), action)
    }
}
