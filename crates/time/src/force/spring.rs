//! Springs between pairs of particles: chains, membranes, arbitrary networks.

use corpuscle_core::{Axis, Boundary, Invalid, Particles, Vector};

use super::{Force, massive, not_negative};
use crate::image::NearestImage;

/// A spring, with a dashpot beside it.
///
/// With `r` the arrow from the first to the second particle (nearest image), `n = r/|r|` and `v` the relative velocity, the
/// second feels `-(k (|r| - l) + c v . n) n`. With rest length zero spring and dashpot act on whole vectors,
/// `-k r - c v`, which is linear: a stretched string whose transverse waves obey the wave equation at any amplitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring {
    /// Index of one end.
    pub first: usize,
    /// Index of the other.
    pub second: usize,
    /// Stiffness `k`, energy per length squared.
    pub stiffness: f64,
    /// Rest length `l`.
    pub rest_length: f64,
    /// Damping `c`, force per velocity.
    pub damping: f64,
}

impl Spring {
    /// An undamped spring.
    pub fn new(first: usize, second: usize, stiffness: f64, rest_length: f64) -> Self {
        Self { first, second, stiffness, rest_length, damping: 0.0 }
    }

    /// Elastic part of the force on the second particle.
    #[inline]
    fn elastic<const D: usize>(&self, r: Vector<D>) -> Vector<D> {
        if self.rest_length == 0.0 {
            return r * -self.stiffness;
        }
        r * (self.stiffness * (self.rest_length / r.norm() - 1.0))
    }

    /// Friction on the second particle, which moves at `v` relative to the first.
    #[inline]
    fn friction<const D: usize>(&self, r: Vector<D>, v: Vector<D>) -> Vector<D> {
        if self.rest_length == 0.0 {
            return v * -self.damping;
        }
        r * (-self.damping * v.dot(r) / r.norm_squared())
    }
}

/// Any number of springs.
#[derive(Clone, Debug, PartialEq)]
pub struct Springs {
    springs: Vec<Spring>,
}

impl Springs {
    /// A network of springs.
    pub fn new(springs: Vec<Spring>) -> Self {
        Self { springs }
    }

    /// The springs.
    pub fn springs(&self) -> &[Spring] {
        &self.springs
    }

    fn arrows<'a, const D: usize>(
        &'a self,
        boundary: &Boundary<D>,
        particles: &'a Particles<D>,
    ) -> impl Iterator<Item = (&'a Spring, Vector<D>)> {
        let image = NearestImage::new(boundary);
        self.springs
            .iter()
            .map(move |spring| (spring, image.displacement(particles.position[spring.first], particles.position[spring.second])))
    }
}

impl<const D: usize> Force<D> for Springs {
    fn name(&self) -> &'static str {
        "springs"
    }

    fn accelerate(&mut self, _: f64, boundary: &Boundary<D>, particles: &Particles<D>, acceleration: &mut [Vector<D>]) {
        for (spring, r) in self.arrows(boundary, particles) {
            let mut force = spring.elastic(r);
            if spring.damping != 0.0 {
                force += spring.friction(r, particles.velocity[spring.second] - particles.velocity[spring.first]);
            }
            acceleration[spring.first] -= force * (1.0 / particles.mass[spring.first]);
            acceleration[spring.second] += force * (1.0 / particles.mass[spring.second]);
        }
    }

    fn energy(&self, _: f64, boundary: &Boundary<D>, particles: &Particles<D>) -> f64 {
        let energy = |(spring, r): (&Spring, Vector<D>)| 0.5 * spring.stiffness * (r.norm() - spring.rest_length).powi(2);
        self.arrows(boundary, particles).map(energy).sum()
    }

    fn virial(&self, _: f64, boundary: &Boundary<D>, particles: &Particles<D>) -> f64 {
        self.arrows(boundary, particles).map(|(spring, r)| r.dot(spring.elastic(r))).sum()
    }

    fn validate(&self, boundary: &Boundary<D>, particles: &Particles<D>) -> Result<(), Invalid> {
        for (number, spring) in self.springs.iter().enumerate() {
            massive("a spring", spring.first, particles)?;
            massive("a spring", spring.second, particles)?;
            if spring.first == spring.second {
                return Err(Invalid::new(format!("ends of spring {number}"), spring.first, "two different particles"));
            }
            not_negative(&format!("stiffness of spring {number}"), spring.stiffness)?;
            not_negative(&format!("rest length of spring {number}"), spring.rest_length)?;
            not_negative(&format!("damping of spring {number}"), spring.damping)?;
            for k in (0..D).filter(|&k| boundary.axes[k] == Axis::Periodic) {
                let half = 0.5 * boundary.extent()[k];
                if spring.rest_length >= half {
                    let expected = format!("less than half the periodic box, {half} along axis {k}");
                    return Err(Invalid::new(format!("rest length of spring {number}"), spring.rest_length, expected));
                }
            }
        }
        Ok(())
    }

    fn depends_on_velocity(&self) -> bool {
        self.springs.iter().any(|spring| spring.damping != 0.0)
    }
}
