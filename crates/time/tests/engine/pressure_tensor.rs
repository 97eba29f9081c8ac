//! The pressure tensor: the response of the energy to stretching along each axis, and how it turns with the system.

use corpuscle_core::{Axis, Boundary, Particles, Random, Vector};
use corpuscle_time::{
    Coulomb, Ewald, Force, Gravity, Integrator, LennardJones, PairForce, Spring, Springs, Tensor, TimeDriven, UniformField,
};

/// A rough lattice of three species in a box of unequal sides; no pair is near the cutoff of the pair forces below.
fn fluid(sides: [usize; 3], axis: Axis) -> (Boundary<3>, Particles<3>) {
    let mut random = Random::new(6, 0);
    let mut particles = Particles::new();
    for i in 0..sides.iter().product() {
        let site = Vector([(i % sides[0]) as f64, (i / sides[0] % sides[1]) as f64, (i / sides[0] / sides[1]) as f64]);
        let velocity = Vector::from_fn(|_| random.normal());
        particles.push(
            site * 1.1 + Vector::from_fn(|_| 0.1 * random.uniform()),
            velocity,
            1.0 + random.uniform(),
            0.0,
            (i % 3) as u16,
        );
    }
    (Boundary::new([0.0; 3], sides.map(|n| 1.1 * n as f64), axis), particles)
}

/// Diagonal elements against `-dU/d ln L_k` by central differences, the trace against the virial, symmetry.
fn check(force: &dyn Force<3>, boundary: &Boundary<3>, particles: &Particles<3>) -> Tensor<3> {
    force.validate(boundary, particles).unwrap();
    let tensor = force.virial_tensor(0.0, boundary, particles).unwrap();
    let energy = |k: usize, h: f64| {
        let (mut stretched, mut moved) = (boundary.clone(), particles.clone());
        stretched.upper[k] = boundary.lower[k] + (boundary.upper[k] - boundary.lower[k]) * (1.0 + h);
        moved.position.iter_mut().for_each(|r| r[k] = boundary.lower[k] + (r[k] - boundary.lower[k]) * (1.0 + h));
        force.energy(0.0, &stretched, &moved)
    };
    let size = force.energy(0.0, boundary, particles).abs() + tensor.iter().flatten().map(|x| x.abs()).sum::<f64>();
    for k in 0..3 {
        let slope = |h: f64| (energy(k, h) - energy(k, -h)) / (2.0 * h);
        let (fine, coarse) = (slope(1e-5), slope(2e-5));
        let bound = (fine - coarse).abs() + 100.0 * f64::EPSILON * size / 1e-5;
        assert!((tensor[k][k] + fine).abs() < bound, "{} axis {k}: {} against {}", force.name(), tensor[k][k], -fine);
        for l in 0..k {
            assert!((tensor[k][l] - tensor[l][k]).abs() < 1e-12 * size, "{tensor:?}");
        }
    }
    let trace: f64 = (0..3).map(|k| tensor[k][k]).sum();
    let virial = force.virial(0.0, boundary, particles);
    assert!((trace - virial).abs() < 1e-11 * size, "{}: trace {trace}, virial {virial}", force.name());
    tensor
}

/// In few cells, where every particle meets all others, and in many.
#[test]
fn the_virial_tensor_of_pairs_is_the_response_to_stretching() {
    for axis in [Axis::Open, Axis::Periodic] {
        for sides in [[3, 4, 5], [9, 4, 7]] {
            let (boundary, particles) = fluid(sides, axis);
            // Force-shifted, for the energy of a pair that crosses the cutoff has no kink to upset the differences.
            let between = |a: u16, b: u16| {
                corpuscle_time::ForceShifted(LennardJones {
                    epsilon: 1.0 + f64::from(a),
                    sigma: 1.0,
                    cutoff: 1.4 + 0.1 * f64::from(b),
                })
            };
            check(&PairForce::between_species(3, between), &boundary, &particles);
        }
    }
}

