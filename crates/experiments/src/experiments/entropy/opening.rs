//! The growth of entropy: free expansion of a gas and mixing of two, through a partition that opens, and what happens when
//! all velocities are reversed.
//!
//! Coarse-grained configurational entropy over `K` equal cells of the accessible volume (Boltzmann's `k ln W`):
//! `S / k_B = ln(N! / prod n_i!)`, summed over species. In equilibrium the `n_i` are multinomial but for the hard cores,
//! which lower their variance by the reduced compressibility `chi_T = k_B T dn/dP`; expanding `ln n!` to second order,
//! `<S> = <S>_multinomial + (K - 1)(1 - chi_T)/2` for each species-blind gas. The thermodynamic limit of the rise is
//! `N k_B ln(V_2/V_1)` for the expansion and `k_B sum N_s ln(V/V_s)` for the mixing.

use std::f64::consts::{LN_2, PI};

use corpuscle_checkpoint::{Resume, resume};
use corpuscle_core::{Failure, Invalid, Vector};
use corpuscle_observe::entropy::equilibrium_entropy;
use corpuscle_observe::{Chart, Check, Estimate, Schedule};
use corpuscle_scene::{Colour, Colouring, Label, Region, Scene};

use super::Set;
use super::room::{Process, Room, Sample};
use crate::horizon::precision_horizon;
use crate::replicas::{energy_check, honesty};
use crate::tally::Tally;
use crate::{Action, Frame, Honesty, Probed, Settings, Simulation, drawing, ensemble, hand, peek, probe};

/// Samples taken of each room in the whole duration.
const SAMPLES: usize = 400;
/// Most cells for which the entropy is shown beside the one asked for.
const MOST_CELLS: usize = 1024;
/// Streams of random numbers: replicas of expansion from 0, of mixing from here, the room on show after both.
const MIXING_STREAM: u64 = 1 << 32;
const SHOWN_STREAM: u64 = 1 << 33;

impl<const D: usize> Set<D> {
    /// The cells asked for along the box, and half, twice and four times as many where the halves of the box have whole cells,
    /// and there are not too many.
    pub(super) fn scales(&self) -> Vec<usize> {
        let asked = self.cells_along;
        let others = [asked / 2, 2 * asked, 4 * asked].into_iter();
        let beside = others.filter(|&along| along > 0 && along % 2 == 0 && self.cells(along).len() <= MOST_CELLS);
        std::iter::once(asked).chain(beside).collect()
    }

    /// As long as mixing takes by diffusion, `exp(-14)` of it left, and fifteen crossings at least.
    ///
    /// First Sonine approximation to the self-diffusion of discs, `D = sqrt(kT/pi m)/(2 n s)`, and of spheres,
    /// `3 sqrt(kT/pi m)/(8 n s^2)` (Chapman and Cowling); the slowest mode of the box of length `L` decays with `D (pi/L)^2`.
    fn mixing_time(&self) -> f64 {
        let density = self.particles as f64 / self.boundary.volume();
        let (s, speed) = (2.0 * self.radius, (self.temperature / PI).sqrt());
        let diffusion = if D == 2 { speed / (2.0 * density * s) } else { 3.0 * speed / (8.0 * density * s * s) };
        let wave_number = PI / self.boundary.upper[0];
        (14.0 / (diffusion * wave_number * wave_number)).max(15.0 * self.crossing())
    }

