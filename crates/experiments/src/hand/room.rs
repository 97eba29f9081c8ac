//! Where a particle finds room.

use corpuscle_core::{Boundary, Particles, Vector};

/// Directions tried on each ring (shell).
const DIRECTIONS: usize = 36;
/// Rings tried, each a quarter of a radius wider than the one before.
const RINGS: usize = 64;
/// A little more than touching, so that rounding leaves no overlap.
const CLEARANCE: f64 = 1.0 + 1e-9;
/// Golden angle `pi (3 - sqrt 5)`, which spreads points evenly on a sphere.
const GOLDEN: f64 = 2.399_963_229_728_653;

/// The place nearest to `target`, of those on rings about it, where the sphere `body` is inside the box, clear of all that
/// stands in it and of all other particles; none within reach.
pub(super) fn nearest<const D: usize>(
    boundary: &Boundary<D>,
    time: f64,
    particles: &Particles<D>,
    body: usize,
    target: Vector<D>,
) -> Option<Vector<D>> {
    let radius = particles.radius[body];
    let extent = boundary.extent().0.into_iter().fold(f64::INFINITY, f64::min);
    let width = if radius > 0.0 { 0.25 * radius } else { 1e-3 * extent };
    let reach = width * RINGS as f64;
    let near: Vec<(Vector<D>, f64)> = (0..particles.len())
        .filter(|&j| j != body)
        .map(|j| (particles.position[j], (radius + particles.radius[j]) * CLEARANCE))
        .filter(|&(r, contact)| boundary.displacement(boundary.wrap(target), r).norm() < reach + contact)
        .collect();
    let mut alone = Particles::new();
    alone.push(target, Vector::ZERO, 1.0, radius * CLEARANCE, 0);
    let mut fits = |place: Vector<D>| {
        alone.position[0] = place;
        boundary.validate_particles_at(time, &alone).is_ok()
            && near.iter().all(|&(r, contact)| boundary.displacement(place, r).norm() >= contact)
    };
    let target = boundary.wrap(target);
    if fits(target) {
        return Some(target);
    }
    let mut places = (1..=RINGS).flat_map(|ring| {
        let distance = width * ring as f64;
        (0..DIRECTIONS).map(move |k| boundary.wrap(target + direction::<D>(k, ring) * distance))
    });
    places.find(|&place| fits(place))
}

/// Unit vectors spread evenly, each ring turned a little against the one before.
fn direction<const D: usize>(k: usize, ring: usize) -> Vector<D> {
    let turn = (k as f64 + 0.5 * ring as f64) * if D == 2 { std::f64::consts::TAU / DIRECTIONS as f64 } else { GOLDEN };
    let (sine, cosine) = libm::sincos(turn);
    let z = if D == 2 { 0.0 } else { 1.0 - (2 * k + 1) as f64 / DIRECTIONS as f64 };
    let flat = (1.0 - z * z).sqrt();
    Vector::from_fn(|axis| [flat * cosine, flat * sine, z][axis])
}
