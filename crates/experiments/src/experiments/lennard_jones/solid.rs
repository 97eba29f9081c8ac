//! The crystal: a face-centred cubic lattice, its phonons, and what they make of energy, pressure and structure.
//!
//! To first order in the temperature a crystal is a set of oscillators. Its energy is that of the lattice and `kT/2` for each of `3(N - 1)` of
//! them, whatever their frequencies; its pressure `P = -dU_0/dV - kT d(sum ln omega)/dV + kT/V`, the last by the free motion of the whole.
//! The frequencies are the square roots of the eigenvalues of `D(k) = sum_R (1 - cos k.R) Phi(R)` for the `N` wave vectors of this very
//! crystal, so that `sum ln omega = (1/2) sum_k ln det D(k)`. The distance of two atoms varies by `(kT/N) sum_k 2 (1 - cos k.R) R.D^-1.R/R^2`.
//! Of the next orders, the anharmonic part of van der Hoef's equation of state (2000, doi:10.1063/1.1314342) is taken:
//! `U_ah/N = sum a_nm rho^n T^m`, `P_ah = -rho^2 sum n a_nm rho^(n-1) T^m/(m - 1)`; at `T = 0.1` it is below a hundredth of either.

use std::f64::consts::{PI, TAU};

use super::CUTOFF;

/// Van der Hoef's `a_nm`, `n = 0..=2`, `m = 2..=5`.
const ANHARMONIC: [[f64; 4]; 3] = [
    [-8.215_176_8, 12.070_686, -6.659_461_5, 1.321_158_2],
    [13.404_069, -20.632_066, 11.564_825, -2.306_480_1],
    [-5.548_126_1, 8.846_597_8, -5.025_863_1, 1.007_006_6],
];

type Vector = [f64; 3];
type Matrix = [[f64; 3]; 3];

/// `U'/r` and `U''` of `4 (r^-12 - r^-6)`.
fn derivatives(r: f64) -> (f64, f64) {
    let (square, sixth) = (r * r, r.powi(-6));
    (-24.0 * sixth * (2.0 * sixth - 1.0) / square, 24.0 * sixth * (26.0 * sixth - 7.0) / square)
}

/// Places of the atoms of a crystal of `4 n^3`, in a cube of this side.
pub(super) fn places(cells: usize, side: f64) -> impl Iterator<Item = Vector> {
    let a = side / cells as f64;
    let corners = [[0.25, 0.25, 0.25], [0.75, 0.75, 0.25], [0.75, 0.25, 0.75], [0.25, 0.75, 0.75]];
    let cube = (0..cells).flat_map(move |i| (0..cells).flat_map(move |j| (0..cells).map(move |k| [i, j, k])));
    cube.flat_map(move |cell| corners.map(|corner| std::array::from_fn(|axis| (cell[axis] as f64 + corner[axis]) * a)))
}

/// Number `n` of cells along each side of a crystal of `4 n^3` atoms.
pub(super) fn cells(count: usize) -> Option<usize> {
    (1..=count).take_while(|n| 4 * n * n * n <= count).find(|n| 4 * n * n * n == count)
}

/// A shell of neighbours: mean distance, its variance, and how many they are.
pub(super) type Shell = (f64, f64, usize);

/// A crystal at rest, its atoms bound to those nearer than the cutoff.
pub(super) struct Crystal {
    cells: usize,
    /// Arrows to the neighbours, in halves of the cube's side `a`.
    arrows: Vec<[i32; 3]>,
    /// Half of the side of the cubic cell.
    half: f64,
}

impl Crystal {
    pub(super) fn new(cells: usize, density: f64, cutoff: f64) -> Self {
        let half = 0.5 * libm::cbrt(4.0 / density);
        let most = (cutoff / half) as i32;
        let range = || -most..=most;
        let all = range().flat_map(|x| range().flat_map(move |y| range().map(move |z| [x, y, z])));
        let near = |v: &[i32; 3]| {
            let square = v.iter().map(|x| x * x).sum::<i32>();
            square > 0 && v.iter().sum::<i32>() % 2 == 0 && f64::from(square).sqrt() * half < cutoff
        };
        Self { cells, arrows: all.filter(near).collect(), half }
    }

    fn count(&self) -> f64 {
        4.0 * (self.cells as f64).powi(3)
    }

    fn density(&self) -> f64 {
        0.5 / self.half.powi(3)
    }

