//! Spectra, and the frequency of a line with its error.

use std::f64::consts::PI;

use realfft::RealFftPlanner;

use crate::Estimate;

/// Power against angular frequency, `0..=pi/interval`, of a series with its mean taken off, through Hann's window
/// `sin^2(pi k/n)`. A sinusoid of amplitude `A` peaks at `A^2`. Not bound to the same last bits on every platform: for
/// drawing, and for finding the highest line.
pub fn power_spectrum(series: &[f64], interval: f64) -> Vec<(f64, f64)> {
    let n = series.len();
    if n < 2 {
        return vec![];
    }
    let mut input = windowed(series);
    let transform = RealFftPlanner::<f64>::new().plan_fft_forward(n);
    let mut output = transform.make_output_vec();
    if transform.process(&mut input, &mut output).is_err() {
        return vec![]; // impossible: both lengths come from the plan
    }
    let bin = 2.0 * PI / (n as f64 * interval);
    let scale = 4.0 / n as f64; // the window's mean is 1/2, and half of a sinusoid's amplitude is at negative frequency
    output.iter().enumerate().map(|(k, c)| (bin * k as f64, c.norm_sqr() * scale * scale)).collect()
}

/// The strongest line of a series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Angular frequency. The error is that of a sinusoid in white noise, the noise being all that the fit leaves over; for a
    /// pure line it is of the order of rounding.
    pub frequency: Estimate,
    /// Amplitude of the sinusoid.
    pub amplitude: f64,
    /// Root mean square of what the fit leaves over.
    pub residual: f64,
    /// Two lines closer than this, `2 pi` over the length of the series, cannot be told apart.
    pub resolution: f64,
}

/// The angular frequency of the strongest line: the highest bin of the spectrum, interpolated, then least squares of
/// `a cos(omega t) + b sin(omega t) + c` in all four parameters (IEEE standard 1057), which is the maximum-likelihood estimate
/// in white noise and reaches the bound of Cramer and Rao, `var(omega) = 24 s^2/(A^2 dt^2 n^3)` (Rife and Boorstyn 1974,
/// doi:10.1109/TIT.1974.1055282).
///
/// None when the series is shorter than 16 samples, does not vary, or has no line between 2 bins and the highest frequency.
pub fn strongest_line(series: &[f64], interval: f64) -> Option<Line> {
    let n = series.len();
    let spectrum = power_spectrum(series, interval);
    if n < 16 || !spectrum.iter().all(|point| point.1.is_finite()) {
        return None;
    }
    let inner = 2..spectrum.len() - 2;
    let peak = inner.max_by(|&a, &b| spectrum[a].1.total_cmp(&spectrum[b].1))?;
    if spectrum[peak].1 == 0.0 {
        return None;
    }
    // Angles count from the middle of the series, where phase and frequency are uncorrelated.
    let phases = 2.0 * PI / n as f64;
    let input = windowed(series);
    let power = |bin: f64| libm::log(transform(&input, phases * bin));
    let (low, mid, high) = (power(peak as f64 - 1.0), power(peak as f64), power(peak as f64 + 1.0));
    let offset = 0.5 * (low - high) / (low - 2.0 * mid + high);
    let start = phases * (peak as f64 + if offset.abs() < 1.0 { offset } else { 0.0 });
    let fit = SineFit::new(series, start)?;
    let frequency = Estimate::new(fit.frequency / interval, fit.standard_error / interval).with_degrees_of_freedom(n as f64 - 4.0);
    Some(Line { frequency, amplitude: fit.amplitude, residual: fit.residual, resolution: phases / interval })
}

/// The series without its mean, through Hann's window.
fn windowed(series: &[f64]) -> Vec<f64> {
    let n = series.len() as f64;
    let mean = series.iter().sum::<f64>() / n;
    let window = |k: usize| {
        let sine = libm::sin(PI * k as f64 / n);
        sine * sine
    };
    series.iter().enumerate().map(|(k, x)| (x - mean) * window(k)).collect()
}

/// Power at one angle a sample, from `libm` alone.
fn transform(input: &[f64], angle: f64) -> f64 {
    let (mut re, mut im) = (0.0, 0.0);
    for (k, x) in input.iter().enumerate() {
        let (sine, cosine) = libm::sincos(angle * k as f64);
        re += x * cosine;
        im += x * sine;
    }
    re * re + im * im
}

/// Least-squares sinusoid; frequencies in radians a sample.
struct SineFit {
    frequency: f64,
    standard_error: f64,
    amplitude: f64,
    residual: f64,
}

