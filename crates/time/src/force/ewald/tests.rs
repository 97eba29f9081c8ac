use std::f64::consts::PI;

use corpuscle_core::{Axis, Boundary, Particles, Random, Vector};

use super::*;
use crate::force::Coulomb;

/// Ions of charge 1 and -1 at these places of a cubic cell of side `cell`, and `repeats` cells along each axis.
fn crystal(cell: f64, repeats: usize, positive: &[[f64; 3]], negative: &[[f64; 3]]) -> (Boundary<3>, Particles<3>, Vec<f64>) {
    let (mut ions, mut charges) = (Particles::new(), vec![]);
    for n in 0..repeats.pow(3) {
        let corner = Vector::from_fn(|k| cell * (n / repeats.pow(k as u32) % repeats) as f64);
        for (places, charge) in [(positive, 1.0), (negative, -1.0)] {
            for place in places {
                ions.push(corner + Vector(*place) * cell, Vector::ZERO, 1.0, 0.0, 0);
                charges.push(charge);
            }
        }
    }
    (Boundary::periodic(cell * repeats as f64), ions, charges)
}

const FACES: [[f64; 3]; 4] = [[0.0; 3], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5], [0.5, 0.5, 0.0]];

fn shifted(places: [[f64; 3]; 4], by: f64) -> [[f64; 3]; 4] {
    places.map(|place| place.map(|x| x + by))
}

/// Ions of either sign, equally many, on a rough lattice: no pair is closer than about a third of the mean distance.
fn melt(repeats: usize, disorder: f64, seed: u64) -> (Boundary<3>, Particles<3>, Vec<f64>) {
    let (boundary, mut ions, charges) = crystal(2.0, repeats, &FACES, &shifted(FACES, 0.5));
    let mut random = Random::new(seed, 0);
    for r in &mut ions.position {
        *r += Vector::from_fn(|_| disorder * (2.0 * random.uniform() - 1.0));
    }
    for mass in &mut ions.mass {
        *mass = 0.5 + random.uniform();
    }
    (boundary, ions, charges)
}

fn forces(force: &mut Ewald, boundary: &Boundary<3>, ions: &Particles<3>) -> Vec<Vector<3>> {
    force.validate(boundary, ions).unwrap();
    let mut acceleration = vec![Vector::ZERO; ions.len()];
    force.accelerate(0.0, boundary, ions, &mut acceleration);
    acceleration.iter().zip(&ions.mass).map(|(&a, &m)| a * m).collect()
}

/// Madelung's constants, from the nearest distance: rock salt and zinc blende (Borwein, Borwein and Taylor 1985,
/// doi:10.1063/1.526675), and caesium chloride.
#[test]
fn crystals_have_their_madelung_constants() {
    let half = 3f64.sqrt() / 2.0;
    for (name, positive, negative, nearest, madelung) in [
        ("rock salt", &FACES[..], &shifted(FACES, 0.5)[..], 0.5, 1.747_564_594_633_182),
        ("caesium chloride", &FACES[..1], &[[0.5; 3]][..], half, 1.762_674_773_070_991),
        ("zinc blende", &FACES[..], &shifted(FACES, 0.25)[..], half / 2.0, 1.638_055_053_388_79),
    ] {
        for repeats in [2, 3] {
            let (boundary, ions, charges) = crystal(1.7, repeats, positive, negative);
            let mut force = Ewald::new(2.5, charges, 1e-12);
            let energy = force.energy(0.0, &boundary, &ions);
            let found = -energy * nearest * 1.7 / (2.5 * 0.5 * ions.len() as f64);
            let largest = forces(&mut force, &boundary, &ions).iter().map(|f| f.norm()).fold(0.0, f64::max);
            let force_between_neighbours = 2.5 / (nearest * 1.7 * nearest * 1.7);
            println!("{name}, {} ions: {found:.15}, off by {:.1e}, force {largest:.1e}", ions.len(), found - madelung);
            assert!((found - madelung).abs() < 1e-11, "{name}: {found}");
            // Each ion is a centre of symmetry or of a tetrahedron: no force, but for roundings of pairs to their quantum.
            assert!(largest < 1e-9 * force_between_neighbours, "{name}: {largest}");
        }
    }
}

