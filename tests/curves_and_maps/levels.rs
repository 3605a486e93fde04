//! Curves on which a number of the steady state is at a level, against closed forms, and through the program.

use pbif::cancellation::Cancellation;
use pbif::continuation::BifurcationStatus;
use pbif::continuation::curve::{
    CurveError, CurveOptions, EndReason, LevelCurve, Plane, follow_level,
};
use pbif::system::MeasureLevel;
use pbif::topology::Detector as _;

use super::support::{Side, stepping};
use crate::common::room::Room;
use crate::common::sweeps::prepared;

/// The mean time from rest to |v| = 1 is (D/f²)(e^{f/D} - 1) - 1/f.
const DRY: &str = r#"
system.equations = { v = "-f sgn(v)" }
system.noise = { v = "sqrt(2 D)" }
system.parameters = { f = 1.0, D = 0.4 }
sweep = { parameter = "f", from = 0.5, to = 2.0, points = 9 }
cells.v = { from = -1.5, to = 1.5, count = 120 }
passage.out = { start = { v = 0.0 }, until = "abs(v) > 1" }
levels = { out_mean = 3.0 }
locate = { relative_tolerance = 1e-3 }
"#;

/// The standard deviation of x is 1/√(1 + u² + v²): a level is a circle.
const CIRCLE: &str = r#"
system.equations = { x = "-(1 + u^2 + v^2) x" }
system.noise = { x = "sqrt(2)" }
system.parameters = { u = 0.0, v = 0.1 }
sweep = { parameter = "u", from = -1.0, to = 1.0, points = 9 }
cells.x = { from = -6.0, to = 6.0, count = 120 }
levels = { sd_x = 0.8 }
locate = { relative_tolerance = 1e-3 }
"#;

/// The curve of a level from a start in a box, by the method that words set.
fn level(
    (text, words): (&str, &str),
    (first, second): (Side<'_>, Side<'_>),
    (start, measure, level): ([f64; 2], &str, f64),
    options: &CurveOptions,
) -> Result<(Plane, LevelCurve), CurveError> {
    let (sweep, never) = (prepared(text, words), Cancellation::new());
    let plane = Plane::new(first, second).unwrap();
    let asked = MeasureLevel {
        measure: measure.to_owned(),
        level,
    };
    let one = std::slice::from_ref(&asked);
    let source = sweep.source_of_levels(&plane, one, &never).unwrap();
    let begun = (start, &asked);
    let how = (options, sweep.detector().confidence());
    let met = follow_level(source.as_ref(), &plane, begun, how, &never, &mut |_| ());
    met.map(|curve| (plane, curve))
}

/// How many times its error a point is off a curve F = 0 at most, in the box of a plane.
#[track_caller]
fn assert_on(curve: &LevelCurve, plane: &Plane, of: impl Fn([f64; 2]) -> f64) -> f64 {
    let lengths = [0, 1].map(|k| plane.sides()[k].to - plane.sides()[k].from);
    let mut worst: f64 = 0.0;
    for point in &curve.points {
        let at = point.values;
        let off = distance(at, lengths, &of);
        assert!(
            off <= point.error,
            "{at:?}: off by {off}, stated {}",
            point.error
        );
        worst = worst.max(off / point.error);
    }
    worst
}

/// How far a place is from the curve F = 0, in a box with sides of length one.
fn distance(at: [f64; 2], lengths: [f64; 2], of: impl Fn([f64; 2]) -> f64) -> f64 {
    let slope = [0, 1].map(|k| {
        let beside = |sign: f64| {
            let mut at = at;
            at[k] += sign * 1e-5 * lengths[k];
            of(at)
        };
        (beside(1.0) - beside(-1.0)) / 2e-5
    });
    of(at).abs() / slope[0].hypot(slope[1])
}

fn time([f, d]: [f64; 2]) -> f64 {
    let mean = d / (f * f) * ((f / d).exp() - 1.0) - 1.0 / f;
    (mean / 3.0).ln()
}

#[test]
fn a_mean_time_of_first_passage_is_followed_from_border_to_border() {
    let sides = (("f", 0.5, 2.0), ("D", 0.2, 0.8));
    let start = ([0.8776, 0.4], "out_mean", 3.0);
    let (plane, curve) = level((DRY, ""), sides, start, &stepping(0.05)).unwrap();
    let worst = assert_on(&curve, &plane, time);
    assert!(worst > 0.05, "errors are {worst} of what is stated at most");
    let borders = curve.ends.iter().map(|end| end.reason.clone());
    assert!(
        borders.eq([EndReason::Border(0), EndReason::Border(0)]),
        "{:?}",
        curve.ends
    );
    let largest = curve
        .points
        .iter()
        .map(|point| point.error)
        .fold(0.0, f64::max);
    assert!(largest < 1e-4, "{largest}");
    let mut located = curve.points.iter();
    assert!(located.all(|point| point.status() == BifurcationStatus::Located));
    // Two solves a point, and four more where it begins.
    let [points, solves] = [curve.points.len(), curve.work.solves];
    assert!(
        points >= 20 && solves <= 2 * points + 8,
        "{solves} solves of {points} points"
    );
}

