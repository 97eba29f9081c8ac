//! A grid of bins: which particles are near a place.

use corpuscle_core::instructions::prefetch;
use corpuscle_core::{Axis, Boundary, Vector};

use super::candidates::Candidates;
use super::sites::{Sites, Way, away};
use crate::pages::filled;
use crate::search::{Neighbour, home};

pub(crate) const NONE: u32 = u32::MAX;

/// Cells over the box, each with the particles that were put into it.
///
/// A periodic neighbour comes with the number of its image, so boxes of one or two cells are exact as well. Across open
/// axes the outermost cells have no end.
#[derive(Clone, Debug)]
pub(crate) struct Bins<const D: usize, const WORDS: usize> {
    pub(crate) lower: Vector<D>,
    pub(crate) width: Vector<D>,
    pub(crate) axes: [Axis; D],
    pub(crate) cells: [u32; D],
    stride: [u32; D],
    content: Vec<Cell<WORDS>>,
    /// Coordinates of the faces between cells along all axes; infinite at the ends of the box where nothing is beyond.
    faces: Vec<f64>,
    /// Where those of each axis begin.
    first_face: [u32; D],
    places: Vec<Place<D>>,
    sites: Sites<D>,
}

/// The particles of a cell, side by side so that they can be copied without looking how many there are; in the last word
/// how many.
///
/// They are stored as words, in the image of the box itself. In an overfull cell (whose last word is `WORDS`) the last but
/// one holds the head of a list threaded through the particles.
type Cell<const WORDS: usize> = [u32; WORDS];

/// Where a particle is: its cell, and the one after it in the list of an overfull cell.
#[derive(Clone, Copy, Debug)]
struct Place<const D: usize> {
    next: u32,
    cell: [u16; D],
}

impl<const D: usize, const WORDS: usize> Bins<D, WORDS> {
    /// Particles that a cell holds side by side.
    const SLOTS: usize = WORDS - 1;

    /// Cells at least `width` wide, with room for particles `0..count`; no more than about `most` of them.
    pub(crate) fn new(boundary: &Boundary<D>, mut width: f64, count: usize, most: f64) -> Self {
        let extent = boundary.extent();
        let cells = loop {
            let cells: [u32; D] = std::array::from_fn(|k| (extent[k] / width).floor().clamp(1.0, 60_000.0) as u32);
            // Thin boxes have one layer of cells however wide, and would have too many along the other axes.
            if cells.iter().map(|&n| f64::from(n)).product::<f64>() <= most {
                break cells;
            }
            width *= 1.1;
        };
        let mut stride = [1; D];
        for k in 1..D {
            stride[k] = stride[k - 1] * cells[k - 1];
        }
        let total = cells.iter().product::<u32>() as usize;
        let width = Vector::from_fn(|k| extent[k] / f64::from(cells[k]));
        let (mut faces, mut first_face) = (vec![], [0; D]);
        for k in 0..D {
            first_face[k] = faces.len() as u32;
            let end = |open: f64, face: f64| if boundary.axes[k] == Axis::Periodic { face } else { open };
            faces.push(end(f64::NEG_INFINITY, boundary.lower[k]));
            faces.extend((1..cells[k]).map(|c| boundary.lower[k] + f64::from(c) * width[k]));
            faces.push(end(f64::INFINITY, boundary.upper[k]));
        }
        // Where a face is going to open, particles may be outside from then on.
        let axes = std::array::from_fn(|k| match boundary.axes[k] {
            Axis::Walls if boundary.faces[k].iter().any(|face| face.opened_at.is_some()) => Axis::Open,
            axis => axis,
        });
        Self {
            lower: boundary.lower,
            width,
            axes,
            cells,
            stride,
            content: filled([0; WORDS], total),
            faces,
            first_face,
            places: filled(Place { next: NONE, cell: [0; D] }, count),
            sites: Sites::new(axes, cells, stride),
        }
    }

    /// The cell around a point.
    #[inline]
    pub(crate) fn cell_of(&self, r: Vector<D>) -> [u16; D] {
        std::array::from_fn(|k| ((r[k] - self.lower[k]) / self.width[k]).floor().clamp(0.0, f64::from(self.cells[k] - 1)) as u16)
    }

    #[inline]
    pub(crate) fn cell(&self, i: usize) -> [u16; D] {
        self.places[i].cell
    }

    /// Says where a particle is, without putting it into the cell's list.
    #[inline]
    pub(crate) fn locate(&mut self, i: usize, cell: [u16; D]) {
        self.places[i].cell = cell;
    }

    #[inline]
    pub(crate) fn index(&self, cell: [u16; D]) -> usize {
        cell.iter().zip(&self.stride).map(|(&c, stride)| u32::from(c) * stride).sum::<u32>() as usize
    }

    /// Number of cells.
    pub(crate) fn count(&self) -> usize {
        self.content.len()
    }

