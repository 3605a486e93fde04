//! Points of codimension two, and the curves that start from them, against systems whose densities are known exactly.

use crate::common::pbif;
use crate::common::sweeps::prepared;
use crate::common::trees::Start;
use pbif::cancellation::Cancellation;
use pbif::continuation::BifurcationStatus;
use pbif::continuation::curve::{
    CodimensionTwoKind, CurveOptions, CurveTree, EndReason, codimension_two,
};

/// Peaks of the density are zeros of the drift: the centre splits at a = 0, and for b > 0 two peaks are born away from
/// it at a = -b²/4.
const TRICRITICAL: &str = r#"
[system.equations]
x = "a x + b x^3 - x^5"
[system.noise]
x = "sqrt(0.1)"
[system.parameters]
b = -0.5
[sweep]
parameter = "a"
from = -0.3
to = 0.2
points = 6
[cells]
x = { from = -1.8, to = 1.8, count = 160 }
"#;

/// Damping c - bH + H², H the energy: the density is exp(-(2/σ²)(cH - bH²/2 + H³/3)). The centre is lost at c = 0, and
/// for b > 0 a ring is born around it at c = b²/4.
const RING: &str = r#"
[system.equations]
x = "y"
y = "-(c - b (x^2 + y^2)/2 + (x^2 + y^2)^2/4) y - x"
[system.noise]
y = "sqrt(0.02)"
[system.parameters]
b = -0.3
[sweep]
parameter = "c"
from = -0.1
to = 0.15
points = 6
[cells]
x = { from = -1.6, to = 1.6, count = 64 }
y = { from = -1.6, to = 1.6, count = 64 }
[detect]
marginals = []
joint = [["x", "y"]]
[locate]
relative_tolerance = 1e-3
"#;

const CUSP: &str = r#"
[system.equations]
x = "h + a x - x^3"
[system.noise]
x = "sqrt(0.1)"
[system.parameters]
a = 0.8
[sweep]
parameter = "h"
from = 0.1
to = 0.4
points = 7
[cells]
x = { from = -2.2, to = 2.2, count = 300 }
"#;

/// The curves that hang together with that of the only row of a sweep, in a box, at a value of the second parameter.
fn tree(
    text: &str,
    first: (&str, f64, f64),
    second: (&str, f64, f64),
    (held, largest_step): (f64, f64),
) -> CurveTree {
    let options = CurveOptions {
        largest_step,
        ..CurveOptions::default()
    };
    crate::common::trees::tree(text, only_row(held), (first, second), options)
}

fn only_row(held: f64) -> Start {
    let is_start = |_: &_| true;
    Start { is_start, held }
}

#[test]
fn births_at_the_centre_turn_into_births_away_from_it_and_their_fold_is_followed() {
    let tree = tree(
        TRICRITICAL,
        ("a", -0.3, 0.2),
        ("b", -1.0, 1.0),
        (-0.5, 0.025),
    );
    assert!(tree.missed.is_empty(), "{:?}", tree.missed);
    let [split, fold] = tree.curves.as_slice() else {
        panic!("{} curves", tree.curves.len());
    };
    let [degenerate] = split.degenerate.as_slice() else {
        panic!("{:?}", split.degenerate);
    };
    let point = &split.points[degenerate.point];
    let off = (point.values[0] / 0.5).hypot(point.values[1] / 2.0);
    assert!(off <= point.error && point.error < 1e-5, "{point:?}");
    assert_eq!(point.status, BifurcationStatus::Located);
    assert!(point.checked, "{point:?}");
    let begins = split.points[split.start].values;
    assert!((begins[1] + 0.5).abs() < 1e-6, "{begins:?}");
    for pair in split.points.windows(2) {
        assert!(pair[0].arclength < pair[1].arclength, "{pair:?}");
    }

    // The fold is a = -b²/4, and ends where it begins.
    assert!(fold.points.len() > 20);
    for point in &fold.points {
        let [a, b] = point.values;
        let off = (a + 0.25 * b * b) / 0.5 / 1.0_f64.hypot(0.5 * b * 2.0 / 0.5);
        assert!(
            off.abs() <= 1e-4 && off.abs() <= point.error,
            "{point:?}: {off:.1e}"
        );
    }
    let ends: Vec<&EndReason> = fold.ends.iter().map(|end| &end.reason).collect();
    assert!(
        ends.contains(&&EndReason::DegenerateSplit) && ends.contains(&&EndReason::Border(1)),
        "{ends:?}"
    );
    let points = codimension_two(&tree.curves);
    assert_eq!(points.len(), 1, "{points:?}");
    assert_eq!(points[0].kind, CodimensionTwoKind::DegenerateSplit);
    assert_eq!(points[0].curves, [0, 1]);
    assert!(points[0].place[0].abs() < 1e-9);
}

