//! Real trigonometric polynomials of twice an angle: Σ c_k e^{2ikφ}, |k| ≤ 2.

use std::ops::{Add, Mul, Sub};

/// A 2×2 matrix by rows.
pub(super) type Matrix = [[f64; 2]; 2];

/// A complex number.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Complex {
    pub(super) re: f64,
    pub(super) im: f64,
}

impl Complex {
    pub(super) fn new(re: f64, im: f64) -> Self {
        Self { re, im }
    }

    pub(super) fn conjugate(self) -> Self {
        Self::new(self.re, -self.im)
    }

    pub(super) fn times(self, factor: f64) -> Self {
        Self::new(factor * self.re, factor * self.im)
    }
}

impl Add for Complex {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::new(self.re + other.re, self.im + other.im)
    }
}

impl Mul for Complex {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self::new(
            self.re * other.re - self.im * other.im,
            self.re * other.im + self.im * other.re,
        )
    }
}

/// The polynomial: c_0, which is real, c_1 and c_2; c_{-k} is the conjugate of c_k.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Waves([Complex; 3]);

impl Waves {
    /// constant + cosine cos 2φ + sine sin 2φ.
    fn new(constant: f64, cosine: f64, sine: f64) -> Self {
        let first = Complex::new(0.5 * cosine, -0.5 * sine);
        Self([Complex::new(constant, 0.0), first, Complex::default()])
    }

    /// s·M s, where s = (cos φ, sin φ): how fast M stretches.
    pub(super) fn along(m: &Matrix) -> Self {
        let [[a, b], [c, d]] = *m;
        Self::new(0.5 * (a + d), 0.5 * (a - d), 0.5 * (b + c))
    }

    /// n·M s, where n = (-sin φ, cos φ): how fast M turns.
    pub(super) fn across(m: &Matrix) -> Self {
        let [[a, b], [c, d]] = *m;
        Self::new(0.5 * (c - b), 0.5 * (c + b), 0.5 * (d - a))
    }

    /// c_k, for k from -2 to 2; zero beyond.
    pub(super) fn at(&self, k: i64) -> Complex {
        let known = usize::try_from(k.abs()).ok();
        let found = known.and_then(|k| self.0.get(k)).copied();
        let found = found.unwrap_or_default();
        if k < 0 { found.conjugate() } else { found }
    }

    /// Its value at an angle.
    pub(super) fn value(&self, angle: f64) -> f64 {
        let term = |k: i64| {
            let (sine, cosine) = (2.0 * k as f64 * angle).sin_cos();
            2.0 * (self.at(k).re * cosine - self.at(k).im * sine)
        };
        self.at(0).re + term(1) + term(2)
    }

    /// Bound of its magnitude.
    pub(super) fn size(&self) -> f64 {
        let size = |k: i64| self.at(k).re.hypot(self.at(k).im);
        size(0) + 2.0 * size(1) + 2.0 * size(2)
    }

    /// Angles in half a turn at which it is zero, of a polynomial without c_2; none where it is zero everywhere.
    pub(super) fn zeros(&self) -> Vec<f64> {
        let (constant, first) = (self.at(0).re, self.at(1));
        let size = 2.0 * first.re.hypot(first.im);
        let cosine = -constant / size;
        // A double zero is one in spite of rounding.
        let cosine = match (cosine.abs() - 1.0).abs() < 1e-13 {
            true => cosine.signum(),
            false => cosine,
        };
        if cosine.is_nan() || cosine.abs() > 1.0 {
            return Vec::new();
        }
        let (phase, apart) = (first.im.atan2(first.re), cosine.acos());
        vec![0.5 * (apart - phase), 0.5 * (-apart - phase)]
    }

    pub(super) fn times(self, factor: f64) -> Self {
        Self(self.0.map(|one| one.times(factor)))
    }
}

impl Add for Waves {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let [a, b, c] = self.0;
        let [d, e, f] = other.0;
        Self([a + d, b + e, c + f])
    }
}

impl Sub for Waves {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + other.times(-1.0)
    }
}

/// The product of two polynomials without c_2.
impl Mul for Waves {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let ([a, b, _], [c, d, _]) = (self.0, other.0);
        let mean = a.re * c.re + 2.0 * (b.re * d.re + b.im * d.im);
        Self([
            Complex::new(mean, 0.0),
            d.times(a.re) + b.times(c.re),
            b * d,
        ])
    }
}

#[cfg(test)]
mod tests {
    use super::{Matrix, Waves};

    #[test]
    fn matrices_stretch_and_turn_as_their_polynomials_say() {
        let m: Matrix = [[0.3, -1.2], [0.7, 2.1]];
        let (along, across) = (Waves::along(&m), Waves::across(&m));
        for angle in [0.0, 0.4, 1.1, 2.9] {
            let (s, c) = f64::sin_cos(angle);
            let image = [m[0][0] * c + m[0][1] * s, m[1][0] * c + m[1][1] * s];
            let (stretch, turn) = (image[0] * c + image[1] * s, image[1] * c - image[0] * s);
            assert!((along.value(angle) - stretch).abs() < 1e-15);
            assert!((across.value(angle) - turn).abs() < 1e-15);
            let product = (along * across).value(angle);
            assert!((product - stretch * turn).abs() < 1e-14);
        }
    }

    #[test]
    fn directions_that_a_matrix_keeps_are_zeros() {
        // Its eigenvectors are (1, 1) and (1, -2).
        let zeros = Waves::across(&[[1.0, 1.0], [2.0, 0.0]]).zeros();
        let mut slopes: Vec<f64> = zeros.iter().map(|angle| angle.tan()).collect();
        slopes.sort_by(f64::total_cmp);
        assert!((slopes[0] + 2.0).abs() < 1e-14 && (slopes[1] - 1.0).abs() < 1e-14);
        // A rotation keeps none; a shear one, twice.
        assert!(Waves::across(&[[0.0, -1.0], [1.0, 0.0]]).zeros().is_empty());
        let zeros = Waves::across(&[[0.0, 0.0], [3.0, 0.0]]).zeros();
        assert!(zeros.iter().all(|angle| angle.cos().abs() < 1e-15));
    }
}
