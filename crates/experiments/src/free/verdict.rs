//! What is checked of a free system: conservation laws, and the equation of state where one is known.

use corpuscle_core::particles::ball_volume;
use corpuscle_core::{Axis as Faces, Engine, Vector};
use corpuscle_observe::{Check, Estimate, blocking, theory};

use super::build::{AnyEngine, EnergyLaw};
use super::run::Free;
use super::sample::Sample;
use super::spec::Observable;
use crate::Honesty;
use crate::horizon::precision_horizon;

/// Energy a time-driven run may lose or win of the largest kinetic energy and still be called conservative: a choice, not a
/// theorem. A slope against zero would be no better: the energy error of a few bodies is quasi-periodic and that of a
/// truncated potential a random walk, so that neither has the independent parts a standard error needs.
const ENERGY_BOUND: f64 = 0.01;
/// The same for what is conserved up to rounding.
const ROUNDING_BOUND: f64 = 1e-10;

/// The largest departure of what should be conserved from its start, over the largest scale seen: a system may start at
/// rest.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
pub(super) struct Conserved<const K: usize> {
    start: Option<Vector<K>>,
    largest: f64,
    scale: f64,
}

impl<const K: usize> Conserved<K> {
    pub(super) const fn new() -> Self {
        Self { start: None, largest: 0.0, scale: 0.0 }
    }

    pub(super) fn see(&mut self, value: [f64; K], scale: f64) {
        let start = self.start.get_or_insert(Vector(value)).0;
        let departure = value.iter().zip(start).map(|(x, x0)| (x - x0) * (x - x0)).sum::<f64>().sqrt();
        // f64::max would let a value that is not a number pass unseen.
        self.largest = self.largest.max(if departure.is_nan() { f64::INFINITY } else { departure });
        self.scale = self.scale.max(scale);
    }

    pub(super) fn relative(&self) -> f64 {
        if self.largest == 0.0 { 0.0 } else { self.largest / self.scale }
    }
}

impl<const D: usize> Free<D> {
    pub(super) fn all_checks(&self) -> Vec<Check> {
        let mut checks = match &self.engine {
            AnyEngine::Event(_) => vec![self.energy_of_collisions()],
            AnyEngine::Time(_) if self.energy_law == EnergyLaw::Stays => vec![Check::at_most(
                "largest energy error, over the largest kinetic energy",
                self.motion.relative(),
                ENERGY_BOUND,
                "forces with a potential conserve energy; a hundredth is what is allowed to the integrator",
            )],
            AnyEngine::Time(_) if self.energy_law == EnergyLaw::Free => vec![],
            AnyEngine::Time(_) => vec![Check::at_most(
                "largest rise of the energy, over the largest kinetic energy",
                self.rise_over_motion(),
                ENERGY_BOUND,
                "damping only takes energy; a hundredth is what is allowed to the integrator",
            )],
        };
        if self.closed {
            checks.push(Check::at_most(
                "largest momentum drift, relative",
                self.momentum.relative(),
                ROUNDING_BOUND,
                "no walls, no field: double precision",
            ));
        }
        if self.done() {
            checks.extend(self.equipartition());
            checks.extend(self.equation_of_state());
            checks.extend(self.virial_theorem());
        }
        checks
    }

    /// The kinetic temperature against that of the bath, where nothing else gives or takes heat.
    fn equipartition(&self) -> Option<Check> {
        let bath = self.bath.filter(|bath| bath.thermal && bath.alone)?;
        let series: Vec<f64> = self.settled().iter().map(|sample| sample.temperature).collect();
        let mean = blocking(&series);
        mean.plateau.then(|| mean.estimate.check("kinetic temperature", bath.temperature, "equipartition, in a heat bath"))
    }

    fn rise_over_motion(&self) -> f64 {
        let largest = self.samples.iter().map(|sample| sample.kinetic).fold(0.0, f64::max);
        if self.rise > 0.0 { self.rise / largest } else { 0.0 }
    }

    /// What collisions do to the energy, apart from what warm and moving walls gave.
    fn energy_of_collisions(&self) -> Check {
        let walls = if self.isolated() { "" } else { " less what walls gave" };
        if self.elastic {
            let quantity = format!("largest energy drift{walls}, relative");
            return Check::at_most(quantity, self.energy.relative(), ROUNDING_BOUND, "elastic collisions, double precision");
        }
        let scale = |sample: &Sample| sample.kinetic + sample.potential.abs();
        let largest = self.samples.iter().map(scale).fold(0.0, f64::max) + self.given.energy().abs();
        let rise = if self.rise > 0.0 { self.rise / largest } else { 0.0 };
        let quantity = format!("largest rise of the energy{walls}, relative");
        Check::at_most(quantity, rise, ROUNDING_BOUND, "inelastic collisions only take energy")
    }

