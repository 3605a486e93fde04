//! How often regions are visited and for how long, against Rice's formula with the exact density of an oscillator whose
//! damping and noise balance: p = exp(-(U + v²/2)/T) up to a factor.

use crate::common::sweeps::{measure, solved};
use pbif::continuation::Solution;
use statrs::function::erf::erfc;

/// x'' = -g x' - U'(x) + √(2 g T) ξ with U = k x²/2 + b x⁴/4.
fn text(cells: &str, visits: &str) -> String {
    format!(
        "[system.equations]\nx = \"v\"\nv = \"-g v - k x - b x^3\"\n[system.noise]\nv = \"sqrt(2 g T)\"\n\
         [system.parameters]\ng = 0.4\nk = -1\nb = 1\nT = 0.3\n\
         [sweep]\nparameter = \"T\"\nfrom = 0.2\nto = 0.3\npoints = 2\n[cells]\n{cells}\n[visits]\n{visits}\n"
    )
}

/// End of what is integrated over: the density is below 1e-90 there.
const FAR: f64 = 6.0;

/// Probability of an interval of x, and how often both of its ends are passed one way, by quadrature with T = 0.3,
/// k = -1 and b = 1.
fn exact((from, to): (f64, f64)) -> [f64; 2] {
    let temperature = 0.3;
    let weight = |x: f64| (-(0.25 * x.powi(4) - 0.5 * x * x) / temperature).exp();
    let integral = |from: f64, to: f64| {
        let step = (to - from) / 20_000.0;
        let middles = (0..20_000).map(|number| from + (f64::from(number) + 0.5) * step);
        step * middles.map(weight).sum::<f64>()
    };
    let whole = integral(-FAR, FAR);
    let speed = (temperature / std::f64::consts::TAU).sqrt();
    [
        integral(from, to) / whole,
        speed * (weight(from) + weight(to)) / whole,
    ]
}

/// The three numbers of a region hold so many of their errors, which are at most a share of them.
fn assert_visits(
    solution: &Solution<'_>,
    (name, [share, rate]): (&str, [f64; 2]),
    (errors, largest): (f64, f64),
) {
    let all = [
        ("time_share", share),
        ("visits", rate),
        ("sojourn", share / rate),
    ];
    for (word, exact) in all {
        let (value, error) = measure(solution, &format!("{name}_{word}"));
        let off = (value - exact).abs();
        assert!(off <= errors * error, "{name}_{word}: {off:e} of {error:e}");
        assert!(error <= largest * exact, "{name}_{word}: {error:e}");
    }
}

#[test]
fn an_oscillator_visits_wells_and_bands_as_often_as_rice_says() {
    let visits = "right = \"x > 0\"\nhigh = \"x > 1.2\"\nband = \"-0.4 < x < 0.9\"\n\
                  slanted = \"2 x + 0.3 > 0.5\"";
    for (cells, largest) in [("x = 40\nv = 44", 0.02), ("x = 90\nv = 70", 0.003)] {
        let (_, solution) = solved(&text(cells, visits), "", None);
        for (name, interval) in [
            ("right", (0.0, FAR)),
            ("high", (1.2, FAR)),
            ("band", (-0.4, 0.9)),
            ("slanted", (0.1, FAR)),
        ] {
            assert_visits(&solution, (name, exact(interval)), (1.0, largest));
        }
    }
}

#[test]
fn a_band_thinner_than_a_cell_is_visited_as_often_as_rice_says() {
    // Cells are 0.1 to 0.2 wide.
    let visits = "thin = \"x > 0.3 and x < 0.31\"\ngap = \"x < 0.3 or x > 0.31\"";
    let [share, rate] = exact((0.3, 0.31));
    for cells in ["x = 33\nv = 60", "x = 47\nv = 60", "x = 60\nv = 60"] {
        let (_, solution) = solved(&text(cells, visits), "", None);
        assert_visits(&solution, ("thin", [share, rate]), (1.0, 0.05));
        assert_visits(&solution, ("gap", [1.0 - share, rate]), (1.0, 0.05));
    }
}

#[test]
fn a_pendulum_visits_ranges_of_its_angle_as_often_as_rice_says() {
    // p = exp(-(v²/2 - k cos φ)/T) up to a factor; the angle's range ends at ±π, inside of `last` and at its border.
    let (k, g) = (0.8, 0.4);
    let visits = "sine = \"sin(phi) > 0.3\"\nlast = \"phi > 1\"\nhalf = \"cos(phi) < 0\"\n\
                  far = \"phi < -2 or phi > 1\"";
    let pi = std::f64::consts::PI;
    for temperature in [0.25, 0.8] {
        for modes in ["", "phi = { modes = 8 }\n", "phi = { modes = 15 }\n"] {
            let text = format!(
                "[system.equations]\nphi = \"v\"\nv = \"-{g} v - {k} sin(phi)\"\n\
                 [system.noise]\nv = \"sqrt(2*{g}*T)\"\n[system.bounds]\nphi = \"periodic\"\n\
                 [sweep]\nparameter = \"T\"\nfrom = 0.2\nto = {temperature}\npoints = 2\n\
                 [cells]\n{modes}v = 70\n[visits]\n{visits}\n"
            );
            let (_, solution) = solved(&text, "", None);
            let weight = |phi: f64| (k * phi.cos() / temperature).exp();
            let integral = |from: f64, to: f64| {
                let step = (to - from) / 20_000.0;
                let middles = (0..20_000).map(|at| from + (f64::from(at) + 0.5) * step);
                step * middles.map(weight).sum::<f64>()
            };
            let low = 0.3_f64.asin();
            let ranges = [
                ("sine", low, pi - low),
                ("last", 1.0, pi),
                ("half", 0.5 * pi, 1.5 * pi),
                ("far", 1.0, 2.0 * pi - 2.0),
            ];
            for (name, from, to) in ranges {
                let whole = integral(-pi, pi);
                let share = integral(from, to) / whole;
                let speed = (temperature / std::f64::consts::TAU).sqrt();
                let rate = speed * (weight(from) + weight(to)) / whole;
                assert_visits(&solution, (name, [share, rate]), (1.0, 0.1));
            }
        }
    }
}

