//! Solitons on Toda's chain, beside the exact solution.
//!
//! `exp(-b r_n) = tau_{n+1} tau_{n-1}/tau_n^2` for the extension `r_n` of the spring after mass `n`, with
//! `tau_n = sum over subsets of prod exp(2 theta_i) prod A_ij`, `theta_i = kappa_i (n - x_i) - omega_0 sinh(kappa_i) t` and
//! `A_ij = (sinh((kappa_i - kappa_j)/2)/sinh((kappa_i + kappa_j)/2))^2` (Toda 1967, doi:10.1143/JPSJ.22.431; Hirota 1973,
//! doi:10.1143/JPSJ.35.286). A soliton runs at `sinh(kappa)/kappa` times the speed of long waves. One that overtakes another is
//! thrown forward by `-ln(A)/(2 kappa)` spacings, the other one back.

use corpuscle_checkpoint::resume;
use corpuscle_core::Invalid;
use corpuscle_observe::chart::Axis;
use corpuscle_observe::{Chart, Check, Series, Style};

use super::{Material, Row};
use crate::{Settings, Table};

/// Steepness of the springs times the spacing: the highest solitons allowed press a spring to half its length.
const STEEPNESS: f64 = 4.0;
/// From the wall to the first soliton, in its widths `1/kappa`; and between solitons.
const CLEAR: f64 = 9.0;

/// The solitons, and how far the chain has been from them.
pub(super) struct Solitons {
    material: Material,
    /// `kappa a` and place at the start in spacings, the fastest first.
    each: Vec<(f64, f64)>,
    /// Largest deviation of a displacement from the exact one, in `1/b`, with the step and with twice the step.
    deviation: [f64; 2],
    /// Time, and where the peaks are, in spacings.
    peaks: Vec<(f64, Vec<f64>)>,
    /// Time of the last sample and where the fastest one is, with the step and with twice the step.
    fastest: [Option<(f64, f64)>; 2],
}

resume!(Solitons { values: [deviation, peaks, fastest], set_up: [material, each] });

impl Solitons {
    pub(super) fn new(settings: &Settings, material: Material) -> Result<Self, Invalid> {
        let mut widths = settings.list("solitons").to_vec();
        widths.sort_by(|a, b| b.total_cmp(a));
        if widths.is_empty() || widths.windows(2).any(|pair| pair[0] - pair[1] < 0.05) {
            return Err(settings.invalid("solitons", "one to three numbers that differ by 0.05 or more"));
        }
        let mut place = CLEAR / widths[0];
        let mut each = vec![];
        for (number, &kappa) in widths.iter().enumerate() {
            if number > 0 {
                place += CLEAR / 2.0 * (1.0 / widths[number - 1] + 1.0 / kappa);
            }
            each.push((kappa, place));
        }
        let this = Self { material, each, deviation: [0.0; 2], peaks: vec![], fastest: [None; 2] };
        if this.chase() > this.room() {
            return Err(settings.invalid("masses", "more of them: the solitons have no room to overtake each other"));
        }
        Ok(this)
    }

    /// Spacings that the one in front can run before it comes near the wall.
    fn room(&self) -> f64 {
        self.each
            .iter()
            .map(|&(kappa, place)| (self.material.masses as f64 - place - CLEAR / kappa) / speed(kappa))
            .fold(f64::INFINITY, f64::min)
    }

    pub(super) fn steepness(&self) -> f64 {
        STEEPNESS / self.material.spacing
    }

    /// Time, in that of a long wave from mass to mass, until the fastest has overtaken all others and is as far ahead as it was
    /// behind.
    fn chase(&self) -> f64 {
        let (first, start) = self.each[0];
        let each = self.each[1..].iter().map(|&(kappa, place)| 2.0 * (place - start) / (speed(first) - speed(kappa)));
        each.fold(0.0, f64::max)
    }

    pub(super) fn end(&self) -> f64 {
        let wanted = if self.each.len() > 1 { self.chase() } else { self.room() };
        wanted / self.material.omega_0()
    }

    /// `ln tau` and its rate of change at the place `n`.
    fn tau(&self, n: f64, time: f64) -> (f64, f64) {
        let omega_0 = self.material.omega_0();
        let terms: Vec<(f64, f64)> = (0..1usize << self.each.len())
            .map(|subset| {
                let chosen = |i: usize| subset >> i & 1 == 1;
                let (mut exponent, mut rate) = (0.0, 0.0);
                for (i, &(kappa, place)) in self.each.iter().enumerate().filter(|(i, _)| chosen(*i)) {
                    let beta = omega_0 * libm::sinh(kappa);
                    exponent += 2.0 * (kappa * (n - place) - beta * time);
                    rate -= 2.0 * beta;
                    exponent += (0..i).filter(|&j| chosen(j)).map(|j| interaction(kappa, self.each[j].0)).sum::<f64>();
                }
                (exponent, rate)
            })
            .collect();
        let most = terms.iter().map(|term| term.0).fold(f64::NEG_INFINITY, f64::max);
        let weight = |exponent: f64| libm::exp(exponent - most);
        let sum: f64 = terms.iter().map(|term| weight(term.0)).sum();
        let rate: f64 = terms.iter().map(|term| weight(term.0) * term.1).sum();
        (most + libm::log(sum), rate / sum)
    }

