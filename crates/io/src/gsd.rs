//! GSD, the General Simulation Data format (<https://gsd.readthedocs.io/en/stable/file-layer.html>, version 2.0, with the schema
//! of HOOMD-blue, version 1.4), which OVITO, HOOMD-blue, freud and MDAnalysis read. Numbers are in single precision and the box
//! has no walls: for looking and measuring, never to go on from.
//!
//! A file is a header, a list of names, data, and an index that says which data belong to which frame under which name. A frame
//! counts once it is in the index. Data are written at once, the index only when they are on the disk, and whatever is killed
//! or cut off leaves whole frames: the entries of a frame never cross a page, and a new index is whole before the header
//! points at it.
//!
//! The `gsd` crate of the format's own authors, `hoomd-gsd`, was tried: it has no names for velocities and masses, cannot go
//! back to the frame of a checkpoint, and brings Parquet with it.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};

use corpuscle_experiments::Frame;

/// The first bytes, and the versions of format and schema.
const MAGIC: u64 = 0x65df_65df_65df_65df;
const FORMAT: u32 = 2 << 16;
const SCHEMA: u32 = 1 << 16 | 4;
const HEADER: usize = 256;
/// Where the names stand, and the room for them in units of 64 bytes.
const NAMES_AT: u64 = HEADER as u64;
const NAMES_ROOM: u64 = 16;
/// The index begins on a page, with room for the entries of one.
const PAGE: u64 = 4096;
const ENTRY: u64 = 32;
const FIRST_ROOM: u64 = PAGE / ENTRY;

/// Types of numbers in this format.
const U8: u8 = 1;
const U32: u8 = 3;
const U64: u8 = 4;
const I8: u8 = 5;
const F32: u8 = 9;
const F64: u8 = 10;

/// Names of all data, each by its place. The first frame has all; the others what changes, as many as a power of two, so that
/// their entries fill pages without crossing them.
const NAMES: [&str; 12] = [
    "configuration/step",
    "configuration/dimensions",
    "configuration/box",
    "particles/N",
    "particles/types",
    "particles/typeid",
    "particles/mass",
    "particles/diameter",
    "particles/position",
    "particles/velocity",
    "log/time",
    "log/box/lower",
];
const CHANGING: [u16; 4] = [0, 8, 9, 10];

/// How far a file has been written: what a checkpoint keeps.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Layout {
    /// Frames in it.
    frames: u64,
    /// Where the index is, and how many entries it has room for.
    index: u64,
    room: u64,
    /// Length of the file.
    end: u64,
}

impl Layout {
    /// Whether a file could be so, whoever says it.
    pub(crate) fn is_possible(&self) -> bool {
        let index = self.room.checked_mul(ENTRY).and_then(|bytes| bytes.checked_add(self.index));
        let aligned = self.index >= PAGE && self.index.is_multiple_of(PAGE) && self.room >= FIRST_ROOM;
        aligned && self.frames <= self.room && self.entries() <= self.room && index.is_some_and(|end| end <= self.end)
    }

    /// Length of the file.
    pub(crate) fn end(&self) -> u64 {
        self.end
    }

    fn entries(&self) -> u64 {
        let (first, others) = (NAMES.len() as u64, CHANGING.len() as u64);
        if self.frames == 0 { 0 } else { first + others * (self.frames - 1) }
    }
}

/// Writes frames into a file.
#[derive(Debug)]
pub(crate) struct Writer {
    layout: Layout,
    /// Entries that are not yet in the index.
    pending: Vec<u8>,
}

impl Writer {
    /// Begins an empty file.
    pub(crate) fn begin(file: &mut File) -> io::Result<Self> {
        let layout = Layout { frames: 0, index: PAGE, room: FIRST_ROOM, end: 2 * PAGE };
        file.set_len(layout.end)?;
        let names: Vec<u8> = NAMES.iter().flat_map(|name| [name.as_bytes(), &[0]].concat()).collect();
        at(file, NAMES_AT, &names)?;
        at(file, 0, &header(&layout))?;
        Ok(Self { layout, pending: vec![] })
    }

    /// Goes on where a file was: what was written since is cut off.
    pub(crate) fn again(file: &mut File, layout: Layout) -> io::Result<Self> {
        file.set_len(layout.end)?;
        let (from, to) = (layout.index + ENTRY * layout.entries(), layout.index + ENTRY * layout.room);
        file.seek(SeekFrom::Start(from))?;
        io::copy(&mut io::repeat(0).take(to - from), file)?;
        at(file, 0, &header(&layout))?;
        Ok(Self { layout, pending: vec![] })
    }

    /// How far the file has been written.
    pub(crate) fn layout(&self) -> Layout {
        self.layout
    }

    /// Writes the data of a frame; it counts from the next [`flush`](Self::flush) on.
    pub(crate) fn add(&mut self, file: &mut File, frame: &Frame) -> io::Result<()> {
        let number = self.layout.frames;
        let mut wanted = self.layout;
        wanted.frames += 1;
        if wanted.entries() > wanted.room {
            self.move_index(file)?;
        }
        let ids: Vec<u16> = if number == 0 { (0..NAMES.len() as u16).collect() } else { CHANGING.to_vec() };
        let (mut data, mut entries) = (vec![], vec![]);
        for id in ids {
            let Chunk { rows, columns, kind, bytes } = chunk(frame, number, id);
            let location = self.layout.end + data.len() as u64;
            for word in [number, rows, location] {
                entries.extend(word.to_le_bytes());
            }
            entries.extend(columns.to_le_bytes());
            entries.extend(id.to_le_bytes());
            entries.extend([kind, 0]);
            data.extend(bytes);
        }
        at(file, self.layout.end, &data)?;
        self.layout.end += data.len() as u64;
        self.layout.frames += 1;
        self.pending.extend(entries);
        Ok(())
    }

