//! The time-driven engine: soft particles, few bodies and springs, in any dimension from one code.
//!
//! A system is a [`Boundary`](corpuscle_core::Boundary), [`Particles`](corpuscle_core::Particles), a list of [`Force`]s
//! and an [`Integrator`]; [`TimeDriven`] advances it in steps of time. A new force is one file with its acceleration and
//! its energy; a new short-range potential ([`PairPotential`]) gets neighbour lists, vector
//! instructions, threads, the virial and the checks for free.
//!
//! ```
//! use corpuscle_core::{Axis, Boundary, Engine, Particles, Vector};
//! use corpuscle_time::{Gravity, Integrator, TimeDriven};
//!
//! let mut bodies = Particles::<2>::new();
//! bodies.push(Vector([0.0, 0.0]), Vector([0.0, 0.0]), 1.0, 0.0, 0);
//! bodies.push(Vector([1.0, 0.0]), Vector([0.0, 1.0]), 0.0, 0.0, 1); // a massless planet
//! let space = Boundary::new([-2.0; 2], [2.0; 2], Axis::Open);
//! let orbit = Integrator::GaussRadau15 { tolerance: 1e-9, first_step: None };
//! let mut engine = TimeDriven::new(space, bodies, vec![Box::new(Gravity::new(1.0, 0.0))], orbit)?;
//! engine.advance(std::f64::consts::TAU, &mut ())?;
//! assert!((engine.particles().position[1] - Vector([1.0, 0.0])).norm() < 1e-12); // one year later
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

// An axis or a lane indexes several arrays at once; zipped iterators of five arrays read worse.
#![allow(clippy::needless_range_loop)]
// What a kernel calls must end up inside the function that has the instruction set, or it is not compiled for it.
#![allow(clippy::inline_always)]

mod checkpoint;
mod constraint;
mod engine;
mod exact;
pub mod force;
mod image;
mod integrator;
mod lanes;
mod motion;
mod neighbours;
mod strider;
mod system;
mod threads;

pub use constraint::{Drive, Pin, Signal};
pub use engine::TimeDriven;
pub use force::{
    BondLaw, Bonds, BornMayer, CentralField, Coulomb, Drag, DrivingForce, Ewald, FiniteExtension, Force, ForceShifted, Gravity,
    HarmonicRepulsion, InversePower, LennardJones, Morse, PairForce, PairPotential, Spring, Springs, Tensor, Toda, TreeGravity,
    UniformField, WeeksChandlerAndersen, Yukawa,
};
pub use integrator::Integrator;
pub use neighbours::Neighbours;
