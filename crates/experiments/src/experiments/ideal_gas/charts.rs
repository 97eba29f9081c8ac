//! The charts: each law with its theory, speeds, the pressure in time and how its error shrinks, and where the law fails.

use std::f64::consts::PI;

use corpuscle_core::particles::ball_volume;
use corpuscle_observe::chart::Axis;
use corpuscle_observe::theory::{compressibility, mean_speed, wall_hit_rate};
use corpuscle_observe::{Chart, Estimate, Scale, Series, Style};

use super::laws::{Laboratory, Law, Point};
use super::system::{Speeds, System, Totals};
use crate::simulation::Table;

/// All charts, the most telling first.
pub(super) fn all<const D: usize>(laboratory: &Laboratory<D>) -> Vec<Chart> {
    let mut charts: Vec<Chart> = Law::ALL.into_iter().map(|law| of_law(laboratory, law)).collect();
    charts.extend([speeds(laboratory), running(laboratory), averaging(laboratory), equation_of_state(laboratory)]);
    charts
}

fn with_error(x: f64, estimate: Estimate) -> (f64, f64, f64) {
    (x, estimate.mean, estimate.standard_error)
}

fn of_law<const D: usize>(laboratory: &Laboratory<D>, law: Law) -> Chart {
    let (name, title, label) = match law {
        Law::Boyle => ("boyle", "Boyle: pressure against volume, at constant N and T", "1 / accessible volume, 1/V_acc"),
        Law::Charles => ("charles", "Charles and Gay-Lussac: pressure against temperature, at constant N and V", "temperature kT"),
        Law::Avogadro => ("avogadro", "Avogadro: pressure against number, at constant V and T", "number of particles N"),
    };
    let points: Vec<&Point<D>> = laboratory.sweep(law).collect();
    let base = laboratory.base.state;
    let (most, pressure) = (law.abscissa::<D>(&base), base.ideal_pressure::<D>());
    let x = |point: &Point<D>| law.abscissa::<D>(&point.state);
    let chart = Chart::new(name, title, Axis::linear(label, ""), Axis::linear("pressure P", ""))
        .with(Series::theory("ideal gas, P = N k T / V_acc", 0.0, 1.05 * most, 2, Scale::Linear, |x| pressure * x / most))
        .with(Series::new("with the particles' size", Style::Theory, points.iter().map(|p| (x(p), p.expected_pressure()))));
    if !laboratory.is_telling() {
        return chart;
    }
    chart
        .with(Series::with_errors("from wall hits", Style::Points, points.iter().map(|p| with_error(x(p), p.wall_pressure()))))
        .with(Series::with_errors("from the virial", Style::Points, points.iter().map(|p| with_error(x(p), p.virial_pressure()))))
        .noting("The points lie on a line through the origin but for the small excess that the particles' own size adds.")
}

fn speeds<const D: usize>(laboratory: &Laboratory<D>) -> Chart {
    let state = &laboratory.base.state;
    let unit = state.thermal_speed();
    let mut counts = [0u64; Speeds::BINS];
    let mut snapshots = 0;
    for system in &laboratory.base.replicas {
        counts.iter_mut().zip(system.speeds.bins).for_each(|(sum, n)| *sum += n);
        snapshots += system.speeds.snapshots;
    }
    let width = Speeds::WIDTH * unit;
    let whole = (snapshots * state.count as u64) as f64 * width;
    let middle = |bin: usize| (bin as f64 + 0.5) * width;
    // sqrt(n) is the error of a bin: speeds of one snapshot hardly know each other, those of two have forgotten each other.
    let bars = counts.iter().enumerate().map(|(bin, &n)| (middle(bin), n as f64 / whole, (n as f64).sqrt() / whole));
    let maxwell = |v: f64| {
        let x = v / unit;
        let norm = if D == 2 { x } else { (2.0 / PI).sqrt() * x * x };
        norm * libm::exp(-0.5 * x * x) / unit
    };
    let chart =
        Chart::new("speeds", "Maxwell: distribution of speeds", Axis::linear("speed v", ""), Axis::linear("density p(v)", ""));
    let chart = if snapshots > 0 { chart.with(Series::with_errors("measured", Style::Bars, bars)) } else { chart };
    chart.with(Series::theory("Maxwell", 0.0, Speeds::BINS as f64 * width, 200, Scale::Linear, maxwell)).noting(format!(
        "{snapshots} snapshots of {} particles, some ten collisions of each particle apart; the mean speed of theory is {:.4}.",
        state.count,
        mean_speed::<D>(state.temperature, state.mass)
    ))
}