/// What knows no box turns with the system: `W' = R W R^T`.
#[test]
fn the_virial_tensor_turns_with_the_system() {
    let (boundary, particles) = fluid([3, 3, 3], Axis::Open);
    let charges: Vec<f64> = (0..27).map(|i| [1.0, -0.5, 2.0][i % 3]).collect();
    let springs = (1..27).map(|i| Spring { cubic: 0.3, ..Spring::new(i / 2, i, 1.5, 0.7) }).collect();
    let forces: [Box<dyn Force<3>>; 4] = [
        Box::new(Coulomb::new(1.2, charges)),
        Box::new(Gravity::new(0.8, 0.3)),
        Box::new(Springs::new(springs)),
        Box::new(PairForce::new(LennardJones { epsilon: 1.0, sigma: 1.0, cutoff: 1.9 })),
    ];
    let (sine, cosine) = 0.7f64.sin_cos();
    let rotation = [[cosine, -sine, 0.0], [0.8 * sine, 0.8 * cosine, -0.6], [0.6 * sine, 0.6 * cosine, 0.8]];
    let turn = |r: Vector<3>| Vector(rotation.map(|row| Vector(row).dot(r)));
    let mut turned = particles.clone();
    turned.position.iter_mut().for_each(|r| *r = turn(*r));
    for (number, force) in forces.iter().enumerate() {
        let tensor = if number < 3 {
            check(&**force, &boundary, &particles)
        } else {
            force.virial_tensor(0.0, &boundary, &particles).unwrap()
        };
        let found = force.virial_tensor(0.0, &boundary, &turned).unwrap();
        let size: f64 = tensor.iter().flatten().map(|x| x.abs()).sum();
        for a in 0..3 {
            for b in 0..3 {
                let mut expected = 0.0;
                for c in 0..3 {
                    for d in 0..3 {
                        expected += rotation[a][c] * tensor[c][d] * rotation[b][d];
                    }
                }
                assert!((found[a][b] - expected).abs() < 1e-12 * size, "{}: {found:?}", force.name());
            }
        }
    }
}

/// Near charges and waves share the tensor as `alpha` says; their sum does not depend on it.
#[test]
fn ewald_s_virial_tensor_is_the_response_to_stretching_and_does_not_depend_on_the_splitting() {
    let (boundary, particles) = fluid([4, 5, 6], Axis::Periodic);
    let charges: Vec<f64> = (0..120).map(|i| [1.0, -0.9, 0.7, -0.75][i % 4]).collect();
    let with = |alpha: f64| Ewald::with_parameters(1.3, charges.clone(), alpha, 2.19, 15.0 * alpha);
    let (tight, loose) = (check(&with(3.2), &boundary, &particles), with(2.8).virial_tensor(0.0, &boundary, &particles).unwrap());
    for (a, b) in tight.iter().flatten().zip(loose.iter().flatten()) {
        assert!((a - b).abs() < 1e-9, "{tight:?} {loose:?}");
    }
}

/// `P = (2 E_kin + W)/(3 V)` is a third of the trace; a gas without forces has `sum m v_a v_b / V`; fields add nothing.
#[test]
fn the_trace_of_the_pressure_tensor_is_the_pressure() {
    let (boundary, particles) = fluid([4, 4, 4], Axis::Periodic);
    let forces: Vec<Box<dyn Force<3>>> = vec![
        Box::new(PairForce::new(LennardJones { epsilon: 1.0, sigma: 1.0, cutoff: 2.0 })),
        Box::new(UniformField::new(Vector::ZERO)),
    ];
    let volume = boundary.volume();
    let engine = TimeDriven::new(boundary, particles, forces, Integrator::VelocityVerlet { dt: 0.001 }).unwrap();
    let tensor = engine.pressure_tensor().unwrap();
    let expected = (2.0 * engine.kinetic_energy() + engine.virial()) / volume;
    assert!((tensor[0][0] + tensor[1][1] + tensor[2][2] - expected).abs() < 1e-11 * expected.abs());
    let names: Vec<&str> = engine.energies().iter().map(|(name, _)| *name).collect();
    assert_eq!(names, ["Lennard-Jones", "uniform field"]);
    assert_eq!(engine.energies().iter().map(|(_, energy)| energy).sum::<f64>(), engine.potential_energy());
}
