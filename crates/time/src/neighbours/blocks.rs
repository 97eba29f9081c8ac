//! Particles sorted in space, in blocks of neighbours: the memory order of pair forces.

use corpuscle_core::instructions::{larger, smaller};
use corpuscle_core::{Axis, Boundary, Vector};

use crate::image::NearestImage;
use crate::lanes::{InLanes, LANES, Lanes};
use crate::threads::{self, CHUNK};

/// What stands in for a particle's index at places without one.
pub(crate) const NOBODY: u32 = u32::MAX;

/// Columns that one thread sorts at a time.
const SORTED_TOGETHER: usize = 8;

/// Positions in blocks of [`LANES`] particles that are near each other.
///
/// Space is divided into columns along the last axis, about as wide as a block is long; the particles of a column are
/// sorted along it and cut into blocks (Pall and Hess 2013, doi:10.1016/j.cpc.2013.06.003).
#[derive(Clone, Debug)]
pub(crate) struct Blocks<const D: usize> {
    /// Position at each place; no number where there is no particle, the last places of a block.
    pub(crate) position: Vec<[f64; D]>,
    /// Species at each place.
    pub(crate) species: Vec<u16>,
    /// Index of the particle at each place; [`NOBODY`] where there is none.
    pub(crate) particle: Vec<u32>,
    /// Place of each particle.
    pub(crate) place: Vec<u32>,
    pub(crate) columns: Columns<D>,
}

/// Columns along the last axis.
#[derive(Clone, Debug)]
pub(crate) struct Columns<const D: usize> {
    lower: [f64; D],
    scale: [f64; D],
    /// Columns along each axis; one along the last.
    counts: [usize; D],
    wraps: [bool; D],
    /// Blocks of column `c` are `starts[c]..starts[c + 1]`.
    pub(crate) starts: Vec<u32>,
}

impl<const D: usize> Columns<D> {
    fn new(boundary: &Boundary<D>, position: &[Vector<D>]) -> Self {
        // Along an open axis the columns span the particles; along the others, the box.
        let (mut lower, mut upper) = (boundary.lower, boundary.upper);
        for k in (0..D).filter(|&k| boundary.axes[k] == Axis::Open) {
            lower[k] = position.iter().map(|r| r[k]).fold(f64::INFINITY, f64::min);
            upper[k] = position.iter().map(|r| r[k]).fold(f64::NEG_INFINITY, f64::max);
        }
        let sides: [f64; D] = std::array::from_fn(|k| (upper[k] - lower[k]).max(f64::MIN_POSITIVE));
        // A block as long as a column is wide: LANES particles in width^D, at the mean density. No more columns along an
        // axis than particles, whatever their spread.
        let most = position.len() as f64;
        let blocks = (most / LANES as f64).max(1.0);
        let mean = libm::pow(sides.iter().map(|side| side / sides[0]).product::<f64>() / blocks, 1.0 / D as f64) * sides[0];
        let mut counts = [1; D];
        let mut left = blocks;
        for k in 0..D.saturating_sub(1) {
            counts[k] = (sides[k] / mean).round().clamp(1.0, left.max(1.0)) as usize;
            left /= counts[k] as f64;
        }
        Self {
            lower: lower.0,
            scale: std::array::from_fn(|k| counts[k] as f64 / sides[k]),
            counts,
            wraps: std::array::from_fn(|k| boundary.axes[k] == Axis::Periodic),
            starts: vec![],
        }
    }

    fn number(&self) -> usize {
        self.counts.iter().product()
    }

    /// The column a point is in; the nearest one for points outside.
    fn of(&self, r: Vector<D>) -> usize {
        (0..D - 1).rev().fold(0, |column, k| {
            let slot = (((r[k] - self.lower[k]) * self.scale[k]) as usize).min(self.counts[k] - 1);
            column * self.counts[k] + slot
        })
    }

