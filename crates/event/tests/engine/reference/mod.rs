//! A second event-driven engine, as plain as can be, to hold the fast one against.
//!
//! Every particle is moved to every event; then every pair, in every periodic image, and every surface is asked anew
//! for its next contact. `O(N^2)` work per event, no cells, no queue, no local times, and none of the engine's code:
//! roots of motion in a field are found by sampling and bisection.

mod pair;

use corpuscle_core::{Axis, Boundary, Particles, Random, Vector};
use corpuscle_event::{Restitution, Rules};

/// What happened: when, to whom (a pair `i < j`, or a particle alone).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Event {
    pub(crate) time: f64,
    pub(crate) first: usize,
    pub(crate) second: Option<usize>,
}

pub(crate) struct Reference<const D: usize> {
    /// The piston in it is as of `time`.
    pub(crate) boundary: Boundary<D>,
    pub(crate) rules: Rules<D>,
    pub(crate) particles: Particles<D>,
    pub(crate) time: f64,
    above_piston: Vec<bool>,
    thermal_contacts: Vec<u64>,
    /// Which pairs are inside their wells.
    pub(crate) bonds: Vec<Vec<bool>>,
    /// Radii are this times those of the particles, and grow at this rate.
    pub(crate) scale: f64,
    pub(crate) growth: f64,
}

#[derive(Clone, Copy)]
enum Next<const D: usize> {
    /// Cores meet.
    Pair(usize, usize, Vector<D>),
    /// A pair comes to the edge of its well.
    Edge(usize, usize, Vector<D>),
    /// A face of the box: particle, axis, upper or lower.
    Face(usize, usize, bool),
    /// A side of a plate: the normal is this much of the axis.
    Plate(usize, usize, f64),
    Rim(usize, [usize; 2], [f64; 2]),
    /// An obstacle, the place of its centre and its radius.
    Round(usize, Vector<D>, f64),
    Piston(usize),
    Stop,
}

/// What a particle collides with: normal velocity along the normal, inverse mass, radius.
struct Other {
    velocity: f64,
    inverse_mass: f64,
    radius: f64,
}

impl Other {
    const FIXED: Self = Self { velocity: 0.0, inverse_mass: 0.0, radius: f64::INFINITY };
}

impl<const D: usize> Reference<D> {
    pub(crate) fn new(boundary: Boundary<D>, particles: Particles<D>, rules: Rules<D>) -> Self {
        let above = |r: &Vector<D>| boundary.piston.is_some_and(|piston| r[piston.axis] > piston.position);
        let above_piston = particles.position.iter().map(above).collect();
        let n = particles.len();
        let mut plain = Self {
            thermal_contacts: vec![0; n],
            boundary,
            rules,
            particles,
            time: 0.0,
            above_piston,
            bonds: vec![vec![false; n]; n],
            scale: 1.0,
            growth: 0.0,
        };
        for i in 0..n {
            for j in 0..n {
                let r = plain.boundary.displacement(plain.particles.position[i], plain.particles.position[j]);
                plain.bonds[i][j] = i != j && r.norm() < plain.edge(i, j);
            }
        }
        plain
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
        let removals = self.boundary.partitions.iter().filter_map(|plate| plate.removed_at);
        let removals = removals.chain(self.boundary.faces.iter().flatten().filter_map(|face| face.opened_at));
        let removal = removals.filter(|&time| self.time < time).fold(f64::INFINITY, f64::min);
        let mut best = (piece.min(removal - self.time), None);
        let n = self.particles.len();
        for i in 0..n {
            for j in i + 1..n {
                for shift in self.shifts(2) {
                    for (t, next) in [
                        (self.core_delay(i, j, shift), Next::Pair(i, j, shift)),
                        (self.edge_delay(i, j, shift), Next::Edge(i, j, shift)),
                    ] {
                        if t < best.0 {
                            best = (t, Some(next));
                        }
                    }
                }
            }
            self.faces(i, &mut best);
            self.plates(i, &mut best);
            self.obstacles(i, &mut best);
        }
        self.piston(&mut best);
        let (delay, next) = best;
        self.fly(delay);
        if next.is_none() && self.time + 1e-12 > removal {
            self.time = removal;
        }
        let event = next.and_then(|next| self.execute(next));
        for r in &mut self.particles.position {
            *r = self.boundary.wrap(*r);
        }
        event
    }

    fn fly(&mut self, delay: f64) {
        let g = self.rules.field;
        for (r, v) in self.particles.position.iter_mut().zip(&mut self.particles.velocity) {
            *r += *v * delay + g * (0.5 * delay * delay);
            *v += g * delay;
        }
        if let Some(piston) = &mut self.boundary.piston {
            let a = piston.acceleration();
            piston.position += piston.velocity * delay + 0.5 * a * delay * delay;
            piston.velocity += a * delay;
        }
        self.time += delay;
        self.scale += self.growth * delay;
    }

