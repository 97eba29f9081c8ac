//! A system at one instant, its dimension erased: what a frame of a trajectory holds.

use corpuscle_core::{Axis, Boundary, Engine, Particles, Vector};
use corpuscle_event::EventDriven;

/// Thickness of the box of a planar system, whose particles lie in its middle.
const SLAB: f64 = 1.0;

/// All particles at one instant, and the box they are in.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Physical time.
    pub time: f64,
    /// Two of a planar system, three otherwise.
    pub dimension: usize,
    /// Lower corner of the box; a planar system has a box of height 1 around `z = 0`.
    pub lower: [f64; 3],
    /// Upper corner.
    pub upper: [f64; 3],
    /// Which axes are periodic.
    pub periodic: [bool; 3],
    /// Names of the species, in the order of their indices.
    pub names: Vec<String>,
    /// The particles, in the order of their indices; of a planar system with `z = 0`.
    pub particles: Particles<3>,
}

impl Frame {
    /// Takes down particles that are all as of `time`.
    pub fn new<const D: usize>(time: f64, boundary: &Boundary<D>, particles: &Particles<D>, names: &[String]) -> Self {
        let corner = |corner: [f64; D], missing: f64| std::array::from_fn(|k| corner.get(k).copied().unwrap_or(missing));
        let mut erased = Particles::new();
        for i in 0..particles.len() {
            let (r, v) = (particles.position[i].to_three(), particles.velocity[i].to_three());
            erased.push(Vector(r), Vector(v), particles.mass[i], particles.radius[i], particles.species[i]);
        }
        Self {
            time,
            dimension: D,
            lower: corner(boundary.lower.0, -0.5 * SLAB),
            upper: corner(boundary.upper.0, 0.5 * SLAB),
            periodic: std::array::from_fn(|k| boundary.axes.get(k) == Some(&Axis::Periodic)),
            names: names.to_vec(),
            particles: erased,
        }
    }

    /// The particles of an event-driven engine now, with the time counted from `start` on its clock.
    pub(crate) fn of_hard<const D: usize>(engine: &EventDriven<D>, start: f64, names: &[&str]) -> Self {
        let names: Vec<String> = names.iter().map(|&name| name.to_owned()).collect();
        Self::new(engine.time() - start, engine.boundary(), &engine.snapshot(), &names)
    }

    /// The same particles with the species that the experiment knows them by.
    pub(crate) fn with_species(mut self, species: impl Iterator<Item = u16>) -> Self {
        self.particles.species.iter_mut().zip(species).for_each(|(kept, known)| *kept = known);
        self
    }

    /// Name of the species of a particle; `X`, the usual sign for any particle, where it has none.
    pub fn name(&self, particle: usize) -> &str {
        self.names.get(usize::from(self.particles.species[particle])).map_or("X", String::as_str)
    }
}