    /// Calls `visit` once with every column that comes within `reach` of the region from `low` to `high`: with its number, and how far its blocks may be from the region along the
    /// last axis, squared.
    #[inline(always)]
    pub(crate) fn for_each_near(&self, low: &[f64; D], high: &[f64; D], reach: f64, mut visit: impl FnMut(usize, f64)) {
        // Slots along each axis: from where, and how many; in a ring smaller than the region, each once.
        let (mut from, mut span, mut all) = ([0i64; D], [1i64; D], [false; D]);
        for k in 0..D - 1 {
            let count = self.counts[k] as i64;
            let slot = |x: f64| ((x - self.lower[k]) * self.scale[k]).floor().clamp(-1e9, 1e9) as i64;
            let (mut start, mut end) = (slot(low[k] - reach), slot(high[k] + reach));
            if !self.wraps[k] {
                (start, end) = (start.clamp(0, count - 1), end.clamp(0, count - 1));
            }
            all[k] = end - start + 1 > count;
            (from[k], span[k]) = if all[k] { (0, count) } else { (start, end - start + 1) };
        }
        for mut number in 0..span.iter().product() {
            let (mut column, mut stride, mut room) = (0, 1, reach * reach);
            for k in 0..D - 1 {
                let (count, slot) = (self.counts[k] as i64, from[k] + number % span[k]);
                number /= span[k];
                column += slot.rem_euclid(count) * stride;
                stride *= count;
                if !all[k] {
                    // Particles outside the space the columns share are in the outermost ones.
                    let ends = (!self.wraps[k] && slot == 0, !self.wraps[k] && slot == count - 1);
                    let left = if ends.0 { f64::NEG_INFINITY } else { self.lower[k] + slot as f64 / self.scale[k] };
                    let right = if ends.1 { f64::INFINITY } else { self.lower[k] + (slot + 1) as f64 / self.scale[k] };
                    let gap = larger(larger(left - high[k], low[k] - right), 0.0);
                    room -= gap * gap;
                }
            }
            if room > 0.0 {
                visit(column as usize, room);
            }
        }
    }
}

impl<const D: usize> Blocks<D> {
    pub(crate) fn empty() -> Self {
        let columns = Columns { lower: [0.0; D], scale: [1.0; D], counts: [1; D], wraps: [false; D], starts: vec![0] };
        Self { position: vec![], species: vec![], particle: vec![], place: vec![], columns }
    }

    /// Sorts the particles, by all threads where that is to be shared.
    pub(crate) fn sorted(boundary: &Boundary<D>, places: &[Vector<D>], shared: bool) -> Self {
        let mut columns = Columns::new(boundary, places);
        let mut of = vec![0u32; places.len()];
        threads::for_each(shared, of.chunks_mut(CHUNK).zip(places.chunks(CHUNK)), |(of, places)| {
            for (of, &r) in of.iter_mut().zip(places) {
                *of = columns.of(r) as u32;
            }
        });
        let mut ends = vec![0u32; columns.number() + 1];
        for &column in &of {
            ends[column as usize + 1] += 1;
        }
        for column in 1..ends.len() {
            ends[column] += ends[column - 1];
        }
        let mut next = ends.clone();
        let mut members = vec![(0.0, 0u32); places.len()];
        for (i, (&column, r)) in of.iter().zip(places).enumerate() {
            let slot = &mut next[column as usize];
            members[*slot as usize] = (r[D - 1], i as u32);
            *slot += 1;
        }
        let mut particle = Vec::with_capacity(places.len() + columns.number() * LANES);
        columns.starts.push(0);
        let (mut rest, mut all) = (&mut members[..], vec![]);
        for bounds in ends.windows(2) {
            all.push(rest.split_off_mut(..(bounds[1] - bounds[0]) as usize).unwrap_or_default());
        }
        let sort = |columns: &mut [&mut [(f64, u32)]]| {
            for column in columns {
                column.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
            }
        };
        threads::for_each(shared, all.chunks_mut(SORTED_TOGETHER), sort);
        for column in all {
            particle.extend(column.iter().map(|&(_, i)| i));
            particle.resize(particle.len().next_multiple_of(LANES), NOBODY);
            columns.starts.push((particle.len() / LANES) as u32);
        }
        let mut place = vec![0; places.len()];
        for (number, &i) in particle.iter().enumerate() {
            if i != NOBODY {
                place[i as usize] = number as u32;
            }
        }
        let position = vec![[f64::NAN; D]; particle.len()];
        let mut blocks = Self { position, species: vec![0; particle.len()], particle, place, columns };
        let chunks = blocks.position.chunks_mut(CHUNK).zip(blocks.particle.chunks(CHUNK));
        threads::for_each(shared, chunks, |(here, particle)| take_over(here, particle, places));
        blocks
    }

    /// Number of blocks.
    pub(crate) fn count(&self) -> usize {
        self.position.len() / LANES
    }

