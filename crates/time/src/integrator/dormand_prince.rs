//! Dormand and Prince's Runge-Kutta method of order 8 with error estimates of order 5 and 3, and dense output of order 7.
//!
//! Prince and Dormand 1981 (doi:10.1016/0771-050X(81)90010-3); step control and dense output after Hairer, Norsett and Wanner
//! 1993 (doi:10.1007/978-3-540-78862-1, sections II.5 and II.10).

use corpuscle_checkpoint::resume;
use corpuscle_core::{Failure, Vector};

use super::dormand_prince_table::{DENSE, DENSE_SLOPES, ERROR_3, ERROR_5, MATRIX, NODES, SLOPES};
use super::{Adaptive, too_close};
use crate::system::System;

/// Steps aim at somewhat less than the error allowed, and change by at most these factors.
const SAFETY: f64 = 0.9;
const SHORTEST: f64 = 1.0 / 3.0;
const LONGEST: f64 = 6.0;
/// Terms of the dense output.
const TERMS: usize = 7;

/// Positions, not wrapped into the box, and velocities; or their rates.
type State<const D: usize> = Vec<(Vector<D>, Vector<D>)>;

/// The method between two steps: the last step is kept so that any time within it can be asked for.
pub(crate) struct DormandPrince<const D: usize> {
    tolerance: f64,
    start: f64,
    taken: f64,
    reached: f64,
    next: Option<f64>,
    before: State<D>,
    after: State<D>,
    slopes: Vec<State<D>>,
    /// Terms of the dense output of the last step, empty until somebody asks.
    dense: Vec<[(Vector<D>, Vector<D>); TERMS]>,
}

resume!(DormandPrince<const D> { values: [start, taken, reached, next, before, after, slopes, dense], set_up: [tolerance] });

impl<const D: usize> DormandPrince<D> {
    pub(crate) fn new(tolerance: f64, first_step: Option<f64>) -> Self {
        Self {
            tolerance,
            start: 0.0,
            taken: 0.0,
            reached: 0.0,
            next: first_step,
            before: vec![],
            after: vec![],
            slopes: vec![vec![]; DENSE_SLOPES],
            dense: vec![],
        }
    }

    /// The slope numbered `slope`, from those before it.
    fn evaluate(&mut self, system: &mut System<D>, slope: usize, dt: f64) {
        self.after.clear();
        self.after.extend(self.before.iter().enumerate().map(|(i, &(r, v))| {
            let (dr, dv) = weighted(MATRIX[slope], &self.slopes, i);
            (r + dr * dt, v + dv * dt)
        }));
        let time = self.start + NODES[slope] * dt;
        place(system, &self.after, time);
        system.accelerate(time, 0.0);
        self.slopes[slope].clear();
        self.slopes[slope].extend(system.particles.velocity.iter().zip(&system.acceleration).map(|(&v, &a)| (v, a)));
        // What is held is where it has to be, whatever the slopes say.
        for held in &system.held {
            let state = &mut self.after[held.particle];
            (state.0[held.axis], state.1[held.axis]) = held.at(time);
        }
    }

    /// A step of this length, and its error as a share of the error allowed.
    fn attempt(&mut self, system: &mut System<D>, dt: f64) -> f64 {
        for slope in 1..SLOPES {
            self.evaluate(system, slope, dt);
        }
        let (mut size, mut fifth, mut third) = ((0.0, 0.0), (0.0, 0.0), (0.0, 0.0));
        for i in 0..self.after.len() {
            grow(&mut size, self.before[i]);
            grow(&mut size, self.after[i]);
            grow(&mut fifth, weighted(&ERROR_5, &self.slopes, i));
            grow(&mut third, weighted(&ERROR_3, &self.slopes, i));
        }
        let share = |error: f64, size: f64| if error == 0.0 { 0.0 } else { dt * error / (self.tolerance * size) };
        let share = |error: (f64, f64)| {
            let (position, velocity) = (share(error.0, size.0), share(error.1, size.1));
            if position > velocity { position } else { velocity }
        };
        let (fifth, third) = (share(fifth), share(third));
        if fifth == 0.0 { 0.0 } else { fifth * fifth / (fifth * fifth + 0.01 * third * third).sqrt() }
    }