#[test]
fn the_birth_of_a_ring_and_the_loss_of_the_centre_meet_where_both_are_exact() {
    let tree = tree(RING, ("c", -0.1, 0.15), ("b", -0.6, 0.6), (-0.3, 0.05));
    assert!(tree.missed.is_empty(), "{:?}", tree.missed);
    let [lost, born] = tree.curves.as_slice() else {
        panic!("{} curves", tree.curves.len());
    };
    let off = |c: f64| c / 0.25;
    for point in &lost.points {
        assert!(off(point.values[0]).abs() <= point.error, "{point:?}");
    }
    let point = &lost.points[lost.degenerate[0].point];
    let apart = off(point.values[0]).hypot(point.values[1] / 1.2);
    assert!(apart <= point.error && point.error < 1e-3, "{point:?}");
    // The ring's curve is c = b²/4 from the meeting to the border of the box.
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for point in &born.points {
        let [c, b] = point.values;
        let slope = 0.5 * b * 1.2 / 0.25;
        let off = (c - 0.25 * b * b) / 0.25 / 1.0_f64.hypot(slope);
        assert!(
            off.abs() <= point.error && off.abs() < 2e-3,
            "{point:?}: {off:.1e}"
        );
        (low, high) = (low.min(b), high.max(b));
    }
    assert!(low < 0.05 && high == 0.6, "{low} {high}");
    let points = codimension_two(&tree.curves);
    assert_eq!(points.len(), 1, "{points:?}");
    assert_eq!(points[0].curves, [0, 1]);
}

#[test]
fn the_curve_goes_on_beyond_a_cusp_onto_the_other_fold() {
    let tree = tree(CUSP, ("h", -0.4, 0.4), ("a", -0.3, 1.0), (0.8, 0.025));
    assert!(tree.missed.is_empty(), "{:?}", tree.missed);
    assert_eq!(tree.curves.len(), 2);
    let sides = tree.curves.iter();
    let sides: Vec<f64> = sides
        .map(|curve| curve.points[curve.start].values[0].signum())
        .collect();
    assert_eq!(sides, [1.0, -1.0]);
    for point in tree.curves.iter().flat_map(|curve| &curve.points) {
        let [h, a] = point.values;
        if a > 0.01 {
            let off = 27.0 * h * h - 4.0 * a.powi(3);
            let off = off / (54.0 * h * 0.8).hypot(12.0 * a * a * 1.3);
            assert!(off.abs() <= point.error, "{point:?}: {off:.1e}");
        }
    }
    let points = codimension_two(&tree.curves);
    assert_eq!(points.len(), 1);
    assert_eq!(
        (points[0].label.as_str(), &points[0].curves[..]),
        ("CP1", &[0, 1][..])
    );
    let off = (points[0].values[0] / 0.8).hypot(points[0].values[1] / 1.3);
    assert!(off <= points[0].error, "{:?}", points[0]);
}

#[test]
fn a_cusp_of_a_fold_that_no_finer_cells_have_checked_is_unchecked() {
    let (h, a) = (("h", -0.4, 0.4), ("a", -0.3, 1.0));
    for (every, status) in [
        (0, BifurcationStatus::Unchecked),
        (8, BifurcationStatus::Located),
    ] {
        let options = CurveOptions {
            largest_step: 0.025,
            check_every: every,
            ..CurveOptions::default()
        };
        let tree = crate::common::trees::tree(CUSP, only_row(0.8), (h, a), options);
        let points = codimension_two(&tree.curves);
        assert_eq!(points.len(), 1);
        assert_eq!(points[0].status, status);
    }
}