/// The pressure averaged from the start of the measurement.
fn running<const D: usize>(laboratory: &Laboratory<D>) -> Chart {
    let base = &laboratory.base;
    let interval = laboratory.pace.interval;
    let measured = laboratory.measured();
    let step = measured.div_ceil(400).max(1);
    let places: Vec<u64> = (1..=measured).filter(|k| k.is_multiple_of(step)).collect();
    let series = |name: &str, pressure: &dyn Fn(&System<D>, &Totals<D>, f64) -> f64| {
        let points = places.iter().map(|&k| {
            let duration = k as f64 * interval;
            with_error(duration, base.estimate(|system| pressure(system, &system.readings[k as usize], duration)))
        });
        Series::with_errors(name, Style::Line, points)
    };
    let end = measured.max(1) as f64 * interval;
    let level = |name: &str, value: f64| Series::theory(name, 0.0, end, 2, Scale::Linear, |_| value);
    Chart::new(
        "pressure",
        "Pressure of the base state, averaged so far",
        Axis::linear("averaging time t", ""),
        Axis::linear("pressure P", ""),
    )
    .with(series("from wall hits", &|system, totals, duration| system.wall_pressure(totals, duration)))
    .with(series("from the virial", &|system, totals, duration| system.virial_pressure(totals, duration)))
    .with(level("ideal gas", base.state.ideal_pressure::<D>()))
    .with(level("with the particles' size", base.expected_pressure()))
    .noting("Bands are one standard error, from the replicas.")
}

/// How the error of a wall pressure shrinks with the averaging time.
///
/// Over less than a crossing of the box hits are independent: `sqrt((4/pi)/H)`. Over more, the virial theorem takes over: the
/// kinetic energy of an isolated gas is constant, so that in an ideal gas `P - N k T/V = -(G(t) - G(0))/(D V t)` with
/// `G = sum m v . r`, of variance `D N m kT a^2/12`: the error falls as `1/t`, to `1/(sqrt(6 D N) t)` in crossings.
fn averaging<const D: usize>(laboratory: &Laboratory<D>) -> Chart {
    let base = &laboratory.base;
    let (state, interval) = (&base.state, laboratory.pace.interval);
    let crossing = state.open_side() / state.thermal_speed();
    let measured = laboratory.measured() as usize;
    let mut points = vec![];
    let mut length = 1;
    while 2 * length <= measured {
        let deviations = base.replicas.iter().flat_map(|system| {
            let blocks = (0..measured / length).map(move |b| (b * length, (b + 1) * length));
            blocks.map(move |(from, to)| {
                let totals = system.readings[to].since(&system.readings[from]);
                system.wall_pressure(&totals, length as f64 * interval) / base.expected_pressure() - 1.0
            })
        });
        let (count, squares) = deviations.fold((0.0, 0.0), |(n, sum), x| (n + 1.0, sum + x * x));
        let spread = f64::sqrt(squares / count);
        points.push((length as f64 * interval / crossing, spread, spread / f64::sqrt(2.0 * count)));
        length *= 2;
    }
    let rate = wall_hit_rate(base.expected_pressure() / state.temperature, state.temperature, state.mass);
    let hits = rate * 2.0 * D as f64 * state.volume::<D>() / state.open_side() * crossing;
    let freedom = (D * state.count) as f64;
    let (first, last) = (interval / crossing, points.last().map_or(1.0, |p| p.0));
    Chart::new(
        "averaging",
        "Error of a wall pressure against the averaging time",
        Axis::logarithmic("averaging time t", "a/sqrt(kT/m)"),
        Axis::logarithmic("relative standard deviation of P", ""),
    )
    .with(Series::theory("independent hits, sqrt((4/pi)/H)", first, last, 60, Scale::Logarithmic, |t| {
        (4.0 / PI / (hits * t)).sqrt()
    }))
    .with(Series::theory("isolated ideal gas, 1/(sqrt(6 D N) t)", first, last, 60, Scale::Logarithmic, |t| {
        1.0 / ((6.0 * freedom).sqrt() * t)
    }))
    .with(Series::with_errors("from wall hits", Style::Points, points))
    .noting("Hits are independent for a moment only: an isolated gas keeps its energy, and its pressure is sharper than its hits.")
}

