//! The smooth part of the interaction, as a sum over waves that fit the box.
//!
//! Waves come in rows of equal `K_x`, `K_y`, and of two opposite waves only one is counted. Along a row the phase factors are
//! products of one factor a coordinate and serve `K_z` and `-K_z` at once. Sums over particles run over one row after another,
//! forces over one group of particles after another, whoever computes them: bits do not depend on threads.

use std::f64::consts::PI;

use corpuscle_core::{Boundary, Vector};
use rayon::prelude::*;

use super::plan::Plan;
use crate::force::{Tensor, add_product};
use corpuscle_core::instructions::{Instructions, Kernel};

/// Particles whose phases are computed together.
const LANES: usize = 8;
type Lanes = [f64; LANES];

/// `cos` and `sin`, or real and imaginary part.
type Factor = [Lanes; 2];

/// The waves with `K = 2 pi (x/L_x, y/L_y, +-z/L_z)` for `z` from 0.
#[derive(Clone, Copy, Debug)]
struct Row {
    x: usize,
    y: usize,
    /// Whether `K_y` is negative.
    mirrored: bool,
    k: [f64; 2],
    /// Its pairs of waves in the list of all of them.
    first: usize,
    count: usize,
}

/// Two waves, of `K_z` and `-K_z`.
#[derive(Clone, Copy, Debug, Default)]
struct Pair {
    /// `4 pi k exp(-K^2/4 alpha^2)/(V K^2)` of each of the two; zero where it is counted elsewhere.
    weight: [f64; 2],
    k_squared: f64,
    /// `sum q_i exp(i K.r_i)` of both: real, imaginary, real, imaginary.
    amplitude: [f64; 4],
}

/// The waves, and the phases of all particles.
#[derive(Clone, Debug, Default)]
pub(super) struct Waves {
    /// What rows and weights were made for.
    made_for: Option<(Plan, f64)>,
    rows: Vec<Row>,
    pairs: Vec<Pair>,
    /// Orders `n` of the phase factors along each axis.
    orders: [usize; 3],
    /// `exp(2 pi i n x/L_x)` times the charge, `exp(2 pi i n y/L_y)`, `exp(2 pi i n z/L_z)`, for `n` from 0, one group of
    /// particles after another.
    phases: Vec<Factor>,
    count: usize,
}

impl Waves {
    /// Takes over box, charges and positions.
    pub(super) fn load(&mut self, plan: &Plan, constant: f64, boundary: &Boundary<3>, charges: &[f64], position: &[Vector<3>]) {
        if self.made_for != Some((*plan, constant)) {
            self.list(plan, constant);
            self.made_for = Some((*plan, constant));
        }
        let total: usize = self.orders.iter().sum();
        self.count = position.len();
        self.phases.clear();
        self.phases.resize(self.count.div_ceil(LANES) * total, [[0.0; LANES]; 2]);
        let side = boundary.extent();
        let orders = self.orders;
        let group = |(number, phases): (usize, &mut [Factor])| {
            let (x, rest) = phases.split_at_mut(orders[0]);
            let (y, z) = rest.split_at_mut(orders[1]);
            for (k, phases) in [x, y, z].into_iter().enumerate() {
                let mut first = [[0.0; LANES]; 2];
                for lane in 0..LANES {
                    let i = number * LANES + lane;
                    let place = position.get(i).map_or(0.0, |r| (r[k] - boundary.lower[k]) / side[k]);
                    (first[1][lane], first[0][lane]) = libm::sincos(2.0 * PI * place);
                    // Lanes without a particle have no charge.
                    phases[0][0][lane] = if k > 0 { 1.0 } else { charges.get(i).copied().unwrap_or(0.0) };
                }
                for n in 1..phases.len() {
                    phases[n] = product(&phases[n - 1], &first);
                }
            }
        };
        self.phases.par_chunks_mut(total).enumerate().for_each(group);
    }

