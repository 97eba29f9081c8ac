//! The candidates of a search.

use crate::lanes::LANES;
use crate::search::Neighbour;

/// The particles found in some cells: memory that is used again and again.
#[derive(Clone, Debug, Default)]
pub(crate) struct Candidates {
    pub(super) list: Vec<u32>,
    pub(super) count: usize,
    /// Some of them are periodic images.
    pub(crate) images: bool,
}

impl Candidates {
    /// Those found, and more of `filler` up to a whole number of blocks.
    #[inline]
    pub(crate) fn padded(&mut self, filler: Neighbour) -> &[u32] {
        self.reserve(LANES);
        self.list[self.count..self.count + LANES].fill(filler.word());
        &self.list[..self.count.next_multiple_of(LANES)]
    }

    #[inline]
    pub(crate) fn clear(&mut self) {
        (self.count, self.images) = (0, false);
    }

    #[inline]
    pub(crate) fn push(&mut self, neighbour: Neighbour) {
        self.reserve(1);
        self.list[self.count] = neighbour.word();
        self.count += 1;
    }

    /// Overwrites one of those found.
    #[inline]
    pub(crate) fn put(&mut self, number: usize, word: u32) {
        self.list[number] = word;
    }

    /// Keeps the first of them only.
    #[inline]
    pub(crate) fn truncate(&mut self, count: usize) {
        self.count = count;
    }

    #[inline]
    pub(crate) fn found(&self) -> &[u32] {
        &self.list[..self.count]
    }

    #[inline]
    pub(super) fn reserve(&mut self, more: usize) {
        if self.list.len() < self.count + more {
            self.list.resize(2 * (self.count + more), 0);
        }
    }
}
