//! What is measured on braked chains, beside theory.

use std::f64::consts::{PI, TAU};

use corpuscle_observe::chart::{Axis, Chart, Scale, Series, Style};

use super::trial::Purpose;
use super::{Braked, Subject, long_echo, theory, watched};

/// Pieces that the curves of a resonance are drawn in.
const PARTS: usize = 1200;

impl Braked {
    pub(super) fn all_charts(&self) -> Vec<Chart> {
        match self.subject {
            Subject::End { impedance } => vec![self.echo_chart(), self.energy_chart(impedance)],
            Subject::Mode { number, omega, gamma } => vec![self.release_chart(number, omega, gamma), self.decay_chart(omega)],
            Subject::Shaken { omega, gamma } => {
                let mut charts = self.resonance_charts(gamma).to_vec();
                charts.push(self.standing_chart(omega, gamma));
                charts
            }
        }
    }

    /// Where each trial that is done was measured, and the two numbers.
    fn found(&self) -> impl Iterator<Item = (f64, [f64; 2])> {
        self.trials.iter().filter_map(|trial| {
            let at = match trial.purpose {
                Purpose::Echo { impedance } => impedance,
                Purpose::Decay { gamma, .. } => gamma,
                Purpose::Response { omega, .. } => omega,
            };
            Some((at, trial.finding?.measured))
        })
    }

    fn echo_chart(&self) -> Chart {
        let (least, most) = self.trials.iter().fold((0.1, 10.0), |(least, most): (f64, f64), trial| match trial.purpose {
            Purpose::Echo { impedance } if impedance > 0.0 => (least.min(impedance), most.max(impedance)),
            _ => (least, most),
        });
        Chart::new(
            "end",
            "Echo from a damper",
            Axis::logarithmic("impedance of the damper over that of the string, Z'/Z", ""),
            Axis::linear("amplitude of the echo", ""),
        )
        .with(Series::theory("(Z - Z')/(Z + Z')", least, most, 120, Scale::Logarithmic, long_echo))
        .with(Series::new("measured", Style::Points, self.found().filter(|(z, _)| *z > 0.0).map(|(z, [echo, _])| (z, echo))))
        .noting("A damper like the string takes the pulse as more string would: nothing comes back.")
    }

    fn energy_chart(&self, impedance: f64) -> Chart {
        let whole = self.samples[0].1;
        let last = self.samples.last().map_or(0.0, |sample| sample.0);
        let level = long_echo(impedance).powi(2);
        Chart::new("energy", "Energy against time", Axis::linear("time t", ""), Axis::linear("energy over that at the start", ""))
            .with(Series::new("left by the damper, R^2", Style::Theory, [(0.0, level), (last, level)]))
            .with(Series::new("total", Style::Line, self.samples.iter().map(|&(t, energy, _)| (t, energy / whole))))
            .noting("The damper takes what does not come back.")
    }

    fn release_chart(&self, number: usize, omega: f64, gamma: f64) -> Chart {
        let last = self.samples.last().map_or(0.0, |sample| sample.0).max(1.0);
        let release = |t: f64| theory::release(omega, gamma, t);
        let q = self.samples.iter().map(|&(t, _, q)| (t, q / self.amplitude));
        Chart::new(
            "decay",
            format!("Mode {number}, let go"),
            Axis::linear("time t", ""),
            Axis::linear("displacement over that at the start", ""),
        )
        .with(Series::theory("exp(−γt/2)", 0.0, last, 200, Scale::Linear, |t| libm::exp(-0.5 * gamma * t)))
        .with(Series::theory("damped oscillator", 0.0, last, 800, Scale::Linear, release))
        .with(Series::new("chain", Style::Points, q.step_by(2)))
        .noting("Friction on every mass takes the same share of all modes in a time, whatever their frequency.")
    }

