//! What an engine is, and how it says that something is wrong.

use crate::{Observer, Particles};

/// Dynamics that can be advanced to a time.
///
/// Where and how often a caller stops has no influence on the trajectory: `advance(1.0)` and a hundred advances by
/// 0.01 leave the same bits. Reading the particles has none either.
pub trait Engine<const D: usize> {
    /// Physical time reached.
    fn time(&self) -> f64;

    /// Advances to the physical time `to` and reports what happens to `observer`, which may stop the run early.
    ///
    /// # Errors
    /// [`Failure`] when the dynamics breaks down; the state is then the last good one.
    fn advance<O: Observer<D>>(&mut self, to: f64, observer: &mut O) -> Result<(), Failure>;

    /// Copies every particle as it is at [`time`](Engine::time) into `particles`, reusing its memory.
    fn snapshot_into(&self, particles: &mut Particles<D>);

    /// Every particle as it is at [`time`](Engine::time).
    fn snapshot(&self) -> Particles<D> {
        let mut particles = Particles::new();
        self.snapshot_into(&mut particles);
        particles
    }
}

/// A value that cannot be used, said so that a person can mend it.
///
/// ```
/// use corpuscle_core::Invalid;
/// let error = Invalid::new("radius", -1.0, "a positive number");
/// assert_eq!(error.to_string(), "radius = -1: expected a positive number");
/// ```
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{key} = {value}: expected {expected}")]
pub struct Invalid {
    /// The name of what is wrong, as the user wrote it.
    pub key: String,
    /// The value found.
    pub value: String,
    /// What would have been accepted.
    pub expected: String,
}

/// Digits a number is quoted with, beyond which it is written with its power of ten.
const LONGEST_NUMBER: usize = 30;

impl Invalid {
    /// `key` was `value`, but `expected` was needed.
    #[allow(clippy::needless_pass_by_value)] // numbers are passed as they are, at a dozen places
    pub fn new(key: impl Into<String>, value: impl ToString, expected: impl Into<String>) -> Self {
        let value = value.to_string();
        // Rust writes all three hundred digits of a large number.
        let value = match value.parse::<f64>() {
            Ok(number) if value.len() > LONGEST_NUMBER => format!("{number:?}"),
            _ => value,
        };
        Self { key: key.into(), value, expected: expected.into() }
    }
}

/// A run that cannot go on: which particle, when and why.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("at t = {time:?}{}: {cause}", .particle.map(|i| format!(", particle {i}")).unwrap_or_default())]
pub struct Failure {
    /// Physical time of the failure.
    pub time: f64,
    /// The particle it was noticed at, where there is one.
    pub particle: Option<usize>,
    /// What went wrong and what may help.
    pub cause: String,
}
