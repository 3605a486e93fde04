//! Location with the real detector on closed-form densities, whose bifurcations are known exactly.

use super::*;
use crate::cancellation::Cancellation;
use crate::density::{Density, EstimatedDensity, Kink, Observable, Structure, Variants};
use crate::space::Axis;
use crate::system::examples::bistable;
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
            cell_check: CellCheck::OnFinerCells { ratio: 1.25 },
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
            observable: self.subject.observables[0],
            standard_error: vec![0.0; density.values.len()],
            density,
            variants: Variants::None,
            structure: (self.structure)(value),
            negligible: crate::density::NEGLIGIBLE,
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

    fn finer(&self) -> Result<Option<Box<dyn DensitySource>>, SourceError> {
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

fn rows(result: &SweepResult) -> Vec<&LabelledPoint> {
    let labels = result.labels.iter();
    labels
        .filter(|row| row.kind == PointType::Bifurcation)
        .collect()
}

fn words(row: &LabelledPoint) -> String {
    let signature = |one: Option<crate::topology::Signature>| one.unwrap().to_string();
    format!(
        "{} → {}, {}",
        signature(row.before),
        signature(row.after),
        row.change
    )
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
    assert_eq!(row.status, Some(BifurcationStatus::Located));
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
            row.status,
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
fn checks_that_were_seen_are_not_solved_again() {
    #[derive(Default)]
    struct Keeper {
        kept: Vec<KeptCheck>,
        checked: Vec<KeptCheck>,
    }
    impl Observer for Keeper {
        fn checked(
            &mut self,
            check: &KeptCheck,
        ) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
            self.checked.push(check.clone());
            Ok(())
        }

        fn kept_checks(&mut self) -> Vec<KeptCheck> {
            std::mem::take(&mut self.kept)
        }
    }
    let mut source = split();
    source.subject.family = bistable(-0.5, 0.5);
    let detector = PersistenceDetector::new(DetectOptions::default(), 11);
    let (options, never) = (LocateOptions::default(), Cancellation::new());
    let swept = |kept: &[KeptCheck]| {
        let mut keeper = Keeper {
            kept: kept.to_vec(),
            ..Keeper::default()
        };
        let result = sweep(&source, &detector, 11, &options, &never, &mut keeper).unwrap();
        assert_eq!(rows(&result).len(), 1);
        (rows(&result)[0].clone(), result.checks, keeper.checked)
    };
    let (row, checks, seen) = swept(&[]);
    assert!(!seen.is_empty());
    for kept in 0..=seen.len() {
        let again = swept(&seen[..kept]);
        assert_eq!((&again.0, &again.1), (&row, &checks));
        assert_eq!(again.2, seen[kept..]);
    }
    // A check that was kept of something else is of no use, and does no harm.
    let mut other = seen[0].clone();
    other.seen.value += 1e-9;
    assert_eq!(swept(&[other]).2, seen);
}

/// As [`split`], with tails of which a depth is taken away.
fn torn_split(depth: f64) -> Exact<impl Formula> {
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
        let result = run(&torn_split(depth), (-0.5, 0.5, 11), 1e-4);
        let row = rows(&result)[0].clone();
        assert!((row.value - 0.03).abs() <= row.error, "{row:?}");
        (row.status, row.reason)
    };
    assert_eq!(status(0.0).0, Some(BifurcationStatus::Located));
    // 0.8 in x at about a tenth of the height of a density some two wide: four per cent of the mass, or two thousandths of it.
    let (torn, reason) = status(0.1);
    assert_eq!(torn, Some(BifurcationStatus::Unresolved));
    assert!(reason.unwrap().contains("of the density there is negative"));
    assert_eq!(status(0.005).0, Some(BifurcationStatus::Located));
}

/// A main peak at -1 and, from θ = 0 on, a pair born at 0.5: (log p)' = -(x + 1)(2 (x - 0.5)² - θ); mirrored for sign -1.
fn flank(sign: f64) -> Exact<impl Formula> {
    Exact::new(
        1,
        120,
        |_| Structure::default(),
        move |theta: f64, at: &[f64]| {
            let x = sign * at[0];
            let potential = 0.5 * x.powi(4) - (1.5 + theta) * 0.5 * x * x + (0.5 - theta) * x;
            (-potential).exp()
        },
    )
}

