//! The sweep driver on sources whose answers are known in closed form.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::*;
use crate::cancellation::Cancellation;
use crate::density::{Density, EstimatedDensity, Observable};
use crate::space::Axis;
use crate::system::test_families::bistable;
use crate::topology::{
    Detection, Detector, Feature, FeatureErrors, FeatureKind, Signature, Verdict,
};

/// A source that hands the parameter to the detector, and fails where asked.
#[derive(Clone)]
struct Ramp {
    subject: Subject,
    /// Values without a steady state.
    failing: Option<(f64, f64)>,
    /// Values that are refused.
    refused: Option<(f64, f64)>,
    segments: usize,
}

impl Ramp {
    fn new(from: f64, to: f64) -> Self {
        let subject = Subject {
            family: bistable(from, to),
            observables: vec![Observable::Marginal(0)],
            measures: Vec::new(),
            cell_check: CellCheck::Needless,
        };
        Self {
            subject,
            failing: None,
            refused: None,
            segments: 1,
        }
    }

    fn solve(&self, value: f64) -> Solution<'static> {
        let failed = self.failing.is_some_and(|(a, b)| (a..=b).contains(&value));
        let mut solution = Solution::without_density(SolveReport::solved("exact"));
        if failed {
            solution.report.status = PointStatus::NoSteadyState;
            return solution;
        }
        solution.densities = vec![EstimatedDensity::new(
            Observable::Marginal(0),
            Density {
                axes: vec![Axis::uniform(-1.0, 1.0, 2).unwrap()],
                values: vec![0.5 + 0.1 * value, 0.5 - 0.1 * value],
            },
        )];
        solution
    }
}

impl DensitySource for Ramp {
    fn method(&self) -> &'static str {
        "exact"
    }

    fn subject(&self) -> &Subject {
        &self.subject
    }

    fn open(&self, _: &Cancellation) -> Box<dyn Session> {
        let source = self.clone();
        let is_refused = move |value: f64| {
            let refused = source.refused;
            refused.is_some_and(|(a, b)| (a..=b).contains(&value))
        };
        let source = self.clone();
        Box::new(move |value: f64| match is_refused(value) {
            true => Err(SourceError::Method("refused".into())),
            false => Ok(source.solve(value)),
        })
    }

    fn segments(&self, values: usize) -> usize {
        self.segments.min(values)
    }
}

/// A second peak of persistence (θ - birth)² beyond the birth, seen against noise of the given size.
struct SquareLaw {
    birth: f64,
    noise: f64,
}

impl Detector for SquareLaw {
    fn name(&self) -> &'static str {
        "square-law"
    }

    fn detect(&self, density: &EstimatedDensity) -> Detection {
        let theta = (density.density.values[0] - 0.5) / 0.1;
        let persistence = (theta - self.birth).max(0.0).powi(2);
        let significance = persistence / (5.0 * self.noise);
        let verdict = match significance {
            s if s > 1.0 => Verdict::Present,
            s if s > 0.6 => Verdict::Unresolved,
            _ => Verdict::Absent,
        };
        let feature = |persistence, significance, verdict| Feature {
            kind: FeatureKind::Peak,
            position: vec![0.0],
            density: 1.0,
            persistence,
            standard_error: self.noise,
            significance,
            verdict,
            partner: None,
            errors: FeatureErrors::default(),
        };
        let present = verdict == Verdict::Present;
        Detection {
            signature: Signature::of_peaks(1 + usize::from(present)),
            indicators: Vec::new(),
            is_seen: true,
            features: vec![
                feature(1.0, f64::MAX, Verdict::Present),
                feature(persistence, significance, verdict),
            ],
        }
    }
}

fn run(source: &Ramp, detector: &SquareLaw, points: usize, tolerance: f64) -> SweepResult {
    sweep(
        source,
        detector,
        points,
        &LocateOptions {
            tolerance: Some(tolerance),
            ..LocateOptions::default()
        },
        &Cancellation::new(),
        &mut (),
    )
    .unwrap()
}

fn bifurcations(result: &SweepResult) -> Vec<&Located> {
    result.bifurcations().collect()
}

