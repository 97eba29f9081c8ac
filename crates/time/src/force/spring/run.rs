//! Springs alike between neighbours in memory.

use corpuscle_core::Vector;
use corpuscle_core::instructions::Kernel;

use super::Spring;
use crate::image::NearestImage;

/// Springs stretched together.
const BLOCK: usize = 64;
/// Runs below this length are handled spring by spring.
const SHORT: usize = 8;

/// Springs like `spring` between the particles `first + n` and `second + n`, `n = 0..count`, `first < second`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Run {
    spring: Spring,
    count: usize,
}

impl Run {
    /// All springs, as runs: block by block of `near` particles their first ends are in, then by how far apart the ends are. No run
    /// has first ends in two blocks.
    pub(super) fn all(springs: &[Spring], near: usize) -> Vec<Self> {
        let upwards = |spring: &Spring| {
            let (first, second) = (spring.first.min(spring.second), spring.first.max(spring.second));
            Spring { first, second, ..*spring }
        };
        let mut sorted: Vec<Spring> = springs.iter().map(upwards).collect();
        sorted.sort_by_key(|spring| (spring.first / near, spring.second - spring.first, spring.first));
        let mut runs: Vec<Self> = vec![];
        for spring in sorted {
            match runs.last_mut() {
                Some(run) if run.nth(run.count) == spring && run.first() / near == spring.first / near => run.count += 1,
                _ => runs.push(Self { spring, count: 1 }),
            }
        }
        runs
    }

    /// The first of its first ends.
    pub(super) fn first(&self) -> usize {
        self.spring.first
    }

    /// How far apart in memory its ends are.
    pub(super) fn reach(&self) -> usize {
        self.spring.second - self.spring.first
    }

    /// The springs one by one.
    pub(super) fn springs(&self) -> impl Iterator<Item = Spring> {
        (0..self.count).map(|n| self.nth(n))
    }

    fn nth(&self, n: usize) -> Spring {
        Spring { first: self.spring.first + n, second: self.spring.second + n, ..self.spring }
    }

    /// Whether it is too short for [`Stretch`] to be worth preparing.
    pub(super) fn is_short(&self) -> bool {
        self.count < SHORT
    }
}

/// The particles of a stretch of memory, and what their accelerations are added to.
pub(super) struct Place<'a, const D: usize> {
    /// Index of the first.
    pub(super) from: usize,
    pub(super) position: &'a [Vector<D>],
    /// Read where there is friction.
    pub(super) velocity: &'a [Vector<D>],
    pub(super) mass: &'a [f64],
    pub(super) acceleration: &'a mut [Vector<D>],
}

/// Adds the accelerations by a run of springs.
pub(super) struct Stretch<'a, const D: usize> {
    pub(super) run: &'a Run,
    /// Nearest images, where there is a periodic axis.
    pub(super) image: Option<NearestImage<D>>,
    pub(super) place: Place<'a, D>,
}

impl<const D: usize> Kernel for Stretch<'_, D> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { run, image, place } = self;
        let Run { spring, count } = run;
        let Place { from, position, velocity, mass, acceleration } = place;
        let mut pull = [[0.0; D]; BLOCK];
        let mut block = Block::<D>::new();
        for start in (0..*count).step_by(BLOCK) {
            let springs = BLOCK.min(count - start);
            let ends = |end: usize| end - from + start..end - from + start + springs;
            let (first, second) = (ends(spring.first), ends(spring.second));
            block.load(image.as_ref(), &position[first.clone()], &position[second.clone()]);
            block.stretch(spring, springs);
            if spring.damping != 0.0 {
                block.damp(spring, &velocity[first.clone()], &velocity[second.clone()]);
            }
            for (n, pull) in pull[..springs].iter_mut().enumerate() {
                *pull = std::array::from_fn(|k| block.pull[k][n]);
            }
            let pull = pull[..springs].as_flattened();
            add(pull, 1.0, &mass[first.clone()], &mut acceleration[first]);
            add(pull, -1.0, &mass[second.clone()], &mut acceleration[second]);
        }
    }
}

