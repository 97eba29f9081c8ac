//! Which spheres of a configuration overlap.

use std::ops::ControlFlow;

use super::{Axis, Boundary};
use crate::{Particles, Vector};

impl<const D: usize> Boundary<D> {
    /// Calls `found(i, j, depth)` for each pair that overlaps by more than a share `tolerance` of its contact distance, some
    /// pairs several times, until told to stop.
    ///
    /// Every sphere is noted in all cells its bounding box touches; pairs that share a cell are compared. Cells are about as
    /// wide as spheres are apart, so the cost is `O(N)` for spheres that do not overlap much, whatever their sizes.
    pub(super) fn for_each_overlap(
        &self,
        particles: &Particles<D>,
        tolerance: f64,
        mut found: impl FnMut(usize, usize, f64) -> ControlFlow<()>,
    ) {
        // Points overlap nothing but obstacles.
        let points = !self.obstacles.is_empty();
        let spheres: Vec<usize> = (0..particles.len()).filter(|&i| particles.radius[i] > 0.0 || points).collect();
        let grid = Grid::new(self, particles, &spheres);
        for cell in grid.first.windows(2) {
            let inside = &grid.entries[cell[0]..cell[1]];
            for (number, &i) in inside.iter().enumerate() {
                for &j in &inside[number + 1..] {
                    let (i, j) = (i as usize, j as usize);
                    let contact = particles.radius[i] + particles.radius[j];
                    let distance = self.displacement(particles.position[i], particles.position[j]).norm();
                    if i != j && distance < contact * (1.0 - tolerance) && found(i, j, contact - distance).is_break() {
                        return;
                    }
                }
            }
        }
    }
}

/// The spheres that touch each cell: those of cell `c` are `entries[first[c]..first[c + 1]]`.
struct Grid {
    first: Vec<usize>,
    entries: Vec<u32>,
}

/// Notes a sphere in its cells on average at most.
const NOTES: usize = 64;

impl Grid {
    fn new<const D: usize>(boundary: &Boundary<D>, particles: &Particles<D>, spheres: &[usize]) -> Self {
        let extent = boundary.extent();
        let mut width = (boundary.volume() / (spheres.len() as f64).max(1.0)).powf(1.0 / D as f64);
        let cells = loop {
            let cells: [usize; D] = std::array::from_fn(|k| (extent[k] / width).floor().clamp(1.0, 65_536.0) as usize);
            let notes = |&i: &usize| range(boundary, &cells, particles, i).iter().map(|(_, count)| *count as f64).product::<f64>();
            let fits = cells.iter().map(|&n| n as f64).product::<f64>() <= 8.0 * spheres.len() as f64 + 64.0;
            if fits && (cells == [1; D] || spheres.iter().map(notes).sum::<f64>() <= (NOTES * spheres.len()) as f64) {
                break cells;
            }
            width *= 1.5;
        };
        let mut first = vec![0; cells.iter().product::<usize>() + 1];
        for &i in spheres {
            for_each_cell(boundary, &cells, particles, i, |cell| first[cell + 1] += 1);
        }
        for cell in 1..first.len() {
            first[cell] += first[cell - 1];
        }
        let mut next = first.clone();
        let mut entries = vec![0; first[first.len() - 1]];
        for &i in spheres {
            for_each_cell(boundary, &cells, particles, i, |cell| {
                entries[next[cell]] = i as u32;
                next[cell] += 1;
            });
        }
        Self { first, entries }
    }
}

/// The cells that the bounding box of a sphere touches: along each axis the first, and how many.
fn range<const D: usize>(boundary: &Boundary<D>, cells: &[usize; D], particles: &Particles<D>, i: usize) -> [(i64, usize); D] {
    std::array::from_fn(|k| {
        let (n, scale) = (cells[k] as i64, cells[k] as f64 / (boundary.upper[k] - boundary.lower[k]));
        let place = |x: f64| ((x - boundary.lower[k]) * scale).floor();
        let (r, radius): (&Vector<D>, f64) = (&particles.position[i], particles.radius[i]);
        let (from, to) = (place(r[k] - radius), place(r[k] + radius));
        if boundary.axes[k] == Axis::Periodic {
            (from as i64, ((to - from) as usize + 1).min(cells[k]))
        } else {
            // Outer cells have no end.
            let clamp = |place: f64| place.clamp(0.0, (n - 1) as f64) as i64;
            (clamp(from), (clamp(to) - clamp(from)) as usize + 1)
        }
    })
}

fn for_each_cell<const D: usize>(
    boundary: &Boundary<D>,
    cells: &[usize; D],
    particles: &Particles<D>,
    i: usize,
    mut visit: impl FnMut(usize),
) {
    let range = range(boundary, cells, particles, i);
    for mut number in 0..range.iter().map(|(_, count)| count).product::<usize>() {
        let (mut index, mut stride) = (0, 1);
        for k in 0..D {
            let (from, count) = range[k];
            index += stride * (from + (number % count) as i64).rem_euclid(cells[k] as i64) as usize;
            number /= count;
            stride *= cells[k];
        }
        visit(index);
    }
}
