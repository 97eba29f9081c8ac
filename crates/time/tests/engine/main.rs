//! Everything the time-driven engine is held to, in one program: the engine is compiled for it once.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed, and its helpers are tests")]

mod checkpoint;
mod common;
mod engine;
mod few_body;
mod golden;
mod hard_limit;
mod heat_bath;
mod lammps;
mod lennard_jones;
mod many_body;
mod orders;
mod planets;
mod polymers;
mod pressure_tensor;
mod soak;
mod springs;
