//! How time passes: the integrators, by name.

mod composition;
mod dormand_prince;
mod dormand_prince_table;
mod gauss_radau;
mod gauss_radau_table;
mod kepler;
mod nose_hoover;
mod runge_kutta;
mod thermal;
mod wisdom_holman;

use corpuscle_checkpoint::{Fault, Reader, Resume, Writer};
use corpuscle_core::{Axis, Failure, Invalid};

use crate::force::{not_negative, positive};
use crate::system::System;
use composition::Composition;
use dormand_prince::DormandPrince;
use gauss_radau::GaussRadau;
use nose_hoover::Chain;
pub(crate) use nose_hoover::Link;
use runge_kutta::RungeKutta;
use thermal::Bath;
use wisdom_holman::WisdomHolman;

/// A rule for advancing positions and velocities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Integrator {
    /// Euler's rule with the old velocity, order 1: `r += v dt`, `v += a dt`. Its energy grows; kept for comparison.
    ExplicitEuler {
        /// Time step.
        dt: f64,
    },
    /// Euler's rule with the new velocity, order 1, symplectic: `v += a dt`, `r += v dt`.
    SymplecticEuler {
        /// Time step.
        dt: f64,
    },
    /// Velocity Verlet, also called leapfrog: order 2, symplectic, reversible, one force evaluation a step.
    VelocityVerlet {
        /// Time step.
        dt: f64,
    },
    /// The classical rule of Runge and Kutta, order 4, four evaluations; not symplectic.
    RungeKutta4 {
        /// Time step.
        dt: f64,
    },
    /// Three velocity Verlet steps of Yoshida's lengths (1990, doi:10.1016/0375-9601(90)90092-3): order 4, symplectic,
    /// reversible, three evaluations.
    Yoshida4 {
        /// Time step.
        dt: f64,
    },
    /// Seven velocity Verlet steps of Yoshida's lengths (1990, solution A): order 6, symplectic, reversible, seven evaluations.
    Yoshida6 {
        /// Time step.
        dt: f64,
    },
    /// Fifteen velocity Verlet steps (Suzuki and Umeno 1993, doi:10.1007/978-3-642-78448-4_7): order 8, symplectic, reversible,
    /// fifteen evaluations.
    Yoshida8 {
        /// Time step.
        dt: f64,
    },
    /// Gauss-Radau collocation of order 15 that chooses its step (Everhart 1985, doi:10.1007/978-94-009-5400-7_17;
    /// Rein and Spiegel 2015, doi:10.1093/mnras/stu2164). Needs smooth forces: hard walls are refused.
    GaussRadau15 {
        /// The share of the acceleration that the last term of its series may have; `1e-9` reaches rounding error.
        tolerance: f64,
        /// Length of the first step tried; chosen from the accelerations when absent.
        first_step: Option<f64>,
    },
    /// Kepler orbits around the heaviest body, kicked by the others (Wisdom and Holman 1991, doi:10.1086/115978; democratic
    /// heliocentric coordinates): order 2, symplectic, errors smaller than velocity Verlet's by the planets' share of the
    /// mass. Needs unsoftened gravity alone, and planets that stay away from each other.
    WisdomHolman {
        /// Time step.
        dt: f64,
    },
    /// Langevin's equation `m dv = (F - m gamma v) dt + sqrt(2 m gamma k T) dW` by the splitting BAOAB (Leimkuhler and Matthews
    /// 2013, doi:10.1063/1.4802990): canonical, order 2 in averages, one evaluation a step. Without friction, velocity Verlet.
    Langevin {
        /// Time step.
        dt: f64,
        /// Temperature `k T`.
        temperature: f64,
        /// Friction `gamma`, a rate.
        friction: f64,
        /// Seed of the noise.
        seed: u64,
    },
    /// Brownian motion `dr = F/(m gamma) dt + sqrt(2 k T/(m gamma)) dW`, the limit of strong friction, by the rule of
    /// Leimkuhler and Matthews (2013, doi:10.1093/amrx/abs010): order 2 in averages over configurations. Velocities are the mean
    /// drift `F/(m gamma)`, not thermal.
    Brownian {
        /// Time step.
        dt: f64,
        /// Temperature `k T`.
        temperature: f64,
        /// Friction `gamma`, a rate.
        friction: f64,
        /// Seed of the noise.
        seed: u64,
    },
    /// Velocity Verlet with all velocities rescaled after each step, so that the kinetic energy follows its canonical
    /// distribution (Bussi, Donadio and Parrinello 2007, doi:10.1063/1.2408420): hardly disturbs the dynamics.
    StochasticRescaling {
        /// Time step.
        dt: f64,
        /// Temperature `k T`.
        temperature: f64,
        /// Time in which the kinetic energy forgets where it was.
        relaxation_time: f64,
        /// Velocities that move freely: `D N`, or `D (N - 1)` where the total momentum is conserved and zero.
        degrees_of_freedom: u32,
        /// Seed of the noise.
        seed: u64,
    },
    /// Velocity Verlet with a chain of Nose-Hoover thermostats (Martyna, Klein and Tuckerman 1992, doi:10.1063/1.463940; Martyna,
    /// Tuckerman, Tobias and Klein 1996, doi:10.1080/00268979600100761): canonical without random numbers, reversible, and with a
    /// conserved quantity, [`TimeDriven::conserved_energy`](crate::TimeDriven::conserved_energy). A single link fails where the motion
    /// is too regular, as in one harmonic oscillator; three or more do not.
    NoseHoover {
        /// Time step.
        dt: f64,
        /// Temperature `k T`.
        temperature: f64,
        /// Time scale `tau` on which heat flows: inertias are `f k T tau^2` for the first link, `k T tau^2` for the others. Of
        /// the order of the motion's own period.
        relaxation_time: f64,
        /// Velocities that move freely, `f`: `D N`, or `D (N - 1)` where the total momentum is conserved and zero.
        degrees_of_freedom: u32,
        /// Links of the chain, 1 to 64.
        links: u32,
    },
    /// Dormand and Prince's Runge-Kutta method of order 8 that chooses its step by errors of order 5 and 3, with dense output
    /// of order 7 (Hairer, Norsett and Wanner 1993, doi:10.1007/978-3-540-78862-1). Needs smooth forces, not very precise
    /// ones: hard walls are refused.
    DormandPrince8 {
        /// The error that a step may make, as a share of the largest distance from the origin and of the largest speed.
        tolerance: f64,
        /// Length of the first step tried; chosen from the accelerations when absent.
        first_step: Option<f64>,
    },
}

