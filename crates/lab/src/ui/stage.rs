//! The stage: the picture, and the pointer on it.

use corpuscle_render::{Projection, Rectangle, View, navigate};
use corpuscle_scene::Camera;
use egui::{
    Align2, Color32, FontId, Painter, PointerButton, Pos2, Rect, Response, Sense, Stroke, StrokeKind, Ui, Vec2, pos2, vec2,
};

use super::{Canvas, Easel, hands, hints, legend, toolbar};
use crate::command::Command;
use crate::language::Text;
use crate::model::Model;
use crate::number::{significant, with_error};
use crate::runner::Snapshot;
use crate::tools::{Tool, pick, probe, state_of};

/// Height of the strip above the stage, in points.
const STRIP: f32 = 40.0;
/// A pointer that misses a body by so many points still means it.
pub(super) const REACH: f64 = 4.0;

pub(super) fn show(ui: &mut Ui, model: &mut Model, seen: &Snapshot, easel: &mut dyn Easel) {
    let whole = ui.available_rect_before_wrap();
    let (strip, whole) = whole.split_top_bottom_at_y(whole.top() + STRIP);
    let (middle, band) = whole.split_top_bottom_at_y(whole.bottom() - legend::HEIGHT);
    let (column, stage) = toolbar::beside(middle);
    let (stage, other) = if seen.beside.is_some() { halves(stage) } else { (stage, Rect::NOTHING) };
    let response = ui.allocate_rect(stage, Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, model.text(Text::Stage)));

    let camera = model.camera_now(seen);
    let view = view_of(stage, camera, model, ui.ctx().pixels_per_point());
    if let Some(texture) = easel.paint(Canvas::Stage, seen.look, &seen.scene, &view) {
        // OpenGL's pictures stand on their heads.
        let upright = Rect::from_min_max(pos2(0.0, 1.0), pos2(1.0, 0.0));
        ui.painter().image(texture, stage, upright, Color32::WHITE);
        if let Some(side) = &seen.beside
            && let Some(texture) =
                easel.paint(Canvas::Beside, seen.look, &side.scene, &view_of(other, camera, model, ui.ctx().pixels_per_point()))
        {
            ui.painter().image(texture, other, upright, Color32::WHITE);
        }
    }
    // The same projection in points, for the pointer and what is drawn over the picture.
    let projection = projection_of(stage, camera);
    pointer(ui, model, seen, &response, &projection, camera);
    let painter = ui.painter().with_clip_rect(stage);
    hands::preview(&painter, model, seen, &projection, &response);
    followed(&painter, model, seen, &projection, stage);
    ruler(&painter, model, &projection, stage);
    probe_reading(&painter, model, seen, &projection, stage);
    if !response.dragged() {
        hovered(ui, model, seen, &response, &projection, stage);
    }
    caption(ui, model, seen, strip);
    compared(ui, model, seen, stage, other);
    legend::show(ui, model, seen, band, &projection);
    toolbar::show(ui, model, seen, column);
    toolbar::settings(ui, model, seen, stage);
    stopwatch(&painter, model, seen, stage);
    hints::show(ui, model, stage);
}

/// The two halves of a stage on which two ways of computing the same are shown, with a line between.
fn halves(stage: Rect) -> (Rect, Rect) {
    let (left, right) = stage.split_left_right_at_x(stage.center().x);
    (left.with_max_x(left.right() - 1.0), right.with_min_x(right.left() + 1.0))
}

/// What computes either half, and how long they agree.
fn compared(ui: &Ui, model: &Model, seen: &Snapshot, stage: Rect, other: Rect) {
    let Some(side) = &seen.beside else { return };
    let (language, colours) = (model.language(), model.preferences.theme.colours());
    let painter = ui.painter();
    painter.vline(stage.right() + 1.0, stage.y_range(), Stroke::new(2.0, colours.line));
    let engine = &seen.measured.honesty.engine;
    let own = engine.rsplit(", ").next().map_or_else(|| engine.clone(), |name| language.choice(name));
    for (half, name) in [(stage, own), (other, language.choice(&side.name))] {
        card(&painter.with_clip_rect(half), model, half.center_top() + vec2(0.0, 10.0), Align2::CENTER_TOP, &name);
    }
    let verdict = match (&side.fault, side.parted) {
        (Some(fault), _) => fault.clone(),
        (None, Some(time)) => language.fill(Text::AgreeUntil, &[&significant(time, 4)]),
        (None, None) => language.fill(Text::AgreeYet, &[&significant(side.apart, 2)]),
    };
    let both = stage.union(other);
    card(&painter.with_clip_rect(both), model, both.center_bottom() - vec2(0.0, 12.0), Align2::CENTER_BOTTOM, &verdict);
}

