//! Observables with standard errors, and the charts and checks made of them, all as plain data.
//!
//! One observable a file. Each is an [`Observer`](corpuscle_core::Observer) or is fed by one; none knows an engine,
//! a picture or a file.

pub mod chart;
pub mod check;

pub use chart::{Chart, Scale, Series, Style};
pub use check::{Check, Verdict};
