//! One chart: theory as a line, measurement as points, bars or a line with its band of one standard error.

use corpuscle_observe::Chart;
use corpuscle_observe::chart::{Axis, Scale, Series, Style};
use corpuscle_scene::{Colour, okabe_ito};
use egui::{Color32, Stroke, Ui, vec2};
use egui_plot::{
    AxisHints, Bar, BarChart, FilledArea, GridInput, GridMark, HPlacement, HoverPosition, Line, LineStyle, Plot, PlotPoints,
    PlotUi, Points,
};

use crate::language::{Language, Text};
use crate::number::{power_of_ten, significant, tick, with_error};
use crate::theme::Theme;

/// Points a line is drawn with at most: twice the pixels of a wide chart.
const MOST: usize = 1600;
/// Marks of error bars stop where points are denser than a person can tell apart.
const BARS: usize = 400;

/// Size of the names of axes.
const NAME: f32 = 12.0;

/// How a chart is to look.
pub(super) struct Look {
    /// Colours.
    pub theme: Theme,
    /// Language of the axes.
    pub language: Language,
    /// Height in points.
    pub height: f32,
    /// Width in points.
    pub width: f32,
    /// Whether axes have names, and the pointer moves the view; a small chart has neither.
    pub large: bool,
}

/// Draws a chart; `run` makes the view of each run its own.
pub(super) fn show(ui: &mut Ui, chart: &Chart, run: u64, look: &Look) -> egui::Response {
    let (x, y) = (scale(chart.x.scale), scale(chart.y.scale));
    let faces = faces(chart, look.theme);
    let hover = |position: &HoverPosition<'_>| hover(chart, position, look.language);
    let font = egui::FontId::proportional(if look.large { 11.5 } else { 10.5 });
    let colours = look.theme.colours();
    let hints = |axis: &Axis, length: f32, hints: AxisHints<'static>| {
        let logarithmic = axis.scale == Scale::Logarithmic;
        let name = if look.large { fitted(ui, &axis_name(axis, look.language), length - 34.0) } else { String::new() };
        hints
            .label(egui::RichText::new(name).size(NAME))
            .tick_label_font(font.clone())
            .tick_label_color(colours.quiet)
            .label_spacing(8.0..=12.0)
            .formatter(move |mark, range| {
                let largest = range.start().abs().max(range.end().abs());
                if logarithmic { decade(mark) } else { tick(mark.value, mark.step_size, largest) }
            })
    };
    // A number on an axis takes so many points: no more of them than there is room for.
    let spacing = |axis: &Axis, length: f32, each: f32| {
        let logarithmic = axis.scale == Scale::Logarithmic;
        let count = f64::from(length / each).max(2.0);
        move |input: GridInput| if logarithmic { decades(&input, count) } else { round_marks(&input, count) }
    };
    let mut plot = Plot::new(("chart", &chart.name, run, look.large))
        .width(look.width)
        .height(look.height)
        .show_background(false)
        .set_margin_fraction(vec2(0.03, 0.06))
        .custom_x_axes(vec![hints(&chart.x, look.width, AxisHints::new_x())])
        .custom_y_axes(vec![hints(
            &chart.y,
            look.height,
            AxisHints::new_y().placement(HPlacement::Left).min_thickness(if look.large { 46.0 } else { 38.0 }),
        )])
        .x_grid_spacer(spacing(&chart.x, look.width - 50.0, 46.0))
        .y_grid_spacer(spacing(&chart.y, look.height - 30.0, if look.large { 24.0 } else { 18.0 }))
        .grid_spacing(8.0..=30.0)
        .grid_color(colours.line)
        .label_formatter(hover)
        .show_crosshair(look.large)
        .allow_scroll(false)
        .allow_zoom(look.large)
        .allow_drag(false)
        .allow_boxed_zoom(look.large)
        .boxed_zoom_pointer_button(egui::PointerButton::Primary);
    if !look.large {
        plot = plot.sense(egui::Sense::click()).allow_double_click_reset(false);
    }
    for height in about_a_level(chart, y).into_iter().flatten() {
        plot = plot.include_y(height);
    }
    let response = plot.show(ui, |plot| {
        for (series, face) in chart.series.iter().zip(&faces) {
            draw(plot, series, *face, look, x, y);
        }
    });
    response.response
}

