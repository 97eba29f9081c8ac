//! Sound in a gas of hard discs: particles are pushed together in one place, and the crowd runs away to both sides.
//!
//! A dense gas carries sound with `c^2 = (kT/m)(d(eta Z)/d eta + Z^2)` in the plane ([`theory::speed_of_sound`]): mechanics of
//! single collisions on one side, the adiabats of thermodynamics on the other. Long waves of a periodic tube of length `L`,
//! `k = 2 pi/L`, follow from `J = sum v_x cos(k x)` and `R = sum sin(k x)`: `dR/dt = k J` exactly, and
//! `dJ/dt = -c^2 k R - 2 Gamma k^2 J` in linear hydrodynamics, with the attenuation `Gamma` of viscosity and heat conduction. Both
//! constants come out of one linear regression of `J(t) - J(0)` on `int R dt` and `R(t) - R(0)`.
//!
//! Each tube is run twice, with the push and with its opposite; half the difference has no part that is of second order in
//! the push, nor, for a while, the noise that both have in common.

mod tube;

use corpuscle_checkpoint::{Resume, resume};
use corpuscle_core::{Failure, Invalid};
use corpuscle_observe::chart::{Axis, Scale, Series, Style};
use corpuscle_observe::{Chart, Check, Estimate, theory};
use corpuscle_scene::{Camera, Colouring, Scene};

use crate::replicas::{Replicas, energy_check, honesty};
use crate::{Experiment, Honesty, Kind, Parameter, Settings, Simulation, drawing, ensemble, peek};
use tube::{BINS, Set, Tube};

/// The registry's entry.
pub(crate) static EXPERIMENT: Experiment = Experiment {
    name: "sound",
    title: "Sound in a gas of discs",
    summary: "A push sends two waves of density through a gas of hard discs; their speed is the one the equation of state \
              demands.",
    dimensions: &[2],
    engines: &["event-driven"],
    parameters: PARAMETERS,
    start,
};

static PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "particles",
        unit: "",
        help: "Number of discs in a tube four times as long as wide.",
        kind: Kind::Whole { default: 600, least: 50, most: 100_000 },
    },
    Parameter {
        name: "packing_fraction",
        unit: "",
        help: "Area of the discs over that of the tube.",
        kind: Kind::Real { default: 0.3, least: 0.02, most: 0.6 },
    },
    Parameter {
        name: "temperature",
        unit: "",
        help: "Temperature k_B T; sound is faster where it is warm.",
        kind: Kind::Real { default: 1.0, least: 1e-6, most: 1e6 },
    },
    Parameter {
        name: "push",
        unit: "c",
        help: "Speed of the push in its middle, in speeds of sound.",
        kind: Kind::Real { default: 0.12, least: 1e-3, most: 0.3 },
    },
    Parameter {
        name: "duration",
        unit: "L/c",
        help: "How long is watched, in times in which sound runs through the tube.",
        kind: Kind::Real { default: 1.5, least: 0.5, most: 20.0 },
    },
    Parameter {
        name: "replicas",
        unit: "",
        help: "Independent pairs of tubes; their scatter gives the error bars. The first is on show.",
        kind: Kind::Whole { default: 32, least: 3, most: 10_000 },
    },
];

/// Samples in the time in which sound runs through the tube.
const RESOLUTION: f64 = 48.0;

fn start(settings: &Settings) -> Result<Box<dyn Simulation>, Invalid> {
    Ok(Box::new(Sound::new(settings)?))
}

/// The running experiment.
struct Sound {
    set: Set,
    duration: f64,
    tubes: Replicas<Tube>,
}

resume!(Sound { values: [], parts: [tubes], set_up: [set, duration] });

/// `c^2` and `2 Gamma` by least squares, from the mean of `J` and `R` at equal intervals.
fn regression(current: &[f64], density: &[f64], k: f64, interval: f64) -> [f64; 2] {
    let mut integral = 0.0;
    let (mut aa, mut ab, mut bb, mut ay, mut by) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for m in 1..current.len() {
        // The trapezium with the slopes at its ends, which are k J: of fourth order.
        integral += 0.5 * interval * (density[m - 1] + density[m]) + interval * interval / 12.0 * k * (current[m - 1] - current[m]);
        let (a, b, y) = (-k * integral, -k * (density[m] - density[0]), current[m] - current[0]);
        (aa, ab, bb, ay, by) = (aa + a * a, ab + a * b, bb + b * b, ay + a * y, by + b * y);
    }
    let determinant = aa * bb - ab * ab;
    [(ay * bb - by * ab) / determinant, (by * aa - ay * ab) / determinant]
}

