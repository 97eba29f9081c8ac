//! Normal modes of a chain of equal masses and springs.

use std::f64::consts::PI;

/// What holds the ends of a chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// A further spring to a fixed point at either end: `omega_j = 2 sqrt(kappa/m) sin(j pi/(2 (N + 1)))`, `j = 1..N`.
    Fixed,
    /// Nothing: `omega_j = 2 sqrt(kappa/m) sin(j pi/(2 N))`, `j = 0..N-1`; mode 0 is the motion of the whole.
    Free,
    /// The last is joined to the first: `omega_j = 2 sqrt(kappa/m) sin(j pi/N)`, `j = 0..N-1`; `j` and `N - j` are the
    /// cosine and the sine of the same wave number.
    Periodic,
}

/// The orthonormal shapes of the modes of a chain, and their frequencies.
#[derive(Clone, Debug, PartialEq)]
pub struct NormalModes {
    shapes: Vec<Vec<f64>>,
    frequencies: Vec<f64>,
    mass: f64,
}

impl NormalModes {
    /// The modes of `masses` masses; memory grows with the square of their number.
    pub fn new(masses: usize, ends: Ends, stiffness: f64, mass: f64) -> Self {
        let n = masses as f64;
        let cut_off = 2.0 * (stiffness / mass).sqrt();
        let shape = |row: usize| -> (f64, Vec<f64>) {
            let (j, half) = (row as f64, 0.5 * PI);
            let along = |f: &dyn Fn(f64) -> f64| (0..masses).map(|i| f(i as f64)).collect();
            match ends {
                Ends::Fixed => {
                    let k = PI * (j + 1.0) / (n + 1.0);
                    let norm = (2.0 / (n + 1.0)).sqrt();
                    (libm::sin(0.5 * k), along(&|i| norm * libm::sin(k * (i + 1.0))))
                }
                Ends::Free => {
                    let norm = (if row == 0 { 1.0 } else { 2.0 } / n).sqrt();
                    (libm::sin(half * j / n), along(&|i| norm * libm::cos(PI * j / n * (i + 0.5))))
                }
                Ends::Periodic => {
                    let alone = row == 0 || 2 * row == masses;
                    let norm = (if alone { 1.0 } else { 2.0 } / n).sqrt();
                    let k = 2.0 * PI * j / n;
                    let wave = |i: f64| if 2 * row <= masses { libm::cos(k * i) } else { -libm::sin(k * i) };
                    (libm::sin(0.5 * k), along(&|i| norm * wave(i)))
                }
            }
        };
        let (sines, shapes): (Vec<f64>, _) = (0..masses).map(shape).unzip();
        Self { shapes, frequencies: sines.iter().map(|sine| cut_off * sine.abs()).collect(), mass }
    }

    /// Angular frequencies, in the order of the mode numbers of [`Ends`]: with fixed ends, index 0 is mode 1.
    pub fn frequencies(&self) -> &[f64] {
        &self.frequencies
    }

    /// Shape of a mode, of unit length.
    pub fn shape(&self, mode: usize) -> &[f64] {
        &self.shapes[mode]
    }

    /// Amplitude `Q_j = sum_i u_i phi_ij` of one mode; of velocities it gives the amplitude's rate.
    pub fn amplitude(&self, mode: usize, displacements: &[f64]) -> f64 {
        self.shapes[mode].iter().zip(displacements).map(|(phi, u)| phi * u).sum()
    }

    /// Energy of each mode, `m (Q'^2 + omega^2 Q^2)/2`: in a harmonic chain each is conserved, and they sum to the whole.
    pub fn energies(&self, displacements: &[f64], velocities: &[f64]) -> Vec<f64> {
        let energy = |j: usize| {
            let (q, rate) = (self.frequencies[j] * self.amplitude(j, displacements), self.amplitude(j, velocities));
            0.5 * self.mass * (rate * rate + q * q)
        };
        (0..self.shapes.len()).map(energy).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corpuscle_core::Random;

    const KAPPA: f64 = 2.5;
    const MASS: f64 = 0.8;

    /// Force on each mass, straight from the springs.
    fn forces(u: &[f64], ends: Ends) -> Vec<f64> {
        let n = u.len();
        let neighbour = |i: usize, step: isize| match (i.checked_add_signed(step).filter(|&k| k < n), ends) {
            (Some(k), _) => u[k],
            (None, Ends::Fixed) => 0.0,
            (None, Ends::Free) => u[i],
            (None, Ends::Periodic) => u[(i + n).checked_add_signed(step).unwrap() % n],
        };
        (0..n).map(|i| KAPPA * (neighbour(i, -1) + neighbour(i, 1) - 2.0 * u[i])).collect()
    }

    #[test]
    fn shapes_are_orthonormal_and_swing_at_their_frequencies() {
        for ends in [Ends::Fixed, Ends::Free, Ends::Periodic] {
            for n in [7, 8] {
                let modes = NormalModes::new(n, ends, KAPPA, MASS);
                for j in 0..n {
                    let omega = modes.frequencies()[j];
                    for (force, u) in forces(modes.shape(j), ends).iter().zip(modes.shape(j)) {
                        assert!((force + MASS * omega * omega * u).abs() < 1e-13, "{ends:?} {n} {j}");
                    }
                    for l in 0..n {
                        let product = modes.amplitude(j, modes.shape(l));
                        assert!((product - f64::from(u8::from(j == l))).abs() < 1e-13, "{ends:?} {n} {j} {l}");
                    }
                }
            }
        }
    }

    #[test]
    fn mode_energies_add_to_the_whole() {
        let mut random = Random::new(1, 80);
        for ends in [Ends::Fixed, Ends::Free, Ends::Periodic] {
            let u: Vec<f64> = (0..9).map(|_| random.normal()).collect();
            let v: Vec<f64> = (0..9).map(|_| random.normal()).collect();
            // For linear forces the potential energy is -u.F/2.
            let potential: f64 = -0.5 * u.iter().zip(forces(&u, ends)).map(|(u, f)| u * f).sum::<f64>();
            let whole = potential + 0.5 * MASS * v.iter().map(|v| v * v).sum::<f64>();
            let sum: f64 = NormalModes::new(9, ends, KAPPA, MASS).energies(&u, &v).iter().sum();
            assert!((sum / whole - 1.0).abs() < 1e-13);
        }
    }
}
