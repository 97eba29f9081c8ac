//! Springs between pairs of particles: chains, membranes, arbitrary networks.

use corpuscle_core::{Axis, Boundary, Instructions, Invalid, Particles, Vector};

mod gather;
mod lattice;
mod masses;
mod plan;
mod run;
mod scatter;
mod strides;
mod walk;

use super::{Force, Tensor, add_product, finite, massive, not_negative};
use crate::image::NearestImage;
use crate::motion::{Stride, both};
use crate::strider::{Progress, State, Strider};
use lattice::Lattice;
use plan::Plan;
use run::{Place, Run, Stretch};

/// A spring, with a dashpot beside it.
///
/// With `r` the arrow from the first to the second particle (nearest image), `n = r/|r|` and `v` the relative velocity, the
/// second feels `-(k (|r| - l) + c v . n) n`. With rest length zero spring and dashpot act on whole vectors,
/// `-k r - c v`, which is linear: a stretched string whose transverse waves obey the wave equation at any amplitude.
///
/// Beyond Hooke, with `x = |r| - l`, the tension is `k (x + alpha x^2 + beta x^3)`, as in the chains of Fermi, Pasta, Ulam and
/// Tsingou (1955, doi:10.2172/4376203), and the energy `k (x^2/2 + alpha x^3/3 + beta x^4/4)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring {
    /// Index of one end.
    pub first: usize,
    /// Index of the other.
    pub second: usize,
    /// Stiffness `k`, energy per length squared.
    pub stiffness: f64,
    /// Rest length `l`.
    pub rest_length: f64,
    /// Damping `c`, force per velocity.
    pub damping: f64,
    /// `alpha` of the tension, per length; zero for Hooke's law.
    pub quadratic: f64,
    /// `beta` of the tension, per length squared; zero for Hooke's law.
    pub cubic: f64,
}

impl Spring {
    /// An undamped spring that obeys Hooke's law.
    pub fn new(first: usize, second: usize, stiffness: f64, rest_length: f64) -> Self {
        Self { first, second, stiffness, rest_length, damping: 0.0, quadratic: 0.0, cubic: 0.0 }
    }

    /// Elastic part of the force on the second particle.
    #[inline]
    fn elastic<const D: usize>(&self, r: Vector<D>) -> Vector<D> {
        if self.obeys_hooke() {
            if self.rest_length == 0.0 {
                return r * -self.stiffness;
            }
            return r * (self.stiffness * (self.rest_length / r.norm() - 1.0));
        }
        let length = r.norm();
        let x = length - self.rest_length;
        let tension = self.stiffness * x * (1.0 + x * (self.quadratic + x * self.cubic));
        // Ends in one place have no direction to pull in; with rest length zero they are at rest there.
        if length == 0.0 && self.rest_length == 0.0 { Vector::ZERO } else { r * (-tension / length) }
    }

    /// Elastic energy at a length.
    fn energy(&self, length: f64) -> f64 {
        let x = length - self.rest_length;
        self.stiffness * x * x * (0.5 + x * (self.quadratic / 3.0 + x * self.cubic / 4.0))
    }

    /// Names what is wrong, but not the spring.
    fn validate<const D: usize>(&self, boundary: &Boundary<D>) -> Result<(), Invalid> {
        let Self { first, second, stiffness, rest_length, damping, quadratic, cubic } = *self;
        if first == second {
            return Err(Invalid::new("ends", first, "two different particles"));
        }
        not_negative("stiffness", stiffness)?;
        not_negative("rest length", rest_length)?;
        not_negative("damping", damping)?;
        finite("quadratic coefficient", quadratic)?;
        finite("cubic coefficient", cubic)?;
        for k in (0..D).filter(|&k| boundary.axes[k] == Axis::Periodic) {
            let half = 0.5 * boundary.extent()[k];
            if rest_length >= half {
                let expected = format!("less than half the periodic box, {half} along axis {k}");
                return Err(Invalid::new("rest length", rest_length, expected));
            }
        }
        Ok(())
    }

    fn obeys_hooke(&self) -> bool {
        self.quadratic == 0.0 && self.cubic == 0.0
    }

