//! The driver without a clock: what is asked for happens, and how it was come by leaves no trace.

use super::*;
use corpuscle_experiments::find;
use corpuscle_scene::Body;

fn scenario(name: &str, set: &[(&str, &str)]) -> Scenario {
    let mut scenario = Scenario::new(find(name).unwrap());
    for (key, value) in set {
        scenario.set(key, value).unwrap();
    }
    scenario
}

fn gas() -> Driver {
    Driver::new(scenario("brownian", &[("particles", "40"), ("replicas", "2"), ("mass", "5")])).unwrap()
}

fn arrive(driver: &mut Driver) {
    while driver.travels() {
        driver.pass(0.0, || true);
    }
}

fn bodies(driver: &mut Driver) -> Vec<Body> {
    driver.look();
    driver.seen().scene.bodies.clone()
}

#[test]
fn time_passes_at_the_asked_speed_only_while_it_plays() {
    let mut driver = gas();
    let usual = driver.seen().speed;
    assert_eq!(usual, driver.seen().end / 30.0);
    driver.pass(1.0, || false);
    assert_eq!(driver.seen().time, 0.0);
    driver.obey(Order::Play(true));
    driver.obey(Order::Speed(0.5));
    assert_eq!(driver.pass(1.0, || false), 1.0);
    assert!((driver.seen().time - 0.5 * usual).abs() < 1e-12 * usual);
    // Stopped on the way: what did not fit is dropped, and said.
    let share = driver.pass(1.0, || true);
    assert!((share - 1.0 / f64::from(PARTS)).abs() < 1e-9);
}

#[test]
fn it_stops_where_the_verdict_is_due_and_goes_on_when_asked() {
    let mut driver = gas();
    let end = driver.seen().end;
    driver.obey(Order::Play(true));
    driver.pass(60.0, || false);
    assert_eq!((driver.seen().time, driver.seen().playing, driver.seen().measured.time), (end, false, end));
    driver.obey(Order::Play(true));
    driver.pass(1.0, || false);
    assert!(driver.seen().time > end);
}

/// Back and forth, with a reversal on the way, however often it is interrupted: the same bits.
#[test]
fn going_back_gives_the_same_bits() {
    let mut straight = gas();
    straight.obey(Order::GoTo(7.0));
    arrive(&mut straight);
    straight.obey(Order::Act(Action::Reverse));
    straight.obey(Order::GoTo(11.0));
    arrive(&mut straight);
    let at_eleven = bodies(&mut straight);

    let mut wandering = gas();
    wandering.obey(Order::Play(true));
    for _ in 0..10 {
        wandering.pass(0.05, || false);
    }
    wandering.obey(Order::Play(false));
    wandering.obey(Order::GoTo(7.0));
    arrive(&mut wandering);
    wandering.obey(Order::Act(Action::Reverse));
    for time in [14.0, 3.0] {
        wandering.obey(Order::GoTo(time));
        arrive(&mut wandering);
        assert_eq!(wandering.seen().time, time);
    }
    // Back before the reversal it is undone; doing it again at the same time gives the same again.
    wandering.obey(Order::GoTo(7.0));
    arrive(&mut wandering);
    wandering.obey(Order::Act(Action::Reverse));
    wandering.obey(Order::GoTo(12.0));
    arrive(&mut wandering);
    wandering.obey(Order::GoTo(11.0));
    arrive(&mut wandering);
    assert_eq!(bodies(&mut wandering), at_eleven);
}

#[test]
fn the_next_collision_is_one_collision_away() {
    let mut driver = gas();
    for _ in 0..20 {
        let before = bodies(&mut driver);
        driver.obey(Order::NextEvent);
        assert!(driver.seen().fault.is_none());
        let after = bodies(&mut driver);
        let turned = before.iter().zip(&after).filter(|(a, b)| a.velocity != b.velocity).count();
        assert_eq!(turned, 2, "exactly one pair has new velocities");
    }
    let mut chain = Driver::new(scenario("wave", &[])).unwrap();
    chain.obey(Order::NextEvent);
    assert_eq!(chain.seen().fault, Some(Fault::NoCollisions));
}

#[test]
fn what_cannot_be_started_leaves_the_run_as_it_is() {
    let mut driver = gas();
    driver.obey(Order::GoTo(2.0));
    arrive(&mut driver);
    let run = driver.seen().run;
    driver.obey(Order::Start(Box::new(scenario("brownian", &[("particles", "3"), ("radius", "9000")]))));
    let Some(Fault::Refused { key, expected }) = &driver.seen().fault else { panic!("accepted") };
    assert_eq!(key, "radius");
    assert!(expected.contains("at most"));
    assert_eq!((driver.seen().run, driver.seen().time), (run, 2.0));
    driver.obey(Order::Start(Box::new(scenario("wave", &[]))));
    assert_eq!((driver.seen().run, driver.seen().time, &driver.seen().fault), (run + 1, 0.0, &None));
}

