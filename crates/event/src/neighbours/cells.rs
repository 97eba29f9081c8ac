//! Candidates from cells: nested grids, one for each class of sizes.

use corpuscle_core::{Boundary, Vector};

use super::bins::Bins;
use super::candidates::Candidates;
use super::reach::Reach;
use crate::motion::Flight;
use crate::plan::Exit;

/// Grids for classes of sizes, the smallest first.
///
/// In the grid of its own class a particle finds others of the class in the cells around its own, since their diameters
/// are below the width of a cell. For each smaller class it also has a place in that grid, from which follows which cells
/// its surface can reach ([`Reach`]). Equal spheres need one grid.
#[derive(Clone, Debug)]
pub(crate) struct Cells<const D: usize> {
    levels: Vec<Level<D>>,
    /// The class of each particle; empty if there is one class.
    class: Vec<u8>,
}

#[derive(Clone, Debug)]
struct Level<const D: usize> {
    bins: Bins<D, 4>,
    reach: Reach<D>,
}

/// Cells are wider than the diameters by this, wider than rounding: pairs become neighbours before they can touch.
const MARGIN: f64 = 1.0 + 1e-6;

impl<const D: usize> Cells<D> {
    /// `position`: where each particle is now.
    pub(crate) fn new(boundary: &Boundary<D>, flights: &[Flight<D>], core: f64, position: impl Fn(usize) -> Vector<D>) -> Self {
        let count = flights.len();
        let mut class = vec![0; count];
        let mut levels = vec![];
        let mut rest: Vec<usize> = (0..count).collect();
        loop {
            let radii: Vec<f64> = rest.iter().map(|&i| flights[i].radius).collect();
            // At most 256 classes: the last takes all that are left.
            let width = if levels.len() == 255 {
                2.0 * MARGIN * radii.iter().copied().fold(0.0, f64::max)
            } else {
                cell_width(boundary, &radii)
            };
            let mut bins = Bins::new(boundary, width, count, 8.0 * (rest.len() + boundary.obstacles.len()) as f64 + 64.0);
            let fits = |radius: f64| 2.0 * radius * (1.0 + 0.9 * (MARGIN - 1.0)) <= width;
            let (mut largest, mut larger) = (0.0f64, vec![]);
            for &i in &rest {
                bins.locate(i, bins.cell_of(position(i)));
                if fits(flights[i].radius) {
                    bins.insert(i);
                    class[i] = levels.len() as u8;
                    largest = largest.max(flights[i].radius);
                } else {
                    larger.push((i, flights[i].radius));
                }
            }
            let reach = Reach::new(&bins, &larger, largest, core);
            levels.push(Level { bins, reach });
            rest = larger.into_iter().map(|(i, _)| i).collect();
            if rest.is_empty() {
                break;
            }
        }
        if levels.len() == 1 {
            class.clear();
        }
        Self { levels, class }
    }

    #[inline]
    fn class(&self, i: usize) -> usize {
        self.class.get(i).map_or(0, |&class| class as usize)
    }

    /// The grid of the smallest particles.
    #[inline]
    pub(crate) fn finest(&self) -> &Bins<D, 4> {
        &self.levels[0].bins
    }

    /// Everything the particle can touch before it or the other steps into another cell.
    #[inline]
    pub(crate) fn collect(&self, i: usize, found: &mut Candidates) {
        found.clear();
        let class = self.class(i);
        let Level { bins, reach } = &self.levels[class];
        bins.collect_around(bins.cell(i), found);
        reach.collect_larger(bins.index(bins.cell(i)), found);
        for smaller in &self.levels[..class] {
            smaller.reach.collect_smaller(&smaller.bins, i, found);
        }
    }

    /// What has become near by a step.
    #[inline]
    pub(crate) fn collect_new(&self, i: usize, exit: Exit, found: &mut Candidates) {
        found.clear();
        let level = exit.level();
        let Level { bins, reach } = &self.levels[level];
        if level == self.class(i) {
            bins.collect_ahead(bins.cell(i), exit.axis(), exit.up(), found);
            reach.collect_larger(bins.index(bins.cell(i)), found);
        } else {
            reach.collect_smaller(bins, i, found);
        }
    }

