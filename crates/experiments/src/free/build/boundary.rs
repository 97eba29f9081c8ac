//! The box of a free system, with its walls and what stands or moves in it.

use corpuscle_core::{Axis, Boundary, Face, Hole, Invalid, Motion, Obstacle, Partition, Piston, Vector};

use super::{array, axis};
use crate::free::spec::{self, Cylinder, Faces, Side, System, Wall};

/// The box as the file describes it.
pub(super) fn boundary<const D: usize>(system: &System) -> Result<Boundary<D>, Invalid> {
    let empty = empty(system)?;
    let mut boundary = empty.clone();
    for (index, plate) in system.partitions.iter().enumerate() {
        let key = |field: &str| format!("partition[{index}].{field}");
        let hole = match plate.hole {
            None => None,
            Some(ref hole) => Some(Hole { along: axis::<D>(&key("hole.along"), hole.along)?, from: hole.from, to: hole.to }),
        };
        let whole = Partition::new(axis::<D>(&key("axis"), plate.axis)?, plate.position);
        let partition = Partition { hole, removed_at: plate.removed_at, ..whole };
        Boundary { partitions: vec![partition], ..empty.clone() }.validate().map_err(|error| {
            let field = error.key.strip_prefix("partition ").unwrap_or(&error.key).replace("hole ", "hole.");
            Invalid { key: key(&field), ..error }
        })?;
        boundary.partitions.push(partition);
    }
    for (index, peg) in system.obstacles.iter().enumerate() {
        let key = |field: &str| format!("obstacle[{index}].{field}");
        let obstacle = Obstacle { centre: Vector(array(&key("centre"), &peg.centre)?), radius: peg.radius };
        Boundary { obstacles: vec![obstacle], ..empty.clone() }
            .validate()
            .map_err(|error| Invalid { key: key(error.key.strip_prefix("obstacle ").unwrap_or(&error.key)), ..error })?;
        boundary.obstacles.push(obstacle);
    }
    for (index, wall) in system.walls.iter().enumerate() {
        let (k, side, face) = face(&boundary, index, wall)?;
        boundary.faces[k][side] = face;
    }
    for (index, wall) in system.walls.iter().enumerate() {
        stays_clear(&boundary, index, wall)?;
    }
    if let Some(given) = &system.piston {
        boundary.piston = Some(piston(&boundary, given)?);
        boundary.validate().map_err(|error| {
            let field = error.key.strip_prefix("piston ").unwrap_or(&error.key);
            let field =
                if field == "force and velocity" { if given.force.is_finite() { "velocity" } else { "force" } } else { field };
            Invalid { key: format!("piston.{field}"), ..error }
        })?;
    }
    Ok(boundary)
}

/// The box with nothing in it.
fn empty<const D: usize>(system: &System) -> Result<Boundary<D>, Invalid> {
    let room = &system.room;
    let kind = |face: spec::Face| match face {
        spec::Face::Periodic => Axis::Periodic,
        spec::Face::Walls => Axis::Walls,
        spec::Face::Open => Axis::Open,
    };
    let (lower, upper): ([f64; D], [f64; D]) = (array("box.lower", &room.lower)?, array("box.upper", &room.upper)?);
    // The difference counts, too: it is what may overflow, or vanish beside the corners.
    if (0..D).any(|k| !(upper[k] - lower[k] > 0.0 && (upper[k] - lower[k]).is_finite())) {
        return Err(Invalid::new("box.lower", format!("{lower:?}"), format!("numbers below those of box.upper, {upper:?}")));
    }
    let mut boundary = Boundary::new(lower, upper, Axis::Walls);
    match &room.faces {
        Faces::All(face) => boundary.axes = [kind(*face); D],
        Faces::Each(faces) => {
            let faces: [spec::Face; D] = faces
                .clone()
                .try_into()
                .map_err(|_| Invalid::new("box.faces", format!("{} words", faces.len()), format!("one word, or {D}")))?;
            boundary.axes = faces.map(kind);
        }
    }
    Ok(boundary)
}