/// Some springs, one array a component.
struct Block<const D: usize> {
    /// From the first end to the second.
    arrow: [[f64; BLOCK]; D],
    squared: [f64; BLOCK],
    /// Force on the first end.
    pull: [[f64; BLOCK]; D],
}

impl<const D: usize> Block<D> {
    #[inline(always)]
    fn new() -> Self {
        Self { arrow: [[0.0; BLOCK]; D], squared: [0.0; BLOCK], pull: [[0.0; BLOCK]; D] }
    }

    #[inline(always)]
    fn load(&mut self, image: Option<&NearestImage<D>>, first: &[Vector<D>], second: &[Vector<D>]) {
        for (n, (from, to)) in first.iter().zip(second).enumerate().take(BLOCK) {
            for k in 0..D {
                self.arrow[k][n] = to[k] - from[k];
            }
        }
        if let Some(image) = image {
            for k in 0..D {
                for n in 0..BLOCK {
                    self.arrow[k][n] = image.component(k, self.arrow[k][n]);
                }
            }
        }
        for n in 0..BLOCK {
            self.squared[n] = self.arrow[0][n] * self.arrow[0][n];
            for k in 1..D {
                self.squared[n] += self.arrow[k][n] * self.arrow[k][n];
            }
        }
    }

    /// Elastic forces, as [`Spring::elastic`] has them.
    #[inline(always)]
    fn stretch(&mut self, spring: &Spring, count: usize) {
        let Spring { stiffness, rest_length, quadratic, cubic, .. } = *spring;
        let mut factor = [stiffness; BLOCK];
        if !spring.obeys_hooke() {
            for n in 0..count.min(BLOCK) {
                let length = self.squared[n].sqrt();
                let x = length - rest_length;
                let tension = stiffness * x * (1.0 + x * (quadratic + x * cubic));
                factor[n] = if length == 0.0 && rest_length == 0.0 { 0.0 } else { tension / length };
            }
        } else if rest_length != 0.0 {
            for n in 0..count.min(BLOCK) {
                factor[n] = -(stiffness * (rest_length / self.squared[n].sqrt() - 1.0));
            }
        }
        for k in 0..D {
            for n in 0..count.min(BLOCK) {
                self.pull[k][n] = self.arrow[k][n] * factor[n];
            }
        }
    }

    /// Adds friction, as [`Spring::friction`] has it.
    #[inline(always)]
    fn damp(&mut self, spring: &Spring, first: &[Vector<D>], second: &[Vector<D>]) {
        for (n, (from, to)) in first.iter().zip(second).enumerate().take(BLOCK) {
            let v = *to - *from;
            if spring.rest_length == 0.0 {
                for k in 0..D {
                    self.pull[k][n] += v[k] * spring.damping;
                }
            } else {
                let r = Vector::from_fn(|k| self.arrow[k][n]);
                let factor = spring.damping * v.dot(r) / self.squared[n];
                for k in 0..D {
                    self.pull[k][n] += r[k] * factor;
                }
            }
        }
    }
}

/// `a += sign pull / m`.
#[inline(always)]
fn add<const D: usize>(pull: &[f64], sign: f64, mass: &[f64], acceleration: &mut [Vector<D>]) {
    let Some(&first) = mass.first() else { return };
    // Most chains and membranes are of equal masses: one division, and nothing to do particle by particle.
    let (groups, rest) = mass.as_chunks::<8>();
    let mut differences = [0u64; 8];
    for group in groups {
        for lane in 0..8 {
            differences[lane] |= group[lane].to_bits() ^ first.to_bits();
        }
    }
    let alike = differences == [0; 8] && rest.iter().all(|&mass| mass == first);
    if alike {
        let factor = sign * (1.0 / first);
        for (a, pull) in Vector::components_mut(acceleration).iter_mut().zip(pull) {
            *a += factor * pull;
        }
    } else {
        for ((a, pull), mass) in acceleration.iter_mut().zip(pull.chunks_exact(D)).zip(mass) {
            let factor = sign * (1.0 / mass);
            for k in 0..D {
                a[k] += factor * pull[k];
            }
        }
    }
}
