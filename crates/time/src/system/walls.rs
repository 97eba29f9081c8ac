//! What becomes of particles that moved out of the box.

use corpuscle_core::{Axis, Contact, Failure, Meeting, Party, Vector};

use super::System;
use crate::motion;

impl<const D: usize> System<D> {
    /// Reflects at walls and wraps around periodic axes what moved out of the box in a step of length `dt` that ends at
    /// `end`. Hits of walls are kept for the observer.
    pub(crate) fn confine(&mut self, end: f64, dt: f64, path: Path) -> Result<(), Failure> {
        if let Some(stride) = self.due.last_mut() {
            stride.confined = true; // in its turn; strides are put off only where there are no walls
            return Ok(());
        }
        if self.boundary.axes.contains(&Axis::Periodic) {
            motion::wrap_all(&self.boundary, &mut self.particles.position, &mut self.images);
        }
        if !self.boundary.axes.contains(&Axis::Walls) {
            return Ok(());
        }
        // A force that takes strides leaves no accelerations behind.
        let path = if self.strides_at_once() > 0 { Path::Straight } else { path };
        for i in 0..self.particles.len() {
            for k in 0..D {
                if self.boundary.axes[k] == Axis::Walls {
                    let (x, radius) = (self.particles.position[i][k], self.particles.radius[i]);
                    if x < self.boundary.lower[k] + radius {
                        self.reflect(i, k, false, end, dt, path)?;
                    } else if x > self.boundary.upper[k] - radius {
                        self.reflect(i, k, true, end, dt, path)?;
                    }
                }
            }
        }
        Ok(())
    }

    fn is_held(&self, i: usize, k: usize) -> bool {
        self.held.iter().any(|held| held.particle == i && held.axis == k)
    }

    /// Brings particle `i` back from behind a face it has gone through, its velocity turned inwards.
    fn reflect(&mut self, i: usize, k: usize, upper: bool, end: f64, dt: f64, path: Path) -> Result<(), Failure> {
        if self.is_held(i, k) {
            return Ok(());
        }
        let radius = self.particles.radius[i];
        let (low, high) = (self.boundary.lower[k] + radius, self.boundary.upper[k] - radius);
        let (face, outward) = if upper { (high, 1.0) } else { (low, -1.0) };
        let outside = self.particles.position[i];
        let mirrored = 2.0 * face - outside[k];
        if !(low <= mirrored && mirrored <= high) {
            let cause = format!(
                "moved through the wall across axis {k} by {:.3e}, further than the box is wide; use a smaller dt",
                (outside[k] - face).abs()
            );
            return Err(Failure { time: end, particle: Some(i), cause });
        }
        let mut before = self.particles.velocity[i];
        let speed = outward * before[k];
        let depth = (outside[k] - face).abs();
        let bounce = match path {
            Path::Straight => (speed > 0.0).then(|| Bounce { since: depth / speed, speed, place: mirrored, left: -before[k] }),
            Path::Bent { kick } => {
                let pull = outward * self.acceleration[i][k];
                Bounce::bent(depth, speed + pull * kick, pull).map(|bounce| Bounce {
                    place: face + outward * bounce.place,
                    left: outward * (bounce.left - pull * kick),
                    ..bounce
                })
            }
        };
        // What comes back already is only put inside.
        self.particles.position[i][k] = mirrored;
        let Some(Bounce { since, speed, place, left }) = bounce else { return Ok(()) };
        let since = since.min(dt);
        self.particles.position[i][k] = place.clamp(low, high);
        self.particles.velocity[i][k] = left;
        before[k] = outward * speed;
        let mut after = before;
        after[k] = -before[k];
        let mut position = outside - before * since;
        position[k] = face;
        let mut normal = Vector::ZERO;
        normal[k] = outward;
        let mass = self.particles.mass[i];
        self.contacts.push(Contact {
            time: end - since,
            first: Party { index: i, mass, position, before, after },
            with: Meeting::Face { axis: k, upper },
            normal,
            impulse: 2.0 * mass * speed,
            distance: radius,
        });
        Ok(())
    }
}

/// How particles came to where they are at the end of a step: what a wall in their way has to know.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Path {
    /// On straight lines, in a single drift: a billiard.
    Straight,
    /// On paths that the forces bent all the way. Velocities at the end of the step are still to get their kick of this length. A mirror
    /// image would not do: with the force `F` into the wall and the speed `v` it wins or loses the energy `F v dt`, and always the one
    /// or always the other.
    Bent { kick: f64 },
}

/// A hit of a wall within a step.
struct Bounce {
    /// How long before the end of the step.
    since: f64,
    /// Normal speed at the wall.
    speed: f64,
    /// Where the particle is at the end, and how fast.
    place: f64,
    left: f64,
}

impl Bounce {
    /// Of a particle found `depth` behind the wall at the outward velocity `w`, accelerated outwards by `b`: at the wall its speed was
    /// `u = sqrt(w^2 - 2 b depth)`, a time `s = 2 depth/(w + u)` ago, and since then it has been thrown back. Place and velocity count
    /// outwards from the wall. None of one that was never on its way out.
    fn bent(depth: f64, w: f64, b: f64) -> Option<Self> {
        let u = (w * w - 2.0 * b * depth).max(0.0).sqrt();
        if w + u <= 0.0 {
            return None;
        }
        let s = 2.0 * depth / (w + u);
        let (place, left) = (s * (0.5 * b * s - u), b * s - u);
        // Back at the wall within the same step, it is pressed against it: a mirror image has to do.
        Some(if place <= 0.0 {
            Self { since: s, speed: u, place, left }
        } else {
            Self { since: s, speed: u, place: -depth, left: -w }
        })
    }
}
