//! Starts from elsewhere, and frames for other programs.

use std::sync::Arc;

use corpuscle_core::{Particles, Vector};

use super::*;
use crate::free::spec::Imported;

/// A box of particles taken from elsewhere: `places` with the velocity 1 along x.
fn imported(text: &str, places: &[[f64; 3]]) -> System {
    let mut system = read(&(text.split("[[species]]").next().unwrap().to_owned() + "[start]\nfile = 'given.xyz'\n"));
    let mut particles = Particles::new();
    for (i, &place) in places.iter().enumerate() {
        particles.push(Vector(place), Vector([1.0, 0.0, 0.0]), 2.0, 0.3, i as u16 % 2);
    }
    system.imported = Some(Arc::new(Imported { particles, names: vec!["light".into(), "heavy".into()] }));
    system
}

/// Particles come as they are, are wrapped where the box is periodic, and are given away again as they came.
#[test]
fn what_is_taken_is_given() {
    let system = imported(&with(GAS, "'walls'", "'periodic'"), &[[1.0, 2.0, 5.0], [13.0, 4.0, 5.0], [-1.0, 6.0, 5.0]]);
    let frame = start(&system, 1).unwrap().frame().unwrap();
    assert_eq!(frame.particles.position, [[1.0, 2.0, 0.0], [1.0, 4.0, 0.0], [11.0, 6.0, 0.0]].map(Vector));
    assert_eq!((frame.dimension, frame.lower, frame.upper), (2, [0.0, 0.0, -0.5], [12.0, 9.0, 0.5]));
    assert_eq!((frame.periodic, frame.name(1), frame.particles.mass[2]), ([true, true, false], "heavy", 2.0));
    assert_eq!(frame.particles.velocity[0], Vector([1.0, 0.0, 0.0]));
}

#[test]
fn velocities_are_drawn_anew_when_asked() {
    let mut system = imported(GAS, &[[1.0, 2.0, 0.0], [4.0, 4.0, 0.0], [7.0, 6.0, 0.0]]);
    system.start.as_mut().unwrap().temperature = Some(0.7);
    let frames = [1, 1, 2].map(|seed| start(&system, seed).unwrap().frame().unwrap().particles);
    assert!(frames[0] == frames[1] && frames[0].velocity != frames[2].velocity);
    assert!((frames[0].kinetic_energy() - 3.0 * 0.7).abs() < 1e-14);
}

#[test]
fn what_does_not_fit_is_refused_by_its_key() {
    let refused = |system: &System| start(system, 1).err().map(|error| (error.key, error.value));
    let key = |system: &System| refused(system).unwrap().0;
    let good = imported(GAS, &[[1.0, 2.0, 0.0], [4.0, 4.0, 0.0]]);
    assert_eq!(refused(&good), None);
    assert_eq!(key(&System { imported: None, ..good.clone() }), "start.file");
    assert_eq!(key(&System { species: read(GAS).species, ..good.clone() }), "species[0]");
    assert_eq!(key(&imported(GAS, &[[1.0, 2.0, 0.0], [4.0, 4.0, 1.0]])), "start.file");
    assert_eq!(key(&imported(GAS, &[[1.0, 200.0, 0.0]])), "start.file");
    let (key, value) = refused(&imported(GAS, &[[1.0, 2.0, 0.0], [1.1, 2.0, 0.0]])).unwrap();
    assert!(key == "start.file" && value.contains("particles 0 and 1 overlapping"), "{key} = {value}");
}

/// A soft system's frames are those of its own steps, and asking for them changes nothing.
#[test]
fn frames_are_as_of_their_time() {
    let (mut asked, mut unasked) = (started(SOFT, 3), started(SOFT, 3));
    for step in 1..=7 {
        asked.advance(f64::from(step) / 7.0).unwrap();
        let frame = asked.frame().unwrap();
        assert!((frame.time - f64::from(step) / 7.0).abs() <= 0.005 && frame.particles.len() == 60);
    }
    unasked.advance(1.0).unwrap();
    assert_eq!(asked.frame(), unasked.frame());
    assert_eq!(fingerprint(&*asked), fingerprint(&*unasked));
}
