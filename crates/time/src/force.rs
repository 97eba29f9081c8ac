//! Forces, one file each.

mod bond;
mod born_mayer;
mod central;
mod complementary_error;
mod coulomb;
mod drag;
mod drive;
mod ewald;
mod exponential;
mod fene;
mod force_shifted;
mod gravity;
mod harmonic_repulsion;
mod inverse_power;
mod lennard_jones;
mod morse;
mod pair;
mod screened_charge;
mod spring;
mod toda;
mod uniform;
mod wca;
mod yukawa;

pub use bond::{BondLaw, Bonds};
pub use born_mayer::BornMayer;
pub use central::CentralField;
pub use coulomb::Coulomb;
pub use drag::Drag;
pub use drive::DrivingForce;
pub use ewald::Ewald;
pub use fene::FiniteExtension;
pub use force_shifted::ForceShifted;
pub use gravity::{Gravity, TreeGravity};
pub use harmonic_repulsion::HarmonicRepulsion;
pub use inverse_power::InversePower;
pub use lennard_jones::LennardJones;
pub use morse::Morse;
pub use pair::{PairForce, PairPotential};
pub use spring::{Spring, Springs};
pub use toda::Toda;
pub use uniform::UniformField;
pub use wca::WeeksChandlerAndersen;
pub use yukawa::Yukawa;

use corpuscle_core::{Boundary, Invalid, Particles, Vector};

use crate::strider::Strider;

/// A square of numbers, row by row.
pub type Tensor<const D: usize> = [[f64; D]; D];

/// Adds the products of the components of two vectors.
pub(crate) fn add_product<const D: usize>(tensor: &mut Tensor<D>, a: Vector<D>, b: Vector<D>) {
    for k in 0..D {
        for l in 0..D {
            tensor[k][l] += a[k] * b[l];
        }
    }
}

/// Something that accelerates particles.
///
/// Accelerations are accumulated rather than forces, so that massless grains can feel a field. A force must be a pure
/// function of time, positions and velocities: what it remembers between calls may only save work.
pub trait Force<const D: usize>: Send {
    /// Name, as a table of energies shows it.
    fn name(&self) -> &'static str;

    /// Adds the acceleration of every particle.
    fn accelerate(&mut self, time: f64, boundary: &Boundary<D>, particles: &Particles<D>, acceleration: &mut [Vector<D>]);

    /// The same with positions to twice the precision, `r + remainder`. Worth using where the difference of two nearby
    /// positions decides: bodies in a close encounter far from the origin.
    fn accelerate_precisely(
        &mut self,
        time: f64,
        boundary: &Boundary<D>,
        particles: &Particles<D>,
        remainder: &[Vector<D>],
        acceleration: &mut [Vector<D>],
    ) {
        let _ = remainder;
        self.accelerate(time, boundary, particles, acceleration);
    }

    /// Potential energy; zero for a force that has none.
    fn energy(&self, time: f64, boundary: &Boundary<D>, particles: &Particles<D>) -> f64;

    /// Virial `sum over pairs of r_ij . F_ij`; zero for a force from outside.
    fn virial(&self, time: f64, boundary: &Boundary<D>, particles: &Particles<D>) -> f64;

    /// Virial tensor `sum over pairs of r_ij F_ij`, components of the arrow by rows: its trace is the virial. `None` where it is
    /// not known.
    fn virial_tensor(&self, time: f64, boundary: &Boundary<D>, particles: &Particles<D>) -> Option<Tensor<D>> {
        let _ = (time, boundary, particles);
        None
    }

    /// Checks that the force makes sense for this box and these particles.
    ///
    /// # Errors
    /// Names the parameter or particle at fault.
    fn validate(&self, boundary: &Boundary<D>, particles: &Particles<D>) -> Result<(), Invalid>;

    /// Whether the acceleration depends on velocities.
    fn depends_on_velocity(&self) -> bool {
        false
    }

    /// The constant `G` of a force that is Newton's between points, and nothing else; only then are two bodies on Kepler orbits.
    fn point_gravity(&self) -> Option<f64> {
        None
    }

    /// What moves particles while it finds their accelerations, where the force can do that; asked of a force that is the only one.
    #[doc(hidden)]
    fn strider(&mut self) -> Option<&mut dyn Strider<D>> {
        None
    }

    /// What was wrong when accelerations were asked for last, said of a particle that has been lost by it: a bond that broke.
    fn complaint(&self) -> Option<String> {
        None
    }

    /// The longest step of an adaptive integrator that cannot miss what the force does by itself as time passes.
    fn longest_step(&self) -> f64 {
        f64::INFINITY
    }
}

/// A parameter that must be a finite number.
fn finite(key: &str, value: f64) -> Result<(), Invalid> {
    if value.is_finite() { Ok(()) } else { Err(Invalid::new(key, value, "a finite number")) }
}

/// A parameter that must be positive.
pub(crate) fn positive(key: &str, value: f64) -> Result<(), Invalid> {
    if value.is_finite() && value > 0.0 { Ok(()) } else { Err(Invalid::new(key, value, "a positive number")) }
}

/// A parameter that must not be negative.
pub(crate) fn not_negative(key: &str, value: f64) -> Result<(), Invalid> {
    if value.is_finite() && value >= 0.0 { Ok(()) } else { Err(Invalid::new(key, value, "a number, zero or more")) }
}

/// A particle on which a force, not a field, acts: it must exist and have mass.
fn massive<const D: usize>(force: &str, particle: usize, particles: &Particles<D>) -> Result<(), Invalid> {
    match particles.mass.get(particle) {
        None => Err(Invalid::new(format!("{force} at particle"), particle, format!("an index below {}", particles.len()))),
        Some(mass) if *mass > 0.0 => Ok(()),
        Some(mass) => {
            Err(Invalid::new(format!("mass of particle {particle}"), mass, format!("a positive mass: {force} acts on it")))
        }
    }
}

#[cfg(test)]
mod tests;
