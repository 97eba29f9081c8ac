//! What theory says of the chain, with the engine's own error in time: a chain advanced by velocity Verlet obeys
//! `sin(omega dt/2)^2 = (omega_0 dt)^2 sin(k a/2)^2`, `omega_0 = sqrt(kappa/m)`, exactly. So a measured frequency is held
//! against what it must be to the last digits, not against an approximation.

use std::f64::consts::{PI, TAU};

use corpuscle_time::Signal;

use super::chain::{Design, End, Ends};

/// The modes of a uniform chain.
#[derive(Clone, Copy, Debug)]
pub(super) struct Modes {
    count: usize,
    /// Phase advance `k a` from one mass to the next of mode 1.
    step: f64,
    /// Place of mass 0 in spacings.
    first: f64,
    cosine: bool,
    ring: bool,
}

impl Modes {
    /// The modes of a chain; none when the two ends differ.
    pub(super) fn of(design: &Design) -> Option<Self> {
        let count = design.count();
        let n = count as f64;
        let (step, first, cosine, ring) = match design.ends {
            Ends::Ring => (TAU / n, 0.5, true, true),
            Ends::Between(End::Free, End::Free) => (PI / n, 0.5, true, false),
            Ends::Between(End::Fixed, End::Fixed) => (PI / (n + 1.0), 1.0, false, false),
            Ends::Between(..) => return None,
        };
        Some(Self { count, step, first, cosine, ring })
    }

    /// Number of the highest mode: `N` with fixed ends, `N - 1` with free ones, on a ring the largest below `N/2`.
    pub(super) fn highest(&self) -> usize {
        if self.ring { (self.count - 1) / 2 } else { self.count - usize::from(self.cosine) }
    }

    /// Phase advance `k a` of mode `j`.
    pub(super) fn phase(&self, j: usize) -> f64 {
        j as f64 * self.step
    }

    /// Shape of mode `j` at each mass, largest value 1 but for its sampling.
    pub(super) fn shape(&self, j: usize) -> Vec<f64> {
        let phase = |n: usize| self.phase(j) * (n as f64 + self.first);
        (0..self.count).map(|n| if self.cosine { libm::cos(phase(n)) } else { libm::sin(phase(n)) }).collect()
    }

    /// All shapes, orthogonal to each other, with the phase advance of each: on a ring sines beside the cosines.
    pub(super) fn basis(&self) -> Vec<(f64, Vec<f64>)> {
        let lowest = usize::from(!self.cosine);
        let mut basis: Vec<_> = (lowest..=self.highest()).map(|j| (self.phase(j), self.shape(j))).collect();
        if self.ring {
            let sines = (1..=self.highest()).map(|j| {
                let shape = (0..self.count).map(|n| libm::sin(self.phase(j) * (n as f64 + self.first))).collect();
                (self.phase(j), shape)
            });
            basis.extend(sines);
            if self.count.is_multiple_of(2) {
                basis.push((PI, (0..self.count).map(|n| if n.is_multiple_of(2) { 1.0 } else { -1.0 }).collect()));
            }
        }
        basis
    }
}

/// Dispersion relation `omega = 2 omega_0 |sin(theta / 2)|`, `theta = k a`.
pub(super) fn dispersion(omega_0: f64, theta: f64) -> f64 {
    2.0 * omega_0 * libm::sin(0.5 * theta).abs()
}

/// The frequency `omega'` at which velocity Verlet runs an oscillator of frequency `omega`:
/// `sin(omega' dt/2) = omega dt/2`. Not a number beyond the limit of stability `omega dt = 2`.
pub(super) fn verlet_frequency(omega: f64, dt: f64) -> f64 {
    2.0 * libm::asin(0.5 * omega * dt) / dt
}

/// Phase advance `theta = k a` of a wave that velocity Verlet shakes at `omega`; not a number above the cutoff.
pub(super) fn verlet_phase(omega: f64, omega_0: f64, dt: f64) -> f64 {
    2.0 * libm::asin(libm::sin(0.5 * omega * dt) / (omega_0 * dt))
}

/// A projection on an orthogonal shape: `sum u s / sum s^2`.
pub(super) fn project(values: &[f64], shape: &[f64]) -> f64 {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    dot(values, shape) / dot(shape, shape)
}

/// A worst case for rounding: after `steps` steps each mass may be off by `8 eps X sqrt(N) omega_0 / omega` a step, `X` the
/// largest coordinate and `omega` the lowest frequency that matters.
///
/// A step rounds each position by `eps X` and each velocity by `omega_0 eps X` at most, a few times; a linear chain
/// keeps the energy of a disturbance, which is then at most `2 kappa N (eps X)^2` a step, and moves no mass further than
/// the softest mode would with all of it.
pub(super) fn rounding(steps: u64, largest: f64, count: usize, ratio: f64) -> f64 {
    8.0 * steps as f64 * f64::EPSILON * largest * (count as f64).sqrt() * ratio.max(1.0)
}