    fn execute(&mut self, next: Next<D>) -> Option<Event> {
        let position = |i: usize| self.particles.position[i];
        let (first, second) = match next {
            Next::Pair(i, j, shift) => {
                let r = position(j) + shift - position(i);
                self.collide_pair(i, j, r / r.norm());
                (i, Some(j))
            }
            Next::Edge(i, j, shift) => {
                let r = position(j) + shift - position(i);
                self.cross(i, j, r / r.norm());
                (i, Some(j))
            }
            Next::Face(i, axis, upper) => {
                let k = Vector::unit(axis) * if upper { 1.0 } else { -1.0 };
                let velocity = self.boundary.face_at(axis, upper, self.time).1 * k[axis];
                match self.boundary.faces[axis][usize::from(upper)].temperature {
                    Some(temperature) => self.leave_warm_face(i, axis, k[axis], velocity, temperature),
                    None => {
                        self.collide(i, k, &Other { velocity, ..Other::FIXED });
                    }
                }
                (i, None)
            }
            Next::Plate(i, axis, sign) => {
                self.collide(i, Vector::unit(axis) * sign, &Other::FIXED);
                (i, None)
            }
            Next::Rim(i, axes, at) => {
                let mut r = Vector::ZERO;
                for (&axis, at) in axes.iter().zip(at) {
                    r[axis] = at - position(i)[axis];
                }
                self.collide(i, r / r.norm(), &Other::FIXED);
                (i, None)
            }
            Next::Round(i, centre, radius) => {
                let r = centre - position(i);
                self.collide(i, r / r.norm(), &Other { radius, ..Other::FIXED });
                (i, None)
            }
            Next::Piston(i) => {
                let piston = self.boundary.piston?;
                let sign = if self.above_piston[i] { -1.0 } else { 1.0 };
                let other = Other { velocity: sign * piston.velocity, inverse_mass: 1.0 / piston.mass, ..Other::FIXED };
                let impulse = self.collide(i, Vector::unit(piston.axis) * sign, &other);
                self.boundary.piston.as_mut()?.velocity += sign * impulse / piston.mass;
                (i, None)
            }
            Next::Stop => {
                let piston = self.boundary.piston.as_mut()?;
                piston.velocity = -piston.velocity;
                return None;
            }
        };
        Some(Event { time: self.time, first, second })
    }

    /// Whole-box shifts to so many boxes in each direction; two are more than enough for all images that could touch.
    fn shifts(&self, boxes: i32) -> Vec<Vector<D>> {
        let mut shifts = vec![Vector::ZERO];
        for k in 0..D {
            if self.boundary.axes[k] == Axis::Periodic {
                let side = Vector::unit(k) * self.boundary.extent()[k];
                shifts = shifts.iter().flat_map(|&s| (-boxes..=boxes).map(move |turns| s + side * f64::from(turns))).collect();
            }
        }
        shifts
    }

    fn faces(&self, i: usize, best: &mut (f64, Option<Next<D>>)) {
        let p = &self.particles;
        let (r, v, g, radius) = (p.position[i], p.velocity[i], self.rules.field, p.radius[i]);
        for k in (0..D).filter(|&k| self.boundary.axes[k] == Axis::Walls) {
            for (sign, upper) in [(-1.0, false), (1.0, true)] {
                let face = &self.boundary.faces[k][usize::from(upper)];
                if !face.stands_at(self.time) {
                    continue;
                }
                let t = if face.motion.is_some() {
                    let place = |t: f64| r[k] + v[k] * t + 0.5 * g[k] * t * t;
                    let gap = |t: f64| sign * (self.boundary.face_at(k, upper, self.time + t).0 - place(t)) - radius;
                    first_crossing(gap, best.0, 1000)
                } else {
                    reach(sign * (self.boundary.face_at(k, upper, 0.0).0 - r[k]) - radius, sign * v[k], sign * g[k])
                };
                if t < best.0 {
                    *best = (t, Some(Next::Face(i, k, upper)));
                }
            }
        }
    }

