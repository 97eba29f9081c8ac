//! A scene drawn into whatever frame buffer is bound.

use std::sync::Arc;

use corpuscle_scene::Scene;

use crate::gl::{Gl, Viewport, begin_frame, end_frame, largest_side};
use crate::layers::{Bodies, Lines, Maps, Regions, Space, Trails};
use crate::overlay::{Layout, Sheet};
use crate::projection::Projection;
use crate::{RenderError, View};

/// Draws scenes with OpenGL 3.3 or OpenGL ES 3.0.
///
/// Keeps in the graphics memory what does not change from picture to picture: bodies that were not touched, the points
/// of trails, letters.
pub struct Renderer {
    gl: Gl,
    bodies: Bodies,
    lines: Lines,
    maps: Maps,
    regions: Regions,
    trails: Trails,
    sheet: Sheet,
    largest_side: u32,
}

impl Renderer {
    /// A renderer for a context that is current on this thread, and stays so in every later call.
    ///
    /// # Errors
    /// [`RenderError::Shader`] or [`RenderError::OpenGl`] when the driver refuses a shader, a buffer or a texture.
    pub fn new(gl: Arc<glow::Context>) -> Result<Self, RenderError> {
        Ok(Self {
            bodies: Bodies::new(&gl)?,
            lines: Lines::new(&gl)?,
            maps: Maps::new(&gl)?,
            regions: Regions::new(&gl)?,
            trails: Trails::new(&gl)?,
            sheet: Sheet::new(&gl)?,
            largest_side: largest_side(&gl),
            gl,
        })
    }

    /// Where the simulation's space appears on a picture: for picking, dragging and labels.
    pub fn projection(&self, scene: &Scene, view: &View) -> Projection {
        let layout = Layout::new(scene, view, &self.sheet.typeface);
        Self::project(scene, view, &layout)
    }

    /// Draws `scene` into the bound frame buffer, over the rectangle that `view` names.
    ///
    /// # Errors
    /// [`RenderError::Size`] when the picture is empty or larger than the driver allows; [`RenderError::OpenGl`] when
    /// the graphics memory is full.
    pub fn draw(&mut self, scene: &Scene, view: &View) -> Result<(), RenderError> {
        self.check_size(view.width, view.height)?;
        self.sheet.begin();
        let layout = Layout::new(scene, view, &self.sheet.typeface);
        let projection = Self::project(scene, view, &layout);
        let space = Space::new(scene, view, projection, view.samples_for(view.camera.unwrap_or(scene.camera)));
        let size = [view.width, view.height];

        begin_frame(&self.gl, Viewport { origin: view.origin, size }, view.palette.ground());
        if projection.is_spatial() {
            // What is transparent comes after what can hide it.
            self.bodies.draw(&self.gl, &space, scene);
        }
        self.maps.draw(&self.gl, &space, scene)?;
        self.regions.draw(&self.gl, &space, scene);
        self.lines.draw(&self.gl, &space, scene);
        self.trails.draw(&self.gl, &space, scene)?;
        if !projection.is_spatial() {
            self.bodies.draw(&self.gl, &space, scene);
        }
        layout.draw(&mut self.sheet, scene, view, &projection);
        self.sheet.draw(&self.gl, size);
        end_frame(&self.gl);
        Ok(())
    }

    fn project(scene: &Scene, view: &View, layout: &Layout) -> Projection {
        let frame = [f64::from(view.width), f64::from(view.height)];
        Projection::new(view.camera.unwrap_or(scene.camera), frame, layout.stage)
    }

    pub(crate) fn check_size(&self, width: u32, height: u32) -> Result<(), RenderError> {
        let most = self.largest_side;
        let fits = |side| (1..=most).contains(&side);
        if fits(width) && fits(height) { Ok(()) } else { Err(RenderError::Size { width, height, most }) }
    }
}
