//! The wave experiment's charts and tables.

use std::f64::consts::PI;

use corpuscle_observe::chart::{Axis, Chart, Scale, Series, Style};

use super::trials::{Finding, Tone};
use super::{Start, Wave, theory};
use crate::Table;
use theory::Modes;

/// Moments shown on the chart of displacements.
const MOMENTS: usize = 3;
/// Most points of a series.
const MOST: usize = 2000;

impl Wave {
    pub(super) fn all_charts(&self) -> Vec<Chart> {
        let mut charts = vec![self.displacement_chart(), self.space_time_chart()];
        charts.extend(self.step_chart());
        charts.extend(self.dispersion_chart());
        charts.push(self.energy_chart());
        charts.extend(self.mode_chart());
        charts.extend(self.shift_chart());
        charts
    }

    /// Places of the masses at rest.
    fn places(&self) -> Vec<f64> {
        (0..self.chain.design().count()).map(|n| self.chain.design().place(n)).collect()
    }

    fn displacement_chart(&self) -> Chart {
        let mut chart = Chart::new(
            "displacement",
            "The chain at several times",
            Axis::linear("position x", ""),
            Axis::linear("displacement u", ""),
        );
        let every = (self.kept.len() - 1).div_ceil(MOMENTS).max(1);
        let (places, length) = (self.places(), self.chain.design().length());
        let thin = places.len().div_ceil(400);
        for (time, displacements) in self.kept.iter().rev().step_by(every).take(MOMENTS).collect::<Vec<_>>().into_iter().rev() {
            if let Some(wave) = &self.dalembert {
                let name = format!("d'Alembert, t = {time:.1}");
                chart = chart.with(Series::theory(name, 0.0, length, 400, Scale::Linear, |x| wave.at(x, *time)));
            } else if let Some(exact) = self.exact(*time) {
                let points = places.iter().copied().zip(exact);
                chart = chart.with(Series::new(format!("sum of modes, t = {time:.1}"), Style::Theory, points));
            }
            let points = places.iter().copied().zip(displacements.iter().copied()).step_by(thin);
            chart = chart.with(Series::new(format!("chain, t = {time:.1}"), Style::Points, points));
        }
        chart.noting("The continuous string keeps a pulse's shape for ever; the chain lets its short waves fall behind.")
    }

    /// Rows of the chain, one above the other in time: one series, interrupted after each row.
    fn space_time_chart(&self) -> Chart {
        let rows = self.kept.len();
        let places = self.places();
        let thin = (rows * places.len()).div_ceil(MOST);
        let interval = if rows > 1 { self.kept[1].0 - self.kept[0].0 } else { 1.0 };
        let scale = if self.largest > 0.0 { 1.6 * interval / self.largest } else { 0.0 };
        let mut points = vec![];
        for (time, displacements) in &self.kept {
            points.extend(places.iter().zip(displacements).step_by(thin).map(|(&x, u)| (x, time + scale * u)));
            points.push((f64::NAN, f64::NAN));
        }
        let mut chart = Chart::new(
            "space-time",
            "The wave in space and time",
            Axis::linear("position x", ""),
            Axis::linear("time t + displacement", ""),
        )
        .with(Series::new("chain", Style::Line, points));
        if self.ratio != 1.0 {
            let last = self.kept.last().map_or(0.0, |kept| kept.0);
            chart = chart.with(Series::new("density step", Style::Theory, [(self.step, 0.0), (self.step, last)]));
        }
        let slope = 1.0 / self.material.speed();
        let denser = if self.ratio == 1.0 {
            String::new()
        } else {
            format!(", beyond the step at x = {:.1} by {:.3}", self.step, slope * self.ratio.sqrt())
        };
        chart.noting(format!("A pulse rises by 1/c = {slope:.3} for each unit of length it runs{denser}."))
    }

