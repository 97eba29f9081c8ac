//! Paths that go on through periodic faces.

use corpuscle_core::{Boundary, Particles, Vector};

/// Follows chosen particles through the faces of a periodic box: each sample adds the shortest displacement since the last,
/// which is the true one while no particle moves half a side between samples.
#[derive(Clone, Debug)]
pub struct Unwrap<const D: usize> {
    boundary: Boundary<D>,
    tracers: Vec<usize>,
    last: Vec<Vector<D>>,
    path: Vec<Vector<D>>,
}

impl<const D: usize> Unwrap<D> {
    /// Follows the particles with these indices.
    pub fn new(boundary: Boundary<D>, tracers: impl IntoIterator<Item = usize>) -> Self {
        Self { boundary, tracers: tracers.into_iter().collect(), last: vec![], path: vec![] }
    }

    /// The unwrapped positions of the tracers now; they start where the particles are at the first call.
    pub fn follow(&mut self, particles: &Particles<D>) -> &[Vector<D>] {
        let now: Vec<Vector<D>> = self.tracers.iter().map(|&i| particles.position[i]).collect();
        if self.path.is_empty() {
            self.path.clone_from(&now);
        } else {
            for ((path, &from), &to) in self.path.iter_mut().zip(&self.last).zip(&now) {
                *path += self.boundary.displacement(from, to);
            }
        }
        self.last = now;
        &self.path
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_particle_may_circle_the_box() {
        let ring = Boundary::<2>::periodic(3.0);
        let mut unwrap = Unwrap::new(ring.clone(), [1]);
        let mut particles = Particles::new();
        particles.push(Vector([1.0, 1.0]), Vector::ZERO, 1.0, 0.1, 0);
        particles.push(Vector([1.0, 1.0]), Vector::ZERO, 1.0, 0.1, 0);
        for step in 0..50 {
            let path = Vector([1.0 + f64::from(step), 1.0 - 0.5 * f64::from(step)]);
            particles.position[1] = ring.wrap(path);
            assert!((unwrap.follow(&particles)[0] - path).norm() < 1e-12);
        }
    }
}
