//! Exponents against closed forms.

use super::{Exponent, ExponentError, largest};
use crate::system::Linearised;

/// The exponent of matrices by rows.
fn exponent(drift: [[f64; 2]; 2], noises: &[[[f64; 2]; 2]]) -> Exponent {
    let rows = |m: &[[f64; 2]; 2]| m.iter().map(|row| row.to_vec()).collect::<Vec<_>>();
    let linear = Linearised {
        drift: rows(&drift),
        noises: noises.iter().map(rows).collect(),
    };
    largest(&linear).unwrap()
}

/// That of v1' = v2, v2' = α v1 + β v2 + σ v1 ξ.
fn of_oscillator(alpha: f64, beta: f64, sigma: f64) -> Exponent {
    exponent([[0.0, 1.0], [alpha, beta]], &[[[0.0, 0.0], [sigma, 0.0]]])
}

/// [AiAi' + BiBi'] / [Ai² + Bi²] at x, by Taylor steps of Airy's equation y'' = x y from zero.
fn airy_quotient(x: f64) -> f64 {
    // Ai(0) and Ai'(0); those of Bi are √3 times as large, the slope with the other sign.
    let (ai, slope) = (0.355_028_053_887_817_2, -0.258_819_403_792_806_8);
    let root = 3f64.sqrt();
    let mut known = [[ai, slope], [root * ai, -root * slope]];
    let steps = (x.abs() / 0.1).ceil().max(1.0);
    let h = x / steps;
    for step in 0..steps as usize {
        let at = step as f64 * h;
        known = known.map(|[y, dy]| {
            let mut terms = vec![y, dy, 0.5 * at * y];
            for n in 1..28 {
                let next = (at * terms[n] + terms[n - 1]) / ((n + 1) * (n + 2)) as f64;
                terms.push(next);
            }
            let value = terms.iter().rev().fold(0.0, |sum, term| sum * h + term);
            let slopes = terms.iter().enumerate().skip(1).rev();
            let slope = slopes.fold(0.0, |sum, (n, term)| sum * h + n as f64 * term);
            [value, slope]
        });
    }
    let [[a, da], [b, db]] = known;
    (a * da + b * db) / (a * a + b * b)
}

/// Source: P. Imkeller and C. Lederer, An explicit description of the Lyapunov exponents of the noisy damped harmonic
/// oscillator, Dynamics and Stability of Systems 14, 1999.
fn by_airy(alpha: f64, beta: f64, sigma: f64) -> f64 {
    let half = 0.5 * sigma * sigma;
    let s = (-alpha - 0.25 * beta * beta) / half.powf(2.0 / 3.0);
    0.5 * beta + half.cbrt() * airy_quotient(-s)
}

