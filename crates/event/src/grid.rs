//! Cells that tell which particles are near which.

use corpuscle_core::{Axis, Boundary, Vector};

pub(crate) const NONE: u32 = u32::MAX;
/// Index contribution of a neighbour that does not exist: it lifts the sum beyond every cell.
const OUTSIDE: u32 = 1 << 30;

/// A grid of cells over the box, each with a list of the small particles whose centres are in it.
///
/// *Small* particles have diameters below the width of a cell, so that two of them touch only from the same or from
/// adjacent cells. *Large* ones are in no cell's list, but have a place in the grid like the others: from it follows
/// which cells a large particle's surface can reach while its centre stays where it is. A periodic neighbour comes
/// with its explicit shift, so boxes of one or two cells are exact as well. Across open axes the outermost cells have
/// no end.
#[derive(Clone, Debug)]
pub(crate) struct Grid<const D: usize> {
    lower: Vector<D>,
    upper: Vector<D>,
    width: Vector<D>,
    axes: [Axis; D],
    cells: [u32; D],
    stride: [u32; D],
    content: Vec<Cell>,
    places: Vec<Place<D>>,
    /// All of `{-1, 0, 1}^D`, plus one.
    around: Vec<[u8; D]>,
    /// The part of them that is new after a step down or up along an axis.
    ahead: [[Vec<[u8; D]>; 2]; D],
    /// Indices of the large particles.
    large: Vec<u32>,
    /// For each of them, the cells its surface can reach.
    reach: Vec<Vec<[i32; D]>>,
    /// Shifts of a large particle's periodic images.
    images: Vec<[i8; D]>,
}

/// Where a particle is: its cell, and the one after it in the list of an overfull cell.
#[derive(Clone, Copy, Debug)]
struct Place<const D: usize> {
    next: u32,
    cell: [u16; D],
}

const SLOTS: usize = 6;

/// The particles of a cell: the first few side by side, so that they can be copied without looking how many there are;
/// any more in a list threaded through the particles.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
struct Cell {
    slots: [u32; SLOTS],
    filled: u32,
    more: u32,
}

impl Cell {
    const EMPTY: Self = Self { slots: [NONE; SLOTS], filled: 0, more: NONE };
}

/// The candidates for a collision: memory that is used again and again.
#[derive(Clone, Debug, Default)]
pub(crate) struct Candidates {
    /// Particles, and the number of the neighbour cell (an offset in base three) each was found in.
    pub(crate) index: Vec<u32>,
    pub(crate) cell: Vec<u8>,
    pub(crate) count: usize,
    /// Those of them that pass a first test.
    pub(crate) chosen: Vec<u32>,
}

impl Candidates {
    /// Makes room for this many in all.
    #[inline]
    fn reserve(&mut self, count: usize) {
        if self.index.len() < count {
            self.index.resize(2 * count, 0);
            self.cell.resize(2 * count, 0);
            self.chosen.resize(2 * count, 0);
        }
    }
}

/// The neighbourhood of one cell: index contributions, images and shifts of the lower, own and upper layer along each
/// axis.
#[derive(Clone, Copy)]
pub(crate) struct Neighbourhood<const D: usize> {
    part: [[u32; 3]; D],
    image: [[i8; 3]; D],
    shift: [[f64; 3]; D],
    /// Every neighbour exists, in the primary image.
    pub(crate) inside: bool,
}

impl<const D: usize> Neighbourhood<D> {
    /// Image and shift of the neighbour cell of this number.
    #[inline]
    pub(crate) fn image(&self, number: u8) -> ([i8; D], Vector<D>) {
        let layer = |k: usize| DIGITS[number as usize & 31][k] as usize;
        (std::array::from_fn(|k| self.image[k][layer(k)]), Vector::from_fn(|k| self.shift[k][layer(k)]))
    }
}

/// The digits of the numbers up to 27 in base three. (32 of them, so that five bits are an index.)
const DIGITS: [[u8; 3]; 32] = {
    let mut digits = [[0; 3]; 32];
    let mut number = 0;
    while number < 27 {
        digits[number] = [(number % 3) as u8, (number / 3 % 3) as u8, (number / 9) as u8];
        number += 1;
    }
    digits
};

