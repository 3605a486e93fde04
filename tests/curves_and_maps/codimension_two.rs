//! Points of codimension two, and the curves that start from them, against systems whose densities are known exactly.

use pbif::cancellation::Cancellation;
use pbif::continuation::curve::{
    CodimensionTwoKind, CurveOptions, CurveStart, EndReason, Plane, codimension_two, follow,
};
use pbif::continuation::{
    BifurcationStatus, DensitySource, Doubt, Session, SourceError, Subject, Want,
};

use super::support::{
    Side, assert_drawn_again, assert_meet, assert_on, ends, mapped, off_the_fold, stepping, tree,
};
use crate::common::room::{Room, assert_says};
use crate::common::sweeps::swept;

/// Peaks of the density are zeros of the drift: the centre splits at a = 0, and for b > 0 two peaks are born away from
/// it at a = -b²/4.
const TRICRITICAL: &str = r#"
system.equations = { x = "a x + b x^3 - x^5" }
system.noise = { x = "sqrt(0.1)" }
system.parameters = { b = -0.5 }
sweep = { parameter = "a", from = -0.3, to = 0.2, points = 6 }
cells.x = { from = -1.8, to = 1.8, count = 160 }
"#;

/// Damping c - bH + H², H the energy: the density is exp(-(2/σ²)(cH - bH²/2 + H³/3)). The centre is lost at c = 0, and
/// for b > 0 a ring is born around it at c = b²/4.
const RING: &str = r#"
system.equations = { x = "y", y = "-(c - b (x^2 + y^2)/2 + (x^2 + y^2)^2/4) y - x" }
system.noise = { y = "sqrt(0.02)" }
system.parameters = { b = -0.3 }
sweep = { parameter = "c", from = -0.1, to = 0.15, points = 6 }
cells.x = { from = -1.6, to = 1.6, count = 64 }
cells.y = { from = -1.6, to = 1.6, count = 64 }
detect = { marginals = [], joint = [["x", "y"]] }
locate = { relative_tolerance = 1e-3 }
"#;

const CUSP: &str = r#"
system.equations = { x = "h + a x - x^3" }
system.noise = { x = "sqrt(0.1)" }
system.parameters = { a = 0.8 }
sweep = { parameter = "h", from = 0.1, to = 0.4, points = 7 }
cells.x = { from = -2.2, to = 2.2, count = 300 }
"#;

const BOX_OF_CUSP: (Side<'_>, Side<'_>) = (("h", -0.4, 0.4), ("a", -0.3, 1.0));

#[test]
fn births_at_the_centre_turn_into_births_away_from_it_and_their_fold_is_followed() {
    let plane = (("a", -0.3, 0.2), ("b", -1.0, 1.0));
    let tree = tree(TRICRITICAL, |_| true, plane, -0.5, stepping(0.025));
    let [split, fold] = tree.curves.as_slice() else {
        panic!("{} curves", tree.curves.len());
    };
    let [degenerate] = split.degenerate.as_slice() else {
        panic!("{:?}", split.degenerate);
    };
    let point = &split.points[degenerate.point];
    assert_eq!(point.status(), BifurcationStatus::Located);
    assert!(point.checked, "{point:?}");
    let begins = split.points[split.start].values;
    assert!((begins[1] + 0.5).abs() < 1e-6, "{begins:?}");
    for pair in split.points.windows(2) {
        assert!(pair[0].arclength < pair[1].arclength, "{pair:?}");
    }
    // The fold is a = -b²/4, and ends where it begins.
    assert!(fold.points.len() > 20);
    assert_on(fold, 1e-4, |[a, b]| {
        (a + 0.25 * b * b) / 0.5 / 1.0_f64.hypot(0.5 * b * 2.0 / 0.5)
    });
    let ends = ends(fold);
    let wanted = [EndReason::DegenerateSplit, EndReason::Border(1)];
    assert!(wanted.iter().all(|end| ends.contains(&end)), "{ends:?}");
    let kind = ("DS1", CodimensionTwoKind::DegenerateSplit);
    assert_meet(&tree.curves, kind, &[0, 1], [0.0, 0.0], 1e-5);
    assert!(codimension_two(&tree.curves)[0].place[0].abs() < 1e-9);
}

