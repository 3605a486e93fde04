//! Polynomials nearest to some points, with their derivatives.

/// Coefficients, lowest power first, of the polynomial that is nearest to some points: by columns made orthogonal one
/// after the other.
pub(super) fn fit(places: &[f64], values: &[f64], degree: usize) -> Vec<f64> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut rest = values.to_vec();
    // Each column with its coefficients in powers.
    let mut columns: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
    let mut result = vec![0.0; degree + 1];
    for power in 0..=degree {
        let mut column: Vec<f64> = places.iter().map(|x| x.powi(power as i32)).collect();
        let mut powers = vec![0.0; degree + 1];
        powers[power] = 1.0;
        // Twice: rounding leaves something of the first time.
        for _ in 0..2 {
            for (other, other_powers) in &columns {
                let share = dot(&column, other);
                subtract(&mut column, share, other);
                subtract(&mut powers, share, other_powers);
            }
        }
        let length = dot(&column, &column).sqrt();
        column.iter_mut().for_each(|value| *value /= length);
        powers.iter_mut().for_each(|value| *value /= length);
        let share = dot(&rest, &column);
        subtract(&mut rest, share, &column);
        subtract(&mut result, -share, &powers);
        columns.push((column, powers));
    }
    result
}

fn subtract(from: &mut [f64], share: f64, other: &[f64]) {
    let pairs = from.iter_mut().zip(other);
    pairs.for_each(|(a, b)| *a -= share * b);
}

/// Value, first and second derivative of a polynomial.
pub(super) fn evaluate(coefficients: &[f64], x: f64) -> [f64; 3] {
    let mut result = [0.0; 3];
    for coefficient in coefficients.iter().rev() {
        result[2] = result[2] * x + 2.0 * result[1];
        result[1] = result[1] * x + result[0];
        result[0] = result[0] * x + coefficient;
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polynomial_is_fitted_to_the_digit_and_has_its_derivatives() {
        let of = |x: f64| 2.0 - x + 3.0 * x * x - x.powi(4);
        let places = [-1.0, -0.3, 0.2, 0.7, 0.9, 1.5, 1.6];
        let [value, first, second] = evaluate(&fit(&places, &places.map(of), 4), 0.4);
        assert!((value - of(0.4)).abs() < 1e-12);
        assert!((first - (-1.0 + 2.4 - 4.0 * 0.064)).abs() < 1e-12);
        assert!((second - (6.0 - 12.0 * 0.16)).abs() < 1e-11);
    }
}
