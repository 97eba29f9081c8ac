//! The experiment's own parameters, from their one declaration. A changed value starts the run again.

use corpuscle_experiments::{Kind, Parameter, Value};
use corpuscle_io::scenario::Subject;
use egui::{Align, ComboBox, DragValue, Layout, RichText, ScrollArea, Slider, SliderClamping, TextEdit, Ui, vec2};

use super::icons::Icon;
use super::widgets::{quiet, section, sized_icon_button};
use crate::language::{Language, Text};
use crate::model::Model;
use crate::number::significant;
use crate::presets;
use crate::rivals;
use crate::runner::{Fault, Snapshot};

/// Parameters that choose a whole situation.
const PRESETS: [&str; 4] = ["preset", "process", "law", "start"];
/// Parameters of the measurement rather than of the system.
const NUMERICS: [&str; 10] =
    ["integrator", "time_step", "duration", "replicas", "points", "cells", "span", "dense_packings", "softening", "reverse_at"];

pub(super) fn show(ui: &mut Ui, model: &mut Model, seen: &Snapshot) {
    let Subject::Experiment(experiment) = model.scenario.subject else {
        free(ui, model, seen);
        return;
    };
    let colours = model.preferences.theme.colours();
    let group = |parameter: &Parameter| match parameter.name {
        name if PRESETS.contains(&name) => 0,
        name if NUMERICS.contains(&name) => 2,
        _ => 1,
    };
    ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        ui.set_max_width(ui.available_width() - 6.0);
        ui.spacing_mut().item_spacing.y = 2.0;
        ui.spacing_mut().interact_size.y = 22.0;
        ui.spacing_mut().button_padding.y = 2.0;
        presets(ui, model, experiment.name);
        beside(ui, model);
        for (index, heading) in [Text::GroupPreset, Text::GroupSystem, Text::GroupMeasurement].into_iter().enumerate() {
            let mut of_group = experiment.parameters.iter().filter(|parameter| group(parameter) == index).peekable();
            if of_group.peek().is_some() {
                section(ui, &colours, model.text(heading));
            }
            for parameter in of_group {
                one(ui, model, seen, parameter);
            }
        }
        ui.add_space(8.0);
        quiet(ui, &colours, model.text(Text::RestartNote));
    });
}

/// Ready-made situations by name, beside those that an experiment declares as a parameter.
fn presets(ui: &mut Ui, model: &mut Model, experiment: &str) {
    let list = presets::of(experiment);
    if list.is_empty() {
        return;
    }
    let language = model.language();
    let current = list.iter().find(|preset| preset.is_set(&model.scenario));
    let shown = current.map_or(model.text(Text::PresetNone).into(), |preset| language.phrase(preset.name));
    let mut chosen = None;
    ui.horizontal(|ui| {
        let label = ui.label(model.text(Text::Preset));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let combo = ComboBox::from_id_salt("presets").width(150.0).selected_text(shown.as_ref()).truncate();
            let response = combo.show_ui(ui, |ui| {
                for preset in list {
                    let here = current.is_some_and(|current| current.name == preset.name);
                    if ui.selectable_label(here, language.phrase(preset.name)).clicked() {
                        chosen = Some(preset);
                    }
                }
            });
            response.response.labelled_by(label.id);
        });
    });
    if let Some(preset) = chosen {
        match preset.scenario(&model.scenario) {
            Ok(scenario) => model.run(scenario),
            Err(refusal) => model.complain(refusal.to_string()),
        }
    }
    ui.add_space(2.0);
}

