//! The wave experiment's checks. Nothing is random: each bound is derived, from the lattice, the step, or rounding.

use std::f64::consts::TAU;

use corpuscle_observe::Check;
use corpuscle_time::Integrator;

use super::chain::Polarisation;
use super::trials::Finding;
use super::{Start, Wave, theory};

impl Wave {
    pub(super) fn verdicts(&self) -> Vec<Check> {
        let mut checks = self.mode_checks();
        checks.extend(self.speed_checks());
        checks.extend(self.step_checks());
        checks.extend(self.stability_checks());
        checks.extend(self.conservation_checks());
        checks
    }

    fn mode_checks(&self) -> Vec<Check> {
        let modes = self.findings().filter_map(|finding| match finding {
            Finding::Modes { tones, bound } => Some((tones, *bound)),
            _ => None,
        });
        let names = [
            ("fixed ends", "omega_j = 2 sqrt(kappa/m) sin(j pi/(2(N+1)))"),
            ("free ends", "omega_j = 2 sqrt(kappa/m) sin(j pi/(2N))"),
            ("a ring", "omega_j = 2 sqrt(kappa/m) sin(j pi/N)"),
        ];
        let check = |((tones, bound), (ends, formula)): ((&Vec<super::trials::Tone>, f64), (&str, &str))| {
            let worst = tones.iter().map(|tone| (tone.measured / tone.verlet - 1.0).abs()).fold(0.0, f64::max);
            Check::at_most(
                format!("relative deviation of the {} mode frequencies with {ends}, largest", tones.len()),
                worst,
                bound,
                format!(
                    "{formula}, shifted by velocity Verlet to sin(omega' dt/2) = omega dt/2 (up to {:.1e} of omega here); \
                     bound: worst case of rounding in the motion and in the fit of a sine",
                    tones.iter().map(|tone| tone.verlet / tone.chain - 1.0).fold(0.0, f64::max)
                ),
            )
        };
        modes.zip(names).map(check).collect()
    }

    fn speed_checks(&self) -> Vec<Check> {
        let mut checks = vec![];
        let c = self.material.speed();
        let mut pulse = None;
        for (finding, (name, sign)) in self
            .findings()
            .filter(|finding| matches!(finding, Finding::Echo { .. }))
            .zip([("fixed end inverts a pulse: its echo + 1", -1.0), ("free end does not invert a pulse: its echo - 1", 1.0)])
        {
            let &Finding::Echo { amplitude, bound, speed, speed_bound } = finding else { continue };
            if pulse.is_none() {
                pulse = Some((speed, speed_bound));
                checks.push(Check::at_most(
                    "relative deviation of a pulse's speed (there and back) from a sqrt(kappa/m)",
                    (speed / c - 1.0).abs(),
                    speed_bound,
                    "the centre of a pulse travels at the long-wave speed d omega/dk at k = 0 whatever its dispersion; \
                     bound: worst case of rounding in the two times of arrival",
                ));
            }
            checks.push(Check::at_most(
                format!("{name}, magnitude"),
                (amplitude - sign).abs(),
                bound,
                "amplitude of the echo in units of the pulse sent, by projection on the pulse; bound: the lattice's dispersion \
                 averaged over the pulse's spectrum",
            ));
        }
        let travel = self.findings().find_map(|finding| match finding {
            Finding::Travel { frequency, wavelength } => Some((*frequency, *wavelength)),
            _ => None,
        });
        if let (Some((frequency, wavelength)), Some((speed, speed_bound))) = (travel, pulse) {
            let phase = TAU * self.material.spacing / wavelength;
            checks.push(Check::at_most(
                "relative difference of f lambda of a running wave from the pulse's speed",
                (frequency * wavelength / speed - 1.0).abs(),
                phase * phase / 24.0 + speed_bound,
                format!(
                    "c = f lambda; bound: sin(ka/2)/(ka/2) >= 1 - (ka)^2/24 at lambda = {:.1} spacings",
                    wavelength / self.material.spacing
                ),
            ));
        }
        checks
    }

    /// The run's own density step in full, all others by their worst.
    fn step_checks(&self) -> Vec<Check> {
        let (mut checks, mut worst) = (vec![], None::<f64>);
        for finding in self.findings() {
            let &Finding::Step { ratio, reflected, transmitted, bounds } = finding else { continue };
            let (r, t) = theory::step_amplitudes(ratio);
            let (off_r, off_t) = ((reflected - r).abs(), (transmitted - t).abs());
            worst = Some(worst.unwrap_or(0.0).max(off_r / bounds.0).max(off_t / bounds.1));
            if ratio != self.ratio {
                continue;
            }
            let because = "Z = sqrt(T mu); bound: lattice and dispersion averaged over the pulse's spectrum, of order (k a)^2";
            checks.push(Check::at_most(
                format!("reflected amplitude {reflected:.5} at a density step of {ratio}: deviation from {r:.5}"),
                off_r,
                bounds.0,
                format!("(Z_1 - Z_2)/(Z_1 + Z_2), {because}"),
            ));
            checks.push(Check::at_most(
                format!("transmitted amplitude {transmitted:.5} at a density step of {ratio}: deviation from {t:.5}"),
                off_t,
                bounds.1,
                format!("2 Z_1/(Z_1 + Z_2), {because}"),
            ));
            let root = ratio.sqrt();
            let square = |x: f64, e: f64| 2.0 * x.abs() * e + e * e;
            checks.push(Check::at_most(
                "reflected and transmitted energy over the incident: deviation of the sum from 1",
                (reflected * reflected + root * transmitted * transmitted - 1.0).abs(),
                square(r, bounds.0) + root * square(t, bounds.1),
                "R^2 + (Z_2/Z_1) T^2 = 1, with the bounds of R and T",
            ));
        }
        if let Some(worst) = worst {
            checks.push(Check::at_most(
                "reflection and transmission at all density steps: largest deviation over its bound",
                worst,
                1.0,
                "(Z_1 - Z_2)/(Z_1 + Z_2) and 2 Z_1/(Z_1 + Z_2), each with its own bound of order (k a)^2",
            ));
        }
        checks
    }

