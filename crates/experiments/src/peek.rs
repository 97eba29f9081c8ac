//! A look ahead that does not disturb.

use std::ops::ControlFlow;

use corpuscle_core::{Contact, Engine, Observer};
use corpuscle_event::EventDriven;

/// Stops at the first contact and keeps its time.
struct First(Option<f64>);

impl<const D: usize> Observer<D> for First {
    fn contact(&mut self, contact: &Contact<D>) -> ControlFlow<()> {
        self.0 = Some(contact.time);
        ControlFlow::Break(())
    }
}

/// Time of the next collision on the engine's clock, found on a copy; none when there is none within `horizon`.
pub(crate) fn next_contact<const D: usize>(engine: &EventDriven<D>, horizon: f64) -> Option<f64> {
    let mut ahead = engine.clone();
    let mut first = First(None);
    let end = ahead.time() + horizon;
    // A copy that breaks down has no next collision to tell of; the engine itself will say why.
    ahead.advance(end, &mut first).ok()?;
    first.0
}