/// Against the plain sum over images of everything, weighted to fall off smoothly far away: its limit is that of growing spheres,
/// which differs from Ewald's within a conductor by the dipole's surface term, `2 pi k M^2/(3 V)` in the energy and
/// `-4 pi k q_i M/(3 V)` in a force.
#[test]
fn images_summed_one_by_one_give_the_same() {
    let (k, side) = (1.5, 3.0);
    let mut random = Random::new(4, 0);
    let (mut ions, mut charges) = (Particles::new(), vec![]);
    for i in 0..6 {
        let site = Vector([0.5 * f64::from(i), 0.8 * f64::from(i % 3), 1.5 * f64::from(i % 2)]);
        ions.push(site + Vector::from_fn(|_| 0.2 * random.uniform()), Vector::ZERO, 1.0, 0.0, 0);
        charges.push(if i % 2 == 0 { 1.0 } else { -1.0 });
    }
    (charges[0], charges[1]) = (1.5, -1.5);
    let boundary = Boundary::periodic(side);
    let mut force = Ewald::new(k, charges.clone(), 1e-9);
    let ewald = (force.energy(0.0, &boundary, &ions), forces(&mut force, &boundary, &ions));
    let moment = ions.position.iter().zip(&charges).fold(Vector::ZERO, |sum, (&r, &q)| sum + r * q);
    assert!(moment.norm() > 1.0);
    let surface = 2.0 * PI * k / (3.0 * side.powi(3));
    let off = |reach: i32| {
        let (mut energy, mut force) = (0.0, vec![Vector::<3>::ZERO; 6]);
        let end = reach * 5 / 4;
        for n in 0..(2 * end + 1).pow(3) {
            let cell = [n % (2 * end + 1) - end, n / (2 * end + 1) % (2 * end + 1) - end, n / (2 * end + 1).pow(2) - end];
            let shift = Vector(cell.map(|n| side * f64::from(n)));
            let weight = (-(shift.norm() / (0.5 * side * f64::from(reach))).powi(6)).exp();
            for i in 0..6 {
                for j in (0..6).filter(|&j| j != i || cell != [0; 3]) {
                    let arrow = ions.position[i] - ions.position[j] + shift;
                    let strength = weight * k * charges[i] * charges[j] / arrow.norm();
                    energy += 0.5 * strength;
                    force[i] += arrow * (strength / arrow.norm_squared());
                }
            }
        }
        let energy = (energy - surface * moment.norm_squared() - ewald.0).abs();
        let force = (0..6).map(|i| (force[i] + moment * (2.0 * surface * charges[i]) - ewald.1[i]).norm()).fold(0.0, f64::max);
        (energy, force)
    };
    let (near, far) = (off(6), off(20));
    println!("off by {near:?} up to 6 cells, {far:?} up to 20");
    // A smooth weight makes the sum converge fast: at 14 cells 4e-6 are left of the energy.
    assert!(far.0 < 2e-6 && far.1 < 1e-5, "{far:?}");
    assert!(far.0 < 0.01 * near.0 && far.1 < 0.01 * near.1, "{near:?} {far:?}");
}

