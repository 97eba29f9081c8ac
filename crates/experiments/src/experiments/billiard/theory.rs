//! The Lyapunov exponent of the thin Lorentz gas.

/// Euler's constant.
const EULER: f64 = 0.577_215_664_901_532_9;
/// Places in each of the four variables of the average.
const PLACES: usize = 24;

/// `lambda l/v` of scattered discs of radius `a` with the mean free path `l`: the mean logarithm of what a front spreads
/// between two discs, flights being independent and exponential.
///
/// Behind a disc met under the angle `phi` the curvature is `2/(a cos phi) + 1/w`, with `w = s' + a cos phi'/2` for the flight
/// `s'` and the angle `phi'` before. So `ln(1 + kappa s) = ln(2 s/(a cos phi)) + ln(1 + (a cos phi/2)(1/w + 1/s))`: the first
/// term averages to `ln(l/a) + 1 - C`, since `<ln s> = ln l - C` and `<ln cos phi> = ln 2 - 1` for uniform `sin phi`; the second,
/// of order `(a/l) ln(l/a)`, is summed here. What is left out is of second order, and the returns to a disc met before.
pub(super) fn exponent_per_flight(radius: f64, free_path: f64) -> f64 {
    let middle = |k: usize| (k as f64 + 0.5) / PLACES as f64;
    let halves: Vec<f64> = (0..PLACES).map(|k| 0.5 * radius * (1.0 - middle(k) * middle(k)).sqrt()).collect();
    // Most of it comes from short flights, where the logarithm is steep: places are dense there, s = -l ln(1 - x^3).
    let weights: f64 = (0..PLACES).map(|k| middle(k) * middle(k)).sum();
    let flight = |x: f64| (-free_path * libm::log1p(-x * x * x), x * x / weights);
    let flights: Vec<(f64, f64)> = (0..PLACES).map(|k| flight(middle(k))).collect();
    let mut correction = 0.0;
    for &(before, weight_before) in &flights {
        for &angle_before in &halves {
            let flat = 1.0 / (before + angle_before);
            for &angle in &halves {
                for &(flight, weight) in &flights {
                    correction += weight_before * weight * libm::log1p(angle * (flat + 1.0 / flight));
                }
            }
        }
    }
    libm::log(free_path / radius) + 1.0 - EULER + correction / (PLACES as f64).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use corpuscle_core::Random;

    /// The same process played out: exponential flights, uniform impact parameters, the whole history of the curvature.
    #[test]
    fn the_next_order_agrees_with_the_process_it_stands_for() {
        let (radius, free_path) = (1.0, 100.0);
        let mut random = Random::new(1, 0);
        let (mut curvature, mut sum, mut squares) = (0.02, 0.0, 0.0);
        let flights = 400_000;
        for _ in 0..flights {
            let flight = -free_path * libm::log(random.uniform());
            let growth = libm::log1p(curvature * flight);
            let sine = random.uniform();
            curvature = curvature / (1.0 + curvature * flight) + 2.0 / (radius * (1.0 - sine * sine).sqrt());
            sum += growth;
            squares += growth * growth;
        }
        let n = f64::from(flights);
        let mean = sum / n;
        let error = ((squares / n - mean * mean) / n).sqrt();
        let theory = exponent_per_flight(radius, free_path);
        // Successive growths are hardly correlated; the quadrature is good to 1e-3 (with twice the places it moves by 6e-5, at a free path of 5 by 5e-4).
        assert!((theory - mean).abs() < 4.0 * error + 1e-3, "{theory}, {mean} +- {error}");
        let leading = libm::log(free_path) + 1.0 - EULER;
        assert!((leading - mean).abs() > 10.0 * error, "the next order is there to be seen: {leading}");
    }
}