impl Sound {
    fn new(settings: &Settings) -> Result<Self, Invalid> {
        let set = Set::new(settings)?;
        let streams: Vec<u64> = (0..settings.whole("replicas") as u64).collect();
        let members = ensemble::build(&streams, |&stream| Tube::new(&set, stream))?;
        let passage = set.length() / set.speed;
        let duration = settings.real("duration") * passage;
        Ok(Self { duration, tubes: Replicas::new(passage / RESOLUTION, members), set })
    }

    /// Means over the tubes of `J` and `R`, one tube left out or none.
    fn means(&self, left_out: Option<usize>) -> [Vec<f64>; 2] {
        let mut sums = [vec![0.0; self.tubes.times.len()], vec![0.0; self.tubes.times.len()]];
        let rest = self.tubes.members.iter().enumerate().filter(|(r, _)| Some(*r) != left_out);
        for (_, tube) in rest {
            for (m, sample) in tube.samples.iter().enumerate() {
                sums[0][m] += sample.current;
                sums[1][m] += sample.density;
            }
        }
        let count = self.tubes.members.len() as f64 - f64::from(u8::from(left_out.is_some()));
        sums.map(|sum| sum.into_iter().map(|x| x / count).collect())
    }

    /// `c^2` and `2 Gamma`, each by the delete-one jackknife over the tubes.
    fn constants(&self) -> [Estimate; 2] {
        let (k, interval) = (self.set.wave_number(), self.tubes.times[1] - self.tubes.times[0]);
        let fit = |left_out: Option<usize>| {
            let [current, density] = self.means(left_out);
            regression(&current, &density, k, interval)
        };
        let (whole, count) = (fit(None), self.tubes.members.len());
        let without: Vec<[f64; 2]> = (0..count).map(|r| fit(Some(r))).collect();
        std::array::from_fn(|which| {
            // Pseudo-values, whose mean and scatter are the jackknife's.
            let pseudo = without.iter().map(|fit| count as f64 * whole[which] - (count as f64 - 1.0) * fit[which]);
            Estimate::from_replicas(&pseudo.collect::<Vec<_>>())
        })
    }

    fn speed(&self) -> Estimate {
        let [square, _] = self.constants();
        let speed = square.mean.max(0.0).sqrt();
        square.map(speed, 0.5 / speed)
    }

    fn enough(&self) -> bool {
        self.tubes.sampled() >= 0.49 * self.set.length() / self.set.speed
    }

    fn wave_chart(&self) -> Chart {
        let set = &self.set;
        let (k, amplitude) = (set.wave_number(), 0.5 * set.push);
        let scale = 2.0 / set.particles() as f64;
        let omega = set.speed * k;
        let damping = if self.enough() { (0.5 * self.constants()[1].mean * k * k).max(0.0) } else { 0.0 };
        let end = self.tubes.sampled();
        let points = |pick: fn(&tube::Sample) -> f64, scale: f64| {
            let mean = move |m: usize| self.tubes.mean(|tube| scale * pick(&tube.samples[m]));
            (0..self.tubes.times.len())
                .map(move |m| (self.tubes.times[m], mean(m).mean, mean(m).standard_error))
                .collect::<Vec<_>>()
        };
        Chart::new("wave", "The longest wave", Axis::linear("time t", ""), Axis::linear("amplitude over that at the start", ""))
            .with(Series::theory("cos(c k t) exp(−Γ k² t)", 0.0, end, 160, Scale::Linear, |t| {
                libm::cos(omega * t) * libm::exp(-damping * t)
            }))
            .with(Series::with_errors("velocity", Style::Points, points(|sample| sample.current, scale / amplitude)))
            .with(Series::theory("sin(c k t) exp(−Γ k² t)", 0.0, end, 160, Scale::Linear, |t| {
                libm::sin(omega * t) * libm::exp(-damping * t)
            }))
            .with(Series::with_errors(
                "density, times c",
                Style::Points,
                points(|sample| sample.density, scale * set.speed / amplitude),
            ))
            .noting("The frequency is theory's, from the equation of state alone; the damping Γ is the measured one.")
    }

    fn profile_chart(&self) -> Chart {
        let set = &self.set;
        let length = set.length();
        let last = self.tubes.times.len() - 1;
        let per_bin = set.particles() as f64 / BINS as f64;
        let damping = if self.enough() { (0.5 * self.constants()[1].mean).max(0.0) } else { 0.0 };
        let mut chart = Chart::new(
            "profile",
            "The density along the tube",
            Axis::linear("place x − x₀", ""),
            Axis::linear("change of density δn/n", ""),
        );
        let eighth = (RESOLUTION / 8.0) as usize;
        for step in (1..=3).map(|step| step * eighth).filter(|&step| step <= last) {
            let time = self.tubes.times[step];
            let place = |bin: usize| length * ((bin as f64 + 0.5) / BINS as f64 - 0.5);
            let measured = (0..BINS).map(|bin| {
                let change = self.tubes.mean(|tube| tube.samples[step].bins[bin] / per_bin);
                (place(bin), change.mean, change.standard_error)
            });
            let name = format!("t = {:.2} L/c", time * set.speed / length);
            chart = chart
                .with(Series::theory(format!("{name}, theory"), -0.5 * length, 0.5 * length, 120, Scale::Linear, |x| {
                    set.density_change(x, time, damping)
                }))
                .with(Series::with_errors(name, Style::Points, measured));
        }
        chart.noting("Ahead of the push the gas is denser, behind it thinner; both run off with the speed of sound.")
    }
}

