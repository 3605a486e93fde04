//! Sine and cosine without branches, error below one unit in the last place.
//!
//! The argument is reduced by a multiple of π/2 in four parts (Cody and Waite), exact enough for every number up to
//! [`REDUCED`]; beyond, `libm` answers.

use std::f64::consts::FRAC_2_PI;

/// Largest magnitude that is reduced here.
pub(crate) const REDUCED: f64 = 1.6e6;
/// 1.5·2⁵²: see `exponential`.
const ROUND: f64 = 6_755_399_441_055_744.0;
/// π/2 as a sum; products of the first three with integers below 2²⁰ are exact.
const QUARTER: [f64; 4] = [
    1.570_796_326_734_125_6,
    6.077_100_506_303_966e-11,
    2.022_266_248_711_166_5e-21,
    8.478_427_660_368_9e-32,
];

/// Sine and cosine of the remainder of a number 0 ≤ x ≤ [`REDUCED`], and the number of quarter turns in its low bits.
#[inline(always)]
fn sine_cosine(x: f64) -> (f64, f64, u64) {
    let rounded = x * FRAC_2_PI + ROUND;
    let quarters = rounded - ROUND;
    // x - n π/2 as r + tail; the first difference is exact, of the second the rounding error is kept.
    let first = x - quarters * QUARTER[0];
    let (second, lost) = difference(first, quarters * QUARTER[1]);
    let (third, lost_too) = difference(second, quarters * QUARTER[2]);
    let low = lost + lost_too - quarters * QUARTER[3];
    let r = third + low;
    let tail = (third - r) + low;
    let w = r * r;
    // sin r = r - r³ (1/3! - r²/5! + …), |r| < 0.79: the first term left out is r¹⁹/19! = 8e-20.
    let sine =
        1.0 / 6_227_020_800.0 - w * (1.0 / 1_307_674_368_000.0 - w * (1.0 / 355_687_428_096_000.0));
    let sine = 1.0 / 5_040.0 - w * (1.0 / 362_880.0 - w * (1.0 / 39_916_800.0 - w * sine));
    let sine = 1.0 / 6.0 - w * (1.0 / 120.0 - w * sine);
    // d(sin r) = (1 - r²/2) tail, d(cos r) = -r tail.
    let sine = r - (w * r * sine - tail * (1.0 - 0.5 * w));
    // cos r = 1 - r²/2 + r⁴ (1/4! - r²/6! + …), the first term left out r¹⁸/18! = 2e-18.
    let cosine = 1.0 / 87_178_291_200.0 - w * (1.0 / 20_922_789_888_000.0);
    let cosine = 1.0 / 40_320.0 - w * (1.0 / 3_628_800.0 - w * (1.0 / 479_001_600.0 - w * cosine));
    let cosine = 1.0 / 24.0 - w * (1.0 / 720.0 - w * cosine);
    let half = 0.5 * w;
    let main = 1.0 - half;
    let cosine = main + (((1.0 - main) - half) + (w * w * cosine - r * tail));
    (sine, cosine, rounded.to_bits())
}

/// a - b and the rounding error of it: their sum is exact.
#[inline(always)]
fn difference(a: f64, b: f64) -> (f64, f64) {
    let difference = a - b;
    let subtracted = a - difference;
    let error = (a - (difference + subtracted)) + (subtracted - b);
    (difference, error)
}

/// sin x for |x| ≤ [`REDUCED`]; an odd function to the last bit.
#[inline(always)]
pub(crate) fn reduced_sine(x: f64) -> f64 {
    let (sine, cosine, quarters) = sine_cosine(x.abs());
    let value = if quarters & 1 == 0 { sine } else { cosine };
    let turned = (quarters & 2) << 62;
    f64::from_bits(value.to_bits() ^ turned ^ (x.to_bits() & (1 << 63)))
}

/// cos x for |x| ≤ [`REDUCED`].
#[inline(always)]
pub(crate) fn reduced_cosine(x: f64) -> f64 {
    let (sine, cosine, quarters) = sine_cosine(x.abs());
    let value = if quarters & 1 == 0 { cosine } else { sine };
    let turned = (quarters.wrapping_add(1) & 2) << 62;
    f64::from_bits(value.to_bits() ^ turned)
}

/// sin x.
#[inline(always)]
pub(crate) fn sine(x: f64) -> f64 {
    if x.abs() <= REDUCED {
        reduced_sine(x)
    } else {
        libm::sin(x)
    }
}

/// cos x.
#[inline(always)]
pub(crate) fn cosine(x: f64) -> f64 {
    if x.abs() <= REDUCED {
        reduced_cosine(x)
    } else {
        libm::cos(x)
    }
}
