//! Lennard-Jones against the NIST Standard Reference Simulation Website (doi:10.18434/T4M88Q): energies of a configuration, and
//! averages at state points.

use std::f64::consts::PI;

use corpuscle_core::{Axis, Boundary, Engine, Particles, Random, Vector, placement};
use corpuscle_observe::{Estimate, blocking};
use corpuscle_time::{Force, ForceShifted, Integrator, LennardJones, PairForce, TimeDriven};

const CONFIGURATION: &str = include_str!("data/lennard_jones_nist_4.txt");

/// Configuration 4 of the "Lennard-Jones Fluid Reference Calculations" (cuboid cell): pair energy, and virial `sum r.F`, with five
/// published digits; the energy for `r_c = 3` to all digits is that of NIST's own program FEASST.
#[test]
fn a_reference_configuration_has_its_published_energy_and_virial() {
    let boundary = Boundary::new([-4.0; 3], [4.0; 3], Axis::Periodic);
    let mut particles = Particles::<3>::new();
    for line in CONFIGURATION.lines().filter(|line| !line.starts_with('#')) {
        let numbers: Vec<f64> = line.split_whitespace().map(|x| x.parse().unwrap()).collect();
        particles.push(Vector([numbers[0], numbers[1], numbers[2]]), Vector::ZERO, 1.0, 0.0, 0);
    }
    assert_eq!(particles.len(), 30);
    let potential = |cutoff| LennardJones { epsilon: 1.0, sigma: 1.0, cutoff };
    let plain = |cutoff| -> Box<dyn Force<3>> { Box::new(PairForce::new(potential(cutoff)).unshifted()) };
    let forces: [(Box<dyn Force<3>>, f64, f64); 3] = [
        (plain(3.0), -16.790, -46.249),
        (plain(4.0), -17.060, -47.869),
        (Box::new(PairForce::new(ForceShifted(potential(3.0)))), -15.001, -43.096),
    ];
    for (force, energy, virial) in forces {
        force.validate(&boundary, &particles).unwrap();
        let found = (force.energy(0.0, &boundary, &particles), force.virial(0.0, &boundary, &particles));
        println!("{found:?}, published {energy} and {virial}");
        assert!((found.0 - energy).abs() <= 0.0005 && (found.1 - virial).abs() <= 0.0005, "{found:?}");
    }
    let energy = plain(3.0).energy(0.0, &boundary, &particles);
    // Positions are given to 13 digits; the steepest of the 30 pairs nearby multiplies their rounding by 1e2.
    assert!((energy + 16.790_321_304_625_856).abs() < 1e-10, "{energy}");
}

/// Averages at `T = 0.85` of 500 particles, cut at 3 with the usual corrections for what lies beyond (NIST, "Lennard-Jones Fluid
/// Properties", Monte Carlo at constant volume: mean and standard deviation of energy per particle and pressure). Here by molecular
/// dynamics with each of two thermostats.
#[test]
fn state_points_have_their_published_energy_and_pressure() {
    let (n, temperature, cutoff) = (500usize, 0.85, 3.0f64);
    let dt = 0.004;
    let freedom = 3 * (n as u32 - 1);
    let rescaling = Integrator::StochasticRescaling { dt, temperature, relaxation_time: 0.5, degrees_of_freedom: freedom, seed: 7 };
    let chain = Integrator::NoseHoover { dt, temperature, relaxation_time: 0.3, degrees_of_freedom: freedom, links: 4 };
    for (density, integrator, published) in [
        (0.776, rescaling, [Estimate::new(-5.5121, 4.55e-4), Estimate::new(6.7714e-3, 1.72e-3)]),
        (0.820, chain, [Estimate::new(-5.7947, 6.03e-4), Estimate::new(5.5355e-1, 4.13e-3)]),
    ] {
        let boundary = Boundary::<3>::periodic((n as f64 / density).cbrt());
        let mut random = Random::new(12, 0);
        let mut particles = Particles::new();
        for place in placement::lattice(&boundary, n, 0.0, &mut random, |_| true).unwrap() {
            particles.push(place, Vector::ZERO, 1.0, 0.0, 0);
        }
        placement::maxwell(&mut particles, temperature, true, &mut random);
        let force = PairForce::new(LennardJones { epsilon: 1.0, sigma: 1.0, cutoff }).unshifted();
        let mut engine = TimeDriven::new(boundary, particles, vec![Box::new(force)], integrator).unwrap();
        engine.advance(20.0, &mut ()).unwrap();
        let volume = engine.boundary().volume();
        // What lies beyond the cutoff, where the distribution is even.
        let (third, ninth) = (cutoff.powi(-3), cutoff.powi(-9));
        let energy_beyond = 8.0 / 3.0 * PI * density * (ninth / 3.0 - third);
        let pressure_beyond = 16.0 / 3.0 * PI * density * density * (2.0 / 3.0 * ninth - third);
        let (mut energies, mut pressures) = (vec![], vec![]);
        for sample in 0..512 {
            engine.advance(20.0 + 0.12 * f64::from(sample + 1), &mut ()).unwrap();
            energies.push(engine.potential_energy() / n as f64 + energy_beyond);
            pressures.push(density * temperature + engine.virial() / (3.0 * volume) + pressure_beyond);
        }
        for (what, series, published) in [("U/N", &energies, published[0]), ("P", &pressures, published[1])] {
            let measured = blocking(series);
            let (mean, error) = (measured.estimate.mean, measured.estimate.standard_error);
            let z = (mean - published.mean) / error.hypot(published.standard_error);
            println!(
                "density {density}, {}: {what} = {mean:.5} +- {error:.5}, published {:.5} +- {:.5}, z = {z:.2}",
                integrator.name(),
                published.mean,
                published.standard_error
            );
            assert!(measured.plateau, "{what}: too short a series");
            assert!(z.abs() < 4.0, "{what} at density {density}: {mean} +- {error}, z = {z}");
            assert!(error < 0.03, "{what}: too uncertain, +- {error}");
        }
    }
}
