//! Several steps of a lattice in one sweep over the memory.
//!
//! Kicks read positions and write velocities, drifts read velocities and write positions: both are done in place. As soon as all
//! that a particle pulls at has been kicked, it can drift, and as soon as all that pulls at it has drifted, it can be kicked again.
//! So steps follow one another through the memory, twice as far apart as springs reach, each through what the one before has just
//! left in a cache (time skewing; McCalpin and Wonnacott 1999, Rutgers DCS-TR-379). Threads sweep parts of the memory, each step
//! ending farther from where parts meet than the one before, and then what is left there (split tiling; Krishnamoorthy et al. 2007,
//! doi:10.1145/1250734.1250761): nothing is copied, nothing done twice.

use std::ops::Range;

use corpuscle_core::{Particles, Vector};
use rayon::prelude::*;

use super::PARTS_A_THREAD;
use super::gather::{Drift, Kick, LINE, Soon};
use super::lattice::Lattice;
use super::masses::{InverseMass, Masses};
use super::plan::Plan;
use super::walk::{Block, Walk};
use crate::constraint::Held;
use crate::lanes::eight::{self, LANES};
use crate::motion::{Moves, Stride, both};
use crate::threads;

/// The most strides in a sweep.
const MOST: usize = 8;
/// Bytes that may be at work: a second cache.
const AT_WORK: usize = 1 << 20;
/// Particles handled together, at least.
const BLOCK: usize = 256;

impl Lattice {
    /// How many strides of so many particles should be taken at once: as many as keep what is between the first and the last in a
    /// cache, and one where all particles are in a cache anyway.
    pub(super) fn strides_at_once<const D: usize>(&self, particles: usize) -> usize {
        let particle = 2 * size_of::<Vector<D>>();
        if particle * particles <= AT_WORK / 2 {
            return 1;
        }
        (AT_WORK / (2 * particle * self.reach.max(BLOCK))).clamp(1, MOST)
    }

    /// Takes these strides, one after the other; tells what [`kick_and_drift`](crate::motion::kick_and_drift)
    /// does, of all of them together.
    pub(super) fn sweep<const D: usize>(&self, particles: &mut Particles<D>, plan: &Plan, strides: &[Stride]) -> [bool; 2] {
        let Particles { position, velocity, mass, .. } = particles;
        let threads = if threads::are_worth_it(mass.len()) { rayon::current_num_threads() } else { 1 };
        // The fewer, the shorter may parts be: one for each thread at least.
        let together = if threads == 1 { strides.len() } else { mass.len() / (self.shortest_part(1) * threads).max(1) };
        let few = strides.chunks(together.max(1));
        let masses = Masses { each: mass, of_all: plan.mass_of_all };
        let sweep = |strides| Sweep { lattice: self, plan, masses, strides };
        few.map(|few| sweep(few).in_parts(position, velocity, PARTS_A_THREAD * threads)).fold([true; 2], both)
    }

    /// Particles of a part between two others, for so many strides: each recedes from both as far as a kick and a drift reach.
    fn shortest_part(&self, strides: usize) -> usize {
        4 * strides * self.reach
    }
}

/// Strides of all particles.
#[derive(Clone, Copy)]
struct Sweep<'a> {
    lattice: &'a Lattice,
    plan: &'a Plan,
    masses: Masses<'a>,
    strides: &'a [Stride],
}

/// Particles that follow one another, and which of them are moved: between bounds that move as far as springs reach before every
/// kick and before every drift, inwards where others follow that are not known, outwards where those left some.
struct Tile<'a, const D: usize> {
    /// The first of them.
    from: usize,
    position: &'a mut [Vector<D>],
    velocity: &'a mut [Vector<D>],
    bounds: [Bound; 2],
}

/// The first that is moved, or the first that no longer is.
#[derive(Clone, Copy)]
enum Bound {
    Fixed(usize),
    Rising(usize),
    Falling(usize),
}

impl Bound {
    /// After it has moved so far.
    fn after(self, way: usize) -> usize {
        match self {
            Self::Fixed(at) => at,
            Self::Rising(at) => at + way,
            Self::Falling(at) => at - way,
        }
    }
}

