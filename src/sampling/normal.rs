//! A Box-Muller transform made of polynomials, so that it runs on vector registers.
//!
//! With u uniform in (0, 1] and φ uniform in [-π/4, π/4), √(-ln u)·(cos φ ∓ sin φ) are the two legs
//! √(-2 ln u)·cos(φ + π/4) and √(-2 ln u)·sin(φ + π/4) of the first quadrant; two random signs complete the
//! circle. Polynomials are Taylor series cut below 1e-13 on these short intervals.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, LN_2};

/// Bits of 1.0: a mantissa joined to it is a number in [1, 2).
const ONE: u64 = 0x3ff0_0000_0000_0000;
/// Bits of 2⁵²: an integer below 2⁵² joined to it is that integer plus 2⁵².
const TWO_52: u64 = 0x4330_0000_0000_0000;
/// Bits of √½, where one octave of the logarithm ends and the next begins.
const ROOT_HALF: u64 = 0x3fe6_a09e_667f_3bcd;
const SIGN: u64 = 1 << 63;

/// Two independent standard normals from two independent random words, whose lowest ten bits are not used.
/// Their magnitude is at most √(104 ln 2) = 8.49.
#[inline(always)]
pub(super) fn normal_pair(radius: u64, angle: u64) -> (f64, f64) {
    // 2 - [1, 2) = (0, 1]: the logarithm is finite and 1 itself is exact.
    let uniform = 2.0 - f64::from_bits((radius >> 12) | ONE);
    let root = (-ln(uniform)).sqrt();
    // The two highest bits are the signs, the next 52 the angle.
    let share = f64::from_bits(((angle << 2) >> 12) | ONE) - 1.0;
    let (sine, cosine) = sine_cosine(share * FRAC_PI_2 - FRAC_PI_4);
    let first = root * (cosine - sine);
    let second = root * (cosine + sine);
    (
        f64::from_bits(first.to_bits() ^ (angle & SIGN)),
        f64::from_bits(second.to_bits() ^ ((angle << 1) & SIGN)),
    )
}

/// Natural logarithm of a normal number in (0, 1], relative error below 1e-13.
#[inline(always)]
fn ln(value: f64) -> f64 {
    // value = mantissa × 2^(octave - 1023) with √½ ≤ mantissa < √2.
    let bits = value.to_bits();
    let octave = bits.wrapping_sub(ROOT_HALF).wrapping_add(1023 << 52) >> 52;
    let mantissa = f64::from_bits(bits.wrapping_add(1023 << 52).wrapping_sub(octave << 52));
    let octaves = f64::from_bits(octave | TWO_52) - (f64::from_bits(TWO_52) + 1023.0);
    // ln m = 2 artanh((m-1)/(m+1)), an argument below 0.1716: the next term is 2·0.1716¹⁷/17 = 1e-14.
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let w = s * s;
    let series = 1.0 / 9.0 + w * (1.0 / 11.0 + w * (1.0 / 13.0 + w * (1.0 / 15.0)));
    let series = 1.0 / 3.0 + w * (1.0 / 5.0 + w * (1.0 / 7.0 + w * series));
    octaves * LN_2 + 2.0 * (s + s * w * series)
}

/// Sine and cosine on [-π/4, π/4], error below 1e-13: the next terms are φ¹⁵/15! = 2e-14, φ¹⁶/16! = 1e-15.
#[inline(always)]
fn sine_cosine(angle: f64) -> (f64, f64) {
    let w = angle * angle;
    let sine = 1.0 / 362_880.0 - w * (1.0 / 39_916_800.0 - w * (1.0 / 6_227_020_800.0));
    let sine = 1.0 / 6.0 - w * (1.0 / 120.0 - w * (1.0 / 5_040.0 - w * sine));
    let cosine = 1.0 / 3_628_800.0 - w * (1.0 / 479_001_600.0 - w * (1.0 / 87_178_291_200.0));
    let cosine = 1.0 / 24.0 - w * (1.0 / 720.0 - w * (1.0 / 40_320.0 - w * cosine));
    (angle - angle * w * sine, 1.0 - w * (0.5 - w * cosine))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    #[test]
    fn extreme_words_give_the_ends_of_the_distribution() {
        let largest = f64::sqrt(104.0 * LN_2);
        let (first, second) = normal_pair(u64::MAX, 0);
        assert!((first - largest).abs() < 1e-9 && second.abs() < 1e-9);
        let (first, second) = normal_pair(0, u64::MAX);
        assert!(first == 0.0 && second == 0.0);
    }

    #[test]
    fn the_logarithm_keeps_its_relative_accuracy_next_to_one() {
        for exponent in 1..=52 {
            for value in [1.0 - f64::powi(2.0, -exponent), f64::powi(2.0, -exponent)] {
                assert!((ln(value) / value.ln() - 1.0).abs() < 1e-13, "{value}");
            }
        }
    }

    proptest! {
        #[test]
        fn the_transform_is_box_muller(radius in any::<u64>(), angle in any::<u64>()) {
            let uniform = ((1_u64 << 52) - (radius >> 12)) as f64 / (1_u64 << 52) as f64;
            let share = ((angle << 2) >> 12) as f64 / (1_u64 << 52) as f64;
            let (sine, cosine) = (share * TAU / 4.0).sin_cos();
            let length = (-2.0 * uniform.ln()).sqrt();
            let sign = |bit: u32| if angle >> bit & 1 == 1 { -1.0 } else { 1.0 };
            let (first, second) = normal_pair(radius, angle);
            prop_assert!((first - sign(63) * length * cosine).abs() < 1e-12);
            prop_assert!((second - sign(62) * length * sine).abs() < 1e-12);
        }
    }
}
