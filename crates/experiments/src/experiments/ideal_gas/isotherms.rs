//! Gases at several temperatures and densities, up to dense fluids, in periodic boxes: whatever is held constant, it is in here.
//!
//! Along a row of volumes at one temperature runs an isotherm (Boyle, and where he fails), along a row of temperatures in one volume an
//! isochore (Gay-Lussac 1802, Amontons 1702). Hard particles have no energy but kinetic, so that `P = n k T Z(eta)`: isochores are straight
//! lines through the origin at any density, and the temperature that keeps a pressure in another volume is `P/(n k Z)`.

use std::ops::ControlFlow;

use corpuscle_checkpoint::resume;
use corpuscle_core::particles::ball_volume;
use corpuscle_core::{Axis as Sides, Failure, Invalid, Random};
use corpuscle_observe::chart::{Axis, Scale, Series, Style};
use corpuscle_observe::distribution::normal_score_of_chi_squared;
use corpuscle_observe::{Chart, Check, Estimate, fit};
use corpuscle_scene::{Colouring, Scene};

use super::system::{State, Totals};
use super::theory;
use crate::replicas::{Member, Replicas};
use crate::study::{Running, Specimen, Study, Vessel};
use crate::{Settings, ensemble, gas};

/// Crossings of the box before the measurement.
const BEFORE: f64 = 10.0;
/// Samples in the whole duration.
const SAMPLES: usize = 20;

/// A gas at each temperature and packing, in replicas; the first, the most dilute of the coldest, is on show.
pub(super) fn start<const D: usize>(settings: &Settings) -> Result<Running<D, Isotherms>, Invalid> {
    let base = State { axis: Sides::Periodic, ..State::base::<D>(settings) };
    let mut packings = vec![settings.real("packing_fraction")];
    packings.extend(settings.list("dense_packings"));
    let rising = |list: &[f64]| list.iter().zip(list.iter().skip(1)).all(|(a, b)| a < b);
    if packings.len() < 2 || !rising(&packings) {
        return Err(settings.invalid("dense_packings", "at least one, each larger than the one before and than packing_fraction"));
    }
    let temperatures = settings.list("temperatures").to_vec();
    if temperatures.len() < 2 || !rising(&temperatures) {
        return Err(settings.invalid("temperatures", "at least two, each larger than the one before"));
    }
    let study = Isotherms { base, packings, temperatures };
    let (rows, columns) = (study.temperatures.len(), study.packings.len());
    let replicas = settings.whole("replicas") as u64;
    let jobs: Vec<(usize, usize, u64)> =
        (0..rows).flat_map(|i| (0..columns).flat_map(move |j| (0..replicas).map(move |r| (i, j, r)))).collect();
    let first = study.state::<D>(0, 0);
    let gases = ensemble::build(&jobs, |&(i, j, replica)| {
        let state = study.state::<D>(i, j);
        let stream = ((i * columns + j) as u64) << 32 | replica;
        let vessel = state.vessel(BEFORE * state.crossing(), &mut Random::new(settings.seed, stream))?;
        let clock = first.collision_rate::<D>() / state.collision_rate::<D>();
        Ok(Filled { vessel, place: (i, j), clock, meter: Totals::ZERO, reading: Totals::ZERO })
    })?;
    Ok(Running::new(study, settings.real("duration") * first.crossing(), SAMPLES, gases))
}

/// What is asked.
pub(super) struct Isotherms {
    base: State,
    packings: Vec<f64>,
    /// Over the base temperature.
    temperatures: Vec<f64>,
}

/// A gas at one temperature and packing.
pub(super) struct Filled<const D: usize> {
    vessel: Vessel<D>,
    /// Which temperature, which packing.
    place: (usize, usize),
    /// Rate of its own clock: a dense or hot gas needs less time for as many collisions.
    clock: f64,
    meter: Totals<D>,
    /// The meter at the last sample.
    reading: Totals<D>,
}

resume!(Filled<const D> { values: [meter, reading], parts: [vessel], set_up: [place, clock] });

impl<const D: usize> Member for Filled<D> {
    fn advance(&mut self, time: f64) -> Result<(), Failure> {
        let meter = &mut self.meter;
        self.vessel.advance(time * self.clock, &mut |contact| {
            let _: ControlFlow<()> = corpuscle_core::Observer::contact(meter, contact);
            ControlFlow::Continue(())
        })
    }

    fn sample(&mut self) {
        self.reading = self.meter;
    }

    fn time(&self) -> f64 {
        self.vessel.time() / self.clock
    }
}

impl<const D: usize> Specimen<D> for Filled<D> {
    fn vessel(&self) -> &Vessel<D> {
        &self.vessel
    }

