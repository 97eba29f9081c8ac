//! A hand on a running system: what it does there, so that the system stays a legal one.
//!
//! An action is done whole or not at all. It depends on nothing but the state it meets, so that doing it again at the same
//! time gives the same bits.

mod room;

use corpuscle_core::{Axis, Boundary, Engine, Face, Failure, Invalid, Particles, Partition, Random, Vector};
use corpuscle_event::EventDriven;
use corpuscle_time::TimeDriven;

use crate::probe::{self, Region};
use crate::tally::Tally;
use crate::{Action, Probed};

/// Stream of the random numbers that disturb velocities.
const DISTURBANCE: u64 = 0x6861_6e64;
/// Largest disturbance: an eighth of a turn.
const MOST_DISTURBED: f64 = 1.0;

/// What hands cannot do where an experiment knows its particles by number.
const EACH_IS_KNOWN: &str = "a system of a scenario file: this experiment knows each of its particles";
/// What boundaries need.
const NO_PISTON: &str = "a system with a piston";
const NO_WALLS: &str = "a box with walls";
const SOFT: &str = "hard particles: the walls of soft ones are no more than walls";

/// A copy of a measured system: a hand plays with it while the measurement goes on undisturbed. It is no result: a run that is
/// taken up again has none.
#[derive(Clone, Debug)]
pub(crate) struct InHand<const D: usize> {
    pub(crate) engine: EventDriven<D>,
    pub(crate) tally: Tally,
}

impl<const D: usize> InHand<D> {
    /// What is on show: the copy, or what is measured while there is none.
    pub(crate) fn on_show<'a>(held: Option<&'a Self>, engine: &'a EventDriven<D>) -> &'a EventDriven<D> {
        held.map_or(engine, |copy| &copy.engine)
    }

    /// Advances the copy, if there is one, to a time on the engine's clock.
    ///
    /// # Errors
    /// [`Failure`] of the engine.
    pub(crate) fn advance_any(held: &mut Option<Self>, to: f64) -> Result<(), Failure> {
        held.as_mut().map_or(Ok(()), |copy| copy.advance(to))
    }

    /// Does something to the copy, which is made from `engine` and its tally when there is none yet. Bodies keep their number.
    ///
    /// # Errors
    /// As [`on_hard`]; also to add or to remove bodies.
    pub(crate) fn act(held: &mut Option<Self>, engine: &EventDriven<D>, tally: &Tally, action: Action) -> Result<(), Invalid> {
        let copy = held.take();
        let mut copy = copy.unwrap_or_else(|| Self { engine: engine.clone(), tally: tally.clone() });
        let outcome = on_number(&mut copy.engine, action);
        *held = Some(copy);
        outcome
    }

    /// Lays a probe, or takes it up. It watches a copy, made when there is none yet, which goes on as what is measured does.
    pub(crate) fn lay(held: &mut Option<Self>, engine: &EventDriven<D>, corners: Option<[[f64; 2]; 2]>) {
        if held.is_some() || corners.is_some() {
            let copy = held.get_or_insert_with(|| Self { engine: engine.clone(), tally: Tally::default() });
            copy.tally.lay(corners.and_then(|corners| Region::lay(&copy.engine, corners)));
        }
    }

    /// What the probe has seen, if one was laid.
    pub(crate) fn probed(held: Option<&Self>) -> Option<Probed> {
        held.and_then(|copy| probe::read(&copy.engine, &copy.tally))
    }

    /// Advances to a time on the engine's clock.
    ///
    /// # Errors
    /// [`Failure`] of the engine.
    pub(crate) fn advance(&mut self, to: f64) -> Result<(), Failure> {
        self.engine.advance(to, &mut self.tally)
    }
}

/// What an action on hard particles would need that is not there.
pub(crate) fn wanting_of_hard<const D: usize>(engine: &EventDriven<D>, action: Action) -> Option<&'static str> {
    match action {
        Action::Push { .. } if engine.piston().is_none() => Some(NO_PISTON),
        Action::Heat { .. } if !engine.boundary().axes.contains(&Axis::Walls) => Some(NO_WALLS),
        _ => None,
    }
}

/// The same where an experiment knows each particle by its index.
pub(crate) fn wanting_of_number<const D: usize>(engine: &EventDriven<D>, action: Action) -> Option<&'static str> {
    match action {
        Action::Add { .. } | Action::Remove { .. } => Some(EACH_IS_KNOWN),
        _ => wanting_of_hard(engine, action),
    }
}

/// What an action on soft particles would need.
pub(crate) fn wanting_of_soft(action: Action) -> Option<&'static str> {
    let on_walls = matches!(action, Action::Partition { .. } | Action::OpenPartitions | Action::Heat { .. } | Action::Push { .. });
    on_walls.then_some(SOFT)
}

