//! Writes a few pictures into a folder: `cargo run --release -p corpuscle-render --example gallery -- FOLDER`.

use std::path::PathBuf;

use corpuscle_render::{Headless, RenderError};
use corpuscle_scene::{Body, Camera, Colour, Colouring, Label, Line, Palette, Region, Scene, TrailPoint};

fn main() -> Result<(), RenderError> {
    let folder = PathBuf::from(std::env::args_os().nth(1).unwrap_or_else(|| "gallery".into()));
    std::fs::create_dir_all(&folder).map_err(|source| RenderError::Write { path: folder.clone(), source })?;
    let mut headless = Headless::new(1280, 800)?;
    let scenes =
        [("gas", gas()), ("mixing", mixing()), ("spheres", spheres()), ("chain", chain()), ("stars", stars()), ("portrait", gas())];
    for (name, scene) in &scenes {
        for (suffix, palette) in [("dark", Palette::Dark), ("light", Palette::Light)] {
            let mut view = headless.view().palette(palette);
            if *name == "portrait" {
                (view.width, view.height, view.scale) = (1080, 1350, 1.5);
            }
            headless.picture(scene, &view)?.save(folder.join(format!("{name}-{suffix}.png")))?;
        }
    }
    Ok(())
}

/// A plain generator of numbers from 0 to 1; pictures need no better one.
fn uniform(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1u64 << 53) as f64
}

fn gaussian(state: &mut u64) -> f64 {
    (0..12).map(|_| uniform(state)).sum::<f64>() - 6.0
}

fn gas() -> Scene {
    let mut state = 7;
    let mut scene = Scene {
        time: 3.217,
        title: "Ideal gas".into(),
        caption: "1600 discs, packing fraction 0.23 · P = 1.287 ± 0.004, theory 1.291".into(),
        camera: Camera::fit([0.0; 3], [40.0, 40.0, 0.0]),
        colouring: Colouring::Speed { most: 3.5, unit: "m/s".into() },
        ..Scene::default()
    };
    for i in 0..1600 {
        let [column, row] = [i % 40, i / 40].map(f64::from);
        let jitter = |state: &mut u64| 0.5 + 0.36 * (uniform(state) - 0.5);
        scene.bodies.push(Body {
            position: [column + jitter(&mut state), row + jitter(&mut state), 0.0],
            velocity: [gaussian(&mut state), gaussian(&mut state), 0.0],
            time: 3.217,
            radius: 0.27 + 0.04 * uniform(&mut state),
            shade: 0.0,
        });
    }
    scene.add_box([0.0; 3], [40.0, 40.0, 0.0], 2.0, Colour::Wall);
    scene
}

fn mixing() -> Scene {
    let mut scene = gas();
    scene.title = "Entropy of mixing".into();
    scene.caption = "partition removed at t = 0 · ΔS/k = 412 ± 9, theory 415.9".into();
    scene.colouring = Colouring::Species(vec!["helium".into(), "argon".into(), "xenon".into()]);
    for (index, body) in scene.bodies.iter_mut().enumerate() {
        body.shade = if body.position[0] < 20.0 { f64::from(u8::from(index % 7 == 0)) } else { 1.0 };
        if index % 97 == 0 {
            body.shade = 2.0;
        }
    }
    scene.regions.push(Region { lower: [0.0, 0.0], upper: [20.0, 40.0], colour: Colour::Tint(0) });
    scene.regions.push(Region { lower: [20.0, 0.0], upper: [40.0, 40.0], colour: Colour::Tint(1) });
    scene.lines.push(Line { from: [20.0, 0.0, 0.0], to: [20.0, 16.0, 0.0], width: 2.0, colour: Colour::Wall });
    scene.lines.push(Line { from: [20.0, 24.0, 0.0], to: [20.0, 40.0, 0.0], width: 2.0, colour: Colour::Wall });
    scene
}

fn spheres() -> Scene {
    let mut state = 11;
    let side = 12;
    let upper = [f64::from(side); 3];
    let mut scene = Scene {
        time: 0.84,
        title: "Hard spheres".into(),
        caption: "1728 spheres, packing fraction 0.30 · Z = 3.97 ± 0.01, Carnahan–Starling 3.974".into(),
        camera: Camera::fit([0.0; 3], upper),
        colouring: Colouring::Speed { most: 4.0, unit: String::new() },
        ..Scene::default()
    };
    for i in 0..side * side * side {
        let place = [i % side, i / side % side, i / side / side];
        scene.bodies.push(Body {
            position: place.map(|n| f64::from(n) + 0.5 + 0.16 * (uniform(&mut state) - 0.5)),
            velocity: [gaussian(&mut state), gaussian(&mut state), gaussian(&mut state)],
            time: 0.84,
            radius: 0.41,
            shade: 0.0,
        });
    }
    scene.add_box([0.0; 3], upper, 1.5, Colour::Wall);
    scene
}

