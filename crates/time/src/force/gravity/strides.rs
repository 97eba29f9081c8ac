//! Grains on their way among few masses.
//!
//! Grains feel the masses and nobody feels them: where the masses will be is known without them, and so any number of steps can be
//! taken with some grains, which stay in the nearest cache meanwhile, before the next are looked at.

use corpuscle_core::instructions::{Kernel, larger};
use corpuscle_core::{Axis, Boundary, Particles, Vector};

use super::grains::{Source, pull};
use super::lanes::LANES;
use super::scale::Scale;
use super::{FEW, Gravity};
use crate::motion::{self, Moves, Stride, both};
use crate::strider::{Progress, State, Strider};
use crate::threads;

/// Grains taken along together: what is known of them fits the first-level cache.
const BLOCK: usize = 128;
/// Strides taken together.
const AT_ONCE: usize = 64;
/// Fewer are not worth the preparation.
const FEWEST: usize = 3;
/// Grains to each mass, at least.
const GRAINS_TO_A_MASS: usize = 16;
/// Pulls from which more than one thread is worth waking.
const WORTH_THREADS: usize = 1 << 17;

impl<const D: usize> Strider<D> for Gravity<D> {
    fn strides_at_once(&self, boundary: &Boundary<D>, particles: &Particles<D>, held: usize) -> usize {
        let masses = particles.mass.iter().filter(|mass| **mass > 0.0).count();
        let worth_it = particles.len() > FEW && GRAINS_TO_A_MASS * masses <= particles.len();
        if worth_it && boundary.axes == [Axis::Open; D] && held == 0 { AT_ONCE } else { 0 }
    }

    fn stride(&mut self, state: State<'_, D>, strides: &[Stride]) -> Progress {
        if strides.len() < FEWEST {
            return Progress { taken: 0, finite: [true; 2] };
        }
        let Particles { position, velocity, mass, .. } = state.particles;
        let mut masses = Particles::new();
        let heavy: Vec<usize> = (0..mass.len()).filter(|&i| mass[i] > 0.0).collect();
        for &i in &heavy {
            masses.push(position[i], velocity[i], mass[i], 0.0, 0);
        }
        let (tracks, finite) = self.lead(&mut masses, strides);

        let scale = Scale::new(self.softening, position, self.instructions);
        let sources = self.sources(&tracks, scale);
        let follow = |((position, velocity), mass): ((&mut [Vector<D>], &mut [Vector<D>]), &[f64])| {
            let mut grains = Grains { position, velocity, mass };
            let (mut scale, mut outcome) = (scale, self.follow(&mut grains, &sources, strides, scale));
            while outcome == Outcome::TooFar {
                scale = scale.coarser();
                outcome = self.follow(&mut grains, &self.sources(&tracks, scale), strides, scale);
            }
            outcome
        };
        let shared = sources.len() * position.len() >= WORTH_THREADS && rayon::current_num_threads() > 1;
        let blocks = position.chunks_mut(BLOCK).zip(velocity.chunks_mut(BLOCK)).zip(mass.chunks(BLOCK));
        let outcome = threads::sum(shared, blocks, follow, Outcome::and);
        for (number, &i) in heavy.iter().enumerate() {
            (position[i], velocity[i]) = (masses.position[number], masses.velocity[number]);
        }
        Progress { taken: strides.len(), finite: both(finite, [outcome == Outcome::Finite; 2]) }
    }
}

impl<const D: usize> Gravity<D> {
    /// Takes strides with the masses alone; tells where they are before each, and whether all stay finite.
    fn lead(&mut self, masses: &mut Particles<D>, strides: &[Stride]) -> (Vec<(Vector<D>, f64)>, [bool; 2]) {
        let (mut tracks, mut finite) = (vec![], [true; 2]);
        let mut acceleration = vec![Vector::ZERO; masses.len()];
        for stride in strides {
            tracks.extend(masses.position.iter().copied().zip(masses.mass.iter().copied()));
            acceleration.fill(Vector::ZERO);
            self.attract_masses(masses, &[], &mut acceleration);
            finite = both(finite, motion::kick_and_drift(&mut masses.position, &mut masses.velocity, &acceleration, stride.moves));
        }
        (tracks, finite)
    }