/// What has to be shown above and below, where all there is so far has one height: a theory without measurements, say. By itself
/// the plot would make its axis as long as that of the time.
fn about_a_level(chart: &Chart, y: fn(f64) -> f64) -> Option<[f64; 2]> {
    let heights = chart.series.iter().flat_map(|series| {
        let ends = errors(series).flat_map(|(_, value, error)| [value - error, value + error]);
        series.y.iter().copied().chain(ends)
    });
    let shown = heights.map(y).filter(|height| height.is_finite());
    let [least, most] = shown.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], y| [least.min(y), most.max(y)]);
    let level = 0.5 * (least + most);
    let room = if level == 0.0 { 1.0 } else { 0.5 * level.abs() };
    (most - least <= 1e-9 * level.abs()).then_some([level - room, level + room])
}

/// How a series is drawn.
#[derive(Clone, Copy)]
pub(super) struct Face {
    /// Its colour.
    pub colour: Color32,
    /// Whether it is theory beside a measurement of the same colour, or theory alone, which is dashed when it is not the only one.
    pub dash: usize,
}

/// A face for each series: each theory in the colour of its measurement where they come in pairs; in ink otherwise.
pub(super) fn faces(chart: &Chart, theme: Theme) -> Vec<Face> {
    let lone = chart.before_pairs().unwrap_or(usize::MAX);
    let (mut theory, mut measured) = (0, 0);
    let next = |count: &mut usize| std::mem::replace(count, *count + 1);
    let face = |series: &Series| {
        if series.style == Style::Theory {
            let place = next(&mut theory);
            match place.checked_sub(lone) {
                Some(pair) => Face { colour: accent(pair, theme), dash: 0 },
                None => Face { colour: theme.colours().ink, dash: place },
            }
        } else {
            Face { colour: accent(next(&mut measured), theme), dash: 0 }
        }
    };
    chart.series.iter().map(face).collect()
}

/// Yellow does not show on white: the light themes have seven accents.
fn accent(place: usize, theme: Theme) -> Color32 {
    let place = if theme == Theme::Dark { place % 8 } else { [0, 1, 2, 3, 5, 4, 7][place % 7] };
    if theme != Theme::Dark && place == 5 {
        let [r, g, b] = okabe_ito(5);
        return Color32::from_rgb(r, g, b).lerp_to_gamma(Color32::BLACK, 0.2);
    }
    theme.role(Colour::Accent(place as u8))
}

fn draw<'a>(plot: &mut PlotUi<'a>, series: &'a Series, face: Face, look: &Look, x: fn(f64) -> f64, y: fn(f64) -> f64) {
    let colour = face.colour;
    let width = look.theme.stroke() * if look.large { 1.0 } else { 0.8 };
    match series.style {
        Style::Theory | Style::Line => {
            if series.style == Style::Line {
                band(plot, series, colour, x, y);
            }
            let style = match face.dash {
                0 => LineStyle::Solid,
                1 => LineStyle::dashed_dense(),
                _ => LineStyle::dotted_dense(),
            };
            for run in runs(series, x, y) {
                plot.line(Line::new(&series.name, PlotPoints::from(run)).color(colour).width(width).style(style));
            }
        }
        Style::Points => {
            error_bars(plot, series, colour, look, x, y);
            let points: Vec<[f64; 2]> = runs(series, x, y).into_iter().flatten().collect();
            let radius = if points.len() > 200 {
                1.4
            } else if look.large {
                2.8
            } else {
                2.0
            };
            plot.points(Points::new(&series.name, PlotPoints::from(points)).color(colour).radius(radius * width / 1.6));
        }
        Style::Bars => {
            let bin = series.x.windows(2).map(|w| w[1] - w[0]).fold(f64::INFINITY, f64::min);
            let bin = if bin.is_finite() { bin } else { 1.0 };
            let bars = series.x.iter().zip(&series.y).filter(|(_, y)| y.is_finite()).map(|(&at, &height)| {
                Bar::new(x(at), y(height)).width(0.92 * bin).fill(colour.gamma_multiply(0.45)).stroke(Stroke::NONE)
            });
            plot.bar_chart(BarChart::new(&series.name, bars.collect()).color(colour.gamma_multiply(0.45)).allow_hover(look.large));
            error_bars(plot, series, colour, look, x, y);
        }
    }
}

/// The points that the axes can show, in runs without a gap, thinned so that drawing costs no more than there are pixels.
fn runs(series: &Series, x: fn(f64) -> f64, y: fn(f64) -> f64) -> Vec<Vec<[f64; 2]>> {
    let points: Vec<[f64; 2]> = series.x.iter().zip(&series.y).map(|(&a, &b)| [x(a), y(b)]).collect();
    let shown = |point: &[f64; 2]| point[0].is_finite() && point[1].is_finite();
    points.split(|point| !shown(point)).filter(|run| !run.is_empty()).map(thinned).collect()
}

