//! What acts on a membrane besides its springs.

use corpuscle_core::{Boundary, Invalid, Particles, Vector};
use corpuscle_time::Force;

/// A row of points that shake the membrane with the acceleration `A sin(omega t)`, switched on within two periods; they may move.
#[derive(Clone, Debug)]
pub(super) struct Sources {
    /// Row and column at the start.
    pub(super) places: Vec<(usize, f64)>,
    /// Columns that each moves a unit of time.
    pub(super) speed: f64,
    pub(super) angular_frequency: f64,
    pub(super) amplitude: f64,
    pub(super) columns: usize,
}

impl Force<1> for Sources {
    fn name(&self) -> &'static str {
        "shakers"
    }

    fn accelerate(&mut self, time: f64, _: &Boundary<1>, _: &Particles<1>, acceleration: &mut [Vector<1>]) {
        let phase = self.angular_frequency * time;
        let part = (phase / (2.0 * std::f64::consts::TAU)).min(1.0);
        let now = self.amplitude * part * part * (3.0 - 2.0 * part) * libm::sin(phase);
        for &(row, start) in &self.places {
            // Between two masses it shakes both, the nearer one more.
            let place = start + self.speed * time;
            let (column, share) = (place.floor(), place - place.floor());
            for (column, share) in [(column, 1.0 - share), (column + 1.0, share)] {
                if share > 0.0 && (0.0..self.columns as f64).contains(&column) {
                    acceleration[row * self.columns + column as usize] += Vector([now * share]);
                }
            }
        }
    }

    fn energy(&self, _: f64, _: &Boundary<1>, _: &Particles<1>) -> f64 {
        0.0
    }

    fn virial(&self, _: f64, _: &Boundary<1>, _: &Particles<1>) -> f64 {
        0.0
    }

    fn validate(&self, _: &Boundary<1>, _: &Particles<1>) -> Result<(), Invalid> {
        Ok(())
    }

    fn longest_step(&self) -> f64 {
        1.0 / self.angular_frequency
    }
}
