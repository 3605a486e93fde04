//! Points of codimension two at kinks of densities, and the curves that start from them, against systems whose
//! densities are known exactly.

use crate::common::pbif;
use crate::common::sweeps::prepared;
use crate::common::trees::Start;
use pbif::cancellation::Cancellation;
use pbif::continuation::curve::{
    CodimensionTwoKind, Curve, CurveOptions, CurveTree, EndReason, codimension_two,
};
use pbif::continuation::{BifurcationStatus, LabelledPoint};
use pbif::topology::IndicatorKind;

/// The density is exp(-(2/σ²)(f |x| - b x²/2 + |x|³/3)). The kink turns from a peak into a valley at f = 0: from one
/// peak come two for b < 0, and for b > 0 two peaks stand beside it already, born where f = b²/4.
const AT_CENTRE: &str = r#"
[system.equations]
x = "-f sign(x) + b x - x abs(x)"
[system.noise]
x = "sqrt(0.1)"
[system.parameters]
b = -0.5
[sweep]
parameter = "f"
from = -0.2
to = 0.21
points = 6
[cells]
x = { from = -1.8, to = 1.8, count = 160 }
"#;

/// The same tilted: above the kink the slope of the potential is f - h - b x + x², below it -f - h - b x - x². For f >
/// 0 the kink is a peak where |h| < f, and loses a valley at h = f for b > 0; for b < 0 nothing happens there. For f <
/// 0 it is a valley where |h| < -f.
const TILTED: &str = r#"
[system.equations]
x = "h - f sign(x) + b x - x abs(x)"
[system.noise]
x = "sqrt(0.1)"
[system.parameters]
f = 0.2
b = 0.5
[sweep]
parameter = "h"
from = 0.16
to = 0.4
points = 5
[cells]
x = { from = -2.2, to = 2.2, count = 160 }
"#;

/// Damping -a + 2H, H the energy, with dry friction: at f = 0 the density is exp(-(2/σ²)(-aH + H²)), and y has one peak
/// there for a below 0.540903 √(2σ²).
const FRICTION: &str = r#"
[system.equations]
x = "y"
y = "-(-a + x^2 + y^2) y - x - f sign(y)"
[system.noise]
y = "sqrt(0.1)"
[system.parameters]
a = 0.0
[sweep]
parameter = "f"
from = -0.05
to = 0.06
points = 4
[cells]
x = { from = -1.9, to = 1.9, count = 48 }
y = { from = -1.9, to = 1.9, count = 60, grade = { at = [0.0], smallest = 0.02 } }
[detect]
marginals = ["y"]
joint = []
[locate]
relative_tolerance = 1e-3
"#;

/// At f_c = 0 the density is exp(-(2κ/σ²)(y²/2 + αx²/2 + x⁴/4)): along the kink of the joint density, y = 0, its centre
/// is a peak for α > 0 alone.
const JOINT: &str = r#"
[system]
model = "coulomb"
[system.parameters]
kappa = 0.4
alpha = 0.5
mu = 1.0
sigma2 = 0.3
[sweep]
parameter = "f_c"
from = -0.1
to = 0.11
points = 4
[cells]
x = { from = -3.2, to = 3.2, count = 50 }
y = { from = -4, to = 4, count = 50, grade = { at = [0.0], smallest = 0.03 } }
[detect]
marginals = []
joint = [["x", "y"]]
[locate]
relative_tolerance = 1e-3
"#;

/// The curves that hang together with the one of a row by an indicator.
fn tree(
    text: &str,
    is_start: fn(&LabelledPoint) -> bool,
    plane: ((&str, f64, f64), (&str, f64, f64)),
    (held, largest_step): (f64, f64),
) -> CurveTree {
    let options = CurveOptions {
        largest_step,
        ..CurveOptions::default()
    };
    crate::common::trees::tree(text, Start { is_start, held }, plane, options)
}

fn is_kink(row: &LabelledPoint) -> bool {
    row.indicator == Some(IndicatorKind::KINK_SLOPE)
}

