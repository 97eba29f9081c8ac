//! OpenGL drawing of a [`corpuscle_scene::Scene`], in a window or with none.
//!
//! - [`Renderer`] draws into whatever frame buffer is bound: a host with its own window (an egui application) uses it.
//! - [`Headless`] draws into memory without a screen, and gives [`Picture`]s.
//!
//! One GLSL source serves OpenGL 3.3 and OpenGL ES 3.0. Bodies are moved to the scene's time in the vertex shader.

mod canvas;
mod clip;
mod error;
mod gl;
mod headless;
mod layers;
mod overlay;
mod picture;
mod platform;
mod projection;
mod renderer;
mod view;

pub use clip::Clip;
pub use error::RenderError;
pub use headless::{Headless, ShadingLanguage};
pub use picture::Picture;
pub use projection::{Projection, Rectangle};
pub use renderer::Renderer;
pub use view::View;
