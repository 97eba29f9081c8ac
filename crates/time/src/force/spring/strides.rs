//! Several steps of a lattice in one sweep over the memory.
//!
//! As soon as a block and all that pulls at it have taken a step, the block can take the next: sweeps follow one another through the
//! memory a few blocks apart, each through what the one before has just left in a cache (time skewing; McCalpin and Wonnacott 1999,
//! Rutgers DCS-TR-379). Between two of them places are kept in a ring; the last puts them where they belong.

use corpuscle_core::{Particles, Vector};

use super::gather::Move;
use super::lattice::{BLOCK, InverseMass, Lattice, Place};
use super::ring::Ring;
use super::sweep::{Sweep, in_parts};
use crate::constraint::Held;
use crate::motion::{Stride, both};

/// The most strides in a sweep.
const MOST: usize = 8;
/// Bytes that may be at work: half of a second cache, as small as they are.
const AT_WORK: usize = 512 << 10;

impl Lattice {
    /// How many strides of so many particles should be taken at once: as many as keep what is between the first and the last in a
    /// cache, and one where all particles are in a cache anyway.
    pub(super) fn strides_at_once<const D: usize>(&self, particles: usize) -> usize {
        let particle = size_of::<Vector<D>>();
        if 2 * particle * particles <= AT_WORK {
            return 1;
        }
        // A ring is twice as long as one sweep is behind the next, and so are the positions and velocities between them.
        (AT_WORK / (4 * particle * (self.reach + BLOCK))).clamp(1, MOST)
    }

    /// Takes these strides, one after the other; tells what [`kick_and_drift`](crate::motion::kick_and_drift)
    /// does, of all of them together.
    pub(super) fn sweep<const D: usize>(&self, particles: &mut Particles<D>, held: &[Held], strides: &[Stride]) -> [bool; 2] {
        let Particles { position, velocity, mass, .. } = particles;
        let sweep = Gathering { lattice: self, mass, held, strides };
        in_parts(&sweep, position, velocity, BLOCK, self.reach)
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
        let length = BLOCK.min(count);
        // The particles of a block.
        let block = |number: usize| (number * length).min(count)..((number + 1) * length).min(count);
        let ring = |number| Ring::new(length, self.lattice.reach, beside(before, number, 0));
        let mut rings: Vec<_> = (0..passes.len()).map(ring).collect();
        // By how many blocks one pass is behind the other.
        let behind = self.lattice.reach.div_ceil(length);
        let mut finite = [true; 2];
        for front in 0..count.div_ceil(length) + passes.len() * behind {
            let coming = block(front);
            rings[0].put(coming.start, &position[coming.clone()]);
            rings[0].put_after(front, count, beside(after, 0, 1));
            let (position, later) = position.split_at_mut(coming.end);
            for (number, pass) in passes.iter_mut().enumerate() {
                let Some(now) = front.checked_sub((number + 1) * behind) else { break };
                let particles = block(now);
                let (velocity, later_velocity) = velocity.split_at_mut(particles.end);
                let velocity = &mut velocity[particles.start..];
                let soon = if number == 0 { [&*later, &*later_velocity] } else { [&[][..]; 2] };
                let (done, rest) = rings.split_at_mut(number + 1);
                let ring = &done[number];
                let moved = if let Some(next) = rest.first_mut() {
                    let moved = pass.take(ring, particles.start, next.open(particles.clone()), velocity, soon);
                    next.close(particles);
                    next.put_after(now, count, beside(after, number + 1, 1));
                    moved
                } else {
                    pass.take(ring, particles.start, &mut position[particles.clone()], velocity, soon)
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
struct Pass<'a, const D: usize> {
    lattice: &'a Lattice,
    mass: &'a [f64],
    /// What is held of the particles still to come.
    held: &'a [Held],
    stride: Stride,
    /// The first particle of the part.
    from: usize,
    stretch: usize,
    inverse_mass: InverseMass<D>,
}

impl<'a, const D: usize> Pass<'a, D> {
    fn new(Gathering { lattice, mass, held, .. }: Gathering<'a>, stride: Stride, from: usize) -> Self {
        let held = &held[held.partition_point(|held| held.particle < from)..];
        Self { lattice, mass, held, stride, from, stretch: lattice.first_stretch(from), inverse_mass: InverseMass::new() }
    }

    /// Moves the next particles, from `start` of the part on, to `position`.
    fn take(
        &mut self,
        ring: &Ring<D>,
        start: usize,
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
        self.inverse_mass.see(&self.mass[particles.clone()]);
        for (piece, neighbours) in self.lattice.pieces(particles.clone(), &mut self.stretch) {
            let own = piece.start - first..piece.end - first;
            let place = Place {
                position: ring.places(),
                room: ring.room(),
                own: ring.at(start + own.start),
                inverse_mass: self.inverse_mass.from(own.start),
            };
            let soon = soon.map(|soon| soon.get(own.start..).unwrap_or(&[]));
            let (position, velocity) = (&mut position[own.clone()], &mut velocity[own]);
            let moved = match moves.owed {
                Some(_) => self.lattice.gather(neighbours, place, Move::<true>::new(position, velocity, soon, moves)),
                None => self.lattice.gather(neighbours, place, Move::<false>::new(position, velocity, soon, moves)),
            };
            finite = both(finite, moved);
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
        let side = 60;
        let mut random = Random::new(7, 0);
        let mut particles = Particles::<3>::new();
        let mut springs = vec![];
        for i in 0..side * side {
            let mut vector = || Vector::from_fn(|_| random.normal());
            particles.push(vector(), vector(), if i < 2000 { 1.0 } else { 2.0 }, 0.0, 0);
            springs.extend(
                [i % side, i / side]
                    .iter()
                    .zip([1, side])
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
        for at in [60, 61, 256, 299, 1024, 3300, 3540] {
            let mut found = particles.clone();
            let seam = together.seam(&found.position, &found.velocity, at);
            let (first, second) = found.position.split_at_mut(at);
            let (first_velocity, second_velocity) = found.velocity.split_at_mut(at);
            assert_eq!(together.part(first, first_velocity, &nothing(), &seam, 0), [true; 2]);
            together.part(second, second_velocity, &seam, &nothing(), at);
            assert!(found == alone, "seam at {at}");
        }
    }
}