    /// A first step that is short against the time in which the fastest-changing velocity changes altogether.
    fn first_guess(&self) -> f64 {
        let (mut size, mut rate) = ((0.0, 0.0), (0.0, 0.0));
        for (&state, &slope) in self.before.iter().zip(&self.slopes[0]) {
            grow(&mut size, state);
            grow(&mut rate, slope);
        }
        let guess = 0.01 * (size.0 / rate.0).min((size.0 / rate.1).sqrt());
        if guess.is_finite() && guess > 0.0 { guess } else { 0.01 }
    }

    /// The terms of the polynomial of the last step.
    fn expand(&mut self, system: &mut System<D>) {
        let dt = self.taken;
        let end = std::mem::take(&mut self.after);
        for slope in SLOPES..DENSE_SLOPES {
            self.evaluate(system, slope, dt);
        }
        self.after = end;
        self.dense.clear();
        for i in 0..self.before.len() {
            let scaled = |(r, v): (Vector<D>, Vector<D>)| (r * dt, v * dt);
            let difference = |a: (Vector<D>, Vector<D>), b: (Vector<D>, Vector<D>)| (a.0 - b.0, a.1 - b.1);
            let step = difference(self.after[i], self.before[i]);
            let (first, last) = (scaled(self.slopes[0][i]), scaled(self.slopes[SLOPES - 1][i]));
            let mut terms = [(Vector::ZERO, Vector::ZERO); TERMS];
            terms[0] = step;
            terms[1] = difference(first, step);
            terms[2] = difference(difference(step, first), difference(last, step));
            for (term, row) in terms[3..].iter_mut().zip(&DENSE) {
                *term = scaled(weighted(row, &self.slopes, i));
            }
            self.dense.push(terms);
        }
    }
}

impl<const D: usize> Adaptive<D> for DormandPrince<D> {
    fn particle_count(&self) -> usize {
        self.after.len()
    }

    fn reached(&self) -> f64 {
        self.reached
    }

    fn restart(&mut self, system: &mut System<D>, time: f64) {
        system.fresh = false;
        system.hold(time);
        system.accelerate(time, 0.0);
        self.after.clear();
        self.after.extend((0..system.particles.len()).map(|i| (system.unwrapped(i), system.particles.velocity[i])));
        let last = &mut self.slopes[SLOPES - 1];
        last.clear();
        last.extend(system.particles.velocity.iter().zip(&system.acceleration).map(|(&v, &a)| (v, a)));
        (self.reached, self.taken) = (time, 0.0);
    }

    fn step(&mut self, system: &mut System<D>) -> Result<(), Failure> {
        self.start = self.reached;
        std::mem::swap(&mut self.before, &mut self.after);
        self.slopes.swap(0, SLOPES - 1);
        let longest = system.longest_step();
        let mut dt = self.next.unwrap_or_else(|| self.first_guess()).min(longest);
        loop {
            if self.start + dt == self.start {
                let fastest = self.slopes[0].iter().map(|slope| slope.1.norm()).enumerate();
                let particle = fastest.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i);
                // The state before the step is the last good one.
                self.after.clone_from(&self.before);
                self.slopes.swap(0, SLOPES - 1);
                (self.reached, self.taken) = (self.start, 0.0);
                return Err(too_close(self.start, particle, dt));
            }
            let error = self.attempt(system, dt);
            // Forces that overflowed give no number: anything shorter is better.
            let factor = if error.is_finite() { SAFETY * libm::pow(error, -0.125) } else { SHORTEST };
            let next = dt * factor.clamp(SHORTEST, LONGEST);
            if error <= 1.0 {
                self.next = Some(next);
                break;
            }
            dt = next.min(SAFETY * dt);
        }
        self.taken = dt;
        self.reached = self.start + dt;
        self.dense.clear();
        Ok(())
    }

    fn interpolate(&mut self, system: &mut System<D>, time: f64) {
        if time == self.reached || self.taken == 0.0 {
            place(system, &self.after, time);
            return;
        }
        if self.dense.is_empty() {
            self.expand(system);
        }
        let share = (time - self.start) / self.taken;
        let states = self.before.iter().zip(&self.dense).map(|(&(r, v), terms)| {
            let (mut dr, mut dv) = (Vector::ZERO, Vector::ZERO);
            for (number, term) in terms.iter().enumerate().rev() {
                let factor = if number % 2 == 0 { share } else { 1.0 - share };
                dr = (dr + term.0) * factor;
                dv = (dv + term.1) * factor;
            }
            (r + dr, v + dv)
        });
        let states: State<D> = states.collect();
        place(system, &states, time);
    }
}

