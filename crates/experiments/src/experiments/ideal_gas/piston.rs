//! A piston under a constant force: it swings, and comes to rest where the pressure carries it.
//!
//! Gas and piston are isolated: with the enthalpy-like energy `E = E_gas + M u^2/2 + F x` conserved, the place `x` of the piston is
//! distributed as `Q_N(x) (E - F x)^((dN + 1)/2 - 1)`, in the mean near `P A = F`.
//!
//! Displaced a little it swings. The gas is a column of length `l` in which sound runs at `c = sqrt(gamma kT/m)`: with the
//! displacement `sin(k x)` of the gas the force on the piston is `-rho c^2 A k cot(k l)`, so that `k l tan(k l) = N m/M` and
//! `omega = c k`; for a heavy piston `omega^2 = gamma F/(M l)`. Two corrections are kept to first order. The gas becomes isotropic
//! in the time `tau = eta/P` only (viscosity `eta`, first Sonine approximation), so that `gamma` rises towards the 3 of motion along one
//! axis: `gamma + (3 - gamma) w^2/(1 + w^2)` with `w = omega tau`. And a swing of the relative amplitude `a` in the potential of an
//! adiabatic spring is slower by `a^2 (5 (gamma + 1)^2/48 - (gamma + 1)(gamma + 2)/16)` (Landau and Lifshitz, Mechanics, section 28).

use std::ops::ControlFlow;

use corpuscle_checkpoint::resume;
use corpuscle_core::{Boundary, Engine, Failure, Invalid, Piston, Random};
use corpuscle_observe::chart::{Axis, Scale, Series, Style};
use corpuscle_observe::{Chart, Check, Estimate};
use corpuscle_scene::{Colouring, Scene};

use super::system::State;
use super::theory;
use crate::replicas::{Member, Replicas};
use crate::study::{Running, Specimen, Study, Vessel};
use crate::{Settings, ensemble};

/// Samples in the whole duration, and periods; in the last third of it the swing of a light piston has died away.
const SAMPLES: usize = 720;
const PERIODS: f64 = 30.0;
/// The gas starts compressed to this part of its length in equilibrium.
const START: f64 = 0.88;
/// Crossings of the box before the piston is let go.
const BEFORE: f64 = 10.0;
/// The box is so much longer than the gas.
const ROOM: f64 = 2.5;

/// Pistons on gases that are compressed at the start.
pub(super) fn start<const D: usize>(settings: &Settings) -> Result<Running<D, Swing>, Invalid> {
    let state = State::base::<D>(settings);
    let mass = settings.real("piston_mass") * state.count as f64 * state.mass;
    let swing = Swing::new::<D>(state, mass);
    let duration = PERIODS * std::f64::consts::TAU / swing.frequency;
    let streams: Vec<u64> = (0..settings.whole("replicas") as u64).collect();
    let gases = ensemble::build(&streams, |&stream| Loaded::new(&swing, &mut Random::new(settings.seed, stream)))?;
    Ok(Running::new(swing, duration, SAMPLES, gases))
}

/// What is asked.
pub(super) struct Swing {
    state: State,
    mass: f64,
    /// Downward force on the piston.
    force: f64,
    /// Length of the gas open to centres at the start.
    length: f64,
    /// Mean and variance of the length in equilibrium.
    equilibrium: (f64, f64),
    /// Angular frequency of small oscillations.
    frequency: f64,
}

impl Swing {
    /// A gas of the base state's sides, compressed along one axis to `START` of them at the base temperature; the force is what the
    /// ideal gas of this energy carries where it fills the base state's box.
    fn new<const D: usize>(state: State, mass: f64) -> Self {
        let (n, d, whole) = (state.count as f64, D as f64, state.open_side());
        let length = START * whole;
        // E = dN kT/2 + F START a = (dN/2 + 1) kT' in equilibrium with F a = N kT'.
        let ratio = (0.5 * d) / (0.5 * d + 1.0 - START);
        let force = n * ratio * state.temperature / whole;
        let energy = 0.5 * d * n * state.temperature + force * length;
        let mut swing = Self { state, mass, force, length, equilibrium: (whole, 0.0), frequency: 0.0 };
        swing.equilibrium = swing.moments_of_length::<D>(energy);
        let rest = swing.equilibrium.0;
        let temperature = (energy - force * rest) / (0.5 * d * n);
        let gamma = 1.0 + 2.0 / d;
        let frequency = |gamma: f64| (gamma * temperature / state.mass).sqrt() / rest * column(n * state.mass / mass);
        let slow = frequency(gamma) * relaxation::<D>(&state, temperature, rest);
        let amplitude = length / rest - 1.0;
        let bent = 5.0 * (gamma + 1.0) * (gamma + 1.0) / 48.0 - (gamma + 1.0) * (gamma + 2.0) / 16.0;
        swing.frequency =
            frequency(gamma + (3.0 - gamma) * slow * slow / (1.0 + slow * slow)) * (1.0 - bent * amplitude * amplitude);
        swing
    }

