//! Random systems that make sense, as scenario files describe them, of both engines, in both dimensions and all kinds of boxes:
//! each runs for a short time with all invariants looked at. What once broke has a test of its own name.

#![allow(clippy::unwrap_used)] // in the helpers too: a test that cannot be set up has failed

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use corpuscle_core::Random;
use corpuscle_experiments::{Frame, REGISTRY, Simulation, free::System, free::spec};
use corpuscle_io::Scenario;
use corpuscle_io::scenario::Subject;

/// One of these, each as likely.
fn one_of<T: Clone>(random: &mut Random, choices: &[T]) -> T {
    choices[random.below(choices.len() as u32) as usize].clone()
}

fn between(random: &mut Random, from: f64, to: f64) -> f64 {
    from + (to - from) * random.uniform()
}

fn chance(random: &mut Random, probability: f64) -> bool {
    random.uniform() < probability
}

/// The box of a scenario, and what stands in it.
struct Draft<'a> {
    random: &'a mut Random,
    text: String,
    sides: Vec<f64>,
    faces: Vec<&'static str>,
}

/// The name of an axis.
const AXES: [&str; 3] = ["x", "y", "z"];

impl Draft<'_> {
    fn walled(&mut self) -> Option<usize> {
        let walled: Vec<usize> = (0..self.sides.len()).filter(|&k| self.faces[k] == "walls").collect();
        (!walled.is_empty()).then(|| one_of(self.random, &walled))
    }

    fn add(&mut self, line: &str) {
        self.text += line;
        self.text.push('\n');
    }

    /// What only hard particles meet. Not every mixture fits together: what does not is refused, and another is drawn.
    fn furnish(&mut self) {
        let dimension = self.sides.len();
        if chance(self.random, 0.25) {
            let k = self.random.below(dimension as u32) as usize;
            self.add("[[partition]]");
            self.add(&format!("axis = '{}'\nposition = {:?}", AXES[k], 0.5 * self.sides[k]));
            if chance(self.random, 0.5) {
                let along = (k + 1) % dimension;
                self.add(&format!(
                    "hole = {{ along = '{}', from = {:?}, to = {:?} }}",
                    AXES[along],
                    0.3 * self.sides[along],
                    0.6 * self.sides[along]
                ));
            }
            if chance(self.random, 0.3) {
                let time = self.random.uniform();
                self.add(&format!("removed_at = {time:?}"));
            }
        }
        for side in ["lower", "upper"] {
            if let Some(k) = self.walled().filter(|_| chance(self.random, 0.3)) {
                self.add(&format!("[[face]]\naxis = '{}'\nside = '{side}'", AXES[k]));
                if chance(self.random, 0.6) {
                    let temperature = between(self.random, 0.2, 2.0);
                    self.add(&format!("temperature = {temperature:?}"));
                }
                let depth = 0.04 * self.sides[k];
                let place = |inward: f64| if side == "lower" { inward } else { self.sides[k] - inward };
                let (far, near) = (place(depth), place(0.0));
                match self.random.below(4) {
                    0 => self.add(&format!("path = [[0.0, {far:?}], [0.7, {near:?}], [1.2, {far:?}]]")),
                    1 => {
                        let frequency = between(self.random, 0.5, 5.0);
                        // A little less than the whole way, for rounding.
                        let line = format!(
                            "oscillation = {{ centre = {:?}, amplitude = {:?}, angular_frequency = {frequency:?}, phase = 1.0 }}",
                            0.5 * (far + near),
                            0.499 * depth
                        );
                        self.add(&line);
                    }
                    2 => self.add("opened_at = 0.8"),
                    _ => {}
                }
            }
        }
        if chance(self.random, 0.3) {
            for _ in 0..=self.random.below(3) {
                let centre: Vec<f64> = self.sides.iter().map(|side| side * self.random.uniform()).collect();
                let radius = between(self.random, 0.0, 0.6);
                self.add(&format!("[[obstacle]]\ncentre = {centre:?}\nradius = {radius:?}"));
            }
        }
        if let Some(k) = self.walled().filter(|_| chance(self.random, 0.25)) {
            let side = self.sides[k];
            let (velocity, mass) = (self.random.normal(), between(self.random, 0.5, 30.0));
            let force = if chance(self.random, 0.5) { self.random.normal() } else { 0.0 };
            let (position, stops) = (0.5 * side, [0.1 * side, 0.9 * side]);
            self.add(&format!("[piston]\naxis = '{}'\nposition = {position:?}\nvelocity = {velocity:?}\nmass = {mass:?}\nforce = {force:?}\nstops = {stops:?}", AXES[k]));
        }
        match self.random.below(10) {
            0 => self.add("[collisions]\nrestitution = 0.8\nelastic_below = 0.05"),
            1 => self.add("[collisions]\nviscoelastic = { stiffness = 20.0, dissipation_time = 0.03 }\nelastic_below = 0.05"),
            2 | 3 => self.add("[collisions]\nwell = { range = 1.4, depth = 0.5 }"),
            4 => self.add("[collisions]\nshoulder = { range = 1.3, height = 0.7 }"),
            _ => {}
        }
    }

    fn soften(&mut self) {
        let name = one_of(self.random, &["velocity-verlet", "yoshida-4", "runge-kutta-4", "symplectic-euler", "yoshida-6"]);
        self.add(&format!("[integrator]\nname = '{name}'\ntime_step = 0.002"));
        match self.random.below(4) {
            0 => self.add("[forces.lennard_jones]\nsigma = 0.8"),
            1 if self.faces.iter().all(|&faces| faces != "periodic") => {
                self.add("[forces.gravity]\nconstant = 0.3\nsoftening = 0.3");
            }
            _ => self.add("[forces.wca]\nsigma = 0.8"),
        }
        if chance(self.random, 0.3) {
            self.add("[[spring]]\nfirst = 0\nsecond = 1\nstiffness = 20.0\nrest_length = 1.0");
            if chance(self.random, 0.5) {
                self.add("damping = 0.3");
            }
        }
    }
}