    /// Whether all particles are hard spheres of one radius and mass, in equilibrium among themselves.
    fn uniform_hard_spheres(&self) -> Option<f64> {
        let particles = &self.start_particles;
        let (radius, mass) = (particles.radius[0], particles.mass[0]);
        let alike = particles.radius.iter().all(|&r| r == radius) && particles.mass.iter().all(|&m| m == mass);
        (alike && self.keeps_temperature() && self.has_pressure() && radius > 0.0).then_some(radius)
    }

    /// `Z` of a periodic gas against the equation of state.
    fn equation_of_state(&self) -> Option<Check> {
        let radius = self.uniform_hard_spheres()?;
        let boundary = self.engine.boundary();
        let count = self.start_particles.len();
        let packing = count as f64 * ball_volume::<D>(radius) / boundary.volume();
        let periodic = boundary.axes.iter().all(|&axis| axis == Faces::Periodic);
        // Below a hundred particles further terms of order 1/N would show; denser fluids are out of the equations' reach.
        if !periodic || count < 100 || packing >= 0.45 {
            return None;
        }
        let (finite, source) = if D == 2 {
            (theory::hard_discs::liquid_of_few(packing, count), "ten virial coefficients, Clisby and McCoy 2006, of a fixed number")
        } else {
            let z = theory::compressibility::<D>(packing) + theory::finite_size_shift::<D>(packing, count);
            (z, "Carnahan and Starling 1969, hard spheres, of a fixed number")
        };
        Some(self.virial_pressure.compressibility().check("compressibility factor Z", finite, source))
    }

    /// Pressure on the walls against the virial's. Both come from the same collisions, so their errors are not independent:
    /// the differences in blocks of time are what is compared with zero.
    fn virial_theorem(&self) -> Option<Check> {
        self.uniform_hard_spheres()?;
        if !self.observe.contains(&Observable::Pressure)
            || self.engine.boundary().axes.iter().any(|&axis| axis != Faces::Walls)
            || self.wall_pressure.hits() < 1000
        {
            return None;
        }
        let (wall, virial) = (self.wall_pressure.blocks(), self.virial_pressure.blocks());
        let differences: Vec<f64> = wall.iter().zip(&virial).map(|(wall, virial)| wall - virial).collect();
        let mut check = blocking(&differences).trusted().check("pressure on the walls P", 0.0, "the virial theorem, same run");
        let expected = self.virial_pressure.estimate().mean;
        (check.measured, check.expected) = (expected + check.measured, expected);
        Some(check)
    }

    /// Pressure with its error, by each way that applies, if it is asked for.
    pub(super) fn pressures(&self) -> Vec<(&'static str, Estimate)> {
        let mut pressures = vec![];
        if !self.observe.contains(&Observable::Pressure) || !self.has_pressure() || self.settled_from.is_none() {
            return pressures;
        }
        if self.wall_pressure.hits() > 0 {
            pressures.push(("on the walls", self.wall_pressure.estimate()));
        }
        match &self.engine {
            AnyEngine::Event(_) if self.keeps_temperature() => pressures.push(("from the virial", self.virial_pressure.estimate())),
            AnyEngine::Event(_) => {}
            AnyEngine::Time(_) => {
                let series: Vec<f64> = self.settled().iter().map(|sample| sample.pressure).collect();
                pressures.push(("from the virial", blocking(&series).estimate));
            }
        }
        pressures
    }

    /// Numerical quality.
    pub(super) fn quality(&self) -> Honesty {
        let (engine, work, work_unit, largest_overlap) = match &self.engine {
            AnyEngine::Event(engine) => {
                let counts = engine.counts();
                let diameter = 2.0 * self.start_particles.radius.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
                let overlap = engine.boundary().largest_overlap(&engine.snapshot()) / diameter;
                ("event-driven".into(), counts.collisions + counts.wall_collisions, "collisions", Some(overlap))
            }
            AnyEngine::Time(engine) => (format!("time-driven, {}", engine.integrator().name()), engine.steps(), "steps", None),
        };
        Honesty {
            engine,
            work,
            work_unit,
            largest_overlap,
            energy_drift: match &self.engine {
                AnyEngine::Event(_) => self.elastic.then(|| self.energy.relative()),
                AnyEngine::Time(_) => (self.energy_law == EnergyLaw::Stays).then(|| self.motion.relative()),
            },
            momentum_drift: self.closed.then(|| self.momentum.relative()),
            angular_momentum_drift: self.keeps_angular_momentum().then(|| self.angular_momentum.relative()),
            rejected_events: match &self.engine {
                AnyEngine::Event(engine) => Some(engine.counts().stale),
                AnyEngine::Time(_) => None,
            },
            precision_horizon: match &self.engine {
                AnyEngine::Event(engine) => precision_horizon(engine),
                AnyEngine::Time(_) => None,
            },
            ..Honesty::default()
        }
    }
}