    /// Expected rise of the coarse-grained entropy from behind the partition to equilibrium.
    ///
    /// The correction for hard cores belongs to the total count; a species that shares the cells with another carries its
    /// fraction `x` of it: `Var n_s = n_s (1 - x (1 - chi_T))`.
    pub(super) fn expected_rise(&self, process: Process, along: usize) -> f64 {
        let cells = self.cells(along).len();
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

/// The opening under way.
pub(super) struct Entropy<const D: usize> {
    pub(super) set: Set<D>,
    pub(super) duration: f64,
    schedule: Schedule,
    time: f64,
    pub(super) times: Vec<f64>,
    pub(super) replicas: Vec<Room<D>>,
    pub(super) shown: Room<D>,
    pub(super) echo: Option<Echo<D>>,
    /// Somebody has done more to the room on show than turn it round: it says nothing of conservation any more.
    touched: bool,
}

/// The way out of the room on show, remembered, and how far the way back strays from it.
#[derive(serde::Serialize, serde::Deserialize)]
pub(super) struct Echo<const D: usize> {
    /// Sample at which the velocities are reversed.
    pub(super) turn: usize,
    /// Positions at each sample up to the turn.
    out: Vec<Vec<Vector<D>>>,
    /// Time and largest distance of a particle from its place on the way out.
    pub(super) errors: Vec<(f64, f64)>,
}

impl<const D: usize> Entropy<D> {
    pub(super) fn new(set: Set<D>, settings: &Settings) -> Result<Self, Invalid> {
        let duration = Set::<D>::duration(settings, set.mixing_time());
        let (hole, scales) = ((set.hole_width > 0.0).then_some(set.hole_width), set.scales());
        let count = settings.whole("replicas") as u64;
        let jobs: Vec<(Process, u64)> = (0..count)
            .map(|replica| (Process::Expansion, replica))
            .chain((0..count).map(|replica| (Process::Mixing, MIXING_STREAM + replica)))
            .collect();
        let mut replicas = ensemble::build(&jobs, |&(process, stream)| Room::new(&set, process, hole, &scales, stream))?;
        let shown_process = if settings.word("process") == "mixing" { Process::Mixing } else { Process::Expansion };
        let mut shown = Room::new(&set, shown_process, hole, &scales, SHOWN_STREAM)?;
        shown.vessel.tally = Tally::of(set.particles);
        replicas.iter_mut().chain(std::iter::once(&mut shown)).for_each(Room::sample);
        let interval = duration / SAMPLES as f64;
        let reverse_at = settings.real("reverse_at");
        if reverse_at > 0.5 * duration {
            return Err(settings
                .invalid("reverse_at", format!("at most half of the duration {duration}, so that there is time to come back")));
        }
        let turn = (reverse_at / interval).round() as usize;
        let echo = (turn > 0).then(|| Echo { turn, out: vec![shown.places()], errors: vec![] });
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
                self.shown.vessel.engine.reverse_velocities();
            }
        } else if let Some(mirror) = (2 * echo.turn).checked_sub(sample) {
            let places = self.shown.places();
            let error = places.iter().zip(&echo.out[mirror]).map(|(a, b)| (*a - *b).norm()).fold(0.0, f64::max);
            echo.errors.push((time, error));
        }
    }

    pub(super) fn rooms(&self, process: Process) -> impl Iterator<Item = &Room<D>> {
        self.replicas.iter().filter(move |room| room.process == process)
    }

