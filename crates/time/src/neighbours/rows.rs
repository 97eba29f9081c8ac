//! Which blocks come near which particle.

use corpuscle_core::instructions::Kernel;
use corpuscle_core::{Axis, Boundary};

use super::blocks::{Blocks, LANES, Lanes, NOBODY};
use crate::image::NearestImage;

/// Rows of blocks: one row a place, for some of the places.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rows {
    /// The place of each row.
    pub(crate) places: Vec<u32>,
    /// Whether the row's place meets the later places of its own block, too.
    pub(crate) own: Vec<bool>,
    /// Row `n` is `blocks[ends[n - 1]..ends[n]]`.
    pub(crate) ends: Vec<u32>,
    /// Later blocks with particles within reach.
    pub(crate) blocks: Vec<u32>,
}

impl Rows {
    fn clear(&mut self) {
        self.places.clear();
        self.own.clear();
        self.ends.clear();
        self.blocks.clear();
    }

    /// Ends the row of `place`, if there is anything in it.
    fn close(&mut self, place: usize, own: bool) {
        if own || self.blocks.len() > self.ends.last().map_or(0, |&end| end as usize) {
            self.places.push(place as u32);
            self.own.push(own);
            self.ends.push(self.blocks.len() as u32);
        }
    }

    /// Place, whether its own block counts, and blocks of each row.
    #[inline(always)]
    pub(crate) fn iter(&self) -> impl Iterator<Item = (usize, bool, &[u32])> {
        let mut start = 0;
        self.places.iter().zip(&self.own).zip(&self.ends).map(move |((&place, &own), &end)| {
            let row = &self.blocks[start..end as usize];
            start = end as usize;
            (place as usize, own, row)
        })
    }
}

/// A share of all pairs, the work of one thread: each pair of particles within reach is in one row of one share.
#[derive(Clone, Debug, Default)]
pub(crate) struct Share {
    /// Pairs that no periodic face can come between while the list holds.
    pub(crate) direct: Rows,
    /// Pairs that need the nearest image.
    pub(crate) imaged: Rows,
}

/// What the search for rows needs to know about blocks.
pub(crate) struct Map<'a, const D: usize> {
    blocks: &'a Blocks<D>,
    image: NearestImage<D>,
    reach: f64,
    /// Lower and upper corner of each block's box.
    boxes: Vec<([f64; D], [f64; D])>,
    /// Whether a particle of the block may pass a periodic face while the list holds.
    border: Vec<bool>,
    /// The last axis, where it is periodic.
    ring: Option<(f64, f64)>,
    /// Half the sides of the box less the skin; infinite along axes that are not periodic.
    half: [f64; D],
    /// Whether in this box another image of a block within reach may be nearer.
    small: bool,
}

impl<'a, const D: usize> Map<'a, D> {
    pub(crate) fn new(boundary: &Boundary<D>, blocks: &'a Blocks<D>, cutoff: f64, skin: f64) -> Self {
        let boxes: Vec<_> = (0..blocks.position.len()).map(|block| blocks.bounds(block)).collect();
        let periodic = |k: &usize| boundary.axes[*k] == Axis::Periodic;
        let (lower, upper) = (boundary.lower, boundary.upper);
        let touches = |(low, high): &([f64; D], [f64; D])| {
            (0..D).filter(periodic).any(|k| low[k] - skin <= lower[k] || high[k] + skin >= upper[k])
        };
        // Positions may come a little outside the box; and a pair at the cutoff must not be lost to rounding.
        let outside = |(low, high): &([f64; D], [f64; D])| {
            (0..D).filter(periodic).map(|k| (lower[k] - low[k]).max(high[k] - upper[k])).fold(0.0, f64::max)
        };
        let reach = (cutoff + skin) * (1.0 + 1e-9) + 2.0 * boxes.iter().map(outside).fold(0.0, f64::max);
        let half = |k| if periodic(&k) { 0.5 * boundary.extent()[k] - skin } else { f64::INFINITY };
        let half: [f64; D] = std::array::from_fn(half);
        let longest = |k: usize| boxes.iter().map(|(low, high)| high[k] - low[k]).fold(0.0, f64::max);
        Self {
            blocks,
            image: NearestImage::new(boundary),
            reach,
            border: boxes.iter().map(touches).collect(),
            ring: periodic(&(D - 1)).then_some((lower[D - 1], upper[D - 1])),
            small: (0..D).any(|k| half[k] <= reach + 2.0 * longest(k)),
            half,
            boxes,
        }
    }

    /// Whether particles of two blocks (or one), neither of which touches a face, may come to be half a box apart.
    fn far(&self, first: usize, second: usize) -> bool {
        let ((low, high), (other_low, other_high)) = (&self.boxes[first], &self.boxes[second]);
        (0..D).any(|k| (high[k] - other_low[k]).max(other_high[k] - low[k]) >= self.half[k])
    }
}

