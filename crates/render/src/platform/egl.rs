//! Linux and its kin: EGL devices need neither a window system nor a screen.

use glutin::api::egl::device::Device;
use glutin::config::{Api, ConfigSurfaceTypes, ConfigTemplateBuilder};
use glutin::context::PossiblyCurrentContext;
use glutin::display::Display;
use glutin::error::{Error, ErrorKind};
use glutin::prelude::*;

use super::create_context;
use crate::{RenderError, ShadingLanguage};

/// A context that draws into frame buffers only.
pub(crate) struct Offscreen {
    context: PossiblyCurrentContext,
    display: Display,
}

impl Offscreen {
    /// A context on the first device that gives one: a graphics card, or Mesa's software renderer.
    pub(crate) fn new(language: ShadingLanguage) -> Result<Self, RenderError> {
        let devices = Device::query_devices().map_err(|fault| explain(&fault))?;
        let mut refusal = RenderError::Missing { what: "an OpenGL driver".into(), package: DRIVER };
        for device in devices {
            match Self::on(&device, language) {
                Ok(offscreen) => return Ok(offscreen),
                Err(fault) => refusal = fault,
            }
        }
        Err(refusal)
    }

    fn on(device: &Device, language: ShadingLanguage) -> Result<Self, RenderError> {
        // SAFETY: no raw display is passed on.
        let display = unsafe { glutin::api::egl::display::Display::with_device(device, None) };
        let display = Display::Egl(display.map_err(|fault| explain(&fault))?);
        let api = match language {
            ShadingLanguage::Desktop => Api::OPENGL,
            ShadingLanguage::Embedded => Api::GLES3,
        };
        let template = ConfigTemplateBuilder::new().with_surface_type(ConfigSurfaceTypes::empty()).with_api(api).build();
        // SAFETY: the template names no window.
        let config = unsafe { display.find_configs(template) }.map_err(|fault| explain(&fault))?.next();
        let config = config.ok_or_else(|| RenderError::Context("the device offers no OpenGL".into()))?;
        let context = create_context(&display, &config, language, None)?.treat_as_possibly_current();
        let this = Self { context, display };
        this.make_current()?;
        Ok(this)
    }

    /// Directs OpenGL's calls on this thread to this context.
    #[allow(
        unreachable_patterns,
        clippy::match_wildcard_for_single_variants,
        reason = "which other kinds exist depends on the features that glutin is built with"
    )]
    pub(crate) fn make_current(&self) -> Result<(), RenderError> {
        match &self.context {
            PossiblyCurrentContext::Egl(context) => context.make_current_surfaceless().map_err(|fault| explain(&fault)),
            _ => Err(RenderError::Context("a device gave a context of another kind".into())),
        }
    }

    pub(crate) fn display(&self) -> &Display {
        &self.display
    }
}

const LIBRARY: &str = "libegl1 and libgl1-mesa-dri (Debian/Ubuntu)";
const DRIVER: &str = "libgl1-mesa-dri (Debian/Ubuntu)";

/// EGL's terse words, with the package that helps.
fn explain(fault: &Error) -> RenderError {
    match fault.error_kind() {
        ErrorKind::NotFound => RenderError::Missing { what: "libEGL".into(), package: LIBRARY },
        ErrorKind::InitializationFailed => RenderError::Missing { what: "an OpenGL driver".into(), package: DRIVER },
        _ => RenderError::Context(fault.to_string()),
    }
}
