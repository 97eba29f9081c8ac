//! OpenGL drawing of a [`corpuscle_scene::Scene`], in a window or with none.
//!
//! - [`Renderer`] draws into whatever frame buffer is bound: a host with its own window (an egui application) uses it.
//! - [`window::view`] opens a plain window (with the feature `window`).
//! - [`Headless`] draws into memory without a screen, and gives [`Picture`]s; [`Clip`] collects them in a film.
//!
//! One GLSL source serves OpenGL 3.3 and OpenGL ES 3.0. Bodies are moved to the scene's time in the vertex shader.

mod backdrop;
mod canvas;
mod clip;
mod error;
mod gl;
mod headless;
mod layers;
pub mod navigate;
mod overlay;
mod picture;
mod platform;
mod projection;
mod renderer;
mod surface;
mod view;
#[cfg(feature = "window")]
pub mod window;

pub use backdrop::Backdrop;
pub use clip::Clip;
pub use error::RenderError;
pub use gl::Cost;
pub use headless::{Headless, ShadingLanguage};
pub use picture::Picture;
pub use projection::{Projection, Rectangle};
pub use renderer::Renderer;
pub use surface::Surface;
pub use view::View;
