//! Newton's gravity between all masses, and of the masses on grains.

use corpuscle_core::{Axis, Boundary, Invalid, Particles, Vector};

use super::{Force, finite, not_negative};

/// Targets handled together in the kernels.
const LANES: usize = 8;

/// `a_i = sum_j G m_j (r_j - r_i) / (|r_j - r_i|^2 + s^2)^(3/2)`, with the softening length `s` of Plummer (zero: none).
///
/// A particle of mass zero is a grain: it feels the masses and attracts nothing, so that `N` grains and `M` masses cost
/// `O(M (M + N))`. Sums are direct, in the order of the indices; `m_i a_i` of a pair cancel to rounding.
#[derive(Clone, Debug)]
pub struct Gravity<const D: usize> {
    constant: f64,
    softening: f64,
    sources: Sources<D>,
}

/// The particles with mass, one array a component.
#[derive(Clone, Debug)]
struct Sources<const D: usize> {
    index: Vec<usize>,
    /// `G m`.
    strength: Vec<f64>,
    position: [Vec<f64>; D],
    /// What rounding took from the positions.
    remainder: [Vec<f64>; D],
    acceleration: [Vec<f64>; D],
}

impl<const D: usize> Gravity<D> {
    /// Gravity of the given constant `G` and softening length.
    pub fn new(constant: f64, softening: f64) -> Self {
        let empty = || std::array::from_fn(|_| vec![]);
        let sources = Sources { index: vec![], strength: vec![], position: empty(), remainder: empty(), acceleration: empty() };
        Self { constant, softening, sources }
    }

    /// The constant `G`.
    pub fn constant(&self) -> f64 {
        self.constant
    }

    /// The softening length.
    pub fn softening(&self) -> f64 {
        self.softening
    }

    fn sum_over_pairs(&self, particles: &Particles<D>, f: impl Fn(f64, f64) -> f64) -> f64 {
        let massive: Vec<usize> = (0..particles.len()).filter(|&i| particles.mass[i] > 0.0).collect();
        let mut sum = 0.0;
        for (place, &i) in massive.iter().enumerate() {
            for &j in &massive[place + 1..] {
                let r_squared = (particles.position[j] - particles.position[i]).norm_squared();
                sum += f(self.constant * particles.mass[i] * particles.mass[j], r_squared);
            }
        }
        sum
    }
}

/// `1/(r^2 + s^2)^(3/2)`.
#[inline]
fn inverse_cube(r_squared: f64, softening_squared: f64) -> f64 {
    let d2 = r_squared + softening_squared;
    1.0 / (d2 * d2.sqrt())
}

impl<const D: usize> Sources<D> {
    fn load(&mut self, constant: f64, particles: &Particles<D>, remainder: &[Vector<D>]) {
        self.index.clear();
        self.strength.clear();
        self.position.iter_mut().chain(&mut self.remainder).for_each(Vec::clear);
        for (i, &mass) in particles.mass.iter().enumerate() {
            if mass > 0.0 {
                self.index.push(i);
                self.strength.push(constant * mass);
                for k in 0..D {
                    self.position[k].push(particles.position[i][k]);
                    self.remainder[k].push(remainder.get(i).map_or(0.0, |remainder| remainder[k]));
                }
            }
        }
        for component in &mut self.acceleration {
            component.clear();
            component.resize(self.index.len(), 0.0);
        }
    }

    /// Every pair of sources once.
    fn attract_each_other(&mut self, softening_squared: f64) {
        for i in 0..self.index.len() {
            let mut total = [[0.0; LANES]; D];
            let mut start = i + 1;
            while start + LANES <= self.index.len() {
                self.attract_block::<LANES>(i, start, softening_squared, &mut total);
                start += LANES;
            }
            for j in start..self.index.len() {
                let mut one = [[0.0]; D];
                self.attract_block::<1>(i, j, softening_squared, &mut one);
                for k in 0..D {
                    total[k][0] += one[k][0];
                }
            }
            for k in 0..D {
                self.acceleration[k][i] += total[k].iter().sum::<f64>();
            }
        }
    }

