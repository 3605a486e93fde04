//! Densities and moments of quantities against closed forms and Monte Carlo, and quantities in sweep files from text to
//! stored runs.

use pbif::cancellation::Cancellation;
use pbif::continuation::{DensitySource, Solution};
use pbif::density::{EstimatedDensity, Observable, total_variation};
use pbif::method::{
    Correction, GeneratorMethodOptions, GeneratorSource, MonteCarloOptions, MonteCarloSource,
    Problem, SgcmOptions, SgcmSource, StepChoice,
};
use pbif::space::{Axis, CellSpace};
use pbif::sweep_file::SweepFile;
use pbif::system::{Family, Path, quantities, registry};

use crate::common::room::assert_says;

const FORMULAS: [(&str, Option<&str>); 3] = [
    ("H", Some("(x^2 + y^2)/2")),
    ("amplitude", Some("sqrt(x^2 + y^2)")),
    ("turned", Some("0.6 x + 0.8 y")),
];

/// x'' = -0.1 x' - x + noise with p ∝ exp(-(x² + y²)/2).
fn linear(cells: usize) -> Problem {
    let model = registry::find("coulomb").unwrap();
    let fixed = [("kappa", 0.1), ("mu", 0.0), ("sigma2", 0.2), ("alpha", 1.0)];
    let read = quantities(&model, &FORMULAS).unwrap();
    let power = quantities(&model, &[("power", Some("y^2"))]).unwrap();
    let family = Family::new(model, &fixed, Path::parameter("f_c", 0.0, 0.0)).unwrap();
    let mut family = family.with_quantities(read);
    family.questions.averaged = power;
    let axis = Axis::uniform(-6.0, 6.0, cells).unwrap();
    let space = CellSpace::new(vec![axis.clone(), axis]).unwrap();
    let bins = [(0.0, 8.0), (0.0, 4.5), (-5.0, 5.0)];
    let bins = bins.map(|(from, to)| Axis::uniform(from, to, 50).unwrap());
    let mut watched: Vec<Observable> = (2..5).map(Observable::Marginal).collect();
    watched.push(Observable::Joint(4, 0));
    Problem::watching(family, space, watched, bins.to_vec()).unwrap()
}

fn by_generator(problem: &Problem) -> Solution<'static> {
    let source = GeneratorSource::new(problem, &GeneratorMethodOptions::default()).unwrap();
    let mut session = source.open(&Cancellation::new());
    session.solve(0.0).unwrap().detached()
}

/// Largest difference from averages over the bins of an exact density given by its integral, over its maximum; and the
/// same of the density's own error.
fn errors(found: &EstimatedDensity, below: impl Fn(f64) -> f64) -> (f64, f64) {
    let edges = found.density.axes[0].edges().windows(2);
    let exact: Vec<f64> = edges
        .map(|e| (below(e[1]) - below(e[0])) / (e[1] - e[0]))
        .collect();
    let pairs = found.density.values.iter().zip(&exact);
    let error = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let stated = found.standard_error.iter().copied().fold(0.0, f64::max);
    let maximum = exact.iter().copied().fold(0.0, f64::max);
    (error / maximum, stated / maximum)
}

fn normal(x: f64) -> f64 {
    0.5 * statrs::function::erf::erf(x / 2f64.sqrt())
}

#[test]
fn energy_and_amplitude_of_a_linear_oscillator_have_their_exact_densities() {
    // On 48 cells both schemes are off by what their common stencil of the diffusion does to so weak a damping.
    let solution = by_generator(&linear(64));
    let exact: [&dyn Fn(f64) -> f64; 3] =
        [&|h| -(-h).exp(), &|r| -(-0.5 * r * r).exp(), &|u| normal(u)];
    for (found, exact) in solution.densities.iter().zip(exact) {
        let (error, stated) = errors(found, exact);
        // The second scheme may happen to err alike along a direction.
        assert!(
            error < 3.0 * stated && stated < 1e-2,
            "{error:e} {stated:e}"
        );
        let mass: f64 = found.density.masses().iter().sum();
        assert!((mass - 1.0).abs() < 1e-3);
    }
    // Both coordinates are odd under the symmetry of the oscillator.
    assert_eq!(solution.densities[2].structure.centre, Some(vec![0.0]));
    assert_eq!(solution.densities[3].structure.centre, Some(vec![0.0; 2]));
    assert_eq!(solution.densities[0].structure.centre, None);
    // Axes have their moments first: E[y²] = 1, and its variance is 2.
    let power = |word: &str| solution.report.measure(&format!("{word}_power")).unwrap();
    assert!((power("mean") - 1.0).abs() < 2e-3, "{}", power("mean"));
    assert!((power("sd") - 2f64.sqrt()).abs() < 5e-3);
}