impl Integrator {
    /// Names of the integrators that need no more than a step; thermostats need a temperature as well.
    pub const NAMES: [&'static str; 10] = [
        "explicit-euler",
        "symplectic-euler",
        "velocity-verlet",
        "runge-kutta-4",
        "yoshida-4",
        "gauss-radau-15",
        "yoshida-6",
        "yoshida-8",
        "dormand-prince-8",
        "wisdom-holman",
    ];

    /// The integrator of that name. The adaptive ones take `dt` as the first step to try, and tolerance
    /// `1e-9` (Gauss-Radau) or `1e-12` (Dormand-Prince).
    ///
    /// # Errors
    /// When there is no such name, or the step is not a positive number.
    pub fn from_name(name: &str, dt: f64) -> Result<Self, Invalid> {
        let integrator = match name {
            "explicit-euler" => Self::ExplicitEuler { dt },
            "symplectic-euler" => Self::SymplecticEuler { dt },
            "velocity-verlet" => Self::VelocityVerlet { dt },
            "runge-kutta-4" => Self::RungeKutta4 { dt },
            "yoshida-4" => Self::Yoshida4 { dt },
            "yoshida-6" => Self::Yoshida6 { dt },
            "yoshida-8" => Self::Yoshida8 { dt },
            "wisdom-holman" => Self::WisdomHolman { dt },
            "dormand-prince-8" => Self::DormandPrince8 { tolerance: 1e-12, first_step: Some(dt) },
            "gauss-radau-15" => Self::GaussRadau15 { tolerance: 1e-9, first_step: Some(dt) },
            _ => return Err(Invalid::new("integrator", name, format!("one of {}", Self::NAMES.join(", ")))),
        };
        integrator.validate()?;
        Ok(integrator)
    }

