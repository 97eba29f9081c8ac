//! Charges in a periodic box.

mod plan;
mod waves;

use std::f64::consts::PI;

use corpuscle_core::{Axis, Boundary, Invalid, Particles, Vector};

use super::coulomb;
use super::screened_charge::ScreenedCharge;
use super::{Force, PairForce, Tensor, positive};
use corpuscle_core::instructions::Instructions;
use plan::{Plan, Splitting};
use waves::Waves;

/// Different charges a system may have: each pair of kinds has an entry in a table.
const KINDS: usize = 256;

/// Coulomb's force between charges and all their periodic images, by Ewald's sum (1921, doi:10.1002/andp.19213690304):
///
/// ```text
/// U = k [ sum over pairs of q_i q_j erfc(alpha r)/r                                   near charges, each in a cloud
///       + (2 pi/V) sum over K != 0 of exp(-K^2/4 alpha^2)/K^2 |sum_i q_i exp(i K.r_i)|^2      the clouds, as waves
///       - alpha/sqrt(pi) sum q_i^2 - pi/(2 V alpha^2) (sum q_i)^2 ]               a cloud with itself; a background
/// ```
///
/// The images fill a sphere within a conductor, which takes off what its surface does (de Leeuw, Perram and Smith 1980,
/// doi:10.1098/rspa.1980.0135). A box that is not neutral gets an even background of the opposite charge.
///
/// Near charges go through the same lists, lanes and exact sums as every pair potential. Waves cost `O(N^(3/2))` at best; `alpha`
/// and both ranges follow from the accuracy that is wanted, the box and the number of particles. Bits do not depend on the number
/// of threads nor on the machine.
pub struct Ewald {
    constant: f64,
    charges: Vec<f64>,
    splitting: Splitting,
    instructions: Instructions,
    near: Option<Near>,
    waves: Waves,
}

/// What serves one box.
struct Near {
    plan: Plan,
    force: PairForce<ScreenedCharge, 3>,
    /// The particles, with kinds of charges in place of their species.
    ions: Particles<3>,
}

impl Ewald {
    /// The force between particles of these charges, with Coulomb's constant `k` (1 in Gaussian units). `accuracy` is the root
    /// mean square error of a force wanted, as a share of the force `k <q^2> n^(2/3)` of two such charges at the mean distance:
    /// 1e-12 to 0.1. It is met for charges without order, and more than met in a crystal.
    pub fn new(constant: f64, charges: Vec<f64>, accuracy: f64) -> Self {
        Self::with_splitting(constant, charges, Splitting::Accuracy(accuracy))
    }

    /// The same with a splitting `alpha` (an inverse length), a cutoff of the near part and a largest wave number `|K|` given.
    pub fn with_parameters(constant: f64, charges: Vec<f64>, alpha: f64, cutoff: f64, largest_wave_number: f64) -> Self {
        Self::with_splitting(constant, charges, Splitting::Given(Plan { alpha, cutoff, largest_wave_number, sides: [0.0; 3] }))
    }

    fn with_splitting(constant: f64, charges: Vec<f64>, splitting: Splitting) -> Self {
        let instructions = Instructions::detect();
        Self { constant, charges, splitting, instructions, near: None, waves: Waves::default() }
    }

    /// The charges.
    pub fn charges(&self) -> &[f64] {
        &self.charges
    }

    /// `alpha`, cutoff and largest wave number in this box.
    pub fn parameters(&self, boundary: &Boundary<3>) -> [f64; 3] {
        let plan = self.plan(boundary);
        [plan.alpha, plan.cutoff, plan.largest_wave_number]
    }

    fn plan(&self, boundary: &Boundary<3>) -> Plan {
        self.splitting.plan(boundary.extent().0, self.charges.len())
    }

    /// The different charges, and which of them each particle has.
    fn kinds(&self) -> (Vec<f64>, Vec<u16>) {
        let mut kinds = self.charges.clone();
        kinds.sort_unstable_by(f64::total_cmp);
        kinds.dedup();
        let kind = |charge: &f64| kinds.partition_point(|known| known.total_cmp(charge).is_lt()) as u16;
        let species = self.charges.iter().map(kind).collect();
        (kinds, species)
    }

    fn near(&self, boundary: &Boundary<3>, particles: &Particles<3>) -> Near {
        let plan = self.plan(boundary);
        let (kinds, species) = self.kinds();
        let between = |a: u16, b: u16| ScreenedCharge {
            strength: self.constant * kinds[usize::from(a)] * kinds[usize::from(b)],
            screening: plan.alpha,
            cutoff: plan.cutoff,
        };
        let force = PairForce::between_species(kinds.len() as u16, between).unshifted();
        Near { plan, force, ions: Particles { species, ..particles.clone() } }
    }

