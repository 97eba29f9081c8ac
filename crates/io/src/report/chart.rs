//! A chart as inline SVG. Colours and fonts come from the page's style sheet, so that one drawing serves the light page,
//! the dark page and the printer; this is why it is drawn here and not by a plotting crate.

use std::collections::BTreeSet;
use std::fmt::Write;

use corpuscle_observe::{Chart, Scale, Series, Style};

use super::axis::Range;
use super::html::escape;
use super::residuals::{self, Residuals};
use crate::number::{significant, superscript};

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 400.0;
const RIGHT: f64 = 14.0;
const BOTTOM: f64 = 54.0;
/// Average width of a character, in user units.
const CHARACTER: f64 = 6.9;
/// Room at the left for the title of the ordinate; the texts of its ticks come on top.
const TITLE: f64 = 34.0;
const LEGEND_ROW: f64 = 20.0;
const Y_TICKS: usize = 6;
/// Height of the residuals below a chart, and of the gap between them.
const RESIDUALS: f64 = 84.0;
const GAP: f64 = 12.0;

/// Height of the whole drawing, in user units; its width is always the same.
pub(super) fn height(chart: &Chart) -> f64 {
    HEIGHT + if residuals::of(chart).is_empty() { 0.0 } else { GAP + RESIDUALS }
}

/// The chart as one `<svg>` element, with the residuals of what is measured below it where theory is known.
pub(super) fn svg(chart: &Chart) -> String {
    let looks = looks(chart);
    let y = ordinate_range(chart);
    let left = TITLE + CHARACTER * longest(&y).max(4) as f64;
    let (legend, legend_height) = legend(chart, &looks, left);
    let frame = Frame::new(chart, y, left, legend_height + 12.0);
    let residuals = residuals::of(chart);
    let whole = height(chart);
    let mut out = format!(
        "<svg viewBox=\"0 0 {WIDTH} {whole}\" role=\"img\" aria-label=\"{}\">{legend}",
        escape(&format!("{}: {} against {}", chart.title, chart.y.label, chart.x.label))
    );
    let ordinate = |range: &Range| axis_title(&chart.y.label, &chart.y.unit, range.ticks(Y_TICKS).1);
    frame.axes(&ordinate(&frame.y), Y_TICKS, residuals.is_empty().then_some(chart), &mut out);
    frame.clip(&mut out);
    // Theory above bars and bands, points above theory: the measurement is what was done here.
    let layer = |style: Style| match style {
        Style::Bars => 0,
        Style::Line => 1,
        Style::Theory => 2,
        Style::Points => 3,
    };
    let mut order: Vec<usize> = (0..chart.series.len()).collect();
    order.sort_by_key(|&index| layer(chart.series[index].style));
    for index in order {
        frame.series(&chart.series[index], &looks[index], &mut out);
    }
    out += "</svg>";
    if !residuals.is_empty() {
        frame.below(&residuals).residuals(chart, &residuals, &looks, &mut out);
    }
    out + "</svg>"
}

/// How the series are told apart, as class names.
fn looks(chart: &Chart) -> Vec<String> {
    let lone = chart.before_pairs().unwrap_or(usize::MAX);
    let (mut theory, mut measured) = (0, 0);
    let mut look = |series: &Series| {
        if series.style == Style::Theory {
            theory += 1;
            // Each theory in the colour of its measurement; those that have none in ink with dashes.
            if theory > lone {
                format!("theory c{}", (theory - lone - 1) % 8)
            } else {
                format!("theory ink dash{}", (theory - 1) % 4)
            }
        } else {
            measured += 1;
            format!("c{}", (measured - 1) % 8)
        }
    };
    chart.series.iter().map(&mut look).collect()
}

