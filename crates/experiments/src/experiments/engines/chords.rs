//! Collisions that a look every now and then does not see.

/// Steps that are tried, in times in which a particle of speed `sqrt(kT/m)` flies over a diameter.
pub(super) const STEPS: [f64; 8] = [0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2, 6.4];

/// What became of the collisions of a gas, had its particles flown straight on through each other.
#[derive(Clone, Copy, Debug, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Chords {
    /// Collisions.
    pub(super) count: f64,
    /// For each step, the share of its phases at which no look falls into the overlap, summed over the collisions.
    missed: [f64; STEPS.len()],
}

impl Chords {
    /// A collision of two with this time of overlap, in the unit of the steps: of all phases of a look every `h`,
    /// `max(0, 1 - overlap/h)` miss it.
    pub(super) fn add(&mut self, overlap: f64) {
        self.count += 1.0;
        for (missed, step) in self.missed.iter_mut().zip(STEPS) {
            *missed += (1.0 - overlap / step).max(0.0);
        }
    }

    /// Share of the collisions that are missed with each step.
    pub(super) fn shares(&self) -> [f64; STEPS.len()] {
        self.missed.map(|missed| missed / self.count.max(1.0))
    }
}

/// Share of the collisions of discs at the relative speed `g` that a step `h` misses, `u = g h/(2 s)`. Impact parameters `b` are
/// uniform and the way through a disc is `2 sqrt(s^2 - b^2)`, so that with `c = sqrt(1 - u^2)` it is
/// `int_0^1 max(0, 1 - sqrt(1 - b^2)/u) db = 1 - c/2 - asin(u)/(2 u)`, beyond `u = 1` it is `1 - pi/(4 u)`.
fn missed_at(u: f64) -> f64 {
    if u < 1e-3 {
        u * u / 6.0
    } else if u < 1.0 {
        1.0 - 0.5 * (1.0 - u * u).sqrt() - 0.5 * libm::asin(u) / u
    } else {
        1.0 - 0.25 * std::f64::consts::PI / u
    }
}

/// The same of all collisions of a gas of discs in equilibrium, whose relative speeds have the density `g^2 exp(-g^2/4)` in
/// units of `sqrt(kT/m)`: Simpson's rule up to `g = 12`.
pub(super) fn missed(step: f64) -> f64 {
    const INTERVALS: usize = 1200;
    let h = 12.0 / INTERVALS as f64;
    let mut sums = [0.0; 2];
    for k in 0..=INTERVALS {
        let g = h * k as f64;
        let rule = match k {
            0 | INTERVALS => 1.0,
            odd if odd % 2 == 1 => 4.0,
            _ => 2.0,
        };
        let weight = rule * g * g * libm::exp(-0.25 * g * g);
        sums[0] += weight * missed_at(0.5 * g * step);
        sums[1] += weight;
    }
    sums[0] / sums[1]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The closed form against its integral, by midpoints.
    #[test]
    fn the_closed_form_is_the_mean_over_impact_parameters() {
        for u in [0.01f64, 0.3, 0.99, 1.01, 4.0] {
            let points = 400_000;
            let miss = |k: usize| {
                let b = (k as f64 + 0.5) / points as f64;
                (1.0 - (1.0 - b * b).sqrt() / u).max(0.0)
            };
            let mean = (0..points).map(miss).sum::<f64>() / points as f64;
            assert!((missed_at(u) - mean).abs() < 1e-6, "{u}: {} {mean}", missed_at(u));
        }
    }

    /// Short steps miss as the square: `<g^2> h^2/24` with `<g^2> = 6`.
    #[test]
    fn short_steps_miss_as_their_square() {
        assert!((missed(0.01) / (0.01f64.powi(2) / 4.0) - 1.0).abs() < 1e-3);
        assert!(missed(1e4) > 0.999 && missed(1e4) < 1.0);
    }

    #[test]
    fn phases_are_counted() {
        let mut chords = Chords::default();
        chords.add(0.1);
        chords.add(7.0);
        let shares = chords.shares();
        assert_eq!((shares[0], shares[1], shares[2]), (0.0, 0.0, 0.25));
    }
}
