//! What the map says as a whole: shares of fates against time, and how much must be known of a start to know its end.

use corpuscle_observe::chart::Axis;
use corpuscle_observe::{Chart, Check, Estimate, Scale, Series, Style, fit};

use super::{Basins, Fate, LANES, PROBES};
use crate::Table;

/// Times at which shares are shown.
const TIMES: usize = 120;
/// The probes' shares are shown at this many times.
const BARS: usize = 12;
/// Strips of the map, each of which has its own exponent.
const STRIPS: usize = 16;
/// Fewer probes than this of one fate say nothing that a normal distribution describes.
const FEWEST: f64 = 8.0;

impl Basins {
    /// The share of cells with each of [`Fate::ALL`] now.
    pub(super) fn shares(&self) -> [f64; 5] {
        let mut counts = [0u64; 5];
        self.fates().for_each(|(fate, _)| counts[fate.index()] += 1);
        counts.map(|count| count as f64 / (self.cells * self.cells) as f64)
    }

    pub(super) fn verdicts(&self) -> Vec<Check> {
        if self.time <= 0.0 {
            return vec![];
        }
        let n = PROBES as f64;
        let check = |(fate, share): (Fate, f64)| {
            let hits = self.probes.iter().filter(|probe| probe.fate == fate).count() as f64;
            // The map is dense: the scatter is that of the probes alone.
            let measured = Estimate::new(hits / n, (share * (1.0 - share) / n).sqrt());
            (n * share.min(1.0 - share) >= FEWEST).then(|| {
                measured.check(
                    format!("share of grains of which one {}", self.name_of(fate)),
                    share,
                    format!(
                        "the map; measured: {PROBES} grains released at random, advanced by gauss-radau-15, binomial error. \
                         Fates of single grains are lost in a fractal, their shares are not"
                    ),
                )
            })
        };
        Fate::ALL.into_iter().zip(self.shares()).filter_map(check).collect()
    }

    /// Shares of fates against time, from the map and from the probes.
    pub(super) fn chart_of_fates(&self) -> Chart {
        let end = self.stars.time().max(f64::MIN_POSITIVE);
        let mut chart =
            Chart::new("fates", "What has become of the dust", Axis::linear("time t", ""), Axis::linear("share of all grains", ""));
        let map: Vec<(Fate, f64)> = self.fates().collect();
        let probes: Vec<(Fate, f64)> = self.probes.iter().map(|probe| (probe.fate, probe.time)).collect();
        for fate in Fate::ALL {
            let line = shares(&map, fate, end, TIMES);
            if line.last().is_none_or(|&(_, share)| share <= 1e-3) {
                continue;
            }
            let points = shares(&probes, fate, end, BARS)
                .into_iter()
                .map(|(t, share)| (t, share, (share * (1.0 - share) / PROBES as f64).sqrt()));
            chart = chart.with(Series::new(format!("{}: map", self.name_of(fate)), Style::Theory, line)).with(Series::with_errors(
                format!("{}: gauss-radau-15", self.name_of(fate)),
                Style::Points,
                points,
            ));
        }
        let rate = self.escape_rate();
        let half = if rate.mean > 0.0 { std::f64::consts::LN_2 / rate.mean } else { f64::INFINITY };
        chart.noting(format!(
            "Of those still on their way at half time, {:.4} ± {:.4} meet their fate per unit of time: half of them in {half:.3}.",
            rate.mean, rate.standard_error
        ))
    }

    /// The rate at which fates are sealed in the second half of the time, as if it were constant: events over exposure, the
    /// most likely rate of an exponential law; standard error over the strips of the map.
    fn escape_rate(&self) -> Estimate {
        let (end, half) = (self.stars.time(), 0.5 * self.stars.time());
        let fates: Vec<(Fate, f64)> = self.fates().collect();
        let rates = fates.chunks(fates.len().div_ceil(STRIPS)).map(|strip| {
            let late = strip.iter().filter(|&&(fate, time)| fate == Fate::Open || time > half);
            let (events, exposure) = late.fold((0.0, 0.0), |(events, exposure), &(fate, time)| match fate {
                Fate::Open => (events, exposure + end - half),
                _ => (events + 1.0, exposure + time - half),
            });
            if exposure > 0.0 { events / exposure } else { 0.0 }
        });
        Estimate::from_replicas(&rates.collect::<Vec<f64>>())
    }

