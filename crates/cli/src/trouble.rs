//! Why a command ends early, and with which exit code.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use corpuscle_core::Failure;
use corpuscle_io::number::significant;
use corpuscle_io::{Refusal, WriteError};
use corpuscle_lab::LabError;
use corpuscle_render::RenderError;

/// What keeps a command from doing its work.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Trouble {
    /// The input cannot be used.
    #[error(transparent)]
    Refused(#[from] Refusal),
    /// The arguments cannot be understood.
    #[error("on the command line: {0}")]
    Usage(String),
    /// The dynamics broke down.
    #[error(transparent)]
    Failed(#[from] Failure),
    /// Something could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Something could not be written, but a checkpoint is there.
    #[error("{error}{}", to_go_on(*.time, .folder))]
    Lost {
        /// What could not be written.
        error: WriteError,
        /// Physical time of the newest checkpoint.
        time: Option<f64>,
        /// Folder of the run.
        folder: PathBuf,
    },
    /// The run ended before its end.
    #[error("{0}")]
    Stopped(String),
    /// Something went wrong that cannot.
    #[error("{0}")]
    Fault(String),
    /// Something could not be drawn.
    #[error("{}{}", .0, remedy(.0))]
    Render(#[from] RenderError),
    /// Standard output refuses.
    #[error("standard output: {0}")]
    Output(#[from] std::io::Error),
    /// It was stopped by a signal.
    #[error("{0}")]
    Interrupted(String),
}

impl Trouble {
    /// 2 when the user's input is at fault and nothing has been done, 1 otherwise.
    pub(crate) fn exit_code(&self) -> ExitCode {
        match self {
            Self::Refused(_)
            | Self::Usage(_)
            | Self::Write(WriteError::NotEmpty(_) | WriteError::NotAFolder(_) | WriteError::Taken { .. })
            | Self::Render(RenderError::Size { .. } | RenderError::Clip { .. }) => ExitCode::from(2),
            _ => ExitCode::from(1),
        }
    }
}

/// How to go on when something could not be written.
fn to_go_on(time: Option<f64>, folder: &Path) -> String {
    let folder = folder.display();
    time.map_or_else(String::new, |time| {
        format!("; the checkpoint of t = {} is intact: corpuscle resume {folder}", significant(time, 5))
    })
}

/// What may help when the driver gives no context: its own words name no package.
fn remedy(error: &RenderError) -> &'static str {
    match error {
        RenderError::Context(_) if cfg!(target_os = "linux") => ": install libegl1 and libgl1-mesa-dri (Debian/Ubuntu)",
        _ => "",
    }
}

impl From<LabError> for Trouble {
    fn from(error: LabError) -> Self {
        match error {
            LabError::Refused(refusal) => refusal.into(),
            LabError::Render(error) => error.into(),
        }
    }
}
