//! Splitting methods: alternate kicks by the forces and free drifts, of lengths from a table.
//!
//! Every one of them is exact for each half of the energy alone, hence symplectic; those with one drift stay so with hard
//! walls, where the drift is a billiard flow. The others go through a wall and are thrown back as if their path had been a
//! parabola. A table read the same backwards makes the method reversible.

use corpuscle_core::Failure;

use crate::system::{Path, System};

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

/// `w_1, w_0, w_1`, where `2 w_1 + w_0 = 1` and `2 w_1^3 + w_0^3 = 0`.
pub(super) const LENGTHS_4: [f64; 3] = [OUTER, MIDDLE, OUTER];

/// Yoshida's solution A of order 6 (1990, doi:10.1016/0375-9601(90)90092-3, table 1).
#[allow(clippy::excessive_precision)] // digits to check against other tables
const LENGTHS_6: [f64; 7] = symmetric([
    0.784_513_610_477_557_263_82,
    0.235_573_213_359_358_133_68,
    -1.177_679_984_178_871_006_95,
    1.315_186_320_683_911_218_89,
]);

/// Order 8 in Yoshida's form of 15 steps; the solution with the smallest longest step (Suzuki and Umeno 1993,
/// doi:10.1007/978-3-642-78448-4_7; Hairer, Lubich and Wanner 2006, doi:10.1007/3-540-30666-8, equation V.3.11).
#[allow(clippy::excessive_precision)] // digits to check against other tables
const LENGTHS_8: [f64; 15] = symmetric([
    0.741_670_364_350_612_953_448_227_80,
    -0.409_100_825_800_031_593_997_300_10,
    0.190_754_710_296_238_379_953_876_26,
    -0.573_862_471_116_082_266_656_387_73,
    0.299_064_181_303_655_923_844_463_54,
    0.334_624_918_245_298_183_784_957_98,
    0.315_293_092_396_766_596_632_056_66,
    -0.796_887_939_352_916_354_019_788_84,
]);

pub(crate) static YOSHIDA_4: [Stage; 4] = compose(LENGTHS_4);
pub(crate) static YOSHIDA_6: [Stage; 8] = compose(LENGTHS_6);
pub(crate) static YOSHIDA_8: [Stage; 16] = compose(LENGTHS_8);

/// The first half of a table and its middle, made whole: read backwards it is the same.
const fn symmetric<const HALF: usize, const WHOLE: usize>(half: [f64; HALF]) -> [f64; WHOLE] {
    assert!(WHOLE == 2 * HALF - 1);
    let mut whole = [0.0; WHOLE];
    let mut i = 0;
    while i < HALF {
        whole[i] = half[i];
        whole[WHOLE - 1 - i] = half[i];
        i += 1;
    }
    whole
}

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

/// One step. The acceleration of the last kick serves the first of the next step, which does both.
pub(crate) fn step<const D: usize>(
    stages: &Composition,
    system: &mut System<D>,
    start: f64,
    end: f64,
    dt: f64,
) -> Result<(), Failure> {
    let (mut drifted, mut kicked) = (0.0, 0.0);
    let mut time = start;
    let drifts = stages.iter().filter(|stage| stage.drift != 0.0).count();
    for (number, stage) in stages.iter().enumerate() {
        let lag = (drifted - kicked) * dt;
        kicked += stage.kick;
        if stage.drift == 0.0 {
            system.owe_kick(time, lag, stage.kick * dt);
            continue;
        }
        drifted += stage.drift;
        let last = stages[number + 1..].iter().all(|stage| stage.drift == 0.0);
        let until = if last { end } else { start + drifted * dt };
        if !system.advance(time, lag, stage.kick * dt, stage.drift * dt, until) {
            system.check(start)?;
        }
        time = until;
        if last {
            let path = if drifts == 1 { Path::Straight } else { Path::Bent { kick: (drifted - kicked) * dt } };
            system.confine(end, dt, path)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kicks_and_drifts_add_up_to_one_step() {
        for stages in [SYMPLECTIC_EULER, &VELOCITY_VERLET, &YOSHIDA_4, &YOSHIDA_6, &YOSHIDA_8] {
            assert!((stages.iter().map(|s| s.kick).sum::<f64>() - 1.0).abs() < 16.0 * f64::EPSILON);
            assert!((stages.iter().map(|s| s.drift).sum::<f64>() - 1.0).abs() < 16.0 * f64::EPSILON);
        }
    }

    /// Of the conditions for order `p`, those on the sums of odd powers below it: `sum w = 1`, `sum w^3 = 0`, ... Tables are
    /// good to a few units of the last digit of a double, and a power multiplies that by at most `p max |w|^p`.
    #[test]
    fn yoshida_s_lengths_cancel_odd_powers() {
        for (lengths, order) in [(&LENGTHS_4[..], 4), (&LENGTHS_6, 6), (&LENGTHS_8, 8)] {
            for power in (1..order).step_by(2) {
                let sum: f64 = lengths.iter().map(|w| w.powi(power)).sum();
                let size: f64 = lengths.iter().map(|w| w.abs().powi(power)).sum();
                let expected = if power == 1 { 1.0 } else { 0.0 };
                assert!((sum - expected).abs() < 4.0 * f64::from(power) * size * f64::EPSILON, "{order}, {power}: {sum:e}");
            }
        }
    }
}
