//! What an integrator moves: particles in a boundary under forces, with the few operations integrators are made of.

mod walls;

use corpuscle_checkpoint::resume;
use corpuscle_core::{Axis, Boundary, Contact, Failure, Invalid, Particles, Vector};

use rayon::prelude::*;

use crate::constraint::Held;
use crate::force::Force;
use crate::motion::{self, Moves, Stride};
use crate::strider::{State, Strider};
use crate::threads::{self, CHUNK};
pub(crate) use walls::Path;

/// State and forces. Scratch arrays live beside what uses them.
pub(crate) struct System<const D: usize> {
    pub(crate) boundary: Boundary<D>,
    pub(crate) particles: Particles<D>,
    /// How often each particle went through the upper minus the lower face of a periodic axis.
    pub(crate) images: Vec<[i64; D]>,
    pub(crate) forces: Vec<Box<dyn Force<D>>>,
    /// In the order of their particles.
    pub(crate) held: Vec<Held>,
    /// Accelerations; those of the present positions when `fresh`.
    pub(crate) acceleration: Vec<Vector<D>>,
    pub(crate) fresh: bool,
    /// Hits of walls since they were last taken out.
    pub(crate) contacts: Vec<Contact<D>>,
    /// A kick that is still to be done.
    owed: Option<f64>,
    /// Strides that are still to be taken, before that kick; nobody sees the particles in between.
    due: Vec<Stride>,
    /// How many strides the force takes together, until something else changes than places and velocities.
    pub(crate) at_once: Option<usize>,
    /// The most strides that may be due.
    pub(crate) patience: usize,
    /// What rounding took from the positions, where the integrator knows it; else empty.
    pub(crate) remainder: Vec<Vector<D>>,
    /// Whether positions or velocities may have become something else than finite numbers.
    pub(crate) doubtful: bool,
    velocity_dependent: bool,
    estimate: Vec<Vector<D>>,
}

resume!(System<const D> {
    values: [boundary, particles, held, acceleration, fresh, owed, remainder],
    // Images are written down by the engine.
    set_up: [images, forces, contacts, due, at_once, patience, doubtful, velocity_dependent, estimate],
});

impl<const D: usize> System<D> {
    pub(crate) fn new(boundary: Boundary<D>, particles: Particles<D>, forces: Vec<Box<dyn Force<D>>>) -> Result<Self, Invalid> {
        let n = particles.len();
        let velocity_dependent = forces.iter().any(|force| force.depends_on_velocity());
        let mut system = Self {
            boundary,
            particles,
            images: vec![[0; D]; n],
            forces,
            held: vec![],
            acceleration: vec![Vector::ZERO; n],
            fresh: false,
            contacts: vec![],
            owed: None,
            due: vec![],
            at_once: None,
            patience: usize::MAX,
            remainder: vec![],
            doubtful: true,
            velocity_dependent,
            estimate: vec![],
        };
        system.admit()?;
        Ok(system)
    }

    /// Checks everything and brings the particles into the box, after somebody changed something.
    pub(crate) fn admit(&mut self) -> Result<(), Invalid> {
        self.boundary.validate()?;
        self.particles.validate()?;
        if self.particles.is_empty() {
            return Err(Invalid::new("particles", 0, "at least one"));
        }
        if !self.boundary.partitions.is_empty() {
            return Err(Invalid::new(
                "partitions",
                self.boundary.partitions.len(),
                "none: only the event-driven engine knows them; remove them or use it",
            ));
        }
        if !self.boundary.is_plain() {
            return Err(Invalid::new(
                "box",
                "a piston, obstacles, or faces that move, open or have a temperature",
                "none of these: only the event-driven engine knows them; remove them or use it",
            ));
        }
        let n = self.particles.len();
        self.images.resize(n, [0; D]);
        self.acceleration.resize(n, Vector::ZERO);
        for (i, (&r, &radius)) in self.particles.position.iter().zip(&self.particles.radius).enumerate() {
            for k in (0..D).filter(|&k| self.boundary.axes[k] == Axis::Walls) {
                let margin = radius * (1.0 - 1e-12);
                let (lower, upper) = (self.boundary.lower[k] + margin, self.boundary.upper[k] - margin);
                if !(lower <= r[k] && r[k] <= upper) {
                    return Err(Invalid::new(
                        format!("position of particle {i}"),
                        format!("{:?}", r.0),
                        format!("a centre between {lower} and {upper} along axis {k}"),
                    ));
                }
            }
        }
        if let Some(held) = self.held.iter().find(|held| held.particle >= n) {
            return Err(Invalid::new("particles", n, format!("enough of them for the one held, {}", held.particle)));
        }
        for i in 0..n {
            self.wrap(i);
        }
        (self.fresh, self.at_once) = (false, None);
        self.forces.iter().try_for_each(|force| force.validate(&self.boundary, &self.particles))
    }

