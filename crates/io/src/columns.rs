//! Particles as lines of text, below a head that says what the columns mean: what extended XYZ and LAMMPS dump have in common.
//!
//! Files may come from strangers: a line, the particles of a frame and the names of species are limited in number, and memory
//! grows with what has been read, never with what a file says of itself.

use std::collections::HashMap;
use std::io::{self, BufRead, Read, Seek, SeekFrom};

use corpuscle_core::Vector;

/// Longest line, in bytes.
const LONGEST: u64 = 1 << 16;
/// Particles of a frame.
const MOST: usize = 2_000_000;
/// Names of species.
const MOST_NAMES: usize = 1000;
/// Longest name, in bytes.
const LONGEST_NAME: usize = 100;

/// Why a file cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The system refuses.
    #[error("cannot be read: {0}")]
    System(#[from] io::Error),
    /// What stands there is something else.
    #[error("line {line}: `{found}`: expected {expected}")]
    Wrong {
        /// Where.
        line: u64,
        /// What stands there, or its beginning.
        found: String,
        /// What should.
        expected: String,
    },
    /// It ends in the middle of the frame that is wanted.
    #[error("ends in the middle of a frame (a line without its end counts as cut off)")]
    CutOff,
    /// It has fewer frames.
    #[error("has {0} whole frames")]
    TooShort(u64),
}

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Column {
    /// A coordinate.
    Position(usize),
    /// A coordinate, from 0 to 1 across the box.
    Scaled(usize),
    /// A component of the velocity.
    Velocity(usize),
    Mass,
    Radius,
    Diameter,
    /// Name of the species.
    Name,
    /// Number of the species.
    Kind,
    /// Number of the particle.
    Identity,
    /// What nobody here asks for.
    Other,
}

/// What stands above the particles of a frame.
#[derive(Debug)]
pub(crate) struct Head {
    pub(crate) count: usize,
    pub(crate) columns: Vec<Column>,
    pub(crate) time: Option<f64>,
    /// Lower and upper coordinate of the box along each axis, where places are scaled by it.
    pub(crate) scale: Option<[[f64; 2]; 3]>,
}

/// A frame as it was read: what its file has no column for is none. Particles are in the order of their numbers, or of the
/// file where they have none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    /// Physical time.
    pub time: Option<f64>,
    /// Positions.
    pub position: Vec<Vector<3>>,
    /// Velocities.
    pub velocity: Option<Vec<Vector<3>>>,
    /// Masses.
    pub mass: Option<Vec<f64>>,
    /// Radii.
    pub radius: Option<Vec<f64>>,
    /// Species, as an index into `names`.
    pub species: Vec<u16>,
    /// Names of the species, in the order of their appearance.
    pub names: Vec<String>,
}

/// Lines of bounded length, counted.
pub(crate) struct Lines<R> {
    input: R,
    bytes: Vec<u8>,
    line: u64,
    offset: u64,
}

impl<R: BufRead> Lines<R> {
    pub(crate) fn new(input: R) -> Self {
        Self { input, bytes: vec![], line: 0, offset: 0 }
    }

    /// The next line without its end; none at the end of the file.
    pub(crate) fn next(&mut self) -> Result<Option<&str>, ReadError> {
        self.bytes.clear();
        let read = self.input.by_ref().take(LONGEST).read_until(b'\n', &mut self.bytes)?;
        if read == 0 {
            return Ok(None);
        }
        self.line += 1;
        self.offset += read as u64;
        if self.bytes.pop_if(|&mut last| last == b'\n').is_none() {
            // Cut off in the middle, where even a number may look whole.
            if (read as u64) < LONGEST {
                return Err(ReadError::CutOff);
            }
            return Err(self.wrong(&String::from_utf8_lossy(&self.bytes), &format!("lines of at most {LONGEST} bytes")));
        }
        match std::str::from_utf8(&self.bytes) {
            Ok(line) => Ok(Some(line)),
            Err(_) => Err(self.wrong(&String::from_utf8_lossy(&self.bytes), "text in UTF-8")),
        }
    }

    /// What is wrong with the line just read.
    pub(crate) fn wrong(&self, found: &str, expected: &str) -> ReadError {
        let found: String = found.chars().map(|c| if c.is_control() { ' ' } else { c }).take(60).collect();
        ReadError::Wrong { line: self.line, found, expected: expected.into() }
    }

    /// How many particles there are to be.
    pub(crate) fn count(&self, text: &str) -> Result<usize, ReadError> {
        let count = text.parse().ok().filter(|count| (1..=MOST).contains(count));
        count.ok_or_else(|| self.wrong(text, &format!("a number of particles, from 1 to {MOST}")))
    }
}

/// Reads a frame: that of this number, counted from 0, or the last whole one. `head` reads what stands above its particles.
///
/// # Errors
/// When there is no such frame, or it cannot be read.
pub(crate) fn read<R: BufRead + Seek>(
    input: R,
    head: fn(&mut Lines<R>) -> Result<Option<Head>, ReadError>,
    wanted: Option<u64>,
) -> Result<Snapshot, ReadError> {
    let mut lines = Lines::new(input);
    // Where the last whole frame begins, and after how many lines.
    let (mut frames, mut last) = (0, None);
    loop {
        let start = (lines.offset, lines.line);
        let found = match head(&mut lines) {
            Ok(Some(found)) => found,
            Ok(None) => break,
            Err(ReadError::CutOff) if wanted.is_none() && last.is_some() => break,
            Err(error) => return Err(error),
        };
        if wanted == Some(frames) {
            return rows(&mut lines, &found);
        }
        match skip(&mut lines, found.count) {
            Ok(()) => (frames, last) = (frames + 1, Some(start)),
            Err(ReadError::CutOff) if wanted.is_none() && last.is_some() => break,
            Err(error) => return Err(error),
        }
    }
    let Some((offset, line)) = last.filter(|_| wanted.is_none()) else { return Err(ReadError::TooShort(frames)) };
    lines.input.seek(SeekFrom::Start(offset))?;
    (lines.offset, lines.line) = (offset, line);
    match head(&mut lines)? {
        Some(found) => rows(&mut lines, &found),
        None => Err(ReadError::TooShort(frames)),
    }
}

