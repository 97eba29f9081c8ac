//! Maxwell's demon: a door at a hole, opened for some and shut for others, without work and without friction.
//!
//! Whoever comes to the door is looked at: one decision, one bit. A demon that lets all pass to the right and none to the left makes
//! a pressure; one that lets the fast pass to the right and the slow to the left makes a difference of temperatures. The entropy of
//! the gas, `sum over the sides of N_s (ln(V/N_s) + (d/2) ln T_s)`, falls, and no law of mechanics is broken: energy is conserved to
//! rounding. What saves the second law is the demon's memory (Szilard 1929, doi:10.1007/BF01341281; Landauer 1961,
//! doi:10.1147/rd.53.0183; Bennett 1982, doi:10.1007/BF02084158). To wipe it costs at least `k h` a decision, with Shannon's
//! `h(p) = -p ln p - (1 - p) ln(1 - p)` of the answers, at most `k ln 2`; and the gas never loses more.
//!
//! Where all are on the right at last, the shut door is a piece of wall: knocks come at the rate `P/sqrt(2 pi m kT)` an area.

use std::f64::consts::LN_2;
use std::ops::ControlFlow;

use corpuscle_checkpoint::resume;
use corpuscle_core::{Engine, Failure, Invalid, Observer, Random};
use corpuscle_observe::chart::{Axis, Scale, Series, Style};
use corpuscle_observe::{Chart, Check, Estimate, Gate, entropy, theory};
use corpuscle_scene::{Colour, Colouring, Scene};

use super::Set;
use super::effusion::Door;
use super::room::{self, Process};
use crate::replicas::{Member, Replicas};
use crate::study::{Running, Specimen, Study, Vessel};
use crate::{Settings, ensemble};

/// Samples in the whole duration.
const SAMPLES: usize = 100;
/// Duration in times `tau` in which one passes for each particle on a side.
const DURATION: f64 = 6.0;
/// From here on nearly all are on the right.
const SETTLED: usize = 60;

/// The demon at work.
pub(super) fn start<const D: usize>(set: Set<D>, settings: &Settings) -> Result<Running<D, Demon<D>>, Invalid> {
    let hole = set.hole(settings)?;
    let door = Door::new(&set, hole);
    let rule = if settings.word("rule") == "all" { Rule::All } else { Rule::Fast };
    let duration = Set::<D>::duration(settings, DURATION * door.time);
    let streams: Vec<u64> = (0..settings.whole("replicas") as u64).collect();
    let rooms = ensemble::build(&streams, |&stream| Guarded::new(&set, rule, hole, stream))?;
    Ok(Running::new(Demon { set, door, rule }, duration, SAMPLES, rooms))
}

/// Whom the demon lets pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Rule {
    /// Everybody to the right, nobody to the left.
    All,
    /// Those with more than the mean energy of those that come, `(d + 1) kT/2`, to the right; the others to the left.
    Fast,
}

/// What is asked.
pub(super) struct Demon<const D: usize> {
    set: Set<D>,
    door: Door,
    rule: Rule,
}

/// What was noted at one sampling time; of pairs the left comes first.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
struct Reading {
    count: [usize; 2],
    energy: [f64; 2],
    /// Decisions so far: those that knocked from either side, and those of them that passed.
    knocks: [u64; 2],
    passed: [u64; 2],
    /// Time integrals of the numbers on either side.
    presence: [f64; 2],
}

/// A room with a demon.
pub(super) struct Guarded<const D: usize> {
    vessel: Vessel<D>,
    gate: Gate,
    knocks: [u64; 2],
    passed: [u64; 2],
    readings: Vec<Reading>,
    rule: Rule,
    threshold: f64,
}

resume!(Guarded<const D> { values: [gate, knocks, passed, readings], parts: [vessel], set_up: [rule, threshold] });

