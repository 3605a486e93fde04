//! Ends at which noise dies: populations that cannot be negative on more than one axis, whose marginals are known, and
//! square-root noises, which have no value beyond.

use pbif::cancellation::Cancellation;
use pbif::continuation::{
    BifurcationStatus, DensitySource, Finding, Measure, PointStatus, Solution,
};
use pbif::method::{GeneratorMethodOptions, GeneratorSource};
use pbif::sweep_file::{Sweep, SweepFile};

use crate::common::room::Room;
use crate::common::sweeps::{measure, rows, solved, swept};

/// Growth with a rate that fluctuates, beside a state that relaxes: x has the gamma density x^(a/D - 1) exp(-x/D),
/// whose mean is a and whose variance is a D. No end is given: no path crosses x = 0.
const GROWTH: &str = r#"
[system.equations]
x = "a x - x^2"
y = "-y + 0.3 x"
[system.noise]
interpretation = "stratonovich"
x = "sqrt(2 D) x"
y = "0.5"
[system.parameters]
a = 1.0
D = 0.3
[sweep]
parameter = "a"
from = -0.1
to = 1.3
points = 13
[cells]
x = { count = 100 }
y = { count = 50 }
[detect]
marginals = ["x"]
joint = []
"#;

fn sweep() -> Sweep {
    let file = SweepFile::parse("growth.toml", GROWTH);
    let settings = file.validate().unwrap_or_else(|report| panic!("{report}"));
    let prepared = settings.prepare(&Cancellation::new());
    prepared.unwrap_or_else(|report| panic!("{report}"))
}

/// A number and its error.
fn number(solution: &Solution<'_>, name: &str) -> (f64, f64) {
    let of_name = |one: &&Measure| one.name == name;
    let found = solution.report.measures.iter().find(of_name).unwrap();
    (found.value, found.error.unwrap())
}

fn is_natural_end(finding: &Finding) -> bool {
    matches!(finding, Finding::NaturalEnd { axis: 0, at, .. } if *at == 0.0)
}

#[test]
fn nothing_leaves_where_noise_dies_and_means_are_those_of_the_gamma_density() {
    let sweep = sweep();
    let axis = &sweep.problem.space().axes()[0];
    // Narrower cells beside the end follow a density that goes like a power of the distance.
    assert!(axis.from() == 0.0 && axis.width(0) < 0.1 * axis.width(50));
    let source = GeneratorSource::new(&sweep.problem, &GeneratorMethodOptions::default()).unwrap();
    let mut session = source.open(&Cancellation::new());
    for a in [0.4, 0.7, 1.0, 1.3] {
        let solution = session.solve(a).unwrap();
        let findings = &solution.report.findings;
        assert!(findings.is_empty(), "{findings:?}");
        // What leaves does so through the upper end, where e^{-x/D} is small.
        let escape = solution.report.measure("escape_rate").unwrap();
        assert!(escape < 2e-6, "a = {a}: {escape}");
        for (name, exact) in [("mean_x", a), ("sd_x", (0.3 * a).sqrt())] {
            let (value, error) = number(&solution, name);
            println!("a = {a}: {name} {value} ± {error:.1e}, exactly {exact}");
            let off = (value - exact).abs();
            assert!(off <= 1e-4 && error <= 1e-3, "{name} {value} ± {error}");
        }
    }
    // With the power -2/3 a tenth of the mass lies in the last cell, and that is told.
    let findings = session.solve(0.1).unwrap().report.findings;
    assert!(findings.iter().any(is_natural_end), "{findings:?}");
    // A rate of growth below zero ends in extinction, by the power -4/3.
    let report = session.solve(-0.1).unwrap().report;
    assert_eq!(report.status, PointStatus::NoSteadyState);
    let [
        Finding::Absorbed {
            axis: 0,
            at,
            exponent,
        },
    ] = report.findings[..]
    else {
        panic!("{:?}", report.findings);
    };
    assert!(
        at == 0.0 && (exponent + 4.0 / 3.0).abs() < 0.1,
        "{exponent}"
    );
}

/// b at which the slope of the density of a tumour is zero at x: 1 - x/10 - s²/2 = b x/(1 + x²).
fn intensity(x: f64) -> f64 {
    (1.0 - 0.045 - 0.1 * x) * (1.0 + x * x) / x
}