    fn vessel_mut(&mut self) -> &mut Vessel<D> {
        &mut self.vessel
    }
}

type Gases<const D: usize> = Replicas<Filled<D>>;

impl Isotherms {
    fn state<const D: usize>(&self, row: usize, column: usize) -> State {
        let temperature = self.temperatures[row] * self.base.temperature;
        State { temperature, side: gas::side::<D>(self.base.count, self.base.radius, self.packings[column]), ..self.base }
    }

    /// `Z = P V/(N k T)` of one gas, from the virial.
    fn compressibility<const D: usize>(&self, gases: &Gases<D>, gas: &Filled<D>) -> f64 {
        let state = self.state::<D>(gas.place.0, gas.place.1);
        1.0 + gas.reading.virial / (D as f64 * gases.sampled() * gas.clock * state.count as f64 * state.temperature)
    }

    fn replicas<const D: usize>(&self, gases: &Gases<D>, place: (usize, usize)) -> Vec<f64> {
        gases.members.iter().filter(|gas| gas.place == place).map(|gas| self.compressibility(gases, gas)).collect()
    }

    fn estimate<const D: usize>(&self, gases: &Gases<D>, row: usize, column: usize) -> Estimate {
        Estimate::from_replicas(&self.replicas(gases, (row, column)))
    }

    fn pressure<const D: usize>(&self, gases: &Gases<D>, row: usize, column: usize) -> (f64, f64) {
        let pressure = self.estimate(gases, row, column) * self.state::<D>(row, column).ideal_pressure::<D>();
        (pressure.mean, pressure.standard_error)
    }

    /// Slope and intercept of `P V/(N k)` against `T` in one volume, of which the first is `Z`: a line for each replica.
    fn isochore<const D: usize>(&self, gases: &Gases<D>, column: usize) -> Option<(Estimate, Estimate)> {
        let rows: Vec<Vec<f64>> = (0..self.temperatures.len()).map(|row| self.replicas(gases, (row, column))).collect();
        let line = |replica: usize| {
            // Relative errors are alike at all temperatures.
            let points = rows.iter().zip(&self.temperatures).map(|(row, &t)| (t, t * row[replica], t));
            fit::line(&points.collect::<Vec<_>>())
        };
        let lines: Vec<fit::Line> = (0..rows[0].len()).map(line).collect::<Option<_>>()?;
        let over = |value: fn(&fit::Line) -> f64| Estimate::from_replicas(&lines.iter().map(value).collect::<Vec<_>>());
        Some((over(|line| line.slope.mean), over(|line| line.intercept.mean)))
    }

    /// Columns that the virial series knows.
    fn known(&self) -> impl Iterator<Item = usize> {
        (0..self.packings.len()).filter(|&column| self.packings[column] <= theory::DENSEST)
    }
}

impl<const D: usize> Study<D> for Isotherms {
    type Specimen = Filled<D>;

    fn draw(&self, gases: &Gases<D>, scene: &mut Scene) {
        scene.title = super::EXPERIMENT.title.into();
        let state = self.state::<D>(0, 0);
        scene.colouring = Colouring::Speed { most: 3.0 * state.thermal_speed(), unit: String::new() };
        scene.caption = if gases.times.len() > 1 {
            let z = self.estimate(gases, 0, 0);
            format!(
                "packing {}, kT = {}: P V/(N kT) = {:.4} ± {:.4}",
                self.packings[0], state.temperature, z.mean, z.standard_error
            )
        } else {
            format!("packing {}, kT = {}", self.packings[0], state.temperature)
        };
    }