    /// Puts everything onto the disk, the index after the data.
    pub(crate) fn flush(&mut self, file: &mut File) -> io::Result<()> {
        file.sync_data()?;
        let mut place = self.layout.index + ENTRY * self.layout.entries() - self.pending.len() as u64;
        let mut rest = self.pending.as_slice();
        while !rest.is_empty() {
            let (page, after) = rest.split_at(rest.len().min((PAGE - place % PAGE) as usize));
            at(file, place, page)?;
            (place, rest) = (place + page.len() as u64, after);
        }
        self.pending.clear();
        file.sync_data()
    }

    /// Makes an index of twice the size at the end of the file. It happens at a certain frame, whenever the file is flushed.
    fn move_index(&mut self, file: &mut File) -> io::Result<()> {
        self.flush(file)?;
        let Layout { index, room, end, .. } = self.layout;
        let mut entries = vec![0; (ENTRY * self.layout.entries()) as usize];
        file.seek(SeekFrom::Start(index))?;
        file.read_exact(&mut entries)?;
        let new = end.next_multiple_of(PAGE);
        file.set_len(new + ENTRY * 2 * room)?;
        at(file, new, &entries)?;
        file.sync_data()?;
        (self.layout.index, self.layout.room, self.layout.end) = (new, 2 * room, new + ENTRY * 2 * room);
        at(file, 0, &header(&self.layout))?;
        file.sync_data()
    }
}

fn at(file: &mut File, place: u64, bytes: &[u8]) -> io::Result<()> {
    file.seek(SeekFrom::Start(place))?;
    file.write_all(bytes)
}

fn header(layout: &Layout) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HEADER);
    for word in [MAGIC, layout.index, layout.room, NAMES_AT, NAMES_ROOM] {
        bytes.extend(word.to_le_bytes());
    }
    bytes.extend(SCHEMA.to_le_bytes());
    bytes.extend(FORMAT.to_le_bytes());
    for text in [concat!("Corpuscle ", env!("CARGO_PKG_VERSION")), "hoomd"] {
        let end = bytes.len() + 64;
        bytes.extend(text.as_bytes());
        bytes.resize(end, 0);
    }
    bytes.resize(HEADER, 0);
    bytes
}

/// Numbers of one kind, in rows and columns.
struct Chunk {
    rows: u64,
    columns: u32,
    kind: u8,
    bytes: Vec<u8>,
}

/// What stands under a name in a frame.
fn chunk(frame: &Frame, number: u64, id: u16) -> Chunk {
    let Frame { lower, upper, particles, .. } = frame;
    let n = particles.len() as u64;
    let one = |kind, bytes: &[u8]| Chunk { rows: 1, columns: 1, kind, bytes: bytes.to_vec() };
    let single = |numbers: &mut dyn Iterator<Item = f64>| numbers.flat_map(|x| (x as f32).to_le_bytes()).collect::<Vec<u8>>();
    // The box of this format is centred at the origin; that of a plane has no height.
    let centre: [f64; 3] = std::array::from_fn(|k| 0.5 * (lower[k] + upper[k]));
    let side = |k: usize| if k < frame.dimension { upper[k] - lower[k] } else { 0.0 };
    match NAMES[usize::from(id)] {
        "configuration/step" => one(U64, &number.to_le_bytes()),
        "configuration/dimensions" => one(U8, &[frame.dimension as u8]),
        "configuration/box" => {
            let sides = single(&mut [side(0), side(1), side(2), 0.0, 0.0, 0.0].into_iter());
            Chunk { rows: 6, columns: 1, kind: F32, bytes: sides }
        }
        "particles/N" => one(U32, &(n as u32).to_le_bytes()),
        "particles/types" => types(&frame.names),
        "particles/typeid" => {
            let kinds = particles.species.iter().flat_map(|&kind| u32::from(kind).to_le_bytes()).collect();
            Chunk { rows: n, columns: 1, kind: U32, bytes: kinds }
        }
        "particles/mass" => Chunk { rows: n, columns: 1, kind: F32, bytes: single(&mut particles.mass.iter().copied()) },
        "particles/diameter" => {
            Chunk { rows: n, columns: 1, kind: F32, bytes: single(&mut particles.radius.iter().map(|radius| 2.0 * radius)) }
        }
        "particles/position" => {
            let places = particles.position.iter().flat_map(|r| std::array::from_fn::<f64, 3, _>(|k| r[k] - centre[k]));
            Chunk { rows: n, columns: 3, kind: F32, bytes: single(&mut { places }) }
        }
        "particles/velocity" => {
            Chunk { rows: n, columns: 3, kind: F32, bytes: single(&mut particles.velocity.iter().flat_map(|v| v.0)) }
        }
        "log/time" => one(F64, &frame.time.to_le_bytes()),
        _ => Chunk { rows: 3, columns: 1, kind: F64, bytes: lower.iter().flat_map(|x| x.to_le_bytes()).collect() },
    }
}

/// Names of the species, of equal length, ended by zeros.
fn types(names: &[String]) -> Chunk {
    let names: Vec<&str> = if names.is_empty() { vec!["X"] } else { names.iter().map(String::as_str).collect() };
    let longest = names.iter().map(|name| name.len()).max().unwrap_or(0) + 1;
    let padded = names.iter().flat_map(|name| [name.as_bytes(), &vec![0; longest - name.len()]].concat()).collect();
    Chunk { rows: names.len() as u64, columns: longest as u32, kind: I8, bytes: padded }
}
