//! Running an engine for so many seconds of a clock.

use corpuscle_core::{Engine, Failure, Observer};

use crate::Clock;

/// Advances an engine in slices of physical time, until `seconds` of the clock have gone or it has reached `end`, and
/// answers the seconds spent. The first slice is a guess; later ones take about a hundredth of what is asked for.
///
/// Where an engine stops has no influence on its trajectory, so that only the end depends on the clock.
pub(crate) fn stretch<const D: usize, E: Engine<D>>(
    engine: &mut E,
    observer: &mut impl Observer<D>,
    clock: Clock,
    seconds: f64,
    mut slice: f64,
    end: f64,
) -> Result<f64, Failure> {
    let running = clock.start();
    let (mut spent, mut before) = (0.0, 0.0);
    while spent < seconds && engine.time() < end {
        engine.advance((engine.time() + slice).min(end), observer)?;
        spent = running.seconds();
        // At most twofold at a time: the first slices run cold.
        slice *= (0.01 * seconds / (spent - before).max(1e-9)).clamp(0.5, 2.0);
        before = spent;
    }
    Ok(spent)
}
