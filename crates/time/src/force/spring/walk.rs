//! The way along a lattice, from particle to particle.

use std::ops::Range;

use corpuscle_core::Vector;

use super::gather::{Action, Alike, Each, Gather};
use super::lattice::{Lattice, Neighbour};
use super::masses::{Inverse, InverseMass};
use crate::lanes::eight::{self, LANES};

/// A particle that is not treated as those beside it in memory: where the rows of a membrane end.
#[derive(Clone, Debug)]
pub(super) struct Exception {
    pub(super) particle: usize,
    /// What pulls at it; nothing is done to it without.
    pub(super) neighbours: Option<Range<usize>>,
}

/// Where someone is who does something to all particles of a lattice, or to some that follow one another.
pub(super) struct Walk<'a, const D: usize> {
    lattice: &'a Lattice,
    /// The first stretch that ends behind the next particle.
    stretch: usize,
    /// Those still to come.
    exceptions: &'a [Exception],
    /// What exceptions were before they were treated as those beside them.
    before: Vec<Vector<D>>,
}

/// Particles that follow one another, and where what belongs to them is.
#[derive(Clone, Copy)]
pub(super) struct Block<'a, 'b, const D: usize> {
    /// The first of them.
    pub(super) start: usize,
    /// Positions of these and all others that pull at them.
    pub(super) position: &'a [Vector<D>],
    /// The particle whose position is the first of these.
    pub(super) from: usize,
    pub(super) inverse_mass: &'a InverseMass<'b, D>,
}

impl<'a, const D: usize> Walk<'a, D> {
    /// From this particle on.
    pub(super) fn new(lattice: &'a Lattice, exceptions: &'a [Exception], particle: usize) -> Self {
        let exceptions = &exceptions[exceptions.partition_point(|exception| exception.particle < particle)..];
        Self { lattice, stretch: lattice.first_stretch(particle), exceptions, before: vec![] }
    }

    /// Does something to what belongs to the particles of a block, which is the next behind the last; tells whether all is well.
    pub(super) fn act<A: Action>(&mut self, block: Block<'_, '_, D>, target: &mut [Vector<D>], action: A) -> bool {
        let (mut done, mut well) = (0, true);
        while done < target.len() {
            let start = block.start + done;
            let (end, neighbours) = self.piece(start, block.start + target.len());
            let target = &mut target[done..end - block.start];
            let (here, later) = self.exceptions.split_at(self.exceptions.iter().take_while(|one| one.particle < end).count());
            self.exceptions = later;
            self.before.clear();
            self.before.extend(here.iter().map(|one| target[one.particle - start]));
            let pull = |particle: usize, neighbours: &[Neighbour], target: &mut [Vector<D>]| {
                let place = Place {
                    position: block.position,
                    own: particle - block.from,
                    inverse_mass: block.inverse_mass.from(particle - block.start),
                };
                self.lattice.gather(neighbours, place, Vector::components_mut(target), action.later(D * (particle - block.start)))
            };
            well &= pull(start, neighbours, target);
            for (exception, &before) in here.iter().zip(&self.before) {
                let n = exception.particle - start;
                target[n] = before;
                if let Some(neighbours) = &exception.neighbours {
                    well &= pull(exception.particle, self.lattice.neighbours(neighbours), &mut target[n..=n]);
                }
            }
            done = end - block.start;
        }
        well
    }

    /// Particles from this one on, not beyond another, in which nothing changes: where they end, and what pulls at each.
    fn piece(&mut self, start: usize, end: usize) -> (usize, &'a [Neighbour]) {
        match self.lattice.stretches.get(self.stretch) {
            None => (end, &[]),
            Some(stretch) if start < stretch.particles.start => (end.min(stretch.particles.start), &[]),
            Some(stretch) => {
                let end = end.min(stretch.particles.end);
                self.stretch += usize::from(end == stretch.particles.end);
                (end, self.lattice.neighbours(&stretch.neighbours))
            }
        }
    }
}

/// Where what belongs to some particles is.
#[derive(Clone, Copy)]
struct Place<'a, const D: usize> {
    /// Theirs, and those of all that pulls at them.
    position: &'a [Vector<D>],
    /// Which of these is that of the first.
    own: usize,
    inverse_mass: Inverse<'a>,
}

impl Lattice {
    fn gather<const D: usize, A: Action>(
        &self,
        neighbours: &[Neighbour],
        place: Place<'_, D>,
        target: &mut [f64],
        action: A,
    ) -> bool {
        if target.len() < LANES {
            return gather_few(neighbours, place, target, action);
        }
        match *neighbours {
            [] => self.gather_from::<D, A, 0>([], place, target, action),
            [a] => self.gather_from([a], place, target, action),
            [a, b] => self.gather_from([a, b], place, target, action),
            [a, b, c] => self.gather_from([a, b, c], place, target, action),
            [a, b, c, d] => self.gather_from([a, b, c, d], place, target, action),
            [a, b, c, d, e] => self.gather_from([a, b, c, d, e], place, target, action),
            [a, b, c, d, e, f] => self.gather_from([a, b, c, d, e, f], place, target, action),
            [a, b, c, d, e, f, g] => self.gather_from([a, b, c, d, e, f, g], place, target, action),
            [a, b, c, d, e, f, g, h, ..] => self.gather_from([a, b, c, d, e, f, g, h], place, target, action),
        }
    }

    fn gather_from<const D: usize, A: Action, const N: usize>(
        &self,
        neighbours: [Neighbour; N],
        place: Place<'_, D>,
        target: &mut [f64],
        action: A,
    ) -> bool {
        let Place { position, own, inverse_mass } = place;
        let components = |first: usize| &Vector::components(&position[first..])[..target.len()];
        let near = neighbours.map(|neighbour| components(own.strict_add_signed(neighbour.offset)));
        let (stiffness, own) = (neighbours.map(|neighbour| neighbour.stiffness), components(own));
        match inverse_mass {
            Inverse::Alike(one) => {
                eight::run(self.instructions, Gather { stiffness, near, own, inverse_mass: Alike(one), target, action })
            }
            Inverse::Each(all) => {
                let inverse_mass = Each(&all[..target.len()]);
                eight::run(self.instructions, Gather { stiffness, near, own, inverse_mass, target, action })
            }
        }
    }
}

/// As [`Gather`], but for so few numbers that preparing for it would take longer.
fn gather_few<const D: usize, A: Action>(neighbours: &[Neighbour], place: Place<'_, D>, target: &mut [f64], action: A) -> bool {
    let Place { position, own, inverse_mass } = place;
    let (position, mut doubt) = (Vector::components(position), 0.0);
    for n in 0..target.len() {
        let own = D * own + n;
        let pull = |neighbour: &Neighbour| {
            neighbour.stiffness * (position[own.wrapping_add_signed(D as isize * neighbour.offset)] - position[own])
        };
        let a = neighbours.iter().map(pull).reduce(|a, pull| a + pull).unwrap_or(0.0);
        let [x, seen] = action.act_on_one(target[n], a * inverse_mass.of(n));
        (target[n], doubt) = (x, doubt + seen);
    }
    doubt.is_finite()
}
