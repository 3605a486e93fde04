//! Location with the real detector on closed-form densities, whose bifurcations are known exactly.

mod births;
mod stages;

use super::*;
use crate::cancellation::Cancellation;
use crate::density::{Density, EstimatedDensity, Kink, Observable, Structure};
use crate::space::Axis;
use crate::system::test_families::bistable;
use crate::topology::{DetectOptions, PersistenceDetector};

/// p(x; θ), not normalised.
trait Formula: Fn(f64, &[f64]) -> f64 + Clone + Send + Sync + 'static {}

impl<F: Fn(f64, &[f64]) -> f64 + Clone + Send + Sync + 'static> Formula for F {}

/// A density of one or two axes, by Gauss quadrature over cells.
#[derive(Clone)]
struct Exact<F> {
    subject: Subject,
    axes: Vec<Axis>,
    structure: fn(f64) -> Structure,
    density: F,
    scale: f64,
}

const GAUSS: [(f64, f64); 3] = [
    (-0.774_596_669_241_483_4, 5.0 / 18.0),
    (0.0, 8.0 / 18.0),
    (0.774_596_669_241_483_4, 5.0 / 18.0),
];

impl<F: Formula> Exact<F> {
    fn new(axes: usize, count: usize, structure: fn(f64) -> Structure, density: F) -> Self {
        let subject = Subject {
            family: bistable(-1.0, 1.0),
            observables: vec![match axes {
                1 => Observable::Marginal(0),
                _ => Observable::Joint(0, 1),
            }],
            measures: Vec::new(),
            cell_check: CellCheck::OnFinerCells {
                ratio: 1.25,
                follows: None,
            },
        };
        Self {
            subject,
            axes: vec![Axis::uniform(-2.0, 2.0, count).unwrap(); axes],
            structure,
            density,
            scale: 1.0,
        }
    }

    fn average(&self, theta: f64, cell: usize) -> f64 {
        let axis = &self.axes[0];
        let at = |index: usize, node: f64| axis.centre(index) + 0.5 * node * axis.width(index);
        let second = self.axes.get(1).map(|_| cell % axis.count());
        let first = cell / axis.count().pow(self.axes.len() as u32 - 1);
        let mut sum = 0.0;
        for (u, weight) in GAUSS {
            match second {
                None => sum += weight * (self.density)(theta, &[at(first, u)]),
                Some(second) => {
                    for (v, other) in GAUSS {
                        let place = [at(first, u), at(second, v)];
                        sum += weight * other * (self.density)(theta, &place);
                    }
                }
            }
        }
        sum
    }
}

impl<F: Formula> Exact<F> {
    fn solve(&self, value: f64) -> Solution<'static> {
        let cells = self.axes[0].count().pow(self.axes.len() as u32);
        let values: Vec<f64> = (0..cells).map(|cell| self.average(value, cell)).collect();
        let mut density = Density {
            axes: self.axes.clone(),
            values,
        };
        let total: f64 = density.masses().iter().sum();
        density
            .values
            .iter_mut()
            .for_each(|p| *p *= self.scale / total);
        let mut solution = Solution::without_density(SolveReport::solved("exact"));
        solution.densities = vec![EstimatedDensity {
            structure: (self.structure)(value),
            ..EstimatedDensity::new(self.subject.observables[0], density)
        }];
        solution
    }
}

impl<F: Formula> DensitySource for Exact<F> {
    fn method(&self) -> &'static str {
        "exact"
    }

    fn subject(&self) -> &Subject {
        &self.subject
    }

    fn open(&self, _: &Cancellation) -> Box<dyn Session> {
        let source = self.clone();
        Box::new(move |value: f64| Ok(source.solve(value)))
    }

    fn finer(&self, _: &Want) -> Result<Option<Box<dyn DensitySource>>, SourceError> {
        let axes = self.axes.iter().map(|axis| axis.refined(1.5)).collect();
        Ok(Some(Box::new(Self {
            axes,
            ..self.clone()
        })))
    }
}

fn centred(axes: usize) -> Structure {
    Structure {
        centre: Some(vec![0.0; axes]),
        ..Structure::default()
    }
}

fn run<F: Formula>(
    source: &Exact<F>,
    (from, to, points): (f64, f64, usize),
    tolerance: f64,
) -> SweepResult {
    let mut source = source.clone();
    source.subject.family = bistable(from, to);
    let detector = PersistenceDetector::new(DetectOptions::default(), points);
    let options = LocateOptions {
        tolerance: Some(tolerance),
        ..LocateOptions::default()
    };
    let never = Cancellation::new();
    sweep(&source, &detector, points, &options, &never, &mut ()).unwrap()
}

fn rows(result: &SweepResult) -> Vec<&Located> {
    result.bifurcations().collect()
}

fn words(row: &Located) -> String {
    format!("{} → {}, {}", row.before, row.after, row.change())
}

/// Every row in words, with its status, value and error: for messages.
fn lines(result: &SweepResult) -> Vec<String> {
    let line = |row: &&Located| {
        let (status, value, error) = (row.status(), row.value, row.error);
        format!("{} {status:?} {value} ± {error}", words(row))
    };
    rows(result).iter().map(line).collect()
}

