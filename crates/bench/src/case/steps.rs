//! What the cases on the time-driven engine share: taking steps by the clock.

use corpuscle_core::{Engine, Failure};
use corpuscle_time::TimeDriven;

use crate::{Clock, Figure};

/// Steps taken, and the seconds they took.
#[derive(Clone, Copy, Debug)]
pub(super) struct Steps {
    pub(super) count: u64,
    pub(super) seconds: f64,
}

impl Steps {
    pub(super) fn per_second(self) -> f64 {
        self.count as f64 / self.seconds
    }

    /// What every case reports of them.
    pub(super) fn figures(self) -> [Figure; 2] {
        [Figure::new("steps_measured", self.count as f64), Figure::new("seconds_measured", self.seconds)]
    }
}

/// Takes steps of a fixed length, `group` at a time, until `seconds` of the clock have gone, and at least one group. After
/// each group `look` sees the engine, off the clock.
pub(super) fn take<const D: usize>(
    engine: &mut TimeDriven<D>,
    clock: Clock,
    seconds: f64,
    group: u64,
    mut look: impl FnMut(&TimeDriven<D>),
) -> Result<Steps, Failure> {
    let dt = engine.integrator().dt().unwrap_or(f64::INFINITY);
    let before = engine.steps();
    let mut spent = 0.0;
    while spent < seconds {
        let to = (engine.steps() + group) as f64 * dt;
        let running = clock.start();
        engine.advance(to, &mut ())?;
        spent += running.seconds();
        look(engine);
    }
    Ok(Steps { count: engine.steps() - before, seconds: spent })
}
