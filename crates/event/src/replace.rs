//! Other particles in the same box.

use corpuscle_core::{Boundary, Invalid, Particles};

use crate::engine::{EventDriven, removals};

impl<const D: usize> EventDriven<D> {
    /// Replaces all particles between two events: some are added, some taken away. The clock and the counts go on, and so does
    /// the piston; paths over periodic faces are counted from here.
    ///
    /// # Errors
    /// When the particles do not fit into the box, or grow; the old ones then stay.
    pub fn set_particles(&mut self, particles: &Particles<D>) -> Result<(), Invalid> {
        if self.pairs.growth().is_some() {
            return Err(Invalid::new("particles", "growing", "particles that have stopped growing"));
        }
        let boundary = Boundary { piston: self.piston(), ..self.boundary.clone() };
        boundary.validate_particles_at(self.time, particles)?;
        let fresh = Self::idle(boundary, particles, self.rules, None)?;
        let next_epoch = fresh.next_epoch + self.counts.collisions + self.counts.edges + self.counts.wall_collisions;
        let (removals, counts, time) = (removals(&fresh.boundary, self.time), self.counts, self.time);
        // Times in flights and plans count from the epoch, which is now.
        *self = Self { epoch: time, time, removals, removed: time, counts, next_epoch, ..fresh };
        self.begin_anew();
        Ok(())
    }
}