    /// Takes the particle into the next cell. A step over a face of the box is one in the grids of all classes.
    pub(crate) fn step(&mut self, i: usize, exit: Exit) {
        let (class, axis) = (self.class(i), exit.axis());
        let steps = if exit.around() { 0..class + 1 } else { exit.level()..exit.level() + 1 };
        for level in steps {
            let Level { bins, reach } = &mut self.levels[level];
            if level == class {
                bins.remove(i);
            }
            if exit.around() {
                bins.step_around(i, axis, exit.up());
            } else {
                bins.step(i, axis, exit.up());
            }
            if level == class {
                bins.insert(i);
            } else {
                reach.register(bins, i);
            }
        }
    }

    /// In how many grids the particle has a place.
    #[inline]
    pub(crate) fn levels(&self, i: usize) -> usize {
        self.class(i) + 1
    }

    /// The face of its cell of a level at which a particle leaves it: see [`Bins::face`].
    #[inline]
    pub(crate) fn face(&self, i: usize, level: usize, axis: usize, up: bool) -> (f64, bool) {
        self.levels[level].bins.face(i, axis, up)
    }

    #[inline]
    pub(crate) fn prefetch_place(&self, i: usize) {
        self.levels[self.class(i)].bins.prefetch_place(i);
    }

    #[inline]
    pub(crate) fn prefetch_around(&self, i: usize) {
        let bins = &self.levels[self.class(i)].bins;
        bins.prefetch_around(bins.cell(i));
    }

    #[inline]
    pub(crate) fn prefetch_beyond(&self, i: usize, exit: Exit) {
        let bins = &self.levels[exit.level()].bins;
        bins.prefetch_own(i);
        bins.prefetch_ahead(bins.beyond(i, exit.axis(), exit.up()), exit.axis(), exit.up());
    }

    /// What will become near by a step, among particles of the class whose cell is left.
    #[inline]
    pub(crate) fn collect_beyond(&self, i: usize, exit: Exit, found: &mut Candidates) {
        let bins = &self.levels[exit.level()].bins;
        found.clear();
        bins.collect_ahead(bins.beyond(i, exit.axis(), exit.up()), exit.axis(), exit.up(), found);
    }

    pub(crate) fn memory(&self) -> usize {
        self.levels.iter().map(|level| level.bins.memory() + level.reach.memory()).sum::<usize>() + self.class.capacity()
    }
}

/// The mean number of particles in a cell at which a collision costs least, where cells may be as fine as wanted; for so
/// many particles of this radius to a unit of volume.
///
/// Both particles of a collision, and some more whose partner has changed, look into `3^D` cells; on their mean free path
/// `1 / (sqrt(2) n A)` (cross-section `A`) they pass faces, and look into `3^(D - 1)` new cells at each. In units of a pair
/// test, measured: docs/performance.md.
fn occupancy<const D: usize>(density: f64, radius: f64) -> f64 {
    /// What looking into a cell costs, a search, and a passage.
    const CELL: f64 = 0.33;
    const SEARCH: f64 = 5.0;
    const PASSAGE: f64 = 22.0;
    const SEARCHES: f64 = 2.4;
    let d = D as i32;
    let (cross_section, passages) = if D == 2 {
        (4.0 * radius, 2.0 * 2.0 * std::f64::consts::FRAC_2_PI)
    } else {
        (4.0 * std::f64::consts::PI * radius * radius, 2.0 * 3.0 * 0.5)
    };
    let path = 1.0 / (std::f64::consts::SQRT_2 * density * cross_section);
    let work = |occupancy: f64| {
        let width = (occupancy / density).powf(1.0 / f64::from(d));
        let layer = 3f64.powi(d - 1) * (CELL + occupancy);
        SEARCHES * (SEARCH + 3.0 * layer) + passages * path / width * (PASSAGE + layer)
    };
    [0.5, 0.7, 1.0, 1.4, 2.0].into_iter().min_by(|&a, &b| work(a).total_cmp(&work(b))).unwrap_or(0.5)
}

