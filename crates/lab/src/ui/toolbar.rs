//! The tools, in a column at the left edge of the stage, and what the chosen one is set to.

use egui::{DragValue, Frame, Margin, Rect, Ui, UiBuilder, pos2, vec2};

use super::icons::Icon;
use super::widgets::sized_icon_button;
use crate::command::Command;
use crate::language::Text;
use crate::model::Model;
use crate::number::significant;
use crate::runner::Snapshot;
use crate::tools::Tool;

/// Width of the column, in points.
pub(super) const WIDTH: f32 = 36.0;
/// Size of a button.
const BUTTON: f32 = 28.0;
/// Between buttons, and between their groups.
const GAPS: [f32; 2] = [2.0, 8.0];

/// The tools in groups: those that look, those that touch bodies, those that touch the box, those that measure.
const GROUPS: [&[(Tool, Icon)]; 4] = [
    &[(Tool::Hand, Icon::Move)],
    &[(Tool::Carry, Icon::Carry), (Tool::Throw, Icon::Throw), (Tool::Add, Icon::Plus), (Tool::Remove, Icon::Minus)],
    &[(Tool::Partition, Icon::Plate), (Tool::Heat, Icon::Flame), (Tool::Piston, Icon::Piston)],
    &[(Tool::Ruler, Icon::Ruler), (Tool::Probe, Icon::Probe)],
];

/// Why something cannot be done in this experiment, under its name.
pub(super) fn refused(model: &Model, name: &str, needs: &str) -> String {
    let language = model.language();
    format!("{name}\n{}", language.fill(Text::Unable, &[&language.phrase(needs)]))
}

pub(super) fn show(ui: &mut Ui, model: &mut Model, seen: &Snapshot, column: Rect) {
    if model.tool.refusal(seen).is_some() {
        (model.tool, model.touch) = (Tool::Hand, None);
    }
    let rect = column.shrink2(vec2(4.0, 4.0));
    ui.scope_builder(UiBuilder::new().max_rect(rect).layout(egui::Layout::top_down(egui::Align::Center)), |ui| {
        ui.spacing_mut().item_spacing.y = GAPS[0];
        let size = vec2(BUTTON, BUTTON - 2.0);
        for group in GROUPS {
            for &(tool, icon) in group {
                let key = if tool == Tool::Hand { Command::NextTool.key() } else { "" };
                let needs = tool.refusal(seen).map(|needs| refused(model, model.text(tool.text()), needs));
                let button = ui.add_enabled_ui(needs.is_none(), |ui| {
                    let button = sized_icon_button(ui, icon, model.text(tool.text()), key, model.tool == tool, size);
                    button.on_disabled_hover_text(needs.as_deref().unwrap_or_default())
                });
                if button.inner.clicked() {
                    model.tool = if model.tool == tool { Tool::Hand } else { tool };
                    model.touch = None;
                }
            }
            ui.add_space(GAPS[1] - GAPS[0]);
        }
        let watch = model.stopwatch.reading(seen.time).is_some();
        for (icon, command, text, chosen) in [
            (Icon::Watch, Command::Stopwatch, Text::DoStopwatch, watch),
            (Icon::Arrow, Command::Arrows, Text::DoArrows, model.preferences.arrows),
            (Icon::Fit, Command::Fit, Text::DoFit, false),
        ] {
            if sized_icon_button(ui, icon, model.text(text), command.key(), chosen, size).clicked() {
                model.obey(command, seen);
            }
        }
    });
}

/// What the chosen tool is set to, beside the column.
pub(super) fn settings(ui: &mut Ui, model: &mut Model, seen: &Snapshot, stage: Rect) {
    if !matches!(model.tool, Tool::Partition | Tool::Heat) {
        return;
    }
    let colours = model.preferences.theme.colours();
    let rect = Rect::from_min_size(stage.min + vec2(10.0, 10.0), vec2(240.0, 36.0)).intersect(stage);
    ui.scope_builder(UiBuilder::new().max_rect(rect), |ui| {
        let margin = Margin::symmetric(10, 5);
        Frame::new().fill(colours.panel).stroke((1.0, colours.line)).corner_radius(5.0).inner_margin(margin).show(ui, |ui| {
            ui.horizontal(|ui| {
                if model.tool == Tool::Partition {
                    partition(ui, model, seen);
                } else {
                    let label = ui.label(model.text(Text::WallTemperature));
                    let field = DragValue::new(&mut model.tools.temperature).range(0.0..=1e6).speed(0.02);
                    ui.add(field.custom_formatter(|value, _| significant(value, 4))).labelled_by(label.id);
                }
            });
        });
    });
}

/// The hole of the next plate, and a way to take all of them out.
fn partition(ui: &mut Ui, model: &mut Model, seen: &Snapshot) {
    let label = ui.label(model.text(Text::HoleWidth));
    let field = DragValue::new(&mut model.tools.hole)
        .range(0.0..=1.0)
        .speed(0.005)
        .custom_formatter(|value, _| format!("{} %", significant(100.0 * value, 3)))
        .custom_parser(|text| text.trim_end_matches('%').trim().parse::<f64>().ok().map(|value| 0.01 * value));
    ui.add(field).labelled_by(label.id);
    let open = ui.button(model.text(Text::DoOpenPartitions));
    if open.on_hover_text(Command::OpenPartitions.key()).clicked() {
        model.obey(Command::OpenPartitions, seen);
    }
}

/// The part of the stage that is left beside the column.
pub(super) fn beside(stage: Rect) -> (Rect, Rect) {
    let x = stage.left() + WIDTH;
    (Rect::from_min_max(stage.min, pos2(x, stage.bottom())), Rect::from_min_max(pos2(x, stage.top()), stage.max))
}
