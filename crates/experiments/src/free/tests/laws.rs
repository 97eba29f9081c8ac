//! Laws of pairs, restitution, and growth to dense starts.

use corpuscle_event::Restitution;

use super::*;

/// Two discs of diameter 1, two apart in the mean, closing at the relative speed 1 along a line.
const PAIR: &str = "engine = 'event'\nduration = 20.0\n[box]\nlower = [0.0, 0.0]\nupper = [40.0, 40.0]\nfaces = 'periodic'\n\
                    [[particle]]\nposition = [18.0, 20.0]\nvelocity = [0.5, 0.0]\nradius = 0.5\n\
                    [[particle]]\nposition = [22.0, 20.0]\nvelocity = [-0.5, 0.0]\nradius = 0.5\n";

/// Velocity of the first disc at a time.
fn speed_at(text: &str, time: f64) -> f64 {
    let mut simulation = started(text, 1);
    simulation.advance(time).unwrap();
    let mut scene = Scene::default();
    simulation.draw(&mut scene);
    scene.bodies[0].velocity[0]
}

#[test]
fn a_well_pulls_and_a_shoulder_pushes() {
    let well = PAIR.to_owned() + "[collisions.well]\nrange = 2.0\ndepth = 0.6\n";
    // Into the well after 2: the relative kinetic energy 1/4 grows by 0.6 to v^2/4, v = sqrt(3.4).
    assert_eq!(speed_at(&well, 1.9), 0.5);
    assert!((speed_at(&well, 2.2) - 0.5 * 3.4f64.sqrt()).abs() < 1e-14);
    assert!((speed_at(&well, 20.0) + 0.5).abs() < 1e-14);
    let low = PAIR.to_owned() + "[collisions.shoulder]\nrange = 2.0\nheight = 0.16\n";
    assert!((speed_at(&low, 2.2) - 0.5 * 0.36f64.sqrt()).abs() < 1e-14);
    // Too high: back at once.
    let high = PAIR.to_owned() + "[collisions.shoulder]\nrange = 2.0\nheight = 0.26\n";
    assert_eq!(speed_at(&high, 2.2), -0.5);
}

#[test]
fn wells_keep_energy_and_momentum_and_are_no_hard_spheres() {
    for law in ["[collisions.well]\nrange = 1.5\ndepth = 1.0\n", "[collisions.shoulder]\nrange = 1.3\nheight = 0.5\n"] {
        let text = "observe = ['pressure', 'temperature']\n".to_owned() + &with(GAS_3, "2.0", "20.0") + law;
        let simulation = run(&text, 1).unwrap();
        assert!(check(&*simulation, "largest energy drift").passed && check(&*simulation, "largest momentum").passed);
        // Neither the equation of state of hard spheres nor a virial at a constant temperature.
        assert!(simulation.checks().len() == 2 && simulation.tables().is_empty());
        assert!(simulation.charts()[0].series.iter().any(|series| series.name == "potential"));
    }
}

#[test]
fn viscoelastic_spheres_lose_what_their_speed_says() {
    let law = Restitution::Viscoelastic { stiffness: 1000.0, dissipation_time: 0.01 };
    let text = PAIR.to_owned() + "[collisions]\nviscoelastic = { stiffness = 1000.0, dissipation_time = 0.01 }\n";
    let e = law.at(1.0, [0.5, 0.5], 0.5);
    assert!((0.5..0.95).contains(&e));
    assert!((speed_at(&text, 4.0) + 0.5 * e).abs() < 1e-14);
    let gas = with(GAS_3, "2.0", "20.0") + "[collisions.viscoelastic]\nstiffness = 1000.0\ndissipation_time = 0.01\n";
    assert!(check(&*run(&gas, 1).unwrap(), "largest rise").passed);
}

