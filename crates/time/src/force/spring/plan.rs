//! What a lattice has to know of its particles beside places and velocities.

use super::lattice::Lattice;
use super::masses;
use super::walk::Exception;
use crate::constraint::Held;

/// Found once, for as long as nothing changes but places and velocities.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    /// Particles that are not treated as those beside them. Among them are those that are held along all axes where they are: as they
    /// have no velocity, and are never kicked, drifts leave them there.
    pub(super) exceptions: Vec<Exception>,
    /// What else is held, or driven.
    pub(super) held: Vec<Held>,
    /// The mass of every particle, where all have the same.
    pub(super) mass_of_all: Option<f64>,
}

impl Plan {
    pub(super) fn new<const D: usize>(lattice: &Lattice, mass: &[f64], held: &[Held]) -> Self {
        let (mut still, mut others) = (vec![], vec![]);
        for of_one in held.chunk_by(|one, next| one.particle == next.particle) {
            if (0..D).all(|axis| of_one.iter().any(|held| held.axis == axis)) && !of_one.iter().any(Held::is_driven) {
                still.push(of_one[0].particle);
            } else {
                others.extend_from_slice(of_one);
            }
        }
        Self { exceptions: lattice.exceptions(&still), held: others, mass_of_all: masses::of_all(mass) }
    }
}

#[cfg(test)]
mod tests {
    use corpuscle_core::{Particles, Vector};

    use super::super::Spring;
    use super::*;
    use crate::Signal;

    #[test]
    fn still_is_what_is_held_along_all_axes_and_not_driven() {
        let mut particles = Particles::<2>::new();
        for _ in 0..6 {
            particles.push(Vector([1.0, 2.0]), Vector::ZERO, 1.0, 0.0, 0);
        }
        let springs: Vec<_> = (1..100).map(|i| Spring::new(i - 1, i, 1.0, 0.0)).collect();
        let lattice = Lattice::new(&springs).unwrap();
        let signal = Signal::Pulse { amplitude: 1.5, centre: 2.0, width: 0.7 };
        let held: Vec<_> = [
            (0, 0, None),
            (0, 1, None),
            (1, 0, None),
            (2, 1, None),
            (2, 1, None),
            (3, 0, None),
            (3, 1, Some(signal)),
            (4, 1, None),
            (4, 0, None),
            (4, 0, Some(signal)),
            (5, 1, None),
            (5, 0, None),
        ]
        .map(|(particle, axis, signal)| Held::new(particle, axis, signal, 0.0, &particles).unwrap())
        .into();
        let plan = Plan::new::<2>(&lattice, &[1.0, 2.0], &held);
        let still: Vec<_> = plan.exceptions.iter().map(|exception| exception.particle).collect();
        assert_eq!(still, [0, 5]);
        let others: Vec<_> = plan.held.iter().map(|held| (held.particle, held.axis)).collect();
        assert_eq!(others, [(1, 0), (2, 1), (2, 1), (3, 0), (3, 1), (4, 1), (4, 0), (4, 0)]);
    }

    #[test]
    fn one_mass_in_a_million_is_seen() {
        let mut masses = vec![0.7; 1000];
        assert_eq!(masses::of_all(&masses), Some(0.7));
        masses[999] = 0.7f64.next_up();
        assert_eq!((masses::of_all(&masses), masses::of_all(&[])), (None, None));
    }
}