/// The same where each particle is known.
pub(crate) fn wanting_of_soft_number(action: Action) -> Option<&'static str> {
    match action {
        Action::Add { .. } | Action::Remove { .. } => Some(EACH_IS_KNOWN),
        _ => wanting_of_soft(action),
    }
}

/// Does something to hard particles of which an experiment knows each by its index.
///
/// # Errors
/// As [`on_hard`]; also to add or to remove particles.
pub(crate) fn on_number<const D: usize>(engine: &mut EventDriven<D>, action: Action) -> Result<(), Invalid> {
    if let Some(expected) = wanting_of_number(engine, action) {
        return action.refused(expected);
    }
    on_hard(engine, action)
}

/// Does something to hard particles.
///
/// # Errors
/// [`Invalid`] when it makes no sense here, or there is no legal place; the system is then as it was.
pub(crate) fn on_hard<const D: usize>(engine: &mut EventDriven<D>, action: Action) -> Result<(), Invalid> {
    match action {
        Action::Reverse => engine.reverse_velocities(),
        Action::Disturb { strength, seed } => {
            let strength = disturbance(strength)?;
            engine.set_velocities(|i, velocity| *velocity = disturbed(*velocity, strength, seed, i));
        }
        Action::Place { body, at } => {
            let particles = engine.snapshot();
            index(body, &particles)?;
            let place = free_place(&present(engine), engine.time(), &particles, body, vector(at)?)?;
            engine.shift_position(body, engine.boundary().displacement(particles.position[body], place))?;
            if engine.piston().is_some() {
                // It may have been carried across: the piston looks again who is on which side.
                engine.set_boundary(present(engine))?;
            }
        }
        Action::Throw { body, velocity } => {
            index(body, &engine.snapshot())?;
            let thrown = vector(velocity)?;
            engine.set_velocities(|i, velocity| {
                if i == body {
                    *velocity = thrown;
                }
            });
        }
        Action::Partition { axis, at, hole } => return partition(engine, axis, at, hole),
        Action::OpenPartitions => {
            if engine.boundary().partitions.is_empty() {
                return action.refused("a box with a partition");
            }
            engine.set_boundary(Boundary { partitions: vec![], ..present(engine) })?;
        }
        Action::Heat { axis, upper, temperature } => {
            let mut boundary = present(engine);
            let faces = boundary.faces.get_mut(axis).ok_or_else(|| Invalid::new("axis", axis, format!("below {D}")))?;
            let face = &mut faces[usize::from(upper)];
            *face = Face { temperature, ..face.clone() };
            engine.set_boundary(boundary)?;
        }
        Action::Push { velocity } => {
            let mut boundary = present(engine);
            let Some(piston) = &mut boundary.piston else { return action.refused(NO_PISTON) };
            piston.velocity = vector::<D>(velocity)?[piston.axis];
            engine.set_boundary(boundary)?;
        }
        Action::Add { at, velocity, like } => {
            let particles = added(&present(engine), engine.time(), engine.snapshot(), at, velocity, like)?;
            engine.set_particles(&particles)?;
        }
        Action::Remove { body } => engine.set_particles(&without(engine.snapshot(), body)?)?,
    }
    Ok(())
}

/// Does something to soft particles, whose walls are no more than walls.
///
/// # Errors
/// As [`on_hard`].
pub(crate) fn on_soft<const D: usize>(engine: &mut TimeDriven<D>, action: Action) -> Result<(), Invalid> {
    match action {
        Action::Reverse => engine.edit(|particles| particles.velocity.iter_mut().for_each(|v| *v = -*v)),
        Action::Disturb { strength, seed } => {
            let strength = disturbance(strength)?;
            engine.edit(|particles| {
                let velocities = particles.velocity.iter_mut().enumerate();
                velocities.for_each(|(i, velocity)| *velocity = disturbed(*velocity, strength, seed, i));
            })
        }
        Action::Place { body, at } => {
            let particles = engine.particles();
            index(body, particles)?;
            let place = free_place(engine.boundary(), engine.time(), particles, body, vector(at)?)?;
            engine.edit(|particles| particles.position[body] = place)
        }
        Action::Throw { body, velocity } => {
            index(body, engine.particles())?;
            let thrown = vector(velocity)?;
            engine.edit(|particles| particles.velocity[body] = thrown)
        }
        Action::Add { at, velocity, like } => {
            let more = added(engine.boundary(), engine.time(), engine.snapshot(), at, velocity, like)?;
            engine.edit(|particles| *particles = more)
        }
        Action::Remove { body } => {
            let fewer = without(engine.snapshot(), body)?;
            engine.edit(|particles| *particles = fewer)
        }
        Action::Partition { .. } | Action::OpenPartitions | Action::Heat { .. } | Action::Push { .. } => action.refused(SOFT),
    }
}