fn chain() -> Scene {
    let length = 64;
    let wave = |i: i32| 6.0 * (-((f64::from(i) - 20.0) / 6.0).powi(2)).exp() - 3.0 * (-((f64::from(i) - 46.0) / 4.0).powi(2)).exp();
    let mut scene = Scene {
        time: 12.5,
        title: "Waves on a chain".into(),
        caption: "transmitted and reflected pulse at a density step · R = 0.1716, theory 3 − 2√2".into(),
        camera: Camera::Plane { centre: [32.0, 0.0], extent: [68.0, 24.0] },
        ..Scene::default()
    };
    for i in 0..=length {
        let heavy = i >= 36;
        scene.bodies.push(Body {
            position: [f64::from(i), wave(i), 0.0],
            radius: if heavy { 0.42 } else { 0.28 },
            ..Body::default()
        });
        if i > 0 {
            let place = |i: i32| [f64::from(i), wave(i), 0.0];
            scene.lines.push(Line { from: place(i - 1), to: place(i), width: 1.5, colour: Colour::Ink });
        }
    }
    scene.lines.push(Line { from: [0.0, -9.0, 0.0], to: [0.0, 9.0, 0.0], width: 2.5, colour: Colour::Wall });
    scene.lines.push(Line { from: [36.0, -9.0, 0.0], to: [36.0, 9.0, 0.0], width: 1.0, colour: Colour::Faint });
    scene.labels.push(Label { at: [36.0, 10.0, 0.0], text: "μ → 4 μ".into(), colour: Colour::Ink });
    scene
}

fn stars() -> Scene {
    let mut scene = Scene {
        time: 5.5,
        title: "Three bodies".into(),
        caption: "figure-eight of Chenciner and Montgomery · |ΔE/E| = 3 × 10⁻¹⁴".into(),
        camera: Camera::Plane { centre: [0.0, 0.0], extent: [2.6, 1.5] },
        colouring: Colouring::Species(vec!["star 1".into(), "star 2".into(), "star 3".into()]),
        ..Scene::default()
    };
    // Leapfrog on the published start: https://doi.org/10.2307/2661357
    let mut x = [[-0.970_004_36, 0.243_087_53], [0.970_004_36, -0.243_087_53], [0.0, 0.0]];
    let mut v = [[0.466_203_685, 0.432_365_73], [0.466_203_685, 0.432_365_73], [-0.932_407_37, -0.864_731_46]];
    let acceleration = |x: &[[f64; 2]; 3], i: usize| {
        let mut a = [0.0; 2];
        for j in (0..3).filter(|j| *j != i) {
            let r = [x[j][0] - x[i][0], x[j][1] - x[i][1]];
            let cube = (r[0] * r[0] + r[1] * r[1]).powf(1.5);
            a = [a[0] + r[0] / cube, a[1] + r[1] / cube];
        }
        a
    };
    let dt = 1e-3;
    for step in 0..5500 {
        for (i, x) in x.iter().enumerate().filter(|_| step % 10 == 0) {
            let trail = scene.trail(i as u32, 170, Colour::Accent(i as u8));
            trail.width = 3.0;
            trail.push(TrailPoint { position: [x[0], x[1], 0.0], time: f64::from(step) * dt });
        }
        for (v, a) in v.iter_mut().zip([0, 1, 2].map(|i| acceleration(&x, i))) {
            *v = [v[0] + 0.5 * dt * a[0], v[1] + 0.5 * dt * a[1]];
        }
        for (x, v) in x.iter_mut().zip(&v) {
            *x = [x[0] + dt * v[0], x[1] + dt * v[1]];
        }
        for (v, a) in v.iter_mut().zip([0, 1, 2].map(|i| acceleration(&x, i))) {
            *v = [v[0] + 0.5 * dt * a[0], v[1] + 0.5 * dt * a[1]];
        }
    }
    for (i, x) in x.iter().enumerate() {
        let position = [x[0], x[1], 0.0];
        scene.bodies.push(Body { position, time: 5.5, radius: 0.045, shade: i as f64, ..Body::default() });
    }
    scene
}
