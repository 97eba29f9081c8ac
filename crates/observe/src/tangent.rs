//! Tangent space of hard particles: how an infinitesimal difference between two paths grows, collision by collision.

use std::ops::ControlFlow;

use corpuscle_core::{Contact, Meeting, Observer, Vector};

/// An infinitesimal displacement of every particle, carried along a path.
///
/// Between contacts `d(delta r)/dt = delta v`. At the contact of two spheres, with the unit normal `n` from 1 to 2, the distance
/// `s`, the relative velocity `v = v2 - v1` before, `delta r` and `delta v` those of 2 less those of 1 and
/// `w_1 = 2 m2/(m1 + m2)`, the displaced pair meets later by `-(delta r.n)/(v.n)` and with its normal turned by
/// `delta n = (delta r - v (delta r.n)/(v.n))/s`, so that
///
/// > `delta r1 += w_1 (delta r.n) n`, `delta v1 += w_1 [(delta v.n) n + (v.delta n) n + (v.n) delta n]`
///
/// and likewise for 2 with `-w_2` (Dellago, Posch and Hoover 1996, doi:10.1103/PhysRevE.53.1485). A flat face mirrors both.
/// Elastic contacts, no field, faces that neither move nor have a temperature, round obstacles; after any other contact the
/// displacement is not a number.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Tangent<const D: usize> {
    offsets: Vec<Offset<D>>,
    /// Powers of two taken out so far: the numbers stay within range, and no bit of them is lost.
    taken_out: f64,
}

/// The displacement of one particle, as of its own last contact.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
struct Offset<const D: usize> {
    place: Vector<D>,
    velocity: Vector<D>,
    time: f64,
}

impl<const D: usize> Offset<D> {
    fn place_at(&self, time: f64) -> Vector<D> {
        self.place + self.velocity * (time - self.time)
    }

    fn bring_to(&mut self, time: f64) {
        (self.place, self.time) = (self.place_at(time), time);
    }
}

impl<const D: usize> Tangent<D> {
    /// A displacement of velocities alone, at `time`.
    pub fn of_velocities(time: f64, velocities: impl IntoIterator<Item = Vector<D>>) -> Self {
        let offset = |velocity| Offset { place: Vector::ZERO, velocity, time };
        Self { offsets: velocities.into_iter().map(offset).collect(), taken_out: 0.0 }
    }

    /// `ln |delta r|` over the places of all particles at a time not before the last contact.
    pub fn logarithm(&self, time: f64) -> f64 {
        let square: f64 = self.offsets.iter().map(|offset| offset.place_at(time).norm_squared()).sum();
        0.5 * libm::log(square) + self.taken_out * std::f64::consts::LN_2
    }

    /// Takes a power of two out of the displacement, at a time not before the last contact. Call it now and then in a long run.
    pub fn rescale(&mut self, time: f64) {
        let square: f64 = self.offsets.iter().map(|offset| offset.place_at(time).norm_squared()).sum();
        let power = libm::round(0.5 * libm::log2(square));
        if power.is_finite() {
            let factor = libm::exp2(-power);
            for offset in &mut self.offsets {
                (offset.place, offset.velocity) = (offset.place * factor, offset.velocity * factor);
            }
            self.taken_out += power;
        }
    }
}

impl<const D: usize> Observer<D> for Tangent<D> {
    fn contact(&mut self, contact: &Contact<D>) -> ControlFlow<()> {
        let (n, time, first) = (contact.normal, contact.time, contact.first);
        let one = &mut self.offsets[first.index];
        one.bring_to(time);
        let (r1, u1) = (one.place, one.velocity);
        // What the first particle meets, by its velocity, displacement, mass and curvature.
        let (v, r, u, share) = match contact.with {
            Meeting::Pair(second) => {
                let two = &mut self.offsets[second.index];
                two.bring_to(time);
                let share = 2.0 / (first.mass + second.mass);
                (second.before - first.before, two.place - r1, two.velocity - u1, [share * second.mass, share * first.mass])
            }
            Meeting::Face { .. } | Meeting::Obstacle { .. } => (-first.before, -r1, -u1, [2.0, 0.0]),
            Meeting::Partition { .. } | Meeting::Piston { .. } => (Vector::splat(f64::NAN), r1, u1, [2.0, 0.0]),
        };
        let (approach, along) = (v.dot(n), r.dot(n));
        let turned = match contact.with {
            Meeting::Face { .. } => Vector::ZERO,
            _ => (r - v * (along / approach)) * (1.0 / contact.distance),
        };
        let place = n * along;
        let velocity = n * (u.dot(n) + v.dot(turned)) + turned * approach;
        let one = &mut self.offsets[first.index];
        (one.place, one.velocity) = (one.place + place * share[0], one.velocity + velocity * share[0]);
        if let Meeting::Pair(second) = contact.with {
            let two = &mut self.offsets[second.index];
            (two.place, two.velocity) = (two.place - place * share[1], two.velocity - velocity * share[1]);
        }
        ControlFlow::Continue(())
    }
}
