//! The start of a free system from a trajectory.

use std::fs::File;
use std::path::{Component, Path};

use corpuscle_core::{Invalid, Particles, Vector};
use corpuscle_experiments::Frame;
use corpuscle_experiments::free::System;
use corpuscle_experiments::free::spec::{Imported, Start};

use crate::trajectory::{self, ReadError, START, Snapshot};
use crate::xyz;

/// Reads the particles that a scenario in `folder` starts from.
///
/// # Errors
/// [`Invalid`] with the key that is wrong.
pub(super) fn load(start: &Start, folder: &Path) -> Result<Imported, Invalid> {
    let path = Path::new(&start.file);
    let below = path.components().all(|component| matches!(component, Component::Normal(_)));
    if !below || start.file.is_empty() || start.file.contains(['\\', ':']) {
        return Err(Invalid::new("start.file", &start.file, "a file in the folder of the scenario, or below it"));
    }
    let refuse = |error: ReadError| match error {
        ReadError::TooShort(frames) if start.frame.is_some() => {
            Invalid::new("start.frame", start.frame.unwrap_or_default(), format!("one of the {frames} whole frames, from 0"))
        }
        error => Invalid::new("start.file", format!("{}: {error}", start.file), "a trajectory that can be read"),
    };
    let path = folder.join(path);
    let snapshot = trajectory::read(&path, start.frame).map_err(refuse)?;
    if let Some(wanted) = &start.blake3 {
        let mut hasher = blake3::Hasher::new();
        let found = File::open(&path).and_then(|file| hasher.update_reader(file).map(|hasher| hasher.finalize().to_string()));
        let found = found.map_err(|error| refuse(error.into()))?;
        if found != *wanted {
            return Err(Invalid::new("start.blake3", wanted, format!("the sum of {}, which is {found}", start.file)));
        }
    }
    complete(start, snapshot)
}

/// The particles with all they need, from the file or else from the keys.
fn complete(start: &Start, snapshot: Snapshot) -> Result<Imported, Invalid> {
    let Snapshot { position, velocity, mass, radius, species, names, .. } = snapshot;
    let count = position.len();
    let all = |key: &str, given: Option<f64>, read: Option<Vec<f64>>| match (given, read) {
        (Some(value), _) if value >= 0.0 && value.is_finite() => Ok(vec![value; count]),
        (Some(value), _) => Err(Invalid::new(format!("start.{key}"), value, "a number, zero or more")),
        (None, Some(values)) => Ok(values),
        (None, None) => Err(Invalid::new(format!("start.{key}"), "missing", format!("a number: {} has none", start.file))),
    };
    let velocity = match (velocity, start.temperature) {
        (Some(velocity), _) => velocity,
        (None, Some(_)) => vec![Vector::ZERO; count],
        (None, None) => {
            let expected = format!("a number, 0 for a start at rest: {} has no velocities", start.file);
            return Err(Invalid::new("start.temperature", "missing", expected));
        }
    };
    let (mass, radius) = (all("mass", start.mass, mass)?, all("radius", start.radius, radius)?);
    Ok(Imported { particles: Particles { position, velocity, mass, radius, species }, names })
}

/// The start of a system as a file of its own, and the keys that go with it.
pub(super) fn pack(system: &System) -> Option<(Start, Vec<u8>)> {
    let (start, imported) = (system.start.as_ref()?, system.imported.as_ref()?);
    let corner = |corner: &[f64], missing: f64| std::array::from_fn(|k| corner.get(k).copied().unwrap_or(missing));
    let frame = Frame {
        time: 0.0,
        dimension: system.room.lower.len(),
        lower: corner(&system.room.lower, -0.5),
        upper: corner(&system.room.upper, 0.5),
        periodic: [false; 3],
        names: imported.names.clone(),
        particles: imported.particles.clone(),
    };
    let bytes = xyz::frame(&frame).into_bytes();
    let sum = blake3::hash(&bytes).to_string();
    let keys =
        Start { file: START.into(), frame: None, radius: None, mass: None, temperature: start.temperature, blake3: Some(sum) };
    Some((keys, bytes))
}
