//! Places of particles that slide by: the last few blocks of them, in a ring.

use std::ops::Range;

use corpuscle_core::Vector;

use super::lattice::Around;

/// The places of the latest particles of a row: those of a block, of the one before and of the one behind it.
pub(super) struct Ring<const D: usize> {
    places: Vec<Vector<D>>,
    block: usize,
}

impl<const D: usize> Ring<D> {
    /// The first places put in are those of particles `-before.len()` to -1, at most a block of them.
    pub(super) fn new(block: usize, before: &[Vector<D>]) -> Self {
        let mut places = vec![Vector::ZERO; 3 * block];
        places[block - before.len()..block].copy_from_slice(before);
        Self { places, block }
    }

    /// Where to find the place of this particle.
    #[inline]
    fn at(&self, particle: usize) -> usize {
        (particle + self.block) % self.places.len()
    }

    /// The places around this particle.
    pub(super) fn around(&self, particle: usize) -> Around<'_, D> {
        Around { position: &self.places, own: self.at(particle) }
    }

    /// Where the places of these particles, some of one block, go.
    pub(super) fn open(&mut self, particles: Range<usize>) -> &mut [Vector<D>] {
        let first = self.at(particles.start);
        &mut self.places[first..first + particles.len()]
    }

    /// Takes in, of the places `after` those of `count` particles, what is in a block.
    pub(super) fn put_after(&mut self, block: usize, count: usize, after: &[Vector<D>]) {
        let (first, end) = ((block * self.block).max(count), ((block + 1) * self.block).min(count + after.len()));
        if first < end {
            self.open(first..end).copy_from_slice(&after[first - count..end - count]);
        }
    }
}
