//! What particles meet besides each other, thrown into a box at random.

use std::f64::consts::{FRAC_PI_2, PI};

use corpuscle_core::{Axis, Boundary, Motion, Obstacle, Piston, Random, Vector};
use corpuscle_event::{Restitution, Rules};

/// Each kind of furniture in a part of the boxes, in any mix that leaves room for particles at all times.
pub(crate) fn furnish<const D: usize>(boundary: &mut Boundary<D>, rules: &mut Rules<D>, random: &mut Random) {
    let walled: Vec<usize> = (0..D).filter(|&k| boundary.axes[k] == Axis::Walls).collect();
    let mut one_in = |n: u32| random.below(n) == 0;
    let (warm, driven, viscoelastic) = (one_in(3), one_in(3), one_in(4));
    let (round, piston, removed, opened) = (one_in(2), one_in(2), one_in(2), one_in(12));
    let upper = one_in(2);
    rules.seed = random.bits();
    if viscoelastic {
        rules.restitution = Restitution::Viscoelastic { stiffness: 20.0, dissipation_time: 0.02 + 0.05 * random.uniform() };
        rules.elastic_below = 0.05;
    }
    if removed {
        for plate in &mut boundary.partitions {
            plate.removed_at = Some(2.0 * random.uniform());
        }
    }
    if let Some(&axis) = walled.last() {
        if warm {
            boundary.faces[axis][usize::from(!upper)].temperature = Some(0.5 + random.uniform());
        }
        if driven {
            boundary.faces[axis][usize::from(upper)].motion = Some(motion(boundary, axis, upper, random));
        } else if opened {
            boundary.faces[axis][usize::from(upper)].opened_at = Some(2.0 + 2.0 * random.uniform());
        }
    }
    let still = boundary.faces.iter().flatten().all(|face| face.motion.is_none());
    if round && still {
        for _ in 0..=random.below(3) {
            let centre = Vector::from_fn(|k| boundary.upper[k] * random.uniform());
            boundary.obstacles.push(Obstacle { centre, radius: 0.05 + 0.5 * random.uniform() });
        }
    } else if piston
        && boundary.partitions.is_empty()
        && let Some(&axis) = walled.first()
    {
        let side = boundary.upper[axis];
        boundary.piston = Some(Piston {
            axis,
            position: side * (0.3 + 0.4 * random.uniform()),
            velocity: random.normal(),
            mass: 30f64.powf(random.uniform()),
            force: if random.below(2) == 0 { 0.0 } else { 3.0 * random.normal() },
            // Clear of a face that moves.
            stops: [0.12 * side, 0.88 * side],
        });
    }
}

/// A motion that starts where the face is furthest in, so that particles which fit then fit always.
fn motion<const D: usize>(boundary: &Boundary<D>, axis: usize, upper: bool, random: &mut Random) -> Motion {
    let side = boundary.upper[axis];
    let (outer, inward) = if upper { (side, -1.0) } else { (0.0, 1.0) };
    let amplitude = 0.05 * side * random.uniform();
    if random.below(2) == 0 {
        let centre = outer + inward * amplitude;
        return Motion::Oscillation {
            centre,
            // Rounding must not put it outside.
            amplitude: amplitude * (1.0 - 1e-12),
            angular_frequency: 0.5 + 6.0 * random.uniform(),
            phase: if upper { PI + FRAC_PI_2 } else { FRAC_PI_2 },
        };
    }
    let place = |depth: f64| outer + inward * depth * amplitude;
    Motion::Path(vec![
        (0.1, place(2.0)),
        (0.4 + random.uniform(), place(2.0 * random.uniform())),
        (1.5 + random.uniform(), place(2.0 * random.uniform())),
        (3.0 + random.uniform(), place(0.5)),
        (5.0, place(2.0)),
        (6.0, place(0.0)),
    ])
}
