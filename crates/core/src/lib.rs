//! What both engines share: vectors, particles, boundaries, observers and reproducible random numbers.
//!
//! This crate does no input or output, starts no thread and knows no picture. Units are reduced: mass, length and
//! `k_B T` set the scale, so a temperature is an energy and a pressure is an energy per volume.

pub mod array;
pub mod boundary;
pub mod engine;
pub mod instructions;
pub mod observer;
pub mod particles;
pub mod placement;
pub mod polynomial;
pub mod rng;
pub mod vector;

pub use boundary::{Axis, Boundary, Face, Hole, Motion, Obstacle, Partition, Piston};
pub use engine::{Engine, Failure, Invalid};
pub use instructions::Instructions;
pub use observer::{Contact, Meeting, Observer, Party};
pub use particles::Particles;
pub use rng::Random;
pub use vector::Vector;
