//! What the trials' records say, with bounds of their errors.

use std::f64::consts::TAU;

use super::super::chain::End;
use super::super::sine;
use super::super::theory::{self, Modes};
use super::{CLEAR, Finding, MODE_MASSES, Probe, Purpose, Tone, Trial};

impl Trial {
    /// Worst case of rounding over the amplitude of a trial with this number of soft modes.
    fn rounding(&self, amplitude: f64) -> f64 {
        let design = self.chain.design();
        let (rounded, count) = (self.material.rounded(design, amplitude), design.count());
        theory::rounding(self.steps, rounded, count, count as f64)
    }

    pub(super) fn evaluate(&self) -> Option<Finding> {
        match self.purpose {
            Purpose::Modes => self.tones(),
            Purpose::Echo { end } => self.evaluate_echo(end),
            Purpose::Step { ratio } => Some(self.evaluate_step(ratio)),
            Purpose::Travel => {
                let frequency = sine::angular_frequency(&self.series[0], self.dt)? / TAU;
                let wavenumber = sine::angular_frequency(&self.chain.displacements(), self.material.spacing)?;
                Some(Finding::Travel { frequency, wavelength: TAU / wavenumber })
            }
            Purpose::Growth { number } => {
                let series = &self.series[0];
                let largest = series.iter().fold(0.0, |most: f64, q| most.max(q.abs()));
                // From rest, Q_n / Q_0 = cosh(rate n) beyond the limit.
                let last = (series[series.len() - 1] / series[0]).abs();
                let rate = libm::acosh(last.max(1.0)) / self.steps as f64;
                Some(Finding::Growth { number, largest: largest / series[0].abs(), rate, steps: self.steps })
            }
        }
    }

    fn tones(&self) -> Option<Finding> {
        let modes = Modes::of(self.chain.design())?;
        let omega_0 = self.material.omega_0();
        let tone = |(index, series): (usize, &Vec<f64>)| {
            let phase = modes.phase(index + 1);
            let chain = theory::dispersion(omega_0, phase);
            let verlet = theory::verlet_frequency(chain, self.dt);
            Some(Tone { number: index + 1, phase, measured: sine::angular_frequency(series, self.dt)?, chain, verlet })
        };
        let tones: Vec<Tone> = self.series.iter().enumerate().map(tone).collect::<Option<_>>()?;
        // An error of at most e in a sine of amplitude A shifts the frequency fitted over T by at most 6 e / (A T).
        let amplitude = self.material.amplitude() / MODE_MASSES as f64;
        let radians = tones[0].verlet * self.steps as f64 * self.dt;
        Some(Finding::Modes { bound: 6.0 * self.rounding(amplitude) / radians, tones })
    }

    /// Amplitude of the pulse, over the one sent, in a window of `CLEAR` deviations about the time it is due `after` it was
    /// sent, and the centre of what is there.
    fn receive(&self, sensor: usize, after: f64) -> (f64, f64) {
        let due = CLEAR * self.sigma + after;
        let (mut overlap, mut square, mut sum, mut moment) = (0.0, 0.0, 0.0, 0.0);
        for (i, &y) in self.series[sensor].iter().enumerate() {
            let t = i as f64 * self.dt - due;
            if t.abs() <= CLEAR * self.sigma {
                let u = t / self.sigma;
                let g = libm::exp(-0.5 * u * u);
                overlap += y * g;
                square += g * g;
                sum += y;
                moment += y * t;
            }
        }
        (overlap / (square * self.material.amplitude()), after + moment / sum)
    }

    /// Bound of the error of a received amplitude: dispersion and the lattice act on each frequency of the pulse by a known
    /// factor `f(omega)` and phase, and the projection averages `f cos(phase)` over the pulse's spectrum.
    fn spread(&self, expected: f64, response: impl Fn(f64) -> (f64, f64)) -> f64 {
        const PARTS: i32 = 1000;
        let (mut sum, mut weights) = (0.0, 0.0);
        for part in 0..=PARTS {
            let u = 7.0 * f64::from(part) / f64::from(PARTS);
            let weight = libm::exp(-u * u) * if part == 0 { 0.5 } else { 1.0 };
            let (factor, phase) = response(u / self.sigma);
            weights += weight;
            sum += weight * (factor * libm::cos(phase) - expected).abs();
        }
        sum / weights + self.rounding(self.material.amplitude())
    }

    fn evaluate_echo(&self, end: End) -> Option<Finding> {
        let Probe::Place(sensor) = self.probes[0] else { return None };
        let (design, omega_0, c) = (self.chain.design(), self.material.omega_0(), self.material.speed());
        let (out, back) = (design.place(sensor), 2.0 * (design.length() - design.place(sensor)));
        let (_, first) = self.receive(0, out / c);
        let (amplitude, second) = self.receive(0, (out + back) / c);
        let sign = if end == End::Free { 1.0 } else { -1.0 };
        let bound = self.spread(sign, |omega| {
            let lag = theory::verlet_phase(omega, omega_0, self.dt) / self.material.spacing - omega / c;
            (sign, lag * (out + back))
        });
        // Centres of two windows of half-width W deviations: 2 W^2 / sqrt(2 pi) deviations times the error of a value.
        let rounding = self.rounding(self.material.amplitude());
        let speed_bound = 2.0 * CLEAR * CLEAR / TAU.sqrt() * self.sigma * rounding / (second - first);
        Some(Finding::Echo { amplitude, bound, speed: back / (second - first), speed_bound })
    }

    fn evaluate_step(&self, ratio: f64) -> Finding {
        let (design, omega_0, a) = (self.chain.design(), self.material.omega_0(), self.material.spacing);
        let place = |probe: &Probe| if let Probe::Place(n) = probe { design.place(*n) } else { f64::NAN };
        let (sensor, behind) = (place(&self.probes[0]), place(&self.probes[1]));
        let light = design.masses.iter().position(|&m| m != design.masses[0]).unwrap_or(design.count());
        let step = design.place(0) + (light as f64 - 0.5) * a;
        let (c_1, c_2) = (self.material.speed(), self.material.speed() / ratio.sqrt());
        let phases = |omega: f64| {
            let of = |omega_0| theory::verlet_phase(omega, omega_0, self.dt);
            (of(omega_0), of(omega_0 / ratio.sqrt()))
        };
        let (r, t) = theory::step_amplitudes(ratio);
        let back = 2.0 * step - sensor;
        let (reflected, _) = self.receive(0, back / c_1);
        let bound_r = self.spread(r, |omega| {
            let (one, two) = phases(omega);
            (theory::lattice_step_amplitudes(one, two).0, (one / a - omega / c_1) * back)
        });
        let on = behind - step;
        let (transmitted, _) = self.receive(1, step / c_1 + on / c_2);
        let bound_t = self.spread(t, |omega| {
            let (one, two) = phases(omega);
            let lag = (one / a - omega / c_1) * step + (two / a - omega / c_2) * on;
            (theory::lattice_step_amplitudes(one, two).1, lag)
        });
        Finding::Step { ratio, reflected, transmitted, bounds: (bound_r, bound_t) }
    }
}