    /// Source `i` and the `L` sources from `start` on.
    #[inline]
    fn attract_block<const L: usize>(&mut self, i: usize, start: usize, softening_squared: f64, total: &mut [[f64; L]; D]) {
        let mut arrow = [[0.0; L]; D];
        let mut r_squared = [0.0; L];
        for k in 0..D {
            let (r, lost) = (self.position[k][i], self.remainder[k][i]);
            let (position, remainder) = (&self.position[k][start..start + L], &self.remainder[k][start..start + L]);
            for lane in 0..L {
                arrow[k][lane] = (position[lane] - r) + (remainder[lane] - lost);
                r_squared[lane] += arrow[k][lane] * arrow[k][lane];
            }
        }
        let scale = r_squared.map(|r_squared| inverse_cube(r_squared, softening_squared));
        let own = self.strength[i];
        let strength = &self.strength[start..start + L];
        for k in 0..D {
            let acceleration = &mut self.acceleration[k][start..start + L];
            for lane in 0..L {
                let pull = scale[lane] * arrow[k][lane];
                acceleration[lane] -= own * pull;
                total[k][lane] += strength[lane] * pull;
            }
        }
    }

    /// The pull of all sources on a block of places.
    #[inline]
    fn pull(&self, softening_squared: f64, place: &[[f64; LANES]; D]) -> [[f64; LANES]; D] {
        let mut pull = [[0.0; LANES]; D];
        for (source, &strength) in self.strength.iter().enumerate() {
            let mut arrow = [[0.0; LANES]; D];
            let mut r_squared = [0.0; LANES];
            for k in 0..D {
                let x = self.position[k][source];
                for lane in 0..LANES {
                    arrow[k][lane] = x - place[k][lane];
                    r_squared[lane] += arrow[k][lane] * arrow[k][lane];
                }
            }
            let scale = r_squared.map(|r_squared| strength * inverse_cube(r_squared, softening_squared));
            for k in 0..D {
                for lane in 0..LANES {
                    pull[k][lane] += scale[lane] * arrow[k][lane];
                }
            }
        }
        pull
    }
}

impl<const D: usize> Force<D> for Gravity<D> {
    fn name(&self) -> &'static str {
        "gravity"
    }

    fn accelerate(&mut self, time: f64, boundary: &Boundary<D>, particles: &Particles<D>, acceleration: &mut [Vector<D>]) {
        self.accelerate_precisely(time, boundary, particles, &[], acceleration);
    }

    fn accelerate_precisely(
        &mut self,
        _: f64,
        _: &Boundary<D>,
        particles: &Particles<D>,
        remainder: &[Vector<D>],
        acceleration: &mut [Vector<D>],
    ) {
        let softening_squared = self.softening * self.softening;
        let sources = &mut self.sources;
        sources.load(self.constant, particles, remainder);
        sources.attract_each_other(softening_squared);
        for (place, &i) in sources.index.iter().enumerate() {
            acceleration[i] += Vector::from_fn(|k| sources.acceleration[k][place]);
        }
        if sources.index.len() == particles.len() {
            return;
        }
        let blocks = particles.position.chunks(LANES).zip(particles.mass.chunks(LANES)).zip(acceleration.chunks_mut(LANES));
        for ((position, mass), acceleration) in blocks {
            if mass.iter().all(|&mass| mass > 0.0) {
                continue;
            }
            let mut place = [[0.0; LANES]; D];
            for (lane, r) in position.iter().enumerate() {
                for k in 0..D {
                    place[k][lane] = r[k];
                }
            }
            let pull = sources.pull(softening_squared, &place);
            for (lane, a) in acceleration.iter_mut().enumerate().filter(|(lane, _)| mass[*lane] == 0.0) {
                *a += Vector::from_fn(|k| pull[k][lane]);
            }
        }
    }

    fn energy(&self, _: f64, _: &Boundary<D>, particles: &Particles<D>) -> f64 {
        let softening_squared = self.softening * self.softening;
        self.sum_over_pairs(particles, |strength, r_squared| -strength / (r_squared + softening_squared).sqrt())
    }

    fn virial(&self, _: f64, _: &Boundary<D>, particles: &Particles<D>) -> f64 {
        let softening_squared = self.softening * self.softening;
        self.sum_over_pairs(particles, |strength, r_squared| -strength * r_squared * inverse_cube(r_squared, softening_squared))
    }

    fn validate(&self, boundary: &Boundary<D>, particles: &Particles<D>) -> Result<(), Invalid> {
        finite("gravitational constant", self.constant)?;
        not_negative("softening", self.softening)?;
        if let Some(k) = boundary.axes.iter().position(|&axis| axis == Axis::Periodic) {
            let expected = "open space or walls: gravity reaches through every periodic image";
            return Err(Invalid::new(format!("axis {k} of the box"), "periodic", expected));
        }
        if particles.mass.iter().all(|&mass| mass == 0.0) {
            return Err(Invalid::new("masses", "all zero", "at least one particle with mass, to attract the others"));
        }
        Ok(())
    }
}
