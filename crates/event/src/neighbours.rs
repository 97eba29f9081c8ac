//! Who is near whom: cells where particles are far apart, neighbour lists where they are dense.

mod bins;
mod candidates;
mod cells;
mod lists;
mod reach;
mod region;
mod sites;

use corpuscle_core::instructions::prefetch;
use corpuscle_core::{Boundary, Vector};

pub(crate) use candidates::Candidates;
pub(crate) use cells::Cells;
pub(crate) use lists::Lists;

use crate::motion::Flight;
use crate::plan::Exit;
use crate::search::Images;

/// One of the two ways; the density decides.
#[derive(Clone, Debug)]
pub(crate) enum Neighbours<const D: usize> {
    Cells(Cells<D>),
    Lists(Lists<D>),
}

impl<const D: usize> Neighbours<D> {
    /// `position`: where each particle is now. Pairs meet at the sum of the radii or farther in, but no centre comes nearer
    /// to another than `core` of its radius.
    pub(crate) fn new(
        boundary: &Boundary<D>,
        flights: &[Flight<D>],
        core: f64,
        position: impl Fn(usize) -> Vector<D>,
        images: &Images<D>,
        found: &mut Candidates,
    ) -> Self {
        Lists::new(boundary, flights, &position, images, found)
            .map_or_else(|| Self::Cells(Cells::new(boundary, flights, core, &position)), Self::Lists)
    }

    /// What a particle can touch (words), and perhaps some of the particles twice.
    #[inline]
    pub(crate) fn candidates<'a>(&'a self, i: usize, found: &'a mut Candidates) -> &'a [u32] {
        match self {
            Self::Cells(cells) => {
                cells.collect(i, found);
                found.found()
            }
            Self::Lists(lists) => lists.neighbours(i).0,
        }
    }

    /// What is looked at when a particle will have left its cell or box.
    #[inline]
    pub(crate) fn candidates_beyond<'a>(&self, i: usize, exit: Exit, found: &'a mut Candidates) -> &'a [u32] {
        match self {
            Self::Cells(cells) => cells.collect_beyond(i, exit, found),
            Self::Lists(lists) => lists.collect_around(i, found),
        }
        found.found()
    }

    /// Asks for the place of a particle.
    #[inline]
    pub(crate) fn prefetch_place(&self, i: usize) {
        match self {
            Self::Cells(cells) => cells.prefetch_place(i),
            Self::Lists(lists) => lists.prefetch_row(i),
        }
    }

    /// Asks for what tells the candidates of a particle.
    #[inline]
    pub(crate) fn prefetch_around(&self, i: usize) {
        match self {
            Self::Cells(cells) => cells.prefetch_around(i),
            Self::Lists(_) => {}
        }
    }

    /// Asks for what tells which particles are beyond a face.
    #[inline]
    pub(crate) fn prefetch_beyond(&self, i: usize, exit: Exit) {
        match self {
            Self::Cells(cells) => cells.prefetch_beyond(i, exit),
            Self::Lists(lists) => lists.prefetch_around(i),
        }
    }

    /// Asks for what is read first of a particle that may be beyond a face.
    #[inline]
    pub(crate) fn prefetch_candidate(&self, i: usize, flights: &[Flight<D>]) {
        match self {
            Self::Cells(_) => prefetch(flights, i),
            Self::Lists(lists) => lists.prefetch_centre(i),
        }
    }

    /// Bytes held.
    pub(crate) fn memory(&self) -> usize {
        match self {
            Self::Cells(cells) => cells.memory(),
            Self::Lists(lists) => lists.memory(),
        }
    }
}
