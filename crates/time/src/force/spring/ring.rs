//! Places of particles that slide by: the last few blocks of them, in a ring.

use std::ops::Range;

use corpuscle_core::Vector;

/// The places of the latest particles of a row, block by block. Those of a block, and as many as far from it as springs reach, lie in
/// memory one after the other.
pub(super) struct Ring<const D: usize> {
    /// The last places once more, the ring, its first places once more: so that nobody has to look beyond an end.
    places: Vec<Vector<D>>,
    block: usize,
    /// Where particle 0 is in the ring.
    shift: usize,
    /// How many places are there once more before the ring and behind it.
    again: [usize; 2],
}

impl<const D: usize> Ring<D> {
    /// Room for a block, what follows it and what goes before it as far as `reach`. The first places put in are those of particles
    /// `-before.len()` to -1, at most `reach` of them.
    pub(super) fn new(block: usize, reach: usize, before: &[Vector<D>]) -> Self {
        let shift = reach.next_multiple_of(block);
        // Whoever is farther away than a block is found anywhere in the ring.
        let again = if reach < block { [reach; 2] } else { [0, block] };
        let places = vec![Vector::ZERO; again[0] + 2 * shift + block + again[1]];
        let mut ring = Self { places, block, shift, again };
        let first = shift - before.len();
        ring.places[again[0] + first..again[0] + shift].copy_from_slice(before);
        ring.repeat(first..shift);
        ring
    }

    /// After so many places they are found from the first on again.
    pub(super) fn room(&self) -> usize {
        2 * self.shift + self.block
    }

    /// Where to find the place of this particle.
    #[inline]
    pub(super) fn at(&self, particle: usize) -> usize {
        self.again[0] + (particle + self.shift) % self.room()
    }

    /// All that is kept; see [`at`](Self::at).
    pub(super) fn places(&self) -> &[Vector<D>] {
        &self.places
    }

    /// Where the places of these particles, some of one block, go. [`close`](Self::close) is due afterwards.
    pub(super) fn open(&mut self, particles: Range<usize>) -> &mut [Vector<D>] {
        let first = self.at(particles.start);
        &mut self.places[first..first + particles.len()]
    }

    /// Ends what [`open`](Self::open) began.
    pub(super) fn close(&mut self, particles: Range<usize>) {
        let first = self.at(particles.start) - self.again[0];
        self.repeat(first..first + particles.len());
    }

    /// Puts those of these places of the ring that are to be there once more before it and behind it.
    fn repeat(&mut self, ring: Range<usize>) {
        let (room, [before, behind]) = (self.room(), self.again);
        let (first, end) = (ring.start, ring.end.min(behind));
        if first < end {
            self.places.copy_within(before + first..before + end, before + room + first);
        }
        let (first, end) = (ring.start.max(room - before), ring.end);
        if first < end {
            self.places.copy_within(before + first..before + end, before + first - room);
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
