//! Candidates from neighbour lists: for dense systems of about equal spheres.

use corpuscle_core::instructions::prefetch;
use corpuscle_core::{Boundary, Vector};

use super::bins::Bins;
use super::candidates::Candidates;
use crate::lanes::LANES;
use crate::motion::Flight;
use crate::pages::filled;
use crate::search::{Images, Neighbour, home, opposite};

/// For each particle those that it can touch while both stay in their own small boxes.
///
/// The box of a particle is a cube around where it was when the box was made. Two particles are in each other's lists if
/// their boxes come closer than a contact distance; so no list changes until a particle leaves its box. Then it gets a new
/// box, and its entries in lists, its own and those of its old and new neighbours, are made anew: the lists are always
/// complete and symmetric.
#[derive(Clone, Debug)]
pub(crate) struct Lists<const D: usize> {
    /// For each particle a row: the number of neighbours, then these, then the particle itself up to the end of the row: a
    /// candidate that is never met.
    rows: Vec<u32>,
    stride: usize,
    /// The centres of the boxes, in single precision: they are where they are put.
    centres: Vec<[f32; D]>,
    /// Which of the old neighbours are neighbours of a new box as well.
    kept: Vec<[u32; LANES]>,
    /// Half the side of a particle's box.
    half: f64,
    /// Boxes closer than this, squared, make neighbours.
    reach: f64,
    bins: Bins<D, 8>,
}

/// Words of a row before the neighbours.
const HEAD: usize = 1;

/// Half the side of a box, in units of the largest diameter. Measured: docs/performance.md.
const fn half_side<const D: usize>() -> f64 {
    if D == 2 { 0.25 } else { 0.2 }
}

/// The packing fraction above which lists serve better than cells. Measured: docs/performance.md.
const fn dense<const D: usize>() -> f64 {
    if D == 2 { 0.62 } else { 0.4 }
}

impl<const D: usize> Lists<D> {
    /// The contact distance and half the side of the boxes to use, if lists suit the system.
    fn fit(boundary: &Boundary<D>, flights: &[Flight<D>]) -> Option<(f64, f64)> {
        let radius = flights.iter().map(|flight| flight.radius).fold(0.0, f64::max);
        let smallest = flights.iter().map(|flight| flight.radius).fold(f64::INFINITY, f64::min);
        let volume = flights.iter().map(|flight| corpuscle_core::particles::ball_volume::<D>(flight.radius)).sum::<f64>();
        let packing = volume / boundary.volume();
        let half = half_side::<D>() * 2.0 * radius;
        let reach = 2.0 * radius + 2.0 * half;
        let extent = boundary.extent();
        // Each neighbour in one image only, and centres as single-precision numbers fine enough.
        let fits = (0..D).all(|k| extent[k] > 3.5 * reach && extent[k].max(boundary.upper[k].abs()) < 1e4 * half);
        let closed = boundary.is_closed();
        (packing > dense::<D>() && smallest > 0.5 * radius && fits && closed).then_some((2.0 * radius, half))
    }

    /// Lists for these particles, if lists suit them. `position`: where each is now.
    pub(crate) fn new(
        boundary: &Boundary<D>,
        flights: &[Flight<D>],
        position: impl Fn(usize) -> Vector<D>,
        images: &Images<D>,
        found: &mut Candidates,
    ) -> Option<Self> {
        let (contact, half) = Self::fit(boundary, flights)?;
        let reach = contact * (1.0 + 1e-6);
        let bins = Bins::new(boundary, reach + 2.0 * half, flights.len(), 8.0 * flights.len() as f64 + 64.0);
        let (rows, kept, centres) = (vec![], vec![], filled([0.0; D], flights.len()));
        let mut lists = Self { rows, stride: 0, centres, kept, half, reach: reach * reach, bins };
        lists.widen(HEAD + if D == 2 { 8 } else { 16 }, flights.len());
        for i in 0..flights.len() {
            lists.set_centre(i, position(i));
            lists.bins.insert(i);
        }
        for i in 0..flights.len() {
            lists.find_near(i, images, found);
            for &word in found.found() {
                lists.push(i, Neighbour::from_word(word));
            }
        }
        Some(lists)
    }

    #[inline]
    pub(crate) fn centre(&self, i: usize) -> Vector<D> {
        Vector(self.centres[i].map(f64::from))
    }

    fn set_centre(&mut self, i: usize, r: Vector<D>) {
        self.centres[i] = r.0.map(|x| x as f32);
        let centre = self.centre(i);
        self.bins.locate(i, self.bins.cell_of(centre));
    }

    /// The bins in which the centres of the boxes are.
    pub(crate) fn bins(&self) -> &Bins<D, 8> {
        &self.bins
    }

    /// Half the side of the boxes.
    pub(crate) fn half(&self) -> f64 {
        self.half
    }

    /// The neighbours of a particle (words), filled up to a whole number of blocks; and whether some are periodic images.
    #[inline]
    pub(crate) fn neighbours(&self, i: usize) -> (&[u32], bool) {
        let row = &self.rows[i * self.stride..(i + 1) * self.stride];
        let (count, images) = unpack(row[0]);
        (&row[HEAD..][..count.next_multiple_of(LANES)], images != 0)
    }

    /// The coordinate of a face of a particle's box.
    #[inline]
    pub(crate) fn face(&self, i: usize, axis: usize, up: bool) -> f64 {
        f64::from(self.centres[i][axis]) + if up { self.half } else { -self.half }
    }

