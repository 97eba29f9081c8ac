//! OpenGL contexts for windows, and the libraries that windows need.

use std::num::NonZeroU32;
use std::sync::Arc;

use glutin::config::{Api, Config, ConfigTemplateBuilder};
use glutin::context::PossiblyCurrentContext;
use glutin::display::{Display, DisplayApiPreference};
use glutin::prelude::*;
use glutin::surface::{Surface, SwapInterval, WindowSurface};
use glutin_winit::GlWindow;
use raw_window_handle::{HasDisplayHandle, HasWindowHandle, RawWindowHandle};
use winit::event_loop::ActiveEventLoop;
use winit::window::{Window, WindowAttributes};

use super::{create_context, load};
use crate::{RenderError, ShadingLanguage};

/// The context and the surface of a window.
pub(crate) struct WindowContext {
    surface: Surface<WindowSurface>,
    context: PossiblyCurrentContext,
    display: Display,
    size: [u32; 2],
}

impl WindowContext {
    /// Opens a window and makes its context current: OpenGL 3.3, or OpenGL ES 3.0 where there is none.
    pub(crate) fn open(events: &ActiveEventLoop, attributes: WindowAttributes) -> Result<(Window, Self), RenderError> {
        let (window, display, config) = window_and_config(events, attributes)?;
        let handle = window.window_handle().map_err(|fault| refused(&fault))?.as_raw();
        let create = |language| create_context(&display, &config, language, Some(handle));
        let context = create(ShadingLanguage::Desktop).or_else(|desktop| create(ShadingLanguage::Embedded).map_err(|_| desktop))?;
        let surface_attributes =
            window.build_surface_attributes(glutin::surface::SurfaceAttributesBuilder::new()).map_err(|fault| refused(&fault))?;
        // SAFETY: the caller keeps the window for as long as the surface.
        let surface = unsafe { display.create_window_surface(&config, &surface_attributes) }.map_err(|fault| refused(&fault))?;
        let context = context.make_current(&surface).map_err(|fault| refused(&fault))?;
        // The screen's own pace, where it has one; otherwise the window keeps its own.
        let _ = surface.set_swap_interval(&context, SwapInterval::Wait(NonZeroU32::MIN));
        Ok((window, Self { surface, context, display, size: [0, 0] }))
    }

    pub(crate) fn load(&self) -> Arc<glow::Context> {
        load(&self.display)
    }

    /// Follows the window's size.
    pub(crate) fn resize(&mut self, size: [u32; 2]) {
        if size != self.size
            && let [Some(width), Some(height)] = size.map(NonZeroU32::new)
        {
            self.surface.resize(&self.context, width, height);
            self.size = size;
        }
    }

    /// Puts the picture on the screen.
    pub(crate) fn swap(&self) -> Result<(), RenderError> {
        self.surface.swap_buffers(&self.context).map_err(|fault| refused(&fault))
    }
}

/// On Windows the display comes from a window; elsewhere the window's pixels follow from the display's configuration.
fn window_and_config(events: &ActiveEventLoop, attributes: WindowAttributes) -> Result<(Window, Display, Config), RenderError> {
    if cfg!(windows) {
        let window = events.create_window(attributes).map_err(|fault| refused(&fault))?;
        let handle = window.window_handle().map_err(|fault| refused(&fault))?.as_raw();
        let (display, config) = display_and_config(events, Some(handle))?;
        Ok((window, display, config))
    } else {
        let (display, config) = display_and_config(events, None)?;
        let window = glutin_winit::finalize_window(events, attributes, &config).map_err(|fault| refused(&fault))?;
        Ok((window, display, config))
    }
}

fn display_and_config(events: &ActiveEventLoop, window: Option<RawWindowHandle>) -> Result<(Display, Config), RenderError> {
    let handle = events.display_handle().map_err(|fault| refused(&fault))?.as_raw();
    // SAFETY: the event loop keeps its display, and the caller the window.
    let display = unsafe { Display::new(handle, preference(window)) }.map_err(|fault| explain(&fault))?;
    let template = |api| {
        let builder = ConfigTemplateBuilder::new().with_api(api).with_alpha_size(0);
        window.into_iter().fold(builder, ConfigTemplateBuilder::compatible_with_native_window).build()
    };
    // SAFETY: as above.
    let find = |api| unsafe { display.find_configs(template(api)) }.ok().and_then(|mut configs| configs.next());
    match find(Api::OPENGL).or_else(|| find(Api::GLES3)) {
        Some(config) => Ok((display, config)),
        None => Err(explain_missing()),
    }
}

#[cfg(windows)]
fn preference(window: Option<RawWindowHandle>) -> DisplayApiPreference {
    DisplayApiPreference::WglThenEgl(window)
}

#[cfg(target_os = "macos")]
fn preference(_: Option<RawWindowHandle>) -> DisplayApiPreference {
    DisplayApiPreference::Cgl
}

#[cfg(not(any(windows, target_os = "macos")))]
fn preference(_: Option<RawWindowHandle>) -> DisplayApiPreference {
    DisplayApiPreference::EglThenGlx(Box::new(winit::platform::x11::register_xlib_error_hook))
}

fn refused(fault: &dyn std::fmt::Display) -> RenderError {
    RenderError::Context(fault.to_string())
}

fn explain_missing() -> RenderError {
    RenderError::no_driver()
}

fn explain(fault: &glutin::error::Error) -> RenderError {
    use glutin::error::ErrorKind::{InitializationFailed, NotFound};
    match fault.error_kind() {
        NotFound | InitializationFailed => explain_missing(),
        _ => refused(fault),
    }
}

/// Libraries that the window system is loaded from, with their packages; winit panics without some of them.
#[cfg(not(any(windows, target_os = "macos")))]
pub(crate) fn check_libraries() -> Result<(), RenderError> {
    const WAYLAND: &[(&str, &str)] = &[("libwayland-client.so.0", "libwayland-client0"), ("libxkbcommon.so.0", "libxkbcommon0")];
    const X11: &[(&str, &str)] = &[
        ("libX11.so.6", "libx11-6"),
        ("libX11-xcb.so.1", "libx11-xcb1"),
        ("libXcursor.so.1", "libxcursor1"),
        ("libXi.so.6", "libxi6"),
        ("libxkbcommon.so.0", "libxkbcommon0"),
        ("libxkbcommon-x11.so.0", "libxkbcommon-x11-0"),
    ];
    let set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let needed = if set("WAYLAND_DISPLAY") || set("WAYLAND_SOCKET") {
        WAYLAND
    } else if set("DISPLAY") {
        X11
    } else {
        let cause = "neither WAYLAND_DISPLAY nor DISPLAY is set".into();
        return Err(RenderError::NoDisplay { cause });
    };
    for (library, package) in needed {
        // SAFETY: these are the window system's own libraries, which are loaded next in any case.
        if unsafe { libloading::Library::new(library) }.is_err() {
            return Err(RenderError::Missing { what: (*library).into(), package });
        }
    }
    Ok(())
}

/// The window system is part of the operating system here.
#[cfg(any(windows, target_os = "macos"))]
pub(crate) fn check_libraries() -> Result<(), RenderError> {
    Ok(())
}
