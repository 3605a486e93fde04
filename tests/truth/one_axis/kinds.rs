//! Kinds of systems of one axis, all of whose answers are closed forms or series of positive terms.

use statrs::function::gamma::ln_gamma;

use super::Case;
use crate::common::numbers::Numbers;

pub(super) const KINDS: [fn(&mut Numbers) -> Case; 7] = [
    square_root,
    between_two_ends,
    linear,
    growing_noise,
    logistic,
    immigration,
    on_a_wall,
];

/// Σ f_n (b^(n+1) - a^(n+1))/(n + 1) of coefficients from the first and their ratios: mean times upward.
fn series((from, to): (f64, f64), first: f64, ratio: impl Fn(f64) -> f64) -> f64 {
    let (mut sum, mut coefficient) = (0.0, first);
    let (mut low, mut high) = (from, to);
    for n in 0..200_000 {
        let n = f64::from(n);
        let term = coefficient * (high - low) / (n + 1.0);
        sum += term;
        if n > 10.0 && term.abs() < 1e-17 * sum {
            break;
        }
        coefficient *= ratio(n + 1.0);
        low *= from;
        high *= to;
    }
    sum
}

/// Σ f_n b^(2n + 2)/(2n + 2): mean times from 0 to ±b.
fn even_series(to: f64, first: f64, ratio: impl Fn(f64) -> f64) -> f64 {
    let (mut sum, mut power) = (0.0, first * to * to);
    for n in 0..200_000 {
        let n = f64::from(n);
        let term = power / (2.0 * n + 2.0);
        sum += term;
        if term.abs() < 1e-17 * sum.abs() {
            break;
        }
        power *= ratio(n + 1.0) * to * to;
    }
    sum
}

/// x' = k (c - x) + s √x ξ: a gamma density.
fn square_root(numbers: &mut Numbers) -> Case {
    let [k, c, s] = [(0.3, 3.0), (0.2, 3.0), (0.3, 2.0)].map(|(a, b)| numbers.rounded(a, b));
    let (shape, scale) = (2.0 * k * c / (s * s), s * s / (2.0 * k));
    let mut case = Case::new(
        format!("square root {k} {c} {s}, power {:.2}", shape - 1.0),
        format!("{k}*({c} - x)"),
        &[format!("{s}*sqrt(x)")],
    );
    case.moments(c, shape * scale * scale);
    case.mean(
        "r",
        "sqrt(x)",
        (ln_gamma(shape + 0.5) - ln_gamma(shape)).exp() * scale.sqrt(),
    );
    let to = c + 8.0 * shape.sqrt() * scale;
    case.rest = format!("[cells]\nx = {{ from = 0, to = {to:.2} }}\n");
    let cube = shape * (shape + 1.0) * (shape + 2.0);
    case.mean("c", "x^3", cube * scale.powi(3));
    case.rates(&[k, 2.0 * k, 3.0 * k]);
    case.spectrum = Some((shape * scale * scale, k));
    let [from, to] = [
        numbers.rounded(0.05, 0.9) * c,
        c * numbers.rounded(1.0, 2.5),
    ];
    let time = series((from, to), 1.0 / (k * c), |n| k / (0.5 * s * s * n + k * c));
    case.passage(from, format!("x > {to:?}"), time);
    case
}

/// x' = k (m - x) + s √(x (1 - x)) ξ: a beta density.
fn between_two_ends(numbers: &mut Numbers) -> Case {
    let [k, m, s] = [(0.3, 2.0), (0.1, 0.9), (0.3, 1.6)].map(|(a, b)| numbers.rounded(a, b));
    let sum = 2.0 * k / (s * s);
    let (alpha, beta) = (sum * m, sum * (1.0 - m));
    let mut case = Case::new(
        format!(
            "two ends {k} {m} {s}, powers {:.2} {:.2}",
            alpha - 1.0,
            beta - 1.0
        ),
        format!("{k}*({m} - x)"),
        &[format!("{s}*sqrt(x*(1 - x))")],
    );
    let variance = m * (1.0 - m) / (sum + 1.0);
    case.moments(m, variance);
    let root = ln_gamma(alpha + 0.5) - ln_gamma(alpha) + ln_gamma(sum) - ln_gamma(sum + 0.5);
    case.mean("r", "sqrt(x)", root.exp());
    case.mean("h", "x*(1 - x)", alpha * beta / (sum * (sum + 1.0)));
    case.rates(&[1.0, 2.0, 3.0].map(|n| n * (k + 0.5 * (n - 1.0) * s * s)));
    case.spectrum = Some((variance, k));
    let [from, to] = [numbers.rounded(0.02, 0.5), numbers.rounded(0.55, 0.95)];
    let time = series((from, to), 1.0 / (k * m), |n| {
        (k + 0.5 * s * s * (n - 1.0)) / (0.5 * s * s * n + k * m)
    });
    case.passage(from, format!("x > {to}"), time);
    case
}

/// x' = -k x + c ξ: a normal density.
fn linear(numbers: &mut Numbers) -> Case {
    let [k, c] = [(0.3, 3.0), (0.3, 2.5)].map(|(a, b)| numbers.rounded(a, b));
    let variance: f64 = 0.5 * c * c / k;
    let mut case = Case::new(
        format!("linear {k} {c}"),
        format!("-{k}*x"),
        &[format!("{c}")],
    );
    case.moments(0.0, variance);
    case.mean("e", "exp(3*x)", (4.5 * variance).exp());
    case.mean("f", "x^10", 945.0 * variance.powi(5));
    case.mean(
        "a",
        "abs(x)",
        (2.0 * variance / std::f64::consts::PI).sqrt(),
    );
    case.mean(
        "j",
        "step(x - 0.123)",
        0.5 * statrs::function::erf::erfc(0.123 / (2.0 * variance).sqrt()),
    );
    case.rates(&[k, 2.0 * k, 3.0 * k]);
    case.spectrum = Some((variance, k));
    let to = numbers.rounded(0.5, 2.5) * variance.sqrt();
    let time = even_series(to, 2.0 / (c * c), |n| 2.0 * k / (c * c * (2.0 * n + 1.0)));
    case.passage(0.0, format!("abs(x) > {to:?}"), time);
    case
}

