//! Several steps of a lattice in one sweep over the memory.
//!
//! As soon as a block and all that pulls at it have taken a step, the block can take the next: sweeps follow one another through the
//! memory a few blocks apart, each through what the one before has just left in a cache (time skewing; McCalpin and Wonnacott 1999,
//! Rutgers DCS-TR-379). Between two of them places are kept in a ring; the last puts them where they belong.

use corpuscle_core::{Particles, Vector};

use super::gather::Move;
use super::lattice::{Around, InverseMass, Lattice, Place};
use super::ring::Ring;
use super::sweep::{Sweep, in_parts};
use crate::constraint::Held;
use crate::motion::{Stride, both};

/// The most strides in a sweep.
const MOST: usize = 8;
/// Bytes that may be at work: a second cache.
const AT_WORK: usize = 1 << 20;
/// Particles handled together are a multiple of these.
const BLOCK: usize = 256;

impl Lattice {
    /// How many strides of so many particles should be taken at once: as many as keep what is between the first and the last in a
    /// cache, and one where all particles are in a cache anyway.
    pub(super) fn strides_at_once<const D: usize>(&self, particles: usize) -> usize {
        let particle = size_of::<Vector<D>>();
        if 2 * particle * particles <= AT_WORK / 2 {
            return 1;
        }
        // Three blocks are in a ring, and the velocities of one are between a stride and the next.
        (AT_WORK / (4 * particle * self.block())).clamp(1, MOST)
    }

    /// Particles handled together: no spring reaches beyond the next block.
    fn block(&self) -> usize {
        self.reach.max(1).next_multiple_of(BLOCK)
    }

    /// Takes these strides, one after the other; tells what [`kick_and_drift`](crate::motion::kick_and_drift)
    /// does, of all of them together.
    pub(super) fn sweep<const D: usize>(&self, particles: &mut Particles<D>, held: &[Held], strides: &[Stride]) -> [bool; 2] {
        let Particles { position, velocity, mass, .. } = particles;
        let sweep = Gathering { lattice: self, mass, held, strides };
        in_parts(&sweep, position, velocity, self.block(), self.reach)
    }
}

/// Strides of all particles.
#[derive(Clone, Copy)]
struct Gathering<'a> {
    lattice: &'a Lattice,
    mass: &'a [f64],
    held: &'a [Held],
    strides: &'a [Stride],
}

/// Before each stride, where the particles before and behind a place in the memory are, as far as springs reach.
type Seam<const D: usize> = Vec<[Vec<Vector<D>>; 2]>;

