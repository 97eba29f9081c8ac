//! Effusion: a gas leaks through a small hole into the empty half, and goes on passing both ways when the halves are equal.
//!
//! Through a hole whose width lets centres pass over `A` fly `n A sqrt(kT/(2 pi m))` particles a time: `n v/pi` in the plane and
//! `n v/4` in space, with the mean speed `v`. A disc of radius `R` keeps it from the rims, so that of a hole of width `w` is left
//! `w - 2R`; its volume open to centres includes the strip between the rims. In equilibrium the flux is exact for a thin gas
//! whatever the size of the hole. Out of it the law `N_left = (N/2)(1 + exp(-2t/tau))`, `tau = V_left/(A sqrt(kT/(2 pi m)))`, is
//! that of a hole which is small against the chamber and the mean free path (Knudsen 1909, doi:10.1002/andp.19093330505).
//!
//! Fast particles come to the hole more often: those that pass carry `(d + 1) kT/2` rather than `d kT/2`. At constant energy of
//! `f = d N` velocity components that is `f/(f + 1)` of it, and the flux `sqrt(f/2) Gamma(f/2)/Gamma((f + 1)/2)` times as large.

use std::f64::consts::PI;

use corpuscle_checkpoint::resume;
use corpuscle_core::{Engine, Failure, Invalid, Observer};
use corpuscle_observe::chart::{Axis, Scale, Series, Style};
use corpuscle_observe::gate::Passages;
use corpuscle_observe::{Chart, Check, Estimate, Gate, theory};
use corpuscle_scene::{Colour, Colouring, Scene};

use super::Set;
use super::room::{Process, Room};
use crate::replicas::{Member, Replicas};
use crate::study::{Running, Specimen, Study, Vessel};
use crate::{Settings, ensemble};

/// Samples in the whole duration.
const SAMPLES: usize = 200;
/// Duration in times `tau`: when its second half begins, `exp(-8)` of the difference is left.
const DURATION: f64 = 8.0;

/// The leak.
pub(super) fn start<const D: usize>(set: Set<D>, settings: &Settings) -> Result<Running<D, Effusion<D>>, Invalid> {
    let hole = set.hole(settings)?;
    let effusion = Effusion { door: Door::new(&set, hole), set };
    let duration = Set::<D>::duration(settings, DURATION * effusion.door.time);
    let streams: Vec<u64> = (0..settings.whole("replicas") as u64).collect();
    let leaks = ensemble::build(&streams, |&stream| Leak::new(&effusion.set, hole, stream))?;
    Ok(Running::new(effusion, duration, SAMPLES, leaks))
}

/// The hole, as theory sees it.
pub(super) struct Door {
    /// Volume open to centres, of both halves with the strip between the rims.
    volume: f64,
    /// Passages one way per time and density.
    conductance: f64,
    /// `tau`: in this time one passes for each particle on a side.
    pub(super) time: f64,
}

impl Door {
    pub(super) fn new<const D: usize>(set: &Set<D>, width: f64) -> Self {
        let (radius, extent) = (set.radius, set.boundary.extent());
        let across: f64 = (2..D).map(|k| extent[k] - 2.0 * radius).product();
        let halves = 2.0 * (0.5 * extent[0] - 2.0 * radius) * (extent[1] - 2.0 * radius);
        let strip = 2.0 * radius * width - PI * radius * radius;
        let volume = (halves + strip) * across;
        let freedom = (D * set.particles) as f64;
        let closed = theory::closed_flux_factor(freedom);
        let conductance = (width - 2.0 * radius) * across * theory::wall_hit_rate(1.0, set.temperature, 1.0) * closed;
        Self { volume, conductance, time: 0.5 * volume / conductance }
    }

    /// Passages one way per time in equilibrium.
    fn flux(&self, particles: usize) -> f64 {
        particles as f64 / self.volume * self.conductance
    }
}