/// Of many points the lowest and the highest of each stretch, in their order: peaks stay, and the choice depends on the
/// stretch's place in the whole only, so that a growing line does not flicker.
fn thinned(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    if points.len() <= MOST {
        return points.to_vec();
    }
    // Stretches double in length as the line grows: those that are full stay as they are.
    let mut stretch = 2;
    while points.len().div_ceil(stretch) * 2 > MOST {
        stretch *= 2;
    }
    let mut kept = Vec::with_capacity(MOST);
    for part in points.chunks(stretch) {
        let by_height = |a: &usize, b: &usize| part[*a][1].total_cmp(&part[*b][1]);
        let lowest = (0..part.len()).min_by(by_height).unwrap_or(0);
        let highest = (0..part.len()).max_by(by_height).unwrap_or(0);
        kept.push(part[lowest.min(highest)]);
        if lowest != highest {
            kept.push(part[lowest.max(highest)]);
        }
    }
    kept
}

fn errors(series: &Series) -> impl Iterator<Item = (f64, f64, f64)> + '_ {
    let points = series.x.iter().zip(&series.y).zip(&series.standard_error).map(|((&x, &y), &error)| (x, y, error));
    points.filter(|(x, y, error)| x.is_finite() && y.is_finite() && error.is_finite())
}

fn band<'a>(plot: &mut PlotUi<'a>, series: &'a Series, colour: Color32, x: fn(f64) -> f64, y: fn(f64) -> f64) {
    let stride = (series.x.len() / MOST).max(1);
    let (mut places, mut low, mut high) = (vec![], vec![], vec![]);
    for (at, value, error) in errors(series).step_by(stride) {
        let (a, l, h) = (x(at), y(value - error), y(value + error));
        if a.is_finite() && l.is_finite() && h.is_finite() {
            places.push(a);
            low.push(l);
            high.push(h);
        }
    }
    if places.len() > 1 {
        plot.add(FilledArea::new(&series.name, &places, &low, &high).fill_color(colour.gamma_multiply(0.25)).allow_hover(false));
    }
}

fn error_bars<'a>(plot: &mut PlotUi<'a>, series: &'a Series, colour: Color32, look: &Look, x: fn(f64) -> f64, y: fn(f64) -> f64) {
    if series.x.len() > BARS {
        return band(plot, series, colour, x, y);
    }
    let width = if look.large { 1.2 } else { 0.9 };
    for (at, value, error) in errors(series) {
        let (a, high) = (x(at), y(value + error));
        // On a logarithmic axis a bar may reach down to where there is no place: it then ends at the point.
        let low = Some(y(value - error)).filter(|low| low.is_finite()).unwrap_or(y(value));
        if a.is_finite() && low.is_finite() && high.is_finite() {
            plot.line(
                Line::new(&series.name, PlotPoints::from(vec![[a, low], [a, high]])).color(colour).width(width).allow_hover(false),
            );
        }
    }
}

/// From a value to its place on an axis.
fn scale(scale: Scale) -> fn(f64) -> f64 {
    match scale {
        Scale::Linear => |value| value,
        Scale::Logarithmic => |value| if value > 0.0 { value.log10() } else { f64::NAN },
    }
}

/// As much of a name as there is room for along its axis.
fn fitted(ui: &Ui, name: &str, room: f32) -> String {
    let width = |text: String| ui.painter().layout_no_wrap(text, egui::FontId::proportional(NAME), Color32::WHITE).size().x;
    // What stands in brackets or behind a comma explains; without it the name is still one.
    let short = name.split_once(" (").or(name.split_once('，')).or(name.split_once(", ")).map_or(name, |(short, _)| short);
    let mut kept = if width(name.to_owned()) > room { short } else { name }.to_owned();
    while width(kept.clone()) > room && kept.chars().count() > 2 {
        kept = kept.trim_end_matches('…').chars().take(kept.chars().count().saturating_sub(2)).collect();
        kept.push('…');
    }
    kept
}

/// The name of an axis with its unit.
fn axis_name(axis: &Axis, language: Language) -> String {
    let name = language.phrase(&axis.label);
    if axis.unit.is_empty() { name.into_owned() } else { format!("{name} / {}", axis.unit) }
}