    fn decay_chart(&self, omega: f64) -> Chart {
        let points = |which: usize| self.found().map(move |(gamma, measured)| (0.5 * gamma / omega, measured[which] / omega));
        Chart::new(
            "friction",
            "Frequency and decay of a mode against friction",
            Axis::linear("friction over the critical one, γ/2ω", ""),
            Axis::linear("over the frequency without friction", ""),
        )
        .with(Series::theory("frequency, sqrt(1 − (γ/2ω)²)", 0.0, 1.0, 200, Scale::Linear, |x| (1.0 - x * x).max(0.0).sqrt()))
        .with(Series::new("frequency, measured", Style::Points, points(0)))
        .with(Series::theory("rate of decay, γ/2ω", 0.0, 1.0, 2, Scale::Linear, |x| x))
        .with(Series::new("rate of decay, measured", Style::Points, points(1)))
        .noting("A little friction shortens the life of a mode at once, and lowers its frequency to second order only.")
    }

    /// Amplitude and phase of one mass against the frequency of the shaker.
    fn resonance_charts(&self, gamma: f64) -> [Chart; 2] {
        let (omega_0, count) = (self.material.omega_0(), self.chain.design().count());
        let mass = watched(count);
        let places: Vec<f64> = self
            .trials
            .iter()
            .filter_map(|trial| if let Purpose::Response { omega, .. } = trial.purpose { Some(omega) } else { None })
            .collect();
        let (least, most) = (places[0], places[places.len() - 1]);
        let amplitude = |omega: f64| {
            let (a, b) = theory::response(omega, gamma, omega_0, count)[mass];
            a.hypot(b)
        };
        // The phase without jumps, followed from rest.
        let mut phases: Vec<(f64, f64)> = vec![];
        for part in 0..=PARTS {
            let omega = least + (most - least) * part as f64 / PARTS as f64;
            let (a, b) = theory::response(omega, gamma, omega_0, count)[mass];
            let last = phases.last().map_or(0.0, |entry| entry.1);
            phases.push((omega, near(libm::atan2(b, a), last)));
        }
        let lag = |omega: f64| {
            let part = ((omega - least) / (most - least) * PARTS as f64).round().clamp(0.0, PARTS as f64);
            phases[part as usize].1
        };
        let x = || Axis::linear("angular frequency of the shaker omega", "rad/time");
        [
            Chart::new(
                "resonance",
                "Resonance: amplitude against frequency",
                x(),
                Axis::logarithmic("amplitude over the shaker's", ""),
            )
            .with(Series::theory("chain with friction", least, most, PARTS, Scale::Linear, amplitude))
            .with(Series::new("measured", Style::Points, self.found().map(|(omega, [a, b])| (omega, a.hypot(b)))))
            .noting(format!("Mass {} of {count}: near each of its modes the chain swings far more than the shaker.", mass + 1)),
            Chart::new("phase", "Resonance: phase against frequency", x(), Axis::linear("phase after the shaker", "π"))
                .with(Series::new("chain with friction", Style::Theory, phases.iter().map(|&(omega, phase)| (omega, phase / PI))))
                .with(Series::new(
                    "measured",
                    Style::Points,
                    self.found().map(|(omega, [a, b])| (omega, near(libm::atan2(b, a), lag(omega)) / PI)),
                ))
                .noting("In a resonance the phase passes a quarter of a turn, and beyond it the chain moves against the shaker."),
        ]
    }

    /// Amplitude along the chain on show: nodes and antinodes.
    fn standing_chart(&self, omega: f64, gamma: f64) -> Chart {
        let design = self.chain.design();
        let expected = theory::response(omega, gamma, self.material.omega_0(), design.count());
        let place = |n: usize| design.place(n);
        let theory = expected.iter().enumerate().map(|(n, (a, b))| (place(n), a.hypot(*b)));
        let chart = Chart::new(
            "standing",
            "Standing wave: amplitude along the chain",
            Axis::linear("position x", ""),
            Axis::linear("amplitude over the shaker's", ""),
        )
        .with(Series::new("chain with friction", Style::Theory, theory));
        if self.locked == 0 {
            return chart;
        }
        let scale = 2.0 / (self.locked as f64 * self.amplitude);
        let measured = self.lock.iter().enumerate().map(|(n, (a, b))| (place(n), scale * a.hypot(*b)));
        chart
            .with(Series::new("measured over the last periods", Style::Points, measured))
            .noting("Waves to and fro make nodes where they cancel, and antinodes between them; friction lifts the nodes a little.")
    }
}

/// The same angle, nearest to another.
fn near(angle: f64, other: f64) -> f64 {
    angle + TAU * libm::round((other - angle) / TAU)
}
