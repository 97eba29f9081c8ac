//! Several steps of particles in the order of the neighbour list: whoever finds the force on a particle moves it.
//!
//! Particles are put in that order once in many steps, and not for each. Nothing then goes through the memory but what a step needs,
//! and a thread finds the particles that it moves, and most of their neighbours, in its own cache.

use corpuscle_core::{Axis, Boundary, Particles, Vector};

use super::kernel::{Finder, Law, Pairs, Table, Uniform};
use super::{PairForce, PairPotential, finest, larger, largest};
use crate::exact::Quantum;
use crate::lanes::{self, InLanes, LANES, Lanes};
use crate::motion::{self, Inside, Moves, Stride};
use crate::neighbours::{Farthest, Moved, column};
use crate::strider::{Progress, State, Strider};
use crate::threads::{self, CHUNK};

/// Fewer strides are not worth putting particles in order.
const FEWEST: usize = 3;

/// Particles in the order of the list.
#[derive(Default)]
pub(super) struct InOrder<const D: usize> {
    /// Those of each share.
    parts: Vec<Share<D>>,
    /// Where all of them go.
    next: Vec<[f64; D]>,
}

/// The components of four vectors.
type Quad<const D: usize> = [[f64; LANES]; D];

/// What the particles of a share have beside their positions.
struct Share<const D: usize> {
    velocity: Vec<Quad<D>>,
    next_velocity: Vec<Quad<D>>,
    inverse_mass: Vec<[f64; LANES]>,
    /// Who has gone through periodic faces in this stride.
    crossings: Vec<Crossing<D>>,
}

/// How often the particle at a place of a share went through the upper minus the lower face of each axis.
struct Crossing<const D: usize> {
    place: usize,
    images: [i64; D],
}

impl<P: PairPotential, const D: usize> Strider<D> for PairForce<P, D> {
    fn strides_at_once(&mut self, state: &State<'_, D>) -> usize {
        if state.boundary.axes.contains(&Axis::Walls) || !state.held.is_empty() { 0 } else { usize::MAX }
    }

    /// Stops before a stride after which something would not be a finite number.
    fn stride(&mut self, state: State<'_, D>, strides: &[Stride]) -> Progress {
        let mut taken = 0;
        if strides.len() >= FEWEST {
            let State { boundary, particles, images, .. } = state;
            let mut order = std::mem::take(&mut self.order);
            self.neighbours.awake = true;
            self.neighbours.update(boundary, &particles.position);
            let shared = self.neighbours.is_shared();
            let mut all = || self.take_strides(&mut order, boundary, particles, images, strides);
            // Whoever comes from outside enters the pool once, and not for each share.
            taken = if shared { rayon::scope(|_| all()) } else { all() };
            self.neighbours.awake = false;
            self.order = order;
        }
        Progress { taken, finite: [true; 2] }
    }
}

impl<P: PairPotential, const D: usize> PairForce<P, D> {
    /// Takes strides, the first from a list that holds; tells how many.
    fn take_strides(
        &mut self,
        order: &mut InOrder<D>,
        boundary: &Boundary<D>,
        particles: &mut Particles<D>,
        images: &mut [[i64; D]],
        strides: &[Stride],
    ) -> usize {
        let (table, mut taken) = (self.table.clone(), 0);
        loop {
            self.neighbours.blocks.load_species(&particles.species);
            self.put_in_order(order, particles);
            let ahead = &strides[taken..];
            let shared = self.neighbours.is_shared();
            let mut while_it_holds = || {
                if let [potential] = table[..] {
                    self.while_it_holds(Uniform(potential), order, boundary, images, ahead)
                } else {
                    self.while_it_holds(Table(&table, self.species), order, boundary, images, ahead)
                }
            };
            let (more, holds) = if shared { threads::kept_awake(while_it_holds) } else { while_it_holds() };
            self.put_back(order, particles);
            taken += more;
            if holds {
                return taken;
            }
            self.neighbours.build(boundary, &particles.position);
        }
    }

