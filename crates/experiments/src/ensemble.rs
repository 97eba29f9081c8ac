//! Replicas and state points side by side: independent systems on as many threads as there are, with results that do not
//! depend on how many.

use corpuscle_core::Failure;
use rayon::prelude::*;

/// Does the same to every member, in parallel; of several failures the one of the first member is returned.
///
/// Members share nothing, so that the bits of each are its own.
///
/// # Errors
/// The failure of the first member that failed.
pub(crate) fn for_each<T: Send>(
    members: &mut [T],
    task: impl Fn(&mut T) -> Result<(), Failure> + Sync + Send,
) -> Result<(), Failure> {
    let outcomes: Vec<Result<(), Failure>> = members.par_iter_mut().map(task).collect();
    outcomes.into_iter().collect()
}

/// Builds one member for each job, in parallel; of several errors the one of the first job is returned.
///
/// # Errors
/// The error of the first job that failed.
pub(crate) fn build<J: Sync, T: Send, E: Send>(jobs: &[J], make: impl Fn(&J) -> Result<T, E> + Sync + Send) -> Result<Vec<T>, E> {
    let outcomes: Vec<Result<T, E>> = jobs.par_iter().map(make).collect();
    outcomes.into_iter().collect()
}