#[test]
fn a_birth_hidden_by_noise_lies_in_the_stated_band() {
    let detector = SquareLaw {
        birth: 0.1,
        noise: 1e-3,
    };
    let result = run(&Ramp::new(-1.0, 1.0), &detector, 41, 1e-4);
    let rows = bifurcations(&result);
    assert_eq!(rows.len(), 1);
    let row = rows[0];
    assert_eq!(row.label, "PB1");
    assert!(row.lower <= 0.1 && 0.1 <= row.upper);
    // The persistence is counted only from 0.1 + √(5e-3) = 0.171 on.
    assert!(row.upper > 0.165 && row.upper - row.lower < 0.1);
    assert!((row.value - 0.1).abs() < 0.01);
    assert_eq!(row.status(), BifurcationStatus::Unresolved);
    assert_eq!(row.before.peaks, 1);
    assert_eq!(row.after.peaks, 2);
}

#[test]
fn without_noise_the_bracket_reaches_the_tolerance() {
    let detector = SquareLaw {
        birth: 0.1,
        noise: 1e-12,
    };
    let result = run(&Ramp::new(-1.0, 1.0), &detector, 41, 1e-4);
    let rows = bifurcations(&result);
    // What cells count is no proof, however narrow the bracket.
    assert_eq!(rows[0].status(), BifurcationStatus::Unresolved);
    assert!(rows[0].upper - rows[0].lower <= 1e-4);
    assert!(rows[0].lower <= 0.1 && 0.1 <= rows[0].upper);
    // 0.05 / 2^9 < 1e-4: nine halvings and no more.
    assert_eq!(result.points.len(), 41 + 9);
}

#[test]
fn the_direction_of_the_sweep_changes_no_row() {
    let detector = SquareLaw {
        birth: 0.1,
        noise: 1e-3,
    };
    let up = run(&Ramp::new(-1.0, 1.0), &detector, 41, 1e-3);
    let down = run(&Ramp::new(1.0, -1.0), &detector, 41, 1e-3);
    let (a, b) = (bifurcations(&up), bifurcations(&down));
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(&b) {
        assert_eq!(
            (a.before, a.after, a.status()),
            (b.before, b.after, b.status())
        );
        for (x, y) in [(a.value, b.value), (a.lower, b.lower), (a.upper, b.upper)] {
            assert!((x - y).abs() < 1e-12);
        }
    }
}

#[test]
fn failures_are_rows_and_do_not_stop_the_sweep() {
    let source = Ramp {
        failing: Some((-0.35, 0.05)),
        ..Ramp::new(-1.0, 1.0)
    };
    let detector = SquareLaw {
        birth: 0.5,
        noise: 1e-6,
    };
    let result = run(&source, &detector, 21, 1e-3);
    let failures: Vec<_> = result
        .labels
        .iter()
        .filter(|row| matches!(row, Label::Failure { .. }))
        .collect();
    assert_eq!(failures.len(), 1);
    let (lower, upper) = failures[0].bracket();
    assert!((lower + 0.3).abs() < 1e-12 && upper == 0.0);
    assert_eq!(failures[0].name(), "MX1");
    assert_eq!(bifurcations(&result).len(), 1);
    assert_eq!(result.labels[0].name(), "EP1");
}

#[test]
fn an_interruption_keeps_the_points_so_far() {
    struct StopAfter(usize, Cancellation);
    impl Observer for StopAfter {
        fn point(
            &mut self,
            _: &Point,
            done: usize,
            _: usize,
        ) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
            if done == self.0 {
                self.1.cancel();
            }
            Ok(())
        }
    }
    let cancellation = Cancellation::new();
    let mut observer = StopAfter(7, cancellation.clone());
    let detector = SquareLaw {
        birth: 0.1,
        noise: 1e-6,
    };
    let options = LocateOptions::default();
    let source = Ramp::new(-1.0, 1.0);
    let result = sweep(
        &source,
        &detector,
        41,
        &options,
        &cancellation,
        &mut observer,
    )
    .unwrap();
    assert!(result.interrupted);
    assert_eq!(result.points.len(), 7);
}

