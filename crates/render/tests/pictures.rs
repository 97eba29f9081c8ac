//! Pictures, drawn for real on whatever OpenGL there is without a screen (Mesa's software renderer in CI).
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot draw has failed")]

use corpuscle_render::{Headless, Picture, ShadingLanguage, View};
use corpuscle_scene::{Body, Camera, Cell, Colour, Colouring, Line, Map, Palette, Region, Scene, TrailPoint};

const SIDE: u32 = 256;

fn bare(palette: Palette) -> View {
    View { overlay: false, palette, ..View::new(SIDE, SIDE) }
}

fn draw(scene: &Scene, view: &View) -> Picture {
    Headless::new(view.width, view.height).unwrap().picture(scene, view).unwrap()
}

/// One pixel a unit of length, the origin in the middle of the picture.
fn plane() -> Camera {
    Camera::Plane { centre: [0.0; 2], extent: [f64::from(SIDE); 2] }
}

fn white(bodies: Vec<Body>) -> Scene {
    let colouring = Colouring::Uniform(Colour::Accent(7));
    Scene { camera: plane(), bodies, colouring, ..Scene::default() }
}

fn disc(x: f64, y: f64, radius: f64) -> Body {
    Body { position: [x, y, 0.0], radius, ..Body::default() }
}

/// How far each pixel is from the ground towards `full`, from 0 to 1, by its green.
fn coverage(picture: &Picture, full: f64) -> impl Fn(u32, u32) -> f64 {
    let ground = f64::from(picture.pixel(0, 0).unwrap()[1]);
    move |x, y| (f64::from(picture.pixel(x, y).unwrap()[1]) - ground) / (full - ground)
}

fn largest_difference(a: &Picture, b: &Picture) -> u8 {
    assert_eq!(a.rgba.len(), b.rgba.len());
    a.rgba.iter().zip(&b.rgba).map(|(a, b)| a.abs_diff(*b)).max().unwrap()
}

#[test]
fn a_line_covers_what_geometry_says() {
    // From pixel edge to pixel edge, 10.5 pixels wide: coverage is known exactly in the middle of the line.
    let mut scene = white(Vec::new());
    scene.lines.push(Line { from: [-50.0, 0.0, 0.0], to: [50.0, 0.0, 0.0], width: 10.5, colour: Colour::Accent(7) });
    let picture = draw(&scene, &bare(Palette::Dark));
    let covered = coverage(&picture, 245.0);
    let column: f64 = (0..SIDE).map(|y| covered(128, y)).sum();
    // Each of the two edges is rounded to 1/255, once for its opacity and once for its colour.
    assert!((column - 10.5).abs() < 4.0 / 200.0, "{column}");
}

/// Cells lie where geometry says, the first one at the lower left, and in the palette's colours.
#[test]
fn a_map_shows_its_cells() {
    let cell = |species: u8| Cell { species, strength: 255 };
    let map = Map { lower: [-60.0, -40.0], upper: [60.0, 40.0], columns: 3, cells: [1, 2, 3, 4, 5, 6].map(cell).into() };
    let scene = Scene { map: Some(map), ..white(Vec::new()) };
    for palette in [Palette::Dark, Palette::Light] {
        let picture = draw(&scene, &bare(palette));
        for (number, at) in [[-40, -20], [0, -20], [40, -20], [-40, 20], [0, 20], [40, 20]].into_iter().enumerate() {
            for shift in [-19, 0, 19] {
                let pixel = picture.pixel((128 + at[0] + shift) as u32, (127 - at[1] - shift) as u32).unwrap();
                let expected = palette.rgba(Colour::Accent(number as u8 + 1)).map(|c| (255.0 * c).round() as u8);
                assert_eq!(pixel[..3], expected[..3], "cell {number} off by {shift}");
            }
        }
        let ground = palette.ground().map(|c| (255.0 * c).round() as u8);
        for at in [(66, 128), (190, 128), (128, 86), (128, 170)] {
            assert_eq!(picture.pixel(at.0, at.1).unwrap()[..3], ground, "outside, at {at:?}");
        }
    }
}