    /// Whether the force is `-k r`, component by component.
    fn is_linear(&self) -> bool {
        self.rest_length == 0.0 && self.damping == 0.0 && self.obeys_hooke()
    }

    /// Friction on the second particle, which moves at `v` relative to the first.
    #[inline]
    fn friction<const D: usize>(&self, r: Vector<D>, v: Vector<D>) -> Vector<D> {
        if self.rest_length == 0.0 {
            return v * -self.damping;
        }
        r * (-self.damping * v.dot(r) / r.norm_squared())
    }
}

/// Springs whose first ends are within one block of so many particles are handled together: what is written stays in a cache near the
/// processor meanwhile.
const NEAR: usize = 2048;
/// Springs between particles farther apart would need windows that no cache holds.
const FARTHEST: usize = 16_384;
/// Parts of the memory a thread: whoever is held up leaves some to the others.
const PARTS_A_THREAD: usize = 2;

/// Any number of springs.
///
/// Springs alike whose ends follow one another, as those of a chain or of the rows of a membrane, are found and handled
/// together: nothing has to be looked up for each of them.
#[derive(Clone, Debug)]
pub struct Springs {
    given: Vec<Spring>,
    /// How linear springs of a regular arrangement are handled; all others, or at periodic axes, are runs.
    lattice: Option<Lattice>,
    /// What the lattice has to know of the particles to take strides, until something else changes than places and velocities; none where
    /// it is not what takes them.
    plan: Option<Plan>,
    runs: Vec<Run>,
    /// Where the runs of each block of first ends begin, and the last ends.
    blocks: Vec<usize>,
    /// The farthest apart in memory that two ends are.
    reach: usize,
    damped: bool,
    instructions: Instructions,
}

impl PartialEq for Springs {
    fn eq(&self, other: &Self) -> bool {
        self.given == other.given
    }
}

impl Springs {
    /// A network of springs.
    pub fn new(springs: Vec<Spring>) -> Self {
        let lattice = Lattice::new(&springs);
        let runs = Run::all(&springs, NEAR);
        let last = runs.last().map_or(0, |run| run.first() / NEAR + 1);
        let blocks = (0..=last).map(|block| runs.partition_point(|run| run.first() / NEAR < block)).collect();
        let reach = runs.iter().map(Run::reach).max().unwrap_or(0);
        let damped = springs.iter().any(|spring| spring.damping != 0.0);
        Self { given: springs, lattice, plan: None, runs, blocks, reach, damped, instructions: Instructions::detect() }
    }

    /// The springs.
    pub fn springs(&self) -> &[Spring] {
        &self.given
    }

    /// The lattice, unless nearest images have to be looked for.
    fn lattice<const D: usize>(&self, boundary: &Boundary<D>) -> Option<&Lattice> {
        self.lattice.as_ref().filter(|_| !boundary.axes.contains(&Axis::Periodic))
    }

    /// The runs with first ends in a block.
    fn block(&self, block: usize) -> &[Run] {
        self.blocks.get(block..block + 2).map_or(&[], |ends| &self.runs[ends[0]..ends[1]])
    }

    /// Adds the accelerations by some runs, one after the other.
    fn stretch<const D: usize>(&self, runs: &[Run], boundary: &Boundary<D>, place: Place<'_, D>) {
        let image = NearestImage::new(boundary);
        let periodic = boundary.axes.contains(&Axis::Periodic).then_some(image);
        let Place { from, position, velocity, mass, acceleration } = place;
        for run in runs {
            if !run.is_short() {
                let place = Place { from, position, velocity, mass, acceleration: &mut *acceleration };
                self.instructions.run(Stretch { run, image: periodic, place });
                continue;
            }
            for spring in run.springs() {
                let (first, second) = (spring.first - from, spring.second - from);
                let r = image.displacement(position[first], position[second]);
                let mut force = spring.elastic(r);
                if spring.damping != 0.0 {
                    force += spring.friction(r, velocity[second] - velocity[first]);
                }
                acceleration[first] -= force * (1.0 / mass[first]);
                acceleration[second] += force * (1.0 / mass[second]);
            }
        }
    }