#[test]
fn a_region_across_whose_border_noise_acts_is_entered_infinitely_often() {
    let visits = "fast = \"v > 0.5\"\nnowhere = \"x > 80\"";
    let (sweep, solution) = solved(&text("x = 40\nv = 40", visits), "", None);
    let (share, error) = measure(&solution, "fast_time_share");
    // P(v > 0.5) of a normal density of variance 0.3.
    let exact = 0.5 * erfc(0.5 / 0.6_f64.sqrt());
    assert!((share - exact).abs() <= error && error < 0.01);
    let has = |name: &str| solution.report.measures.iter().any(|one| one.name == name);
    assert!(!has("fast_visits") && !has("fast_sojourn") && !has("nowhere_visits"));
    let family = sweep.problem.family();
    let findings = solution.report.findings.iter();
    let words: Vec<String> = findings
        .map(|one| pbif::run::finding_in_words(family, one))
        .collect();
    let words = words.join("; ");
    assert!(words.contains("noise acts across its border"), "{words}");
    assert!(words.contains("`nowhere`"), "{words}");
}

#[test]
fn what_filtered_noise_moves_has_visits_on_one_line() {
    // x' = -x + z with z an Ornstein-Uhlenbeck process: x is normal with variance D/(1 + τ), its derivative with
    // variance D/(τ (1 + τ)).
    let (d, tau) = (0.5, 0.4_f64);
    let text = format!(
        "[system.equations]\nx = \"-x + z\"\nz = \"-z/tau\"\n[system.noise]\nz = \"sqrt(2 D)/tau\"\n\
         [system.parameters]\ntau = {tau}\nD = {d}\n[sweep]\nparameter = \"D\"\nfrom = 0.3\nto = {d}\npoints = 2\n\
         [cells]\nx = 50\nz = 50\n[visits]\nhigh = \"x > 0.6\"\n"
    );
    let (_, solution) = solved(&text, "", None);
    let variance = d / (1.0 + tau);
    let exact = (1.0 / tau).sqrt() / std::f64::consts::TAU * (-0.18 / variance).exp();
    let (rate, error) = measure(&solution, "high_visits");
    let off = (rate - exact).abs();
    assert!(off <= error && error < 0.01 * exact, "{off:e} of {error:e}");
}

#[test]
fn trajectories_visit_a_well_as_often_as_rice_says() {
    let visits = "right = \"x > 0\"\nhigh = \"x > 1.2\"\nfast = \"v > 0.5\"";
    let sampled = text("x = 40\nv = 44", visits);
    let (_, solution) = solved(
        &sampled,
        "method.kind=\"monte-carlo\" method.passages=4000",
        None,
    );
    for (name, from) in [("right", 0.0), ("high", 1.2)] {
        assert_visits(&solution, (name, exact((from, FAR))), (3.0, 0.1));
    }
    let mut all = solution.report.measures.iter();
    assert!(all.all(|one| !one.name.starts_with("fast")));
}

#[test]
fn sgcm_counts_visits_as_often_as_rice_says() {
    let visits =
        "right = \"x > 0\"\nhigh = \"x > 1.2\"\nband = \"-0.4 < x < 0.9\"\nhard = \"v > 1\"";
    let mut ratios = Vec::new();
    for (cells, seed) in [(30, 1), (36, 2), (48, 3)] {
        let cells = format!(
            "x = {{ from = -2.3, to = 2.3, count = {cells} }}\nv = {{ from = -2.7, to = 2.7, count = 40 }}"
        );
        let method = format!("method.kind=\"sgcm\" method.samples=200 method.seed={seed}");
        let (_, solution) = solved(&text(&cells, visits), &method, None);
        let rest = [
            ("right", (0.0, FAR)),
            ("high", (1.2, FAR)),
            ("band", (-0.4, 0.9)),
        ];
        for (name, interval) in rest {
            let [share, rate] = exact(interval);
            let all = [
                ("time_share", share),
                ("visits", rate),
                ("sojourn", share / rate),
            ];
            for (word, exact) in all {
                let (value, error) = measure(&solution, &format!("{name}_{word}"));
                assert!(error <= 0.08 * exact, "{name}_{word}: {error:e}");
                ratios.push((value - exact) / error);
            }
        }
        // Noise acts across this border.
        let (share, error) = measure(&solution, "hard_time_share");
        let normal = 0.5 * erfc(1.0 / (2.0 * 0.3_f64).sqrt());
        assert!((share - normal).abs() <= 4.0 * error);
        let mut measures = solution.report.measures.iter();
        assert!(!measures.any(|one| one.name == "hard_visits"));
    }
    // Errors are standard errors of sampling and what else is known.
    let squares: f64 = ratios.iter().map(|ratio| ratio * ratio).sum();
    let size = (squares / ratios.len() as f64).sqrt();
    assert!(size <= 1.5, "{size}: {ratios:?}");
}