    /// Mean and variance of the length, by the trapezium rule over all lengths there can be.
    fn moments_of_length<const D: usize>(&self, energy: f64) -> (f64, f64) {
        const STEPS: usize = 20_000;
        let (state, freedom) = (&self.state, (D * self.state.count + 1) as f64);
        let most = (energy / self.force).min((ROOM - 1.0) * state.open_side());
        let least = 4.0 * state.radius;
        let ln_weight = |x: f64| {
            let mut sides = [state.open_side(); D];
            sides[0] = x;
            let configurations = theory::ln_configurations::<D>(state.count, sides, 2.0 * state.radius);
            configurations + (0.5 * freedom - 1.0) * libm::log(energy - self.force * x)
        };
        let places: Vec<f64> = (1..STEPS).map(|k| least + (most - least) * k as f64 / STEPS as f64).collect();
        let logarithms: Vec<f64> = places.iter().map(|&x| ln_weight(x)).collect();
        let largest = logarithms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let [mut sum, mut first, mut second] = [0.0; 3];
        for (x, ln) in places.iter().zip(&logarithms) {
            let weight = libm::exp(ln - largest);
            (sum, first, second) = (sum + weight, first + weight * x, second + weight * x * x);
        }
        let mean = first / sum;
        (mean, second / sum - mean * mean)
    }
}

/// Time `eta/P` in which stresses relax, of a gas that fills this length: `eta = 1.022 sqrt(m kT/pi)/(2 s)` of discs,
/// `1.016 (5/16) sqrt(m kT/pi)/s^2` of spheres (Chapman and Cowling; Gass 1971, doi:10.1063/1.1675116).
fn relaxation<const D: usize>(state: &State, temperature: f64, length: f64) -> f64 {
    let (s, momentum) = (2.0 * state.radius, (state.mass * temperature / std::f64::consts::PI).sqrt());
    let viscosity = if D == 2 { 1.022 * momentum / (2.0 * s) } else { 1.016 * 5.0 / 16.0 * momentum / (s * s) };
    let volume = length * state.open_side().powi(D as i32 - 1);
    viscosity * volume / (state.count as f64 * temperature)
}