#[test]
fn a_pair_born_on_a_flank_is_located_by_the_slope_at_its_inflection() {
    let result = run(&flank(1.0), (-0.5, 0.55, 22), 1e-3);
    let rows = rows(&result);
    assert_eq!(rows.len(), 1, "{rows:?}");
    let row = rows[0];
    assert_eq!(words(row), "1 peak → 2 peaks, peak and valley are born");
    assert_eq!(row.method, "slope at the inflection");
    assert_eq!(row.status, Some(BifurcationStatus::Located), "{row:?}");
    assert!(row.value.abs() <= row.error && row.error < 1e-3, "{row:?}");
}

#[test]
fn mirroring_a_density_without_symmetry_changes_no_row() {
    let located = |sign: f64| {
        let result = run(&flank(sign), (-0.5, 0.55, 22), 1e-3);
        let row = rows(&result)[0].clone();
        (words(&row), row.value, row.error, row.status)
    };
    let (plain, mirrored) = (located(1.0), located(-1.0));
    assert_eq!((&plain.0, plain.3), (&mirrored.0, mirrored.3));
    assert!((plain.1 - mirrored.1).abs() < 1e-9 && (plain.2 - mirrored.2).abs() < 1e-9);
}

#[test]
fn a_stage_within_a_narrow_window_has_its_own_rows() {
    // Curvatures θ and θ + 0.002 at the centre: two peaks only for -0.002 < θ < 0, between given values.
    let source = Exact::new(
        2,
        60,
        |_| centred(2),
        |theta: f64, at: &[f64]| {
            let (x, y) = (at[0], at[1]);
            let square = x * x + y * y;
            (0.5 * (theta * x * x + (theta + 0.002) * y * y) - 0.5 * square * square).exp()
        },
    );
    let result = run(&source, (-0.525, 0.475, 11), 1e-5);
    let rows = rows(&result);
    let found: Vec<String> = rows.iter().map(|row| words(row)).collect();
    assert_eq!(
        found,
        [
            "1 peak → 2 peaks, symmetric split",
            "2 peaks → crater with 2 peaks, crater opens"
        ]
    );
    for (row, truth) in rows.iter().zip([-0.002, 0.0]) {
        assert!(
            (row.value - truth).abs() <= row.error && row.error < 1e-4,
            "{row:?}"
        );
    }
}

#[test]
fn two_changes_between_two_given_values_are_both_found() {
    // The curvature (θ - 0.52)² - 0.0004 is positive at all given values; the valley is a peak only from 0.50 to 0.54.
    let source = Exact::new(
        1,
        100,
        |_| centred(1),
        |theta: f64, at: &[f64]| {
            let x = at[0];
            let curvature = (theta - 0.52).powi(2) - 0.0004;
            (4.0 * (0.5 * curvature * x * x - 0.25 * x.powi(4))).exp()
        },
    );
    let result = run(&source, (0.0, 0.95, 11), 1e-3);
    let found: Vec<(String, f64)> = rows(&result)
        .iter()
        .map(|row| (words(row), row.value))
        .collect();
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(found[0].0.starts_with("2 peaks → 1 peak") && (found[0].1 - 0.50).abs() < 1e-4);
    assert!(found[1].0.starts_with("1 peak → 2 peaks") && (found[1].1 - 0.54).abs() < 1e-4);
}

#[test]
fn curvatures_that_vanish_together_make_one_row() {
    let source = Exact::new(
        2,
        60,
        |_| centred(2),
        |theta: f64, at: &[f64]| {
            let square = at[0] * at[0] + at[1] * at[1];
            (0.5 * theta * square - 0.5 * square * square).exp()
        },
    );
    let result = run(&source, (-0.5, 0.5, 10), 1e-4);
    let rows = rows(&result);
    assert_eq!(rows.len(), 1, "{rows:?}");
    assert!(
        words(rows[0]).starts_with("1 peak → ring, ring opens"),
        "{}",
        words(rows[0])
    );
    assert!(rows[0].value.abs() <= rows[0].error && rows[0].error < 1e-4);
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

/// With a kink at 0.4; mirrored for sign -1.
fn kinked<F: Fn(f64, f64) -> f64 + Clone + Send + Sync + 'static>(
    sign: f64,
    structure: fn(f64) -> Structure,
    log_density: F,
) -> Exact<impl Formula> {
    Exact::new(1, 100, structure, move |theta: f64, at: &[f64]| {
        log_density(theta, sign * at[0] - 0.4).exp()
    })
}