/// The place between two others where that turns.
fn turn(mut low: f64, mut high: f64) -> f64 {
    let slope = |x: f64| (intensity(x + 1e-6) - intensity(x - 1e-6)) / 2e-6;
    let rises = slope(low) > 0.0;
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if (slope(middle) > 0.0) == rises {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[test]
fn folds_of_a_population_are_located_where_its_equation_has_them() {
    let room = Room::new();
    let text = r#"
        [system.equations]
        x = "x (1 - x/10) - b x^2/(1 + x^2)"
        y = "-y + 0.1 x"
        [system.noise]
        interpretation = "stratonovich"
        x = "0.3 x"
        y = "0.3"
        [system.parameters]
        b = 2.0
        [sweep]
        parameter = "b"
        from = 1.5
        to = 2.6
        points = 12
        [cells]
        x = { from = 0, count = 120 }
        y = { count = 50 }
        [detect]
        marginals = ["x"]
        joint = []
    "#;
    room.write("tumour.toml", text);
    room.solved("sweep tumour.toml --out run --quiet figures.draw=[]");
    let mut rows = room.table("run/bifurcations.csv").0;
    rows.retain(|row| row["label"].starts_with("PB"));
    let folds = [turn(2.0, 6.0), turn(0.8, 2.0)].map(intensity);
    assert_eq!(rows.len(), 2, "{rows:?}");
    let mut exact = folds.to_vec();
    exact.sort_by(f64::total_cmp);
    for (row, exact) in rows.iter().zip(exact) {
        let (value, error) = (row.number("value"), row.number("error"));
        println!("{value} ± {error:.1e}, exactly {exact}");
        assert_eq!(&row["status"], "located");
        assert!((value - exact).abs() <= error, "{value} ± {error}: {exact}");
    }
}

/// i' = b i (1 - i) - g i + s i (1 - i) ξ (Itô), a share of infected: nothing passes 1 upward. The density's power at
/// zero is 2 (b - g)/s² - 2, which is zero at s = 1/√2: its peak reaches the end there.
#[test]
fn a_share_ends_at_one_where_its_noise_dies() {
    let text = "[system.equations]\ni = \"b i (1 - i) - g i\"\n[system.noise]\ni = \"s i (1 - i)\"\n\
         interpretation = \"ito\"\n[system.parameters]\nb = 1.5\ng = 1\n\
         [sweep]\nparameter = \"s\"\nfrom = 0.2\nto = 0.95\npoints = 7\n";
    let (sweep, result) = swept(text, "figures.draw=[]");
    let axis = &sweep.problem.space().axes()[0];
    assert_eq!((axis.from(), axis.to()), (0.0, 1.0));
    let found = rows(&result, "i");
    let [row] = found[..] else {
        panic!("one change: {found:?}");
    };
    let off = (row.value - 0.5f64.sqrt()).abs();
    assert!(off <= row.error && row.error < 1e-3, "{row:?}");
    assert_eq!(row.status(), BifurcationStatus::Located);
}

#[test]
fn the_exponent_of_a_square_root_process_is_within_its_error() {
    // x' = 1 - x + s √x ξ (Itô) has a gamma density of the shape α = 2/s². Deviations grow at the mean of f' - b'²/2 =
    // -1 - s²/(8 x), and 1/x has the mean α/(α - 1): near the end, which cells do not resolve where α is small.
    let text = r#"
[system.equations]
x = "1 - x"
[system.noise]
x = "s sqrt(x)"
interpretation = "ito"
[system.parameters]
s = 0.8
[sweep]
parameter = "s"
from = 0.6
to = 1.2
points = 2
[cells]
x = { from = 0, to = 12, count = 120 }
[exponent]
kind = "largest"
"#;
    for s in [0.6_f64, 0.75, 0.9, 1.05, 1.2] {
        let shape = 2.0 / (s * s);
        let exact = -1.0 - s * s / 8.0 * shape / (shape - 1.0);
        let (_, solution) = solved(text, "", Some(s));
        let (value, error) = measure(&solution, "exponent");
        println!("{s}: {value} ± {error:.1e}, exact {exact}");
        assert!(
            (value - exact).abs() <= error,
            "{s}: {value} ± {error:e}, exact {exact}"
        );
        assert!(error < 0.15 * exact.abs(), "{s}: {error:e}");
    }
}

#[test]
fn square_root_noises_need_neither_ends_nor_cells() {
    // Cox, Ingersoll and Ross' process in Stratonovich's reading has the drift 1 - x + s²/4 in Itô's, which has a value
    // at 0 though the derivative of the amplitude has none: p ~ x^(2/s² - 1/2). Jacobi's: p ~ x^(0.6/s - 1) and
    // (1 - x)^(1.4/s - 1). A peak reaches an end, or is born there, where the power is zero: at values of the sweep.
    let sweep = |drift: &str, noise: &str, interpretation: &str, to: f64| {
        let text = format!(
            "[system.equations]\nx = \"{drift}\"\n[system.noise]\nx = \"{noise}\"\n\
             interpretation = \"{interpretation}\"\n\
             [sweep]\nparameter = \"s\"\nfrom = 0.2\nto = {to}\npoints = 15\n"
        );
        swept(&text, "").1
    };
    let cases = [
        (sweep("1 - x", "s sqrt(x)", "stratonovich", 3.0), vec![2.0]),
        (
            sweep("0.3 - x", "sqrt(s x (1 - x))", "ito", 3.0),
            vec![0.6, 1.4],
        ),
    ];
    for (result, exact) in cases {
        let found = rows(&result, "x");
        assert_eq!(found.len(), exact.len());
        for (row, exact) in found.iter().zip(exact) {
            assert_eq!(row.status(), BifurcationStatus::Located);
            assert!(
                (row.value - exact).abs() < row.error,
                "{} ± {}",
                row.value,
                row.error
            );
        }
    }
}
