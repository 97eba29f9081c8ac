//! Opening, saving, recording: small windows with a name to type.

use egui::{Align2, DragValue, Grid, Key, TextEdit, Ui, Window};

use super::widgets::quiet;
use crate::language::Text;
use crate::model::{Job, Model, Overlay};
use crate::runner::Snapshot;

pub(super) fn open(ui: &mut Ui, model: &mut Model) {
    framed(ui, model, Text::DoOpen, |ui, model| {
        let colours = model.preferences.theme.colours();
        quiet(ui, &colours, model.text(Text::OpenHelp));
        if name(ui, model, Text::DoOpen) {
            let path = model.typed.path.trim().to_owned();
            model.open(path.as_ref());
        }
    });
}

pub(super) fn save(ui: &mut Ui, model: &mut Model, seen: &Snapshot) {
    framed(ui, model, Text::DoSave, |ui, model| {
        let colours = model.preferences.theme.colours();
        quiet(ui, &colours, model.text(Text::SaveHelp));
        if name(ui, model, Text::Save) {
            let path = model.typed.path.trim().to_owned();
            let text = model.scenario.with_deeds(&seen.deeds).to_toml();
            model.ask(Job::Write(path.into(), text.into_bytes()));
            model.overlay = Overlay::None;
        }
    });
}

pub(super) fn record(ui: &mut Ui, model: &mut Model, seen: &Snapshot) {
    framed(ui, model, Text::DoRecord, |ui, model| {
        let colours = model.preferences.theme.colours();
        quiet(ui, &colours, model.text(Text::RecordHelp));
        let words = |text| model.preferences.language.text(text);
        let film = &mut model.typed.film;
        Grid::new("film").num_columns(2).spacing([14.0, 7.0]).show(ui, |ui| {
            let label = ui.label(words(Text::File));
            ui.add(TextEdit::singleline(&mut film.path).desired_width(240.0)).labelled_by(label.id);
            ui.end_row();
            let number = |ui: &mut Ui, text: Text, value: &mut f64, range: std::ops::RangeInclusive<f64>| {
                let label = ui.label(words(text));
                ui.add(DragValue::new(value).range(range).speed(0.1).max_decimals(4)).labelled_by(label.id);
                ui.end_row();
            };
            if film.is_picture() {
                number(ui, Text::At, &mut film.until, 0.0..=f64::MAX);
            } else {
                number(ui, Text::From, &mut film.from, 0.0..=f64::MAX);
                number(ui, Text::Until, &mut film.until, 0.0..=f64::MAX);
                number(ui, Text::Seconds, &mut film.seconds, 0.1..=600.0);
                number(ui, Text::Fps, &mut film.fps, 1.0..=120.0);
            }
            let label = ui.label(words(Text::Size));
            ui.horizontal(|ui| {
                ui.add(DragValue::new(&mut film.size[0]).range(64..=4096).speed(2.0)).labelled_by(label.id);
                ui.label("×");
                ui.add(DragValue::new(&mut film.size[1]).range(64..=4096).speed(2.0)).labelled_by(label.id);
            });
            ui.end_row();
            ui.label("");
            ui.checkbox(&mut film.panels, words(Text::WithPanels));
            ui.end_row();
        });
        film.light = model.preferences.theme != crate::theme::Theme::Dark;
        let possible = !film.path.trim().is_empty() && (film.is_picture() || film.until > film.from);
        if !possible {
            quiet(ui, &colours, &model.language().fill(Text::RecordNeeds, &[&crate::number::significant(seen.end, 4)]));
        }
        if ui.add_enabled(possible, egui::Button::new(model.text(Text::DoRecord))).clicked() {
            let mut film = model.typed.film.clone();
            // H.264 wants even sides.
            film.size = film.size.map(|side| side & !1);
            let scenario = model.scenario.with_deeds(&seen.deeds).to_toml();
            model.ask(Job::Film { film, scenario });
            model.overlay = Overlay::None;
        }
    });
}

fn framed(ui: &mut Ui, model: &mut Model, title: Text, contents: impl FnOnce(&mut Ui, &mut Model)) {
    let mut open = true;
    Window::new(model.text(title))
        .open(&mut open)
        .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
        .collapsible(false)
        .resizable(false)
        .show(ui.ctx(), |ui| {
            ui.set_width(360.0);
            contents(ui, model);
        });
    if !open {
        model.overlay = Overlay::None;
    }
}

/// A file's name and a button; whether it was meant.
fn name(ui: &mut Ui, model: &mut Model, verb: Text) -> bool {
    ui.horizontal(|ui| {
        let field = ui.add(TextEdit::singleline(&mut model.typed.path).desired_width(250.0));
        field.widget_info(|| egui::WidgetInfo::text_edit(true, "", &model.typed.path, model.text(Text::File)));
        if std::mem::take(&mut model.typed.fresh) {
            field.request_focus();
        }
        // Enter is for the name, unless a button has the keyboard; a quick hand presses it before the field has.
        let elsewhere = ui.ctx().memory(|memory| memory.focused().is_some_and(|id| id != field.id));
        let entered = !elsewhere && ui.input(|input| input.key_pressed(Key::Enter));
        let pressed = ui.add_enabled(!model.typed.path.trim().is_empty(), egui::Button::new(model.text(verb))).clicked();
        (entered || pressed) && !model.typed.path.trim().is_empty()
    })
    .inner
}
