//! The curves that hang together with one of a sweep's rows.

use pbif::cancellation::Cancellation;
use pbif::continuation::LabelledPoint;
use pbif::continuation::curve::{CurveOptions, CurveStart, CurveTree, Plane, follow_all};

use super::sweeps::prepared;

/// What a curve needs of the sweep it starts from: the first row that `is_start` takes, and the value at which the
/// sweep holds the second parameter.
pub(crate) struct Start {
    pub(crate) is_start: fn(&LabelledPoint) -> bool,
    pub(crate) held: f64,
}

/// The tree of curves in a box of two parameters, each with its name and ends, at a tolerance of 1e-3 of its sides.
pub(crate) fn tree(
    text: &str,
    start: Start,
    (first, second): ((&str, f64, f64), (&str, f64, f64)),
    options: CurveOptions,
) -> CurveTree {
    let never = Cancellation::new();
    let sweep = prepared(text, &[]);
    let result = sweep.run(&never, &mut ()).unwrap();
    let mut rows = result.labels.iter().filter(|row| (start.is_start)(row));
    let start = rows.find_map(|row| CurveStart::from_row(row, start.held, sweep.problem.subject()));
    let plane = Plane::new(first, second).unwrap();
    let source = sweep.source_in(&plane, &never).unwrap();
    let options = CurveOptions {
        tolerance: 1e-3,
        ..options
    };
    let (detector, start) = (sweep.detector(), start.unwrap());
    let watched = &mut |_: [f64; 2]| ();
    follow_all(
        &source, &plane, &detector, &start, &options, &never, watched,
    )
    .unwrap()
}