/// What is asked.
pub(super) struct Effusion<const D: usize> {
    set: Set<D>,
    door: Door,
}

/// What was noted at one sampling time.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
struct Reading {
    below: usize,
    upward: Passages,
    downward: Passages,
    /// Time integrals of the numbers on the left and on the right.
    presence: [f64; 2],
}

/// A room with a hole, watched.
pub(super) struct Leak<const D: usize> {
    room: Room<D>,
    gate: Gate,
    readings: Vec<Reading>,
}

resume!(Leak<const D> { values: [gate, readings], parts: [room] });

impl<const D: usize> Leak<D> {
    fn new(set: &Set<D>, hole: f64, stream: u64) -> Result<Self, Invalid> {
        let room = Room::new(set, Process::Expansion, Some(hole), &[set.cells_along], stream)?;
        let engine = &room.vessel.engine;
        let gate = Gate::new(0, set.middle(), engine.time(), &engine.snapshot());
        Ok(Self { room, gate, readings: vec![] })
    }
}

impl<const D: usize> Member for Leak<D> {
    fn advance(&mut self, time: f64) -> Result<(), Failure> {
        let gate = &mut self.gate;
        self.room.vessel.advance(time, &mut |contact| gate.contact(contact))
    }

    fn sample(&mut self) {
        self.gate.settle(self.room.vessel.engine.time());
        self.room.sample();
        let gate = &self.gate;
        self.readings.push(Reading {
            below: gate.below(),
            upward: gate.upward(),
            downward: gate.downward(),
            presence: gate.presence(),
        });
    }

    fn time(&self) -> f64 {
        self.room.vessel.time()
    }
}

impl<const D: usize> Specimen<D> for Leak<D> {
    fn vessel(&self) -> &Vessel<D> {
        &self.room.vessel
    }

    fn vessel_mut(&mut self) -> &mut Vessel<D> {
        &mut self.room.vessel
    }
}

type Leaks<const D: usize> = Replicas<Leak<D>>;

impl<const D: usize> Effusion<D> {
    fn share_chart(&self, leaks: &Leaks<D>) -> Chart {
        let count = self.set.particles as f64;
        let end = leaks.sampled().max(self.door.time);
        let measured = leaks.times.iter().enumerate().map(|(k, &time)| {
            let share = leaks.mean(|leak| leak.readings[k].below as f64 / count);
            (time, share.mean, share.standard_error)
        });
        let one = leaks.times.iter().zip(&leaks.members[0].readings).map(|(&time, reading)| (time, reading.below as f64 / count));
        Chart::new(
            "effusion",
            "Effusion: share of particles in the left half",
            Axis::linear("time t", ""),
            Axis::linear("share n_left/N", ""),
        )
        .with(Series::theory("small hole, ½ (1 + exp(−2t/τ))", 0.0, end, 100, Scale::Linear, |t| {
            0.5 * (1.0 + libm::exp(-2.0 * t / self.door.time))
        }))
        .with(Series::with_errors("mean of the replicas", Style::Line, measured))
        .with(Series::new("one room", Style::Line, one))
        .noting("Each particle finds the hole by itself: the difference of the halves dies away exponentially.")
    }

