//! Brownian motion: a heavy sphere in a bath of light ones, from the collisions up.
//!
//! Kinetic theory of a dilute bath of `N` particles of mass `m` and a tracer of mass `M >> m`: its velocity obeys
//! `dV/dt = -gamma (V - V_bath) + noise`, with the Enskog friction `gamma_0` of
//! [`theory::initial_friction`]. In a periodic box total momentum stays zero, so that the bath drifts against the tracer,
//! `V_bath = -V M/(N m)`. With `s = N m / (N m + M)` this gives, for every finite `N`,
//! `<V^2> = s d kT/M` (exact), a velocity correlation that decays with `gamma_0 / s`, and `D = s^2 kT/(M gamma_0)`.
//! Between walls `s = 1`.
//!
//! The friction itself is measured from the kicks: in equilibrium `2 <V.dV> = -<|dV|^2>` per collision, so
//! `gamma_0 = <|dV|^2 per time> / (2 d kT/M)`, exact at any density and any mass.

mod bath;
mod charts;

use corpuscle_checkpoint::{Resume, resume};
use corpuscle_core::{Axis as Faces, Engine, Failure, Invalid, particles::ball_volume};
use corpuscle_observe::{Chart, Check, Curves, Estimate, Schedule, msd, theory, vacf};
use corpuscle_scene::{Colour, Colouring, Scene, TrailPoint};

use crate::hand::InHand;
use crate::horizon::precision_horizon;
use crate::{Action, Experiment, Frame, Honesty, Kind, Parameter, Settings, Simulation, drawing, ensemble, gas, peek};
use bath::{Bath, TRACER};

/// The registry's entry.
pub(crate) static EXPERIMENT: Experiment = Experiment {
    name: "brownian",
    title: "Brownian motion",
    summary: "A heavy particle in a bath of light ones: its zigzag path, how far it gets, how it forgets its velocity, and \
              Perrin's way from there to k T.",
    dimensions: &[2, 3],
    engines: &["event-driven"],
    parameters: PARAMETERS,
    start,
};

static PARAMETERS: &[Parameter] = &[
    gas::DIMENSION,
    Parameter {
        name: "boundary",
        unit: "",
        help: "A periodic box, or walls, between which the displacement saturates.",
        kind: Kind::Choice { default: "periodic", options: &["periodic", "walls"] },
    },
    Parameter {
        name: "particles",
        unit: "",
        help: "Number of bath particles.",
        kind: Kind::Whole { default: 200, least: 1, most: 100_000 },
    },
    Parameter {
        name: "packing_fraction",
        unit: "",
        help: "Volume of all bath particles over that of the box. Theory is for a dilute bath.",
        kind: Kind::Real { default: 0.004, least: 1e-6, most: 0.4 },
    },
    Parameter {
        name: "bath_radius",
        unit: "",
        help: "Radius of a bath particle; its mass is 1.",
        kind: Kind::Real { default: 0.5, least: 1e-3, most: 1e3 },
    },
    Parameter {
        name: "radius",
        unit: "",
        help: "Radius of the heavy particle.",
        kind: Kind::Real { default: 2.0, least: 1e-3, most: 1e4 },
    },
    Parameter {
        name: "mass",
        unit: "",
        help: "Mass of the heavy particle, in masses of a bath particle.",
        kind: Kind::Real { default: 30.0, least: 1.0, most: 1e6 },
    },
    Parameter {
        name: "temperature",
        unit: "",
        help: "Temperature k_B T.",
        kind: Kind::Real { default: 1.0, least: 1e-6, most: 1e6 },
    },
    Parameter {
        name: "duration",
        unit: "1/γ",
        help: "How long is measured, in relaxation times of the heavy particle's velocity.",
        kind: Kind::Real { default: 60.0, least: 1.0, most: 1e6 },
    },
    Parameter {
        name: "replicas",
        unit: "",
        help: "Independent baths; their scatter gives the error bars. The first is on show.",
        kind: Kind::Whole { default: 48, least: 2, most: 10_000 },
    },
];

