//! What is heard ahead of and behind a source that moves.

use std::f64::consts::TAU;

use corpuscle_observe::chart::Axis;
use corpuscle_observe::{Chart, Check, Series, Style, spectrum};

use super::{COLUMNS, Membrane, SPONGE, theory};

impl Membrane {
    /// Frequencies heard ahead of and behind a moving source, with what the lattice makes of them.
    fn heard(&self, share: f64) -> Vec<(&'static str, spectrum::Line, f64)> {
        let phase = |omega: f64| 2.0 * libm::asin(self.half_sine(omega));
        let speed = share * self.omega_0;
        [("ahead", speed), ("behind", -speed)]
            .into_iter()
            .zip(&self.heard)
            .filter_map(|((name, speed), series)| {
                // From when waves arrive, until the source does or the run ends.
                let far = (COLUMNS - 2 * SPONGE - 14) as f64;
                let arrival = if speed > 0.0 { far } else { 10.0 } / (self.omega_0 * self.dt)
                    + 4.0 * TAU / (self.angular_frequency * self.dt);
                let until = if speed > 0.0 { 0.9 * far / (share * self.omega_0 * self.dt) } else { series.len() as f64 };
                let (from, until) = (arrival as usize, (until as usize).min(series.len()));
                let line = spectrum::strongest_line(series.get(from..until)?, self.dt)?;
                Some((name, line, theory::doppler(self.angular_frequency, speed, phase)?))
            })
            .collect()
    }

    pub(super) fn checks_of_doppler(&self, share: f64) -> Vec<Check> {
        if self.steps < self.last || share >= 0.9 {
            return vec![];
        }
        let check = |(name, line, expected): (&str, spectrum::Line, f64)| {
            let classical = self.angular_frequency / if name == "ahead" { 1.0 - share } else { 1.0 + share };
            Check::at_most(
                format!("frequency {name} of the source, {:.5}: deviation from {expected:.5}", line.frequency.mean),
                (line.frequency.mean - expected).abs(),
                0.1 * line.resolution,
                format!(
                    "Doppler 1842: ω' − v k(ω') = ω on the lattice, ω/(1 ∓ v/c) = {classical:.5} for long waves; bound: a tenth of the \
                     width of a line, for an amplitude that changes meanwhile"
                ),
            )
        };
        self.heard(share).into_iter().map(check).collect()
    }

    pub(super) fn chart_of_doppler(&self, share: f64) -> Chart {
        let mut chart = Chart::new(
            "doppler",
            "What is heard ahead of and behind the source",
            Axis::linear("time t", ""),
            Axis::linear("displacement u", ""),
        );
        for (name, series) in ["ahead", "behind"].into_iter().zip(&self.heard) {
            let stride = series.len().div_ceil(1500).max(1);
            let points = series.iter().enumerate().step_by(stride).map(|(step, &u)| ((step + 1) as f64 * self.dt, u));
            chart = chart.with(Series::new(name, Style::Line, points));
        }
        let heard: Vec<String> = self
            .heard(share)
            .iter()
            .map(|(name, line, theory)| format!("{name} {:.4} (theory {theory:.4})", line.frequency.mean))
            .collect();
        chart.noting(format!("The source shakes at ω = {:.4}; heard: {}.", self.angular_frequency, heard.join(", ")))
    }
}
