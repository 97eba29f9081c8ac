//! Walls that are warm, move or open, obstacles, the piston, plates that go.

use corpuscle_observe::Estimate;
use corpuscle_scene::{Body, Colour, Line};

use super::*;

/// A body where it is at the scene's time.
fn place(scene: &Scene, body: &Body) -> [f64; 2] {
    let t = scene.time - body.time;
    [0, 1].map(|k| body.position[k] + body.velocity[k] * t + 0.5 * scene.field[k] * t * t)
}

fn picture_at(simulation: &mut dyn Simulation, time: f64) -> Scene {
    simulation.advance(time).unwrap();
    let mut scene = Scene::default();
    simulation.draw(&mut scene);
    scene
}

/// The lines at this coordinate along an axis.
fn lines_at(scene: &Scene, axis: usize, coordinate: f64) -> Vec<&Line> {
    let near = |end: [f64; 3]| (end[axis] - coordinate).abs() < 1e-9;
    scene.lines.iter().filter(|line| near(line.from) && near(line.to)).collect()
}

/// One disc of radius 0.1 and mass 1 on its way to the right at the speed 1, in a box of 10 by 2.
const FLYER: &str = "engine = 'event'\nduration = 20.0\n[box]\nlower = [0.0, 0.0]\nupper = [10.0, 2.0]\nfaces = 'walls'\n\
                     [[particle]]\nposition = [1.0, 1.0]\nvelocity = [1.0, 0.0]\nradius = 0.1\n";

#[test]
fn a_gas_takes_the_temperature_of_its_walls() {
    let walls: String = ["x", "y"]
        .iter()
        .flat_map(|axis| ["lower", "upper"].map(|side| format!("[[face]]\naxis = '{axis}'\nside = '{side}'\ntemperature = 2.5\n")))
        .collect();
    let text = "observe = ['temperature']\n".to_owned() + &with(GAS, "2.0", "400.0") + &walls;
    let means: Vec<f64> = (0..8)
        .map(|seed| {
            let simulation = run(&text, seed).unwrap();
            let chart = simulation.charts().into_iter().find(|chart| chart.name == "temperature").unwrap();
            assert_eq!(chart.series[1].name, "walls at 2.5");
            // Energy comes and goes, and every bit of it is accounted for.
            let energy = &simulation.charts()[0].series[0].y;
            assert!((energy[energy.len() - 1] - energy[0]).abs() > 0.1 * energy[0]);
            assert!(check(&*simulation, "largest energy drift less what walls gave").measured < 1e-12);
            assert!(simulation.honesty().energy_drift.unwrap() < 1e-12);
            let settled = &chart.series[0].y[chart.series[0].y.len() / 5..];
            settled.iter().sum::<f64>() / settled.len() as f64
        })
        .collect();
    let estimate = Estimate::from_replicas(&means);
    assert!(estimate.score(2.5).abs() < 4.0 && estimate.relative_error() < 0.03, "{estimate:?}");
}

/// Energy less what walls gave is kept by elastic particles, whatever moves or warms them, and falls with inelastic ones.
#[test]
fn what_walls_give_is_accounted_for() {
    let driven = "[[face]]\naxis = 'x'\nside = 'lower'\noscillation = { centre = 0.2, amplitude = 0.2, angular_frequency = 3.0 }\n\
                  [[face]]\naxis = 'y'\nside = 'upper'\npath = [[1.0, 9.0], [4.0, 8.5]]\ntemperature = 1.5\n";
    let gas = with(GAS, "2.0", "30.0") + "lower = [1.0, 0.0]\nupper = [12.0, 8.0]\n" + driven;
    for more in ["field = [0.1, -0.4]\n", ""] {
        for piston in ["", "[piston]\naxis = 'x'\nposition = 11.0\nmass = 3.0\nforce = -2.0\nstops = [2.0, 12.0]\n"] {
            // The piston would go through what begins above it.
            let room = if piston.is_empty() { gas.clone() } else { with(&gas, "upper = [12.0, 8.0]", "upper = [10.0, 8.0]") };
            let simulation = run(&(more.to_owned() + &room + piston), 4).unwrap();
            let check = check(&*simulation, "largest energy drift less what walls gave");
            assert!(check.passed && check.measured < 1e-12, "{more}{piston}: {check:?}");
        }
    }
    let grains = run(&(gas + "[collisions]\nrestitution = 0.7\nelastic_below = 0.01\n"), 4).unwrap();
    let check = check(&*grains, "largest rise of the energy less what walls gave");
    assert!(check.passed && grains.honesty().energy_drift.is_none(), "{check:?}");
}

