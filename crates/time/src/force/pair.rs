//! Short-range forces between all pairs, from one potential.

use corpuscle_core::{Axis, Boundary, Invalid, Particles, Vector};

use super::{Force, massive, positive};
use crate::image::NearestImage;
use crate::neighbours::Neighbours;

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
    force: Vec<Vector<D>>,
    near: Near<D>,
}

/// The neighbours of one particle that are within range, one array a quantity; longer than there are such neighbours.
struct Near<const D: usize> {
    index: Vec<u32>,
    arrow: Vec<Vector<D>>,
    /// Square of the distance; then, in its place, the force over the distance.
    scale: Vec<f64>,
}

impl<const D: usize> Near<D> {
    /// Collects those of `candidates` that are within range of `r`, in their order; returns their number.
    #[inline]
    fn collect(&mut self, image: &NearestImage<D>, range: f64, r: Vector<D>, candidates: &[u32], position: &[Vector<D>]) -> usize {
        if self.index.len() < candidates.len() {
            self.index.resize(candidates.len(), 0);
            self.arrow.resize(candidates.len(), Vector::ZERO);
            self.scale.resize(candidates.len(), 0.0);
        }
        // Written without a branch, which would be mispredicted for every third candidate.
        let mut count = 0;
        for &j in candidates {
            let arrow = image.displacement(r, position[j as usize]);
            let r_squared = arrow.norm_squared();
            (self.index[count], self.arrow[count], self.scale[count]) = (j, arrow, r_squared);
            count += usize::from(r_squared < range);
        }
        count
    }
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
        Self { potential, neighbours, force: vec![], near: Near { index: vec![], arrow: vec![], scale: vec![] } }
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
}

impl<P: PairPotential, const D: usize> Force<D> for PairForce<P, D> {
    fn name(&self) -> &'static str {
        self.potential.name()
    }

    fn accelerate(&mut self, _: f64, boundary: &Boundary<D>, particles: &Particles<D>, acceleration: &mut [Vector<D>]) {
        self.neighbours.update(boundary, &particles.position);
        let image = NearestImage::new(boundary);
        let range = self.potential.cutoff() * self.potential.cutoff();
        let position = &particles.position;
        let (force, near) = (&mut self.force, &mut self.near);
        force.clear();
        force.resize(position.len(), Vector::ZERO);
        for (i, &r) in position.iter().enumerate() {
            let mut total = Vector::ZERO;
            let count = near.collect(&image, range, r, self.neighbours.of(i), position);
            for scale in &mut near.scale[..count] {
                *scale = self.potential.force_over_distance(*scale);
            }
            for ((&j, &arrow), &scale) in near.index[..count].iter().zip(&near.arrow[..count]).zip(&near.scale[..count]) {
                let f = arrow * scale;
                force[j as usize] += f;
                total -= f;
            }
            force[i] += total;
        }
        for ((a, f), mass) in acceleration.iter_mut().zip(force).zip(&particles.mass) {
            *a += *f * (1.0 / mass);
        }
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