/// The search for the rows of some blocks.
pub(crate) struct Search<'a, const D: usize> {
    pub(crate) map: &'a Map<'a, D>,
    pub(crate) range: std::ops::Range<usize>,
    pub(crate) share: &'a mut Share,
}

impl<const D: usize> Kernel for Search<'_, D> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { map, range, share } = self;
        let (blocks, columns) = (map.blocks, &map.blocks.columns);
        share.direct.clear();
        share.imaged.clear();
        let mut seen = vec![u32::MAX; if map.small { map.boxes.len() } else { 0 }];
        let (mut direct, mut imaged, mut squares) = (vec![], vec![], vec![]);
        let mut column = 0;
        for block in range {
            while columns.starts[column + 1] as usize <= block {
                column += 1;
            }
            direct.clear();
            imaged.clear();
            let (low, high) = &map.boxes[block];
            let border = map.border[block];
            let own_imaged = border || (map.small && map.far(block, block));
            columns.for_each_near(low, high, map.reach, column, |other, wrapped, room| {
                let first = (columns.starts[other] as usize).max(block + 1);
                let last = (columns.starts[other + 1] as usize).max(first);
                let (low, high) = (low[D - 1] - room.sqrt(), high[D - 1] + room.sqrt());
                let mut visit = |low: f64, high: f64, wrapped: bool| {
                    for candidate in overlap(&map.boxes, first..last, low, high) {
                        if map.small {
                            if seen[candidate] == block as u32 {
                                continue;
                            }
                            seen[candidate] = block as u32;
                        }
                        let needs_image = wrapped || border || map.border[candidate] || (map.small && map.far(block, candidate));
                        if needs_image { imaged.push(candidate as u32) } else { direct.push(candidate as u32) }
                    }
                };
                visit(low, high, wrapped);
                if let Some((lower, upper)) = map.ring {
                    if low < lower {
                        visit(low + (upper - lower), high + (upper - lower), true);
                    }
                    if high >= upper {
                        visit(low - (upper - lower), high - (upper - lower), true);
                    }
                }
            });
            for lane in (0..LANES).filter(|lane| blocks.particle[block * LANES + lane] != NOBODY) {
                let place = block * LANES + lane;
                let r = std::array::from_fn(|k| blocks.position[block][k][lane]);
                keep_near::<D, false>(map, &r, &direct, &mut squares, &mut share.direct.blocks);
                share.direct.close(place, !own_imaged);
                keep_near::<D, true>(map, &r, &imaged, &mut squares, &mut share.imaged.blocks);
                share.imaged.close(place, own_imaged);
            }
        }
    }
}

/// Appends to `kept` the candidates with a particle within reach of `r`.
#[inline(always)]
fn keep_near<const D: usize, const IMAGE: bool>(
    map: &Map<'_, D>,
    r: &[f64; D],
    candidates: &[u32],
    squares: &mut Vec<Lanes<f64>>,
    kept: &mut Vec<u32>,
) {
    squares.resize(candidates.len(), Lanes([0.0; LANES]));
    for (square, &candidate) in squares.iter_mut().zip(candidates) {
        let there = &map.blocks.position[candidate as usize];
        let mut r_squared = [0.0; LANES];
        for k in 0..D {
            for lane in 0..LANES {
                let d = there[k][lane] - r[k];
                let d = if IMAGE { map.image.component(k, d) } else { d };
                r_squared[lane] += d * d;
            }
        }
        *square = Lanes(r_squared);
    }
    // Written without a branch that depends on the outcome: it would be mispredicted for every second candidate.
    let start = kept.len();
    kept.resize(start + candidates.len(), 0);
    let row = &mut kept[start..];
    let mut count = 0;
    for (&candidate, square) in candidates.iter().zip(&*squares) {
        let smaller = |a: f64, b: f64| if a < b { a } else { b };
        let nearest = smaller(smaller(square[0], square[1]), smaller(square[2], square[3]));
        row[count] = candidate;
        count += usize::from(nearest < map.reach * map.reach);
    }
    kept.truncate(start + count);
}

/// The blocks of `range`, which lie in order along a column, that overlap `low..high`.
#[inline(always)]
fn overlap<const D: usize>(
    boxes: &[([f64; D], [f64; D])],
    range: std::ops::Range<usize>,
    low: f64,
    high: f64,
) -> std::ops::Range<usize> {
    let column = &boxes[range.clone()];
    let start = column.partition_point(|(_, upper)| upper[D - 1] < low);
    let count = column[start..].iter().take_while(|(lower, _)| lower[D - 1] <= high).count();
    range.start + start..range.start + start + count
}
