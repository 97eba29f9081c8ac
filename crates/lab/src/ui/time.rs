//! The bar below: time, its speed, and the line of remembered moments.

use corpuscle_experiments::Action;
use egui::{Align, Align2, DragValue, FontId, Layout, Rect, RichText, Sense, Slider, Stroke, Ui, pos2, vec2};

use super::hands;
use super::icons::Icon;
use super::toolbar::refused;
use super::widgets::{command_button, icon_button, sized_icon_button};
use crate::command::Command;
use crate::language::Text;
use crate::model::{Model, SPEEDS};
use crate::number::significant;
use crate::runner::{Fault, Order, Snapshot};
use crate::theme::bold;

/// A pace below this is said.
const SLOW: f64 = 0.93;

pub(super) fn show(ui: &mut Ui, model: &mut Model, seen: &Snapshot) {
    ui.horizontal(|ui| {
        for (icon, command, text) in
            [(Icon::Restart, Command::Restart, Text::DoRestart), (Icon::Reverse, Command::Reverse, Text::DoReverse)]
        {
            let needs = if command == Command::Reverse { seen.refusal(Action::Reverse) } else { None };
            if refusable(ui, model, icon, command, text, needs) {
                model.obey(command, seen);
            }
        }
        disturb(ui, model, seen);
        let (icon, text) = if seen.playing { (Icon::Pause, Text::Pause) } else { (Icon::Play, Text::Play) };
        if sized_icon_button(ui, icon, model.text(text), Command::TogglePlay.key(), true, vec2(52.0, 32.0)).clicked() {
            model.obey(Command::TogglePlay, seen);
        }
        for (icon, command, text) in [
            (Icon::Step, Command::Step, Text::DoStep),
            (Icon::Collision, Command::NextEvent, Text::DoNextEvent),
            (Icon::Mark, Command::Remember, Text::DoRemember),
        ] {
            if command_button(ui, model, icon, command, text) {
                model.obey(command, seen);
            }
        }
        ui.add_space(8.0);
        speed(ui, model, seen);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            seed(ui, model, seen);
            ui.add_space(6.0);
            said(ui, model, seen);
        });
    });
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        go_to(ui, model, seen);
        timeline(ui, model, seen);
    });
}

/// A button that is grey and says why where the experiment refuses what it does.
fn refusable(ui: &mut Ui, model: &Model, icon: Icon, command: Command, text: Text, needs: Option<&str>) -> bool {
    let words = needs.map(|needs| refused(model, model.text(text), needs));
    let button = ui.add_enabled_ui(words.is_none(), |ui| {
        let button = icon_button(ui, icon, model.text(text), command.key(), false);
        button.on_disabled_hover_text(words.as_deref().unwrap_or_default())
    });
    button.inner.clicked()
}

/// Loschmidt's question, and how strongly it is asked.
fn disturb(ui: &mut Ui, model: &mut Model, seen: &Snapshot) {
    let strength = model.tools.disturbance;
    let needs = seen.refusal(Action::Disturb { strength, seed: 0 });
    if refusable(ui, model, Icon::Fork, Command::Disturb, Text::DoDisturb, needs) {
        model.obey(Command::Disturb, seen);
    }
    let field = DragValue::new(&mut model.tools.disturbance)
        .range(1e-15..=1.0)
        .speed(0.02 * strength)
        .prefix("ε ")
        .custom_formatter(|value, _| significant(value, 2))
        .custom_parser(|text| text.trim_start_matches('ε').trim().parse().ok());
    let field = ui.add(field).on_hover_text(model.text(Text::DisturbanceHelp));
    field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::SpinButton, true, model.text(Text::Disturbance)));
}

fn speed(ui: &mut Ui, model: &mut Model, seen: &Snapshot) {
    let label = ui.label(model.text(Text::Speed));
    let mut factor = model.speed;
    ui.spacing_mut().slider_width = 96.0;
    let slider =
        ui.add(Slider::new(&mut factor, 1e-2..=1e2).logarithmic(true).show_value(false).clamping(egui::SliderClamping::Never));
    let slider = slider.labelled_by(label.id).on_hover_text(model.text(Text::SpeedHelp));
    if slider.changed() && factor != model.speed {
        model.set_speed(factor);
    }
    let usual = if model.speed > 0.0 { seen.speed / model.speed } else { 0.0 };
    let mut shown = seen.speed;
    let exact = DragValue::new(&mut shown)
        .speed(0.02 * seen.speed.abs().max(1e-9))
        .range(SPEEDS.start() * usual..=SPEEDS.end() * usual)
        .custom_formatter(|value, _| significant(value, 3))
        .custom_parser(|text| text.trim().parse().ok())
        .suffix(model.text(Text::EachSecond));
    if ui.add(exact).labelled_by(label.id).changed() && usual > 0.0 {
        model.set_speed(shown / usual);
    }
}