/// What is to compute the same beside it, where there is another way.
fn beside(ui: &mut Ui, model: &mut Model) {
    let rivals = rivals::of(&model.scenario);
    if rivals.is_empty() {
        return;
    }
    let language = model.language();
    let none = model.text(Text::Alone);
    let mut chosen = model.beside.clone();
    ui.horizontal(|ui| {
        let label = ui.label(model.text(Text::BesideIt)).on_hover_text(model.text(Text::BesideHelp));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let shown = chosen.as_ref().map_or(none.to_owned(), |name| language.choice(name));
            let combo = ComboBox::from_id_salt("beside").width(150.0).selected_text(shown).truncate();
            let response = combo.show_ui(ui, |ui| {
                ui.selectable_value(&mut chosen, None, none);
                for rival in &rivals {
                    ui.selectable_value(&mut chosen, Some(rival.name.clone()), language.choice(&rival.name));
                }
            });
            response.response.labelled_by(label.id).on_hover_text(model.text(Text::BesideHelp));
        });
    });
    if chosen != model.beside {
        model.set_beside(chosen.as_deref());
    }
    ui.add_space(2.0);
}

/// A system of a file's own has no declared parameters: the file is shown.
fn free(ui: &mut Ui, model: &mut Model, seen: &Snapshot) {
    let colours = model.preferences.theme.colours();
    section(ui, &colours, model.text(Text::OwnSystem));
    beside(ui, model);
    quiet(ui, &colours, model.text(Text::OwnSystemNote));
    ui.add_space(6.0);
    ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        ui.set_max_width(ui.available_width() - 8.0);
        ui.add(egui::Label::new(RichText::new(model.scenario.with_deeds(&seen.deeds).to_toml()).monospace().small()).wrap());
    });
}

fn one(ui: &mut Ui, model: &mut Model, seen: &Snapshot, parameter: &'static Parameter) {
    let Some((value, given)) = model
        .scenario
        .parameters()
        .find(|(known, ..)| known.name == parameter.name)
        .map(|(_, value, given)| (value.clone(), given))
    else {
        return;
    };
    let language = model.language();
    let colours = model.preferences.theme.colours();
    let name = language.parameter(model.scenario.name(), parameter.name);
    let refused = match &seen.fault {
        Some(Fault::Refused { key, expected }) if key == parameter.name => Some(expected.clone()),
        _ => None,
    };
    let help = format!("{}\n{}", language.phrase(parameter.help), range(model, parameter));
    let idle = model.scenario.settings.idle_under(parameter.name).map(|by| idle(model, by));
    let mut chosen = None;
    let top = ui.cursor().min;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let ink = match (&refused, &idle) {
            (Some(_), _) => colours.bad,
            (None, Some(_)) => colours.quiet,
            (None, None) => colours.ink,
        };
        let label = ui.label(RichText::new(&name).color(ink)).on_hover_text(&help);
        if !parameter.unit.is_empty() {
            ui.label(RichText::new(language.phrase(parameter.unit)).color(colours.quiet).small());
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            // The place is kept, so that nothing moves when a value is no longer the default.
            ui.scope(|ui| {
                if !given {
                    ui.set_invisible();
                }
                let fallback = model.scenario.settings.fallback(parameter.name).unwrap_or_else(|_| parameter.default());
                let tip = language.fill(Text::ResetTo, &[&shown(language, &fallback)]);
                if sized_icon_button(ui, Icon::Undo, &tip, "", false, vec2(20.0, 20.0)).clicked() {
                    chosen = Some(None);
                }
            });
            ui.scope(|ui| {
                if idle.is_some() {
                    ui.disable();
                }
                if let Some(value) = field(ui, model, parameter, &value, label.id, &help) {
                    chosen = Some(Some(value));
                }
            });
        });
    });
    ui.scope(|ui| {
        if idle.is_some() {
            ui.disable();
        }
        if let Some(value) = slider(ui, model, parameter, &value, &name) {
            chosen = Some(Some(value));
        }
    });
    if let Some(words) = idle {
        let rect = egui::Rect::from_min_max(top, egui::pos2(ui.max_rect().right(), ui.cursor().top()));
        let whole = ui.interact(rect, ui.scope_id().with(("idle", parameter.name)), egui::Sense::hover());
        whole.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, false, format!("{name}: {words}")));
        whole.on_hover_text(format!("{words}\n{help}"));
    }
    if let Some(expected) = refused {
        ui.add(egui::Label::new(RichText::new(language.fill(Text::Expected, &[&expected])).color(colours.bad).small()).wrap());
    }
    ui.add_space(5.0);
    if let Some(value) = chosen {
        model.set_parameter(parameter, value);
    }
}

