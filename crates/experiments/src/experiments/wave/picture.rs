//! The wave experiment's picture: the chain with its springs, ends and density step, displacements drawn larger than they
//! are, and d'Alembert's string behind it.

use corpuscle_core::Invalid;
use corpuscle_scene::{Body, Colour, Label, Line, Region, Scene};

use super::beads::{self, HEIGHT};
use super::chain::{End, Ends, Polarisation};
use super::{Start, Wave, theory};

/// Largest displacement drawn, over the length.
const REACH: f64 = 0.19;

/// Which mass a body of the picture is, and how its displacement is drawn: at `rest + scale u` along an axis.
pub(super) struct Drawn {
    pub(super) mass: usize,
    pub(super) axis: usize,
    pub(super) rest: f64,
    pub(super) scale: f64,
}

impl Wave {
    pub(super) fn picture(&self, scene: &mut Scene) {
        let design = self.chain.design();
        let length = design.length();
        beads::stage(scene, length, self.chain.time());
        scene.title = "Waves on a chain".into();
        let half = 0.5 * HEIGHT * length;
        if self.ratio != 1.0 {
            let colour = Colour::Tint(1);
            scene.regions.push(Region { lower: [self.step, -half], upper: [length, half], colour });
            let label = |x: f64, text: String| Label { at: [x, -0.92 * half, 0.0], text, colour: Colour::Ink };
            let c = self.material.speed();
            scene.labels.push(label(0.5 * self.step, format!("mass {}, c = {c:.3}", self.material.mass)));
            let (mass, slow) = (self.material.mass * self.ratio, c / self.ratio.sqrt());
            scene.labels.push(label(0.5 * (self.step + length), format!("mass {mass}, c = {slow:.3}")));
        }
        let scale = self.scale();
        let (middle, shown) = self.across();
        self.string(scene, middle, shown, half);
        if design.polarisation == Polarisation::Longitudinal {
            self.planes(scene, -0.45 * half, 0.22 * half);
        }
        scene.caption = self.caption(scale);
    }

    /// How much larger than they are displacements are drawn.
    fn scale(&self) -> f64 {
        REACH * self.chain.design().length() / self.reference()
    }

    /// Height about which displacements are drawn across, and how much larger.
    fn across(&self) -> (f64, f64) {
        let half = 0.5 * HEIGHT * self.chain.design().length();
        match self.chain.design().polarisation {
            Polarisation::Transverse => (0.0, self.scale()),
            Polarisation::Longitudinal => (0.42 * half, 0.55 * self.scale()),
        }
    }

    /// How much larger displacements are drawn along the chain, as far as masses keep their order.
    fn scale_along(&self) -> f64 {
        0.8 * self.material.speed() / (self.fastest() * self.ratio.sqrt().max(1.0))
    }

    /// How a body of the picture is drawn.
    ///
    /// # Errors
    /// When there is none of this number.
    pub(super) fn drawn(&self, body: usize) -> Result<Drawn, Invalid> {
        let design = self.chain.design();
        let count = design.count();
        let along = design.polarisation == Polarisation::Longitudinal && body >= count;
        let mass = if along { body - count } else { body };
        if mass >= count {
            return Err(Invalid::new("body", body, "one of the masses in the picture"));
        }
        Ok(if along {
            Drawn { mass, axis: 0, rest: design.place(mass), scale: self.scale_along() }
        } else {
            let (rest, scale) = self.across();
            Drawn { mass, axis: 1, rest, scale }
        })
    }

    fn caption(&self, scale: f64) -> String {
        let mut parts = vec![];
        if let (Some(sample), true) = (self.samples.last(), self.ratio != 1.0) {
            let energy = sample.kinetic + sample.elastic;
            if energy > 0.0 {
                parts.push(format!("energy left of the step {:.1} %", 100.0 * sample.left / energy));
            }
            let (r, t) = theory::step_amplitudes(self.ratio);
            parts.push(format!("echo {r:+.2}, onwards {t:+.2}"));
        } else if let Start::Mode(j) = self.start {
            let phase = theory::Modes::of(self.chain.design()).map_or(0.0, |modes| modes.phase(j));
            parts.push(format!("mode {j}, omega = {:.5}", theory::dispersion(self.material.omega_0(), phase)));
        } else {
            parts.push(format!("c = {:.3}", self.material.speed()));
        }
        if let Start::Drive { angular_frequency } = self.start {
            let wavelength = std::f64::consts::TAU * self.material.speed() / angular_frequency;
            parts.push(format!("wavelength c/f = {wavelength:.2}"));
        }
        parts.push(format!("heights × {scale:.0}"));
        if self.dalembert.is_some() {
            parts.push("thin line: string".into());
        }
        parts.join("  ·  ")
    }