    /// `D(k)` of a crystal that is so many times as wide.
    fn dynamical(&self, phase: Vector, width: f64) -> Matrix {
        let mut matrix = [[0.0; 3]; 3];
        for arrow in &self.arrows {
            let v = arrow.map(|x| f64::from(x) * self.half * width);
            let square = v.iter().map(|x| x * x).sum::<f64>();
            let (pull, bend) = derivatives(square.sqrt());
            let turn = (0..3).map(|axis| phase[axis] * f64::from(arrow[axis])).sum::<f64>();
            let share = 1.0 - libm::cos(turn);
            for i in 0..3 {
                for j in 0..3 {
                    let own = if i == j { pull } else { 0.0 };
                    matrix[i][j] += share * ((bend - pull) * v[i] * v[j] / square + own);
                }
            }
        }
        matrix
    }

    /// The phases `k a/2` of all wave vectors but zero, twice: a cube of twice the side of the reciprocal cell has each of them twice.
    fn phases(&self) -> impl Iterator<Item = Vector> {
        let twice = 2 * self.cells;
        let step = TAU / twice as f64;
        let cube = (0..twice).flat_map(move |h| (0..twice).flat_map(move |k| (0..twice).map(move |l| [h, k, l])));
        let cells = self.cells;
        cube.filter(move |v| *v != [0; 3] && *v != [cells; 3]).map(move |v| v.map(|x| x as f64 * step))
    }

    /// Energy per atom and pressure of the lattice at rest.
    pub(super) fn at_rest(&self) -> [f64; 2] {
        let (mut energy, mut virial) = (0.0, 0.0);
        for arrow in &self.arrows {
            let r = self.half * f64::from(arrow.iter().map(|x| x * x).sum::<i32>()).sqrt();
            energy += 0.5 * super::potential(r);
            virial += 0.5 * r * r * derivatives(r).0;
        }
        [energy, -self.density() * virial / 3.0]
    }

    /// Mean of `omega^2` over all `3N` modes, the motion of the whole among them: a third of the trace of `sum_R Phi(R)`.
    pub(super) fn mean_square_frequency(&self) -> f64 {
        let trace = |arrow: &[i32; 3]| {
            let (pull, bend) = derivatives(self.half * f64::from(arrow.iter().map(|x| x * x).sum::<i32>()).sqrt());
            bend + 2.0 * pull
        };
        self.arrows.iter().map(trace).sum::<f64>() / 3.0
    }

    /// `d(sum ln omega)/d ln V`.
    fn stiffening(&self) -> f64 {
        const STEP: f64 = 1e-4;
        let sum = |width: f64| -> f64 { self.phases().map(|phase| libm::log(determinant(&self.dynamical(phase, width)))).sum() };
        // Half for the square root, half for each wave vector's coming twice, a third for volume's being the cube of width.
        (sum(1.0 + STEP) - sum(1.0 - STEP)) / (2.0 * STEP) / 12.0
    }

    /// Energy per atom and pressure at a low temperature.
    pub(super) fn expected(&self, temperature: f64) -> [f64; 2] {
        let ([energy, pressure], n, density) = (self.at_rest(), self.count(), self.density());
        let volume = n / density;
        let mut anharmonic = [0.0; 2];
        for (power, row) in ANHARMONIC.iter().enumerate() {
            for (m, a) in (2..).zip(row) {
                anharmonic[0] += a * density.powi(power as i32) * temperature.powi(m);
                anharmonic[1] -= a * power as f64 * density.powi(power as i32 + 1) * temperature.powi(m) / f64::from(m - 1);
            }
        }
        [
            energy + 1.5 * temperature * (n - 1.0) / n + anharmonic[0],
            pressure + temperature * (1.0 - self.stiffening()) / volume + anharmonic[1],
        ]
    }

    /// Shells of neighbours up to a distance.
    pub(super) fn shells(&self, temperature: f64, range: f64) -> Vec<Shell> {
        let wide = Self::new(self.cells, self.density(), range + 4.0 * self.half);
        let mut kinds: Vec<([i32; 3], usize)> = vec![];
        for arrow in &wide.arrows {
            let mut kind = arrow.map(i32::abs);
            kind.sort_unstable();
            match kinds.iter_mut().find(|(known, _)| *known == kind) {
                Some((_, count)) => *count += 1,
                None => kinds.push((kind, 1)),
            }
        }
        let inverses: Vec<(Vector, Matrix)> = self.phases().map(|phase| (phase, inverse(&self.dynamical(phase, 1.0)))).collect();
        let strength = temperature / (2.0 * self.count());
        let shell = |(arrow, count): ([i32; 3], usize)| {
            let square = f64::from(arrow.iter().map(|x| x * x).sum::<i32>());
            let (mut along, mut all) = (0.0, 0.0);
            for (phase, inverse) in &inverses {
                let share = 2.0 * (1.0 - libm::cos((0..3).map(|axis| phase[axis] * f64::from(arrow[axis])).sum::<f64>()));
                for i in 0..3 {
                    all += share * inverse[i][i];
                    for j in 0..3 {
                        along += share * inverse[i][j] * f64::from(arrow[i] * arrow[j]) / square;
                    }
                }
            }
            let (along, all) = (strength * along, strength * all);
            let r = self.half * square.sqrt();
            // Motion across makes the distance longer.
            (r + (all - along) / (2.0 * r), along, count)
        };
        kinds.into_iter().map(shell).collect()
    }

