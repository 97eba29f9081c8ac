//! A hand on the system: from a press on the stage to what it does there, and what is seen meanwhile.

use corpuscle_experiments::Action;
use corpuscle_render::Projection;
use egui::{Align2, Painter, Pos2, Rect, Response, Stroke, Ui, vec2};

use super::stage::{REACH, card, inside, outside};
use crate::language::{Language, Text};
use crate::model::Model;
use crate::number::significant;
use crate::runner::{Order, Snapshot};
use crate::tools::{Tool, Touch, deed, nearest_face, pick, place_beside, plate, state_of};

/// Follows the pointer of a tool that touches the system. Time stands still from the press to the release.
pub(super) fn pointer(ui: &Ui, model: &mut Model, seen: &Snapshot, response: &Response, projection: &Projection) {
    let stage = response.rect;
    let Some(at) = response.interact_pointer_pos() else { return };
    let press = ui.input(|input| input.pointer.press_origin()).unwrap_or(at);
    let began = response.drag_started_by(egui::PointerButton::Primary) || response.clicked();
    if began && model.touch.is_none() {
        model.touch = Some(begin(model.tool, seen, projection, inside(stage, press)));
        if seen.playing {
            model.order(Order::Play(false));
        }
    }
    let Some(mut touch) = model.touch else { return };
    let beside = touch.body.and_then(|body| seen.scene.bodies.get(body)).map(|body| state_of(body, &seen.scene).0);
    touch.to = place_beside(projection, inside(stage, at), beside.unwrap_or(projection.centre));
    model.touch = Some(touch);
    if response.clicked() || response.drag_stopped() {
        model.touch = None;
        if response.clicked() {
            touch.to = touch.from;
        }
        // A click carries nothing anywhere, and stops nothing.
        let still = response.clicked() && matches!(model.tool, Tool::Carry | Tool::Throw | Tool::Piston);
        if let Some(action) = deed(model.tool, &touch, model.tools, &seen.scene, seen.speed).filter(|_| !still) {
            model.act(action);
        }
        if touch.played {
            model.order(Order::Play(true));
        }
    }
}

fn begin(tool: Tool, seen: &Snapshot, projection: &Projection, pixel: [f64; 2]) -> Touch {
    let body = if tool == Tool::Add { None } else { pick(&seen.scene, projection, pixel, REACH) };
    let place = body.and_then(|index| seen.scene.bodies.get(index)).map(|body| state_of(body, &seen.scene).0);
    let from = match (tool, place) {
        // A velocity starts at the body's centre, wherever it was caught.
        (Tool::Throw, Some(place)) => place,
        (_, place) => place_beside(projection, pixel, place.unwrap_or(projection.centre)),
    };
    Touch { body, from, to: from, played: seen.playing }
}

/// What a touch is going to do.
pub(super) fn preview(painter: &Painter, model: &Model, seen: &Snapshot, projection: &Projection, response: &Response) {
    let stage = response.rect;
    let accent = model.preferences.theme.colours().accent;
    let stroke = Stroke::new(1.8, accent);
    let spot = |place: [f64; 3]| projection.pixel(place).map(|pixel| outside(stage, pixel));
    let Some(touch) = model.touch else {
        if model.tool == Tool::Heat
            && let (Some(at), Some(bounds)) = (response.hover_pos(), seen.scene.bounds)
        {
            face(painter, nearest_face(projection.place(inside(stage, at)), bounds), bounds, &spot, Stroke::new(4.0, accent));
        }
        return;
    };
    let (Some(from), Some(to)) = (spot(touch.from), spot(touch.to)) else { return };
    let radius = touch.body.or(seen.scene.bodies.len().checked_sub(1)).and_then(|index| seen.scene.bodies.get(index));
    let radius = radius.map_or(4.0, |body| (body.radius * projection.scale) as f32).max(4.0);
    match model.tool {
        Tool::Carry if touch.body.is_some() => {
            painter.line_segment([from, to], Stroke::new(1.0, accent));
            painter.circle(to, radius, accent.gamma_multiply(0.25), stroke);
        }
        Tool::Throw | Tool::Piston | Tool::Add if touch.body.is_some() || model.tool != Tool::Throw => {
            if model.tool == Tool::Add {
                painter.circle(from, radius, accent.gamma_multiply(0.25), stroke);
            }
            if from != to {
                painter.arrow(from, to - from, stroke);
                let speed = (0..3).map(|k| (touch.to[k] - touch.from[k]).powi(2)).sum::<f64>().sqrt() / seen.speed;
                card(painter, model, to + vec2(12.0, -8.0), Align2::LEFT_BOTTOM, &format!("|v| = {}", significant(speed, 3)));
            }
        }
        Tool::Partition => {
            if let Some(bounds) = seen.scene.bounds {
                let (axis, at) = plate(&touch);
                face(
                    painter,
                    (axis, false),
                    [bounds[0], bounds[1]].map(|mut c| {
                        c[axis] = at;
                        c
                    }),
                    &spot,
                    stroke,
                );
            }
        }
        _ => {}
    }
}

