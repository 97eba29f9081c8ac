//! When several threads are worth the waiting for the last of them.

use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use rayon::Yield;
use rayon::prelude::*;

/// Particles a thread moves at a time.
pub(crate) const CHUNK: usize = 2048;
/// How long a thread looks for work before it may fall asleep: whoever it waits for may have lost its processor for a moment.
const PATIENCE: Duration = Duration::from_millis(2);
/// How long before it gives way to whoever else needs its processor: longer than what is between two passes.
const CLAIM: Duration = Duration::from_micros(20);

/// Whether simple passes over so many particles should be shared among threads: what one moves, another then has to fetch from its
/// cache, and that takes as long as to move some ten thousand.
pub(crate) fn are_worth_it(particles: usize) -> bool {
    particles >= 12 * CHUNK && rayon::current_num_threads() > 1
}

/// Does the same with every part, by all threads of the pool where the work is to be shared.
pub(crate) fn for_each<T: Send>(shared: bool, parts: impl Iterator<Item = T>, one: impl Fn(T) + Send + Sync) {
    if shared {
        parts.collect::<Vec<_>>().into_par_iter().for_each(one);
    } else {
        parts.for_each(one);
    }
}

/// Does the same with every part, and puts together what that gives: in any order, beginning with the default.
pub(crate) fn sum<T: Send, R: Default + Send>(
    shared: bool,
    parts: impl Iterator<Item = T>,
    one: impl Fn(T) -> R + Send + Sync,
    and: impl Fn(R, R) -> R + Send + Sync,
) -> R {
    if shared {
        parts.collect::<Vec<_>>().into_par_iter().map(one).reduce(R::default, and)
    } else {
        parts.map(one).fold(R::default(), and)
    }
}

thread_local! {
    /// How much work in [`kept_awake`] waits on this thread.
    static AT_WORK: Cell<usize> = const { Cell::new(0) };
}

/// Does work of many short passes by the threads of the pool, which look for their shares of the next one without falling asleep
/// in between. A thread whose processor somebody else needs gives way; what it would have done is done by the others. Nobody waits for
/// a thread that has found something else to do.
pub(crate) fn kept_awake<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    // In the pool, once and for all.
    rayon::scope(|_| {
        let shift = Shift::begin();
        for _ in 1..rayon::current_num_threads() {
            let done = shift.done.clone();
            rayon::spawn(move || look_for_work(&done));
        }
        work()
    })
}

/// From the beginning to the end of some work, whatever the end.
struct Shift {
    done: Arc<AtomicBool>,
}

impl Shift {
    fn begin() -> Self {
        AT_WORK.set(AT_WORK.get() + 1);
        Self { done: Arc::default() }
    }
}

impl Drop for Shift {
    fn drop(&mut self) {
        AT_WORK.set(AT_WORK.get() - 1);
        self.done.store(true, Ordering::Relaxed);
    }
}

/// Until there has been none for a while; not a thread that took this up while it waits for a share of its own.
fn look_for_work(done: &AtomicBool) {
    if AT_WORK.get() > 0 {
        return;
    }
    let mut last = Instant::now();
    while !done.load(Ordering::Relaxed) && last.elapsed() < PATIENCE {
        if rayon::yield_now() == Some(Yield::Executed) {
            last = Instant::now();
        } else if last.elapsed() < CLAIM {
            std::hint::spin_loop();
        } else {
            std::thread::yield_now();
        }
    }
}