    /// Lists the waves up to the largest wave number.
    fn list(&mut self, plan: &Plan, constant: f64) {
        let unit = plan.sides.map(|side| 2.0 * PI / side);
        let most = plan.largest_wave_number;
        let highest = unit.map(|unit| (most / unit).floor());
        self.orders = highest.map(|n| n as usize + 1);
        self.rows.clear();
        self.pairs.clear();
        for x in 0..self.orders[0] {
            for (y, mirrored) in (0..self.orders[1]).flat_map(|y| [(y, false), (y, true)]) {
                let k = [x as f64 * unit[0], if mirrored { -(y as f64) } else { y as f64 } * unit[1]];
                let left = most * most - k[0] * k[0] - k[1] * k[1];
                if left < 0.0 || (mirrored && (x == 0 || y == 0)) {
                    continue; // beyond reach, or the opposite of another row
                }
                let count = ((left.sqrt() / unit[2]).floor() as usize + 1).min(self.orders[2]);
                self.rows.push(Row { x, y, mirrored, k, first: self.pairs.len(), count });
                for z in 0..count {
                    let k_z = z as f64 * unit[2];
                    let k_squared = k[0] * k[0] + k[1] * k[1] + k_z * k_z;
                    let weight =
                        4.0 * PI * constant * libm::exp(-k_squared / (4.0 * plan.alpha * plan.alpha)) / (plan.volume() * k_squared);
                    let up = if k_squared > 0.0 { weight } else { 0.0 };
                    let down = if z > 0 && (x > 0 || y > 0) { weight } else { 0.0 };
                    self.pairs.push(Pair { weight: [up, down], k_squared, amplitude: [0.0; 4] });
                }
            }
        }
    }

    /// Sums the charges' phases for every wave.
    pub(super) fn sum(&mut self, instructions: Instructions) {
        let (phases, orders) = (&self.phases, self.orders);
        let amplitudes = |row: &Row| instructions.run(Amplitudes { row, phases, orders });
        let amplitudes: Vec<Vec<[f64; 4]>> = self.rows.par_iter().map(amplitudes).collect();
        for (wave, amplitude) in self.pairs.iter_mut().zip(amplitudes.into_iter().flatten()) {
            wave.amplitude = amplitude;
        }
    }

    /// Adds the accelerations by all waves: `F_i = sum 2 w q_i K Im(conj(S) exp(i K.r_i))`.
    pub(super) fn push(&self, instructions: Instructions, mass: &[f64], acceleration: &mut [Vector<3>]) {
        let total: usize = self.orders.iter().sum();
        let unit = self.made_for.map_or(0.0, |(plan, _)| 2.0 * PI / plan.sides[2]);
        let group = |(number, acceleration): (usize, &mut [Vector<3>])| {
            let phases = &self.phases[number * total..(number + 1) * total];
            let force = instructions.run(Push { waves: self, phases, unit });
            for (lane, a) in acceleration.iter_mut().enumerate() {
                let inverse_mass = 1.0 / mass[number * LANES + lane];
                *a += Vector::from_fn(|k| force[k][lane] * inverse_mass);
            }
        };
        acceleration.par_chunks_mut(LANES).enumerate().for_each(group);
    }

    /// `sum w |S|^2`.
    pub(super) fn energy(&self) -> f64 {
        self.pairs.iter().map(Pair::energy).sum()
    }

    /// Adds `sum (delta_ab - 2 K_a K_b (1/K^2 + 1/4 alpha^2)) w |S|^2`.
    pub(super) fn add_virial_tensor(&self, alpha: f64, tensor: &mut Tensor<3>) {
        let unit = self.made_for.map_or(0.0, |(plan, _)| 2.0 * PI / plan.sides[2]);
        for row in &self.rows {
            for (n, wave) in self.pairs[row.first..row.first + row.count].iter().enumerate() {
                let k_z = n as f64 * unit;
                for (energy, k_z) in wave.energies().into_iter().zip([k_z, -k_z]).filter(|(energy, _)| *energy != 0.0) {
                    let k = Vector([row.k[0], row.k[1], k_z]);
                    let factor = -2.0 * (1.0 / wave.k_squared + 1.0 / (4.0 * alpha * alpha)) * energy;
                    add_product(tensor, k, k * factor);
                    for axis in 0..3 {
                        tensor[axis][axis] += energy;
                    }
                }
            }
        }
    }

    /// `sum (1 - K^2/2 alpha^2) w |S|^2`.
    pub(super) fn virial(&self, alpha: f64) -> f64 {
        self.pairs.iter().map(|wave| wave.energy() * (1.0 - wave.k_squared / (2.0 * alpha * alpha))).sum()
    }
}

impl Pair {
    fn energy(&self) -> f64 {
        self.energies().iter().sum()
    }