/// x' = -k x + c ξ₁ + s x ξ₂: a density that falls like |x|^-(2 + 2k/s²).
fn growing_noise(numbers: &mut Numbers) -> Case {
    let [k, c, s] = [(0.5, 2.0), (0.3, 1.5), (0.3, 1.0)].map(|(a, b)| numbers.rounded(a, b));
    let s = s * k.sqrt();
    let variance = c * c / (2.0 * k - s * s);
    let mut case = Case::new(
        format!(
            "growing noise {k} {c} {s:.3}, power {:.2}",
            2.0 + 2.0 * k / (s * s)
        ),
        format!("-{k}*x"),
        &[format!("{c}"), format!("{s:?}*x")],
    );
    case.moments(0.0, variance);
    case.mean("q", "x^2", variance);
    if 2.0 * k > 3.2 * s * s {
        let fourth = 6.0 * c * c * variance / (4.0 * k - 6.0 * s * s);
        case.mean("f", "x^4", fourth);
    }
    // Of polynomials of degree n there is a mean square where n < 1/2 + k/s²; the rest is continuous.
    let rates = [1.0, 2.0, 3.0]
        .into_iter()
        .filter(|n| *n < 0.4 + k / (s * s));
    let rates: Vec<f64> = rates.map(|n| n * k - 0.5 * n * (n - 1.0) * s * s).collect();
    case.rates(&rates);
    case.spectrum = Some((variance, k));
    let to = numbers.rounded(0.3, 0.9) * c / s;
    let time = even_series(to, 2.0 / (c * c), |n| {
        (k - 0.5 * s * s * (2.0 * n - 1.0)) / (0.5 * c * c * (2.0 * n + 1.0))
    });
    case.passage(0.0, format!("abs(x) > {to:?}"), time);
    case
}

/// x' = x (r - x) + s x ξ: a gamma density whose noise dies with x.
fn logistic(numbers: &mut Numbers) -> Case {
    let [r, s] = [(0.5, 2.0), (0.25, 1.0)].map(|(a, b)| numbers.rounded(a, b));
    let s = s * r.sqrt();
    let (shape, scale) = (2.0 * r / (s * s) - 1.0, 0.5 * s * s);
    let mut case = Case::new(
        format!("logistic {r} {s:.3}, power {:.2}", shape - 1.0),
        format!("x*({r} - x)"),
        &[format!("{s:?}*x")],
    );
    case.moments(shape * scale, shape * scale * scale);
    case.mean(
        "r",
        "sqrt(x)",
        (ln_gamma(shape + 0.5) - ln_gamma(shape)).exp() * scale.sqrt(),
    );
    let mean = r - 0.5 * s * s;
    let rates = [1.0, 2.0].into_iter().filter(|n| n * s * s < 0.9 * mean);
    case.rates(
        &rates
            .map(|n| n * mean - 0.5 * n * n * s * s)
            .collect::<Vec<_>>(),
    );
    case
}

/// x' = c - k x + s x ξ: 1/x has a gamma density.
fn immigration(numbers: &mut Numbers) -> Case {
    let [c, k, s] = [(0.2, 2.0), (0.5, 2.0), (0.3, 0.95)].map(|(a, b)| numbers.rounded(a, b));
    let s = s * k.sqrt();
    let (shape, rate) = (1.0 + 2.0 * k / (s * s), 2.0 * c / (s * s));
    let mut case = Case::new(
        format!("immigration {c} {k} {s:.3}, power {:.2}", shape + 1.0),
        format!("{c} - {k}*x"),
        &[format!("{s:?}*x")],
    );
    let mean = rate / (shape - 1.0);
    let variance = mean * mean / (shape - 2.0);
    case.moments(mean, variance);
    let root = (ln_gamma(shape - 0.5) - ln_gamma(shape)).exp() * rate.sqrt();
    case.mean("r", "sqrt(x)", root);
    case.mean("q", "x^2", variance + mean * mean);
    let rates = [1.0, 2.0].into_iter().filter(|n| *n < 0.4 + k / (s * s));
    case.rates(
        &rates
            .map(|n| n * k - 0.5 * n * (n - 1.0) * s * s)
            .collect::<Vec<_>>(),
    );
    case.spectrum = Some((variance, k));
    case
}

/// x' = -g + c ξ on a wall: an exponential density.
fn on_a_wall(numbers: &mut Numbers) -> Case {
    let [g, c] = [(0.3, 3.0), (0.4, 2.0)].map(|(a, b)| numbers.rounded(a, b));
    let length = 0.5 * c * c / g;
    let mut case = Case::new(format!("wall {g} {c}"), format!("-{g}"), &[format!("{c}")]);
    case.rest =
        "[system.bounds]\nx = [\"reflecting\", \"open\"]\n[cells]\nx = { from = 0 }\n".into();
    case.moments(length, length * length);
    case.mean("q", "x^2", 2.0 * length * length);
    case.mean("r", "sqrt(x)", 0.5 * (std::f64::consts::PI * length).sqrt());
    // All rates from here on are there.
    case.rates(&[0.5 * g * g / (c * c)]);
    let to = numbers.rounded(0.5, 4.0) * length;
    case.passage(
        0.0,
        format!("x > {to:?}"),
        (length * ((to / length).exp() - 1.0) - to) / g,
    );
    case
}
