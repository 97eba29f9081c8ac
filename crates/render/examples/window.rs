//! A window on a few discs in free fall: `cargo run --release -p corpuscle-render --example window`.

use std::ops::ControlFlow;

use corpuscle_render::RenderError;
use corpuscle_render::window::{Action, Options, WindowApp, view};
use corpuscle_scene::{Body, Camera, Colour, Colouring, Scene};

/// Bodies thrown up from the ground again and again; the vertex shader does all their motion.
struct Fountain {
    paused: bool,
    speed: f64,
}

impl WindowApp for Fountain {
    fn frame(&mut self, elapsed_wall: f64, scene: &mut Scene) -> ControlFlow<()> {
        if scene.bodies.is_empty() {
            scene.title = "Fountain".into();
            scene.camera = Camera::Plane { centre: [0.0, 5.0], extent: [24.0, 12.0] };
            scene.field = [0.0, -9.81, 0.0];
            scene.colouring = Colouring::Speed { most: 10.0, unit: "m/s".into() };
            scene.add_box([-12.0, 0.0, 0.0], [12.0, 11.0, 0.0], 1.5, Colour::Wall);
            scene.bodies = (0..400).map(|i| thrown(i, -2.2 * (i as f64 * 0.7548).fract())).collect();
        }
        if !self.paused {
            scene.time += self.speed * elapsed_wall;
        }
        let time = scene.time;
        for (i, body) in scene.bodies.iter_mut().enumerate() {
            let flight = 2.0 * body.velocity[1] / 9.81;
            if time > body.time + flight {
                *body = thrown(i, body.time + flight);
            }
        }
        scene.caption = format!("{} times real time{}", self.speed, if self.paused { ", paused" } else { "" });
        ControlFlow::Continue(())
    }

    fn act(&mut self, action: Action) {
        match action {
            Action::TogglePause => self.paused = !self.paused,
            Action::Faster => self.speed *= 2.0,
            Action::Slower => self.speed /= 2.0,
            _ => {}
        }
    }
}

fn thrown(index: usize, time: f64) -> Body {
    let part = index as f64 / 400.0;
    let angle = 1.1 + 0.94 * part;
    let speed = 9.0 + 2.0 * (index as f64 * 0.618).fract();
    Body { velocity: [speed * angle.cos(), speed * angle.sin(), 0.0], time, radius: 0.12, ..Body::default() }
}

fn main() -> Result<(), RenderError> {
    view(Options::default(), Fountain { paused: false, speed: 1.0 })
}