fn is_beside(row: &LabelledPoint) -> bool {
    let beside = |kind: IndicatorKind| kind.side_of_kink().is_some();
    row.indicator.is_some_and(beside)
}

/// How far a place is from another, in sides of the box.
fn off(curve: &Curve, values: [f64; 2], exact: [f64; 2]) -> f64 {
    let sides = curve.plane.sides();
    let gap = [0, 1].map(|k| (values[k] - exact[k]) / sides[k].length());
    gap[0].hypot(gap[1])
}

fn reasons(curve: &Curve) -> Vec<&EndReason> {
    curve.ends.iter().map(|end| &end.reason).collect()
}

#[test]
fn births_at_a_kink_turn_into_births_away_from_it_and_their_fold_is_followed() {
    let plane = (("f", -0.2, 0.21), ("b", -1.0, 1.0));
    let tree = tree(AT_CENTRE, is_kink, plane, (-0.5, 0.05));
    assert!(tree.missed.is_empty(), "{:?}", tree.missed);
    let [kink, fold] = tree.curves.as_slice() else {
        panic!("{} curves", tree.curves.len());
    };
    for point in &kink.points {
        let off = off(kink, point.values, [0.0, point.values[1]]);
        assert!(off <= point.error && off < 1e-5, "{point:?}: {off:.1e}");
        assert_eq!(point.status, BifurcationStatus::Located);
    }
    // The slope at a kink follows from the equations, and so does how it changes: no solve but one a point.
    let solves = kink.work.solves;
    assert!(
        solves <= kink.points.len() + 2,
        "{solves} solves for {} points",
        kink.points.len()
    );

    // The fold is f = b²/4, b > 0, and ends where it begins.
    for point in &fold.points {
        let [f, b] = point.values;
        let slope = 0.5 * b * 2.0 / 0.41;
        let off = ((f - 0.25 * b * b) / 0.41 / 1.0_f64.hypot(slope)).abs();
        assert!(off <= point.error && off < 1e-4, "{point:?}: {off:.1e}");
    }
    assert!(
        reasons(fold).contains(&&EndReason::DegenerateKink),
        "{:?}",
        fold.ends
    );
    let points = codimension_two(&tree.curves);
    let [point] = points.as_slice() else {
        panic!("{points:?}");
    };
    assert_eq!(
        (point.label.as_str(), point.kind),
        ("DK1", CodimensionTwoKind::DegenerateKink)
    );
    assert_eq!(point.curves, [0, 1]);
    let gap = off(kink, point.values, [0.0, 0.0]);
    assert!(gap <= point.error && point.error < 3e-4, "{point:?}");
    assert_eq!(point.status, BifurcationStatus::Located);
}

#[test]
fn a_curve_beside_a_kink_ends_where_nothing_happens_beyond() {
    let plane = (("h", 0.0, 0.4), ("b", -1.0, 1.0));
    let tree = tree(TILTED, is_beside, plane, (0.5, 0.05));
    assert!(tree.missed.is_empty(), "{:?}", tree.missed);
    let [beside, fold] = tree.curves.as_slice() else {
        panic!("{} curves", tree.curves.len());
    };
    // h = f as long as b > 0.
    for point in &beside.points {
        let gap = off(beside, point.values, [0.2, point.values[1].max(0.0)]);
        assert!(gap <= point.error && gap < 1e-4, "{point:?}: {gap:.1e}");
    }
    assert!(
        reasons(beside).contains(&&EndReason::DegenerateKink),
        "{:?}",
        beside.ends
    );
    // The pair that vanishes there is born at f - h = b²/4.
    for point in &fold.points {
        let [h, b] = point.values;
        let slope = 0.5 * b * 2.0 / 0.4;
        let off = ((0.2 - h - 0.25 * b * b) / 0.4 / 1.0_f64.hypot(slope)).abs();
        assert!(off <= point.error && off < 1e-4, "{point:?}: {off:.1e}");
    }
    assert!(fold.points.len() > 10);
    let points = codimension_two(&tree.curves);
    assert_eq!(points.len(), 1, "{points:?}");
    assert_eq!(points[0].curves, [0, 1]);
    let gap = off(beside, points[0].values, [0.2, 0.0]);
    assert!(
        gap <= points[0].error && points[0].error < 1e-3,
        "{points:?}"
    );
}

