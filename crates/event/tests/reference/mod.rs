//! A second event-driven engine, as plain as can be, to hold the fast one against.
//!
//! Every particle is moved to every event; then every pair, in every periodic image, and every surface is asked anew
//! for its next contact. `O(N^2)` work per event, no cells, no queue, no local times, and none of the engine's code:
//! roots of motion in a field are found by sampling and bisection.

use corpuscle_core::{Axis, Boundary, Particles, Vector};
use corpuscle_event::Rules;

/// What happened: when, to whom (a pair `i < j`, or a particle alone).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Event {
    pub(crate) time: f64,
    pub(crate) first: usize,
    pub(crate) second: Option<usize>,
}

pub(crate) struct Reference<const D: usize> {
    pub(crate) boundary: Boundary<D>,
    pub(crate) rules: Rules<D>,
    pub(crate) particles: Particles<D>,
    pub(crate) time: f64,
}

#[derive(Clone, Copy)]
enum Next<const D: usize> {
    Pair(usize, usize, Vector<D>),
    /// A fixed obstacle: the unit normal is found when it happens.
    Wall(usize, usize, f64),
    Rim(usize, [usize; 2], [f64; 2]),
}

impl<const D: usize> Reference<D> {
    pub(crate) fn new(boundary: Boundary<D>, particles: Particles<D>, rules: Rules<D>) -> Self {
        Self { boundary, rules, particles, time: 0.0 }
    }

    /// Moves on to the next contact, if there is one before `horizon` more time, and executes it.
    ///
    /// Free flight goes in pieces of at most half a box, so that few periodic images can be met in one.
    pub(crate) fn step(&mut self, horizon: f64) -> Option<Event> {
        let end = self.time + horizon;
        while self.time < end {
            let fastest = self.particles.velocity.iter().map(|v| v.norm()).fold(0.0, f64::max);
            let side = self.boundary.extent().0.into_iter().fold(f64::INFINITY, f64::min);
            let hastening = self.rules.field.norm();
            let piece = (0.25 * side / (fastest + hastening * 0.1)).min(0.1 * side / (fastest * hastening).sqrt().max(1e-9));
            if let Some(event) = self.piece(piece) {
                return Some(event);
            }
        }
        None
    }

    fn piece(&mut self, piece: f64) -> Option<Event> {
        let mut best = (piece, None);
        let n = self.particles.len();
        for i in 0..n {
            for j in i + 1..n {
                for shift in self.shifts() {
                    let t = self.pair_delay(i, j, shift);
                    if t < best.0 {
                        best = (t, Some(Next::Pair(i, j, shift)));
                    }
                }
            }
            self.obstacles(i, &mut best);
        }
        let (delay, next) = best;
        let g = self.rules.field;
        for i in 0..n {
            let v = self.particles.velocity[i];
            self.particles.position[i] += v * delay + g * (0.5 * delay * delay);
            self.particles.velocity[i] += g * delay;
        }
        self.time += delay;
        let event = next.map(|next| match next {
            Next::Pair(i, j, shift) => {
                let r = self.particles.position[j] + shift - self.particles.position[i];
                self.collide(i, Some(j), r / r.norm());
                Event { time: self.time, first: i, second: Some(j) }
            }
            Next::Wall(i, axis, sign) => {
                self.collide(i, None, Vector::unit(axis) * sign);
                Event { time: self.time, first: i, second: None }
            }
            Next::Rim(i, axes, at) => {
                let mut r = Vector::ZERO;
                for (&axis, at) in axes.iter().zip(at) {
                    r[axis] = at - self.particles.position[i][axis];
                }
                self.collide(i, None, r / r.norm());
                Event { time: self.time, first: i, second: None }
            }
        });
        for r in &mut self.particles.position {
            *r = self.boundary.wrap(*r);
        }
        event
    }

    /// Whole-box shifts to all images that could touch: two boxes in each direction are more than enough.
    fn shifts(&self) -> Vec<Vector<D>> {
        let mut shifts = vec![Vector::ZERO];
        for k in 0..D {
            if self.boundary.axes[k] == Axis::Periodic {
                let side = Vector::unit(k) * self.boundary.extent()[k];
                shifts = shifts.iter().flat_map(|&s| [-2.0, -1.0, 0.0, 1.0, 2.0].map(|turns| s + side * turns)).collect();
            }
        }
        shifts
    }

