//! The time-driven engine.

use std::ops::ControlFlow;

use corpuscle_core::{Axis, Boundary, Engine, Failure, Invalid, Observer, Particles, Vector};

use crate::constraint::{Drive, Held, Pin};
use crate::force::{Force, Tensor, add_product};
use crate::integrator::{Integrator, Link, Stepper};
use crate::system::System;
use crate::threads;

/// A caller's time may fall short of the end of a step by this share of it: the rounding of the caller's sums.
const GUARD: f64 = 1e-6;
/// A state is kept every so many steps; a failure is answered by going back to it and repeating the good steps.
const KEPT_EVERY: u64 = 128;

/// Particles under forces, advanced in steps of time.
///
/// With a fixed step `dt` the time is `steps * dt`: [`advance`](Engine::advance) takes every whole step that ends at or
/// before the time asked for, never a part of one, and [`time`](Engine::time) is the end of the last. The adaptive
/// integrator goes past the time asked for and reports the state in between from its polynomial. Either way the
/// trajectory's bits do not depend on where callers stop.
///
/// The engine only follows forces: two fast particles with a hard, narrow potential can pass through each other within a
/// step. Where that must not happen, use the event-driven engine.
pub struct TimeDriven<const D: usize> {
    pub(crate) system: System<D>,
    pub(crate) integrator: Integrator,
    pub(crate) stepper: Stepper<D>,
    pub(crate) steps: u64,
    pub(crate) time: f64,
    pub(crate) kept: Kept<D>,
}

/// What is needed to repeat steps from.
#[derive(Default)]
pub(crate) struct Kept<const D: usize> {
    steps: u64,
    position: Vec<Vector<D>>,
    velocity: Vec<Vector<D>>,
    /// Where there is a periodic axis.
    images: Vec<[i64; D]>,
    /// Where they are those of these positions.
    acceleration: Vec<Vector<D>>,
    links: Vec<Link>,
    fresh: bool,
}

impl<const D: usize> TimeDriven<D> {
    /// A system at time zero. Positions outside a periodic box are wrapped into it.
    ///
    /// # Errors
    /// Names what cannot be used: numbers, particles outside walls, a force that does not fit the box or the masses, a
    /// box with partitions (the event-driven engine has them), hard walls with the adaptive integrator.
    pub fn new(
        boundary: Boundary<D>,
        particles: Particles<D>,
        forces: Vec<Box<dyn Force<D>>>,
        integrator: Integrator,
    ) -> Result<Self, Invalid> {
        integrator.validate()?;
        let system = System::new(boundary, particles, forces)?;
        let mut engine = Self { system, integrator, stepper: integrator.stepper(), steps: 0, time: 0.0, kept: Kept::default() };
        engine.restart()?;
        Ok(engine)
    }

    /// Holds coordinates fixed.
    ///
    /// # Errors
    /// When a pin names a particle that does not exist.
    pub fn with_pins(mut self, pins: Vec<Pin<D>>) -> Result<Self, Invalid> {
        for pin in pins {
            for axis in (0..D).filter(|&axis| pin.axes[axis]) {
                self.system.held.push(Held::new(pin.particle, axis, None, self.time, &self.system.particles)?);
            }
        }
        self.system.held.sort_by_key(|held| held.particle);
        self.restart()?;
        Ok(self)
    }

    /// Moves coordinates as prescribed.
    ///
    /// # Errors
    /// When a drive names a particle or an axis that does not exist, a periodic axis, or a signal that makes no sense.
    pub fn with_drives(mut self, drives: Vec<Drive>) -> Result<Self, Invalid> {
        for drive in drives {
            if drive.axis < D && self.system.boundary.axes[drive.axis] == Axis::Periodic {
                return Err(Invalid::new("drive along axis", drive.axis, "an axis that is not periodic"));
            }
            let signal = Some(drive.signal);
            self.system.held.push(Held::new(drive.particle, drive.axis, signal, self.time, &self.system.particles)?);
        }
        self.system.held.sort_by_key(|held| held.particle);
        self.restart()?;
        Ok(self)
    }

    /// The particles at [`time`](Engine::time), wrapped into the box along periodic axes.
    pub fn particles(&self) -> &Particles<D> {
        &self.system.particles
    }

    /// The box.
    pub fn boundary(&self) -> &Boundary<D> {
        &self.system.boundary
    }

    /// Steps taken, of whatever length.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// The integrator.
    pub fn integrator(&self) -> Integrator {
        self.integrator
    }

    /// Kinetic energy `sum m v^2 / 2`.
    pub fn kinetic_energy(&self) -> f64 {
        self.system.particles.kinetic_energy()
    }

    /// Potential energy of all forces.
    pub fn potential_energy(&self) -> f64 {
        self.energies().iter().map(|(_, energy)| energy).sum()
    }

