//! Charges in open space.

use corpuscle_core::{Axis, Boundary, Invalid, Particles, Vector};
use rayon::prelude::*;

use super::{Force, Tensor, add_product, finite, massive};
use corpuscle_core::instructions::{Instructions, Kernel};

/// Charges that are acted on together.
const LANES: usize = 8;
/// Charges from which more than one thread is worth the waiting.
const WORTH_THREADS: usize = 512;

/// `U = sum over pairs of k q_i q_j / r`, every pair summed directly, for open space or between walls; [`Ewald`](super::Ewald) sums
/// over periodic images. In the plane these are charges of space that move in a plane.
///
/// Each particle's sum runs in the order of the indices, so that bits do not depend on threads or machine; the forces of a pair
/// cancel to rounding.
#[derive(Clone, Debug)]
pub struct Coulomb<const D: usize> {
    constant: f64,
    charges: Vec<f64>,
    instructions: Instructions,
    /// Places of all charges, and what rounding took from them, one array a component.
    places: [Vec<f64>; D],
    remainders: [Vec<f64>; D],
}

impl<const D: usize> Coulomb<D> {
    /// The force between particles of these charges, with Coulomb's constant `k` (1 in Gaussian units).
    pub fn new(constant: f64, charges: Vec<f64>) -> Self {
        let empty = || std::array::from_fn(|_| vec![]);
        Self { constant, charges, instructions: Instructions::detect(), places: empty(), remainders: empty() }
    }

    /// The charges.
    pub fn charges(&self) -> &[f64] {
        &self.charges
    }
}

/// What all kinds of charges ask for.
pub(super) fn validate<const D: usize>(constant: f64, charges: &[f64], particles: &Particles<D>) -> Result<(), Invalid> {
    finite("Coulomb's constant", constant)?;
    if charges.len() != particles.len() {
        return Err(Invalid::new("charges", charges.len(), format!("{}, one for each particle", particles.len())));
    }
    for (i, &charge) in charges.iter().enumerate() {
        finite(&format!("charge of particle {i}"), charge)?;
        massive("Coulomb", i, particles)?;
    }
    Ok(())
}

impl<const D: usize> Force<D> for Coulomb<D> {
    fn name(&self) -> &'static str {
        "Coulomb"
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
        for k in 0..D {
            self.places[k].clear();
            self.places[k].extend(particles.position.iter().map(|r| r[k]));
            self.remainders[k].clear();
            self.remainders[k].extend(remainder.iter().map(|r| r[k]));
        }
        let group = |(number, acceleration): (usize, &mut [Vector<D>])| {
            let first = number * LANES;
            let (places, remainders) = (self.places.each_ref().map(|x| &x[..]), self.remainders.each_ref().map(|x| &x[..]));
            let charges = &self.charges;
            let field = if remainder.is_empty() {
                self.instructions.run(Field::<D, false> { first, charges, places, remainders })
            } else {
                self.instructions.run(Field::<D, true> { first, charges, places, remainders })
            };
            for (lane, a) in acceleration.iter_mut().enumerate() {
                let i = first + lane;
                *a += Vector::from_fn(|k| field[k][lane]) * (self.constant * self.charges[i] / particles.mass[i]);
            }
        };
        if particles.len() < WORTH_THREADS {
            acceleration.chunks_mut(LANES).enumerate().for_each(group);
        } else {
            acceleration.par_chunks_mut(LANES).enumerate().for_each(group);
        }
    }

    fn energy(&self, _: f64, _: &Boundary<D>, particles: &Particles<D>) -> f64 {
        let (r, q) = (&particles.position, &self.charges);
        let of_one = |i: usize| (0..i).map(|j| q[j] / (r[i] - r[j]).norm()).sum::<f64>() * q[i];
        self.constant * (0..r.len()).map(of_one).sum::<f64>()
    }

    /// Of a potential of degree -1 it is the energy (Euler's theorem).
    fn virial(&self, time: f64, boundary: &Boundary<D>, particles: &Particles<D>) -> f64 {
        self.energy(time, boundary, particles)
    }

    fn virial_tensor(&self, _: f64, _: &Boundary<D>, particles: &Particles<D>) -> Option<Tensor<D>> {
        let mut tensor = [[0.0; D]; D];
        let (r, q) = (&particles.position, &self.charges);
        for i in 0..r.len() {
            for j in 0..i {
                let arrow = r[i] - r[j];
                let push = self.constant * q[i] * q[j] / (arrow.norm_squared() * arrow.norm());
                add_product(&mut tensor, arrow, arrow * push);
            }
        }
        Some(tensor)
    }

    fn validate(&self, boundary: &Boundary<D>, particles: &Particles<D>) -> Result<(), Invalid> {
        if let Some(k) = boundary.axes.iter().position(|&axis| axis == Axis::Periodic) {
            let expected = "open space or walls; Ewald sums over periodic images";
            return Err(Invalid::new(format!("axis {k} of the box"), "periodic", expected));
        }
        validate(self.constant, &self.charges, particles)
    }
}

/// The field `sum_j q_j (r_i - r_j)/|r_i - r_j|^3` at a group of charges.
struct Field<'a, const D: usize, const PRECISE: bool> {
    first: usize,
    charges: &'a [f64],
    places: [&'a [f64]; D],
    remainders: [&'a [f64]; D],
}

impl<const D: usize, const PRECISE: bool> Kernel for Field<'_, D, PRECISE> {
    type Output = [[f64; LANES]; D];

    #[inline(always)]
    fn run(self) -> [[f64; LANES]; D] {
        let count = self.charges.len();
        let (mut here, mut lost, mut field) = ([[0.0; LANES]; D], [[0.0; LANES]; D], [[0.0; LANES]; D]);
        for k in 0..D {
            for lane in 0..LANES {
                // Lanes beyond the last charge repeat it, and nobody reads them.
                let i = (self.first + lane).min(count - 1);
                here[k][lane] = self.places[k][i];
                if PRECISE {
                    lost[k][lane] = self.remainders[k][i];
                }
            }
        }
        for j in 0..count {
            let charge = self.charges[j];
            let mut arrow = [[0.0; LANES]; D];
            let mut square = [0.0; LANES];
            for k in 0..D {
                let (place, remainder) = (self.places[k][j], if PRECISE { self.remainders[k][j] } else { 0.0 });
                for lane in 0..LANES {
                    let mut x = here[k][lane] - place;
                    if PRECISE {
                        x += lost[k][lane] - remainder;
                    }
                    arrow[k][lane] = x;
                    square[lane] += x * x;
                }
            }
            for lane in 0..LANES {
                let weight = charge / (square[lane] * square[lane].sqrt());
                let weight = if self.first + lane == j { 0.0 } else { weight };
                for k in 0..D {
                    field[k][lane] += weight * arrow[k][lane];
                }
            }
        }
        field
    }
}
