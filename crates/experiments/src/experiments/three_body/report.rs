//! What was measured on the system on show, beside its theory.

use corpuscle_core::Vector;
use corpuscle_observe::chart::Axis;
use corpuscle_observe::{Chart, Check, Series, Style};

use super::ThreeBody;
use super::orbits::Orbit;
use super::start::{MOON, OFFSETS, PRECISE};

/// Most points of a series in a chart.
const MOST_POINTS: usize = 2000;

/// The figure-eight after one period.
pub(super) fn check_of_closure(closure: f64) -> Check {
    Check::at_most(
        "figure-eight: distance from the start after one period",
        closure,
        1e-6,
        "Chenciner and Montgomery 2000 (doi:10.2307/2661357); the start is given to 8 decimals, the period to 8, velocities near 1 \
         and a period of 6.3 carry that to some 1e-7",
    )
}

impl ThreeBody {
    pub(super) fn checks_of_conservation(&self) -> Vec<Check> {
        let run = &self.runs[0];
        if self.samples < 2 {
            return vec![];
        }
        let coarse = self.runs.get(2);
        let [energy, momentum, angular] = run.bounds(coarse);
        let rounding = "rounding: 4 u sqrt(n) times its largest scale, after Rein and Spiegel 2015 (doi:10.1093/mnras/stu2164)";
        let truncation = format!("{rounding}; plus 2^(1 - p) times the error at twice the step");
        let symplectic = run.engine.integrator().is_symplectic();
        let reference = |exact: bool| if coarse.is_none() || exact { rounding.to_owned() } else { truncation.clone() };
        vec![
            Check::at_most("relative energy error", run.relative_energy_error(), energy, reference(false)),
            Check::at_most("relative momentum error", run.relative_momentum_error(), momentum, reference(true)),
            Check::at_most(
                "relative angular momentum error",
                run.relative_angular_momentum_error(),
                angular,
                reference(symplectic),
            ),
        ]
    }

    pub(super) fn check_of_closure(&self) -> Option<Check> {
        let closure = self.closure?;
        if self.start.preset == "figure-eight" {
            return Some(check_of_closure(closure));
        }
        if let Some(orbit) = Orbit::find(&self.start.preset) {
            return Some(Check::at_most(
                format!("{}: distance from the start after one period", orbit.name),
                closure,
                1e-6,
                "Šuvakov and Dmitrašinović 2013 (doi:10.1103/PhysRevLett.110.114301), start refined to all digits: rounding of 1e-16, \
                 grown by less than 1e10 in a period",
            ));
        }
        if self.start.preset == "euler" {
            // A displacement grows by at most exp(2 pi lambda/omega) a revolution, ten times over for its direction.
            let growth = 10.0 * libm::exp(std::f64::consts::TAU * super::orbits::growth_of_line(self.start.masses()));
            let own = self.runs[0].engine.integrator() == PRECISE && self.start.softening == 0.0;
            return own.then(|| {
                Check::at_most(
                    "Euler's line: distance from the start after one period",
                    closure,
                    self.runs[0].bounds(None)[0] * growth,
                    "Euler 1767: it turns rigidly; bound: rounding, grown by exp(2π λ/ω)",
                )
            });
        }
        // A relative error of the energy shears the orbits by 6 pi a revolution at most, or grows exponentially. A fixed step
        // also shifts the phase, at constant energy: by no more than 2^(1 - p) of what twice the step does.
        let run = &self.runs[0];
        let rate = super::triangle::growth_rate(self.start.masses());
        let phase = self.coarse_closure.map_or(0.0, |c| c * 2f64.powi(1 - run.engine.integrator().order() as i32));
        let bound = run.bounds(self.runs.get(2))[0] * super::triangle::drift_bound(rate, 1.0) + phase;
        (self.start.softening == 0.0).then(|| {
            Check::at_most(
                "Lagrange's triangle: distance from the start after one period 2π√(a³/GM)",
                closure,
                bound,
                "Lagrange 1772: it turns rigidly; bound: the error of the energy, sheared by 6π a revolution and growing as exp(λ t), and of the phase",
            )
        })
    }

    /// The Earth and the Moon together go round the Sun in Kepler's year.
    pub(super) fn check_of_year(&self) -> Option<Check> {
        let start = &self.start;
        let period = start.duration;
        let (last, [sun, earth, moon]) = (self.path.back()?, start.masses());
        if start.magnified.is_none() || last.time < period * (1.0 - 1e-12) || start.softening > 0.0 {
            return None;
        }
        let pair = |r: &[Vector<2>]| (r[1] * earth + r[2] * moon) / (earth + moon) - r[0];
        let year = std::f64::consts::TAU / (start.constant * (sun + earth + moon)).sqrt();
        let missed = (pair(&last.position) - pair(&start.particles.position)).norm();
        let reduced = earth * moon / ((earth + moon) * (earth + moon));
        let bound = 6.0 * std::f64::consts::PI * 3.0 * reduced * MOON * MOON;
        ((period / year - 1.0).abs() < 1e-12).then(|| {
            Check::at_most(
                "Earth and Moon: distance of their centre from its start after Kepler's year",
                missed,
                bound,
                "Kepler's third law; bound: the pair's quadrupole, 3 ν (a/R)² of the Sun's pull with ν the product of the shares \
                 of mass, shears the orbit by at most 6π of it a revolution",
            )
        })
    }

