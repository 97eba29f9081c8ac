//! Collocation on Gauss-Radau nodes, order 15, with a step that adapts itself.
//!
//! Over a step the acceleration is the polynomial `a(h) = a_0 + b_0 h + ... + b_6 h^7`, `h = (t - t_0)/dt` in `[0, 1]`,
//! that agrees with the forces at the eight nodes `h_n`. It is found by iteration in Newton's form
//! `a_0 + g_1 h + g_2 h (h - h_1) + ...`, whose coefficients change one at a time, and integrated twice in closed form.
//! Everhart 1985 (doi:10.1007/978-94-009-5400-7_17); Rein and Spiegel 2015 (doi:10.1093/mnras/stu2164), whose step control
//! and compensated summation are followed here.

use corpuscle_checkpoint::resume;
use corpuscle_core::{Failure, Vector};

use super::gauss_radau_table::{BINOMIAL, END_WEIGHTS, NODES, ORDER, Table};
use super::{Adaptive, too_close};
use crate::system::System;

/// A step is shortened, or lengthened, by at most this factor and its inverse.
const SAFETY: f64 = 0.25;
/// More rounds than this do not improve a prediction that is any good.
const ROUNDS: u32 = 12;

type Coefficients<const D: usize> = [Vector<D>; ORDER];

/// What is kept of one particle.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
struct Body<const D: usize> {
    /// State at the start of the step, not wrapped into the box, with what rounding took from it.
    position: Sum<D>,
    velocity: Sum<D>,
    acceleration: Vector<D>,
    /// Accelerations at the nodes, less that at the start.
    change: [Vector<D>; ORDER],
    /// Coefficients of the step's polynomial, and the same in Newton's form.
    b: Coefficients<D>,
    g: Coefficients<D>,
    /// What was predicted for `b`, and both as they were in the last accepted step.
    predicted: Coefficients<D>,
    last_b: Coefficients<D>,
    last_predicted: Coefficients<D>,
}

/// A sum to twice the precision: its value and what rounding took from it (Dekker 1971, doi:10.1007/BF01397083).
///
/// Kahan's summation first adds what was lost to the next increment. That rounds it to the increment's digits, among which ties
/// are frequent: something far too small to count then decides all ties one way, and ten times its own size is added.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
struct Sum<const D: usize> {
    value: Vector<D>,
    lost: Vector<D>,
}

impl<const D: usize> Sum<D> {
    fn add(&mut self, increment: Vector<D>) {
        let sum = self.value + increment;
        let taken = sum - self.value;
        // What this addition loses, whichever of the two is larger (Knuth 1969).
        let lost = self.lost + ((self.value - (sum - taken)) + (increment - taken));
        self.value = sum + lost;
        self.lost = lost - (self.value - sum);
    }
}

/// The integrator, between two steps: the last step is kept so that any time within it can be asked for.
pub(crate) struct GaussRadau<const D: usize> {
    tolerance: f64,
    table: Table,
    bodies: Vec<Body<D>>,
    /// Start of the last step taken, its length, and the end as a compensated sum.
    start: f64,
    taken: f64,
    end: Sum<1>,
    /// Length of the next step to try; not known before the first.
    next: Option<f64>,
    /// Whether `bodies` are those of the step from `start` to `end`, rather than at rest at `end` (nothing done yet).
    stepped: bool,
    /// Accelerations at the end of the last step.
    after: Vec<Vector<D>>,
}

resume!(GaussRadau<const D> { values: [bodies, start, taken, end, next, stepped, after], set_up: [tolerance, table] });

impl<const D: usize> GaussRadau<D> {
    pub(crate) fn new(tolerance: f64, first_step: Option<f64>) -> Self {
        let end = Sum { value: Vector([0.0]), lost: Vector([0.0]) };
        let table = Table::new();
        Self { tolerance, table, bodies: vec![], start: 0.0, taken: 0.0, end, next: first_step, stepped: false, after: vec![] }
    }

    /// Makes the end of the last step the start of the next.
    fn begin(&mut self, system: &mut System<D>) {
        if self.stepped {
            let dt = self.taken;
            for (i, (body, &after)) in self.bodies.iter_mut().zip(&self.after).enumerate() {
                (body.position, body.velocity) = end(body, dt);
                body.acceleration = after;
                body.last_b = body.b;
                body.last_predicted = body.predicted;
                for held in system.held.iter().filter(|held| held.particle == i) {
                    // `place` has put the prescribed coordinate into the system.
                    let k = held.axis;
                    let place = held.at(self.end.value[0]);
                    (body.position.value[k], body.velocity.value[k]) = place;
                    (body.position.lost[k], body.velocity.lost[k]) = (0.0, 0.0);
                }
            }
        } else {
            system.fresh = false;
            system.hold(self.start);
            system.accelerate(self.start, 0.0);
            for (body, &acceleration) in self.bodies.iter_mut().zip(&system.acceleration) {
                body.acceleration = acceleration;
            }
        }
        self.start = self.reached();
    }

