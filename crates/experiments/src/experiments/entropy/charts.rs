//! What the growth of entropy looks like on paper, each curve beside its theory.

use std::f64::consts::LN_2;

use corpuscle_observe::chart::{Axis, Chart, Scale, Series, Style};

use super::Set;
use super::opening::Entropy;
use super::room::Process;

impl<const D: usize> Entropy<D> {
    pub(super) fn entropy_chart(&self, process: Process) -> Chart {
        let (name, title, limit) = match process {
            Process::Expansion => ("expansion", "Free expansion: entropy against time", "N k ln(V₂/V₁), thermodynamic limit"),
            Process::Mixing => ("mixing", "Mixing: entropy against time", "k Σ Nₛ ln(V/Vₛ), thermodynamic limit"),
        };
        let count = self.set.particles as f64;
        let rise = self.set.expected_rise(process, self.set.cells_along) / count;
        let level = |name: &str, value: f64| Series::theory(name, 0.0, self.duration, 2, Scale::Linear, |_| value);
        let mut chart = Chart::new(
            format!("entropy-{name}"),
            title,
            Axis::linear("time t", ""),
            Axis::linear("rise of entropy (S − S₀)/N", "k_B"),
        )
        .with(level("equilibrium, this N and these cells", rise))
        .with(level(limit, LN_2))
        .with(Series::with_errors(
            "mean of the replicas",
            Style::Line,
            self.curve(process, |room, sample| room.rise(sample) / count),
        ));
        if self.shown.process == process {
            let name = if self.echo.is_some() { "one room, velocities reversed" } else { "one room" };
            let points = self.times.iter().zip(&self.shown.samples).map(|(&t, sample)| (t, self.shown.rise(sample) / count));
            chart = chart.with(Series::new(name, Style::Line, points));
        }
        chart.noting(match process {
            Process::Expansion => "The gas finds the empty half; with all velocities reversed the same mechanics empties it again.",
            Process::Mixing => "Nothing pushes the gases through each other: there are just more ways to be mixed.",
        })
    }

    /// The rise of the process on show, over cells of several sizes.
    pub(super) fn scales_chart(&self) -> Chart {
        let (process, count) = (self.shown.process, self.set.particles as f64);
        let mut chart = Chart::new(
            "cell-sizes",
            "Entropy over cells of several sizes",
            Axis::linear("time t", ""),
            Axis::linear("rise of entropy (S − S₀)/N", "k_B"),
        );
        for (grid, along) in self.set.scales().into_iter().enumerate() {
            let (rise, cells) = (self.set.expected_rise(process, along) / count, self.set.cells(along).len());
            let measured = self.curve(process, |room, sample| (sample.entropies[grid] - room.samples[0].entropies[grid]) / count);
            chart = chart
                .with(Series::theory(format!("{cells} cells: equilibrium"), 0.0, self.duration, 2, Scale::Linear, |_| rise))
                .with(Series::with_errors(format!("{cells} cells: measured"), Style::Line, measured));
        }
        chart.noting(
            "How much entropy there is depends on how finely one looks; that it rises, and by about ln 2 a particle, does not.",
        )
    }

    pub(super) fn left_chart(&self) -> Chart {
        let count = self.set.particles as f64;
        Chart::new(
            "left-half",
            "Share of particles in the left half",
            Axis::linear("time t", ""),
            Axis::linear("share n_left/N", ""),
        )
        .with(Series::theory("half", 0.0, self.duration, 2, Scale::Linear, |_| 0.5))
        .with(Series::with_errors("expansion", Style::Line, self.curve(Process::Expansion, |_, sample| sample.left as f64 / count)))
        .with(Series::with_errors("mixing", Style::Line, self.curve(Process::Mixing, |_, sample| sample.left as f64 / count)))
        .noting("That all are on the left again by chance has probability 2^-N.")
    }

    /// Distribution of the left count in equilibrium beside the normal law with the variance of theory.
    pub(super) fn fluctuation_chart(&self) -> Option<Chart> {
        if self.times.len() <= Self::settled() {
            return None;
        }
        let count = self.set.particles as f64;
        let deviation = 0.5 * (count * Set::<D>::compressibility(self.set.packing_fraction)).sqrt();
        let bin = (0.4 * deviation).ceil().max(1.0);
        let reach = (4.0 * deviation / bin).ceil() as i64;
        let mut bins = vec![0u32; 2 * reach as usize + 1];
        let mut total = 0u32;
        for room in self.rooms(Process::Expansion) {
            for sample in &room.samples[Self::settled()..] {
                let place = ((sample.left as f64 - 0.5 * count) / bin).round() as i64 + reach;
                if let Some(slot) = usize::try_from(place).ok().and_then(|place| bins.get_mut(place)) {
                    *slot += 1;
                }
                total += 1;
            }
        }
        let middle = |k: usize| 0.5 * count + (k as i64 - reach) as f64 * bin;
        let bars = bins.iter().enumerate().map(|(k, &n)| (middle(k), f64::from(n) / (f64::from(total) * bin)));
        let normal = |x: f64| {
            let u = (x - 0.5 * count) / deviation;
            libm::exp(-0.5 * u * u) / (deviation * (2.0 * std::f64::consts::PI).sqrt())
        };
        let end = 4.0 * deviation;
        Some(
            Chart::new(
                "fluctuations",
                "Fluctuations of the left count in equilibrium",
                Axis::linear("particles in the left half", ""),
                Axis::linear("probability", ""),
            )
            .with(Series::new("measured", Style::Bars, bars))
            .with(Series::theory("normal, variance N χ/4", 0.5 * count - end, 0.5 * count + end, 121, Scale::Linear, normal))
            .noting("Equilibrium is not rest: the count goes on fluctuating by about half the square root of N."),
        )
    }

    pub(super) fn echo_chart(&self) -> Option<Chart> {
        let echo = self.echo.as_ref().filter(|echo| !echo.errors.is_empty())?;
        let turn = self.times[echo.turn];
        let points = echo.errors.iter().filter(|(_, error)| *error > 0.0).map(|&(t, error)| (t - turn, error));
        Some(
            Chart::new(
                "echo",
                "Loschmidt's reversal: distance from the way out",
                Axis::linear("time since the reversal", ""),
                Axis::logarithmic("largest distance", ""),
            )
            .with(Series::new("largest over all particles", Style::Line, points))
            .with(Series::theory("radius of a particle", 0.0, turn, 2, Scale::Linear, |_| self.set.radius))
            .noting("Rounding errors grow exponentially on the way back: chaos limits how long a computer can be reversed."),
        )
    }
}
