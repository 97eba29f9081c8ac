//! What differs between operating systems: how to come by an OpenGL context with no window to draw on.
#![allow(unsafe_code, reason = "contexts come from C interfaces, and OpenGL's functions are loaded by name")]

#[cfg_attr(windows, path = "windows.rs")]
#[cfg_attr(target_os = "macos", path = "macos.rs")]
#[cfg_attr(not(any(windows, target_os = "macos")), path = "egl.rs")]
mod offscreen;

#[cfg(feature = "window")]
pub(crate) mod display;

use std::sync::Arc;

use glutin::config::Config;
use glutin::context::{ContextApi, ContextAttributesBuilder, GlProfile, NotCurrentContext, Version};
use glutin::display::Display;
use glutin::prelude::*;
use raw_window_handle::RawWindowHandle;

pub(crate) use offscreen::Offscreen;

use crate::{RenderError, ShadingLanguage};

/// A context of the version that the shaders are written for.
pub(crate) fn create_context(
    display: &Display,
    config: &Config,
    language: ShadingLanguage,
    window: Option<RawWindowHandle>,
) -> Result<NotCurrentContext, RenderError> {
    let api = match language {
        ShadingLanguage::Desktop => ContextApi::OpenGl(Some(Version::new(3, 3))),
        ShadingLanguage::Embedded => ContextApi::Gles(Some(Version::new(3, 0))),
    };
    let attributes = ContextAttributesBuilder::new().with_profile(GlProfile::Core).with_context_api(api).build(window);
    // SAFETY: the window, where there is one, is kept by the caller for as long as the context.
    unsafe { display.create_context(config, &attributes) }.map_err(|fault| RenderError::Context(fault.to_string()))
}

/// OpenGL's functions, loaded through the display of a context that is current.
pub(crate) fn load(display: &Display) -> Arc<glow::Context> {
    // SAFETY: the caller has made a context of this display current, and its functions are those found by name.
    let gl = unsafe { glow::Context::from_loader_function_cstr(|name| display.get_proc_address(name)) };
    #[allow(clippy::arc_with_non_send_sync, reason = "glow and eframe share contexts by Arc")]
    Arc::new(gl)
}
