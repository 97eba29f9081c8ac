//! What can go wrong between a scene and its pixels, and what to do about it.

use std::path::PathBuf;

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// A library that is loaded at run time is not installed.
    #[error("{what} is missing: install {package}")]
    Missing {
        /// The library, or the part of it.
        what: String,
        /// The package that brings it.
        package: &'static str,
    },
    /// There is no screen to open a window on.
    #[error("no display: {cause}. Pictures and clips need none (`--screenshot`, `record`)")]
    NoDisplay {
        /// What the window system said.
        cause: String,
    },
    /// The window system or the driver refuses a context or a window.
    #[error("no OpenGL context: {0}")]
    Context(String),
    /// The driver refuses a shader: a fault of this program or of the driver.
    #[error("the driver refuses the shader `{name}`: {log}")]
    Shader {
        /// Name of the program.
        name: &'static str,
        /// The compiler's words.
        log: String,
    },
    /// OpenGL could not make an object.
    #[error("OpenGL: {0}")]
    OpenGl(String),
    /// A picture of this size cannot be drawn.
    #[error("a picture of {width} x {height} pixels cannot be drawn: each side is to be from 1 to {most}")]
    Size {
        /// Width asked for.
        width: u32,
        /// Height asked for.
        height: u32,
        /// Longest side of this driver.
        most: u32,
    },
    /// A clip cannot be written as asked.
    #[error("{path}: {expected}")]
    Clip {
        /// The file or folder.
        path: PathBuf,
        /// What was expected.
        expected: String,
    },
    /// The operating system refuses to write.
    #[error("{path}: {source}")]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// Its words.
        source: std::io::Error,
    },
}

impl RenderError {
    /// There is no driver for OpenGL.
    pub fn no_driver() -> Self {
        Self::Missing { what: "an OpenGL driver".into(), package: "libegl1 and libgl1-mesa-dri (Debian/Ubuntu)" }
    }
}
