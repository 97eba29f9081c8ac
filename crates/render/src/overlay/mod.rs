//! Title, caption, time, legend, scale bar and labels, laid out so that the stage stays free.

mod font;
mod legend;
mod number;
mod sheet;

use corpuscle_scene::{Camera, Colour, Palette, Scene};

use crate::View;
use crate::projection::{Projection, Rectangle};
use font::{Style, Typeface};
use legend::{Legend, quiet};
use number::{clock, one_two_five_below, short};
use sheet::Align;
pub(crate) use sheet::Sheet;

/// Lengths of the layout, in pixels of one frame.
#[derive(Clone, Copy)]
pub(crate) struct Measures {
    scale: f64,
}

impl Measures {
    fn points(self, points: f64) -> f64 {
        points * self.scale
    }

    /// The thinnest line that is drawn evenly.
    fn hair(self) -> f64 {
        self.scale.round().max(1.0)
    }

    fn margin(self) -> f64 {
        self.points(18.0)
    }

    fn small(self) -> Style {
        Style { size: self.points(13.0), bold: false }
    }

    fn title(self) -> Style {
        Style { size: self.points(17.0), bold: true }
    }
}

/// Where everything goes on one frame: a band on top for the words, a column on the right (of a wide frame) or a band
/// below (of a tall one) for the legend and the scale bar, and the rest for the stage.
pub(crate) struct Layout {
    /// What is left to the simulation.
    pub(crate) stage: Rectangle,
    top: f64,
    /// Column on the right or band below; none when there is nothing to put there.
    side: Option<Rectangle>,
    column: bool,
    legend: Option<Legend>,
    measures: Measures,
}

impl Layout {
    pub(crate) fn new(scene: &Scene, view: &View, typeface: &Typeface) -> Self {
        let m = Measures { scale: f64::from(view.scale) };
        let (width, height) = (f64::from(view.width), f64::from(view.height));
        let whole = Rectangle { left: 0.0, top: 0.0, width, height };
        let mut layout = Self { stage: whole, top: 0.0, side: None, column: false, legend: None, measures: m };
        if !view.overlay {
            return layout;
        }
        layout.top = m.points(if scene.caption.is_empty() { 44.0 } else { 64.0 });
        layout.legend = Legend::new(&scene.colouring);
        let flat = matches!(view.camera.unwrap_or(scene.camera), Camera::Plane { .. });
        let middle = Rectangle { left: 0.0, top: layout.top, width, height: (height - layout.top).max(1.0) };
        layout.stage = middle;
        layout.column = layout.legend.is_some() && width >= 1.1 * height;
        if layout.column {
            let needs = layout.legend.as_ref().map_or(0.0, |legend| legend.column_size(m, typeface)[0]);
            let needs = (needs.max(m.points(110.0)) + 2.0 * m.margin()).min(0.4 * width);
            layout.stage.width = (width - needs).max(1.0);
            layout.side = Some(Rectangle { left: width - needs, width: needs, ..middle });
        } else if flat || layout.legend.is_some() {
            let room = width - 2.0 * m.margin() - if flat { m.points(160.0) } else { 0.0 };
            let needs = layout.legend.as_ref().map_or(m.points(22.0), |legend| legend.band_height(m, typeface, room));
            let needs = (needs + m.margin()).min(0.4 * middle.height);
            layout.stage.height = (middle.height - needs).max(1.0);
            layout.side = Some(Rectangle { top: height - needs, height: needs, ..middle });
        } else {
            layout.stage.height = (middle.height - m.margin()).max(1.0);
        }
        layout
    }

    /// Lays out and collects everything that lies over the picture.
    pub(crate) fn draw(&self, sheet: &mut Sheet, scene: &Scene, view: &View, projection: &Projection) {
        let m = self.measures;
        for label in &scene.labels {
            if let Some([x, y]) = projection.pixel(label.at) {
                let style = m.small();
                // On a ground of its own: bodies pass below it.
                let size = [sheet.typeface.width(&label.text, style) + m.points(10.0), m.points(19.0)];
                let (left, top) = ((x - 0.5 * size[0]).round(), (y - 0.5 * size[1]).round());
                Self::veil(sheet, Rectangle { left, top, width: size[0].round(), height: size[1].round() }, view.palette);
                sheet.text(&label.text, style, [x, y + 0.36 * style.size], Align::Middle, view.palette.rgba(label.colour));
            }
        }
        if view.overlay {
            self.words(sheet, scene, view);
            self.sides(sheet, view, projection);
        }
        if !view.card.is_empty() {
            self.card(sheet, view);
        }
    }

    /// A veil of the ground's colour, so that texts stay readable over what reaches below them.
    fn veil(sheet: &mut Sheet, area: Rectangle, palette: Palette) {
        let [r, g, b] = palette.ground();
        sheet.fill(area, [r, g, b, 0.82]);
    }