/// One peak to two at θ = 0.03: log p = 2((θ - 0.03) x²/2 - x⁴/4)/σ², σ² = 0.5.
fn split() -> Exact<impl Formula> {
    Exact::new(
        1,
        100,
        |_| centred(1),
        |theta: f64, at: &[f64]| {
            let x = at[0];
            (4.0 * (0.5 * (theta - 0.03) * x * x - 0.25 * x.powi(4))).exp()
        },
    )
}

#[test]
fn a_symmetric_split_is_located_to_a_part_in_a_million_with_few_solves() {
    let source = split();
    let result = run(&source, (-0.5, 0.5, 11), 1e-4);
    let rows = rows(&result);
    assert_eq!(rows.len(), 1);
    let row = rows[0];
    assert_eq!(words(row), "1 peak → 2 peaks, symmetric split");
    assert_eq!(row.status(), BifurcationStatus::Located);
    assert!(
        (row.value - 0.03).abs() <= row.error && row.error < 1e-5,
        "{row:?}"
    );
    assert!(row.lower <= 0.03 && 0.03 <= row.upper && row.upper - row.lower <= 1.1e-4);
    // The curvature is almost linear: a secant and one step to either side.
    assert!(result.points.len() <= 11 + 4, "{}", result.points.len());
}

#[test]
fn scale_and_direction_change_no_row() {
    let all = |scale: f64, from: f64, to: f64| {
        let source = Exact { scale, ..split() };
        let result = run(&source, (from, to, 11), 1e-4);
        let row = rows(&result)[0].clone();
        (
            words(&row),
            row.status(),
            [row.value, row.error, row.lower, row.upper],
        )
    };
    let plain = all(1.0, -0.5, 0.5);
    for (scale, from, to) in [(10.0, -0.5, 0.5), (1.0, 0.5, -0.5)] {
        let other = all(scale, from, to);
        assert_eq!((&plain.0, plain.1), (&other.0, other.1));
        for (a, b) in plain.2.iter().zip(other.2) {
            assert!((a - b).abs() < 1e-9, "{plain:?} {other:?}");
        }
    }
}

#[test]
fn checks_that_are_known_are_not_solved_again() {
    struct Keeper(Vec<CheckedIndicator>);
    impl Observer for Keeper {
        fn known_checks(&mut self) -> Vec<CheckedIndicator> {
            std::mem::take(&mut self.0)
        }
    }
    let mut source = split();
    source.subject.family = bistable(-0.5, 0.5);
    let detector = PersistenceDetector::new(DetectOptions::default(), 11);
    let (options, never) = (LocateOptions::default(), Cancellation::new());
    let swept = |known: &[CheckedIndicator]| {
        let mut keeper = Keeper(known.to_vec());
        let result = sweep(&source, &detector, 11, &options, &never, &mut keeper).unwrap();
        assert_eq!(rows(&result).len(), 1);
        (rows(&result)[0].clone(), result.checks.unwrap())
    };
    let (row, seen) = swept(&[]);
    assert!(!seen.is_empty());
    for known in 0..=seen.len() {
        assert_eq!(swept(&seen[..known]), (row.clone(), seen.clone()));
    }
    // What is known is believed.
    let mut other = seen[0].clone();
    other.indicator = other.indicator.map(|value| -value);
    assert_ne!(swept(&[other.clone()]).1, seen);
    // A check of something else is of no use, and does no harm.
    other.value += 1e-9;
    assert_eq!(swept(&[other]).1, seen);
}

/// As [`split`], with tails of which a depth is taken away.
fn split_without_tails(depth: f64) -> Exact<impl Formula> {
    let whole = split().density;
    Exact::new(
        1,
        100,
        |_| centred(1),
        move |theta: f64, at: &[f64]| {
            let tail = if at[0].abs() > 1.6 { depth } else { 0.0 };
            whole(theta, at) - tail
        },
    )
}

#[test]
fn nothing_is_located_in_a_density_that_is_negative() {
    let status = |depth: f64| {
        let result = run(&split_without_tails(depth), (-0.5, 0.5, 11), 1e-4);
        let row = rows(&result)[0].clone();
        assert!((row.value - 0.03).abs() <= row.error, "{row:?}");
        (row.status(), row.doubts)
    };
    assert_eq!(status(0.0).0, BifurcationStatus::Located);
    // 0.8 in x at about a tenth of the height of a density some two wide: four per cent of the mass, or two thousandths
    // of it.
    let (torn, doubts) = status(0.1);
    assert_eq!(torn, BifurcationStatus::Unresolved);
    let is_negative = matches!(doubts[..], [Doubt::NegativeDensity(share), ..] if share > 0.02);
    assert!(is_negative, "{doubts:?}");
    assert_eq!(status(0.005).0, BifurcationStatus::Located);
}

#[test]
fn a_kink_is_located_from_its_jump_and_needs_no_grid() {
    let structure = |theta: f64| Structure {
        kinks: vec![Kink {
            axis: 0,
            at: 0.0,
            jump: vec![2.0 * (theta - 0.1)],
        }],
        ..centred(1)
    };
    let source = Exact::new(1, 100, structure, |theta: f64, at: &[f64]| {
        ((theta - 0.1) * at[0].abs() - at[0] * at[0]).exp()
    });
    let result = run(&source, (-0.9, 1.0, 20), 1e-4);
    let rows = rows(&result);
    assert_eq!(rows.len(), 1);
    assert_eq!(words(rows[0]), "1 peak → 2 peaks, split at a kink");
    assert!((rows[0].value - 0.1).abs() <= rows[0].error && rows[0].error < 1e-6);
}