#[test]
fn a_joint_density_of_quantities_has_their_marginals() {
    let solution = by_generator(&linear(48));
    let joint = &solution.densities[3].density;
    let columns = joint.axes[1].count();
    let rows = joint.values.chunks(columns);
    let sums: Vec<f64> = rows
        .map(|row| {
            row.iter()
                .enumerate()
                .map(|(i, p)| p * joint.axes[1].width(i))
                .sum()
        })
        .collect();
    let marginal = &solution.densities[2].density;
    let summed = pbif::density::Density {
        axes: marginal.axes.clone(),
        values: sums,
    };
    assert!(total_variation(&summed, marginal).unwrap() < 1e-10);
}

#[test]
fn free_trajectories_find_the_same_densities() {
    let problem = linear(40);
    let options = MonteCarloOptions {
        error: 0.02,
        ..MonteCarloOptions::default()
    };
    let never = Cancellation::new();
    let source = MonteCarloSource::new(&problem, &options, &never).unwrap();
    let sampled = source.open(&never).solve(0.0).unwrap().detached();
    let computed = by_generator(&problem);
    for (a, b) in computed.densities.iter().zip(&sampled.densities).take(3) {
        let distance = total_variation(&a.density, &b.density).unwrap();
        let noise: f64 = b.standard_error.iter().sum::<f64>() * b.density.axes[0].width(0);
        // Half the sum of errors is what noise makes of the distance.
        assert!(distance < noise, "{:?} {distance} {noise}", a.observable);
    }
    let [a, b] = [computed, sampled].map(|one| one.report.measure("mean_power").unwrap());
    assert!((a - b).abs() < 0.1, "{a} {b}");
}

/// Under damping -a + bH the density of H is exp(-(2/σ²)(-aH + bH²/2)) on H > 0; a crater of rest, and a force that is
/// not linear.
#[test]
fn every_method_has_the_exact_densities_of_quantities_where_damping_depends_on_energy() {
    let model = registry::find("rayleigh").unwrap();
    let (a, b, sigma2) = (0.2, 0.4, 0.1);
    let formulas = [
        ("H", Some("(x^2 + y^2)/2")),
        ("amplitude", Some("sqrt(2 H)")),
    ];
    let read = quantities(&model, &formulas).unwrap();
    let power = quantities(&model, &[("power", Some("y^2"))]).unwrap();
    let fixed = [("b", b), ("sigma2", sigma2)];
    let family = Family::new(model, &fixed, Path::parameter("a", a, a)).unwrap();
    let mut family = family.with_quantities(read);
    family.questions.averaged = power;
    let axis = Axis::uniform(-3.0, 3.0, 50).unwrap();
    let space = CellSpace::new(vec![axis.clone(), axis]).unwrap();
    let bins = [(0.0, 4.0), (0.0, 2.8)].map(|(from, to)| Axis::uniform(from, to, 40).unwrap());
    let watched = vec![Observable::Marginal(2), Observable::Marginal(3)];
    let problem = Problem::watching(family, space, watched, bins.to_vec()).unwrap();
    let weight = |h: f64| (-(2.0 / sigma2) * (-a * h + b * h * h / 2.0)).exp();
    let all = integral(weight, 0.0, 6.0);
    let mean_energy = integral(|h| h * weight(h), 0.0, 6.0) / all;
    let below = |h: f64| integral(weight, 0.0, h) / all;
    let distance = |found: &EstimatedDensity, energy: &dyn Fn(f64) -> f64| {
        let edges = found.density.axes[0].edges();
        let masses = found.density.masses();
        let pairs = edges.windows(2).zip(&masses);
        let apart = pairs.map(|(e, mass)| (below(energy(e[1])) - below(energy(e[0])) - mass).abs());
        0.5 * apart.sum::<f64>()
    };
    let never = Cancellation::new();
    let sgcm = |correction| {
        let options = SgcmOptions {
            samples: 400,
            map_step: StepChoice::Fixed(1.5),
            correction,
            ..SgcmOptions::default()
        };
        SgcmSource::new(&problem, &options, &never).unwrap()
    };
    let monte_carlo = MonteCarloOptions {
        error: 0.01,
        ..MonteCarloOptions::default()
    };
    // The cells of a cell map add a diffusion of up to h²/(12 Δt) = 8e-4 to each axis beside σ²/4 = 0.025: 3 % of the
    // noise, which moves masses by about as much; the slope correction takes most of it. Monte Carlo has its noise, and
    // 1600 samples a cell have 1 %.
    let methods: [(Box<dyn DensitySource>, f64); 4] = [
        (
            Box::new(GeneratorSource::new(&problem, &GeneratorMethodOptions::default()).unwrap()),
            2e-3,
        ),
        (Box::new(sgcm(Correction::Slope)), 0.015),
        (Box::new(sgcm(Correction::None)), 0.04),
        (
            Box::new(MonteCarloSource::new(&problem, &monte_carlo, &never).unwrap()),
            0.03,
        ),
    ];
    for (source, allowed) in methods {
        let mut session = source.open(&never);
        let found = session.solve(a).unwrap().detached();
        let h = distance(&found.densities[0], &|h| h);
        let amplitude = distance(&found.densities[1], &|r| 0.5 * r * r);
        // Of y² the mean is that of H.
        let power = found.report.measure("mean_power").unwrap() / mean_energy - 1.0;
        let method = source.method();
        assert!(
            h < allowed && amplitude < allowed,
            "{method} {h} {amplitude}"
        );
        assert!(power.abs() < allowed, "{method} {power}");
    }
}