impl<const D: usize> Guarded<D> {
    fn new(set: &Set<D>, rule: Rule, hole: f64, stream: u64) -> Result<Self, Invalid> {
        let mut random = Random::new(set.seed, stream);
        let particles = room::apart(set, Process::Mixing, &mut random)?;
        let mut divided = set.boundary.clone();
        divided.partitions.push(set.plate(None));
        let wait = 2.0 * super::COLLISIONS_BEFORE / set.collision_rate;
        let mut vessel = Vessel::new(divided.clone(), particles, wait, &mut random)?;
        divided.partitions = vec![set.plate(Some(hole))];
        vessel.engine.set_boundary(divided)?;
        let gate = Gate::new(0, set.middle(), vessel.engine.time(), &vessel.engine.snapshot());
        let threshold = 0.5 * (D as f64 + 1.0) * set.temperature;
        Ok(Self { vessel, gate, knocks: [0; 2], passed: [0; 2], readings: vec![], rule, threshold })
    }

    /// Somebody is at the door.
    fn decide(&mut self, due: f64, particle: usize) {
        let (rightwards, fast) = (self.gate.is_below(particle), self.gate.energy(particle) > self.threshold);
        let side = usize::from(!rightwards);
        self.knocks[side] += 1;
        let opens = match self.rule {
            Rule::All => rightwards,
            Rule::Fast => rightwards == fast,
        };
        if opens {
            self.passed[side] += 1;
            self.gate.settle(due);
        } else {
            self.gate.refuse(particle);
            self.vessel.engine.set_velocities(|i, velocity| {
                if i == particle {
                    velocity[0] = -velocity[0];
                }
            });
        }
    }
}

impl<const D: usize> Member for Guarded<D> {
    fn advance(&mut self, time: f64) -> Result<(), Failure> {
        let end = self.vessel.started() + time;
        loop {
            let stop = self.gate.next().map_or(end, |(due, _)| due.min(end));
            let gate = &mut self.gate;
            // After a contact on the way somebody else may come sooner.
            self.vessel.advance_to(stop, &mut |contact| {
                gate.contact(contact)?;
                if gate.next().is_some_and(|(due, _)| due < stop) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            })?;
            let now = self.vessel.engine.time();
            match self.gate.next() {
                Some((due, particle)) if due <= now => self.decide(due, particle),
                _ if now >= end => return Ok(()),
                _ => {}
            }
        }
    }

    fn sample(&mut self) {
        let (mut count, mut energy) = ([0; 2], [0.0; 2]);
        for i in 0..self.vessel.engine.particle_count() {
            let side = usize::from(!self.gate.is_below(i));
            count[side] += 1;
            energy[side] += 0.5 * self.vessel.engine.velocity(i).norm_squared();
        }
        self.gate.settle(self.vessel.engine.time());
        let presence = self.gate.presence();
        self.readings.push(Reading { count, energy, knocks: self.knocks, passed: self.passed, presence });
    }

    fn time(&self) -> f64 {
        self.vessel.time()
    }
}

impl<const D: usize> Specimen<D> for Guarded<D> {
    fn vessel(&self) -> &Vessel<D> {
        &self.vessel
    }

    fn vessel_mut(&mut self) -> &mut Vessel<D> {
        &mut self.vessel
    }
}

type Rooms<const D: usize> = Replicas<Guarded<D>>;

impl<const D: usize> Demon<D> {
    /// Entropy of the gas on both sides, up to a constant a particle.
    fn entropy(&self, reading: &Reading) -> f64 {
        let side = |s: usize| match reading.count[s] {
            0 => 0.0,
            count => {
                let temperature = 2.0 * reading.energy[s] / (D * count) as f64;
                entropy::ideal_gas(count as u64, D, 0.5 * self.set.boundary.volume(), temperature, 1.0)
            }
        };
        side(0) + side(1)
    }

    /// Loss of the gas since the start, at each sampling time.
    fn losses(&self, rooms: &Rooms<D>) -> Vec<(f64, Estimate)> {
        let of = |k: usize| rooms.mean(|room| self.entropy(&room.readings[0]) - self.entropy(&room.readings[k]));
        rooms.times.iter().enumerate().map(|(k, &time)| (time, of(k))).collect()
    }

