//! Motion in contact with a heat bath.

use corpuscle_core::{Failure, Invalid, Random, Vector};

use crate::system::{Path, System};

/// Streams of random numbers: one for each use.
const NOISE: u64 = 0x4c41_4e47;
const RESCALING: u64 = 0x4255_5353;

/// A heat bath, and how it touches the particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Bath {
    /// Friction and noise on every particle.
    Langevin { temperature: f64, friction: f64, seed: u64 },
    /// Langevin's in the limit of strong friction: positions alone.
    Brownian { temperature: f64, friction: f64, seed: u64 },
    /// All velocities scaled together.
    Rescaling { temperature: f64, relaxation_time: f64, degrees_of_freedom: u32, seed: u64 },
}

impl Bath {
    /// Noise of the bath is in proportion to `1/sqrt m`.
    pub(crate) fn admit<const D: usize>(system: &System<D>) -> Result<(), Invalid> {
        match system.particles.mass.iter().position(|&mass| mass == 0.0) {
            Some(i) => Err(Invalid::new(format!("mass of particle {i}"), 0, "a positive mass: heat moves it by 1/sqrt m")),
            None => Ok(()),
        }
    }

    pub(crate) fn step<const D: usize>(&self, system: &mut System<D>, start: f64, end: f64, dt: f64) -> Result<(), Failure> {
        let number = (start / dt).round() as u64;
        system.accelerate(start, 0.0);
        match *self {
            // Kick, drift, bath, drift, kick: BAOAB, whose configurations are the most exact of all such orders
            // (Leimkuhler and Matthews 2013, doi:10.1063/1.4802990).
            Self::Langevin { temperature, friction, seed } => {
                system.kick_and_drift(0.5 * dt, 0.5 * dt);
                let kept = libm::exp(-friction * dt);
                let spread = ((1.0 - kept * kept) * temperature).sqrt();
                let particles = &mut system.particles;
                for (i, (v, mass)) in particles.velocity.iter_mut().zip(&particles.mass).enumerate() {
                    *v = *v * kept + noise(seed, number, i) * (spread / mass.sqrt());
                }
                system.kick_and_drift(0.0, 0.5 * dt);
                system.hold(end);
                system.confine(end, dt, Path::Straight)?;
                system.accelerate(end, 0.0);
                system.kick(0.5 * dt);
                system.hold(end);
            }
            // The mean of this step's noise and the next one's makes configurations right to second order (Leimkuhler and
            // Matthews 2013, doi:10.1093/amrx/abs010). Velocities are those of the mean drift.
            Self::Brownian { temperature, friction, seed } => {
                let spread = (2.0 * temperature * dt / friction).sqrt();
                for i in 0..system.particles.len() {
                    let drift = system.acceleration[i] * (1.0 / friction);
                    let noise = (noise::<D>(seed, number, i) + noise(seed, number + 1, i))
                        * (0.5 * spread / system.particles.mass[i].sqrt());
                    system.particles.position[i] += drift * dt + noise;
                    system.particles.velocity[i] = drift;
                }
                (system.fresh, system.doubtful) = (false, true);
                system.hold(end);
                system.confine(end, dt, Path::Straight)?;
            }
            Self::Rescaling { temperature, relaxation_time, degrees_of_freedom, seed } => {
                system.kick_and_drift(0.5 * dt, dt);
                system.hold(end);
                system.confine(end, dt, Path::Straight)?;
                system.accelerate(end, 0.0);
                system.kick(0.5 * dt);
                let kinetic = system.particles.kinetic_energy();
                let factor = rescaling(kinetic, temperature, libm::exp(-dt / relaxation_time), degrees_of_freedom, seed, number);
                system.particles.velocity.iter_mut().for_each(|v| *v = *v * factor);
                system.hold(end);
            }
        }
        Ok(())
    }
}

/// A standard normal vector, which belongs to a step and a particle.
fn noise<const D: usize>(seed: u64, step: u64, particle: usize) -> Vector<D> {
    let mut random = Random::at(seed, NOISE, step, particle as u64);
    Vector::from_fn(|_| random.normal())
}

/// The factor by which velocities are scaled: the exact solution of the stochastic equation for the kinetic energy (Bussi,
/// Donadio and Parrinello 2007, doi:10.1063/1.2408420, equation A7), of which a share `kept` stays.
fn rescaling(kinetic: f64, temperature: f64, kept: f64, degrees_of_freedom: u32, seed: u64, step: u64) -> f64 {
    if kinetic == 0.0 {
        return 1.0; // nothing to scale: velocities have no direction
    }
    let mut random = Random::at(seed, RESCALING, step, 0);
    let first = random.normal();
    let others: f64 = (1..degrees_of_freedom).map(|_| random.normal()).map(|x| x * x).sum();
    let share = 0.5 * temperature / kinetic * (1.0 - kept);
    let squared = kept + share * (first * first + others) + 2.0 * first * (kept * share).sqrt();
    // Rounding may leave less than nothing of a square.
    let factor = squared.max(0.0).sqrt();
    if first + (kept / share).sqrt() < 0.0 { -factor } else { factor }
}
