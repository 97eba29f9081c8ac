//! Springs alike between neighbours in memory.

use corpuscle_core::Vector;
use corpuscle_core::instructions::Kernel;

use super::Spring;

/// First ends within one block of so many particles are handled together: what is written stays in the cache meanwhile.
const NEAR: usize = 2048;
/// Springs stretched together.
const BLOCK: usize = 64;

/// Springs like `spring` between the particles `first + n` and `second + n`, `n = 0..count`, `first < second`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Run {
    spring: Spring,
    count: usize,
}

impl Run {
    /// All springs, as runs: block by block of their first ends, then by how far apart the ends are.
    pub(super) fn all(springs: &[Spring]) -> Vec<Self> {
        let upwards = |spring: &Spring| {
            let (first, second) = (spring.first.min(spring.second), spring.first.max(spring.second));
            Spring { first, second, ..*spring }
        };
        let mut sorted: Vec<Spring> = springs.iter().map(upwards).collect();
        sorted.sort_by_key(|spring| (spring.first / NEAR, spring.second - spring.first, spring.first));
        let mut runs: Vec<Self> = vec![];
        for spring in sorted {
            match runs.last_mut() {
                Some(run) if run.nth(run.count) == spring => run.count += 1,
                _ => runs.push(Self { spring, count: 1 }),
            }
        }
        runs
    }

    /// The springs one by one.
    pub(super) fn springs(&self) -> impl Iterator<Item = Spring> {
        (0..self.count).map(|n| self.nth(n))
    }

    fn nth(&self, n: usize) -> Spring {
        Spring { first: self.spring.first + n, second: self.spring.second + n, ..self.spring }
    }

    /// Whether forces are `-k r`, component by component.
    pub(super) fn is_linear(&self) -> bool {
        self.spring.rest_length == 0.0 && self.spring.damping == 0.0 && self.spring.obeys_hooke()
    }
}

/// Adds the accelerations by a run of linear springs.
pub(super) struct Stretch<'a, const D: usize> {
    pub(super) run: &'a Run,
    pub(super) position: &'a [Vector<D>],
    pub(super) mass: &'a [f64],
    pub(super) acceleration: &'a mut [Vector<D>],
}

impl<const D: usize> Kernel for Stretch<'_, D> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { run: Run { spring, count }, position, mass, acceleration } = self;
        let mut pull = [[0.0; D]; BLOCK];
        for start in (0..*count).step_by(BLOCK) {
            let springs = BLOCK.min(count - start);
            let first = spring.first + start..spring.first + start + springs;
            let second = spring.second + start..spring.second + start + springs;
            let pull = &mut pull.as_flattened_mut()[..springs * D];
            let (from, to) = (Vector::components(&position[first.clone()]), Vector::components(&position[second.clone()]));
            for ((pull, from), to) in pull.iter_mut().zip(from).zip(to) {
                *pull = spring.stiffness * (to - from);
            }
            add(pull, 1.0, &mass[first.clone()], &mut acceleration[first]);
            add(pull, -1.0, &mass[second.clone()], &mut acceleration[second]);
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
