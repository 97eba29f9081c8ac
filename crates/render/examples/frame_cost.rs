//! What a picture of the stage costs on this machine's OpenGL, without a screen: time with reading it back, bytes sent, calls
//! to draw.
//!
//! `cargo run --release -p corpuscle-render --example frame_cost -- [FRAMES] [LARGEST]`
//!
//! `flying`: only time has passed, bodies move in the shader. `colliding`: one in a hundred has collided since the last picture.
//! `soft`: every body has moved, as with a time-driven engine. `trails`: flying, and a hundred paths of 2000 points grow by one.

use std::time::Instant;

use corpuscle_render::{Cost, Headless, RenderError, View};
use corpuscle_scene::{Body, Camera, Colour, Colouring, Scene, TrailPoint};

const KINDS: [&str; 4] = ["flying", "colliding", "soft", "trails"];

fn main() -> Result<(), RenderError> {
    let mut numbers = std::env::args().skip(1).filter_map(|word| word.parse::<usize>().ok());
    let (frames, largest) = (numbers.next().unwrap_or(9), numbers.next().unwrap_or(1_000_000));
    let view = View { overlay: false, ..View::new(1280, 720) };
    println!("bodies      kind        median ms   bytes/frame   draws");
    for count in [1_000, 10_000, 100_000, 1_000_000].into_iter().filter(|&count| count <= largest) {
        for kind in KINDS {
            let mut headless = Headless::new(1280, 720)?;
            let mut scene = gas(count);
            headless.draw(&scene, &view)?;
            let mut times = vec![];
            let mut cost = Cost::default();
            for frame in 1..=frames {
                pass(&mut scene, kind, frame);
                Cost::take();
                let began = Instant::now();
                let picture = headless.picture(&scene, &view)?;
                times.push(began.elapsed().as_secs_f64() * 1e3);
                cost = Cost::take();
                assert_eq!(picture.width, 1280);
            }
            times.sort_by(f64::total_cmp);
            println!("{count:>9}   {kind:<9} {:>11.1} {:>13} {:>7}", times[times.len() / 2], cost.bytes, cost.draws);
        }
    }
    Ok(())
}

/// Discs at packing 0.3, coloured by speed.
fn gas(count: usize) -> Scene {
    let side = (count as f64).sqrt().ceil();
    let mut scene = Scene {
        camera: Camera::fit([0.0; 3], [side, side, 0.0]),
        colouring: Colouring::Speed { most: 2.0, unit: String::new() },
        ..Scene::default()
    };
    scene.add_box([0.0; 3], [side, side, 0.0], 1.5, Colour::Wall);
    let columns = side as usize;
    scene.bodies.extend((0..count).map(|i| {
        let angle = i as f64;
        let position = [(i % columns) as f64 + 0.5, (i / columns) as f64 + 0.5, 0.0];
        Body { position, velocity: [angle.cos(), (1.7 * angle).sin(), 0.0], radius: 0.31, ..Body::default() }
    }));
    scene
}

fn pass(scene: &mut Scene, kind: &str, frame: usize) {
    scene.time += 1e-3;
    let time = scene.time;
    let moved = match kind {
        "colliding" => 100,
        "soft" => 1,
        _ => usize::MAX,
    };
    for body in scene.bodies.iter_mut().skip(frame % moved).step_by(moved).filter(|_| moved < usize::MAX) {
        let dt = time - body.time;
        body.position = std::array::from_fn(|k| body.position[k] + body.velocity[k] * dt);
        (body.velocity, body.time) = (body.velocity.map(|v| -v), time);
    }
    if kind == "trails" {
        let points: Vec<[f64; 3]> = scene.bodies.iter().take(100).map(|body| body.position).collect();
        let already = if scene.trails.is_empty() { 2000 } else { 1 };
        for (key, place) in (0..).zip(points) {
            for step in 0..already {
                let angle = 0.01 * (step + frame) as f64;
                let position = [place[0] + 5.0 * angle.cos(), place[1] + 5.0 * angle.sin(), 0.0];
                scene
                    .trail(key, 2000, Colour::Accent(1))
                    .push(TrailPoint { position, time: time - 1e-3 * (already - step) as f64 });
            }
        }
    }
}
