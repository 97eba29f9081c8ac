//! The clocks speed is measured by.

use std::sync::LazyLock;
use std::time::Instant;

/// From when the wall's clock counts.
static ORIGIN: LazyLock<Instant> = LazyLock::new(Instant::now);

/// A clock, by name: what runs on one thread is timed by that thread alone, so that other work on the machine counts little.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// Processor time of this thread.
    Thread,
    /// Time on the wall: for work on several threads, whose gain is what is asked for.
    Wall,
}

impl Clock {
    /// Its name in a report. Where the system has no clock for threads, the wall's is read instead, and named.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Thread if cfg!(unix) => "processor time of this thread",
            _ => "wall time",
        }
    }

    /// Starts it.
    pub(crate) fn start(self) -> Running {
        Running { clock: self, started: self.read() }
    }

    fn read(self) -> f64 {
        #[cfg(unix)]
        if self == Self::Thread {
            let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
            return time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64;
        }
        ORIGIN.elapsed().as_secs_f64()
    }
}

/// A clock that has been started.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Running {
    clock: Clock,
    started: f64,
}

impl Running {
    /// Seconds since the start.
    pub(crate) fn seconds(&self) -> f64 {
        self.clock.read() - self.started
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::{Duration, Instant};

    #[cfg(unix)]
    #[test]
    fn a_sleeping_thread_spends_no_processor_time() {
        let (thread, wall) = (Clock::Thread.start(), Clock::Wall.start());
        std::thread::sleep(Duration::from_millis(50));
        assert!(wall.seconds() >= 0.05 && thread.seconds() < 0.04, "{} {}", wall.seconds(), thread.seconds());
    }

    #[test]
    fn a_busy_thread_does() {
        let (thread, begin) = (Clock::Thread.start(), Instant::now());
        while thread.seconds() < 0.01 {}
        assert!(begin.elapsed() >= Duration::from_millis(9));
    }
}
