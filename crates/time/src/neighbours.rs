//! Lists of the pairs that may come within reach.

mod blocks;
mod rows;

use corpuscle_core::{Axis, Boundary, Instructions, Vector};

use crate::image::NearestImage;
use crate::lanes::{self, LANES};
use crate::threads;
pub(crate) use blocks::{Blocks, Farthest, Moved, column, norm_squared};
use blocks::{LargestMoves, take_over};
pub(crate) use rows::{ALL, Image, NONE, Near, Rows};
use rows::{Map, Prune, Search, rounded_up};

/// Entries of a list from which more than one thread is worth waking for one evaluation: that takes as long as a few thousand of them.
const WORTH_WAKING: usize = 50_000;
/// Entries from which threads that are awake are worth sharing it.
const WORTH_SHARING: usize = 4000;
/// Entries of a share, at least.
const LEAST_SHARE: usize = 500;
/// What the first list may hold a block.
const GUESS: usize = 64;
/// Shares a thread, where there is more than one: whoever is held up leaves some to the others.
const SHARES_A_THREAD: usize = 4;
/// What pruning a list costs, in evaluations of the force from it.
const PRUNE_COST: f64 = 1.0;
/// What sorting and searching costs, in evaluations of the force.
const BUILD_COST: f64 = 4.0;

/// The pairs of particles within cutoff plus skin (Verlet 1967, doi:10.1103/PhysRev.159.98), from blocks of four particles next
/// to each other in space to the others near any of the four.
///
/// The list holds until two particles together have moved by the skin; until then no pair can have come within the cutoff
/// unseen. It is then pruned from a wider one, and only when that does not hold any more are particles sorted and searched for
/// anew. Left to itself the skin follows from what was seen: a wide one holds for longer and lists more pairs.
#[derive(Clone, Debug)]
pub struct Neighbours<const D: usize> {
    cutoff: f64,
    skin: f64,
    wide_skin: f64,
    skin_is_given: bool,
    instructions: Instructions,
    pub(crate) blocks: Blocks<D>,
    /// Pairs within the cutoff and the skin, in shares of [`share`](Self::share) blocks.
    pub(crate) shares: Vec<Rows>,
    share: usize,
    /// Whether one evaluation is worth waking threads for.
    pub(crate) is_large: bool,
    /// Whether they are awake anyway.
    pub(crate) awake: bool,
    wide: Vec<Rows>,
    pub(crate) pruned_at: Vec<[f64; D]>,
    built_at: Vec<[f64; D]>,
    built_in: Option<([Axis; D], Vector<D>, Vector<D>)>,
    builds: u64,
    uses: u64,
}

impl<const D: usize> Neighbours<D> {
    /// An empty list for pairs within `cutoff`, with the margin `skin`; one that chooses its margin if there is none.
    pub fn new(cutoff: f64, skin: Option<f64>) -> Self {
        let mut neighbours = Self {
            cutoff,
            skin: skin.unwrap_or(0.1 * cutoff),
            wide_skin: 0.0,
            skin_is_given: skin.is_some(),
            instructions: Instructions::detect(),
            blocks: Blocks::empty(),
            shares: vec![],
            share: 1,
            is_large: false,
            awake: false,
            wide: vec![],
            pruned_at: vec![],
            built_at: vec![],
            built_in: None,
            builds: 0,
            uses: 0,
        };
        neighbours.choose_wide_skin();
        neighbours
    }

    /// The margin beyond the cutoff.
    pub fn skin(&self) -> f64 {
        self.skin
    }

    /// Particles near blocks, block by block: a kernel looks at four times as many pairs, and sees each from both sides.
    pub fn len(&self) -> usize {
        self.shares.iter().map(Rows::len).sum()
    }

    /// Whether the list is empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How often particles were sorted and searched for.
    pub fn builds(&self) -> u64 {
        self.builds
    }

    /// Takes over the positions; makes the list anew where it no longer holds.
    pub fn update(&mut self, boundary: &Boundary<D>, position: &[Vector<D>]) {
        if self.fits(boundary, position) {
            let closer = self.load(boundary, position);
            if self.keep_up(boundary, closer) {
                return;
            }
        }
        self.build(boundary, position);
    }

    /// Whether the list holds for the present positions, maybe after it has been pruned, if two particles have come nearer to each other
    /// by `closer` since it was.
    pub(crate) fn keep_up(&mut self, boundary: &Boundary<D>, closer: f64) -> bool {
        self.uses += 1;
        if closer < self.skin {
            return true;
        }
        let moved = self.moved(boundary, &self.built_at, &self.blocks);
        if moved + self.skin <= self.wide_skin {
            self.prune(boundary);
            return true;
        }
        self.choose_skin(moved);
        false
    }

    /// The blocks with other positions, if the list still holds for them.
    pub(crate) fn blocks_at(&self, boundary: &Boundary<D>, position: &[Vector<D>]) -> Option<Blocks<D>> {
        if !self.fits(boundary, position) {
            return None;
        }
        let mut blocks = self.blocks.clone();
        blocks.load(position);
        (self.moved(boundary, &self.pruned_at, &blocks) < self.skin).then_some(blocks)
    }

    /// Places in each share but the last.
    pub(crate) fn places_a_share(&self) -> usize {
        self.share * LANES
    }

