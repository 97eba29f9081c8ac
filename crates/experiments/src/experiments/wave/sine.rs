//! The sine that fits a series of evenly spaced values best: a stopwatch and a ruler.

/// Angular frequency `omega` of the `a cos(omega t) + b sin(omega t)` that fits values at `t = 0, h, 2h, ...` best.
///
/// Starts from the recurrence `y_{i+1} + y_{i-1} = 2 cos(omega h) y_i` of every sine, in the sense of least squares, and
/// improves all three numbers by the method of Gauss and Newton (IEEE Std 1057, four-parameter fit without offset). None
/// when the values are no sine that can be told apart from a constant.
pub(super) fn angular_frequency(values: &[f64], interval: f64) -> Option<f64> {
    if values.len() < 4 {
        return None;
    }
    let (mut cross, mut square) = (0.0, 0.0);
    for three in values.windows(3) {
        cross += three[1] * (three[0] + three[2]);
        square += three[1] * three[1];
    }
    let mut omega = libm::acos((0.5 * cross / square).clamp(-1.0, 1.0));
    let middle = 0.5 * (values.len() - 1) as f64;
    let (mut a, mut b) = (0.0, 0.0);
    for round in 0..8 {
        let (mut matrix, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
        for (i, &y) in values.iter().enumerate() {
            let t = i as f64 - middle;
            let (sine, cosine) = libm::sincos(omega * t);
            let row = [cosine, sine, t * (b * cosine - a * sine)];
            let residual = y - a * cosine - b * sine;
            for j in 0..3 {
                right[j] += row[j] * residual;
                for k in 0..3 {
                    matrix[j][k] += row[j] * row[k];
                }
            }
        }
        if round == 0 {
            matrix[2] = [0.0, 0.0, 1.0]; // no amplitude yet to tell a change of frequency from
            right[2] = 0.0;
        }
        let step = solve(matrix, right)?;
        (a, b, omega) = (a + step[0], b + step[1], omega + step[2]);
    }
    (omega.is_finite() && omega > 0.0).then_some(omega / interval)
}

/// Solution of three linear equations, by elimination with row exchanges.
fn solve(mut matrix: [[f64; 3]; 3], mut right: [f64; 3]) -> Option<[f64; 3]> {
    for column in 0..3 {
        let pivot = (column..3).max_by(|&i, &j| matrix[i][column].abs().total_cmp(&matrix[j][column].abs()))?;
        if matrix[pivot][column] == 0.0 || matrix[pivot][column].is_nan() {
            return None;
        }
        matrix.swap(column, pivot);
        right.swap(column, pivot);
        for row in column + 1..3 {
            let upper = matrix[column];
            let factor = matrix[row][column] / upper[column];
            for (entry, above) in matrix[row].iter_mut().zip(upper) {
                *entry -= factor * above;
            }
            right[row] -= factor * right[column];
        }
    }
    let mut solution = [0.0; 3];
    for row in (0..3).rev() {
        let known: f64 = (row + 1..3).map(|k| matrix[row][k] * solution[k]).sum();
        solution[row] = (right[row] - known) / matrix[row][row];
    }
    Some(solution)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The fit of an exact sine over three periods is limited by rounding: `6 eps / (omega T)` with some roundings each.
    #[test]
    fn a_sine_is_found_to_rounding() {
        for omega in [0.01, 0.3, 3.0] {
            let count = (20.0 / omega) as usize + 20;
            let values: Vec<f64> = (0..count).map(|i| 0.3 * libm::cos(omega * i as f64 + 0.7)).collect();
            let found = angular_frequency(&values, 1.0).unwrap();
            assert!((found / omega - 1.0).abs() < 100.0 * f64::EPSILON, "{found} for {omega}");
        }
    }

    #[test]
    fn silence_has_no_frequency() {
        assert!(angular_frequency(&[0.0; 50], 1.0).is_none() && angular_frequency(&[1.0, 2.0], 1.0).is_none());
    }
}
