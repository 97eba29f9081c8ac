//! Splitting methods: alternate kicks by the forces and free drifts, of lengths from a table.
//!
//! Every one of them is exact for each half of the energy alone, hence symplectic; those with one drift stay so with hard
//! walls, where the drift is a billiard flow. A table read the same backwards makes the method reversible.

use corpuscle_core::Failure;

use crate::system::System;

/// A kick and the drift after it, as shares of the step.
pub(crate) struct Stage {
    kick: f64,
    drift: f64,
}

pub(crate) type Composition = [Stage];

/// Kick by the whole step, drift by the whole step.
pub(crate) const SYMPLECTIC_EULER: &Composition = &[Stage { kick: 1.0, drift: 1.0 }];

/// Half a kick, a drift, half a kick.
pub(crate) static VELOCITY_VERLET: [Stage; 2] = compose([1.0]);

/// `w_1 = 1/(2 - 2^(1/3))`, the outer steps of Yoshida's triple jump.
const OUTER: f64 = 1.351_207_191_959_657_6;
/// `w_0 = -2^(1/3)/(2 - 2^(1/3))`, the backward step in its middle.
const MIDDLE: f64 = -1.702_414_383_919_315_3;

/// Velocity Verlet steps of lengths `w_1, w_0, w_1`, where `2 w_1 + w_0 = 1` and `2 w_1^3 + w_0^3 = 0`.
pub(crate) static YOSHIDA_4: [Stage; 4] = compose([OUTER, MIDDLE, OUTER]);

/// Velocity Verlet steps of the given lengths in a row, neighbouring half kicks merged.
const fn compose<const LENGTHS: usize, const STAGES: usize>(lengths: [f64; LENGTHS]) -> [Stage; STAGES] {
    assert!(STAGES == LENGTHS + 1);
    let mut stages = [const { Stage { kick: 0.0, drift: 0.0 } }; STAGES];
    let mut i = 0;
    while i < LENGTHS {
        stages[i].kick += 0.5 * lengths[i];
        stages[i].drift = lengths[i];
        stages[i + 1].kick = 0.5 * lengths[i];
        i += 1;
    }
    stages
}

/// One step. The acceleration of the last kick serves the first of the next step.
pub(crate) fn step<const D: usize>(
    stages: &Composition,
    system: &mut System<D>,
    start: f64,
    end: f64,
    dt: f64,
) -> Result<(), Failure> {
    let (mut drifted, mut kicked) = (0.0, 0.0);
    let mut time = start;
    for (number, stage) in stages.iter().enumerate() {
        system.accelerate(time, (drifted - kicked) * dt);
        kicked += stage.kick;
        if stage.drift == 0.0 {
            system.kick(stage.kick * dt);
            continue;
        }
        system.kick_and_drift(stage.kick * dt, stage.drift * dt);
        drifted += stage.drift;
        let last = stages[number + 1..].iter().all(|stage| stage.drift == 0.0);
        time = if last { end } else { start + drifted * dt };
        system.hold(time);
        if last {
            system.confine(end, dt)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kicks_and_drifts_add_up_to_one_step() {
        for stages in [SYMPLECTIC_EULER, &VELOCITY_VERLET, &YOSHIDA_4] {
            assert!((stages.iter().map(|s| s.kick).sum::<f64>() - 1.0).abs() < 4.0 * f64::EPSILON);
            assert!((stages.iter().map(|s| s.drift).sum::<f64>() - 1.0).abs() < 4.0 * f64::EPSILON);
        }
    }

    /// The condition that removes the error of third order; each cube carries a few roundings of numbers below 5.
    #[test]
    fn yoshida_s_lengths_cancel_the_cubes() {
        assert!((2.0 * OUTER.powi(3) + MIDDLE.powi(3)).abs() < 8.0 * 5.0 * f64::EPSILON);
    }
}
