//! What there is to see: stars with their trails, dust, and the numbers of the moment.

use corpuscle_core::Vector;
use corpuscle_scene::{Body, Camera, Colour, Colouring, Line, Scene, Shade, TrailPoint};

use super::ThreeBody;
use super::fate::Fate;

/// Samples drawn behind a grain.
const TRAIL_OF_GRAIN: usize = 180;
/// The picture grows with the stars' reach up to this many times its first width.
const WIDEST: f64 = 3.0;

impl ThreeBody {
    pub(super) fn draw_into(&self, scene: &mut Scene) {
        scene.clear();
        let Some(frame) = self.path.back() else { return };
        let start = &self.start;
        let half = (1.1 * self.reach).clamp(start.view, WIDEST * start.view);
        scene.time = self.time;
        scene.title = super::EXPERIMENT.title.into();
        scene.caption = self.caption();
        scene.camera = Camera::fit([-half, -half, 0.0], [half, half, 0.0]);
        let masses = start.masses();
        let heaviest = masses.iter().fold(0.0f64, |most, &mass| most.max(mass));
        let visible = 3 + start.grains;
        scene.shaded = if scene.wanted == Shade::Collisions { Shade::Own } else { scene.wanted };
        let by_mass = scene.shaded == Shade::Mass;
        let shade = |i: usize| if by_mass { start.particles.mass[i] } else { i.min(3) as f64 };
        // The Moon's orbit is too small to be seen beside the Earth's.
        let drawn = |position: &[Vector<2>], i: usize| match start.magnified {
            Some(times) if i == 2 => (position[1] + (position[2] - position[1]) * times).to_three(),
            _ => position[i].to_three(),
        };
        scene.bodies.extend((0..visible).map(|i| Body {
            position: drawn(&frame.position, i),
            velocity: frame.velocity[i].to_three(),
            time: frame.time,
            // Volume as mass, but no star so small that it is lost.
            radius: if i < 3 { 0.035 * half * (masses[i] / heaviest).cbrt().max(0.4) } else { 0.0075 * half },
            shade: shade(i),
        }));
        let mut names: Vec<String> = masses.iter().map(|mass| format!("star, m = {mass}")).collect();
        if start.grains > 0 {
            names.push("dust".into());
        }
        if self.both && self.other.len() >= visible {
            self.draw_other(scene, &frame.position, half);
            names.resize(4, "dust".into());
            names.push(format!("the same in {}", self.runs[1].engine.integrator().name()));
        }
        scene.colouring = Colouring::Species(names);
        // Dust first: the stars' trails lie on top.
        for i in (3..visible).chain(0..3) {
            let star = i < 3;
            let (capacity, colour) = if star { (start.trail, Colour::Accent(i as u8)) } else { (TRAIL_OF_GRAIN, Colour::Faint) };
            let trail = scene.trail(i as u32, capacity, colour);
            trail.width = if star { 2.0 } else { 1.0 };
            let seen = trail.points().back().map_or(f64::NEG_INFINITY, |point| point.time);
            let first = self.path.partition_point(|frame| frame.time <= seen).max(self.path.len().saturating_sub(capacity));
            for frame in self.path.range(first..) {
                trail.push(TrailPoint { position: drawn(&frame.position, i), time: frame.time });
            }
        }
    }

    /// The same start in the other integrator, each body joined to itself.
    fn draw_other(&self, scene: &mut Scene, own: &[Vector<2>], half: f64) {
        for (i, (&here, &there)) in own.iter().zip(&self.other).enumerate().take(3 + self.start.grains) {
            let (from, to) = (here.to_three(), there.to_three());
            scene.lines.push(Line { from, to, width: 1.2, colour: Colour::Accent(4) });
            let radius = if i < 3 { 0.016 * half } else { 0.006 * half };
            scene.bodies.push(Body { position: to, velocity: [0.0; 3], time: scene.time, radius, shade: 4.0 });
        }
    }

    fn caption(&self) -> String {
        let run = &self.runs[0];
        let mut parts =
            vec![run.engine.integrator().name().to_owned(), format!("energy error {:.0e}", run.relative_energy_error())];
        if let Some(times) = self.start.magnified {
            parts.push(format!("the Moon drawn {times} times farther from the Earth than it is"));
        } else if self.both {
            let apart = self.parting.integrators.last().map_or(0.0, |apart| libm::exp(*apart));
            parts.push(format!("two integrators, one start: {apart:.1e} apart"));
        } else if self.start.preset == "pythagorean" {
            parts.push(Fate::of(run.engine.particles(), self.start.constant).describe(self.start.masses()));
        } else if let Some(apart) = self.parting.neighbours.last().filter(|_| self.start.grains > 1) {
            parts.push(format!("grains {} apart are now {:.2} apart", self.start.spacing, libm::exp(*apart)));
        } else if let Some(period) = self.start.period {
            parts.push(format!("period {:.2}", self.time / period));
        }
        parts.join("   ")
    }
}
