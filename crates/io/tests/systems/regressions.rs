//! What random systems once found, by name.

use crate::{Sample, invariants};

/// Crushed between a warm wall that moves in, the floor and an obstacle, a particle is hit ever more often in ever less time. The engine
/// ends there, says what may be the matter, and leaves every particle in the box.
#[test]
fn a_particle_that_a_moving_wall_crushes_is_a_failure() {
    let text = r#"engine = 'event'
duration = 1.5
sample_interval = 0.25
[box]
lower = [0.0, 0.0, 0.0]
upper = [10.384980368350512, 9.123411337836835, 11.171878191836399]
faces = ["walls", "walls", "walls"]
[[face]]
axis = 'x'
side = 'upper'
temperature = 1.4564544064513625
oscillation = { centre = 10.177280760983502, amplitude = 0.20728420815227622, angular_frequency = 3.779198396986645, phase = 1.0 }
[[obstacle]]
centre = [9.330427024550511, 4.474751168440734, 0.5077658163839288]
radius = 0.32113991018264115
[[obstacle]]
centre = [4.031501047688602, 5.008140690678792, 8.37728011701244]
radius = 0.2910355465995476
[collisions]
viscoelastic = { stiffness = 20.0, dissipation_time = 0.03 }
elastic_below = 0.05
[[species]]
name = 'kind 0'
count = 12
radius = 0.2421871135343891
mass = 2.111011222930036
temperature = 1.2751130409738427
[[species]]
name = 'kind 1'
count = 19
radius = 0.26835721761690917
mass = 1.395064753984358
temperature = 0.21415483576698705"#;
    let mut sample = Sample::new(text.into()).unwrap();
    let failure = sample.simulation.advance(1.5).unwrap_err();
    assert!(failure.cause.contains("would crush it") && failure.particle == Some(17), "{failure}");
    assert!((failure.time - 0.632_165_423).abs() < 1e-6 && sample.simulation.time() <= failure.time, "{failure}");
    assert_eq!(sample.simulation.honesty().broken(), None);
}

/// Cold particles on a lattice that begins at a wall, pressed against it by a field: they lie there, and do not bounce.
#[test]
fn particles_at_rest_on_a_wall_under_a_field_are_refused() {
    let text = |temperature: f64, field: f64| {
        format!(
            "engine = 'event'\nduration = 1.5\nfield = [0.0, {field}]\n[box]\nlower = [0.0, 0.0]\nupper = [4.0, 4.0]\nfaces = 'walls'\n\
             [[species]]\ncount = 16\nradius = 0.5\ntemperature = {temperature}"
        )
    };
    let refusal = Sample::new(text(0.0, -1.0)).err().unwrap();
    assert_eq!(refusal.invalid.key, "species[0].temperature");
    assert!(refusal.invalid.expected.contains("hard particles bounce and do not lie"), "{refusal}");
    assert!(Sample::new(text(0.0, 0.0)).is_ok() && Sample::new(text(1.0, -1.0)).is_ok());
    let single = |place: f64, velocity: f64| {
        format!(
            "engine = 'event'\nduration = 1.5\nfield = [0.0, -1.0]\n[box]\nlower = [0.0, 0.0]\nupper = [4.0, 4.0]\nfaces = 'walls'\n\
             [[particle]]\nposition = [2.0, {place}]\nvelocity = [1.0, {velocity}]\nradius = 0.5"
        )
    };
    assert_eq!(Sample::new(single(0.5, 0.0)).err().unwrap().invalid.key, "particle[0].velocity");
    for text in [single(0.5, 1.0), single(0.75, 0.0), single(3.5, 0.0)] {
        invariants::hold(Sample::new(text).unwrap()).unwrap();
    }
}

/// A bond drawn across half the box whips its ends through a wall in one step: the engine asks for a shorter one, and gets it.
#[test]
fn a_spring_let_go_across_the_box_needs_shorter_steps() {
    let text = r#"engine = 'time'
duration = 1.5
sample_interval = 0.25
[box]
lower = [0.0, 0.0, 0.0]
upper = [9.218705816726253, 6.585811770666722, 8.269753774040945]
faces = ["walls", "walls", "walls"]
[integrator]
name = 'symplectic-euler'
time_step = 0.002
[forces.lennard_jones]
sigma = 0.8
[[spring]]
first = 0
second = 1
stiffness = 20.0
rest_length = 1.0
[[species]]
name = 'kind 0'
count = 9
radius = 0.45
mass = 0.21528058413956253
temperature = 0.25861842276611885"#;
    assert!(invariants::hold(Sample::new(text.into()).unwrap()).unwrap().halvings > 0);
}
