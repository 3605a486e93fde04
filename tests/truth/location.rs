//! Located values against the truth, through the library: exact families by the generator and by SGCM, and the
//! calibration of stated errors over many seeds (ignored by default; results in docs/location.md).

use pbif::cancellation::Cancellation;
use pbif::continuation::{LocateOptions, Located, SweepResult, sweep};
use pbif::density::Observable;
use pbif::method::{
    GeneratorMethodOptions, MethodOptions, MethodSource, Problem, SgcmOptions, StepChoice,
};
use pbif::space::{Axis, CellSpace};
use pbif::system::{Family, Path, registry};
use pbif::topology::{DetectOptions, PersistenceDetector};

/// One sweep.
struct Case<'a> {
    model: &'a str,
    parameters: &'a [(&'a str, f64)],
    parameter: &'a str,
    range: (f64, f64),
    points: usize,
    axes: Vec<Axis>,
    observables: Vec<Observable>,
    tolerance: f64,
}

impl Case<'_> {
    fn run(&self, method: &MethodOptions) -> SweepResult {
        let model = registry::find(self.model).unwrap();
        let path = Path::parameter(self.parameter, self.range.0, self.range.1);
        let family = Family::new(model, self.parameters, path).unwrap();
        let space = CellSpace::new(self.axes.clone()).unwrap();
        let problem = Problem::new(family, space, self.observables.clone()).unwrap();
        let source = MethodSource::new(&problem, method, &Cancellation::new()).unwrap();
        let looks = self.points * self.observables.len();
        let detector = PersistenceDetector::new(DetectOptions::default(), looks);
        let options = LocateOptions {
            tolerance: Some(self.tolerance),
            ..LocateOptions::default()
        };
        let never = Cancellation::new();
        sweep(&source, &detector, self.points, &options, &never, &mut ()).unwrap()
    }
}

fn bistable(points: usize, range: (f64, f64)) -> Case<'static> {
    Case {
        model: "bistable",
        parameters: &[("sigma2", 0.25)],
        parameter: "a",
        range,
        points,
        axes: vec![Axis::uniform(-2.2, 2.2, 100).unwrap()],
        observables: vec![Observable::Marginal(0)],
        tolerance: 1e-3,
    }
}

fn rayleigh(count: usize, points: usize, range: (f64, f64)) -> Case<'static> {
    let axis = Axis::uniform(-2.6, 2.6, count).unwrap();
    Case {
        model: "rayleigh",
        parameters: &[("b", 0.1), ("sigma2", 0.02)],
        parameter: "a",
        range,
        points,
        axes: vec![axis.clone(), axis],
        observables: vec![Observable::Marginal(0), Observable::Joint(0, 1)],
        tolerance: 1e-4,
    }
}

fn rows(result: &SweepResult, observable: Observable) -> Vec<&Located> {
    let rows = result.bifurcations();
    rows.filter(|row| row.observable == observable).collect()
}

/// The only row of an observable holds the truth within an error of at most `share` of the range.
fn assert_located(result: &SweepResult, observable: Observable, truth: f64, largest: f64) {
    let found = rows(result, observable);
    assert_eq!(found.len(), 1, "{found:?}");
    let row = found[0];
    assert!(
        (row.value - truth).abs() <= row.error,
        "{row:?} but {truth}"
    );
    println!("{} ± {}", row.value, row.error);
    assert!(row.error <= largest, "{row:?}");
}

