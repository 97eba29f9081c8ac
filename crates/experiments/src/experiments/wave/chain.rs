//! A chain of masses and springs on the time-driven engine.
//!
//! `m_n d^2u_n/dt^2 = kappa (u_{n+1} - 2 u_n + u_{n-1})`, for both polarisations and at any amplitude:
//! transverse masses slide on rods across the string, joined by springs of rest length zero under the tension
//! `T = kappa a`; longitudinal ones have springs of rest length `a`, which are linear as long as the masses keep their order.

use corpuscle_checkpoint::resume;
use corpuscle_core::{Axis, Boundary, Engine, Failure, Invalid, Particles, Vector};
use corpuscle_time::{Drive, Force, Integrator, Pin, Signal, Spring, Springs, TimeDriven};

use super::sponge::Sponge;
use crate::Frame;

/// Direction of the displacements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Polarisation {
    /// Across the chain.
    Transverse,
    /// Along the chain.
    Longitudinal,
}

impl Polarisation {
    /// Axis of the displacements.
    pub(super) fn axis(self) -> usize {
        usize::from(self == Self::Transverse)
    }
}

/// What is at an end of the chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum End {
    /// A last spring, to a wall.
    Fixed,
    /// Nothing: the last mass is a ring on a rod.
    Free,
    /// A last spring, to a shaker.
    Driven(Signal),
}

/// How the chain ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Ends {
    /// It does not: its last mass is joined to its first.
    Ring,
    /// With these two.
    Between(End, End),
}

/// Everything that makes a chain.
#[derive(Clone, Debug)]
pub(super) struct Design {
    /// The masses, from left to right.
    pub(super) masses: Vec<f64>,
    /// Stiffness `kappa` of each spring.
    pub(super) stiffness: f64,
    /// Distance `a` of neighbours at rest.
    pub(super) spacing: f64,
    pub(super) polarisation: Polarisation,
    pub(super) ends: Ends,
    pub(super) integrator: Integrator,
    /// Rate `gamma_n` of the friction `-m gamma_n du_n/dt` on each mass; none where there are no more.
    pub(super) friction: Vec<f64>,
}

impl Design {
    /// Number `N` of masses that can move.
    pub(super) fn count(&self) -> usize {
        self.masses.len()
    }

    /// Place of mass `n = 0..N` at rest. Waves turn back at `x = 0`, a spacing before the first mass at a fixed end and half
    /// a spacing before it at a free one.
    pub(super) fn place(&self, n: usize) -> f64 {
        let first = if matches!(self.ends, Ends::Ring | Ends::Between(End::Free, _)) { 0.5 } else { 1.0 };
        (n as f64 + first) * self.spacing
    }

    /// Distance between the places where waves turn back; circumference of a ring.
    pub(super) fn length(&self) -> f64 {
        let beyond = if matches!(self.ends, Ends::Ring | Ends::Between(_, End::Free)) { 0.5 } else { 1.0 };
        self.place(self.count() - 1) + beyond * self.spacing
    }

    /// Upper bound `2 sqrt(kappa / m)` of the frequencies, `m` the lightest mass.
    pub(super) fn highest_frequency(&self) -> f64 {
        2.0 * (self.stiffness / self.masses.iter().copied().fold(f64::INFINITY, f64::min)).sqrt()
    }

    /// Pairs of particles joined by springs. Anchors come after the masses: first the left one.
    fn bonds(&self) -> Vec<(usize, usize)> {
        let count = self.count();
        let mut bonds: Vec<_> = (1..count).map(|n| (n - 1, n)).collect();
        match self.ends {
            Ends::Ring => bonds.push((count - 1, 0)),
            Ends::Between(left, right) => {
                let mut anchor = count;
                if left != End::Free {
                    bonds.push((anchor, 0));
                    anchor += 1;
                }
                if right != End::Free {
                    bonds.push((count - 1, anchor));
                }
            }
        }
        bonds
    }
}

/// Energies of a chain, measured from its rest.
#[derive(Clone, Debug)]
pub(super) struct Energy {
    /// Energy at each mass: its own kinetic energy and half of each of its springs; all of a spring to a wall.
    pub(super) local: Vec<f64>,
    /// Kinetic energy `sum m v^2 / 2`.
    pub(super) kinetic: f64,
    /// Elastic energy `sum kappa s^2 / 2` of the stretches `s`.
    pub(super) elastic: f64,
    /// `sum F^2 / m` over the masses: the shadow energy that velocity Verlet conserves is `E - dt^2/8` of it.
    pub(super) force_term: f64,
}

impl Energy {
    /// Kinetic and elastic.
    pub(super) fn total(&self) -> f64 {
        self.kinetic + self.elastic
    }
}

/// A chain in motion.
pub(super) struct Chain {
    design: Design,
    engine: TimeDriven<2>,
    rest: Vec<Vector<2>>,
    bonds: Vec<(usize, usize)>,
}

resume!(Chain { values: [], parts: [engine], set_up: [design, rest, bonds] });