    /// Exact displacements of walls and masses, zero in front of all solitons.
    pub(super) fn displacements(&self, time: f64) -> Vec<f64> {
        let ahead: f64 = self.each.iter().map(|(kappa, _)| 2.0 * kappa).sum();
        let logarithm: Vec<f64> = (0..self.material.masses + 3).map(|n| self.tau(n as f64 - 1.0, time).0).collect();
        logarithm.windows(2).map(|pair| (pair[0] - pair[1] + ahead) / self.steepness()).collect()
    }

    pub(super) fn velocities(&self, time: f64) -> Vec<f64> {
        let rates: Vec<f64> = (0..self.material.masses + 3).map(|n| self.tau(n as f64 - 1.0, time).1).collect();
        rates.windows(2).map(|pair| (pair[0] - pair[1]) / self.steepness()).collect()
    }

    /// `exp(-b r_n) - 1`: how much harder than at rest each spring is pressed, in units of `k/b`.
    pub(super) fn pressure(&self, displacements: &[f64]) -> Vec<f64> {
        displacements.windows(2).map(|pair| libm::expm1(-self.steepness() * (pair[1] - pair[0]))).collect()
    }

    /// Largest pressure of a soliton, `sinh^2 kappa`.
    pub(super) fn highest(&self) -> f64 {
        let sine = libm::sinh(self.each[0].0);
        sine * sine
    }

    pub(super) fn see(&mut self, rows: &[Row]) {
        for (which, row) in rows.iter().enumerate() {
            let time = corpuscle_core::Engine::time(&row.engine);
            let own = row.displacements();
            let off = own.iter().zip(self.displacements(time)).map(|(u, exact)| (u - exact).abs());
            self.deviation[which] =
                off.fold(
                    self.deviation[which],
                    |most, off| if off.is_nan() { f64::INFINITY } else { most.max(self.steepness() * off) },
                );
            let pressure = self.pressure(&own);
            self.fastest[which] = self.peak(&pressure).map(|place| (time, place));
            if which == 0 {
                self.peaks.push((time, all_peaks(&pressure)));
            }
        }
    }

    /// Where the fastest soliton is, from the two highest springs: its shape `sinh^2(kappa) sech^2(kappa (n - x))` is known.
    fn peak(&self, pressure: &[f64]) -> Option<f64> {
        let kappa = self.each[0].0;
        let top = (1..pressure.len().checked_sub(1)?).max_by(|&a, &b| pressure[a].total_cmp(&pressure[b]))?;
        let beside = if pressure[top + 1] > pressure[top - 1] { top + 1 } else { top - 1 };
        let distance = |n: usize| libm::acosh((libm::sinh(kappa) / pressure[n].sqrt()).max(1.0)) / kappa;
        let sign = if beside > top { 1.0 } else { -1.0 };
        // The one that is farther out is the better known: the top of the curve is flat.
        Some(beside as f64 - sign * distance(beside))
    }

    pub(super) fn caption(&self, time: f64) -> String {
        let speeds: Vec<String> = self.each.iter().map(|&(kappa, _)| format!("{:.3} c", speed(kappa))).collect();
        format!("springs pressed: points, the chain; line, Toda's solution   speeds {}   t = {time:.1}", speeds.join(", "))
    }

    /// Where the fastest would be had it been alone, and how far ahead of that it is thrown by the others.
    fn alone(&self, time: f64) -> (f64, f64) {
        let (kappa, place) = self.each[0];
        let shift = self.each[1..].iter().map(|&(other, _)| -interaction(kappa, other) / (2.0 * kappa)).sum();
        // In `tau` a soliton behind all others is where it is said to be; a spring n lies between the masses n and n + 1, and is the
        // most pressed where theta_n = 0.
        (place + speed(kappa) * self.material.omega_0() * time, shift)
    }

