//! Dispersion as a map: a ring whose modes all swing at once, each with the same energy and a random phase, taken apart by Fourier
//! in space and in time. Where there is power, there is a wave of that wavenumber and frequency.

use std::f64::consts::{PI, TAU};

use corpuscle_checkpoint::{Resume, resume};
use corpuscle_core::{Failure, Invalid, Random};
use corpuscle_observe::chart::Axis;
use corpuscle_observe::{Chart, Check, Scale, Series, Style, spectrum};
use corpuscle_scene::{Camera, Cell, Colour, Colouring, Label, Line, Map, Scene};
use corpuscle_time::Integrator;

use super::chain::{Chain, Design, Ends, Polarisation};
use super::theory::{self, Modes};
use crate::{Action, Frame, Honesty, Settings, Simulation, Table};

/// Stream of the random phases.
const STREAM: u64 = 0xd15b;
/// Samples in time, each some steps after the one before.
const SAMPLES: u64 = 1024;
const STEPS: u64 = 5;
/// Powers below this share of the highest are not drawn.
const FAINTEST: f64 = 1e-6;

/// The running experiment.
pub(super) struct Spectra {
    chain: Chain,
    modes: Modes,
    omega_0: f64,
    dt: f64,
    /// Amplitude of each mode's cosine part at each sample.
    series: Vec<Vec<f64>>,
    time: f64,
}

resume!(Spectra { values: [series, time], parts: [chain], set_up: [modes, omega_0, dt] });

impl Spectra {
    pub(super) fn new(settings: &Settings) -> Result<Self, Invalid> {
        let (stiffness, mass, spacing) = (settings.real("stiffness"), settings.real("mass"), settings.real("spacing"));
        let omega_0 = (stiffness / mass).sqrt();
        let given = settings.real("time_step");
        let dt = if given > 0.0 { given } else { 0.1 / omega_0 };
        if dt * omega_0 * STEPS as f64 >= 1.5 {
            // Above, the highest frequency would be taken for a lower one.
            return Err(settings.invalid("time_step", format!("less than {:.4}", 1.5 / (omega_0 * STEPS as f64))));
        }
        let count = settings.whole("masses");
        let design = Design {
            masses: vec![mass; count],
            stiffness,
            spacing,
            polarisation: Polarisation::Transverse,
            ends: Ends::Ring,
            integrator: Integrator::VelocityVerlet { dt },
            friction: vec![],
        };
        let Some(modes) = Modes::of(&design).filter(|modes| modes.highest() >= 4) else {
            return Err(settings.invalid("masses", "at least ten of them"));
        };
        let (mut displacement, mut velocity) = (vec![0.0; count], vec![0.0; count]);
        let mut random = Random::new(settings.seed, STREAM);
        for j in 1..=modes.highest() {
            let omega = theory::dispersion(omega_0, modes.phase(j));
            let (sine, cosine) = libm::sincos(TAU * random.uniform());
            for (n, s) in modes.shape(j).into_iter().enumerate() {
                displacement[n] += settings.real("amplitude") * omega_0 / omega * cosine * s;
                velocity[n] += settings.real("amplitude") * omega_0 * sine * s;
            }
        }
        let chain = Chain::new(design, &displacement, &velocity)?;
        let series = vec![vec![]; modes.highest()];
        let mut this = Self { chain, modes, omega_0, dt, series, time: 0.0 };
        this.record();
        Ok(this)
    }

    fn record(&mut self) {
        let displacements = self.chain.displacements();
        let modes = self.modes;
        for (j, series) in (1..).zip(&mut self.series) {
            series.push(theory::project(&displacements, &modes.shape(j)));
        }
    }

    fn interval(&self) -> f64 {
        STEPS as f64 * self.dt
    }

    /// The strongest line of each mode's motion, with what theory says of velocity Verlet's chain: mode, measured, expected.
    fn lines(&self) -> Vec<(usize, spectrum::Line, f64)> {
        let line = |(index, series): (usize, &Vec<f64>)| {
            let omega = theory::dispersion(self.omega_0, self.modes.phase(index + 1));
            Some((index + 1, spectrum::strongest_line(series, self.interval())?, theory::verlet_frequency(omega, self.dt)))
        };
        self.series.iter().enumerate().filter_map(line).collect()
    }