    fn words(&self, sheet: &mut Sheet, scene: &Scene, view: &View) {
        let m = self.measures;
        let (width, margin) = (f64::from(view.width), m.margin());
        Self::veil(sheet, Rectangle { left: 0.0, top: 0.0, width, height: self.top }, view.palette);
        let ink = view.palette.rgba(Colour::Ink);
        let time = format!("t = {}", clock(scene.time));
        let time_width = sheet.typeface.width(&time, m.small());
        let baseline = margin + m.points(12.0);
        sheet.text(&time, m.small(), [width - margin, baseline], Align::Right, ink);
        let room = width - 3.0 * margin - time_width;
        let title = sheet.typeface.fit(&scene.title, m.title(), room);
        sheet.text(&title, m.title(), [margin, baseline], Align::Left, ink);
        let caption = sheet.typeface.fit(&scene.caption, m.small(), width - 2.0 * margin);
        sheet.text(&caption, m.small(), [margin, baseline + m.points(22.0)], Align::Left, quiet(view.palette));
    }

    fn sides(&self, sheet: &mut Sheet, view: &View, projection: &Projection) {
        let Some(side) = self.side else { return };
        let m = self.measures;
        Self::veil(sheet, side, view.palette);
        let bar = if projection.is_spatial() { 0.0 } else { m.points(44.0) };
        if self.column {
            let left = side.left + m.margin();
            let inner = Rectangle { left, width: side.width - m.margin(), height: side.height - bar - m.margin(), ..side };
            if let Some(legend) = &self.legend {
                legend.draw_column(sheet, m, inner, view.palette);
            }
            if bar > 0.0 {
                let bottom = side.top + side.height - m.margin();
                scale_bar(sheet, m, view.palette, projection, [left, bottom], side.width - 2.0 * m.margin(), Align::Left);
            }
        } else {
            let inner = Rectangle { left: m.margin(), width: side.width - 2.0 * m.margin(), ..side };
            let room = inner.width - if bar > 0.0 { m.points(160.0) } else { 0.0 };
            if let Some(legend) = &self.legend {
                legend.draw_band(sheet, m, Rectangle { width: room, ..inner }, view.palette);
            }
            if bar > 0.0 {
                let bottom = side.top + side.height - m.margin();
                let at = [inner.left + inner.width, bottom];
                scale_bar(sheet, m, view.palette, projection, at, m.points(140.0), Align::Right);
            }
        }
    }

    /// Rows of a key and its meaning, in a card in the middle.
    fn card(&self, sheet: &mut Sheet, view: &View) {
        let m = self.measures;
        let bold = Style { bold: true, ..m.small() };
        let keys = view.card.iter().map(|row| sheet.typeface.width(row.0, bold)).fold(0.0, f64::max);
        let words = view.card.iter().map(|row| sheet.typeface.width(row.1, m.small())).fold(0.0, f64::max);
        let (gap, pitch) = (m.points(22.0), m.points(23.0));
        let width = keys + gap + words + 2.0 * gap;
        let height = pitch * view.card.len() as f64 + 2.0 * gap - m.points(8.0);
        let left = 0.5 * (f64::from(view.width) - width);
        let top = 0.5 * (f64::from(view.height) - height);
        let ink = view.palette.rgba(Colour::Ink);
        let [r, g, b] = view.palette.ground();
        let frame = m.hair();
        let area = Rectangle { left: left.round(), top: top.round(), width: width.round(), height: height.round() };
        let edge = Rectangle {
            left: area.left - frame,
            top: area.top - frame,
            width: area.width + 2.0 * frame,
            height: area.height + 2.0 * frame,
        };
        sheet.fill(edge, view.palette.rgba(Colour::Faint));
        sheet.fill(area, [r, g, b, 0.96]);
        for (row, (key, meaning)) in (0..).zip(view.card) {
            let baseline = top + gap + m.points(9.0) + pitch * f64::from(row);
            sheet.text(key, bold, [left + gap + keys, baseline], Align::Right, ink);
            sheet.text(meaning, m.small(), [left + 2.0 * gap + keys, baseline], Align::Left, ink);
        }
    }
}

/// A bar of a round length, at most `room` pixels long, with its lower end (left or right) at `at`.
fn scale_bar(sheet: &mut Sheet, m: Measures, palette: Palette, projection: &Projection, at: [f64; 2], room: f64, align: Align) {
    let most = room.min(m.points(140.0)) / projection.scale;
    if !(most.is_finite() && most > 0.0) {
        return;
    }
    let length = one_two_five_below(most);
    let width = (length * projection.scale).round();
    let left = if align == Align::Right { at[0] - width } else { at[0] };
    let (hair, end) = (m.hair(), m.points(7.0).round());
    let colour = quiet(palette);
    let y = at[1].round();
    sheet.fill(Rectangle { left, top: y - hair, width, height: hair }, colour);
    sheet.fill(Rectangle { left, top: y - end, width: hair, height: end - hair }, colour);
    sheet.fill(Rectangle { left: left + width - hair, top: y - end, width: hair, height: end - hair }, colour);
    let place = [left + 0.5 * width, y - m.points(7.0)];
    sheet.text(&short(length), m.small(), place, Align::Middle, palette.rgba(Colour::Ink));
}