    /// The largest displacement to expect: it doubles at a free end, and grows in a lighter part.
    fn reference(&self) -> f64 {
        let free = matches!(self.chain.design().ends, Ends::Between(left, right) if left == End::Free || right == End::Free);
        let ends = if free && !matches!(self.start, Start::Mode(_)) { 2.0 } else { 1.0 };
        let lighter = theory::step_amplitudes(self.ratio).1.max(1.0);
        (self.amplitude * ends * lighter).max(self.largest)
    }

    /// The largest speed to expect.
    fn fastest(&self) -> f64 {
        let rate = match self.start {
            // The steepest flank of a Gaussian.
            Start::Pulse { width } => 0.61 * self.material.speed() / width,
            Start::Mode(j) => {
                let modes = theory::Modes::of(self.chain.design());
                modes.map_or(1.0, |modes| theory::dispersion(self.material.omega_0(), modes.phase(j)))
            }
            Start::Drive { angular_frequency } => 2.0 * angular_frequency,
        };
        rate * self.amplitude
    }

    /// Which half of the chain: its colour.
    fn species(&self, n: usize) -> f64 {
        f64::from(u8::from(self.ratio != 1.0 && n >= self.chain.design().count() / 2))
    }

    fn radius(&self, n: usize) -> f64 {
        // The volume goes with the mass, and the largest touch at most.
        let design = self.chain.design();
        let heaviest = self.material.mass * self.ratio.max(1.0);
        let size = (0.48 * design.spacing).min(0.011 * design.length());
        (size * libm::cbrt(design.masses[n] / heaviest)).max(0.0022 * design.length())
    }

    /// Displacements drawn across, about the height `middle`.
    fn string(&self, scene: &mut Scene, middle: f64, scale: f64, half: f64) {
        let length = self.chain.design().length();
        let height = |u: f64| middle + scale * u;
        if let Some(wave) = &self.dalembert {
            const PARTS: i32 = 400;
            let point = |part: i32| {
                let x = length * f64::from(part) / f64::from(PARTS);
                [x, height(wave.at(x, self.chain.time())), 0.0]
            };
            let line = |part: i32| Line { from: point(part), to: point(part + 1), width: 1.0, colour: Colour::Accent(5) };
            scene.lines.extend((0..PARTS).map(line));
        }
        beads::string(scene, self.on_show(), height, |n| self.radius(n), |n| self.species(n));
        self.ends(scene, middle, half);
    }

    /// Walls, rods with their rings, the shaker's track, or the seam of a ring.
    fn ends(&self, scene: &mut Scene, middle: f64, half: f64) {
        let design = self.chain.design();
        let length = design.length();
        let low = if middle == 0.0 { -half } else { middle - 0.55 * half };
        let post = |x: f64, width: f32, colour: Colour| Line { from: [x, low, 0.0], to: [x, half, 0.0], width, colour };
        let Ends::Between(left, right) = design.ends else {
            scene.lines.extend([0.0, length].map(|x| post(x, 1.0, Colour::Faint)));
            return;
        };
        for (end, x, n) in [(left, 0.0, 0), (right, length, design.count() - 1)] {
            scene.lines.push(match end {
                End::Fixed => post(x, 4.0, Colour::Wall),
                End::Free => {
                    scene.bodies[n].radius = 0.009 * length; // the ring on its rod
                    post(design.place(n), 1.5, Colour::Wall)
                }
                End::Driven(_) => post(x, 1.5, Colour::Accent(1)),
            });
        }
    }

    /// A longitudinal chain as planes that crowd and thin out, displacements enlarged as far as they keep their order.
    fn planes(&self, scene: &mut Scene, middle: f64, half: f64) {
        let design = self.chain.design();
        let scale = self.scale_along();
        let places: Vec<f64> = (0..design.count()).map(|n| design.place(n) + scale * self.on_show().displacement(n)).collect();
        for (n, &x) in places.iter().enumerate() {
            let colour = if self.species(n) == 1.0 { Colour::Accent(1) } else { Colour::Accent(0) };
            scene.lines.push(Line { from: [x, middle - half, 0.0], to: [x, middle + half, 0.0], width: 2.0, colour });
            scene.bodies.push(Body {
                position: [x, middle, 0.0],
                velocity: [self.on_show().velocity(n), 0.0, 0.0],
                time: self.chain.time(),
                radius: self.radius(n),
                shade: self.species(n),
            });
        }
        for pair in places.windows(2) {
            let (from, to) = ([pair[0], middle, 0.0], [pair[1], middle, 0.0]);
            scene.lines.push(Line { from, to, width: 1.2, colour: Colour::Faint });
        }
        for (x, u) in self.on_show().anchors() {
            let x = x + scale * u;
            let (from, to) = ([x, middle - 1.2 * half, 0.0], [x, middle + 1.2 * half, 0.0]);
            scene.lines.push(Line { from, to, width: 4.0, colour: Colour::Wall });
        }
    }
}