/// A scenario that may or may not make sense.
fn draft(seed: u64) -> String {
    let mut random = Random::new(seed, 8);
    let random = &mut random;
    let hard = chance(random, 0.7);
    let dimension = 2 + random.below(2) as usize;
    let sides: Vec<f64> = (0..dimension).map(|_| between(random, 6.0, 12.0)).collect();
    let kinds = ["periodic", "walls", "open"];
    let same = one_of(random, &kinds);
    let mixed = chance(random, 0.4);
    let faces: Vec<&str> = (0..dimension).map(|_| if mixed { one_of(random, &kinds) } else { same }).collect();
    let mut text = format!("engine = '{}'\nduration = 1.5\nsample_interval = 0.25\n", if hard { "event" } else { "time" });
    if chance(random, 0.3) {
        // A uniform field along a periodic axis is for hard particles only.
        let field: Vec<f64> = faces.iter().map(|&faces| if faces == "periodic" && !hard { 0.0 } else { random.normal() }).collect();
        let _ = writeln!(text, "field = {field:?}");
    }
    let _ = writeln!(text, "[box]\nlower = {:?}\nupper = {sides:?}\nfaces = {faces:?}", vec![0.0; dimension]);
    let mut draft = Draft { random, text, sides, faces };
    if hard {
        draft.furnish();
    } else {
        draft.soften();
    }
    if hard && chance(draft.random, 0.1) {
        draft.add("[growth]\nrate = 0.3");
    }
    for kind in 0..=draft.random.below(2) {
        let (count, radius) = (1 + draft.random.below(25), if hard { between(draft.random, 0.05, 0.45) } else { 0.45 });
        let (mass, temperature) =
            (between(draft.random, 0.2, 5.0), if chance(draft.random, 0.9) { between(draft.random, 0.2, 1.5) } else { 0.0 });
        draft.add(&format!("[[species]]\nname = 'kind {kind}'\ncount = {count}\nradius = {radius:?}\nmass = {mass:?}\ntemperature = {temperature:?}"));
    }
    draft.text
}

/// The next scenario that makes sense, and how many drafts did not.
fn sensible(seed: &mut u64) -> (String, Scenario, Box<dyn Simulation>, u64) {
    let mut refused = 0;
    loop {
        let text = draft(*seed);
        *seed += 1;
        let started = Scenario::parse(REGISTRY, &text, Path::new("random.toml")).and_then(|scenario| {
            let simulation = scenario.start()?;
            Ok((scenario, simulation))
        });
        match started {
            Ok((scenario, simulation)) => return (text, scenario, simulation, refused),
            Err(_) => refused += 1,
        }
    }
}

fn system(scenario: &Scenario) -> &System {
    match &scenario.subject {
        Subject::Free(system) => system,
        Subject::Experiment(_) => unreachable!("these describe systems of their own"),
    }
}

/// No particle is anywhere it cannot be.
fn all_in_the_box(system: &System, frame: &Frame, text: &str) {
    let particles = &frame.particles;
    for k in 0..frame.dimension {
        let walls = match &system.room.faces {
            spec::Faces::All(face) => *face,
            spec::Faces::Each(faces) => faces[k],
        } == spec::Face::Walls;
        let (lower, upper) = (system.room.lower[k], system.room.upper[k]);
        let open = |side: spec::Side| {
            let of_axis = system.walls.iter().find(|wall| wall.axis as usize == k && wall.side == side);
            of_axis.is_some_and(|wall| wall.opened_at.is_some_and(|opened| opened <= frame.time))
        };
        for (i, r) in particles.position.iter().enumerate() {
            assert!(r[k].is_finite() && particles.velocity[i][k].is_finite(), "particle {i} is nowhere\n{text}");
            // Soft walls hold centres, hard ones surfaces.
            let radius = if system.engine == spec::EngineKind::Event { particles.radius[i] - 1e-9 } else { -1e-9 };
            let margin = if walls { radius } else { 0.0 };
            if frame.periodic[k] || walls {
                let low = r[k] >= lower + margin || walls && open(spec::Side::Lower);
                let high = r[k] <= upper - margin || walls && open(spec::Side::Upper);
                assert!(low && high, "particle {i} at {:?} is outside at t = {}\n{text}", r.0, frame.time);
            }
        }
    }
}