fn equation_of_state<const D: usize>(laboratory: &Laboratory<D>) -> Chart {
    let name = if D == 2 { "Henderson" } else { "Carnahan and Starling" };
    let most = laboratory.dense.iter().map(|(packing, _)| *packing).fold(0.05, f64::max);
    let chart = Chart::new(
        "equation-of-state",
        "Where the law fails: compressibility factor against packing",
        Axis::linear("packing fraction eta", ""),
        Axis::linear("Z = P V / (N k T)", ""),
    )
    .with(Series::theory(name, 0.0, 1.05 * most, 200, Scale::Linear, compressibility::<D>))
    .with(Series::theory("ideal gas", 0.0, 1.05 * most, 2, Scale::Linear, |_| 1.0));
    if !laboratory.is_telling() {
        return chart;
    }
    let dense = laboratory
        .dense
        .iter()
        .map(|(packing, point)| with_error(*packing, point.virial_pressure() / point.state.ideal_pressure::<D>()));
    let dilute =
        std::iter::once(&laboratory.base).chain(laboratory.sweep(Law::Boyle).take(laboratory.sweep(Law::Boyle).count() - 1));
    let dilute = dilute.map(|point| {
        let packing = point.state.count as f64 * ball_volume::<D>(point.state.radius) / point.state.volume::<D>();
        with_error(packing, point.wall_pressure() / point.state.ideal_pressure::<D>())
    });
    chart
        .with(Series::with_errors("dense, from the virial", Style::Points, dense))
        .with(Series::with_errors("Boyle's gases, from wall hits", Style::Points, dilute))
        .noting("Particles with a size take room from each other: the pressure rises above the ideal gas law.")
}

/// All state points as rows.
pub(super) fn table<const D: usize>(laboratory: &Laboratory<D>) -> Table {
    let columns = [
        "packing_fraction",
        "particles",
        "temperature",
        "accessible_volume",
        "pressure_walls",
        "pressure_walls_standard_error",
        "pressure_virial",
        "pressure_virial_standard_error",
        "pressure_expected",
        "pressure_ideal",
        "wall_hits",
        "collisions",
    ];
    let row = |point: &Point<D>| {
        let state = &point.state;
        let (walls, virial) = (point.wall_pressure(), point.virial_pressure());
        let sum =
            |count: &dyn Fn(&Totals<D>) -> u64| point.replicas.iter().map(|system| count(&system.totals())).sum::<u64>() as f64;
        vec![
            state.count as f64 * ball_volume::<D>(state.radius) / state.side.powi(D as i32),
            state.count as f64,
            state.temperature,
            state.volume::<D>(),
            walls.mean,
            walls.standard_error,
            virial.mean,
            virial.standard_error,
            point.expected_pressure(),
            state.ideal_pressure::<D>(),
            sum(&|totals| totals.hits),
            sum(&|totals| totals.collisions),
        ]
    };
    let rows = if laboratory.is_telling() { laboratory.points().map(row).collect() } else { vec![] };
    Table { name: "state-points".into(), columns: columns.map(Into::into).to_vec(), rows }
}
