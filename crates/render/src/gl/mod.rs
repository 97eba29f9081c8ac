//! OpenGL behind small typed pieces: what is bound, in which order and in which format stays in here, and so does
//! every `unsafe` call. The rest of the crate cannot leave a wrong buffer bound.
//!
//! Soundness of the calls: a piece is made from a context that was current, keeps it alive, and is used on the thread on
//! which the context is current; slices handed to OpenGL outlive the call, which copies them.
#![allow(unsafe_code, reason = "OpenGL is a C interface; these files are the only ones that call it")]

mod buffer;
mod cost;
mod framebuffer;
mod pass;
mod program;
mod screen;
mod texture;

pub(crate) use buffer::{Strip, Vertex, VertexBuffer};
pub use cost::Cost;
pub(crate) use framebuffer::Framebuffer;
pub(crate) use pass::{Pass, Viewport, begin_frame, end_frame, largest_side};
pub(crate) use program::Program;
pub(crate) use screen::Screen;
pub(crate) use texture::{Format, Texture};

/// The functions of one OpenGL context.
pub(crate) type Gl = std::sync::Arc<glow::Context>;
