//! What the colours mean.

use corpuscle_scene::{Colour, Colouring, Palette};

use super::Measures;
use super::font::Typeface;
use super::number::{common_exponent, decimals, fixed, power_text, ticks};
use super::sheet::{Align, Rgba, Sheet};
use crate::projection::Rectangle;

/// A legend that knows how much room it needs.
pub(crate) enum Legend {
    /// A swatch and a name each.
    Species(Vec<String>),
    /// A bar of colours with ticks: values and their texts.
    Scale { heading: String, least: f64, most: f64, ticks: Vec<(f64, String)>, map: fn(f64) -> [f64; 3] },
}

impl Legend {
    /// None where all bodies look alike.
    pub(crate) fn new(colouring: &Colouring) -> Option<Self> {
        let scale = |name: &str, unit: &str, least, most| Some(Self::scale(name, unit, [least, most], colouring.map()));
        match colouring {
            Colouring::Uniform(_) => None,
            Colouring::Species(names) if names.is_empty() => None,
            Colouring::Species(names) => Some(Self::Species(names.clone())),
            Colouring::Speed { most, unit } => scale("speed", unit, 0.0, *most),
            Colouring::Energy { most } => scale("kinetic energy", "", 0.0, *most),
            Colouring::Height { least, most, .. } => scale("height", "", *least, *most),
            Colouring::Value { name, unit, least, most } | Colouring::Angle { name, unit, least, most } => {
                scale(name, unit, *least, *most)
            }
        }
    }

    fn scale(name: &str, unit: &str, [least, most]: [f64; 2], map: fn(f64) -> [f64; 3]) -> Self {
        let exponent = common_exponent(least.abs().max(most.abs()));
        let values = ticks(least, most);
        let power = 10f64.powi(exponent);
        let places = values.windows(2).map(|w| decimals((w[1] - w[0]) / power)).max().unwrap_or(2);
        let unit = match (exponent, unit) {
            (0, "") => String::new(),
            (0, unit) => format!(" / {unit}"),
            (_, "") => format!(" / {}", power_text(exponent)),
            (_, unit) => format!(" / {} {unit}", power_text(exponent)),
        };
        let ticks = values.into_iter().map(|value| (value, fixed(value / power, places))).collect();
        Self::Scale { heading: format!("{name}{unit}"), least, most, ticks, map }
    }

    /// Width and height in a column beside the stage.
    pub(crate) fn column_size(&self, m: Measures, typeface: &Typeface) -> [f64; 2] {
        let widest =
            |texts: &mut dyn Iterator<Item = &String>| texts.map(|text| typeface.width(text, m.small())).fold(0.0, f64::max);
        match self {
            Self::Species(names) => [m.points(20.0) + widest(&mut names.iter()), m.points(22.0) * names.len() as f64],
            Self::Scale { heading, ticks, .. } => {
                let beside = m.points(14.0 + 10.0) + widest(&mut ticks.iter().map(|(_, text)| text));
                [beside.max(typeface.width(heading, m.small())), m.points(24.0 + 180.0)]
            }
        }
    }

    /// Height in a band below the stage that leaves `width` to the legend.
    pub(crate) fn band_height(&self, m: Measures, typeface: &Typeface, width: f64) -> f64 {
        match self {
            Self::Species(names) => m.points(22.0) * Self::rows(names, m, typeface, width).len() as f64,
            Self::Scale { .. } => m.points(48.0),
        }
    }

    /// The names that stand in one row each, by their indices, with their left edges.
    fn rows(names: &[String], m: Measures, typeface: &Typeface, width: f64) -> Vec<Vec<(usize, f64)>> {
        let mut rows = vec![Vec::new()];
        let mut left = 0.0;
        for (index, name) in names.iter().enumerate() {
            let needs = m.points(20.0) + typeface.width(name, m.small());
            if left > 0.0 && left + needs > width {
                rows.push(Vec::new());
                left = 0.0;
            }
            if let Some(row) = rows.last_mut() {
                row.push((index, left));
            }
            left += needs + m.points(20.0);
        }
        rows
    }

