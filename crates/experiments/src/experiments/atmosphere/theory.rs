//! The density of two gases of equal spheres in a field, layer by layer in hydrostatic balance.

use corpuscle_core::particles::ball_volume;
use corpuscle_observe::theory;

use crate::gas::Species;

/// Layers in which the balance is solved.
const LAYERS: usize = 2000;

/// Densities of both gases against the height of their centres above the lowest place.
pub(super) struct Profile {
    height: f64,
    /// Number density of each species in the middle of each layer.
    densities: [Vec<f64>; 2],
}

impl Profile {
    /// Solves `n_s = C_s exp(-z/h_s - mu_ex(n)/kT)` with the numbers of particles given, by iteration: each round takes the
    /// excess chemical potential from the densities before it. Thin gases converge at once, the densest allowed in some tens.
    pub(super) fn new<const D: usize>(species: [Species; 2], scales: [f64; 2], height: f64, area: f64) -> Self {
        let layer = height / LAYERS as f64;
        let ball = ball_volume::<D>(species[0].radius);
        let mut excess = vec![0.0; LAYERS];
        let mut densities = [vec![], vec![]];
        for _ in 0..200 {
            for s in 0..2 {
                let z = |k: usize| layer * (k as f64 + 0.5);
                let shape: Vec<f64> = (0..LAYERS).map(|k| libm::exp(-z(k) / scales[s] - excess[k])).collect();
                let scale = species[s].count as f64 / (area * layer * shape.iter().sum::<f64>());
                densities[s] = shape.iter().map(|x| scale * x).collect();
            }
            let mut change: f64 = 0.0;
            for (k, excess) in excess.iter_mut().enumerate() {
                let packing = ball * (densities[0][k] + densities[1][k]);
                let next = theory::excess_chemical_potential::<D>(packing.min(0.7));
                change = change.max((next - *excess).abs());
                // Half steps: the full one overshoots where the gas is dense.
                *excess += 0.5 * (next - *excess);
            }
            if change < 1e-12 {
                break;
            }
        }
        Self { height, densities }
    }

    /// Height open to the centres.
    pub(super) fn height(&self) -> f64 {
        self.height
    }

    /// Number density of a species at a height.
    pub(super) fn density(&self, species: usize, height: f64) -> f64 {
        let layer = (height / self.height * LAYERS as f64).max(0.0) as usize;
        self.densities[species][layer.min(LAYERS - 1)]
    }

    /// Mean height of a species.
    pub(super) fn mean_height(&self, species: usize) -> f64 {
        let densities = &self.densities[species];
        let layer = self.height / LAYERS as f64;
        let moment: f64 = densities.iter().enumerate().map(|(k, n)| n * layer * (k as f64 + 0.5)).sum();
        moment / densities.iter().sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solved(counts: [usize; 2], masses: [f64; 2], area: f64) -> Profile {
        let species = std::array::from_fn(|s| Species { count: counts[s], radius: 0.5, mass: masses[s], index: s as u16 });
        Profile::new::<2>(species, masses.map(|mass| 50.0 / mass), 600.0, area)
    }

    /// Points: each gas has its scale height for a mean height. (The ceiling takes off 12 `exp(-12)`.)
    #[test]
    fn thin_gases_follow_the_barometric_law() {
        let profile = solved([100, 50], [1.0, 2.0], 1e9);
        assert!((profile.mean_height(0) / 50.0 - 1.0).abs() < 1e-4);
        assert!((profile.mean_height(1) / 25.0 - 1.0).abs() < 1e-4);
    }

    /// The pressure at the floor is the weight of all above: exact for the continuum, to the layer's width here.
    #[test]
    fn the_floor_carries_the_weight() {
        let (counts, masses, area) = ([300, 100], [1.0, 3.0], 60.0);
        let profile = solved(counts, masses, area);
        let packing = |n: f64| n * ball_volume::<2>(0.5);
        let n = profile.density(0, 0.0) + profile.density(1, 0.0);
        assert!(packing(n) > 0.1, "dense enough to tell: {}", packing(n));
        let pressure = n * theory::compressibility::<2>(packing(n));
        let ceiling = profile.density(0, 600.0) + profile.density(1, 600.0);
        let weight = (0..2).map(|s| counts[s] as f64 * masses[s] / 50.0).sum::<f64>() / area + ceiling;
        assert!((pressure / weight - 1.0).abs() < 5e-3, "{pressure} {weight}");
    }
}