    /// Name; those of [`NAMES`](Self::NAMES) are what [`from_name`](Self::from_name) takes.
    pub fn name(&self) -> &'static str {
        match self {
            Self::ExplicitEuler { .. } => Self::NAMES[0],
            Self::SymplecticEuler { .. } => Self::NAMES[1],
            Self::VelocityVerlet { .. } => Self::NAMES[2],
            Self::RungeKutta4 { .. } => Self::NAMES[3],
            Self::Yoshida4 { .. } => Self::NAMES[4],
            Self::GaussRadau15 { .. } => Self::NAMES[5],
            Self::Yoshida6 { .. } => Self::NAMES[6],
            Self::Yoshida8 { .. } => Self::NAMES[7],
            Self::DormandPrince8 { .. } => Self::NAMES[8],
            Self::WisdomHolman { .. } => Self::NAMES[9],
            Self::Langevin { .. } => "langevin",
            Self::Brownian { .. } => "brownian",
            Self::StochasticRescaling { .. } => "stochastic-rescaling",
            Self::NoseHoover { .. } => "nose-hoover",
        }
    }

    /// Order `p`: the error at a fixed time is proportional to `dt^p`; for a thermostat, that of averages.
    pub fn order(&self) -> u32 {
        match self {
            Self::ExplicitEuler { .. } | Self::SymplecticEuler { .. } => 1,
            Self::VelocityVerlet { .. }
            | Self::WisdomHolman { .. }
            | Self::Langevin { .. }
            | Self::Brownian { .. }
            | Self::StochasticRescaling { .. }
            | Self::NoseHoover { .. } => 2,
            Self::RungeKutta4 { .. } | Self::Yoshida4 { .. } => 4,
            Self::Yoshida6 { .. } => 6,
            Self::Yoshida8 { .. } | Self::DormandPrince8 { .. } => 8,
            Self::GaussRadau15 { .. } => 15,
        }
    }

    /// Whether the flow keeps phase-space volume and, with it, energy within bounds.
    pub fn is_symplectic(&self) -> bool {
        matches!(
            self,
            Self::SymplecticEuler { .. }
                | Self::VelocityVerlet { .. }
                | Self::Yoshida4 { .. }
                | Self::Yoshida6 { .. }
                | Self::Yoshida8 { .. }
                | Self::WisdomHolman { .. }
        )
    }

    /// Length of the step, where it is fixed.
    pub fn dt(&self) -> Option<f64> {
        match *self {
            Self::ExplicitEuler { dt }
            | Self::SymplecticEuler { dt }
            | Self::VelocityVerlet { dt }
            | Self::RungeKutta4 { dt }
            | Self::Yoshida4 { dt }
            | Self::Yoshida6 { dt }
            | Self::Yoshida8 { dt }
            | Self::WisdomHolman { dt }
            | Self::Langevin { dt, .. }
            | Self::Brownian { dt, .. }
            | Self::StochasticRescaling { dt, .. }
            | Self::NoseHoover { dt, .. } => Some(dt),
            Self::GaussRadau15 { .. } | Self::DormandPrince8 { .. } => None,
        }
    }

    pub(crate) fn validate(&self) -> Result<(), Invalid> {
        match *self {
            Self::GaussRadau15 { tolerance, first_step } | Self::DormandPrince8 { tolerance, first_step } => {
                positive("tolerance", tolerance)?;
                first_step.map_or(Ok(()), |step| positive("first step", step))
            }
            Self::Langevin { dt, temperature, friction, .. } => {
                positive("dt", dt)?;
                not_negative("temperature", temperature)?;
                not_negative("friction", friction)
            }
            Self::Brownian { dt, temperature, friction, .. } => {
                positive("dt", dt)?;
                not_negative("temperature", temperature)?;
                positive("friction", friction)
            }
            Self::StochasticRescaling { dt, temperature, relaxation_time, degrees_of_freedom, .. } => {
                positive("dt", dt)?;
                not_negative("temperature", temperature)?;
                positive("relaxation time", relaxation_time)?;
                positive("degrees of freedom", f64::from(degrees_of_freedom))
            }
            Self::NoseHoover { dt, temperature, relaxation_time, degrees_of_freedom, links } => {
                positive("dt", dt)?;
                positive("temperature", temperature)?;
                positive("relaxation time", relaxation_time)?;
                positive("degrees of freedom", f64::from(degrees_of_freedom))?;
                if !(1..=64).contains(&links) {
                    return Err(Invalid::new("links", links, "1 to 64"));
                }
                Ok(())
            }
            _ => self.dt().map_or(Ok(()), |dt| positive("dt", dt)),
        }
    }

    pub(crate) fn stepper<const D: usize>(&self) -> Stepper<D> {
        match *self {
            Self::ExplicitEuler { .. } => Stepper::RungeKutta(RungeKutta::new(&runge_kutta::EULER)),
            Self::RungeKutta4 { .. } => Stepper::RungeKutta(RungeKutta::new(&runge_kutta::CLASSICAL)),
            Self::SymplecticEuler { .. } => Stepper::Composition(composition::SYMPLECTIC_EULER),
            Self::VelocityVerlet { .. } => Stepper::Composition(&composition::VELOCITY_VERLET),
            Self::Yoshida4 { .. } => Stepper::Composition(&composition::YOSHIDA_4),
            Self::Yoshida6 { .. } => Stepper::Composition(&composition::YOSHIDA_6),
            Self::Yoshida8 { .. } => Stepper::Composition(&composition::YOSHIDA_8),
            Self::GaussRadau15 { tolerance, first_step } => Stepper::Adaptive(Box::new(GaussRadau::new(tolerance, first_step))),
            Self::WisdomHolman { .. } => Stepper::WisdomHolman(WisdomHolman::default()),
            Self::Langevin { temperature, friction, seed, .. } => Stepper::Bath(Bath::Langevin { temperature, friction, seed }),
            Self::Brownian { temperature, friction, seed, .. } => Stepper::Bath(Bath::Brownian { temperature, friction, seed }),
            Self::StochasticRescaling { temperature, relaxation_time, degrees_of_freedom, seed, .. } => {
                Stepper::Bath(Bath::Rescaling { temperature, relaxation_time, degrees_of_freedom, seed })
            }
            Self::NoseHoover { temperature, relaxation_time, degrees_of_freedom, links, .. } => {
                Stepper::NoseHoover(Chain::new(temperature, relaxation_time, degrees_of_freedom, links))
            }
            Self::DormandPrince8 { tolerance, first_step } => {
                Stepper::Adaptive(Box::new(DormandPrince::new(tolerance, first_step)))
            }
        }
    }
}