    /// Potential energy of each force, with its name, in the order the forces were given.
    pub fn energies(&self) -> Vec<(&'static str, f64)> {
        let System { boundary, particles, forces, .. } = &self.system;
        forces.iter().map(|force| (force.name(), force.energy(self.time, boundary, particles))).collect()
    }

    /// Kinetic plus potential energy.
    pub fn energy(&self) -> f64 {
        self.kinetic_energy() + self.potential_energy()
    }

    /// What the equations of motion conserve: [`energy`](Self::energy) and, with a Nose-Hoover chain, what its links hold,
    /// `sum Q_k v_k^2/2 + f k T eta_1 + k T (eta_2 + ... + eta_M)`. Other thermostats exchange heat that is not counted.
    pub fn conserved_energy(&self) -> f64 {
        self.energy() + self.bath_energy()
    }

    /// What the links of a Nose-Hoover chain hold; zero of all other integrators.
    pub fn bath_energy(&self) -> f64 {
        self.stepper.energy()
    }

    /// Total momentum.
    pub fn momentum(&self) -> Vector<D> {
        self.system.particles.momentum()
    }

    /// Total angular momentum about the origin; a planar system fills the last component.
    pub fn angular_momentum(&self) -> [f64; 3] {
        self.system.particles.angular_momentum()
    }

    /// Virial `W = sum over pairs of r_ij . F_ij` of the forces between particles: `P V = (2 E_kin + W) / D`.
    pub fn virial(&self) -> f64 {
        let System { boundary, particles, forces, .. } = &self.system;
        forces.iter().map(|force| force.virial(self.time, boundary, particles)).sum()
    }

    /// Pressure tensor `P_ab = (sum m v_a v_b + sum over pairs of r_a F_b)/V` with the volume of the box (Irving and Kirkwood 1950,
    /// doi:10.1063/1.1747782); its trace over `D` is the pressure. `None` where a force does not know its virial tensor, as the
    /// tree's.
    pub fn pressure_tensor(&self) -> Option<Tensor<D>> {
        let System { boundary, particles, forces, .. } = &self.system;
        let mut tensor = [[0.0; D]; D];
        for (&v, &m) in particles.velocity.iter().zip(&particles.mass) {
            add_product(&mut tensor, v, v * m);
        }
        for force in forces {
            let virial = force.virial_tensor(self.time, boundary, particles)?;
            for k in 0..D {
                for l in 0..D {
                    tensor[k][l] += virial[k][l];
                }
            }
        }
        let volume = boundary.volume();
        Some(tensor.map(|row| row.map(|sum| sum / volume)))
    }

    /// How often particle `i` went through the upper minus the lower
    /// face of each periodic axis.
    pub fn images(&self, i: usize) -> [i64; D] {
        self.system.images[i]
    }

    /// Position of particle `i` on its continuous path through the periodic images.
    pub fn unwrapped(&self, i: usize) -> Vector<D> {
        self.system.unwrapped(i)
    }

    /// Changes particles between steps: reverses velocities, perturbs, adds or removes some. Held coordinates are held
    /// where the change put them.
    ///
    /// # Errors
    /// When the result cannot be used; nothing is then changed.
    pub fn edit(&mut self, change: impl FnOnce(&mut Particles<D>)) -> Result<(), Invalid> {
        let (particles, images, held) = (self.system.particles.clone(), self.system.images.clone(), self.system.held.clone());
        change(&mut self.system.particles);
        let result = self.system.admit();
        if result.is_ok() {
            for held in &mut self.system.held {
                held.settle(self.time, &self.system.particles);
            }
            return self.restart();
        }
        (self.system.particles, self.system.images, self.system.held) = (particles, images, held);
        self.system.admit()?;
        result
    }

    /// Replaces the box: removes a wall, moves one away.
    ///
    /// # Errors
    /// When the particles or forces do not fit the new box; nothing is then changed.
    pub fn set_boundary(&mut self, boundary: Boundary<D>) -> Result<(), Invalid> {
        let before = std::mem::replace(&mut self.system.boundary, boundary);
        let (position, images) = (self.system.particles.position.clone(), self.system.images.clone());
        let result = self.system.admit().and_then(|()| self.restart());
        if result.is_err() {
            self.system.boundary = before;
            (self.system.particles.position, self.system.images) = (position, images);
            self.restart()?;
        }
        result
    }

    /// Makes the present state the one to go on from.
    fn restart(&mut self) -> Result<(), Invalid> {
        (self.system.fresh, self.system.at_once) = (false, None);
        self.system.hold(self.time);
        self.stepper.restart(&mut self.system, self.time, self.integrator.name())?;
        self.keep();
        Ok(())
    }

