//! When several threads are worth the waiting for the last of them.

/// Particles a thread moves at a time.
pub(crate) const CHUNK: usize = 2048;

/// Whether simple passes over so many particles should be shared among threads: to wake one takes as long as to move some
/// ten thousand.
pub(crate) fn are_worth_it(particles: usize) -> bool {
    particles >= 12 * CHUNK && rayon::current_num_threads() > 1
}