/// `k l` of the slowest oscillation, `k l tan(k l) = r`, by bisection: the left side grows from 0 to infinity below a right angle.
fn column(ratio: f64) -> f64 {
    let (mut low, mut high) = (0.0, std::f64::consts::FRAC_PI_2);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if middle * libm::tan(middle) < ratio { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// A gas with a piston on it.
pub(super) struct Loaded<const D: usize> {
    vessel: Vessel<D>,
    /// Lengths open to centres, and velocities of the piston, at the samples.
    course: Vec<(f64, f64)>,
    radius: f64,
}

resume!(Loaded<const D> { values: [course], parts: [vessel], set_up: [radius] });

impl<const D: usize> Loaded<D> {
    fn new(swing: &Swing, random: &mut Random) -> Result<Self, Invalid> {
        let state = &swing.state;
        let mut short: Boundary<D> = state.boundary();
        short.upper[0] = swing.length + 2.0 * state.radius;
        let particles = state.particles(&short, random)?;
        let gas = Vessel::new(short.clone(), particles, BEFORE * state.crossing(), random)?;
        let mut long = state.boundary();
        long.upper[0] = ROOM * state.side;
        long.piston = Some(Piston {
            axis: 0,
            position: short.upper[0],
            velocity: 0.0,
            mass: swing.mass,
            force: -swing.force,
            stops: [4.0 * state.radius, long.upper[0] - 2.0 * state.radius],
        });
        let vessel = Vessel::new(long, gas.engine.snapshot(), 0.0, random)?;
        Ok(Self { vessel, course: vec![], radius: state.radius })
    }

    fn length(&self) -> f64 {
        self.vessel.engine.piston().map_or(f64::NAN, |piston| piston.position - 2.0 * self.radius)
    }
}

impl<const D: usize> Member for Loaded<D> {
    fn advance(&mut self, time: f64) -> Result<(), Failure> {
        self.vessel.advance(time, &mut |_| ControlFlow::Continue(()))
    }

    fn sample(&mut self) {
        let velocity = self.vessel.engine.piston().map_or(f64::NAN, |piston| piston.velocity);
        self.course.push((self.length(), velocity));
    }

    fn time(&self) -> f64 {
        self.vessel.time()
    }
}

impl<const D: usize> Specimen<D> for Loaded<D> {
    fn vessel(&self) -> &Vessel<D> {
        &self.vessel
    }

    fn vessel_mut(&mut self) -> &mut Vessel<D> {
        &mut self.vessel
    }

    fn conserves_energy(&self) -> bool {
        false
    }
}

type Gases<const D: usize> = Replicas<Loaded<D>>;

/// Samples of one and a half periods: the first three passages of the mean through equilibrium lie in them.
const PASSAGES: usize = (1.5 * SAMPLES as f64 / PERIODS) as usize;

impl Swing {
    /// Angular frequency from the first passage of the mean length through equilibrium and the third, a period later: outwards both.
    fn measured_frequency<const D: usize>(&self, gases: &Gases<D>) -> Estimate {
        let courses: Vec<[f64; PASSAGES]> =
            gases.members.iter().map(|gas| std::array::from_fn(|k| gas.course[k].0 - self.equilibrium.0)).collect();
        let interval = gases.times[1];
        Estimate::jackknife(&courses, |mean| {
            let mut passages = (1..PASSAGES).filter(|&k| mean[k - 1] * mean[k] < 0.0).map(|k| {
                let part = mean[k - 1] / (mean[k - 1] - mean[k]);
                (k as f64 - 1.0 + part) * interval
            });
            match (passages.next(), passages.nth(1)) {
                (Some(first), Some(third)) => std::f64::consts::TAU / (third - first),
                _ => f64::NAN,
            }
        })
    }
}

impl<const D: usize> Study<D> for Swing {
    type Specimen = Loaded<D>;

    fn draw(&self, gases: &Gases<D>, scene: &mut Scene) {
        scene.title = super::EXPERIMENT.title.into();
        scene.colouring = Colouring::Speed { most: 3.0 * self.state.thermal_speed(), unit: String::new() };
        let length = gases.members[0].length();
        scene.caption = format!(
            "length of the gas {:.1}, in equilibrium {:.1}, force on the piston F = {:.3}",
            length, self.equilibrium.0, self.force
        );
    }

    fn charts(&self, gases: &Gases<D>) -> Vec<Chart> {
        let rest = self.equilibrium.0;
        let period = std::f64::consts::TAU / self.frequency;
        let measured = gases.times.iter().enumerate().map(|(k, &time)| {
            let length = gases.mean(|gas| gas.course[k].0 / rest);
            (time, length.mean, length.standard_error)
        });
        let one = gases.times.iter().zip(&gases.members[0].course).map(|(&time, &(length, _))| (time, length / rest));
        let amplitude = self.length / rest - 1.0;
        vec![
            Chart::new("piston", "A piston on a gas", Axis::linear("time t", ""), Axis::linear("length of the gas over that in equilibrium", ""))
                .with(Series::theory("adiabatic spring, undamped", 0.0, 3.0 * period, 200, Scale::Linear, |t| {
                    1.0 + amplitude * libm::cos(self.frequency * t)
                }))
                .with(Series::with_errors("mean of the replicas", Style::Line, measured))
                .with(Series::new("one piston", Style::Line, one))
                .noting("The gas is a spring with γP for its stiffness; friction in it takes the swing out of the mean, thermal motion stays."),
        ]
    }

    fn checks(&self, gases: &Gases<D>) -> Vec<Check> {
        if gases.times.len() <= SAMPLES {
            return vec![];
        }
        let late = |gas: &Loaded<D>, value: &dyn Fn((f64, f64)) -> f64| {
            let course = &gas.course[2 * SAMPLES / 3..];
            course.iter().map(|&point| value(point)).sum::<f64>() / course.len() as f64
        };
        let (rest, variance) = self.equilibrium;
        let mut checks = vec![];
        // In few small gases thermal motion may hide the swing.
        let frequency = self.measured_frequency(gases);
        if frequency.standard_error.is_finite() {
            checks.push(frequency.check(
                "angular frequency of the piston",
                self.frequency,
                "k l tan(k l) = N m/M, omega = k c: the gas as a column in which sound runs",
            ));
        }
        checks.extend([
            gases.mean(|gas| late(gas, &|(length, _)| length)).check(
                "mean length of the gas under the force",
                rest,
                "Q_N(x) (E - F x)^((dN+1)/2 - 1), near P A = F",
            ),
            gases.mean(|gas| late(gas, &|(length, _)| (length - rest) * (length - rest) / variance)).check(
                "variance of the length over theory",
                1.0,
                "the same distribution: an adiabatic spring at kT",
            ),
        ]);
        checks
    }

    fn moments(&self, end: f64) -> Vec<f64> {
        vec![0.0, 0.05 * end]
    }
}