    /// Accelerations at the present positions, unless they are known: the last ones of a step are the first of the next.
    ///
    /// Velocities lag behind positions by `lag` within a splitting step; forces that depend on velocity are shown the
    /// velocity extrapolated to the time of the positions, which keeps second order (Groot and Warren 1997,
    /// doi:10.1063/1.474784).
    pub(crate) fn accelerate(&mut self, time: f64, lag: f64) {
        if self.fresh {
            return;
        }
        self.catch_up();
        let extrapolate = self.velocity_dependent && lag != 0.0;
        if extrapolate {
            self.estimate.clear();
            self.estimate.extend(self.particles.velocity.iter().zip(&self.acceleration).map(|(&v, &a)| v + a * lag));
            std::mem::swap(&mut self.estimate, &mut self.particles.velocity);
        }
        if threads::are_worth_it(self.acceleration.len()) {
            self.acceleration.par_chunks_mut(CHUNK).for_each(|acceleration| acceleration.fill(Vector::ZERO));
        } else {
            self.acceleration.fill(Vector::ZERO);
        }
        for force in &mut self.forces {
            if self.remainder.is_empty() {
                force.accelerate(time, &self.boundary, &self.particles, &mut self.acceleration);
            } else {
                force.accelerate_precisely(time, &self.boundary, &self.particles, &self.remainder, &mut self.acceleration);
            }
        }
        if extrapolate {
            std::mem::swap(&mut self.estimate, &mut self.particles.velocity);
        }
        for held in &self.held {
            self.acceleration[held.particle][held.axis] = 0.0;
        }
        self.fresh = true;
    }

    /// `v += a dt`.
    pub(crate) fn kick(&mut self, dt: f64) {
        self.doubtful |= !motion::kick(&mut self.particles.velocity, &self.acceleration, dt);
    }

    /// [`accelerate`](Self::accelerate), and the [`kick`](Self::kick), put off until the next [`advance`](Self::advance) or
    /// [`settle`](Self::settle): the last kick of a step and the first of the next are by the same accelerations, and one pass over the
    /// memory does both, or finds the accelerations, too.
    pub(crate) fn owe_kick(&mut self, time: f64, lag: f64, kick: f64) {
        if self.strides_at_once() == 0 {
            self.accelerate(time, lag);
        }
        self.owed = Some(kick);
    }

    /// Drops what was put off.
    pub(crate) fn forget_owed(&mut self) {
        self.owed = None;
        self.due.clear();
    }

    /// Does what was put off.
    pub(crate) fn settle(&mut self, time: f64) {
        self.catch_up(); // who is told what went wrong asks `check`
        let Some(owed) = self.owed.take() else { return };
        if let Some(finite) = self.kick_alone(owed) {
            self.doubtful |= !finite;
        } else {
            self.accelerate(time, 0.0);
            self.kick(owed);
        }
    }

    /// A kick by the force itself, where it takes strides and nobody has found the accelerations.
    fn kick_alone(&mut self, dt: f64) -> Option<bool> {
        if self.fresh || self.strides_at_once() == 0 {
            return None;
        }
        let Self { boundary, particles, images, forces, held, .. } = self;
        strider(forces)?.kick(State { boundary, particles, images, held }, dt)
    }

    /// [`accelerate`](Self::accelerate), [`kick_and_drift`](Self::kick_and_drift), and [`hold`](Self::hold) at `end`: by the force
    /// itself where it takes strides, and several of these together where that is faster and nobody is to see what is between.
    pub(crate) fn advance(&mut self, time: f64, lag: f64, kick: f64, drift: f64, end: f64) -> bool {
        let at_once = if self.fresh { 0 } else { self.strides_at_once() };
        if at_once > 0 {
            self.due.push(Stride { moves: Moves { owed: self.owed.take(), kick, drift }, end, confined: false });
            return self.due.len() < at_once || self.catch_up();
        }
        self.accelerate(time, lag);
        let finite = self.kick_and_drift(kick, drift);
        self.hold(end);
        finite
    }

    /// Whether the next stride is likely to be put off.
    pub(crate) fn is_patient(&mut self) -> bool {
        !self.fresh && self.strides_at_once() > 1
    }

    /// How many strides the force takes together; 0 where none takes any.
    fn strides_at_once(&mut self) -> usize {
        let Self { boundary, particles, images, forces, held, .. } = self;
        let state = State { boundary, particles, images, held };
        let ask = || strider(forces).map_or(0, |strider| strider.strides_at_once(&state));
        (*self.at_once.get_or_insert_with(ask)).min(self.patience)
    }