/// Numbers between 0 and 1 that look random.
fn numbers() -> impl FnMut() -> f64 {
    let mut state = 0x9e37_79b9_7f4a_7c15u64;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

#[test]
fn oscillators_with_noise_in_their_stiffness_have_the_exponents_of_the_closed_form() {
    let mut number = numbers();
    let mut within = |from: f64, to: f64| from + (to - from) * number();
    for _ in 0..200 {
        let (alpha, beta, sigma) = (within(-2.0, 1.0), within(-1.5, 1.0), within(0.15, 2.0));
        let (found, exact) = (
            of_oscillator(alpha, beta, sigma),
            by_airy(alpha, beta, sigma),
        );
        let off = (found.value - exact).abs();
        assert!(
            off < 1e-12 && found.error < 1e-11 && off <= found.error + 1e-13,
            "α {alpha}, β {beta}, σ {sigma}: {found:?} for {exact}"
        );
    }
}

#[test]
fn faint_noise_takes_more_modes_and_the_error_holds() {
    for sigma in [0.1, 0.03, 0.01] {
        // At critical damping the exponent goes as σ^(2/3).
        let (found, exact) = (
            of_oscillator(-0.01, -0.2, sigma),
            by_airy(-0.01, -0.2, sigma),
        );
        assert!(
            (found.value - exact).abs() <= found.error,
            "{found:?}, {exact}"
        );
        for (alpha, beta) in [(-1.0, -0.1), (0.5, -1.0)] {
            let found = of_oscillator(alpha, beta, sigma);
            let quiet = of_oscillator(alpha, beta, 0.0);
            assert!(found.error < 1e-10, "{found:?}");
            // The first correction is of the order of σ².
            assert!((found.value - quiet.value).abs() < sigma * sigma);
        }
    }
}

#[test]
fn the_fixed_point_of_duffing_and_van_der_pol_changes_its_stability_where_it_is_known_to() {
    for (sigma, zero) in [
        (0.2, -0.009_996_510_0),
        (0.5, -0.061_722_831_0),
        (1.0, -0.222_527_174_3),
    ] {
        let found = of_oscillator(-1.0, zero, sigma);
        assert!(found.value.abs() < 6e-11, "σ {sigma}: {found:?}");
    }
}

#[test]
fn noise_that_turns_all_directions_alike_makes_a_density_of_von_mises() {
    // p ∝ exp(κ cos 2φ), whose mean cosine is I₁(κ)/I₀(κ).
    let bessel = |order: u32, x: f64| {
        let mut term = (1..=order).fold(1.0, |term, k| term * 0.5 * x / f64::from(k));
        let mut sum = term;
        for k in 1..60 {
            term *= 0.25 * x * x / f64::from(k * (k + order));
            sum += term;
        }
        sum
    };
    for (a, b, sigma) in [(0.4, -1.0, 0.5), (0.2, 0.1, 2.0), (-1.0, 1.0, 0.4)] {
        let found = exponent([[a, 0.0], [0.0, b]], &[[[0.0, -sigma], [sigma, 0.0]]]);
        let kappa = (a - b) / (2.0 * sigma * sigma);
        let mean = bessel(1, kappa) / bessel(0, kappa);
        let exact = 0.5 * (a + b) + 0.5 * (a - b) * mean + 0.5 * sigma * sigma;
        assert!((found.value - exact).abs() < 1e-13, "{found:?}, {exact}");
    }
}

#[test]
fn exponents_do_not_depend_on_the_coordinates() {
    let (drift, noises) = (
        [[-0.3, 1.1], [-1.4, 0.2]],
        [[[0.2, 0.0], [0.5, -0.3]], [[0.0, 0.4], [0.1, 0.6]]],
    );
    let own = exponent(drift, &noises);
    // With v = M w the matrices are M⁻¹ A M.
    let (m, inverse) = ([[2.0, 1.0], [1.0, 1.0]], [[1.0, -1.0], [-1.0, 2.0]]);
    let product = |a: [[f64; 2]; 2], b: [[f64; 2]; 2]| {
        let entry = |i: usize, j: usize| a[i][0] * b[0][j] + a[i][1] * b[1][j];
        [[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]]
    };
    let seen = |a| product(inverse, product(a, m));
    let other = exponent(seen(drift), &noises.map(seen));
    assert!((own.value - other.value).abs() <= own.error + other.error);
    assert!(own.error < 1e-12);
}

#[test]
fn directions_that_nothing_leaves_and_angles_without_noise_are_exact() {
    // Two axes that do not know of each other.
    let found = exponent([[0.3, 0.0], [0.0, 0.1]], &[[[1.0, 0.0], [0.0, 0.0]]]);
    assert!((found.value - 0.1).abs() <= found.error, "{found:?}");
    // A triangle, in other coordinates: exponents 0.3 - 0.5 and -0.4 - 0.02.
    let found = exponent([[-0.4, 0.0], [0.7, 0.3]], &[[[0.2, 0.0], [0.8, 1.0]]]);
    assert!((found.value + 0.2).abs() <= found.error, "{found:?}");
    // No noise: a focus, a node; and noise that stretches all directions alike.
    let focus = [[0.0, 1.0], [-1.0, -0.2]];
    assert!((exponent(focus, &[]).value + 0.1).abs() < 1e-15);
    assert!((exponent([[0.0, 1.0], [2.0, 1.0]], &[]).value - 2.0).abs() < 1e-15);
    let even = exponent(focus, &[[[0.5, 0.0], [0.0, 0.5]]]);
    assert!((even.value + 0.1 + 0.125).abs() < 1e-15);
}

#[test]
fn three_axes_are_refused() {
    let linear = Linearised {
        drift: vec![vec![0.0; 3]; 3],
        noises: Vec::new(),
    };
    assert_eq!(largest(&linear), Err(ExponentError::Axes { axes: 3 }));
}
