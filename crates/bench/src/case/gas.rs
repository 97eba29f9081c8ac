//! What the cases on hard spheres share: parameters, coming to equilibrium, and the work of the engine.

use corpuscle_core::particles::ball_volume;
use corpuscle_core::{Engine, Observer};
use corpuscle_event::{Counts, EventDriven};
use corpuscle_experiments::{Kind, Parameter};

use crate::stretch::stretch;
use crate::{Clock, Figure, Trouble};

pub(super) const DIMENSION: Parameter = Parameter {
    name: "dimension",
    unit: "",
    help: "Discs in the plane, or spheres in space.",
    kind: Kind::Choice { default: "3", options: &["2", "3"] },
};

/// Side of the cube (square) of which balls of this total volume fill the fraction `packing`.
pub(super) fn side<const D: usize>(volume: f64, packing: f64) -> f64 {
    libm::pow(volume / packing, 1.0 / D as f64)
}

/// Volume of a ball of diameter 1.
pub(super) fn unit_ball<const D: usize>() -> f64 {
    ball_volume::<D>(0.5)
}

/// Collisions a particle suffers before the measurement, if the time allows.
const COLLISIONS_BEFORE: f64 = 50.0;
/// Share of a mean free time that the first slice takes.
const FIRST_SLICE: f64 = 0.01;

/// Lets a gas come to equilibrium, then measures for so many seconds how the engine works and what it keeps: `rate` is the collisions a particle suffers per
/// physical time, as expected, and says how long that is.
pub(super) fn measure<const D: usize>(
    engine: &mut EventDriven<D>,
    observer: &mut impl Observer<D>,
    seconds: f64,
    rate: f64,
) -> Result<Vec<Figure>, Trouble> {
    let clock = Clock::Thread;
    let count = engine.particle_count() as f64;
    stretch(engine, &mut (), clock, 5.0 * seconds, FIRST_SLICE / rate, COLLISIONS_BEFORE / rate)?;
    let (before, energy) = (engine.counts(), engine.kinetic_energy());
    observer.begin(engine.time(), &engine.snapshot());
    let spent = stretch(engine, observer, clock, seconds, FIRST_SLICE / rate, f64::INFINITY)?;
    observer.finish(engine.time(), &engine.snapshot());
    let after = engine.counts();
    let per_second = |what: fn(&Counts) -> u64| (what(&after) - what(&before)) as f64 / spent;
    Ok(vec![
        Figure::new("collisions_per_second", per_second(|counts| counts.collisions)),
        Figure::new("cell_crossings_per_second", per_second(|counts| counts.crossings)),
        Figure::new("list_rebuilds_per_second", per_second(|counts| counts.rebuilds)),
        Figure::new("stale_events_per_second", per_second(|counts| counts.stale)),
        Figure::new("searches_per_second", per_second(|counts| counts.predictions)),
        Figure::new("seconds_measured", spent),
        Figure::new("collisions_per_particle", 2.0 * (after.collisions - before.collisions) as f64 / count),
        Figure::new("collisions_per_particle_before", 2.0 * before.collisions as f64 / count),
        Figure::new("bytes_per_particle", engine.memory() as f64 / count),
        Figure::new("relative_energy_drift", (engine.kinetic_energy() / energy - 1.0).abs()),
    ])
}
