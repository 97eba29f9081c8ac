//! Extended XYZ, which OVITO and ASE read: particles at one instant, one line each, below a line that says what the columns
//! mean and what the box is. Planar systems get `z = 0` and a box of height 1.

use std::fmt::Write;

use corpuscle_core::{Axis, Boundary, Particles};

/// One frame. Frames one after the other make a trajectory.
///
/// `names` are those of the species; a particle of a species without one is an `X`, the symbol ASE has for any particle.
pub fn frame<const D: usize>(particles: &Particles<D>, boundary: &Boundary<D>, time: f64, names: &[&str]) -> String {
    let component = |vector: &[f64; D], k: usize, missing: f64| vector.get(k).copied().unwrap_or(missing);
    let extent = boundary.extent();
    let side = |k| component(&extent.0, k, 1.0);
    let periodic = |k: usize| if boundary.axes.get(k) == Some(&Axis::Periodic) { "T" } else { "F" };
    let mut text = format!(
        "{}\nLattice=\"{:?} 0 0 0 {:?} 0 0 0 {:?}\" Origin=\"{:?} {:?} {:?}\" pbc=\"{} {} {}\" Time={time:?} \
         Properties=species:S:1:pos:R:3:velo:R:3:radius:R:1:mass:R:1:id:I:1\n",
        particles.len(),
        side(0),
        side(1),
        side(2),
        component(&boundary.lower.0, 0, 0.0),
        component(&boundary.lower.0, 1, 0.0),
        component(&boundary.lower.0, 2, 0.0),
        periodic(0),
        periodic(1),
        periodic(2),
    );
    for i in 0..particles.len() {
        let (r, v) = (&particles.position[i].0, &particles.velocity[i].0);
        let name = names.get(usize::from(particles.species[i])).copied().unwrap_or("X");
        let triple = |vector| [0, 1, 2].map(|k| component(vector, k, 0.0));
        let ([x, y, z], [u, v, w]) = (triple(r), triple(v));
        let (radius, mass) = (particles.radius[i], particles.mass[i]);
        // Writing into a string cannot fail.
        let _ = writeln!(text, "{name} {x:?} {y:?} {z:?} {u:?} {v:?} {w:?} {radius:?} {mass:?} {}", i + 1);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use corpuscle_core::Vector;

    #[test]
    fn a_planar_frame_is_complete_and_exact() {
        let mut particles = Particles::<2>::new();
        particles.push(Vector([0.1, 1.0 / 3.0]), Vector([-1e-20, 2.0]), 2.0, 0.5, 0);
        particles.push(Vector([3.0, 4.0]), Vector([0.0, 0.0]), 1.0, 0.5, 7);
        let mut boundary = Boundary::new([0.0, -1.0], [10.0, 4.0], Axis::Walls);
        boundary.axes[0] = Axis::Periodic;
        let text = frame(&particles, &boundary, 2.5, &["bath"]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "2");
        assert!(lines[1].starts_with("Lattice=\"10.0 0 0 0 5.0 0 0 0 1.0\" Origin=\"0.0 -1.0 0.0\" pbc=\"T F F\" Time=2.5 "));
        assert_eq!(lines[3], "X 3.0 4.0 0.0 0.0 0.0 0.0 0.5 1.0 2");
        let fields: Vec<&str> = lines[2].split(' ').collect();
        let numbers: Vec<f64> = fields[1..].iter().map(|field| field.parse().unwrap()).collect();
        assert_eq!((fields[0], numbers), ("bath", vec![0.1, 1.0 / 3.0, 0.0, -1e-20, 2.0, 0.0, 0.5, 2.0, 1.0]));
    }
}
