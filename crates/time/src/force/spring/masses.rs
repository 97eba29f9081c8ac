//! Masses of the particles of a lattice, most often all the same.

use std::ops::Range;

/// Masses of particles.
#[derive(Clone, Copy)]
pub(super) struct Masses<'a> {
    pub(super) each: &'a [f64],
    /// That of every one of them, where all are known to have the same.
    pub(super) of_all: Option<f64>,
}

/// `1/m`; 0 without mass, which nothing pulls at.
#[derive(Clone, Copy)]
pub(super) enum Inverse<'a> {
    Alike(f64),
    /// For each component of the particles.
    Each(&'a [f64]),
}

impl Inverse<'_> {
    pub(super) fn of(self, n: usize) -> f64 {
        match self {
            Self::Alike(one) => one,
            Self::Each(all) => all[n],
        }
    }
}

/// [`Inverse`] masses of the particles of a block.
pub(super) struct InverseMass<'a, const D: usize> {
    mass: &'a [f64],
    /// Inverted, if they are alike: most chains and membranes are of equal masses.
    alike: Option<f64>,
    /// For each component of the particles of the block.
    components: Vec<[f64; D]>,
}

impl<'a, const D: usize> InverseMass<'a, D> {
    /// Of some of these particles.
    pub(super) fn new(masses: Masses<'a>, particles: Range<usize>) -> Self {
        let mass = &masses.each[particles];
        Self { mass, alike: masses.of_all.or_else(|| of_all(mass)).map(inverse), components: vec![] }
    }

    /// Takes in the masses of a block.
    pub(super) fn see(&mut self, block: Range<usize>) {
        if self.alike.is_none() {
            self.components.clear();
            self.components.extend(self.mass[block].iter().map(|&mass| [inverse(mass); D]));
        }
    }

    /// Those of the particles of the block from this one on.
    pub(super) fn from(&self, particle: usize) -> Inverse<'_> {
        self.alike.map_or_else(|| Inverse::Each(self.components[particle..].as_flattened()), Inverse::Alike)
    }
}

/// What every one of these is, bit by bit, where all are the same.
pub(super) fn of_all(masses: &[f64]) -> Option<f64> {
    let first = *masses.first()?;
    let differences = masses.iter().fold(0, |bits, mass| bits | (mass.to_bits() ^ first.to_bits()));
    (differences == 0).then_some(first)
}

fn inverse(mass: f64) -> f64 {
    if mass == 0.0 { 0.0 } else { 1.0 / mass }
}