#[test]
fn a_disc_covers_its_area_around_its_place() {
    for (x, y, radius) in [(0.0, 0.0, 20.0), (31.25, -17.6, 9.3), (-80.1, 60.7, 33.3)] {
        // The outline is darker than the body, so what counts is whether a pixel differs from the ground at all.
        let picture = draw(&white(vec![disc(x, y, radius)]), &bare(Palette::Dark));
        let ground = picture.pixel(0, 0).unwrap();
        let middle = f64::from(SIDE) / 2.0;
        let (mut count, mut sum) = (0.0, [0.0; 2]);
        for row in 0..SIDE {
            for column in 0..SIDE {
                let place = [f64::from(column) + 0.5 - middle, middle - f64::from(row) - 0.5];
                let distance = (place[0] - x).hypot(place[1] - y);
                if picture.pixel(column, row).unwrap() == ground {
                    // A covered fraction below half a step of 1/255 of the faintest outline is invisible.
                    assert!(distance > radius + 0.5 - 0.02, "a hole in the disc");
                } else {
                    assert!(distance < radius + 0.5 + 1e-3, "painted {distance} from the centre");
                    count += 1.0;
                    sum = [sum[0] + place[0], sum[1] + place[1]];
                }
            }
        }
        // All pixels with centres within r + 1/2 were painted and no other: their number is the area up to Gauss's
        // circle error, of the order of the square root of the perimeter; their mean is the centre.
        let area = std::f64::consts::PI * (radius + 0.5) * (radius + 0.5);
        let perimeter = 2.0 * std::f64::consts::PI * (radius + 0.5);
        assert!((count - area).abs() < 3.0 * perimeter.sqrt(), "{count} pixels for an area of {area}");
        assert!((sum[0] / count - x).abs() < 0.1 && (sum[1] / count - y).abs() < 0.1);
    }
}

#[test]
fn the_edge_is_antialiased_by_its_distance() {
    // The right edge of the disc crosses the row through its centre at a quarter of a pixel: the outermost pixel is
    // covered by (r - d + 1/2) with d the distance of its centre.
    let x = 0.25;
    let picture = draw(&white(vec![disc(x, 0.5, 20.0)]), &bare(Palette::Dark));
    let row = SIDE / 2 - 1;
    let inner = f64::from(picture.pixel(128 + 19, row).unwrap()[1]);
    let outer = f64::from(picture.pixel(128 + 20, row).unwrap()[1]);
    let ground = f64::from(picture.pixel(0, 0).unwrap()[1]);
    // The centre of that pixel is 20.5 - 0.25 from the disc's.
    let expected = 20.0 - (20.5 - x) + 0.5;
    assert!(((outer - ground) / (inner - ground) - expected).abs() < 2.0 / (inner - ground), "{outer} {inner}");
}

#[test]
fn a_body_is_moved_to_the_scenes_time() {
    let (time, g) = (7.25, [0.0, -3.0, 0.0]);
    let mut moved = white(Vec::new());
    (moved.time, moved.field) = (time, g);
    let mut given = moved.clone();
    for i in 0..40 {
        let own = 7.0 + 0.2 * (f64::from(i) * 0.7).sin();
        let body = Body {
            position: [f64::from(i * 5 - 100), f64::from((i * 37) % 101) - 50.0, 0.0],
            velocity: [20.0 * (f64::from(i) * 1.3).cos(), 20.0 * (f64::from(i) * 2.1).sin(), 0.0],
            time: own,
            radius: 4.0 + f64::from(i % 5),
            shade: 0.0,
        };
        let dt = time - own;
        moved.bodies.push(body);
        given.bodies.push(Body {
            position: std::array::from_fn(|k| body.position[k] + body.velocity[k] * dt + 0.5 * g[k] * dt * dt),
            velocity: std::array::from_fn(|k| body.velocity[k] + g[k] * dt),
            time,
            ..body
        });
    }
    let unmoved = Scene { time: 7.0, ..moved.clone() };
    for colouring in [Colouring::Uniform(Colour::Accent(1)), Colouring::Speed { most: 25.0, unit: String::new() }] {
        moved.colouring = colouring.clone();
        given.colouring = colouring;
        let view = bare(Palette::Dark);
        // Places of up to 128 pixels in single precision: a few times 128 * 2^-24 of a pixel, below 1e-4 of it; an edge
        // of one pixel then shifts by less than 255e-4 of a step, so only the rounding of a byte can differ.
        assert!(largest_difference(&draw(&moved, &view), &draw(&given, &view)) <= 1);
        assert!(largest_difference(&draw(&moved, &view), &draw(&unmoved, &view)) > 50, "the test sees no motion");
    }
}