    /// `sum q` and `sum q^2`.
    fn moments(&self) -> (f64, f64) {
        self.charges.iter().fold((0.0, 0.0), |(sum, squares), q| (sum + q, squares + q * q))
    }

    /// Energy of the even background with the charges and itself.
    fn background(&self, plan: &Plan) -> f64 {
        let (sum, _) = self.moments();
        -self.constant * PI * sum * sum / (2.0 * plan.volume() * plan.alpha * plan.alpha)
    }
}

impl Force<3> for Ewald {
    fn name(&self) -> &'static str {
        "Coulomb"
    }

    fn accelerate(&mut self, time: f64, boundary: &Boundary<3>, particles: &Particles<3>, acceleration: &mut [Vector<3>]) {
        let mut near = match self.near.take() {
            Some(near) if near.plan.fits(boundary) && near.ions.mass == particles.mass => near,
            _ => self.near(boundary, particles),
        };
        near.ions.position.clone_from(&particles.position);
        near.force.accelerate(time, boundary, &near.ions, acceleration);
        self.waves.load(&near.plan, self.constant, boundary, &self.charges, &particles.position);
        self.waves.sum(self.instructions);
        self.waves.push(self.instructions, &particles.mass, acceleration);
        self.near = Some(near);
    }

    fn energy(&self, time: f64, boundary: &Boundary<3>, particles: &Particles<3>) -> f64 {
        let near = self.near(boundary, particles);
        let mut waves = Waves::default();
        waves.load(&near.plan, self.constant, boundary, &self.charges, &particles.position);
        waves.sum(self.instructions);
        let itself = self.constant * near.plan.alpha / PI.sqrt() * self.moments().1;
        near.force.energy(time, boundary, &near.ions) + waves.energy() - itself + self.background(&near.plan)
    }

    /// Of each wave `(1 - K^2/2 alpha^2)` times its energy, since stretching the box changes `V`, `K` and no phase; of the
    /// background three times its energy.
    fn virial(&self, time: f64, boundary: &Boundary<3>, particles: &Particles<3>) -> f64 {
        let near = self.near(boundary, particles);
        let mut waves = Waves::default();
        waves.load(&near.plan, self.constant, boundary, &self.charges, &particles.position);
        waves.sum(self.instructions);
        near.force.virial(time, boundary, &near.ions) + waves.virial(near.plan.alpha) + 3.0 * self.background(&near.plan)
    }

    /// Of each wave `delta_ab - 2 K_a K_b (1/K^2 + 1/4 alpha^2)` times its energy (Nose and Klein 1983,
    /// doi:10.1080/00268978300102851).
    fn virial_tensor(&self, time: f64, boundary: &Boundary<3>, particles: &Particles<3>) -> Option<Tensor<3>> {
        let near = self.near(boundary, particles);
        let mut waves = Waves::default();
        waves.load(&near.plan, self.constant, boundary, &self.charges, &particles.position);
        waves.sum(self.instructions);
        let mut tensor = near.force.virial_tensor(time, boundary, &near.ions)?;
        waves.add_virial_tensor(near.plan.alpha, &mut tensor);
        for k in 0..3 {
            tensor[k][k] += self.background(&near.plan);
        }
        Some(tensor)
    }

    fn validate(&self, boundary: &Boundary<3>, particles: &Particles<3>) -> Result<(), Invalid> {
        if let Some(k) = boundary.axes.iter().position(|&axis| axis != Axis::Periodic) {
            let expected = "periodic: Ewald sums over images along every axis; in open space use Coulomb";
            return Err(Invalid::new(format!("axis {k} of the box"), format!("{:?}", boundary.axes[k]), expected));
        }
        coulomb::validate(self.constant, &self.charges, particles)?;
        match self.splitting {
            Splitting::Accuracy(accuracy) if !(1e-12..=0.1).contains(&accuracy) => {
                return Err(Invalid::new("accuracy", accuracy, "1e-12 to 0.1"));
            }
            Splitting::Accuracy(_) => {}
            Splitting::Given(plan) => {
                positive("alpha", plan.alpha)?;
                positive("largest wave number", plan.largest_wave_number)?;
            }
        }
        let kinds = self.kinds().0.len();
        if kinds > KINDS {
            return Err(Invalid::new("charges", format!("{kinds} different ones"), format!("at most {KINDS} different ones")));
        }
        let near = self.near(boundary, particles);
        near.force.validate(boundary, &near.ions)
    }
}

#[cfg(test)]
mod tests;
