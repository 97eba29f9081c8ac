//! The hard limit: steep repulsion approaches the event-driven engine, which has no step to be too long.

use crate::common::{barker_henderson, extrapolate, hard_compressibility, missed, missed_by_events, soft_compressibility};

/// `Z` of the fluid with `U = k T (s/r)^n` for growing `n`, extrapolated to `1/n = 0` by a parabola, against the event-driven engine
/// at the same number of particles; and each against hard spheres of Barker and Henderson's diameter.
#[test]
fn steep_spheres_approach_the_event_driven_engine() {
    let packing = 0.3;
    let hard = hard_compressibility(packing, 3000.0, 1);
    let mut points = vec![];
    for exponent in [24, 32, 48, 72, 128, 255u8] {
        let soft = soft_compressibility(exponent, packing, 100.0, 2);
        let n = f64::from(exponent);
        println!(
            "n = {exponent}: Z = {:.4} +- {:.4}, Barker and Henderson {:.4}",
            soft.mean,
            soft.standard_error,
            barker_henderson(n, packing)
        );
        points.push((1.0 / n, soft.mean, soft.standard_error));
    }
    let limit = extrapolate(&points);
    let z = (limit.mean - hard.mean) / limit.standard_error.hypot(hard.standard_error);
    println!(
        "limit {:.4} +- {:.4}, hard spheres {:.4} +- {:.4}, z = {z:.2}",
        limit.mean, limit.standard_error, hard.mean, hard.standard_error
    );
    assert!(z.abs() < 4.0, "z = {z}");
    assert!(limit.standard_error < 0.02 * hard.mean, "too uncertain: {}", limit.standard_error);
    // The softest is far from the limit: what is extrapolated is there to be seen.
    assert!((points[0].1 - hard.mean).abs() > 10.0 * points[0].2, "{points:?}");
}

/// With too long a step particles pass through each other, or come out with an energy they never had; never in the event-driven engine.
#[test]
fn long_steps_miss_collisions_and_events_do_not() {
    let pairs = 2000;
    let counts: Vec<[u32; 2]> = [0.001, 0.03, 0.3, 1.0].iter().map(|&dt| missed(48, dt, pairs, 3)).collect();
    println!("passed, wrong of {pairs}: {counts:?}");
    assert_eq!(counts[0], [0, 0]);
    assert!(counts[1][1] > pairs / 20, "energies at dt = 0.03: {counts:?}");
    assert!(counts[3][0] > pairs / 10, "{counts:?}");
    assert!(counts.windows(2).all(|pair| pair[0][0] <= pair[1][0]), "{counts:?}");
    assert_eq!(missed_by_events(pairs, 3), [0, 0]);
}
