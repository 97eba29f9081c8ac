//! Event-driven dynamics of hard particles: exact between collisions, from collision to collision.
//!
//! Spheres (discs in 2-D) of any radius and mass fly freely, or on parabolas in a uniform field, until two of them
//! touch or one touches a wall. There is no time step: the engine computes when the next contact happens, brings
//! the particles concerned there, and changes their velocities. See [`EventDriven`] for how, and why it is right.
//!
//! ```
//! use corpuscle_core::{Boundary, Engine, Particles, Vector};
//! use corpuscle_event::{EventDriven, Rules};
//!
//! // Two discs on a line: they meet after 3 time units and exchange their velocities.
//! let mut discs = Particles::<2>::new();
//! discs.push(Vector([2.0, 5.0]), Vector([1.0, 0.0]), 1.0, 0.5, 0);
//! discs.push(Vector([6.0, 5.0]), Vector([0.0, 0.0]), 1.0, 0.5, 0);
//! let mut gas = EventDriven::new(Boundary::periodic(10.0), discs, Rules::default())?;
//! gas.advance(4.0, &mut ())?;
//! assert_eq!(gas.counts().collisions, 1);
//! assert_eq!(gas.velocity(0).0, [0.0, 0.0]);
//! assert_eq!(gas.position(1).0, [7.0, 5.0]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod access;
mod ahead;
mod calendar;
mod checkpoint;
mod collide;
mod engine;
mod grown;
#[doc(hidden)]
pub mod kernels;
mod lanes;
mod law;
mod motion;
mod neighbours;
mod order;
mod pages;
mod pair;
mod piston;
mod plan;
mod predict;
mod replace;
mod restitution;
mod rules;
mod search;
mod surface;
mod wall;

pub use engine::EventDriven;
pub use grown::grown;
pub use pair::Pair;
pub use restitution::Restitution;
pub use rules::{Counts, Lazy, Rules};
