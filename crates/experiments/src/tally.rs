//! How often each particle has collided.

use std::ops::ControlFlow;

use corpuscle_core::{Contact, Meeting, Observer};

use crate::probe::Region;

/// Contacts of each particle with another one, of the system on show, and what a probe there sees of them; of a system without
/// a tally nothing is counted.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tally {
    counts: Vec<u32>,
    probe: Option<Region>,
}

impl Tally {
    /// A tally of so many particles.
    pub(crate) fn of(count: usize) -> Self {
        Self { counts: vec![0; count], probe: None }
    }

    /// Begins anew with so many particles; a probe stays where it is.
    pub(crate) fn begin_again(&mut self, count: usize) {
        self.counts = vec![0; count];
    }

    /// Lays a probe, or takes it up.
    pub(crate) fn lay(&mut self, probe: Option<Region>) {
        self.probe = probe;
    }

    /// The probe, if one was laid.
    pub(crate) fn probe(&self) -> Option<&Region> {
        self.probe.as_ref()
    }

    /// Whether nothing is counted.
    pub(crate) fn is_empty(&self) -> bool {
        self.counts.is_empty()
    }

    /// Collisions of a particle since the tally began.
    pub(crate) fn count(&self, particle: usize) -> u32 {
        self.counts.get(particle).copied().unwrap_or(0)
    }
}

impl<const D: usize> Observer<D> for Tally {
    #[inline]
    fn contact(&mut self, contact: &Contact<D>) -> ControlFlow<()> {
        if let Meeting::Pair(second) = contact.with {
            for party in [contact.first, second] {
                if let Some(count) = self.counts.get_mut(party.index) {
                    *count += 1;
                }
            }
        }
        if let Some(probe) = &mut self.probe {
            probe.note(contact);
        }
        ControlFlow::Continue(())
    }
}