#[test]
fn known_points_are_not_solved_again_detected_in_once_and_change_nothing() {
    struct Knowing(Vec<Point>);
    impl Observer for Knowing {
        fn known_points(&mut self) -> Vec<Point> {
            std::mem::take(&mut self.0)
        }
    }
    /// Counts the densities in which is detected.
    struct Counting(SquareLaw, AtomicUsize);
    impl Detector for Counting {
        fn name(&self) -> &'static str {
            self.0.name()
        }
        fn detect(&self, density: &EstimatedDensity) -> Detection {
            self.1.fetch_add(1, Ordering::Relaxed);
            self.0.detect(density)
        }
    }
    let found = |source: &Ramp, known: Vec<Point>| {
        let options = LocateOptions {
            largest_distance: 2e-3,
            tolerance: Some(1e-3),
            ..LocateOptions::default()
        };
        let law = SquareLaw {
            birth: 0.1,
            noise: 1e-6,
        };
        let seen = known
            .iter()
            .filter(|one| !one.detections.is_empty())
            .count();
        let (detector, mut observer) = (Counting(law, AtomicUsize::new(0)), Knowing(known));
        let never = Cancellation::new();
        let result = sweep(source, &detector, 41, &options, &never, &mut observer).unwrap();
        assert_eq!(detector.1.into_inner() + seen, result.points.len());
        let points = result.points.iter();
        let table: Vec<(f64, Option<f64>)> = points.map(|one| (one.value, one.distance)).collect();
        (table, format!("{:?}", result.labels), result.points)
    };
    for (from, to, segments) in [(-1.0, 1.0, 1), (1.0, -1.0, 1), (-1.0, 1.0, 3)] {
        let source = Ramp {
            segments,
            ..Ramp::new(from, to)
        };
        let whole = found(&source, Vec::new());
        assert!(whole.2.len() > 2 * 41);
        let known = |is_known: fn(usize) -> bool| {
            let points = whole.2.iter().cloned().enumerate();
            let mut known: Vec<Point> = points
                .filter(|(place, _)| is_known(*place))
                .map(|(place, point)| Point {
                    // Of every other one it is known what was detected.
                    detections: match place % 2 {
                        0 => Vec::new(),
                        _ => point.detections,
                    },
                    distance: None,
                    ..point
                })
                .collect();
            known.reverse();
            known
        };
        // Some of them, and all: then a source that refuses every value is not asked.
        let refusing = Ramp {
            refused: Some((-2.0, 2.0)),
            ..source.clone()
        };
        let some = found(&source, known(|place| place % 3 != 1));
        let all = found(&refusing, known(|_| true));
        for again in [some, all] {
            assert_eq!((&again.0, &again.1), (&whole.0, &whole.1));
        }
    }
}

#[test]
fn segments_side_by_side_give_what_one_gives() {
    let detector = SquareLaw {
        birth: 0.1,
        noise: 1e-6,
    };
    let found = |source: &Ramp| {
        let options = LocateOptions {
            // Neighbours are farther apart, within segments and across their borders.
            largest_distance: 2e-3,
            tolerance: Some(1e-3),
            ..LocateOptions::default()
        };
        let never = Cancellation::new();
        sweep(source, &detector, 41, &options, &never, &mut ())
    };
    let table = |result: &SweepResult| {
        let points = result.points.iter();
        let points: Vec<(f64, Option<f64>)> = points.map(|one| (one.value, one.distance)).collect();
        (points, format!("{:?}", result.labels))
    };
    for (from, to) in [(-1.0, 1.0), (1.0, -1.0)] {
        let whole = found(&Ramp::new(from, to)).unwrap();
        assert!(whole.points.len() > 2 * 41 && bifurcations(&whole).len() == 1);
        for segments in [2, 3, 7, 41] {
            let source = Ramp {
                segments,
                ..Ramp::new(from, to)
            };
            assert_eq!(table(&found(&source).unwrap()), table(&whole), "{segments}");
            // What is refused at the first value is a mistake, elsewhere it is a row.
            let refusing = |refused| Ramp {
                refused: Some(refused),
                ..source.clone()
            };
            let first = found(&refusing((from - 0.01, from + 0.01)));
            assert!(matches!(first, Err(SweepError::Source { value, .. }) if value == from));
            let later = found(&refusing((-0.01, 0.01))).unwrap();
            let mut points = later.points.iter();
            assert!(points.any(|one| one.report.status == PointStatus::Failed));
        }
    }
}

#[test]
fn given_values_hit_both_ends_and_zero_exactly() {
    let values = evenly_spaced((-0.02, 0.01), 31);
    assert_eq!((values[0], values[30]), (-0.02, 0.01));
    assert_eq!((values[10], values[20]), (-0.01, 0.0));
}