impl Sweep<'_> {
    /// In so many parts at most.
    fn in_parts<const D: usize>(&self, position: &mut [Vector<D>], velocity: &mut [Vector<D>], parts: usize) -> [bool; 2] {
        let count = position.len();
        let parts = parts.min(count / self.lattice.shortest_part(self.strides.len()).max(1)).max(1);
        let ends: Vec<usize> = (0..=parts).map(|part| part * count / parts).collect();
        let middles: Vec<usize> = ends.windows(2).map(|ends| ends[0].midpoint(ends[1])).collect();
        let alone = cut(position, velocity, &ends, |part| {
            let lower = if part.start == 0 { Bound::Fixed } else { Bound::Rising };
            let upper = if part.end == count { Bound::Fixed } else { Bound::Falling };
            [lower(0), upper(part.len())]
        });
        let finite = self.all(alone);
        let rest = cut(position, velocity, &middles, |between| {
            let at = ends[ends.partition_point(|&end| end < between.start)] - between.start;
            [Bound::Falling(at), Bound::Rising(at)]
        });
        both(finite, self.all(rest))
    }

    fn all<const D: usize>(&self, tiles: Vec<Tile<'_, D>>) -> [bool; 2] {
        if tiles.len() < 2 {
            return tiles.into_iter().map(|tile| self.take(tile)).fold([true; 2], both);
        }
        tiles.into_par_iter().map(|tile| self.take(tile)).reduce(|| [true; 2], both)
    }

    /// Takes all strides, as far as the tile goes.
    fn take<const D: usize>(&self, tile: Tile<'_, D>) -> [bool; 2] {
        let Tile { from, position, velocity, bounds } = tile;
        let reach = self.lattice.reach;
        let range = |ways: usize| bounds[0].after(ways * reach)..bounds[1].after(ways * reach);
        let pass = |number| Pass::new(*self, number, from, [range(2 * number + 1), range(2 * number + 2)]);
        let mut passes: Vec<_> = (0..self.strides.len()).map(pass).collect();
        let mut inverse_mass = InverseMass::new(self.masses, from..from + position.len());
        let (mut front, mut finite) = (range(1).start, [true; 2]);
        while passes.iter().any(|pass| !(pass.kicked.is_empty() && pass.drifting.is_empty())) {
            // In a membrane springs reach from row to row: so much in one piece.
            let length = BLOCK.max(reach);
            front += length;
            // What pulls at particles before this one is where it has to be.
            let mut known = front;
            for pass in &mut passes {
                finite = both(finite, pass.kick(known, front..front + length, position, velocity, &mut inverse_mass));
                finite[1] &= pass.drift(position, velocity);
                known = pass.done(&pass.drifting);
            }
        }
        finite
    }
}

/// Pieces of both arrays between these cuts, and what of each is moved.
fn cut<'a, const D: usize>(
    position: &'a mut [Vector<D>],
    velocity: &'a mut [Vector<D>],
    cuts: &[usize],
    bounds: impl Fn(Range<usize>) -> [Bound; 2],
) -> Vec<Tile<'a, D>> {
    let (mut position, mut velocity) = (&mut position[cuts[0]..], &mut velocity[cuts[0]..]);
    let mut tiles = vec![];
    for ends in cuts.windows(2) {
        let piece = ends[0]..ends[1];
        let (positions, later) = position.split_at_mut(piece.len());
        let (velocities, later_velocities) = velocity.split_at_mut(piece.len());
        tiles.push(Tile { from: piece.start, position: positions, velocity: velocities, bounds: bounds(piece) });
        (position, velocity) = (later, later_velocities);
    }
    tiles
}

/// One stride on its way through a tile.
struct Pass<'a, const D: usize> {
    lattice: &'a Lattice,
    stride: Stride,
    /// How many come before it.
    number: usize,
    /// How many there are.
    all: usize,
    /// The first particle of the tile.
    from: usize,
    /// Particles still to be kicked.
    kicked: Range<usize>,
    /// Particles that still have to drift.
    drifting: Range<usize>,
    walk: Walk<'a, D>,
    /// What is held of particles that still have to drift, but those that never move.
    held: &'a [Held],
}

