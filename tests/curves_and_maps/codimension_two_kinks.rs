//! Points of codimension two at kinks of densities, and the curves that start from them, against systems whose
//! densities are known exactly.

use pbif::continuation::curve::{CodimensionTwoKind, Curve, EndReason};
use pbif::continuation::{BifurcationStatus, Located};
use pbif::topology::IndicatorKind;

use super::support::{
    assert_drawn_again, assert_meet, assert_on, ends, mapped, off, stepping, tree,
};
use crate::common::room::{Room, assert_says};

/// The density is exp(-(2/σ²)(f |x| - b x²/2 + |x|³/3)). The kink turns from a peak into a valley at f = 0: from one
/// peak come two for b < 0, and for b > 0 two peaks stand beside it already, born where f = b²/4.
const AT_CENTRE: &str = r#"
system.equations = { x = "-f sign(x) + b x - x abs(x)" }
system.noise = { x = "sqrt(0.1)" }
system.parameters = { b = -0.5 }
sweep = { parameter = "f", from = -0.2, to = 0.21, points = 6 }
cells.x = { from = -1.8, to = 1.8, count = 160 }
"#;

/// The same tilted: above the kink the slope of the potential is f - h - b x + x², below it -f - h - b x - x². For f >
/// 0 the kink is a peak where |h| < f, and loses a valley at h = f for b > 0; for b < 0 nothing happens there. For f <
/// 0 it is a valley where |h| < -f.
const TILTED: &str = r#"
system.equations = { x = "h - f sign(x) + b x - x abs(x)" }
system.noise = { x = "sqrt(0.1)" }
system.parameters = { f = 0.2, b = 0.5 }
sweep = { parameter = "h", from = 0.16, to = 0.4, points = 5 }
cells.x = { from = -2.2, to = 2.2, count = 160 }
"#;

/// Damping -a + 2H, H the energy, with dry friction: at f = 0 the density is exp(-(2/σ²)(-aH + H²)), and y has one peak
/// there for a below 0.540903 √(2σ²).
const FRICTION: &str = r#"
system.equations = { x = "y", y = "-(-a + x^2 + y^2) y - x - f sign(y)" }
system.noise = { y = "sqrt(0.1)" }
system.parameters = { a = 0.0 }
sweep = { parameter = "f", from = -0.05, to = 0.06, points = 4 }
cells.x = { from = -1.9, to = 1.9, count = 48 }
cells.y = { from = -1.9, to = 1.9, count = 60, grade = { at = [0.0], smallest = 0.02 } }
detect = { marginals = ["y"], joint = [] }
locate = { relative_tolerance = 1e-3 }
"#;

/// At f_c = 0 the density is exp(-(2κ/σ²)(y²/2 + αx²/2 + x⁴/4)): along the kink of the joint density, y = 0, its centre
/// is a peak for α > 0 alone.
const JOINT: &str = r#"
system.model = "coulomb"
system.parameters = { kappa = 0.4, alpha = 0.5, mu = 1.0, sigma2 = 0.3 }
sweep = { parameter = "f_c", from = -0.1, to = 0.11, points = 4 }
cells.x = { from = -3.2, to = 3.2, count = 50 }
cells.y = { from = -4, to = 4, count = 50, grade = { at = [0.0], smallest = 0.03 } }
detect = { marginals = [], joint = [["x", "y"]] }
locate = { relative_tolerance = 1e-3 }
"#;

const DEGENERATE: (&str, CodimensionTwoKind) = ("DK1", CodimensionTwoKind::DegenerateKink);
const CORNER: (&str, CodimensionTwoKind) = ("KC1", CodimensionTwoKind::KinkCorner);

fn is_kink(row: &Located) -> bool {
    row.indicator() == Some(IndicatorKind::KINK_SLOPE)
}

fn is_beside(row: &Located) -> bool {
    row.method() == "slope beside the kink"
}

fn assert_ends(curve: &Curve, reason: EndReason) {
    assert!(ends(curve).contains(&&reason), "{:?}", curve.ends);
}