    /// Gives a particle a new box around where it is now, and the neighbours that come with it.
    pub(crate) fn move_box(&mut self, i: usize, r: Vector<D>, images: &Images<D>, found: &mut Candidates) {
        self.bins.remove(i);
        self.set_centre(i, r);
        self.bins.insert(i);
        self.find_near(i, images, found);
        self.part(i, found);
        for &word in found.found() {
            let other = Neighbour::from_word(word);
            self.push(i, other);
            self.push(other.slot(), Neighbour::new(i as u32, opposite::<D>(other.image() as u8)));
        }
    }

    /// All others whose boxes are near.
    fn find_near(&self, i: usize, images: &Images<D>, found: &mut Candidates) {
        self.collect_around(i, found);
        let centre = self.centre(i);
        let mut near = 0;
        for number in 0..found.found().len() {
            let word = found.found()[number];
            let other = Neighbour::from_word(word);
            let r = self.centre(other.slot()) - centre + images.shift(other);
            let gap = Vector::<D>::from_fn(|k| (r[k].abs() - 2.0 * self.half).max(0.0));
            // Kept or overwritten by the next: without a branch, since either is likely.
            found.put(near, word);
            near += usize::from((gap.norm_squared() < self.reach) & (other.slot() != i));
        }
        found.truncate(near);
    }

    /// Ends the neighbourhood with those that are not among the found, and leaves only those of them that are new.
    ///
    /// A box moves by a part of its side, so most neighbours stay: their rows are not touched.
    fn part(&mut self, i: usize, found: &mut Candidates) {
        let row = i * self.stride;
        let (count, _) = unpack(self.rows[row]);
        // Whole blocks, which are compared at once; beyond the count only the particle itself.
        let blocks = self.rows[row + HEAD..row + self.stride].as_chunks::<LANES>().0;
        let blocks = &blocks[..count.div_ceil(LANES)];
        self.kept.clear();
        self.kept.resize(blocks.len(), [0; LANES]);
        let mut new = 0;
        for number in 0..found.found().len() {
            let word = found.found()[number];
            let mut known = [0; LANES];
            for (kept, old) in self.kept.iter_mut().zip(blocks) {
                for lane in 0..LANES {
                    let same = u32::from(old[lane] == word);
                    kept[lane] |= same;
                    known[lane] |= same;
                }
            }
            found.put(new, word);
            new += usize::from(known == [0; LANES]);
        }
        found.truncate(new);
        // From the last on, since the last takes the place of one that goes.
        for at in (0..count).rev() {
            if self.kept[at / LANES][at % LANES] == 0 {
                let other = Neighbour::from_word(self.rows[row + HEAD + at]);
                self.remove(other.slot(), Neighbour::new(i as u32, opposite::<D>(other.image() as u8)));
                self.remove(i, other);
            }
        }
    }

    #[inline]
    fn push(&mut self, i: usize, neighbour: Neighbour) {
        let row = i * self.stride;
        let (count, _) = unpack(self.rows[row]);
        if count % LANES == 0 && HEAD + count + LANES > self.stride {
            self.widen(LANES, self.rows.len() / self.stride);
            return self.push(i, neighbour);
        }
        self.rows[row + HEAD + count] = neighbour.word();
        self.rows[row] += 1 + (u32::from(neighbour.image() != home::<D>() as usize) << 16);
    }

    /// Takes a neighbour out of the row of a particle.
    #[inline]
    fn remove(&mut self, i: usize, neighbour: Neighbour) {
        let start = i * self.stride;
        let row = &mut self.rows[start..start + self.stride];
        let (count, _) = unpack(row[0]);
        let last = row[HEAD + count - 1];
        // Without a branch: any of them may be the one.
        for entry in &mut row[HEAD..][..count] {
            *entry = if *entry == neighbour.word() { last } else { *entry };
        }
        row[HEAD + count - 1] = Neighbour::new(i as u32, home::<D>()).word();
        row[0] -= 1 + (u32::from(neighbour.image() != home::<D>() as usize) << 16);
    }

    /// Makes the rows of all particles longer.
    #[cold]
    fn widen(&mut self, more: usize, particles: usize) {
        let stride = self.stride + more;
        let mut rows = filled(0, particles * stride);
        for i in 0..particles {
            let row = &mut rows[i * stride..(i + 1) * stride];
            row[HEAD..].fill(Neighbour::new(i as u32, home::<D>()).word());
            if let Some(old) = self.rows.get(i * self.stride..(i + 1) * self.stride) {
                row[..self.stride].copy_from_slice(old);
            }
        }
        (self.rows, self.stride) = (rows, stride);
    }

    #[inline]
    pub(crate) fn prefetch_row(&self, i: usize) {
        prefetch(&self.rows, i * self.stride);
        prefetch(&self.rows, i * self.stride + 16);
        prefetch(&self.centres, i);
    }

    /// Asks for the centre of a box.
    #[inline]
    pub(crate) fn prefetch_centre(&self, i: usize) {
        prefetch(&self.centres, i);
    }

    /// Asks for the bins that a new box will look at.
    #[inline]
    pub(crate) fn prefetch_around(&self, i: usize) {
        self.bins.prefetch_around(self.bins.cell(i));
    }

    /// All whose boxes may be near.
    #[inline]
    pub(crate) fn collect_around(&self, i: usize, found: &mut Candidates) {
        found.clear();
        self.bins.collect_around(self.bins.cell(i), found);
    }

    pub(crate) fn memory(&self) -> usize {
        self.rows.capacity() * size_of::<u32>() + self.centres.capacity() * size_of::<[f32; D]>() + self.bins.memory()
    }
}

/// How many neighbours there are, and how many of them are periodic images.
#[inline]
fn unpack(word: u32) -> (usize, usize) {
    ((word & 0xffff) as usize, (word >> 16) as usize)
}
