//! Springs stretched and particles moved in one sweep over the memory.
//!
//! Springs belong to the block of their lower ends. When those of a block are done, all that pulls at its particles has been added up,
//! and no later spring asks where these are: they can be moved at once. Accelerations live in a window that slides along, and what
//! goes through the memory is positions and velocities, once. Every sum has the terms, and their order, that [`Springs::stretch`]
//! gives it, however many threads share the sweep.

use corpuscle_core::{Boundary, Particles, Vector};
use rayon::prelude::*;

use super::{Place, Springs, alike};
use crate::constraint::Held;
use crate::motion::{Moves, both};
use crate::threads;

/// Particles that pass before a window starts anew, at least; and four blocks.
const WINDOW: usize = 4096;
/// Springs between particles farther apart would need windows that no cache holds.
const FARTHEST: usize = 16_384;
/// Parts of the memory a thread: whoever is held up leaves some to the others.
const PARTS_A_THREAD: usize = 4;

impl Springs {
    /// Whether [`sweep`](Self::sweep) may be asked for: all ends are near enough in memory, and there is no friction, which would need
    /// the accelerations before.
    pub(crate) fn can_sweep(&self) -> bool {
        self.reach <= FARTHEST && !self.damped
    }

    /// Kicks and drifts by the accelerations at the present positions, zero along coordinates that are held (in the order of their
    /// particles); tells what [`kick_and_drift`](crate::motion::kick_and_drift) does.
    pub(crate) fn sweep<const D: usize>(
        &self,
        boundary: &Boundary<D>,
        particles: &mut Particles<D>,
        held: &[Held],
        moves: Moves,
    ) -> [bool; 2] {
        let Particles { position, velocity, mass, .. } = particles;
        let near = self.near;
        let blocks = position.len().div_ceil(near);
        let parts = if threads::are_worth_it(position.len()) { PARTS_A_THREAD * rayon::current_num_threads() } else { 1 };
        // A seam looks back into one part only.
        let length = blocks.div_ceil(parts).max(self.reach.div_ceil(near)).max(1) * near;
        let sweep = Sweep { springs: self, boundary, mass, alike: alike(mass), held, moves };
        if length >= position.len() {
            return sweep.part(position, velocity, &Seam::default(), &Seam::default(), 0);
        }
        let mut seams: Vec<Seam<D>> =
            (length..position.len()).into_par_iter().step_by(length).map(|at| sweep.seam(position, at)).collect();
        seams.insert(0, Seam::default());
        seams.push(Seam::default());
        let parts = position.par_chunks_mut(length).zip(velocity.par_chunks_mut(length)).zip(seams.par_windows(2)).enumerate();
        let one = |(number, ((position, velocity), seams)): (usize, ((&mut [_], &mut [_]), &[Seam<D>]))| {
            sweep.part(position, velocity, &seams[0], &seams[1], number * length)
        };
        parts.map(one).reduce(|| [true; 2], both)
    }
}

/// What two parts of the memory have to know of each other before either moves.
#[derive(Default)]
struct Seam<const D: usize> {
    /// Where the first particles of the later part are.
    position: Vec<Vector<D>>,
    /// What springs with lower ends in the earlier part add to them.
    acceleration: Vec<Vector<D>>,
}

struct Sweep<'a, const D: usize> {
    springs: &'a Springs,
    boundary: &'a Boundary<D>,
    mass: &'a [f64],
    alike: Option<f64>,
    held: &'a [Held],
    moves: Moves,
}

impl<const D: usize> Sweep<'_, D> {
    /// The seam at particle `at`, where a block begins.
    fn seam(&self, position: &[Vector<D>], at: usize) -> Seam<D> {
        let Self { springs, boundary, alike, .. } = *self;
        let near = springs.near;
        let from = at - springs.reach.next_multiple_of(near);
        let end = (at + springs.reach).min(position.len());
        let mut acceleration = vec![Vector::ZERO; end - from];
        let (there, mass) = (&position[from..], &self.mass[from..]);
        for block in from / near..at / near {
            let place = Place { from, position: there, velocity: &[], mass, alike, acceleration: &mut acceleration };
            springs.stretch(springs.block(block), boundary, place);
        }
        Seam { position: position[at..end].to_vec(), acceleration: acceleration.split_off(at - from) }
    }

    /// One part, from particle `from` on, between two seams.
    fn part(
        &self,
        position: &mut [Vector<D>],
        velocity: &mut [Vector<D>],
        before: &Seam<D>,
        after: &Seam<D>,
        from: usize,
    ) -> [bool; 2] {
        let Self { springs, boundary, mass, alike, held, moves } = *self;
        let (count, reach, near) = (position.len(), springs.reach, springs.near);
        // From here on springs reach beyond the part: they find the places beside each other in a copy.
        let last = count.saturating_sub(reach) / near * near;
        let ending = [&position[last..], &after.position].concat();
        let mut window = vec![Vector::ZERO; WINDOW.max(4 * near).min(count) + reach];
        window[..before.acceleration.len()].copy_from_slice(&before.acceleration);
        let (mut window_from, mut finite) = (0, [true; 2]);
        let mut held = held[held.partition_point(|held| held.particle < from)..].iter().peekable();
        for start in (0..count).step_by(near) {
            let end = (start + near).min(count);
            if end - window_from + reach > window.len() {
                window.copy_within(start - window_from..start - window_from + reach, 0);
                window[reach..].fill(Vector::ZERO);
                window_from = start;
            }
            let acceleration = &mut window[start - window_from..];
            let there = if start < last { &position[start..] } else { &ending[start - last..] };
            let mass = &mass[from + start..];
            let place = Place { from: from + start, position: there, velocity: &[], mass, alike, acceleration };
            springs.stretch(springs.block((from + start) / near), boundary, place);
            let acceleration = &mut window[start - window_from..end - window_from];
            while let Some(held) = held.next_if(|held| held.particle < from + end) {
                acceleration[held.particle - from - start][held.axis] = 0.0;
            }
            finite = both(finite, moves.apply(&mut position[start..end], &mut velocity[start..end], acceleration));
        }
        finite
    }
}