impl<const D: usize> Grid<D> {
    pub(crate) fn new(boundary: &Boundary<D>, position: impl Fn(usize) -> Vector<D>, radii: &[f64]) -> Self {
        let (extent, count) = (boundary.extent(), radii.len());
        let mut width = cell_width(boundary, radii);
        let cells = loop {
            let cells: [u32; D] = std::array::from_fn(|k| (extent[k] / width).floor().clamp(1.0, 60_000.0) as u32);
            // Thin boxes have one layer of cells however wide, and would have too many along the other axes.
            if cells.iter().map(|&n| f64::from(n)).product::<f64>() <= 8.0 * count as f64 + 64.0 {
                break cells;
            }
            width *= 1.25;
        };
        let mut stride = [1; D];
        for k in 1..D {
            stride[k] = stride[k - 1] * cells[k - 1];
        }
        let around = offsets::<D>();
        let ahead = std::array::from_fn(|k| {
            [0, 2].map(|layer| around.iter().copied().filter(|offset| offset[k] == layer).collect::<Vec<_>>())
        });
        let mut grid = Self {
            lower: boundary.lower,
            upper: boundary.upper,
            width: Vector::from_fn(|k| extent[k] / f64::from(cells[k])),
            axes: boundary.axes,
            cells,
            stride,
            content: vec![Cell::EMPTY; cells.iter().product::<u32>() as usize],
            places: Vec::with_capacity(count),
            around,
            ahead,
            large: vec![],
            reach: vec![],
            images: vec![],
        };
        // The margin, wider than rounding, lets a pair become neighbours before it can touch.
        let small = |radius: f64| 2.0 * radius * (1.0 + 0.9e-6) <= width;
        for (i, &radius) in radii.iter().enumerate() {
            let r = position(i);
            let cell = std::array::from_fn(|k| {
                ((r[k] - grid.lower[k]) / grid.width[k]).floor().clamp(0.0, f64::from(grid.cells[k] - 1)) as u16
            });
            grid.places.push(Place { next: NONE, cell });
            if small(radius) {
                grid.insert(i as u32);
            } else {
                grid.large.push(i as u32);
            }
        }
        grid.images = grid.around.iter().map(|offset| offset.map(|o| o as i8 - 1)).collect();
        grid.images.retain(|image| (0..D).all(|k| image[k] == 0 || grid.axes[k] == Axis::Periodic));
        let largest_small = radii.iter().copied().filter(|&radius| small(radius)).fold(0.0, f64::max);
        grid.reach = grid.large.iter().map(|&i| grid.reach_of(radii[i as usize], largest_small)).collect();
        grid
    }

    /// Offsets of all cells in which a small particle can touch a sphere of this radius centred in the cell of offset 0.
    fn reach_of(&self, radius: f64, largest_small: f64) -> Vec<[i32; D]> {
        let far = (radius + largest_small) * (1.0 + 1e-6);
        let near = radius * (1.0 - 1e-6);
        let reach: [i32; D] = std::array::from_fn(|k| (far / self.width[k]).ceil() as i32);
        let total: i64 = reach.iter().map(|&n| i64::from(2 * n + 1)).product();
        // Where outer cells have no end, distances say nothing.
        let closed = !self.axes.contains(&Axis::Open);
        (0..total)
            .map(|mut number| {
                std::array::from_fn(|k| {
                    let sides = i64::from(2 * reach[k] + 1);
                    let offset = (number % sides) as i32 - reach[k];
                    number /= sides;
                    offset
                })
            })
            .filter(|offset: &[i32; D]| {
                let gap = |layers: i32| -> f64 {
                    Vector::<D>::from_fn(|k| f64::from((offset[k].abs() + layers).max(0)) * self.width[k]).norm()
                };
                !closed || (gap(-1) <= far && gap(1) >= near)
            })
            .collect()
    }

    #[inline]
    fn index(&self, cell: [u16; D]) -> usize {
        cell.iter().zip(&self.stride).map(|(&c, stride)| u32::from(c) * stride).sum::<u32>() as usize
    }

    #[inline]
    fn insert(&mut self, i: u32) {
        let place = self.index(self.places[i as usize].cell);
        let cell = &mut self.content[place];
        if let Some(slot) = cell.slots.get_mut(cell.filled as usize) {
            *slot = i;
            cell.filled += 1;
        } else {
            self.places[i as usize].next = std::mem::replace(&mut cell.more, i);
        }
    }

    #[inline]
    fn remove(&mut self, i: u32) {
        let place = self.index(self.places[i as usize].cell);
        let cell = &mut self.content[place];
        let Some(slot) = cell.slots[..cell.filled as usize].iter().position(|&j| j == i) else {
            return self.remove_from_list(place, i);
        };
        if cell.more == NONE {
            cell.filled -= 1;
            cell.slots[slot] = cell.slots[cell.filled as usize];
        } else {
            cell.slots[slot] = cell.more;
            cell.more = self.places[cell.more as usize].next;
        }
    }

