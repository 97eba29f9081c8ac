//! Ctrl-C: once ends cleanly, twice at once.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether the user, or the system, has asked to stop.
#[derive(Clone, Default)]
pub(crate) struct Stop(Arc<AtomicBool>);

impl Stop {
    /// Listens from now on. Where the system offers no signals, nothing ever asks.
    pub(crate) fn listen() -> Self {
        let stop = Self::default();
        let asked = stop.clone();
        let listening = ctrlc::set_handler(move || {
            if asked.0.swap(true, Ordering::SeqCst) {
                std::process::exit(1);
            }
            crate::console::complain("stopping cleanly; once more to stop at once");
        });
        if let Err(error) = listening {
            crate::console::complain(&format!("Ctrl-C will end the run without a report: {error}"));
        }
        stop
    }

    /// Whether it has been asked.
    pub(crate) fn asked(&self) -> bool {
        self.0.load(Ordering::SeqCst)
    }
}
