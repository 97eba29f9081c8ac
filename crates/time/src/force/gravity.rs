//! Newton's gravity between all masses, and of the masses on grains.

use corpuscle_core::{Axis, Boundary, Instructions, Invalid, Particles, Vector};

mod direct;
mod few;
mod grains;
mod lanes;
mod scale;
mod strides;
mod tree;

use super::{Force, Tensor, add_product, finite, not_negative};
use crate::strider::Strider;
use direct::Masses;
use grains::attract_grains;
use scale::Scale;
pub use tree::TreeGravity;

/// Up to so many particles the plain double loop is the fastest.
const FEW: usize = 12;

/// `a_i = sum_j G m_j (r_j - r_i) / (|r_j - r_i|^2 + s^2)^(3/2)`, with the softening length `s` of Plummer (zero: none).
///
/// A particle of mass zero is a grain: it feels the masses and attracts nothing, so that `N` grains and `M` masses cost
/// `O(M (M + N))`. Sums are direct, in the order of the indices; `m_i a_i` of a pair cancel to rounding.
#[derive(Clone, Debug)]
pub struct Gravity<const D: usize> {
    constant: f64,
    softening: f64,
    masses: Masses<D>,
    instructions: Instructions,
}

impl<const D: usize> Gravity<D> {
    /// Gravity of the given constant `G` and softening length.
    pub fn new(constant: f64, softening: f64) -> Self {
        Self { constant, softening, masses: Masses::default(), instructions: Instructions::detect() }
    }

    /// The constant `G`.
    pub fn constant(&self) -> f64 {
        self.constant
    }

    /// The softening length.
    pub fn softening(&self) -> f64 {
        self.softening
    }

    /// Adds the accelerations of those with mass; tells in which units of length.
    fn attract_masses(&mut self, particles: &Particles<D>, remainder: &[Vector<D>], acceleration: &mut [Vector<D>]) -> Scale {
        let scale = Scale::new(self.softening, &particles.position, self.instructions);
        let softening_squared = self.softening_squared(scale);
        self.masses.load(self.constant, scale, particles, remainder);
        self.masses.attract_each_other(softening_squared, !remainder.is_empty(), self.instructions);
        self.masses.add_to(scale, acceleration);
        scale
    }

    fn softening_squared(&self, scale: Scale) -> f64 {
        (self.softening * scale.length) * (self.softening * scale.length)
    }

    fn sum_over_pairs(&self, particles: &Particles<D>, f: impl Fn(f64, f64) -> f64) -> f64 {
        let massive: Vec<usize> = (0..particles.len()).filter(|&i| particles.mass[i] > 0.0).collect();
        let mut sum = 0.0;
        for (place, &i) in massive.iter().enumerate() {
            for &j in &massive[place + 1..] {
                let r_squared = (particles.position[j] - particles.position[i]).norm_squared();
                sum += f(self.constant * particles.mass[i] * particles.mass[j], r_squared);
            }
        }
        sum
    }
}

/// `1/(r^2 + s^2)^(3/2)`.
#[inline]
fn inverse_cube(r_squared: f64, softening_squared: f64) -> f64 {
    let d2 = r_squared + softening_squared;
    1.0 / (d2 * d2.sqrt())
}

impl<const D: usize> Force<D> for Gravity<D> {
    fn name(&self) -> &'static str {
        "gravity"
    }

    fn accelerate(&mut self, time: f64, boundary: &Boundary<D>, particles: &Particles<D>, acceleration: &mut [Vector<D>]) {
        self.accelerate_precisely(time, boundary, particles, &[], acceleration);
    }

    fn accelerate_precisely(
        &mut self,
        _: f64,
        _: &Boundary<D>,
        particles: &Particles<D>,
        remainder: &[Vector<D>],
        acceleration: &mut [Vector<D>],
    ) {
        if particles.len() <= FEW {
            few::attract(self.constant, self.softening, particles, remainder, acceleration);
            return;
        }
        let scale = self.attract_masses(particles, remainder, acceleration);
        let (softening_squared, masses) = (self.softening_squared(scale), &self.masses.index);
        if masses.len() < particles.len() {
            attract_grains(self.constant, scale, softening_squared, masses, particles, acceleration, self.instructions);
        }
    }

    fn energy(&self, _: f64, _: &Boundary<D>, particles: &Particles<D>) -> f64 {
        let softening_squared = self.softening * self.softening;
        self.sum_over_pairs(particles, |strength, r_squared| -strength / (r_squared + softening_squared).sqrt())
    }

    fn virial(&self, _: f64, _: &Boundary<D>, particles: &Particles<D>) -> f64 {
        let softening_squared = self.softening * self.softening;
        self.sum_over_pairs(particles, |strength, r_squared| -strength * r_squared * inverse_cube(r_squared, softening_squared))
    }

    fn virial_tensor(&self, _: f64, _: &Boundary<D>, particles: &Particles<D>) -> Option<Tensor<D>> {
        let mut tensor = [[0.0; D]; D];
        let (r, m) = (&particles.position, &particles.mass);
        for i in (0..r.len()).filter(|&i| m[i] > 0.0) {
            for j in (0..i).filter(|&j| m[j] > 0.0) {
                let arrow = r[i] - r[j];
                let pull = self.constant * m[i] * m[j] * inverse_cube(arrow.norm_squared(), self.softening * self.softening);
                add_product(&mut tensor, arrow, arrow * -pull);
            }
        }
        Some(tensor)
    }

    fn validate(&self, boundary: &Boundary<D>, particles: &Particles<D>) -> Result<(), Invalid> {
        validate(self.constant, self.softening, boundary, particles)
    }

    fn strider(&mut self) -> Option<&mut dyn Strider<D>> {
        Some(self)
    }

    fn point_gravity(&self) -> Option<f64> {
        (self.softening == 0.0).then_some(self.constant)
    }
}

/// What direct sums and trees ask for.
fn validate<const D: usize>(
    constant: f64,
    softening: f64,
    boundary: &Boundary<D>,
    particles: &Particles<D>,
) -> Result<(), Invalid> {
    finite("gravitational constant", constant)?;
    not_negative("softening", softening)?;
    if let Some(k) = boundary.axes.iter().position(|&axis| axis == Axis::Periodic) {
        let expected = "open space or walls: gravity reaches through every periodic image";
        return Err(Invalid::new(format!("axis {k} of the box"), "periodic", expected));
    }
    if particles.mass.iter().all(|&mass| mass == 0.0) {
        return Err(Invalid::new("masses", "all zero", "at least one particle with mass, to attract the others"));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
