//! Measurement beside theory: value, error, expectation, z and verdict, as the report prints them.

use corpuscle_observe::Check;
use corpuscle_observe::check::Verdict;
use egui::{Align, Align2, Color32, FontId, Frame, Layout, Rect, RichText, Sense, Stroke, Ui, pos2, vec2};

use super::icons::Icon;
use super::related;
use super::widgets::{quiet, sized_icon_button};
use crate::language::Text;
use crate::model::{Model, Tab};
use crate::number::{significant, with_error};
use crate::runner::Snapshot;
use crate::theme::{Colours, bold};

/// The tabs of the panel on the right, and beside them how many checks hold.
pub(super) fn tabs(ui: &mut Ui, model: &mut Model, seen: &Snapshot) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        for (tab, text, command) in Tab::ALL {
            let response = ui.selectable_label(model.tab == tab, model.text(text));
            if response.on_hover_text(format!("{}  ({})", model.text(text), command.key())).clicked() {
                model.tab = tab;
            }
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| verdict(ui, model, seen));
    });
    ui.add_space(4.0);
}

/// One line for all checks.
fn verdict(ui: &mut Ui, model: &Model, seen: &Snapshot) {
    let colours = model.preferences.theme.colours();
    let checks = &seen.measured.checks;
    if checks.is_empty() {
        return;
    }
    let good = checks.iter().filter(|check| check.passed).count();
    let all = good == checks.len();
    let (mark, colour) = mark(all, is_ready(seen), &colours);
    let short = format!("{mark} {good}/{}", checks.len());
    let long = model.language().fill(Text::ChecksHold, &[&good.to_string(), &checks.len().to_string()]);
    ui.label(RichText::new(short).font(FontId::new(13.0, bold())).color(colour)).on_hover_text(long);
}

/// Before the experiment has measured what it set out to measure, a check that does not hold is no failure yet.
fn is_ready(seen: &Snapshot) -> bool {
    seen.measured.time >= seen.end
}

fn mark(passed: bool, ready: bool, colours: &Colours) -> (&'static str, Color32) {
    match (passed, ready) {
        (true, _) => ("✓", colours.good),
        (false, true) => ("✗", colours.bad),
        (false, false) => ("…", colours.quiet),
    }
}

pub(super) fn show(ui: &mut Ui, model: &mut Model, seen: &Snapshot) {
    let colours = model.preferences.theme.colours();
    let checks = &seen.measured.checks;
    if checks.is_empty() {
        quiet(ui, &colours, model.text(Text::NoChecks));
        return;
    }
    if !is_ready(seen) {
        let end = significant(seen.end, 4);
        quiet(ui, &colours, &model.language().fill(Text::ChecksEarly, &[&end]));
    }
    let mut wanted = None;
    for check in checks {
        let chart = related::chart(&seen.measured.charts, check);
        if card(ui, model, check, is_ready(seen), chart.is_some()) {
            wanted = chart;
        }
    }
    if let Some(name) = wanted {
        model.show_chart(name);
    }
}

/// One check; whether its chart is wanted.
fn card(ui: &mut Ui, model: &Model, check: &Check, ready: bool, has_chart: bool) -> bool {
    let colours = model.preferences.theme.colours();
    let language = model.language();
    let (mark, colour) = mark(check.passed, ready, &colours);
    let frame = Frame::new()
        .fill(colours.ground)
        .stroke((1.0, colours.line))
        .corner_radius(5.0)
        .inner_margin(egui::Margin::symmetric(9, 6));
    let mut wanted = false;
    frame.show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.spacing_mut().item_spacing.y = 3.0;
        ui.horizontal(|ui| {
            ui.label(RichText::new(mark).font(FontId::new(14.0, bold())).color(colour));
            let side = vec2(22.0, 20.0);
            let width = ui.available_width() - if has_chart { side.x + 8.0 } else { 0.0 };
            ui.scope(|ui| {
                ui.set_max_width(width);
                ui.add(egui::Label::new(language.phrase(&check.quantity)).wrap());
            });
            if has_chart {
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                    let name = format!("{}: {}", language.text(Text::ShowChart), language.phrase(&check.quantity));
                    wanted = sized_icon_button(ui, Icon::Picture, &name, "", false, side).clicked();
                });
            }
        });
        let unit = if check.unit.is_empty() { String::new() } else { format!(" {}", check.unit) };
        let relation = match check.verdict {
            Verdict::Agreement => "",
            Verdict::AtMost => "≤ ",
            Verdict::AtLeast => "≥ ",
        };
        ui.horizontal(|ui| {
            let measured = with_error(check.measured, check.standard_error);
            ui.label(RichText::new(format!("{measured}{unit}")).font(FontId::new(14.0, bold())));
            ui.label(
                RichText::new(format!("{} {relation}{}", language.text(Text::Theory), significant(check.expected, 4)))
                    .color(colours.quiet),
            );
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                if let Some(z) = check.z {
                    score(ui, z, colour, &colours);
                }
            });
        });
        if !check.reference.is_empty() {
            quiet(ui, &colours, &language.phrase(&check.reference));
        }
    });
    wanted
}

/// Where z lies between the limits, drawn and written.
fn score(ui: &mut Ui, z: f64, colour: Color32, colours: &Colours) {
    let (rect, response) = ui.allocate_exact_size(vec2(104.0, 18.0), Sense::hover());
    let painter = ui.painter();
    let scale = Rect::from_min_max(pos2(rect.left(), rect.center().y - 2.0), pos2(rect.left() + 48.0, rect.center().y + 2.0));
    painter.rect_filled(scale, 2.0, colours.hovered);
    for sign in [-0.5f32, 0.0, 0.5] {
        let x = scale.center().x + sign * scale.width();
        painter.line_segment([pos2(x, scale.top() - 3.0), pos2(x, scale.bottom() + 3.0)], Stroke::new(1.0, colours.quiet));
    }
    let place = (z / (2.0 * Check::Z_LIMIT)).clamp(-0.56, 0.56) as f32;
    painter.circle_filled(pos2(scale.center().x + place * scale.width(), scale.center().y), 4.5, colour);
    painter.text(rect.right_center(), Align2::RIGHT_CENTER, format!("z {}", significant(z, 2)), FontId::proportional(12.5), colour);
    response.on_hover_text(format!("|z| ≤ {}", Check::Z_LIMIT));
}
