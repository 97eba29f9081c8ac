//! How often each particle has collided.

use std::ops::ControlFlow;

use corpuscle_core::{Contact, Meeting, Observer};

/// Contacts of each particle with another one, of the system on show; of a system without a tally nothing is counted.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tally(Vec<u32>);

impl Tally {
    /// A tally of so many particles.
    pub(crate) fn of(count: usize) -> Self {
        Self(vec![0; count])
    }

    /// Whether nothing is counted.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Collisions of a particle since the tally began.
    pub(crate) fn count(&self, particle: usize) -> u32 {
        self.0.get(particle).copied().unwrap_or(0)
    }
}

impl<const D: usize> Observer<D> for Tally {
    #[inline]
    fn contact(&mut self, contact: &Contact<D>) -> ControlFlow<()> {
        if let Meeting::Pair(second) = contact.with {
            for party in [contact.first, second] {
                if let Some(count) = self.0.get_mut(party.index) {
                    *count += 1;
                }
            }
        }
        ControlFlow::Continue(())
    }
}
