//! How often particles collide, and how far they fly in between.

use std::ops::ControlFlow;

use corpuscle_core::{Contact, Meeting, Observer, Particles};

use crate::Estimate;
use crate::blocking::blocking;
use crate::time_blocks::TimeBlocks;

/// Collision rate per particle: twice the pairs' collisions over `N t`, since each involves two particles.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct CollisionRate {
    collisions: TimeBlocks,
    particles: f64,
}

impl CollisionRate {
    /// Watches `particles` particles in time blocks of this length, best of some collisions a particle each.
    pub fn new(particles: usize, block: f64) -> Self {
        Self { collisions: TimeBlocks::new(block), particles: particles as f64 }
    }

    /// Collisions a particle suffers per time.
    pub fn rate(&self) -> Estimate {
        blocking(&self.collisions.rates()).estimate * (2.0 / self.particles)
    }

    /// Mean free path: the mean speed over the rate. The mean speed of a gas at temperature `T` is
    /// [`mean_speed`](crate::theory::mean_speed).
    pub fn mean_free_path(&self, mean_speed: f64) -> Estimate {
        Estimate::exact(mean_speed) / self.rate()
    }

    /// Collisions between pairs, counted in the time blocks that are over.
    pub fn collisions(&self) -> f64 {
        self.collisions.total()
    }
}

impl<const D: usize> Observer<D> for CollisionRate {
    fn begin(&mut self, time: f64, _: &Particles<D>) {
        self.collisions.advance(time);
    }

    #[inline]
    fn contact(&mut self, contact: &Contact<D>) -> ControlFlow<()> {
        if let Meeting::Pair(_) = contact.with {
            self.collisions.add(contact.time, 1.0);
        }
        ControlFlow::Continue(())
    }

    fn sample(&mut self, time: f64, _: &Particles<D>) -> ControlFlow<()> {
        self.collisions.advance(time);
        ControlFlow::Continue(())
    }

    fn finish(&mut self, time: f64, _: &Particles<D>) {
        self.collisions.advance(time);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::tests::assert_standard_normal;
    use corpuscle_core::{Party, Random, Vector};

    #[test]
    fn a_poisson_process_gives_its_rate() {
        let party = Party { index: 0, mass: 1.0, position: Vector::<3>::ZERO, before: Vector::ZERO, after: Vector::ZERO };
        let scores: Vec<f64> = (0..400)
            .map(|seed| {
                let mut random = Random::new(seed, 22);
                let mut rate = CollisionRate::new(10, 0.5);
                Observer::<3>::begin(&mut rate, 0.0, &Particles::new());
                let mut time = 0.0;
                while time < 200.0 {
                    let with = Meeting::Pair(party);
                    let contact = Contact { time, first: party, with, normal: Vector::unit(0), impulse: 1.0, distance: 1.0 };
                    if time > 0.0 {
                        let _ = rate.contact(&contact);
                    }
                    time -= libm::log(random.uniform()) / 15.0;
                }
                Observer::<3>::finish(&mut rate, 200.0, &Particles::new());
                assert_eq!(rate.mean_free_path(6.0).mean, 6.0 / rate.rate().mean);
                rate.rate().score(3.0)
            })
            .collect();
        assert_standard_normal("collision rate", &scores);
    }
}
