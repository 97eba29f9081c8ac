//! Letters: rasterised once, kept in a table in the graphics memory.

use std::collections::HashMap;

use ab_glyph::{Font, FontRef, PxScale, ScaleFont, point};

use crate::RenderError;
use crate::gl::{Format, Gl, Texture};

/// Side of the table in texels: every OpenGL 3.3 has it, and it holds some thousand letters.
const SIDE: usize = 1024;

/// Size and weight of a text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Style {
    /// Height of an em in pixels.
    pub(crate) size: f64,
    /// Heavier strokes.
    pub(crate) bold: bool,
}

/// A letter in the table.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Glyph {
    /// Left, top, right, bottom in texels.
    pub(crate) texels: [f32; 4],
    /// From the pen (floored) and the baseline to the upper left corner, in pixels.
    pub(crate) offset: [f32; 2],
}

/// A letter at a size and at a quarter of a pixel.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct Key {
    letter: char,
    size: u32,
    bold: bool,
    quarter: u8,
}

/// DejaVu Sans and its letters as they were needed.
pub(crate) struct Typeface {
    fonts: [FontRef<'static>; 2],
    texture: Texture,
    glyphs: HashMap<Key, Glyph>,
    /// Where the next letter goes, and the height of the current row.
    next: [usize; 2],
    row: usize,
    full: bool,
}

impl Typeface {
    pub(crate) fn new(gl: &Gl) -> Result<Self, RenderError> {
        let font = |bytes| FontRef::try_from_slice(bytes).map_err(|fault| RenderError::OpenGl(format!("the font: {fault}")));
        let fonts = [font(dejavu::sans::regular())?, font(dejavu::sans::bold())?];
        let texture = Texture::new(gl, Format::Mask, [SIDE, SIDE])?;
        let mut this = Self { fonts, texture, glyphs: HashMap::new(), next: [0; 2], row: 0, full: false };
        this.empty();
        Ok(this)
    }

    /// The table; its first texel is fully covered.
    pub(crate) fn texture(&self) -> &Texture {
        &self.texture
    }

    /// Makes room when the last picture ran out of it.
    pub(crate) fn begin(&mut self) {
        if self.full {
            self.empty();
        }
    }

    fn empty(&mut self) {
        self.glyphs.clear();
        self.texture.write([0, 0], [1, 1], &[255u8]);
        (self.next, self.row, self.full) = ([2, 0], 2, false);
    }

    /// The width of a text in pixels.
    pub(crate) fn width(&self, text: &str, style: Style) -> f64 {
        self.pens(text, style).last().map_or(0.0, |(_, end)| end)
    }

    /// Each letter's end, from the start of the text, in pixels.
    fn pens<'t>(&'t self, text: &'t str, style: Style) -> impl Iterator<Item = (char, f64)> + 't {
        let font = self.font(style.bold).as_scaled(self.scale(style));
        let mut before = None;
        let mut pen = 0.0;
        text.chars().map(move |letter| {
            let id = font.glyph_id(letter);
            pen += before.map_or(0.0, |last| f64::from(font.kern(last, id))) + f64::from(font.h_advance(id));
            before = Some(id);
            (letter, pen)
        })
    }

    /// The longest beginning of a text that is no wider than `most`, with an ellipsis where it is cut.
    pub(crate) fn fit(&self, text: &str, style: Style, most: f64) -> String {
        if self.width(text, style) <= most {
            return text.to_owned();
        }
        let room = most - self.width("…", style);
        let kept: String = self.pens(text, style).take_while(|(_, end)| *end <= room).map(|(letter, _)| letter).collect();
        kept.trim_end().to_owned() + "…"
    }

    /// The letters of a text with the pixel of their upper left corner, for a pen that starts at `start`.
    pub(crate) fn lay(&mut self, text: &str, style: Style, start: [f64; 2]) -> Vec<([f32; 2], Glyph)> {
        let ends: Vec<_> = self.pens(text, style).collect();
        let mut pen = 0.0;
        let baseline = start[1].round() as f32;
        let mut laid = Vec::with_capacity(ends.len());
        for (letter, end) in ends {
            // Letters stand on quarters of a pixel: even spacing, and few pictures of each.
            let quarters = ((start[0] + pen) * 4.0).round();
            let whole = (quarters / 4.0).floor();
            let glyph = self.glyph(letter, style, (quarters - 4.0 * whole) as u8);
            laid.push(([whole as f32 + glyph.offset[0], baseline + glyph.offset[1]], glyph));
            pen = end;
        }
        laid
    }

    fn font(&self, bold: bool) -> &FontRef<'static> {
        &self.fonts[usize::from(bold)]
    }

    /// ab_glyph measures sizes by the font's height, everybody else by its em.
    fn scale(&self, style: Style) -> PxScale {
        let font = self.font(style.bold);
        let em = font.units_per_em().unwrap_or(2048.0);
        PxScale::from(style.size as f32 * font.height_unscaled() / em)
    }

    fn glyph(&mut self, letter: char, style: Style, quarter: u8) -> Glyph {
        let key = Key { letter, size: (style.size * 64.0).round() as u32, bold: style.bold, quarter };
        if let Some(glyph) = self.glyphs.get(&key) {
            return *glyph;
        }
        let font = self.font(style.bold);
        let id = font.glyph_id(letter);
        let placed = id.with_scale_and_position(self.scale(style), point(f32::from(quarter) / 4.0, 0.0));
        let mut glyph = Glyph::default();
        if let Some(outline) = font.outline_glyph(placed) {
            let bounds = outline.px_bounds();
            let [width, height] = [bounds.width() as usize, bounds.height() as usize];
            let mut mask = vec![0u8; width * height];
            outline.draw(|x, y, coverage| {
                mask[y as usize * width + x as usize] = (coverage.clamp(0.0, 1.0) * 255.0).round() as u8;
            });
            glyph = self.store([width, height], &mask);
            glyph.offset = [bounds.min.x, bounds.min.y];
        }
        self.glyphs.insert(key, glyph);
        glyph
    }

    /// A round mask of the given radius in pixels, for swatches; its offset is from the centre.
    pub(crate) fn disc(&mut self, radius: f64) -> Glyph {
        let key = Key { letter: '\0', size: (radius * 64.0).round() as u32, bold: false, quarter: 0 };
        if let Some(glyph) = self.glyphs.get(&key) {
            return *glyph;
        }
        let half = radius.ceil() + 1.0;
        let side = 2 * half as usize;
        let coverage = |i: usize| {
            let [x, y] = [i % side, i / side].map(|n| n as f64 + 0.5 - half);
            ((radius - x.hypot(y) + 0.5).clamp(0.0, 1.0) * 255.0).round() as u8
        };
        let mask: Vec<u8> = (0..side * side).map(coverage).collect();
        let mut glyph = self.store([side, side], &mask);
        glyph.offset = [-half as f32; 2];
        self.glyphs.insert(key, glyph);
        glyph
    }

    /// Finds a place in rows; a mask that finds none is left out of this picture.
    fn store(&mut self, [width, height]: [usize; 2], mask: &[u8]) -> Glyph {
        if self.next[0] + width > SIDE {
            self.next = [0, self.next[1] + self.row + 1];
            self.row = 0;
        }
        let [x, y] = self.next;
        if width > SIDE || y + height > SIDE {
            self.full = true;
            return Glyph::default();
        }
        self.texture.write([x, y], [width, height], mask);
        self.next[0] += width + 1;
        self.row = self.row.max(height);
        Glyph { texels: [x, y, x + width, y + height].map(|n| n as f32), offset: [0.0; 2] }
    }
}
