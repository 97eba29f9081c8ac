//! A heat bath of a few variables that follow equations of motion themselves: a chain of Nose-Hoover thermostats.
//!
//! Each link has a velocity `v_k`, a place `eta_k` and an inertia `Q_k`. The first rubs against the particles, every other one
//! against the link before it, and each is driven by what that has too much of:
//!
//! ```text
//! dv_i/dt = F_i/m_i - v_1 v_i                                          d eta_k/dt = v_k
//! dv_1/dt = (sum m_i v_i^2 - f k T)/Q_1 - v_2 v_1                      Q_1 = f k T tau^2
//! dv_k/dt = (Q_(k-1) v_(k-1)^2 - k T)/Q_k - v_(k+1) v_k                Q_k = k T tau^2
//! ```
//!
//! (Martyna, Klein and Tuckerman 1992, doi:10.1063/1.463940). They conserve
//! `E_kin + U + sum Q_k v_k^2/2 + f k T eta_1 + k T (eta_2 + ... + eta_M)`, and where they are ergodic the particles are
//! canonical. One link alone is not ergodic for a harmonic oscillator; a chain of them practically is.
//!
//! A step is symmetric: half a step of the chain, velocity Verlet, half a step of the chain (Martyna, Tuckerman, Tobias and Klein
//! 1996, doi:10.1080/00268979600100761), the chain's own step being of order 4.

use corpuscle_checkpoint::resume;
use corpuscle_core::{Failure, Invalid};

use super::composition::LENGTHS_4;
use crate::system::{Path, System};

/// One link of the chain.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Link {
    place: f64,
    velocity: f64,
    inertia: f64,
}

/// The chain, and what it is to keep the particles at.
#[derive(Clone, Debug)]
pub(crate) struct Chain {
    temperature: f64,
    degrees_of_freedom: f64,
    pub(crate) links: Vec<Link>,
}

resume!(Chain { values: [links], set_up: [temperature, degrees_of_freedom] });

impl Chain {
    /// A chain at rest.
    pub(crate) fn new(temperature: f64, relaxation_time: f64, degrees_of_freedom: u32, links: u32) -> Self {
        let degrees_of_freedom = f64::from(degrees_of_freedom);
        let inertia = temperature * relaxation_time * relaxation_time;
        let link = |k| Link { place: 0.0, velocity: 0.0, inertia: if k == 0 { degrees_of_freedom * inertia } else { inertia } };
        Self { temperature, degrees_of_freedom, links: (0..links).map(link).collect() }
    }

    /// A particle without mass has no kinetic energy to control.
    pub(crate) fn admit<const D: usize>(system: &System<D>) -> Result<(), Invalid> {
        match system.particles.mass.iter().position(|&mass| mass == 0.0) {
            Some(i) => Err(Invalid::new(format!("mass of particle {i}"), 0, "a positive mass, which can have a temperature")),
            None => Ok(()),
        }
    }

    pub(crate) fn step<const D: usize>(&mut self, system: &mut System<D>, start: f64, end: f64, dt: f64) -> Result<(), Failure> {
        system.accelerate(start, 0.0);
        self.rub(system, 0.5 * dt);
        system.kick_and_drift(0.5 * dt, dt);
        system.hold(end);
        system.confine(end, dt, Path::Straight)?;
        system.accelerate(end, 0.0);
        system.kick(0.5 * dt);
        self.rub(system, 0.5 * dt);
        system.hold(end);
        Ok(())
    }

    /// What the chain holds of the conserved energy.
    pub(crate) fn energy(&self) -> f64 {
        let energy = |(k, link): (usize, &Link)| {
            let freedom = if k == 0 { self.degrees_of_freedom } else { 1.0 };
            0.5 * link.inertia * link.velocity * link.velocity + freedom * self.temperature * link.place
        };
        self.links.iter().enumerate().map(energy).sum()
    }

    /// The particles' velocities and the chain after the time `dt`, in which positions stand still.
    fn rub<const D: usize>(&mut self, system: &mut System<D>, dt: f64) {
        let mut twice_kinetic = 2.0 * system.particles.kinetic_energy();
        let mut factor = 1.0;
        for length in LENGTHS_4 {
            let h = length * dt;
            for k in (0..self.links.len()).rev() {
                self.drive(k, twice_kinetic, h);
            }
            let scale = libm::exp(-self.links[0].velocity * h);
            factor *= scale;
            twice_kinetic *= scale * scale;
            for link in &mut self.links {
                link.place += link.velocity * h;
            }
            for k in 0..self.links.len() {
                self.drive(k, twice_kinetic, h);
            }
        }
        system.particles.velocity.iter_mut().for_each(|v| *v = *v * factor);
    }

    /// Half a step `h` of link `k`: half of it rubbed by the next link, driven by the one before, rubbed again.
    fn drive(&mut self, k: usize, twice_kinetic: f64, h: f64) {
        let excess = match k.checked_sub(1) {
            None => twice_kinetic - self.degrees_of_freedom * self.temperature,
            Some(before) => {
                let before = self.links[before];
                before.inertia * before.velocity * before.velocity - self.temperature
            }
        };
        let rubbed = self.links.get(k + 1).map_or(1.0, |next| libm::exp(-0.25 * h * next.velocity));
        let link = &mut self.links[k];
        link.velocity = (link.velocity * rubbed + 0.5 * h * excess / link.inertia) * rubbed;
    }
}