    pub(crate) fn keep(&mut self) {
        let System { boundary, particles, images, acceleration, fresh, .. } = &self.system;
        self.kept.steps = self.steps;
        self.kept.position.clone_from(&particles.position);
        self.kept.velocity.clone_from(&particles.velocity);
        if boundary.axes.contains(&Axis::Periodic) {
            self.kept.images.clone_from(images);
        }
        self.kept.fresh = *fresh;
        if *fresh {
            self.kept.acceleration.clone_from(acceleration);
        }
        self.kept.links.clear();
        self.kept.links.extend_from_slice(self.stepper.links());
    }

    fn restore(&mut self) {
        let System { boundary, particles, images, acceleration, fresh, .. } = &mut self.system;
        self.steps = self.kept.steps;
        particles.position.clone_from(&self.kept.position);
        particles.velocity.clone_from(&self.kept.velocity);
        if boundary.axes.contains(&Axis::Periodic) {
            images.clone_from(&self.kept.images);
        }
        *fresh = self.kept.fresh;
        if *fresh {
            acceleration.clone_from(&self.kept.acceleration);
        }
        self.stepper.set_links(&self.kept.links);
        self.system.forget_owed();
    }

    /// Every whole step of length `dt` up to `to`.
    fn advance_fixed<O: Observer<D>>(&mut self, dt: f64, to: f64, observer: &mut O) -> Result<(), Failure> {
        let last = (to / dt + GUARD).floor();
        while (self.steps as f64) < last {
            if self.step_kept(dt).is_err() {
                self.repeat(self.steps + 1, dt)?;
            }
            let mut flow = ControlFlow::Continue(());
            for contact in self.system.contacts.drain(..) {
                if observer.contact(&contact).is_break() {
                    flow = ControlFlow::Break(());
                }
            }
            if flow.is_break() {
                break;
            }
        }
        self.settle().or_else(|_| self.repeat(self.steps, dt))
    }

    /// Steps taken together fail together: taken again one by one, up to the one of this number, the first that fails tells so. The
    /// last good state is left then.
    fn repeat(&mut self, steps: u64, dt: f64) -> Result<(), Failure> {
        self.system.patience = 1;
        let outcome = self.one_by_one(steps, dt).or_else(|failure| self.go_back(failure, dt));
        self.system.patience = usize::MAX;
        self.system.contacts.clear();
        outcome
    }

    /// From the state that was kept last.
    fn one_by_one(&mut self, steps: u64, dt: f64) -> Result<(), Failure> {
        self.restore();
        self.time = self.steps as f64 * dt;
        while self.steps < steps {
            self.step_fixed(dt)?;
            self.settle()?; // so that it does not depend on who stops where whom a failure names
        }
        Ok(())
    }

    fn go_back(&mut self, failure: Failure, dt: f64) -> Result<(), Failure> {
        // What went wrong may be a kick put off from the last step.
        let good = self.steps - u64::from(failure.time <= self.time);
        self.restore();
        self.time = self.steps as f64 * dt;
        while self.steps < good {
            self.step_fixed(dt)?;
        }
        self.settle()?;
        Err(failure)
    }

    /// One step, from a state that is kept every now and then.
    fn step_kept(&mut self, dt: f64) -> Result<(), Failure> {
        if self.steps.is_multiple_of(KEPT_EVERY) {
            self.settle()?;
            self.keep();
        }
        self.step_fixed(dt)
    }

    fn step_fixed(&mut self, dt: f64) -> Result<(), Failure> {
        let (start, end) = (self.steps as f64 * dt, (self.steps + 1) as f64 * dt);
        let (stepper, system) = (&mut self.stepper, &mut self.system);
        if threads::are_worth_it(system.particles.len()) && !system.is_patient() {
            threads::kept_awake(|| stepper.step(system, start, end, dt))?;
        } else {
            stepper.step(system, start, end, dt)?;
        }
        system.check(end)?;
        self.steps += 1;
        self.time = end;
        Ok(())
    }

    /// Does the kick that the last step put off.
    fn settle(&mut self) -> Result<(), Failure> {
        self.system.settle(self.time);
        self.system.check(self.time)
    }
}

impl<const D: usize> Engine<D> for TimeDriven<D> {
    fn time(&self) -> f64 {
        self.time
    }

    fn advance<O: Observer<D>>(&mut self, to: f64, observer: &mut O) -> Result<(), Failure> {
        let Stepper::Adaptive(method) = &mut self.stepper else {
            let dt = self.integrator.dt().unwrap_or(f64::INFINITY);
            return self.advance_fixed(dt, to, observer);
        };
        if to <= self.time {
            return Ok(());
        }
        let mut outcome = Ok(());
        while method.reached() < to && outcome.is_ok() {
            outcome = method.step(&mut self.system);
            self.steps += u64::from(outcome.is_ok());
        }
        self.time = to.min(method.reached());
        method.interpolate(&mut self.system, self.time);
        outcome
    }

    fn snapshot_into(&self, particles: &mut Particles<D>) {
        particles.clone_from(&self.system.particles);
    }
}
