//! Small signs on buttons, drawn as shapes: no font has all of them, and these are crisp at every size.

use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke};

/// A sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Icon {
    /// A triangle to the right.
    Play,
    /// Two bars.
    Pause,
    /// A bar and a triangle: one step.
    Step,
    /// Two discs that touch: the next collision.
    Collision,
    /// Two arrows, one each way: reversal.
    Reverse,
    /// A triangle to the left behind a bar: from the start.
    Restart,
    /// A die.
    Die,
    /// A ribbon: remember this moment.
    Mark,
    /// A cross in a frame: everything in view.
    Fit,
    /// An arrow back, bent: to the default.
    Undo,
    /// Four tiles: the gallery.
    Tiles,
    /// An arrow out of a tray: save.
    Save,
    /// A disc: record.
    Record,
    /// An open hand's place: move the view.
    Move,
    /// A ruler.
    Ruler,
    /// A dashed rectangle: probe.
    Probe,
    /// A watch.
    Watch,
    /// A cross: take away.
    Cross,
    /// An arrow into a tray: open.
    Open,
    /// A framed view: a picture.
    Picture,
    /// A body, and where it goes: carry.
    Carry,
    /// A body with an arrow: throw.
    Throw,
    /// A body more.
    Plus,
    /// A body less.
    Minus,
    /// A wall with a hole.
    Plate,
    /// A flame: heat.
    Flame,
    /// A plate on a rod.
    Piston,
    /// An arrow: velocities.
    Arrow,
    /// A path that forks: disturb.
    Fork,
}

