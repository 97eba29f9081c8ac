//! Everything the event-driven engine is held to, in one program: the engine is compiled for it once.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed, and its helpers are tests")]

mod checkpoint;
mod common;
mod differential;
mod golden;
mod growth;
mod invariants;
mod obstacles;
mod order;
mod physics;
mod piston;
mod reference;
mod soak;
mod transport;
mod walls;
mod wells;
