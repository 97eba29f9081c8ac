//! Lists of the pairs that may come within reach.

mod blocks;
mod rows;

use corpuscle_core::instructions::{Instructions, Kernel};
use corpuscle_core::{Axis, Boundary, Vector};
use rayon::prelude::*;

pub(crate) use blocks::{Blocks, LANES, Lanes};
use rows::{Map, Search};
pub(crate) use rows::{Rows, Share};

use crate::image::NearestImage;

/// Blocks below which a share of the work is not worth a thread.
const SMALLEST_SHARE: usize = 128;
/// What building a list costs, in evaluations of the force from it.
const BUILD_COST: f64 = 4.0;

/// The pairs of particles within cutoff plus skin (Verlet 1967, doi:10.1103/PhysRev.159.98), from every particle to blocks
/// of four others that are next to each other in space and in memory.
///
/// The list holds until two particles together have moved by the skin; until then no pair can have come within the cutoff
/// unseen. Left to itself the skin follows from what was seen: a wide one holds for longer and lists more pairs.
#[derive(Clone, Debug)]
pub struct Neighbours<const D: usize> {
    cutoff: f64,
    skin: f64,
    skin_is_given: bool,
    instructions: Instructions,
    pub(crate) blocks: Blocks<D>,
    pub(crate) shares: Vec<Share>,
    built_at: Vec<[Lanes<f64>; D]>,
    built_in: Option<([Axis; D], Vector<D>, Vector<D>)>,
    builds: u64,
    uses: u64,
}

impl<const D: usize> Neighbours<D> {
    /// An empty list for pairs within `cutoff`, with the margin `skin`; one that chooses its margin if there is none.
    pub fn new(cutoff: f64, skin: Option<f64>) -> Self {
        Self {
            cutoff,
            skin: skin.unwrap_or(0.1 * cutoff),
            skin_is_given: skin.is_some(),
            instructions: Instructions::detect(),
            blocks: Blocks::empty(),
            shares: vec![],
            built_at: vec![],
            built_in: None,
            builds: 0,
            uses: 0,
        }
    }

    /// The margin beyond the cutoff.
    pub fn skin(&self) -> f64 {
        self.skin
    }

    /// Pairs of a particle and a block in the list: the pairs a kernel looks at are four times as many.
    pub fn len(&self) -> usize {
        let rows = self.shares.iter().flat_map(|share| [&share.direct, &share.imaged]);
        rows.map(|rows| rows.blocks.len() + rows.places.len()).sum()
    }

    /// Whether the list is empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How often the list was built.
    pub fn builds(&self) -> u64 {
        self.builds
    }

    /// Takes over the positions; builds the list anew where it no longer holds.
    pub fn update(&mut self, boundary: &Boundary<D>, position: &[Vector<D>]) {
        let mut moved = 0.0;
        if self.built_in == Some((boundary.axes, boundary.lower, boundary.upper)) && self.blocks.place.len() == position.len() {
            self.blocks.load(position);
            moved = self.moved(boundary, &self.blocks);
            if moved < self.skin {
                self.uses += 1;
                return;
            }
        }
        self.choose_skin(moved);
        self.build(boundary, position);
    }

    /// The blocks with other positions, if the list still holds for them.
    pub(crate) fn blocks_at(&self, boundary: &Boundary<D>, position: &[Vector<D>]) -> Option<Blocks<D>> {
        if self.built_in != Some((boundary.axes, boundary.lower, boundary.upper)) || self.blocks.place.len() != position.len() {
            return None;
        }
        let mut blocks = self.blocks.clone();
        blocks.load(position);
        (self.moved(boundary, &blocks) < self.skin).then_some(blocks)
    }

    /// By how much two particles can have come nearer to each other since the list was built.
    fn moved(&self, boundary: &Boundary<D>, blocks: &Blocks<D>) -> f64 {
        struct Moves<'a, const D: usize>(NearestImage<D>, &'a [[Lanes<f64>; D]], &'a [[Lanes<f64>; D]]);
        impl<const D: usize> Kernel for Moves<'_, D> {
            type Output = [f64; 2];
            #[inline(always)]
            fn run(self) -> [f64; 2] {
                blocks::largest_moves(&self.0, self.1, self.2)
            }
        }
        let moves = Moves(NearestImage::new(boundary), &self.built_at, &blocks.position);
        self.instructions.run(moves).map(f64::sqrt).iter().sum()
    }

    /// The skin `s` of least cost. A force evaluation costs in proportion to the volume within reach, `(r + s)^D`, where `r`
    /// stands for cutoff and size of a block; a list costs `BUILD_COST` evaluations every `s/v` steps, if particles close in
    /// by `v` a step. To first order in `s` the cost is `1 + D s / r + BUILD_COST v / s`, least at
    /// `s = sqrt(BUILD_COST v r / D)`.
    fn choose_skin(&mut self, moved: f64) {
        if !self.skin_is_given && self.uses > 0 {
            let v = moved / (self.uses + 1) as f64;
            let r = 1.5 * self.cutoff;
            self.skin = (BUILD_COST * v * r / D as f64).sqrt().clamp(0.02 * self.cutoff, self.cutoff);
        }
        self.uses = 0;
    }

    fn build(&mut self, boundary: &Boundary<D>, position: &[Vector<D>]) {
        self.blocks = Blocks::sorted(boundary, position);
        let blocks = &self.blocks;
        let count = blocks.position.len();
        let map = Map::new(boundary, blocks, self.cutoff, self.skin);
        let shares = (count / SMALLEST_SHARE).clamp(1, rayon::current_num_threads());
        self.shares.resize_with(shares, Share::default);
        let instructions = self.instructions;
        self.shares.par_iter_mut().enumerate().for_each(|(number, share)| {
            let range = count * number / shares..count * (number + 1) / shares;
            instructions.run(Search { map: &map, range, share });
        });
        self.built_at.clone_from(&blocks.position);
        self.built_in = Some((boundary.axes, boundary.lower, boundary.upper));
        self.builds += 1;
    }
}