/// What there is to say: a fault, a notice, or that the engine cannot keep up.
fn said(ui: &mut Ui, model: &Model, seen: &Snapshot) {
    let colours = model.preferences.theme.colours();
    let language = model.language();
    let (words, colour) = if let Some(fault) = &seen.fault {
        let words = match fault {
            Fault::Refused { key, expected } => language.fill(Text::Refused, &[&language.key(key), expected]),
            Fault::Failed(words) => language.fill(Text::Failed, &[words]),
            Fault::NoCollisions => language.text(Text::NoCollisions).to_owned(),
            Fault::Unable(expected) => language.fill(Text::Unable, &[&language.phrase(expected)]),
        };
        (words, colours.bad)
    } else if let Some(notice) = &model.notice {
        (notice.words.clone(), if notice.fault { colours.bad } else { colours.good })
    } else if let Some((from, goal)) = seen.travel {
        let part = if goal > from { (seen.time - from) / (goal - from) } else { 1.0 };
        (language.fill(Text::Travelling, &[&significant(goal, 4), &format!("{:.0}", 100.0 * part)]), colours.quiet)
    } else if seen.playing && seen.pace < SLOW {
        let percent = format!("{:.0}", (100.0 * seen.pace).max(1.0));
        (language.fill(Text::TooSlow, &[&percent]), colours.bad)
    } else {
        return;
    };
    ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
        ui.add_space(10.0);
        ui.add(egui::Label::new(RichText::new(&words).color(colour)).truncate()).on_hover_text(words);
    });
}

fn seed(ui: &mut Ui, model: &mut Model, seen: &Snapshot) {
    if icon_button(ui, Icon::Die, model.text(Text::DoNewSeed), Command::NewSeed.key(), false).clicked() {
        model.obey(Command::NewSeed, seen);
    }
    let mut seed = model.scenario.settings.seed;
    let name = model.text(Text::Seed);
    let field = ui.add(DragValue::new(&mut seed).speed(0.1).update_while_editing(false));
    let field = field.on_hover_text(model.text(Text::SeedHelp));
    ui.label(name).labelled_by(field.id);
    if seed != model.scenario.settings.seed {
        model.set_seed(seed);
    }
}

/// The time, which can be typed.
fn go_to(ui: &mut Ui, model: &mut Model, seen: &Snapshot) {
    ui.label(RichText::new("t").font(FontId::new(14.0, bold())));
    let mut time = seen.time;
    let width = ui.spacing().interact_size.x;
    ui.spacing_mut().interact_size.x = 74.0;
    let field = DragValue::new(&mut time)
        .speed(0.0)
        .range(seen.start..=f64::MAX)
        .update_while_editing(false)
        .custom_formatter(|value, _| significant(value, 5))
        .custom_parser(|text| text.trim().parse().ok());
    let field = ui.add(field).on_hover_text(model.text(Text::GoToHelp));
    field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::SpinButton, true, model.text(Text::GoTo)));
    ui.spacing_mut().interact_size.x = width;
    if field.changed() && time != seen.time {
        model.order(Order::GoTo(time));
    }
}

/// The whole run as a line, with the moments on it; a click goes to a time, near a moment to exactly that.
fn timeline(ui: &mut Ui, model: &mut Model, seen: &Snapshot) {
    let colours = model.preferences.theme.colours();
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 26.0), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::slider(true, seen.time, model.text(Text::Timeline)));
    let painter = ui.painter();
    let end = seen.end.max(seen.time);
    let length = (end - seen.start).max(f64::MIN_POSITIVE);
    let line = Rect::from_min_max(pos2(rect.left() + 7.0, rect.center().y - 2.0), pos2(rect.right() - 62.0, rect.center().y + 2.0));
    let x_of = |time: f64| line.left() + line.width() * ((time - seen.start) / length).clamp(0.0, 1.0) as f32;
    painter.rect_filled(line, 2.0, colours.hovered);
    painter.rect_filled(Rect::from_min_max(line.min, pos2(x_of(seen.time), line.max.y)), 2.0, colours.accent);
    for &moment in &model.moments {
        let x = x_of(moment);
        painter.line_segment([pos2(x, line.top() - 7.0), pos2(x, line.bottom() + 7.0)], Stroke::new(2.0, colours.ink));
    }
    let deed = hands::marks(ui, model, seen, line, x_of);
    let handle = pos2(x_of(seen.time), line.center().y);
    painter.circle(handle, 6.0, colours.accent, Stroke::new(2.0, colours.panel));
    let text = significant(end, 4);
    painter.text(pos2(rect.right(), rect.center().y), Align2::RIGHT_CENTER, text, FontId::proportional(12.5), colours.quiet);
    if let (true, Some(at)) = (response.clicked() || response.drag_stopped(), response.interact_pointer_pos()) {
        let near = model.moments.iter().copied().find(|&moment| (x_of(moment) - at.x).abs() < 5.0);
        let part = f64::from(((at.x - line.left()) / line.width()).clamp(0.0, 1.0));
        model.order(Order::GoTo(near.unwrap_or(seen.start + part * length)));
    }
    response.on_hover_text(deed.as_deref().unwrap_or(model.text(Text::TimelineHelp)));
}
