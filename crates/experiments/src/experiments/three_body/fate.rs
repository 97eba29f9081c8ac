//! What becomes of three stars: a pair and one that leaves.

use corpuscle_core::{Failure, Particles, Vector};
use corpuscle_observe::Check;

use super::start::{PRECISE, Start};
use super::{conservation::Run, failure};

/// A star beside the pair of the other two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fate {
    /// The star that is least bound to the others.
    pub(crate) single: usize,
    /// Energy of the pair in its own frame.
    pub(crate) pair_energy: f64,
    /// Energy of the single star and the pair's centre in their frame, all the pair's mass taken at its centre.
    pub(crate) single_energy: f64,
    /// Rate at which the distance between the single star and the pair's centre grows.
    pub(crate) recession: f64,
}

impl Fate {
    /// The fate as it looks now: the pair is the one with the lowest energy of its own.
    pub(crate) fn of(stars: &Particles<2>, constant: f64) -> Self {
        let fates = [0, 1, 2].map(|single| Self::of_single(stars, constant, single));
        fates.into_iter().fold(fates[0], |least, fate| if fate.pair_energy < least.pair_energy { fate } else { least })
    }

    fn of_single(stars: &Particles<2>, constant: f64, single: usize) -> Self {
        let (i, j) = ((single + 1) % 3, (single + 2) % 3);
        let (m, r, v) = (&stars.mass, &stars.position, &stars.velocity);
        let pair_mass = m[i] + m[j];
        let centre = |x: &[Vector<2>]| (x[i] * m[i] + x[j] * m[j]) / pair_mass;
        let energy = |m1: f64, m2: f64, r: Vector<2>, v: Vector<2>| {
            0.5 * m1 * m2 / (m1 + m2) * v.norm_squared() - constant * m1 * m2 / r.norm()
        };
        let (away, speed) = (r[single] - centre(r), v[single] - centre(v));
        Self {
            single,
            pair_energy: energy(m[i], m[j], r[j] - r[i], v[j] - v[i]),
            single_energy: energy(m[single], pair_mass, away, speed),
            recession: away.dot(speed) / away.norm(),
        }
    }

    pub(crate) fn describe(&self, names: [f64; 3]) -> String {
        let others: Vec<String> = (0..3).filter(|&k| k != self.single).map(|k| names[k].to_string()).collect();
        let leaves = self.single_energy > 0.0 && self.recession > 0.0;
        let pair = if self.pair_energy < 0.0 { "bound" } else { "free" };
        format!(
            "masses {} {pair}, {} {}",
            others.join(" and "),
            names[self.single],
            if leaves { "escaping" } else { "still bound" }
        )
    }

    /// The outcome of Burrau's problem: masses 4 and 5 bound to each other, mass 3 leaving for good.
    pub(crate) fn checks_of_burrau(stars: &Particles<2>, constant: f64, time: f64) -> Vec<Check> {
        let fate = Self::of_single(stars, constant, 0);
        let reference =
            format!("Szebehely and Peters 1967 (doi:10.1086/110355): mass 3 escapes, 4 and 5 stay a binary; at t = {time:.1}");
        vec![
            Check::at_most("Pythagorean problem: energy of the pair 4-5 in its own frame", fate.pair_energy, 0.0, &*reference),
            Check::at_least("Pythagorean problem: energy of mass 3 about the pair", fate.single_energy, 0.0, &*reference),
            Check::at_least("Pythagorean problem: speed of mass 3 away from the pair", fate.recession, 0.0, reference),
        ]
    }
}

/// Burrau's problem to its end, at the highest precision.
pub(crate) fn burrau() -> Result<Run, Failure> {
    let start = Start::pythagorean([3.0, 4.0, 5.0], 1.0, 0.0);
    let mut run = Run::new(&start, PRECISE).map_err(failure)?;
    for sample in 1..=(start.duration / start.interval).round() as u64 {
        run.advance(sample as f64 * start.interval)?;
    }
    Ok(run)
}