    fn step_chart(&self) -> Option<Chart> {
        let steps: Vec<_> = self
            .findings()
            .filter_map(|finding| match *finding {
                Finding::Step { ratio, reflected, transmitted, .. } => Some((ratio, reflected, transmitted)),
                _ => None,
            })
            .collect();
        let (first, last) = (steps.first()?.0.min(0.1), steps.last()?.0.max(10.0));
        let theory = |name, pick: fn((f64, f64)) -> f64| {
            Series::theory(name, first, last, 120, Scale::Logarithmic, |ratio| pick(theory::step_amplitudes(ratio)))
        };
        Some(
            Chart::new(
                "density-step",
                "Reflection and transmission at a density step",
                Axis::logarithmic("density ratio mu_2 / mu_1", ""),
                Axis::linear("amplitude over the incident", ""),
            )
            .with(theory("reflected, (Z1 - Z2)/(Z1 + Z2)", |(r, _)| r))
            .with(Series::new("reflected, measured", Style::Points, steps.iter().map(|s| (s.0, s.1))))
            .with(theory("transmitted, 2 Z1/(Z1 + Z2)", |(_, t)| t))
            .with(Series::new("transmitted, measured", Style::Points, steps.iter().map(|s| (s.0, s.2))))
            .noting("A denser part turns the echo upside down; a lighter one doubles at most what goes on."),
        )
    }

    /// Tones of the chains with fixed ends, free ends, and of the ring, as far as they are known.
    fn tones(&self) -> Vec<(&'static str, &Vec<Tone>)> {
        let tones = self.findings().filter_map(|finding| match finding {
            Finding::Modes { tones, .. } => Some(tones),
            _ => None,
        });
        ["fixed ends", "free ends", "ring"].into_iter().zip(tones).collect()
    }

    fn dispersion_chart(&self) -> Option<Chart> {
        let (tones, omega_0) = (self.tones(), self.material.omega_0());
        if tones.is_empty() {
            return None;
        }
        let mut chart = Chart::new(
            "dispersion",
            "Dispersion: frequency against wavenumber",
            Axis::linear("wavenumber times spacing, k a", "rad"),
            Axis::linear("angular frequency omega", "rad/time"),
        )
        .with(Series::theory("chain, 2 sqrt(kappa/m) sin(ka/2)", 0.0, PI, 200, Scale::Linear, |p| theory::dispersion(omega_0, p)))
        .with(Series::theory("string, c k", 0.0, 2.2, 2, Scale::Linear, |p| omega_0 * p));
        for (name, tones) in tones {
            chart = chart.with(Series::new(name, Style::Points, tones.iter().map(|tone| (tone.phase, tone.measured))));
        }
        Some(
            chart
                .noting("Where the curve bends away from the line, the wave notices the masses; at k a = pi it cannot run at all."),
        )
    }

    fn energy_chart(&self) -> Chart {
        let samples = &self.samples;
        let thin = samples.len().div_ceil(MOST);
        let series = |name: &str, value: &dyn Fn(&super::Sample) -> f64| {
            Series::new(name, Style::Line, samples.iter().step_by(thin).map(|s| (s.time, value(s))))
        };
        let chart = Chart::new("energy", "Energy against time", Axis::linear("time t", ""), Axis::linear("energy", ""));
        let total = |s: &super::Sample| s.kinetic + s.elastic;
        if self.ratio == 1.0 {
            return chart
                .with(series("total", &total))
                .with(series("kinetic", &|s| s.kinetic))
                .with(series("elastic", &|s| s.elastic))
                .noting(
                    "In a running wave half of the energy is kinetic; where waves meet, and in standing ones, it goes to and fro.",
                );
        }
        let mut chart = chart;
        if matches!(self.start, Start::Pulse { .. }) {
            let share = theory::step_amplitudes(self.ratio).0.powi(2);
            let (energy, last) = (total(&samples[0]), samples[samples.len() - 1].time);
            let level = |y: f64| [(0.0, y), (last, y)];
            chart = chart.with(Series::new("reflected, R^2 E", Style::Theory, level(share * energy))).with(Series::new(
                "transmitted, (1 - R^2) E",
                Style::Theory,
                level((1.0 - share) * energy),
            ));
        }
        chart
            .with(series("total", &total))
            .with(series("left of the step", &|s| s.left))
            .with(series("right of the step", &|s| total(s) - s.left))
            .noting("The step divides the energy as the squares of the amplitudes, weighted with the impedances, say.")
    }