#[test]
fn deep_zoom_keeps_its_precision() {
    let zoom = |centre: [f64; 2], extent: f64| {
        let place = |x: f64, y: f64| [centre[0] + x * extent, centre[1] + y * extent, 0.0];
        let mut scene = white(vec![
            Body { position: place(0.1, -0.2), radius: 0.15 * extent, ..Body::default() },
            // From afar: a flight of 10^5 lengths ends in the picture.
            Body {
                position: [centre[0] - 1.0e5 + 0.25 * extent, centre[1] + 0.25 * extent, 0.0],
                velocity: [1.0e5, 0.0, 0.0],
                time: -1.0,
                radius: 0.05 * extent,
                ..Body::default()
            },
        ]);
        scene.camera = Camera::Plane { centre, extent: [extent; 2] };
        scene.lines.push(Line { from: place(-0.4, -0.4), to: place(0.3, 0.45), width: 3.0, colour: Colour::Wall });
        let lower = place(-0.3, 0.1);
        let upper = place(0.0, 0.4);
        scene.regions.push(Region { lower: [lower[0], lower[1]], upper: [upper[0], upper[1]], colour: Colour::Tint(1) });
        for i in 0..50 {
            let x = f64::from(i) / 50.0 - 0.5;
            scene.trail(0, 64, Colour::Accent(0)).push(TrailPoint { position: place(x, x * x), time: x - 1.0 });
        }
        draw(&scene, &bare(Palette::Dark))
    };
    // Places near 10^6 are known to 10^6 * 2^-52 in double precision, and reach the shader with 48 bits: 10^6 * 2^-48 is
    // 3.6e-9, or 1e-3 of a pixel of 1e-3 / 256. An edge shifted by that changes a byte by less than 1.
    let near = zoom([0.0, 0.0], 1.0e-3);
    let far = zoom([1.0e6, -1.0e6], 1.0e-3);
    assert!(largest_difference(&near, &far) <= 2, "{}", largest_difference(&near, &far));
}

#[test]
fn the_nearer_sphere_hides_the_farther_whatever_their_order() {
    let sphere = |y: f64, shade: f64| Body { position: [0.0, y, 0.0], radius: 1.0, shade, ..Body::default() };
    let mut scene = Scene {
        camera: Camera::Orbit { target: [0.0; 3], distance: 12.0, yaw: 0.0, pitch: 0.0 },
        colouring: Colouring::Species(vec!["blue".into(), "vermilion".into()]),
        bodies: vec![sphere(-1.5, 0.0), sphere(1.5, 1.0)],
        ..Scene::default()
    };
    let blue = |picture: &Picture| {
        let [r, _, b, _] = picture.pixel(SIDE / 2, SIDE / 2).unwrap();
        b > r
    };
    let view = bare(Palette::Dark);
    // With yaw 0 the eye is at negative y.
    assert!(blue(&draw(&scene, &view)));
    scene.bodies.reverse();
    assert!(blue(&draw(&scene, &view)));
    scene.bodies[0].position[1] = -3.0;
    assert!(!blue(&draw(&scene, &view)));
    // Two spheres that cut each other share their depths: at the left the left one is in front, at the right the other.
    scene.bodies = vec![sphere(0.0, 0.0), sphere(0.0, 1.0)];
    scene.bodies[0].position[0] = -0.4;
    scene.bodies[1].position[0] = 0.4;
    let cut = draw(&scene, &view);
    let is_blue = |x| {
        let [r, _, b, _] = cut.pixel(x, SIDE / 2).unwrap();
        b > r
    };
    // They meet in the plane x = 0, in the middle of the picture.
    assert!((SIDE / 2 - 8..SIDE / 2 - 1).all(is_blue));
    assert!(!(SIDE / 2 + 1..SIDE / 2 + 8).any(is_blue));
}

