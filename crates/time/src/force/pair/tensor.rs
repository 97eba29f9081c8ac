//! The virial tensor of short-range forces: asked for once in a while, hence a plain sum over cells.

use corpuscle_core::{Axis, Boundary, Particles, Vector};

use super::{PairPotential, largest};
use crate::force::{Tensor, add_product};
use crate::image::NearestImage;

/// `sum over pairs of r_ij F_ij` for the potentials of a symmetric square `table` of so many `species`.
///
/// Particles are sorted into cells no smaller than the cutoff, and each meets those of its own and the neighbouring cells.
pub(super) fn virial_tensor<P: PairPotential, const D: usize>(
    table: &[P],
    species: usize,
    boundary: &Boundary<D>,
    particles: &Particles<D>,
) -> Tensor<D> {
    let cells = Cells::new(boundary, &particles.position, largest(table, P::cutoff));
    let image = NearestImage::new(boundary);
    let mut tensor = [[0.0; D]; D];
    for i in 0..particles.len() {
        cells.visit(i, |j| {
            let arrow = image.displacement(particles.position[j], particles.position[i]);
            let r_squared = arrow.norm_squared();
            let of = |i: usize| usize::from(particles.species[i]) % species;
            let potential = &table[of(i) * species + of(j)];
            if j < i && r_squared < potential.cutoff() * potential.cutoff() {
                add_product(&mut tensor, arrow, arrow * potential.force_over_distance(r_squared));
            }
        });
    }
    tensor
}

/// Which particles are in which cell.
struct Cells<const D: usize> {
    axes: [Axis; D],
    count: [usize; D],
    /// The cell of each particle, axis by axis.
    cell: Vec<[usize; D]>,
    /// Where the particles of a cell start in `order`.
    start: Vec<usize>,
    order: Vec<usize>,
}

impl<const D: usize> Cells<D> {
    fn new(boundary: &Boundary<D>, position: &[Vector<D>], cutoff: f64) -> Self {
        // More cells than particles along an axis would only be empty.
        let most = (position.len() as f64).powf(1.0 / D as f64).ceil();
        let mut lower = boundary.lower;
        let mut count = [1; D];
        let mut width = [1.0; D];
        for k in 0..D {
            let mut extent = boundary.extent()[k];
            if boundary.axes[k] != Axis::Periodic {
                // Particles may be anywhere.
                let of = |from: f64, choose: fn(f64, f64) -> f64| position.iter().map(|r| r[k]).fold(from, choose);
                lower[k] = of(f64::INFINITY, f64::min);
                extent = of(f64::NEG_INFINITY, f64::max) - lower[k];
            }
            let cells = (extent / cutoff).floor().clamp(1.0, most) as usize;
            // Of two cells around a periodic axis each is the other's neighbour on both sides.
            count[k] = if boundary.axes[k] == Axis::Periodic && cells < 3 { 1 } else { cells };
            width[k] = extent / count[k] as f64;
        }
        let place = |r: &Vector<D>| std::array::from_fn(|k| (((r[k] - lower[k]) / width[k]) as usize).min(count[k] - 1));
        let cell: Vec<[usize; D]> = position.iter().map(place).collect();
        let mut cells =
            Self { axes: boundary.axes, count, cell, start: vec![0; count.iter().product::<usize>() + 1], order: vec![] };
        for cell in &cells.cell {
            cells.start[number(cell, &count) + 1] += 1;
        }
        for number in 1..cells.start.len() {
            cells.start[number] += cells.start[number - 1];
        }
        let mut next = cells.start.clone();
        cells.order = vec![0; position.len()];
        for (i, cell) in cells.cell.iter().enumerate() {
            let next = &mut next[number(cell, &count)];
            cells.order[*next] = i;
            *next += 1;
        }
        cells
    }

    /// Every particle in the cell of particle `i` or next to it, itself included.
    fn visit(&self, i: usize, mut see: impl FnMut(usize)) {
        for neighbour in 0..3usize.pow(D as u32) {
            let mut cell = self.cell[i];
            let inside = (0..D).all(|k| {
                let (step, count) = (neighbour / 3usize.pow(k as u32) % 3, self.count[k]);
                let moved = cell[k] + step; // one too many
                let periodic = self.axes[k] == Axis::Periodic;
                let exists = if count == 1 { step == 1 } else { periodic || (1..=count).contains(&moved) };
                cell[k] = (moved + count - 1) % count;
                exists
            });
            if inside {
                let number = number(&cell, &self.count);
                self.order[self.start[number]..self.start[number + 1]].iter().for_each(|&j| see(j));
            }
        }
    }
}

fn number<const D: usize>(cell: &[usize; D], count: &[usize; D]) -> usize {
    (0..D).rev().fold(0, |number, k| number * count[k] + cell[k])
}