/// The legend, wrapped into rows, and its height; empty for a single series.
fn legend(chart: &Chart, looks: &[String], left: f64) -> (String, f64) {
    if chart.series.len() < 2 {
        return (String::new(), 0.0);
    }
    let (mut out, mut x, mut row) = (String::from("<g class=\"legend\">"), left, 0.0);
    for (series, look) in chart.series.iter().zip(looks) {
        let width = 34.0 + series.name.chars().count() as f64 * CHARACTER + 16.0;
        if x > left && x + width > WIDTH - RIGHT {
            (x, row) = (left, row + 1.0);
        }
        let y = 12.0 + row * LEGEND_ROW;
        let _ = match series.style {
            Style::Theory | Style::Line => write!(out, "<path class=\"line {look}\" d=\"M{x:.1} {y:.1}h26\"/>"),
            Style::Points => write!(out, "<circle class=\"dot {look}\" cx=\"{:.1}\" cy=\"{y:.1}\" r=\"3.4\"/>", x + 13.0),
            Style::Bars => {
                write!(out, "<rect class=\"bar {look}\" x=\"{:.1}\" y=\"{:.1}\" width=\"14\" height=\"11\"/>", x + 6.0, y - 5.5)
            }
        };
        let _ = write!(out, "<text x=\"{:.1}\" y=\"{:.1}\">{}</text>", x + 34.0, y + 4.2, escape(&series.name));
        x += width;
    }
    (out + "</g>", (row + 1.0) * LEGEND_ROW)
}

/// The rectangle the series are drawn in, and its axes.
#[derive(Clone, Copy)]
struct Frame {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
    x: Range,
    y: Range,
}

impl Frame {
    fn new(chart: &Chart, y: Range, left: f64, top: f64) -> Self {
        let x = Range::of(chart.x.scale, chart.series.iter().flat_map(abscissae), 0.02);
        Self { left, top, width: WIDTH - left - RIGHT, height: HEIGHT - BOTTOM - top, x, y }
    }

    fn point(&self, x: f64, y: f64) -> Option<(f64, f64)> {
        Some((self.left + self.x.place(x)? * self.width, self.down(self.y.place(y)?)))
    }

    fn down(&self, place: f64) -> f64 {
        self.top + (1.0 - place) * self.height
    }

    /// What follows is cut off at the edges of the rectangle.
    fn clip(&self, out: &mut String) {
        let Self { left, top, width, height, .. } = self;
        let _ = write!(
            out,
            "<svg x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" \
             viewBox=\"{left:.1} {top:.1} {width:.1} {height:.1}\">"
        );
    }

    /// The frame for residuals below this one: the same abscissa, an ordinate about zero.
    fn below(&self, residuals: &[Residuals]) -> Self {
        let largest =
            residuals.iter().flat_map(|residuals| &residuals.points).fold(3.0, |most: f64, point| most.max(point.1.abs()));
        let y = Range::of(Scale::Linear, [-largest, largest].into_iter(), 0.08);
        Self { top: self.top + self.height + GAP, height: RESIDUALS, y, ..*self }
    }

    /// Dots about zero, with a band of one standard error.
    fn residuals(&self, chart: &Chart, residuals: &[Residuals], looks: &[String], out: &mut String) {
        self.axes("residual (σ)", 3, Some(chart), out);
        self.clip(out);
        let down = |value: f64| self.y.place(value).map_or(self.top, |place| self.down(place));
        let (left, right, width) = (self.left, self.left + self.width, self.width);
        let (top, zero, bottom) = (down(1.0), down(0.0), down(-1.0));
        let _ = write!(
            out,
            "<rect class=\"one\" x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{:.1}\"/>\
             <path class=\"line theory ink\" d=\"M{left:.1} {zero:.1}H{right:.1}\"/>",
            bottom - top
        );
        for Residuals { series, points } in residuals {
            let radius = if points.len() > 60 { 1.6 } else { 2.6 };
            let _ = write!(out, "<g class=\"points {}\">", looks[*series]);
            for &(x, y) in points.iter().step_by(points.len().div_ceil(2000)) {
                let Some((px, py)) = self.point(x, y) else { continue };
                let _ = write!(out, "<circle class=\"dot\" cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"{radius}\"/>");
            }
            *out += "</g>";
        }
        *out += "</svg>";
    }

