//! Explicit Runge-Kutta methods, from their tables.

use corpuscle_core::{Failure, Vector};

use crate::system::{Path, System};

/// Butcher's table of an explicit method.
pub(crate) struct Tableau {
    /// Times `c_i` of the stages, as shares of the step.
    nodes: &'static [f64],
    /// Row `i`: weights `a_ij`, `j < i`, of the earlier slopes in stage `i`.
    matrix: &'static [&'static [f64]],
    /// Weights `b_i` of the slopes in the step.
    weights: &'static [f64],
}

/// Euler 1768.
pub(crate) static EULER: Tableau = Tableau { nodes: &[0.0], matrix: &[&[]], weights: &[1.0] };

/// Kutta 1901, the classical rule of order 4.
pub(crate) static CLASSICAL: Tableau = Tableau {
    nodes: &[0.0, 0.5, 0.5, 1.0],
    matrix: &[&[], &[0.5], &[0.0, 0.5], &[0.0, 0.0, 1.0]],
    weights: &[1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0],
};

/// Velocity and acceleration of every particle at one stage.
#[derive(Clone, Default)]
struct Slope<const D: usize> {
    velocity: Vec<Vector<D>>,
    acceleration: Vec<Vector<D>>,
}

/// A method with its working memory.
pub(crate) struct RungeKutta<const D: usize> {
    tableau: &'static Tableau,
    slopes: Vec<Slope<D>>,
    position: Vec<Vector<D>>,
    velocity: Vec<Vector<D>>,
}

impl<const D: usize> RungeKutta<D> {
    pub(crate) fn new(tableau: &'static Tableau) -> Self {
        Self { tableau, slopes: vec![Slope::default(); tableau.nodes.len()], position: vec![], velocity: vec![] }
    }

    /// One step from `start` to `end`.
    pub(crate) fn step(&mut self, system: &mut System<D>, start: f64, end: f64, dt: f64) -> Result<(), Failure> {
        let Tableau { nodes, matrix, weights } = self.tableau;
        self.position.clone_from(&system.particles.position);
        self.velocity.clone_from(&system.particles.velocity);
        for (stage, (&node, row)) in nodes.iter().zip(*matrix).enumerate() {
            self.place(system, row, dt);
            system.hold(start + node * dt);
            system.accelerate(start + node * dt, 0.0);
            self.slopes[stage].velocity.clone_from(&system.particles.velocity);
            self.slopes[stage].acceleration.clone_from(&system.acceleration);
        }
        self.place(system, weights, dt);
        system.hold(end);
        system.confine(end, dt, Path::Bent { kick: 0.0 })
    }

    /// Positions and velocities at the start of the step plus `dt sum w_j slope_j`.
    fn place(&self, system: &mut System<D>, weights: &[f64], dt: f64) {
        if weights.is_empty() {
            return; // the first stage is the state itself, whose acceleration may be known
        }
        let particles = &mut system.particles;
        for i in 0..self.position.len() {
            let (mut r, mut v) = (self.position[i], self.velocity[i]);
            for (&weight, slope) in weights.iter().zip(&self.slopes) {
                r += slope.velocity[i] * (weight * dt);
                v += slope.acceleration[i] * (weight * dt);
            }
            particles.position[i] = r;
            particles.velocity[i] = v;
        }
        (system.fresh, system.doubtful) = (false, true);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Row sums equal the nodes; the weights integrate `1, t, t^2, t^3` exactly up to the order.
    #[test]
    fn the_tables_are_consistent_quadratures() {
        for (tableau, order) in [(&EULER, 1), (&CLASSICAL, 4)] {
            for (row, node) in tableau.matrix.iter().zip(tableau.nodes) {
                assert_eq!(row.iter().sum::<f64>(), *node);
            }
            for power in 0..order {
                let sum: f64 = tableau.weights.iter().zip(tableau.nodes).map(|(b, c)| b * c.powi(power)).sum();
                assert!((sum - 1.0 / f64::from(power + 1)).abs() < 4.0 * f64::EPSILON);
            }
        }
    }
}