    /// Passages per time and particle on the side they come from, over theory.
    fn flux_chart(&self, leaks: &Leaks<D>) -> Chart {
        let stops: Vec<usize> = (0..leaks.times.len()).step_by(SAMPLES / 25).collect();
        let series = |name: &str, of: &dyn Fn(&Reading) -> (f64, f64)| {
            let points = stops.windows(2).filter_map(|w| {
                let (from, to) = (w[0], w[1]);
                let pairs: Vec<[f64; 2]> = leaks
                    .members
                    .iter()
                    .map(|leak| {
                        let (a, b) = (of(&leak.readings[from]), of(&leak.readings[to]));
                        [b.0 - a.0, b.1 - a.1]
                    })
                    .collect();
                let ratio = Estimate::jackknife(&pairs, |[passed, presence]| passed * self.door.time / presence);
                let time = 0.5 * (leaks.times[from] + leaks.times[to]);
                ratio.standard_error.is_finite().then_some((time, ratio.mean, ratio.standard_error))
            });
            Series::with_errors(name, Style::Points, points)
        };
        let name = if D == 2 { "n v/π" } else { "n v/4" };
        Chart::new("flux", "Flux through the hole", Axis::linear("time t", ""), Axis::linear(format!("flux over {name}"), ""))
            .with(Series::theory(name, 0.0, leaks.sampled().max(self.door.time), 2, Scale::Linear, |_| 1.0))
            .with(series("from the left", &|reading| (reading.upward.count as f64, reading.presence[0])))
            .with(series("from the right", &|reading| (reading.downward.count as f64, reading.presence[1])))
            .noting("While the gas streams out, collisions before the hole push it on and those behind are missing; then theory is exact.")
    }
}

impl<const D: usize> Study<D> for Effusion<D> {
    type Specimen = Leak<D>;

    fn draw(&self, leaks: &Leaks<D>, scene: &mut Scene) {
        scene.title = super::EXPERIMENT.title.into();
        scene.colouring = Colouring::Uniform(Colour::Accent(0));
        let (gate, count) = (&leaks.members[0].gate, self.set.particles);
        scene.caption = format!(
            "{} left, {} right   {} passages to the right, {} to the left",
            gate.below(),
            count - gate.below(),
            gate.upward().count,
            gate.downward().count
        );
    }

    fn charts(&self, leaks: &Leaks<D>) -> Vec<Chart> {
        vec![self.share_chart(leaks), self.flux_chart(leaks)]
    }

    fn checks(&self, leaks: &Leaks<D>) -> Vec<Check> {
        if leaks.times.len() <= SAMPLES || leaks.sampled() < 0.9 * DURATION * self.door.time {
            return vec![];
        }
        let half = SAMPLES / 2;
        let span = leaks.times[SAMPLES] - leaks.times[half];
        let of_half = |leak: &Leak<D>| (leak.readings[half], leak.readings[SAMPLES]);
        let both = |reading: &Reading| {
            let Reading { upward, downward, .. } = reading;
            Passages { count: upward.count + downward.count, energy: upward.energy + downward.energy }
        };
        let flux = leaks.mean(|leak| {
            let (from, to) = of_half(leak);
            (both(&to).count - both(&from).count) as f64 / (2.0 * span)
        });
        let count = self.set.particles as f64;
        let share = leaks.mean(|leak| {
            let (from, to) = of_half(leak);
            (to.presence[0] - from.presence[0]) / (span * count)
        });
        let carried: Vec<[f64; 2]> = leaks
            .members
            .iter()
            .map(|leak| {
                let (from, to) = of_half(leak);
                [both(&to).energy - both(&from).energy, (both(&to).count - both(&from).count) as f64]
            })
            .collect();
        let energy = Estimate::jackknife(&carried, |[energy, count]| energy / count) / self.set.temperature;
        let (freedom, d) = ((D * self.set.particles) as f64, D as f64);
        let law = if D == 2 { "n v/pi per length" } else { "n v/4 per area" };
        vec![
            flux.check(
                "flux through the hole, one way",
                self.door.flux(self.set.particles),
                format!("{law} open to centres, at constant energy"),
            ),
            share.check("share in the left half", 0.5, "equal volumes"),
            energy.check(
                "mean energy of those that pass, over kT",
                0.5 * (d + 1.0) * freedom / (freedom + 1.0),
                "(d + 1)/2: the fast come to the hole more often; at constant energy",
            ),
        ]
    }

    fn moments(&self, end: f64) -> Vec<f64> {
        vec![0.0, 0.5 * self.door.time, 2.0 * self.door.time].into_iter().filter(|&time| time < end).collect()
    }
}
