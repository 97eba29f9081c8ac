//! Lists of the pairs that may come within reach, from a grid of cells.

use corpuscle_core::{Axis, Boundary, Vector};

use crate::image::NearestImage;

/// For each particle the particles of higher index within cutoff plus skin, in ascending order (Verlet 1967,
/// doi:10.1103/PhysRev.159.98).
///
/// The list holds until some particle has moved by half the skin; until then no pair can have come within the cutoff
/// unseen. Building costs `O(N)` through cells at least as wide as the reach.
#[derive(Clone, Debug)]
pub struct Neighbours<const D: usize> {
    cutoff: f64,
    skin: f64,
    /// Row `i` of `members` is `starts[i]..starts[i + 1]`.
    starts: Vec<u32>,
    members: Vec<u32>,
    built_at: Vec<Vector<D>>,
    built_in: Option<([Axis; D], Vector<D>, Vector<D>)>,
    builds: u64,
}

impl<const D: usize> Neighbours<D> {
    /// An empty list for pairs within `cutoff`, with a margin of `skin`.
    pub fn new(cutoff: f64, skin: f64) -> Self {
        Self { cutoff, skin, starts: vec![0], members: vec![], built_at: vec![], built_in: None, builds: 0 }
    }

    /// Neighbours of higher index of particle `i`.
    #[inline]
    pub fn of(&self, i: usize) -> &[u32] {
        &self.members[self.starts[i] as usize..self.starts[i + 1] as usize]
    }

    /// Pairs in the list.
    pub fn pairs(&self) -> usize {
        self.members.len()
    }

    /// How often the list was built.
    pub fn builds(&self) -> u64 {
        self.builds
    }

    /// Whether the list still holds every pair within the cutoff.
    pub fn hold(&self, boundary: &Boundary<D>, position: &[Vector<D>]) -> bool {
        if self.built_in != Some((boundary.axes, boundary.lower, boundary.upper)) || self.built_at.len() != position.len() {
            return false;
        }
        let image = NearestImage::new(boundary);
        let farthest = self.built_at.iter().zip(position).fold(0.0, |farthest: f64, (&then, &now)| {
            let moved = image.displacement(then, now).norm_squared();
            if moved > farthest { moved } else { farthest }
        });
        4.0 * farthest < self.skin * self.skin
    }

    /// Builds the list anew where it no longer holds.
    pub fn update(&mut self, boundary: &Boundary<D>, position: &[Vector<D>]) {
        if !self.hold(boundary, position) {
            self.build(boundary, position);
        }
    }

    fn build(&mut self, boundary: &Boundary<D>, position: &[Vector<D>]) {
        let reach = self.cutoff + self.skin;
        let image = NearestImage::new(boundary);
        let cells = Cells::new(boundary, position, reach);
        self.starts.clear();
        self.starts.push(0);
        self.members.clear();
        for (i, &r) in position.iter().enumerate() {
            let row = self.members.len();
            cells.for_each_near(cells.of[i] as usize, |near| {
                let later = near.partition_point(|&j| j as usize <= i);
                for &j in &near[later..] {
                    if image.displacement(r, position[j as usize]).norm_squared() < reach * reach {
                        self.members.push(j);
                    }
                }
            });
            self.members[row..].sort_unstable();
            self.starts.push(self.members.len() as u32);
        }
        self.built_at.clear();
        self.built_at.extend_from_slice(position);
        self.built_in = Some((boundary.axes, boundary.lower, boundary.upper));
        self.builds += 1;
    }
}

/// Particles sorted into a grid.
struct Cells<const D: usize> {
    counts: [usize; D],
    wraps: [bool; D],
    /// Cell of each particle.
    of: Vec<u32>,
    /// Members of cell `c`, in ascending order: `members[starts[c]..starts[c + 1]]`.
    starts: Vec<u32>,
    members: Vec<u32>,
}

