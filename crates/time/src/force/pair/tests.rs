use super::*;
use crate::force::{LennardJones, WeeksChandlerAndersen};
use corpuscle_core::Random;
use proptest::prelude::*;

fn gas<const D: usize>(axes: [Axis; D], side: f64, count: usize, seed: u64) -> (Boundary<D>, Particles<D>) {
    let mut boundary = Boundary::new([-1.0; D], [side - 1.0; D], Axis::Open);
    boundary.axes = axes;
    let mut random = Random::new(seed, 0);
    let mut particles = Particles::new();
    for _ in 0..count {
        let place = Vector::from_fn(|k| boundary.lower[k] + side * random.uniform());
        particles.push(place, Vector::ZERO, 1.0 + random.uniform(), 0.0, 0);
    }
    (boundary, particles)
}

fn accelerations<const D: usize>(
    force: &mut PairForce<impl PairPotential, D>,
    boundary: &Boundary<D>,
    particles: &Particles<D>,
) -> Vec<Vector<D>> {
    let mut acceleration = vec![Vector::ZERO; particles.len()];
    force.accelerate(0.0, boundary, particles, &mut acceleration);
    acceleration
}

/// Against a scan over all pairs that adds in quanta of its own; random places overlap, so forces are of any size.
fn check<const D: usize>(axes: [Axis; D], side: f64, count: usize, seed: u64) {
    let (boundary, mut particles) = gas(axes, side, count, seed);
    let potential = WeeksChandlerAndersen::new(1.0, 0.9);
    let mut force = PairForce::new(potential);
    let mut random = Random::new(seed, 1);
    for _ in 0..3 {
        let found = accelerations(&mut force, &boundary, &particles);
        let mut expected = vec![Vector::<D>::ZERO; count];
        let mut size = vec![0.0; count];
        for i in 0..count {
            for j in (0..count).filter(|&j| j != i) {
                let arrow = boundary.displacement(particles.position[i], particles.position[j]);
                if arrow.norm_squared() < potential.cutoff() * potential.cutoff() {
                    let f = arrow * -potential.force_over_distance(arrow.norm_squared());
                    expected[i] += f * (1.0 / particles.mass[i]);
                    size[i] += f.norm();
                }
            }
        }
        // A pair's force is off by half a quantum, and by the rounding of a power 14 of the distance.
        let bound = |i: usize| size[i] * 100.0 * f64::EPSILON + count as f64 * force.quantum.unit() * 2.0;
        for i in 0..count {
            assert!((found[i] - expected[i]).norm() <= bound(i), "{i}: {:?} against {:?}", found[i], expected[i]);
        }
        // A little further on the list still holds; or it must notice that it does not.
        particles.position.iter_mut().for_each(|r| {
            *r = boundary.wrap(*r + Vector::from_fn(|_| 0.06 * (random.uniform() - 0.5)));
        });
    }
}

fn axis() -> impl Strategy<Value = Axis> {
    prop_oneof![Just(Axis::Periodic), Just(Axis::Walls), Just(Axis::Open)]
}

proptest! {
    #[test]
    fn forces_are_what_a_scan_over_all_pairs_finds(
        axes in prop::array::uniform3(axis()), side in 2.1..9.0f64, count in 1..150usize, seed in any::<u64>()
    ) {
        check([axes[0], axes[1]], side, count, seed);
        check(axes, side, count, seed);
        check([axes[0]], side, count.min(12), seed);
    }
}

#[test]
fn bits_depend_neither_on_the_instruction_set_nor_on_the_number_of_threads() {
    let (boundary, mut particles) = gas([Axis::Periodic; 3], 16.0, 4096, 3);
    for (i, r) in particles.position.iter_mut().enumerate() {
        *r = *r * 0.02 + Vector::from_fn(|k| (i / 16usize.pow(k as u32) % 16) as f64 - 0.9);
    }
    let run = |instructions, threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut force = PairForce::<_, 3>::new(LennardJones { epsilon: 1.0, sigma: 1.0, cutoff: 2.5 });
            force.instructions = instructions;
            let accelerations = accelerations(&mut force, &boundary, &particles);
            assert!(force.neighbours.shares.len() >= threads);
            (accelerations, force.energy(0.0, &boundary, &particles), force.virial(0.0, &boundary, &particles))
        })
    };
    let plain = run(Instructions::PLAIN, 1);
    for instructions in Instructions::all() {
        for threads in [1, 2, 5] {
            assert!(run(instructions, threads) == plain, "{instructions:?} {threads}");
        }
    }
    let mut precise = vec![Vector::ZERO; particles.len()];
    let mut force = PairForce::<_, 3>::new(LennardJones { epsilon: 1.0, sigma: 1.0, cutoff: 2.5 });
    force.accelerate_precisely(0.0, &boundary, &particles, &[], &mut precise);
    let off = precise.iter().zip(&plain.0).map(|(a, b)| (*a - *b).norm()).fold(0.0, f64::max);
    assert!(off > 0.0 && off < 100.0 * force.quantum.unit(), "{off:e}");
}

#[test]
fn the_forces_of_a_closed_system_add_up_to_nothing() {
    let (boundary, mut particles) = gas([Axis::Periodic; 2], 30.0, 500, 1);
    particles.mass.fill(1.0);
    let mut force = PairForce::<_, 2>::new(WeeksChandlerAndersen::new(1.0, 1.0));
    let accelerations = accelerations(&mut force, &boundary, &particles);
    // Unit masses: accelerations are multiples of the quantum, whose sum in quanta is exact.
    let unit = force.quantum.unit();
    for k in 0..2 {
        assert_eq!(accelerations.iter().map(|a| (a[k] / unit) as i128).sum::<i128>(), 0);
    }
}

#[test]
fn two_particles_at_one_place_are_named_as_lost() {
    let (boundary, mut particles) = gas([Axis::Open; 2], 30.0, 9, 1);
    particles.position[7] = particles.position[2];
    let mut force = PairForce::<_, 2>::new(WeeksChandlerAndersen::new(1.0, 1.0));
    let accelerations = accelerations(&mut force, &boundary, &particles);
    let lost: Vec<usize> = (0..9).filter(|&i| !accelerations[i].is_finite()).collect();
    assert_eq!(lost, [2, 7]);
}
