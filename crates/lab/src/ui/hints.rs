//! First-run hints: three sentences, one after the other, that go away for good.

use egui::{Align2, Area, Frame, Order, Rect, Ui, vec2};

use crate::language::Text;
use crate::model::Model;

const HINTS: [Text; 3] = [Text::HintPlay, Text::HintStage, Text::HintKeys];

pub(super) fn show(ui: &Ui, model: &mut Model, stage: Rect) {
    let seen = usize::from(model.preferences.hints_seen);
    let Some(&hint) = HINTS.get(seen) else { return };
    let colours = model.preferences.theme.colours();
    let at = stage.center_bottom() + vec2(0.0, -18.0);
    Area::new(egui::Id::unique("hint")).order(Order::Middle).pivot(Align2::CENTER_BOTTOM).fixed_pos(at).show(ui.ctx(), |ui| {
        let frame = Frame::popup(ui.style()).fill(colours.panel).stroke((1.0, colours.accent)).inner_margin(12.0);
        frame.show(ui, |ui| {
            ui.set_max_width((stage.width() - 60.0).min(420.0));
            ui.label(model.text(hint));
            ui.horizontal(|ui| {
                let next = if seen + 1 < HINTS.len() { Text::HintNext } else { Text::HintDone };
                if ui.button(model.text(next)).clicked() {
                    model.preferences.hints_seen += 1;
                }
                if seen + 1 < HINTS.len() && ui.button(model.text(Text::HintNever)).clicked() {
                    model.preferences.hints_seen = HINTS.len() as u8;
                }
            });
        });
    });
}
