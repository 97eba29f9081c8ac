//! All charts of the experiment at once: one large, the others small below it, without scrolling. A click on a small one
//! makes it the large one.

use corpuscle_io::csv;
use corpuscle_observe::Chart;
use corpuscle_observe::chart::{Series, Style};
use egui::text::{LayoutJob, TextWrapping};
use egui::{Align, Color32, FontId, Layout, Rect, RichText, Sense, Stroke, Ui, UiBuilder, pos2, vec2};

use super::chart::{Face, Look, chi_squared, faces, show as plot};
use super::icons::Icon;
use super::widgets::{quiet, sized_icon_button};
use crate::language::Text;
use crate::model::{Job, Model, Tab};
use crate::number::significant;
use crate::runner::Snapshot;
use crate::theme::{Theme, bold};

/// Height of a small chart, at least and at most, in points.
const SMALL: (f32, f32) = (96.0, 190.0);
/// Share of the height that all small charts get.
const SHARE: f32 = 0.44;
/// Between charts.
const GAP: f32 = 8.0;

pub(super) fn show(ui: &mut Ui, model: &mut Model, seen: &Snapshot) {
    let measured = seen.measured.clone();
    let colours = model.preferences.theme.colours();
    let Some(first) = measured.charts.first() else {
        quiet(ui, &colours, model.text(Text::NoCharts));
        return;
    };
    let large = measured.charts.iter().find(|chart| Some(&chart.name) == model.large_chart.as_ref()).unwrap_or(first);
    let small: Vec<&Chart> = measured.charts.iter().filter(|chart| chart.name != large.name).collect();
    let area = ui.available_rect_before_wrap();
    let rows = small.len().div_ceil(2);
    let room = (SHARE * area.height() / rows.max(1) as f32 - GAP).clamp(SMALL.0, SMALL.1);
    let below = (room + GAP) * rows as f32;
    let top = Rect::from_min_max(area.min, pos2(area.right(), area.bottom() - below));
    ui.scope_builder(UiBuilder::new().max_rect(top), |ui| {
        if one(ui, model, large, seen.run, colours.quiet) {
            model.ask(Job::Picture(format!("{}-{}.png", model.scenario.name(), large.name).into(), top));
        }
    });
    let count = small.len();
    for (index, chart) in small.into_iter().enumerate() {
        let (row, column) = (index / 2, index % 2);
        let half = 0.5 * (area.width() - GAP);
        // The last of an odd number has the row to itself.
        let width = if column == 0 && index + 1 == count { area.width() } else { half };
        let min = pos2(area.left() + column as f32 * (half + GAP), top.bottom() + GAP + row as f32 * (room + GAP));
        let rect = Rect::from_min_size(min, vec2(width, room));
        if tile(ui, model, chart, seen.run, rect) {
            model.large_chart = Some(chart.name.clone());
        }
    }
    ui.advance_cursor_after_rect(area);
}

/// The large chart, with what to look at and what its lines are; whether it is wanted as a picture.
fn one(ui: &mut Ui, model: &mut Model, chart: &Chart, run: u64, ink: Color32) -> bool {
    let language = model.language();
    let mut wanted = false;
    if model.from_checks && ui.button(format!("← {}", model.text(Text::BackToChecks))).clicked() {
        (model.tab, model.from_checks) = (Tab::Checks, false);
    }
    ui.horizontal(|ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let tip = model.text(Text::SaveCsv);
            if sized_icon_button(ui, Icon::Save, tip, "", false, vec2(24.0, 22.0)).clicked() {
                model.ask(Job::Write(format!("{}-{}.csv", model.scenario.name(), chart.name).into(), csv::chart(chart)));
            }
            let tip = model.text(Text::SavePicture);
            wanted = sized_icon_button(ui, Icon::Picture, tip, "", false, vec2(24.0, 22.0)).clicked();
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                let title = RichText::new(language.phrase(&chart.title)).font(FontId::new(14.0, bold()));
                ui.add(egui::Label::new(title).truncate());
            });
        });
    });
    key(ui, model, chart);
    chi_squared_line(ui, model, chart);
    let note = &*language.phrase(&chart.note);
    let lines = if note.is_empty() { 0.0 } else { note_height(ui, note) };
    let height = ui.available_height() - lines;
    let look = Look {
        theme: model.preferences.theme,
        language,
        height: height.max(90.0),
        width: ui.available_width() - 10.0,
        large: true,
    };
    let response = plot(ui, chart, run, &look);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, language.phrase(&chart.title)));
    if !note.is_empty() {
        ui.add(egui::Label::new(RichText::new(note).color(ink).small()).wrap());
    }
    wanted
}

fn note_height(ui: &Ui, note: &str) -> f32 {
    let font = egui::TextStyle::Small.resolve(ui.style());
    let galley = ui.painter().layout(note.to_owned(), font, Color32::WHITE, ui.available_width());
    galley.size().y + ui.spacing().item_spacing.y + 2.0
}

/// What the lines, points and bars are.
fn key(ui: &mut Ui, model: &Model, chart: &Chart) {
    let theme = model.preferences.theme;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(4.0, 2.0);
        ui.spacing_mut().interact_size.y = 15.0;
        for (series, face) in chart.series.iter().zip(faces(chart, theme)) {
            let name = &*model.language().phrase(&series.name);
            // A sign and its name stay on one line.
            let font = egui::TextStyle::Small.resolve(ui.style());
            let width = 32.0 + ui.painter().layout_no_wrap(name.to_owned(), font, Color32::WHITE).size().x;
            if ui.available_size_before_wrap().x < width {
                ui.end_row();
            }
            let (rect, _) = ui.allocate_exact_size(vec2(20.0, 14.0), Sense::hover());
            sign(ui.painter(), rect, series, face, theme);
            ui.label(RichText::new(name).small());
            ui.add_space(8.0);
        }
    });
}

