//! A polynomial on an interval, by the coefficients of its Legendre series.

use super::rule::{NODES, Rule, legendre};

/// Σ c_n P_n(u), where u goes from -1 to 1 over the interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Series {
    pub(super) from: f64,
    pub(super) to: f64,
    coefficients: [f64; NODES],
}

impl Series {
    /// The polynomial through values at the points of the rule.
    pub(super) fn through(rule: &Rule, (from, to): (f64, f64), values: &[f64; NODES]) -> Self {
        let mut coefficients = [0.0; NODES];
        for ((point, weight), value) in rule.points.iter().zip(&rule.weights).zip(values) {
            let polynomials = legendre(2.0 * point - 1.0);
            for (n, slot) in coefficients.iter_mut().enumerate() {
                *slot += (2 * n + 1) as f64 * weight * value * polynomials[n];
            }
        }
        Self {
            from,
            to,
            coefficients,
        }
    }

    /// The sum of this and a multiple of another on the same interval.
    pub(super) fn plus(mut self, factor: f64, other: &Self) -> Self {
        let pairs = self.coefficients.iter_mut().zip(&other.coefficients);
        pairs.for_each(|(own, other)| *own += factor * other);
        self
    }

    fn unit(&self, place: f64) -> f64 {
        ((2.0 * place - self.from - self.to) / (self.to - self.from)).clamp(-1.0, 1.0)
    }

    /// Its value; beyond the ends that at the end.
    pub(super) fn at(&self, place: f64) -> f64 {
        let polynomials = legendre(self.unit(place));
        let terms = self.coefficients.iter().zip(polynomials);
        terms.map(|(c, p)| c * p).sum()
    }

    /// Its derivative: P_k' is the sum of (2n + 1) P_n over n = k - 1, k - 3 …
    pub(super) fn derivative(&self) -> Self {
        let mut coefficients = [0.0; NODES];
        for (n, slot) in coefficients.iter_mut().enumerate() {
            let above = self.coefficients.iter().skip(n + 1).step_by(2);
            *slot = 2.0 / (self.to - self.from) * (2 * n + 1) as f64 * above.sum::<f64>();
        }
        Self {
            coefficients,
            ..*self
        }
    }

    /// Its integral from the lower end.
    pub(super) fn integral_to(&self, place: f64) -> f64 {
        let p = legendre(self.unit(place));
        let terms = self.coefficients.iter().enumerate().map(|(n, c)| {
            let below = if n == 0 { -1.0 } else { p[n - 1] };
            c * (p[n + 1] - below) / (2 * n + 1) as f64
        });
        0.5 * (self.to - self.from) * terms.sum::<f64>()
    }

    /// The last two coefficients: what is left out is smaller where they fall.
    pub(super) fn tail(&self) -> f64 {
        self.coefficients[NODES - 2].abs() + self.coefficients[NODES - 1].abs()
    }

    /// A bound of its magnitude.
    pub(super) fn size(&self) -> f64 {
        self.coefficients.iter().map(|c| c.abs()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polynomial_of_degree_seven_is_kept_with_its_derivative_and_integral() {
        let rule = Rule::new();
        let (from, to) = (-0.3, 1.1);
        let f = |x: f64| 1.0 - 2.0 * x.powi(3) + 0.7 * x.powi(7);
        let values = rule.points.map(|point| f(from + (to - from) * point));
        let series = Series::through(&rule, (from, to), &values);
        let (slope, primitive) = (
            |x: f64| -6.0 * x.powi(2) + 4.9 * x.powi(6),
            |x: f64| x - 0.5 * x.powi(4) + 0.7 / 8.0 * x.powi(8),
        );
        for x in [-0.3, -0.1, 0.4, 1.0, 1.1] {
            assert!((series.at(x) - f(x)).abs() < 1e-13);
            assert!((series.derivative().at(x) - slope(x)).abs() < 1e-12);
            let integral = primitive(x) - primitive(from);
            assert!((series.integral_to(x) - integral).abs() < 1e-13);
        }
        assert!(series.tail() > 1e-3 && series.size() > f(0.0));
    }
}
