//! Accelerations found and particles moved in one sweep over the memory.
//!
//! What goes through the memory is positions and velocities, once; accelerations never leave a cache. Every sum has the terms, and
//! their order, that it has without a sweep, however many threads share it.

use corpuscle_core::Vector;
use rayon::prelude::*;

use crate::motion::both;
use crate::threads;

/// Parts of the memory a thread: whoever is held up leaves some to the others.
const PARTS_A_THREAD: usize = 2;

/// A sweep that can be cut into parts.
pub(super) trait Sweep<const D: usize>: Sync {
    /// What two parts have to know of each other before either moves.
    type Seam: Default + Send + Sync;

    /// The seam at particle `at`, where a block begins.
    fn seam(&self, position: &[Vector<D>], velocity: &[Vector<D>], at: usize) -> Self::Seam;

    /// Moves the particles of one part, from particle `from` on, between two seams; tells what
    /// [`kick_and_drift`](crate::motion::kick_and_drift) does.
    fn part(
        &self,
        position: &mut [Vector<D>],
        velocity: &mut [Vector<D>],
        before: &Self::Seam,
        after: &Self::Seam,
        from: usize,
    ) -> [bool; 2];
}

/// Does a sweep in as many parts as there are threads for, each of whole blocks of `block` particles and longer than springs reach: a
/// seam looks back into one part only.
pub(super) fn in_parts<const D: usize, S: Sweep<D>>(
    sweep: &S,
    position: &mut [Vector<D>],
    velocity: &mut [Vector<D>],
    block: usize,
    reach: usize,
) -> [bool; 2] {
    let blocks = position.len().div_ceil(block);
    let parts = if threads::are_worth_it(position.len()) { PARTS_A_THREAD * rayon::current_num_threads() } else { 1 };
    let length = blocks.div_ceil(parts).max(reach.div_ceil(block)).max(1) * block;
    if length >= position.len() {
        return sweep.part(position, velocity, &S::Seam::default(), &S::Seam::default(), 0);
    }
    let mut seams: Vec<S::Seam> =
        (length..position.len()).into_par_iter().step_by(length).map(|at| sweep.seam(position, velocity, at)).collect();
    seams.insert(0, S::Seam::default());
    seams.push(S::Seam::default());
    let parts = position.par_chunks_mut(length).zip(velocity.par_chunks_mut(length)).zip(seams.par_windows(2)).enumerate();
    let moved =
        parts.map(|(number, ((position, velocity), seams))| sweep.part(position, velocity, &seams[0], &seams[1], number * length));
    moved.reduce(|| [true; 2], both)
}
