//! Charts of a free system.

use corpuscle_observe::SpeedDistribution;
use corpuscle_observe::chart::{Axis, Chart, Scale, Series, Style};

use super::build::AnyEngine;
use super::run::Free;
use super::sample::Sample;
use super::spec::Observable;

/// Points of a chart.
const CHART: usize = 1000;

impl<const D: usize> Free<D> {
    pub(super) fn all_charts(&self) -> Vec<Chart> {
        let mut charts = vec![self.energy_chart()];
        if self.observe.contains(&Observable::Temperature) {
            charts.push(self.temperature_chart());
        }
        charts.extend(self.piston_chart());
        charts.extend(self.pressure_chart());
        charts.extend(self.speed_chart());
        charts.extend(self.structure_chart());
        charts.extend(self.displacement_chart());
        charts
    }

    /// The instantaneous pressure of a time-driven system, and the means with their errors of either.
    fn pressure_chart(&self) -> Option<Chart> {
        let pressures = self.pressures();
        let (from, to) = (self.settled().first()?.time, self.samples.last()?.time);
        let mut chart = Chart::new("pressure", "Pressure", Axis::linear("time t", ""), Axis::linear("pressure P", ""));
        if matches!(self.engine, AnyEngine::Time(_)) && !pressures.is_empty() {
            let series = thin(self.settled()).map(|sample| (sample.time, sample.pressure));
            chart = chart.with(Series::new("instantaneous", Style::Line, series));
        }
        for (name, estimate) in &pressures {
            let ends = [from, to].map(|time| (time, estimate.mean, estimate.standard_error));
            chart = chart.with(Series::with_errors(*name, Style::Line, ends));
        }
        (!pressures.is_empty() && to > from)
            .then(|| chart.noting("Means over the run after its first fifth, with standard errors."))
    }

    fn energy_chart(&self) -> Chart {
        let series = |name: &str, value: fn(&Sample) -> f64| {
            Series::new(name, Style::Line, thin(&self.samples).map(|sample| (sample.time, value(sample))))
        };
        let mut chart = Chart::new("energy", "Energy", Axis::linear("time t", ""), Axis::linear("energy E", ""))
            .with(series("kinetic", |sample| sample.kinetic));
        if self.samples.iter().any(|sample| sample.potential != 0.0) {
            let rest = if self.engine.piston().is_some() { "potential, and of the piston" } else { "potential" };
            chart = chart
                .with(series(rest, |sample| sample.potential))
                .with(series("total", |sample| sample.kinetic + sample.potential));
        }
        chart
    }

    fn temperature_chart(&self) -> Chart {
        let measured = thin(&self.samples).map(|sample| (sample.time, sample.temperature));
        let mut chart = Chart::new("temperature", "Temperature", Axis::linear("time t", ""), Axis::linear("temperature k_B T", ""))
            .with(Series::new("kinetic temperature", Style::Line, measured));
        let mut warm: Vec<f64> = self.engine.boundary().faces.iter().flatten().filter_map(|face| face.temperature).collect();
        warm.sort_by(f64::total_cmp);
        warm.dedup();
        let end = self.samples.last().map_or(0.0, |sample| sample.time);
        for wall in warm {
            chart = chart.with(Series::theory(format!("walls at {wall}"), 0.0, end, 2, Scale::Linear, move |_| wall));
        }
        chart
    }

    fn piston_chart(&self) -> Option<Chart> {
        let places = thin(&self.samples).filter_map(|sample| Some((sample.time, sample.piston?)));
        let measured = Series::new("piston", Style::Line, places);
        let axes = (Axis::linear("time t", ""), Axis::linear("coordinate of the piston", ""));
        self.engine.piston().map(|_| Chart::new("piston", "Piston", axes.0, axes.1).with(measured))
    }

    fn displacement_chart(&self) -> Option<Chart> {
        let points = self.displacement.iter().filter(|(time, moved)| *time > 0.0 && *moved > 0.0).copied();
        (self.displacement.len() > 1).then(|| {
            Chart::new(
                "mean-squared-displacement",
                "Mean squared displacement",
                Axis::logarithmic("time t", ""),
                Axis::logarithmic("⟨|r(t) − r(0)|²⟩", ""),
            )
            .with(Series::new("measured", Style::Line, points))
        })
    }

    fn speed_chart(&self) -> Option<Chart> {
        let particles = &self.start_particles;
        let mass = particles.mass[0];
        let alike = mass > 0.0 && particles.mass.iter().all(|&m| m == mass);
        let speeds = self.speeds.as_ref().filter(|speeds| speeds.total() > 0 && alike)?;
        let settled = self.settled();
        let temperature = settled.iter().map(|sample| sample.temperature).sum::<f64>() / settled.len() as f64;
        let maxwell = SpeedDistribution::maxwell(D, temperature, mass);
        let bars = speeds.densities().into_iter().map(|(speed, density)| (speed, density.mean));
        let last = speeds.edges().last().copied()?;
        Some(
            Chart::new(
                "speeds",
                "Distribution of speeds",
                Axis::linear("speed v", ""),
                Axis::linear("probability density f(v)", ""),
            )
            .with(Series::new("measured", Style::Bars, bars))
            .with(Series::theory("Maxwell", 0.0, last, 200, Scale::Linear, |speed| maxwell.density(speed))),
        )
    }

    fn structure_chart(&self) -> Option<Chart> {
        let structure = self.structure.as_ref().filter(|structure| structure.samples() > 0)?;
        let points = structure.points().into_iter().map(|(r, g)| (r, g.mean, g.standard_error));
        Some(
            Chart::new("radial-distribution", "Radial distribution", Axis::linear("distance r", ""), Axis::linear("g(r)", ""))
                .with(Series::with_errors("measured", Style::Line, points)),
        )
    }
}

/// At most [`CHART`] of the samples, evenly.
fn thin(samples: &[Sample]) -> impl Iterator<Item = &Sample> {
    samples.iter().step_by(samples.len().div_ceil(CHART).max(1))
}