#[test]
fn the_warm_wall_and_the_cold_one_are_told_apart() {
    let text = GAS.to_owned()
        + "[[face]]\naxis = 'x'\nside = 'lower'\ntemperature = 0.5\n[[face]]\naxis = 'x'\nside = 'upper'\ntemperature = 2.0\n";
    let scene = picture_at(&mut *started(&text, 1), 1.0);
    let colours = [0.0, 12.0].map(|x| lines_at(&scene, 0, x)[0].colour);
    assert!(colours[0] != colours[1] && !colours.contains(&Colour::Wall), "{colours:?}");
    assert_eq!(lines_at(&scene, 1, 0.0)[0].colour, Colour::Wall);
    let texts: Vec<_> = scene.labels.iter().map(|label| label.text.as_str()).collect();
    assert_eq!(texts, ["kT = 0.5", "kT = 2"]);
}

#[test]
fn a_wall_that_comes_nearer_gives_twice_its_speed() {
    // The disc's edge at 1.1 + t meets the wall at 5 - t/2 after 2.6, and leaves at 2 (-1/2) - 1.
    let text = FLYER.to_owned() + "[[face]]\naxis = 'x'\nside = 'upper'\npath = [[0.0, 5.0], [4.0, 3.0]]\n";
    let mut simulation = started(&text, 1);
    let scene = picture_at(&mut *simulation, 3.0);
    assert!((scene.bodies[0].velocity[0] + 2.0).abs() < 1e-12);
    assert!((place(&scene, &scene.bodies[0])[0] - (3.6 - 2.0 * 0.4)).abs() < 1e-12);
    assert_eq!(lines_at(&scene, 0, 3.5).len(), 1, "the wall is drawn where it is");
    assert_eq!(lines_at(&picture_at(&mut *simulation, 10.0), 0, 3.0).len(), 1);
}

#[test]
fn a_shaken_floor_keeps_what_falls_on_it_above() {
    let text = "field = [0.0, -1.0]\n".to_owned()
        + &with(GAS, "duration = 2.0", "duration = 60.0")
        + "[[face]]\naxis = 'y'\nside = 'lower'\noscillation = { centre = 1.0, amplitude = 0.5, angular_frequency = 3.0 }\n";
    let mut simulation = started(&text, 2);
    for time in [0.0, 7.3, 20.0, 60.0] {
        let scene = picture_at(&mut *simulation, time);
        let floor = 1.0 + 0.5 * (3.0 * time).sin();
        assert_eq!(lines_at(&scene, 1, floor).len(), 1);
        let lowest = scene.bodies.iter().map(|body| place(&scene, body)[1]).fold(f64::INFINITY, f64::min);
        assert!(lowest > floor + 0.3 - 1e-9, "{lowest} at {time}");
    }
}

#[test]
fn an_open_wall_lets_particles_go() {
    let text = with(GAS, "2.0", "50.0") + "[[face]]\naxis = 'x'\nside = 'upper'\nopened_at = 1.0\n";
    let mut simulation = started(&text, 1);
    let outside = |scene: &Scene| scene.bodies.iter().filter(|body| place(scene, body)[0] > 12.0).count();
    let (before, after) = (picture_at(&mut *simulation, 1.0 - 1e-9), picture_at(&mut *simulation, 50.0));
    assert!(outside(&before) == 0 && outside(&after) > 20);
    assert_eq!((lines_at(&before, 0, 12.0)[0].colour, lines_at(&after, 0, 12.0)[0].colour), (Colour::Wall, Colour::Faint));
    assert!(check(&*simulation, "largest energy drift").passed);
}

#[test]
fn a_plate_goes_at_its_time() {
    let text = with(GAS, "2.0", "40.0")
        + "lower = [0.0, 0.0]\nupper = [6.0, 9.0]\n[[partition]]\naxis = 'x'\nposition = 6.0\nremoved_at = 20.0\n";
    let mut simulation = started(&text, 3);
    let right = |scene: &Scene| scene.bodies.iter().filter(|body| place(scene, body)[0] > 6.0).count();
    let (before, after) = (picture_at(&mut *simulation, 19.9), picture_at(&mut *simulation, 40.0));
    assert!(right(&before) == 0 && right(&after) > 5, "{} then {}", right(&before), right(&after));
    assert_eq!((lines_at(&before, 0, 6.0).len(), lines_at(&after, 0, 6.0).len()), (1, 0));
}

