//! Curves in planes of two parameters beside what is known exactly.

use pbif::cancellation::Cancellation;
use pbif::continuation::curve::{
    CodimensionTwoKind, Curve, CurveError, CurveOptions, CurveStart, CurveTree, EndReason, Plane,
    codimension_two, follow, follow_all,
};
use pbif::continuation::map::RegimeMap;
use pbif::continuation::{Located, SweepResult};
use pbif::sweep_file::Sweep;

use crate::common::room::{Printed, Room};
use crate::common::sweeps::{prepared, rows, swept};

/// The name of a parameter, from where and to where.
pub(super) type Side<'a> = (&'a str, f64, f64);

/// Distance of a point (h, a) from 27 h² = 4 a³, the fold of a tilted double well, in a box with sides of these
/// lengths.
pub(super) fn off_the_fold([h, a]: [f64; 2], [of_h, of_a]: [f64; 2]) -> f64 {
    (27.0 * h * h - 4.0 * a.powi(3)) / (54.0 * h * of_h).hypot(12.0 * a * a * of_a)
}

/// How far a place is from another, in sides of the box.
pub(super) fn off(curve: &Curve, values: [f64; 2], exact: [f64; 2]) -> f64 {
    let sides = curve.plane.sides();
    let gap = [0, 1].map(|k| (values[k] - exact[k]) / sides[k].length());
    gap[0].hypot(gap[1])
}

/// The row of an observable that an indicator of this name located.
pub(super) fn row<'a>(result: &'a SweepResult, observable: &str, method: &str) -> &'a Located {
    let mut rows = rows(result, observable).into_iter();
    rows.find(|row| row.method() == method).unwrap()
}

/// The curve from a start in a plane, or why there is none.
pub(super) fn followed(
    sweep: &Sweep,
    plane: &Plane,
    start: &CurveStart,
    options: &CurveOptions,
) -> Result<Curve, CurveError> {
    let never = Cancellation::new();
    let source = sweep.source_in(plane, &never).unwrap();
    let (detector, watched) = (sweep.detector(), &mut |_: [f64; 2]| ());
    follow(&source, plane, &detector, start, options, &never, watched)
}

/// The curve from a row in the plane of the swept and a second parameter, which the sweep holds at `held`.
pub(super) fn curve(sweep: &Sweep, row: &Located, plane: &Plane, held: f64) -> Curve {
    let start = CurveStart::from_row(row, held, sweep.problem.subject()).unwrap();
    followed(sweep, plane, &start, &CurveOptions::default()).unwrap()
}

/// The same of the row of an observable that an indicator of this name located.
pub(super) fn curve_of(
    (sweep, result): &(Sweep, SweepResult),
    (observable, method): (&str, &str),
    (first, second): (Side<'_>, Side<'_>),
    held: f64,
) -> Curve {
    let plane = Plane::new(first, second).unwrap();
    curve(sweep, row(result, observable, method), &plane, held)
}

pub(super) fn stepping(largest_step: f64) -> CurveOptions {
    CurveOptions {
        largest_step,
        ..CurveOptions::default()
    }
}

/// The curves that hang together with that of the first row that `is_start` takes, in a box of two parameters, of which
/// the sweep holds the second at `held`, at a tolerance of 1e-3 of its sides. None is missed.
pub(super) fn tree(
    text: &str,
    is_start: fn(&Located) -> bool,
    (first, second): (Side<'_>, Side<'_>),
    held: f64,
    options: CurveOptions,
) -> CurveTree {
    let never = Cancellation::new();
    let (sweep, result) = swept(text, "");
    let row = result.bifurcations().filter(|row| is_start(row));
    let mut starts = row.filter_map(|row| CurveStart::from_row(row, held, sweep.problem.subject()));
    let plane = Plane::new(first, second).unwrap();
    let source = sweep.source_in(&plane, &never).unwrap();
    let options = CurveOptions {
        tolerance: 1e-3,
        ..options
    };
    let (detector, watched) = (sweep.detector(), &mut |_: [f64; 2]| ());
    let start = starts.next().unwrap();
    let tree = follow_all(
        &source, &plane, &detector, &start, &options, &never, watched,
    )
    .unwrap();
    assert!(tree.missed.is_empty(), "{:?}", tree.missed);
    tree
}

pub(super) fn mapped(text: &str, settings: &str) -> RegimeMap {
    let sweep = prepared(text, settings);
    sweep.map(&Cancellation::new(), &|_| ()).unwrap().unwrap()
}

/// Asserts that a curve lies where a function of both parameters is zero: `off` gives its distance to there across the
/// curve, in sides of the box, which is within the stated error and at most `largest`.
pub(super) fn assert_on(curve: &Curve, largest: f64, off: impl Fn([f64; 2]) -> f64) {
    for point in &curve.points {
        let off = off(point.values).abs();
        assert!(
            off <= largest && off <= point.error,
            "{point:?}: {off:.1e} off"
        );
    }
}

pub(super) fn ends(curve: &Curve) -> Vec<&EndReason> {
    curve.ends.iter().map(|end| &end.reason).collect()
}

/// Asserts that curves have one point of codimension two, of this label and kind and of these curves, which lies at an
/// exact place within its error, and that this error is below `largest`.
pub(super) fn assert_meet(
    curves: &[Curve],
    (label, kind): (&str, CodimensionTwoKind),
    of: &[usize],
    exact: [f64; 2],
    largest: f64,
) {
    let points = codimension_two(curves);
    let [point] = points.as_slice() else {
        panic!("{points:?}");
    };
    assert_eq!((point.label.as_str(), point.kind), (label, kind));
    assert_eq!(point.curves, of);
    let off = off(&curves[0], point.values, exact);
    assert!(
        off <= point.error && point.error < largest,
        "{point:?}: {off:.1e}"
    );
}

/// Draws a stored plane again into `again`, to the same picture.
pub(super) fn assert_drawn_again(room: &Room, folder: &str, picture: &str) -> Printed {
    let printed = room.done(&format!("plot {folder} --quiet --out again --format svg"));
    let again = room.read(&format!("again/{picture}"));
    assert_eq!(again, room.read(&format!("{folder}/figures/{picture}")));
    printed
}