    /// What the memory of a room holds at each sampling time: decisions times `ln 2`, and what they can be compressed to by somebody
    /// who knows how many of all rooms' knocks in that interval were let in.
    fn memory(rooms: &Rooms<D>) -> Vec<[f64; 2]> {
        let mut sum = [0.0; 2];
        let replicas = rooms.members.len() as f64;
        let total = |k: usize| {
            let of_all = |value: &dyn Fn(&Reading) -> [u64; 2]| {
                rooms.members.iter().map(|room| value(&room.readings[k]).iter().sum::<u64>()).sum::<u64>() as f64
            };
            [of_all(&|reading| reading.knocks), of_all(&|reading| reading.passed)]
        };
        let steps = (1..rooms.times.len()).map(|k| {
            let ([knocks, passed], [before, passed_before]) = (total(k), total(k - 1));
            let (decisions, passages) = (knocks - before, passed - passed_before);
            sum[0] += decisions * LN_2 / replicas;
            if decisions > 0.0 {
                sum[1] += decisions * shannon(passages / decisions) / replicas;
            }
            sum
        });
        std::iter::once([0.0; 2]).chain(steps).collect()
    }

    fn balance_chart(&self, rooms: &Rooms<D>) -> Chart {
        let count = self.set.particles as f64;
        let memory = Self::memory(rooms);
        let line =
            |index: usize| rooms.times.iter().zip(&memory).map(move |(&time, sum)| (time, sum[index] / count)).collect::<Vec<_>>();
        let losses = self.losses(rooms).into_iter().map(|(time, loss)| (time, loss.mean / count, loss.standard_error / count));
        let mut chart = Chart::new(
            "demon",
            "What the demon takes from the gas, and what its memory takes up",
            Axis::linear("time t", ""),
            Axis::linear("entropy/N", "k_B"),
        );
        if self.rule == Rule::All {
            let end = rooms.sampled().max(self.door.time);
            chart = chart.with(Series::theory("all on one side, ln 2", 0.0, end, 2, Scale::Linear, |_| LN_2));
        }
        chart
            .with(Series::with_errors("taken from the gas", Style::Line, losses))
            .with(Series::new("memory, compressed: Shannon's entropy of the answers", Style::Line, line(1)))
            .noting("The gas never loses more than the memory gains: the second law counts the demon, too. A bit a decision is more still.")
    }

    fn side_chart(&self, rooms: &Rooms<D>) -> Chart {
        let count = self.set.particles as f64;
        let series = |name: &str, of: &dyn Fn(&Reading) -> f64| {
            let points = rooms.times.iter().enumerate().map(|(k, &time)| {
                let value = rooms.mean(|room| of(&room.readings[k]));
                (time, value.mean, value.standard_error)
            });
            Series::with_errors(name, Style::Line, points.filter(|point| point.1.is_finite()))
        };
        let end = rooms.sampled().max(self.door.time);
        let temperature =
            |reading: &Reading, side: usize| 2.0 * reading.energy[side] / (D * reading.count[side]) as f64 / self.set.temperature;
        match self.rule {
            Rule::All => Chart::new(
                "sides",
                "Share of particles in the left half",
                Axis::linear("time t", ""),
                Axis::linear("share n_left/N", ""),
            )
            .with(Series::theory("small hole, ½ exp(−t/τ)", 0.0, end, 100, Scale::Linear, |t| {
                0.5 * libm::exp(-t / self.door.time)
            }))
            .with(series("measured", &|reading| reading.count[0] as f64 / count))
            .noting("Nobody is let back: without any work the left half is emptied."),
            Rule::Fast => Chart::new(
                "sides",
                "Temperatures of the halves",
                Axis::linear("time t", ""),
                Axis::linear("T of a half over T", ""),
            )
            .with(Series::theory("at the start", 0.0, end, 2, Scale::Linear, |_| 1.0))
            .with(series("left, of the slow", &|reading| temperature(reading, 0)))
            .with(series("right, of the fast", &|reading| temperature(reading, 1)))
            .noting("A heat engine could run between the halves, at the demon's expense."),
        }
    }
}