    pub(super) fn checks_of_parting(&self) -> Vec<Check> {
        let mut checks = vec![];
        if let Some(growth) = self.parting.growth().filter(|_| self.start.preset == "paper") {
            let rate = growth.rate;
            checks.push(Check::at_least(
                format!("growth rate λ = {:.3} ± {:.3} of separations, over its standard error", rate.mean, rate.standard_error),
                rate.mean / rate.standard_error,
                4.0,
                format!(
                    "sensitive dependence: λ > 0 over all grains (Poincaré 1892); twins 1e-8 apart until t = {:.1}",
                    growth.until
                ),
            ));
        }
        if let Some((time, difference)) = self.parting.proportionality() {
            // The grains are the same in every run: no score of chance, but a bound.
            checks.push(Check::at_most(
                format!(
                    "ln of separation over offset, twins {:.0e} less twins {:.0e} apart, at t = {time:.1}",
                    OFFSETS[0], OFFSETS[1]
                ),
                difference.mean.abs(),
                Check::Z_LIMIT * difference.standard_error,
                "small separations obey a linear equation: they grow in proportion; bound: four standard errors over the grains",
            ));
        }
        checks
    }

    pub(super) fn chart_of_parting(&self) -> Chart {
        let parting = &self.parting;
        let series = |name: String, values: &[f64]| Series::new(name, Style::Line, thin(&parting.time, values));
        let mut chart = Chart::new(
            "separation",
            "How paths that start close together part",
            Axis::linear("time t", ""),
            Axis::logarithmic("separation (geometric mean)", ""),
        );
        let other = self.runs[1].engine.integrator().name();
        if self.start.grains > 1 {
            let [neighbours, wide, close] = parting.offsets();
            chart = chart
                .with(series(format!("neighbours, {neighbours} apart"), &parting.neighbours))
                .with(series(format!("twins, {wide:.0e} apart"), &parting.twins[0]))
                .with(series(format!("twins, {close:.0e} apart"), &parting.twins[1]))
                .with(series("unrelated grains: saturation".into(), &parting.unrelated));
        }
        chart = chart.with(series(format!("one start, two integrators ({other})"), &parting.integrators));
        let mut notes = vec!["A straight rise is exponential growth.".to_owned()];
        if let Some(growth) = parting.growth() {
            let name = format!("exp(λ t), λ = {:.2} ± {:.2}", growth.rate.mean, growth.rate.standard_error);
            let line = |t: f64| libm::exp(growth.intercept + growth.rate.mean * t);
            chart = chart.with(Series::theory(name, 0.0, growth.until, 2, corpuscle_observe::Scale::Linear, line));
            notes.push("It ends where the grains are as far apart as any two: there memory of the start is lost.".into());
        }
        if let Some(horizon) = parting.horizon(self.start.view) {
            notes.push(format!("Two good integrators disagree from t = {horizon:.1} on."));
        }
        chart.noting(notes.join(" "))
    }

    pub(super) fn chart_of_energy(&self) -> Chart {
        let (times, own): (Vec<f64>, Vec<f64>) = self.energy_error.iter().copied().unzip();
        let other: Vec<f64> = self.other_energy_error.iter().map(|pair| pair.1).collect();
        let own: Vec<f64> = own.iter().map(|&error| libm::log(error)).collect();
        let other: Vec<f64> = other.iter().map(|&error| libm::log(error)).collect();
        let name = |k: usize| self.runs[k].engine.integrator().name();
        let mut chart = Chart::new(
            "energy",
            "Largest energy error so far",
            Axis::linear("time t", ""),
            Axis::logarithmic("|E − E0| / |E0|", ""),
        )
        .with(Series::new(name(0), Style::Line, thin(&times, &own)))
        .with(Series::new(name(1), Style::Line, thin(&times, &other)))
        .noting("Rounding adds up like a random walk, as the square root of the number of steps; truncation depends on the step.");
        let precise = self.runs.iter().find(|run| run.engine.integrator() == PRECISE);
        if let (Some(run), Some(&end)) = (precise, times.last().filter(|&&end| end > 0.0)) {
            let bound = run.bounds(None)[0];
            let curve = |t: f64| bound * (t / end).sqrt();
            let line =
                Series::theory("bound of rounding, 4 u sqrt(n) X", end / 200.0, end, 200, corpuscle_observe::Scale::Linear, curve);
            chart = chart.with(line);
        }
        chart
    }
}

/// `(time, exp(value))`, thinned out evenly to what a chart can show.
fn thin(times: &[f64], values: &[f64]) -> Vec<(f64, f64)> {
    let stride = times.len().div_ceil(MOST_POINTS).max(1);
    times.iter().zip(values).step_by(stride).map(|(&time, &value)| (time, libm::exp(value))).collect()
}