/// Draws a sign into the middle of a rectangle.
#[allow(clippy::too_many_lines, reason = "one small picture after the other")]
pub(crate) fn paint(painter: &Painter, icon: Icon, rect: Rect, colour: Color32) {
    let side = rect.width().min(rect.height());
    let at = |x: f32, y: f32| -> Pos2 { rect.center() + side * egui::vec2(x - 0.5, y - 0.5) };
    let stroke = Stroke::new((side * 0.1).max(1.2), colour);
    let fill = |points: Vec<Pos2>| painter.add(Shape::convex_polygon(points, colour, Stroke::NONE));
    let path = |points: Vec<Pos2>| painter.add(Shape::line(points, stroke));
    let bar =
        |x: f32, w: f32, top: f32, bottom: f32| painter.rect_filled(Rect::from_min_max(at(x, top), at(x + w, bottom)), 0.5, colour);
    match icon {
        Icon::Play => drop(fill(vec![at(0.22, 0.1), at(0.88, 0.5), at(0.22, 0.9)])),
        Icon::Pause => {
            bar(0.2, 0.2, 0.12, 0.88);
            bar(0.6, 0.2, 0.12, 0.88);
        }
        Icon::Step => {
            bar(0.12, 0.14, 0.15, 0.85);
            fill(vec![at(0.38, 0.15), at(0.92, 0.5), at(0.38, 0.85)]);
        }
        Icon::Collision => {
            painter.circle_filled(at(0.28, 0.64), 0.22 * side, colour);
            painter.circle_stroke(at(0.68, 0.46), 0.22 * side, stroke);
            path(vec![at(0.34, 0.14), at(0.42, 0.3)]);
            path(vec![at(0.18, 0.22), at(0.28, 0.34)]);
        }
        Icon::Reverse => {
            path(vec![at(0.1, 0.32), at(0.88, 0.32)]);
            path(vec![at(0.66, 0.12), at(0.88, 0.32), at(0.66, 0.5)]);
            path(vec![at(0.9, 0.7), at(0.12, 0.7)]);
            path(vec![at(0.34, 0.5), at(0.12, 0.7), at(0.34, 0.9)]);
        }
        Icon::Restart => {
            bar(0.12, 0.14, 0.15, 0.85);
            fill(vec![at(0.9, 0.15), at(0.9, 0.85), at(0.34, 0.5)]);
        }
        Icon::Die => {
            painter.rect_stroke(Rect::from_min_max(at(0.12, 0.12), at(0.88, 0.88)), 2.0, stroke, egui::StrokeKind::Middle);
            for (x, y) in [(0.33, 0.33), (0.5, 0.5), (0.67, 0.67)] {
                painter.circle_filled(at(x, y), 0.075 * side, colour);
            }
        }
        Icon::Mark => {
            fill(vec![at(0.25, 0.1), at(0.75, 0.1), at(0.75, 0.62), at(0.25, 0.62)]);
            fill(vec![at(0.25, 0.6), at(0.5, 0.6), at(0.25, 0.92)]);
            fill(vec![at(0.75, 0.6), at(0.75, 0.92), at(0.5, 0.6)]);
        }
        Icon::Fit => {
            for (x, y, dx, dy) in
                [(0.12, 0.12, 1.0, 1.0), (0.88, 0.12, -1.0, 1.0), (0.12, 0.88, 1.0, -1.0), (0.88, 0.88, -1.0, -1.0)]
            {
                path(vec![at(x, y + 0.24 * dy), at(x, y), at(x + 0.24 * dx, y)]);
            }
            painter.circle_filled(at(0.5, 0.5), 0.12 * side, colour);
        }
        Icon::Undo => {
            let arc = (0..=14).map(|k| {
                let angle = -2.6 + 4.4 * k as f32 / 14.0;
                at(0.54 + 0.32 * angle.cos(), 0.54 + 0.32 * angle.sin())
            });
            path(arc.collect());
            path(vec![at(0.1, 0.16), at(0.26, 0.4), at(0.5, 0.28)]);
        }
        Icon::Tiles => {
            for (x, y) in [(0.1, 0.1), (0.56, 0.1), (0.1, 0.56), (0.56, 0.56)] {
                painter.rect_filled(Rect::from_min_max(at(x, y), at(x + 0.34, y + 0.34)), 1.5, colour);
            }
        }
        Icon::Save | Icon::Open => {
            path(vec![at(0.12, 0.62), at(0.12, 0.9), at(0.88, 0.9), at(0.88, 0.62)]);
            path(vec![at(0.5, 0.08), at(0.5, 0.66)]);
            let (tip, foot) = if icon == Icon::Save { (0.68, 0.44) } else { (0.08, 0.32) };
            path(vec![at(0.27, foot), at(0.5, tip), at(0.73, foot)]);
        }
        Icon::Record => {
            painter.circle_stroke(at(0.5, 0.5), 0.42 * side, stroke);
            painter.circle_filled(at(0.5, 0.5), 0.22 * side, colour);
        }
        Icon::Move => {
            path(vec![at(0.5, 0.08), at(0.5, 0.92)]);
            path(vec![at(0.08, 0.5), at(0.92, 0.5)]);
            for (x, y) in [(0.5, 0.06), (0.94, 0.5), (0.5, 0.94), (0.06, 0.5)] {
                let (dx, dy) = (0.5 - x, 0.5 - y);
                let (ox, oy) = (0.3 * dx, 0.3 * dy);
                path(vec![at(x + ox + 0.3 * dy, y + oy + 0.3 * dx), at(x, y), at(x + ox - 0.3 * dy, y + oy - 0.3 * dx)]);
            }
        }
        Icon::Ruler => {
            let points = vec![at(0.04, 0.34), at(0.96, 0.34), at(0.96, 0.68), at(0.04, 0.68)];
            painter.add(Shape::closed_line(points, stroke));
            for k in 1..5 {
                let x = 0.04 + 0.92 * k as f32 / 5.0;
                path(vec![at(x, 0.34), at(x, 0.51)]);
            }
        }
        Icon::Probe => {
            let corners = [at(0.1, 0.16), at(0.9, 0.16), at(0.9, 0.84), at(0.1, 0.84), at(0.1, 0.16)];
            painter.extend(Shape::dashed_line(&corners, stroke, 0.18 * side, 0.12 * side));
            painter.circle_filled(at(0.38, 0.58), 0.09 * side, colour);
            painter.circle_filled(at(0.64, 0.4), 0.09 * side, colour);
        }
        Icon::Watch => {
            painter.circle_stroke(at(0.5, 0.56), 0.36 * side, stroke);
            path(vec![at(0.5, 0.56), at(0.5, 0.34)]);
            path(vec![at(0.5, 0.56), at(0.66, 0.62)]);
            path(vec![at(0.38, 0.08), at(0.62, 0.08)]);
        }
        Icon::Picture => {
            painter.rect_stroke(Rect::from_min_max(at(0.06, 0.16), at(0.94, 0.84)), 1.5, stroke, egui::StrokeKind::Middle);
            path(vec![at(0.12, 0.74), at(0.38, 0.46), at(0.54, 0.62), at(0.68, 0.5), at(0.88, 0.72)]);
            painter.circle_filled(at(0.7, 0.34), 0.08 * side, colour);
        }
        Icon::Carry => {
            painter.circle_filled(at(0.24, 0.72), 0.2 * side, colour);
            painter.circle_stroke(at(0.74, 0.26), 0.2 * side, stroke);
            painter.extend(Shape::dashed_line(&[at(0.38, 0.58), at(0.6, 0.4)], stroke, 0.12 * side, 0.08 * side));
        }
        Icon::Throw => {
            painter.circle_filled(at(0.24, 0.76), 0.2 * side, colour);
            path(vec![at(0.38, 0.62), at(0.9, 0.1)]);
            path(vec![at(0.58, 0.1), at(0.9, 0.1), at(0.9, 0.42)]);
        }
        Icon::Plus | Icon::Minus => {
            painter.circle_stroke(at(0.5, 0.5), 0.42 * side, stroke);
            path(vec![at(0.28, 0.5), at(0.72, 0.5)]);
            if icon == Icon::Plus {
                path(vec![at(0.5, 0.28), at(0.5, 0.72)]);
            }
        }
        Icon::Plate => {
            bar(0.44, 0.12, 0.02, 0.34);
            bar(0.44, 0.12, 0.66, 0.98);
            painter.circle_filled(at(0.16, 0.5), 0.11 * side, colour);
            painter.circle_stroke(at(0.82, 0.5), 0.11 * side, stroke);
        }
        Icon::Flame => {
            let half = [(0.5, 0.04), (0.62, 0.3), (0.8, 0.52), (0.76, 0.8), (0.5, 0.96)];
            let other = [(0.24, 0.8), (0.2, 0.56), (0.34, 0.42), (0.4, 0.26)];
            painter.add(Shape::closed_line(half.iter().chain(&other).map(|&(x, y)| at(x, y)).collect(), stroke));
        }
        Icon::Piston => {
            path(vec![at(0.06, 0.2), at(0.06, 0.94), at(0.94, 0.94), at(0.94, 0.2)]);
            path(vec![at(0.14, 0.56), at(0.86, 0.56)]);
            path(vec![at(0.5, 0.56), at(0.5, 0.04)]);
        }
        Icon::Arrow => {
            path(vec![at(0.1, 0.9), at(0.88, 0.12)]);
            path(vec![at(0.5, 0.12), at(0.88, 0.12), at(0.88, 0.5)]);
        }
        Icon::Fork => {
            path(vec![at(0.06, 0.5), at(0.4, 0.5), at(0.92, 0.16)]);
            painter.extend(Shape::dashed_line(&[at(0.4, 0.5), at(0.92, 0.84)], stroke, 0.14 * side, 0.1 * side));
            path(vec![at(0.7, 0.14), at(0.92, 0.16), at(0.86, 0.36)]);
        }
        Icon::Cross => {
            path(vec![at(0.22, 0.22), at(0.78, 0.78)]);
            path(vec![at(0.78, 0.22), at(0.22, 0.78)]);
        }
    }
}
