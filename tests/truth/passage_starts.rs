//! Times of first passage from where the steady state is: its own errors are part of theirs. Exact by quadrature.

use pbif::cancellation::Cancellation;
use pbif::continuation::DensitySource as _;
use pbif::density::Observable;
use pbif::method::{GeneratorMethodOptions, GeneratorSource, Problem};
use pbif::space::{Axis, CellSpace};
use pbif::system::{Family, PassageQuestion, PassageStart, Path, TypedModel, regions};

use crate::common::numbers::{Numbers, given};

/// A motion dx = f dt + √(2D) dW along a line, in steps of `width` about `low`, and what of it is asked.
struct Line {
    drift: Box<dyn Fn(f64) -> f64>,
    d: f64,
    /// The process starts below the first place, spread as the steady state is, and ends at the second.
    from: f64,
    end: f64,
    range: (f64, f64),
}

/// Intervals of the quadrature.
const STEPS: usize = 60_000;

impl Line {
    /// Mean and standard deviation of the time: T' = -(1/(D p)) ∫ p f with f = 1 for the mean and 2 T for the square.
    fn exact(&self) -> [f64; 2] {
        let (low, high) = (self.range.0, self.end);
        let h = (high - low) / STEPS as f64;
        let place = |step: usize| low + h * step as f64;
        // Trapezia: their error is of order h², 1e-8 here. A drift that jumps at zero is met half-way.
        let mut log_p = vec![0.0; STEPS + 1];
        for step in 0..STEPS {
            let middle = place(step) + 0.5 * h;
            log_p[step + 1] = log_p[step] + h * (self.drift)(middle) / self.d;
        }
        let most = log_p.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let p: Vec<f64> = log_p.iter().map(|log| (log - most).exp()).collect();
        let times = |gain: &dyn Fn(usize) -> f64| {
            let mut flux = vec![0.0; STEPS + 1];
            for step in 0..STEPS {
                let weighed = |step: usize| p[step] * gain(step);
                flux[step + 1] = flux[step] + 0.5 * h * (weighed(step) + weighed(step + 1));
            }
            let mut time = vec![0.0; STEPS + 1];
            for step in (0..STEPS).rev() {
                let slope = |step: usize| flux[step] / (self.d * p[step]);
                time[step] = time[step + 1] + 0.5 * h * (slope(step) + slope(step + 1));
            }
            time
        };
        let mean = times(&|_| 1.0);
        let square = times(&|step| 2.0 * mean[step]);
        let first = |values: &[f64]| {
            let (mut sum, mut mass) = (0.0, 0.0);
            for step in 0..STEPS {
                // The last step is cut where the start ends.
                let share = ((self.from - place(step)) / h).clamp(0.0, 1.0);
                let terms = [step, step + 1].map(|step| 0.5 * p[step]);
                sum += share * (terms[0] * values[step] + terms[1] * values[step + 1]);
                mass += share * (terms[0] + terms[1]);
            }
            sum / mass
        };
        let mean_square = first(&square);
        let mean = first(&mean);
        [mean, (mean_square - mean * mean).sqrt()]
    }
}

/// Mean, standard deviation and median with their errors of a passage between two regions of a system.
fn found(
    equations: &[(&str, String)],
    noise: &[(&str, String)],
    axes: Vec<Axis>,
    (from, until): (Option<String>, String),
) -> Vec<(f64, f64)> {
    let names: Vec<&str> = equations.iter().map(|(axis, _)| *axis).collect();
    let mut model = TypedModel::new("model", "Model", names).with_parameters(["s"]);
    for (axis, drift) in equations {
        model = model.with_equation(*axis, format!("s ({drift})"));
    }
    for (axis, amplitude) in noise {
        model = model.with_noise(*axis, [format!("s*{amplitude}")]);
    }
    let model = model.build().unwrap();
    let region = |text: &str| regions(&model, &[("region", text)]).unwrap().remove(0);
    let question = PassageQuestion {
        name: "leave".to_owned(),
        until: region(&until),
        exits: Vec::new(),
        switching: false,
        transitions: None,
        fields: Vec::new(),
        start: match &from {
            Some(text) => PassageStart::Region(region(text)),
            None => PassageStart::Density,
        },
        times: Vec::new(),
        quantiles: vec![0.5],
    };
    let mut family = Family::new(model, &[], Path::parameter("s", 1.0, 1.0)).unwrap();
    family.questions.passages = vec![question];
    let space = CellSpace::new(axes).unwrap();
    let problem = Problem::new(family, space, vec![Observable::Marginal(0)]).unwrap();
    let source = GeneratorSource::new(&problem, &GeneratorMethodOptions::default()).unwrap();
    let mut session = source.open(&Cancellation::new());
    let solution = session.solve(1.0).unwrap();
    let ours = solution
        .report
        .measures
        .iter()
        .filter(|one| one.name.starts_with("leave"));
    let numbers: Vec<(f64, f64)> = ours.map(|one| (one.value, one.error.unwrap())).collect();
    assert_eq!(numbers.len(), 4, "{:?}", solution.report.findings);
    numbers
}

