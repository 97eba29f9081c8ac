//! Places of particles that slide by: the last few blocks of them, in a ring.

use std::ops::Range;

use corpuscle_core::Vector;

/// The places of the latest particles of a row, block by block. Any `block` of them that follow one another lie in memory so.
pub(super) struct Ring<const D: usize> {
    /// A block more than there is room for: the first block once more, so that nobody has to look beyond the end.
    places: Vec<Vector<D>>,
    block: usize,
    /// Where particle 0 is.
    shift: usize,
}

impl<const D: usize> Ring<D> {
    /// Room for a block, what follows it and what goes before it as far as `reach`. The first places put in are those of particles
    /// `-before.len()` to -1, at most `reach` of them.
    pub(super) fn new(block: usize, reach: usize, before: &[Vector<D>]) -> Self {
        let around = reach.div_ceil(block);
        let mut ring = Self { places: vec![Vector::ZERO; (2 * around + 2) * block], block, shift: around * block };
        let first = ring.shift - before.len();
        ring.places[first..ring.shift].copy_from_slice(before);
        ring.repeat(first..ring.shift);
        ring
    }

    /// After so many places they are found from the first on again.
    pub(super) fn room(&self) -> usize {
        2 * self.shift + self.block
    }

    /// Where to find this particle's place, and those of a block from it on. It may be one before particle 0.
    #[inline]
    pub(super) fn at(&self, particle: isize) -> usize {
        (particle + self.shift as isize) as usize % self.room()
    }

    /// All that is kept; see [`at`](Self::at).
    pub(super) fn places(&self) -> &[Vector<D>] {
        &self.places
    }

    /// Where the places of these particles, some of one block, go. [`close`](Self::close) is due afterwards.
    pub(super) fn open(&mut self, particles: Range<usize>) -> &mut [Vector<D>] {
        let first = self.at(particles.start as isize);
        &mut self.places[first..first + particles.len()]
    }

    /// Ends what [`open`](Self::open) began.
    pub(super) fn close(&mut self, particles: Range<usize>) {
        let first = self.at(particles.start as isize);
        self.repeat(first..first + particles.len());
    }

    /// What of these places is of the first block comes once more at the end.
    fn repeat(&mut self, places: Range<usize>) {
        let (first, end) = (places.start, places.end.min(self.block));
        if first < end {
            let again = first + self.room();
            self.places.copy_within(first..end, again);
        }
    }

    /// Takes places in.
    pub(super) fn put(&mut self, first: usize, places: &[Vector<D>]) {
        let particles = first..first + places.len();
        self.open(particles.clone()).copy_from_slice(places);
        self.close(particles);
    }

    /// Takes in, of the places `after` those of `count` particles, what is in a block.
    pub(super) fn put_after(&mut self, block: usize, count: usize, after: &[Vector<D>]) {
        let (first, end) = ((block * self.block).max(count), ((block + 1) * self.block).min(count + after.len()));
        if first < end {
            self.put(first, &after[first - count..end - count]);
        }
    }
}