    /// Whether threads are to share what is done with the list.
    pub(crate) fn is_shared(&self) -> bool {
        self.shares.len() > 1 && (self.is_large || self.awake)
    }

    fn fits(&self, boundary: &Boundary<D>, position: &[Vector<D>]) -> bool {
        self.built_in == Some((boundary.axes, boundary.lower, boundary.upper)) && self.blocks.place.len() == position.len()
    }

    /// Takes over the positions; tells by how much two particles can have come nearer to each other since the list was made.
    fn load(&mut self, boundary: &Boundary<D>, position: &[Vector<D>]) -> f64 {
        let (instructions, image, places) = (self.instructions, NearestImage::new(boundary), self.places_a_share());
        let (now, before, particle) = (&mut self.blocks.position, &self.pruned_at, &self.blocks.particle);
        let shares = now.chunks_mut(places).zip(before.chunks(places)).zip(particle.chunks(places));
        let one = |((now, before), particle): ((&mut [_], &[_]), &[_])| {
            take_over(now, particle, position);
            lanes::run(instructions, LargestMoves { image, before, now })
        };
        threads::sum(self.is_large, shares, one, Moved::and).closer_by()
    }

    /// By how much two particles can have come nearer to each other since they were `before`.
    fn moved(&self, boundary: &Boundary<D>, before: &[[f64; D]], blocks: &Blocks<D>) -> f64 {
        let (image, places) = (NearestImage::new(boundary), self.places_a_share());
        let shares = before.chunks(places).zip(blocks.position.chunks(places));
        let one = |(before, now)| lanes::run(self.instructions, LargestMoves { image, before, now });
        threads::sum(self.is_shared(), shares, one, Moved::and).closer_by()
    }

    /// The skin `s` of least cost. A force evaluation costs in proportion to the volume within reach, `(r + s)^D`, where `r`
    /// stands for cutoff and size of a block; pruning costs `PRUNE_COST` evaluations every `s/v` steps, if particles close in
    /// by `v` a step. To first order in `s` the cost is `1 + D s / r + PRUNE_COST v / s`, least at
    /// `s = sqrt(PRUNE_COST v r / D)`.
    fn choose_skin(&mut self, moved: f64) {
        if !self.skin_is_given {
            let v = moved / self.uses as f64;
            self.skin = (PRUNE_COST * v * self.range() / D as f64).sqrt().clamp(0.02 * self.cutoff, self.cutoff);
            self.choose_wide_skin();
        }
    }

    /// The wider skin `w` of least cost: pruning costs `PRUNE_COST (1 + D w / r)` evaluations every `s/v` steps, building
    /// `BUILD_COST` every `(w - s)/v`. The sum is least at `w = s + sqrt(s r BUILD_COST / (PRUNE_COST D))`.
    fn choose_wide_skin(&mut self) {
        let wider = (self.skin * self.range() * BUILD_COST / (PRUNE_COST * D as f64)).sqrt();
        self.wide_skin = self.skin + wider.min(self.cutoff);
    }

    fn range(&self) -> f64 {
        1.5 * self.cutoff
    }

    /// Sorts the particles, and searches for pairs.
    pub(crate) fn build(&mut self, boundary: &Boundary<D>, position: &[Vector<D>]) {
        let expected = if self.builds == 0 { GUESS * position.len() / LANES } else { self.len() };
        let threads = if expected < WORTH_SHARING { 1 } else { rayon::current_num_threads() };
        self.is_large = threads > 1 && expected >= WORTH_WAKING;
        let shared = self.is_large || self.awake && threads > 1;
        self.blocks = Blocks::sorted(boundary, position, shared);
        let count = self.blocks.count();
        let most = if threads == 1 { 1 } else { (SHARES_A_THREAD * threads).min(expected / LEAST_SHARE) };
        self.share = count.div_ceil(most).max(1);
        let shares = count.div_ceil(self.share);
        self.wide.resize_with(shares, Rows::default);
        self.shares.resize_with(shares, Rows::default);
        let map = Map::new(boundary, &self.blocks, self.cutoff, self.wide_skin, shared);
        let (instructions, share) = (self.instructions, self.share);
        let search = |(number, rows): (usize, &mut Rows)| {
            let range = share * number..count.min(share * (number + 1));
            lanes::run(instructions, Search { map: &map, range, rows });
        };
        threads::for_each(shared, self.wide.iter_mut().enumerate(), search);
        self.built_at.clone_from(&self.blocks.position);
        self.built_in = Some((boundary.axes, boundary.lower, boundary.upper));
        self.builds += 1;
        self.uses = 0;
        self.prune(boundary);
    }

    /// Makes the list from the wider one.
    fn prune(&mut self, boundary: &Boundary<D>) {
        let shared = self.is_shared();
        let Self { blocks, wide, shares, instructions, .. } = self;
        // Positions outside the box cost no pair here: the nearest image is that of the pair, wherever the two are.
        let (image, reach) = (NearestImage::new(boundary), rounded_up(self.cutoff + self.skin));
        let prune = |(rows, wide): (&mut Rows, &Rows)| lanes::run(*instructions, Prune { image, blocks, reach, wide, rows });
        threads::for_each(shared, shares.iter_mut().zip(&*wide), prune);
        self.pruned_at.clone_from(&self.blocks.position);
    }
}
