//! The experiments themselves, one file each.

pub(crate) mod brownian;
pub(crate) mod entropy;
pub(crate) mod ideal_gas;
pub(crate) mod three_body;
pub(crate) mod wave;