impl Chain {
    /// A chain that starts with these displacements and velocities of its masses.
    ///
    /// # Errors
    /// Names what the engine cannot use.
    pub(super) fn new(design: Design, displacement: &[f64], velocity: &[f64]) -> Result<Self, Invalid> {
        let axis = design.polarisation.axis();
        let (count, length) = (design.count(), design.length());
        let mut rest: Vec<Vector<2>> = (0..count).map(|n| Vector([design.place(n), 0.0])).collect();
        let mut pins: Vec<Pin<2>> = (0..count).map(|particle| Pin { particle, axes: [axis != 0, axis != 1] }).collect();
        let mut drives = vec![];
        let mut boundary = Boundary::new([0.0, -0.5 * length], [length, 0.5 * length], Axis::Open);
        match design.ends {
            Ends::Ring => boundary.axes[0] = Axis::Periodic,
            Ends::Between(left, right) => {
                for (end, x) in [(left, 0.0), (right, length)] {
                    let particle = rest.len();
                    match end {
                        End::Free => continue,
                        End::Fixed => pins.push(Pin { particle, axes: [true, true] }),
                        End::Driven(signal) => {
                            pins.push(Pin { particle, axes: [axis != 0, axis != 1] });
                            drives.push(Drive { particle, axis, signal });
                        }
                    }
                    rest.push(Vector([x, 0.0]));
                }
            }
        }
        let mut particles = Particles::new();
        for (i, &place) in rest.iter().enumerate() {
            let along = |values: &[f64]| Vector::unit(axis) * values.get(i).copied().unwrap_or(0.0);
            // A shaker starts where its signal does.
            let shaken = drives.iter().find(|drive| drive.particle == i).map_or(0.0, |drive| drive.signal.at(0.0).0);
            let mass = design.masses.get(i).copied().unwrap_or(design.masses[0]);
            particles.push(place + along(displacement) + Vector::unit(axis) * shaken, along(velocity), mass, 0.0, 0);
        }
        let rest_length = if design.polarisation == Polarisation::Longitudinal { design.spacing } else { 0.0 };
        let bonds = design.bonds();
        let springs = bonds.iter().map(|&(i, j)| Spring::new(i, j, design.stiffness, rest_length)).collect();
        let mut forces: Vec<Box<dyn Force<2>>> = vec![Box::new(Springs::new(springs))];
        if !design.friction.is_empty() {
            forces.push(Box::new(Sponge { rates: design.friction.clone() }));
        }
        let engine = TimeDriven::new(boundary, particles, forces, design.integrator)?.with_pins(pins)?.with_drives(drives)?;
        Ok(Self { design, engine, rest, bonds })
    }

    pub(super) fn design(&self) -> &Design {
        &self.design
    }

    pub(super) fn time(&self) -> f64 {
        self.engine.time()
    }

    /// All masses and anchors now.
    pub(super) fn frame(&self) -> Frame {
        Frame::new(self.engine.time(), self.engine.boundary(), self.engine.particles(), &["masses".into()])
    }

    pub(super) fn steps(&self) -> u64 {
        self.engine.steps()
    }

    /// Advances to the last whole step at or before `to`.
    ///
    /// # Errors
    /// When longitudinal masses have passed through each other: their springs are then no longer linear.
    pub(super) fn advance(&mut self, to: f64) -> Result<(), Failure> {
        self.engine.advance(to, &mut ())?;
        if self.design.polarisation == Polarisation::Longitudinal
            && let Some(&(particle, _)) = self.bonds.iter().find(|&&bond| self.stretch(bond) <= -self.design.spacing)
        {
            let cause = "neighbours on a longitudinal chain passed through each other; use a smaller amplitude".into();
            return Err(Failure { time: self.time(), particle: Some(particle), cause });
        }
        Ok(())
    }

    /// Displacement of a mass, or of an anchor, from its place at rest.
    pub(super) fn displacement(&self, i: usize) -> f64 {
        self.engine.boundary().displacement(self.rest[i], self.engine.particles().position[i])[self.design.polarisation.axis()]
    }

    /// Displacements of all masses.
    pub(super) fn displacements(&self) -> Vec<f64> {
        (0..self.design.count()).map(|n| self.displacement(n)).collect()
    }

    /// Velocity of a mass along its displacement.
    pub(super) fn velocity(&self, i: usize) -> f64 {
        self.engine.particles().velocity[i][self.design.polarisation.axis()]
    }

    /// Places at rest and displacements of the anchors at the left and the right end, where there are any.
    pub(super) fn anchors(&self) -> impl Iterator<Item = (f64, f64)> {
        (self.design.count()..self.rest.len()).map(|i| (self.rest[i][0], self.displacement(i)))
    }

    fn stretch(&self, (i, j): (usize, usize)) -> f64 {
        self.displacement(j) - self.displacement(i)
    }

    /// Energies now.
    pub(super) fn energy(&self) -> Energy {
        let count = self.design.count();
        let (mut local, mut force, mut elastic) = (vec![0.0; count], vec![0.0; count], 0.0);
        for &(i, j) in &self.bonds {
            let stretch = self.stretch((i, j));
            let energy = 0.5 * self.design.stiffness * stretch * stretch;
            elastic += energy;
            let share = if i < count && j < count { 0.5 } else { 1.0 };
            for (end, pull) in [(i, stretch), (j, -stretch)] {
                if end < count {
                    local[end] += share * energy;
                    force[end] += self.design.stiffness * pull;
                }
            }
        }
        let kinetic_of = |n: usize| 0.5 * self.design.masses[n] * self.velocity(n) * self.velocity(n);
        (0..count).for_each(|n| local[n] += kinetic_of(n));
        let kinetic = (0..count).map(kinetic_of).sum();
        let force_term = force.iter().zip(&self.design.masses).map(|(f, m)| f * f / m).sum();
        Energy { local, kinetic, elastic, force_term }
    }

    /// Reverses all velocities.
    ///
    /// # Errors
    /// None that the present state could cause.
    pub(super) fn reverse(&mut self) -> Result<(), Invalid> {
        self.engine.edit(|particles| particles.velocity.iter_mut().for_each(|v| *v = -*v))
    }
}