const FILE: &str = r#"
[system]
model = "rayleigh"
[system.parameters]
b = 0.1
sigma2 = 0.02
[sweep]
parameter = "a"
from = -0.04
to = 0.05
points = 4
[cells]
x = { from = -2.4, to = 2.4, count = 40 }
y = { from = -2.4, to = 2.4, count = 40 }
[detect]
marginals = ["H = (x^2 + y^2)/2", "amplitude = sqrt(2 H)"]
joint = []
[watch]
power = "y^2"
[figures]
formats = []
"#;

fn sweep(text: &str) -> pbif::sweep_file::Sweep {
    let file = SweepFile::parse("test.toml", text);
    file.validate()
        .unwrap()
        .prepare(&Cancellation::new())
        .unwrap()
}

#[test]
fn a_sweep_watches_quantities_stores_them_and_reads_them_back() {
    let prepared = sweep(FILE);
    let bins = prepared.problem.bins();
    assert_eq!(bins[0].from(), 0.0, "the energy ends at rest");
    assert_eq!(bins[1].from(), 0.0);
    // Written down and read again it is the same sweep.
    assert_eq!(sweep(&prepared.to_toml()).to_toml(), prepared.to_toml());
    let result = prepared.run(&Cancellation::new(), &mut ()).unwrap();
    for point in &result.points {
        // Both have one peak at every a: p(H) ∝ exp((2/σ²)(aH - bH²/2)), and the amplitude vanishes at rest.
        for detection in &point.detections {
            assert_eq!(detection.signature.peaks, 1, "a = {}", point.value);
        }
        let (a, found) = (point.value, &point.densities[0]);
        let weight = |h: f64| (100.0 * (a * h - 0.05 * h * h)).exp();
        let whole = integral(weight, 0.0, 6.0);
        let (error, stated) = errors(found, |h| integral(weight, 0.0, h) / whole);
        assert!(error < 2.0 * stated + 1e-4, "a = {a}: {error:e} {stated:e}");
    }
}

/// By Simpson's rule.
fn integral(of: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    let (count, width) = (1000, (to - from) / 1000.0);
    let value = |i: usize| of(from + width * i as f64);
    let inner: f64 = (1..count)
        .map(|i| value(i) * if i % 2 == 1 { 4.0 } else { 2.0 })
        .sum();
    width / 3.0 * (value(0) + inner + value(count))
}

fn refusal(from: &str, to: &str) -> String {
    assert!(FILE.contains(from));
    let file = SweepFile::parse("test.toml", &FILE.replace(from, to));
    match file.validate() {
        Err(report) => report.to_string(),
        Ok(settings) => settings
            .prepare(&Cancellation::new())
            .unwrap_err()
            .to_string(),
    }
}

#[test]
#[rustfmt::skip]
fn bad_formulas_are_shown_where_they_stand() {
    let amplitude = "amplitude = sqrt(2 H)";
    for (old, new, words) in [
        ("sqrt(2 H)", "sqrt(2 h)", &["unknown symbol `h`", "test.toml:16:", "did you mean `H`?"][..]),
        (amplitude, "sqrt(2 H)", &["a formula needs a name"]),
        (amplitude, "amplitud", &["has no axis `amplitud`"]),
        (amplitude, "x = sqrt(2 H)", &["already a state"]),
        (amplitude, "level = 1/H", &["`level` is inf at x = 0, y = 0"]),
        ("power = \"y^2\"", "power = \"v^2\"", &["unknown symbol `v`", "test.toml:19:"]),
    ] {
        assert_says(&refusal(old, new), words);
    }
    let text = refusal(amplitude, "level = 0*x + b");
    assert!(text.contains("no coordinate") || text.contains("all over"), "{text}");
    let more = FILE.replace("[watch]", "[detect.bins]\nenergy = { count = 50 }\n[watch]");
    let settings = SweepFile::parse("test.toml", &more).validate().unwrap();
    let text = settings.warnings.to_string();
    assert!(text.contains("no quantity `energy` is watched"), "{text}");
}