    #[cold]
    fn remove_from_list(&mut self, place: usize, i: u32) {
        let next = self.places[i as usize].next;
        if self.content[place].more == i {
            self.content[place].more = next;
            return;
        }
        let mut before = self.content[place].more;
        while self.places[before as usize].next != i {
            before = self.places[before as usize].next;
        }
        self.places[before as usize].next = next;
    }

    #[inline]
    pub(crate) fn is_large(&self, i: u32) -> Option<usize> {
        if self.large.is_empty() { None } else { self.large.binary_search(&i).ok() }
    }

    /// The coordinate of the face at which a particle leaves its cell, and whether that is a periodic face of the box.
    /// Infinity where the cell has no end, or a wall comes first.
    #[inline]
    pub(crate) fn exit(&self, i: u32, axis: usize, up: bool) -> (f64, bool) {
        let cell = u32::from(self.places[i as usize].cell[axis]);
        if up {
            if cell + 1 < self.cells[axis] {
                (self.lower[axis] + f64::from(cell + 1) * self.width[axis], false)
            } else if self.axes[axis] == Axis::Periodic {
                (self.upper[axis], true)
            } else {
                (f64::INFINITY, false)
            }
        } else if cell > 0 {
            (self.lower[axis] + f64::from(cell) * self.width[axis], false)
        } else if self.axes[axis] == Axis::Periodic {
            (self.lower[axis], true)
        } else {
            (f64::NEG_INFINITY, false)
        }
    }

    /// Moves a particle to the next cell along an axis, around a periodic box.
    pub(crate) fn step(&mut self, i: u32, axis: usize, up: bool) {
        let large = self.is_large(i).is_some();
        if !large {
            self.remove(i);
        }
        let cell = &mut self.places[i as usize].cell[axis];
        let last = (self.cells[axis] - 1) as u16;
        *cell = match (up, *cell) {
            (true, c) if c == last => 0,
            (true, c) => c + 1,
            (false, 0) => last,
            (false, c) => c - 1,
        };
        if !large {
            self.insert(i);
        }
    }

    /// The cells around that of `i`.
    #[inline]
    pub(crate) fn neighbourhood(&self, i: u32) -> Neighbourhood<D> {
        let cell = self.places[i as usize].cell;
        let mut around = Neighbourhood { part: [[0; 3]; D], image: [[0; 3]; D], shift: [[0.0; 3]; D], inside: true };
        for (k, &place) in cell.iter().enumerate() {
            let (c, last, stride) = (u32::from(place), self.cells[k] - 1, self.stride[k]);
            let here = c * stride;
            around.part[k] = [here.wrapping_sub(stride), here, here + stride];
            let side = self.upper[k] - self.lower[k];
            if c == 0 {
                around.part[k][0] = self.beyond(k, last * stride);
                (around.image[k][0], around.shift[k][0], around.inside) = (-1, -side, false);
            }
            if c == last {
                around.part[k][2] = self.beyond(k, 0);
                (around.image[k][2], around.shift[k][2], around.inside) = (1, side, false);
            }
        }
        around
    }

    #[inline]
    fn beyond(&self, axis: usize, around: u32) -> u32 {
        if self.axes[axis] == Axis::Periodic { around } else { OUTSIDE }
    }

    /// Collects all small particles in the cells of a neighbourhood, the one in its middle included.
    #[inline]
    pub(crate) fn collect_around(&self, around: &Neighbourhood<D>, found: &mut Candidates) {
        self.collect(around, &self.around, found);
    }

    /// The same, for the layer of cells that is new after a step.
    #[inline]
    pub(crate) fn collect_ahead(&self, around: &Neighbourhood<D>, axis: usize, up: bool, found: &mut Candidates) {
        self.collect(around, &self.ahead[axis][usize::from(up)], found);
    }

    #[inline]
    fn collect(&self, around: &Neighbourhood<D>, offsets: &[[u8; D]], found: &mut Candidates) {
        if around.inside {
            self.collect_from::<true>(around, offsets, found);
        } else {
            self.collect_from::<false>(around, offsets, found);
        }
    }