    /// Grid and axes; the abscissa has texts where it is given the chart they stand in.
    fn axes(&self, ordinate: &str, y_ticks: usize, abscissa: Option<&Chart>, out: &mut String) {
        let (left, bottom) = (self.left, self.top + self.height);
        let (x_ticks, x_exponent) = self.x.ticks(7);
        for tick in x_ticks {
            let Some(x) = self.x.place(tick.value).map(|place| self.left + place * self.width) else { continue };
            let _ = match tick.text {
                Some(text) => {
                    let _ = write!(out, "<path class=\"grid\" d=\"M{x:.1} {:.1}V{bottom:.1}\"/>", self.top);
                    if abscissa.is_some() {
                        let y = bottom + 18.0;
                        write!(out, "<text class=\"tick\" x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\">{text}</text>")
                    } else {
                        Ok(())
                    }
                }
                None => write!(out, "<path class=\"minor\" d=\"M{x:.1} {bottom:.1}v-4\"/>"),
            };
        }
        for tick in self.y.ticks(y_ticks).0 {
            let Some(y) = self.y.place(tick.value).map(|place| self.down(place)) else { continue };
            let _ = match tick.text {
                Some(text) => write!(
                    out,
                    "<path class=\"grid\" d=\"M{left:.1} {y:.1}h{:.1}\"/><text class=\"tick\" x=\"{:.1}\" y=\"{:.1}\" \
                     text-anchor=\"end\">{text}</text>",
                    self.width,
                    left - 8.0,
                    y + 4.0
                ),
                None => write!(out, "<path class=\"minor\" d=\"M{left:.1} {y:.1}h4\"/>"),
            };
        }
        let _ = write!(
            out,
            "<path class=\"axis\" d=\"M{left:.1} {:.1}V{bottom:.1}h{:.1}\"/>\
             <text class=\"label\" transform=\"translate(16 {:.1}) rotate(-90)\" text-anchor=\"middle\">{ordinate}</text>",
            self.top,
            self.width,
            self.top + 0.5 * self.height,
        );
        if let Some(chart) = abscissa {
            let _ = write!(
                out,
                "<text class=\"label\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
                left + 0.5 * self.width,
                bottom + BOTTOM - 8.0,
                axis_title(&chart.x.label, &chart.x.unit, x_exponent),
            );
        }
    }

    fn series(&self, series: &Series, look: &str, out: &mut String) {
        match series.style {
            Style::Theory => self.line(series, look, out),
            Style::Line => {
                self.band(series, look, out);
                self.line(series, look, out);
            }
            Style::Points => self.points(series, look, out),
            Style::Bars => self.bars(series, look, out),
        }
    }

    fn line(&self, series: &Series, look: &str, out: &mut String) {
        let mut path = String::new();
        // A point the axes have no place for interrupts the line.
        let points: Vec<Option<(f64, f64)>> = series.x.iter().zip(&series.y).map(|(&x, &y)| self.point(x, y)).collect();
        for run in points.split(Option::is_none) {
            let run: Vec<(f64, f64)> = run.iter().copied().flatten().collect();
            trace(&thinned(&run), &mut path);
        }
        let _ = write!(out, "<path class=\"line {look}\" d=\"{path}\"/>");
    }

    /// A band of one standard error on either side.
    fn band(&self, series: &Series, look: &str, out: &mut String) {
        let edge = |sign: f64| -> Vec<(f64, f64)> {
            let points = errors(series).filter_map(|(x, y, error)| self.point(x, y + sign * error));
            thinned(&points.collect::<Vec<_>>()).into_owned()
        };
        let (mut upper, lower) = (edge(1.0), edge(-1.0));
        upper.extend(lower.iter().rev());
        if upper.len() > 2 {
            let mut path = String::new();
            trace(&upper, &mut path);
            let _ = write!(out, "<path class=\"band {look}\" d=\"{path}z\"/>");
        }
    }