    /// Numbers of all cells that meet a block.
    pub(crate) fn cells_meeting(&self, lower: Vector<D>, upper: Vector<D>, mut visit: impl FnMut(usize)) {
        let last = self.cells.map(|cells| f64::from(cells - 1));
        let layers: [[f64; 2]; D] =
            std::array::from_fn(|k| [lower[k], upper[k]].map(|x| ((x - self.lower[k]) / self.width[k]).floor()));
        if (0..D).any(|k| self.axes[k] == Axis::Periodic && (layers[k][1] < 0.0 || layers[k][0] > last[k])) {
            return;
        }
        let range: [[u32; 2]; D] = std::array::from_fn(|k| layers[k].map(|layer| layer.clamp(0.0, last[k]) as u32));
        let total: u32 = range.iter().map(|[from, to]| to - from + 1).product();
        for mut number in 0..total {
            let mut cell = 0;
            for ([from, to], stride) in range.into_iter().zip(self.stride) {
                cell += (from + number % (to - from + 1)) * stride;
                number /= to - from + 1;
            }
            visit(cell as usize);
        }
    }

    /// The coordinate of the face at which a particle leaves its cell, and whether that is a periodic face of the box.
    /// Infinity where nothing is beyond: the cell has no end, or a wall comes first.
    #[inline]
    pub(crate) fn face(&self, i: usize, axis: usize, up: bool) -> (f64, bool) {
        let number = u32::from(self.places[i].cell[axis]) + u32::from(up);
        let end = if up { self.cells[axis] } else { 0 };
        (self.faces[(self.first_face[axis] + number) as usize], number == end)
    }

    /// Puts a particle into the list of its cell.
    #[inline]
    pub(crate) fn insert(&mut self, i: usize) {
        let index = self.index(self.places[i].cell);
        let cell = &mut self.content[index];
        let filled = cell[Self::SLOTS] as usize;
        if filled < Self::SLOTS {
            cell[filled] = word::<D>(i);
            cell[Self::SLOTS] += 1;
        } else {
            self.insert_into_list(index, i);
        }
    }

    #[cold]
    fn insert_into_list(&mut self, index: usize, i: usize) {
        let cell = &mut self.content[index];
        if cell[Self::SLOTS] as usize == Self::SLOTS {
            self.places[slot(cell[Self::SLOTS - 1])].next = NONE;
            cell[Self::SLOTS] += 1;
        }
        self.places[i].next = std::mem::replace(&mut cell[Self::SLOTS - 1], word::<D>(i));
    }

    /// Takes a particle out of the list of its cell.
    #[inline]
    pub(crate) fn remove(&mut self, i: usize) {
        let index = self.index(self.places[i].cell);
        let cell = &mut self.content[index];
        let filled = cell[Self::SLOTS] as usize;
        if filled > Self::SLOTS {
            return self.remove_from_list(index, i);
        }
        // The last one takes the place; without a branch, since any of them may be the one.
        let last = cell[filled - 1];
        for slot in &mut cell[..Self::SLOTS] {
            *slot = if *slot == word::<D>(i) { last } else { *slot };
        }
        cell[Self::SLOTS] -= 1;
    }

    #[cold]
    fn remove_from_list(&mut self, index: usize, i: usize) {
        let cell = &mut self.content[index];
        let head = slot(cell[Self::SLOTS - 1]);
        if let Some(slot) = cell[..Self::SLOTS - 1].iter_mut().find(|slot| **slot == word::<D>(i)) {
            *slot = word::<D>(head);
            cell[Self::SLOTS - 1] = self.places[head].next;
        } else if head == i {
            cell[Self::SLOTS - 1] = self.places[i].next;
        } else {
            let mut before = head;
            while self.places[before].next != word::<D>(i) {
                before = slot(self.places[before].next);
            }
            self.places[before].next = self.places[i].next;
        }
        // One particle left in the list is no list any more.
        if self.places[slot(cell[Self::SLOTS - 1])].next == NONE {
            cell[Self::SLOTS] -= 1;
        }
    }

    /// Moves a particle's place to the next cell along an axis, around a periodic box.
    #[inline]
    pub(crate) fn step(&mut self, i: usize, axis: usize, up: bool) {
        self.places[i].cell = self.beyond(i, axis, up);
    }

    /// The cell beyond a face of a particle's.
    #[inline]
    pub(crate) fn beyond(&self, i: usize, axis: usize, up: bool) -> [u16; D] {
        let last = (self.cells[axis] - 1) as u16;
        let mut cell = self.places[i].cell;
        cell[axis] = match (up, cell[axis]) {
            (true, c) if c == last => 0,
            (true, c) => c + 1,
            (false, 0) => last,
            (false, c) => c - 1,
        };
        cell
    }

    /// Puts a particle's place to the other end of the box, after a passage through a periodic face.
    pub(crate) fn step_around(&mut self, i: usize, axis: usize, up: bool) {
        self.places[i].cell[axis] = if up { 0 } else { (self.cells[axis] - 1) as u16 };
    }

    /// Collects the particles of all cells around a cell, that one included.
    #[inline]
    pub(crate) fn collect_around(&self, cell: [u16; D], found: &mut Candidates) {
        let site = self.sites.of(cell);
        self.collect(cell, &site.around, site.images, found);
    }