/// The centre splits at a = 0, and two pairs of a peak and a valley are born at x = ±1 where c = 0: both lines are
/// exact, and cross.
const CROSSING: &str = r#"
[system.equations]
x = "-10 x (x^2 - a) ((x^2 - 1)^2 - c)"
[system.noise]
x = "sqrt(0.5)"
[system.parameters]
c = 0.01
[sweep]
parameter = "a"
from = -0.2
to = 0.3
points = 9
[map]
parameter = "c"
from = -0.03
to = 0.05
points = 7
depth = 1
[cells]
x = { from = -1.6, to = 1.6, count = 160 }
"#;

#[test]
fn curves_that_cross_are_told_with_where_they_do() {
    let never = Cancellation::new();
    let sweep = prepared(CROSSING, &[]);
    let map = sweep.map(&never, &|_| ()).unwrap().unwrap();
    let points = map.codimension_two();
    let crossings = points.iter();
    let crossings = crossings.filter(|one| one.kind == CodimensionTwoKind::Crossing);
    let [crossing] = crossings.collect::<Vec<_>>()[..] else {
        panic!("{points:?} {:?}", map.untraced);
    };
    let off = (crossing.values[0] / 0.5).hypot(crossing.values[1] / 0.08);
    assert!(
        off <= crossing.error && crossing.error < 1e-4,
        "{crossing:?}"
    );
    assert_eq!(crossing.status, BifurcationStatus::Located);
    assert_eq!(crossing.label, "CX1");
}

#[test]
fn the_program_tells_and_draws_what_starts_from_a_degenerate_split() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (file, out) = (at("split.toml"), at("out"));
    std::fs::write(&file, TRICRITICAL).unwrap();
    let follow = |more: &[&str]| {
        let mut arguments = vec!["curve", file.as_str(), "--quiet", "--out", out.as_str()];
        arguments.extend(["--second", "b", "--from", "-1", "--to", "1"]);
        arguments.extend(more);
        let output = pbif(&arguments);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    let said = follow(&[]);
    for words in [
        "C2  slope at the inflection",
        "DS1",
        "degenerate split of C1 and C2",
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
    let read = |name: &str| std::fs::read_to_string(at(name)).unwrap();
    let table = read("out/codimension_two.csv");
    assert!(
        table.starts_with(
            "label,kind,a,b,error,status,observable,place,curves\nDS1,degenerate split,"
        )
    );
    let tex = read("out/codimension_two.tex");
    assert!(tex.contains("DS1 & degenerate split & $"), "{tex}");
    let curves = read("out/curves.csv");
    assert!(curves.starts_with("curve,label,a,b,"));
    for line in ["C1,PB1,", "C1,DS1,", "C2,DS1,", "C2,start,"] {
        assert!(curves.lines().any(|one| one.starts_with(line)), "{line}");
    }
    let drawn = read("out/figures/curve.svg");
    assert!(drawn.contains("DS1"));
    // Drawn again from what is stored, to the same picture.
    let again = at("again");
    let output = pbif(&["plot", &out, "--quiet", "--out", &again, "--format", "svg"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert_eq!(read("again/curve.svg"), drawn);
    // Of another version, and cut off, it is refused.
    let plane = at("out/plane.json");
    let whole = std::fs::read_to_string(&plane).unwrap();
    for (text, says) in [
        (whole.replace("\"pbif\"", "\"other\""), "is of other"),
        (
            whole[..whole.len() / 2].to_owned(),
            "does not hold the curves of a plane",
        ),
        (
            whole.replace("\"C", "\"X").replace("\"kind\"", "\"sort\""),
            "a curve cannot be understood",
        ),
    ] {
        std::fs::write(&plane, text).unwrap();
        let output = pbif(&["plot", &out, "--quiet", "--out", &again]);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        let text = String::from_utf8(output.stderr).unwrap();
        assert!(text.contains(says), "{says}:\n{text}");
    }
    let said = follow(&["--alone"]);
    assert!(said.contains("DS1") && !said.contains("C2"), "{said}");
}
