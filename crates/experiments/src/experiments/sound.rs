//! Sound in a gas of hard discs: particles are pushed together in one place, and the crowd runs away to both sides.
//!
//! A dense gas carries sound with `c^2 = c_T^2 + kT Z^2/m`, `c_T^2 = (kT/m) d(eta Z)/d eta` in the plane
//! ([`corpuscle_observe::theory::speed_of_sound`]): mechanics of single collisions on one side, the adiabats of thermodynamics on the other. Of the longest
//! wave of a periodic tube of length `L`, `k = 2 pi/L`, three sums are noted: the current `J = sum v_x cos(k x)`, the density
//! `R = sum sin(k x)` and the heat `H = sum (m v^2/2 - kT) sin(k x)`. `dR/dt = k J` exactly, and momentum is balanced by pressure and
//! viscosity: `dJ/dt = -k (c_T^2 R + Z H/m) - nu k^2 J`. With `Z` from the virial of the same gas at rest, one linear regression of
//! `J(t) - J(0) + (k Z/m) int H dt` on `int R dt` and `R(t) - R(0)` gives `c_T^2` and `nu`, whatever heat conduction does.
//!
//! Each tube is run twice, with the push and with its opposite; half the difference has no part that is of second order in
//! the push, nor, for a while, the noise that both have in common.

mod hydrodynamics;
mod tube;

use corpuscle_checkpoint::{Resume, resume};
use corpuscle_core::{Failure, Invalid};
use corpuscle_observe::chart::{Axis, Scale, Series, Style};
use corpuscle_observe::theory::hard_discs;
use corpuscle_observe::{Chart, Check, Estimate};
use corpuscle_scene::{Camera, Colouring, Scene};

use crate::hand::{self, InHand};
use crate::replicas::{Replicas, energy_check, honesty};
use crate::tally::Tally;
use crate::{Action, Experiment, Frame, Honesty, Kind, Parameter, Probed, Settings, Simulation, drawing, ensemble, peek};
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
        kind: Kind::Real { default: 0.2, least: 1e-3, most: 0.4 },
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
        kind: Kind::Whole { default: 40, least: 3, most: 10_000 },
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
    in_hand: Option<InHand<2>>,
}

resume!(Sound { values: [], parts: [tubes], set_up: [set, duration, in_hand] });

