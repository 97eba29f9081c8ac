//! Which larger particles can touch the small ones of a cell.

use corpuscle_core::{Axis, Vector};

use super::bins::{Bins, NONE};
use super::candidates::Candidates;
use crate::search::{Neighbour, opposite};

/// For each cell of a level the larger particles whose surface can come into it while their centres stay in theirs.
///
/// A small particle then looks at the list of its own cell and nowhere else; a larger one, when its centre steps into
/// another cell, is taken from the lists of some cells and put into others.
#[derive(Clone, Debug)]
pub(crate) struct Reach<const D: usize> {
    /// Head of each cell's list; empty while no particle is larger.
    heads: Vec<u32>,
    /// A bit for each cell: whether its list holds any. Most hold none, and bits stay in the processor's inner cache.
    reached: Vec<u64>,
    /// Every larger particle owns a run of nodes, one for each cell of its shape.
    nodes: Vec<Node>,
    /// Cells that a sphere of some radius can reach, as offsets from that of its centre.
    shapes: Vec<Shape<D>>,
    /// For each larger particle its slot, shape and first node, sorted by slot.
    owners: Vec<Owner>,
}

#[derive(Clone, Debug)]
struct Shape<const D: usize> {
    radius: f64,
    offsets: Vec<[i32; D]>,
}

#[derive(Clone, Copy, Debug)]
struct Owner {
    slot: u32,
    shape: u32,
    first: u32,
}

/// In the list of a cell: the larger particle as the small ones of that cell see it.
#[derive(Clone, Copy, Debug)]
struct Node {
    neighbour: Neighbour,
    cell: u32,
    next: u32,
    previous: u32,
}

impl<const D: usize> Reach<D> {
    /// Registers the `larger` particles (slot and radius, sorted by slot), whose places `bins` knows; the others are at
    /// most of radius `largest_small`. No centre comes nearer to a larger one than `core` of its radius.
    pub(crate) fn new(bins: &Bins<D, 4>, larger: &[(usize, f64)], largest_small: f64, core: f64) -> Self {
        let mut reach = Self { heads: vec![], reached: vec![], nodes: vec![], shapes: vec![], owners: vec![] };
        if larger.is_empty() {
            return reach;
        }
        reach.heads = vec![NONE; bins.count()];
        reach.reached = vec![0; bins.count().div_ceil(64)];
        for &(slot, radius) in larger {
            let shape = reach.shapes.iter().position(|shape| shape.radius == radius).unwrap_or_else(|| {
                reach.shapes.push(Shape { radius, offsets: offsets(bins, radius, largest_small, core) });
                reach.shapes.len() - 1
            });
            reach.owners.push(Owner { slot: slot as u32, shape: shape as u32, first: reach.nodes.len() as u32 });
            let node = Node { neighbour: Neighbour::new(slot as u32, 0), cell: NONE, next: NONE, previous: NONE };
            reach.nodes.resize(reach.nodes.len() + reach.shapes[shape].offsets.len(), node);
            reach.register(bins, slot);
        }
        reach
    }

    fn owner(&self, slot: usize) -> Owner {
        // Every larger particle has been registered.
        self.owners[self.owners.partition_point(|owner| (owner.slot as usize) < slot)]
    }

    /// Puts a larger particle into the lists of the cells it can reach from where `bins` says it is.
    pub(crate) fn register(&mut self, bins: &Bins<D, 4>, slot: usize) {
        let owner = self.owner(slot);
        let home = bins.cell(slot);
        for number in 0..self.shapes[owner.shape as usize].offsets.len() {
            let offset = self.shapes[owner.shape as usize].offsets[number];
            let at = owner.first + number as u32;
            let Node { cell, next, previous, .. } = self.nodes[at as usize];
            if cell != NONE {
                if next != NONE {
                    self.nodes[next as usize].previous = previous;
                }
                if previous == NONE {
                    self.set_head(cell as usize, next);
                } else {
                    self.nodes[previous as usize].next = next;
                }
            }
            let node = if let Some((index, image)) = bins.at(home, offset) {
                let next = self.heads[index];
                self.set_head(index, at);
                if next != NONE {
                    self.nodes[next as usize].previous = at;
                }
                Node { neighbour: Neighbour::new(slot as u32, opposite::<D>(image)), cell: index as u32, next, previous: NONE }
            } else {
                Node { neighbour: Neighbour::new(slot as u32, 0), cell: NONE, next: NONE, previous: NONE }
            };
            self.nodes[at as usize] = node;
        }
    }

    fn set_head(&mut self, cell: usize, head: u32) {
        self.heads[cell] = head;
        let bit = 1 << (cell % 64);
        if head == NONE {
            self.reached[cell / 64] &= !bit;
        } else {
            self.reached[cell / 64] |= bit;
        }
    }

    /// The larger particles that a small one in this cell can touch.
    #[inline]
    pub(crate) fn collect_larger(&self, cell: usize, found: &mut Candidates) {
        if self.reached.get(cell / 64).is_none_or(|bits| bits >> (cell % 64) & 1 == 0) {
            return;
        }
        let mut at = self.heads[cell];
        while at != NONE {
            let node = self.nodes[at as usize];
            found.push(node.neighbour);
            found.images = true;
            at = node.next;
        }
    }

    /// The small particles that a larger one can touch.
    pub(crate) fn collect_smaller(&self, bins: &Bins<D, 4>, slot: usize, found: &mut Candidates) {
        let home = bins.cell(slot);
        for &offset in &self.shapes[self.owner(slot).shape as usize].offsets {
            bins.collect_at(home, offset, found);
        }
    }

    pub(crate) fn memory(&self) -> usize {
        self.heads.capacity() * 4 + self.nodes.capacity() * size_of::<Node>() + self.owners.capacity() * size_of::<Owner>()
    }
}

/// Offsets of all cells in which a small particle can touch a sphere of this radius centred in the cell of offset 0.
fn offsets<const D: usize>(bins: &Bins<D, 4>, radius: f64, largest_small: f64, core: f64) -> Vec<[i32; D]> {
    let far = (radius + largest_small) * (1.0 + 1e-6);
    let near = core * radius * (1.0 - 1e-6);
    let reach: [i32; D] = std::array::from_fn(|k| (far / bins.width[k]).ceil() as i32);
    let total: i64 = reach.iter().map(|&n| i64::from(2 * n + 1)).product();
    // Where outer cells have no end, distances say nothing.
    let closed = !bins.axes.contains(&Axis::Open);
    (0..total)
        .map(|mut number| {
            std::array::from_fn(|k| {
                let sides = i64::from(2 * reach[k] + 1);
                let offset = (number % sides) as i32 - reach[k];
                number /= sides;
                offset
            })
        })
        .filter(|offset: &[i32; D]| {
            let gap = |layers: i32| -> f64 {
                Vector::<D>::from_fn(|k| f64::from((offset[k].abs() + layers).max(0)) * bins.width[k]).norm()
            };
            !closed || (gap(-1) <= far && gap(1) >= near)
        })
        .collect()
}