#[test]
fn the_curves_of_both_sides_of_a_kink_meet_in_a_corner() {
    let plane = (("h", -0.4, 0.4), ("f", -0.3, 0.3));
    let tree = tree(TILTED, is_beside, plane, (0.2, 0.05));
    assert!(tree.missed.is_empty(), "{:?}", tree.missed);
    assert_eq!(tree.curves.len(), 2);
    for (curve, sign) in tree.curves.iter().zip([1.0, -1.0]) {
        for point in &curve.points {
            let [h, f] = point.values;
            let off = ((h - sign * f) / 0.8 / 1.0_f64.hypot(0.6 / 0.8)).abs();
            assert!(off <= point.error && off < 1e-4, "{point:?}: {off:.1e}");
            assert!(f > -1e-4, "nothing happens there: {point:?}");
        }
        assert!(
            reasons(curve).contains(&&EndReason::KinkCorner),
            "{:?}",
            curve.ends
        );
    }
    let points = codimension_two(&tree.curves);
    let [corner] = points.as_slice() else {
        panic!("{points:?}");
    };
    assert_eq!(
        (corner.label.as_str(), corner.kind),
        ("KC1", CodimensionTwoKind::KinkCorner)
    );
    assert_eq!(corner.curves, [0, 1]);
    let gap = off(&tree.curves[0], corner.values, [0.0, 0.0]);
    assert!(gap <= corner.error && corner.error < 1e-4, "{corner:?}");
}

#[test]
fn a_marginal_of_an_oscillator_with_friction_has_the_exact_point() {
    let plane = (("f", -0.05, 0.06), ("a", 0.0, 0.5));
    let tree = tree(FRICTION, is_kink, plane, (0.0, 0.1));
    assert!(tree.missed.is_empty(), "{:?}", tree.missed);
    let [_, fold] = tree.curves.as_slice() else {
        panic!("{} curves", tree.curves.len());
    };
    assert!(
        reasons(fold).contains(&&EndReason::DegenerateKink),
        "{:?}",
        fold.ends
    );
    let kink = &tree.curves[0];
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
    let tree = tree(JOINT, is_kink, plane, (0.5, 0.1));
    assert!(tree.missed.is_empty(), "{:?}", tree.missed);
    let kinds: Vec<IndicatorKind> = tree.curves.iter().map(|curve| curve.kind).collect();
    assert_eq!(
        kinds,
        [
            IndicatorKind::KINK_SLOPE,
            IndicatorKind::CURVATURE_ALONG_KINK
        ]
    );
    let points = codimension_two(&tree.curves);
    let [crossing] = points.as_slice() else {
        panic!("{points:?}");
    };
    assert_eq!(
        (crossing.label.as_str(), crossing.kind),
        ("CX1", CodimensionTwoKind::Crossing)
    );
    assert_eq!(crossing.curves, [0, 1]);
    let gap = off(&tree.curves[0], crossing.values, [0.0, 0.0]);
    assert!(
        gap <= crossing.error && crossing.error < 1e-3,
        "{crossing:?}: {gap:.1e}"
    );
}

