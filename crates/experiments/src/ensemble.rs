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
pub(crate) fn for_each<T: Send>(members: &mut [T], task: impl Fn(&mut T) -> Result<(), Failure> + Sync) -> Result<(), Failure> {
    let outcomes: Vec<Result<(), Failure>> = members.par_iter_mut().map(task).collect();
    outcomes.into_iter().collect()
}