    fn stability_checks(&self) -> Vec<Check> {
        let check = |finding: &Finding| {
            let &Finding::Growth { number, largest, rate, steps } = finding else { return None };
            let roundings = 16.0 * steps as f64 * f64::EPSILON;
            Some(if number < 2.0 {
                Check::at_most(
                    format!("velocity Verlet at omega dt = {number}: largest amplitude over the first"),
                    largest,
                    // The velocity amplifies what rounding adds to the position by 1/sqrt(1 - (omega dt)^2/4) at most.
                    1.0 + roundings / (1.0 - 0.25 * number * number).sqrt(),
                    "stable for omega dt < 2: a motion from rest never exceeds its start; bound: rounding",
                )
            } else {
                let theory = 2.0 * libm::acosh(0.5 * number);
                Check::at_most(
                    format!("velocity Verlet at omega dt = {number}: relative deviation of the growth rate {rate:.6} a step"),
                    (rate / theory - 1.0).abs(),
                    roundings / (theory * theory),
                    "unstable for omega dt > 2: grows by 2 arcosh(omega dt/2) a step; bound: rounding, amplified like the motion",
                )
            })
        };
        self.findings().filter_map(check).collect()
    }

    fn conservation_checks(&self) -> Vec<Check> {
        let mut checks = vec![];
        let design = self.chain.design();
        let (Some(first), false) = (self.samples.first(), matches!(self.start, Start::Drive { .. })) else { return checks };
        if self.samples.len() < 2 {
            return checks;
        }
        let energy = first.kinetic + first.elastic;
        let z = design.highest_frequency() * self.material.time_step;
        let steps = self.chain.steps();
        let off = |value: &dyn Fn(&super::Sample) -> f64| {
            let distances = self.samples.iter().map(|sample| (value(sample) / value(first) - 1.0).abs());
            distances.fold(0.0, |most: f64, d| if d.is_nan() { f64::INFINITY } else { most.max(d) })
        };
        let reach = match design.polarisation {
            Polarisation::Transverse => self.largest,
            Polarisation::Longitudinal => design.length() + self.largest,
        };
        // Rounding moves each mass by a few eps X a step; Cauchy and Schwarz turn that into energy.
        let stretch = (2.0 * design.stiffness * design.count() as f64 / energy).sqrt();
        let rounding = steps as f64 * f64::EPSILON * (4.0 + 8.0 * reach * stretch);
        let (bound, why) = match design.integrator {
            Integrator::SymplecticEuler { .. } => (z / (1.0 - 0.5 * z).max(0.0), "2 (z/2)/(1 - z/2) from E - dt F.v/2"),
            Integrator::RungeKutta4 { .. } => {
                let loss = z.powi(6) / 72.0 - z.powi(8) / 576.0;
                (steps as f64 * loss.abs(), "z^6/72 a step, which each mode loses at most")
            }
            _ => (
                0.25 * z * z / (1.0 - 0.25 * z * z),
                "(z/2)^2/(1 - (z/2)^2), all that velocity Verlet may exchange with its shadow energy",
            ),
        };
        checks.push(Check::at_most(
            "energy: largest relative deviation from the start",
            off(&|sample| sample.kinetic + sample.elastic),
            bound + rounding,
            format!("conserved; bound: {why}, z = {z:.3} the highest frequency times the step"),
        ));
        if matches!(design.integrator, Integrator::VelocityVerlet { .. }) {
            checks.push(Check::at_most(
                "shadow energy E - dt^2/8 sum F^2/m: largest relative deviation",
                off(&|sample| sample.shadow),
                rounding / (1.0 - 0.25 * z * z),
                "velocity Verlet conserves it exactly on a linear chain; bound: worst case of rounding",
            ));
        }
        if let Some(deviation) = self.deviation {
            let ratio = (design.count() as f64).max(self.chain.time() * self.material.omega_0());
            checks.push(Check::at_most(
                "displacements: largest deviation from the sum of normal modes, over the amplitude",
                deviation / self.amplitude,
                theory::rounding(steps, reach / self.amplitude, design.count(), ratio),
                "each mode at its own frequency, with velocity Verlet's shift; bound: worst case of rounding",
            ));
        }
        checks
    }
}