/// Samples per relaxation time: Simpson's rule on the velocity correlation is then good to `20^-4 / 180`.
const RESOLUTION: f64 = 20.0;
/// Longest lag of the velocity correlation in relaxation times: what follows is `exp(-7)` of the whole.
const MEMORY: f64 = 7.0;
/// Lags, in relaxation times, between which the displacement is taken as diffusive: memory has gone by `exp(-5)`.
const DIFFUSIVE: (f64, f64) = (5.0, 10.0);
/// Points of the trail on show.
const TRAIL: usize = 6000;

/// What all baths have in common.
#[derive(Clone, Debug)]
struct Set<const D: usize> {
    seed: u64,
    particles: usize,
    bath_radius: f64,
    radius: f64,
    mass: f64,
    temperature: f64,
    faces: Faces,
    side: f64,
    /// Collisions of a bath particle per time.
    collision_rate: f64,
    /// Friction `gamma_0` by Enskog's theory.
    friction: f64,
    /// `s`: 1 between walls, `N m / (N m + M)` where total momentum is zero.
    share: f64,
    interval: f64,
    longest_lag: f64,
}

impl<const D: usize> Set<D> {
    fn new(settings: &Settings) -> Result<Self, Invalid> {
        let (particles, bath_radius, radius) = (settings.whole("particles"), settings.real("bath_radius"), settings.real("radius"));
        let (mass, temperature) = (settings.real("mass"), settings.real("temperature"));
        let side = gas::side::<D>(particles, bath_radius, settings.real("packing_fraction"));
        let contact = radius + bath_radius;
        if 4.0 * contact > side {
            return Err(settings.invalid(
                "radius",
                format!("a tracer that leaves room in the box of side {side:.3}: at most {:.3}", 0.25 * side - bath_radius),
            ));
        }
        let faces = if settings.word("boundary") == "walls" { Faces::Walls } else { Faces::Periodic };
        // The tracer keeps the centres of the bath out of its own surroundings: the rest is denser.
        let density = particles as f64 / (side.powi(D as i32) - ball_volume::<D>(contact));
        let chi =
            theory::contact_value_of_tracer::<D>(theory::packing_fraction::<D>(density, 2.0 * bath_radius), bath_radius, radius);
        let friction = theory::initial_friction::<D>(density, contact, chi, 1.0, mass, temperature);
        let share = if faces == Faces::Periodic { particles as f64 / (particles as f64 + mass) } else { 1.0 };
        let relaxation = share / friction;
        Ok(Self {
            seed: settings.seed,
            particles,
            bath_radius,
            radius,
            mass,
            temperature,
            faces,
            side,
            collision_rate: theory::collision_rate::<D>(density, 2.0 * bath_radius, temperature, 1.0),
            friction,
            share,
            interval: relaxation / RESOLUTION,
            longest_lag: MEMORY * relaxation,
        })
    }

    /// Relaxation time of the tracer's velocity in this box, `s / gamma_0`.
    fn relaxation(&self) -> f64 {
        self.share / self.friction
    }

    /// Expected diffusion coefficient `s^2 kT/(M gamma_0)`.
    fn diffusion(&self) -> f64 {
        self.share * self.share * theory::diffusion_coefficient(self.temperature, self.mass, self.friction)
    }

    /// Expected mean squared displacement: Ornstein and Uhlenbeck's, with the box's own `kT` and friction.
    fn displacement(&self, time: f64) -> f64 {
        theory::ornstein_uhlenbeck_displacement(D, self.share * self.temperature, self.mass, self.friction / self.share, time)
    }

    /// In a closed system of `f` degrees of freedom speeds are bounded; kicks go with the cube of the relative speed, whose
    /// mean is lower than Maxwell's by `(f/2)^(3/2) Gamma(f/2) / Gamma(f/2 + 3/2)`.
    fn closed_system_factor(&self) -> f64 {
        let particles = self.particles as f64 + if self.faces == Faces::Periodic { 0.0 } else { 1.0 };
        let half = 0.5 * D as f64 * particles;
        libm::exp(1.5 * libm::log(half) + libm::lgamma(half) - libm::lgamma(half + 1.5))
    }
}

fn start(settings: &Settings) -> Result<Box<dyn Simulation>, Invalid> {
    Ok(match settings.word("dimension") {
        "3" => Box::new(Brownian::<3>::new(settings)?),
        _ => Box::new(Brownian::<2>::new(settings)?),
    })
}