    fn charts(&self, gases: &Gases<D>) -> Vec<Chart> {
        let base = &self.base;
        let (rows, columns) = (self.temperatures.len(), self.packings.len());
        // Volume of a particle's share, over that of the particle, is 1/eta.
        let density = |packing: f64| packing / ball_volume::<D>(base.radius);
        let (least, most) = (1.0 / self.packings[columns - 1], 1.0 / self.packings[0]);
        let measured = gases.times.len() > 1;
        let temperature = |row: usize| self.temperatures[row] * base.temperature;
        let points = |cells: &[(usize, usize)], x: &dyn Fn(usize, usize) -> f64| -> Vec<(f64, f64, f64)> {
            let cells = if measured { cells } else { &[] };
            cells
                .iter()
                .map(|&(row, column)| (x(row, column), self.pressure(gases, row, column)))
                .map(|(x, (y, e))| (x, y, e))
                .collect()
        };

        let mut isotherms = Chart::new(
            "isotherms",
            "Isotherms: pressure against volume, temperature held",
            Axis::logarithmic("volume over that of all particles, 1/η", ""),
            Axis::logarithmic("pressure P", ""),
        );
        let ideal = (0..rows).flat_map(|row| {
            let t = temperature(row);
            [(least, density(1.0 / least) * t), (most, density(1.0 / most) * t), (f64::NAN, f64::NAN)]
        });
        isotherms = isotherms.with(Series::new("ideal gas", Style::Theory, ideal));
        for row in 0..rows {
            let t = temperature(row);
            let cells: Vec<_> = (0..columns).map(|column| (row, column)).collect();
            isotherms = isotherms
                .with(Series::theory(format!("kT = {t}: virial series"), least, most, 60, Scale::Logarithmic, |v| {
                    density(1.0 / v) * t * theory::periodic::<D>(base.count, 1.0 / v)
                }))
                .with(Series::with_errors(
                    format!("kT = {t}: measured"),
                    Style::Points,
                    points(&cells, &|_, column| 1.0 / self.packings[column]),
                ));
        }

        let mut isochores = Chart::new(
            "isochores",
            "Isochores: pressure against temperature, volume held",
            Axis::linear("temperature kT", ""),
            Axis::linear("pressure P", ""),
        );
        for (column, &packing) in self.packings.iter().enumerate() {
            let cells: Vec<_> = (0..rows).map(|row| (row, column)).collect();
            let slope = density(packing) * theory::periodic::<D>(base.count, packing);
            isochores = isochores
                .with(Series::theory(format!("η = {packing}: n kT Z"), 0.0, 1.05 * temperature(rows - 1), 2, Scale::Linear, |t| {
                    slope * t
                }))
                .with(Series::with_errors(
                    format!("η = {packing}: measured"),
                    Style::Points,
                    points(&cells, &|row, _| temperature(row)),
                ));
        }

        let held = density(self.packings[0]) * base.temperature * theory::periodic::<D>(base.count, self.packings[0]);
        let needed = |packing: f64| held / density(packing);
        let lines = (0..columns).filter(|_| measured).filter_map(|column| {
            let (z, _) = self.isochore(gases, column)?;
            let t = Estimate::exact(needed(self.packings[column])) / z;
            Some((1.0 / self.packings[column], t.mean, t.standard_error))
        });
        let keeping = Chart::new(
            "isobar",
            "The temperature that keeps the pressure in another volume",
            Axis::logarithmic("volume over that of all particles, 1/η", ""),
            Axis::logarithmic("temperature kT", ""),
        )
        .with(Series::theory("ideal gas, P V/(N k)", least, most, 2, Scale::Logarithmic, |v| needed(1.0 / v)))
        .with(Series::theory("virial series, P V/(N k Z)", least, most, 60, Scale::Logarithmic, |v| {
            needed(1.0 / v) / theory::periodic::<D>(base.count, 1.0 / v)
        }))
        .with(Series::with_errors("from the slopes of the isochores", Style::Points, lines));
        vec![
            isotherms.noting("All isotherms are one curve times kT; it leaves the straight line of the ideal gas where particles take room from each other."),
            isochores.noting("Straight lines through the origin, even of dense fluids: hard particles have no energy but kinetic."),
            keeping.noting("P held by T: in a smaller volume the gas must be colder, the more so where particles crowd."),
        ]
    }

    fn checks(&self, gases: &Gases<D>) -> Vec<Check> {
        if gases.times.len() <= SAMPLES {
            return vec![];
        }
        let expected = |column: usize| theory::periodic::<D>(self.base.count, self.packings[column]);
        let series = "virial series to B_10 (Clisby and McCoy 2006), with the term in 1/N of a closed periodic box";
        let mut checks = vec![];
        for (row, temperature) in self.temperatures.iter().enumerate() {
            let scores = self.known().map(|column| self.estimate(gases, row, column).score(expected(column)));
            let (sum, count) = scores.fold((0.0, 0.0), |(sum, n), z| (sum + z * z, n + 1.0));
            let z = normal_score_of_chi_squared(sum, count);
            let quantity = format!("isotherm of {temperature} T: chi^2 per degree of freedom");
            checks.push(Check::scored(quantity, sum / count, (2.0 / count).sqrt(), 1.0, z, series));
        }
        for column in self.known() {
            let Some((slope, intercept)) = self.isochore(gases, column) else { continue };
            let packing = self.packings[column];
            checks.push(slope.check(
                format!("isochore of packing {packing}: slope of P V/(N k) against T"),
                expected(column),
                series,
            ));
            checks.push(intercept.check(
                format!("isochore of packing {packing}: intercept over the base temperature"),
                0.0,
                "a proportionality, at any density",
            ));
        }
        checks
    }
}
