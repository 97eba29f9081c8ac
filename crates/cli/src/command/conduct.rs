//! How a run is conducted, whether it begins or goes on.

use clap::Args;

use crate::keeper;

/// Arguments that change no result.
#[derive(Args)]
pub(crate) struct Conduct {
    #[command(flatten)]
    pub(super) threads: Threads,
    /// Leave out the pictures.
    #[arg(long)]
    pub(super) no_pictures: bool,
    /// Print one line only.
    #[arg(long)]
    pub(super) quiet: bool,
    #[command(flatten)]
    pub(super) checkpoints: keeper::Options,
}

/// On how many cores.
#[derive(Args)]
pub(crate) struct Threads {
    /// Threads to use [default: all cores]. Results do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

impl Threads {
    /// So many threads, or one for each core.
    pub(super) fn set(&self) {
        if let Some(threads) = self.threads {
            // Fails only when a pool exists already; none does before this line.
            let _ = rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build_global();
        }
    }
}