    /// First sample that counts as equilibrium.
    pub(super) const fn settled() -> usize {
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
    pub(super) fn curve(&self, process: Process, quantity: impl Fn(&Room<D>, &Sample) -> f64) -> Vec<(f64, f64, f64)> {
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
        let start: Vec<f64> = self.rooms(process).map(|room| room.samples[0].entropy()).collect();
        let end = self.settled_means(process, Sample::entropy);
        let rises: Vec<f64> = end.iter().zip(&start).map(|(a, b)| a - b).collect();
        let (name, limit) = match process {
            Process::Expansion => ("entropy of free expansion ΔS", "N k ln(V2/V1)"),
            Process::Mixing => ("entropy of mixing ΔS", "k sum N_s ln(V/V_s)"),
        };
        Estimate::from_replicas(&rises)
            .check(
                name,
                self.set.expected_rise(process, self.set.cells_along),
                format!(
                    "ln(N!/prod n_i!) over {} cells, multinomial with hard-core correction; {limit} = {:.2} for N and K to infinity",
                    self.set.cells(self.set.cells_along).len(),
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
        // A hair behind the last sample, which rounding does not put off then.
        self.duration * (1.0 + 8.0 * f64::EPSILON)
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
        drawing::add_event_driven(scene, &room.vessel.engine, &room.vessel.tally, room.vessel.started(), |i| {
            f64::from(room.species[i])
        });
        scene.colouring = match room.process {
            Process::Expansion => Colouring::Uniform(Colour::Accent(0)),
            Process::Mixing => Colouring::Species(vec!["started left".into(), "started right".into()]),
        };
        let count = self.set.particles;
        let middle = 0.5 * self.set.boundary.upper[0];
        let left = (0..count).filter(|&i| room.vessel.engine.position(i)[0] < middle).count();
        if D == 2 {
            let height = self.set.boundary.upper[1];
            scene.regions.push(Region { lower: [0.0, 0.0], upper: [middle, height], colour: Colour::Tint(0) });
            for (x, number) in [(0.5 * middle, left), (1.5 * middle, count - left)] {
                scene.labels.push(Label { at: [x, 0.045 * height, 0.0], text: number.to_string(), colour: Colour::Ink });
            }
        }
        let rise = room.samples.last().map_or(0.0, |sample| room.rise(sample));
        scene.title = super::EXPERIMENT.title.into();
        scene.caption = format!(
            "{left} left, {} right   S − S₀ = {rise:.1} k_B (equilibrium {:.1})",
            count - left,
            self.set.expected_rise(room.process, self.set.cells_along)
        );
    }

    fn frame(&self) -> Option<Frame> {
        let room = &self.shown;
        let names: &[&str] = match room.process {
            Process::Expansion => &["particles"],
            Process::Mixing => &["started left", "started right"],
        };
        let species = room.species.iter().map(|&species| if names.len() > 1 { species } else { 0 });
        Some(Frame::of_hard(&room.vessel.engine, room.vessel.started(), names).with_species(species))
    }

    fn charts(&self) -> Vec<Chart> {
        let other = if self.shown.process == Process::Expansion { Process::Mixing } else { Process::Expansion };
        let mut charts =
            vec![self.entropy_chart(self.shown.process), self.entropy_chart(other), self.scales_chart(), self.left_chart()];
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
            let left_over = self.shown.rise(&self.shown.samples[2 * echo.turn]).abs();
            checks.push(
                Check::at_most("entropy left over after reversal", left_over, 0.0, "the same cells hold the same numbers again")
                    .with_unit("k_B"),
            );
        }
        checks.extend(energy_check(&self.honesty()));
        checks
    }

    fn honesty(&self) -> Honesty {
        let rooms = self.replicas.iter().chain((!self.touched).then_some(&self.shown));
        let of_each = rooms.map(|room| (&room.vessel.engine, Some(room.vessel.energy())));
        Honesty { precision_horizon: precision_horizon(&self.shown.vessel.engine), ..honesty(of_each) }
    }

    fn next_event(&self) -> Option<f64> {
        let vessel = &self.shown.vessel;
        peek::next_contact(&vessel.engine, 1.5 * self.duration).map(|time| time - vessel.started())
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

    fn probe(&mut self, corners: Option<[[f64; 2]; 2]>) {
        let vessel = &mut self.shown.vessel;
        vessel.tally.lay(corners.and_then(|corners| probe::Region::lay(&vessel.engine, corners)));
    }

    fn probed(&self) -> Option<Probed> {
        probe::read(&self.shown.vessel.engine, &self.shown.vessel.tally)
    }

    fn refusal(&self, action: Action) -> Option<&'static str> {
        hand::wanting_of_number(&self.shown.vessel.engine, action)
    }

    fn act(&mut self, action: Action) -> Result<(), Invalid> {
        hand::on_number(&mut self.shown.vessel.engine, action)?;
        self.touched |= action != Action::Reverse;
        // A hand on the system ends the comparison with the remembered way.
        self.echo = None;
        Ok(())
    }
}
