//! Extended XYZ, which OVITO and ASE read: particles at one instant, one line each, below a line that says what the columns
//! mean and what the box is (<https://github.com/libAtoms/extxyz>). Planar systems lie at `z = 0` in a box of height 1.
//!
//! The column of names is called `type`, which OVITO shows as it is; ASE would take `species` for chemical elements.

use std::fmt::Write;
use std::io::BufRead;

use corpuscle_experiments::Frame;

use crate::columns::{Column, Head, Lines, ReadError};
use crate::trajectory::word;

/// One frame. Frames one after the other make a trajectory.
pub(crate) fn frame(frame: &Frame) -> String {
    let Frame { lower, upper, particles, .. } = frame;
    let [x, y, z] = [0, 1, 2].map(|k| upper[k] - lower[k]);
    let pbc = frame.periodic.map(|periodic| if periodic { "T" } else { "F" }).join(" ");
    let mut text = format!(
        "{}\nLattice=\"{x:?} 0 0 0 {y:?} 0 0 0 {z:?}\" Origin=\"{:?} {:?} {:?}\" pbc=\"{pbc}\" Time={:?} \
         Properties=type:S:1:pos:R:3:velo:R:3:radius:R:1:mass:R:1:id:I:1\n",
        particles.len(),
        lower[0],
        lower[1],
        lower[2],
        frame.time,
    );
    let names: Vec<String> = frame.names.iter().map(|name| word(name)).collect();
    for i in 0..particles.len() {
        let name = names.get(usize::from(particles.species[i])).map_or("X", String::as_str);
        let ([x, y, z], [u, v, w]) = (particles.position[i].0, particles.velocity[i].0);
        let (radius, mass) = (particles.radius[i], particles.mass[i]);
        // Writing into a string cannot fail.
        let _ = writeln!(text, "{name} {x:?} {y:?} {z:?} {u:?} {v:?} {w:?} {radius:?} {mass:?} {}", i + 1);
    }
    text
}

/// Reads what stands above the particles of the next frame; none at the end of the file.
///
/// # Errors
/// When it is not that.
pub(crate) fn head<R: BufRead>(lines: &mut Lines<R>) -> Result<Option<Head>, ReadError> {
    let count = loop {
        let Some(line) = lines.next()? else { return Ok(None) };
        // Blank lines at the end of a file are usual.
        if !line.trim().is_empty() {
            break line.trim().to_owned();
        }
    };
    let count = lines.count(&count)?;
    let Some(comment) = lines.next()? else { return Err(ReadError::CutOff) };
    let (properties, time) = (value(comment, "Properties"), value(comment, "Time"));
    let time = time.and_then(|time| time.parse().ok()).filter(|time: &f64| time.is_finite());
    let properties = properties.unwrap_or("species:S:1:pos:R:3").to_owned();
    let columns =
        columns(&properties).ok_or_else(|| lines.wrong(&properties, "Properties=name:type:count:..., among them pos:R:3"))?;
    Ok(Some(Head { count, columns, time, scale: None }))
}

/// What the columns of `species:S:1:pos:R:3:...` mean.
fn columns(properties: &str) -> Option<Vec<Column>> {
    let words: Vec<&str> = properties.split(':').collect();
    let mut columns = vec![];
    for property in words.chunks(3) {
        let [name, _, count] = property else { return None };
        let count: usize = count.parse().ok().filter(|count| (1..=MOST_COLUMNS).contains(count))?;
        let column = |k: usize| match (*name, count) {
            ("pos" | "positions", 3) => Column::Position(k),
            ("velo" | "vel" | "velocity" | "velocities", 3) => Column::Velocity(k),
            ("radius" | "radii", 1) => Column::Radius,
            ("mass" | "masses", 1) => Column::Mass,
            ("type" | "species" | "element" | "name", 1) => Column::Name,
            ("id", 1) => Column::Identity,
            _ => Column::Other,
        };
        columns.extend((0..count).map(column));
        (columns.len() <= MOST_COLUMNS).then_some(())?;
    }
    Some(columns)
}

/// Columns a file may have.
const MOST_COLUMNS: usize = 256;

/// The value of a key in `key=value key="a value" ...`.
fn value<'a>(comment: &'a str, key: &str) -> Option<&'a str> {
    let mut rest = comment;
    loop {
        let (before, after) = rest.split_once('=')?;
        let name = before.trim_end().rsplit(char::is_whitespace).next().unwrap_or_default();
        let after = after.trim_start();
        let (value, left) = match after.strip_prefix('"') {
            Some(quoted) => quoted.split_once('"')?,
            None => after.split_once(char::is_whitespace).unwrap_or((after, "")),
        };
        if name.eq_ignore_ascii_case(key) {
            return Some(value);
        }
        rest = left;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corpuscle_core::{Axis, Boundary, Particles, Vector};

    #[test]
    fn a_planar_frame_is_complete_and_exact() {
        let mut particles = Particles::<2>::new();
        particles.push(Vector([0.1, 1.0 / 3.0]), Vector([-1e-20, 2.0]), 2.0, 0.5, 0);
        particles.push(Vector([3.0, 4.0]), Vector([0.0, 0.0]), 1.0, 0.5, 7);
        let mut boundary = Boundary::new([0.0, -1.0], [10.0, 4.0], Axis::Walls);
        boundary.axes[0] = Axis::Periodic;
        let text = frame(&Frame::new(2.5, &boundary, &particles, &["warm bath".into()]));
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "2");
        let head = "Lattice=\"10.0 0 0 0 5.0 0 0 0 1.0\" Origin=\"0.0 -1.0 -0.5\" pbc=\"T F F\" Time=2.5 ";
        assert!(lines[1].starts_with(head), "{}", lines[1]);
        assert_eq!(lines[3], "X 3.0 4.0 0.0 0.0 0.0 0.0 0.5 1.0 2");
        let fields: Vec<&str> = lines[2].split(' ').collect();
        let numbers: Vec<f64> = fields[1..].iter().map(|field| field.parse().unwrap()).collect();
        assert_eq!((fields[0], numbers), ("warm_bath", vec![0.1, 1.0 / 3.0, 0.0, -1e-20, 2.0, 0.0, 0.5, 2.0, 1.0]));
    }

    #[test]
    fn a_comment_is_taken_apart() {
        let comment = "Lattice=\"1 0 0 0 = 0\"  note = Time energy=-3 Time=2.5 properties=pos:R:3";
        assert_eq!(value(comment, "Time"), Some("2.5"));
        assert_eq!(value(comment, "Properties"), Some("pos:R:3"));
        assert_eq!(value(comment, "energy"), Some("-3"));
        assert_eq!(value("Time=\"1", "Time"), None);
        assert_eq!(columns("pos:R:3:x"), None);
        assert_eq!(columns("pos:R:3:x:R:9999999999"), None);
        assert_eq!(columns("id:I:1:forces:R:2").unwrap(), [Column::Identity, Column::Other, Column::Other]);
    }
}