/// The cell width with the least estimated work; particles of larger diameter are left to the next class.
///
/// Work of a collision, in pair tests: a particle of the class looks into `3^D` cells; a larger one, which collides more
/// often the larger its surface, looks into every cell its surface reaches.
fn cell_width<const D: usize>(boundary: &Boundary<D>, radii: &[f64]) -> f64 {
    let extent = boundary.extent();
    let longest = extent.0.into_iter().fold(0.0, f64::max);
    let mut sorted = radii.to_vec();
    sorted.sort_by(f64::total_cmp);
    let (volume, d, obstacles) = (boundary.volume(), D as i32, boundary.obstacles.len());
    // Obstacles are looked up by cell like particles.
    let bodies = |particles: usize| (particles + obstacles) as f64;
    let largest = sorted.last().copied().unwrap_or(0.0);
    if largest == 0.0 {
        // Points never meet, but what is fixed.
        return if obstacles == 0 { 2.0 * longest } else { (volume / bodies(radii.len())).powf(1.0 / f64::from(d)) };
    }
    let mut best = (f64::INFINITY, 2.0 * largest);
    let mut previous = 0.0;
    for (m, &radius) in sorted.iter().enumerate().rev() {
        // Of nearly equal radii only the largest can be the border.
        if previous > 0.0 && radius > 0.95 * previous {
            continue;
        }
        previous = radius;
        let width = (2.0 * radius * MARGIN)
            .max((occupancy::<D>(bodies(m + 1) / volume, radius) * volume / bodies(m + 1)).powf(1.0 / f64::from(d)));
        // Cells that are wide to be occupied hold particles beyond the border as well.
        let fit = sorted.partition_point(|&radius| 2.0 * radius * MARGIN <= width);
        let small = fit as f64;
        let in_cell = small * width.powi(d) / volume;
        let mut work = small * 3f64.powi(d) * (0.3 + in_cell);
        let stride = 1 + (sorted.len() - fit) / 64;
        for &big in sorted[fit..].iter().step_by(stride) {
            // The cells at its surface, for each of its collisions, and looked at by the small ones in them.
            let cells = 2.0 * f64::from(d) * (2.0 * big / width + 1.0).powi(d - 1);
            work += stride as f64 * cells * ((big / width + 1.0).powi(d - 1) * (0.3 + in_cell) + in_cell);
        }
        if work < best.0 {
            best = (work, width);
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::search::{Images, Neighbour, opposite};
    use corpuscle_core::{Axis, Random};

    /// Spheres at random places, and cells over them.
    struct System<const D: usize> {
        boundary: Boundary<D>,
        flights: Vec<Flight<D>>,
        cells: Cells<D>,
        found: Candidates,
    }

    impl<const D: usize> System<D> {
        /// Radii over a factor of 100, evenly in the logarithm.
        fn new(seed: u64) -> Self {
            let mut random = Random::new(seed, 0);
            let mut boundary = Boundary::<D>::new([0.0; D], std::array::from_fn(|_| 4.0 + 2.0 * random.uniform()), Axis::Walls);
            for axis in &mut boundary.axes {
                *axis = [Axis::Walls, Axis::Periodic][random.below(2) as usize];
            }
            let flights: Vec<_> = (0..150)
                .map(|_| Flight {
                    position: Vector::from_fn(|k| boundary.upper[k] * random.uniform()),
                    time: 0.0,
                    velocity: Vector::ZERO,
                    radius: 0.8 * 100f64.powf(-random.uniform()),
                })
                .collect();
            let cells = Cells::new(&boundary, &flights, 1.0, |i| flights[i].position);
            assert!(cells.levels.len() > 1, "one class for radii over a factor of 100");
            Self { boundary, flights, cells, found: Candidates::default() }
        }

        fn collect(&mut self, i: usize) -> Vec<u32> {
            self.cells.collect(i, &mut self.found);
            self.found.found().to_vec()
        }

        /// All in touch with one, each in its image. Places are random, so some are inside others: those which no motion
        /// can bring about do not count.
        fn touching(&self, i: usize) -> Vec<Neighbour> {
            let images = Images::new(self.boundary.extent());
            let mut touching = vec![];
            for j in (0..self.flights.len()).filter(|&j| j != i) {
                let (me, other) = (self.flights[i], self.flights[j]);
                for image in 0..3u8.pow(D as u32) {
                    let neighbour = Neighbour::new(j as u32, image);
                    let shift = images.shift(neighbour);
                    let exists = (0..D).all(|k| shift[k] == 0.0 || self.boundary.axes[k] == Axis::Periodic);
                    let distance = (other.position + shift - me.position).norm();
                    if exists && me.radius.max(other.radius) <= distance && distance <= me.radius + other.radius {
                        touching.push(neighbour);
                    }
                }
            }
            touching
        }

        /// Every pair in touch is found from both sides; answers how many of different classes there are.
        fn check(&mut self) -> usize {
            let found: Vec<Vec<u32>> = (0..self.flights.len()).map(|i| self.collect(i)).collect();
            let mut mixed = 0;
            for i in 0..self.flights.len() {
                for neighbour in self.touching(i) {
                    let j = neighbour.slot();
                    let back = Neighbour::new(i as u32, opposite::<D>(neighbour.image() as u8));
                    assert!(found[i].contains(&neighbour.word()), "{i} does not find {j} in image {}", neighbour.image());
                    assert!(found[j].contains(&back.word()), "{j} does not find {i} in image {}", back.image());
                    mixed += usize::from(self.cells.class(i) < self.cells.class(j));
                }
            }
            mixed
        }

        /// Moves a particle straight to the next face between cells, of whatever grid, and over it; says whether there is
        /// one. What touches it then has been found before the step or is found by it.
        fn step(&mut self, i: usize, axis: usize, up: bool) -> bool {
            let faces = (0..self.cells.levels(i)).map(|level| (level, self.cells.face(i, level, axis, up)));
            // The nearest; the box has its faces in all grids.
            let (level, (face, around)) = faces
                .min_by(|(_, (a, _)), (_, (b, _))| if up { a.total_cmp(b) } else { b.total_cmp(a) })
                .unwrap_or((0, (f64::INFINITY, false)));
            if face.is_infinite() {
                return false;
            }
            let exit = Exit::new(level, axis, up, around);
            let mut known = self.collect(i);
            self.cells.step(i, exit);
            let (lower, upper) = (self.boundary.lower[axis], self.boundary.upper[axis]);
            self.flights[i].position[axis] = match (around, up) {
                (false, _) => face,
                (true, true) => lower,
                (true, false) => upper,
            };
            if around {
                // All neighbours are seen in other images from there: everything is searched again.
                known = self.collect(i);
            } else {
                self.cells.collect_new(i, exit, &mut self.found);
                known.extend_from_slice(self.found.found());
            }
            for neighbour in self.touching(i) {
                assert!(known.contains(&neighbour.word()), "{i} misses {} after {exit:?}", neighbour.slot());
            }
            true
        }
    }

    /// Answers how many pairs of different classes have been in touch.
    fn every_pair_in_touch_is_found<const D: usize>(seed: u64) -> usize {
        let mut system = System::<D>::new(seed);
        let mut mixed = system.check();
        let mut random = Random::new(seed, 1);
        let mut steps = 0;
        for _ in 0..20 {
            for _ in 0..100 {
                let i = random.below(system.flights.len() as u32) as usize;
                steps += usize::from(system.step(i, random.below(D as u32) as usize, random.below(2) == 0));
            }
            mixed += system.check();
        }
        assert!(steps > 1000, "{steps} steps");
        mixed
    }

    #[test]
    fn discs_of_several_classes_in_touch_are_found_from_both_sides() {
        assert!((0..10).map(every_pair_in_touch_is_found::<2>).sum::<usize>() > 1000);
    }

    #[test]
    fn spheres_of_several_classes_in_touch_are_found_from_both_sides() {
        assert!((0..10).map(every_pair_in_touch_is_found::<3>).sum::<usize>() > 1000);
    }

    /// Radii spread a little, in a dilute gas: cells as fine as for equal ones.
    #[test]
    fn a_spread_of_radii_costs_no_coarse_cells() {
        fn check<const D: usize>(side: f64) {
            let (mut random, boundary) = (Random::new(5, 0), Boundary::<D>::periodic(side));
            let radii: Vec<f64> = (0..1000).map(|_| 0.5 + 0.5 * random.uniform()).collect();
            let (width, equal) = (cell_width(&boundary, &radii), cell_width(&boundary, &[1.0; 1000]));
            assert!(width <= equal, "{width} instead of {equal}");
        }
        check::<2>(200.0);
        check::<3>(50.0);
    }
}
