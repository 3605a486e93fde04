//! Sessions of sources: several of one source beside each other, what a solved point says of other parameters, and how
//! soon a cancelled solve ends.

use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use pbif::cancellation::Cancellation;
use pbif::continuation::{DensitySource, SourceError};
use pbif::density::Observable;
use pbif::method::{
    GeneratorMethodOptions, GeneratorSource, MonteCarloOptions, MonteCarloSource, Problem,
    SgcmOptions, SgcmSource, StepChoice,
};
use pbif::space::{Axis, CellSpace, Grading};
use pbif::stationary::Solver;
use pbif::system::{Family, Path, registry};

const COULOMB: [(&str, f64); 4] = [
    ("kappa", 0.05),
    ("mu", 0.05),
    ("f_c", 0.004),
    ("sigma2", 0.05),
];

/// The oscillator with Coulomb friction along one of its parameters, on `count`² cells, the kink resolved.
fn coulomb(parameter: &str, count: usize) -> Problem {
    let value = COULOMB.iter().find(|one| one.0 == parameter).unwrap().1;
    let fixed = COULOMB.into_iter().filter(|one| one.0 != parameter);
    let path = Path::parameter(parameter, 0.8 * value, 1.2 * value);
    let model = registry::find("coulomb").unwrap();
    let family = Family::new(model, &fixed.collect::<Vec<_>>(), path).unwrap();
    let grading = Grading {
        at: vec![0.0],
        smallest: 0.02,
    };
    let x = Axis::uniform(-4.0, 4.0, count).unwrap();
    let y = Axis::graded(-4.0, 4.0, count, &grading).unwrap();
    let observables = vec![Observable::Marginal(1), Observable::Joint(0, 1)];
    Problem::new(family, CellSpace::new(vec![x, y]).unwrap(), observables).unwrap()
}

fn generator(parameter: &str, count: usize) -> GeneratorSource {
    let options = GeneratorMethodOptions {
        solver_tolerance: 1e-12,
        ..GeneratorMethodOptions::default()
    };
    GeneratorSource::new(&coulomb(parameter, count), &options).unwrap()
}

#[test]
fn sessions_of_one_source_run_beside_each_other_and_do_not_meet() {
    let source = generator("f_c", 30);
    let values = [0.0034, 0.004, 0.0046, 0.0037];
    let masses = |source: &GeneratorSource| {
        let mut session = source.open(&Cancellation::new());
        let solve = |value: f64| {
            let solution = session.solve(value).unwrap();
            let densities = solution.densities.iter();
            densities
                .map(|one| one.density.masses())
                .collect::<Vec<_>>()
        };
        values.map(solve)
    };
    let alone = masses(&source);
    let together = thread::scope(|scope| {
        let threads = [(); 3].map(|()| scope.spawn(|| masses(&source)));
        threads.map(|thread| thread.join().unwrap())
    });
    for one in together {
        assert_eq!(one, alone, "bit for bit");
    }
}

/// Largest difference of two lists of densities over the largest entry of the second.
fn mismatch(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    let gap = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    gap / b.iter().flatten().fold(0.0, |max: f64, b| max.max(b.abs()))
}

fn densities(source: &dyn DensitySource, value: f64) -> Vec<Vec<f64>> {
    let mut session = source.open(&Cancellation::new());
    let solution = session.solve(value).unwrap();
    let densities = solution.densities.iter();
    densities.map(|one| one.density.values.clone()).collect()
}

/// Central differences of fourth order: their error is about step⁴ p⁽⁵⁾/30, and the solver's 1e-12 over the step. The
/// sensitivity itself is solved to 1e-6.
#[test]
fn a_solved_point_knows_its_derivative_by_any_parameter() {
    // One session, swept over f_c, says what sessions over the other parameters find by differences.
    let source = generator("f_c", 30);
    let mut session = source.open(&Cancellation::new());
    session.solve(0.0035).unwrap();
    let mut solution = session.solve(0.004).unwrap();
    let sensitivity = solution.sensitivity.as_mut().unwrap();
    for (parameter, value) in COULOMB {
        let found = sensitivity.to_parameter(parameter).unwrap();
        let other = generator(parameter, 30);
        let step = 0.02 * value;
        let mut difference: Vec<Vec<f64>> = found.iter().map(|one| vec![0.0; one.len()]).collect();
        for (steps, weight) in [(2.0, -1.0), (1.0, 8.0), (-1.0, -8.0), (-2.0, 1.0)] {
            let solved = densities(&other, value + steps * step);
            for (sum, density) in difference.iter_mut().zip(solved) {
                for (sum, p) in sum.iter_mut().zip(density) {
                    *sum += weight / (12.0 * step) * p;
                }
            }
        }
        let error = mismatch(&found, &difference);
        assert!(error < 1e-5, "{parameter}: {error:e}");
    }
    assert_eq!(
        sensitivity.along_path().unwrap(),
        sensitivity.to_parameter("f_c").unwrap()
    );
    let unknown = sensitivity.to_parameter("friction").unwrap_err();
    assert!(matches!(unknown, SourceError::Method(_)), "{unknown}");
}