    /// Of the wave with `K_z` and of the one with `-K_z`.
    fn energies(&self) -> [f64; 2] {
        let [a, b, c, d] = self.amplitude;
        [self.weight[0] * (a * a + b * b), self.weight[1] * (c * c + d * d)]
    }
}

/// The product of two complex numbers, lane by lane.
#[inline(always)]
fn product(a: &Factor, b: &Factor) -> Factor {
    let mut product = [[0.0; LANES]; 2];
    for lane in 0..LANES {
        product[0][lane] = a[0][lane] * b[0][lane] - a[1][lane] * b[1][lane];
        product[1][lane] = a[0][lane] * b[1][lane] + a[1][lane] * b[0][lane];
    }
    product
}

/// `q exp(i (K_x x + K_y y))` of a group.
#[inline(always)]
fn across(row: &Row, phases: &[Factor], orders: [usize; 3]) -> Factor {
    let mut y = phases[orders[0] + row.y];
    let sign = if row.mirrored { -1.0 } else { 1.0 };
    for lane in 0..LANES {
        y[1][lane] *= sign;
    }
    product(&phases[row.x], &y)
}

/// `a exp(i K_z z)` and `a exp(-i K_z z)`.
#[inline(always)]
fn up_and_down(a: &Factor, z: &Factor) -> [Lanes; 4] {
    let mut both = [[0.0; LANES]; 4];
    for lane in 0..LANES {
        let (cc, ss) = (a[0][lane] * z[0][lane], a[1][lane] * z[1][lane]);
        let (cs, sc) = (a[0][lane] * z[1][lane], a[1][lane] * z[0][lane]);
        both[0][lane] = cc - ss;
        both[1][lane] = sc + cs;
        both[2][lane] = cc + ss;
        both[3][lane] = sc - cs;
    }
    both
}

/// The sums over all particles for one row.
struct Amplitudes<'a> {
    row: &'a Row,
    phases: &'a [Factor],
    orders: [usize; 3],
}

impl Kernel for Amplitudes<'_> {
    type Output = Vec<[f64; 4]>;

    #[inline(always)]
    fn run(self) -> Vec<[f64; 4]> {
        let Self { row, phases, orders } = self;
        let mut sums = vec![[[0.0; LANES]; 4]; row.count];
        for phases in phases.chunks_exact(orders.iter().sum()) {
            let a = across(row, phases, orders);
            for (sums, z) in sums.iter_mut().zip(&phases[orders[0] + orders[1]..]) {
                let both = up_and_down(&a, z);
                for part in 0..4 {
                    for lane in 0..LANES {
                        sums[part][lane] += both[part][lane];
                    }
                }
            }
        }
        sums.iter().map(|sums| sums.map(|lanes| lanes.iter().sum())).collect()
    }
}

/// The force of all waves on one group of particles.
struct Push<'a> {
    waves: &'a Waves,
    phases: &'a [Factor],
    /// `2 pi/L_z`.
    unit: f64,
}

impl Kernel for Push<'_> {
    type Output = [Lanes; 3];

    #[inline(always)]
    fn run(self) -> [Lanes; 3] {
        let Self { waves, phases, unit } = self;
        let orders = waves.orders;
        let mut force = [[0.0; LANES]; 3];
        for row in &waves.rows {
            let a = across(row, phases, orders);
            let (mut along, mut up) = ([0.0; LANES], [0.0; LANES]);
            let z = &phases[orders[0] + orders[1]..];
            for (n, (wave, z)) in waves.pairs[row.first..row.first + row.count].iter().zip(z).enumerate() {
                let both = up_and_down(&a, z);
                let [c, s, c_down, s_down] = wave.amplitude;
                let (w, w_down) = (2.0 * wave.weight[0], 2.0 * wave.weight[1]);
                let k_z = n as f64 * unit;
                for lane in 0..LANES {
                    let t = w * (c * both[1][lane] - s * both[0][lane]);
                    let t_down = w_down * (c_down * both[3][lane] - s_down * both[2][lane]);
                    along[lane] += t + t_down;
                    up[lane] += k_z * (t - t_down);
                }
            }
            for lane in 0..LANES {
                force[0][lane] += row.k[0] * along[lane];
                force[1][lane] += row.k[1] * along[lane];
                force[2][lane] += up[lane];
            }
        }
        force
    }
}