impl Simulation for Sound {
    fn state(&self) -> Option<&dyn Resume> {
        Some(self)
    }

    fn state_mut(&mut self) -> Option<&mut dyn Resume> {
        Some(self)
    }

    fn time(&self) -> f64 {
        self.tubes.time()
    }

    fn end(&self) -> f64 {
        self.duration
    }

    fn advance(&mut self, to: f64) -> Result<(), Failure> {
        self.tubes.advance(to)
    }

    fn draw(&self, scene: &mut Scene) {
        scene.clear();
        let tube = &self.tubes.members[0];
        let thermal = self.set.temperature().sqrt();
        // Coloured by the velocity along the tube, averaged over neighbours: of single particles one sees only heat.
        let drift = tube.drift();
        drawing::add_event_driven(scene, tube.engine(), tube.started(), |i| drift[i] / thermal);
        scene.camera = Camera::fit(tube.engine().boundary().lower.to_three(), tube.engine().boundary().upper.to_three());
        scene.colouring =
            Colouring::Value { name: "velocity to the right".into(), unit: "√(kT/m)".into(), least: -0.4, most: 0.4 };
        scene.title = EXPERIMENT.title.into();
        scene.caption = if self.enough() {
            let speed = self.speed();
            format!("c = {:.3} ± {:.3}   equation of state: {:.3}", speed.mean, speed.standard_error, self.set.speed)
        } else {
            format!("equation of state: c = {:.3} √(kT/m)", self.set.speed / thermal)
        };
    }

    fn charts(&self) -> Vec<Chart> {
        if self.tubes.times.len() < 3 {
            return vec![];
        }
        vec![self.wave_chart(), self.profile_chart()]
    }

    fn checks(&self) -> Vec<Check> {
        let mut checks = vec![];
        if self.enough() {
            let reference = "c^2 = (kT/m)(d(eta Z)/d eta + Z^2), Henderson 1975, doi:10.1080/00268977500102511";
            checks.push(self.speed().check("speed of sound c", self.set.speed, reference));
            let eta = self.set.packing();
            let expected = theory::compressibility::<2>(eta);
            let pressure = self.tubes.mean(Tube::compressibility);
            checks.push(pressure.check("P V/(N k T) by the virial", expected, "Henderson 1975, doi:10.1080/00268977500102511"));
            let rate = self.tubes.mean(Tube::collision_rate);
            checks.push(rate.check(
                "collisions of a disc per time",
                self.set.collision_rate(),
                "Enskog, with the same equation of state",
            ));
        }
        checks.extend(energy_check(&self.honesty()));
        checks
    }

    fn honesty(&self) -> Honesty {
        honesty(self.tubes.members.iter().flat_map(Tube::runs))
    }

    fn moments(&self) -> Vec<f64> {
        let passage = self.set.length() / self.set.speed;
        vec![0.0, passage / 8.0, passage / 4.0]
    }

    fn next_event(&self) -> Option<f64> {
        let tube = &self.tubes.members[0];
        peek::next_contact(tube.engine(), 1.5 * self.duration).map(|time| time - tube.started())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A damped oscillation of known constants, without noise: what is left is the quadrature's error.
    #[test]
    fn the_regression_finds_the_constants_of_a_damped_wave() {
        let (c2, gamma2, k) = (8.0, 3.0, 0.1);
        let rate = 0.5 * gamma2 * k * k;
        let omega = (c2 * k * k - rate * rate).sqrt();
        let interval = std::f64::consts::TAU / omega / RESOLUTION;
        let density = |t: f64| libm::sin(omega * t) * libm::exp(-rate * t);
        // dR/dt = k J.
        let current = |t: f64| (omega * libm::cos(omega * t) - rate * libm::sin(omega * t)) * libm::exp(-rate * t) / k;
        let times: Vec<f64> = (0..72).map(|m| f64::from(m) * interval).collect();
        let [currents, densities]: [Vec<f64>; 2] =
            [times.iter().map(|&t| current(t)).collect(), times.iter().map(|&t| density(t)).collect()];
        let found = regression(&currents, &densities, k, interval);
        assert!((found[0] / c2 - 1.0).abs() < 1e-5 && (found[1] / gamma2 - 1.0).abs() < 1e-4, "{found:?}");
    }
}