    /// A first step that is short against the time the fastest-changing motion takes.
    fn first_guess(&self) -> f64 {
        let n = self.bodies.len() as f64;
        let centre = self.bodies.iter().fold(Vector::ZERO, |sum, body| sum + body.position.value) / n;
        let size = self.bodies.iter().map(|body| (body.position.value - centre).norm()).fold(0.0, f64::max);
        let fastest = self.bodies.iter().map(|body| body.acceleration.norm()).fold(0.0, f64::max);
        let guess = 0.01 * (size / fastest).sqrt();
        if guess.is_finite() && guess > 0.0 { guess } else { 0.01 }
    }

    /// Continues the last accepted polynomial into a step of length `dt`, and corrects by how wrong that was last time.
    fn predict(&mut self, dt: f64) {
        let ratio = if self.taken > 0.0 { dt / self.taken } else { 0.0 };
        for body in &mut self.bodies {
            let mut power = ratio;
            for k in 0..ORDER {
                let series = (k..ORDER).fold(Vector::ZERO, |sum, j| sum + body.last_b[j] * BINOMIAL[j + 1][k + 1]);
                let correction = body.last_b[k] - body.last_predicted[k];
                body.predicted[k] = series * power;
                // A correction says nothing about a step of quite another length.
                body.b[k] = if ratio > 20.0 { Vector::ZERO } else { body.predicted[k] + correction };
                power *= ratio;
            }
            for k in 0..ORDER {
                body.g[k] = (k..ORDER).fold(Vector::ZERO, |sum, j| sum + body.b[j] * self.table.newton_from_power[j][k]);
            }
        }
    }

    /// Solves for the coefficients; returns the share of the last term in the acceleration.
    ///
    /// The share is of root mean squares over all components, which change smoothly along an orbit and not with the direction it
    /// is looked at from. The largest component has kinks, and steps that depend on the phase with kinks may lock to a whole number a
    /// period: the same points are then met over and over, and errors that else average out over all phases add up.
    fn iterate(&mut self, system: &mut System<D>, start: f64, dt: f64) -> f64 {
        let mut last_change = f64::INFINITY;
        for round in 0..ROUNDS {
            let mut change: f64 = 0.0;
            let mut scale: f64 = 0.0;
            for node in 1..=ORDER {
                let h = NODES[node];
                self.place_within(system, h, dt);
                system.hold(start + h * dt);
                system.accelerate(start + h * dt, 0.0);
                for (body, &a) in self.bodies.iter_mut().zip(&system.acceleration) {
                    let grown = a - body.acceleration;
                    body.change[node - 1] = grown;
                    let mut g = grown * self.table.inverse_gap[node][0];
                    for m in 1..node {
                        g = (g - body.g[m - 1]) * self.table.inverse_gap[node][m];
                    }
                    let step = g - body.g[node - 1];
                    body.g[node - 1] = g;
                    for (k, b) in body.b.iter_mut().enumerate().take(node) {
                        *b += step * self.table.power_from_newton[node - 1][k];
                    }
                    if node == ORDER {
                        change = largest(change, step);
                        scale = largest(scale, a);
                    }
                }
            }
            if !(change.is_finite() && scale.is_finite()) {
                return f64::NAN;
            }
            let change = change / scale;
            // Converged to rounding, or no longer getting better.
            if scale == 0.0 || change < 1e-16 || (round >= 2 && change >= last_change) {
                break;
            }
            last_change = change;
        }
        let squares =
            |(term, scale), (body, a): (&Body<D>, &Vector<D>)| (term + body.b[ORDER - 1].norm_squared(), scale + a.norm_squared());
        let (last_term, scale) = self.bodies.iter().zip(&system.acceleration).fold((0.0, 0.0), squares);
        let (last_term, scale) = (last_term.sqrt(), scale.sqrt());
        // Against accelerations; but what does not change the last bit of a velocity is no error. Without that, a kink in a
        // force (where a potential is cut off) asks for ever shorter steps while all else is at rest.
        let fastest = self.bodies.iter().fold(0.0, |fastest, body| largest(fastest, body.velocity.value));
        let scale = scale.max(f64::EPSILON * fastest / (dt * self.tolerance));
        if scale == 0.0 { 0.0 } else { last_term / scale }
    }

    fn place(&self, system: &mut System<D>, share: f64) {
        if share != 1.0 {
            return self.place_within(system, share, self.taken);
        }
        for (i, body) in self.bodies.iter().enumerate() {
            let (position, velocity) = end(body, self.taken);
            system.set_unwrapped(i, position.value);
            system.remainder[i] = position.lost;
            system.particles.velocity[i] = velocity.value;
        }
        (system.fresh, system.doubtful) = (false, true);
    }

    /// Puts the system's particles where the polynomial has them at the share `h` of the step.
    fn place_within(&self, system: &mut System<D>, h: f64, dt: f64) {
        for (i, body) in self.bodies.iter().enumerate() {
            let (dr, dv) = increments(body, dt, h);
            let (v, lost) = (body.velocity.value, body.velocity.lost);
            let mut position = body.position;
            position.add(v * (h * dt) + (lost * (h * dt) + dr));
            system.set_unwrapped(i, position.value);
            system.remainder[i] = position.lost;
            system.particles.velocity[i] = v + (lost + dv);
        }
        (system.fresh, system.doubtful) = (false, true);
    }
}