/// `h(p)` in natural units.
fn shannon(p: f64) -> f64 {
    let term = |p: f64| if p > 0.0 { -p * libm::log(p) } else { 0.0 };
    term(p) + term(1.0 - p)
}

impl<const D: usize> Study<D> for Demon<D> {
    type Specimen = Guarded<D>;

    fn draw(&self, rooms: &Rooms<D>, scene: &mut Scene) {
        scene.title = super::EXPERIMENT.title.into();
        scene.colouring = match self.rule {
            Rule::All => Colouring::Uniform(Colour::Accent(0)),
            Rule::Fast => Colouring::Speed { most: 3.0 * self.set.thermal_speed(), unit: String::new() },
        };
        let room = &rooms.members[0];
        let (knocks, passed) = (room.knocks.iter().sum::<u64>(), room.passed.iter().sum::<u64>());
        let lost = room.readings.last().map_or(0.0, |reading| self.entropy(&room.readings[0]) - self.entropy(reading));
        scene.caption = format!(
            "{knocks} decisions, {passed} let in   taken from the gas {lost:.1} k_B, memory {:.1} k_B",
            knocks as f64 * LN_2
        );
    }

    fn charts(&self, rooms: &Rooms<D>) -> Vec<Chart> {
        vec![self.balance_chart(rooms), self.side_chart(rooms)]
    }

    fn checks(&self, rooms: &Rooms<D>) -> Vec<Check> {
        if rooms.times.len() <= SAMPLES {
            return vec![];
        }
        let (memory, losses) = (Self::memory(rooms), self.losses(rooms));
        let (held, loss) = (memory[SAMPLES][1], losses[SAMPLES].1);
        let mut checks = vec![
            Check::at_most(
                "entropy taken from the gas",
                loss.mean,
                held,
                "Landauer: what the demon's memory takes up, Shannon's entropy of its answers",
            )
            .with_unit("k_B"),
        ];
        if self.rule == Rule::All && rooms.sampled() >= 0.9 * DURATION * self.door.time {
            let late: Vec<[f64; 3]> = rooms
                .members
                .iter()
                .map(|room| {
                    let (from, to) = (room.readings[SETTLED], room.readings[SAMPLES]);
                    let each = room.readings[SETTLED..].iter().map(|reading| reading.energy[1] / reading.count[1] as f64);
                    let energy = each.sum::<f64>() / (SAMPLES - SETTLED + 1) as f64;
                    [(to.knocks[1] - from.knocks[1]) as f64, to.presence[1] - from.presence[1], energy]
                })
                .collect();
            // The slow are the last to come over, so that those who have are a little hotter than all.
            let speed = |energy: f64| (2.0 * energy / (D as f64 * self.set.temperature)).sqrt();
            // As at any wall the density is P/kT; each particle has N - 1 partners.
            let count = self.set.particles as f64;
            let pressure = 1.0 + (theory::compressibility::<D>(2.0 * self.set.packing_fraction) - 1.0) * (count - 1.0) / count;
            let rate = |[knocks, presence, energy]: [f64; 3]| knocks * self.door.time / (presence * speed(energy));
            checks.push(Estimate::jackknife(&late, rate).check(
                "knocks at the shut door, of each particle behind it in the time τ",
                pressure,
                "P/kT sqrt(kT/(2 pi m)) on the hole at the temperature of those behind it",
            ));
        }
        checks
    }

    fn moments(&self, end: f64) -> Vec<f64> {
        vec![0.0, self.door.time, 3.0 * self.door.time].into_iter().filter(|&time| time < end).collect()
    }
}