/// Amplitudes of a wave reflected and transmitted where the mass a spacing changes by `density_ratio`:
/// `(Z_1 - Z_2)/(Z_1 + Z_2)` and `2 Z_1/(Z_1 + Z_2)` with the impedances `Z = sqrt(T mu)`.
pub(super) fn step_amplitudes(density_ratio: f64) -> (f64, f64) {
    let root = density_ratio.sqrt();
    ((1.0 - root) / (1.0 + root), 2.0 / (1.0 + root))
}

/// The same on the lattice, from the phase advances on either side (match both laws of motion at the two masses next to
/// the step): `sin((theta_1 - theta_2)/2) / sin((theta_1 + theta_2)/2)` and `sin(theta_1) / sin((theta_1 + theta_2)/2)`,
/// for waves that turn half-way between these masses.
pub(super) fn lattice_step_amplitudes(theta_1: f64, theta_2: f64) -> (f64, f64) {
    let sum = libm::sin(0.5 * (theta_1 + theta_2));
    if sum == 0.0 {
        let (a, b) = if theta_1 == 0.0 { (1.0, 1.0) } else { (theta_1, theta_2) };
        return ((a - b) / (a + b), 2.0 * a / (a + b));
    }
    (libm::sin(0.5 * (theta_1 - theta_2)) / sum, libm::sin(theta_1) / sum)
}

/// A wave on the continuous string that runs one way through one of its parts:
/// `u(x, t) = amplitude s(t - delay - |x - from| / c)`.
#[derive(Clone, Copy, Debug)]
struct Ray {
    amplitude: f64,
    part: usize,
    forward: bool,
    from: f64,
    delay: f64,
}

/// D'Alembert's solution for a string of one or two densities: every wave, with all its echoes, as rays.
#[derive(Clone, Debug)]
pub(super) struct Dalembert {
    signal: Signal,
    parts: Vec<(f64, f64, f64)>,
    rays: Vec<Ray>,
}

impl Dalembert {
    /// More echoes than this are not followed.
    const MOST: usize = 20_000;

    /// The waves until `end` that `signal` sends rightwards from `x`, on parts `(from, to, c)` in a row.
    ///
    /// None when there are too many echoes to follow.
    pub(super) fn new(parts: Vec<(f64, f64, f64)>, ends: Ends, signal: Signal, x: f64, end: f64) -> Option<Self> {
        let mut rays = vec![Ray { amplitude: 1.0, part: 0, forward: true, from: x, delay: 0.0 }];
        let mut next = 0;
        while next < rays.len() {
            if rays.len() > Self::MOST {
                return None;
            }
            let ray = rays[next];
            next += 1;
            let (lower, upper, c) = parts[ray.part];
            let face = if ray.forward { upper } else { lower };
            let delay = ray.delay + (face - ray.from).abs() / c;
            if delay > end + Self::lead(signal) || ray.amplitude.abs() < 1e-5 {
                continue;
            }
            let last = if ray.forward { parts.len() - 1 } else { 0 };
            let beyond = match ends {
                Ends::Between(left, right) if ray.part == last => {
                    let end = if ray.forward { right } else { left };
                    let sign = if end == End::Free { 1.0 } else { -1.0 };
                    rays.push(Ray { amplitude: sign * ray.amplitude, forward: !ray.forward, from: face, delay, ..ray });
                    continue;
                }
                _ => (ray.part + if ray.forward { 1 } else { parts.len() - 1 }) % parts.len(),
            };
            let ratio = (c / parts[beyond].2) * (c / parts[beyond].2);
            let (reflected, transmitted) = step_amplitudes(ratio);
            let from = if ray.forward { parts[beyond].0 } else { parts[beyond].1 };
            rays.push(Ray { amplitude: transmitted * ray.amplitude, part: beyond, from, delay, ..ray });
            if reflected != 0.0 {
                rays.push(Ray { amplitude: reflected * ray.amplitude, forward: !ray.forward, from: face, delay, ..ray });
            }
        }
        Some(Self { signal, parts, rays })
    }

    /// How long before its nominal time a signal is felt.
    fn lead(signal: Signal) -> f64 {
        match signal {
            Signal::Pulse { width, .. } => 7.0 * width,
            Signal::Sine { .. } => 0.0,
        }
    }

    /// Displacement of the string at `x`.
    pub(super) fn at(&self, x: f64, t: f64) -> f64 {
        let part = self.parts.iter().position(|&(_, upper, _)| x <= upper).unwrap_or(self.parts.len() - 1);
        let c = self.parts[part].2;
        let here = self.rays.iter().filter(|ray| ray.part == part);
        here.map(|ray| {
            let forward = if ray.forward { 1.0 } else { -1.0 };
            let since = t - ray.delay - forward * (x - ray.from) / c;
            // A sine starts at time zero; a pulse has been under way for ever.
            if since < 0.0 && matches!(self.signal, Signal::Sine { .. }) { 0.0 } else { ray.amplitude * self.signal.at(since).0 }
        })
        .sum()
    }
}
