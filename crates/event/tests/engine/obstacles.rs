//! Fixed round obstacles against theory: scatterers, pegs, and an atmosphere between them.

use std::f64::consts::PI;
use std::ops::ControlFlow;

use crate::common::{assert_estimate, assert_score, points};
use corpuscle_core::{Axis, Boundary, Contact, Engine, Observer, Obstacle, Particles, Random, Vector};
use corpuscle_event::{EventDriven, Rules};
use corpuscle_observe::distribution::normal_score_of_chi_squared;
use corpuscle_observe::histogram::chi_squared;
use corpuscle_observe::{Estimate, blocking};

/// Contacts of each particle with anything but particles.
struct Hits(Vec<f64>);

impl<const D: usize> Observer<D> for Hits {
    fn contact(&mut self, contact: &Contact<D>) -> ControlFlow<()> {
        self.0[contact.first.index] += 1.0;
        ControlFlow::Continue(())
    }
}

/// Points of unit speed, evenly over places and directions: a state that stays, so that the mean number of contacts in
/// a time `t` is `t` over the mean free path exactly.
fn mean_number_of_contacts<const D: usize>(room: &Boundary<D>, time: f64, seed: u64) -> Estimate {
    let outside =
        |place: Vector<D>| room.obstacles.iter().all(|o| room.displacement(o.centre, place).norm() > o.radius * (1.0 + 1e-9));
    let mut particles = points(room, 4000, 1.0, &mut Random::new(seed, 0), outside);
    for velocity in &mut particles.velocity {
        *velocity = *velocity / velocity.norm();
    }
    let mut gas = EventDriven::new(room.clone(), particles, Rules::default()).unwrap();
    let mut hits = Hits(vec![0.0; 4000]);
    gas.advance(time, &mut hits).unwrap();
    let now = gas.snapshot();
    for i in 0..4000 {
        assert!((now.velocity[i].norm() - 1.0).abs() < 1e-11);
        for obstacle in &room.obstacles {
            assert!(room.displacement(obstacle.centre, now.position[i]).norm() > obstacle.radius - 1e-11);
        }
    }
    Estimate::from_replicas(&hits.0)
}

/// A Lorentz gas: in a periodic array of discs the mean free path is `pi (A - sum pi R^2) / sum 2 pi R`, after Santalo
/// (Chernov, J. Stat. Phys. 88, 1 (1997), doi:10.1007/BF02508462). These two leave no straight way through.
#[test]
fn points_among_discs_have_the_mean_free_path_of_santalo() {
    let mut room = Boundary::<2>::periodic(1.0);
    room.obstacles.push(Obstacle { centre: Vector([0.0, 0.0]), radius: 0.4 });
    room.obstacles.push(Obstacle { centre: Vector([0.5, 0.5]), radius: 0.2 });
    let path = PI * (1.0 - PI * (0.16 + 0.04)) / (2.0 * PI * 0.6);
    assert_estimate("contacts of a point", mean_number_of_contacts(&room, 4.0, 4), 4.0 / path);
}

/// In space it is `4 V / S`, the walls of the room counted with the spheres in it.
#[test]
fn points_among_spheres_have_the_mean_free_path_of_santalo() {
    let mut room = Boundary::<3>::new([0.0; 3], [3.0, 2.0, 2.0], Axis::Walls);
    room.axes[2] = Axis::Periodic;
    let (mut volume, mut surface) = (12.0, room.wall_area());
    for (centre, radius) in [([0.7, 0.8, 0.1], 0.5), ([2.1, 0.9, 1.0], 0.7), ([1.2, 1.6, 1.5], 0.25)] {
        room.obstacles.push(Obstacle { centre: Vector(centre), radius });
        volume -= 4.0 / 3.0 * PI * radius.powi(3);
        surface += 4.0 * PI * radius * radius;
    }
    assert_estimate("contacts of a point", mean_number_of_contacts(&room, 8.0, 5), 8.0 * surface / (4.0 * volume));
}

