//! The viewer's actions, without a window, a thread or a clock.

use corpuscle_experiments::REGISTRY;

use super::*;

fn driver(name: &str) -> Driver {
    Driver::new(REGISTRY, Scenario::find(REGISTRY, name).unwrap()).unwrap()
}

/// What there is to see, trails left aside: how many points they have depends on how often they were looked at.
fn seen(driver: &mut Driver) -> Scene {
    let mut scene = Scene::default();
    driver.changed = true;
    driver.draw(&mut scene);
    scene.trails.clear();
    scene
}

/// The same without the words, which tell the speed and whether it is paused.
fn bodies(driver: &mut Driver) -> (f64, Vec<corpuscle_scene::Body>) {
    let scene = seen(driver);
    (scene.time, scene.bodies)
}

/// Where the renderer draws the bodies: each has its own clock, and is moved to the scene's time.
fn drawn(scene: &Scene) -> Vec<[f64; 3]> {
    let place = |body: &corpuscle_scene::Body| {
        let t = scene.time - body.time;
        std::array::from_fn(|k| body.position[k] + body.velocity[k] * t + 0.5 * scene.field[k] * t * t)
    };
    scene.bodies.iter().map(place).collect()
}

#[test]
fn frame_rate_and_interruptions_do_not_change_the_physics() {
    for experiment in REGISTRY {
        let mut steady = driver(experiment.name);
        steady.pass(0.5, || false);
        let mut hasty = driver(experiment.name);
        while hasty.now < steady.now {
            // Uneven pictures, most of them cut short.
            let left = (steady.now - hasty.now) / hasty.speed();
            hasty.pass((0.013f64).min(left), || true);
            hasty.draw(&mut Scene::default());
            if left < 1e-9 {
                break;
            }
        }
        // Both are taken to the same moment, exactly.
        let to = steady.now.max(hasty.now);
        steady.advance(to, || false);
        hasty.advance(to, || false);
        assert_eq!(bodies(&mut steady), bodies(&mut hasty), "{}", experiment.name);
    }
}

#[test]
fn a_pause_stops_time_and_a_step_moves_it_by_one_picture() {
    for experiment in REGISTRY {
        let mut driver = driver(experiment.name);
        driver.pass(0.1, || false);
        driver.act(Action::TogglePause);
        let paused = seen(&mut driver);
        driver.pass(10.0, || false);
        assert_eq!(seen(&mut driver), paused);
        assert!(paused.caption.contains("paused"));
        let before = driver.now;
        driver.act(Action::Step);
        assert!((driver.now - before - STEP * driver.speed()).abs() < 1e-9 * driver.now.max(1.0));
        assert_ne!(drawn(&seen(&mut driver)), drawn(&paused), "{}", experiment.name);
        driver.act(Action::TogglePause);
        let before = driver.now;
        driver.pass(0.1, || false);
        assert!(driver.now > before);
    }
}

#[test]
fn a_step_while_running_pauses() {
    let mut driver = driver("wave");
    driver.act(Action::Step);
    let now = driver.now;
    driver.pass(1.0, || false);
    assert_eq!(driver.now, now);
}

#[test]
fn a_reset_returns_to_the_same_start_and_keeps_pause_and_speed() {
    for experiment in REGISTRY {
        let mut driver = driver(experiment.name);
        driver.act(Action::TogglePause);
        driver.act(Action::Faster);
        let start = seen(&mut driver);
        driver.act(Action::Step);
        driver.act(Action::Step);
        assert_ne!(seen(&mut driver), start);
        driver.act(Action::Reset);
        assert!(driver.fresh, "old trails would lead to the new start");
        assert_eq!(seen(&mut driver), start, "{}", experiment.name);
    }
}

#[test]
fn speed_is_what_passes_in_a_second() {
    let mut driver = driver("wave");
    let usual = driver.speed();
    driver.act(Action::Faster);
    driver.act(Action::Faster);
    driver.pass(0.1, || false);
    assert!((driver.now / (0.1 * usual) - FACTOR * FACTOR).abs() < 1e-9);
    driver.act(Action::Slower);
    driver.act(Action::Slower);
    assert_eq!(driver.speed(), usual, "as many presses back as there");
    for _ in 0..10_000 {
        driver.act(Action::Slower);
    }
    assert!(driver.speed() > usual * 1e-4);
    for _ in 0..10_000 {
        driver.act(Action::Faster);
    }
    assert!(driver.speed() < usual * 1e4);
}

#[test]
fn velocities_turn_round_or_the_viewer_is_told_why_not() {
    // The gas expands from its half: after a while, and the same while backwards, it is where it was.
    let mut entropy = driver("entropy");
    let start = bodies(&mut entropy).1;
    let there = 0.02 * entropy.simulation.end();
    entropy.advance(there, || false);
    let away = bodies(&mut entropy).1;
    entropy.act(Action::Reverse);
    assert_eq!(entropy.notice(), "");
    entropy.advance(2.0 * there, || false);
    let back = bodies(&mut entropy);
    let place = |body: &corpuscle_scene::Body, time: f64| -> [f64; 2] {
        std::array::from_fn(|axis| body.position[axis] + body.velocity[axis] * (time - body.time))
    };
    let apart = |a: &[corpuscle_scene::Body], a_time: f64, b: &[corpuscle_scene::Body], b_time: f64| -> f64 {
        let pairs = a.iter().zip(b).map(|(a, b)| (place(a, a_time), place(b, b_time)));
        pairs.map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).fold(0.0, f64::max)
    };
    assert!(apart(&start, 0.0, &away, there) > 0.1);
    assert!(apart(&start, 0.0, &back.1, back.0) < 1e-6, "{}", apart(&start, 0.0, &back.1, back.0));

    let mut stars = driver("three-body");
    stars.act(Action::Reverse);
    let notice = stars.notice().to_owned();
    if !notice.is_empty() {
        assert!(notice.contains("cannot be reversed"));
        assert!(seen(&mut stars).caption.contains(&notice));
        stars.act(Action::TogglePause);
        assert_eq!(stars.notice(), "", "the next action clears it");
    }
}

#[test]
fn the_neighbours_are_all_the_experiments_in_turn() {
    let mut driver = driver(REGISTRY[0].name);
    for step in 1..=REGISTRY.len() {
        driver.act(Action::Next);
        assert_eq!(driver.scenario().name(), REGISTRY[step % REGISTRY.len()].name);
    }
    driver.act(Action::Previous);
    assert_eq!(driver.scenario().name(), REGISTRY[REGISTRY.len() - 1].name);
}

#[test]
fn nothing_new_is_not_drawn_again() {
    let mut driver = driver("three-body");
    let mut scene = Scene::default();
    driver.act(Action::TogglePause);
    assert!(driver.draw(&mut scene));
    let points: Vec<u64> = scene.trails.iter().map(corpuscle_scene::Trail::total).collect();
    for _ in 0..100 {
        driver.pass(0.01, || false);
        assert!(!driver.draw(&mut scene));
    }
    let after: Vec<u64> = scene.trails.iter().map(corpuscle_scene::Trail::total).collect();
    assert_eq!(points, after, "a pause does not eat the trails");
}