/// The running experiment.
struct Brownian<const D: usize> {
    set: Set<D>,
    duration: f64,
    schedule: Schedule,
    times: Vec<f64>,
    baths: Vec<Bath<D>>,
    /// A copy of the first bath, once a hand has touched it.
    in_hand: Option<InHand<D>>,
}

impl<const D: usize> Brownian<D> {
    fn new(settings: &Settings) -> Result<Self, Invalid> {
        let set = Set::<D>::new(settings)?;
        let streams: Vec<u64> = (0..settings.whole("replicas") as u64).collect();
        let baths = ensemble::build(&streams, |&stream| Bath::new(&set, stream))?;
        let duration = settings.real("duration") * set.relaxation();
        // The baths noted their first sample when they were ready.
        let schedule = Schedule::new(set.interval).after_start();
        Ok(Self { set, duration, schedule, times: vec![0.0], baths, in_hand: None })
    }

    fn elapsed(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }

    fn displacements(&self) -> Curves {
        Curves::join(self.baths.iter().map(Bath::displacement))
    }

    fn correlations(&self) -> Curves {
        Curves::join(self.baths.iter().map(Bath::velocity))
    }

    /// `d k T` from the tracer's speed: `M <V^2> / s`.
    fn kinetic(&self) -> Estimate {
        let samples = self.times.len() as f64;
        let means: Vec<f64> = self.baths.iter().map(|bath| bath.speed_squares / samples).collect();
        Estimate::from_replicas(&means) * (self.set.mass / self.set.share)
    }

    /// Friction from the kicks, `<|dV|^2 per time> / (2 d kT/M)`.
    fn friction(&self) -> Estimate {
        let scale = self.set.mass / (2.0 * D as f64 * self.set.temperature * self.elapsed());
        let rates: Vec<f64> = self.baths.iter().map(|bath| bath.kicks.squares * scale).collect();
        Estimate::from_replicas(&rates)
    }

    /// Diffusion coefficient of each bath, by the slope of the displacement and by the integral of the correlation.
    fn diffusion_pairs(&self) -> Vec<[f64; 2]> {
        let time = self.set.relaxation();
        let einstein = |bath: &Bath<D>| msd::diffusion(&bath.displacement(), D, DIFFUSIVE.0 * time, DIFFUSIVE.1 * time).mean;
        let kubo = |bath: &Bath<D>| vacf::green_kubo(&bath.velocity(), D, MEMORY * time).mean;
        self.baths.iter().map(|bath| [einstein(bath), kubo(bath)]).collect()
    }

    /// Displacements along each axis over [`DIFFUSIVE`]`.0` relaxation times, one after the other, bath by bath.
    fn steps(&self) -> Vec<Vec<f64>> {
        let stride = (DIFFUSIVE.0 * RESOLUTION) as usize;
        let of = |bath: &Bath<D>| {
            let places: Vec<_> = bath.path.iter().step_by(stride).collect();
            places.windows(2).flat_map(|w| (*w[1] - *w[0]).0).collect()
        };
        self.baths.iter().map(of).collect()
    }

    fn diffusion_checks(&self) -> Vec<Check> {
        let set = &self.set;
        let pairs = self.diffusion_pairs();
        let einstein = Estimate::jackknife(&pairs, |[einstein, _]| einstein);
        let difference = Estimate::jackknife(&pairs, |[einstein, kubo]| einstein - kubo);
        // Perrin: M gamma D / s^2, with D and gamma as measured in the same baths.
        let scale = set.mass / (set.share * set.share);
        let rates =
            self.baths.iter().map(|bath| bath.kicks.squares * set.mass / (2.0 * D as f64 * set.temperature * self.elapsed()));
        let both: Vec<[f64; 2]> = pairs.iter().zip(rates).map(|(pair, rate)| [pair[0], rate]).collect();
        let perrin = Estimate::jackknife(&both, |[diffusion, friction]| scale * diffusion * friction);
        let powers: Vec<[f64; 2]> = self
            .steps()
            .iter()
            .map(|steps| {
                let mean = |power: i32| steps.iter().map(|x| x.powi(power)).sum::<f64>() / steps.len() as f64;
                [mean(2), mean(4)]
            })
            .collect();
        let kurtosis = Estimate::jackknife(&powers, |[second, fourth]| fourth / (second * second));
        vec![
            einstein.check("diffusion coefficient D, Einstein", set.diffusion(), "s^2 kT/(M gamma_0), Enskog: dilute bath, M >> m"),
            difference.check("D, Einstein less Green-Kubo", 0.0, "Kubo 1957, doi:10.1143/JPSJ.12.570"),
            perrin.check(
                "k_B T by Perrin's way, M gamma D / s^2",
                set.temperature,
                "Einstein 1905, doi:10.1002/andp.19053220806; Perrin 1909",
            ),
            kurtosis.check("kurtosis of the displacements", 3.0, "Gaussian by the central limit theorem"),
        ]
    }
}