/// What does not depend on `alpha`: energy, forces and, by Euler's theorem for a potential of degree -1, the virial, which is the energy;
/// also for a box that is not neutral, nor cubic.
#[test]
fn neither_energy_nor_force_depends_on_the_splitting() {
    let mut random = Random::new(8, 0);
    let mut boundary = Boundary::<3>::periodic(1.0);
    boundary.upper = Vector([7.0, 8.0, 9.5]);
    let (mut ions, mut charges) = (Particles::new(), vec![]);
    for i in 0..60 {
        let site = Vector([1.7 * f64::from(i % 4), 1.6 * f64::from(i / 4 % 5), 3.0 * f64::from(i / 20)]);
        ions.push(site + Vector::from_fn(|_| 0.6 * random.uniform()), Vector::ZERO, 1.0, 0.0, 0);
        charges.push([1.0, -0.7, 2.0, -1.1][i as usize % 4]);
    }
    let with = |alpha: f64| {
        let mut force = Ewald::with_parameters(0.8, charges.clone(), alpha, 3.49, 14.0 * alpha);
        let (energy, virial) = (force.energy(0.0, &boundary, &ions), force.virial(0.0, &boundary, &ions));
        (energy, virial, forces(&mut force, &boundary, &ions))
    };
    let (tight, loose) = (with(2.1), with(1.75));
    let apart = tight.2.iter().zip(&loose.2).map(|(a, b)| (*a - *b).norm()).fold(0.0, f64::max);
    println!("energy {} {}, virial {} {}, forces apart {apart:.1e}", tight.0, loose.0, tight.1, loose.1);
    // What lies beyond the cutoff of the looser splitting: erfc(1.75 * 3.49) = 6e-18.
    assert!((tight.0 - loose.0).abs() < 1e-11 * tight.0.abs());
    assert!((tight.0 - tight.1).abs() < 1e-11 * tight.0.abs());
    // Pairs are rounded to quanta of 2^-45 k q^2 alpha^2, up to 20 of them at random.
    assert!(apart < 20.0 * 2f64.powi(-45) * 0.8 * 4.0 * 2.1 * 2.1, "{apart:e}");
}

/// `F = -dU/dr` by central differences; no net force.
#[test]
fn forces_are_the_slopes_of_the_energy_and_add_up_to_nothing() {
    let (boundary, mut ions, charges) = melt(2, 0.3, 5);
    let mut force = Ewald::new(1.3, charges, 1e-8);
    let found = forces(&mut force, &boundary, &ions);
    for (i, k) in [(0, 0), (17, 1), (40, 2), (63, 0)] {
        let mut slope = |h: f64| {
            let x = ions.position[i][k];
            let mut energy = |h| {
                ions.position[i][k] = x + h;
                force.energy(0.0, &boundary, &ions)
            };
            let slope = (energy(h) - energy(-h)) / (2.0 * h);
            ions.position[i][k] = x;
            slope
        };
        let (fine, coarse) = (slope(1e-4), slope(2e-4));
        // Truncation, measured by doubling the difference; rounding of the energy, which is some 100; pairs at the cutoff.
        let bound = (coarse - fine).abs() + 100.0 * 64.0 * f64::EPSILON / 1e-4 + 1e-7;
        assert!((found[i][k] + fine).abs() < bound, "{i}: {} against {}", found[i][k], -fine);
    }
    let net = found.iter().fold(Vector::ZERO, |sum, &f| sum + f).norm();
    let size: f64 = found.iter().map(|f| f.norm()).sum();
    println!("net force {net:.1e} of {size:.1}");
    assert!(net < 16.0 * f64::EPSILON * size, "{net:e}");
}

/// The root mean square error, against a sum that leaves out nothing, is what was asked for: not more, and not wastefully less.
#[test]
fn the_accuracy_is_what_was_asked_for() {
    let side = 8.0;
    let boundary = Boundary::<3>::periodic(side);
    let mut random = Random::new(6, 0);
    let (mut ions, mut charges) = (Particles::new(), vec![]);
    for i in 0..500 {
        ions.push(Vector::from_fn(|_| side * random.uniform()), Vector::ZERO, 1.0, 0.0, 0);
        charges.push(if i % 2 == 0 { 1.0 } else { -1.0 });
    }
    let exact = forces(&mut Ewald::with_parameters(1.0, charges.clone(), 1.6, 3.99, 20.0), &boundary, &ions);
    let typical = (500f64 / side.powi(3)).powf(2.0 / 3.0);
    for accuracy in [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8] {
        let mut force = Ewald::new(1.0, charges.clone(), accuracy);
        let found = forces(&mut force, &boundary, &ions);
        let squares: f64 = found.iter().zip(&exact).map(|(f, e)| (*f - *e).norm_squared()).sum();
        let error = (squares / 500.0).sqrt() / typical;
        println!("wanted {accuracy:.0e}: {error:.1e}, with {:?}", force.parameters(&boundary));
        assert!((0.2..1.5).contains(&(error / accuracy)), "{error:e} where {accuracy:e} was wanted");
    }
}