#[test]
fn the_program_tells_stores_and_draws_a_degenerate_kink() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (file, out) = (at("kink.toml"), at("out"));
    std::fs::write(&file, AT_CENTRE).unwrap();
    let mut arguments = vec!["curve", file.as_str(), "--quiet", "--out", out.as_str()];
    arguments.extend([
        "--second", "b", "--from", "-1", "--to", "1", "--step", "0.1",
    ]);
    let output = pbif(&arguments);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let said = String::from_utf8(output.stdout).unwrap();
    for words in ["slope at the kink", "DK1", "degenerate kink of C1 and C2"] {
        assert!(said.contains(words), "{words}: {said}");
    }
    let read = |name: &str| std::fs::read_to_string(at(name)).unwrap();
    let table = read("out/codimension_two.csv");
    assert!(table.contains("\nDK1,degenerate kink,"), "{table}");
    let drawn = read("out/figures/curve.svg");
    assert!(drawn.contains("DK1"));
    // Drawn again from what is stored, to the same picture.
    let again = at("again");
    let output = pbif(&["plot", &out, "--quiet", "--out", &again, "--format", "svg"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert_eq!(read("again/curve.svg"), drawn);
}

/// With a tilt h, the centre and its kink are there at h = 0 alone: the kink turns in a corner, and one peak that
/// splits is a cusp.
#[test]
fn where_the_second_parameter_breaks_the_symmetry_a_split_is_a_cusp_or_a_corner() {
    let tilted = TILTED
        .replace("b = 0.5", "b = -0.5\nh = 0.0")
        .replace("f = 0.2\n", "")
        .replace("parameter = \"h\"", "parameter = \"f\"")
        .replace("from = 0.16", "from = -0.3")
        .replace("to = 0.4\n", "to = 0.35\n");
    let plane = (("f", -0.3, 0.35), ("h", -0.4, 0.4));
    let corner = tree(&tilted, is_kink, plane, (0.0, 0.05));
    let cusp = r#"
[system.equations]
x = "h + a x - x^3"
[system.noise]
x = "sqrt(0.1)"
[system.parameters]
h = 0.0
[sweep]
parameter = "a"
from = -0.5
to = 0.55
points = 5
[cells]
x = { from = -2.2, to = 2.2, count = 240 }
"#;
    let split = |row: &LabelledPoint| row.indicator == Some(IndicatorKind::CURVATURE);
    let cusp = tree(
        cusp,
        split,
        (("a", -0.5, 0.55), ("h", -0.2, 0.2)),
        (0.0, 0.025),
    );
    for (tree, kind, name) in [
        (&corner, CodimensionTwoKind::KinkCorner, "KC1"),
        (&cusp, CodimensionTwoKind::Cusp, "CP1"),
    ] {
        assert!(tree.missed.is_empty(), "{:?}", tree.missed);
        assert_eq!(tree.curves.len(), 3, "{name}");
        assert_eq!(tree.curves[0].points.len(), 1, "{name}");
        let points = codimension_two(&tree.curves);
        let [point] = points.as_slice() else {
            panic!("{points:?}");
        };
        assert_eq!((point.label.as_str(), point.kind), (name, kind));
        assert_eq!(point.curves, [0, 1, 2], "{name}");
        let gap = off(&tree.curves[0], point.values, [0.0, 0.0]);
        assert!(gap <= point.error && point.error < 1e-3, "{point:?}");
    }
    for curve in &corner.curves[1..] {
        for point in &curve.points {
            let [f, h] = point.values;
            assert!((h.abs() + f).abs() <= 1e-4, "{point:?}");
        }
    }
    for curve in &cusp.curves[1..] {
        let exact = |a: f64| 2.0 * (a.max(0.0) / 3.0).powf(1.5);
        let far = curve.points.iter().filter(|point| point.values[0] > 0.02);
        for point in far {
            let [a, h] = point.values;
            assert!((h.abs() - exact(a)).abs() <= 1e-4 * 0.4, "{point:?}");
        }
    }
}

/// In a map whose second parameter is given no value elsewhere: the folds on both sides of the centre are one curve.
#[test]
fn a_map_finds_the_degenerate_kink_and_draws_the_fold_of_both_sides_once() {
    let text = AT_CENTRE
        .replace("[system.parameters]\nb = -0.5\n", "")
        .replace("points = 6", "points = 7")
        + "[map]\nparameter = \"b\"\nfrom = -1.0\nto = 1.0\npoints = 7\ndepth = 1\n";
    let never = Cancellation::new();
    let map = prepared(&text, &[]).map(&never, &|_| ()).unwrap().unwrap();
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
    assert_eq!(
        (points[0].label.as_str(), &points[0].curves[..]),
        ("DK1", &[0, 1][..])
    );
}
