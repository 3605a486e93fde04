//! Work of a fine sweep by the generator: factorisations and iterations, point by point.

use pbif::cancellation::Cancellation;
use pbif::continuation::{self, DensitySource, LocateOptions, PointStatus, Solution, SolveReport};
use pbif::density::Observable;
use pbif::method::{GeneratorMethodOptions, GeneratorSource, Problem};
use pbif::space::{Axis, CellSpace, Grading};
use pbif::system::{Family, Path, registry};
use pbif::topology::{DetectOptions, PersistenceDetector};

const OBSERVABLES: [Observable; 2] = [Observable::Marginal(0), Observable::Marginal(1)];

/// Runs `task` on a source for the oscillator with Coulomb friction, 40 × 40 cells, the kink resolved.
fn with_source<T>(task: impl FnOnce(&GeneratorSource) -> T) -> T {
    let model = registry::find("coulomb").unwrap();
    let given = [("mu", 0.05), ("kappa", 0.05), ("sigma2", 0.05)];
    let family = Family::new(model, &given, Path::parameter("f_c", -0.01, 0.01)).unwrap();
    let grading = Grading {
        at: vec![0.0],
        smallest: 0.02,
    };
    let x = Axis::uniform(-4.0, 4.0, 40).unwrap();
    let y = Axis::graded(-4.0, 4.0, 40, &grading).unwrap();
    let space = CellSpace::new(vec![x, y]).unwrap();
    let problem = Problem::new(family, space, OBSERVABLES.to_vec()).unwrap();
    let options = GeneratorMethodOptions::default();
    task(&GeneratorSource::new(&problem, &options).unwrap())
}

fn value(index: usize) -> f64 {
    -0.01 + 5e-4 * index as f64
}

fn sweep(source: &GeneratorSource) -> Vec<Solution<'static>> {
    let mut session = source.open(&Cancellation::new());
    let solutions = (0..41).map(|index| session.solve(value(index)).unwrap().detached());
    solutions
        .inspect(|solution| assert_eq!(solution.report.status, PointStatus::Solved))
        .collect()
}

#[test]
fn work_counters_are_as_they_were() {
    let solutions = with_source(sweep);
    let reports = solutions.iter().map(|solution| &solution.report);
    let counts: Vec<String> = reports
        .map(|report| {
            let factorisations = report.measure("factorisations").unwrap();
            format!("{factorisations}+{}", report.iterations)
        })
        .collect();
    let lines: Vec<String> = counts.chunks(10).map(|chunk| chunk.join(" ")).collect();
    insta::assert_snapshot!(lines.join("\n"), @r"
    1+3 0+8 0+5 0+4 0+4 1+1 0+1 0+1 0+1 0+1
    0+1 0+1 0+1 0+1 0+1 0+1 0+1 0+1 0+1 0+3
    0+3 0+3 0+1 0+1 0+3 0+3 0+3 0+3 0+1 0+1
    0+4 1+4 0+3 0+1 0+3 0+1 0+1 0+1 0+1 0+1
    0+1
    ");
}

/// The same by a sweep, which is cut into four segments.
#[test]
fn segments_take_little_more_work_than_one_session() {
    let (found, alone) = with_source(|source| {
        let never = Cancellation::new();
        let detector = PersistenceDetector::new(DetectOptions::default(), 41);
        let options = LocateOptions {
            tolerance: Some(1.0),
            ..LocateOptions::default()
        };
        assert_eq!(source.segments(41), 4);
        let found = continuation::sweep(source, &detector, 41, &options, &never, &mut ());
        (found.unwrap().points, sweep(source))
    });
    let work = |reports: Vec<&SolveReport>| {
        let factorisations = reports
            .iter()
            .map(|one| one.measure("factorisations").unwrap());
        let iterations: usize = reports.iter().map(|one| one.iterations).sum();
        format!("{} + {iterations}", factorisations.sum::<f64>())
    };
    let alone = work(alone.iter().map(|one| &one.report).collect());
    let found = work(found.iter().map(|one| &one.report).collect());
    insta::assert_snapshot!(format!("{alone}, in segments {found}"), @"3 + 84, in segments 7 + 108");
}

/// The prediction saves work and changes nothing: every solve is checked to its tolerance, 1e-8 in L1, and differences
/// between schemes, which are the errors, are known to two digits.
#[test]
fn a_predicted_point_is_the_point_solved_alone() {
    let chained = with_source(sweep);
    for index in [7, 23, 40] {
        let alone = with_source(|source| {
            let mut session = source.open(&Cancellation::new());
            session.solve(value(index)).unwrap().detached()
        });
        let pairs = chained[index].densities.iter().zip(&alone.densities);
        for (a, b) in pairs {
            let masses = a.density.masses().into_iter().zip(b.density.masses());
            let gap: f64 = masses.map(|(a, b)| (a - b).abs()).sum();
            assert!(gap < 1e-7, "{index}: {gap:e}");
            let norm = |errors: &[f64]| errors.iter().map(|error| error * error).sum::<f64>();
            let ratio = (norm(&a.standard_error) / norm(&b.standard_error)).sqrt();
            assert!((ratio - 1.0).abs() < 0.05, "{index}: {ratio}");
        }
    }
}