impl<'a, const D: usize> Pass<'a, D> {
    fn new(sweep: Sweep<'a>, number: usize, from: usize, [kicked, drifting]: [Range<usize>; 2]) -> Self {
        let Sweep { lattice, plan, strides, .. } = sweep;
        let held = &plan.held[plan.held.partition_point(|held| held.particle < from + drifting.start)..];
        let walk = Walk::new(lattice, &plan.exceptions, from + kicked.start);
        Self { lattice, stride: strides[number], number, all: strides.len(), from, walk, kicked, drifting, held }
    }

    /// The end of the particles all of whose neighbours are done, where these still are to be done.
    fn done(&self, rest: &Range<usize>) -> usize {
        if rest.is_empty() { usize::MAX } else { rest.start.saturating_sub(self.lattice.reach) }
    }

    /// Kicks the next particles, up to this one at most, and asks for some of what the first stride will need for those it kicks `soon`;
    /// tells whether every velocity was finite after the kick that was owed, and, if none was, whether it is.
    fn kick(
        &mut self,
        end: usize,
        soon: Range<usize>,
        position: &[Vector<D>],
        velocity: &mut [Vector<D>],
        inverse_mass: &mut InverseMass<'_, D>,
    ) -> [bool; 2] {
        let Moves { owed, kick, .. } = self.stride.moves;
        let (start, end) = (self.kicked.start, whole_lines(velocity, self.kicked.end, end));
        if start >= end {
            return [true; 2];
        }
        self.kicked.start = end;
        inverse_mass.see(start..end);
        let block = Block { start: self.from + start, position, from: self.from, inverse_mass };
        let (velocity, later) = velocity[start..].split_at_mut(end - start);
        let soon = self.share(&soon, position, later, end);
        match owed {
            Some(owed) => [self.walk.act(block, velocity, Kick::<true> { first: owed, second: kick, soon }), true],
            None => [true, self.walk.act(block, velocity, Kick::one(kick, soon))],
        }
    }

    /// This stride's share of what will be needed to kick these particles: positions that no stride has read yet, and velocities, of
    /// which `later` begins with particle `from`. If the first stride asked for all, memory would be waited for, and then lie idle.
    fn share<'b>(&self, soon: &Range<usize>, position: &'b [Vector<D>], later: &'b [Vector<D>], from: usize) -> Soon<'b> {
        let [start, end] = [self.number, self.number + 1].map(|number| soon.start + number * soon.len() / self.all);
        let some = |values: &'b [Vector<D>], start: usize, end: usize| {
            let end = end.min(values.len());
            Vector::components(&values[start.min(end)..end])
        };
        let reach = self.lattice.reach;
        let numbers =
            [some(position, start + reach, end + reach), some(later, start.saturating_sub(from), end.saturating_sub(from))];
        Soon { numbers, rarity: self.all.ilog2() }
    }

    /// Lets those particles drift that nobody will ask for where they are; tells whether every position is finite.
    fn drift(&mut self, position: &mut [Vector<D>], velocity: &mut [Vector<D>]) -> bool {
        let (start, end) = (self.drifting.start, whole_lines(position, self.drifting.end, self.done(&self.kicked)));
        if start >= end {
            return true;
        }
        self.drifting.start = end;
        let dt = self.stride.moves.drift;
        let (positions, velocities) =
            (Vector::components_mut(&mut position[start..end]), Vector::components(&velocity[start..end]));
        let finite = eight::run(self.lattice.instructions, Drift { position: positions, velocity: velocities, dt });
        let (among, later) = self.held.split_at(self.held.iter().take_while(|held| held.particle < self.from + end).count());
        self.held = later;
        for held in among {
            let n = held.particle - self.from;
            (position[n][held.axis], velocity[n][held.axis]) = held.at(self.stride.end);
        }
        finite
    }
}