    /// Energies of the modes now, beside those at the start: a linear chain never exchanges them.
    fn mode_chart(&self) -> Option<Chart> {
        let design = self.chain.design();
        if self.ratio != 1.0 || matches!(self.start, Start::Drive { .. }) || design.count() > 500 {
            return None;
        }
        let basis = Modes::of(design)?.basis();
        let velocities: Vec<f64> = (0..design.count()).map(|n| self.chain.velocity(n)).collect();
        let energies = |u: &[f64], v: &[f64]| {
            let energy = |(phase, shape): &(f64, Vec<f64>)| {
                let omega = theory::dispersion(self.material.omega_0(), *phase);
                let (q, w) = (omega * theory::project(u, shape), theory::project(v, shape));
                0.5 * self.material.mass * shape.iter().map(|s| s * s).sum::<f64>() * (q * q + w * w)
            };
            let mut levels: Vec<(f64, f64)> = basis.iter().map(|mode| (mode.0, energy(mode))).collect();
            levels.sort_by(|a, b| a.0.total_cmp(&b.0));
            // Sine and cosine of a ring belong to the same wavenumber.
            let mut merged: Vec<(f64, f64)> = vec![];
            for (phase, energy) in levels {
                match merged.last_mut() {
                    Some(last) if last.0 == phase => last.1 += energy,
                    _ => merged.push((phase, energy)),
                }
            }
            let most = merged.iter().fold(0.0, |most: f64, level| most.max(level.1));
            let useful = merged.iter().rposition(|level| level.1 > 1e-4 * most).unwrap_or(0) + 2;
            merged.into_iter().take(useful.max(12)).map(|(phase, energy)| (phase / basis_step(&basis), energy)).collect::<Vec<_>>()
        };
        Some(
            Chart::new("modes", "Energy of the normal modes", Axis::linear("mode number j", ""), Axis::linear("energy", ""))
                .with(Series::new("now", Style::Bars, energies(&self.chain.displacements(), &velocities)))
                .with(Series::new("at the start", Style::Theory, energies(&self.initial.0, &self.initial.1)))
                .noting("On a linear chain each mode keeps its energy for ever, whatever the chain looks like."),
        )
    }

    fn shift_chart(&self) -> Option<Chart> {
        let tones = self.tones();
        let (_, fixed) = tones.first()?;
        let dt = self.material.trial_step();
        let chart = Chart::new(
            "verlet-shift",
            "The integrator's own error: velocity Verlet runs fast",
            Axis::linear("omega dt", ""),
            Axis::linear("omega'/omega - 1", ""),
        );
        let last = 2.0 * self.material.omega_0() * dt;
        let shift = |z: f64| theory::verlet_frequency(z, 1.0) / z - 1.0;
        Some(
            chart
                .with(Series::theory("sin(omega' dt/2) = omega dt/2", 1e-3 * last, last, 120, Scale::Linear, shift))
                .with(Series::new(
                    "modes measured",
                    Style::Points,
                    fixed.iter().map(|t| (t.chain * dt, t.measured / t.chain - 1.0)),
                ))
                .noting("The shift grows with the square of omega dt; at omega dt = 2 the motion becomes unstable."),
        )
    }

    pub(super) fn all_tables(&self) -> Vec<Table> {
        let columns = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
        let mut tables = vec![];
        for (ends, tones) in self.tones() {
            tables.push(Table {
                name: format!("modes-{}", ends.replace(' ', "-")),
                columns: columns(&["mode", "ka_rad", "omega_measured", "omega_with_verlet", "omega_chain"]),
                rows: tones.iter().map(|t| vec![t.number as f64, t.phase, t.measured, t.verlet, t.chain]).collect(),
            });
        }
        let steps = self.findings().filter_map(|finding| match *finding {
            Finding::Step { ratio, reflected, transmitted, bounds } => {
                let (r, t) = theory::step_amplitudes(ratio);
                Some(vec![ratio, reflected, r, bounds.0, transmitted, t, bounds.1])
            }
            _ => None,
        });
        let names = [
            "density_ratio",
            "reflected",
            "reflected_theory",
            "reflected_bound",
            "transmitted",
            "transmitted_theory",
            "transmitted_bound",
        ];
        let rows: Vec<_> = steps.collect();
        if !rows.is_empty() {
            tables.push(Table { name: "density-steps".into(), columns: columns(&names), rows });
        }
        tables
    }
}

/// Phase advance of mode 1: the smallest that is not zero.
fn basis_step(basis: &[(f64, Vec<f64>)]) -> f64 {
    basis.iter().map(|mode| mode.0).filter(|&phase| phase > 0.0).fold(f64::INFINITY, f64::min)
}
