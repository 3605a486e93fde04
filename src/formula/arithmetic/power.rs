//! Powers: small integers by repeated multiplication, the rest by `libm`.

/// Integer exponents up to this magnitude are repeated multiplications.
const INTEGER_POWERS: i32 = 64;

/// The exponent as an integer, if it is one of those that are multiplied out.
#[inline]
pub(crate) fn small_integer(exponent: f64) -> Option<i32> {
    // The comparison of the values refuses fractions and NaN.
    let integer = exponent as i32;
    (f64::from(integer) == exponent && integer.abs() <= INTEGER_POWERS).then_some(integer)
}

/// baseᵉˣᵖᵒⁿᵉⁿᵗ. NaN for a negative base with an exponent that is not an integer.
pub(crate) fn power(base: f64, exponent: f64) -> f64 {
    if exponent == 0.5 {
        base.sqrt()
    } else if let Some(integer) = small_integer(exponent) {
        integer_power(base, integer)
    } else {
        libm::pow(base, exponent)
    }
}

/// baseⁿ as the product of the base's squares, squares of squares, …, lowest first: x⁷ = (x x²) x⁴. A tape does
/// exactly this. 1 for n = 0; for n < 0 the reciprocal of the power.
pub(crate) fn integer_power(base: f64, n: i32) -> f64 {
    let (mut square, mut left, mut product) = (base, n.unsigned_abs(), None);
    while left > 0 {
        if left & 1 == 1 {
            product = Some(product.map_or(square, |product: f64| product * square));
        }
        square *= square;
        left >>= 1;
    }
    let product = product.unwrap_or(1.0);
    if n < 0 { 1.0 / product } else { product }
}