/// Where to stop on the way to the end of all, if these are the particles that may be reached by now: there, or where a line of the cache
/// begins before, if any particle's values do.
fn whole_lines<const D: usize>(values: &[Vector<D>], end_of_all: usize, end: usize) -> usize {
    if end_of_all <= end {
        return end_of_all;
    }
    let head = Vector::components(values).as_ptr().align_offset(LINE).min(LANES);
    let back = (0..LANES.min(end + 1)).find(|back| (D * (end - back) + LANES - head).is_multiple_of(LANES));
    end - back.unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use corpuscle_core::Random;

    use super::super::Spring;
    use super::*;
    use crate::Signal;

    /// Strides one by one over all particles, and any number of them together in parts, the last of them as small as they may be. Some
    /// particles are free, some held, by one axis or by all, also where parts meet.
    #[test]
    fn strides_taken_together_in_parts_are_those_taken_alone() {
        in_parts_and_alone(1, 4000);
        in_parts_and_alone(60, 160);
        // A row longer than the shortest block.
        in_parts_and_alone(300, 120);
    }

    fn in_parts_and_alone(width: usize, height: usize) {
        let (mut random, count) = (Random::new(7, 0), width * height);
        let mut particles = Particles::<3>::new();
        let mut springs = vec![];
        for i in 0..count {
            let mut vector = || Vector::from_fn(|_| random.normal());
            particles.push(vector(), vector(), if i < 2000 { 1.0 } else { 2.0 }, 0.0, 0);
            let before = [(i % width > 0, 1), (i >= width, width)];
            let free = 3100..3300;
            springs.extend(before.iter().filter(|(there, by)| *there && !free.contains(&i) && !free.contains(&(i - by))).map(
                |(_, by)| {
                    let stiffness = if *by == 1 { 1.0 } else { 0.7 };
                    Spring::new(i - by, i, stiffness, 0.0)
                },
            ));
        }
        let lattice = Lattice::new(&springs).unwrap();
        let signal = Some(Signal::Sine { amplitude: 0.5, angular_frequency: 1.0, phase: 0.3, ramp: 0.0 });
        let meeting = (1..8).flat_map(|parts| (1..parts).map(move |part| part * count / parts));
        let at = meeting.flat_map(|i| [i - 1, i]).chain([0, 3, 250, 1700, 3200, count - 1]);
        let mut held: Vec<_> = at
            .flat_map(|i| (0..=2 * (i % 2)).map(move |axis| (i, axis)))
            .map(|(i, axis)| Held::new(i, axis, signal.filter(|_| i % 3 == 0), 0.0, &particles).unwrap())
            .collect();
        held.sort_by_key(|held| held.particle);
        let stride = |n: u8| Stride {
            moves: Moves { owed: (n % 3 != 1).then_some(0.05), kick: 0.05, drift: 0.1 },
            end: f64::from(n),
            confined: false,
        };
        let strides: Vec<_> = (0..8).map(stride).collect();
        for held in &held {
            held.apply(0.0, &mut particles);
        }
        let plan = Plan::new::<3>(&lattice, &particles.mass, &held);
        let masses = Masses { each: &particles.mass, of_all: None };
        let sweep = |strides| Sweep { lattice: &lattice, plan: &plan, masses, strides };
        let mut alone = particles.clone();
        for (number, stride) in strides.iter().enumerate() {
            assert_eq!(sweep(std::slice::from_ref(stride)).in_parts(&mut alone.position, &mut alone.velocity, 1), [true; 2]);
            for parts in 1..8 {
                let mut found = particles.clone();
                assert_eq!(sweep(&strides[..=number]).in_parts(&mut found.position, &mut found.velocity, parts), [true; 2]);
                assert!(found == alone, "width {width}, {} strides, {parts} parts", number + 1);
            }
            for held in held.iter().filter(|held| !held.is_driven()) {
                let [before, after] = [&particles, &alone].map(|particles| particles.position[held.particle][held.axis]);
                assert_eq!(before.to_bits(), after.to_bits(), "{held:?}");
            }
        }
        // So many threads that there is no part for each of them unless fewer strides are taken together.
        for threads in [2, 16] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut found = particles.clone();
            assert_eq!(pool.install(|| lattice.sweep(&mut found, &plan, &strides)), [true; 2]);
            assert!(found == alone, "width {width}, {threads} threads");
        }
    }
}
