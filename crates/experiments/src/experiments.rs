//! The experiments themselves, one file each.

pub(crate) mod atmosphere;
pub(crate) mod billiard;
pub(crate) mod brownian;
pub(crate) mod diffusion;
pub(crate) mod engines;
pub(crate) mod entropy;
pub(crate) mod galton;
pub(crate) mod granular;
pub(crate) mod hard_disk_melting;
pub(crate) mod ideal_gas;
pub(crate) mod lennard_jones;
pub(crate) mod newton_cradle;
pub(crate) mod sound;
pub(crate) mod three_body;
pub(crate) mod wave;
