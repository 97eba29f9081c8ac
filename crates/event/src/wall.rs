//! A particle meets what is no particle: when, and what comes of it.

use corpuscle_core::{Contact, Invalid, Random, Vector};

use crate::Rules;
use crate::engine::EventDriven;
use crate::law::Law;

/// Stands for the piston where a plan names a surface.
pub(crate) const PISTON: u32 = u32::MAX;

/// The earliest contact found.
#[derive(Clone, Copy)]
struct Earliest {
    time: f64,
    surface: u32,
}

impl<const D: usize> EventDriven<D> {
    /// Whether there is anything but particles.
    #[inline]
    pub(crate) fn has_surfaces(&self) -> bool {
        !self.surfaces.is_empty() || self.piston.is_some()
    }

    /// Refuses a particle that lies on a surface, pressed against it by the field: it would touch it without end at one instant.
    pub(crate) fn refuse_lasting_contacts(&self) -> Result<(), Invalid> {
        if self.rules.field == Vector::ZERO {
            return Ok(());
        }
        for (id, &i) in self.slots.iter().enumerate() {
            let (flight, time) = (&self.flights[i as usize], self.epoch + self.now);
            let carries = |number: u32| self.surfaces.get(number).carries(flight, self.rules.field, time);
            let by_an_obstacle = || match self.neighbours.region(i as usize) {
                _ if !self.surfaces.has_obstacles() => false,
                Some(region) => self.surfaces.obstacles_near(region).iter().copied().any(carries),
                None => self.surfaces.obstacles().any(carries),
            };
            if self.surfaces.everywhere().any(carries) || by_an_obstacle() {
                return Err(Invalid::new(
                    format!("velocity of particle {id}"),
                    format!("{:?}", flight.velocity.0),
                    "a velocity off the wall or obstacle it touches, against which the field presses it, or a place off that: \
                     hard particles bounce and do not lie",
                ));
            }
        }
        Ok(())
    }

    /// The state of a particle has changed: plans its next contact with a surface or the piston.
    pub(crate) fn plan_surface(&mut self, i: usize) {
        let mut earliest = Earliest { time: f64::INFINITY, surface: 0 };
        self.consider_surfaces(i, self.surfaces.everywhere(), &mut earliest);
        if self.surfaces.has_obstacles() {
            self.consider_obstacles(i, &mut earliest);
        }
        let (id, field) = (self.id(i), self.rules.field);
        if let Some(piston) = &mut self.piston {
            let time = piston.contact_with(id, &self.flights[i], field);
            if time < earliest.time {
                earliest = Earliest { time, surface: PISTON };
            }
        }
        (self.plans[i].surface_time, self.met[i]) = (earliest.time.max(self.now), earliest.surface);
    }

    /// A particle has come into another region: it may meet an obstacle there before what it had planned.
    #[inline]
    pub(crate) fn plan_obstacles(&mut self, i: usize) {
        if self.surfaces.has_obstacles() {
            let mut earliest = Earliest { time: self.plans[i].surface_time, surface: self.met[i] };
            self.consider_obstacles(i, &mut earliest);
            (self.plans[i].surface_time, self.met[i]) = (earliest.time.max(self.now), earliest.surface);
        }
    }

    fn consider_obstacles(&self, i: usize, earliest: &mut Earliest) {
        match self.neighbours.region(i) {
            Some(region) => self.consider_surfaces(i, self.surfaces.obstacles_near(region).iter().copied(), earliest),
            None => self.consider_surfaces(i, self.surfaces.obstacles(), earliest),
        }
    }

    #[inline]
    fn consider_surfaces(&self, i: usize, numbers: impl Iterator<Item = u32>, earliest: &mut Earliest) {
        let flight = &self.flights[i];
        for surface in numbers {
            let time = flight.time + self.surfaces.get(surface).contact_delay(flight, self.rules.field, self.epoch);
            if time < earliest.time {
                *earliest = Earliest { time, surface };
            }
        }
    }

    /// Executes the planned contact with a surface or the piston. None when the plan was obsolete, and is made anew.
    pub(crate) fn touch<L: Law>(&mut self, i: usize) -> Option<Contact<D>> {
        let surface = self.met[i];
        if surface != PISTON {
            return Some(self.bounce::<L>(i, surface));
        }
        if self.piston.as_ref().is_some_and(|piston| piston.is_known_to(self.id(i))) {
            return self.push_piston::<L>(i);
        }
        self.counts.stale += 1;
        self.plan_surface(i);
        self.calendar.schedule(i as u32, self.plans[i].due());
        None
    }

    /// A particle touches a surface: `J = (1 + e) m (v.k - u)` where the surface moves at `u` along `k`, so that an elastic
    /// wall gives `v' = 2 u - v`.
    fn bounce<L: Law>(&mut self, i: usize, number: u32) -> Contact<D> {
        self.counts.wall_collisions += 1;
        self.count_stuck(i);
        self.settle(i);
        let (surface, time) = (self.surfaces.get(number), self.epoch + self.now);
        let flight = &mut self.flights[i];
        surface.align(flight, time);
        let (distance, radius) = (surface.distance(flight.position, time), surface.radius());
        let (with, temperature, u) = (surface.meeting, surface.temperature, surface.velocity(time));
        let (before, mass) = (flight.velocity, self.plans[i].mass);
        // With the arrow in place of a rounded unit vector, as between particles.
        let arrow = surface.arrow(flight.position);
        let length = arrow.norm();
        let k = arrow / length;
        let impulse = if let Some(temperature) = temperature {
            let after = self.thermal_velocity(i, temperature, k, u);
            self.flights[i].velocity = after;
            mass * (before - after).dot(k)
        } else {
            let approach = before.dot(arrow) / length - u;
            let e = self.rules.restitution_at(approach, [self.flights[i].radius, radius], mass);
            let change = ((1.0 + e) * (before.dot(arrow) / arrow.norm_squared() - u / length)).max(0.0);
            self.flights[i].velocity = before - arrow * change;
            mass * change * length
        };
        self.stamp(i);
        let contact = Contact { time, first: self.party(i, before), with, normal: k, impulse, distance };
        self.plan_and_schedule::<L>(i);
        contact
    }

    /// The velocity with which a particle leaves a wall of temperature `kT` with the normal `k` towards it, moving at `u`
    /// along that: the tangential components are Gaussian with variance `kT/m`, the normal one has the density
    /// `(m v / kT) exp(-m v^2 / 2 kT)` of those that cross a plane in a gas in equilibrium.
    fn thermal_velocity(&mut self, i: usize, temperature: f64, k: Vector<D>, u: f64) -> Vector<D> {
        let id = self.id(i);
        let spread = (temperature / self.plans[i].mass).sqrt();
        let contacts = &mut self.thermal_contacts[id];
        let mut random = Random::at(self.rules.seed, Rules::<D>::THERMAL, u64::from(*contacts), id as u64);
        *contacts = contacts.wrapping_add(1);
        let normal = spread * (-2.0 * libm::log(random.uniform())).sqrt();
        let tangential = Vector::from_fn(|axis| if k[axis] == 0.0 { spread * random.normal() } else { 0.0 });
        tangential + k * (u - normal)
    }

    /// One number a particle where there are walls with a temperature, none elsewhere.
    pub(crate) fn count_thermal_contacts(&mut self) {
        if self.boundary.faces.iter().flatten().any(|face| face.temperature.is_some()) {
            self.thermal_contacts.resize(self.flights.len(), 0);
        }
    }
}