#[test]
fn along_a_curve_the_derivatives_by_its_parameters_add_up() {
    let model = registry::find("coulomb").unwrap();
    let path = Path::curve("s", "s", ["f_c", "sigma2"], (0.0, 1.0), |s: f64| {
        vec![0.002 + 0.004 * s * s, 0.04 + 0.02 * s]
    });
    let family = Family::new(model, &[("kappa", 0.05), ("mu", 0.05)], path).unwrap();
    let base = coulomb("f_c", 30);
    let problem = Problem::new(family, base.space().clone(), base.observables().to_vec()).unwrap();
    let source = GeneratorSource::new(&problem, &GeneratorMethodOptions::default()).unwrap();
    let mut session = source.open(&Cancellation::new());
    let mut solution = session.solve(0.5).unwrap();
    let sensitivity = solution.sensitivity.as_mut().unwrap();
    let along = sensitivity.along_path().unwrap();
    // df_c/ds = 0.004, dσ²/ds = 0.02 at s = 0.5.
    let by_friction = sensitivity.to_parameter("f_c").unwrap();
    let by_noise = sensitivity.to_parameter("sigma2").unwrap();
    let sums = by_friction.iter().zip(&by_noise).map(|(f, n)| {
        let pairs = f.iter().zip(n);
        pairs.map(|(f, n)| 0.004 * f + 0.02 * n).collect()
    });
    let error = mismatch(&along, &sums.collect::<Vec<_>>());
    assert!(error < 1e-5, "{error:e}");
}

/// p ∝ exp((2/σ²)(ax²/2 - x⁴/4)): dp/da = p (x² - ⟨x²⟩)/σ², and dp/dσ² = -p (φ - ⟨φ⟩)/σ² with φ the exponent.
#[test]
fn on_one_axis_derivatives_are_those_of_the_exact_density() {
    let (a, sigma2) = (0.3, 0.5);
    let path = Path::parameter("a", -1.0, 1.0);
    let family = Family::new(
        registry::find("bistable").unwrap(),
        &[("sigma2", sigma2)],
        path,
    );
    let axis = Axis::uniform(-2.5, 2.5, 80).unwrap();
    let space = CellSpace::new(vec![axis.clone()]).unwrap();
    let problem = Problem::new(family.unwrap(), space, vec![Observable::Marginal(0)]).unwrap();
    let source = GeneratorSource::new(&problem, &GeneratorMethodOptions::default()).unwrap();
    let mut session = source.open(&Cancellation::new());
    let mut solution = session.solve(a).unwrap();
    // Midpoint sums over 200 points of every cell: their error is 1e-6 and less.
    let fine = 200_u32;
    let exponent = |x: f64| 2.0 / sigma2 * (0.5 * a * x * x - 0.25 * x.powi(4));
    let average = |of: &dyn Fn(f64) -> f64| -> Vec<f64> {
        let mean = |cell: usize| {
            let (from, width) = (axis.edges()[cell], axis.width(cell));
            let at = |k: u32| from + width * (f64::from(k) + 0.5) / f64::from(fine);
            (0..fine)
                .map(|k| of(at(k)) * exponent(at(k)).exp())
                .sum::<f64>()
                / f64::from(fine)
        };
        (0..axis.count()).map(mean).collect()
    };
    let total = |values: &[f64]| values.iter().sum::<f64>() * axis.width(0);
    let norm = total(&average(&|_| 1.0));
    let derivative = |of: &dyn Fn(f64) -> f64| -> Vec<f64> {
        let mean = total(&average(of)) / norm;
        average(&|x| (of(x) - mean) / norm)
    };
    let sensitivity = solution.sensitivity.as_mut().unwrap();
    for (name, exact) in [
        ("a", derivative(&|x| x * x / sigma2)),
        ("sigma2", derivative(&|x| -exponent(x) / sigma2)),
    ] {
        let found = sensitivity.to_parameter(name).unwrap();
        let error = mismatch(&found, &[exact]);
        assert!(error < 1e-4, "{name}: {error:e}");
    }
}

