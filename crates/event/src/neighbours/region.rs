//! In which region a particle stays until its next step: what fixed things are looked up by.

use corpuscle_core::Vector;

use super::Neighbours;
use crate::motion::Flight;

impl<const D: usize> Neighbours<D> {
    /// Number of the region a particle is in until it leaves its cell or its box; none for one of a larger class of sizes.
    #[inline]
    pub(crate) fn region(&self, i: usize) -> Option<usize> {
        match self {
            Self::Cells(cells) => (cells.levels(i) == 1).then(|| cells.finest().index(cells.finest().cell(i))),
            Self::Lists(lists) => Some(lists.bins().index(lists.bins().cell(i))),
        }
    }

    /// Number of regions.
    pub(crate) fn region_count(&self) -> usize {
        match self {
            Self::Cells(cells) => cells.finest().count(),
            Self::Lists(lists) => lists.bins().count(),
        }
    }

    /// How far the surfaces of particles can be outside of the regions they are in.
    pub(crate) fn overhang(&self, flights: &[Flight<D>]) -> f64 {
        let radii = flights.iter().enumerate().filter(|&(i, _)| self.region(i).is_some()).map(|(_, flight)| flight.radius);
        let largest = radii.fold(0.0, f64::max);
        match self {
            Self::Cells(_) => largest,
            Self::Lists(lists) => largest + lists.half(),
        }
    }

    /// Numbers of all regions that meet a block; the outermost go on beyond the box except across periodic faces.
    pub(crate) fn regions_meeting(&self, lower: Vector<D>, upper: Vector<D>, visit: impl FnMut(usize)) {
        match self {
            Self::Cells(cells) => cells.finest().cells_meeting(lower, upper, visit),
            Self::Lists(lists) => lists.bins().cells_meeting(lower, upper, visit),
        }
    }
}