/// Runs a system in uneven pieces and looks at everything it should keep. Answers collisions or steps, and the name of a failure
/// that may be.
fn keeps_its_invariants(text: &str, scenario: &Scenario, mut simulation: Box<dyn Simulation>) -> (u64, Option<&'static str>) {
    let system = system(scenario);
    let mut before = 0.0;
    for piece in 1..=6 {
        let to = 1.5 * f64::from(piece * piece) / 36.0;
        if let Err(failure) = simulation.advance(to) {
            // Inelastic collapse happens in finite time; the engine says so rather than stand still.
            let inelastic =
                system.collisions.as_ref().is_some_and(|rules| rules.restitution.is_some() || rules.viscoelastic.is_some());
            assert!(inelastic && failure.cause.contains("without any time passing"), "{failure}\n{text}");
            return (simulation.honesty().work, Some("collapsed"));
        }
        assert!(simulation.time() > before, "the clock stands still at {before}\n{text}");
        before = simulation.time();
        let frame = simulation.frame().unwrap();
        all_in_the_box(system, &frame, text);
        let honesty = simulation.honesty();
        assert_eq!(honesty.broken(), None, "{text}");
        assert!(honesty.largest_overlap.is_none_or(|overlap| overlap < 1e-9), "{honesty:?}\n{text}");
    }
    // Energy, with what walls gave, and momentum. Statistical checks are of no use on so short a run.
    for check in simulation.checks().into_iter().filter(|check| check.z.is_none()) {
        assert!(check.passed, "{}: {:e}, at most {:e}\n{text}", check.quantity, check.measured, check.expected);
    }
    (simulation.honesty().work, None)
}

/// Not yet part of the tests: its drafts still put particles at rest on a wall under a field, which the engine refuses to go on with,
/// and start soft systems where no step is small enough.
#[test]
#[ignore = "its drafts hold systems that cannot run"]
fn random_systems_keep_their_invariants() {
    let wanted = std::env::var("FUZZ_SYSTEMS").ok().and_then(|count| count.parse().ok()).unwrap_or(400);
    let mut seed = std::env::var("FUZZ_SEED").ok().and_then(|seed| seed.parse().ok()).unwrap_or(0);
    let mut table: BTreeMap<(String, usize, String), [u64; 3]> = BTreeMap::new();
    let mut furniture: BTreeMap<&str, u64> = BTreeMap::new();
    let (mut refused, mut work) = (0, 0);
    for _ in 0..wanted {
        let (text, scenario, simulation, drafts) = sensible(&mut seed);
        refused += drafts;
        let (done, failure) = keeps_its_invariants(&text, &scenario, simulation);
        work += done;
        let system = system(&scenario);
        let faces = match &system.room.faces {
            spec::Faces::All(face) => format!("{face:?}"),
            spec::Faces::Each(faces) if faces.iter().all(|face| *face == faces[0]) => format!("{:?}", faces[0]),
            spec::Faces::Each(_) => "Mixed".into(),
        };
        let row = table.entry((format!("{:?}", system.engine), system.room.lower.len(), faces)).or_default();
        row[0] += 1;
        row[1] += done;
        row[2] += u64::from(failure.is_some());
        let collisions = system.collisions.as_ref();
        for (name, there) in [
            ("plates", !system.partitions.is_empty()),
            ("warm walls", system.walls.iter().any(|wall| wall.temperature.is_some())),
            ("moving walls", system.walls.iter().any(|wall| wall.path.is_some() || wall.oscillation.is_some())),
            ("walls that open", system.walls.iter().any(|wall| wall.opened_at.is_some())),
            ("obstacles", !system.obstacles.is_empty()),
            ("pistons", system.piston.is_some()),
            ("fields", !system.field.is_empty()),
            ("grown starts", system.growth.is_some()),
            ("inelastic", collisions.is_some_and(|rules| rules.restitution.is_some() || rules.viscoelastic.is_some())),
            ("wells", collisions.is_some_and(|rules| rules.well.is_some())),
            ("shoulders", collisions.is_some_and(|rules| rules.shoulder.is_some())),
            ("springs", !system.springs.is_empty()),
        ] {
            *furniture.entry(name).or_default() += u64::from(there);
        }
    }
    println!("{wanted} systems, seeds up to {seed}; {refused} drafts made no sense; {work} collisions and steps");
    for ((engine, dimension, faces), [systems, work, collapsed]) in &table {
        println!("| {engine} | {dimension}-D | {faces} | {systems} | {work} | {collapsed} |");
    }
    println!("{furniture:?}");
    assert!(table.len() == 16 || wanted < 400, "both engines, both dimensions, all kinds of boxes: {table:?}");
    assert!(furniture.values().all(|&count| count > 0) || wanted < 400, "{furniture:?}");
}
