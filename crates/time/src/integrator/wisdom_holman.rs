//! Planets around one heavy star: Kepler orbits, and kicks by the other planets.
//!
//! Wisdom and Holman 1991 (doi:10.1086/115978) in democratic heliocentric coordinates (Duncan, Levison and Lee 1998,
//! doi:10.1086/300541): places from the star, velocities from the centre of mass. The energy falls into Kepler's for each planet,
//! the star's own motion `|sum m u|^2/(2 m_0)`, and that of the planets' attraction; each moves the planets exactly.

use corpuscle_core::{Failure, Invalid, Vector};

use super::kepler::kepler;
use crate::system::System;

/// The map with its working memory.
#[derive(Default)]
pub(crate) struct WisdomHolman<const D: usize> {
    /// Index of the star, the heaviest body.
    star: usize,
    /// `G m_0`.
    pull: f64,
    mass: f64,
    place: Vec<Vector<D>>,
    velocity: Vec<Vector<D>>,
}

impl<const D: usize> WisdomHolman<D> {
    /// Finds the star.
    pub(crate) fn admit(&mut self, system: &System<D>) -> Result<(), Invalid> {
        let refuse = |value: &str, expected: &str| Err(Invalid::new("forces with wisdom-holman", value, expected));
        let [force] = system.forces.as_slice() else {
            return refuse(&format!("{} of them", system.forces.len()), "gravity alone");
        };
        let Some(constant) = force.point_gravity() else {
            return refuse(force.name(), "gravity that is not softened: orbits around the star are Kepler's");
        };
        if !system.held.is_empty() {
            return Err(Invalid::new("held particles", system.held.len(), "none with wisdom-holman: the star moves as it has to"));
        }
        let masses = &system.particles.mass;
        self.star = (0..masses.len()).fold(0, |heaviest, i| if masses[i] > masses[heaviest] { i } else { heaviest });
        self.pull = constant * masses[self.star];
        self.mass = masses.iter().sum();
        Ok(())
    }

    pub(crate) fn step(&mut self, system: &mut System<D>, start: f64, end: f64, dt: f64) -> Result<(), Failure> {
        system.accelerate(start, 0.0);
        let centre = centre(&system.particles.mass, &system.particles.position, self.mass);
        let drift = system.particles.momentum() / self.mass;
        let origin = system.particles.position[self.star];
        self.place.clear();
        self.place.extend(system.particles.position.iter().map(|&r| r - origin));
        self.velocity.clear();
        self.velocity.extend(system.particles.velocity.iter().map(|&v| v - drift));
        self.kick(system, 0.5 * dt);
        self.follow_star(&system.particles.mass, 0.5 * dt);
        for i in (0..self.place.len()).filter(|&i| i != self.star) {
            let Some(orbit) = kepler(self.pull, self.place[i], self.velocity[i], dt) else {
                let cause = "its orbit leads through the star: use gauss-radau-15, which resolves the encounter".to_owned();
                return Err(Failure { time: end, particle: Some(i), cause });
            };
            (self.place[i], self.velocity[i]) = orbit;
        }
        self.follow_star(&system.particles.mass, 0.5 * dt);
        // The centre of mass moves uniformly; the star is where that leaves it.
        let origin = centre + drift * dt - self::centre(&system.particles.mass, &self.place, self.mass);
        for (r, &place) in system.particles.position.iter_mut().zip(&self.place) {
            *r = place + origin;
        }
        (system.fresh, system.doubtful) = (false, true);
        system.accelerate(end, 0.0);
        self.kick(system, 0.5 * dt);
        self.velocity[self.star] = Vector::ZERO;
        self.velocity[self.star] = self.momentum(&system.particles.mass) * (-1.0 / system.particles.mass[self.star]);
        for (v, &velocity) in system.particles.velocity.iter_mut().zip(&self.velocity) {
            *v = velocity + drift;
        }
        Ok(())
    }

    /// The pull of all but the star.
    fn kick(&mut self, system: &System<D>, dt: f64) {
        for i in (0..self.place.len()).filter(|&i| i != self.star) {
            let r = self.place[i];
            let distance = r.norm();
            self.velocity[i] += (system.acceleration[i] + r * (self.pull / (distance * distance * distance))) * dt;
        }
    }

    /// Places are seen from the star, which moves against the planets' momentum.
    fn follow_star(&mut self, mass: &[f64], dt: f64) {
        self.velocity[self.star] = Vector::ZERO;
        let step = self.momentum(mass) * (dt / mass[self.star]);
        for i in (0..self.place.len()).filter(|&i| i != self.star) {
            self.place[i] += step;
        }
    }

    fn momentum(&self, mass: &[f64]) -> Vector<D> {
        self.velocity.iter().zip(mass).fold(Vector::ZERO, |sum, (&v, &m)| sum + v * m)
    }
}

fn centre<const D: usize>(mass: &[f64], place: &[Vector<D>], total: f64) -> Vector<D> {
    place.iter().zip(mass).fold(Vector::ZERO, |sum, (&r, &m)| sum + r * m) / total
}