    /// `g(r)` of such shells.
    pub(super) fn structure(&self, shells: &[Shell], r: f64) -> f64 {
        let of = |&(mean, variance, count): &Shell| {
            let gauss = libm::exp(-0.5 * (r - mean) * (r - mean) / variance) / (TAU * variance).sqrt();
            count as f64 * gauss / (4.0 * PI * r * r * self.density())
        };
        shells.iter().map(of).sum()
    }
}

/// The crystal of a state.
pub(super) fn crystal(count: usize, density: f64) -> Option<Crystal> {
    cells(count).map(|cells| Crystal::new(cells, density, CUTOFF))
}

fn cofactor(m: &Matrix, i: usize, j: usize) -> f64 {
    let [a, b] = [(i + 1) % 3, (i + 2) % 3];
    let [c, d] = [(j + 1) % 3, (j + 2) % 3];
    m[a][c] * m[b][d] - m[a][d] * m[b][c]
}

fn determinant(m: &Matrix) -> f64 {
    (0..3).map(|j| m[0][j] * cofactor(m, 0, j)).sum()
}

/// Of a symmetric matrix.
fn inverse(m: &Matrix) -> Matrix {
    let whole = determinant(m);
    std::array::from_fn(|i| std::array::from_fn(|j| cofactor(m, i, j) / whole))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lattice sums of van der Hoef's static energy, `-14.45392093 rho^2 + 6.065940096 rho^4`, up to what lies beyond 12.
    #[test]
    fn the_lattice_has_its_energy() {
        let density = 1.1;
        let [energy, pressure] = Crystal::new(4, density, 12.0).at_rest();
        let beyond = -8.0 / 3.0 * PI * density * 12f64.powi(-3);
        let known = -14.453_920_93 * density.powi(2) + 6.065_940_096 * density.powi(4);
        assert!((energy + beyond - known).abs() < 1e-4, "{} {known}", energy + beyond);
        let known = density * (2.0 * -14.453_920_93 * density.powi(2) + 4.0 * 6.065_940_096 * density.powi(4));
        assert!((pressure + 2.0 * density * beyond - known).abs() < 1e-3, "{pressure} {known}");
    }

    /// Van der Hoef's harmonic free energy, `sum b_n rho^(n+1)/(n+1)` of `kT`, is that of the whole potential and an infinite crystal: its
    /// derivative, the phonons' pressure over `rho kT` less one, agrees to a few parts in a thousand.
    #[test]
    fn phonons_press_as_published() {
        let density: f64 = 1.05;
        let crystal = Crystal::new(6, density, 4.6);
        let own = -crystal.stiffening() / crystal.count();
        let [a, b, c, d] = [69.833_875, -132.869_63, 97.438_593, -25.848_057];
        let published = 1.0 + density * (a + density * (b + density * (c + density * d)));
        assert!((own / published - 1.0).abs() < 0.01, "{own} {published}");
    }

    #[test]
    fn a_crystal_has_its_places() {
        assert_eq!((cells(500), cells(501)), (Some(5), None));
        let side = 5.0;
        let all: Vec<Vector> = places(3, side).collect();
        assert_eq!(all.len(), 108);
        // Twelve nearest neighbours, at a/sqrt(2).
        let nearest = side / 3.0 / 2f64.sqrt();
        let distance = |r: &Vector| {
            let near = |k: usize| (r[k] - all[0][k] + 1.5 * side).rem_euclid(side) - 0.5 * side;
            (0..3).map(|k| near(k) * near(k)).sum::<f64>().sqrt()
        };
        assert_eq!(all.iter().filter(|r| (distance(r) - nearest).abs() < 1e-9).count(), 12);
    }

    /// All shells together are as many neighbours as the density says.
    #[test]
    fn shells_are_complete() {
        let crystal = Crystal::new(5, 1.08, CUTOFF);
        let shells = crystal.shells(0.1, 3.5);
        let near: usize = shells.iter().filter(|(r, ..)| *r < 2.0).map(|(.., count)| count).sum();
        assert_eq!(near, 12 + 6 + 24); // at 1, sqrt(2) and sqrt(3) of the nearest distance, 1.094
        assert!(shells.iter().all(|(_, variance, _)| (1e-4..3e-3).contains(variance)));
    }
}