    /// `INSIDE`: every neighbour cell exists, in the primary image.
    fn collect_from<const INSIDE: bool>(&self, around: &Neighbourhood<D>, offsets: &[[u8; D]], found: &mut Candidates) {
        let mut count = 0;
        found.reserve(SLOTS * offsets.len());
        for offset in offsets {
            let (mut cell, mut number) = (0, 0);
            for k in (0..D).rev() {
                cell += around.part[k][offset[k] as usize];
                number = number * 3 + offset[k];
            }
            let Some(cell) = self.content.get(cell as usize) else { continue };
            found.index[count..count + SLOTS].copy_from_slice(&cell.slots);
            if !INSIDE {
                found.cell[count..count + SLOTS].fill(number);
            }
            count += cell.filled as usize;
            let mut j = cell.more;
            while j != NONE {
                found.reserve(count + 1 + SLOTS * offsets.len());
                (found.index[count], found.cell[count]) = (j, number);
                count += 1;
                j = self.places[j as usize].next;
            }
        }
        found.count = count;
    }

    /// All small particles in the cells that the surface of a large one can reach; `number` counts the large ones.
    pub(crate) fn visit_reach(&self, number: usize, mut visit: impl FnMut(u32, Vector<D>, [i8; D])) {
        let home = self.places[self.large[number] as usize].cell;
        'cells: for offset in &self.reach[number] {
            let (mut cell, mut image) = (0, [0; D]);
            for k in 0..D {
                let (place, cells) = (i32::from(home[k]) + offset[k], self.cells[k] as i32);
                let turns = place.div_euclid(cells);
                if turns != 0 && self.axes[k] != Axis::Periodic {
                    continue 'cells;
                }
                image[k] = turns as i8;
                cell += place.rem_euclid(cells) as u32 * self.stride[k];
            }
            let (cell, shift) = (&self.content[cell as usize], self.shift(image));
            cell.slots[..cell.filled as usize].iter().for_each(|&j| visit(j, shift, image));
            let mut j = cell.more;
            while j != NONE {
                visit(j, shift, image);
                j = self.places[j as usize].next;
            }
        }
    }

    /// All large particles, each in all periodic images.
    #[inline]
    pub(crate) fn visit_large(&self, mut visit: impl FnMut(u32, Vector<D>, [i8; D])) {
        for &j in &self.large {
            for &image in &self.images {
                visit(j, self.shift(image), image);
            }
        }
    }

    /// The shift of a periodic image.
    #[inline]
    pub(crate) fn shift(&self, image: [i8; D]) -> Vector<D> {
        Vector::from_fn(|k| f64::from(image[k]) * (self.upper[k] - self.lower[k]))
    }
}

/// All of `{0, 1, 2}^D`.
fn offsets<const D: usize>() -> Vec<[u8; D]> {
    (0..3usize.pow(D as u32)).map(|number| std::array::from_fn(|k| (number / 3usize.pow(k as u32) % 3) as u8)).collect()
}

/// Mean number of particles in a cell below which finer cells only cost crossings. Measured: docs/performance.md.
const OCCUPANCY: f64 = 0.5;

/// The cell width with the least estimated work; particles of larger diameter count as large.
///
/// Work of a collision, in pair tests: a small particle looks into `3^D` cells and at each large one's images; a large
/// one, which collides more often the larger its surface, looks into every cell its surface reaches.
fn cell_width<const D: usize>(boundary: &Boundary<D>, radii: &[f64]) -> f64 {
    let extent = boundary.extent();
    let longest = extent.0.into_iter().fold(0.0, f64::max);
    let mut sorted = radii.to_vec();
    sorted.sort_by(f64::total_cmp);
    let largest = sorted.last().copied().unwrap_or(0.0);
    if largest == 0.0 {
        // Points never meet.
        return 2.0 * longest;
    }
    let (volume, n, d) = (boundary.volume(), radii.len() as f64, D as i32);
    let periodic = boundary.axes.iter().filter(|&&axis| axis == Axis::Periodic).count() as i32;
    let mut best = (f64::INFINITY, 2.0 * largest);
    let mut previous = 0.0;
    for (m, &radius) in sorted.iter().enumerate().rev() {
        // Of nearly equal radii only the largest can be the border.
        if previous > 0.0 && radius > 0.95 * previous {
            continue;
        }
        previous = radius;
        let small = m as f64 + 1.0;
        let width = (2.0 * radius * (1.0 + 1e-6)).max((OCCUPANCY * volume / n).powf(1.0 / f64::from(d)));
        let looked_at = 3f64.powi(d) * (0.3 + small * width.powi(d) / volume);
        let large = n - small;
        let mut work = small * (looked_at + large * 3f64.powi(periodic));
        for &big in sorted[m + 1..].iter().step_by(1 + (sorted.len() - m) / 64) {
            let stride = (1 + (sorted.len() - m) / 64) as f64;
            work += stride * (big / width + 1.0).powi(d - 1) * (2.0 * big / width + 3.0).powi(d);
        }
        if work < best.0 {
            best = (work, width);
        }
    }
    best.1
}