/// What a wall does, across which axis and on which side.
fn face<const D: usize>(boundary: &Boundary<D>, index: usize, wall: &Wall) -> Result<(usize, usize, Face), Invalid> {
    let key = |field: &str| format!("face[{index}].{field}");
    let (k, side) = (axis::<D>(&key("axis"), wall.axis)?, usize::from(wall.side == Side::Upper));
    if boundary.axes[k] != Axis::Walls {
        return Err(Invalid::new(key("axis"), wall.axis.letter(), "an axis across which box.faces has walls"));
    }
    if boundary.faces[k][side] != Face::default() {
        return Err(Invalid::new(key("side"), wall.side.word(), "a wall that no [[face]] before this one describes"));
    }
    let motion = match (&wall.path, &wall.oscillation) {
        (None, None) => None,
        (Some(path), None) => Some(Motion::Path(path.iter().map(|&[time, place]| (time, place)).collect())),
        (None, Some(swing)) => Some(Motion::Oscillation {
            centre: swing.centre,
            amplitude: swing.amplitude,
            angular_frequency: swing.angular_frequency,
            phase: swing.phase,
        }),
        (Some(_), Some(_)) => return Err(Invalid::new(key("oscillation"), "given", "nothing: the wall has a path already")),
    };
    let face = Face { temperature: wall.temperature, motion, opened_at: wall.opened_at };
    if face == Face::default() {
        return Err(Invalid::new(format!("face[{index}]"), "nothing special", "temperature, path, oscillation or opened_at"));
    }
    let mut alone = Boundary::new(boundary.lower.0, boundary.upper.0, Axis::Walls);
    alone.faces[k][side] = face.clone();
    alone.validate().map_err(|error| {
        let motion = if wall.path.is_some() { "path" } else { "oscillation" };
        let field = match error.key.as_str() {
            "temperature of a face" => "temperature".to_owned(),
            "motion of a face" => motion.to_owned(),
            "path" | "opened_at" => error.key.clone(),
            number => format!("oscillation.{number}"),
        };
        Invalid { key: key(&field), ..error }
    })?;
    Ok((k, side, face))
}

/// A wall that moves must never come to the wall opposite, nor to a partition: what is in between would have no place.
fn stays_clear<const D: usize>(boundary: &Boundary<D>, index: usize, wall: &Wall) -> Result<(), Invalid> {
    let (k, side) = (wall.axis as usize, usize::from(wall.side == Side::Upper));
    let reach = |side: usize| {
        let still = if side == 0 { boundary.lower[k] } else { boundary.upper[k] };
        boundary.faces[k][side].motion.as_ref().map_or((still, still), Motion::range)
    };
    if boundary.faces[k][side].motion.is_none() {
        return Ok(());
    }
    let (from, to) = reach(side);
    let beyond = |low: f64, high: f64| if side == 0 { to < low } else { high < from };
    let opposite = reach(1 - side);
    let plate = boundary.partitions.iter().position(|plate| plate.axis == k && !beyond(plate.position, plate.position));
    let what = match plate {
        Some(plate) => format!("partition[{plate}]"),
        None if !beyond(opposite.0, opposite.1) => "the wall opposite".to_owned(),
        None => return Ok(()),
    };
    let field = if wall.path.is_some() { "path" } else { "oscillation" };
    let expected = format!("a motion that never comes to {what}");
    Err(Invalid::new(format!("face[{index}].{field}"), format!("between {from} and {to}"), expected))
}

fn piston<const D: usize>(boundary: &Boundary<D>, given: &Cylinder) -> Result<Piston, Invalid> {
    let k = axis::<D>("piston.axis", given.axis)?;
    if boundary.axes[k] != Axis::Walls {
        return Err(Invalid::new("piston.axis", given.axis.letter(), "an axis across which box.faces has walls"));
    }
    let Cylinder { position, velocity, mass, force, .. } = *given;
    Ok(Piston { axis: k, position, velocity, mass, force, stops: given.stops.unwrap_or([boundary.lower[k], boundary.upper[k]]) })
}