impl<const D: usize> Brownian<D> {
    /// The path of the heavy particle as it was measured.
    fn trail(&self, scene: &mut Scene) {
        let bath = &self.baths[0];
        let trail = scene.trail(0, TRAIL, Colour::Accent(1));
        trail.width = 2.0;
        let boundary = bath.engine.boundary();
        let drawn = trail.points().back().map_or(-1.0, |point| point.time);
        let mut before = None;
        for (&path, &time) in bath.path.iter().zip(&self.times) {
            let place = boundary.wrap(path);
            if time > drawn {
                let point = TrailPoint { position: place.to_three(), time };
                // Through a periodic face: the wrapped step is not the real one.
                let through = before.is_some_and(|(last_path, last_place)| {
                    ((place - last_place) - (path - last_path)).norm() > 0.5 * self.set.side
                });
                if through { trail.jump(point) } else { trail.push(point) }
            }
            before = Some((path, place));
        }
    }

    /// In a hand, where nothing is measured: the path from look to look.
    fn trail_of(&self, copy: &InHand<D>, scene: &mut Scene) {
        let (place, time) = (copy.engine.position(TRACER), scene.time);
        let trail = scene.trail(0, TRAIL, Colour::Accent(1));
        let last = trail.points().back().copied();
        let point = TrailPoint { position: place.to_three(), time };
        if last.is_none_or(|last| time > last.time) {
            let far = last.is_some_and(|last| {
                let step = last.position.iter().zip(point.position).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
                step.sqrt() > 0.5 * self.set.side
            });
            if far { trail.jump(point) } else { trail.push(point) }
        }
    }
}

resume!(Brownian<const D> { values: [schedule, times], parts: [baths], set_up: [set, duration, in_hand] });

impl<const D: usize> Simulation for Brownian<D> {
    fn state(&self) -> Option<&dyn Resume> {
        Some(self)
    }

    fn state_mut(&mut self) -> Option<&mut dyn Resume> {
        Some(self)
    }

    fn time(&self) -> f64 {
        self.baths[0].time()
    }

    fn end(&self) -> f64 {
        self.duration
    }

    fn advance(&mut self, to: f64) -> Result<(), Failure> {
        let set = &self.set;
        while let Some(time) = self.schedule.due(to) {
            ensemble::for_each(&mut self.baths, |bath| {
                bath.advance(time)?;
                bath.sample(set);
                Ok(())
            })?;
            self.times.push(time);
        }
        let bath = &mut self.baths[0];
        bath.advance(to)?;
        self.in_hand.as_mut().map_or(Ok(()), |copy| copy.advance(bath.started() + to))
    }

    fn draw(&self, scene: &mut Scene) {
        scene.clear();
        let bath = &self.baths[0];
        let (engine, tally) = self.in_hand.as_ref().map_or((&bath.engine, &bath.tally), |copy| (&copy.engine, &copy.tally));
        drawing::add_event_driven(scene, engine, tally, bath.started(), |i| f64::from(u8::from(i == TRACER)));
        scene.colouring = Colouring::Species(vec!["bath".into(), "heavy particle".into()]);
        scene.least_radius = 1.5; // the bath is to look small beside the heavy particle
        if let Some(copy) = &self.in_hand {
            self.trail_of(copy, scene);
        } else {
            self.trail(scene);
        }
        let away = bath.path.last().zip(bath.path.first()).map_or(0.0, |(now, start)| (*now - *start).norm());
        scene.title = EXPERIMENT.title.into();
        scene.caption = format!(
            "distance from the start {away:.1} (theory √⟨r²⟩ = {:.1})   {} kicks",
            self.set.displacement(self.elapsed()).sqrt(),
            bath.kicks.count
        );
    }