    /// Takes the strides that are due. Tells whether all velocities were finite at the ends of the steps before.
    fn catch_up(&mut self) -> bool {
        if self.due.is_empty() {
            return true;
        }
        let mut due = std::mem::take(&mut self.due);
        let Self { boundary, particles, images, forces, held, .. } = self;
        let (mut finite, mut taken) = ([true; 2], 0);
        if let Some(strider) = strider(forces) {
            let progress = strider.stride(State { boundary, particles, images, held }, &due);
            (finite, taken) = (progress.finite, progress.taken);
        }
        self.doubtful |= finite != [true; 2];
        for stride in due.drain(..).skip(taken) {
            let taken = self.take(stride);
            finite[0] &= taken[0];
            if taken != [true; 2] {
                break; // all is lost, and whoever asks is told
            }
        }
        self.due = due;
        finite[0]
    }

    /// Takes a stride that the force did not take; what it depends on is positions alone.
    fn take(&mut self, Stride { moves, end, confined }: Stride) -> [bool; 2] {
        self.accelerate(end, 0.0);
        let finite = self.make(moves);
        self.hold(end);
        if confined {
            motion::wrap_all(&self.boundary, &mut self.particles.position, &mut self.images);
        }
        finite
    }

    /// `v += a kick`, then `r += v drift`, in one pass. Tells whether the kick put off before, if there was one, left every
    /// velocity a finite number.
    pub(crate) fn kick_and_drift(&mut self, kick: f64, drift: f64) -> bool {
        let moves = Moves { owed: self.owed.take(), kick, drift };
        self.make(moves)[0]
    }

    /// Kicks and drifts by the accelerations that are known; tells what [`kick_and_drift`](motion::kick_and_drift) does.
    fn make(&mut self, moves: Moves) -> [bool; 2] {
        let Particles { position, velocity, .. } = &mut self.particles;
        let finite = motion::kick_and_drift(position, velocity, &self.acceleration, moves);
        self.doubtful |= finite != [true; 2];
        self.fresh = false;
        finite
    }

    /// Puts held and driven coordinates where they have to be at `time`.
    pub(crate) fn hold(&mut self, time: f64) {
        for held in &self.held {
            held.apply(time, &mut self.particles);
            if let Some(remainder) = self.remainder.get_mut(held.particle) {
                remainder[held.axis] = 0.0;
            }
        }
    }

    /// The longest step of an adaptive integrator that cannot miss what forces and drives do.
    pub(crate) fn longest_step(&self) -> f64 {
        let forces = self.forces.iter().map(|force| force.longest_step());
        forces.chain(self.held.iter().map(Held::longest_step)).fold(f64::INFINITY, f64::min)
    }

    /// Brings particle `i` into the primary box and counts the faces it went through.
    fn wrap(&mut self, i: usize) {
        motion::wrap(&self.boundary, &mut self.particles.position[i], &mut self.images[i]);
    }

    /// Position of particle `i` on the path it took through the periodic images.
    pub(crate) fn unwrapped(&self, i: usize) -> Vector<D> {
        let side = self.boundary.extent();
        Vector::from_fn(|k| self.particles.position[i][k] + self.images[i][k] as f64 * side[k])
    }

    /// Puts particle `i` at a position given outside the box.
    pub(crate) fn set_unwrapped(&mut self, i: usize, position: Vector<D>) {
        self.particles.position[i] = position;
        self.images[i] = [0; D];
        self.wrap(i);
    }

    /// The first particle with a coordinate or velocity that is no longer a number. Searched for only when there is doubt.
    pub(crate) fn first_lost(&mut self) -> Option<usize> {
        if !std::mem::take(&mut self.doubtful) {
            return None;
        }
        (0..self.particles.len()).find(|&i| !(self.particles.position[i].is_finite() && self.particles.velocity[i].is_finite()))
    }

    /// Whether all positions and velocities, those at `time`, are numbers.
    pub(crate) fn check(&mut self, time: f64) -> Result<(), Failure> {
        self.first_lost().map_or(Ok(()), |i| {
            let overflow = || "position or velocity is no longer a number: a force overflowed".into();
            let cause = self.forces.iter().find_map(|force| force.complaint()).unwrap_or_else(overflow) + "; use a smaller dt";
            Err(Failure { time, particle: Some(i), cause })
        })
    }
}

/// The force that takes strides, where it is the only one.
fn strider<const D: usize>(forces: &mut [Box<dyn Force<D>>]) -> Option<&mut dyn Strider<D>> {
    let [force] = forces else { return None };
    force.strider()
}