#[test]
fn obstacles_stand_in_the_way() {
    let text = FLYER.to_owned() + "[[obstacle]]\ncentre = [6.0, 1.0]\nradius = 0.5\n";
    let scene = picture_at(&mut *started(&text, 1), 5.4);
    // Contact at x = 5.4 after 4.4, and back for 1.
    assert!((place(&scene, &scene.bodies[0])[0] - 4.4).abs() < 1e-12);
    let round = |line: &&Line| ((line.from[0] - 6.0).hypot(line.from[1] - 1.0) - 0.5).abs() < 1e-9;
    assert_eq!(scene.lines.iter().filter(round).count(), 48);
    // What is generated keeps clear.
    let pegs = "[[obstacle]]\ncentre = [4.0, 4.0]\nradius = 2.0\n[[obstacle]]\ncentre = [9.0, 6.0]\nradius = 1.0\n";
    assert!(check(&*run(&(with(GAS, "2.0", "20.0") + pegs), 1).unwrap(), "largest energy drift").passed);
    let spheres = GAS_3.to_owned() + "[[obstacle]]\ncentre = [4.0, 4.0, 3.0]\nradius = 2.0\n";
    let simulation = run(&spheres, 1).unwrap();
    // They take up momentum.
    assert!(simulation.checks().iter().all(|check| check.passed && !check.quantity.contains("momentum")));
}

#[test]
fn a_piston_is_pushed_and_energy_goes_to_and_fro() {
    let text = FLYER.to_owned() + "[piston]\naxis = 'x'\nposition = 5.0\nmass = 3.0\n";
    let mut simulation = started(&text, 1);
    // Contact after 3.9; then v = (1 - 3)/4 and V = 2/4.
    let scene = picture_at(&mut *simulation, 5.9);
    assert!((scene.bodies[0].velocity[0] + 0.5).abs() < 1e-14);
    assert_eq!(lines_at(&scene, 0, 6.0).len(), 1);
    let loaded =
        with(GAS, "2.0", "50.0") + "upper = [12.0, 6.0]\n[piston]\naxis = 'y'\nposition = 8.0\nmass = 20.0\nforce = -5.0\n";
    let simulation = run(&loaded, 1).unwrap();
    assert!(check(&*simulation, "largest energy drift").passed);
    let charts = simulation.charts();
    let piston = charts.iter().find(|chart| chart.name == "piston").unwrap();
    let (low, high) = piston.series[0].y.iter().fold((f64::INFINITY, 0.0f64), |(low, high), &y| (low.min(y), high.max(y)));
    assert!(low < 7.5 && high <= 9.0, "it falls: {low} to {high}");
}

/// All of them at once, and however the way is cut up.
#[test]
fn walls_of_all_kinds_leave_no_trace_of_where_a_caller_stops() {
    let text = "observe = ['temperature']\nfield = [0.0, -0.3]\n".to_owned()
        + &with(GAS, "2.0", "20.0")
        + "upper = [9.0, 9.0]\nlower = [4.5, 2.0]\n[collisions]\nrestitution = 0.9\nelastic_below = 0.01\n\
           [[face]]\naxis = 'y'\nside = 'upper'\ntemperature = 2.0\n\
           [[face]]\naxis = 'y'\nside = 'lower'\noscillation = { centre = 0.5, amplitude = 0.5, angular_frequency = 2.0, phase = 1.0 }\n\
           [[face]]\naxis = 'x'\nside = 'upper'\nopened_at = 15.0\n[[obstacle]]\ncentre = [8.0, 1.0]\nradius = 0.6\n\
           [[partition]]\naxis = 'x'\nposition = 4.0\nhole = { along = 'y', from = 3.0, to = 5.0 }\nremoved_at = 10.0\n";
    let once = run(&text, 5).unwrap();
    let mut often = started(&text, 5);
    for stop in 1..=977 {
        often.advance(once.end() * f64::from(stop) / 977.0).unwrap();
    }
    assert_eq!(fingerprint(&*once), fingerprint(&*often));
}

