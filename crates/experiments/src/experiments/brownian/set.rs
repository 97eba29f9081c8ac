//! What the baths of one kind have in common, and what theory says of the particle in them.

use corpuscle_core::{Axis as Faces, Invalid, particles::ball_volume};
use corpuscle_observe::theory;

use super::path::{MEMORY, RESOLUTION};
use crate::{Settings, gas};

/// What all baths have in common.
#[derive(Clone, Debug)]
pub(super) struct Set<const D: usize> {
    pub(super) seed: u64,
    pub(super) particles: usize,
    pub(super) bath_radius: f64,
    pub(super) radius: f64,
    pub(super) mass: f64,
    pub(super) temperature: f64,
    pub(super) faces: Faces,
    pub(super) side: f64,
    /// Collisions of a bath particle per time.
    pub(super) collision_rate: f64,
    /// Friction `gamma_0` by Enskog's theory.
    pub(super) friction: f64,
    /// `s`: 1 between walls, `N m / (N m + M)` where total momentum is zero.
    pub(super) share: f64,
    pub(super) interval: f64,
    pub(super) longest_lag: f64,
}

impl<const D: usize> Set<D> {
    /// Baths of these settings, around a particle of this radius and mass.
    pub(super) fn new(settings: &Settings, radius: f64, mass: f64) -> Result<Self, Invalid> {
        let (particles, bath_radius) = (settings.whole("particles"), settings.real("bath_radius"));
        let temperature = settings.real("temperature");
        let side = gas::side::<D>(particles, bath_radius, settings.real("packing_fraction"));
        let contact = radius + bath_radius;
        if 4.0 * contact > side {
            return Err(Invalid::new(
                "radius",
                radius,
                format!("a tracer that leaves room in the box of side {side:.3}: at most {:.3}", 0.25 * side - bath_radius),
            ));
        }
        let faces = if settings.word("boundary") == "walls" { Faces::Walls } else { Faces::Periodic };
        // The tracer keeps the centres of the bath out of its own surroundings: the rest is denser.
        let density = particles as f64 / (side.powi(D as i32) - ball_volume::<D>(contact));
        let chi =
            theory::contact_value_of_tracer::<D>(theory::packing_fraction::<D>(density, 2.0 * bath_radius), bath_radius, radius);
        let friction = theory::initial_friction::<D>(density, contact, chi, 1.0, mass, temperature);
        let share = if faces == Faces::Periodic { particles as f64 / (particles as f64 + mass) } else { 1.0 };
        let relaxation = share / friction;
        Ok(Self {
            seed: settings.seed,
            particles,
            bath_radius,
            radius,
            mass,
            temperature,
            faces,
            side,
            collision_rate: theory::collision_rate::<D>(density, 2.0 * bath_radius, temperature, 1.0),
            friction,
            share,
            interval: relaxation / RESOLUTION,
            longest_lag: MEMORY * relaxation,
        })
    }

    /// Relaxation time of the tracer's velocity in this box, `s / gamma_0`.
    pub(super) fn relaxation(&self) -> f64 {
        self.share / self.friction
    }

    /// Expected diffusion coefficient `s^2 kT/(M gamma_0)`.
    pub(super) fn diffusion(&self) -> f64 {
        self.share * self.share * theory::diffusion_coefficient(self.temperature, self.mass, self.friction)
    }

    /// Expected mean squared displacement: Ornstein and Uhlenbeck's, with the box's own `kT` and friction.
    pub(super) fn displacement(&self, time: f64) -> f64 {
        theory::ornstein_uhlenbeck_displacement(D, self.share * self.temperature, self.mass, self.friction / self.share, time)
    }

    /// In a closed system of `f` degrees of freedom speeds are bounded; kicks go with the cube of the relative speed, whose
    /// mean is lower than Maxwell's by `(f/2)^(3/2) Gamma(f/2) / Gamma(f/2 + 3/2)`.
    pub(super) fn closed_system_factor(&self) -> f64 {
        let particles = self.particles as f64 + if self.faces == Faces::Periodic { 0.0 } else { 1.0 };
        let half = 0.5 * D as f64 * particles;
        libm::exp(1.5 * libm::log(half) + libm::lgamma(half) - libm::lgamma(half + 1.5))
    }
}
