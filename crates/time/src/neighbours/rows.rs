//! Which particles come near which block.

use corpuscle_core::{Axis, Boundary};

use super::blocks::{Blocks, column, norm_squared};
use crate::image::{NearestImage, NearestImages};
use crate::lanes::{InLanes, LANES, Lanes};
use crate::threads::{self, CHUNK};

/// Which components of an arrow between particles need the nearest image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Image {
    /// None: no periodic face can come between the two while the list holds.
    None,
    /// That along one axis.
    Along(usize),
    /// All that are periodic.
    All,
}

/// The same as a constant for kernels: the number of an axis, or one of these.
pub(crate) const NONE: usize = usize::MAX;
pub(crate) const ALL: usize = usize::MAX - 1;

impl Image {
    /// Those it was, and the one along `axis`.
    fn and_along(self, axis: usize) -> Self {
        if self == Self::None { Self::Along(axis) } else { Self::All }
    }

    /// All there are, for `D` axes, by their [`number`](Self::number).
    fn every<const D: usize>() -> impl Iterator<Item = Self> {
        std::iter::once(Self::None).chain((0..D).map(Self::Along)).chain(std::iter::once(Self::All))
    }

    fn number<const D: usize>(self) -> usize {
        match self {
            Self::None => 0,
            Self::Along(axis) => 1 + axis,
            Self::All => 1 + D,
        }
    }
}

/// A share of all pairs, the work of one thread: for each of some consecutive blocks what comes near any of its particles, from
/// outside the block: places of particles, or, in a wide list, numbers of blocks. Every pair is there twice, once from each side.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rows {
    /// The first block.
    pub(crate) first: usize,
    ends: Vec<Row>,
    /// All rows, one after the other, each in segments that are alike.
    segments: Vec<Segment>,
    near: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Row {
    own: Image,
    /// Where its segments end.
    segments: usize,
    /// How much it holds.
    count: usize,
}

/// What needs the same images.
#[derive(Clone, Copy, Debug)]
struct Segment {
    image: Image,
    end: usize,
}

/// One row of a list.
#[derive(Clone, Copy)]
pub(crate) struct Near<'a> {
    /// What pairs within the block need.
    pub(crate) own: Image,
    /// How much there is.
    pub(crate) count: usize,
    start: usize,
    segments: &'a [Segment],
    all: &'a [u32],
}

impl<'a> Near<'a> {
    /// What is alike, and which images it needs.
    #[inline(always)]
    pub(crate) fn segments(self) -> impl Iterator<Item = (Image, &'a [u32])> {
        let mut start = self.start;
        self.segments.iter().map(move |segment| {
            let near = &self.all[start..segment.end];
            start = segment.end;
            (segment.image, near)
        })
    }
}

impl Rows {
    /// How much there is in all rows.
    pub(crate) fn len(&self) -> usize {
        self.near.len()
    }

    /// Row by row, from the first block on.
    #[inline(always)]
    pub(crate) fn iter(&self) -> impl Iterator<Item = Near<'_>> {
        let (mut start, mut first) = (0, 0);
        self.ends.iter().map(move |row| {
            let segments = &self.segments[first..row.segments];
            let near = Near { own: row.own, count: row.count, start, segments, all: &self.near };
            (start, first) = (start + row.count, row.segments);
            near
        })
    }

    fn clear(&mut self, first: usize) {
        self.first = first;
        self.ends.clear();
        self.segments.clear();
        self.near.clear();
    }

    /// Adds those of some blocks, all in need of the same images, that come within reach of any of the particles at `r`: the
    /// blocks, or only the places within reach.
    #[inline(always)]
    fn add<V: Lanes, const D: usize, const BLOCKS: bool>(
        &mut self,
        test: &Test<'_, V, D>,
        r: &[V; D],
        image: Image,
        blocks: &[u32],
    ) {
        let start = self.near.len();
        match image {
            Image::None => test.keep_near::<NONE, BLOCKS>(r, blocks, &mut self.near),
            Image::Along(0) if D > 1 => test.keep_near::<0, BLOCKS>(r, blocks, &mut self.near),
            Image::Along(1) if D > 1 => test.keep_near::<1, BLOCKS>(r, blocks, &mut self.near),
            Image::Along(2) if D > 2 => test.keep_near::<2, BLOCKS>(r, blocks, &mut self.near),
            _ => test.keep_near::<ALL, BLOCKS>(r, blocks, &mut self.near),
        }
        if self.near.len() > start {
            self.segments.push(Segment { image, end: self.near.len() });
        }
    }

    /// Ends a row that began with the number `start`.
    fn end(&mut self, own: Image, start: usize) {
        self.ends.push(Row { own, segments: self.segments.len(), count: self.near.len() - start });
    }
}

/// The places of a block.
#[inline(always)]
fn block_in_lanes<V: Lanes, const D: usize>(blocks: &Blocks<D>, block: usize) -> [V; D] {
    let own = &blocks.position[block * LANES..(block + 1) * LANES];
    let mut r = [V::splat(0.0); D];
    for k in 0..D {
        r[k] = column::<V, D>(own, k);
    }
    r
}