/// Carried, thrown, disturbed, shut in and heated: going back undoes it, and doing it again at the same times gives the same bits,
/// however the way there was cut up.
#[test]
fn hands_are_repeated_to_the_bit() {
    let walls = [("particles", "40"), ("replicas", "2"), ("mass", "5"), ("boundary", "walls"), ("duration", "10")];
    let gas = || Driver::new(scenario("brownian", &walls)).unwrap();
    let mut driver = gas();
    let end = driver.seen().end;
    let deeds = [
        Action::Place { body: 3, at: [1.0, 1.0, 0.0] },
        Action::Throw { body: 3, velocity: [2.0, -1.0, 0.0] },
        Action::Disturb { strength: 1e-3, seed: 5 },
        Action::Partition { axis: 0, at: 0.5 * driver_side(&mut driver), hole: Some(4.0) },
        Action::Heat { axis: 0, upper: false, temperature: Some(4.0) },
        Action::Reverse,
    ];
    let run = |driver: &mut Driver, cuts: usize| {
        for (k, &action) in deeds.iter().enumerate() {
            let (from, to) = (driver.seen().time, 0.02 * end * (k + 1) as f64);
            for cut in 1..=cuts {
                driver.obey(Order::GoTo(from + (to - from) * cut as f64 / cuts as f64));
                arrive(driver);
            }
            driver.obey(Order::GoTo(to));
            arrive(driver);
            driver.obey(Order::Act(action));
            assert_eq!(driver.seen().fault, None, "{action:?}");
        }
        driver.obey(Order::GoTo(0.15 * end));
        arrive(driver);
    };
    run(&mut driver, 1);
    let there = bodies(&mut driver);
    assert_eq!(driver.seen().deeds.iter().map(|deed| deed.1).collect::<Vec<_>>(), deeds);
    // What is measured is the untouched system: a run without hands has the same charts.
    let mut untouched = gas();
    untouched.obey(Order::GoTo(0.15 * end));
    arrive(&mut untouched);
    assert_eq!(untouched.seen().measured.charts, driver.seen().measured.charts);
    assert_ne!(bodies(&mut untouched), there);

    let mut wandering = gas();
    run(&mut wandering, 7);
    assert_eq!(bodies(&mut wandering), there);
    // Back into the middle and out again: later deeds are undone, and are done again.
    wandering.obey(Order::GoTo(0.09 * end));
    arrive(&mut wandering);
    assert_eq!(wandering.seen().deeds.len(), 4);
    for (k, &action) in deeds.iter().enumerate().skip(4) {
        wandering.obey(Order::GoTo(0.02 * end * (k + 1) as f64));
        arrive(&mut wandering);
        wandering.obey(Order::Act(action));
    }
    wandering.obey(Order::GoTo(0.15 * end));
    arrive(&mut wandering);
    assert_eq!(bodies(&mut wandering), there);
}

fn driver_side(driver: &mut Driver) -> f64 {
    driver.look();
    driver.seen().scene.bounds.map_or(0.0, |[lower, upper]| upper[0] - lower[0])
}

/// Loschmidt: a reversal brings the gas back, a disturbed one does not, and the farther away the stronger the disturbance.
#[test]
fn a_disturbed_reversal_does_not_come_back() {
    let miss = |strength: Option<f64>| {
        let mut driver = gas();
        let start = bodies(&mut driver);
        driver.obey(Order::GoTo(6.0));
        arrive(&mut driver);
        if let Some(strength) = strength {
            driver.obey(Order::Act(Action::Disturb { strength, seed: 1 }));
        }
        driver.obey(Order::Act(Action::Reverse));
        driver.obey(Order::GoTo(12.0));
        arrive(&mut driver);
        let back = bodies(&mut driver);
        let scene = driver.seen().scene.clone();
        let place = |body: &Body, time: f64| crate::tools::state_at(body, &scene, time).0;
        let off = start.iter().zip(&back).map(|(a, b)| (place(a, 0.0)[0] - place(b, 12.0)[0]).abs() % scene.period[0].max(1.0));
        let side = scene.period[0];
        off.map(|x| x.min((side - x).abs())).fold(0.0, f64::max)
    };
    let (exact, slight, strong) = (miss(None), miss(Some(1e-9)), miss(Some(1e-4)));
    assert!(exact < 1e-4, "{exact}");
    assert!(slight > 10.0 * exact && strong > 10.0 * slight, "{exact} {slight} {strong}");
}

/// Three bodies by another integrator: they agree before they come close; a coarse one parts soon. Going back gives the same answer.
#[test]
fn two_ways_of_computing_agree_for_a_while() {
    let three = |integrator: &str| scenario("three-body", &[("preset", "pythagorean"), ("integrator", integrator)]);
    let mut driver = Driver::new(three("gauss-radau-15")).unwrap();
    driver.obey(Order::Beside(Some(("yoshida-4".into(), Box::new(three("yoshida-4"))))));
    arrive(&mut driver);
    driver.obey(Order::GoTo(1.5));
    arrive(&mut driver);
    driver.look();
    let side = driver.seen().beside.clone().unwrap();
    assert!(side.parted.is_none() && side.apart < 0.01 * side.radius, "{} of {}", side.apart, side.radius);
    assert_eq!(driver.seen().measured.charts[0].name, "agreement");

    let mut coarse = three("symplectic-euler");
    coarse.set("time_step", "0.02").unwrap();
    driver.obey(Order::Beside(Some(("symplectic-euler".into(), Box::new(coarse)))));
    arrive(&mut driver);
    assert_eq!(driver.seen().time, 1.5, "it went to where it was");
    driver.obey(Order::GoTo(8.0));
    arrive(&mut driver);
    driver.look();
    let parted = driver.seen().beside.as_ref().unwrap().parted;
    assert!(parted.is_some());
    driver.obey(Order::GoTo(1.0));
    arrive(&mut driver);
    driver.obey(Order::GoTo(8.0));
    arrive(&mut driver);
    driver.look();
    assert_eq!(driver.seen().beside.as_ref().unwrap().parted, parted);
    driver.obey(Order::Beside(None));
    driver.look();
    assert!(driver.seen().beside.is_none());
}
