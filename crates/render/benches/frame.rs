//! Cost of a frame without a screen at 1280 x 720, from 10^3 to 10^6 bodies:
//! `cargo bench -p corpuscle-render`. `moving`: only the time changes, nothing is uploaded; `changing`: every body is.

use corpuscle_render::{Headless, View};
use corpuscle_scene::{Body, Camera, Colour, Colouring, Scene};
use divan::{Bencher, black_box};

fn main() {
    divan::main();
}

const COUNTS: [usize; 4] = [1_000, 10_000, 100_000, 1_000_000];

/// A box of bodies at packing 0.3 (0.2 in space), all in flight.
fn scene(count: usize, spatial: bool) -> Scene {
    let side = if spatial { (count as f64).cbrt() } else { (count as f64).sqrt() }.ceil() as usize;
    let extent = side as f64;
    let upper = [extent, extent, if spatial { extent } else { 0.0 }];
    let mut scene = Scene {
        camera: Camera::fit([0.0; 3], upper),
        colouring: Colouring::Speed { most: 2.0, unit: String::new() },
        ..Scene::default()
    };
    scene.add_box([0.0; 3], upper, 1.5, Colour::Wall);
    for i in 0..count {
        let place = [i % side, i / side % side, i / side / side].map(|n| n as f64 + 0.5);
        let z = if spatial { place[2] } else { 0.0 };
        let angle = i as f64;
        scene.bodies.push(Body {
            position: [place[0], place[1], z],
            velocity: [angle.cos(), (1.7 * angle).sin(), 0.0],
            radius: if spatial { 0.36 } else { 0.31 },
            ..Body::default()
        });
    }
    scene
}

fn run(bencher: Bencher, count: usize, spatial: bool, change: bool) {
    let view = View { overlay: false, ..View::new(1280, 720) };
    let Ok(mut headless) = Headless::new(1280, 720) else { return };
    let mut scene = scene(count, spatial);
    bencher.bench_local(move || {
        scene.time += 1e-3;
        if change {
            scene.bodies.iter_mut().for_each(|body| body.time += 1e-3);
        }
        black_box(headless.draw(&scene, &view))
    });
}

#[divan::bench(args = COUNTS, sample_count = 10)]
fn discs_moving(bencher: Bencher, count: usize) {
    run(bencher, count, false, false);
}

#[divan::bench(args = COUNTS, sample_count = 10)]
fn discs_changing(bencher: Bencher, count: usize) {
    run(bencher, count, false, true);
}

#[divan::bench(args = COUNTS, sample_count = 10)]
fn spheres_moving(bencher: Bencher, count: usize) {
    run(bencher, count, true, false);
}