#[test]
fn a_pair_born_at_a_kink_that_is_no_centre_is_located_by_the_slope_beside_it() {
    fn kink(at: f64) -> Structure {
        Structure {
            kinks: vec![Kink {
                axis: 0,
                at,
                jump: vec![1.0],
            }],
            ..Structure::default()
        }
    }
    for sign in [1.0, -1.0] {
        let structure: fn(f64) -> Structure = match sign > 0.0 {
            true => |_| kink(0.4),
            false => |_| kink(-0.4),
        };
        // Slopes 1.2 ± 2θ beside the kink, and -2 from there on: it becomes a valley below a peak at θ = 0.6.
        let notch = kinked(sign, structure, |theta: f64, u: f64| {
            1.2 * u - u * u + 2.0 * theta * u.abs()
        });
        let result = run(&notch, (0.23, 1.0, 12), 1e-4);
        let found = rows(&result);
        assert_eq!(found.len(), 1, "{found:?}");
        let row = found[0];
        assert_eq!(
            words(row),
            "1 peak → 2 peaks, peak and valley are born at a kink"
        );
        assert_eq!(row.status, Some(BifurcationStatus::Located), "{row:?}");
        assert!(
            (row.value - 0.6).abs() <= row.error && row.error < 1e-4,
            "{row:?}"
        );
        // Above the kink the slope is -θ + 2u - 3u²: a tip and a valley from 0 on, until valley and peak vanish at 1/3.
        let tip = kinked(sign, structure, |theta: f64, u: f64| match u < 0.0 {
            true => u,
            false => -theta * u + u * u - u.powi(3),
        });
        let result = run(&tip, (-0.31, 0.5, 12), 1e-4);
        let found = rows(&result);
        let told: Vec<String> = found.iter().map(|row| words(row)).collect();
        let expected = [
            "1 peak → 2 peaks, peak and valley are born at a kink",
            "2 peaks → 1 peak, peak and valley vanish",
        ];
        assert_eq!(told, expected);
        for (row, truth) in found.iter().zip([0.0, 1.0 / 3.0]) {
            assert_eq!(row.status, Some(BifurcationStatus::Located), "{row:?}");
            assert!((row.value - truth).abs() <= row.error, "{row:?}");
        }
    }
}

#[test]
fn densities_that_change_fast_get_values_between() {
    // A peak that moves by four of its widths a step.
    let source = Exact::new(
        1,
        200,
        |_| Structure::default(),
        |theta: f64, at: &[f64]| (-0.5 * ((at[0] - theta) / 0.05).powi(2)).exp(),
    );
    let result = run(&source, (-1.0, 1.0, 11), 1e-3);
    let largest = result
        .points
        .iter()
        .filter_map(|point| point.distance)
        .fold(0.0, f64::max);
    assert!(result.points.len() > 11 && largest <= LocateOptions::default().largest_distance);
    assert!(rows(&result).is_empty());
}

#[test]
fn two_folds_within_one_step_have_a_row_each() {
    // (log p)' = -(x - 1.1) (x + 1.1) ... three peaks become one: shoulders of opposite flanks pass zero at 0.1 and 0.11.
    let source = Exact::new(
        1,
        160,
        |_| Structure::default(),
        |theta: f64, at: &[f64]| {
            let x = at[0];
            // A wide hill and two bumps on its flanks, whose heights fall below what makes a peak.
            let bump = |c: f64, w: f64| w * (-0.5 * ((x - c) / 0.15).powi(2)).exp();
            (-0.5 * x * x + bump(-1.0, 0.3 - theta) + bump(1.0, 0.31 - theta)).exp()
        },
    );
    let result = run(&source, (0.0, 0.3, 4), 1e-4);
    let found: Vec<String> = rows(&result)
        .iter()
        .map(|row| format!("{} {:?} {}", words(row), row.status, row.value))
        .collect();
    assert_eq!(found.len(), 2, "{found:#?}");
    let rows = rows(&result);
    assert_eq!(words(rows[0]), "3 peaks → 2 peaks, peak and valley vanish");
    assert_eq!(words(rows[1]), "2 peaks → 1 peak, peak and valley vanish");
    assert!(
        (rows[1].value - rows[0].value - 0.01).abs() < 1e-4,
        "the same bump, 0.01 higher: {found:#?}"
    );
    assert!(
        rows.iter()
            .all(|row| row.status == Some(BifurcationStatus::Located))
    );
}

