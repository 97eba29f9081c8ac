//! What there is to see of a free system.

use std::collections::VecDeque;

use corpuscle_core::{Engine, Particles, Vector};
use corpuscle_scene::{Colour, Colouring, Line, Scene, TrailPoint};

use super::build::AnyEngine;
use super::run::Free;
use crate::drawing;

/// Points of a trail.
const TRAIL: usize = 2000;

/// The path of a particle.
pub(super) type Trail<const D: usize> = VecDeque<Step<D>>;

/// A step of a path that is drawn.
#[derive(serde::Serialize, serde::Deserialize)]
pub(super) struct Step<const D: usize> {
    point: TrailPoint,
    unwrapped: Vector<D>,
    /// Through a periodic face since the step before.
    jumps: bool,
}

impl<const D: usize> Free<D> {
    /// Lengthens the paths that are drawn.
    pub(super) fn follow(&mut self, particles: &Particles<D>) {
        let time = self.engine.time();
        for (i, path) in &mut self.trails {
            let (place, unwrapped) = (particles.position[*i], self.engine.unwrapped(*i));
            let jumps = path.back().is_some_and(|last| {
                // Through a periodic face: the step between the wrapped places is not the real one.
                let wrapped = place.to_three().into_iter().zip(last.point.position).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
                wrapped.sqrt() > (unwrapped - last.unwrapped).norm() * (1.0 + 1e-6)
            });
            if path.len() == TRAIL {
                path.pop_front();
            }
            path.push_back(Step { point: TrailPoint { position: place.to_three(), time }, unwrapped, jumps });
        }
    }

    pub(super) fn show(&self, scene: &mut Scene) {
        scene.clear();
        let speeds = self.names.len() < 2 && self.start.len() > 20;
        match &self.engine {
            AnyEngine::Event(engine) => {
                let species = &self.start_particles.species;
                drawing::add_event_driven(scene, engine, &self.tally, 0.0, |i| f64::from(species[i]));
            }
            AnyEngine::Time(engine) => {
                let particles = engine.particles();
                scene.time = engine.time();
                scene.field = [0.0; 3];
                let size = engine.boundary().extent().norm();
                // A point mass has no size; it is drawn as a dot, half of which is the picture's two-hundredth.
                let radius = |i: usize| if particles.radius[i] > 0.0 { particles.radius[i] } else { 0.005 * size };
                drawing::add_particles(scene, engine.time(), particles, radius);
                drawing::add_boundary(scene, engine.boundary(), engine.time());
                for &[first, second] in &self.bonds {
                    let from = particles.position[first];
                    let to = from + engine.boundary().displacement(from, particles.position[second]);
                    scene.lines.push(Line { from: from.to_three(), to: to.to_three(), width: 1.5, colour: Colour::Faint });
                }
            }
        }
        scene.colouring = if speeds {
            // Of late: a gas that cools keeps its contrast, and colours do not flicker.
            let late = &self.samples[self.samples.len().saturating_sub(25)..];
            let temperature = late.iter().map(|sample| sample.temperature).sum::<f64>() / late.len() as f64;
            Colouring::Speed {
                most: 3.0 * (temperature / self.start_particles.mass[0].max(f64::MIN_POSITIVE)).sqrt(),
                unit: String::new(),
            }
        } else {
            Colouring::Species(self.names.clone())
        };
        for (i, path) in &self.trails {
            let trail = scene.trail(*i as u32, TRAIL, Colour::Accent(self.start_particles.species[*i] as u8));
            let drawn = trail.points().back().map_or(f64::NEG_INFINITY, |last| last.time);
            for step in path.iter().filter(|step| step.point.time > drawn) {
                if step.jumps { trail.jump(step.point) } else { trail.push(step.point) }
            }
        }
        scene.title.clone_from(&self.title);
        let (kinetic, potential) = self.engine.energies();
        scene.caption = format!("{} particles   E = {:.6}", self.start.len(), kinetic + potential);
    }
}
