//! What pulls a group of targets, gathered in blocks, and how.

use corpuscle_core::Vector;
use corpuscle_core::instructions::Kernel;

use super::super::direct::BLOCK;
use super::super::lanes::{LANES, guess, inverse_root, sum};
use super::super::scale::Scale;
use super::build::{Body, Tree};

type Column = [f64; BLOCK];

/// Accepted cells of fewer masses than this pull one by one: that is no slower, and exact.
const FEW: u32 = 3;

/// What a target feels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pull<const D: usize> {
    pub(super) acceleration: Vector<D>,
    /// `sum G m / r`.
    pub(super) potential: f64,
}

impl<const D: usize> Default for Pull<D> {
    fn default() -> Self {
        Self { acceleration: Vector::ZERO, potential: 0.0 }
    }
}

impl<const D: usize> Pull<D> {
    /// From scaled lengths to those of the system.
    pub(super) fn rescale(&mut self, scale: Scale) {
        self.acceleration = self.acceleration * scale.acceleration();
        self.potential *= scale.length;
    }
}

/// Cells and masses that pull a group.
#[derive(Clone, Debug, Default)]
pub(super) struct Lists {
    cells: Vec<u32>,
    masses: Vec<u32>,
}

impl Lists {
    /// Decides for each cell whether it is far enough from all of a group.
    pub(super) fn walk<const D: usize>(&mut self, tree: &Tree<D>, group: &[Body<D>], theta_squared: f64) {
        let (mut lower, mut upper) = (Vector::<D>::splat(f64::INFINITY), Vector::<D>::splat(f64::NEG_INFINITY));
        for body in group {
            for k in 0..D {
                lower[k] = lower[k].min(body.position[k]);
                upper[k] = upper[k].max(body.position[k]);
            }
        }
        self.cells.clear();
        self.masses.clear();
        let mut number = 0;
        while let Some(cell) = tree.cells.get(number) {
            let outside = |k: usize| (lower[k] - cell.centre[k]).max(cell.centre[k] - upper[k]).max(0.0);
            let distance_squared: f64 = (0..D).map(|k| outside(k) * outside(k)).sum();
            let far = cell.side_squared < theta_squared * distance_squared;
            if far && cell.masses.len() as u32 >= FEW {
                self.cells.push(number as u32);
            } else if far || cell.leaf {
                self.masses.extend(cell.masses.clone());
            } else {
                number += 1;
                continue;
            }
            number = cell.next as usize;
        }
    }

    pub(super) fn for_each_block_of_cells<const D: usize>(
        &self,
        tree: &Tree<D>,
        block: &mut Cells<D>,
        mut pull: impl FnMut(&Cells<D>),
    ) {
        for numbers in self.cells.chunks(BLOCK) {
            block.load(tree, numbers);
            pull(block);
        }
    }

    pub(super) fn for_each_block_of_bodies<const D: usize>(
        &self,
        tree: &Tree<D>,
        block: &mut Bodies<D>,
        mut pull: impl FnMut(&Bodies<D>),
    ) {
        for numbers in self.masses.chunks(BLOCK) {
            block.load(tree, numbers);
            pull(block);
        }
    }
}

/// Masses, one array a component, filled up to whole lanes by masses of zero outside the system.
pub(super) struct Bodies<const D: usize> {
    count: usize,
    number: Vec<u32>,
    position: [Column; D],
    strength: Column,
}

impl<const D: usize> Default for Bodies<D> {
    fn default() -> Self {
        Self { count: 0, number: vec![], position: [[0.0; BLOCK]; D], strength: [0.0; BLOCK] }
    }
}

impl<const D: usize> Bodies<D> {
    fn load(&mut self, tree: &Tree<D>, numbers: &[u32]) {
        self.count = numbers.len().next_multiple_of(LANES);
        self.number.clear();
        self.number.extend(numbers);
        for place in 0..self.count {
            let body = numbers.get(place).map(|&number| tree.bodies()[number as usize]);
            self.strength[place] = body.map_or(0.0, |body| body.strength);
            for k in 0..D {
                self.position[k][place] = body.map_or(Scale::OUTSIDE, |body| body.position[k]);
            }
        }
    }

    /// Where body `number` is among these.
    #[inline(always)]
    fn place_of(&self, number: u32) -> Option<usize> {
        self.number.iter().position(|&other| other == number)
    }
}

/// The pull of masses on targets.
pub(super) struct OfBodies<'a, const D: usize> {
    pub(super) bodies: &'a Bodies<D>,
    pub(super) targets: &'a [Body<D>],
    /// Number of the first target along the curve.
    pub(super) first: u32,
    pub(super) softening_squared: f64,
    pub(super) pulls: &'a mut [Pull<D>],
}