/// How a series is drawn, in small.
fn sign(painter: &egui::Painter, rect: Rect, series: &Series, face: Face, theme: Theme) {
    let (middle, width) = (rect.center(), rect.width());
    match series.style {
        Style::Theory | Style::Line => {
            let ends = [rect.left_center(), rect.right_center()];
            let stroke = Stroke::new(theme.stroke() + 0.4, face.colour);
            match face.dash {
                0 => drop(painter.line_segment(ends, stroke)),
                n => painter.extend(egui::Shape::dashed_line(&ends, stroke, if n == 1 { 5.0 } else { 2.0 }, 3.0)),
            }
            if series.style == Style::Line && !series.standard_error.is_empty() {
                painter.rect_filled(Rect::from_center_size(middle, vec2(width, 9.0)), 0.0, face.colour.gamma_multiply(0.25));
            }
        }
        Style::Points => drop(painter.circle_filled(middle, 3.4, face.colour)),
        Style::Bars => {
            painter.rect_filled(Rect::from_center_size(middle, vec2(0.6 * width, 11.0)), 1.0, face.colour.gamma_multiply(0.5));
        }
    }
}

/// Bars beside a theory: how well they agree as a whole.
fn chi_squared_line(ui: &mut Ui, model: &Model, chart: &Chart) {
    if let Some((chi_squared, bins)) = chi_squared(chart) {
        let words = model.language().fill(Text::ChiSquared, &[&significant(chi_squared, 3), &bins.to_string()]);
        ui.label(RichText::new(words).small()).on_hover_text(model.text(Text::ChiSquaredHelp));
    }
}

/// Height of a line of a small key.
const KEY_LINE: f32 = 13.0;
/// A name shorter than this tells nothing.
const KEY_NAME: f32 = 42.0;

/// The key of a small chart: as many series as there is room for in so many lines.
fn small_key(ui: &Ui, model: &Model, chart: &Chart, rect: Rect) {
    let theme = model.preferences.theme;
    let (font, ink) = (FontId::proportional(9.5), theme.colours().quiet);
    let lines = (rect.height() / KEY_LINE).round().max(1.0);
    let in_a_line = (chart.series.len() as f32 / lines).ceil();
    let most = (rect.width() / in_a_line - 22.0).max(KEY_NAME);
    let mut at = rect.min;
    for (series, face) in chart.series.iter().zip(faces(chart, theme)) {
        let name = model.language().phrase(&series.name);
        let mut job = LayoutJob::single_section(name.into_owned(), egui::TextFormat::simple(font.clone(), ink));
        job.wrap = TextWrapping::truncate_at_width(most);
        let text = ui.painter().layout_job(job);
        let width = 15.0 + text.size().x;
        if at.x + width > rect.right() + 1.0 {
            at = pos2(rect.left(), at.y + KEY_LINE);
        }
        if at.y + KEY_LINE > rect.bottom() + 1.0 {
            return;
        }
        let mark = Rect::from_min_size(at, vec2(11.0, KEY_LINE));
        sign(&ui.painter().with_clip_rect(mark), mark, series, face, theme);
        ui.painter().galley(pos2(at.x + 14.0, mark.center().y - 0.5 * text.size().y), text, ink);
        at.x += width + 7.0;
    }
}

/// A title in the largest size in which it fits; in the smallest it is cut.
fn fitting_title(ui: &Ui, title: &str, width: f32) -> RichText {
    let needs = |size: f32| ui.painter().layout_no_wrap(title.to_owned(), FontId::new(size, bold()), Color32::WHITE).size().x;
    let size = [11.5, 10.5, 9.5].into_iter().find(|&size| needs(size) <= width).unwrap_or(9.5);
    RichText::new(title).font(FontId::new(size, bold()))
}

/// A small chart; whether it was chosen.
fn tile(ui: &mut Ui, model: &Model, chart: &Chart, run: u64, rect: Rect) -> bool {
    let language = model.language();
    let colours = model.preferences.theme.colours();
    let title = &*language.phrase(&chart.title);
    let response = ui.interact(rect, ui.scope_id().with(("tile", &chart.name)), Sense::click());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, title));
    let edge = if response.hovered() || response.has_focus() { colours.accent } else { colours.line };
    ui.painter().rect(rect, 5.0, colours.ground, Stroke::new(1.0, edge), egui::StrokeKind::Inside);
    let inner = rect.shrink2(vec2(5.0, 3.0));
    let mut chosen = response.clicked();
    ui.scope_builder(UiBuilder::new().max_rect(inner), |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        let heading = fitting_title(ui, title, ui.available_width());
        ui.add(egui::Label::new(heading).truncate());
        // A theory and a measurement tell themselves apart.
        if chart.series.len() > 2 {
            let lines = if rect.height() < 118.0 { 1.0 } else { 2.0 };
            let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), lines * KEY_LINE), Sense::hover());
            small_key(ui, model, chart, rect);
        }
        let look = Look {
            theme: model.preferences.theme,
            language,
            height: ui.available_height(),
            width: ui.available_width(),
            large: false,
        };
        chosen |= plot(ui, chart, run, &look).clicked();
    });
    response.on_hover_text(model.text(Text::MakeLarge));
    chosen
}