/// Why a parameter is not used, in words.
fn idle(model: &Model, by: &Parameter) -> String {
    let language = model.language();
    let name = language.parameter(model.scenario.name(), by.name);
    language.fill(Text::NotUsed, &[&name, &language.choice(model.scenario.settings.word(by.name))])
}

/// What is accepted, in words.
fn range(model: &Model, parameter: &Parameter) -> String {
    let language = model.language();
    match parameter.kind {
        Kind::Real { least, most, .. } => language.fill(Text::Range, &[&significant(least, 4), &significant(most, 4)]),
        Kind::Whole { least, most, .. } => language.fill(Text::Range, &[&least.to_string(), &most.to_string()]),
        Kind::Choice { .. } | Kind::Situation { .. } => {
            parameter.words().iter().map(|word| language.choice(word)).collect::<Vec<_>>().join(" · ")
        }
        Kind::Flag { .. } => String::new(),
        Kind::List { least, most, longest, .. } => {
            language.fill(Text::ListRange, &[&longest.to_string(), &significant(least, 4), &significant(most, 4)])
        }
    }
}

fn shown(language: Language, value: &Value) -> String {
    match value {
        Value::Word(word) => language.choice(word),
        Value::Real(x) => significant(*x, 6),
        Value::List(list) if list.is_empty() => "[ ]".into(),
        value => value.to_string(),
    }
}

/// The exact value: a field to type in or to drag, a choice, a tick.
fn field(ui: &mut Ui, model: &mut Model, parameter: &Parameter, value: &Value, label: egui::Id, help: &str) -> Option<Value> {
    let language = model.language();
    match (parameter.kind, value) {
        (Kind::Real { least, most, .. }, &Value::Real(x)) => {
            let x = pending(model, parameter, x);
            let mut changed = x;
            let field = DragValue::new(&mut changed)
                .range(least..=most)
                .speed(0.005 * x.abs().max(1e-3 * most.min(1.0)))
                .update_while_editing(false)
                .custom_formatter(|value, _| significant(value, 6))
                .custom_parser(|text| text.trim().replace('−', "-").parse().ok());
            let response = ui.add(field).labelled_by(label).on_hover_text(help);
            settled(model, &response, parameter, changed, changed != x).map(Value::Real)
        }
        (Kind::Whole { least, most, .. }, &Value::Whole(n)) => {
            let n = pending(model, parameter, n as f64) as u64;
            let mut changed = n;
            let field =
                DragValue::new(&mut changed).range(least..=most).speed(0.01 * (n as f64).max(5.0)).update_while_editing(false);
            let response = ui.add(field).labelled_by(label).on_hover_text(help);
            settled(model, &response, parameter, changed as f64, changed != n).map(|n| Value::Whole(n as u64))
        }
        (Kind::Choice { .. } | Kind::Situation { .. }, Value::Word(word)) => {
            let mut changed = word.clone();
            let combo = ComboBox::from_id_salt(parameter.name).width(118.0).selected_text(language.choice(word));
            let response = combo.show_ui(ui, |ui| {
                for option in parameter.words() {
                    ui.selectable_value(&mut changed, option.to_owned(), language.choice(option));
                }
            });
            response.response.labelled_by(label).on_hover_text(help);
            (changed != *word).then_some(Value::Word(changed))
        }
        (Kind::Flag { .. }, &Value::Flag(on)) => {
            let mut changed = on;
            ui.checkbox(&mut changed, "").labelled_by(label).on_hover_text(help);
            (changed != on).then_some(Value::Flag(changed))
        }
        (Kind::List { .. }, Value::List(list)) => typed_list(ui, model, parameter, list, label, help),
        _ => None,
    }
}

