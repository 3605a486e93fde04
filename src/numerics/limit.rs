//! The limit of a quantity whose argument tends to zero.

/// The limit at zero from the values at h, r h and r² h, r being the ratio: what is off by multiples of h and of h²
/// falls out (L. F. Richardson, Philosophical Transactions A 210, 1911). What is left is of order h³.
pub(crate) fn limit_at_zero(values: [f64; 3], ratio: f64) -> f64 {
    let [first, second, third] = values;
    let straight = |near: f64, far: f64| (ratio * near - far) / (ratio - 1.0);
    let (near, far) = (straight(first, second), straight(second, third));
    (ratio * ratio * near - far) / (ratio * ratio - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_has_its_value_at_zero() {
        let values = [0.1, 0.4, 1.6].map(|h: f64| 0.7 - 2.0 * h + 3.0 * h * h);
        assert!((limit_at_zero(values, 4.0) - 0.7).abs() < 1e-14);
    }
}
