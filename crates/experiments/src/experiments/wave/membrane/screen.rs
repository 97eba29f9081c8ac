//! What arrives at the screen behind sources and slits, beside Huygens' principle.

use corpuscle_observe::chart::Axis;
use corpuscle_observe::{Chart, Check, Series, Style};

use super::{Membrane, ROWS, SCREEN, SPONGE, Subject, theory};

impl Membrane {
    /// Amplitude and phase that the origins send to a mass of the screen by Huygens' principle in two dimensions:
    /// `sum exp(i k r)/sqrt(r)`, each times the cosine of its angle where it comes through a wall (Sommerfeld 1954, *Optics*,
    /// section 34), with the wavenumber of the lattice in that direction.
    fn huygens(&self, row: f64) -> (f64, f64) {
        let s = self.half_sine(self.angular_frequency);
        let through = !matches!(self.subject, Subject::TwoSources(_));
        let mut sum = (0.0, 0.0);
        for (from, column) in self.subject.origins() {
            let (x, y) = (SCREEN as f64 - column, row - from);
            let r = x.hypot(y);
            let phase = theory::phase_in_direction(s, x / r, (y / r).abs()) * r;
            let weight = if through { x / r } else { 1.0 } / r.sqrt();
            let (sine, cosine) = libm::sincos(phase);
            sum = (sum.0 + weight * cosine, sum.1 + weight * sine);
        }
        sum
    }

    pub(super) fn chart_of_screen(&self) -> Option<Chart> {
        let amplitudes = self.amplitudes()?;
        let expected: Vec<f64> = (0..ROWS).map(|row| self.huygens(row as f64)).map(|(c, s)| c.hypot(s)).collect();
        let inner = SPONGE..ROWS - SPONGE;
        let dot = |a: &[f64], b: &[f64]| inner.clone().map(|row| a[row] * b[row]).sum::<f64>();
        let scale = dot(&amplitudes, &expected) / dot(&expected, &expected);
        let points = |values: &[f64], scale: f64| {
            inner.clone().map(|row| (row as f64 - (ROWS / 2) as f64, scale * values[row])).collect::<Vec<_>>()
        };
        Some(
            Chart::new(
                "screen",
                "Amplitude on the screen",
                Axis::linear("place along the screen", "spacings"),
                Axis::linear("amplitude", ""),
            )
            .with(Series::new("Huygens: Σ exp(ikr)/√r", Style::Theory, points(&expected, scale)))
            .with(Series::new("measured", Style::Points, points(&amplitudes, 1.0)))
            .noting("Dark where paths differ by half a wavelength, or one and a half; Huygens' curve is scaled once, to fit."),
        )
    }

    /// Dark places between the sponges, in rows from the first: minima of values at the rows, each on its parabola.
    fn minima(values: &[f64]) -> Vec<f64> {
        (SPONGE + 4..ROWS - SPONGE - 4)
            .filter(|&row| values[row] < values[row - 1] && values[row] <= values[row + 1])
            .map(|row| {
                let [before, here, after] = [row - 1, row, row + 1].map(|row| values[row] * values[row]);
                row as f64 + 0.5 * (before - after) / (before - 2.0 * here + after)
            })
            .collect()
    }

    pub(super) fn check_of_fringes(&self) -> Option<Check> {
        let amplitudes = self.amplitudes()?;
        let expected: Vec<f64> = (0..ROWS).map(|row| self.huygens(row as f64)).map(|(c, s)| c.hypot(s)).collect();
        let (found, predicted) = (Self::minima(&amplitudes), Self::minima(&expected));
        if predicted.len() < 2 {
            return None;
        }
        let apart = (predicted[predicted.len() - 1] - predicted[0]) / (predicted.len() - 1) as f64;
        let nearest = |place: &f64| found.iter().map(|other| (other - place).abs()).fold(f64::INFINITY, f64::min);
        let worst = predicted.iter().map(nearest).fold(0.0, f64::max);
        let narrow = !matches!(self.subject, Subject::SingleSlit(_));
        let (bound, why) = if narrow {
            (
                0.05,
                "path difference (j + 1/2) λ, with the lattice's λ in each direction; bound: an echo of 10 % from the edges would \
                    move them by a twentieth of their distance",
            )
        } else {
            (
                0.15,
                "Huygens and Kirchhoff, who take the wave in the slit for the one that comes in: right but for the slit's edges, \
                    a quarter wavelength each",
            )
        };
        Some(Check::at_most(
            format!("{} dark places on the screen: largest deviation over their distance, {apart:.1} spacings", predicted.len()),
            worst / apart,
            bound,
            why,
        ))
    }
}