/// Without a row of zeros before a tiny number.
fn in_a_list(x: f64) -> String {
    if x != 0.0 && x.abs() < 1e-4 { format!("{x:e}") } else { x.to_string() }
}

/// A list is typed, and taken when the field is left.
fn typed_list(ui: &mut Ui, model: &mut Model, parameter: &Parameter, list: &[f64], label: egui::Id, help: &str) -> Option<Value> {
    let kept = || list.iter().copied().map(in_a_list).collect::<Vec<_>>().join(", ");
    let mut text = match &model.typed.list {
        Some((key, text)) if key == parameter.name => text.clone(),
        _ => kept(),
    };
    let edit = TextEdit::singleline(&mut text).desired_width(110.0).hint_text(model.text(Text::Automatic));
    let response = ui.add(edit).labelled_by(label).on_hover_text(help);
    if response.changed() {
        model.typed.list = Some((parameter.name.to_owned(), text.clone()));
    }
    if !response.lost_focus() || model.typed.list.take().is_none() {
        return None;
    }
    match parameter.parse(&text) {
        Ok(value) => (value != Value::List(list.to_vec())).then_some(value),
        Err(invalid) => {
            model.complain(model.language().fill(Text::Refused, &[&model.language().key(parameter.name), &invalid.expected]));
            None
        }
    }
}

/// The whole range to slide along, in ratios where it spans several powers of ten.
fn slider(ui: &mut Ui, model: &mut Model, parameter: &Parameter, value: &Value, name: &str) -> Option<Value> {
    let (least, most, now, whole) = match (parameter.kind, value) {
        (Kind::Real { least, most, .. }, &Value::Real(x)) => (least, most, x, false),
        (Kind::Whole { least, most, .. }, &Value::Whole(n)) => (least as f64, most as f64, n as f64, true),
        _ => return None,
    };
    let now = pending(model, parameter, now);
    let mut changed = now;
    let slider = Slider::new(&mut changed, least..=most).show_value(false).clamping(SliderClamping::Always);
    let slider = slider.logarithmic(most > 500.0 * least.max(f64::from(u8::from(whole))));
    let response = ui
        .scope(|ui| {
            ui.spacing_mut().slider_width = ui.available_width() - 4.0;
            ui.spacing_mut().interact_size.y = 14.0;
            ui.style_mut().text_styles.insert(egui::TextStyle::Body, egui::FontId::proportional(10.0));
            ui.add(slider)
        })
        .inner;
    response.widget_info(|| egui::WidgetInfo::slider(true, now, name));
    // Three digits are what a hand can aim at.
    let aimed = if changed == least || changed == most { changed } else { three_digits(changed) };
    let aimed = if whole { aimed.round() } else { aimed }.clamp(least, most);
    let settled = settled(model, &response, parameter, aimed, changed != now && aimed != now)?;
    Some(if whole { Value::Whole(settled as u64) } else { Value::Real(settled) })
}

fn three_digits(x: f64) -> f64 {
    format!("{x:.2e}").parse().unwrap_or(x)
}

/// The value under a hand that has not let go, or else the one that runs.
fn pending(model: &Model, parameter: &Parameter, value: f64) -> f64 {
    model.typed.dragged.filter(|(key, _)| *key == parameter.name).map_or(value, |(_, pending)| pending)
}

/// The value to start the run again with: none while a hand is on it.
fn settled(model: &mut Model, response: &egui::Response, parameter: &Parameter, value: f64, changed: bool) -> Option<f64> {
    if response.dragged() {
        if changed {
            model.typed.dragged = Some((parameter.name, value));
        }
        return None;
    }
    let dragged = if response.drag_stopped() { model.typed.dragged.take().map(|(_, value)| value) } else { None };
    if changed { Some(value) } else { dragged }
}