#[test]
fn discs_grow_to_places_no_lattice_has() {
    let dense = with(GAS, "radius = 0.3", "radius = 0.7").replace("count = 30", "count = 60");
    assert_eq!(refused(&dense).key, "species[0].count");
    // Two sizes, and a packing of 0.72 between walls.
    let text = "observe = ['temperature']\n".to_owned() + &with(&dense, "count = 60", "count = 40");
    let grown = text + "[[species]]\ncount = 20\nradius = 0.5\n[growth]\nrate = 0.02\n";
    let simulation = run(&grown, 1).unwrap();
    assert!(simulation.checks().iter().all(|check| check.passed), "{:?}", simulation.checks());
    let chart = simulation.charts().into_iter().find(|chart| chart.name == "temperature").unwrap();
    assert!((chart.series[0].y[0] - 1.0).abs() < 1e-12);
    let mut scene = Scene::default();
    simulation.draw(&mut scene);
    assert_eq!(scene.bodies.iter().filter(|body| body.radius == 0.7).count(), 40);
    assert_eq!(fingerprint(&*simulation), fingerprint(&*run(&grown, 1).unwrap()));
    assert_ne!(fingerprint(&*simulation), fingerprint(&*run(&grown, 2).unwrap()));
}

#[test]
fn every_refusal_names_the_key_in_the_file() {
    let two = "[collisions]\nwell = { range = 1.5, depth = 1.0 }\nshoulder = { range = 1.5, height = 1.0 }\n";
    let both = "[collisions]\nrestitution = 0.9\nviscoelastic = { stiffness = 1.0, dissipation_time = 1.0 }\n";
    for (text, added, key) in [
        (GAS, "[collisions.well]\nrange = 1.0\ndepth = 1.0\n", "collisions.well.range"),
        (GAS, "[collisions.well]\nrange = inf\ndepth = 1.0\n", "collisions.well.range"),
        (GAS, "[collisions.well]\nrange = 1.5\ndepth = 0.0\n", "collisions.well.depth"),
        (GAS, "[collisions.well]\nrange = 1.5\ndepth = -1.0\n", "collisions.well.depth"),
        (GAS, "[collisions.shoulder]\nrange = 0.5\nheight = 1.0\n", "collisions.shoulder.range"),
        (GAS, "[collisions.shoulder]\nrange = 1.5\nheight = nan\n", "collisions.shoulder.height"),
        (GAS, two, "collisions.shoulder"),
        (GAS, both, "collisions.viscoelastic"),
        (GAS, "[collisions.viscoelastic]\nstiffness = 0.0\ndissipation_time = 1.0\n", "collisions.viscoelastic.stiffness"),
        (GAS, "[collisions.viscoelastic]\nstiffness = 1.0\ndissipation_time = -1.0\n", "collisions.viscoelastic.dissipation_time"),
        (GAS_3, "[collisions.well]\nrange = 6.0\ndepth = 1.0\n", "collisions.well.range"),
        (GAS_3, "[collisions.shoulder]\nrange = 6.0\nheight = 1.0\n", "collisions.shoulder.range"),
        (GAS, "[growth]\nrate = 0.0\n", "growth.rate"),
        (GAS, "[growth]\nrate = 2.0\n", "growth.rate"),
        (GAS, "[growth]\nrate = nan\n", "growth.rate"),
        (GAS, "lower = [0.0, 0.0]\n[growth]\n", "species[0].lower"),
        (GAS, "[[particle]]\nposition = [1.0, 1.0]\n[growth]\n", "particle[0]"),
        (GAS, "[[species]]\ncount = 2\nradius = 0.0\n[growth]\n", "species[1].radius"),
        (GAS, "[[species]]\ncount = 400\nradius = 0.3\n[growth]\nrate = 1.0\n", "growth"),
        (SOFT, "[growth]\n", "growth"),
    ] {
        let invalid = refused(&(text.to_owned() + added));
        assert_eq!(invalid.key, key, "{added}: {invalid}");
        assert!(!invalid.expected.is_empty() && !invalid.value.is_empty(), "{invalid}");
    }
}
