//! The cases, one a file.

pub(crate) mod brownian;
mod cluster;
mod fluid;
mod gas;
pub(crate) mod grains;
pub(crate) mod gravity;
pub(crate) mod hard_spheres;
pub(crate) mod lennard_jones;
pub(crate) mod membrane;
mod steps;
pub(crate) mod three_body;
pub(crate) mod tree;
pub(crate) mod wca;