/// An integrator that chooses its steps and knows the trajectory between them.
pub(crate) trait Adaptive<const D: usize>: Send + Resume {
    /// How many particles it holds.
    fn particle_count(&self) -> usize;

    /// Time up to which the trajectory is known.
    fn reached(&self) -> f64;

    /// Forgets the past: the next step starts from the system as it is at `time`.
    fn restart(&mut self, system: &mut System<D>, time: f64);

    /// Takes one step, of a length it chooses. The system's particles are left somewhere within it.
    fn step(&mut self, system: &mut System<D>) -> Result<(), Failure>;

    /// Writes the state at `time`, which lies within the last step, into the system's particles.
    fn interpolate(&mut self, system: &mut System<D>, time: f64);
}

/// A step that would have to be so short that time stands still.
fn too_close(time: f64, particle: Option<usize>, dt: f64) -> Failure {
    let cause = format!(
        "the step needed, {dt:.1e}, is below the resolution of time: particles come too close; \
         soften the force or start a little differently"
    );
    Failure { time, particle, cause }
}

/// An integrator with its working memory.
pub(crate) enum Stepper<const D: usize> {
    Composition(&'static Composition),
    RungeKutta(RungeKutta<D>),
    WisdomHolman(WisdomHolman<D>),
    Bath(Bath),
    NoseHoover(Chain),
    Adaptive(Box<dyn Adaptive<D>>),
}

impl<const D: usize> Stepper<D> {
    /// Makes the system as it is at `time` the one to go on from.
    pub(crate) fn restart(&mut self, system: &mut System<D>, time: f64, name: &str) -> Result<(), Invalid> {
        let smooth = matches!(self, Self::Adaptive(_) | Self::WisdomHolman(_));
        if smooth && system.boundary.axes.contains(&Axis::Walls) {
            return Err(Invalid::new(
                "integrator",
                name,
                "one of fixed steps where there are hard walls: a reflection is not smooth",
            ));
        }
        match self {
            Self::Adaptive(method) => method.restart(system, time),
            Self::WisdomHolman(map) => map.admit(system)?,
            Self::Bath(_) => Bath::admit(system)?,
            Self::NoseHoover(_) => Chain::admit(system)?,
            Self::Composition(_) | Self::RungeKutta(_) => {}
        }
        Ok(())
    }

