//! Grains on their way among few masses.
//!
//! Grains feel the masses and nobody feels them: where the masses will be is known without them, and so any number of steps can be
//! taken with some grains, which stay in the nearest cache meanwhile, before the next are looked at.

use corpuscle_core::{Axis, Particles, Vector};

use super::grains::{Source, WORTH_THREADS};
use super::lanes::inverse_cube_from;
use super::scale::Scale;
use super::{FEW, Gravity};
use crate::lanes::eight::{self, Eight, InEights, LANES};
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
/// The most masses: what is known of each from each grain has to stay in a cache.
const MOST_MASSES: usize = 16;
/// Beyond these scaled coordinates of masses, or distances from the first of them, squares may be too large for single precision.
const FAR: f64 = (1u64 << 60) as f64;

impl<const D: usize> Strider<D> for Gravity<D> {
    fn strides_at_once(&mut self, state: &State<'_, D>) -> usize {
        let State { boundary, particles, held, .. } = state;
        let masses = particles.mass.iter().filter(|mass| **mass > 0.0).count();
        let worth_it = particles.len() > FEW && (1..=MOST_MASSES).contains(&masses) && GRAINS_TO_A_MASS * masses <= particles.len();
        if worth_it && boundary.axes == [Axis::Open; D] && held.is_empty() { AT_ONCE } else { 0 }
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

        let scale = Scale::new(self.softening, position, self.instructions).with_room();
        let sources = self.sources(&tracks, scale);
        let follow = |((position, velocity), mass): ((&mut [Vector<D>], &mut [Vector<D>]), &[f64])| {
            let mut grains = Grains { position, velocity, mass };
            let outcome = self.follow(&mut grains, &sources, strides, scale, FAR);
            if outcome == Outcome::TooFar { self.follow_one_by_one(&mut grains, &tracks, strides) } else { outcome }
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

    /// Takes strides with grains; with none of them if any goes as far as `far`.
    fn follow(&self, grains: &mut Grains<'_, D>, sources: &[Source<D>], strides: &[Stride], scale: Scale, far: f64) -> Outcome {
        let (length, softening_squared) = (scale.length, self.softening_squared(scale));
        eight::run(self.instructions, Follow { grains, sources, strides, length, softening_squared, far })
    }

    /// The same, whatever the distance, with a scale for each stride.
    fn follow_one_by_one(&self, grains: &mut Grains<'_, D>, tracks: &[(Vector<D>, f64)], strides: &[Stride]) -> Outcome {
        let one = |(stride, tracks): (&Stride, &[(Vector<D>, f64)])| {
            let places: Vec<_> = tracks.iter().map(|track| track.0).chain(grains.position.iter().copied()).collect();
            let scale = Scale::new(self.softening, &places, self.instructions);
            self.follow(grains, &self.sources(tracks, scale), std::slice::from_ref(stride), scale, f64::INFINITY)
        };
        strides.iter().zip(tracks.chunks_exact(tracks.len() / strides.len())).map(one).fold(Outcome::Finite, Outcome::and)
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
    /// Scaled coordinates, and distances from the first mass, that are too large.
    far: f64,
}

/// The square of the distance from a mass, and a guess of its inverse root: made for all grains of a block before they are used, as
/// there is long to wait for it.
#[derive(Clone, Copy, Default)]
struct Look {
    square: Group,
    guess: Group,
}

/// A number of each of so many grains.
type Group = [f64; LANES];

impl<const D: usize> Follow<'_, '_, D> {
    /// Looks at all masses from the places of a group; the square of the distance to the first.
    #[inline(always)]
    fn look<V: Eight>(&self, sources: &[Source<D>], r: &[V; D], looks: &mut [Look]) -> V {
        let mut first = V::splat(0.0);
        for (number, (source, look)) in sources.iter().zip(looks).enumerate() {
            let mut square = V::splat(self.softening_squared);
            for k in 0..D {
                let x = V::splat(source.position[k]).sub(r[k].mul(V::splat(self.length)));
                square = square.add(x.mul(x));
            }
            if number == 0 {
                first = square;
            }
            *look = Look { square: square.lanes(), guess: square.rough_inverse_root().lanes() };
        }
        first
    }

    /// Adds up the pulls of all masses.
    #[inline(always)]
    fn pulls<V: Eight>(&self, sources: &[Source<D>], r: &[V; D], looks: &[Look]) -> [V; D] {
        let mut pulls = [V::splat(0.0); D];
        for (source, look) in sources.iter().zip(looks) {
            let cube = inverse_cube_from(V::new(look.square), V::new(look.guess));
            let pull = V::splat(source.strength).mul(cube);
            for k in 0..D {
                let arrow = V::splat(source.position[k]).sub(r[k].mul(V::splat(self.length)));
                pulls[k] = pulls[k].add(pull.mul(arrow));
            }
        }
        pulls
    }
}

impl<const D: usize> InEights for Follow<'_, '_, D> {
    type Output = Outcome;

    #[inline(always)]
    fn run<V: Eight>(self) -> Outcome {
        const GROUPS: usize = BLOCK / LANES;
        let (count, masses) = (self.grains.mass.len(), self.sources.len() / self.strides.len());
        let (mut places, mut velocities) = ([[[0.0; LANES]; D]; GROUPS], [[[0.0; LANES]; D]; GROUPS]);
        for i in 0..count {
            for k in 0..D {
                places[i / LANES][k][i % LANES] = self.grains.position[i][k];
                velocities[i / LANES][k][i % LANES] = self.grains.velocity[i][k];
            }
        }
        let groups = count.div_ceil(LANES);
        let mut looks = vec![Look::default(); groups * masses];
        let mut far = [[0.0; LANES]; GROUPS];
        for (group, looks) in looks.chunks_exact_mut(masses).enumerate() {
            far[group] = self.look(&self.sources[..masses], &load::<V, D>(&places[group]), looks).lanes();
        }
        for (number, stride) in self.strides.iter().enumerate() {
            let Moves { owed, kick, drift } = stride.moves;
            let (now, later) = self.sources[number * masses..].split_at(masses);
            for (group, looks) in looks.chunks_exact_mut(masses).enumerate() {
                let (mut r, mut v) = (load::<V, D>(&places[group]), load::<V, D>(&velocities[group]));
                let a = self.pulls(now, &r, looks);
                for k in 0..D {
                    if let Some(owed) = owed {
                        v[k] = v[k].add(a[k].mul(V::splat(owed)));
                    }
                    v[k] = v[k].add(a[k].mul(V::splat(kick)));
                    r[k] = r[k].add(v[k].mul(V::splat(drift)));
                    (places[group][k], velocities[group][k]) = (r[k].lanes(), v[k].lanes());
                }
                if let Some(next) = later.get(..masses) {
                    far[group] = V::new(far[group]).add(self.look(next, &r, looks)).lanes();
                }
            }
        }
        let Grains { position, velocity, mass } = self.grains;
        // A mass among the grains has met itself.
        let grains = || (0..count).filter(|&i| mass[i] == 0.0);
        let place = |i: usize| Vector::<D>::from_fn(|k| places[i / LANES][k][i % LANES]);
        let is_near = |i: usize| far[i / LANES][i % LANES] < self.far * self.far;
        let mut coordinates = self.sources.iter().flat_map(|source| source.position.0);
        if self.far.is_finite() && !(coordinates.all(|x| x.abs() < self.far) && grains().all(is_near)) {
            return Outcome::TooFar; // or nowhere: taken one by one, they tell
        }
        let mut outcome = Outcome::Finite;
        for i in grains() {
            (position[i], velocity[i]) = (place(i), Vector::from_fn(|k| velocities[i / LANES][k][i % LANES]));
            if !(position[i].is_finite() && velocity[i].is_finite()) {
                outcome = Outcome::Lost; // and stays there
            }
        }
        outcome
    }
}

/// The numbers of a group of grains.
#[inline(always)]
fn load<V: Eight, const D: usize>(group: &[Group; D]) -> [V; D] {
    let mut numbers = [V::splat(0.0); D];
    for k in 0..D {
        numbers[k] = V::new(group[k]);
    }
    numbers
}