    /// The same, for the layer of cells that is new after a step into this cell.
    #[inline]
    pub(crate) fn collect_ahead(&self, cell: [u16; D], axis: usize, up: bool, found: &mut Candidates) {
        let site = self.sites.of(cell);
        self.collect(cell, &site.ahead[axis][usize::from(up)], site.images, found);
    }

    #[inline]
    fn collect(&self, cell: [u16; D], ways: &[Way], images: bool, found: &mut Candidates) {
        if images {
            found.images = true;
            self.collect_ways::<true>(cell, ways, found);
        } else {
            self.collect_ways::<false>(cell, ways, found);
        }
    }

    #[inline]
    fn collect_ways<const IMAGES: bool>(&self, cell: [u16; D], ways: &[Way], found: &mut Candidates) {
        found.reserve(WORDS * ways.len());
        let index = self.index(cell) as i32;
        let (list, mut count) = (found.list.as_mut_slice(), found.count);
        let mut overfull = 0;
        for way in ways {
            let cell = &self.content[(index + way.step) as usize];
            let words = if IMAGES { cell.map(|word| word.wrapping_add(way.away)) } else { *cell };
            list[count..][..WORDS].copy_from_slice(&words);
            count += cell[Self::SLOTS] as usize;
            overfull |= cell[Self::SLOTS];
        }
        if overfull as usize & WORDS != 0 {
            return ways.iter().for_each(|way| self.collect_cell((index + way.step) as usize, way.away, found));
        }
        found.count = count;
    }

    /// All the particles of one cell, in another image: `away` is added to the words. There must be room for its slots.
    #[inline]
    fn collect_cell(&self, index: usize, away: u32, found: &mut Candidates) {
        let cell = self.content[index];
        let words = cell.map(|word| word.wrapping_add(away));
        found.list[found.count..][..WORDS].copy_from_slice(&words);
        found.count += cell[Self::SLOTS] as usize;
        if cell[Self::SLOTS] as usize > Self::SLOTS {
            self.collect_list(index, away, found);
        }
    }

    #[cold]
    fn collect_list(&self, index: usize, away: u32, found: &mut Candidates) {
        found.count -= 2;
        let mut word = self.content[index][Self::SLOTS - 1];
        while word != NONE {
            found.reserve(1 + WORDS * 3usize.pow(D as u32));
            found.list[found.count] = word.wrapping_add(away);
            found.count += 1;
            word = self.places[slot(word)].next;
        }
    }

    /// The particles of the cell at this offset from another, if there is one.
    #[inline]
    pub(crate) fn collect_at(&self, cell: [u16; D], offset: [i32; D], found: &mut Candidates) {
        if let Some((index, image)) = self.at(cell, offset) {
            found.reserve(WORDS);
            found.images |= image != home::<D>();
            self.collect_cell(index, away::<D>(image), found);
        }
    }

    /// Index and image of the cell at this offset from another, if there is one.
    #[inline]
    pub(crate) fn at(&self, cell: [u16; D], offset: [i32; D]) -> Option<(usize, u8)> {
        let (mut index, mut image, mut digit) = (0, 0, 1);
        for k in 0..D {
            let (place, cells) = (i32::from(cell[k]) + offset[k], self.cells[k] as i32);
            let turns = place.div_euclid(cells);
            if turns != 0 && self.axes[k] != Axis::Periodic {
                return None;
            }
            index += place.rem_euclid(cells) as u32 * self.stride[k];
            image += digit * (turns + 1) as u8;
            digit *= 3;
        }
        Some((index as usize, image))
    }

    #[inline]
    pub(crate) fn prefetch_place(&self, i: usize) {
        prefetch(&self.places, i);
    }

    /// Asks for the cell a particle is in.
    #[inline]
    pub(crate) fn prefetch_own(&self, i: usize) {
        prefetch(&self.content, self.index(self.places[i].cell));
    }

    /// Asks for the cells around a cell: a row of three lies in one piece, of one line or two.
    #[inline]
    pub(crate) fn prefetch_around(&self, cell: [u16; D]) {
        let index = self.index(cell) as i32;
        for row in self.sites.of(cell).around.as_chunks::<3>().0 {
            prefetch(&self.content, (index + row[0].step) as usize);
            prefetch(&self.content, (index + row[2].step) as usize);
        }
    }

    /// Asks for a cell and the layer of cells that is new after a step into it.
    #[inline]
    pub(crate) fn prefetch_ahead(&self, cell: [u16; D], axis: usize, up: bool) {
        let index = self.index(cell) as i32;
        prefetch(&self.content, index as usize);
        for way in &self.sites.of(cell).ahead[axis][usize::from(up)] {
            prefetch(&self.content, (index + way.step) as usize);
        }
    }

    /// Bytes held.
    pub(crate) fn memory(&self) -> usize {
        self.content.capacity() * size_of::<Cell<WORDS>>() + self.places.capacity() * size_of::<Place<D>>()
    }
}

/// How a particle is noted in its cell.
#[inline]
fn word<const D: usize>(i: usize) -> u32 {
    Neighbour::new(i as u32, home::<D>()).word()
}

#[inline]
fn slot(word: u32) -> usize {
    Neighbour::from_word(word).slot()
}
