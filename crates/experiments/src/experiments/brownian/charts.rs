//! Displacement, memory, diffusion and steps, each beside its theory.

use corpuscle_core::Axis as Faces;
use corpuscle_observe::chart::{Axis, Chart, Scale, Series, Style};
use corpuscle_observe::{Histogram, theory, vacf};

use super::path::{Brownian, DIFFUSIVE};

impl<const D: usize> Brownian<D> {
    pub(super) fn displacement_chart(&self) -> Chart {
        let curves = self.displacements();
        let points: Vec<_> = curves.points().into_iter().filter(|(lag, _)| *lag > 0.0 && *lag <= 0.25 * self.duration).collect();
        let (first, last) = (self.set.interval, points.last().map_or(self.duration, |p| p.0));
        let (set, relaxation) = (&self.set, self.set.relaxation());
        let ballistic = D as f64 * set.share * set.temperature / set.mass;
        let measured = points.iter().map(|&(lag, value)| (lag, value.mean, value.standard_error));
        let mut chart = Chart::new(
            "displacement",
            "Mean squared displacement",
            Axis::logarithmic("time t", ""),
            Axis::logarithmic("⟨|r(t) − r(0)|²⟩", ""),
        )
        .with(Series::theory("ballistic, d kT/M t²", first, 3.0 * relaxation, 2, Scale::Logarithmic, |t| ballistic * t * t))
        .with(Series::theory("diffusive, 2 d D t", 0.3 * relaxation, last, 2, Scale::Logarithmic, |t| {
            2.0 * D as f64 * set.diffusion() * t
        }))
        .with(Series::theory("Ornstein–Uhlenbeck", first, last, 100, Scale::Logarithmic, |t| set.displacement(t)));
        if set.faces == Faces::Walls {
            let open = set.side - 2.0 * set.radius;
            let closed = |t| D as f64 * theory::closed_box_displacement(open, set.diffusion(), t);
            chart = chart.with(Series::theory("diffusion between walls", relaxation, last, 100, Scale::Logarithmic, closed));
        }
        chart
            .with(Series::with_errors("measured", Style::Points, measured))
            .noting("Slope 2 while the particle still flies straight, slope 1 once the kicks have made it forget.")
    }

    pub(super) fn correlation_chart(&self) -> Chart {
        let set = &self.set;
        let start = set.share * D as f64 * set.temperature / set.mass;
        let points = self.correlations().points();
        let step = points.len().div_ceil(70).max(1);
        let measured = points.iter().step_by(step).map(|(lag, value)| (*lag, value.mean / start, value.standard_error / start));
        let decay = set.friction / set.share;
        Chart::new(
            "velocity-correlation",
            "Velocity autocorrelation",
            Axis::linear("time t", ""),
            Axis::linear("⟨V(0)·V(t)⟩ / ⟨V²⟩", ""),
        )
        .with(Series::theory("exp(−γt), Enskog friction", 0.0, set.longest_lag, 120, Scale::Linear, |t| libm::exp(-decay * t)))
        .with(Series::theory("exact initial slope", 0.0, 1.0 / decay, 2, Scale::Linear, |t| {
            1.0 - decay * set.closed_system_factor() * t
        }))
        .with(Series::with_errors("measured", Style::Points, measured))
        .noting("The initial slope is exact; a dense fluid would remember longer (in 2-D with a long-time tail 1/t).")
    }

    pub(super) fn diffusion_chart(&self) -> Chart {
        let set = &self.set;
        let dimension = D as f64;
        let running = vacf::running_integral(&self.correlations(), D).points();
        let kubo = running.iter().map(|(t, value)| (*t, value.mean, value.standard_error));
        let einstein: Vec<_> = self
            .displacements()
            .points()
            .into_iter()
            .filter(|(lag, _)| *lag > 0.0 && *lag <= set.longest_lag)
            .map(|(lag, value)| (lag, value.mean / (2.0 * dimension * lag), value.standard_error / (2.0 * dimension * lag)))
            .collect();
        Chart::new("diffusion", "Diffusion coefficient, two ways", Axis::linear("time t", ""), Axis::linear("D", ""))
            .with(Series::theory("theory, s² kT/(Mγ)", 0.0, set.longest_lag, 2, Scale::Linear, |_| set.diffusion()))
            .with(Series::with_errors("Green–Kubo, (1/d) ∫ ⟨V(0)·V⟩", Style::Line, kubo))
            .with(Series::with_errors("Einstein, ⟨|Δr|²⟩ / (2 d t)", Style::Points, einstein))
            .noting("The integral of the memory and the growth of the displacement lead to the same constant.")
    }

    pub(super) fn step_chart(&self) -> Option<Chart> {
        let set = &self.set;
        let time = DIFFUSIVE.0 * set.relaxation();
        let spread = (set.displacement(time) / D as f64).sqrt();
        let mut histogram = Histogram::new(-4.0 * spread, 4.0 * spread, 32);
        self.steps().iter().flatten().for_each(|&step| histogram.add(step));
        if histogram.total() < 100 {
            return None;
        }
        let normal = |x: f64| libm::exp(-0.5 * (x / spread) * (x / spread)) / (spread * (2.0 * std::f64::consts::PI).sqrt());
        let bars = histogram.densities().into_iter().map(|(x, density)| (x, density.mean, density.standard_error));
        Some(
            Chart::new(
                "steps",
                format!("Displacements along one axis in {} relaxation times", DIFFUSIVE.0),
                Axis::linear("Δx", ""),
                Axis::linear("probability density", ""),
            )
            .with(Series::with_errors("measured", Style::Bars, bars))
            .with(Series::theory("Gaussian", -4.0 * spread, 4.0 * spread, 120, Scale::Linear, normal))
            .noting("Many independent kicks add up to a normal distribution."),
        )
    }
}