fn skip<R: BufRead>(lines: &mut Lines<R>, count: usize) -> Result<(), ReadError> {
    for _ in 0..count {
        lines.next()?.ok_or(ReadError::CutOff)?;
    }
    Ok(())
}

/// Reads the particles of a frame.
fn rows<R: BufRead>(lines: &mut Lines<R>, head: &Head) -> Result<Snapshot, ReadError> {
    let there = |wanted: fn(usize) -> Column| (0..3).all(|k| head.columns.contains(&wanted(k)));
    if !there(Column::Position) && !there(Column::Scaled) {
        return Err(lines.wrong("the columns", "three coordinates among them"));
    }
    let moving = there(Column::Velocity);
    let massive = head.columns.contains(&Column::Mass);
    let large = head.columns.iter().any(|column| matches!(column, Column::Radius | Column::Diameter));
    let named = head.columns.contains(&Column::Name);
    let mut snapshot = Snapshot { time: head.time, ..Snapshot::default() };
    let (mut velocity, mut mass, mut radius) = (vec![], vec![], vec![]);
    let (mut identity, mut species): (Vec<u64>, HashMap<String, u16>) = (vec![], HashMap::new());
    for _ in 0..head.count {
        let line = lines.next()?.ok_or(ReadError::CutOff)?.to_owned();
        let (mut r, mut v, mut m, mut size) = ([0.0; 3], [0.0; 3], 1.0, 0.0);
        let (mut name, mut number) = ("X".to_owned(), None);
        let mut words = line.split_ascii_whitespace();
        for &column in &head.columns {
            let Some(word) = words.next() else { return Err(lines.wrong(&line, &format!("{} columns", head.columns.len()))) };
            let real = || word.parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(|| lines.wrong(word, "a finite number"));
            let whole = || word.parse::<u64>().map_err(|_| lines.wrong(word, "a whole number"));
            match column {
                Column::Position(k) => r[k] = real()?,
                Column::Scaled(k) => {
                    let [from, to] = head.scale.map_or([0.0, 1.0], |scale| scale[k]);
                    r[k] = from + real()? * (to - from);
                }
                Column::Velocity(k) => v[k] = real()?,
                Column::Mass => m = real()?,
                Column::Radius => size = real()?,
                Column::Diameter => size = 0.5 * real()?,
                Column::Name => word.clone_into(&mut name),
                Column::Kind if !named => name = format!("type {}", whole()?),
                Column::Identity => number = Some(whole()?),
                Column::Kind | Column::Other => {}
            }
        }
        if !r.iter().all(|x| x.is_finite()) {
            return Err(lines.wrong(&line, "places that the box leaves finite"));
        }
        if m < 0.0 || size < 0.0 {
            return Err(lines.wrong(&line, "a mass and a radius, zero or more"));
        }
        let species = match species.get(&name) {
            Some(&known) => known,
            None if snapshot.names.len() < MOST_NAMES && name.len() <= LONGEST_NAME => {
                let new = snapshot.names.len() as u16;
                snapshot.names.push(name.clone());
                species.insert(name, new);
                new
            }
            None => return Err(lines.wrong(&name, &format!("at most {MOST_NAMES} names of at most {LONGEST_NAME} bytes"))),
        };
        snapshot.position.push(Vector(r));
        snapshot.species.push(species);
        velocity.push(Vector(v));
        mass.push(m);
        radius.push(size);
        identity.extend(number);
    }
    snapshot.velocity = moving.then_some(velocity);
    snapshot.mass = massive.then_some(mass);
    snapshot.radius = large.then_some(radius);
    in_order(snapshot, &identity).ok_or_else(|| lines.wrong("id", "another number for each particle"))
}

/// Particles in the order of their numbers, which programs that sort them in memory write in any order; none when two have one.
fn in_order(mut snapshot: Snapshot, identity: &[u64]) -> Option<Snapshot> {
    let mut order: Vec<usize> = (0..identity.len()).collect();
    order.sort_by_key(|&i| identity[i]);
    if order.windows(2).any(|pair| identity[pair[0]] == identity[pair[1]]) {
        return None;
    }
    if !order.is_sorted() {
        fn arranged<T: Copy>(items: &[T], order: &[usize]) -> Vec<T> {
            order.iter().map(|&i| items[i]).collect()
        }
        snapshot.position = arranged(&snapshot.position, &order);
        snapshot.species = arranged(&snapshot.species, &order);
        by_appearance(&mut snapshot);
        snapshot.velocity = snapshot.velocity.map(|items| arranged(&items, &order));
        snapshot.mass = snapshot.mass.map(|items| arranged(&items, &order));
        snapshot.radius = snapshot.radius.map(|items| arranged(&items, &order));
    }
    Some(snapshot)
}

/// Species in the order in which their first particles now stand.
fn by_appearance(snapshot: &mut Snapshot) {
    let mut place: Vec<Option<u16>> = vec![None; snapshot.names.len()];
    let mut names = vec![];
    for species in &mut snapshot.species {
        let old = usize::from(*species);
        *species = *place[old].get_or_insert_with(|| {
            names.push(snapshot.names[old].clone());
            (names.len() - 1) as u16
        });
    }
    snapshot.names = names;
}

#[cfg(test)]
mod tests;
