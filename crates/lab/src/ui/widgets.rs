//! What several panels are built from.

use egui::{Color32, FontId, Response, RichText, Sense, Ui, Vec2, WidgetInfo, vec2};

use super::icons::{Icon, paint};
use crate::command::Command;
use crate::language::Text;
use crate::model::Model;
use crate::theme::{Colours, bold};

/// A square button with a sign; its name is for the pointer that rests on it, and for screen readers.
pub(super) fn icon_button(ui: &mut Ui, icon: Icon, name: &str, key: &str, chosen: bool) -> Response {
    sized_icon_button(ui, icon, name, key, chosen, vec2(30.0, 28.0))
}

/// The same in another size.
pub(super) fn sized_icon_button(ui: &mut Ui, icon: Icon, name: &str, key: &str, chosen: bool, size: Vec2) -> Response {
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| WidgetInfo::selected(egui::Role::Button, ui.is_enabled(), chosen, name));
    if ui.is_rect_visible(rect) {
        let visuals = ui.style().interact_selectable(&response, chosen);
        let fill = if chosen { ui.visuals().selection.bg_fill } else { visuals.weak_bg_fill };
        let ink = if chosen { ui.visuals().selection.stroke.color } else { visuals.fg_stroke.color };
        ui.painter().rect_filled(rect, visuals.corner_radius, fill);
        if response.has_focus() {
            ui.painter().rect_stroke(
                rect,
                visuals.corner_radius,
                ui.visuals().widgets.hovered.bg_stroke,
                egui::StrokeKind::Outside,
            );
        }
        let side = (size.y * 0.5).round();
        let inner = egui::Rect::from_center_size(rect.center(), vec2(side, side));
        paint(ui.painter(), icon, inner, if ui.is_enabled() { ink } else { ui.visuals().weak_text_color() });
    }
    let tip = if key.is_empty() { name.to_owned() } else { format!("{name}  ({key})") };
    response.on_hover_text(tip)
}

/// A button with a sign that does a command.
pub(super) fn command_button(ui: &mut Ui, model: &Model, icon: Icon, command: Command, text: Text) -> bool {
    icon_button(ui, icon, model.text(text), command.key(), false).clicked()
}

/// A heading within a panel.
pub(super) fn section(ui: &mut Ui, colours: &Colours, words: &str) {
    ui.add_space(6.0);
    ui.label(RichText::new(words).font(FontId::new(12.0, bold())).color(colours.quiet));
    ui.add_space(3.0);
}

/// Text of less weight, which wraps.
pub(super) fn quiet(ui: &mut Ui, colours: &Colours, words: &str) -> Response {
    ui.add(egui::Label::new(RichText::new(words).color(colours.quiet).small()).wrap())
}

/// A name and a value at either end of a line.
pub(super) fn row(ui: &mut Ui, name: &str, value: &str, colour: Color32) -> Response {
    ui.horizontal(|ui| {
        ui.add(egui::Label::new(name).truncate());
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| ui.label(RichText::new(value).color(colour)));
    })
    .response
}