    fn pair_delay(&self, i: usize, j: usize, shift: Vector<D>) -> f64 {
        let p = &self.particles;
        let (r, v) = (p.position[j] + shift - p.position[i], p.velocity[j] - p.velocity[i]);
        let s = p.radius[i] + p.radius[j];
        let (rr, rv, vv) = (r.dot(r), r.dot(v), v.dot(v));
        if rv >= 0.0 {
            return f64::INFINITY;
        }
        if rr <= s * s {
            return 0.0;
        }
        let root = rv * rv - vv * (rr - s * s);
        if root < 0.0 { f64::INFINITY } else { (rr - s * s) / (root.sqrt() - rv) }
    }

    /// Walls, plates and rims of holes, without periodic images of plates (the tests keep them away from periodic faces).
    fn obstacles(&self, i: usize, best: &mut (f64, Option<Next<D>>)) {
        let p = &self.particles;
        let (r, v, g, radius) = (p.position[i], p.velocity[i], self.rules.field, p.radius[i]);
        for k in (0..D).filter(|&k| self.boundary.axes[k] == Axis::Walls) {
            for (sign, at) in [(-1.0, self.boundary.lower[k]), (1.0, self.boundary.upper[k])] {
                let t = reach(sign * (at - r[k]) - radius, sign * v[k], sign * g[k]);
                if t < best.0 {
                    *best = (t, Some(Next::Wall(i, k, sign)));
                }
            }
        }
        for plate in &self.boundary.partitions {
            let k = plate.axis;
            // Contact with a side is possible only from that side; after a passage through the hole from the other.
            for sign in [-1.0, 1.0] {
                let height = sign * (plate.position - r[k]);
                let t = if height > 0.0 {
                    reach(height - radius, sign * v[k], sign * g[k])
                } else {
                    continue;
                };
                let covered = |t: f64| plate.covers(r + v * t + g * (0.5 * t * t));
                if t < best.0 && covered(t) {
                    *best = (t, Some(Next::Wall(i, k, sign)));
                }
            }
            let Some(hole) = plate.hole else { continue };
            for rim in [hole.from, hole.to] {
                let at = [plate.position, rim];
                let axes = [plate.axis, hole.along];
                let distance = |t: f64| {
                    let place = |m: usize| r[axes[m]] + v[axes[m]] * t + 0.5 * g[axes[m]] * t * t - at[m];
                    place(0).hypot(place(1)) - radius
                };
                // Sample until the best time known, then bisect the first change from outside to inside.
                let last = best.0;
                let samples = 200;
                let step = last / f64::from(samples);
                let mut before = distance(0.0);
                for m in 1..=samples {
                    let after = distance(step * f64::from(m));
                    if before > 1e-11 && after <= 0.0 {
                        let (mut low, mut high) = (step * f64::from(m - 1), step * f64::from(m));
                        while low < 0.5 * (low + high) && 0.5 * (low + high) < high {
                            let middle = 0.5 * (low + high);
                            if distance(middle) > 0.0 { low = middle } else { high = middle }
                        }
                        *best = (high, Some(Next::Rim(i, axes, at)));
                        break;
                    }
                    before = after;
                }
            }
        }
    }

    fn collide(&mut self, i: usize, j: Option<usize>, k: Vector<D>) {
        let p = &mut self.particles;
        let theirs = j.map_or(Vector::ZERO, |j| p.velocity[j]);
        let approach = (p.velocity[i] - theirs).dot(k);
        let e = if approach < self.rules.elastic_below { 1.0 } else { self.rules.restitution };
        let inverse_masses = 1.0 / p.mass[i] + j.map_or(0.0, |j| 1.0 / p.mass[j]);
        let impulse = k * ((1.0 + e) * approach / inverse_masses);
        let (mi, vi) = (p.mass[i], p.velocity[i]);
        p.velocity[i] = vi - impulse / mi;
        if let Some(j) = j {
            p.velocity[j] = theirs + impulse / p.mass[j];
        }
    }
}

/// First time at which a height `h` above contact is used up, falling at `v` towards it, accelerated by `a` towards it.
fn reach(h: f64, v: f64, a: f64) -> f64 {
    // Both roots, the plain way; only an arrival counts, and what touches already arrives only if it moves on.
    if h <= 1e-11 {
        if v > 0.0 {
            return 0.0;
        }
        // It has just left: it comes back after the whole flight.
        return if a > 0.0 { -2.0 * v / a } else { f64::INFINITY };
    }
    if a.abs() < 1e-300 {
        return if v > 0.0 { h / v } else { f64::INFINITY };
    }
    let root = v * v + 2.0 * a * h;
    if root < 0.0 {
        return f64::INFINITY;
    }
    let times = [(-v + root.sqrt()) / a, (-v - root.sqrt()) / a];
    times.into_iter().filter(|&t| t > 0.0).fold(f64::INFINITY, f64::min)
}
