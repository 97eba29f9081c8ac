//! Springs of any kind stretched one after the other, what pulls at their ends added up there, and particles moved behind them.
//!
//! Springs belong to the block of their lower ends. When those of a block are done, all that pulls at its particles has been added up,
//! and no later spring asks where these are: they can be moved at once. Accelerations live in a window that slides along.

use corpuscle_core::{Boundary, Particles, Vector};
use rayon::prelude::*;

use super::{NEAR, PARTS_A_THREAD, Place, Springs};
use crate::constraint::{self, Held};
use crate::motion::{Moves, Stride, both};
use crate::threads;

/// Particles that pass before a window starts anew, at least; and four blocks.
const WINDOW: usize = 4096;

impl Springs {
    /// A stride, whatever the springs; tells what [`kick_and_drift`](crate::motion::kick_and_drift) does.
    pub(super) fn scatter<const D: usize>(
        &self,
        boundary: &Boundary<D>,
        particles: &mut Particles<D>,
        held: &[Held],
        Stride { moves, end, .. }: Stride,
    ) -> [bool; 2] {
        let Particles { position, velocity, mass, .. } = &mut *particles;
        let finite = Scattering { springs: self, boundary, mass, held, moves }.in_parts(position, velocity);
        for held in held {
            held.apply(end, particles);
        }
        finite
    }
}

/// What two parts of the memory have to know of each other before particles of either move.
#[derive(Default)]
struct Seam<const D: usize> {
    /// Where the first particles of the later part are.
    position: Vec<Vector<D>>,
    /// What springs with lower ends in the earlier part add to them.
    acceleration: Vec<Vector<D>>,
}

struct Scattering<'a, const D: usize> {
    springs: &'a Springs,
    boundary: &'a Boundary<D>,
    mass: &'a [f64],
    held: &'a [Held],
    moves: Moves,
}

impl<const D: usize> Scattering<'_, D> {
    /// In as many parts as there are threads for, each of whole blocks and longer than springs reach: a seam looks back into one part
    /// only. Every sum has the terms, and their order, that it has in one part.
    fn in_parts(&self, position: &mut [Vector<D>], velocity: &mut [Vector<D>]) -> [bool; 2] {
        let (count, reach) = (position.len(), self.springs.reach);
        let parts = if threads::are_worth_it(count) { PARTS_A_THREAD * rayon::current_num_threads() } else { 1 };
        let length = count.div_ceil(NEAR).div_ceil(parts).max(reach.div_ceil(NEAR)).max(1) * NEAR;
        if length >= count {
            return self.part(position, velocity, &Seam::default(), &Seam::default(), 0);
        }
        let mut seams: Vec<Seam<D>> = (length..count).into_par_iter().step_by(length).map(|at| self.seam(position, at)).collect();
        seams.insert(0, Seam::default());
        seams.push(Seam::default());
        let parts = position.par_chunks_mut(length).zip(velocity.par_chunks_mut(length)).zip(seams.par_windows(2)).enumerate();
        let moved = parts
            .map(|(number, ((position, velocity), seams))| self.part(position, velocity, &seams[0], &seams[1], number * length));
        moved.reduce(|| [true; 2], both)
    }

    /// The seam at particle `at`, where a block begins.
    fn seam(&self, position: &[Vector<D>], at: usize) -> Seam<D> {
        let Self { springs, boundary, .. } = *self;
        let from = at - springs.reach.next_multiple_of(NEAR);
        let end = (at + springs.reach).min(position.len());
        let mut acceleration = vec![Vector::ZERO; end - from];
        let (there, mass) = (&position[from..], &self.mass[from..]);
        for block in from / NEAR..at / NEAR {
            let place = Place { from, position: there, velocity: &[], mass, acceleration: &mut acceleration };
            springs.stretch(springs.block(block), boundary, place);
        }
        Seam { position: position[at..end].to_vec(), acceleration: acceleration.split_off(at - from) }
    }

    /// Moves the particles of one part, from particle `from` on, between two seams; tells what
    /// [`kick_and_drift`](crate::motion::kick_and_drift) does.
    fn part(
        &self,
        position: &mut [Vector<D>],
        velocity: &mut [Vector<D>],
        before: &Seam<D>,
        after: &Seam<D>,
        from: usize,
    ) -> [bool; 2] {
        let Self { springs, boundary, mass, held, moves } = *self;
        let (count, reach) = (position.len(), springs.reach);
        // From here on springs reach beyond the part: they find the places beside each other in a copy.
        let last = count.saturating_sub(reach) / NEAR * NEAR;
        let ending = [&position[last..], &after.position].concat();
        let mut window = vec![Vector::ZERO; WINDOW.max(4 * NEAR).min(count) + reach];
        window[..before.acceleration.len()].copy_from_slice(&before.acceleration);
        let (mut window_from, mut finite) = (0, [true; 2]);
        for start in (0..count).step_by(NEAR) {
            let end = (start + NEAR).min(count);
            if end - window_from + reach > window.len() {
                window.copy_within(start - window_from..start - window_from + reach, 0);
                window[reach..].fill(Vector::ZERO);
                window_from = start;
            }
            let acceleration = &mut window[start - window_from..];
            let there = if start < last { &position[start..] } else { &ending[start - last..] };
            let mass = &mass[from + start..];
            let place = Place { from: from + start, position: there, velocity: &[], mass, acceleration };
            springs.stretch(springs.block((from + start) / NEAR), boundary, place);
            let acceleration = &mut window[start - window_from..end - window_from];
            for held in constraint::among(held, from + start..from + end) {
                acceleration[held.particle - from - start][held.axis] = 0.0;
            }
            finite = both(finite, moves.apply(&mut position[start..end], &mut velocity[start..end], acceleration));
        }
        finite
    }
}
