//! Windows: its OpenGL needs a window, which stays hidden.

use std::num::NonZeroIsize;

use glutin::config::ConfigTemplateBuilder;
use glutin::context::PossiblyCurrentContext;
use glutin::display::{Display, DisplayApiPreference};
use glutin::prelude::*;
use glutin::surface::{Surface, SurfaceAttributesBuilder, WindowSurface};
use raw_window_handle::{RawDisplayHandle, RawWindowHandle, Win32WindowHandle, WindowsDisplayHandle};
use windows_sys::Win32::Foundation::HWND;
use windows_sys::Win32::UI::WindowsAndMessaging::{CreateWindowExW, DestroyWindow, WS_OVERLAPPEDWINDOW};

use super::create_context;
use crate::{RenderError, ShadingLanguage};

/// A context that draws into frame buffers only. Its parts are dropped before the window they live on.
pub(crate) struct Offscreen {
    context: PossiblyCurrentContext,
    surface: Surface<WindowSurface>,
    display: Display,
    _window: Hidden,
}

impl Offscreen {
    /// A context on a window that nobody sees.
    pub(crate) fn new(language: ShadingLanguage) -> Result<Self, RenderError> {
        let explain = |fault: glutin::error::Error| RenderError::Context(fault.to_string());
        let window = Hidden::open()?;
        let handle = window.handle()?;
        let preference = DisplayApiPreference::WglThenEgl(Some(handle));
        let system = RawDisplayHandle::Windows(WindowsDisplayHandle::new());
        // SAFETY: the window outlives the display, the configuration, the surface and the context.
        unsafe {
            let display = Display::new(system, preference).map_err(explain)?;
            let template = ConfigTemplateBuilder::new().compatible_with_native_window(handle).build();
            let config = display.find_configs(template).map_err(explain)?.next();
            let config = config.ok_or_else(|| RenderError::Context("the system offers no OpenGL".into()))?;
            let side = std::num::NonZeroU32::MIN;
            let attributes = SurfaceAttributesBuilder::<WindowSurface>::new().build(handle, side, side);
            let surface = display.create_window_surface(&config, &attributes).map_err(explain)?;
            let context = create_context(&display, &config, language, Some(handle))?.treat_as_possibly_current();
            let this = Self { context, surface, display, _window: window };
            this.make_current()?;
            Ok(this)
        }
    }

    /// Directs OpenGL's calls on this thread to this context.
    pub(crate) fn make_current(&self) -> Result<(), RenderError> {
        self.context.make_current(&self.surface).map_err(|fault| RenderError::Context(fault.to_string()))
    }

    pub(crate) fn display(&self) -> &Display {
        &self.display
    }
}

/// A window of the system's simplest kind, never shown.
struct Hidden(HWND);

impl Hidden {
    fn open() -> Result<Self, RenderError> {
        let class: Vec<u16> = "STATIC\0".encode_utf16().collect();
        let none = std::ptr::null_mut();
        // SAFETY: the class exists on every system, its name ends with a zero, and nothing else is pointed to.
        let window = unsafe {
            CreateWindowExW(
                0,
                class.as_ptr(),
                std::ptr::null(),
                WS_OVERLAPPEDWINDOW,
                0,
                0,
                1,
                1,
                none,
                none,
                none,
                std::ptr::null(),
            )
        };
        if window.is_null() {
            return Err(RenderError::Context(std::io::Error::last_os_error().to_string()));
        }
        Ok(Self(window))
    }

    fn handle(&self) -> Result<RawWindowHandle, RenderError> {
        let number = NonZeroIsize::new(self.0 as isize).ok_or_else(|| RenderError::Context("no window".into()))?;
        Ok(RawWindowHandle::Win32(Win32WindowHandle::new(number)))
    }
}

impl Drop for Hidden {
    fn drop(&mut self) {
        // SAFETY: opened above, on this thread.
        unsafe { DestroyWindow(self.0) };
    }
}