#[test]
fn births_at_a_kink_turn_into_births_away_from_it_and_their_fold_is_followed() {
    let plane = (("f", -0.2, 0.21), ("b", -1.0, 1.0));
    let tree = tree(AT_CENTRE, is_kink, plane, -0.5, stepping(0.05));
    let [kink, fold] = tree.curves.as_slice() else {
        panic!("{} curves", tree.curves.len());
    };
    assert_on(kink, 1e-5, |[f, _]| f / 0.41);
    let mut points = kink.points.iter();
    assert!(points.all(|point| point.status() == BifurcationStatus::Located));
    // The slope at a kink follows from the equations, and so does how it changes: no solve but one a point.
    let (solves, points) = (kink.work.solves, kink.points.len());
    assert!(solves <= points + 2, "{solves} solves for {points} points");
    // The fold is f = b²/4, b > 0, and ends where it begins.
    assert_on(fold, 1e-4, |[f, b]| {
        (f - 0.25 * b * b) / 0.41 / 1.0_f64.hypot(0.5 * b * 2.0 / 0.41)
    });
    assert_ends(fold, EndReason::DegenerateKink);
    assert_meet(&tree.curves, DEGENERATE, &[0, 1], [0.0, 0.0], 3e-4);
    let points = pbif::continuation::curve::codimension_two(&tree.curves);
    assert_eq!(points[0].status(), BifurcationStatus::Located);
}

#[test]
fn a_curve_beside_a_kink_ends_where_nothing_happens_beyond() {
    let plane = (("h", 0.0, 0.4), ("b", -1.0, 1.0));
    let tree = tree(TILTED, is_beside, plane, 0.5, stepping(0.05));
    let [beside, fold] = tree.curves.as_slice() else {
        panic!("{} curves", tree.curves.len());
    };
    // h = f as long as b > 0.
    assert_on(beside, 1e-4, |[h, b]| {
        off(beside, [h, b], [0.2, b.max(0.0)])
    });
    assert_ends(beside, EndReason::DegenerateKink);
    // The pair that vanishes there is born at f - h = b²/4.
    assert_on(fold, 1e-4, |[h, b]| {
        (0.2 - h - 0.25 * b * b) / 0.4 / 1.0_f64.hypot(0.5 * b * 2.0 / 0.4)
    });
    assert!(fold.points.len() > 10);
    assert_meet(&tree.curves, DEGENERATE, &[0, 1], [0.2, 0.0], 1e-3);
}

#[test]
fn the_curves_of_both_sides_of_a_kink_meet_in_a_corner() {
    let plane = (("h", -0.4, 0.4), ("f", -0.3, 0.3));
    let tree = tree(TILTED, is_beside, plane, 0.2, stepping(0.05));
    assert_eq!(tree.curves.len(), 2);
    for (curve, sign) in tree.curves.iter().zip([1.0, -1.0]) {
        assert_on(curve, 1e-4, |[h, f]| {
            (h - sign * f) / 0.8 / 1.0_f64.hypot(0.6 / 0.8)
        });
        let mut points = curve.points.iter();
        assert!(
            points.all(|point| point.values[1] > -1e-4),
            "nothing happens there"
        );
        assert_ends(curve, EndReason::KinkCorner);
    }
    assert_meet(&tree.curves, CORNER, &[0, 1], [0.0, 0.0], 1e-4);
}

#[test]
fn a_marginal_of_an_oscillator_with_friction_has_the_exact_point() {
    let plane = (("f", -0.05, 0.06), ("a", 0.0, 0.5));
    let tree = tree(FRICTION, is_kink, plane, 0.0, stepping(0.1));
    let [kink, fold] = tree.curves.as_slice() else {
        panic!("{} curves", tree.curves.len());
    };
    assert_ends(fold, EndReason::DegenerateKink);
    let [degenerate] = kink.degenerate.as_slice() else {
        panic!("{:?}", kink.degenerate);
    };
    let exact = 0.540_903 * (2.0 * 0.1_f64).sqrt();
    let point = &kink.points[degenerate.point];
    let gap = off(kink, point.values, [0.0, exact]);
    assert!(
        gap <= point.error && point.error < 1e-2,
        "{point:?}: {gap:.1e}"
    );
    assert_eq!(degenerate.kind, CodimensionTwoKind::DegenerateKink);
}

#[test]
fn in_a_joint_density_the_curve_of_the_curvature_along_the_kink_crosses_and_is_followed() {
    let plane = (("f_c", -0.1, 0.11), ("alpha", -0.5, 0.6));
    let tree = tree(JOINT, is_kink, plane, 0.5, stepping(0.1));
    let kinds: Vec<IndicatorKind> = tree.curves.iter().map(|curve| curve.kind).collect();
    assert_eq!(
        kinds,
        [
            IndicatorKind::KINK_SLOPE,
            IndicatorKind::CURVATURE_ALONG_KINK
        ]
    );
    let kind = ("CX1", CodimensionTwoKind::Crossing);
    assert_meet(&tree.curves, kind, &[0, 1], [0.0, 0.0], 1e-3);
}