    fn frame(&self) -> Option<Frame> {
        let bath = &self.baths[0];
        let species = (0..bath.engine.particle_count()).map(|i| u16::from(i == TRACER));
        Some(Frame::of_hard(&bath.engine, bath.started(), &["bath", "heavy particle"]).with_species(species))
    }

    fn charts(&self) -> Vec<Chart> {
        let mut charts = vec![];
        if self.times.len() > 2 {
            charts.extend([self.displacement_chart(), self.correlation_chart(), self.diffusion_chart()]);
        }
        charts.extend(self.step_chart());
        charts
    }

    fn checks(&self) -> Vec<Check> {
        let (set, elapsed) = (&self.set, self.elapsed());
        let mut checks = vec![];
        if elapsed >= 5.0 * set.relaxation() {
            let exact = if set.faces == Faces::Periodic {
                "equipartition at zero total momentum: M <V^2> = s d kT"
            } else {
                "equipartition"
            };
            checks.push((self.kinetic() / D as f64).check("k_B T of the heavy particle", set.temperature, exact));
            // Near walls the bath cannot come from all sides: theory knows the open bath only.
            if set.faces == Faces::Periodic {
                checks.push(self.friction().check(
                    "friction γ from the kicks",
                    set.friction * set.closed_system_factor(),
                    "Enskog, binary collisions; exact given the contact value",
                ));
            }
        }
        // Long lags need many origins; between walls there is no free diffusion.
        if elapsed >= 2.0 * DIFFUSIVE.1 * set.relaxation() && set.faces == Faces::Periodic {
            checks.extend(self.diffusion_checks());
        }
        let honesty = self.honesty();
        if let Some(drift) = honesty.energy_drift {
            checks.push(Check::at_most("relative energy drift", drift, 1e-11, "elastic collisions, double precision"));
        }
        if let Some(drift) = honesty.momentum_drift {
            checks.push(Check::at_most("relative momentum drift", drift, 1e-11, "no walls, double precision"));
        }
        checks
    }

    fn honesty(&self) -> Honesty {
        let largest = |drift: fn(&Bath<D>) -> Option<f64>| self.baths.iter().filter_map(drift).fold(0.0, f64::max);
        let overlap =
            |bath: &Bath<D>| bath.engine.boundary().largest_overlap(&bath.engine.snapshot()) / (2.0 * self.set.bath_radius);
        Honesty {
            engine: "event-driven".into(),
            work: self.baths.iter().map(|bath| bath.engine.counts().collisions).sum(),
            work_unit: "collisions",
            energy_drift: Some(largest(|bath| bath.energy.largest())),
            momentum_drift: (self.set.faces == Faces::Periodic).then(|| largest(|bath| bath.momentum.largest())),
            largest_overlap: Some(self.baths.iter().map(overlap).fold(0.0, f64::max)),
            rejected_events: Some(self.baths.iter().map(|bath| bath.engine.counts().stale).sum()),
            precision_horizon: precision_horizon(&self.baths[0].engine),
            ..Honesty::default()
        }
    }

    fn moments(&self) -> Vec<f64> {
        vec![0.0, 2.0 * self.set.relaxation(), 10.0 * self.set.relaxation()]
    }

    fn next_event(&self) -> Option<f64> {
        let bath = &self.baths[0];
        let engine = self.in_hand.as_ref().map_or(&bath.engine, |copy| &copy.engine);
        peek::next_contact(engine, 1.5 * self.duration).map(|time| time - bath.started())
    }

    fn act(&mut self, action: Action) -> Result<(), Invalid> {
        let bath = &self.baths[0];
        InHand::act(&mut self.in_hand, &bath.engine, &bath.tally, action)
    }
}