    fn sources(&self, tracks: &[(Vector<D>, f64)], scale: Scale) -> Vec<Source<D>> {
        tracks.iter().map(|&(position, mass)| Source::new(self.constant, scale, position, mass)).collect()
    }

    fn follow(&self, grains: &mut Grains<'_, D>, sources: &[Source<D>], strides: &[Stride], scale: Scale) -> Outcome {
        let (length, softening_squared) = (scale.length, self.softening_squared(scale));
        self.instructions.run(Follow { grains, sources, strides, length, softening_squared })
    }
}

/// How it went with grains.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Outcome {
    #[default]
    Finite,
    /// Some are nowhere.
    Lost,
    /// Some left what the scale was made for; nothing has been done.
    TooFar,
}

impl Outcome {
    fn and(self, other: Self) -> Self {
        if self == Self::Finite { other } else { self }
    }
}

/// The grains of a block, and masses among them.
struct Grains<'a, const D: usize> {
    position: &'a mut [Vector<D>],
    velocity: &'a mut [Vector<D>],
    mass: &'a [f64],
}

/// Takes strides with grains.
struct Follow<'a, 'b, const D: usize> {
    grains: &'a mut Grains<'b, D>,
    /// The masses before each stride.
    sources: &'a [Source<D>],
    strides: &'a [Stride],
    length: f64,
    softening_squared: f64,
}

impl<const D: usize> Kernel for Follow<'_, '_, D> {
    type Output = Outcome;

    #[inline(always)]
    fn run(self) -> Outcome {
        let Self { grains: Grains { position, velocity, mass }, sources, strides, length, softening_squared } = self;
        let count = position.len().min(BLOCK);
        let (mut r, mut v, mut scaled) = ([[0.0; BLOCK]; D], [[0.0; BLOCK]; D], [[0.0; BLOCK]; D]);
        for i in 0..count {
            for k in 0..D {
                (r[k][i], v[k][i]) = (position[i][k], velocity[i][k]);
            }
        }
        let mut highest = [0.0; LANES];
        for (stride, sources) in strides.iter().zip(sources.chunks_exact(sources.len() / strides.len())) {
            let Moves { owed, kick, drift } = stride.moves;
            for k in 0..D {
                for (scaled, r) in scaled[k].as_chunks_mut::<LANES>().0.iter_mut().zip(r[k].as_chunks::<LANES>().0) {
                    for lane in 0..LANES {
                        scaled[lane] = r[lane] * length;
                        highest[lane] = larger(scaled[lane].abs(), highest[lane]);
                    }
                }
            }
            let mut pulls = [[0.0; BLOCK]; D];
            pull(sources, softening_squared, count, &scaled, &mut pulls);
            for k in 0..D {
                if let Some(owed) = owed {
                    for i in 0..count {
                        v[k][i] += pulls[k][i] * owed;
                    }
                }
                for i in 0..count {
                    v[k][i] += pulls[k][i] * kick;
                    r[k][i] += v[k][i] * drift;
                }
            }
        }
        let places = highest.into_iter().chain(sources.iter().flat_map(Source::coordinates));
        if places.into_iter().any(|x| Scale::OUTSIDE < x.abs() && x.is_finite()) {
            return Outcome::TooFar;
        }
        // A mass among the grains has met itself. Whoever is nowhere stays there.
        let mut finite = true;
        for i in (0..count).filter(|&i| mass[i] == 0.0) {
            (position[i], velocity[i]) = (Vector::from_fn(|k| r[k][i]), Vector::from_fn(|k| v[k][i]));
            finite &= position[i].is_finite() && velocity[i].is_finite();
        }
        if finite { Outcome::Finite } else { Outcome::Lost }
    }
}