fn view_of(stage: Rect, camera: Camera, model: &Model, pixels: f32) -> View {
    let size = (stage.size() * pixels).round();
    let mut view = View::new((size.x as u32).max(1), (size.y as u32).max(1)).palette(model.preferences.theme.palette());
    (view.scale, view.camera, view.overlay) = (pixels, Some(camera), false);
    view
}

fn projection_of(stage: Rect, camera: Camera) -> Projection {
    let size = [f64::from(stage.width()), f64::from(stage.height())];
    Projection::new(camera, size, Rectangle { left: 0.0, top: 0.0, width: size[0], height: size[1] })
}

/// A point of the window in the projection's own coordinates.
pub(super) fn inside(stage: Rect, at: Pos2) -> [f64; 2] {
    let at = at - stage.min;
    [f64::from(at.x), f64::from(at.y)]
}

pub(super) fn outside(stage: Rect, at: [f64; 2]) -> Pos2 {
    stage.min + vec2(at[0] as f32, at[1] as f32)
}

/// What wheel, drag and click do.
fn pointer(ui: &Ui, model: &mut Model, seen: &Snapshot, response: &Response, projection: &Projection, camera: Camera) {
    let stage = response.rect;
    if let Some(at) = response.hover_pos() {
        let (wheel, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
        let factor = f64::from(pinch) * (0.004 * f64::from(wheel)).exp();
        if factor != 1.0 {
            model.camera = Some(navigate::zoomed(camera, projection, inside(stage, at), factor));
        }
    }
    if model.tool.touches() {
        hands::pointer(ui, model, seen, response, projection);
    }
    let way = response.drag_delta();
    let moves =
        model.tool == Tool::Hand || response.dragged_by(PointerButton::Secondary) || response.dragged_by(PointerButton::Middle);
    if response.dragged() && moves && way != Vec2::ZERO {
        model.followed = if projection.is_spatial() { model.followed } else { None };
        model.camera = Some(navigate::dragged(camera, projection, [f64::from(way.x), f64::from(way.y)]));
    }
    let Some(at) = response.interact_pointer_pos() else { return };
    let place = projection.place(inside(stage, at));
    let press = ui.input(|input| input.pointer.press_origin()).unwrap_or(at);
    if response.dragged_by(PointerButton::Primary) {
        let from = projection.place(inside(stage, press));
        match model.tool {
            Tool::Ruler => model.ruler = Some([from, place]),
            Tool::Probe if !projection.is_spatial() => {
                model.set_probe(Some([[from[0], from[1]], [place[0], place[1]]]));
            }
            _ => {}
        }
    }
    if response.double_clicked() && !model.tool.touches() {
        model.obey(Command::Fit, seen);
    } else if response.clicked() {
        match model.tool {
            Tool::Hand => model.followed = pick(&seen.scene, projection, inside(stage, at), REACH),
            Tool::Ruler => model.ruler = None,
            Tool::Probe => model.set_probe(None),
            _ => {}
        }
    }
}

/// A ring around the body that is followed, and its values in the corner.
fn followed(painter: &Painter, model: &Model, seen: &Snapshot, projection: &Projection, stage: Rect) {
    let Some(index) = model.followed else { return };
    let Some(body) = seen.scene.bodies.get(index) else { return };
    let (place, _) = state_of(body, &seen.scene);
    let Some(pixel) = projection.pixel(place) else { return };
    let colours = model.preferences.theme.colours();
    let radius = (body.radius * projection.scale) as f32;
    painter.circle_stroke(outside(stage, pixel), radius.max(seen.scene.least_radius) + 4.0, Stroke::new(1.5, colours.accent));
    let words = format!("{} {index}\n{}", model.text(Text::Following), values(model, seen, index));
    card(painter, model, stage.left_bottom() + vec2(14.0, -14.0), Align2::LEFT_BOTTOM, &words);
}

/// The values of a body, line by line.
fn values(model: &Model, seen: &Snapshot, index: usize) -> String {
    let Some(body) = seen.scene.bodies.get(index) else { return String::new() };
    let (x, v) = state_of(body, &seen.scene);
    let flat = matches!(seen.scene.camera, Camera::Plane { .. });
    let list = |values: [f64; 3]| {
        let shown: Vec<String> = values[..if flat { 2 } else { 3 }].iter().map(|&x| significant(x, 4)).collect();
        shown.join(", ")
    };
    let speed = v.iter().map(|c| c * c).sum::<f64>().sqrt();
    let words = [
        format!("r = ({})", list(x)),
        format!("v = ({})", list(v)),
        format!("|v| = {}", significant(speed, 4)),
        format!("{} = {}", model.text(Text::Radius), significant(body.radius, 4)),
    ];
    words.join("\n")
}

fn hovered(ui: &Ui, model: &Model, seen: &Snapshot, response: &Response, projection: &Projection, stage: Rect) {
    let Some(at) = response.hover_pos() else { return };
    if matches!(model.tool, Tool::Ruler | Tool::Probe | Tool::Partition | Tool::Heat | Tool::Piston) {
        ui.ctx().set_cursor_icon(egui::CursorIcon::Crosshair);
        return;
    }
    if let Some(index) = pick(&seen.scene, projection, inside(stage, at), REACH) {
        ui.ctx().set_cursor_icon(egui::CursorIcon::PointingHand);
        if model.followed != Some(index) {
            let words = format!("{} {index}\n{}", model.text(Text::Body), values(model, seen, index));
            response.clone().on_hover_text_at_pointer(words);
        }
    }
}

fn ruler(painter: &Painter, model: &Model, projection: &Projection, stage: Rect) {
    let Some([from, to]) = model.ruler else { return };
    let (Some(a), Some(b)) = (projection.pixel(from), projection.pixel(to)) else { return };
    let (a, b) = (outside(stage, a), outside(stage, b));
    let colour = model.preferences.theme.colours().accent;
    let stroke = Stroke::new(1.6, colour);
    let across = (b - a).normalized().rot90() * 6.0;
    painter.line_segment([a, b], stroke);
    for end in [a, b] {
        painter.line_segment([end - across, end + across], stroke);
    }
    let way: [f64; 3] = std::array::from_fn(|k| to[k] - from[k]);
    let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
    let angle = way[1].atan2(way[0]).to_degrees();
    let angle = if projection.is_spatial() { String::new() } else { format!("   {}°", significant(angle, 3)) };
    card(
        painter,
        model,
        a + 0.5 * (b - a) + vec2(0.0, -12.0),
        Align2::CENTER_BOTTOM,
        &format!("{}{angle}", significant(length, 4)),
    );
}

fn probe_reading(painter: &Painter, model: &Model, seen: &Snapshot, projection: &Projection, stage: Rect) {
    let Some(corners) = model.probe else { return };
    let [a, b] = corners.map(|[x, y]| projection.pixel([x, y, 0.0]).map(|pixel| outside(stage, pixel)));
    let (Some(a), Some(b)) = (a, b) else { return };
    let rect = Rect::from_two_pos(a, b);
    let colour = model.preferences.theme.colours().accent;
    painter.rect(rect, 0.0, colour.gamma_multiply(0.10), Stroke::new(1.4, colour), StrokeKind::Middle);
    if rect.area() < 16.0 {
        return;
    }
    let reading = probe(&seen.scene, corners);
    let mut lines =
        vec![format!("N = {}", reading.bodies), format!("{} n = {}", model.text(Text::Density), significant(reading.density, 4))];
    if let Some((mean, error)) = reading.temperature {
        lines.push(format!("k_B T/m = {}", with_error(mean, Some(error))));
        lines.extend(pressures(model, seen, reading.pressure));
        lines.push(format!(
            "{} = ({}, {})",
            model.text(Text::Flow),
            significant(reading.flow[0], 3),
            significant(reading.flow[1], 3)
        ));
    }
    let right = rect.right() + 220.0 < stage.right();
    let (at, align) = if right {
        (rect.right_top() + vec2(8.0, 0.0), Align2::LEFT_TOP)
    } else {
        (rect.left_top() - vec2(8.0, 0.0), Align2::RIGHT_TOP)
    };
    card(painter, model, at, align, &lines.join("\n"));
}

/// The parts of the pressure: those that contacts tell where they can be watched, or else that of particles without interaction.
fn pressures(model: &Model, seen: &Snapshot, kinetic: Option<(f64, f64)>) -> Vec<String> {
    let shown = |text: Text, (mean, error): (f64, f64)| format!("{} = {}", model.text(text), with_error(mean, Some(error)));
    let Some(probed) = seen.probed else { return kinetic.map(|part| shown(Text::KineticPressure, part)).into_iter().collect() };
    let parts = [(Text::KineticPressure, probed.kinetic), (Text::CollisionPressure, probed.collisional)];
    let mut lines: Vec<String> = parts.into_iter().filter_map(|(text, part)| Some(shown(text, part?))).collect();
    if let (Some((kinetic, error)), Some((collisional, other))) = (probed.kinetic, probed.collisional) {
        lines.push(shown(Text::WholePressure, (kinetic + collisional, error.hypot(other))));
        let counts = [probed.contacts.to_string(), significant(probed.time, 3)];
        lines.push(model.language().fill(Text::ProbedFor, &[&counts[0], &counts[1]]));
    }
    lines
}

/// Words on a ground of their own, so that they can be read over anything.
pub(super) fn card(painter: &Painter, model: &Model, at: Pos2, align: Align2, words: &str) {
    let colours = model.preferences.theme.colours();
    let text = painter.layout_no_wrap(words.to_owned(), FontId::proportional(12.5), colours.ink);
    let size = text.size() + vec2(16.0, 10.0);
    let bounds = painter.clip_rect().shrink(4.0);
    let mut rect = align.anchor_size(at, size);
    rect = rect.translate(vec2((bounds.left() - rect.left()).max(0.0) - (rect.right() - bounds.right()).max(0.0), 0.0));
    rect = rect.translate(vec2(0.0, (bounds.top() - rect.top()).max(0.0) - (rect.bottom() - bounds.bottom()).max(0.0)));
    painter.rect(rect, 5.0, colours.panel.gamma_multiply(0.94), Stroke::new(1.0, colours.line), StrokeKind::Inside);
    painter.galley(rect.min + vec2(8.0, 5.0), text, colours.ink);
}

/// What the experiment says of this moment, above the stage. Lines break between its parts, not within.
fn caption(ui: &Ui, model: &Model, seen: &Snapshot, strip: Rect) {
    let colours = model.preferences.theme.colours();
    let parts = seen.scene.caption.split("  ").map(|part| part.trim_matches([' ', '·'])).filter(|part| !part.is_empty());
    let parts = parts.map(|part| model.language().phrase(part).replace(' ', "\u{a0}"));
    let words = parts.collect::<Vec<_>>().join("  ·  ");
    let mut job = egui::text::LayoutJob::simple(words, FontId::proportional(12.5), colours.quiet, strip.width() - 28.0);
    job.wrap.max_rows = 2;
    let galley = ui.painter().layout_job(job);
    let at = pos2(strip.left() + 14.0, strip.center().y - 0.5 * galley.size().y);
    ui.painter().galley(at, galley, colours.quiet);
}

fn stopwatch(painter: &Painter, model: &Model, seen: &Snapshot, stage: Rect) {
    if let Some(reading) = model.stopwatch.reading(seen.time) {
        let words = format!("Δt = {}", significant(reading, 5));
        card(painter, model, stage.right_bottom() + vec2(-14.0, -14.0), Align2::RIGHT_BOTTOM, &words);
    }
}
