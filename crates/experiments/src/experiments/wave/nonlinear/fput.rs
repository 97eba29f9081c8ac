//! The chain of Fermi, Pasta, Ulam and Tsingou (1955, doi:10.2172/4376203): energy put into the lowest mode goes into a few others
//! and comes back, where statistical mechanics expected it to spread.

use std::f64::consts::PI;

use corpuscle_checkpoint::resume;
use corpuscle_core::Invalid;
use corpuscle_observe::chart::Axis;
use corpuscle_observe::{Chart, Check, Series, Style};
use corpuscle_time::Integrator;

use super::{Material, Row};
use crate::{Settings, Table};

/// Modes shown.
const SHOWN: usize = 5;
/// Most points of a series.
const MOST: usize = 1500;

/// Energies of the modes against time.
pub(super) struct Recurrence {
    material: Material,
    alpha: f64,
    amplitude: f64,
    mode: usize,
    /// Time, and the energy of each mode over that at the start, with the step, with twice the step, and with theirs.
    series: [Vec<(f64, Vec<f64>)>; 3],
}

resume!(Recurrence { values: [series], set_up: [material, alpha, amplitude, mode] });

impl Recurrence {
    pub(super) fn new(settings: &Settings, material: Material) -> Result<Self, Invalid> {
        let (amplitude, mode) = (settings.real("amplitude"), settings.whole("mode"));
        if mode > material.masses {
            return Err(settings.invalid("mode", format!("a whole number from 1 to {}", material.masses)));
        }
        let strain = amplitude * mode as f64 * PI / (material.masses + 1) as f64;
        if strain > 0.3 * material.spacing {
            let most = 0.3 * material.spacing / strain * amplitude;
            return Err(settings.invalid("amplitude", format!("at most {most:.4}: masses must keep their order")));
        }
        Ok(Self { material, alpha: settings.real("nonlinearity"), amplitude, mode, series: [vec![], vec![], vec![]] })
    }

    pub(super) fn alpha(&self) -> f64 {
        self.alpha
    }

    pub(super) fn amplitude(&self) -> f64 {
        self.amplitude
    }

    /// The arithmetic of 1955: leapfrog with `omega_0 dt = sqrt(1/8)`. Its own error weakens the dispersion,
    /// `omega' = omega_0 k (1 - k^2 (1 - omega_0^2 dt^2)/24)`, by an eighth, and the return, which comes the later the weaker the
    /// dispersion (as its inverse root, in the continuum's limit: Zabusky and Kruskal 1965, doi:10.1103/PhysRevLett.15.240), is late.
    pub(super) fn original(&self) -> Integrator {
        Integrator::VelocityVerlet { dt: 0.125f64.sqrt() / self.material.omega_0() }
    }

    /// `A sin(j n pi/(N + 1))`.
    pub(super) fn start(&self) -> Vec<f64> {
        (0..self.material.masses + 2).map(|n| self.amplitude * self.shape(self.mode, n)).collect()
    }

    fn shape(&self, mode: usize, n: usize) -> f64 {
        libm::sin(mode as f64 * n as f64 * PI / (self.material.masses + 1) as f64)
    }

    fn frequency(&self, mode: usize) -> f64 {
        2.0 * self.material.omega_0() * libm::sin(0.5 * mode as f64 * PI / (self.material.masses + 1) as f64)
    }

    /// Period of the lowest mode without nonlinearity.
    fn period(&self) -> f64 {
        2.0 * PI / self.frequency(1)
    }

    /// Long enough for the first return, at some `0.44 N^(3/2)/sqrt(alpha A)` periods (Toda 1975,
    /// doi:10.1016/0370-1573(75)90018-6, after Zabusky).
    pub(super) fn end(&self) -> f64 {
        let count = (self.material.masses + 1) as f64;
        let strength = self.alpha.abs() * self.amplitude;
        let periods = if strength > 0.0 { 0.44 * count.powi(3).sqrt() / strength.sqrt() } else { 100.0 };
        1.1 * periods.min(2000.0) * self.period()
    }

    /// Energy of each mode over that of the start, `(Q'^2 + omega^2 Q^2)/2`; in the nonlinear part of the springs there is more.
    fn shares(&self, row: &Row) -> Vec<f64> {
        let (u, v) = (row.displacements(), row.velocities());
        let initial = self.amplitude * self.frequency(self.mode);
        let share = |mode: usize| {
            let project = |values: &[f64]| {
                let sum: f64 = (1..=self.material.masses).map(|n| values[n] * self.shape(mode, n)).sum();
                2.0 / (self.material.masses + 1) as f64 * sum
            };
            let (q, w) = (self.frequency(mode) * project(&u), project(&v));
            (q * q + w * w) / (initial * initial)
        };
        (1..=self.material.masses.min(12)).map(share).collect()
    }