    fn points(&self, series: &Series, look: &str, out: &mut String) {
        let many = series.x.len() > 200;
        let mut taken = BTreeSet::new();
        let _ = write!(out, "<g class=\"points {look}\">");
        for (index, (&x, &y)) in series.x.iter().zip(&series.y).enumerate() {
            let Some((px, py)) = self.point(x, y) else { continue };
            // Of points on the same pixel one is drawn.
            if many && !taken.insert((px.round() as i64, py.round() as i64)) {
                continue;
            }
            let error = series.standard_error.get(index).copied().filter(|error| error.is_finite());
            if let Some(error) = error {
                // On a logarithmic axis an error bar may reach down to where there is no place: it then ends at the axis.
                let end = |value: f64, otherwise: f64| self.y.place(value).map_or(otherwise, |place| self.down(place));
                let (top, bottom) = (end(y + error, py), end(y - error, self.top + self.height + 10.0));
                let _ = write!(out, "<path class=\"error\" d=\"M{px:.1} {top:.1}V{bottom:.1}\"/>");
            }
            let _ = if many {
                write!(out, "<circle class=\"dot\" cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"1.8\"/>")
            } else {
                let reading = match error {
                    Some(error) => format!("{} ± {} at {}", significant(y, 5), significant(error, 2), significant(x, 5)),
                    None => format!("{} at {}", significant(y, 5), significant(x, 5)),
                };
                write!(out, "<circle class=\"dot\" cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"3.4\"><title>{reading}</title></circle>")
            };
        }
        *out += "</g>";
    }

    fn bars(&self, series: &Series, look: &str, out: &mut String) {
        let half = 0.5 * bin_width(&series.x);
        let floor = if self.y.least() > 0.0 { self.y.least() } else { 0.0_f64.min(self.y.most()) };
        let _ = write!(out, "<g class=\"bars {look}\">");
        for (index, (&x, &y)) in series.x.iter().zip(&series.y).enumerate() {
            let (Some((left, level)), Some((right, ground))) = (self.point(x - half, y), self.point(x + half, floor)) else {
                continue;
            };
            let (top, height) = (level.min(ground), (level - ground).abs());
            let _ = write!(
                out,
                "<rect class=\"bar\" x=\"{left:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"{height:.1}\"/>",
                (right - left - 1.0).max(0.5)
            );
            if let Some(error) = series.standard_error.get(index).filter(|error| error.is_finite())
                && let (Some((middle, high)), Some((_, low))) = (self.point(x, y + error), self.point(x, (y - error).max(floor)))
            {
                let _ = write!(out, "<path class=\"error\" d=\"M{middle:.1} {high:.1}V{low:.1}\"/>");
            }
        }
        *out += "</g>";
    }
}

/// The abscissae a series covers: bars reach half a bin beyond their middles.
fn abscissae(series: &Series) -> Vec<f64> {
    match series.style {
        Style::Bars => {
            let half = 0.5 * bin_width(&series.x);
            series.x.iter().flat_map(|x| [x - half, x + half]).collect()
        }
        _ => series.x.clone(),
    }
}

/// Smallest distance between neighbouring bins; one when there is only one.
fn bin_width(middles: &[f64]) -> f64 {
    let width = middles.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|&width| width > 0.0).fold(f64::INFINITY, f64::min);
    if width.is_finite() { width } else { 1.0 }
}

/// Every `(x, y, standard error)` of a series; nothing when it has no errors.
fn errors(series: &Series) -> impl Iterator<Item = (f64, f64, f64)> + '_ {
    series.x.iter().zip(&series.y).zip(&series.standard_error).map(|((&x, &y), &error)| (x, y, error))
}