impl<const D: usize> Adaptive<D> for GaussRadau<D> {
    fn particle_count(&self) -> usize {
        self.bodies.len()
    }

    fn reached(&self) -> f64 {
        self.end.value[0]
    }

    fn restart(&mut self, system: &mut System<D>, time: f64) {
        let zero = [Vector::ZERO; ORDER];
        let exact = |value| Sum { value, lost: Vector::ZERO };
        self.bodies.clear();
        self.bodies.extend((0..system.particles.len()).map(|i| Body {
            position: exact(system.unwrapped(i)),
            velocity: exact(system.particles.velocity[i]),
            acceleration: Vector::ZERO,
            change: zero,
            b: zero,
            g: zero,
            predicted: zero,
            last_b: zero,
            last_predicted: zero,
        }));
        self.after.clear();
        system.remainder.clear();
        system.remainder.resize(self.bodies.len(), Vector::ZERO);
        self.start = time;
        self.taken = 0.0;
        self.end = Sum { value: Vector([time]), lost: Vector([0.0]) };
        self.stepped = false;
    }

    fn step(&mut self, system: &mut System<D>) -> Result<(), Failure> {
        self.begin(system);
        let start = self.start;
        let longest = system.longest_step();
        let mut dt = self.next.unwrap_or_else(|| self.first_guess()).min(longest);
        let next = loop {
            if start + dt == start {
                let fastest = |i: &usize| self.bodies[*i].acceleration.norm();
                let particle = (0..self.bodies.len()).max_by(|i, j| fastest(i).total_cmp(&fastest(j)));
                return Err(too_close(start, particle, dt));
            }
            self.predict(dt);
            let error = self.iterate(system, start, dt);
            // Forces that overflowed give no number: anything shorter is better.
            let wanted = if error.is_finite() {
                (dt * libm::pow(self.tolerance / error, 1.0 / 7.0)).min(dt / SAFETY)
            } else {
                dt * SAFETY * SAFETY
            };
            if wanted >= SAFETY * dt {
                break wanted;
            }
            dt = wanted;
        };
        self.taken = dt;
        self.next = Some(next.min(longest));
        self.stepped = true;
        self.end.add(Vector([dt]));
        // The accelerations at the end start the next step.
        self.place(system, 1.0);
        system.hold(self.reached());
        system.accelerate(self.reached(), 0.0);
        self.after.clone_from(&system.acceleration);
        system.first_lost().map_or(Ok(()), |i| {
            let cause = "position or velocity is no longer a number; a smaller tolerance may help".to_owned();
            Err(Failure { time: start, particle: Some(i), cause })
        })
    }

    fn interpolate(&mut self, system: &mut System<D>, time: f64) {
        if self.stepped {
            let share = if time == self.reached() { 1.0 } else { (time - self.start) / self.taken };
            self.place(system, share);
            system.hold(time);
        }
    }
}

/// Position and velocity at the end of the step.
fn end<const D: usize>(body: &Body<D>, dt: f64) -> (Sum<D>, Sum<D>) {
    let sum = |of: usize, part: usize| {
        let term = |sum, (change, weights): (&Vector<D>, &[[f64; 2]; 2])| sum + *change * weights[of][part];
        body.change.iter().zip(&END_WEIGHTS).fold(Vector::ZERO, term)
    };
    let (mut position, mut velocity) = (body.position, body.velocity);
    position.add((body.acceleration * 0.5 + sum(1, 0)) * (dt * dt));
    position.add(velocity.value * dt);
    position.add(velocity.lost * dt);
    velocity.add((body.acceleration + sum(0, 0)) * dt);
    // Apart from the rest, beside which they would be rounded away.
    position.add(sum(1, 1) * (dt * dt));
    velocity.add(sum(0, 1) * dt);
    (position, velocity)
}

/// What the acceleration adds to `r_0 + v_0 h dt` and to `v_0` up to the share `h` of the step:
/// `(h dt)^2 (a_0/2 + b_0 h/6 + b_1 h^2/12 + ...)` and `h dt (a_0 + b_0 h/2 + b_1 h^2/3 + ...)`.
fn increments<const D: usize>(body: &Body<D>, dt: f64, h: f64) -> (Vector<D>, Vector<D>) {
    let (mut twice, mut once) = (Vector::ZERO, Vector::ZERO);
    for (k, &b) in body.b.iter().enumerate().rev() {
        let k = k as f64;
        twice = (twice + b * (1.0 / ((k + 2.0) * (k + 3.0)))) * h;
        once = (once + b * (1.0 / (k + 2.0))) * h;
    }
    let step = h * dt;
    ((twice + body.acceleration * 0.5) * (step * step), (once + body.acceleration) * step)
}

fn largest<const D: usize>(so_far: f64, vector: Vector<D>) -> f64 {
    // A NaN must not be lost in the comparison.
    vector.0.iter().fold(so_far, |largest, x| if x.abs() <= largest || largest.is_nan() { largest } else { x.abs() })
}
