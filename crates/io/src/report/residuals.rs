//! What is left of measurements when theory is taken off, in standard errors.

use corpuscle_observe::{Chart, Scale, Series, Style};

/// Residuals of one series: its number in the chart, and `(x, (y - theory)/standard error)` in the order of its points.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Residuals {
    pub(super) series: usize,
    pub(super) points: Vec<(f64, f64)>,
}

/// Residuals of all measured points with errors, where the chart says which theory is theirs: there is one only, or each has its own
/// beside it. A point between two places of a theory that is drawn too coarsely to be known within its error has none.
pub(super) fn of(chart: &Chart) -> Vec<Residuals> {
    let theories: Vec<usize> = numbers(chart, |series| series.style == Style::Theory);
    let of_series = |number: usize| -> Option<usize> {
        match (chart.before_pairs(), &theories[..]) {
            (_, &[only]) => Some(only),
            (Some(lone), _) => {
                let first = lone + (number - lone) / 2 * 2;
                [first, first + 1].into_iter().find(|other| theories.contains(other))
            }
            _ => None,
        }
    };
    let measured = numbers(chart, |series| {
        matches!(series.style, Style::Points | Style::Bars) && series.standard_error.len() == series.x.len()
    });
    let residuals = measured.into_iter().filter_map(|number| {
        let theory = Curve::new(chart, &chart.series[of_series(number)?])?;
        let series = &chart.series[number];
        let points: Vec<(f64, f64)> = series
            .x
            .iter()
            .zip(&series.y)
            .zip(&series.standard_error)
            .filter_map(|((&x, &y), &error)| Some((x, (y - theory.at(x, error)?) / error)))
            .filter(|(_, residual)| residual.is_finite())
            .collect();
        (points.len() > 1).then_some(Residuals { series: number, points })
    });
    residuals.collect()
}

fn numbers(chart: &Chart, which: impl Fn(&Series) -> bool) -> Vec<usize> {
    (0..chart.series.len()).filter(|&number| which(&chart.series[number])).collect()
}

/// Part of the difference between a straight line and a cubic through neighbouring places that the cubic may be wrong by; and the part
/// of a standard error that this may be.
const CUBIC: f64 = 0.1;
const NEGLIGIBLE: f64 = 0.3;

/// A theory between the places it is drawn at: straight, or a cubic, on the chart's own scales.
struct Curve {
    points: Vec<(f64, f64)>,
    x: Scale,
    y: Scale,
}

impl Curve {
    /// None of a theory whose places are not in order: it is no function.
    fn new(chart: &Chart, series: &Series) -> Option<Self> {
        let (x, y) = (chart.x.scale, chart.y.scale);
        let points: Vec<(f64, f64)> = series.x.iter().zip(&series.y).map(|(&a, &b)| (onto(x, a), onto(y, b))).collect();
        let known = points.iter().all(|point| point.0.is_finite());
        (known && points.len() > 1 && points.is_sorted_by(|a, b| a.0 < b.0)).then_some(Self { points, x, y })
    }

    /// The value at `x`; none where it is not known well against an error of this size.
    fn at(&self, x: f64, error: f64) -> Option<f64> {
        let (place, points) = (onto(self.x, x), &self.points);
        let after = points.partition_point(|point| point.0 < place);
        if after < points.len() && points[after].0 == place {
            return Some(from(self.y, points[after].1));
        }
        if after == 0 || after == points.len() {
            return None;
        }
        let between = |from: usize, to: usize| {
            // Lagrange's polynomial.
            let term = |k: usize| {
                let others = (from..to).filter(|&l| l != k);
                points[k].1 * others.map(|l| (place - points[l].0) / (points[k].0 - points[l].0)).product::<f64>()
            };
            (from..to).map(term).sum::<f64>()
        };
        let (first, last) = (after.saturating_sub(2), (after + 2).min(points.len()));
        let (straight, cubic) = (from(self.y, between(after - 1, after + 1)), from(self.y, between(first, last)));
        let known = CUBIC * (cubic - straight).abs() < NEGLIGIBLE * error;
        known.then_some(cubic)
    }
}

fn onto(scale: Scale, value: f64) -> f64 {
    if scale == Scale::Logarithmic { value.ln() } else { value }
}

fn from(scale: Scale, value: f64) -> f64 {
    if scale == Scale::Logarithmic { value.exp() } else { value }
}

#[cfg(test)]
mod tests {
    use corpuscle_observe::chart::Axis;

    use super::*;

    fn chart(y: Axis) -> Chart {
        Chart::new("c", "C", Axis::linear("x", ""), y)
    }

    #[test]
    fn one_theory_serves_all() {
        let line = Series::theory("line", 0.0, 10.0, 2, Scale::Linear, |x| 2.0 * x);
        let points = Series::with_errors("a", Style::Points, [(1.0, 2.5, 0.25), (4.0, 7.0, 0.5), (11.0, 1.0, 1.0)]);
        let without = Series::new("b", Style::Points, [(1.0, 2.0)]);
        let found = of(&chart(Axis::linear("y", "")).with(line).with(points).with(without));
        assert_eq!(found, [Residuals { series: 1, points: vec![(1.0, 2.0), (4.0, -2.0)] }]);
    }

    #[test]
    fn pairs_have_their_own_and_others_none() {
        let theory = |height: f64| Series::theory("t", 0.0, 2.0, 3, Scale::Linear, move |_| height);
        let points = |height: f64| Series::with_errors("m", Style::Points, [(0.5, height, 1.0), (1.5, height, 1.0)]);
        let both =
            chart(Axis::linear("y", "")).with(theory(9.0)).with(theory(1.0)).with(points(2.0)).with(theory(5.0)).with(points(3.0));
        let found: Vec<f64> = of(&both).iter().map(|residuals| residuals.points[0].1).collect();
        assert_eq!(found, [1.0, -2.0]);
        let none = chart(Axis::linear("y", "")).with(theory(1.0)).with(theory(2.0)).with(points(1.0));
        assert!(of(&none).is_empty());
    }

    /// A power law is straight on logarithmic axes; a sine drawn in ten pieces is known to a part of its bend only.
    #[test]
    fn theory_between_its_places_is_known_or_left_out() {
        let law = Series::theory("law", 1.0, 100.0, 2, Scale::Logarithmic, |x| x * x);
        let points = Series::with_errors("m", Style::Points, [(10.0, 101.0, 1.0), (20.0, 400.0, 1.0)]);
        let axes = (Axis::logarithmic("x", ""), Axis::logarithmic("y", ""));
        let found = of(&Chart::new("c", "C", axes.0, axes.1).with(law).with(points));
        assert!((found[0].points[0].1 - 1.0).abs() < 1e-9 && found[0].points[1].1.abs() < 1e-9);
        let sine = Series::theory("sine", 0.0, 3.0, 11, Scale::Linear, f64::sin);
        let at = |error: f64| Series::with_errors("m", Style::Points, [(1.55, 1.0, error), (1.62, 1.0, error), (1.68, 1.0, error)]);
        assert_eq!(of(&chart(Axis::linear("y", "")).with(sine.clone()).with(at(0.01)))[0].points.len(), 3);
        assert!(of(&chart(Axis::linear("y", "")).with(sine).with(at(1e-6))).is_empty());
    }
}