#[test]
fn changes_that_undo_each_other_far_apart_keep_their_rows_though_neither_is_located() {
    // One bump of a wide hill grows as much as the other shrinks: by symmetry their pairs are born and vanish at θ and 0.6 - θ.
    let source = Exact::new(
        1,
        160,
        |_| Structure::default(),
        |theta: f64, at: &[f64]| {
            let x = at[0];
            let bump = |c: f64, w: f64| w * (-0.5 * ((x - c) / 0.15).powi(2)).exp();
            (-0.5 * x * x + bump(-1.0, theta) + bump(1.0, 0.6 - theta)).exp()
        },
    );
    let result = run(&source, (0.1, 0.5, 8), 1e-9);
    let rows = rows(&result);
    let found: Vec<String> = rows.iter().map(|row| words(row)).collect();
    assert_eq!(rows.len(), 2, "{found:?}");
    assert_eq!(rows[0].before, rows[1].after, "{found:?}");
    for row in &rows {
        assert_eq!(row.status, Some(BifurcationStatus::Unresolved));
        assert!(row.error < 1e-3 && row.reason.is_some(), "{row:?}");
    }
    let (sum, error) = (rows[0].value + rows[1].value, rows[0].error + rows[1].error);
    assert!((sum - 0.6).abs() <= error, "{sum} ± {error}");
}

#[test]
fn the_end_of_a_ring_around_a_peak_is_located() {
    let source = Exact::new(
        2,
        80,
        |_| centred(2),
        |c: f64, at: &[f64]| {
            let energy = at[0] * at[0] + at[1] * at[1];
            (-6.0 * (c * energy - 0.5 * energy.powi(2) + energy.powi(3) / 3.0)).exp()
        },
    );
    let result = run(&source, (-0.2, 0.5, 11), 1e-4);
    let found: Vec<String> = rows(&result)
        .iter()
        .map(|row| {
            format!(
                "{} {:?} {} {}",
                words(row),
                row.status,
                row.value,
                row.error
            )
        })
        .collect();
    assert_eq!(found.len(), 2, "{found:#?}");
    let rows = rows(&result);
    assert!(
        words(rows[0]).starts_with("ring → peak in a ring"),
        "{found:#?}"
    );
    assert!(
        words(rows[1]).starts_with("peak in a ring → 1 peak, ring vanishes"),
        "{found:#?}"
    );
    for (row, truth) in rows.iter().zip([0.0, 0.25]) {
        assert_eq!(row.status, Some(BifurcationStatus::Located), "{found:#?}");
        assert!(
            (row.value - truth).abs() <= row.error && row.error < 1e-4,
            "{found:#?}"
        );
    }
}

#[test]
fn a_peak_born_beside_another_in_the_plane_is_located() {
    let source = Exact::new(
        2,
        90,
        |_| Structure::default(),
        |h: f64, at: &[f64]| {
            let (x, y) = (0.8 * at[0] + 0.6 * at[1], 0.8 * at[1] - 0.6 * at[0]);
            (-6.0 * (0.5 * y * y - h * x - 0.5 * x * x + 0.25 * x.powi(4))).exp()
        },
    );
    let result = run(&source, (-0.55, 0.5, 12), 1e-4);
    let found: Vec<String> = rows(&result)
        .iter()
        .map(|row| {
            format!(
                "{} {:?} {} {}",
                words(row),
                row.status,
                row.value,
                row.error
            )
        })
        .collect();
    assert_eq!(found.len(), 2, "{found:#?}");
    let truth = (4.0f64 / 27.0).sqrt();
    for (row, truth) in rows(&result).iter().zip([-truth, truth]) {
        assert_eq!(row.status, Some(BifurcationStatus::Located), "{found:#?}");
        assert!(
            (row.value - truth).abs() <= row.error && row.error < 1e-4,
            "{found:#?}"
        );
    }
}

#[test]
fn a_split_that_is_not_quite_symmetric_is_located_where_its_pair_is_born() {
    // (log p)' = 8 (0.001 + θ x - x³): 27 · 0.001² = 4 θ³.
    let source = Exact::new(
        1,
        100,
        |_| Structure::default(),
        |theta: f64, at: &[f64]| {
            let x = at[0];
            (8.0 * (0.001 * x + 0.5 * theta * x * x - 0.25 * x.powi(4))).exp()
        },
    );
    let result = run(&source, (-1.0, 1.0, 41), 2e-4);
    let truth = 3.0 * (0.0005f64).powf(2.0 / 3.0);
    let found: Vec<String> = rows(&result)
        .iter()
        .map(|row| {
            format!(
                "{} {:?} {} {} {truth}",
                words(row),
                row.status,
                row.value,
                row.error
            )
        })
        .collect();
    assert_eq!(found.len(), 1, "{found:#?}");
    let row = rows(&result)[0];
    assert!((row.value - truth).abs() <= row.error, "{found:#?}");
}