    /// Plates and rims of holes, without periodic images of plates (the tests keep them away from periodic faces).
    fn plates(&self, i: usize, best: &mut (f64, Option<Next<D>>)) {
        let p = &self.particles;
        let (r, v, g, radius) = (p.position[i], p.velocity[i], self.rules.field, p.radius[i]);
        for plate in self.boundary.partitions.iter().filter(|plate| plate.stands_at(self.time)) {
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
                    *best = (t, Some(Next::Plate(i, k, sign)));
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
                let t = first_crossing(distance, best.0, 200);
                if t < best.0 {
                    *best = (t, Some(Next::Rim(i, axes, at)));
                }
            }
        }
    }

    fn obstacles(&self, i: usize, best: &mut (f64, Option<Next<D>>)) {
        let p = &self.particles;
        let (r, v, g) = (p.position[i], p.velocity[i], self.rules.field);
        for obstacle in &self.boundary.obstacles {
            for shift in self.shifts(1) {
                let (centre, s) = (obstacle.centre + shift, p.radius[i] + obstacle.radius);
                let distance = |t: f64| (r + v * t + g * (0.5 * t * t) - centre).norm() - s;
                let t = if g == Vector::ZERO {
                    sphere_delay(r - centre, v, s)
                } else if distance(0.0) > (v.norm() + 0.5 * g.norm() * best.0) * best.0 {
                    f64::INFINITY
                } else {
                    first_crossing(distance, best.0, 1000)
                };
                if t < best.0 {
                    *best = (t, Some(Next::Round(i, centre, obstacle.radius)));
                }
            }
        }
    }

    fn piston(&self, best: &mut (f64, Option<Next<D>>)) {
        let Some(piston) = self.boundary.piston else { return };
        let (k, a, p) = (piston.axis, piston.acceleration(), &self.particles);
        for i in 0..p.len() {
            let sign = if self.above_piston[i] { -1.0 } else { 1.0 };
            let h = sign * (piston.position - p.position[i][k]) - p.radius[i];
            let t = reach(h, sign * (p.velocity[i][k] - piston.velocity), sign * (self.rules.field[k] - a));
            if t < best.0 {
                *best = (t, Some(Next::Piston(i)));
            }
        }
        for (sign, stop) in [(-1.0, piston.stops[0]), (1.0, piston.stops[1])] {
            let t = reach(sign * (stop - piston.position), sign * piston.velocity, sign * a);
            if t < best.0 {
                *best = (t, Some(Next::Stop));
            }
        }
    }

    fn collide_pair(&mut self, i: usize, j: usize, k: Vector<D>) {
        let p = &self.particles;
        let (mass, velocity) = (p.mass[j], p.velocity[j]);
        // Contact distances that grow meet as moving walls do: reflection in the frame of the surface.
        let growth = (p.radius[i] + p.radius[j]) * self.growth;
        let other = Other { velocity: velocity.dot(k) - growth, inverse_mass: 1.0 / mass, radius: p.radius[j] };
        let impulse = self.collide(i, k, &other);
        self.particles.velocity[j] = velocity + k * (impulse / mass);
    }

    /// Answers the impulse.
    fn collide(&mut self, i: usize, k: Vector<D>, other: &Other) -> f64 {
        let p = &mut self.particles;
        let approach = p.velocity[i].dot(k) - other.velocity;
        let inverse_mass = 1.0 / p.mass[i] + other.inverse_mass;
        let e = match self.rules.restitution {
            _ if approach < self.rules.elastic_below => 1.0,
            Restitution::Constant(e) => e,
            Restitution::Viscoelastic { stiffness, dissipation_time } => {
                let effective_radius = 1.0 / (1.0 / p.radius[i] + 1.0 / other.radius);
                let beta = 1.5 * dissipation_time * (stiffness * effective_radius.sqrt() * inverse_mass).powf(0.4);
                let x = beta.sqrt() * approach.max(0.0).powf(0.1);
                let numerator = 1.0 + 0.501_086 * x;
                numerator / (numerator + 1.153_45 * x.powi(2) + 0.577_977 * x.powi(3) + 0.532_178 * x.powi(4))
            }
        };
        let impulse = (1.0 + e) * approach / inverse_mass;
        p.velocity[i] -= k * (impulse / p.mass[i]);
        impulse
    }

    /// `k` is the component of the normal towards the face, which moves at `u` along that.
    fn leave_warm_face(&mut self, i: usize, axis: usize, k: f64, u: f64, temperature: f64) {
        let spread = (temperature / self.particles.mass[i]).sqrt();
        let mut random = Random::at(self.rules.seed, Rules::<D>::THERMAL, self.thermal_contacts[i], i as u64);
        self.thermal_contacts[i] += 1;
        let speed = spread * (-2.0 * random.uniform().ln()).sqrt();
        self.particles.velocity[i] = Vector::from_fn(|m| if m == axis { k * (u - speed) } else { spread * random.normal() });
    }
}

/// When two points at distance vector `r`, moving apart at `v`, are `s` apart: not at all, now, or later.
fn sphere_delay<const D: usize>(r: Vector<D>, v: Vector<D>, s: f64) -> f64 {
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

/// The first change of a gap from open to closed before `last`: samples, then bisects.
fn first_crossing(gap: impl Fn(f64) -> f64, last: f64, samples: u32) -> f64 {
    let step = last / f64::from(samples);
    let mut before = gap(0.0);
    for m in 1..=samples {
        let after = gap(step * f64::from(m));
        if before > 1e-11 && after <= 0.0 {
            let (mut low, mut high) = (step * f64::from(m - 1), step * f64::from(m));
            while low < 0.5 * (low + high) && 0.5 * (low + high) < high {
                let middle = 0.5 * (low + high);
                if gap(middle) > 0.0 { low = middle } else { high = middle }
            }
            return high;
        }
        before = after;
    }
    f64::INFINITY
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
