//! Random scenarios.

use std::fmt::Write;

use corpuscle_core::Random;

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

/// The step of soft systems.
pub(crate) const TIME_STEP: f64 = 0.002;

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
                // Where a moving wall leaves a particle room beside them.
                let centre: Vec<f64> = self.sides.iter().map(|side| side * between(self.random, 0.35, 0.65)).collect();
                let radius = between(self.random, 0.0, 0.45);
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
        let bath = match self.random.below(12) {
            0 => Some("'langevin'\nfriction = 0.7"),
            1 => Some("'brownian'\nfriction = 3.0"),
            2 => Some("'stochastic-rescaling'\nrelaxation_time = 0.3"),
            3 => Some("'nose-hoover'\nrelaxation_time = 0.3"),
            _ => None,
        };
        let name = bath.map_or_else(|| format!("'{name}'"), |bath| format!("{bath}\ntemperature = 0.8"));
        self.add(&format!("[integrator]\nname = {name}\ntime_step = {TIME_STEP}"));
        let closed = self.faces.contains(&"periodic");
        match self.random.below(9) {
            0 => self.add("[forces.lennard_jones]\nsigma = 0.8"),
            1 => self.add("[forces.lennard_jones]\nsigma = 0.8\nforce_shifted = true\nbetween = [{ names = ['kind 0', 'kind 0'], sigma = 0.6 }]"),
            2 => self.add("[forces.inverse_power]\nsigma = 0.8\nexponent = 9"),
            3 => self.add("[forces.yukawa]\nsigma = 0.8\nscreening_length = 0.5\ncutoff = 2.8"),
            4 => self.add("[forces.harmonic_repulsion]\nstiffness = 40.0\ndiameter = 0.9"),
            5 => self.add("[forces.morse]\nequilibrium = 0.9\nsteepness = 4.0"),
            6 => self.add("[forces.wca]\nsigma = 0.8\n[forces.coulomb]\naccuracy = 1e-5\ncharges = { 'kind 0' = 0.4 }"),
            7 if !closed => self.add("[forces.gravity]\nconstant = 0.3\nsoftening = 0.3"),
            _ => self.add("[forces.wca]\nsigma = 0.8"),
        }
        if !closed && chance(self.random, 0.2) {
            self.add(
                "[forces.central]\ncentre = [2.0, 2.0, 2.0]\nstrength = 0.4"
                    .replace(", 2.0]", if self.sides.len() == 2 { "]" } else { ", 2.0]" })
                    .as_str(),
            );
        }
        if chance(self.random, 0.1) {
            self.add("[forces.drag]\nrate = 0.2");
        }
        if chance(self.random, 0.1) {
            self.add("[[toda]]\nfirst = 0\nsecond = 1\nstiffness = 5.0\nsteepness = 0.5\nrest_length = 1.0");
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
pub(crate) fn draft(seed: u64) -> String {
    let mut random = Random::new(seed, 8);
    let random = &mut random;
    let hard = chance(random, 0.7);
    let dimension = 2 + random.below(2) as usize;
    let sides: Vec<f64> = (0..dimension).map(|_| between(random, 5.0, 9.0)).collect();
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
        let most = if hard { 60 } else { 25 };
        let (count, radius) = (1 + draft.random.below(most), if hard { between(draft.random, 0.05, 0.45) } else { 0.45 });
        let (mass, temperature) =
            (between(draft.random, 0.2, 5.0), if chance(draft.random, 0.9) { between(draft.random, 0.2, 1.5) } else { 0.0 });
        draft.add(&format!("[[species]]\nname = 'kind {kind}'\ncount = {count}\nradius = {radius:?}\nmass = {mass:?}\ntemperature = {temperature:?}"));
    }
    draft.text
}
