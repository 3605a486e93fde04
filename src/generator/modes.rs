//! The rates along an axis of modes: a dense block for every place on the other axes.
//!
//! Tested with a polynomial f of degree below N, a drift b along the axis gives
//! d/dt Σ_k u_k f(s_k) = Σ_k u_k b(s_k) f'(s_k), Gauss's rule for the exact ∫ p b f' ds. With f the Lagrange polynomials of the
//! nodes that is the block; by the degree of the rule it is exact for every drift that is a polynomial of degree 2 in s, and
//! spectrally accurate for any smooth one. Walls need no condition: nothing is tested beyond them.

/// One entry `from · count + to` a pair of nodes: the rate from the one into the other.
pub(super) fn block(differentiation: &[f64], drift: &[f64], rates: &mut [f64]) {
    let count = drift.len();
    for (from, &drift) in drift.iter().enumerate() {
        let row = from * count..(from + 1) * count;
        let slopes = &differentiation[row.clone()];
        for (rate, slope) in rates[row].iter_mut().zip(slopes) {
            *rate = drift * slope;
        }
    }
}
