//! What theory says of the gas, and how well it is met.

use corpuscle_observe::distribution::normal_score_of_chi_squared;
use corpuscle_observe::{Check, Estimate, fit};

use super::laws::{Laboratory, Law};
use super::system::{Speeds, System};
use super::theory;

/// All checks, once there is enough to say.
pub(super) fn all<const D: usize>(laboratory: &Laboratory<D>) -> Vec<Check> {
    if !laboratory.is_telling() {
        return vec![];
    }
    let mut checks = pressures(laboratory);
    checks.extend(Law::ALL.into_iter().flat_map(|law| of_law(laboratory, law)));
    checks.extend(motion(laboratory));
    let known = laboratory.dense.iter().filter(|(packing, _)| *packing <= theory::DENSEST);
    checks.extend(known.map(|(packing, point)| {
        let z = point.virial_pressure() / point.state.ideal_pressure::<D>();
        z.check(
            format!("Z = P V/(N k T) at packing {packing}"),
            point.expected,
            "virial series to B_10 (Clisby and McCoy 2006), with the term in 1/N of a closed periodic box",
        )
    }));
    checks
}

fn pressures<const D: usize>(laboratory: &Laboratory<D>) -> Vec<Check> {
    let base = &laboratory.base;
    let ideal = base.state.ideal_pressure::<D>();
    let reference = "1 + second virial coefficient of this very box + higher ones of the fluid with its wall tension";
    let (wall, virial) = (base.wall_pressure() / ideal, base.virial_pressure() / ideal);
    let difference = base.estimate(|system| {
        let (totals, duration) = (system.totals(), system.duration());
        (system.wall_pressure(&totals, duration) - system.virial_pressure(&totals, duration)) / ideal
    });
    let systems = laboratory.points().filter(|point| point.state.axis == base.state.axis).flat_map(|point| &point.replicas);
    let (residual, contacts) = systems.fold((0.0f64, 0u64), |(worst, most), system| {
        let totals = system.totals();
        (worst.max(system.virial_residual()), most.max(totals.hits + totals.collisions))
    });
    vec![
        wall.check("P V_acc/(N k T) from wall hits, base state", base.expected, reference),
        virial.check("P V_acc/(N k T) from the virial, base state", base.expected, reference),
        difference.check("P from wall hits less P from the virial, over N k T/V_acc", 0.0, "Clausius' virial theorem"),
        Check::at_most(
            "virial theorem along each path: relative residual",
            residual,
            contacts as f64 * f64::EPSILON,
            "exact in mechanics; each contact adds at most one rounding to the sums",
        ),
        everywhere(laboratory),
    ]
}

/// All state points between walls at once: the sum of the squares of their scores.
fn everywhere<const D: usize>(laboratory: &Laboratory<D>) -> Check {
    let points = std::iter::once(&laboratory.base).chain(laboratory.sweeps.iter().map(|(_, point)| point));
    let scores: Vec<f64> = points.map(|point| point.wall_pressure().score(point.expected_pressure())).collect();
    chi_squared(
        "P of all state points: chi^2 per degree of freedom",
        scores.iter().map(|z| z * z).sum(),
        scores.len() as f64,
        "each wall pressure against the equation of state of its own box",
    )
}

fn chi_squared(quantity: &str, value: f64, degrees_of_freedom: f64, reference: &str) -> Check {
    let nu = degrees_of_freedom;
    Check::scored(quantity, value / nu, (2.0 / nu).sqrt(), 1.0, normal_score_of_chi_squared(value, nu), reference)
}

/// Slope and intercept of `P/Z` against the law's abscissa. Each replica of the sweep is one complete experiment with a line
/// of its own, and the lines' scatter gives the errors. `Z` takes off what the particles' size adds.
fn of_law<const D: usize>(laboratory: &Laboratory<D>, law: Law) -> Vec<Check> {
    let replicas = laboratory.base.replicas.len();
    let lines: Option<Vec<fit::Line>> = (0..replicas)
        .map(|r| {
            let points = laboratory.sweep(law).map(|point| {
                let system: &System<D> = &point.replicas[r];
                let pressure = system.wall_pressure(&system.totals(), system.duration()) / point.expected;
                // The relative errors of a sweep are alike.
                (law.abscissa::<D>(&point.state), pressure, point.state.ideal_pressure::<D>())
            });
            fit::line(&points.collect::<Vec<_>>())
        })
        .collect();
    let Some(lines) = lines else { return vec![] };
    let over_replicas = |value: &dyn Fn(&fit::Line) -> f64| Estimate::from_replicas(&lines.iter().map(value).collect::<Vec<_>>());
    let base = laboratory.base.state;
    let expected = base.ideal_pressure::<D>() / law.abscissa::<D>(&base);
    let (slope, symbol) = match law {
        Law::Boyle => ("Boyle: slope of P/Z against 1/V_acc", "N k T"),
        Law::Charles => ("Charles: slope of P/Z against T", "N k/V_acc"),
        Law::Avogadro => ("Avogadro: slope of P/Z against N", "k T/V_acc"),
    };
    let intercept = format!("{law:?}: intercept over P of the base state");
    vec![
        over_replicas(&|line| line.slope.mean).check(slope, expected, symbol),
        over_replicas(&|line| line.intercept.mean / base.ideal_pressure::<D>()).check(intercept, 0.0, "a proportionality"),
    ]
}

/// Speeds, equipartition and the impulses of single hits.
fn motion<const D: usize>(laboratory: &Laboratory<D>) -> Vec<Check> {
    let base = &laboratory.base;
    let mut checks = vec![];
    let mut counts = [0u64; Speeds::CLASSES];
    for system in &base.replicas {
        counts.iter_mut().zip(system.speeds.classes).for_each(|(sum, n)| *sum += n);
    }
    let each = counts.iter().sum::<u64>() as f64 / Speeds::CLASSES as f64;
    if each >= 10.0 {
        checks.push(chi_squared(
            "speed distribution: chi^2 per degree of freedom",
            counts.iter().map(|&n| (n as f64 - each) * (n as f64 - each) / each).sum(),
            Speeds::CLASSES as f64 - 2.0, // their sum and the energy are given
            "Maxwell's at constant energy: m v^2/2E follows the beta distribution of D/2 and D (N - 1)/2",
        ));
    }
    for axis in 0..D - 1 {
        let share = base.estimate(|system| system.speeds.shares[axis] / system.speeds.snapshots as f64);
        checks.push(share.check(format!("<m v_{}^2>/kT", ["x", "y", "z"][axis]), 1.0, "equipartition of a constant energy"));
    }
    let moments: Vec<[f64; 3]> = base
        .replicas
        .iter()
        .map(|system| {
            let totals = system.totals();
            [totals.hits as f64, totals.impulse(), totals.squares]
        })
        .collect();
    checks.push(Estimate::jackknife(&moments, |[hits, sum, squares]| hits * squares / (sum * sum)).check(
        "<J^2>/<J>^2 of the impulses of single hits",
        theory::impulse_moments(D * base.state.count),
        "4/pi for N >> 1: so sqrt((4/pi)/H) is the relative error from H independent hits",
    ));
    checks
}
