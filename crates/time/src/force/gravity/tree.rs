//! Gravity of many bodies in `O(N log N)`: far cells of a tree pull by their moments.

mod build;
mod pull;

use corpuscle_core::{Boundary, Instructions, Invalid, Particles, Vector};
use rayon::prelude::*;

use super::scale::Scale;
use super::validate;
use crate::force::Force;
use build::Tree;
use pull::{Bodies, Cells, Lists, OfBodies, OfCells, Pull};

/// Targets that share a walk through the tree.
const GROUP: usize = 16;
/// Groups from which more than one thread is worth the waiting.
const WORTH_THREADS: usize = 16;

/// Newton's gravity by a tree of cells (Barnes and Hut 1986, doi:10.1038/324446a0), expanded to the quadrupole.
///
/// A cell of side `w`, whose centre of mass is at the distance `d` or more from all of a group of 16 neighbouring targets,
/// pulls them by its mass and its second moments if `w < theta d`; a nearer one is opened, and the bodies of the smallest
/// cells pull one by one, as in [`Gravity`](super::Gravity), of which this is the approximation. At `theta = 0.5`
/// half of the accelerations in a cluster are right to `2e-4` and 99 in 100 to `1e-3`; at zero every pair counts. Momentum is conserved to the same accuracy, not to rounding.
///
/// Massless grains are pulled and do not pull. Softening is Plummer's, in the moments as well.
#[derive(Clone, Debug)]
pub struct TreeGravity<const D: usize> {
    constant: f64,
    softening: f64,
    opening_angle: f64,
    tree: Tree<D>,
    pulls: Vec<Pull<D>>,
    instructions: Instructions,
}

impl<const D: usize> TreeGravity<D> {
    /// Gravity of the constant `G`, the softening length and the opening angle `theta`, from 0 to below 1.
    pub fn new(constant: f64, softening: f64, opening_angle: f64) -> Self {
        let instructions = Instructions::detect();
        Self { constant, softening, opening_angle, tree: Tree::default(), pulls: vec![], instructions }
    }

    /// The constant `G`.
    pub fn constant(&self) -> f64 {
        self.constant
    }

    /// The softening length.
    pub fn softening(&self) -> f64 {
        self.softening
    }

    /// The opening angle `theta`.
    pub fn opening_angle(&self) -> f64 {
        self.opening_angle
    }

    /// Builds the tree and finds the pull on every particle, in the order of the tree.
    fn evaluate(&mut self, particles: &Particles<D>) {
        let scale = Scale::new(self.softening, &particles.position, self.instructions);
        self.tree.build(self.constant, scale, particles);
        let Self { tree, pulls, instructions, .. } = self;
        let softening_squared = (self.softening * scale.length) * (self.softening * scale.length);
        let theta_squared = self.opening_angle * self.opening_angle;
        pulls.resize(particles.len(), Pull::default());
        let evaluate = |(bodies, cells, lists): &mut (Bodies<D>, Cells<D>, Lists), (group, pulls): (usize, &mut [Pull<D>])| {
            let first = group * GROUP;
            let targets = &tree.bodies()[first..first + pulls.len()];
            lists.walk(tree, targets, theta_squared);
            pulls.fill(Pull::default());
            lists.for_each_block_of_cells(tree, cells, |cells| {
                instructions.run(OfCells { cells, targets, softening_squared, pulls });
            });
            lists.for_each_block_of_bodies(tree, bodies, |bodies| {
                instructions.run(OfBodies { bodies, targets, first: first as u32, softening_squared, pulls });
            });
            for pull in pulls {
                pull.rescale(scale);
            }
        };
        if particles.len() >= WORTH_THREADS * GROUP {
            pulls.par_chunks_mut(GROUP).enumerate().for_each_init(Default::default, evaluate);
        } else {
            let mut scratch = Default::default();
            pulls.chunks_mut(GROUP).enumerate().for_each(|group| evaluate(&mut scratch, group));
        }
    }
}

impl<const D: usize> Force<D> for TreeGravity<D> {
    fn name(&self) -> &'static str {
        "gravity"
    }

    fn accelerate(&mut self, _: f64, _: &Boundary<D>, particles: &Particles<D>, acceleration: &mut [Vector<D>]) {
        self.evaluate(particles);
        for (&i, pull) in self.tree.order().iter().zip(&self.pulls) {
            acceleration[i] += pull.acceleration;
        }
    }

    fn energy(&self, _: f64, _: &Boundary<D>, particles: &Particles<D>) -> f64 {
        let mut force = Self::new(self.constant, self.softening, self.opening_angle);
        force.evaluate(particles);
        let pulls = force.tree.order().iter().zip(&force.pulls);
        -0.5 * pulls.map(|(&i, pull)| particles.mass[i] * pull.potential).sum::<f64>()
    }

    fn virial(&self, _: f64, _: &Boundary<D>, particles: &Particles<D>) -> f64 {
        let mut force = Self::new(self.constant, self.softening, self.opening_angle);
        force.evaluate(particles);
        let pulls = force.tree.order().iter().zip(&force.pulls);
        // Pairs exert opposite forces, so the sum over pairs of r_ij . F_ij is that over bodies of r_i . F_i.
        pulls.map(|(&i, pull)| particles.mass[i] * particles.position[i].dot(pull.acceleration)).sum()
    }

    fn validate(&self, boundary: &Boundary<D>, particles: &Particles<D>) -> Result<(), Invalid> {
        if !(0.0..1.0).contains(&self.opening_angle) {
            return Err(Invalid::new("opening angle", self.opening_angle, "zero or more and below 1"));
        }
        validate(self.constant, self.softening, boundary, particles)
    }
}

#[cfg(test)]
mod tests;