impl<const D: usize> Sweep<D> for Gathering<'_> {
    type Seam = Seam<D>;

    /// What will be around the place before each stride depends on what is farther and farther away before the first; that takes the
    /// strides here in a copy, and once more in its part.
    fn seam(&self, position: &[Vector<D>], velocity: &[Vector<D>], at: usize) -> Seam<D> {
        let (count, reach) = (position.len(), self.lattice.reach);
        let far = self.strides.len() * reach;
        let (from, end) = (at.saturating_sub(far), (at + far).min(count));
        let (mut position, mut velocity) = (position[from..end].to_vec(), velocity[from..end].to_vec());
        let (here, all) = (at - from, end - from);
        let around =
            |position: &[Vector<D>]| [position[here - reach..here].to_vec(), position[here..(here + reach).min(all)].to_vec()];
        let mut seam = vec![around(&position)];
        let mut known = 0..all;
        for number in 0..self.strides.len() - 1 {
            // Where neighbours are no longer known, particles stay behind.
            let first = if from == 0 { 0 } else { known.start + reach };
            let last = if end == count { all } else { known.end - reach };
            let [before, after] = [known.start..first, last..known.end].map(|beside| position[beside].to_vec());
            let stride = Self { strides: &self.strides[number..=number], ..*self };
            let (before, after) = (vec![[before, vec![]]], vec![[vec![], after]]);
            stride.part(&mut position[first..last], &mut velocity[first..last], &before, &after, from + first);
            seam.push(around(&position));
            known = first..last;
        }
        seam
    }

    fn part(
        &self,
        position: &mut [Vector<D>],
        velocity: &mut [Vector<D>],
        before: &Seam<D>,
        after: &Seam<D>,
        from: usize,
    ) -> [bool; 2] {
        let count = position.len();
        let mut passes: Vec<_> = self.strides.iter().map(|&stride| Pass::new(*self, stride, from)).collect();
        let length = self.lattice.block().min(count.max(self.lattice.reach));
        let blocks = count.div_ceil(length);
        // The particles of a block.
        let block = |number: usize| (number * length).min(count)..((number + 1) * length).min(count);
        // Whether a block is one of the first or the last so many.
        let outer = |number: usize, many: usize| number < many || number + many >= blocks;
        let ring = |number| Ring::new(length, beside(before, number, 0));
        let mut rings: Vec<_> = (0..passes.len()).map(ring).collect();
        let mut inverse_mass = InverseMass::new(&self.mass[from..from + count], length);
        let (alone, mut finite) = (passes.len() == 1, [true; 2]);
        for front in 0..blocks + passes.len() {
            let coming = block(front);
            if alone || outer(front, 3) {
                rings[0].open(coming.clone()).copy_from_slice(&position[coming.clone()]);
                rings[0].put_after(front, count, beside(after, 0, 1));
            }
            let (position, later) = position.split_at_mut(coming.end);
            for (number, pass) in passes.iter_mut().enumerate() {
                let Some(now) = front.checked_sub(number + 1) else { break };
                let particles = block(now);
                let (velocity, later_velocity) = velocity.split_at_mut(particles.end);
                let velocity = &mut velocity[particles.start..];
                let soon = if number == 0 { [&*later, &*later_velocity] } else { [&[][..]; 2] };
                let (done, rest) = rings.split_at_mut(number + 1);
                let in_ring = done[number].around(particles.start);
                let moved = if let Some(next) = rest.first_mut() {
                    // Positions are overwritten by the last stride, behind the others: before the first, neighbours are where they
                    // belong, but beyond a seam.
                    let in_place = number == 0 && !outer(now, 2);
                    let around = if in_place { Around { position, own: particles.start } } else { in_ring };
                    let moved = pass.take(around, particles.start, &mut inverse_mass, next.open(particles.clone()), velocity, soon);
                    next.put_after(now, count, beside(after, number + 1, 1));
                    moved
                } else {
                    pass.take(in_ring, particles.start, &mut inverse_mass, &mut position[particles], velocity, soon)
                };
                finite = both(finite, moved);
            }
        }
        finite
    }
}

/// Where particles beside a part are, on one side of its seam, before the stride of this number.
fn beside<const D: usize>(seam: &Seam<D>, number: usize, side: usize) -> &[Vector<D>] {
    seam.get(number).map_or(&[], |both_sides| &both_sides[side])
}

/// One stride on its way through a part of the memory.
struct Pass<'a> {
    lattice: &'a Lattice,
    /// What is held of the particles still to come.
    held: &'a [Held],
    stride: Stride,
    /// The first particle of the part.
    from: usize,
    stretch: usize,
}

impl<'a> Pass<'a> {
    fn new(Gathering { lattice, held, .. }: Gathering<'a>, stride: Stride, from: usize) -> Self {
        let held = &held[held.partition_point(|held| held.particle < from)..];
        Self { lattice, held, stride, from, stretch: lattice.first_stretch(from) }
    }