/// The same bits for any number of threads and every instruction set.
#[test]
fn bits_depend_on_nothing_but_the_ions() {
    let (boundary, ions, charges) = melt(4, 0.3, 2);
    let with = |threads: usize, instructions| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut force = Ewald::new(1.0, charges.clone(), 1e-4);
            force.instructions = instructions;
            let forces = forces(&mut force, &boundary, &ions);
            (forces, force.energy(0.0, &boundary, &ions), force.virial(0.0, &boundary, &ions))
        })
    };
    let one = with(1, Instructions::detect());
    for instructions in Instructions::all() {
        for threads in [1, 2, 3] {
            assert!(with(threads, instructions) == one, "{threads} threads, {instructions:?}");
        }
    }
}

/// In a box far wider than the cloud of charges, images hardly count: what is left of them is the dipole in its own field,
/// `-2 pi k M^2/(3 V)`, and terms that fall as `L^-5`.
#[test]
fn a_cloud_in_a_wide_box_feels_what_it_feels_in_open_space() {
    let (_, ions, charges) = melt(1, 0.3, 3);
    let open = Boundary::new([-1.0; 3], [3.0; 3], Axis::Open);
    let coulomb = Coulomb::new(1.0, charges.clone());
    coulomb.validate(&open, &ions).unwrap();
    let moment = ions.position.iter().zip(&charges).fold(Vector::ZERO, |sum, (&r, &q)| sum + r * q);
    let off = |side: f64| {
        let wide = Boundary::new([1.0 - side / 2.0; 3], [1.0 + side / 2.0; 3], Axis::Periodic);
        let surface = 2.0 * PI / (3.0 * side.powi(3)) * moment.norm_squared();
        (Ewald::new(1.0, charges.clone(), 1e-11).energy(0.0, &wide, &ions) + surface - coulomb.energy(0.0, &open, &ions)).abs()
    };
    let (wide, wider) = (off(16.0), off(32.0));
    let order = (wide / wider).log2();
    println!("{wide:.1e} {wider:.1e}: order {order:.2}");
    assert!(wide < 1e-3 && (order - 5.0).abs() < 0.1, "{wide:e} {wider:e}");
}

#[test]
fn what_ewald_cannot_do_is_refused_by_name() {
    let (boundary, ions, charges) = melt(1, 0.1, 1);
    let refused = |force: Ewald, boundary: &Boundary<3>| force.validate(boundary, &ions).unwrap_err().to_string();
    let good = || Ewald::new(1.0, charges.clone(), 1e-4);
    good().validate(&boundary, &ions).unwrap();
    let mut slit = boundary.clone();
    slit.axes[1] = Axis::Walls;
    assert!(refused(good(), &slit).contains("axis 1"));
    assert!(refused(Ewald::new(1.0, vec![1.0; 3], 1e-4), &boundary).contains("one for each"));
    assert!(refused(Ewald::new(1.0, charges.clone(), 1e-20), &boundary).contains("accuracy"));
    assert!(refused(Ewald::with_parameters(1.0, charges.clone(), 1.0, 1.01, 5.0), &boundary).contains("cutoff"));
    let mut wrong = charges.clone();
    wrong[2] = f64::NAN;
    assert!(refused(Ewald::new(1.0, wrong, 1e-4), &boundary).contains("charge of particle 2"));
    let direct = Coulomb::new(1.0, charges.clone());
    assert!(direct.validate(&boundary, &ions).unwrap_err().to_string().contains("Ewald"));
}
