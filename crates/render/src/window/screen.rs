//! A window with its OpenGL context.

use corpuscle_scene::Scene;
use winit::dpi::LogicalSize;
use winit::event_loop::ActiveEventLoop;
use winit::window::Window;

use super::Options;
use crate::canvas::Canvas;
use crate::platform::display::WindowContext;
use crate::{Projection, RenderError, View};

/// Drops the canvas first, in its context, and the window last.
pub(super) struct Screen {
    canvas: Canvas,
    context: WindowContext,
    window: Window,
}

impl Screen {
    pub(super) fn open(events: &ActiveEventLoop, options: &Options) -> Result<Self, RenderError> {
        let attributes = Window::default_attributes()
            .with_title(&options.title)
            .with_inner_size(LogicalSize::new(options.width, options.height));
        let (window, context) = WindowContext::open(events, attributes)?;
        Ok(Self { canvas: Canvas::new(context.load())?, context, window })
    }

    /// Width and height in pixels, at least 1.
    pub(super) fn size(&self) -> [u32; 2] {
        let size = self.window.inner_size();
        [size.width.max(1), size.height.max(1)]
    }

    /// Pixels in a point.
    pub(super) fn scale(&self) -> f32 {
        self.window.scale_factor() as f32
    }

    pub(super) fn projection(&self, scene: &Scene, view: &View) -> Projection {
        self.canvas.renderer().projection(scene, view)
    }

    pub(super) fn ask_for_a_picture(&self) {
        self.window.request_redraw();
    }

    pub(super) fn show(&mut self, scene: &Scene, view: &View) -> Result<(), RenderError> {
        self.context.resize([view.width, view.height]);
        self.canvas.draw(scene, view)?.show();
        self.window.pre_present_notify();
        self.context.swap()
    }
}