    pub(super) fn checks(&self, time: f64, end: f64) -> Vec<Check> {
        // An error of order dt^4 is at most 2^(1 - 4) of that at twice the step, and rounding grows with the steps.
        let rounding = 1e-10;
        let mut checks = vec![Check::at_most(
            "displacements: largest deviation from Toda's solution, in 1/b",
            self.deviation[0],
            0.125 * self.deviation[1] + rounding,
            "Toda 1967 (doi:10.1143/JPSJ.22.431), Hirota 1973 (doi:10.1143/JPSJ.35.286); bound: an eighth of the deviation at \
             twice the step, for a method of fourth order",
        )];
        if let ([Some(found), Some(coarse)], true, true) = (self.fastest, self.each.len() > 1, time >= 0.995 * end) {
            let ahead = |(time, place): (f64, f64)| place - self.alone(time).0;
            let (shift, found, coarse) = (self.alone(time).1, ahead(found), ahead(coarse));
            let tail = |&(kappa, place): &(f64, f64)| 10.0 * libm::exp(-2.0 * kappa * (place - self.each[0].1));
            let tails: f64 = self.each[1..].iter().map(tail).sum();
            checks.push(Check::at_most(
                format!("the fast soliton is thrown forward by {found:.5} spacings: deviation from {shift:.5}"),
                (found - shift).abs(),
                0.125 * (coarse - shift).abs() + tails,
                "ln(sinh((κ+κ')/2)/sinh((κ−κ')/2))/κ; bound: an eighth of the deviation at twice the step, and what the tails of the \
                 others add",
            ));
        }
        checks
    }

    pub(super) fn charts(&self, row: &Row) -> Vec<Chart> {
        let time = corpuscle_core::Engine::time(&row.engine);
        let points = |u: &[f64]| self.pressure(u).into_iter().enumerate().map(|(n, f)| (n as f64, f)).collect::<Vec<_>>();
        let profile = Chart::new(
            "profile",
            "How hard each spring is pressed",
            Axis::linear("spring number n", ""),
            Axis::linear("exp(−b r) − 1", ""),
        )
        .with(Series::new("Toda's solution", Style::Theory, points(&self.displacements(time))))
        .with(Series::new(format!("chain, t = {time:.1}"), Style::Points, points(&row.displacements())))
        .noting(
            "A soliton keeps its shape for ever, and after an encounter has it again: the higher, the narrower and the faster.",
        );
        let mut paths = Chart::new(
            "paths",
            "Paths of the solitons, seen from a frame that moves with long waves",
            Axis::linear("time t", ""),
            Axis::linear("position − c t, in spacings", ""),
        );
        let last = self.peaks.last().map_or(0.0, |entry| entry.0);
        let moving = |x: f64, t: f64| x - self.material.omega_0() * t;
        for &(kappa, place) in &self.each {
            let alone = |t: f64| moving(place + speed(kappa) * self.material.omega_0() * t, t);
            paths = paths.with(Series::new(format!("alone, κ = {kappa}"), Style::Theory, [(0.0, alone(0.0)), (last, alone(last))]));
        }
        let stride = self.peaks.len().div_ceil(400).max(1);
        let seen = self.peaks.iter().step_by(stride).flat_map(|(t, places)| places.iter().map(move |&x| (*t, moving(x, *t))));
        let paths = paths
            .with(Series::new("maxima of the pressure", Style::Points, seen.collect::<Vec<_>>()))
            .noting("Who overtakes is thrown forward, who is overtaken falls back: solitons behave like particles that repel.");
        vec![profile, paths]
    }

    pub(super) fn table(&self) -> Table {
        let rows = self.peaks.iter().flat_map(|(t, places)| places.iter().map(move |&x| vec![*t, x]));
        Table { name: "maxima".into(), columns: ["time", "position_spacings"].map(String::from).to_vec(), rows: rows.collect() }
    }
}

/// Speed of a soliton over that of long waves.
fn speed(kappa: f64) -> f64 {
    libm::sinh(kappa) / kappa
}

/// `ln A` of two solitons.
fn interaction(one: f64, other: f64) -> f64 {
    2.0 * libm::log(libm::sinh(0.5 * (one - other).abs()) / libm::sinh(0.5 * (one + other)))
}

/// Maxima above a hundredth of the highest, on the parabola through three springs.
fn all_peaks(pressure: &[f64]) -> Vec<f64> {
    let most = pressure.iter().fold(0.0, |most: f64, &f| most.max(f));
    (1..pressure.len().saturating_sub(1))
        .filter(|&n| pressure[n] > 0.01 * most && pressure[n] >= pressure[n - 1] && pressure[n] > pressure[n + 1])
        .map(|n| {
            let (before, here, after) = (pressure[n - 1], pressure[n], pressure[n + 1]);
            n as f64 + 0.5 * (before - after) / (before - 2.0 * here + after)
        })
        .collect()
}