impl<const D: usize> Cells<D> {
    fn new(boundary: &Boundary<D>, position: &[Vector<D>], reach: f64) -> Self {
        // Along an open axis the grid spans the particles; along the others, the box.
        let (mut lower, mut upper) = (boundary.lower, boundary.upper);
        for k in (0..D).filter(|&k| boundary.axes[k] == Axis::Open) {
            lower[k] = position.iter().map(|r| r[k]).fold(f64::INFINITY, f64::min);
            upper[k] = position.iter().map(|r| r[k]).fold(f64::NEG_INFINITY, f64::max);
        }
        let wraps: [bool; D] = std::array::from_fn(|k| boundary.axes[k] == Axis::Periodic);
        // No more cells than particles, roughly: far-flung ones would otherwise take any amount of memory.
        let most = ((position.len() as f64).powf(1.0 / D as f64).ceil() * 2.0).max(1.0);
        let counts: [usize; D] = std::array::from_fn(|k| {
            let count = ((upper[k] - lower[k]) / reach).floor().clamp(1.0, most) as usize;
            // Two cells around a ring would be each other's neighbour on both sides.
            if wraps[k] && count < 3 { 1 } else { count.max(1) }
        });
        let scale: [f64; D] = std::array::from_fn(|k| counts[k] as f64 / (upper[k] - lower[k]));
        let of: Vec<u32> = position
            .iter()
            .map(|r| {
                (0..D).rev().fold(0, |cell, k| {
                    let place = (((r[k] - lower[k]) * scale[k]) as usize).min(counts[k] - 1);
                    cell * counts[k] + place
                }) as u32
            })
            .collect();
        let mut starts = vec![0; counts.iter().product::<usize>() + 1];
        for &cell in &of {
            starts[cell as usize + 1] += 1;
        }
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }
        let mut next = starts.clone();
        let mut members = vec![0; position.len()];
        for (i, &cell) in of.iter().enumerate() {
            members[next[cell as usize] as usize] = i as u32;
            next[cell as usize] += 1;
        }
        Self { counts, wraps, of, starts, members }
    }

    /// Calls `visit` with the members of the cell and of each cell next to it, every one once.
    fn for_each_near(&self, cell: usize, mut visit: impl FnMut(&[u32])) {
        let mut place = [0; D];
        let mut rest = cell;
        for k in 0..D {
            place[k] = rest % self.counts[k];
            rest /= self.counts[k];
        }
        'offsets: for number in 0..3usize.pow(D as u32) {
            let (mut number, mut stride, mut near) = (number, 1, 0);
            for k in 0..D {
                let count = self.counts[k];
                let shifted = place[k] + number % 3; // one too high: offsets are -1, 0, 1
                number /= 3;
                let inside = (1..=count).contains(&shifted);
                let around = self.wraps[k] && count > 1;
                if !(inside || around) {
                    continue 'offsets;
                }
                near += stride * ((shifted + count - 1) % count);
                stride *= count;
            }
            visit(&self.members[self.starts[near] as usize..self.starts[near + 1] as usize]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corpuscle_core::Random;
    use proptest::prelude::*;

    fn check<const D: usize>(axes: [Axis; D], sides: [f64; D], count: usize, reach: f64, seed: u64) {
        let mut boundary = Boundary::<D>::new([-1.0; D], sides.map(|side| side - 1.0), Axis::Open);
        boundary.axes = axes;
        let mut random = Random::new(seed, 0);
        let position: Vec<Vector<D>> =
            (0..count).map(|_| Vector::from_fn(|k| boundary.lower[k] + sides[k] * random.uniform())).collect();
        let mut list = Neighbours::new(reach, 0.0);
        list.update(&boundary, &position);
        for i in 0..count {
            let near = |j: &u32| boundary.displacement(position[i], position[*j as usize]).norm_squared() < reach * reach;
            let plain: Vec<u32> = (i as u32 + 1..count as u32).filter(near).collect();
            assert_eq!(list.of(i), plain, "particle {i}");
        }
    }

    fn axis() -> impl Strategy<Value = Axis> {
        prop_oneof![Just(Axis::Periodic), Just(Axis::Walls), Just(Axis::Open)]
    }

    proptest! {
        #[test]
        fn the_list_is_what_a_scan_over_all_pairs_finds(
            (axes, sides) in (prop::array::uniform3(axis()), prop::array::uniform3(2.5..9.0f64)),
            count in 1..120usize, seed in any::<u64>()
        ) {
            check([axes[0], axes[1]], [sides[0], sides[1]], count, 1.2, seed);
            check(axes, sides, count, 1.2, seed);
        }
    }
}