#[test]
fn a_sphere_has_the_silhouette_of_perspective() {
    let (distance, radius) = (5.0, 1.0);
    let mut scene = white(vec![disc(0.0, 0.0, radius)]);
    scene.camera = Camera::Orbit { target: [0.0; 3], distance, yaw: 0.3, pitch: 0.2 };
    let view = bare(Palette::Light);
    let picture = draw(&scene, &view);
    let ground = picture.pixel(0, 0).unwrap();
    let width = (0..SIDE).filter(|x| picture.pixel(*x, SIDE / 2).unwrap() != ground).count() as f64;
    // Half the picture spans 20 degrees; the silhouette has the angle asin(r / d).
    let focal = f64::from(SIDE) / 2.0 / 20.0f64.to_radians().tan();
    let expected = 2.0 * focal * (radius / distance).asin().tan();
    assert!((width - expected).abs() <= 2.0, "{width} pixels, {expected} expected");
}

#[test]
fn palettes_differ_and_each_shows_its_ground() {
    let scene = white(vec![disc(0.0, 0.0, 30.0)]);
    let [dark, light] = [Palette::Dark, Palette::Light].map(|palette| draw(&scene, &bare(palette)));
    assert_eq!(dark.pixel(2, 2), Some([14, 17, 22, 255]));
    assert_eq!(light.pixel(2, 2), Some([255; 4]));
    assert!(largest_difference(&dark, &light) > 200);
    // Accent 7 is white on dark and black on light.
    assert_eq!(dark.pixel(128, 128), Some([245, 245, 245, 255]));
    assert_eq!(light.pixel(128, 128), Some([0, 0, 0, 255]));
}

#[test]
fn a_trail_drawn_bit_by_bit_equals_one_drawn_at_once() {
    let view = bare(Palette::Dark);
    let push = |scene: &mut Scene, i: u32| {
        let angle = f64::from(i) * 0.11;
        let position = [90.0 * angle.cos(), 70.0 * (1.3 * angle).sin(), 0.0];
        scene.time = f64::from(i);
        scene.trail(5, 40, Colour::Accent(1)).push(TrailPoint { position, time: f64::from(i) });
    };
    let mut headless = Headless::new(SIDE, SIDE).unwrap();
    let mut grown = white(Vec::new());
    for i in 0..137 {
        push(&mut grown, i);
        // Drawn now and then, so that uploads of all lengths happen, some across the end of the ring.
        if i % 7 == 0 || i % 11 == 0 {
            headless.picture(&grown, &view).unwrap();
        }
    }
    let at_once = draw(&grown, &view);
    assert_eq!(headless.picture(&grown, &view).unwrap(), at_once);
    // A trail that begins anew under the same key replaces the old one, even when it has become longer.
    let mut anew = white(Vec::new());
    for i in 0..150 {
        push(&mut anew, 1000 - i);
    }
    assert_eq!(headless.picture(&anew, &view).unwrap(), draw(&anew, &view));
}

#[test]
fn only_what_changed_is_sent_and_nothing_else_is_lost() {
    // 1000 bodies, several of the runs in which they are compared.
    let body = |i: u32| disc(f64::from(i % 40) * 6.0 - 117.0, f64::from(i / 40) * 9.0 - 110.0, 2.5);
    let mut scene = white((0..1000).map(body).collect());
    let view = bare(Palette::Light);
    let mut headless = Headless::new(SIDE, SIDE).unwrap();
    headless.picture(&scene, &view).unwrap();
    for changed in [vec![0], vec![255, 256], vec![999, 3], (0..1000).collect()] {
        for i in changed {
            let i: usize = i;
            scene.bodies[i].radius = 1.5 + (i % 3) as f64;
        }
        assert_eq!(headless.picture(&scene, &view).unwrap(), draw(&scene, &view));
    }
    scene.bodies.truncate(10);
    assert_eq!(headless.picture(&scene, &view).unwrap(), draw(&scene, &view));
}