    /// Draws it from the upper left corner of `area` down.
    pub(crate) fn draw_column(&self, sheet: &mut Sheet, m: Measures, area: Rectangle, palette: Palette) {
        match self {
            Self::Species(names) => {
                let pitch = m.points(22.0);
                let room = ((area.height / pitch) as usize).max(1);
                let shown = if names.len() > room { room - 1 } else { names.len() };
                let row = |index: usize| [area.left, area.top + pitch * index as f64];
                for (index, name) in names.iter().take(shown).enumerate() {
                    swatch(sheet, m, row(index), index, name, palette);
                }
                if shown < names.len() {
                    let [x, y] = row(shown);
                    let rest = format!("… {} more", names.len() - shown);
                    sheet.text(&rest, m.small(), [x, y + m.points(15.0)], Align::Left, quiet(palette));
                }
            }
            Self::Scale { heading, least, most, ticks, map } => {
                let (ink, small) = (palette.rgba(Colour::Ink), m.small());
                sheet.text(heading, small, [area.left, area.top + m.points(12.0)], Align::Left, ink);
                let top = (area.top + m.points(26.0)).round();
                let height = m.points(170.0).min(area.height - m.points(30.0)).max(1.0).round();
                let width = m.points(14.0).round();
                for row in 0..height as usize {
                    let part = 1.0 - (row as f64 + 0.5) / height;
                    let line = Rectangle { left: area.left, top: top + row as f64, width, height: 1.0 };
                    sheet.fill(line, ramp(*map, part));
                }
                for (value, text) in ticks {
                    let y = top + height * (1.0 - part_of(*value, *least, *most));
                    let mark = Rectangle { left: area.left + width, top: y - 0.5, width: m.points(4.0), height: m.hair() };
                    sheet.fill(mark, quiet(palette));
                    let baseline = y + 0.36 * small.size;
                    sheet.text(text, small, [area.left + width + m.points(8.0), baseline], Align::Left, ink);
                }
            }
        }
    }

    /// Draws it from the upper left corner of `area` to the right.
    pub(crate) fn draw_band(&self, sheet: &mut Sheet, m: Measures, area: Rectangle, palette: Palette) {
        match self {
            Self::Species(names) => {
                for (line, row) in (0..).zip(Self::rows(names, m, &sheet.typeface, area.width)) {
                    for (index, left) in row {
                        let at = [area.left + left, area.top + m.points(22.0) * f64::from(line)];
                        swatch(sheet, m, at, index, &names[index], palette);
                    }
                }
            }
            Self::Scale { heading, least, most, ticks, map } => {
                let (ink, small) = (palette.rgba(Colour::Ink), m.small());
                sheet.text(heading, small, [area.left, area.top + m.points(10.0)], Align::Left, ink);
                let (top, height) = (area.top + m.points(17.0), m.points(12.0));
                let width = m.points(240.0).min(area.width - m.points(24.0)).max(1.0).round();
                for column in 0..width as usize {
                    let part = (column as f64 + 0.5) / width;
                    let line = Rectangle { left: area.left + column as f64, top, width: 1.0, height };
                    sheet.fill(line, ramp(*map, part));
                }
                for (value, text) in ticks {
                    let x = area.left + width * part_of(*value, *least, *most);
                    let mark = Rectangle { left: x - 0.5, top: top + height, width: m.hair(), height: m.points(4.0) };
                    sheet.fill(mark, quiet(palette));
                    sheet.text(text, small, [x.max(area.left + m.points(4.0)), top + height + m.points(17.0)], Align::Middle, ink);
                }
            }
        }
    }
}

/// Ink that steps back behind the figures.
pub(crate) fn quiet(palette: Palette) -> Rgba {
    let [r, g, b, _] = palette.rgba(Colour::Ink);
    [r, g, b, 0.66]
}

fn ramp(map: fn(f64) -> [f64; 3], part: f64) -> Rgba {
    let [r, g, b] = map(part).map(|c| c as f32);
    [r, g, b, 1.0]
}

fn part_of(value: f64, least: f64, most: f64) -> f64 {
    if most > least { (value - least) / (most - least) } else { 0.5 }
}

fn swatch(sheet: &mut Sheet, m: Measures, [left, top]: [f64; 2], index: usize, name: &str, palette: Palette) {
    let colour = palette.rgba(Colour::Accent((index % 8) as u8));
    sheet.disc([left + m.points(6.0), top + m.points(10.0)], m.points(5.5), colour);
    let small = m.small();
    sheet.text(
        name,
        small,
        [left + m.points(20.0), top + m.points(10.0) + 0.36 * small.size],
        Align::Left,
        palette.rgba(Colour::Ink),
    );
}