    /// One step of a fixed-step integrator, from `start` to `end`.
    pub(crate) fn step(&mut self, system: &mut System<D>, start: f64, end: f64, dt: f64) -> Result<(), Failure> {
        match self {
            Self::Composition(stages) => composition::step(stages, system, start, end, dt),
            Self::RungeKutta(method) => method.step(system, start, end, dt),
            Self::WisdomHolman(map) => map.step(system, start, end, dt),
            Self::Bath(bath) => bath.step(system, start, end, dt),
            Self::NoseHoover(chain) => chain.step(system, start, end, dt),
            Self::Adaptive(_) => Ok(()), // chooses its own steps: see `TimeDriven::advance`
        }
    }

    /// The state of a heat bath that has one.
    pub(crate) fn links(&self) -> &[Link] {
        if let Self::NoseHoover(chain) = self { &chain.links } else { &[] }
    }

    /// Puts such a bath back into a state it had.
    pub(crate) fn set_links(&mut self, links: &[Link]) {
        if let Self::NoseHoover(chain) = self {
            chain.links.copy_from_slice(links);
        }
    }

    /// Energy that is neither kinetic nor potential, but conserved together with these.
    pub(crate) fn energy(&self) -> f64 {
        if let Self::NoseHoover(chain) = self { chain.energy() } else { 0.0 }
    }
}

/// What an integrator remembers from step to step beside the system; working memory is not written down.
impl<const D: usize> Resume for Stepper<D> {
    fn save(&self, out: &mut Writer) -> Result<(), Fault> {
        match self {
            Self::Adaptive(method) => method.save(out),
            Self::NoseHoover(chain) => chain.save(out),
            // Random numbers belong to the step and the particle: a bath remembers nothing.
            Self::Composition(_) | Self::RungeKutta(_) | Self::WisdomHolman(_) | Self::Bath(_) => out.fields(0),
        }
    }

    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), Fault> {
        match self {
            Self::Adaptive(method) => method.load(from),
            Self::NoseHoover(chain) => chain.load(from),
            Self::Composition(_) | Self::RungeKutta(_) | Self::WisdomHolman(_) | Self::Bath(_) => from.fields(0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_leads_to_the_integrator_of_that_name() {
        for name in Integrator::NAMES {
            assert_eq!(Integrator::from_name(name, 0.01).unwrap().name(), name);
        }
        assert!(Integrator::from_name("euler", 0.01).unwrap_err().expected.contains("velocity-verlet"));
        assert_eq!(Integrator::from_name("yoshida-4", -0.5).unwrap_err().key, "dt");
    }
}