    /// Group velocities `d omega/dk` from the frequencies of the two neighbouring modes: `k a`, measured, theory.
    fn group_velocities(&self) -> Vec<(f64, f64, f64)> {
        let lines = self.lines();
        let a = self.chain.design().spacing;
        let slope = |three: &[(usize, spectrum::Line, f64)]| {
            let phase = self.modes.phase(three[1].0);
            let width = self.modes.phase(three[2].0) - self.modes.phase(three[0].0);
            let measured = a * (three[2].1.frequency.mean - three[0].1.frequency.mean) / width;
            (phase, measured, a * self.slope(phase))
        };
        lines.windows(3).map(slope).collect()
    }

    /// `d omega'/d(ka) = omega_0 cos(ka/2)/cos(omega' dt/2)`.
    fn slope(&self, phase: f64) -> f64 {
        let omega = theory::verlet_frequency(theory::dispersion(self.omega_0, phase), self.dt);
        self.omega_0 * libm::cos(0.5 * phase) / libm::cos(0.5 * omega * self.dt)
    }
}

impl Simulation for Spectra {
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
        (SAMPLES - 1) as f64 * self.interval()
    }

    fn advance(&mut self, to: f64) -> Result<(), Failure> {
        let last = ((to / self.interval() * (1.0 + 1e-12)).floor() as u64).min(SAMPLES - 1);
        while (self.series[0].len() as u64) <= last {
            self.chain.advance((self.chain.steps() + STEPS) as f64 * self.dt)?;
            self.record();
        }
        self.time = self.time.max(to);
        Ok(())
    }

    fn draw(&self, scene: &mut Scene) {
        scene.clear();
        scene.time = self.chain.time();
        scene.title = "Dispersion: what waves there are".into();
        scene.caption = "power against wavenumber and frequency, by Fourier in space and time   line: 2 √(κ/m) sin(ka/2)".into();
        // A frame of 1.5 by 1: the wavenumber ka from 0 to pi, the frequency from 0 to 1.2 times the cutoff.
        let (width, top) = (1.5, 2.4 * self.omega_0);
        scene.camera = Camera::fit([-0.12, -0.08, 0.0], [width + 0.03, 1.04, 0.0]);
        scene.colouring = Colouring::Species(vec!["power, from 10⁻⁶ to 1".into()]);
        // Each mode fluctuates at its own amplitude: powers are over the highest of its own column.
        let column = |series: &Vec<f64>| -> Vec<u8> {
            let powers = spectrum::power_spectrum(series, self.interval());
            let highest = powers.iter().fold(0.0, |most: f64, power| most.max(power.1)).max(f64::MIN_POSITIVE);
            let strength = |power: f64| (255.0 * (1.0 - libm::log(power / highest) / libm::log(FAINTEST)).clamp(0.0, 1.0)) as u8;
            powers.iter().filter(|(omega, _)| *omega <= top).map(|&(_, power)| strength(power)).collect()
        };
        let columns: Vec<Vec<u8>> = self.series.iter().map(column).collect();
        let rows = columns.iter().map(Vec::len).min().unwrap_or(0);
        let cells = (0..rows).flat_map(|row| columns.iter().map(move |column| Cell { species: 0, strength: column[row] }));
        let half = 0.5 * width / columns.len() as f64;
        scene.map = Some(Map { lower: [half, 0.0], upper: [width + half, 1.0], columns: columns.len(), cells: cells.collect() });
        let place = |phase: f64| [width * phase / PI, theory::dispersion(self.omega_0, phase) / top, 0.0];
        for part in 0..200 {
            let (from, to) = (place(PI * f64::from(part) / 200.0), place(PI * f64::from(part + 1) / 200.0));
            scene.lines.push(Line { from, to, width: 1.5, colour: Colour::Accent(1) });
        }
        scene.add_box([0.0; 3], [width, 1.0, 0.0], 1.0, Colour::Wall);
        for (at, text) in [
            ([0.5 * width, -0.05, 0.0], "wavenumber k a, from 0 to π".to_owned()),
            ([-0.06, 1.0 / 1.2, 0.0], "2 √(κ/m)".to_owned()),
            ([-0.06, 0.5, 0.0], "ω".to_owned()),
        ] {
            scene.labels.push(Label { at, text, colour: Colour::Ink });
        }
    }

    fn frame(&self) -> Option<Frame> {
        Some(self.chain.frame())
    }

    fn charts(&self) -> Vec<Chart> {
        let lines = self.lines();
        let frequencies = Chart::new(
            "dispersion",
            "Dispersion: frequency against wavenumber",
            Axis::linear("wavenumber times spacing, k a", "rad"),
            Axis::linear("angular frequency omega", "rad/time"),
        )
        .with(Series::theory("chain, 2 sqrt(kappa/m) sin(ka/2)", 0.0, PI, 200, Scale::Linear, |p| {
            theory::dispersion(self.omega_0, p)
        }))
        .with(Series::new(
            "strongest line of each mode",
            Style::Points,
            lines.iter().map(|l| (self.modes.phase(l.0), l.1.frequency.mean)),
        ))
        .noting("No wave has a frequency above the cutoff 2 sqrt(kappa/m).");
        let velocities = self.group_velocities();
        let a = self.chain.design().spacing;
        let group = Chart::new(
            "group-velocity",
            "Group velocity",
            Axis::linear("wavenumber times spacing, k a", "rad"),
            Axis::linear("d omega/dk", ""),
        )
        .with(Series::theory("a sqrt(kappa/m) cos(ka/2)", 0.0, PI, 120, Scale::Linear, |p| a * self.omega_0 * libm::cos(0.5 * p)))
        .with(Series::new("differences of neighbouring modes", Style::Points, velocities.iter().map(|v| (v.0, v.1))))
        .noting("Long waves run at the speed of sound; the shortest stand still.");
        vec![frequencies, group]
    }

    fn checks(&self) -> Vec<Check> {
        let lines = self.lines();
        if self.time < 0.5 * self.end() || lines.len() < 3 {
            return vec![];
        }
        // The fit sees other modes through rounding only.
        let worst = lines.iter().map(|line| (line.1.frequency.mean - line.2).abs() / line.1.resolution).fold(0.0, f64::max);
        let highest = lines.iter().map(|line| line.1.frequency.mean).fold(0.0, f64::max);
        let cutoff = theory::verlet_frequency(2.0 * self.omega_0, self.dt);
        let slowest = self.group_velocities().iter().map(|v| (v.1 - v.2).abs()).fold(0.0, f64::max);
        // The third derivative of 2 omega_0 sin(ka/2), and the shares that velocity Verlet adds to it.
        let step = self.modes.phase(1);
        let stiff = 1.0 + (self.omega_0 * self.dt) * (self.omega_0 * self.dt);
        let speed = self.chain.design().spacing * self.omega_0;
        vec![
            Check::at_most(
                format!("frequencies of {} modes: largest deviation over the width of a line", lines.len()),
                worst,
                1e-6,
                "omega = 2 sqrt(kappa/m) sin(ka/2), shifted by velocity Verlet; bound: rounding of 1e-16 a step, grown with the square \
                 of some 10^4 steps, over a line of width 2 pi/T",
            ),
            Check::at_most(
                "highest frequency over the cutoff",
                highest / cutoff,
                1.0 + 1e-12,
                "no wave above 2 sqrt(kappa/m), shifted by velocity Verlet",
            ),
            Check::at_most(
                "group velocity: largest deviation over the speed of long waves",
                slowest / speed,
                stiff * step * step / 24.0 + 1e-6,
                "d omega/dk = a sqrt(kappa/m) cos(ka/2), shifted by velocity Verlet; bound: (delta ka)^2/24 of a central difference",
            ),
        ]
    }

    fn honesty(&self) -> Honesty {
        Honesty {
            engine: "time-driven, velocity-verlet".into(),
            work: self.chain.steps(),
            work_unit: "steps",
            stability_number: Some(2.0 * self.omega_0 * self.dt),
            ..Honesty::default()
        }
    }

    fn tables(&self) -> Vec<Table> {
        let columns = ["mode", "ka_rad", "omega_measured", "omega_theory"].map(String::from).to_vec();
        let rows = self.lines().iter().map(|l| vec![l.0 as f64, self.modes.phase(l.0), l.1.frequency.mean, l.2]).collect();
        vec![Table { name: "modes".into(), columns, rows }]
    }

    fn moments(&self) -> Vec<f64> {
        [0.02, 0.1, 0.4].map(|share| share * self.end()).to_vec()
    }

    fn refusal(&self, _: Action) -> Option<&'static str> {
        Some("a chain with one wave: in this one all modes are measured at once")
    }
}
