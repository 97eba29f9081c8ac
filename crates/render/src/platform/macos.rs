//! macOS: a context of its OpenGL framework is current without a surface as well.

use glutin::config::ConfigTemplateBuilder;
use glutin::context::PossiblyCurrentContext;
use glutin::display::{Display, DisplayApiPreference};
use glutin::prelude::*;
use raw_window_handle::{AppKitDisplayHandle, RawDisplayHandle};

use super::create_context;
use crate::{RenderError, ShadingLanguage};

/// A context that draws into frame buffers only.
pub(crate) struct Offscreen {
    context: PossiblyCurrentContext,
    display: Display,
}

impl Offscreen {
    /// A context of the system's OpenGL; it knows no OpenGL ES.
    pub(crate) fn new(language: ShadingLanguage) -> Result<Self, RenderError> {
        let explain = |fault: glutin::error::Error| RenderError::Context(fault.to_string());
        let handle = RawDisplayHandle::AppKit(AppKitDisplayHandle::new());
        // SAFETY: the handle of this system carries no pointer.
        let display = unsafe { Display::new(handle, DisplayApiPreference::Cgl) }.map_err(explain)?;
        // SAFETY: the template names no window.
        let config = unsafe { display.find_configs(ConfigTemplateBuilder::new().build()) }.map_err(explain)?.next();
        let config = config.ok_or_else(|| RenderError::Context("the system offers no OpenGL".into()))?;
        let context = create_context(&display, &config, language, None)?.treat_as_possibly_current();
        let this = Self { context, display };
        this.make_current()?;
        Ok(this)
    }

    /// Directs OpenGL's calls on this thread to this context.
    pub(crate) fn make_current(&self) -> Result<(), RenderError> {
        let PossiblyCurrentContext::Cgl(context) = &self.context;
        context.make_current_surfaceless().map_err(|fault| RenderError::Context(fault.to_string()))
    }

    pub(crate) fn display(&self) -> &Display {
        &self.display
    }
}