    /// Moves the next particles, from `start` of the part on, to `position`.
    fn take<const D: usize>(
        &mut self,
        around: Around<'_, D>,
        start: usize,
        inverse_mass: &mut InverseMass<'_, D>,
        position: &mut [Vector<D>],
        velocity: &mut [Vector<D>],
        soon: [&[Vector<D>]; 2],
    ) -> [bool; 2] {
        let Stride { moves, end, .. } = self.stride;
        let first = self.from + start;
        let particles = first..first + position.len();
        let mut finite = [true; 2];
        if particles.is_empty() {
            return finite;
        }
        inverse_mass.see(start..start + position.len());
        for (piece, neighbours) in self.lattice.pieces(particles.clone(), &mut self.stretch) {
            let (mut start, end) = (piece.start - first, piece.end - first);
            while start < end {
                let around = around.from(start);
                let own = start..start + around.straight(neighbours, self.lattice.reach, end - start);
                start = own.end;
                let place = Place { around, inverse_mass: inverse_mass.from(own.start) };
                let soon = soon.map(|soon| soon.get(own.start..).unwrap_or(&[]));
                let (position, velocity) = (&mut position[own.clone()], &mut velocity[own]);
                let moved = match moves.owed {
                    Some(_) => self.lattice.gather(neighbours, place, Move::<true>::new(position, velocity, soon, moves)),
                    None => self.lattice.gather(neighbours, place, Move::<false>::new(position, velocity, soon, moves)),
                };
                finite = both(finite, moved);
            }
        }
        let (among, later) = self.held.split_at(self.held.iter().take_while(|held| held.particle < particles.end).count());
        self.held = later;
        for held in among {
            let n = held.particle - first;
            (position[n][held.axis], velocity[n][held.axis]) = held.at(end);
        }
        finite
    }
}

#[cfg(test)]
mod tests {
    use corpuscle_core::Random;

    use super::super::Spring;
    use super::*;
    use crate::motion::Moves;

    /// Strides one by one over all particles, and together in two parts, wherever the seam is: near an end of the memory less is
    /// known on one side of it than strides reach.
    #[test]
    fn strides_taken_together_in_parts_are_those_taken_alone() {
        in_parts_and_alone(60, 60);
        // A row longer than the shortest block.
        in_parts_and_alone(300, 12);
    }

    fn in_parts_and_alone(width: usize, height: usize) {
        let mut random = Random::new(7, 0);
        let mut particles = Particles::<3>::new();
        let mut springs = vec![];
        for i in 0..width * height {
            let mut vector = || Vector::from_fn(|_| random.normal());
            particles.push(vector(), vector(), if i < 2000 { 1.0 } else { 2.0 }, 0.0, 0);
            springs.extend(
                [i % width, i / width]
                    .iter()
                    .zip([1, width])
                    .filter(|(place, _)| **place > 0)
                    .map(|(_, by)| Spring::new(i - by, i, 1.0, 0.0)),
            );
        }
        let lattice = Lattice::new(&springs).unwrap();
        let held = [3, 250, 260, 1700].map(|i| Held::new(i, i % 3, None, 0.0, &particles).unwrap());
        let strides: Vec<_> = (0..6)
            .map(|n| Stride {
                moves: Moves { owed: (n % 2 == 0).then_some(0.05), kick: 0.05, drift: 0.1 },
                end: f64::from(n),
                confined: false,
            })
            .collect();
        let gathering = |strides| Gathering { lattice: &lattice, mass: &particles.mass, held: &held, strides };
        let nothing = || Seam::new();
        let mut alone = particles.clone();
        for stride in strides.chunks(1) {
            gathering(stride).part(&mut alone.position, &mut alone.velocity, &nothing(), &nothing(), 0);
        }
        let together = gathering(&strides);
        for at in [width, 301, 256.max(width), 1024, 3300, 3540, 3595] {
            let mut found = particles.clone();
            let seam = together.seam(&found.position, &found.velocity, at);
            let (first, second) = found.position.split_at_mut(at);
            let (first_velocity, second_velocity) = found.velocity.split_at_mut(at);
            assert_eq!(together.part(first, first_velocity, &nothing(), &seam, 0), [true; 2]);
            together.part(second, second_velocity, &seam, &nothing(), at);
            assert!(found == alone, "width {width}, seam at {at}");
        }
    }
}
