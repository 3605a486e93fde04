//! Increments for laws: four-point numbers in place of standard normals, many from one random word.
//!
//! Weak order 2 asks of a step's increment no more than the first five moments of a normal one (Kloeden and Platen
//! 1992, section 14.2; G. N. Milstein and M. V. Tretyakov, *Stochastic Numerics for Mathematical Physics*, 2004). With
//! probability 1/8 it is ±√(1 + √14), else ±√(1 - √14/7): mean square 1 and fourth moment 3, as of a normal number, and
//! a sixth moment of 13.4 where that has 15. Four random bits make one, where a normal number takes a word, a logarithm
//! and a root.

/// √(1 + √14).
const WIDE: f64 = 2.177_534_703_919_536;
/// √(1 - √14/7).
const NARROW: f64 = 0.682_259_126_853_684;
const SIGN: u64 = 1 << 63;

/// Numbers made of a word: its lowest 16 bits, which are less random, are not used.
pub(super) const A_WORD: usize = 12;

/// The number of the highest four bits of a word.
#[inline(always)]
pub(super) fn four_point(word: u64) -> f64 {
    let size = if (word << 1) >> 61 == 0 { WIDE } else { NARROW };
    f64::from_bits(size.to_bits() | (word & SIGN))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_up_to_the_fifth_are_those_of_a_normal_number() {
        let moment = |power: i32| -> f64 {
            let all = (0..16_u64).map(|bits| four_point(bits << 60 | bits));
            all.map(|value| value.powi(power)).sum::<f64>() / 16.0
        };
        for (power, exact) in [(1, 0.0), (2, 1.0), (3, 0.0), (4, 3.0), (5, 0.0)] {
            assert!((moment(power) - exact).abs() < 1e-14, "{power}");
        }
        assert!((moment(6) - 13.42).abs() < 0.01, "{}", moment(6));
    }
}