    /// `(distance, share of pairs of grains so far apart whose fates differ)` in each strip of the map.
    fn uncertainty(&self) -> Vec<Vec<(f64, f64)>> {
        let fates: Vec<Fate> = self.fates().map(|(fate, _)| fate).collect();
        let rows: Vec<&[Fate]> = fates.chunks(self.cells).collect();
        let distances = || (0..).map(|k| 1usize << k).take_while(|distance| 8 * distance <= self.cells);
        let of_strip = |strip: &[&[Fate]]| {
            let share = |distance: usize| {
                let pairs = strip.iter().flat_map(|row| row.iter().zip(&row[distance..]));
                let sealed = pairs.filter(|(one, other)| **one != Fate::Open && **other != Fate::Open);
                let (count, differ) = sealed.fold((0u32, 0u32), |(n, d), (one, other)| (n + 1, d + u32::from(one != other)));
                (distance as f64 * self.side / self.cells as f64, f64::from(differ) / f64::from(count))
            };
            distances().map(share).collect()
        };
        rows.chunks(self.cells.div_ceil(STRIPS)).map(of_strip).collect()
    }

    /// The uncertainty exponent `alpha` of `f ~ epsilon^alpha` (McDonald, Grebogi, Ott and Yorke 1985): mean over the strips.
    pub(super) fn exponent(&self) -> Option<Estimate> {
        let slopes = self.uncertainty().into_iter().filter_map(|strip| {
            let usable: Vec<(f64, f64)> = strip
                .iter()
                .filter(|(_, share)| *share > 0.0)
                .map(|(distance, share)| (libm::log(*distance), libm::log(*share)))
                .collect();
            (usable.len() >= 3).then(|| fit::line_by_scatter(&usable)).flatten().map(|line| line.slope.mean)
        });
        let slopes: Vec<f64> = slopes.collect();
        (slopes.len() >= STRIPS / 2).then(|| Estimate::from_replicas(&slopes))
    }

    /// How often two grains differ in their fate, against the distance of their starts.
    pub(super) fn chart_of_uncertainty(&self) -> Option<Chart> {
        let strips = self.uncertainty();
        let exponent = self.exponent()?;
        let points: Vec<(f64, f64, f64)> = (0..strips[0].len())
            .map(|k| {
                let shares: Vec<f64> = strips.iter().map(|strip| strip[k].1).filter(|share| share.is_finite()).collect();
                let mean = Estimate::from_replicas(&shares);
                (strips[0][k].0, mean.mean, mean.standard_error)
            })
            .collect();
        let &(first, share, _) = points.first()?;
        let last = points.last()?.0;
        let middle = libm::sqrt(first * last);
        let level =
            points.iter().map(|p| libm::log(p.1) - exponent.mean * libm::log(p.0 / middle)).sum::<f64>() / points.len() as f64;
        let chart = Chart::new(
            "uncertainty",
            "How much of a start must be known to know its end",
            Axis::logarithmic("distance of two starts ε", ""),
            Axis::logarithmic("share of pairs with different fates", ""),
        );
        if !(share > 0.0 && level.is_finite()) {
            return None;
        }
        let line = |x: f64| libm::exp(level + exponent.mean * libm::log(x / middle));
        Some(
            chart
                .with(Series::theory(
                    format!("ε^α, α = {:.3} ± {:.3}", exponent.mean, exponent.standard_error),
                    first,
                    last,
                    2,
                    Scale::Logarithmic,
                    line,
                ))
                .with(Series::with_errors("pairs of neighbours on the map", Style::Points, points))
                .noting(format!(
                    "α = 1 for a smooth border of basins; here the border has the dimension 2 − α = {:.2}, and a start known ten \
                     times better leaves {:.0} % of the doubt.",
                    2.0 - exponent.mean,
                    100.0 * libm::exp(-exponent.mean * std::f64::consts::LN_10)
                )),
        )
    }

    /// The probes, one by one, beside what the map's own method makes of the same starts.
    pub(super) fn all_tables(&self) -> Vec<Table> {
        let columns = ["fate_gauss_radau", "time_gauss_radau", "fate_map", "time_map"].map(String::from).to_vec();
        let double = |k: usize| (&self.doubles[k / LANES], k % LANES);
        let rows = self.probes.iter().enumerate().map(|(k, probe)| {
            let (flock, lane) = double(k);
            vec![probe.fate.index() as f64, probe.time, flock.fate[lane].index() as f64, flock.time[lane]]
        });
        vec![Table { name: "probes".into(), columns, rows: rows.collect() }]
    }
}

/// The share with this fate by each of so many times up to `end`.
fn shares(all: &[(Fate, f64)], fate: Fate, end: f64, count: usize) -> Vec<(f64, f64)> {
    let mut sealed = vec![0.0; count + 1];
    for &(own, time) in all.iter().filter(|(own, _)| (*own == fate) == (fate != Fate::Open)) {
        if own != Fate::Open {
            let slot = (time / end * count as f64).ceil().clamp(0.0, count as f64) as usize;
            sealed[slot] += 1.0 / all.len() as f64;
        }
    }
    let mut sum = 0.0;
    let rising = sealed.iter().enumerate().map(|(slot, share)| {
        sum += share;
        (end * slot as f64 / count as f64, if fate == Fate::Open { 1.0 - sum } else { sum })
    });
    rising.collect()
}