/// Cancels a solve soon after it has begun and gives what becomes of it. Uncancelled, each of the sources below would
/// work for minutes.
fn cancelled(source: &dyn DensitySource) -> SourceError {
    let cancellation = Cancellation::new();
    let (begun, begins) = mpsc::channel();
    thread::scope(|scope| {
        let solve = scope.spawn(|| {
            let mut session = source.open(&cancellation);
            begun.send(()).unwrap();
            session.solve(0.004).map(|solution| solution.report)
        });
        begins.recv().unwrap();
        thread::sleep(Duration::from_millis(200));
        cancellation.cancel();
        solve.join().unwrap().unwrap_err()
    })
}

fn assert_interrupted(source: &dyn DensitySource) {
    let error = cancelled(source);
    assert!(matches!(error, SourceError::Interrupted), "{error}");
}

#[test]
fn a_cancelled_factorisation_ends() {
    // 72 000 unknowns in three dimensions: the fronts of the last separators alone take a minute.
    let model = registry::find("dahl").unwrap();
    let fixed = [
        ("kappa", 0.02),
        ("mu", 1.0),
        ("lambda", 0.06),
        ("f_c", 0.05),
        ("sigma2", 0.02),
    ];
    let family = Family::new(model, &fixed, Path::parameter("alpha", 0.0, 1.0)).unwrap();
    let axes = [(2.5, 60), (2.5, 60), (0.05 / 0.06, 20)];
    let axes = axes.map(|(half, count)| Axis::uniform(-half, half, count).unwrap());
    let space = CellSpace::new(axes.to_vec()).unwrap();
    let problem = Problem::new(family, space, vec![Observable::Marginal(0)]).unwrap();
    let source = GeneratorSource::new(&problem, &GeneratorMethodOptions::default()).unwrap();
    assert_interrupted(&source);
}

#[test]
fn cancelled_sampling_ends() {
    let options = SgcmOptions {
        map_step: StepChoice::Fixed(1e4),
        time_step: StepChoice::Fixed(0.01),
        ..SgcmOptions::default()
    };
    let never = Cancellation::new();
    let source = SgcmSource::new(&coulomb("f_c", 20), &options, &never).unwrap();
    assert_interrupted(&source);
}

#[test]
fn cancelled_power_iteration_ends() {
    // A map step so short that almost nothing moves: the second eigenvalue is all but one.
    let options = SgcmOptions {
        map_step: StepChoice::Fixed(0.05),
        time_step: StepChoice::Fixed(0.05),
        samples: 16,
        replicates: 8,
        solver: Solver::PowerIteration,
        solver_tolerance: 1e-14,
        ..SgcmOptions::default()
    };
    let never = Cancellation::new();
    let source = SgcmSource::new(&coulomb("f_c", 120), &options, &never).unwrap();
    assert_interrupted(&source);
}

#[test]
fn cancelled_trajectories_end() {
    let options = MonteCarloOptions {
        burn_in: StepChoice::Fixed(1e8),
        ..MonteCarloOptions::default()
    };
    let never = Cancellation::new();
    let source = MonteCarloSource::new(&coulomb("f_c", 20), &options, &never).unwrap();
    assert_interrupted(&source);
}

#[test]
fn a_cancelled_choice_of_steps_ends() {
    let cancellation = Cancellation::new();
    cancellation.cancel();
    let problem = coulomb("f_c", 20);
    let sgcm = SgcmSource::new(&problem, &SgcmOptions::default(), &cancellation);
    let sgcm = SourceError::from(sgcm.unwrap_err());
    assert!(matches!(sgcm, SourceError::Interrupted));
    let monte_carlo = MonteCarloSource::new(&problem, &MonteCarloOptions::default(), &cancellation);
    let monte_carlo = SourceError::from(monte_carlo.unwrap_err());
    assert!(matches!(monte_carlo, SourceError::Interrupted));
}

/// Ended in the middle, a session is none the worse: the next solve is that of a session that was never asked to stop.
#[test]
fn a_session_of_a_cancelled_token_stays_cancelled_and_another_one_solves() {
    let source = generator("f_c", 30);
    let cancellation = Cancellation::new();
    let mut session = source.open(&cancellation);
    session.solve(0.004).unwrap();
    cancellation.cancel();
    for _ in 0..2 {
        let error = session.solve(0.0041).unwrap_err();
        assert!(matches!(error, SourceError::Interrupted), "{error}");
    }
    assert!(source.open(&Cancellation::new()).solve(0.0041).is_ok());
}
