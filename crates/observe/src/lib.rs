//! Observables with standard errors, and the charts and checks made of them, all as plain data.
//!
//! One observable a file. Each is an [`Observer`](corpuscle_core::Observer) or is fed by one; none knows an engine,
//! a picture or a file. Whatever ends in a result rests on `libm`, never on the platform's mathematical library.

pub mod blocking;
pub mod chart;
pub mod check;
pub mod collisions;
mod correlator;
pub mod curves;
pub mod distribution;
pub mod drift;
pub mod entropy;
pub mod estimate;
pub mod fit;
pub mod gate;
pub mod histogram;
pub mod lyapunov;
pub mod modes;
pub mod msd;
pub mod pressure;
pub mod radial_distribution;
pub mod schedule;
pub mod scores;
pub mod spectrum;
pub mod speeds;
pub mod tangent;
pub mod theory;
mod time_blocks;
pub mod unwrap;
pub mod vacf;

pub use blocking::{Blocked, blocking};
pub use chart::{Chart, Scale, Series, Style};
pub use check::{Check, Verdict};
pub use collisions::CollisionRate;
pub use curves::Curves;
pub use drift::{Conservation, Drift};
pub use entropy::Cells;
pub use estimate::Estimate;
pub use gate::Gate;
pub use histogram::{GoodnessOfFit, Histogram};
pub use lyapunov::Separation;
pub use modes::{Ends, NormalModes};
pub use msd::MeanSquaredDisplacement;
pub use pressure::{VirialPressure, WallPressure};
pub use radial_distribution::RadialDistribution;
pub use schedule::Schedule;
pub use speeds::SpeedDistribution;
pub use tangent::Tangent;
pub use unwrap::Unwrap;
pub use vacf::VelocityAutocorrelation;
