//! The path of a heavy particle: what is measured along it, and its checks.

use corpuscle_checkpoint::{Resume, resume};
use corpuscle_core::{Axis as Faces, Engine, Failure, Invalid, Vector};
use corpuscle_observe::{Chart, Check, Curves, Estimate, Schedule, msd, vacf};
use corpuscle_scene::{Colour, Colouring, Scene, TrailPoint};

use super::bath::{Bath, TRACER};
use super::set::Set;
use crate::hand::{self, InHand};
use crate::horizon::precision_horizon;
use crate::probe::{self, Region};
use crate::{Action, Frame, Honesty, Probed, Settings, Simulation, drawing, ensemble, peek};

/// Samples per relaxation time: Simpson's rule on the velocity correlation is then good to `20^-4 / 180`.
pub(super) const RESOLUTION: f64 = 20.0;
/// Longest lag of the velocity correlation in relaxation times: what follows is `exp(-7)` of the whole.
pub(super) const MEMORY: f64 = 7.0;
/// Lags, in relaxation times, between which the displacement is taken as diffusive: memory has gone by `exp(-5)`.
pub(super) const DIFFUSIVE: (f64, f64) = (5.0, 10.0);
/// Points of the trail on show.
const TRAIL: usize = 6000;

/// One kind of particle in its baths, under way.
pub(super) struct Brownian<const D: usize> {
    pub(super) set: Set<D>,
    pub(super) duration: f64,
    schedule: Schedule,
    times: Vec<f64>,
    baths: Vec<Bath<D>>,
    /// A copy of the first bath, once a hand has touched it.
    in_hand: Option<InHand<D>>,
}

impl<const D: usize> Brownian<D> {
    /// Baths of one kind; their random numbers are those of `stream` and the next ones.
    pub(super) fn new(set: Set<D>, settings: &Settings, stream: u64) -> Result<Self, Invalid> {
        let streams: Vec<u64> = (stream..stream + settings.whole("replicas") as u64).collect();
        let baths = ensemble::build(&streams, |&stream| Bath::new(&set, stream))?;
        let duration = settings.real("duration") * set.relaxation();
        // The baths noted their first sample when they were ready.
        let schedule = Schedule::new(set.interval).after_start();
        Ok(Self { set, duration, schedule, times: vec![0.0], baths, in_hand: None })
    }

    pub(super) fn elapsed(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }

    pub(super) fn displacements(&self) -> Curves {
        Curves::join(self.baths.iter().map(Bath::displacement))
    }

    pub(super) fn correlations(&self) -> Curves {
        Curves::join(self.baths.iter().map(Bath::velocity))
    }

    /// `d k T` from the tracer's speed: `M <V^2> / s`.
    fn kinetic(&self) -> Estimate {
        let samples = self.times.len() as f64;
        let means: Vec<f64> = self.baths.iter().map(|bath| bath.speed_squares / samples).collect();
        Estimate::from_replicas(&means) * (self.set.mass / self.set.share)
    }

    /// Friction from the kicks, `<|dV|^2 per time> / (2 d kT/M)`.
    pub(super) fn friction(&self) -> Estimate {
        let scale = self.set.mass / (2.0 * D as f64 * self.set.temperature * self.elapsed());
        let rates: Vec<f64> = self.baths.iter().map(|bath| bath.kicks.squares * scale).collect();
        Estimate::from_replicas(&rates)
    }

    /// Diffusion coefficient of each bath, by the slope of the displacement and by the integral of the correlation.
    pub(super) fn diffusion_pairs(&self) -> Vec<[f64; 2]> {
        let time = self.set.relaxation();
        let einstein = |bath: &Bath<D>| msd::diffusion(&bath.displacement(), D, DIFFUSIVE.0 * time, DIFFUSIVE.1 * time).mean;
        let kubo = |bath: &Bath<D>| vacf::green_kubo(&bath.velocity(), D, MEMORY * time).mean;
        self.baths.iter().map(|bath| [einstein(bath), kubo(bath)]).collect()
    }