/// Cells of 0.034 and a box in which a fold is followed past its end: points within six cells of the centre, 0.2, are
/// not told from their mirror images, and lie up to b = 0.08 from the end, farther than an end may be from what is met.
#[test]
fn a_fold_that_was_followed_past_its_degenerate_split_ends_there() {
    let text = TRICRITICAL
        .replace("b = -0.5", "b = 0.824")
        .replace("sqrt(0.1)", "0.7294")
        .replace(
            "from = -0.3, to = 0.2, points = 6",
            "from = -0.5, to = 0.4, points = 19",
        )
        .replace(
            "from = -1.8, to = 1.8, count = 160",
            "from = -3.2, to = 3.2, count = 187",
        );
    for (low, high) in [(-1.0, 1.2), (-0.8, 1.5)] {
        let plane = (("a", -0.5, 0.4), ("b", low, high));
        let splits = |row: &pbif::continuation::Located| row.value.abs() < 0.01;
        let tree = tree(&text, splits, plane, 0.824, CurveOptions::default());
        let [_, fold] = tree.curves.as_slice() else {
            panic!("{} curves", tree.curves.len());
        };
        assert!(
            ends(fold).contains(&&EndReason::DegenerateSplit),
            "{:?}",
            ends(fold)
        );
        // Near the end: far from it errors are those between checks.
        for point in fold.points.iter().filter(|one| one.values[1] < 0.6) {
            let [a, b] = point.values;
            let slope = 0.9_f64.hypot(0.5 * b * (high - low));
            let off = (a + 0.25 * b * b).abs() / slope;
            assert!(
                off <= point.error && point.error < 1e-4,
                "{point:?}: {off:.1e} off"
            );
            assert_eq!(point.status(), BifurcationStatus::Located);
        }
        assert!(fold.points.iter().all(|one| one.values[1] > -1e-3));
        let kind = ("DS1", CodimensionTwoKind::DegenerateSplit);
        assert_meet(&tree.curves, kind, &[0, 1], [0.0, 0.0], 1e-3);
    }
}

#[test]
fn the_birth_of_a_ring_and_the_loss_of_the_centre_meet_where_both_are_exact() {
    let plane = (("c", -0.1, 0.15), ("b", -0.6, 0.6));
    let tree = tree(RING, |_| true, plane, -0.3, stepping(0.05));
    let [lost, born] = tree.curves.as_slice() else {
        panic!("{} curves", tree.curves.len());
    };
    assert_on(lost, f64::INFINITY, |[c, _]| c / 0.25);
    // The ring's curve is c = b²/4 from the meeting to the border of the box.
    assert_on(born, 2e-3, |[c, b]| {
        (c - 0.25 * b * b) / 0.25 / 1.0_f64.hypot(0.5 * b * 1.2 / 0.25)
    });
    let values = || born.points.iter().map(|point| point.values[1]);
    let (low, high) = (
        values().fold(f64::INFINITY, f64::min),
        values().fold(f64::NEG_INFINITY, f64::max),
    );
    assert!(low < 0.05 && high == 0.6, "{low} {high}");
    let kind = ("DS1", CodimensionTwoKind::DegenerateSplit);
    assert_meet(&tree.curves, kind, &[0, 1], [0.0, 0.0], 1e-3);
}

#[test]
fn the_curve_goes_on_beyond_a_cusp_onto_the_other_fold() {
    let tree = tree(CUSP, |_| true, BOX_OF_CUSP, 0.8, stepping(0.025));
    let sides = tree
        .curves
        .iter()
        .map(|curve| curve.points[curve.start].values[0].signum());
    assert_eq!(sides.collect::<Vec<_>>(), [1.0, -1.0]);
    for curve in &tree.curves {
        let off = |values: [f64; 2]| off_the_fold(values, [0.8, 1.3]);
        assert_on(curve, f64::INFINITY, |values| {
            if values[1] > 0.01 { off(values) } else { 0.0 }
        });
    }
    let kind = ("CP1", CodimensionTwoKind::Cusp);
    assert_meet(&tree.curves, kind, &[0, 1], [0.0, 0.0], f64::INFINITY);
}

#[test]
fn a_cusp_of_a_fold_that_no_finer_cells_have_checked_is_unchecked() {
    for (check_every, status) in [
        (0, BifurcationStatus::Unchecked),
        (8, BifurcationStatus::Located),
    ] {
        let options = CurveOptions {
            check_every,
            ..stepping(0.025)
        };
        let tree = tree(CUSP, |_| true, BOX_OF_CUSP, 0.8, options);
        let points = codimension_two(&tree.curves);
        assert_eq!(points.len(), 1);
        assert_eq!(points[0].status(), status);
    }
}

/// A source of which none on finer cells can be made.
struct NoFiner<S>(S);

impl<S: DensitySource> DensitySource for NoFiner<S> {
    fn method(&self) -> &'static str {
        self.0.method()
    }
    fn subject(&self) -> &Subject {
        self.0.subject()
    }
    fn open(&self, cancellation: &Cancellation) -> Box<dyn Session> {
        self.0.open(cancellation)
    }
    fn finer(&self, _: &Want) -> Result<Option<Box<dyn DensitySource>>, SourceError> {
        Err(SourceError::Method("no room".into()))
    }
}

