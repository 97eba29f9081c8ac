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