/// Pegs do not disturb an atmosphere: between them the density is `exp(-m g h / kT)` as ever. Discs over a warm floor, so
/// few that they meet but rarely; places are those open to their centres.
#[test]
fn an_atmosphere_between_pegs_is_barometric() {
    let (n, radius, g) = (20, 0.01, 1.0);
    let mut room = Boundary::<2>::new([0.0; 2], [3.0, 30.0], Axis::Walls);
    room.faces[1][0].temperature = Some(1.0);
    for row in 0..4 {
        for column in 0..3 {
            let centre = Vector([0.5 + f64::from(column) + 0.25 * f64::from(row % 2), 0.4 + 0.6 * f64::from(row)]);
            room.obstacles.push(Obstacle { centre, radius: 0.2 });
        }
    }
    let mut random = Random::new(11, 0);
    let clear = |place: Vector<2>| {
        place[1] < 8.0
            && place[1] > 0.1
            && (place[0] - 1.5).abs() < 1.4
            && room.obstacles.iter().all(|o| (o.centre - place).norm() > o.radius + 0.1)
    };
    let mut particles = points(&room, n, 1.0, &mut random, clear);
    particles.radius.fill(radius);
    let rules = Rules { field: Vector([0.0, -g]), seed: 12, ..Rules::default() };
    let mut air = EventDriven::new(room.clone(), particles, rules).unwrap();
    air.advance(100.0, &mut ()).unwrap();
    let (mut low, mut height) = (vec![], vec![]);
    for _ in 0..40_000 {
        air.advance(air.time() + 1.0, &mut ()).unwrap();
        let heights = (0..n).map(|i| air.position(i)[1]);
        low.push(heights.clone().filter(|&h| h < 1.6).count() as f64 / n as f64);
        height.push(heights.sum::<f64>() / n as f64);
    }
    // Width open to the centres at each height.
    let open = |h: f64| {
        let chord = |o: &Obstacle<2>| 2.0 * ((o.radius + radius).powi(2) - (h - o.centre[1]).powi(2)).max(0.0).sqrt();
        3.0 - 2.0 * radius - room.obstacles.iter().map(chord).sum::<f64>()
    };
    let integral = |from: f64, to: f64, f: &dyn Fn(f64) -> f64| {
        let steps = 200_000;
        let dh = (to - from) / f64::from(steps);
        (0..steps).map(|k| from + dh * (f64::from(k) + 0.5)).map(|h| f(h) * open(h) * (-g * h).exp() * dh).sum::<f64>()
    };
    let all = integral(radius, 30.0 - radius, &|_| 1.0);
    assert_estimate("share below 1.6", blocking(&low).trusted(), integral(radius, 1.6, &|_| 1.0) / all);
    assert_estimate("mean height", blocking(&height).trusted(), integral(radius, 30.0 - radius, &|h| h) / all);
    let contacts = air.counts();
    println!("{contacts:?}");
    assert!(contacts.collisions > 1000);
}

/// Grains through a Galton board: at each row to the left or to the right. They are points, the pegs have the sum of
/// both radii.
///
/// That left and right are alike is exact. That the steps are independent, hence the places binomial, is true only in the
/// limit of narrow gaps, where a grain bounces about in the pocket between three pegs until it has forgotten where it came
/// from. Here steps of neighbouring rows are correlated by a few per cent at most, which a thousand grains do not resolve in
/// their places; with gaps four times as wide and restitution 0.2 the correlation is -0.3, and the places are far from
/// binomial.
#[test]
fn a_galton_board_is_binomial() {
    let (rows, grains, reach, drop) = (8, 1000, 0.485, 0.86);
    let height = drop * f64::from(rows) + 1.0;
    let mut board = Boundary::<2>::new([-6.0, 0.0], [6.0, height], Axis::Walls);
    // Below the last row they are out.
    board.faces[1][0].opened_at = Some(0.0);
    let level = |row: i32| height - 0.8 - drop * f64::from(row);
    for row in 0..rows {
        for column in -6..=6 {
            let x = f64::from(column) + 0.5 * f64::from(row % 2);
            if x.abs() < 6.0 {
                board.obstacles.push(Obstacle { centre: Vector([x, level(row)]), radius: reach });
            }
        }
    }
    let mut random = Random::new(21, 0);
    let mut particles = Particles::new();
    for _ in 0..grains {
        particles.push(Vector([0.04 * (random.uniform() - 0.5), height - 0.2]), Vector::ZERO, 1.0, 0.0, 0);
    }
    let rules = Rules { field: Vector([0.0, -1.0]), restitution: 0.85.into(), elastic_below: 0.02, ..Rules::default() };
    let mut engine = EventDriven::new(board, particles, rules).unwrap();
    let mut places = vec![vec![]; grains];
    while places.iter().any(|slots: &Vec<f64>| slots.len() < rows as usize) && engine.time() < 500.0 {
        engine.advance(engine.time() + 0.01, &mut ()).unwrap();
        for (i, slots) in places.iter_mut().enumerate() {
            let row = slots.len() as i32;
            let place = engine.position(i);
            if row < rows && place[1] < level(row) {
                // Gaps lie half way between the pegs of their row.
                let offset = 0.5 * f64::from(1 - row % 2);
                slots.push((place[0] - offset).round() + offset);
            }
        }
    }
    println!("t = {}, {:?}", engine.time(), engine.counts());
    let step = |slots: &Vec<f64>, k: usize| 2.0 * (slots[k] - if k == 0 { 0.0 } else { slots[k - 1] });
    let products = |slots| (1..rows as usize).map(|k| step(slots, k - 1) * step(slots, k)).sum::<f64>() / f64::from(rows - 1);
    let correlation = Estimate::from_replicas(&places.iter().map(products).collect::<Vec<f64>>());
    println!("correlation of neighbouring steps: {:.4} +- {:.4}", correlation.mean, correlation.standard_error);
    assert!(correlation.mean.abs() < 0.1);
    let mut counts = vec![0; rows as usize + 1];
    for slots in &places {
        counts[(slots[rows as usize - 1] + 0.5 * f64::from(rows)) as usize] += 1;
    }
    println!("{counts:?}");
    let pairs = (0..rows as usize / 2).map(|k| (counts[k] as f64, counts[rows as usize - k] as f64));
    let asymmetry: f64 = pairs.map(|(left, right)| (left - right).powi(2) / (left + right)).sum();
    assert_score("left and right", normal_score_of_chi_squared(asymmetry, 0.5 * f64::from(rows)));
    let choose = |k: i32| (0..k).fold(1.0, |c, j| c * f64::from(rows - j) / f64::from(j + 1));
    let binomial: Vec<f64> = (0..=rows).map(|k| choose(k) * 0.5f64.powi(rows)).collect();
    assert_score("binomial", chi_squared(&counts, &binomial, 1.0, 0).unwrap().score());
}
