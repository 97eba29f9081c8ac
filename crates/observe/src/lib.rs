//! Observables with standard errors, and the charts and checks made of them, all as plain data.
//!
//! One observable a file. Each is an [`Observer`](corpuscle_core::Observer) or is fed by one; none knows an engine,
//! a picture or a file. Whatever ends in a result rests on `libm`, never on the platform's mathematical library.

pub mod blocking;
pub mod chart;
pub mod check;
pub mod collisions;
pub mod distribution;
pub mod drift;
pub mod estimate;
pub mod fit;
pub mod pressure;
pub mod schedule;
pub mod theory;
mod time_blocks;

pub use blocking::{Blocked, blocking};
pub use chart::{Chart, Scale, Series, Style};
pub use check::{Check, Verdict};
pub use collisions::CollisionRate;
pub use drift::{Conservation, Drift};
pub use estimate::Estimate;
pub use pressure::{VirialPressure, WallPressure};
pub use schedule::Schedule;