    /// Takes strides as long as the list holds, up to the last or to one that cannot be taken; tells how many, and whether it does.
    fn while_it_holds<L: Law>(
        &mut self,
        law: L,
        order: &mut InOrder<D>,
        boundary: &Boundary<D>,
        images: &mut [[i64; D]],
        strides: &[Stride],
    ) -> (usize, bool) {
        for (number, stride) in strides.iter().enumerate() {
            let Some(closer) = self.foresee(law, order, boundary, stride) else { return (number, true) };
            let InOrder { parts, next } = &mut *order;
            std::mem::swap(&mut self.neighbours.blocks.position, next);
            let places = self.neighbours.places_a_share();
            for (first, share) in (0..).step_by(places).zip(parts) {
                std::mem::swap(&mut share.velocity, &mut share.next_velocity);
                for Crossing { place, images: more } in share.crossings.drain(..) {
                    let images = &mut images[self.neighbours.blocks.particle[first + place] as usize];
                    *images = std::array::from_fn(|k| images[k] + more[k]);
                }
            }
            if number + 1 < strides.len() && !self.neighbours.keep_up(boundary, closer) {
                return (number + 1, false);
            }
        }
        (strides.len(), true)
    }

    /// Finds out where a stride leads. Tells by how much two particles will have come nearer to each other since the list was pruned;
    /// nothing if something would not be a finite number.
    fn foresee<L: Law>(&mut self, law: L, order: &mut InOrder<D>, boundary: &Boundary<D>, stride: &Stride) -> Option<f64> {
        let cutoff = largest(&self.table, P::cutoff);
        let finest = finest(&self.table, |potential| potential.depth() / potential.length());
        let (blocks, shares, pruned_at) = (&self.neighbours.blocks, &self.neighbours.shares, &self.neighbours.pruned_at);
        let (places, shared, instructions) = (self.neighbours.places_a_share(), self.neighbours.is_shared(), self.instructions);
        let InOrder { parts, next } = order;
        loop {
            let quantum = self.quantum;
            let one = |(number, (share, next)): (usize, (&mut Share<D>, &mut [[f64; D]]))| {
                let pairs = Self::pairs(law, boundary, blocks, &shares[number]);
                let pruned_at = &pruned_at[number * places..][..next.len()];
                lanes::run(instructions, Foresee { pairs, quantum, boundary, stride, pruned_at, share, next })
            };
            let parts = parts.iter_mut().zip(next.chunks_mut(places)).enumerate();
            let seen = threads::sum(shared, parts, one, Seen::and);
            let bound = seen.scale * cutoff;
            if !(bound + seen.doubt).is_finite() {
                return None;
            }
            // The quantum is a guess as in `find_forces`.
            let needed = finest.coarsened(bound);
            if needed == quantum {
                return Some(seen.moved.closer_by());
            }
            self.quantum = needed;
        }
    }

    /// Puts velocities and masses in the order of the list, where positions are.
    fn put_in_order(&self, order: &mut InOrder<D>, particles: &Particles<D>) {
        let blocks = &self.neighbours.blocks;
        let (places, count) = (self.neighbours.places_a_share(), self.neighbours.shares.len());
        order.next.resize(blocks.position.len(), [0.0; D]);
        order.parts.resize_with(count, || Share {
            velocity: vec![],
            next_velocity: vec![],
            inverse_mass: vec![],
            crossings: vec![],
        });
        let velocity = |i: u32, k: usize| particles.velocity.get(i as usize).map_or(0.0, |v| v[k]);
        let inverse_mass = |i: u32| particles.mass.get(i as usize).map_or(0.0, |mass| 1.0 / mass);
        let parts = order.parts.iter_mut().zip(blocks.particle.chunks(places));
        threads::for_each(self.neighbours.is_shared(), parts, |(share, members)| {
            let (quads, _) = members.as_chunks::<LANES>();
            share.velocity.clear();
            share.velocity.extend(quads.iter().map(|quad| std::array::from_fn(|k| quad.map(|i| velocity(i, k)))));
            share.inverse_mass.clear();
            share.inverse_mass.extend(quads.iter().map(|quad| quad.map(inverse_mass)));
            share.next_velocity.resize(share.velocity.len(), [[0.0; LANES]; D]);
        });
    }