    /// Takes over positions, in the present order.
    pub(crate) fn load(&mut self, position: &[Vector<D>]) {
        take_over(&mut self.position, &self.particle, position);
    }

    /// Takes over species.
    pub(crate) fn load_species(&mut self, species: &[u16]) {
        for (kind, &i) in self.species.iter_mut().zip(&self.particle) {
            if let Some(&species) = species.get(i as usize) {
                *kind = species;
            }
        }
    }

    /// Lower and upper corner of a block's box.
    pub(crate) fn bounds(&self, block: usize) -> ([f64; D], [f64; D]) {
        let places = &self.position[block * LANES..(block + 1) * LANES];
        // Places without a particle hold no number, which is neither smaller nor larger than one.
        let bound = |k: usize, start: f64, choose: fn(f64, f64) -> f64| places.iter().fold(start, |bound, r| choose(r[k], bound));
        (std::array::from_fn(|k| bound(k, f64::INFINITY, smaller)), std::array::from_fn(|k| bound(k, f64::NEG_INFINITY, larger)))
    }
}

/// Positions at places, from those of the particles there.
pub(crate) fn take_over<const D: usize>(places: &mut [[f64; D]], particle: &[u32], position: &[Vector<D>]) {
    for (here, &i) in places.iter_mut().zip(particle) {
        if let Some(r) = position.get(i as usize) {
            *here = r.0;
        }
    }
}

/// The two largest squares of displacements from `before` to `now`, nearest images, among places of whole blocks.
pub(crate) struct LargestMoves<'a, const D: usize> {
    pub(crate) image: NearestImage<D>,
    pub(crate) before: &'a [[f64; D]],
    pub(crate) now: &'a [[f64; D]],
}

impl<const D: usize> InLanes for LargestMoves<'_, D> {
    type Output = Moved;

    #[inline(always)]
    fn run<V: Lanes>(self) -> Moved {
        let image = self.image.in_lanes::<V>();
        let mut farthest = Farthest::<V>::new();
        for (before, now) in self.before.chunks_exact(LANES).zip(self.now.chunks_exact(LANES)) {
            let mut way = [V::splat(0.0); D];
            for k in 0..D {
                way[k] = image.component(k, column::<V, D>(now, k).sub(column::<V, D>(before, k)));
            }
            farthest.see(&way);
        }
        farthest.moved()
    }
}

/// The squares of the two longest ways in each lane.
pub(crate) struct Farthest<V> {
    first: V,
    second: V,
}

impl<V: Lanes> Farthest<V> {
    #[inline(always)]
    pub(crate) fn new() -> Self {
        Self { first: V::splat(0.0), second: V::splat(0.0) }
    }

    #[inline(always)]
    pub(crate) fn see<const D: usize>(&mut self, way: &[V; D]) {
        let square = norm_squared(way).larger(V::splat(0.0)); // places without a particle stay
        self.second = self.second.larger(square.smaller(self.first));
        self.first = self.first.larger(square);
    }

    /// Those of all lanes.
    #[inline(always)]
    pub(crate) fn moved(self) -> Moved {
        let lanes = self.first.lanes().into_iter().zip(self.second.lanes());
        lanes.map(|(first, second)| Moved([first, second])).fold(Moved::default(), Moved::and)
    }
}

/// The squares of the two longest ways that particles have moved, the longest first.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Moved([f64; 2]);

impl Moved {
    /// Those of these and other particles.
    pub(crate) fn and(self, other: Self) -> Self {
        let (Self([a, b]), Self([c, d])) = (self, other);
        Self(if a > c { [a, b.max(c)] } else { [c, a.max(d)] })
    }

    /// By how much two particles can have come nearer to each other.
    pub(crate) fn closer_by(self) -> f64 {
        self.0[0].sqrt() + self.0[1].sqrt()
    }
}

/// Component `k` of the places of a block.
#[inline(always)]
pub(crate) fn column<V: Lanes, const D: usize>(places: &[[f64; D]], k: usize) -> V {
    V::new([places[0][k], places[1][k], places[2][k], places[3][k]])
}

/// Squares of the lengths of four arrows.
#[inline(always)]
pub(crate) fn norm_squared<V: Lanes, const D: usize>(arrow: &[V; D]) -> V {
    let mut sum = arrow[0].mul(arrow[0]);
    for k in 1..D {
        sum = sum.add(arrow[k].mul(arrow[k]));
    }
    sum
}