#[test]
fn the_program_tells_stores_and_draws_a_degenerate_kink() {
    let room = Room::new();
    room.write("kink.toml", AT_CENTRE);
    let follow = "curve kink.toml --quiet --out out --second b --from -1 --to 1 --step 0.1";
    let words = ["slope at the kink", "DK1", "degenerate kink of C1 and C2"];
    room.done(follow).says(&words);
    assert_says(
        &room.read("out/codimension_two.csv"),
        &["\nDK1,degenerate kink,"],
    );
    assert_says(&room.read("out/figures/curve.svg"), &["DK1"]);
    assert_drawn_again(&room, "out", "curve.svg");
}

/// With a tilt h, the centre and its kink are there at h = 0 alone: the kink turns in a corner, and one peak that
/// splits is a cusp.
#[test]
fn where_the_second_parameter_breaks_the_symmetry_a_split_is_a_cusp_or_a_corner() {
    let tilted = TILTED
        .replace("{ f = 0.2, b = 0.5 }", "{ b = -0.5, h = 0.0 }")
        .replace(
            "\"h\", from = 0.16, to = 0.4,",
            "\"f\", from = -0.3, to = 0.35,",
        );
    let plane = (("f", -0.3, 0.35), ("h", -0.4, 0.4));
    let corner = tree(&tilted, is_kink, plane, 0.0, stepping(0.05));
    let cusp = r#"
system.equations = { x = "h + a x - x^3" }
system.noise = { x = "sqrt(0.1)" }
system.parameters = { h = 0.0 }
sweep = { parameter = "a", from = -0.5, to = 0.55, points = 5 }
cells.x = { from = -2.2, to = 2.2, count = 240 }
"#;
    let split = |row: &Located| row.indicator() == Some(IndicatorKind::CURVATURE);
    let plane = (("a", -0.5, 0.55), ("h", -0.2, 0.2));
    let cusp = tree(cusp, split, plane, 0.0, stepping(0.025));
    for (tree, kind) in [
        (&corner, CORNER),
        (&cusp, ("CP1", CodimensionTwoKind::Cusp)),
    ] {
        assert_eq!(tree.curves.len(), 3, "{kind:?}");
        assert_eq!(tree.curves[0].points.len(), 1, "{kind:?}");
        assert_meet(&tree.curves, kind, &[0, 1, 2], [0.0, 0.0], 1e-3);
    }
    for point in corner.curves[1..].iter().flat_map(|curve| &curve.points) {
        let [f, h] = point.values;
        assert!((h.abs() + f).abs() <= 1e-4, "{point:?}");
    }
    let exact = |a: f64| 2.0 * (a.max(0.0) / 3.0).powf(1.5);
    for point in cusp.curves[1..].iter().flat_map(|curve| &curve.points) {
        let [a, h] = point.values;
        assert!(
            a <= 0.02 || (h.abs() - exact(a)).abs() <= 1e-4 * 0.4,
            "{point:?}"
        );
    }
}

/// In a map whose second parameter is given no value elsewhere: the folds on both sides of the centre are one curve.
#[test]
fn a_map_finds_the_degenerate_kink_and_draws_the_fold_of_both_sides_once() {
    let text = AT_CENTRE.replace("system.parameters = { b = -0.5 }\n", "");
    let text = text.replace("points = 6", "points = 7");
    let map = format!(
        "{text}map = {{ parameter = \"b\", from = -1.0, to = 1.0, points = 7, depth = 1 }}\n"
    );
    let map = mapped(&map, "");
    let kinds: Vec<IndicatorKind> = map.curves.iter().map(|curve| curve.kind).collect();
    let fold = IndicatorKind::shoulder(true);
    assert_eq!(
        kinds,
        [IndicatorKind::KINK_SLOPE, fold],
        "{:?}",
        map.untraced
    );
    let points = map.codimension_two();
    assert_eq!(points.len(), 1, "{points:?}");
    let found = (points[0].label.as_str(), &points[0].curves[..]);
    assert_eq!(found, ("DK1", &[0, 1][..]));
}
