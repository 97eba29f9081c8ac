//! Short-range forces between all pairs, from one potential.

use corpuscle_core::{Axis, Boundary, Invalid, Particles, Vector};

use super::{Force, massive, positive};
use crate::image::NearestImage;
use crate::neighbours::Neighbours;

/// Pairs handled together in the kernel. The number is part of no result: sums run over one pair at a time.
const LANES: usize = 8;

/// A spherically symmetric potential of finite range. All that a new one needs is in its file; neighbour lists, virial and
/// checks come with [`PairForce`].
pub trait PairPotential: Send {
    /// Name, as a table of energies shows it.
    fn name(&self) -> &'static str;

    /// Range beyond which energy and force are zero.
    fn cutoff(&self) -> f64;

    /// The length on which the potential changes: the diameter of a particle.
    fn length(&self) -> f64;

    /// Energy `U(r)` of a pair within the range.
    fn energy(&self, r_squared: f64) -> f64;

    /// `-U'(r)/r` of a pair within the range, positive when it repels.
    fn force_over_distance(&self, r_squared: f64) -> f64;

    /// Checks the parameters.
    ///
    /// # Errors
    /// Names the parameter at fault.
    fn validate(&self) -> Result<(), Invalid>;
}

/// The force of a [`PairPotential`] between all pairs of particles.
///
/// Every sum runs in the order of the particles' indices, so its bits depend neither on the neighbour list's skin nor
/// on when it was built: the list is scratch, not state.
pub struct PairForce<P, const D: usize> {
    potential: P,
    neighbours: Neighbours<D>,
    position: [Vec<f64>; D],
    force: [Vec<f64>; D],
}

impl<P: PairPotential, const D: usize> PairForce<P, D> {
    /// The force of `potential`, with a neighbour list that reaches `0.3` lengths beyond its cutoff.
    pub fn new(potential: P) -> Self {
        let skin = 0.3 * potential.length();
        Self::with_skin(potential, skin)
    }

    /// The force of `potential`, with a list that reaches `skin` beyond its cutoff: a wider one is built less often and
    /// holds more pairs.
    pub fn with_skin(potential: P, skin: f64) -> Self {
        let neighbours = Neighbours::new(potential.cutoff(), skin);
        let empty = || std::array::from_fn(|_| vec![]);
        Self { potential, neighbours, position: empty(), force: empty() }
    }

    /// The potential.
    pub fn potential(&self) -> &P {
        &self.potential
    }

    /// The neighbour list, as of the last evaluation.
    pub fn neighbours(&self) -> &Neighbours<D> {
        &self.neighbours
    }

    /// Sums `f(r^2)` over all pairs within the range.
    fn sum_over_pairs(&self, boundary: &Boundary<D>, particles: &Particles<D>, f: impl Fn(f64) -> f64) -> f64 {
        let image = NearestImage::new(boundary);
        let range = self.potential.cutoff() * self.potential.cutoff();
        let mut sum = 0.0;
        let mut add = |list: &Neighbours<D>| {
            for (i, &r) in particles.position.iter().enumerate() {
                for &j in list.of(i) {
                    let r_squared = image.displacement(r, particles.position[j as usize]).norm_squared();
                    if r_squared < range {
                        sum += f(r_squared);
                    }
                }
            }
        };
        if self.neighbours.hold(boundary, &particles.position) {
            add(&self.neighbours);
        } else {
            let mut list = Neighbours::new(self.potential.cutoff(), 0.0);
            list.update(boundary, &particles.position);
            add(&list);
        }
        sum
    }

    /// Arrows from `r` to a block of particles, and the force over the distance of each pair: zero out of range.
    #[inline]
    fn block(&self, image: &NearestImage<D>, range: f64, r: [f64; D], block: &[u32; LANES]) -> ([[f64; LANES]; D], [f64; LANES]) {
        let mut arrow = [[0.0; LANES]; D];
        let mut r_squared = [0.0; LANES];
        for k in 0..D {
            for lane in 0..LANES {
                arrow[k][lane] = self.position[k][block[lane] as usize];
            }
            for lane in 0..LANES {
                arrow[k][lane] = image.component(k, arrow[k][lane] - r[k]);
                r_squared[lane] += arrow[k][lane] * arrow[k][lane];
            }
        }
        let scale = r_squared.map(|r_squared| {
            let scale = self.potential.force_over_distance(r_squared);
            if r_squared < range { scale } else { 0.0 }
        });
        (arrow, scale)
    }
}

impl<P: PairPotential, const D: usize> Force<D> for PairForce<P, D> {
    fn name(&self) -> &'static str {
        self.potential.name()
    }

    fn accelerate(&mut self, _: f64, boundary: &Boundary<D>, particles: &Particles<D>, acceleration: &mut [Vector<D>]) {
        self.neighbours.update(boundary, &particles.position);
        let image = NearestImage::new(boundary);
        let range = self.potential.cutoff() * self.potential.cutoff();
        let n = particles.len();
        for k in 0..D {
            self.position[k].clear();
            self.position[k].extend(particles.position.iter().map(|r| r[k]));
        }
        let mut force = std::mem::replace(&mut self.force, std::array::from_fn(|_| vec![]));
        for component in &mut force {
            component.clear();
            component.resize(n, 0.0);
        }
        for i in 0..n {
            let r: [f64; D] = std::array::from_fn(|k| self.position[k][i]);
            let mut total = [0.0; D];
            let neighbours = self.neighbours.of(i);
            for start in (0..neighbours.len()).step_by(LANES) {
                let members = &neighbours[start..neighbours.len().min(start + LANES)];
                // The last block is filled up with copies of its first pair, which are left out of the sum.
                let mut block = [members[0]; LANES];
                block[..members.len()].copy_from_slice(members);
                let (arrow, scale) = self.block(&image, range, r, &block);
                for (lane, &j) in members.iter().enumerate() {
                    for k in 0..D {
                        let f = scale[lane] * arrow[k][lane];
                        force[k][j as usize] += f;
                        total[k] -= f;
                    }
                }
            }
            for k in 0..D {
                force[k][i] += total[k];
            }
        }
        for (i, a) in acceleration.iter_mut().enumerate() {
            let inverse_mass = 1.0 / particles.mass[i];
            for k in 0..D {
                a[k] += force[k][i] * inverse_mass;
            }
        }
        self.force = force;
    }

    fn energy(&self, _: f64, boundary: &Boundary<D>, particles: &Particles<D>) -> f64 {
        self.sum_over_pairs(boundary, particles, |r_squared| self.potential.energy(r_squared))
    }

    fn virial(&self, _: f64, boundary: &Boundary<D>, particles: &Particles<D>) -> f64 {
        self.sum_over_pairs(boundary, particles, |r_squared| r_squared * self.potential.force_over_distance(r_squared))
    }

    fn validate(&self, boundary: &Boundary<D>, particles: &Particles<D>) -> Result<(), Invalid> {
        self.potential.validate()?;
        positive("cutoff", self.potential.cutoff())?;
        for k in (0..D).filter(|&k| boundary.axes[k] == Axis::Periodic) {
            let half = 0.5 * boundary.extent()[k];
            if self.potential.cutoff() > half {
                return Err(Invalid::new(
                    format!("cutoff of {}", self.potential.name()),
                    self.potential.cutoff(),
                    format!("at most half the periodic box, {half} along axis {k}: a particle would meet two images of another"),
                ));
            }
        }
        (0..particles.len()).try_for_each(|i| massive(self.potential.name(), i, particles))
    }
}
