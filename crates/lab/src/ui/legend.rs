//! Below the stage: what the colours mean, how long things are, and how many there are.

use corpuscle_render::Projection;
use corpuscle_scene::{Colour, Colouring, Scene};
use egui::{Align2, Color32, ComboBox, FontId, Painter, Pos2, Rect, TextWrapMode, Ui, UiBuilder, pos2, vec2};

use crate::command::Command;
use crate::language::{Language, Text};
use crate::model::Model;
use crate::number::{one_two_five_below, significant};
use crate::runner::{Paint, Snapshot};
use crate::theme::Theme;

/// Height of the band, in points.
pub(super) const HEIGHT: f32 = 34.0;
const SIZE: f32 = 12.5;
/// The same in two rows.
const SMALL: f32 = 10.5;
/// Longest scale bar.
const BAR: f64 = 110.0;

/// The choice of colours, what they mean, and the scale bar; `projection` is in points.
pub(super) fn show(ui: &mut Ui, model: &mut Model, seen: &Snapshot, band: Rect, projection: &Projection) {
    let left = choice(ui, model, seen, band);
    let (theme, language) = (model.preferences.theme, model.language());
    let right = if projection.is_spatial() { band.right() - 14.0 } else { scale_bar(ui.painter(), band, projection, theme) };
    let room = Rect::from_min_max(pos2(left, band.top()), pos2(right - 10.0, band.bottom()));
    paint(&ui.painter().with_clip_rect(room), room, &seen.scene, theme, language);
}

/// What the colours are to tell; returns where there is room beside it.
fn choice(ui: &mut Ui, model: &mut Model, seen: &Snapshot, band: Rect) -> f32 {
    let rect = Rect::from_min_max(band.min + vec2(10.0, 4.0), pos2(band.left() + 200.0, band.bottom() - 4.0));
    let mut chosen = model.preferences.paint;
    let inner = ui.scope_builder(UiBuilder::new().max_rect(rect), |ui| {
        ui.spacing_mut().interact_size.y = 24.0;
        ui.spacing_mut().button_padding = vec2(7.0, 2.0);
        let combo =
            ComboBox::from_id_salt("paint").width(0.0).wrap_mode(TextWrapMode::Extend).selected_text(model.text(chosen.text()));
        let response = combo.show_ui(ui, |ui| {
            for paint in Paint::ALL {
                ui.selectable_value(&mut chosen, paint, model.text(paint.text()));
            }
        });
        let name = format!("{} {}", model.text(Text::Colouring), model.text(chosen.text()));
        response.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, &name));
        let known = chosen.is_known(&seen.scene);
        let tip = if known { model.text(Text::DoNextPaint) } else { model.text(Text::PaintUnknown) };
        response.response.on_hover_text(format!("{tip}  ({})", Command::NextPaint.key())).rect
    });
    if chosen != model.preferences.paint {
        model.set_paint(chosen);
    }
    inner.inner.right() + 12.0
}

/// What the colours mean.
fn paint(painter: &Painter, room: Rect, scene: &Scene, theme: Theme, language: Language) {
    let colours = theme.colours();
    let at = pos2(room.left(), room.center().y);
    let scale = |name: &str, unit: &str, ends: [f64; 2]| {
        scale(painter, at, &language.phrase(name), unit, ends, scene.colouring.map(), &colours);
    };
    match &scene.colouring {
        Colouring::Uniform(_) => {}
        Colouring::Species(names) => kinds(painter, room, names, theme, language),
        Colouring::Speed { most, unit } => scale("speed", unit, [0.0, *most]),
        Colouring::Energy { most } => scale("kinetic energy", "", [0.0, *most]),
        Colouring::Height { least, most, .. } => scale("height", "", [*least, *most]),
        Colouring::Value { name, unit, least, most } | Colouring::Angle { name, unit, least, most } => {
            scale(name, unit, [*least, *most]);
        }
    }
}

/// A dot and a name for each kind: in one row, or smaller in two where one is too short.
fn kinds(painter: &Painter, room: Rect, names: &[String], theme: Theme, language: Language) {
    let ink = theme.colours().ink;
    let laid_out = |size: f32| -> Vec<_> {
        let lay = |name: &String| painter.layout_no_wrap(language.phrase(name).into_owned(), FontId::proportional(size), ink);
        names.iter().map(lay).collect()
    };
    // The dot, the name, and what is between this and the next.
    let width = |name: &std::sync::Arc<egui::Galley>| 15.0 + name.size().x + 12.0;
    let one = laid_out(SIZE);
    let fits = one.iter().map(width).sum::<f32>() <= room.width() + 12.0;
    let (entries, rows) = if fits { (one, 1) } else { (laid_out(SMALL), 2) };
    let (mut row, mut left) = (0, room.left());
    for (index, name) in entries.into_iter().enumerate() {
        if row + 1 < rows && left > room.left() && left + width(&name) - 12.0 > room.right() {
            (row, left) = (row + 1, room.left());
        }
        let y = room.top() + room.height() * (row as f32 + 0.5) / rows as f32;
        painter.circle_filled(pos2(left + 5.0, y), if rows == 1 { 5.0 } else { 4.0 }, theme.role(Colour::Accent(index as u8)));
        let next = left + width(&name);
        painter.galley(pos2(left + 15.0, y - 0.5 * name.size().y), name, ink);
        left = next;
    }
}

/// A bar of colours with its ends written beside it.
fn scale(
    painter: &Painter,
    Pos2 { x: left, y }: Pos2,
    name: &str,
    unit: &str,
    ends: [f64; 2],
    map: fn(f64) -> [f64; 3],
    colours: &crate::theme::Colours,
) {
    let word = |left: f32, text: &str, colour| {
        painter.text(pos2(left, y), Align2::LEFT_CENTER, text, FontId::proportional(SIZE), colour).right()
    };
    let heading = if unit.is_empty() { name.to_owned() } else { format!("{name} / {unit}") };
    let left = word(left, &heading, colours.quiet) + 12.0;
    let left = word(left, &significant(ends[0], 3), colours.ink) + 7.0;
    let steps = 48;
    let width = 120.0 / steps as f32;
    for step in 0..steps {
        let [r, g, b] = map((f64::from(step) + 0.5) / f64::from(steps)).map(|c| (255.0 * c).round() as u8);
        let from = left + step as f32 * width;
        let rect = Rect::from_min_size(pos2(from, y - 5.0), vec2(width + 0.5, 10.0));
        painter.rect_filled(rect, 0.0, Color32::from_rgb(r, g, b));
    }
    word(left + 120.0 + 7.0, &significant(ends[1], 3), colours.ink);
}

/// A bar of a round length at the right end of the band; returns where it begins.
fn scale_bar(painter: &Painter, band: Rect, projection: &Projection, theme: Theme) -> f32 {
    let colours = theme.colours();
    let most = BAR / projection.scale;
    if !(most.is_finite() && most > 0.0) {
        return band.right();
    }
    let length = one_two_five_below(most);
    let width = (length * projection.scale) as f32;
    let (right, y) = (band.right() - 14.0, band.bottom() - 10.0);
    let points: Vec<Pos2> =
        [(right - width, y - 6.0), (right - width, y), (right, y), (right, y - 6.0)].map(|(x, y)| pos2(x, y)).to_vec();
    painter.add(egui::Shape::line(points, egui::Stroke::new(1.2, colours.quiet)));
    let middle = pos2(right - 0.5 * width, y - 3.0);
    painter.text(middle, Align2::CENTER_BOTTOM, significant(length, 3), FontId::proportional(SIZE), colours.ink);
    right - width
}