/// Where x of `rayleigh` goes from one peak to two: the zero of ∂²p/∂x² at 0 of p ∝ ∫ exp(2(aH - bH²/2)/σ²) dy, H =
/// (x² + y²)/2, hence of ∫ (a - bH) exp(…) dy at x = 0; by bisection and the trapezoidal rule (which is exact here).
fn rayleigh_split_of_x(b: f64, sigma2: f64) -> f64 {
    let integral = |a: f64| -> f64 {
        (-2000..=2000)
            .map(|k| {
                let h = 0.5 * (f64::from(k) * 2e-3).powi(2);
                (a - b * h) * (2.0 * (a * h - 0.5 * b * h * h) / sigma2).exp()
            })
            .sum()
    };
    let (mut low, mut high) = (0.0, 0.1);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if integral(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

fn generator() -> MethodOptions {
    MethodOptions::Generator(GeneratorMethodOptions::default())
}

fn sgcm(samples: usize, map_step: f64, seed: u64) -> MethodOptions {
    MethodOptions::Sgcm(SgcmOptions {
        samples,
        seed,
        map_step: StepChoice::Fixed(map_step),
        replicates: 16,
        ..SgcmOptions::default()
    })
}

#[test]
fn the_generator_locates_exact_families_within_its_stated_errors() {
    let x = Observable::Marginal(0);
    // The issue asks for 1e-3 of the range; the errors are a hundred times smaller.
    assert_located(&bistable(41, (-1.0, 1.0)).run(&generator()), x, 0.0, 2e-5);
    let result = rayleigh(100, 11, (-0.1, 0.1)).run(&generator());
    assert_located(&result, Observable::Joint(0, 1), 0.0, 2e-6);
    assert_located(&result, x, rayleigh_split_of_x(0.1, 0.02), 5e-5);
    let joint = rows(&result, Observable::Joint(0, 1))[0];
    assert_eq!(joint.after.to_string(), "ring");
}

#[test]
fn a_million_samples_locate_an_exact_split_within_a_hundredth_of_the_range() {
    // 100 cells × 10⁴ samples.
    let result = bistable(11, (-1.0, 1.0)).run(&sgcm(10_000, 5.0, 1));
    assert_located(&result, Observable::Marginal(0), 0.0, 0.02);
}

/// Samples of a joint density are short in `program` (`exact_bifurcations_lie_in_the_stated_band`), which says less of
/// the error. A hundredth of the range is what the values of several seeds are off by as a root mean square; stated
/// errors, which differ from seed to seed, are three times as large at most.
#[test]
#[ignore = "half a minute: weak damping asks for long trajectories"]
fn a_million_samples_locate_an_exact_ring_at_length() {
    let (seeds, hundredth) = (1..=4, 0.002);
    let squares = seeds.clone().map(|seed| {
        // 50² cells × 400.
        let result = rayleigh(50, 5, (-0.1, 0.1)).run(&sgcm(400, 80.0, seed));
        assert_located(&result, Observable::Joint(0, 1), 0.0, 3.0 * hundredth);
        rows(&result, Observable::Joint(0, 1))[0].value.powi(2)
    });
    let mean = squares.sum::<f64>() / seeds.count() as f64;
    assert!(mean.sqrt() <= hundredth, "{}", mean.sqrt());
}

#[test]
#[ignore = "a few minutes; the result stands in docs/location.md"]
fn stated_intervals_of_sgcm_hold_the_truth() {
    let (mut held, mut errors) = (0, Vec::new());
    for seed in 0..100 {
        let result = bistable(11, (-1.0, 1.0)).run(&sgcm(2000, 1.0, seed));
        let found = rows(&result, Observable::Marginal(0));
        if let [row] = found.as_slice() {
            held += usize::from(row.value.abs() <= row.error);
            errors.push(row.value / row.error);
        } else {
            println!("seed {seed}: {} rows", found.len());
        }
    }
    let square: f64 = errors.iter().map(|ratio| ratio * ratio).sum();
    println!(
        "{held} of 100 hold the truth; rms of value/error {:.2}",
        (square / errors.len() as f64).sqrt()
    );
    assert!(held >= 90, "{held}");
}

#[test]
#[ignore = "a few minutes; the result stands in docs/location.md"]
fn a_system_without_a_bifurcation_shows_none() {
    let reporting = (0..100)
        .filter(|&seed| {
            let result = bistable(11, (-1.0, -0.2)).run(&sgcm(2000, 1.0, seed));
            !rows(&result, Observable::Marginal(0)).is_empty()
        })
        .count();
    println!("{reporting} of 100 report a bifurcation");
    assert!(reporting <= 5, "{reporting}");
}
