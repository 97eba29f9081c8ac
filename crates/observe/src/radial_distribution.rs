//! The radial distribution function `g(r)`.

use std::ops::ControlFlow;

use corpuscle_core::particles::ball_volume;
use corpuscle_core::{Axis, Boundary, Invalid, Observer, Particles};

use crate::Estimate;
use crate::blocking::blocking;

/// `g(r)`: pairs at distance `r`, over their number were all `N (N - 1)/2` pairs independent. Periodic boxes, up to half the
/// shortest side. Standard errors from blocking over the samples.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct RadialDistribution<const D: usize> {
    boundary: Boundary<D>,
    width: f64,
    /// `[bin][sample]`: pairs over the expected number.
    values: Vec<Vec<f64>>,
}

impl<const D: usize> RadialDistribution<D> {
    /// So many bins from 0 to `radius`.
    ///
    /// # Errors
    /// Refuses boxes that are not periodic, and radii above half a side, where images would be counted wrongly.
    pub fn new(boundary: &Boundary<D>, radius: f64, bins: usize) -> Result<Self, Invalid> {
        if boundary.axes.iter().any(|&axis| axis != Axis::Periodic) {
            return Err(Invalid::new("box", "walls", "a periodic box: walls would need a correction for the missing neighbours"));
        }
        let half = 0.5 * boundary.extent().0.into_iter().fold(f64::INFINITY, f64::min);
        if !(0.0 < radius && radius <= half) || bins == 0 {
            return Err(Invalid::new("radius", radius, format!("a positive number up to half the shortest side, {half}")));
        }
        Ok(Self { boundary: boundary.clone(), width: radius / bins as f64, values: vec![vec![]; bins] })
    }

    /// Counts all pairs of one instant, by a sweep along the first axis.
    pub fn add(&mut self, particles: &Particles<D>) {
        let n = particles.len();
        let side = self.boundary.extent()[0];
        let reach = self.width * self.values.len() as f64;
        let mut order: Vec<(f64, usize)> = (0..n).map(|i| (self.boundary.wrap(particles.position[i])[0], i)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut counts = vec![0u64; self.values.len()];
        for (place, &(x, i)) in order.iter().enumerate() {
            // Everything up to `reach` further up, beyond the upper face too: each pair is met once, from below.
            let above = order[place + 1..].iter().chain(order[..place].iter()).enumerate();
            for (ahead, &(other, j)) in above {
                let gap = if place + 1 + ahead < n { other - x } else { other - x + side };
                if gap >= reach {
                    break;
                }
                // A pair exactly half a side apart is met from both: count it from the lower.
                if gap == 0.5 * side && other < x {
                    continue;
                }
                let distance = self.boundary.displacement(particles.position[i], particles.position[j]).norm();
                if let Some(count) = counts.get_mut((distance / self.width) as usize) {
                    *count += 1;
                }
            }
        }
        let pairs = 0.5 * n as f64 * (n as f64 - 1.0) / self.boundary.volume();
        for (bin, values) in self.values.iter_mut().enumerate() {
            let (inner, outer) = (self.width * bin as f64, self.width * (bin + 1) as f64);
            values.push(counts[bin] as f64 / (pairs * (ball_volume::<D>(outer) - ball_volume::<D>(inner))));
        }
    }

    /// Middle of each bin and `g` there.
    pub fn points(&self) -> Vec<(f64, Estimate)> {
        let middle = |bin: usize| self.width * (bin as f64 + 0.5);
        self.values.iter().enumerate().map(|(bin, values)| (middle(bin), blocking(values).estimate)).collect()
    }

    /// Number of instants counted.
    pub fn samples(&self) -> usize {
        self.values[0].len()
    }
}

impl<const D: usize> Observer<D> for RadialDistribution<D> {
    fn sample(&mut self, _: f64, particles: &Particles<D>) -> ControlFlow<()> {
        self.add(particles);
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::tests::assert_standard_normal;
    use corpuscle_core::{Random, Vector};

    fn scattered<const D: usize>(random: &mut Random, count: usize, extent: Vector<D>) -> Particles<D> {
        let mut particles = Particles::new();
        for _ in 0..count {
            particles.push(Vector::from_fn(|k| extent[k] * random.uniform()), Vector::ZERO, 1.0, 0.0, 0);
        }
        particles
    }

    #[test]
    fn independent_points_have_no_structure() {
        let room = Boundary::<2>::new([0.0; 2], [6.0, 9.0], Axis::Periodic);
        let mut scores = vec![];
        for seed in 0..60 {
            let mut random = Random::new(seed, 70);
            let mut distribution = RadialDistribution::new(&room, 3.0, 6).unwrap();
            (0..100).for_each(|_| distribution.add(&scattered(&mut random, 60, room.extent())));
            scores.extend(distribution.points().iter().map(|(_, g)| g.score(1.0)));
        }
        assert_standard_normal("g(r)", &scores);
    }

    #[test]
    fn the_sweep_counts_what_a_double_loop_counts() {
        let room = Boundary::<3>::periodic(4.0);
        let particles = scattered(&mut Random::new(5, 71), 80, room.extent());
        let mut distribution = RadialDistribution::new(&room, 2.0, 8).unwrap();
        distribution.add(&particles);
        let mut counts = [0u32; 8];
        for i in 0..80 {
            for j in 0..i {
                let distance = room.displacement(particles.position[i], particles.position[j]).norm();
                if distance < 2.0 {
                    counts[(distance / 0.25) as usize] += 1;
                }
            }
        }
        for (bin, &count) in counts.iter().enumerate() {
            let shell = ball_volume::<3>(0.25 * (bin as f64 + 1.0)) - ball_volume::<3>(0.25 * bin as f64);
            let expected = f64::from(count) / (0.5 * 80.0 * 79.0 / 64.0 * shell);
            assert!((distribution.values[bin][0] - expected).abs() < 1e-12 * (1.0 + expected));
        }
    }

    #[test]
    fn walls_and_long_radii_are_refused() {
        assert!(RadialDistribution::new(&Boundary::<2>::new([0.0; 2], [4.0; 2], Axis::Walls), 1.0, 4).is_err());
        assert!(RadialDistribution::new(&Boundary::<2>::periodic(4.0), 2.1, 4).is_err());
    }
}
