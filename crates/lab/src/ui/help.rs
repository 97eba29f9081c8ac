//! The list of keys, made from the table that reads them.

use egui::{Align2, FontId, Grid, Label, RichText, Ui, Window};

use crate::command::BINDINGS;
use crate::language::Text;
use crate::model::{Model, Overlay};
use crate::theme::bold;

pub(super) fn show(ui: &mut Ui, model: &mut Model) {
    let colours = model.preferences.theme.colours();
    let mut open = true;
    Window::new(model.text(Text::Help))
        .open(&mut open)
        .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
        .collapsible(false)
        .resizable(false)
        .show(ui.ctx(), |ui| {
            ui.spacing_mut().interact_size.y = 16.0;
            ui.horizontal_top(|ui| {
                for half in BINDINGS.chunks(BINDINGS.len().div_ceil(2)) {
                    Grid::new(half[0].shown).num_columns(2).spacing([14.0, 4.0]).show(ui, |ui| {
                        for binding in half {
                            ui.label(RichText::new(binding.shown).font(FontId::new(13.5, bold())).color(colours.accent));
                            ui.label(model.text(binding.text));
                            ui.end_row();
                        }
                    });
                    ui.add_space(18.0);
                }
            });
            ui.add_space(8.0);
            ui.set_max_width(ui.min_rect().width());
            ui.add(Label::new(RichText::new(model.text(Text::HelpPointer)).color(colours.quiet)).wrap());
        });
    if !open {
        model.overlay = Overlay::None;
    }
}
