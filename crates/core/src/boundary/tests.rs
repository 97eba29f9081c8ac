use super::*;
use proptest::prelude::*;

#[test]
fn walls_take_a_radius_off_and_periodic_axes_do_not() {
    let mut slab = Boundary::new([0.0; 3], [10.0, 10.0, 4.0], Axis::Periodic);
    slab.axes[2] = Axis::Walls;
    assert_eq!(slab.accessible_volume(0.5), 300.0);
    assert_eq!(slab.wall_area(), 200.0);
}

#[test]
fn a_hole_is_open_and_its_rim_is_near() {
    let plate = Partition::new(0, 5.0).with_hole(1, 2.0, 4.0);
    assert!(plate.covers(Vector([5.0, 1.0])));
    assert!(!plate.covers(Vector([5.0, 3.0])));
    assert_eq!(plate.distance(Vector([5.0, 3.0])), 1.0);
    assert_eq!(plate.distance(Vector([8.0, 1.0])), 3.0);
    assert_eq!(plate.distance(Vector([8.0, 2.0 + 0.0])), 3.0);
}

#[test]
fn an_overlap_across_the_periodic_face_is_found() {
    let room = Boundary::<2>::periodic(10.0);
    let mut pair = Particles::new();
    pair.push(Vector([9.8, 5.0]), Vector::ZERO, 1.0, 0.5, 0);
    pair.push(Vector([0.2, 5.0]), Vector::ZERO, 1.0, 0.5, 0);
    let error = room.validate_particles(&pair).unwrap_err();
    assert_eq!(error.key, "particles 0 and 1");
}

proptest! {
    #[test]
    fn wrapping_lands_in_the_box_and_keeps_the_place(x in -1e3..1e3f64, y in -1e3..1e3f64) {
        let room = Boundary::<2>::new([-1.0, 2.0], [3.0, 9.0], Axis::Periodic);
        let point = Vector([x, y]);
        let wrapped = room.wrap(point);
        for k in 0..2 {
            prop_assert!(room.lower[k] <= wrapped[k] && wrapped[k] < room.upper[k]);
        }
        prop_assert!(room.displacement(point, wrapped).norm() < 1e-9);
    }

    #[test]
    fn overlaps_are_those_of_the_double_loop(seed in 0u64..500) {
        let mut random = crate::Random::new(seed, 0);
        let mut room = Boundary::<2>::periodic(6.0);
        if seed % 2 == 0 { room.axes[0] = Axis::Walls; }
        let mut particles = Particles::new();
        for _ in 0..20 {
            let place = Vector::from_fn(|_| random.uniform() * 6.0);
            particles.push(place, Vector::ZERO, 1.0, 0.1 + 0.4 * random.uniform(), 0);
        }
        let mut plain: f64 = 0.0;
        for i in 0..20 {
            for j in 0..i {
                let distance = room.displacement(particles.position[i], particles.position[j]).norm();
                plain = plain.max(particles.radius[i] + particles.radius[j] - distance);
            }
        }
        prop_assert_eq!(room.largest_overlap(&particles), plain);
    }
}