/// A face of a box, in the plane a line.
fn face(
    painter: &Painter,
    (axis, upper): (usize, bool),
    bounds: [[f64; 3]; 2],
    spot: &dyn Fn([f64; 3]) -> Option<Pos2>,
    stroke: Stroke,
) {
    let corner = |bits: usize| -> [f64; 3] {
        std::array::from_fn(|k| if k == axis { bounds[usize::from(upper)][k] } else { bounds[bits >> ((k + 2 - axis) % 3) & 1][k] })
    };
    let corners: Vec<Pos2> = [0b00, 0b01, 0b11, 0b10].into_iter().filter_map(|bits| spot(corner(bits))).collect();
    painter.add(egui::Shape::closed_line(corners, stroke));
}

/// What was done, in words.
pub(super) fn described(language: Language, action: Action) -> String {
    let (text, part) = match action {
        Action::Reverse => (Text::DidReverse, None),
        Action::Disturb { strength, .. } => (Text::DidDisturb, Some(significant(strength, 2))),
        Action::Place { body, .. } => (Text::DidPlace, Some(body.to_string())),
        Action::Throw { body, .. } => (Text::DidThrow, Some(body.to_string())),
        Action::Partition { .. } => (Text::DidPartition, None),
        Action::OpenPartitions => (Text::DidOpen, None),
        Action::Heat { temperature: Some(temperature), .. } => (Text::DidHeat, Some(significant(temperature, 4))),
        Action::Heat { temperature: None, .. } => (Text::DidCool, None),
        Action::Push { .. } => (Text::DidPush, None),
        Action::Add { .. } => (Text::DidAdd, None),
        Action::Remove { body } => (Text::DidRemove, Some(body.to_string())),
    };
    language.fill(text, &part.iter().map(String::as_str).collect::<Vec<_>>())
}

/// All that is done to the system in this run: by the file, and by hand.
pub(super) fn all(model: &Model, seen: &Snapshot) -> impl Iterator<Item = (f64, Action, Text)> {
    let of_file = model.scenario.deeds.iter().map(|deed| (deed.at, deed.act, Text::DeedsOfFile));
    let by_hand = seen.deeds.iter().map(|&(time, action)| (time, action, Text::Deeds));
    of_file.chain(by_hand)
}

/// Marks of what is done on the line of time: small triangles, hollow for the file's, whose words the pointer reads.
pub(super) fn marks(ui: &Ui, model: &Model, seen: &Snapshot, line: Rect, x_of: impl Fn(f64) -> f32) -> Option<String> {
    let colours = model.preferences.theme.colours();
    let pointer = ui.input(|input| input.pointer.hover_pos());
    let mut read = None;
    for (time, action, by) in all(model, seen) {
        let x = x_of(time);
        let top = egui::pos2(x, line.top() - 3.0);
        let points = vec![top, top + vec2(-4.0, -6.0), top + vec2(4.0, -6.0)];
        let fill = if by == Text::Deeds { colours.bad } else { egui::Color32::TRANSPARENT };
        ui.painter().add(egui::Shape::convex_polygon(points, fill, Stroke::new(1.2, colours.bad)));
        if pointer.is_some_and(|at| (at.x - x).abs() < 5.0 && (at.y - line.top()).abs() < 16.0) {
            let words = described(model.language(), action);
            read = Some(format!("{}: t = {}: {words}", model.text(by), significant(time, 5)));
        }
    }
    read
}