#[test]
fn every_refusal_names_the_key_in_the_file() {
    let face = |rest: &str| format!("[[face]]\naxis = 'x'\nside = 'upper'\n{rest}\n");
    let pair = "[[face]]\naxis = 'x'\nside = 'lower'\npath = [[0.0, 1.0], [9.0, 7.0]]\n".to_owned() + &face("path = [[0.0, 6.0]]");
    let piston = |rest: &str| format!("[piston]\naxis = 'x'\nposition = 11.0\nmass = 1.0\n{rest}\n");
    for (text, added, key) in [
        (GAS, face("temperature = 0.0"), "face[0].temperature"),
        (GAS, face("temperature = nan"), "face[0].temperature"),
        (GAS, face("path = []"), "face[0].path"),
        (GAS, face("path = [[1.0, 10.0], [0.0, 9.0]]"), "face[0].path"),
        (GAS, face("path = [[0.0, 12.5]]"), "face[0].path"),
        (GAS, face("path = [[0.0, inf]]"), "face[0].path"),
        (GAS, face("path = [[0.0, 0.0]]"), "face[0].path"),
        (
            GAS,
            face("path = [[0.0, 10.0]]\noscillation = { centre = 10.0, amplitude = 1.0, angular_frequency = 1.0 }"),
            "face[0].oscillation",
        ),
        (GAS, face("oscillation = { centre = 10.0, amplitude = 3.0, angular_frequency = 1.0 }"), "face[0].oscillation"),
        (
            GAS,
            face("oscillation = { centre = 10.0, amplitude = 1.0, angular_frequency = 0.0 }"),
            "face[0].oscillation.angular_frequency",
        ),
        (GAS, face("oscillation = { centre = nan, amplitude = 1.0, angular_frequency = 1.0 }"), "face[0].oscillation.centre"),
        (GAS, face("opened_at = nan"), "face[0].opened_at"),
        (GAS, face(""), "face[0]"),
        (GAS, face("temperature = 1.0") + &face("opened_at = 1.0"), "face[1].side"),
        (GAS, face("temperature = 1.0").replace("'x'", "'z'"), "face[0].axis"),
        (GAS_3, face("temperature = 1.0"), "face[0].axis"),
        (GAS, pair, "face[0].path"),
        (GAS, face("path = [[0.0, 11.0], [9.0, 7.0]]") + "[[partition]]\naxis = 'x'\nposition = 8.0\n", "face[0].path"),
        (GAS, "[[obstacle]]\ncentre = [1.0]\nradius = 1.0\n".into(), "obstacle[0].centre"),
        (GAS, "[[obstacle]]\ncentre = [1.0, -1.0]\nradius = 1.0\n".into(), "obstacle[0].centre"),
        (GAS, "[[obstacle]]\ncentre = [1.0, 1.0]\nradius = -1.0\n".into(), "obstacle[0].radius"),
        (GAS, "[[obstacle]]\ncentre = [6.0, 4.0]\nradius = 9.0\n".into(), "species[0].count"),
        (FLYER, "[[obstacle]]\ncentre = [1.5, 1.0]\nradius = 0.5\n".into(), "particle[0].position"),
        (GAS, "[[partition]]\naxis = 'x'\nposition = 6.0\nremoved_at = nan\n".into(), "partition[0].removed_at"),
        (GAS, piston("").replace("mass = 1.0", "mass = 0.0"), "piston.mass"),
        (GAS, piston("").replace("11.0", "13.0"), "piston.position"),
        (GAS, piston("").replace("'x'", "'z'"), "piston.axis"),
        (GAS_3, piston(""), "piston.axis"),
        (GAS, piston("velocity = inf"), "piston.velocity"),
        (GAS, piston("force = nan"), "piston.force"),
        (GAS, piston("stops = [5.0, 4.0]"), "piston.stops"),
        (GAS, piston("stops = [10.0, 13.0]"), "piston.stops"),
        (GAS, piston("") + "[[obstacle]]\ncentre = [1.0, 1.0]\nradius = 0.5\n", "piston.stops"),
        (FLYER, piston("").replace("11.0", "1.05"), "particle[0].position"),
        (&SOFT.replace("'periodic'", "'walls'"), piston(""), "piston"),
        (SOFT, face("temperature = 1.0").replace("'x'", "'y'"), "face[0].axis"),
        (&SOFT.replace("'periodic'", "'walls'"), face("temperature = 1.0"), "face[0]"),
        (SOFT, "[[obstacle]]\ncentre = [1.0, 1.0]\nradius = 0.5\n".into(), "obstacle[0]"),
    ] {
        let invalid = refused(&(text.to_owned() + &added));
        assert_eq!(invalid.key, key, "{added}: {invalid}");
        assert!(!invalid.expected.is_empty() && !invalid.value.is_empty(), "{invalid}");
    }
}