#[test]
fn a_degenerate_split_that_no_finer_cells_have_checked_is_unchecked_and_says_why() {
    let never = Cancellation::new();
    let (sweep, result) = swept(TRICRITICAL, "");
    let row = result.bifurcations().next().unwrap();
    let start = CurveStart::from_row(row, -0.5, sweep.problem.subject()).unwrap();
    let plane = Plane::new(("a", -0.3, 0.2), ("b", -1.0, 1.0)).unwrap();
    let source = NoFiner(sweep.source_in(&plane, &never).unwrap());
    let (detector, watched) = (sweep.detector(), &mut |_: [f64; 2]| ());
    for check_every in [0, 8] {
        let options = CurveOptions {
            // Wide enough that the error without finer cells is no doubt of its own.
            tolerance: 2e-2,
            branches: false,
            check_every,
            ..CurveOptions::default()
        };
        let curve = follow(
            &source, &plane, &detector, &start, &options, &never, watched,
        );
        let points = codimension_two(&[curve.unwrap()]);
        let [point] = points.as_slice() else {
            panic!("{points:?}");
        };
        assert_eq!(point.kind, CodimensionTwoKind::DegenerateSplit);
        assert_eq!(point.status(), BifurcationStatus::Unchecked, "{point:?}");
        let says_why = match &point.doubts[..] {
            [Doubt::GridCheckOff] => check_every == 0,
            [Doubt::CheckFailed(_, reason)] => check_every > 0 && reason == "no room",
            _ => false,
        };
        assert!(says_why, "{:?}", point.doubts);
    }
}

/// The centre splits at a = 0, and two pairs of a peak and a valley are born at x = ±1 where c = 0: both lines are
/// exact, and cross.
const CROSSING: &str = r#"
system.equations = { x = "-10 x (x^2 - a) ((x^2 - 1)^2 - c)" }
system.noise = { x = "sqrt(0.5)" }
system.parameters = { c = 0.01 }
sweep = { parameter = "a", from = -0.2, to = 0.3, points = 9 }
map = { parameter = "c", from = -0.03, to = 0.05, points = 7, depth = 1 }
cells.x = { from = -1.6, to = 1.6, count = 160 }
"#;

#[test]
fn curves_that_cross_are_told_with_where_they_do() {
    let map = mapped(CROSSING, "");
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
    assert_eq!(crossing.status(), BifurcationStatus::Located);
    assert_eq!(crossing.label, "CX1");
}

#[test]
fn the_program_tells_and_draws_what_starts_from_a_degenerate_split() {
    let room = Room::new();
    room.write("split.toml", TRICRITICAL);
    let follow = "curve split.toml --quiet --out out --second b --from -1 --to 1";
    let words = [
        "C2  slope at the inflection",
        "DS1",
        "degenerate split of C1 and C2",
    ];
    room.done(follow).says(&words);
    let table = room.read("out/codimension_two.csv");
    let columns = "label,kind,a,b,error,status,observable,place,curves";
    assert!(
        table.starts_with(&format!("{columns}\nDS1,degenerate split,")),
        "{table}"
    );
    assert_says(
        &room.read("out/codimension_two.tex"),
        &["DS1 & degenerate split & $"],
    );
    let curves = room.read("out/curves.csv");
    assert!(curves.starts_with("curve,label,a,b,"));
    assert_says(
        &curves,
        &["\nC1,PB1,", "\nC1,DS1,", "\nC2,DS1,", "\nC2,start,"],
    );
    assert_says(&room.read("out/figures/curve.svg"), &["DS1"]);
    assert_drawn_again(&room, "out", "curve.svg");
    // Of another version, cut off, and altered, it is refused.
    let whole = room.read("out/plane.json");
    let half = whole[..whole.len() / 2].to_owned();
    let sorted = whole.replace("\"C", "\"X").replace("\"kind\"", "\"sort\"");
    for (text, words) in [
        (whole.replace("\"pbif\"", "\"other\""), "is of other"),
        (half, "does not hold the curves of a plane"),
        (sorted, "is changed: it is not what the run left"),
    ] {
        room.write("out/plane.json", text);
        room.refused("plot out --quiet --out again", &[words]);
    }
    let alone = room.done(&format!("{follow} --alone")).says(&["DS1"]);
    assert!(!alone.out.contains("C2"), "{alone:?}");
}

#[test]
fn a_fold_that_touches_a_split_does_not_cross_it() {
    // The density of x splits at its centre on a line that the fold of x touches in one point, (0.0927, -0.3114), and
    // lies beside everywhere else (trapezoid sums over y and bisection). Errors of both lines made a crossing of them
    // at b = -0.329, "located" twelve errors away.
    let text = r#"
system.equations = { x = "y", y = "-1.299 x - 0.317 x^3 - (-a + b H + 0.701 H^2) y" }
system.noise = { y = "sqrt(0.246)" }
system.define = { H = "y^2/2 + 1.299 x^2/2 + 0.317 x^4/4" }
system.parameters = { b = 0.211 }
sweep = { parameter = "a", from = 0.1, to = 0.3, points = 5 }
cells.x = { from = -2.01, to = 2.01, count = 50 }
cells.y = { from = -2.5, to = 2.5, count = 50 }
detect = { marginals = ["x"], joint = [] }
"#;
    let tree = tree(
        text,
        |_| true,
        (("a", -0.35, 0.35), ("b", -0.6, 0.6)),
        0.211,
        CurveOptions::default(),
    );
    assert_eq!(tree.curves.len(), 2);
    let points = codimension_two(&tree.curves);
    let kinds: Vec<CodimensionTwoKind> = points.iter().map(|one| one.kind).collect();
    assert_eq!(kinds, [CodimensionTwoKind::DegenerateSplit]);
}