/// `c_T^2` and `nu` by least squares, from `J`, `R` and `H` at equal intervals.
fn regression([current, density, heat]: &[Vec<f64>; 3], compressibility: f64, k: f64, interval: f64) -> [f64; 2] {
    let (mut crowding, mut warmth) = (0.0, 0.0);
    let (mut aa, mut ab, mut bb, mut ay, mut by) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for m in 1..current.len() {
        // The trapezium; for the density with the slopes at its ends, which are k J: of fourth order.
        crowding += 0.5 * interval * (density[m - 1] + density[m]) + interval * interval / 12.0 * k * (current[m - 1] - current[m]);
        warmth += 0.5 * interval * (heat[m - 1] + heat[m]);
        let y = current[m] - current[0] + k * compressibility * warmth;
        let (a, b) = (-k * crowding, -k * (density[m] - density[0]));
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
        Ok(Self { duration, tubes: Replicas::new(passage / RESOLUTION, members), set, in_hand: None })
    }

    /// The speed of sound, `sqrt(c_T^2 + kT Z^2)`, from the tubes but one, or all.
    fn speed_without(&self, left_out: Option<usize>) -> f64 {
        let mut sums = std::array::from_fn(|_| vec![0.0; self.tubes.times.len()]);
        let (mut compressibility, mut count) = (0.0, 0.0);
        for (_, tube) in self.tubes.members.iter().enumerate().filter(|(r, _)| Some(*r) != left_out) {
            for (m, sample) in tube.samples.iter().enumerate() {
                let [current, density, heat]: &mut [Vec<f64>; 3] = &mut sums;
                current[m] += sample.current;
                density[m] += sample.density;
                heat[m] += sample.heat;
            }
            compressibility += tube.compressibility();
            count += 1.0;
        }
        let z = compressibility / count;
        // Sums serve as well as means: the regression is linear.
        let [isothermal, _] = regression(&sums, z, self.set.wave_number(), self.tubes.times[1]);
        (isothermal + self.set.temperature() * z * z).max(0.0).sqrt()
    }

    /// The same with its error, by the delete-one jackknife over the tubes.
    fn speed(&self) -> Estimate {
        let (whole, count) = (self.speed_without(None), self.tubes.members.len());
        let rest = count as f64 - 1.0;
        // Pseudo-values, whose mean and scatter are the jackknife's.
        let pseudo = (0..count).map(|r| count as f64 * whole - rest * self.speed_without(Some(r)));
        Estimate::from_replicas(&pseudo.collect::<Vec<_>>())
    }

    fn enough(&self) -> bool {
        self.tubes.sampled() >= 0.49 * self.set.length() / self.set.speed
    }

    fn wave_chart(&self) -> Chart {
        const STEPS: usize = 200;
        let set = &self.set;
        let amplitude = 0.5 * set.push;
        let scale = 2.0 / set.particles() as f64 / amplitude;
        let step = self.tubes.sampled() / STEPS as f64;
        let wave = set.wave(1.0).samples(step, STEPS + 1);
        let theory = |name: &str, values: &[f64], scale: f64| {
            Series::new(name, Style::Theory, values.iter().enumerate().map(move |(m, value)| (step * m as f64, scale * value)))
        };
        let points = |pick: fn(&tube::Sample) -> f64, scale: f64| {
            let mean = |m: usize| self.tubes.mean(|tube| scale * pick(&tube.samples[m]));
            let points: Vec<_> =
                (0..self.tubes.times.len()).map(|m| (self.tubes.times[m], mean(m).mean, mean(m).standard_error)).collect();
            points
        };
        Chart::new("wave", "The longest wave", Axis::linear("time t", ""), Axis::linear("amplitude over that at the start", ""))
            .with(theory("velocity, linear hydrodynamics", &wave[0], 1.0))
            .with(Series::with_errors("velocity, measured", Style::Points, points(|sample| sample.current, scale)))
            .with(theory("density, linear hydrodynamics", &wave[1], set.speed))
            .with(Series::with_errors(
                "density times c, measured",
                Style::Points,
                points(|sample| sample.density, scale * set.speed),
            ))
            .noting("Nothing is fitted: equation of state, viscosity and heat conduction are theory's.")
    }

    fn profile_chart(&self) -> Chart {
        let set = &self.set;
        let length = set.length();
        let last = self.tubes.times.len() - 1;
        let per_bin = set.particles() as f64 / BINS as f64;
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
            let law = set.density_change(time);
            chart = chart
                .with(Series::theory(format!("{name}, theory"), -0.5 * length, 0.5 * length, 120, Scale::Linear, law))
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
        self.tubes.advance(to)?;
        InHand::advance_any(&mut self.in_hand, self.tubes.members[0].started() + to)
    }

    fn draw(&self, scene: &mut Scene) {
        scene.clear();
        let tube = &self.tubes.members[0];
        let thermal = self.set.temperature().sqrt();
        // Coloured by the velocity along the tube, averaged over neighbours: of single particles one sees only heat.
        let engine = InHand::on_show(self.in_hand.as_ref(), tube.engine());
        let drift = tube::drift(engine);
        drawing::add_event_driven(scene, engine, &Tally::default(), tube.started(), |i| drift[i] / thermal);
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

    fn frame(&self) -> Option<Frame> {
        let tube = &self.tubes.members[0];
        Some(Frame::of_hard(tube.engine(), tube.started(), &["discs"]))
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
            let expected = hard_discs::liquid_of_few(eta, self.set.particles());
            let pressure = self.tubes.mean(Tube::compressibility);
            let virial = "ten virial coefficients, Clisby and McCoy 2006, doi:10.1007/s10955-005-8080-0, of a fixed number";
            checks.push(pressure.check("P V/(N k T) by the virial", expected, virial));
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
        peek::next_contact(InHand::on_show(self.in_hand.as_ref(), tube.engine()), 1.5 * self.duration)
            .map(|time| time - tube.started())
    }

    fn probe(&mut self, corners: Option<[[f64; 2]; 2]>) {
        InHand::lay(&mut self.in_hand, self.tubes.members[0].engine(), corners);
    }

    fn probed(&self) -> Option<Probed> {
        InHand::probed(self.in_hand.as_ref())
    }

    fn refusal(&self, action: Action) -> Option<&'static str> {
        hand::wanting_of_number(self.tubes.members[0].engine(), action)
    }

    fn act(&mut self, action: Action) -> Result<(), Invalid> {
        InHand::act(&mut self.in_hand, self.tubes.members[0].engine(), &Tally::default(), action)
    }
}

#[cfg(test)]
mod tests {
    use super::hydrodynamics::Wave;
    use super::*;
    use corpuscle_observe::theory;

    /// A wave of linear hydrodynamics, without noise: what is left is the quadrature's error.
    #[test]
    fn the_regression_finds_the_constants_of_a_wave() {
        let (packing, temperature) = (0.3, 1.3);
        let k = 0.08;
        let speed = theory::speed_of_sound::<2>(packing, temperature, 1.0);
        let interval = std::f64::consts::TAU / (k * speed * RESOLUTION);
        let wave = Wave::new(packing, temperature, k);
        let z = theory::compressibility::<2>(packing);
        let [isothermal, viscosity] = regression(&wave.samples(interval, 73), z, k, interval);
        let expected = temperature / theory::reduced_compressibility::<2>(packing);
        assert!((isothermal / expected - 1.0).abs() < 5e-3, "{isothermal}, {expected}");
        assert!((viscosity / wave.viscosity() - 1.0).abs() < 5e-2, "{viscosity}, {}", wave.viscosity());
    }
}