/// The box as it is now, its piston included.
fn present<const D: usize>(engine: &EventDriven<D>) -> Boundary<D> {
    Boundary { piston: engine.piston(), ..engine.boundary().clone() }
}

/// Puts a plate across the box; particles that it would cut make room.
fn partition<const D: usize>(engine: &mut EventDriven<D>, axis: usize, at: f64, hole: Option<f64>) -> Result<(), Invalid> {
    if axis >= D {
        return Err(Invalid::new("axis", axis, format!("below {D}")));
    }
    let mut boundary = present(engine);
    let mut plate = Partition::new(axis, at);
    if let Some(width) = hole {
        let along = (axis + 1) % D;
        let middle = 0.5 * (boundary.lower[along] + boundary.upper[along]);
        plate = plate.with_hole(along, middle - 0.5 * width, middle + 0.5 * width);
    }
    boundary.partitions.push(plate);
    boundary.validate()?;
    let before = engine.clone();
    let outcome = make_room(engine, &boundary).and_then(|()| engine.set_boundary(boundary));
    if outcome.is_err() {
        *engine = before;
    }
    outcome
}

/// Moves particles that do not fit into a new box to where they do.
fn make_room<const D: usize>(engine: &mut EventDriven<D>, boundary: &Boundary<D>) -> Result<(), Invalid> {
    let mut particles = engine.snapshot();
    let time = engine.time();
    for i in 0..particles.len() {
        let place = free_place(boundary, time, &particles, i, particles.position[i])?;
        if place != particles.position[i] {
            engine.shift_position(i, engine.boundary().displacement(particles.position[i], place))?;
            particles.position[i] = place;
        }
    }
    Ok(())
}

/// The particles with one more, like one of them, at rest or thrown.
fn added<const D: usize>(
    boundary: &Boundary<D>,
    time: f64,
    mut particles: Particles<D>,
    at: [f64; 3],
    velocity: [f64; 3],
    like: usize,
) -> Result<Particles<D>, Invalid> {
    index(like, &particles)?;
    let (mass, radius, species) = (particles.mass[like], particles.radius[like], particles.species[like]);
    let newcomer = particles.push(vector(at)?, vector(velocity)?, mass, radius, species);
    particles.position[newcomer] = free_place(boundary, time, &particles, newcomer, particles.position[newcomer])?;
    Ok(particles)
}

/// The particles without one of them.
fn without<const D: usize>(mut particles: Particles<D>, body: usize) -> Result<Particles<D>, Invalid> {
    index(body, &particles)?;
    if particles.len() == 1 {
        return Err(Invalid::new("action", "remove", "a system that keeps at least one particle"));
    }
    particles.position.remove(body);
    particles.velocity.remove(body);
    particles.mass.remove(body);
    particles.radius.remove(body);
    particles.species.remove(body);
    Ok(particles)
}

/// The legal place nearest to the one asked for.
fn free_place<const D: usize>(
    boundary: &Boundary<D>,
    time: f64,
    particles: &Particles<D>,
    body: usize,
    at: Vector<D>,
) -> Result<Vector<D>, Invalid> {
    let place = room::nearest(boundary, time, particles, body, at);
    place.ok_or_else(|| Invalid::new("place", format!("{:?}", at.0), "a place with room for the particle in it or nearby"))
}

fn index<const D: usize>(body: usize, particles: &Particles<D>) -> Result<(), Invalid> {
    if body < particles.len() { Ok(()) } else { Err(Invalid::new("body", body, format!("an index below {}", particles.len()))) }
}

fn vector<const D: usize>(components: [f64; 3]) -> Result<Vector<D>, Invalid> {
    let vector = Vector::from_fn(|k| components[k]);
    if vector.is_finite() { Ok(vector) } else { Err(Invalid::new("place", format!("{components:?}"), "finite numbers")) }
}

fn disturbance(strength: f64) -> Result<f64, Invalid> {
    if strength > 0.0 && strength <= MOST_DISTURBED {
        Ok(strength)
    } else {
        Err(Invalid::new("disturbance", strength, format!("a number above 0, at most {MOST_DISTURBED}")))
    }
}

/// A velocity turned by an angle of about `strength`: `v' = |v| u / |u|` with `u = v / |v| + strength xi` and normal numbers `xi`.
/// Its length, and so the energy, stays.
fn disturbed<const D: usize>(v: Vector<D>, strength: f64, seed: u64, i: usize) -> Vector<D> {
    let speed = v.norm();
    if speed == 0.0 {
        return v;
    }
    let mut random = Random::at(seed, DISTURBANCE, 0, i as u64);
    let u = v * (1.0 / speed) + Vector::from_fn(|_| strength * random.normal());
    let length = u.norm();
    if length > 0.0 { u * (speed / length) } else { v }
}

#[cfg(test)]
mod tests;
