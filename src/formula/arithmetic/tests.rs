//! Special values, exact symmetries, and errors in units of the last place against arithmetic of twice the precision.

use super::power::integer_power;
use super::*;

mod precise;
use precise::Precise;

/// Reproducible numbers in [0, 1).
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let word = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((word ^ (word >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Either sign, any magnitude between 10^low and 10^high.
    fn magnitude(&mut self, low: f64, high: f64) -> f64 {
        let size = libm::pow(10.0, self.between(low, high));
        if self.unit() < 0.5 { -size } else { size }
    }
}

/// Distance from the precise value in units of the result's last place.
fn error_in_units(value: f64, precise: Precise) -> f64 {
    let unit = value.abs().next_up() - value.abs();
    (precise - Precise::from(value)).high.abs() / unit
}

fn assert_accurate(
    limit: f64,
    mut draw: impl FnMut(&mut Random) -> f64,
    value: impl Fn(f64) -> f64,
    precise: impl Fn(f64) -> Precise,
) {
    let mut random = Random(1);
    let mut worst = (0.0, 0.0);
    for _ in 0..20_000 {
        let x = draw(&mut random);
        let error = error_in_units(value(x), precise(x));
        if error.is_nan() || error > worst.0 {
            worst = (error, x);
        }
    }
    assert!(worst.0 < limit, "{} units at {}", worst.0, worst.1);
}

#[test]
fn the_exponential_is_accurate_to_the_last_place() {
    assert_accurate(0.9, |r| r.between(-1.0, 1.0), exponential, Precise::exp);
    assert_accurate(0.9, |r| r.between(-700.0, 709.0), exponential, Precise::exp);
    assert_accurate(0.6, |r| r.magnitude(-18.0, -2.0), exponential, Precise::exp);
}

#[test]
fn the_logarithm_is_accurate_to_the_last_place() {
    assert_accurate(0.9, |r| r.between(0.5, 2.0), logarithm, Precise::ln);
    assert_accurate(
        0.9,
        |r| r.magnitude(-300.0, 300.0).abs(),
        logarithm,
        Precise::ln,
    );
    assert_accurate(
        0.9,
        |r| 1.0 + r.magnitude(-15.0, -2.0),
        logarithm,
        Precise::ln,
    );
}

#[test]
fn sine_and_cosine_are_accurate_to_the_last_place() {
    for limit in [0.8, 7.0, 1000.0, REDUCED] {
        assert_accurate(
            0.9,
            |r| r.between(-limit, limit),
            sine,
            |x| Precise::sine_cosine(x).0,
        );
        assert_accurate(
            0.9,
            |r| r.between(-limit, limit),
            cosine,
            |x| Precise::sine_cosine(x).1,
        );
    }
    // The doubles next to multiples of π, where the reduction has to be exact.
    for n in (1..2000).chain((2000..500_000).step_by(97)) {
        let x = f64::from(n) * std::f64::consts::PI;
        let error = error_in_units(sine(x), Precise::sine_cosine(x).0);
        assert!(error < 0.9, "{x}: {error}");
    }
}

#[test]
fn the_hyperbolic_tangent_is_accurate_to_three_places() {
    assert_accurate(
        2.5,
        |r| r.between(-25.0, 25.0),
        hyperbolic_tangent,
        Precise::tanh,
    );
    assert_accurate(
        2.5,
        |r| r.between(-1.0, 1.0),
        hyperbolic_tangent,
        Precise::tanh,
    );
    assert_accurate(
        2.5,
        |r| r.magnitude(-6.0, -1.0),
        hyperbolic_tangent,
        Precise::tanh,
    );
}

#[test]
fn values_at_the_ends_of_the_range() {
    let (infinity, nan) = (f64::INFINITY, f64::NAN);
    let same = |value: f64, expected: f64, what: &str| {
        let equal = value.to_bits() == expected.to_bits() || (value.is_nan() && expected.is_nan());
        assert!(equal, "{what}: {value} instead of {expected}");
    };
    for (operation, x, expected) in [
        (Unary::Exp, 0.0, 1.0),
        (Unary::Exp, 709.782712893384, 1.7976931348622732e308),
        (Unary::Exp, 709.79, infinity),
        (Unary::Exp, infinity, infinity),
        (Unary::Exp, -745.2, 0.0),
        (Unary::Exp, -f64::INFINITY, 0.0),
        (Unary::Log, 1.0, 0.0),
        (Unary::Log, 0.0, -infinity),
        (Unary::Log, -0.0, -infinity),
        (Unary::Log, -1.0, nan),
        (Unary::Log, -infinity, nan),
        (Unary::Log, infinity, infinity),
        (Unary::Log, f64::from_bits(1), -744.4400719213812),
        (Unary::Log10, 1000.0, 3.0),
        (Unary::Sin, 0.0, 0.0),
        (Unary::Sin, -0.0, -0.0),
        (Unary::Sin, infinity, nan),
        (Unary::Sin, 1e22, -0.8522008497671888),
        (Unary::Cos, 0.0, 1.0),
        (Unary::Cos, -infinity, nan),
        (Unary::Tanh, 1000.0, 1.0),
        (Unary::Tanh, -infinity, -1.0),
        (Unary::Tanh, -0.0, -0.0),
        (Unary::Sqrt, -1.0, nan),
        (Unary::Cbrt, -27.0, -3.0),
        (Unary::Floor, -0.5, -1.0),
        (Unary::Sign, 3.0, 1.0),
        (Unary::Sign, -1e-300, -1.0),
        (Unary::Sign, 0.0, 0.0),
        (Unary::Sign, -0.0, -0.0),
        (Unary::Step, 2.0, 1.0),
        (Unary::Step, -2.0, 0.0),
        (Unary::Step, 0.0, 0.5),
        (Unary::Abs, -2.0, 2.0),
        (Unary::Asin, 2.0, nan),
    ] {
        same(operation.apply(x), expected, &format!("{operation:?} {x}"));
        same(operation.apply(nan), nan, &format!("{operation:?} NaN"));
    }
    for (operation, a, b, expected) in [
        (Binary::Power, 2.0, 10.0, 1024.0),
        (Binary::Power, 2.0, -2.0, 0.25),
        (Binary::Power, -2.0, 3.0, -8.0),
        (Binary::Power, -8.0, 1.0 / 3.0, nan),
        (Binary::Power, nan, 0.0, 1.0),
        (Binary::Power, 9.0, 0.5, 3.0),
        (Binary::Power, 0.0, -1.0, infinity),
        (Binary::Power, 2.0, 100.0, libm::pow(2.0, 100.0)),
        (Binary::Min, 1.0, 2.0, 1.0),
        (Binary::Min, nan, 2.0, nan),
        (Binary::Min, 1.0, nan, nan),
        (Binary::Max, 1.0, 2.0, 2.0),
        (Binary::Max, nan, 2.0, nan),
        (Binary::Max, 1.0, nan, nan),
        (Binary::Hypot, -3.0, 4.0, 5.0),
        (Binary::Atan2, 1.0, -1.0, 3.0 * std::f64::consts::FRAC_PI_4),
        (Binary::Less, 1.0, 2.0, 1.0),
        (Binary::Less, nan, 2.0, 0.0),
        (Binary::LessOrEqual, 2.0, 2.0, 1.0),
        (Binary::Equal, 0.0, -0.0, 1.0),
        (Binary::NotEqual, nan, nan, 1.0),
        (Binary::Divide, 1.0, 0.0, infinity),
    ] {
        same(
            operation.apply(a, b),
            expected,
            &format!("{operation:?} {a} {b}"),
        );
    }
    same(select(1.0, 2.0, 3.0), 2.0, "select");
    same(select(-0.0, 2.0, 3.0), 3.0, "select");
    same(select(nan, 2.0, 3.0), nan, "select");
}

#[test]
fn symmetries_and_identities_hold_to_the_last_bit() {
    let unary = [
        Unary::Sign,
        Unary::Cbrt,
        Unary::Sin,
        Unary::Tan,
        Unary::Asin,
        Unary::Atan,
        Unary::Sinh,
        Unary::Tanh,
        Unary::Abs,
        Unary::Cos,
        Unary::Cosh,
    ];
    let mut random = Random(2);
    for _ in 0..20_000 {
        let x = random.magnitude(-20.0, 8.0);
        for operation in unary {
            let (right, left) = (operation.apply(x), operation.apply(-x));
            let expected = if operation.is_odd() { -right } else { right };
            assert!(operation.is_odd() != operation.is_even());
            assert!(
                left.to_bits() == expected.to_bits() || left.is_nan(),
                "{operation:?} {x}"
            );
        }
        // x x² is (x x) x, and powers of squares are powers.
        let (y, z) = (random.magnitude(-20.0, 20.0), random.magnitude(-3.0, 3.0));
        assert_eq!(integer_power(y, 3).to_bits(), (y * y * y).to_bits());
        assert_eq!(integer_power(y, 2).to_bits(), (y * y).to_bits());
        assert_eq!(
            integer_power(-z, 7).to_bits(),
            (-integer_power(z, 7)).to_bits()
        );
        assert_eq!(
            integer_power(-z, -6).to_bits(),
            integer_power(z, -6).to_bits()
        );
        assert!((integer_power(z, 13) / libm::pow(z, 13.0) - 1.0).abs() < 1e-14);
    }
}