/// How many times its stated errors mean and deviation are off.
fn ratios(what: &str, found: &[(f64, f64)], exact: [f64; 2]) -> Vec<f64> {
    let pairs = found.iter().zip(exact);
    let one = |(&(value, error), exact): (&(f64, f64), f64)| {
        let ratio = (value - exact).abs() / error;
        println!("{what}: {value:.7} ± {error:.1e}, exactly {exact:.7}, off by {ratio:.2} of it");
        assert!(error < 0.05 * exact, "{what}");
        ratio
    };
    pairs.map(one).collect()
}

/// A random well, tilted, with its noise, a start below its barrier and an end beyond that.
fn drawn(between: &mut impl FnMut(f64, f64) -> f64) -> (Line, String) {
    let (tilt, depth) = (between(-0.2, 0.2), between(0.6, 1.5));
    let d = between(0.08, 0.4);
    let line = Line {
        drift: Box::new(move |x| depth * (x - x.powi(3)) + tilt),
        d,
        from: between(-1.2, -0.2),
        end: between(0.0, 1.3),
        range: (-3.4, 3.4),
    };
    (line, format!("{depth} (s - s^3) + {tilt}"))
}

#[test]
fn stated_errors_hold_where_the_start_is_spread_on_one_axis() {
    let mut dice = Numbers(given("OTHER_SEEDS", 77));
    let mut between = |from, to| dice.rounded(from, to);
    let mut all = Vec::new();
    for case in 0..40 {
        let (line, drift) = drawn(&mut between);
        let count = between(60.0, 160.0) as usize;
        let axis = Axis::uniform(between(-3.2, -2.7), between(2.4, 3.0), count).unwrap();
        let equations = [("x", drift.replace("s", "x"))];
        let noise = [("x", format!("sqrt(2*{})", line.d))];
        let asked = (
            Some(format!("x < {}", line.from)),
            format!("x > {}", line.end),
        );
        let numbers = found(&equations, &noise, vec![axis], asked);
        all.extend(ratios(
            &format!("{case} ({count} cells)"),
            &numbers,
            line.exact(),
        ));
    }
    hold(all);
}

#[test]
fn stated_errors_hold_where_the_start_is_spread_on_two_axes() {
    assert_two_axes(8);
}

#[test]
#[ignore = "some ten seconds: more of the same wells"]
fn stated_errors_on_two_axes_at_length() {
    assert_two_axes(30);
}

fn assert_two_axes(count: usize) {
    let mut dice = Numbers(given("OTHER_SEEDS", 78));
    let mut between = |from, to| dice.rounded(from, to);
    let mut all = Vec::new();
    for case in 0..count {
        let (line, drift) = drawn(&mut between);
        // The line runs at an angle through two axes, and a second motion across it.
        let angle = between(-0.8, 0.8);
        let (c, d) = (angle.cos(), angle.sin());
        let along = format!("({c}*x + {d}*y)");
        let across = format!("({c}*y - {d}*x)");
        let drift = drift.replace("s", &along);
        let equations = [
            ("x", format!("{c}*({drift}) + {d}*{across}")),
            ("y", format!("{d}*({drift}) - {c}*{across}")),
        ];
        let noise = ["x", "y"].map(|axis| (axis, format!("sqrt(2*{})", line.d)));
        let count = between(44.0, 90.0) as usize;
        let axes = [0, 1].map(|_| Axis::uniform(-3.4, 3.4, count).unwrap());
        let asked = (
            Some(format!("{along} < {}", line.from)),
            format!("{along} > {}", line.end),
        );
        let numbers = found(&equations, &noise, axes.to_vec(), asked);
        all.extend(ratios(
            &format!("{case} ({count} cells)"),
            &numbers,
            line.exact(),
        ));
    }
    hold(all);
}

#[test]
fn dry_friction_starts_from_a_density_with_a_kink() {
    for (count, friction) in [(80, 0.7), (140, 1.3), (200, 1.0)] {
        let line = Line {
            drift: Box::new(move |v| -friction * v.signum() - 0.2 * v),
            d: 0.5,
            from: 1.5,
            end: 1.5,
            range: (-6.0, 6.0),
        };
        let equations = [("v", format!("-{friction} sgn(v) - 0.2 v"))];
        let axis = Axis::uniform(-6.0, 6.0, count).unwrap();
        let noise = [("v", "1".to_owned())];
        let numbers = found(&equations, &noise, vec![axis], (None, "v > 1.5".to_owned()));
        hold(ratios(
            &format!("friction {friction}"),
            &numbers,
            line.exact(),
        ));
    }
}

/// Every stated error holds.
fn hold(mut all: Vec<f64>) {
    all.sort_by(f64::total_cmp);
    println!(
        "median {:.2}, largest {:.2}",
        all[all.len() / 2],
        all[all.len() - 1]
    );
    assert!(all[all.len() - 1] <= 1.0);
}