impl<const D: usize> Kernel for OfBodies<'_, D> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { bodies, targets, first, softening_squared, pulls } = self;
        let Bodies { position, strength, count, .. } = bodies;
        let count = (*count).min(BLOCK);
        let (mut squares, mut guesses) = ([0.0; BLOCK], [0.0; BLOCK]);
        let (mut potential, mut accelerations) = ([0.0; BLOCK], [[0.0; BLOCK]; D]);
        for ((number, target), pull) in (first..).zip(targets).zip(pulls) {
            let target = target.position;
            measure(target, softening_squared, count, position, &mut squares, &mut guesses);
            if let Some(own) = bodies.place_of(number) {
                (squares[own], guesses[own]) = (1.0, 0.0); // no pull from itself
            }
            for place in 0..count {
                let y = inverse_root(squares[place], guesses[place]);
                potential[place] = strength[place] * y;
                let weight = potential[place] * (y * y);
                for k in 0..D {
                    accelerations[k][place] = weight * (position[k][place] - target[k]);
                }
            }
            pull.add(count, &potential, &accelerations);
        }
    }
}

/// Cells, one array a moment, filled up as [`Bodies`] are.
pub(super) struct Cells<const D: usize> {
    count: usize,
    centre: [Column; D],
    strength: Column,
    second: [[Column; D]; D],
}

impl<const D: usize> Default for Cells<D> {
    fn default() -> Self {
        Self { count: 0, centre: [[0.0; BLOCK]; D], strength: [0.0; BLOCK], second: [[[0.0; BLOCK]; D]; D] }
    }
}

impl<const D: usize> Cells<D> {
    fn load(&mut self, tree: &Tree<D>, numbers: &[u32]) {
        self.count = numbers.len().next_multiple_of(LANES);
        for place in 0..self.count {
            let cell = numbers.get(place).map(|&number| &tree.cells[number as usize]);
            self.strength[place] = cell.map_or(0.0, |cell| cell.strength);
            for k in 0..D {
                self.centre[k][place] = cell.map_or(Scale::OUTSIDE, |cell| cell.centre[k]);
                for l in k..D {
                    self.second[k][l][place] = cell.map_or(0.0, |cell| cell.second[k][l]);
                }
            }
        }
    }
}

/// The pull of cells on targets.
///
/// With `x` the arrow from the target to the centre of mass and `y = (x^2 + s^2)^(-1/2)`, Taylor's expansion of `1/r` gives
/// `phi = M y + (3 y^5 x.S.x - y^3 tr S)/2` for the potential and
/// `(M y^3 + 15/2 y^7 x.S.x - 3/2 y^5 tr S) x - 3 y^5 S x` for the acceleration; the first moments vanish.
pub(super) struct OfCells<'a, const D: usize> {
    pub(super) cells: &'a Cells<D>,
    pub(super) targets: &'a [Body<D>],
    pub(super) softening_squared: f64,
    pub(super) pulls: &'a mut [Pull<D>],
}

impl<const D: usize> Kernel for OfCells<'_, D> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { cells: Cells { centre, strength, second, count }, targets, softening_squared, pulls } = self;
        let count = (*count).min(BLOCK);
        let (mut squares, mut guesses) = ([0.0; BLOCK], [0.0; BLOCK]);
        let (mut potential, mut accelerations) = ([0.0; BLOCK], [[0.0; BLOCK]; D]);
        for (target, pull) in targets.iter().zip(pulls) {
            let target = target.position;
            measure(target, softening_squared, count, centre, &mut squares, &mut guesses);
            for place in 0..count {
                let y = inverse_root(squares[place], guesses[place]);
                let y2 = y * y;
                let (y3, y5) = (y * y2, y * y2 * y2);
                let x: [f64; D] = std::array::from_fn(|k| centre[k][place] - target[k]);
                let (mut sx, mut xsx, mut trace) = ([0.0; D], 0.0, 0.0);
                for k in 0..D {
                    for l in 0..D {
                        let s = if k <= l { second[k][l][place] } else { second[l][k][place] };
                        sx[k] += s * x[l];
                    }
                    xsx += x[k] * sx[k];
                    trace += second[k][k][place];
                }
                potential[place] = strength[place] * y + 0.5 * (3.0 * y5 * xsx - y3 * trace);
                let along = strength[place] * y3 + y5 * (7.5 * y2 * xsx - 1.5 * trace);
                for k in 0..D {
                    accelerations[k][place] = along * x[k] - 3.0 * y5 * sx[k];
                }
            }
            pull.add(count, &potential, &accelerations);
        }
    }
}

/// Softened squares of distances, and guesses of the inverse distances.
#[inline(always)]
fn measure<const D: usize>(
    target: Vector<D>,
    softening_squared: f64,
    count: usize,
    position: &[Column; D],
    squares: &mut Column,
    guesses: &mut [f32; BLOCK],
) {
    for place in 0..count {
        let mut square = softening_squared;
        for k in 0..D {
            let x = position[k][place] - target[k];
            square += x * x;
        }
        squares[place] = square;
        guesses[place] = guess(square);
    }
}

impl<const D: usize> Pull<D> {
    #[inline(always)]
    fn add(&mut self, count: usize, potential: &Column, accelerations: &[Column; D]) {
        self.potential += total(&potential[..count]);
        for k in 0..D {
            self.acceleration[k] += total(&accelerations[k][..count]);
        }
    }
}

/// The sum of a column, lane by lane.
#[inline(always)]
fn total(column: &[f64]) -> f64 {
    let mut lanes = [0.0; LANES];
    for chunk in column.as_chunks::<LANES>().0 {
        for lane in 0..LANES {
            lanes[lane] += chunk[lane];
        }
    }
    sum(&lanes)
}
