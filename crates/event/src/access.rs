//! Looking at the particles without touching them.

use corpuscle_core::{Axis, Boundary, Vector};

use crate::engine::{Body, EventDriven};
use crate::motion::Flight;
use crate::plan::Plan;
use crate::{Counts, Lazy, Rules};

impl<const D: usize> EventDriven<D> {
    /// The box.
    pub fn boundary(&self) -> &Boundary<D> {
        &self.boundary
    }

    /// The law of contact and the field.
    pub fn rules(&self) -> &Rules<D> {
        &self.rules
    }

    /// Number of particles.
    pub fn particle_count(&self) -> usize {
        self.flights.len()
    }

    /// What has been done since the start.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Particle `i` at its own time: all a renderer needs to draw it at any time before its next event.
    pub fn lazy(&self, i: usize) -> Lazy<D> {
        let flight = &self.flights[self.slots[i] as usize];
        Lazy { position: flight.position, velocity: flight.velocity, time: self.epoch + flight.time }
    }

    /// Radius of particle `i`.
    pub fn radius(&self, i: usize) -> f64 {
        self.flights[self.slots[i] as usize].radius
    }

    /// Species of particle `i`.
    pub fn species(&self, i: usize) -> u16 {
        self.bodies[self.slots[i] as usize].species
    }

    /// Mass of particle `i`.
    pub fn mass(&self, i: usize) -> f64 {
        self.plans[self.slots[i] as usize].mass
    }

    /// Bytes held in all, for everything that grows with the number of particles.
    pub fn memory(&self) -> usize {
        self.flights.capacity() * size_of::<Flight<D>>()
            + self.plans.capacity() * size_of::<Plan>()
            + self.bodies.capacity() * size_of::<Body<D>>()
            + (self.met.capacity() + self.slots.capacity()) * size_of::<u32>()
            + self.calendar.memory()
            + self.pairs.bonds.memory()
            + self.neighbours.memory()
    }

    /// Position of particle `i` now, in the primary box.
    pub fn position(&self, i: usize) -> Vector<D> {
        self.boundary.wrap(self.flights[self.slots[i] as usize].position_at(self.now, self.rules.field))
    }

    /// Velocity of particle `i` now.
    pub fn velocity(&self, i: usize) -> Vector<D> {
        self.flights[self.slots[i] as usize].velocity_at(self.now, self.rules.field)
    }

    /// How often particle `i` went around the box upwards, less how often downwards, along each periodic axis, until
    /// its own last event.
    pub fn images(&self, i: usize) -> [i32; D] {
        self.bodies[self.slots[i] as usize].images
    }

    /// Position of particle `i` now, counted on over periodic faces: what a mean squared displacement needs.
    pub fn unwrapped(&self, i: usize) -> Vector<D> {
        let side = self.boundary.extent();
        let slot = self.slots[i] as usize;
        let images = self.bodies[slot].images;
        let travelled =
            Vector::from_fn(|k| if self.boundary.axes[k] == Axis::Periodic { f64::from(images[k]) * side[k] } else { 0.0 });
        self.flights[slot].position_at(self.now, self.rules.field) + travelled
    }

    /// Total kinetic energy `sum m v^2 / 2` now.
    pub fn kinetic_energy(&self) -> f64 {
        let energy = |i: usize| 0.5 * self.mass(i) * self.velocity(i).norm_squared();
        (0..self.flights.len()).map(energy).sum()
    }

    /// Potential energy now: `-sum m g.r` in the uniform field, zero where the coordinates are zero, and `-depth` for each
    /// pair in its well.
    ///
    /// Along a periodic axis a particle that falls around the box has fallen all the way.
    pub fn potential_energy(&self) -> f64 {
        let energy = |i: usize| -self.mass(i) * self.rules.field.dot(self.unwrapped(i));
        (0..self.flights.len()).map(energy).sum::<f64>() + self.pairs.energy()
    }

    /// Total momentum `sum m v` now.
    pub fn momentum(&self) -> Vector<D> {
        (0..self.flights.len()).fold(Vector::ZERO, |sum, i| sum + self.velocity(i) * self.mass(i))
    }
}
