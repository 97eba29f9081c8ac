//! Work on so many threads.

use corpuscle_core::Invalid;
use corpuscle_experiments::Settings;

use crate::{THREADS, Trouble};

/// Runs `work` on a thread of a pool of its own, as large as the parameter [`THREADS`] says.
///
/// Whoever has one thread does its work there, so that the clock of that thread sees all of it.
pub(crate) fn in_pool<T: Send>(settings: &Settings, work: impl FnOnce() -> Result<T, Trouble> + Send) -> Result<T, Trouble> {
    let count = settings.whole(THREADS.name);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build();
    let refused = |_| Invalid::new(THREADS.name, count, "as many threads as the system can start");
    pool.map_err(refused)?.install(work)
}
