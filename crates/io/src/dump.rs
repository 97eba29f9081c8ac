//! LAMMPS dump in the style `custom`, as text (<https://docs.lammps.org/dump.html>), which LAMMPS, OVITO and ASE read. Planar
//! systems lie at `z = 0` in a box of height 1. `TIMESTEP` is the number of the frame, since events have no steps; `TIME` is
//! the physical time.

use std::fmt::Write;
use std::io::BufRead;

use corpuscle_experiments::Frame;

use crate::columns::{Column, Head, Lines, ReadError};

/// The frame of this number. Frames one after the other make a trajectory.
pub(crate) fn frame(frame: &Frame, number: u64) -> String {
    let Frame { time, lower, upper, particles, .. } = frame;
    let faces = frame.periodic.map(|periodic| if periodic { "pp" } else { "ff" }).join(" ");
    let count = particles.len();
    let mut text =
        format!("ITEM: TIME\n{time:?}\nITEM: TIMESTEP\n{number}\nITEM: NUMBER OF ATOMS\n{count}\nITEM: BOX BOUNDS {faces}\n");
    for k in 0..3 {
        // Writing into a string cannot fail.
        let _ = writeln!(text, "{:?} {:?}", lower[k], upper[k]);
    }
    text += "ITEM: ATOMS id type mass radius x y z vx vy vz\n";
    for i in 0..particles.len() {
        let ([x, y, z], [u, v, w]) = (particles.position[i].0, particles.velocity[i].0);
        let (kind, mass, radius) = (u32::from(particles.species[i]) + 1, particles.mass[i], particles.radius[i]);
        let _ = writeln!(text, "{} {kind} {mass:?} {radius:?} {x:?} {y:?} {z:?} {u:?} {v:?} {w:?}", i + 1);
    }
    text
}

/// Reads what stands above the particles of the next frame; none at the end of the file.
///
/// # Errors
/// When it is not that.
pub(crate) fn head<R: BufRead>(lines: &mut Lines<R>) -> Result<Option<Head>, ReadError> {
    let (mut count, mut time, mut bounds) = (None, None, None);
    let mut begun = false;
    loop {
        let Some(line) = lines.next()? else { return if begun { Err(ReadError::CutOff) } else { Ok(None) } };
        if !begun && line.trim().is_empty() {
            continue;
        }
        begun = true;
        let item = line.trim_end().strip_prefix("ITEM: ").map(str::to_owned);
        let Some(item) = item else {
            let found = line.to_owned();
            return Err(lines.wrong(&found, "ITEM: and what follows, as LAMMPS writes it"));
        };
        if let Some(names) = item.strip_prefix("ATOMS") {
            let columns: Vec<Column> = names.split_ascii_whitespace().map(column).collect();
            let count = count.ok_or_else(|| lines.wrong(&item, "ITEM: NUMBER OF ATOMS before it"))?;
            let scaled = columns.iter().any(|column| matches!(column, Column::Scaled(_)));
            let scale = if scaled {
                Some(bounds.ok_or_else(|| lines.wrong(&item, "a box at right angles before scaled places"))?)
            } else {
                None
            };
            return Ok(Some(Head { count, columns, time, scale }));
        }
        let right_angles = !item.contains("xy") && !item.contains("abc");
        let wanted = if item.starts_with("BOX BOUNDS") { 3 } else { 1 };
        let mut found: Vec<String> = vec![];
        for _ in 0..wanted {
            let Some(line) = lines.next()? else { return Err(ReadError::CutOff) };
            found.push(line.trim().to_owned());
        }
        match item.as_str() {
            "NUMBER OF ATOMS" => count = Some(lines.count(&found[0])?),
            "TIME" => time = found[0].parse().ok().filter(|time: &f64| time.is_finite()),
            _ if item.starts_with("BOX BOUNDS") && right_angles => bounds = Some(sides(lines, &found)?),
            // Of units and steps nothing follows here; other items are new to this reader, and one line each.
            _ => {}
        }
    }
}

/// The lower and the upper coordinate along each axis.
fn sides<R: BufRead>(lines: &Lines<R>, found: &[String]) -> Result<[[f64; 2]; 3], ReadError> {
    let mut sides = [[0.0; 2]; 3];
    for (side, line) in sides.iter_mut().zip(found) {
        let numbers: Vec<f64> = line.split_ascii_whitespace().filter_map(|word| word.parse().ok()).collect();
        *side = numbers
            .try_into()
            .ok()
            .filter(|side: &[f64; 2]| side.iter().all(|x| x.is_finite()))
            .ok_or_else(|| lines.wrong(line, "the lower and the upper coordinate of the box"))?;
    }
    Ok(sides)
}

fn column(name: &str) -> Column {
    match name {
        "x" | "xu" => Column::Position(0),
        "y" | "yu" => Column::Position(1),
        "z" | "zu" => Column::Position(2),
        "xs" | "xsu" => Column::Scaled(0),
        "ys" | "ysu" => Column::Scaled(1),
        "zs" | "zsu" => Column::Scaled(2),
        "vx" => Column::Velocity(0),
        "vy" => Column::Velocity(1),
        "vz" => Column::Velocity(2),
        "mass" => Column::Mass,
        "radius" => Column::Radius,
        "diameter" => Column::Diameter,
        "type" => Column::Kind,
        "element" => Column::Name,
        "id" => Column::Identity,
        _ => Column::Other,
    }
}
