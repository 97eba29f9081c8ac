//! A start taken from a trajectory.

use corpuscle_core::Particles;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Particles of a frame of a trajectory, as a start: places, velocities, masses, radii and names.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Start {
    /// Extended XYZ (.xyz, .extxyz) or LAMMPS dump (.dump, .lammpstrj), in the folder of the scenario file or below it.
    pub file: String,
    /// Number of the frame, from 0; the last whole one when not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame: Option<u64>,
    /// Radius of all, in place of the file's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
    /// Mass of all, in place of the file's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mass: Option<f64>,
    /// Temperature `k_B T` of velocities drawn anew, in place of the file's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub temperature: Option<f64>,
    /// BLAKE3 sum of the file, in hexadecimal digits: with it, no other file is taken.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub blake3: Option<String>,
}

/// The particles themselves, read from the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Imported {
    /// As they are in the file, in three coordinates; a plane has `z = 0`.
    pub particles: Particles<3>,
    /// Names of the species, in the order of their indices.
    pub names: Vec<String>,
}
