//! A rectangle coloured cell by cell.

use corpuscle_scene::{Colour, Map, Palette, Scene};

use super::{SPACE, Space};
use crate::RenderError;
use crate::gl::{Format, Gl, Pass, Program, Texture, Vertex, VertexBuffer, largest_side};
use crate::projection::pairs;

#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct MapVertex {
    corners: [[f32; 4]; 2],
}

impl Vertex for MapVertex {
    const FIELDS: &'static [i32] = &[4, 4];
}

/// The map behind everything. Its colours are sent again only when they have changed.
pub(crate) struct Maps {
    program: Program,
    buffer: VertexBuffer<MapVertex>,
    texture: Option<Texture>,
    shown: Option<(Map, Palette)>,
}

impl Maps {
    pub(crate) fn new(gl: &Gl) -> Result<Self, RenderError> {
        let program = Program::new(gl, "map", &[SPACE, include_str!("../shaders/map.glsl")])?;
        Ok(Self { program, buffer: VertexBuffer::new(gl)?, texture: None, shown: None })
    }

    pub(crate) fn draw(&mut self, gl: &Gl, space: &Space, scene: &Scene) -> Result<(), RenderError> {
        let Some(map) = scene.map.as_ref().filter(|map| map.columns > 0 && !map.cells.is_empty()) else { return Ok(()) };
        let size = [map.columns, map.cells.len() / map.columns];
        let most = largest_side(gl);
        if size.iter().any(|&side| side > most as usize) {
            let [width, height] = size.map(|side| u32::try_from(side).unwrap_or(u32::MAX));
            return Err(RenderError::Size { width, height, most });
        }
        if !self.shown.as_ref().is_some_and(|(shown, palette)| shown == map && *palette == space.palette) {
            let mut texture = match self.texture.take() {
                Some(texture) if texture.size() == size => texture,
                _ => Texture::new(gl, Format::Colours, size)?,
            };
            texture.write([0, 0], size, &colours(map, space.palette));
            self.texture = Some(texture);
            self.shown = Some((map.clone(), space.palette));
        }
        let corners = pairs([map.lower[0], map.lower[1], map.upper[0], map.upper[1]]);
        self.buffer.replace(&[MapVertex { corners }]);
        if space.projection.is_spatial() { Pass::Veil } else { Pass::Paint }.begin(gl);
        space.enter(&self.program);
        self.program.set("u_cells", 0);
        if let Some(texture) = &self.texture {
            texture.bind();
        }
        self.buffer.draw();
        Ok(())
    }
}

/// Red, green, blue and opacity of each whole row's cells: a colour of the palette over its ground.
fn colours(map: &Map, palette: Palette) -> Vec<[u8; 4]> {
    let species: [[f32; 4]; 8] = std::array::from_fn(|index| palette.rgba(Colour::Accent(index as u8)));
    let ground = palette.ground();
    let whole = map.cells.len() / map.columns * map.columns;
    let mix = |cell: &corpuscle_scene::Cell| {
        let (colour, share) = (species[usize::from(cell.species) % 8], f32::from(cell.strength) / 255.0);
        let byte = |k: usize| (255.0 * (ground[k] + share * (colour[k] - ground[k])) + 0.5) as u8;
        [byte(0), byte(1), byte(2), 255]
    };
    map.cells[..whole].iter().map(mix).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use corpuscle_scene::{Cell, okabe_ito};

    #[test]
    fn strength_leads_from_the_ground_to_the_colour() {
        let cell = |strength| Cell { species: 1, strength };
        let map = Map { columns: 2, cells: vec![cell(0), cell(255), cell(128)], ..Map::default() };
        let colours = colours(&map, Palette::Light);
        let [red, green, blue] = okabe_ito(1);
        assert_eq!(colours, [[255; 4], [red, green, blue, 255]], "the third cell has no whole row");
    }
}
