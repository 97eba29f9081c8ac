//! The laboratory's window: a stage drawn by OpenGL, live charts with theory beside measurement, parameters, a notebook.
//!
//! - [`Runner`] drives an experiment on a thread of its own: orders go in, [`Snapshot`]s come out.
//! - [`Model`] is the window's state, pure data that keys and panels change; [`ui`] draws it, and knows no OpenGL.
//! - [`open`] puts both into a window; [`Studio`] draws the same panels without one.

pub mod command;
pub mod film;
pub mod language;
pub mod model;
pub mod notebook;
mod number;
mod painter;
pub mod preferences;
pub mod presets;
pub mod previews;
pub mod rivals;
pub mod runner;
mod studio;
pub mod theme;
pub mod tools;
pub mod ui;
mod window;

pub use model::Model;
pub use preferences::Preferences;
pub use runner::{Order, Runner, Snapshot};
pub use studio::{Studio, StudioView};
pub use window::{LabError, Options, open};
