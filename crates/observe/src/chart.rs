//! A chart as data: what the window draws live, the report prints and the CSV holds.

use serde::Serialize;

/// How an axis is divided.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scale {
    /// Equal steps for equal differences.
    #[default]
    Linear,
    /// Equal steps for equal ratios; values that are not positive are left out.
    Logarithmic,
}

/// What a series is, and so how it is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Style {
    /// Theory: a smooth line.
    Theory,
    /// Measurement: points, with error bars where there are errors.
    Points,
    /// Measurement in dense succession: a line, interrupted where a point is not a number, with a band of one standard error
    /// where there are errors.
    Line,
    /// Measured counts or densities in bins: `x` are the bins' middles.
    Bars,
}

/// One series of a chart.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// What the series is.
    pub style: Style,
    /// Abscissae.
    pub x: Vec<f64>,
    /// Ordinates, one for each abscissa.
    pub y: Vec<f64>,
    /// Standard errors of the ordinates: one for each, or none at all.
    pub standard_error: Vec<f64>,
}

impl Series {
    /// A series without errors.
    pub fn new(name: impl Into<String>, style: Style, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let (x, y) = points.into_iter().unzip();
        Self { name: name.into(), style, x, y, standard_error: vec![] }
    }

    /// A series of `(x, y, standard error of y)`.
    pub fn with_errors(name: impl Into<String>, style: Style, points: impl IntoIterator<Item = (f64, f64, f64)>) -> Self {
        let mut series = Self { name: name.into(), style, x: vec![], y: vec![], standard_error: vec![] };
        for (x, y, error) in points {
            series.x.push(x);
            series.y.push(y);
            series.standard_error.push(error);
        }
        series
    }

    /// A theory curve, sampled at `count` places from `from` to `to`, evenly on the given scale.
    pub fn theory(name: impl Into<String>, from: f64, to: f64, count: usize, scale: Scale, f: impl Fn(f64) -> f64) -> Self {
        let place = |k: usize| {
            let part = k as f64 / (count.max(2) - 1) as f64;
            match scale {
                Scale::Linear => from + part * (to - from),
                Scale::Logarithmic => from * (to / from).powf(part),
            }
        };
        Self::new(name, Style::Theory, (0..count.max(2)).map(|k| (place(k), f(place(k)))))
    }
}

/// One axis: what it shows and how.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Axis {
    /// Name of the quantity, with its symbol.
    pub label: String,
    /// Unit; empty when reduced.
    pub unit: String,
    /// Division.
    pub scale: Scale,
}

impl Axis {
    /// A linear axis.
    pub fn linear(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { label: label.into(), unit: unit.into(), scale: Scale::Linear }
    }

    /// A logarithmic axis.
    pub fn logarithmic(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { label: label.into(), unit: unit.into(), scale: Scale::Logarithmic }
    }
}

/// A chart: measurement and theory on the same axes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Chart {
    /// Name of the file it is saved under: lower case, words joined by hyphens.
    pub name: String,
    /// Title.
    pub title: String,
    /// Abscissa.
    pub x: Axis,
    /// Ordinate.
    pub y: Axis,
    /// The series, in drawing order. Several theories, each next to its own measurement in the list (theory, points, theory,
    /// points, ...), share its colour; theories before those, and theories in any other order, are drawn in ink.
    pub series: Vec<Series>,
    /// One sentence: what to look at.
    pub note: String,
}

impl Chart {
    /// A chart without series yet.
    pub fn new(name: impl Into<String>, title: impl Into<String>, x: Axis, y: Axis) -> Self {
        Self { name: name.into(), title: title.into(), x, y, series: vec![], note: String::new() }
    }

    /// How many theories at the front have no measurement of their own, where all the other series come in two pairs or more of a
    /// theory and its measurement; none where they do not.
    pub fn before_pairs(&self) -> Option<usize> {
        let is_theory = |series: &&Series| series.style == Style::Theory;
        let lone = self.series.iter().take_while(is_theory).count().saturating_sub(1);
        let rest = &self.series[lone..];
        let alternates = rest.chunks(2).all(|pair| pair.len() == 2 && pair.iter().filter(is_theory).count() == 1);
        (rest.len() > 2 && alternates).then_some(lone)
    }

    /// The same chart with one more series.
    #[must_use]
    pub fn with(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// The same chart with its note.
    #[must_use]
    pub fn noting(mut self, note: impl Into<String>) -> Self {
        self.note = note.into();
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn theories_and_measurements_in_turn_are_pairs() {
        let before_pairs = |styles: &str| {
            let axes = (Axis::linear("x", ""), Axis::linear("y", ""));
            let style = |letter| if letter == 't' { Style::Theory } else { Style::Points };
            styles
                .chars()
                .fold(Chart::new("c", "C", axes.0, axes.1), |chart, letter| chart.with(Series::new("", style(letter), [])))
                .before_pairs()
        };
        for (styles, expected) in
            [("tptp", Some(0)), ("ptpt", Some(0)), ("ttptp", Some(1)), ("tp", None), ("ttpp", None), ("ttp", None), ("tptpp", None)]
        {
            assert_eq!(before_pairs(styles), expected, "{styles}");
        }
    }
}
