//! How much is summed near by and how much as waves.

use std::f64::consts::PI;

use corpuscle_core::Boundary;

/// Time of a pair within the cutoff against that of a wave for one particle (about 11 and 2 nanoseconds).
const COST_OF_A_PAIR: f64 = 5.5;
/// Cutoffs that are tried.
const TRIALS: u32 = 64;

/// What the splitting has to do.
#[derive(Clone, Copy, Debug)]
pub(super) enum Splitting {
    /// Root mean square error of a force.
    Accuracy(f64),
    /// Parameters from the caller.
    Given(Plan),
}

/// Parameters of the sum in one box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plan {
    pub(super) alpha: f64,
    pub(super) cutoff: f64,
    pub(super) largest_wave_number: f64,
    pub(super) sides: [f64; 3],
}

impl Splitting {
    /// The plan for `count` charges in a box of these sides; it depends on nothing else.
    pub(super) fn plan(self, sides: [f64; 3], count: usize) -> Plan {
        match self {
            Self::Given(plan) => Plan { sides, ..plan },
            Self::Accuracy(accuracy) => Plan::cheapest(accuracy, sides, count as f64),
        }
    }
}

impl Plan {
    pub(super) fn fits(&self, boundary: &Boundary<3>) -> bool {
        self.sides == boundary.extent().0
    }

    pub(super) fn volume(&self) -> f64 {
        self.sides.iter().product()
    }

    /// The least work that is accurate enough, over cutoffs up to half the box.
    ///
    /// Charges without order leave root mean square errors (Kolafa and Perram 1992, doi:10.1080/08927029208049126)
    /// `2 E exp(-alpha^2 r_c^2)/sqrt(r_c V)` from pairs beyond the cutoff and `2 E alpha sqrt(2/(K V)) exp(-K^2/4 alpha^2)` from
    /// waves beyond `K`, with `E = k |q_i| sqrt(sum q^2)`. Either may be `1/sqrt 2` of what is wanted.
    fn cheapest(accuracy: f64, sides: [f64; 3], n: f64) -> Self {
        let volume: f64 = sides.iter().product();
        let half = 0.5 * sides.iter().fold(f64::INFINITY, |least, &side| least.min(side));
        // What each part may leave, in units of E: the wanted error is a share of k <q^2> n^(2/3).
        let allowed = accuracy * libm::pow(n / volume, 2.0 / 3.0) / (2.0 * n).sqrt();
        // Errors above what is allowed without any damping would need none; one keeps alpha positive.
        let exponent = |error: f64| libm::sqrt(libm::log(error / allowed).max(1.0));
        let with_cutoff = |cutoff: f64| {
            let alpha = exponent(2.0 / (cutoff * volume).sqrt()) / cutoff;
            // K stands on both sides, on one of them within a logarithm: the iteration converges at once.
            let wave_number = (0..8).fold(2.0 * alpha, |k, _| 2.0 * alpha * exponent(2.0 * alpha * (2.0 / (k * volume)).sqrt()));
            Self { alpha, cutoff, largest_wave_number: wave_number, sides }
        };
        let shortest = half.min(0.5 * libm::cbrt(volume / n));
        let trial = |number: u32| with_cutoff(shortest * libm::pow(half / shortest, f64::from(number) / f64::from(TRIALS)));
        let mut best = with_cutoff(half);
        for plan in (0..TRIALS).map(trial) {
            if plan.cost(n) < best.cost(n) {
                best = plan;
            }
        }
        best
    }

    /// Pairs and waves for one particle, in waves.
    fn cost(&self, n: f64) -> f64 {
        let pairs = 2.0 / 3.0 * PI * self.cutoff.powi(3) * n / self.volume();
        let waves = self.volume() * self.largest_wave_number.powi(3) / (12.0 * PI * PI);
        COST_OF_A_PAIR * pairs + waves
    }
}
