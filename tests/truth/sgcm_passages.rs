//! Times of first passage by SGCM, whose paths end where they enter a region, against quadrature and closed forms.

use crate::common::sweeps::{measure, solved};
use crate::passages::{brownian_survival, by_quadrature};

/// A system, a passage of it, and exact numbers.
struct Case {
    what: &'static str,
    /// Equations and amplitudes of noise; `k` is 1.
    equations: &'static str,
    noise: &'static str,
    cells: &'static str,
    passage: &'static str,
    /// Name and value of each number, and the largest share of it that its error may be.
    exact: Vec<(&'static str, f64, f64)>,
}

impl Case {
    fn text(&self) -> String {
        format!(
            "[system.equations]\n{}\n[system.noise]\n{}\n[system.parameters]\nk = 1\n\
             [sweep]\nparameter = \"k\"\nfrom = 0.999\nto = 1.0\npoints = 2\n\
             [cells]\n{}\n[passage]\np = {{ {} }}\n[method]\nkind = \"sgcm\"\nsamples = 400\n",
            self.equations, self.noise, self.cells, self.passage
        )
    }
}

fn cases() -> Vec<Case> {
    let parabola = |x: f64| 0.5 * x * x;
    let (mean, deviation) = by_quadrature(parabola, 0.25, 0.0, 1.0, -3.0);
    let (rare, _) = by_quadrature(parabola, 0.25, 0.0, 1.75, -3.0);
    let upper = |x: f64| (-1.6 * (x + 1.0)).exp_m1() / (-1.6f64 * 2.3).exp_m1();
    // E T² = 5 T²/3 out of an interval.
    let brownian = (2.0_f64 / 3.0).sqrt();
    // T(0) = ∫_0^R (e^{s²/2} - 1)/s ds of Ornstein and Uhlenbeck's process out of a disc, unit variances.
    let series = (1..40).scan(1.0, |term, k| {
        *term *= 1.5 * 1.5 / (2.0 * f64::from(k));
        Some(*term / (2.0 * f64::from(k)))
    });
    let disc: f64 = series.sum();
    vec![
        Case {
            what: "two deviations",
            equations: "x = \"-k x\"",
            noise: "x = \"sqrt(0.5)\"",
            cells: "x = { from = -2.0, to = 2.0, count = 50 }",
            passage: "start = { x = 0 }, until = \"x > 1\"",
            exact: vec![("mean", mean, 0.08), ("sd", deviation, 0.08)],
        },
        // Monte Carlo would have to follow its 16384 paths for 1e9 steps.
        Case {
            what: "three and a half",
            equations: "x = \"-k x\"",
            noise: "x = \"sqrt(0.5)\"",
            cells: "x = { from = -2.0, to = 2.0, count = 50 }",
            passage: "start = { x = 0 }, until = \"x > 1.75\"",
            exact: vec![("mean", rare, 0.2), ("rate", 1.0 / rare, 0.2)],
        },
        // Without a steady state: paths leave the range.
        Case {
            what: "interval",
            equations: "x = \"0 x\"",
            noise: "x = \"sqrt(k)\"",
            cells: "x = { from = -1.3, to = 1.3, count = 40 }",
            passage: "start = { x = 0 }, until = \"abs(x) > 1\", times = [0.05, 0.5, 2.0]",
            exact: vec![
                ("mean", 1.0, 0.04),
                ("sd", brownian, 0.04),
                ("rate", std::f64::consts::PI.powi(2) / 8.0, 0.04),
                ("0.05_survival", brownian_survival(0.05), 0.04),
                ("0.5_survival", brownian_survival(0.5), 0.04),
                ("2_survival", brownian_survival(2.0), 0.1),
            ],
        },
        Case {
            what: "either end",
            equations: "x = \"0.4 k\"",
            noise: "x = \"sqrt(0.5)\"",
            cells: "x = { from = -1.6, to = 1.9, count = 50 }",
            passage: "start = { x = -0.9 }, until = [\"x > 1.3\", \"x < -1\"]",
            exact: vec![
                ("1_share", upper(-0.9), 0.1),
                ("2_share", 1.0 - upper(-0.9), 0.1),
            ],
        },
        // (D/Δ²)(e^{ΔA/D} - 1) - A/Δ, D = 1/4, Δ = A = 1; a face lies on the jump.
        Case {
            what: "dry friction",
            equations: "v = \"-k sign(v)\"",
            noise: "v = \"sqrt(0.5)\"",
            cells: "v = { from = -2.0, to = 2.0, count = 60 }",
            passage: "start = { v = 0 }, until = \"abs(v) > 1\"",
            exact: vec![("mean", 0.25 * (4.0_f64.exp() - 1.0) - 1.0, 0.08)],
        },
        Case {
            what: "disc",
            equations: "x = \"-k x\"\ny = \"-y\"",
            noise: "x = \"sqrt(2)\"\ny = \"sqrt(2)\"",
            cells: "x = { from = -2.0, to = 2.0, count = 20 }\ny = { from = -2.0, to = 2.0, count = 20 }",
            passage: "start = { x = 0, y = 0 }, until = \"x^2 + y^2 > 1.5^2\"",
            exact: vec![("mean", disc, 0.04)],
        },
    ]
}

#[test]
fn stated_errors_of_sampled_maps_hold() {
    let (mut squares, mut count) = (0.0, 0.0);
    for case in cases() {
        for seed in 1..=2 {
            let words = format!("method.seed={seed}");
            let (_, solution) = solved(&case.text(), &words, None);
            for (name, exact, largest) in &case.exact {
                let (value, error) = measure(&solution, &format!("p_{name}"));
                let off = (value - exact) / error;
                println!(
                    "{}, seed {seed}, {name}: {value:.5} ± {error:.1e}, exactly {exact:.5}, off by {off:.2} of it",
                    case.what
                );
                assert!(off.abs() < 4.0, "{}: {name}: {value} ± {error}", case.what);
                assert!(
                    error < largest * exact,
                    "{}: {name}: {value} ± {error}",
                    case.what
                );
                squares += off * off;
                count += 1.0;
            }
        }
    }
    let share = f64::sqrt(squares / count);
    println!("root mean square of differences over errors: {share:.2}");
    // Numbers of a case err together, so that 28 of them are about 12 independent ones: 1 ± 0.2.
    assert!((0.4..1.5).contains(&share), "{share}");
}

#[test]
fn numbers_are_the_same_bits_on_any_number_of_threads() {
    let case = &cases()[0];
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let numbers = || {
            let (_, solution) = solved(&case.text(), "method.samples=50", None);
            ["p_mean", "p_sd", "p_rate"].map(|name| measure(&solution, name))
        };
        pool.build().unwrap().install(numbers)
    };
    assert_eq!(with(1), with(3));
}