/// What tells whether particles come near.
struct Test<'a, V, const D: usize> {
    position: &'a [[f64; D]],
    images: NearestImages<V, D>,
    reach_squared: V,
}

impl<'a, V: Lanes, const D: usize> Test<'a, V, D> {
    #[inline(always)]
    fn new(blocks: &'a Blocks<D>, image: &NearestImage<D>, reach: f64) -> Self {
        Self { position: &blocks.position, images: image.in_lanes::<V>(), reach_squared: V::splat(reach * reach) }
    }

    /// See [`Rows::add`]. Written without a branch that depends on the outcome: it would often be mispredicted.
    #[inline(always)]
    fn keep_near<const IMAGE: usize, const BLOCKS: bool>(&self, r: &[V; D], blocks: &[u32], kept: &mut Vec<u32>) {
        let start = kept.len();
        kept.resize(start + if BLOCKS { blocks.len() } else { blocks.len() * LANES }, 0);
        let row = &mut kept[start..];
        let mut count = 0;
        for &block in blocks {
            let places = block as usize * LANES..(block as usize + 1) * LANES;
            let mut nearest = V::splat(f64::INFINITY);
            for (place, there) in places.clone().zip(&self.position[places]) {
                let mut d = *r;
                for k in 0..D {
                    d[k] = r[k].sub(V::splat(there[k]));
                    if IMAGE == ALL || IMAGE == k {
                        d[k] = self.images.component(k, d[k]);
                    }
                }
                let r_squared = norm_squared(&d);
                if BLOCKS {
                    nearest = r_squared.smaller(nearest);
                } else {
                    row[count] = place as u32;
                    count += usize::from(r_squared.any_less(self.reach_squared));
                }
            }
            if BLOCKS {
                row[count] = block;
                count += usize::from(nearest.any_less(self.reach_squared));
            }
        }
        kept.truncate(start + count);
    }
}

/// Where particles, and pairs of them, are too near the periodic faces to do without images while a list holds.
#[derive(Clone, Copy)]
pub(crate) struct Faces<const D: usize> {
    lower: [f64; D],
    upper: [f64; D],
    half: [f64; D],
}

impl<const D: usize> Faces<D> {
    pub(crate) fn new(boundary: &Boundary<D>, skin: f64) -> Self {
        let bound = |k: usize, value: f64, otherwise: f64| if boundary.axes[k] == Axis::Periodic { value } else { otherwise };
        Self {
            lower: std::array::from_fn(|k| bound(k, boundary.lower[k] + skin, f64::NEG_INFINITY)),
            upper: std::array::from_fn(|k| bound(k, boundary.upper[k] - skin, f64::INFINITY)),
            half: std::array::from_fn(|k| bound(k, 0.5 * boundary.extent()[k] - skin, f64::INFINITY)),
        }
    }

    /// What pairs of a particle in one region, from its lower to its upper corner, and one in another need.
    #[inline(always)]
    fn image(&self, one: &([f64; D], [f64; D]), other: &([f64; D], [f64; D])) -> Image {
        let mut image = Image::None;
        for k in 0..D {
            let low = if other.0[k] < one.0[k] { other.0[k] } else { one.0[k] };
            let high = if other.1[k] > one.1[k] { other.1[k] } else { one.1[k] };
            if !(low > self.lower[k] && high < self.upper[k] && high - low < self.half[k]) {
                image = image.and_along(k);
            }
        }
        image
    }
}

/// Makes a list of places from a wide list of blocks.
pub(crate) struct Prune<'a, const D: usize> {
    pub(crate) image: NearestImage<D>,
    pub(crate) blocks: &'a Blocks<D>,
    pub(crate) reach: f64,
    pub(crate) wide: &'a Rows,
    pub(crate) rows: &'a mut Rows,
}

impl<const D: usize> InLanes for Prune<'_, D> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes>(self) {
        let Self { image, blocks, reach, wide, rows } = self;
        let test = Test::<V, D>::new(blocks, &image, reach);
        rows.clear(wide.first);
        for (block, near) in (wide.first..).zip(wide.iter()) {
            let r = block_in_lanes::<V, D>(blocks, block);
            let start = rows.near.len();
            for (image, blocks) in near.segments() {
                rows.add::<V, D, false>(&test, &r, image, blocks);
            }
            rows.end(near.own, start);
        }
    }
}

/// What the search for rows needs to know about blocks.
pub(crate) struct Map<'a, const D: usize> {
    blocks: &'a Blocks<D>,
    image: NearestImage<D>,
    reach: f64,
    /// Lower and upper corner of each block's box.
    boxes: Vec<([f64; D], [f64; D])>,
    faces: Faces<D>,
    /// The last axis, where it is periodic.
    ring: Option<(f64, f64)>,
    /// Whether in this box another image of a block within reach may be nearer.
    small: bool,
}