    pub(super) fn see(&mut self, rows: &[Row]) {
        for (which, row) in rows.iter().enumerate() {
            let entry = (corpuscle_core::Engine::time(&row.engine), self.shares(row));
            self.series[which].push(entry);
        }
    }

    pub(super) fn shares_now(&self) -> Vec<f64> {
        self.series[0].last().map_or(vec![], |(_, shares)| shares.iter().copied().take(8).collect())
    }

    pub(super) fn caption(&self) -> String {
        let Some((time, shares)) = self.series[0].last() else { return String::new() };
        format!(
            "α = {}   {:.1} periods of mode 1   {:.1} % of the energy in mode {}",
            self.alpha,
            time / self.period(),
            100.0 * shares.get(self.mode - 1).copied().unwrap_or(f64::NAN),
            self.mode
        )
    }

    /// The first return: after the mode has lost half of its energy, the greatest share it has again, with its time.
    fn first_return(&self, which: usize) -> Option<(f64, f64)> {
        let of_mode = |entry: &(f64, Vec<f64>)| entry.1.get(self.mode - 1).copied().unwrap_or(0.0);
        let series = &self.series[which];
        let lost = series.iter().position(|entry| of_mode(entry) < 0.2)?;
        let peak = series[lost..].iter().max_by(|a, b| of_mode(a).total_cmp(&of_mode(b)))?;
        // One that is still rising at the end has not been seen yet.
        let last = series.last()?;
        (peak.0 < last.0).then(|| (peak.0 / self.period(), of_mode(peak)))
    }

    pub(super) fn checks(&self) -> Vec<Check> {
        let original = self.material.masses == 31 && (self.alpha * self.amplitude - 0.25).abs() < 1e-12 && self.mode == 1;
        let returns = [0, 1, 2].map(|which| self.first_return(which));
        let ([Some((periods, share)), Some((coarse, _)), Some((theirs, _))], true) = (returns, original) else { return vec![] };
        let sampling = self.series[0].get(1).map_or(0.0, |entry| entry.0 / self.period());
        vec![
            Check::at_least(
                "share of the energy that returns to mode 1",
                share,
                0.95,
                "Fermi, Pasta, Ulam and Tsingou 1955 (doi:10.2172/4376203): to within a few per cent of the initial value",
            ),
            Check::at_most(
                format!("first return as computed in 1955, after {theirs:.1} periods of mode 1: deviation from 157"),
                (theirs - 157.0).abs(),
                3.0,
                "figure 1 of the same: 28,000 cycles of leapfrog with a step of sqrt(1/8), read to 500 of them",
            ),
            Check::at_most(
                format!("first return, after {periods:.1} periods: relative deviation from sqrt(7/8) of that of 1955"),
                (periods / theirs / 0.875f64.sqrt() - 1.0).abs(),
                0.01 + 2.0 * sampling / periods,
                "their step weakens the dispersion by an eighth, and the return comes as its inverse root (Zabusky and Kruskal 1965, \
                 doi:10.1103/PhysRevLett.15.240); bound: the next order in k²/24 of the modes that take part, and the sampling",
            ),
            Check::at_most(
                "time of the first return in periods of mode 1: change when the step is doubled",
                (periods - coarse).abs(),
                1.001 * sampling,
                "a result of the chain and not of the step: the maximum stays within a sample",
            ),
        ]
    }

    pub(super) fn charts(&self) -> Vec<Chart> {
        let mut chart = Chart::new(
            "recurrence",
            "Energy of the lowest modes",
            Axis::linear("time in periods of mode 1", ""),
            Axis::linear("energy over that of the start", ""),
        );
        let stride = self.series[0].len().div_ceil(MOST).max(1);
        for mode in 0..SHOWN.min(self.material.masses) {
            let points = self.series[0].iter().step_by(stride).map(|(time, shares)| (time / self.period(), shares[mode]));
            chart = chart.with(Series::new(format!("mode {}", mode + 1), Style::Line, points));
        }
        let heard = match self.first_return(0) {
            Some((periods, share)) => {
                let late =
                    self.first_return(2).map_or(String::new(), |other| format!(" With the long step of 1955: {:.1}.", other.0));
                format!(" Here {:.1} % return after {periods:.1} periods.{late}", 100.0 * share)
            }
            None => String::new(),
        };
        vec![chart.noting(format!(
            "If the energy were shared out among all {} modes each would have {:.1} %. It is not: it comes back.{heard}",
            self.material.masses,
            100.0 / self.material.masses as f64
        ))]
    }

    pub(super) fn table(&self) -> Table {
        let modes = self.series[0].first().map_or(0, |entry| entry.1.len());
        let columns =
            std::iter::once("time".to_owned()).chain((1..=modes).map(|mode| format!("mode_{mode}_energy_share"))).collect();
        let rows = self.series[0].iter().map(|(time, shares)| std::iter::once(*time).chain(shares.iter().copied()).collect());
        Table { name: "modes".into(), columns, rows: rows.collect() }
    }
}