fn with_everything(camera: Camera) -> Scene {
    let mut scene = Scene {
        time: 1.5,
        title: "Title".into(),
        caption: "caption ± ∞ λ".into(),
        camera,
        colouring: Colouring::Speed { most: 2.0, unit: "m/s".into() },
        ..white((0..50).map(|i| disc(f64::from(i) * 4.0 - 100.0, f64::from(i % 7) * 10.0, 5.0)).collect())
    };
    for (i, body) in scene.bodies.iter_mut().enumerate() {
        body.velocity = [0.04 * i as f64, 0.0, 0.0];
        body.time = 1.5;
    }
    scene.add_box([-110.0, -20.0, -20.0], [110.0, 80.0, 20.0], 1.5, Colour::Wall);
    scene.regions.push(Region { lower: [-110.0, -20.0], upper: [0.0, 80.0], colour: Colour::Tint(0) });
    for i in 0..30 {
        let point = TrailPoint { position: [f64::from(i) * 3.0, f64::from(i), 0.0], time: f64::from(i) * 0.05 };
        scene.trail(0, 64, Colour::Accent(2)).push(point);
    }
    scene
}

#[test]
fn the_words_and_the_legend_stand_in_their_bands() {
    for palette in [Palette::Dark, Palette::Light] {
        for (width, height) in [(800, 500), (500, 700)] {
            let scene = Scene { bodies: Vec::new(), regions: Vec::new(), trails: Vec::new(), ..with_everything(plane()) };
            let view = View::new(width, height).palette(palette);
            let picture = draw(&scene, &view);
            let ground = picture.pixel(0, 0).unwrap();
            let ink = |left: u32, top: u32, right: u32, bottom: u32| {
                (top..bottom)
                    .flat_map(|y| (left..right).map(move |x| (x, y)))
                    .filter(|(x, y)| picture.pixel(*x, *y).unwrap() != ground)
                    .count()
            };
            assert!(ink(0, 0, 150, 35) > 100, "no title");
            assert!(ink(0, 36, 200, 60) > 100, "no caption");
            assert!(ink(width - 120, 0, width, 40) > 50, "no time");
            if width > height {
                assert!(ink(width - 130, 64, width, 300) > 1500, "no legend");
                assert!(ink(width - 146, height - 40, width, height) > 50, "no scale bar");
            } else {
                assert!(ink(0, height - 70, 270, height) > 1500, "no legend");
                assert!(ink(width - 160, height - 40, width, height) > 50, "no scale bar");
            }
            // Nothing touches the frame.
            assert_eq!(
                ink(0, 0, width, 4) + ink(0, height - 4, width, height) + ink(0, 0, 4, height) + ink(width - 4, 0, width, height),
                0
            );
        }
    }
}

#[test]
fn the_same_scene_gives_the_same_bytes() {
    for camera in [plane(), Camera::fit([-110.0, -20.0, -20.0], [110.0, 80.0, 20.0])] {
        let scene = with_everything(camera);
        let view = View::new(400, 300);
        let mut headless = Headless::new(400, 300).unwrap();
        let first = headless.picture(&scene, &view).unwrap();
        headless.picture(&Scene::default(), &View::new(64, 64)).unwrap();
        assert_eq!(first, headless.picture(&scene, &view).unwrap());
        assert_eq!(first, draw(&scene, &view));
        assert!(first.rgba.chunks_exact(4).all(|pixel| pixel[3] == 255), "a picture is opaque");
    }
}

#[test]
fn opengl_es_draws_the_same() {
    for camera in [plane(), Camera::fit([-110.0, -20.0, -20.0], [110.0, 80.0, 20.0])] {
        let scene = with_everything(camera);
        let view = View::new(400, 300);
        let mut embedded = Headless::with_language(400, 300, ShadingLanguage::Embedded).unwrap();
        let difference = largest_difference(&embedded.picture(&scene, &view).unwrap(), &draw(&scene, &view));
        assert!(difference <= 2, "{difference}");
    }
}

#[test]
fn sizes_that_cannot_be_drawn_are_refused() {
    assert!(Headless::new(0, 10).is_err());
    let mut headless = Headless::new(10, 10).unwrap();
    let refused = headless.picture(&Scene::default(), &View::new(10, 1_000_000)).unwrap_err();
    assert!(refused.to_string().contains("1000000"), "{refused}");
    // Still usable.
    assert!(headless.picture(&Scene::default(), &View::new(1, 1)).is_ok());
}
