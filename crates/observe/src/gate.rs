//! Passages through a plane, each at its very time.

use std::ops::ControlFlow;

use corpuscle_core::{Contact, Meeting, Observer, Particles, Party};

/// Watches who passes a plane across the box, in free flight and without a field: between contacts a particle flies straight, so
/// that its last contact tells when it will pass, unless it meets something before.
///
/// Kept up to date by contacts, and by [`settle`](Self::settle) where they end.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Gate {
    axis: usize,
    at: f64,
    particles: Vec<Passenger>,
    below: usize,
    now: f64,
    /// Time during which exactly so many particles were below the plane.
    durations: Vec<f64>,
    /// How often their number became this.
    arrivals: Vec<u64>,
    upward: Passages,
    downward: Passages,
}

/// One particle, as of its last contact.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
struct Passenger {
    below: bool,
    energy: f64,
    /// When it will pass; infinite where it does not fly that way.
    due: f64,
}

/// Passages one way.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Passages {
    /// How many.
    pub count: u64,
    /// Kinetic energy of those that passed.
    pub energy: f64,
}

impl Gate {
    /// A plane across `axis` at this coordinate, and particles as they are at `time`.
    pub fn new<const D: usize>(axis: usize, at: f64, time: f64, particles: &Particles<D>) -> Self {
        let count = particles.len();
        let mut gate = Self {
            axis,
            at,
            particles: vec![],
            below: 0,
            now: time,
            durations: vec![0.0; count + 1],
            arrivals: vec![0; count + 1],
            upward: Passages::default(),
            downward: Passages::default(),
        };
        for i in 0..count {
            let below = particles.position[i][axis] < at;
            gate.below += usize::from(below);
            gate.particles.push(Passenger { below, energy: 0.0, due: f64::INFINITY });
            let (position, after) = (particles.position[i], particles.velocity[i]);
            gate.turn(time, &Party { index: i, mass: particles.mass[i], position, before: after, after });
        }
        gate
    }

    /// Lets all pass that are due until `time`, in their order.
    pub fn settle(&mut self, time: f64) {
        while let Some((due, i)) = self.next().filter(|&(due, _)| due <= time) {
            self.wait(due);
            let particle = &mut self.particles[i];
            let way = if particle.below { &mut self.upward } else { &mut self.downward };
            *way = Passages { count: way.count + 1, energy: way.energy + particle.energy };
            self.below = if particle.below { self.below - 1 } else { self.below + 1 };
            (particle.below, particle.due) = (!particle.below, f64::INFINITY);
            self.arrivals[self.below] += 1;
        }
        self.wait(time);
    }

    /// When the next particle will pass, and which; none if there is nobody on the way.
    pub fn next(&self) -> Option<(f64, usize)> {
        let all = self.particles.iter().enumerate().map(|(i, particle)| (particle.due, i));
        all.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|next| next.0 < f64::INFINITY)
    }

    /// The next one does not pass: the caller turns it back.
    pub fn refuse(&mut self, particle: usize) {
        self.particles[particle].due = f64::INFINITY;
    }

    /// Number of particles below the plane.
    pub fn below(&self) -> usize {
        self.below
    }

    /// Whether a particle is below the plane.
    pub fn is_below(&self, particle: usize) -> bool {
        self.particles[particle].below
    }

    /// Kinetic energy with which a particle is on its way.
    pub fn energy(&self, particle: usize) -> f64 {
        self.particles[particle].energy
    }

    /// Passages upwards along the axis.
    pub fn upward(&self) -> Passages {
        self.upward
    }

    /// Passages downwards.
    pub fn downward(&self) -> Passages {
        self.downward
    }

    /// Time during which exactly so many particles were below.
    pub fn durations(&self) -> &[f64] {
        &self.durations
    }

    /// Time integrals of the numbers below and above.
    pub fn presence(&self) -> [f64; 2] {
        let of_each = self.durations.iter().enumerate();
        let all = (self.durations.len() - 1) as f64;
        of_each.fold([0.0; 2], |[low, high], (count, time)| [low + count as f64 * time, high + (all - count as f64) * time])
    }

    /// How often the number below became this.
    pub fn arrivals(&self) -> &[u64] {
        &self.arrivals
    }

    fn wait(&mut self, until: f64) {
        self.durations[self.below] += until - self.now;
        self.now = until;
    }

    /// A particle has a new velocity.
    fn turn<const D: usize>(&mut self, time: f64, party: &Party<D>) {
        let particle = &mut self.particles[party.index];
        let (way, speed) = (self.at - party.position[self.axis], party.after[self.axis]);
        let approaches = if particle.below { speed > 0.0 } else { speed < 0.0 };
        // Rounding may put a particle a hair beyond the plane that it has not passed yet.
        particle.due = if approaches { time + (way / speed).max(0.0) } else { f64::INFINITY };
        particle.energy = 0.5 * party.mass * party.after.norm_squared();
    }
}

impl<const D: usize> Observer<D> for Gate {
    fn contact(&mut self, contact: &Contact<D>) -> ControlFlow<()> {
        self.settle(contact.time);
        self.turn(contact.time, &contact.first);
        if let Meeting::Pair(second) = &contact.with {
            self.turn(contact.time, second);
        }
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corpuscle_core::Vector;

    /// Two free flights, one of which is turned back by a wall behind the plane.
    #[test]
    fn passages_come_in_their_order() {
        let mut particles = Particles::<2>::new();
        particles.push(Vector([1.0, 0.0]), Vector([2.0, 0.0]), 1.0, 0.1, 0);
        particles.push(Vector([4.0, 0.0]), Vector([-1.0, 0.0]), 2.0, 0.1, 0);
        let mut gate = Gate::new(0, 2.0, 10.0, &particles);
        assert_eq!((gate.below(), gate.next()), (1, Some((10.5, 0))));
        gate.settle(11.0);
        assert_eq!((gate.below(), gate.upward().count, gate.upward().energy), (0, 1, 2.0));
        let party =
            Party { index: 0, mass: 1.0, position: Vector([3.0, 0.0]), before: Vector([2.0, 0.0]), after: Vector([-2.0, 0.0]) };
        let with = Meeting::Face { axis: 0, upper: true };
        let contact = Contact { time: 11.0, first: party, with, normal: Vector([1.0, 0.0]), impulse: 4.0, distance: 0.1 };
        let _ = gate.contact(&contact);
        gate.settle(13.0);
        assert_eq!((gate.below(), gate.downward().count), (2, 2));
        assert_eq!(gate.durations(), [1.0, 1.0, 1.0]);
        assert_eq!(gate.arrivals(), [1, 1, 1]);
    }
}