    fn arrows<'a, const D: usize>(
        &'a self,
        boundary: &Boundary<D>,
        particles: &'a Particles<D>,
    ) -> impl Iterator<Item = (&'a Spring, Vector<D>)> {
        let image = NearestImage::new(boundary);
        self.given
            .iter()
            .map(move |spring| (spring, image.displacement(particles.position[spring.first], particles.position[spring.second])))
    }
}

impl<const D: usize> Strider<D> for Springs {
    /// One where springs are no lattice, or something else moves particles, too; none where ends are too far apart in memory, or
    /// there is friction, which would need the accelerations before.
    fn strides_at_once(&mut self, state: &State<'_, D>) -> usize {
        let State { boundary, particles, held, .. } = state;
        self.plan = self.lattice(boundary).map(|lattice| Plan::new::<D>(lattice, &particles.mass, held));
        if self.reach > FARTHEST || self.damped {
            return 0;
        }
        let nothing_else = boundary.axes == [Axis::Open; D];
        self.lattice(boundary).filter(|_| nothing_else).map_or(1, |lattice| lattice.strides_at_once::<D>(particles.len()))
    }

    fn stride(&mut self, state: State<'_, D>, strides: &[Stride]) -> Progress {
        let State { boundary, particles, held, .. } = state;
        let finite = if let (Some(lattice), Some(plan)) = (&self.lattice, &self.plan) {
            lattice.sweep(particles, plan, strides)
        } else {
            let one = |stride: &Stride| self.scatter(boundary, particles, held, *stride);
            strides.iter().map(one).fold([true; 2], both)
        };
        Progress { taken: strides.len(), finite }
    }

    fn kick(&mut self, state: State<'_, D>, dt: f64) -> Option<bool> {
        let (lattice, plan) = (self.lattice.as_ref()?, self.plan.as_ref()?);
        // Where memory takes the time; else accelerations kept for the next step save as much as they cost.
        let worth_it = lattice.strides_at_once::<D>(state.particles.len()) > 1;
        worth_it.then(|| lattice.kick(state.particles, plan, dt))
    }
}

impl<const D: usize> Force<D> for Springs {
    fn name(&self) -> &'static str {
        "springs"
    }

    fn accelerate(&mut self, _: f64, boundary: &Boundary<D>, particles: &Particles<D>, acceleration: &mut [Vector<D>]) {
        if let Some(lattice) = self.lattice(boundary) {
            return lattice.accelerate(particles, acceleration);
        }
        let Particles { position, velocity, mass, .. } = particles;
        self.stretch(&self.runs, boundary, Place { from: 0, position, velocity, mass, acceleration });
    }

    fn strider(&mut self) -> Option<&mut dyn Strider<D>> {
        Some(self)
    }

    fn energy(&self, _: f64, boundary: &Boundary<D>, particles: &Particles<D>) -> f64 {
        self.arrows(boundary, particles).map(|(spring, r)| spring.energy(r.norm())).sum()
    }

    fn virial(&self, _: f64, boundary: &Boundary<D>, particles: &Particles<D>) -> f64 {
        self.arrows(boundary, particles).map(|(spring, r)| r.dot(spring.elastic(r))).sum()
    }

    fn virial_tensor(&self, _: f64, boundary: &Boundary<D>, particles: &Particles<D>) -> Option<Tensor<D>> {
        let mut tensor = [[0.0; D]; D];
        self.arrows(boundary, particles).for_each(|(spring, r)| add_product(&mut tensor, r, spring.elastic(r)));
        Some(tensor)
    }

    fn validate(&self, boundary: &Boundary<D>, particles: &Particles<D>) -> Result<(), Invalid> {
        for (number, spring) in self.given.iter().enumerate() {
            massive("a spring", spring.first, particles)?;
            massive("a spring", spring.second, particles)?;
            let of_this = |invalid: Invalid| Invalid { key: format!("{} of spring {number}", invalid.key), ..invalid };
            spring.validate(boundary).map_err(of_this)?;
        }
        Ok(())
    }

    fn depends_on_velocity(&self) -> bool {
        self.damped
    }
}

#[cfg(test)]
mod tests;
