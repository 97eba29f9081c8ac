//! The bar on top: what runs, and what belongs to the window as a whole.

use egui::{Align, ComboBox, FontId, Label, Layout, RichText, Ui};

use super::icons::Icon;
use super::widgets::{command_button, icon_button};
use crate::command::Command;
use crate::language::{Language, Text};
use crate::model::{Model, Overlay};
use crate::runner::Snapshot;
use crate::theme::{Theme, bold};

pub(super) fn show(ui: &mut Ui, model: &mut Model, seen: &Snapshot) {
    let colours = model.preferences.theme.colours();
    ui.horizontal(|ui| {
        let open = model.overlay == Overlay::Gallery;
        if icon_button(ui, Icon::Tiles, model.text(Text::Gallery), Command::Gallery.key(), open).clicked() {
            model.obey(Command::Gallery, seen);
        }
        ui.add_space(4.0);
        let title = model.language().phrase(model.scenario.title()).into_owned();
        ui.label(RichText::new(title).font(FontId::new(18.0, bold())));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ends(ui, model, seen);
            let summary = model.language().phrase(model.scenario.summary()).into_owned();
            ui.add_space(6.0);
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.add_space(8.0);
                let shown = whole_clauses(ui, &summary, ui.available_width() - 8.0);
                ui.add(Label::new(RichText::new(shown).color(colours.quiet).small()).wrap()).on_hover_text(&summary);
            });
        });
    });
}

/// As many whole clauses as two lines of small text have room for: a sentence that breaks off tells less than a shorter one.
fn whole_clauses(ui: &Ui, text: &str, width: f32) -> String {
    let font = egui::TextStyle::Small.resolve(ui.style());
    let fits = |text: &str| ui.painter().layout(text.to_owned(), font.clone(), egui::Color32::WHITE, width).rows.len() <= 2;
    if fits(text) {
        return text.to_owned();
    }
    let ends = text.char_indices().filter(|(_, c)| matches!(c, '.' | ':' | ',' | ';' | '。' | '：' | '，' | '；' | '、'));
    let full = if text.is_ascii() { '.' } else { '。' };
    let clauses = ends.map(|(end, _)| format!("{}{full}", text[..end].trim_end()));
    clauses.rev().find(|clause| fits(clause)).unwrap_or_default()
}

/// From the right end inwards.
fn ends(ui: &mut Ui, model: &mut Model, seen: &Snapshot) {
    let help = ui.button(RichText::new("?").font(FontId::new(15.0, bold())));
    help.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, model.text(Text::Help)));
    if help.on_hover_text(format!("{}  (?)", model.text(Text::Help))).clicked() {
        model.obey(Command::Help, seen);
    }
    let theme = model.preferences.theme;
    let colours = ComboBox::from_id_salt("theme").width(92.0).selected_text(model.text(theme.text())).show_ui(ui, |ui| {
        for choice in Theme::ALL {
            let name = model.text(choice.text());
            ui.selectable_value(&mut model.preferences.theme, choice, name);
        }
    });
    named(&colours.response, model.text(Text::Colours));
    let language = model.language();
    let languages = ComboBox::from_id_salt("language").width(92.0).selected_text(language.name()).show_ui(ui, |ui| {
        for choice in Language::ALL {
            ui.selectable_value(&mut model.preferences.language, choice, choice.name());
        }
    });
    named(&languages.response, model.text(Text::LanguageOf));
    for (icon, command, text) in [
        (Icon::Record, Command::Record, Text::DoRecord),
        (Icon::Save, Command::Save, Text::DoSave),
        (Icon::Open, Command::Open, Text::DoOpen),
    ] {
        if command_button(ui, model, icon, command, text) {
            model.obey(command, seen);
        }
    }
}

fn named(combo: &egui::Response, name: &str) {
    combo.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, name));
}
