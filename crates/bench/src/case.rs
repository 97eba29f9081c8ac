//! The cases, one a file.

pub(crate) mod brownian;
mod gas;
pub(crate) mod hard_spheres;