    /// Diffusion coefficient by the slope of the displacement; none before there are long enough paths.
    pub(super) fn diffusion(&self) -> Option<Estimate> {
        let long_enough = self.elapsed() >= 2.0 * DIFFUSIVE.1 * self.set.relaxation();
        long_enough.then(|| Estimate::jackknife(&self.diffusion_pairs(), |[einstein, _]| einstein))
    }

    /// Displacements along each axis over [`DIFFUSIVE`]`.0` relaxation times, one after the other, bath by bath.
    pub(super) fn steps(&self) -> Vec<Vec<f64>> {
        let stride = (DIFFUSIVE.0 * RESOLUTION) as usize;
        let of = |bath: &Bath<D>| {
            let places: Vec<_> = bath.path.iter().step_by(stride).collect();
            places.windows(2).flat_map(|w| (*w[1] - *w[0]).0).collect()
        };
        self.baths.iter().map(of).collect()
    }

    /// Between walls the particle ends up anywhere alike: its mean squared displacement saturates at `L^2/6` an axis, twice the
    /// variance of its place. Checked once it has had time to forget that it started in the middle.
    fn saturation(&self) -> Option<Check> {
        let set = &self.set;
        let open = set.side - 2.0 * set.radius;
        let spreading = (open / std::f64::consts::PI).powi(2) / set.diffusion() + set.relaxation();
        let from = self.times.iter().position(|&time| time >= 8.0 * spreading)?;
        if set.faces != Faces::Walls || self.elapsed() < 24.0 * spreading {
            return None;
        }
        let squares = |bath: &Bath<D>| {
            let late = &bath.path[from..];
            let of_place = |place: &Vector<D>| place.0.iter().map(|x| (x - 0.5 * set.side) * (x - 0.5 * set.side)).sum::<f64>();
            2.0 * late.iter().map(of_place).sum::<f64>() / (late.len() * D) as f64
        };
        let saturated = Estimate::from_replicas(&self.baths.iter().map(squares).collect::<Vec<_>>());
        Some(saturated.check("saturated displacement along one axis", open * open / 6.0, "anywhere between the walls alike: L²/6"))
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
        scene.title = super::EXPERIMENT.title.into();
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
                let friction = set.friction * set.closed_system_factor();
                checks.push(self.friction().check(
                    "friction γ from the kicks",
                    friction,
                    "Enskog, binary collisions; exact given the contact value",
                ));
                checks.push(vacf::initial_friction(&self.correlations()).check(
                    "initial slope of the velocity correlation, −C'(0)/C(0)",
                    friction / set.share,
                    "the same friction, exact at time zero",
                ));
            }
        }
        // Long lags need many origins; between walls there is no free diffusion.
        if elapsed >= 2.0 * DIFFUSIVE.1 * set.relaxation() && set.faces == Faces::Periodic {
            checks.extend(self.diffusion_checks());
        }
        checks.extend(self.saturation());
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

    fn probe(&mut self, corners: Option<[[f64; 2]; 2]>) {
        let bath = &mut self.baths[0];
        let (engine, tally) = self.in_hand.as_mut().map_or((&bath.engine, &mut bath.tally), |copy| (&copy.engine, &mut copy.tally));
        tally.lay(corners.and_then(|corners| Region::lay(engine, corners)));
    }

    fn probed(&self) -> Option<Probed> {
        let bath = &self.baths[0];
        let (engine, tally) = self.in_hand.as_ref().map_or((&bath.engine, &bath.tally), |copy| (&copy.engine, &copy.tally));
        probe::read(engine, tally)
    }

    fn refusal(&self, action: Action) -> Option<&'static str> {
        hand::wanting_of_number(&self.baths[0].engine, action)
    }

    fn act(&mut self, action: Action) -> Result<(), Invalid> {
        let bath = &self.baths[0];
        InHand::act(&mut self.in_hand, &bath.engine, &bath.tally, action)
    }
}