/// The range of the ordinate. Measurements count with their error bars; theory counts too, but where it leaves the
/// measurements by more than their own range it is cut off rather than allowed to flatten them.
fn ordinate_range(chart: &Chart) -> Range {
    let scale = chart.y.scale;
    let measured = || chart.series.iter().filter(|series| series.style != Style::Theory);
    let with_errors = |series: &Series| -> Vec<f64> {
        let bars =
            errors(series).flat_map(|(_, y, error)| if scale == Scale::Linear { [y - error, y + error] } else { [y, y + error] });
        bars.chain(series.y.iter().copied()).collect()
    };
    let theory = chart.series.iter().filter(|series| series.style == Style::Theory).flat_map(|series| series.y.iter().copied());
    let values: Vec<f64> = measured().flat_map(with_errors).collect();
    let range = if values.iter().any(|value| value.is_finite()) {
        let bound = Range::of(scale, values.iter().copied(), 1.0);
        let near = theory.filter(|&value| bound.least() <= value && value <= bound.most());
        Range::of(scale, values.iter().copied().chain(near), 0.06)
    } else {
        Range::of(scale, theory, 0.06)
    };
    let bars = measured().any(|series| series.style == Style::Bars);
    // Zero belongs on the axis of counts, and on any axis whose values nearly reach it.
    let nearly = range.least() > 0.0 && range.least() < 0.4 * range.most();
    if bars || nearly { range.including_zero() } else { range }
}

fn axis_title(label: &str, unit: &str, exponent: i32) -> String {
    let power = if exponent == 0 { String::new() } else { format!("10{}", superscript(exponent)) };
    let parenthesis = match (power.is_empty(), unit.is_empty()) {
        (true, true) => String::new(),
        (true, false) => format!(" ({unit})"),
        (false, true) => format!(" (× {power})"),
        (false, false) => format!(" ({power} {unit})"),
    };
    escape(&format!("{label}{parenthesis}"))
}

/// Number of characters of the longest text at the ordinate.
fn longest(range: &Range) -> usize {
    range.ticks(Y_TICKS).0.iter().filter_map(|tick| tick.text.as_ref()).map(|text| text.chars().count()).max().unwrap_or(0)
}

/// A path through these points.
fn trace(points: &[(f64, f64)], path: &mut String) {
    for (index, (x, y)) in points.iter().enumerate() {
        let _ = write!(path, "{}{x:.1} {y:.1}", if index == 0 { "M" } else { "L" });
    }
}

/// A long line with what no eye can see left out: in each column of a quarter of a pixel the first, the lowest, the highest
/// and the last point stay. A line that runs back and forth keeps every point that is half a pixel from the one before.
fn thinned(points: &[(f64, f64)]) -> std::borrow::Cow<'_, [(f64, f64)]> {
    if points.len() < 2000 {
        return points.into();
    }
    if !points.is_sorted_by(|a, b| a.0 <= b.0) {
        let mut kept = vec![points[0]];
        let mut last = points[0];
        for &(x, y) in points {
            if (x - last.0).hypot(y - last.1) >= 0.5 {
                last = (x, y);
                kept.push(last);
            }
        }
        return kept.into();
    }
    let column = |point: &(f64, f64)| (4.0 * point.0) as i64;
    let extremes = |run: &[(f64, f64)]| {
        let by_height = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        let mut kept: Vec<(f64, f64)> = [run.first(), run.iter().min_by(by_height), run.iter().max_by(by_height), run.last()]
            .into_iter()
            .flatten()
            .copied()
            .collect();
        kept.sort_by(|a, b| a.0.total_cmp(&b.0));
        kept.dedup();
        kept
    };
    points.chunk_by(|a, b| column(a) == column(b)).flat_map(extremes).collect::<Vec<_>>().into()
}
