//! Files: what a run is read from and what it leaves behind. One format a file.
//!
//! [`Scenario`] says what to run, [`Record`] what came of it; the other modules write a record down.

pub mod checkpoint;
mod columns;
pub mod csv;
mod dump;
mod gsd;
pub mod number;
pub mod record;
pub mod refusal;
pub mod report;
pub mod scenario;
pub mod schema;
pub mod summary;
pub mod trajectory;
pub mod write;
mod xyz;

pub use checkpoint::{Checkpoint, CheckpointError, Checkpoints};
pub use record::{Ending, Picture, Record};
pub use refusal::{Origin, Place, Refusal};
pub use scenario::{Registry, Scenario};
pub use trajectory::Trajectory;
pub use write::{Folder, WriteError};

/// The version of the program, written into everything it leaves behind.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

#[cfg(test)]
mod example;