#[test]
fn a_closed_curve_of_a_level_is_followed_round() {
    let sides = (("u", -1.0, 1.0), ("v", -1.0, 1.0));
    let start = ([0.74, 0.1], "sd_x", 0.8);
    let (plane, curve) = level((CIRCLE, ""), sides, start, &CurveOptions::default()).unwrap();
    assert_on(&curve, &plane, |[u, v]| (u * u + v * v - 0.5625) / 4.0);
    assert_eq!(curve.ends.len(), 1);
    assert_eq!(curve.ends[0].reason, EndReason::Closed);
    let length = curve.points.last().unwrap().arclength - curve.points[0].arclength;
    // A circle of radius 0.75 in a box of sides two, by chords.
    assert!(
        (length - std::f64::consts::PI * 0.75).abs() < 5e-3,
        "{length}"
    );
}

#[test]
fn sampled_times_are_followed_within_their_errors() {
    let by_paths = "method.kind=monte-carlo method.error=0.1 detect.confidence=0.999";
    let sides = (("f", 0.5, 2.0), ("D", 0.2, 0.8));
    let start = ([0.8776, 0.4], "out_mean", 3.0);
    let (plane, curve) = level((DRY, by_paths), sides, start, &stepping(0.2)).unwrap();
    assert_on(&curve, &plane, time);
    let inside = curve
        .ends
        .iter()
        .filter(|end| !matches!(end.reason, EndReason::Border(_)));
    assert_eq!(inside.count(), 0, "{:?}", curve.ends);
    // Samples leave more open than is wanted, and the points say so.
    let mut doubtful = curve.points.iter();
    assert!(doubtful.all(|point| point.status() == BifurcationStatus::Unresolved));
}

#[test]
fn a_start_at_which_the_number_is_far_from_its_level_is_refused() {
    let sides = (("f", 0.5, 2.0), ("D", 0.2, 0.8));
    let far = ([1.5, 0.3], "out_mean", 3.0);
    let error = level((DRY, ""), sides, far, &CurveOptions::default()).unwrap_err();
    assert!(matches!(error, CurveError::NoStart { .. }), "{error}");
    let unknown = ([0.8776, 0.4], "out_nothing", 3.0);
    let error = level((DRY, ""), sides, unknown, &CurveOptions::default()).unwrap_err();
    assert!(
        error.to_string().contains("the number has no value"),
        "{error}"
    );
}

#[test]
#[rustfmt::skip]
fn the_program_follows_levels_in_curves_and_maps() {
    let room = Room::new();
    room.write("dry.toml", DRY);
    room.done("sweep dry.toml --out run --quiet").says(&["LV1"]);
    room.done("curve run --quiet --second D --from 0.2 --to 0.8 --step 0.1")
        .says(&["L1  out_mean = 3 in the plane of f and D", "LV1", "border of the box in f"]);
    let curve = room.table("run/curves/LV1-D/levels.csv");
    for row in &curve.0 {
        let [f, d, error] = row.numbers(["f", "D", "error"]);
        let off = distance([f, d], [1.5, 0.6], time);
        assert!(off <= error, "off by {off}: {row:?}");
    }
    room.holds_all("run/curves/LV1-D", "figures/curve.svg figures/curve.png");
    assert!(room.read("run/curves/LV1-D/figures/curve.svg").contains("mean time (out) = 3"));
    room.done("plot run/curves/LV1-D --quiet");
    room.done("explore run/curves/LV1-D --html page.html --quiet");
    room.done("verify run/curves/LV1-D");
    room.write("map.toml", format!("{DRY}map = {{ parameter = \"D\", from = 0.2, to = 0.8, points = 7 }}\n"));
    room.done("sweep map.toml --out map --quiet").says(&["L1  out_mean = 3"]);
    let whole = room.read("map/levels.csv");
    for number in 1..=2 {
        room.done(&format!("sweep map.toml --out cut --quiet --shard {number}/2"));
    }
    room.done("merge cut --quiet");
    assert!(room.read("cut/levels.csv") == whole);
    assert!(room.read("map/map.csv").lines().next().unwrap().ends_with(",out_mean"));
    room.done("plot map --quiet");
    room.done("verify map");
}
