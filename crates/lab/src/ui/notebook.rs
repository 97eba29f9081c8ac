//! The notebook in the window: a button for a row, a table, a line through two columns.

use corpuscle_io::csv;
use egui::{ComboBox, Grid, RichText, ScrollArea, Ui};

use super::hands::{all, described};
use super::icons::Icon;
use super::widgets::{quiet, section, sized_icon_button};
use crate::command::Command;
use crate::language::Text;
use crate::model::{Job, Model};
use crate::notebook::{Entry, Notebook, Quantity};
use crate::number::{significant, with_error};
use crate::runner::Snapshot;

pub(super) fn show(ui: &mut Ui, model: &mut Model, seen: &Snapshot) {
    let colours = model.preferences.theme.colours();
    ui.horizontal_wrapped(|ui| {
        if ui.button(model.text(Text::DoRecordRow)).on_hover_text(Command::RecordRow.key()).clicked() {
            model.obey(Command::RecordRow, seen);
        }
        columns(ui, model, seen);
        let has_rows = !model.notebook.rows().is_empty();
        if ui.add_enabled(has_rows, egui::Button::new(model.text(Text::SaveCsv))).clicked() {
            let table = csv::table(&model.notebook.table());
            model.ask(Job::Write(format!("{}-notebook.csv", model.scenario.name()).into(), table));
        }
        if ui.add_enabled(has_rows, egui::Button::new(model.text(Text::ClearRows))).clicked() {
            model.notebook.clear();
        }
    });
    ui.add_space(6.0);
    if model.notebook.rows().is_empty() {
        quiet(ui, &colours, model.text(Text::NotebookEmpty));
    } else {
        table(ui, model);
        fit(ui, model);
    }
    deeds(ui, model, seen);
}

/// What is done to the system in this run, and when: by the file, of which some may be ahead, and by hand.
fn deeds(ui: &mut Ui, model: &Model, seen: &Snapshot) {
    let colours = model.preferences.theme.colours();
    for (heading, help) in [(Text::DeedsOfFile, Text::DeedsOfFileHelp), (Text::Deeds, Text::DeedsHelp)] {
        let mut list = all(model, seen).filter(|&(.., by)| by == heading).peekable();
        if list.peek().is_none() {
            continue;
        }
        section(ui, &colours, model.text(heading));
        for (time, action, _) in list {
            let ink = if time > seen.time { colours.quiet } else { colours.ink };
            let words = format!("t = {}: {}", significant(time, 6), described(model.language(), action));
            ui.label(RichText::new(words).color(ink));
        }
        quiet(ui, &colours, model.text(help));
    }
}

/// Which quantities the columns hold.
fn columns(ui: &mut Ui, model: &mut Model, seen: &Snapshot) {
    ui.menu_button(model.text(Text::Columns), |ui| {
        ScrollArea::vertical().max_height(420.0).show(ui, |ui| {
            for quantity in Notebook::offered(&model.scenario, &seen.measured) {
                let mut chosen = model.notebook.columns().contains(&quantity);
                if ui.checkbox(&mut chosen, name(model, &quantity)).changed() {
                    model.notebook.toggle(&quantity);
                }
            }
        });
    });
}

fn name(model: &Model, quantity: &Quantity) -> String {
    let language = model.language();
    match quantity {
        Quantity::Time => language.text(Text::Time).into(),
        Quantity::Seed => language.text(Text::Seed).into(),
        Quantity::Parameter(key) => language.key(key),
        Quantity::Measured(name) => language.phrase(name).into_owned(),
    }
}

fn table(ui: &mut Ui, model: &mut Model) {
    let colours = model.preferences.theme.colours();
    let mut removed = None;
    ScrollArea::horizontal().id_salt("rows").show(ui, |ui| {
        Grid::new("rows").striped(true).spacing([14.0, 4.0]).show(ui, |ui| {
            ui.label("");
            for quantity in model.notebook.columns() {
                let name = name(model, quantity);
                let heading = egui::Label::new(RichText::new(&name).small().color(colours.quiet)).truncate();
                ui.scope(|ui| {
                    ui.set_max_width(150.0);
                    ui.add(heading).on_hover_text(name);
                });
            }
            ui.end_row();
            for (number, row) in model.notebook.rows().iter().enumerate() {
                let tip = model.language().fill(Text::RemoveRow, &[&(number + 1).to_string()]);
                if sized_icon_button(ui, Icon::Cross, &tip, "", false, egui::vec2(18.0, 18.0)).clicked() {
                    removed = Some(number);
                }
                for entry in row {
                    ui.label(shown(entry));
                }
                ui.end_row();
            }
        });
    });
    if let Some(row) = removed {
        model.notebook.remove(row);
    }
}

fn shown(entry: &Entry) -> String {
    match entry.error {
        _ if entry.value.is_nan() => "—".into(),
        Some(error) => with_error(entry.value, Some(error)),
        None => significant(entry.value, 6),
    }
}

fn fit(ui: &mut Ui, model: &mut Model) {
    let colours = model.preferences.theme.colours();
    section(ui, &colours, model.text(Text::Fit));
    let names: Vec<String> = model.notebook.columns().iter().map(|quantity| name(model, quantity)).collect();
    if names.len() < 2 {
        quiet(ui, &colours, model.text(Text::FitNeeds));
        return;
    }
    let (mut x, mut y) = model.notebook.axes.unwrap_or((0, 1));
    for (label, place) in [(Text::Abscissa, &mut x), (Text::Ordinate, &mut y)] {
        ui.horizontal(|ui| {
            let label = ui.label(model.text(label));
            let shown = names.get(*place).cloned().unwrap_or_default();
            let combo = ComboBox::from_id_salt(label.id).width(ui.available_width() - 12.0).truncate().selected_text(shown);
            combo.show_ui(ui, |ui| {
                for (index, name) in names.iter().enumerate() {
                    ui.selectable_value(place, index, name);
                }
            });
        });
    }
    model.notebook.axes = Some((x, y));
    let Some(fit) = model.notebook.fit() else {
        quiet(ui, &colours, model.text(Text::FitNeeds));
        return;
    };
    let (slope, intercept) = (fit.line.slope, fit.line.intercept);
    ui.label(format!("y = a + b x,  n = {}", fit.points));
    ui.label(format!("b = {}", with_error(slope.mean, Some(slope.standard_error))));
    ui.label(format!("a = {}", with_error(intercept.mean, Some(intercept.standard_error))));
    if fit.weighted {
        let (chi, nu) = (significant(fit.line.chi_squared, 3), significant(fit.line.degrees_of_freedom, 3));
        ui.label(format!("χ² = {chi}, ν = {nu}"));
        quiet(ui, &colours, model.text(Text::FitWeighted));
    } else {
        quiet(ui, &colours, model.text(Text::FitByScatter));
    }
}