/// `sum w_j slope_j` of particle `i`.
fn weighted<const D: usize>(weights: &[f64], slopes: &[State<D>], i: usize) -> (Vector<D>, Vector<D>) {
    let (mut r, mut v) = (Vector::ZERO, Vector::ZERO);
    for (&weight, slope) in weights.iter().zip(slopes).filter(|(weight, _)| **weight != 0.0) {
        r += slope[i].0 * weight;
        v += slope[i].1 * weight;
    }
    (r, v)
}

/// Makes norms as large as those of a state; what is no number stays.
fn grow<const D: usize>(largest: &mut (f64, f64), (r, v): (Vector<D>, Vector<D>)) {
    let larger = |x: f64, y: f64| if x <= y || y.is_nan() { y } else { x };
    *largest = (larger(r.norm(), largest.0), larger(v.norm(), largest.1));
}

/// Puts the system's particles where a state has them.
fn place<const D: usize>(system: &mut System<D>, states: &State<D>, time: f64) {
    for (i, &(r, v)) in states.iter().enumerate() {
        system.set_unwrapped(i, r);
        system.particles.velocity[i] = v;
    }
    (system.fresh, system.doubtful) = (false, true);
    system.hold(time);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::force::Gravity;
    use corpuscle_core::{Axis, Boundary, Particles};

    /// Row sums equal the nodes; the row of the step integrates `1, t, ..., t^7` exactly; the estimates of error are zero for
    /// all of degree below their order.
    #[test]
    fn the_table_is_a_consistent_quadrature() {
        let bound = |weights: &[f64]| 8.0 * f64::EPSILON * weights.iter().map(|w| w.abs()).sum::<f64>();
        for (row, node) in MATRIX.iter().zip(NODES) {
            assert!((row.iter().sum::<f64>() - node).abs() <= bound(row), "{row:?} {node}");
        }
        let moment = |weights: &[f64], power: i32| weights.iter().zip(NODES).map(|(w, c)| w * c.powi(power)).sum::<f64>();
        for power in 0..8 {
            assert!((moment(MATRIX[12], power) - 1.0 / f64::from(power + 1)).abs() < bound(MATRIX[12]), "t^{power}");
        }
        assert!((0..5).all(|power| moment(&ERROR_5, power).abs() < bound(&ERROR_5)) && moment(&ERROR_5, 5).abs() > 1e-6);
        assert!((0..3).all(|power| moment(&ERROR_3, power).abs() < bound(&ERROR_3)) && moment(&ERROR_3, 3).abs() > 1e-6);
    }

    /// Steps of fixed length on a circle of radius 1, dense output in the middle of the last: errors fall with the eighth power
    /// of the step, and with the eighth (`dt` times order 7) between steps.
    #[test]
    fn halving_the_step_shows_order_eight() {
        let errors = |steps: u32| {
            let mut bodies = Particles::<2>::new();
            bodies.push(Vector::ZERO, Vector::ZERO, 1.0, 0.0, 0);
            bodies.push(Vector([1.0, 0.0]), Vector([0.0, 1.0]), 0.0, 0.0, 0);
            let space = Boundary::new([-2.0; 2], [2.0; 2], Axis::Open);
            let mut system = System::new(space, bodies, vec![Box::new(Gravity::new(1.0, 0.0))]).unwrap();
            let dt = 3.0 / f64::from(steps);
            let mut method = DormandPrince::new(1e30, Some(dt));
            method.restart(&mut system, 0.0);
            for _ in 0..steps {
                method.next = Some(dt);
                method.step(&mut system).unwrap();
            }
            let reached = method.reached();
            let mut off = |time: f64| {
                method.interpolate(&mut system, time);
                (system.particles.position[1] - Vector([time.cos(), time.sin()])).norm()
            };
            (off(reached), off(reached - 0.4 * dt))
        };
        let pairs: Vec<(f64, f64)> = [4, 8, 16].map(errors).to_vec();
        println!("{pairs:?}");
        for pair in pairs.windows(2) {
            let (end, middle) = ((pair[0].0 / pair[1].0).log2(), (pair[0].1 / pair[1].1).log2());
            assert!((end - 8.0).abs() < 0.8 && middle > 7.0, "orders {end}, {middle}: {pairs:?}");
        }
    }
}