/// Marks at round values, at most about `count` of them.
fn round_marks(input: &GridInput, count: f64) -> Vec<GridMark> {
    let (least, most) = input.bounds;
    // The largest of 1, 2 and 5 times a power of ten that is not above 2.5 times the ideal step is never below it.
    let step = crate::number::one_two_five_below((2.5 * (most - least) / count).max(f64::MIN_POSITIVE));
    if !step.is_finite() || step <= 0.0 {
        return vec![];
    }
    let first = (least / step).ceil();
    let number = ((most / step).floor() - first).clamp(-1.0, 40.0) as i64;
    (0..=number).map(|n| GridMark { value: (first + n as f64) * step, step_size: step }).collect()
}

/// Marks at powers of ten, every second or third of them where there are many; at 2 and 5 as well where there are few.
fn decades(input: &GridInput, count: f64) -> Vec<GridMark> {
    let (least, most) = input.bounds;
    let span = most - least;
    if !span.is_finite() || span > 400.0 {
        return vec![];
    }
    let every = (span / count).ceil().max(1.0);
    let within: &[f64] = if 3.0 * span < count && span < 1.6 { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let first = (least / every).floor() as i64;
    let last = (most / every).ceil() as i64;
    let marks = (first..=last).flat_map(|n| within.iter().map(move |factor| n as f64 * every + factor.log10()));
    marks.filter(|value| (least..=most).contains(value)).map(|value| GridMark { value, step_size: every }).collect()
}

/// The number at a mark of a logarithmic axis.
fn decade(mark: GridMark) -> String {
    let power = mark.value.floor();
    let mantissa = 10f64.powf(mark.value - power).round();
    let (power, mantissa) = if mantissa >= 10.0 { (power + 1.0, 1.0) } else { (power, mantissa) };
    let value = mantissa * power_of_ten(power);
    if (0.009..9_999.0).contains(&value) { significant(value, 2) } else { tick(value, value, value) }
}

/// What the pointer reads: the value with its error, theory beside it, and by how many errors they differ.
fn hover(chart: &Chart, position: &HoverPosition<'_>, language: Language) -> Option<String> {
    let back = |place: f64, scale: Scale| if scale == Scale::Logarithmic { 10f64.powf(place) } else { place };
    let HoverPosition::NearDataPoint { plot_name, position, .. } = position else { return None };
    let x = back(position.x, chart.x.scale);
    let y = back(position.y, chart.y.scale);
    let series = chart.series.iter().find(|series| series.name == **plot_name)?;
    let nearest = (0..series.x.len()).min_by(|&a, &b| (series.x[a] - x).abs().total_cmp(&(series.x[b] - x).abs()))?;
    let error = series.standard_error.get(nearest).copied().filter(|error| error.is_finite() && *error > 0.0);
    let mut lines =
        vec![language.phrase(&series.name).into_owned(), format!("{} = {}", axis_name(&chart.x, language), significant(x, 4))];
    lines.push(format!("{} = {}", axis_name(&chart.y, language), with_error(y, error)));
    if series.style != Style::Theory
        && let Some(theory) = theory_beside(chart, series, x)
    {
        lines.push(format!("{} = {}", language.text(Text::Theory), significant(theory, 5)));
        if let Some(error) = error {
            lines.push(format!("z = {}", significant((y - theory) / error, 2)));
        }
    }
    Some(lines.join("\n"))
}

/// Counts in a bin from which on their scatter is about normal.
const ENOUGH: f64 = 5.0;

/// `chi^2 = sum ((measured - theory) / error)^2` of bars with errors beside their theory, and over how many bins: those with
/// [`ENOUGH`] counts, which is the inverse square of the relative error. None where there are no such bars.
pub(super) fn chi_squared(chart: &Chart) -> Option<(f64, usize)> {
    let bars = chart.series.iter().find(|series| series.style == Style::Bars && !series.standard_error.is_empty())?;
    let mut theories = chart.series.iter().filter(|series| series.style == Style::Theory);
    let theory = theories.next().filter(|_| theories.next().is_none())?;
    let full = errors(bars).filter(|&(_, y, error)| error > 0.0 && y * y >= ENOUGH * error * error);
    let (mut sum, mut bins) = (0.0, 0);
    for (x, y, error) in full {
        if let Some(expected) = interpolated(theory, x) {
            sum += ((y - expected) / error).powi(2);
            bins += 1;
        }
    }
    (bins > 1).then_some((sum, bins))
}

/// The value of a measurement's theory at `x`: of the one before it in the list, or of the only one.
fn theory_beside(chart: &Chart, series: &Series, x: f64) -> Option<f64> {
    let place = chart.series.iter().position(|known| std::ptr::eq(known, series))?;
    let theories: Vec<&Series> = chart.series.iter().filter(|known| known.style == Style::Theory).collect();
    let beside = place.checked_sub(1).map(|before| &chart.series[before]).filter(|before| before.style == Style::Theory);
    let theory = if let [only] = theories[..] { only } else { beside? };
    interpolated(theory, x)
}

/// A curve's value between its points.
fn interpolated(curve: &Series, x: f64) -> Option<f64> {
    let after = curve.x.iter().position(|&known| known >= x)?;
    if curve.x[after] == x {
        return Some(curve.y[after]);
    }
    let before = after.checked_sub(1)?;
    let part = (x - curve.x[before]) / (curve.x[after] - curve.x[before]);
    Some(curve.y[before] + part * (curve.y[after] - curve.y[before]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_peaks_and_does_not_flicker() {
        let wave = |n: usize| -> Vec<[f64; 2]> {
            (0..n).map(|k| [k as f64, if k == 4321 { 9.0 } else { (k as f64 * 0.37).sin() }]).collect()
        };
        let (short, long) = (thinned(&wave(20_000)), thinned(&wave(20_640)));
        assert!(short.len() <= MOST + 2);
        assert!(short.contains(&[4321.0, 9.0]));
        // What was drawn stays where it was, but for the last stretch, which was not full.
        assert_eq!(short[..short.len() - 2], long[..short.len() - 2]);
    }

    #[test]
    fn a_level_line_alone_has_an_axis_of_its_own_size() {
        let axis = |name: &str| Axis::linear(name, "");
        let of = |points: &[(f64, f64, f64)]| {
            let theory = Series::new("theory", Style::Theory, [(0.0, 1.0), (1000.0, 1.0)]);
            let measured = Series::with_errors("measured", Style::Points, points.to_vec());
            about_a_level(&Chart::new("c", "", axis("x"), axis("y")).with(theory).with(measured), |y| y)
        };
        assert_eq!(of(&[]), Some([0.5, 1.5]));
        assert_eq!(of(&[(500.0, 1.0, 0.0)]), Some([0.5, 1.5]));
        assert_eq!(of(&[(500.0, 1.0, 0.1)]), None);
        assert_eq!(about_a_level(&Chart::new("c", "", axis("x"), axis("y")), |y| y), None);
    }

    #[test]
    fn marks_of_a_logarithmic_axis_are_powers_of_ten() {
        let texts = |bounds| decades(&GridInput { bounds, base_step_size: 0.1 }, 6.0).into_iter().map(decade).collect::<Vec<_>>();
        assert_eq!(texts((-2.2, 1.5)), ["0.01", "0.1", "1", "10"]);
        assert_eq!(texts((0.1, 0.9)), ["2", "5"]);
        assert_eq!(texts((-9.5, -3.0)), ["10⁻⁸", "10⁻⁶", "10⁻⁴"]);
    }

    /// Of Poisson counts about their theory, chi^2 is as large as the number of bins, within its own scatter.
    #[test]
    fn chi_squared_of_honest_counts_is_their_number() {
        let mut random = corpuscle_core::Random::new(4, 0);
        let (mut sum, mut all) = (0.0, 0.0);
        for _ in 0..40 {
            let counts: Vec<f64> = (0..20).map(|_| 400.0 + 20.0 * random.normal()).collect();
            let bars = counts.iter().enumerate().map(|(k, &n)| (k as f64, n, 20.0));
            let axis = || Axis::linear("x", "");
            let chart = Chart::new("c", "", axis(), axis())
                .with(Series::with_errors("measured", Style::Bars, bars))
                .with(Series::new("theory", Style::Theory, [(-1.0, 400.0), (21.0, 400.0)]));
            let (chi, bins) = chi_squared(&chart).unwrap();
            assert_eq!(bins, 20);
            (sum, all) = (sum + chi, all + bins as f64);
        }
        let z = (sum - all) / (2.0 * all).sqrt();
        assert!(z.abs() < 4.0, "{z}");
    }

    #[test]
    fn theory_is_read_between_its_points() {
        let theory = Series::new("theory", Style::Theory, [(0.0, 0.0), (2.0, 4.0)]);
        let measured = Series::new("measured", Style::Points, [(1.0, 2.5)]);
        let axis = |name: &str| Axis::linear(name, "");
        let chart = Chart::new("c", "", axis("x"), axis("y")).with(theory).with(measured);
        assert_eq!(theory_beside(&chart, &chart.series[1], 1.0), Some(2.0));
        assert_eq!(theory_beside(&chart, &chart.series[1], 3.0), None);
    }
}
