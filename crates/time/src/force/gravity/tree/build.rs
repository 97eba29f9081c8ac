//! The tree: particles along a curve that fills space, cells as ranges of it, moments of the cells.

use std::ops::Range;

use corpuscle_core::{Particles, Vector};

use super::super::scale::Scale;

/// Masses in a cell that is not divided further.
const LEAF: usize = 8;

/// A cube of space and the masses in it.
#[derive(Clone, Debug)]
pub(super) struct Cell<const D: usize> {
    /// Side of the cube, squared.
    pub(super) side_squared: f64,
    /// The masses, as a range along the curve.
    pub(super) masses: Range<u32>,
    /// The next cell that is not within this one.
    pub(super) next: u32,
    pub(super) leaf: bool,
    /// `sum G m`.
    pub(super) strength: f64,
    /// Centre of mass.
    pub(super) centre: Vector<D>,
    /// `sum G m x_k x_l` about the centre of mass, `k <= l`.
    pub(super) second: [[f64; D]; D],
}

/// A body where the curve meets it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body<const D: usize> {
    pub(super) position: Vector<D>,
    /// `G m`.
    pub(super) strength: f64,
}

/// Masses first, along Morton's curve, then grains along the same curve; the cells of the masses, parents first.
#[derive(Clone, Debug, Default)]
pub(super) struct Tree<const D: usize> {
    order: Vec<usize>,
    bodies: Vec<Body<D>>,
    pub(super) cells: Vec<Cell<D>>,
    keys: Vec<(u64, usize)>,
}

impl<const D: usize> Tree<D> {
    /// Levels of cells within cells that a key distinguishes: its highest bit tells grains from masses.
    const LEVELS: u32 = if D < 3 { 31 } else { 63 / D as u32 };

    /// Indices of the particles along the curve.
    pub(super) fn order(&self) -> &[usize] {
        &self.order
    }

    pub(super) fn bodies(&self) -> &[Body<D>] {
        &self.bodies
    }

    pub(super) fn build(&mut self, constant: f64, scale: Scale, particles: &Particles<D>) {
        let Particles { position, mass, .. } = particles;
        let (lower, side) = bounding_cube(position, scale);
        let per_length = f64::from(1u32 << Self::LEVELS) / side;
        let cell = |x: f64| ((x * per_length) as u64).min((1u64 << Self::LEVELS) - 1);
        self.keys.clear();
        self.keys.extend(position.iter().zip(mass).enumerate().map(|(i, (&r, &mass))| {
            let place: [u64; D] = std::array::from_fn(|k| cell(r[k] * scale.length - lower[k]));
            let grain = u64::from(mass == 0.0) << 63;
            (grain | interleave(place, Self::LEVELS), i)
        }));
        self.keys.sort_unstable();
        self.order.clear();
        self.order.extend(self.keys.iter().map(|&(_, i)| i));
        self.bodies.clear();
        self.bodies.extend(self.order.iter().map(|&i| Body { position: position[i] * scale.length, strength: constant * mass[i] }));
        let masses = self.keys.partition_point(|&(key, _)| key >> 63 == 0);
        self.cells.clear();
        self.divide(0..masses, 0, side);
    }

    /// Makes the cell of these masses, which share the first `level` digits of their keys, and those within it.
    fn divide(&mut self, masses: Range<usize>, level: u32, side: f64) {
        let cell = self.cells.len();
        let leaf = masses.len() <= LEAF || level == Self::LEVELS;
        self.cells.push(Cell {
            side_squared: side * side,
            masses: masses.start as u32..masses.end as u32,
            next: 0,
            leaf,
            strength: 0.0,
            centre: Vector::ZERO,
            second: [[0.0; D]; D],
        });
        if leaf {
            let bodies = &self.bodies[masses];
            let parts = bodies.iter().map(|body| (body.strength, body.position, [[0.0; D]; D]));
            gather(parts, &mut self.cells[cell]);
        } else {
            let shift = D as u32 * (Self::LEVELS - 1 - level);
            let mut start = masses.start;
            while start < masses.end {
                let digit = self.keys[start].0 >> shift;
                let end = start + self.keys[start..masses.end].partition_point(|&(key, _)| key >> shift == digit);
                self.divide(start..end, level + 1, 0.5 * side);
                start = end;
            }
            let mut children = vec![];
            let mut child = cell + 1;
            while child < self.cells.len() {
                children.push(child);
                child = self.cells[child].next as usize;
            }
            let (parent, rest) = self.cells.split_at_mut(cell + 1);
            let parts = children.iter().map(|&child| {
                let child = &rest[child - cell - 1];
                (child.strength, child.centre, child.second)
            });
            gather(parts, &mut parent[cell]);
        }
        self.cells[cell].next = self.cells.len() as u32;
    }
}

/// Mass, centre and second moments of parts, which have their own second moments.
fn gather<const D: usize>(parts: impl Iterator<Item = (f64, Vector<D>, [[f64; D]; D])> + Clone, cell: &mut Cell<D>) {
    for (strength, centre, _) in parts.clone() {
        cell.strength += strength;
        cell.centre += centre * strength;
    }
    cell.centre = cell.centre / cell.strength;
    for (strength, centre, second) in parts {
        let x = centre - cell.centre;
        for k in 0..D {
            for l in k..D {
                cell.second[k][l] += second[k][l] + strength * x[k] * x[l];
            }
        }
    }
}

/// Lower corner and side of a cube around all places; what is no number is left out.
fn bounding_cube<const D: usize>(position: &[Vector<D>], scale: Scale) -> (Vector<D>, f64) {
    let (mut lower, mut upper) = (Vector::<D>::splat(f64::INFINITY), Vector::<D>::splat(f64::NEG_INFINITY));
    for r in position {
        for k in 0..D {
            lower[k] = if r[k] < lower[k] { r[k] } else { lower[k] };
            upper[k] = if r[k] > upper[k] { r[k] } else { upper[k] };
        }
    }
    let side = (0..D).map(|k| upper[k] - lower[k]).fold(0.0, f64::max) * scale.length;
    // Bodies all in one place: any side will do.
    (lower * scale.length, if side > 0.0 { side } else { 1.0 })
}

/// The bits of the coordinates in turn, highest first (Morton 1966).
fn interleave<const D: usize>(place: [u64; D], levels: u32) -> u64 {
    let mut key = 0;
    for bit in (0..levels).rev() {
        for x in place {
            key = key << 1 | (x >> bit & 1);
        }
    }
    key
}
