//! Exponential, logarithm and hyperbolic tangent without branches. Errors stay below one unit in the last place, three
//! for the hyperbolic tangent. Polynomials are Taylor series, cut where the next term is below the rounding.

/// 1.5·2⁵²: a number below 2⁵¹ added to it is rounded to an integer, which stands in the low bits.
const ROUND: f64 = 6_755_399_441_055_744.0;
/// ln 2 to 33 bits, so that its products with exponents are exact, and the rest.
const LN2_HIGH: f64 = 0.693_147_180_485_539_1;
const LN2_LOW: f64 = 7.440_617_110_012_397e-11;
/// Bits of √½, where one octave of the logarithm ends and the next begins.
const ROOT_HALF: u64 = 0x3fe6_a09e_667f_3bcd;
const TWO_52: u64 = 0x4330_0000_0000_0000;

/// 2ᵏ for an integer -1022 ≤ k ≤ 1023.
#[inline(always)]
fn two_to_the(k: f64) -> f64 {
    f64::from_bits((k + (ROUND + 1023.0)).to_bits() << 52)
}

/// The integer k nearest to x/ln 2, and e^(x - k ln 2) - 1, whose magnitude is below ½.
#[inline(always)]
fn reduced(x: f64) -> (f64, f64) {
    let k = (x * std::f64::consts::LOG2_E + ROUND) - ROUND;
    let high = x - k * LN2_HIGH;
    let low = k * LN2_LOW;
    let r = high - low;
    // e^r - 1 - r = r² (1/2 + r/6 + r²/24 + …); the first term left out is 0.35¹⁴/14! = 4e-18.
    let tail = 1.0 / 39_916_800.0 + r * (1.0 / 479_001_600.0 + r * (1.0 / 6_227_020_800.0));
    let tail = 1.0 / 40_320.0 + r * (1.0 / 362_880.0 + r * (1.0 / 3_628_800.0 + r * tail));
    let tail = 1.0 / 120.0 + r * (1.0 / 720.0 + r * (1.0 / 5_040.0 + r * tail));
    let tail = 1.0 / 2.0 + r * (1.0 / 6.0 + r * (1.0 / 24.0 + r * tail));
    (k, high + (r * r * tail - low))
}

/// eˣ. Beyond ±746 the result is infinite or zero.
#[inline(always)]
pub(crate) fn exponential(x: f64) -> f64 {
    let clamped = if x > 710.0 { 710.0 } else { x };
    let clamped = if clamped < -746.0 { -746.0 } else { clamped };
    let (k, less_one) = reduced(clamped);
    // In two factors, so that neither overflows before the result does.
    let half = (k * 0.5 + ROUND) - ROUND;
    (1.0 + less_one) * two_to_the(half) * two_to_the(k - half)
}

/// tanh x = (e²ˣ - 1)/(e²ˣ + 1), from e²ˣ - 1 without cancellation; an odd function to the last bit.
#[inline(always)]
pub(crate) fn hyperbolic_tangent(x: f64) -> f64 {
    // At 2x = 44 the quotient is 1 to the last bit.
    let double = 2.0 * x.abs();
    let clamped = if double > 44.0 { 44.0 } else { double };
    let (k, less_one) = reduced(clamped);
    let scale = two_to_the(k);
    let grown = (scale - 1.0) + scale * less_one;
    (grown / (grown + 2.0)).copysign(x)
}

/// The natural logarithm.
#[inline(always)]
pub(crate) fn logarithm(x: f64) -> f64 {
    let tiny = x < f64::MIN_POSITIVE;
    let normal = if tiny {
        x * 18_014_398_509_481_984.0
    } else {
        x
    };
    let shift = if tiny { 54.0 } else { 0.0 };
    // normal = mantissa 2^(octave - 1023) with √½ ≤ mantissa < √2.
    let bits = normal.to_bits();
    let octave = bits.wrapping_sub(ROOT_HALF).wrapping_add(1023 << 52) >> 52;
    let mantissa = f64::from_bits(bits.wrapping_add(1023 << 52).wrapping_sub(octave << 52));
    let k = f64::from_bits(octave | TWO_52) - (f64::from_bits(TWO_52) + 1023.0) - shift;
    // ln(1 + f) = 2 artanh s = f - f²/2 + s (f²/2 + R), s = f/(2 + f), R = 2 (s²/3 + s⁴/5 + …);
    // |s| < 0.172, and the first term left out is 2·0.0295¹¹/23 = 1e-18.
    let f = mantissa - 1.0;
    let s = f / (2.0 + f);
    let w = s * s;
    let series = 2.0 / 17.0 + w * (2.0 / 19.0 + w * (2.0 / 21.0));
    let series = 2.0 / 11.0 + w * (2.0 / 13.0 + w * (2.0 / 15.0 + w * series));
    let series = 2.0 / 5.0 + w * (2.0 / 7.0 + w * (2.0 / 9.0 + w * series));
    let series = w * (2.0 / 3.0 + w * series);
    let half_square = 0.5 * f * f;
    let tail = half_square - (s * (half_square + series) + k * LN2_LOW);
    let value = k * LN2_HIGH - (tail - f);
    // Infinity and NaN stay; zero is -∞, negative numbers NaN.
    let value = if x < f64::INFINITY { value } else { x };
    let value = if x == 0.0 { f64::NEG_INFINITY } else { value };
    if x < 0.0 { f64::NAN } else { value }
}
