//! The energy that walls give.

use std::ops::ControlFlow;

use corpuscle_core::{Contact, Meeting, Observer};

/// Energy that particles got from the faces of the box, warm or moving, so far: the sum of `m (v'^2 - v^2) / 2` over their contacts
/// with them, with the rounding of each addition carried along (Neumaier 1974, doi:10.1002/zamm.19740540106).
///
/// What is left of a system's energy without it is conserved by everything else: elastic collisions, wells, fields and the piston,
/// whose own energy counts.
#[derive(Clone, Copy, Debug, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Given {
    sum: f64,
    rest: f64,
}

impl Given {
    pub(super) fn energy(&self) -> f64 {
        self.sum + self.rest
    }

    fn add(&mut self, energy: f64) {
        let sum = self.sum + energy;
        self.rest += if self.sum.abs() >= energy.abs() { (self.sum - sum) + energy } else { (energy - sum) + self.sum };
        self.sum = sum;
    }
}

impl<const D: usize> Observer<D> for Given {
    fn contact(&mut self, contact: &Contact<D>) -> ControlFlow<()> {
        if let Meeting::Face { .. } = contact.with {
            let party = &contact.first;
            // As a product, which loses no digits where the speed hardly changes.
            self.add(0.5 * party.mass * (party.after - party.before).dot(party.after + party.before));
        }
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_gifts_are_not_lost_beside_large_ones() {
        let mut given = Given::default();
        given.add(1e16);
        (0..1000).for_each(|_| given.add(1.0));
        given.add(-1e16);
        assert_eq!(given.energy(), 1000.0);
    }
}