    /// Puts positions and velocities back where they belong.
    fn put_back(&self, order: &InOrder<D>, particles: &mut Particles<D>) {
        let blocks = &self.neighbours.blocks;
        let quads = self.neighbours.places_a_share() / LANES;
        let chunks = particles.position.chunks_mut(CHUNK).zip(particles.velocity.chunks_mut(CHUNK)).zip(blocks.place.chunks(CHUNK));
        threads::for_each(self.neighbours.is_shared(), chunks, |((position, velocity), place)| {
            for ((position, velocity), &place) in position.iter_mut().zip(velocity).zip(place) {
                let place = place as usize;
                let (quad, lane) = (place / LANES, place % LANES);
                let of_quad = &order.parts[quad / quads].velocity[quad % quads];
                *position = Vector(blocks.position[place]);
                *velocity = Vector::from_fn(|k| of_quad[k][lane]);
            }
        });
    }
}

/// What is seen of a stride.
#[derive(Clone, Copy, Default)]
struct Seen {
    /// The largest `|U'(r)/r|`.
    scale: f64,
    moved: Moved,
    /// A sum that is finite only if all velocities and positions are.
    doubt: f64,
}

impl Seen {
    fn and(self, other: Self) -> Self {
        Self { scale: larger(self.scale, other.scale), moved: self.moved.and(other.moved), doubt: self.doubt + other.doubt }
    }
}

/// Finds what a share's particles are after a stride: the same operations as of accelerations, kicks, drifts and wraps one after the
/// other.
struct Foresee<'a, L, const D: usize> {
    pairs: Pairs<'a, L, D>,
    quantum: Quantum,
    boundary: &'a Boundary<D>,
    stride: &'a Stride,
    pruned_at: &'a [[f64; D]],
    share: &'a mut Share<D>,
    next: &'a mut [[f64; D]],
}

impl<L: Law, const D: usize> InLanes for Foresee<'_, L, D> {
    type Output = Seen;

    #[inline(always)]
    fn run<V: Lanes>(self) -> Seen {
        let Self { pairs, quantum, boundary, stride, pruned_at, share, next } = self;
        let Moves { owed, kick, drift } = stride.moves;
        let (kick, drift, zero) = (V::splat(kick), V::splat(drift), V::splat(0.0));
        let mut finder = Finder::<V, L, D, 1>::new(&pairs, [quantum, quantum.finer()]);
        let image = pairs.image.in_lanes::<V>();
        let inside = if stride.confined { Inside::new(boundary) } else { Inside::everywhere() };
        let mut bounds = [(zero, zero); D];
        for k in 0..D {
            bounds[k] = (V::splat(inside.least[k]), V::splat(inside.largest[k]));
        }
        let (mut farthest, mut doubts, mut doubt) = (Farthest::<V>::new(), zero, 0.0);
        share.crossings.clear();
        let rows = (pairs.rows.first..).zip(pairs.rows.iter());
        for (quad, (block, near)) in rows.enumerate() {
            let forces = finder.forces(block, &near);
            let now = &pairs.blocks.position[block * LANES..(block + 1) * LANES];
            let (before, next) = (&pruned_at[quad * LANES..(quad + 1) * LANES], &mut next[quad * LANES..(quad + 1) * LANES]);
            let inverse_mass = V::new(share.inverse_mass[quad]);
            let (mut way, mut outside) = ([zero; D], false);
            for k in 0..D {
                let a = forces[k].mul(inverse_mass).add(zero); // no negative zero, as in a sum that begins with zero
                let mut v = V::new(share.velocity[quad][k]);
                if let Some(owed) = owed {
                    v = v.add(a.mul(V::splat(owed)));
                }
                v = v.add(a.mul(kick));
                let r = column::<V, D>(now, k).add(v.mul(drift));
                share.next_velocity[quad][k] = v.lanes();
                let places = r.lanes();
                for lane in 0..LANES {
                    next[lane][k] = places[lane];
                }
                doubts = doubts.add(v);
                outside |= r.any_less(bounds[k].0) | bounds[k].1.any_less(r);
                way[k] = image.component(k, r.sub(column::<V, D>(before, k)));
            }
            farthest.see(&way);
            if outside {
                for (lane, r) in next.iter_mut().enumerate() {
                    if (0..D).any(|k| inside.is_outside(k, r[k])) {
                        let (mut place, mut images) = (Vector(*r), [0; D]);
                        motion::wrap(boundary, &mut place, &mut images);
                        *r = place.0;
                        doubt += r.iter().sum::<f64>();
                        share.crossings.push(Crossing { place: quad * LANES + lane, images });
                    }
                }
            }
        }
        doubt += doubts.lanes().iter().sum::<f64>();
        Seen { scale: finder.largest(), moved: farthest.moved(), doubt }
    }
}