impl<'a, const D: usize> Map<'a, D> {
    pub(crate) fn new(boundary: &Boundary<D>, blocks: &'a Blocks<D>, cutoff: f64, skin: f64, shared: bool) -> Self {
        let mut boxes = vec![([0.0; D], [0.0; D]); blocks.count()];
        threads::for_each(shared, boxes.chunks_mut(CHUNK).enumerate(), |(number, boxes)| {
            for (block, bounds) in (number * CHUNK..).zip(boxes) {
                *bounds = blocks.bounds(block);
            }
        });
        let periodic = |k: &usize| boundary.axes[*k] == Axis::Periodic;
        let (lower, upper) = (boundary.lower, boundary.upper);
        // Positions may come a little outside the box; and a pair at the cutoff must not be lost to rounding.
        let outside = |(low, high): &([f64; D], [f64; D])| {
            (0..D).filter(periodic).map(|k| (lower[k] - low[k]).max(high[k] - upper[k])).fold(0.0, f64::max)
        };
        let reach = rounded_up(cutoff + skin) + 2.0 * boxes.iter().map(outside).fold(0.0, f64::max);
        let faces = Faces::new(boundary, skin);
        let longest = |k: usize| boxes.iter().map(|(low, high)| high[k] - low[k]).fold(0.0, f64::max);
        Self {
            blocks,
            image: NearestImage::new(boundary),
            reach,
            small: (0..D).any(|k| faces.half[k] <= reach + 2.0 * longest(k)),
            faces,
            ring: periodic(&(D - 1)).then_some((lower[D - 1], upper[D - 1])),
            boxes,
        }
    }
}

/// A distance that no rounding makes too short.
pub(crate) fn rounded_up(distance: f64) -> f64 {
    distance * (1.0 + 1e-9)
}

/// The search for the rows of some blocks.
pub(crate) struct Search<'a, const D: usize> {
    pub(crate) map: &'a Map<'a, D>,
    pub(crate) range: std::ops::Range<usize>,
    pub(crate) rows: &'a mut Rows,
}

impl<const D: usize> InLanes for Search<'_, D> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes>(self) {
        let Self { map, range, rows } = self;
        let (blocks, columns) = (map.blocks, &map.blocks.columns);
        let test = Test::<V, D>::new(blocks, &map.image, map.reach);
        rows.clear(range.start);
        let mut seen = vec![u32::MAX; if map.small { map.boxes.len() } else { 0 }];
        let mut candidates = vec![vec![]; D + 2];
        let mut guesses = columns.starts.clone();
        for block in range {
            let bounds = &map.boxes[block];
            columns.for_each_near(&bounds.0, &bounds.1, map.reach, |other, room| {
                let all = columns.starts[other] as usize..columns.starts[other + 1] as usize;
                let (low, high) = (bounds.0[D - 1] - room.sqrt(), bounds.1[D - 1] + room.sqrt());
                let mut visit = |low: f64, high: f64, guess: &mut u32| {
                    for candidate in overlap(&map.boxes, all.clone(), low, high, guess) {
                        if candidate == block {
                            continue;
                        }
                        if map.small {
                            if seen[candidate] == block as u32 {
                                continue;
                            }
                            seen[candidate] = block as u32;
                        }
                        let image = map.faces.image(bounds, &map.boxes[candidate]);
                        candidates[image.number::<D>()].push(candidate as u32);
                    }
                };
                visit(low, high, &mut guesses[other]);
                if let Some((lower, upper)) = map.ring {
                    if low < lower {
                        visit(low + (upper - lower), high + (upper - lower), &mut { columns.starts[other + 1] });
                    }
                    if high >= upper {
                        visit(low - (upper - lower), high - (upper - lower), &mut { columns.starts[other] });
                    }
                }
            });
            let r = block_in_lanes::<V, D>(blocks, block);
            let start = rows.near.len();
            for (image, candidates) in Image::every::<D>().zip(&mut candidates) {
                rows.add::<V, D, true>(&test, &r, image, candidates);
                candidates.clear();
            }
            rows.end(map.faces.image(bounds, bounds), start);
        }
    }
}

/// The blocks of `range`, which lie in order along a column, that overlap `low..high`. The first is looked for from `guess` on,
/// where it then is: for one block after another along a column it is never far.
#[inline(always)]
fn overlap<const D: usize>(
    boxes: &[([f64; D], [f64; D])],
    range: std::ops::Range<usize>,
    low: f64,
    high: f64,
    guess: &mut u32,
) -> std::ops::Range<usize> {
    let mut start = (*guess as usize).clamp(range.start, range.end);
    while start > range.start && boxes[start - 1].1[D - 1] >= low {
        start -= 1;
    }
    while start < range.end && boxes[start].1[D - 1] < low {
        start += 1;
    }
    *guess = start as u32;
    let count = boxes[start..range.end].iter().take_while(|(lower, _)| lower[D - 1] <= high).count();
    start..start + count
}