impl SineFit {
    /// Gauss and Newton's iteration from a frequency that is right to a fraction of a bin.
    fn new(series: &[f64], start: f64) -> Option<Self> {
        let n = series.len();
        let half = 0.5 * (n as f64 - 1.0);
        let (mut omega, mut slope) = (start, [0.0; 2]);
        for _ in 0..50 {
            // Basis cos, sin, 1 and, once a and b are known, the derivative by omega, in units of 1/half.
            let (mut normal, mut right) = ([[0.0; 4]; 4], [0.0; 4]);
            for (k, &x) in series.iter().enumerate() {
                let t = k as f64 - half;
                let (sine, cosine) = libm::sincos(omega * t);
                let row = [cosine, sine, 1.0, t / half * (slope[1] * cosine - slope[0] * sine)];
                for i in 0..4 {
                    right[i] += row[i] * x;
                    for j in 0..4 {
                        normal[i][j] += row[i] * row[j];
                    }
                }
            }
            let first = slope == [0.0; 2];
            if first {
                normal[3][3] = 1.0; // amplitudes only, at the starting frequency
            }
            let inverse = inverse(normal)?;
            let solution: [f64; 4] = std::array::from_fn(|i| (0..4).map(|j| inverse[i][j] * right[j]).sum());
            slope = [solution[0], solution[1]];
            if first {
                continue;
            }
            let step = solution[3] / half;
            omega += step;
            if step.abs() <= 1e-14 * omega.abs() {
                let noise = Self::residual(series, omega, solution, half);
                let variance = noise / (n as f64 - 4.0);
                return Some(Self {
                    frequency: omega,
                    standard_error: (variance * inverse[3][3]).sqrt() / half,
                    amplitude: slope[0].hypot(slope[1]),
                    residual: (noise / n as f64).sqrt(),
                });
            }
        }
        None
    }

    /// Sum of squared residuals, term by term.
    fn residual(series: &[f64], omega: f64, [a, b, c, _]: [f64; 4], half: f64) -> f64 {
        let residual = |(k, x): (usize, &f64)| {
            let (sine, cosine) = libm::sincos(omega * (k as f64 - half));
            x - a * cosine - b * sine - c
        };
        series.iter().enumerate().map(residual).map(|r| r * r).sum()
    }
}

/// Inverse of a small matrix by elimination with row exchange; none when it is singular.
fn inverse<const N: usize>(mut matrix: [[f64; N]; N]) -> Option<[[f64; N]; N]> {
    let mut inverse: [[f64; N]; N] = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    for column in 0..N {
        let pivot = (column..N).max_by(|&a, &b| matrix[a][column].abs().total_cmp(&matrix[b][column].abs()))?;
        matrix.swap(column, pivot);
        inverse.swap(column, pivot);
        let scale = matrix[column][column];
        if scale == 0.0 || !scale.is_finite() {
            return None;
        }
        for j in 0..N {
            matrix[column][j] /= scale;
            inverse[column][j] /= scale;
        }
        for row in (0..N).filter(|&row| row != column) {
            let factor = matrix[row][column];
            for j in 0..N {
                matrix[row][j] -= factor * matrix[column][j];
                inverse[row][j] -= factor * inverse[column][j];
            }
        }
    }
    Some(inverse)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::tests::assert_standard_normal;
    use corpuscle_core::Random;

    fn tone(n: usize, omega: f64, phase: f64, mut noise: impl FnMut() -> f64) -> Vec<f64> {
        (0..n).map(|k| 0.3 + 2.0 * libm::cos(omega * k as f64 * 0.1 + phase) + noise()).collect()
    }

    #[test]
    fn frequencies_in_white_noise_are_standard_normal_and_reach_the_bound() {
        let n = 500;
        let mut widths = vec![];
        let scores: Vec<f64> = (0..600)
            .map(|seed| {
                let mut random = Random::new(seed, 90);
                let (omega, phase) = (2.0 + 4.0 * random.uniform(), 6.0 * random.uniform());
                let line = strongest_line(&tone(n, omega, phase, || 0.5 * random.normal()), 0.1).unwrap();
                widths.push(line.frequency.standard_error);
                line.frequency.score(omega)
            })
            .collect();
        assert_standard_normal("frequency", &scores);
        let bound = (24.0 * 0.25 / 4.0 / f64::from(500 * 500 * 500)).sqrt() / 0.1;
        let width = Estimate::from_replicas(&widths);
        // The bound's own relative error is of order 1/n; the noise estimate's relative bias 1/(4n).
        assert!((width.mean / bound - 1.0).abs() < 4.0 * width.relative_error() + 3.0 / n as f64, "{width:?} {bound}");
    }

    #[test]
    fn a_pure_line_is_found_to_rounding() {
        for (omega, phase) in [(1.234, 0.0), (3.3, 1.0), (9.87, 2.0)] {
            let line = strongest_line(&tone(300, omega, phase, || 0.0), 0.1).unwrap();
            assert!((line.frequency.mean / omega - 1.0).abs() < 1e-13, "{omega}: {line:?}");
            assert!((line.amplitude - 2.0).abs() < 1e-12 && line.residual < 1e-12);
        }
    }

    #[test]
    fn the_spectrum_peaks_at_the_squared_amplitude() {
        let bin = 2.0 * PI / 25.6;
        let spectrum = power_spectrum(&tone(256, 20.0 * bin, 0.4, || 0.0), 0.1);
        assert!((spectrum[20].1 - 4.0).abs() < 1e-12 && (spectrum[20].0 - 20.0 * bin).abs() < 1e-12);
        assert!(spectrum[40].1 < 1e-20 && spectrum.len() == 129);
    }

    #[test]
    fn what_has_no_line_is_none() {
        assert!(strongest_line(&[1.0; 100], 0.1).is_none() && strongest_line(&[], 0.1).is_none());
        assert!(strongest_line(&[f64::NAN; 100], 0.1).is_none());
    }
}
