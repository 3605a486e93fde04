//! Curves of P-bifurcations in planes of two parameters, against curves that are known exactly and against sweeps over
//! one parameter.

use crate::common::cusp::off_the_fold;
use crate::common::pbif;
use crate::common::room::{Room, words};
use crate::common::sweeps::prepared;
use pbif::cancellation::Cancellation;
use pbif::continuation::curve::{
    Curve, CurveError, CurveOptions, CurvePoint, CurveStart, EndReason, Plane, follow,
};
use pbif::continuation::{BifurcationStatus, LabelledPoint, SweepResult};
use pbif::sweep_file::Sweep;

/// Additive noise: peaks of the density are zeros of the drift, and two of them fold where 27 h² = 4 a³.
const CUSP: &str = r#"
[system.equations]
x = "h + a x - x^3"
[system.noise]
x = "sqrt(sigma2)"
[system.parameters]
a = 1.0
h = 0.3
sigma2 = 0.1
[sweep]
parameter = "h"
from = 0.1
to = 0.6
points = 11
[cells]
x = { from = -2.5, to = 2.5, count = 300 }
"#;

/// One peak splits where u² + v² = 1.
const CIRCLE: &str = r#"
[system.equations]
x = "(1 - u^2 - v^2) x - x^3"
[system.noise]
x = "1/2"
[system.parameters]
u = 0.0
v = 0.3
[sweep]
parameter = "u"
from = 0.2
to = 1.5
points = 6
[cells]
x = { from = -2.5, to = 2.5, count = 100 }
"#;

const COULOMB: &str = r#"
[system]
model = "coulomb"
[system.parameters]
kappa = 0.05
mu = 0.05
sigma2 = 0.05
[sweep]
parameter = "f_c"
from = -0.03
to = 0.01
points = 5
[cells]
x = { from = -4.0, to = 4.0, count = 50, grade = { at = [0.0], smallest = 0.06 } }
y = { from = -4.0, to = 4.0, count = 50, grade = "auto" }
[detect]
marginals = ["x", "y"]
joint = []
[locate]
relative_tolerance = 1e-3
"#;

/// With damping -a + bH the density is exp(-(2/σ²)(-aH + bH²/2)): the crater opens at a = 0, and x splits at a = c √(b
/// σ²).
const RAYLEIGH: &str = r#"
[system]
model = "rayleigh"
[system.parameters]
b = 0.1
sigma2 = 0.02
[sweep]
parameter = "a"
from = -0.02
to = 0.06
points = 5
[cells]
x = { from = -2.8, to = 2.8, count = 50 }
y = { from = -2.8, to = 2.8, count = 50 }
[locate]
relative_tolerance = 1e-3
"#;

fn swept(text: &str, settings: &[&str]) -> (Sweep, SweepResult) {
    let never = Cancellation::new();
    let sweep = prepared(text, settings);
    let result = sweep.run(&never, &mut ()).unwrap();
    (sweep, result)
}

/// The row of an observable that an indicator of this name located.
fn row<'a>(result: &'a SweepResult, observable: &str, method: &str) -> &'a LabelledPoint {
    let family = &result.subject.family;
    let mut rows = result.labels.iter();
    let is_it = |row: &&LabelledPoint| {
        let name = row.observable.map(|one| one.name(family));
        name.as_deref() == Some(observable) && row.method == method
    };
    rows.find(is_it).unwrap()
}

/// The curve from a row in the plane of the swept and a second parameter, which the sweep holds at `held`.
fn curve(sweep: &Sweep, row: &LabelledPoint, plane: &Plane, held: f64) -> Curve {
    let never = Cancellation::new();
    let source = sweep.source_in(plane, &never).unwrap();
    let start = CurveStart::from_row(row, held, sweep.problem.subject()).unwrap();
    let options = CurveOptions::default();
    let detector = sweep.detector();
    let (observer, never) = (&mut |_: [f64; 2]| (), Cancellation::new());
    follow(
        &source, plane, &detector, &start, &options, &never, observer,
    )
    .unwrap()
}

/// Asserts that a curve lies where a function of both parameters is zero: `off` gives its distance to there across the
/// curve, in sides of the box.
fn assert_on(curve: &Curve, off: impl Fn([f64; 2]) -> f64) {
    for CurvePoint { values, error, .. } in &curve.points {
        let off = off(*values).abs();
        assert!(
            off <= 1e-4 && off <= *error,
            "{values:?}: {off:.1e} off, stated {error:.1e}"
        );
    }
}

fn ends(curve: &Curve) -> Vec<&EndReason> {
    curve.ends.iter().map(|end| &end.reason).collect()
}

#[test]
fn the_fold_of_a_cusp_is_followed_within_its_error_whichever_parameter_is_first() {
    let (sweep, result) = swept(CUSP, &[]);
    let plane = Plane::new(("h", -0.7, 0.7), ("a", 0.2, 1.6)).unwrap();
    let first = curve(
        &sweep,
        row(&result, "x", "slope at the inflection"),
        &plane,
        1.0,
    );
    assert_on(&first, |values| off_the_fold(values, [1.4, 1.4]));
    // At the lower end a = 0.2; at the upper one h = 0.7.
    assert_eq!(ends(&first), [&EndReason::Border(1), &EndReason::Border(0)]);
    let (low, high) = (
        &first.points[0].values,
        &first.points.last().unwrap().values,
    );
    assert!(low[1] == 0.2 && (low[0] - 2.0 * (0.2_f64 / 3.0).powf(1.5)).abs() < 1e-6);
    assert!(high[0] == 0.7 && (high[1] - 3.0 * 0.35_f64.powf(2.0 / 3.0)).abs() < 1e-6);
    assert!(
        first
            .points
            .iter()
            .all(|point| point.status == BifurcationStatus::Located)
    );

    // One solve a point, but for the two ends and the start; every eighth point, both ends and the start are checked.
    let points = first.points.len();
    assert!((30..70).contains(&points), "{points}");
    assert!(
        first.work.solves <= points + 6,
        "{:?} for {points}",
        first.work
    );
    let checked = first.points.iter().filter(|point| point.checked).count();
    assert_eq!(first.check_work.solves, checked);
    assert!((points / 8..points / 8 + 4).contains(&checked));

    // Neighbours follow each other, and the tangent is that of 27 h² = 4 a³: da/dh = 54 h/(12 a²).
    for pair in first.points.windows(2) {
        assert!(pair[0].arclength < pair[1].arclength);
        assert!(pair[0].values[1] < pair[1].values[1]);
    }
    for point in &first.points {
        let ([h, a], [dh, da]) = (point.values, point.tangent);
        assert!(
            (da / dh / (4.5 * h / (a * a)) - 1.0).abs() < 1e-3,
            "{point:?}"
        );
    }

    // The same from a sweep over the other parameter, begun elsewhere.
    let other = [
        "sweep.parameter=a",
        "sweep.from=0.5",
        "sweep.to=1.2",
        "system.parameters.h=0.2",
    ];
    let (sweep, result) = swept(&CUSP.replace("a = 1.0\n", ""), &other);
    let plane = Plane::new(("a", 0.2, 1.6), ("h", -0.7, 0.7)).unwrap();
    let second = curve(
        &sweep,
        row(&result, "x", "slope at the inflection"),
        &plane,
        0.2,
    );
    assert_on(&second, |[a, h]| off_the_fold([h, a], [1.4, 1.4]));
    let both =
        [&first, &second].map(|one| one.points.last().unwrap().arclength - one.points[0].arclength);
    assert!((both[0] - both[1]).abs() < 1e-3, "{both:?}");
}

#[test]
fn the_cusp_in_which_two_folds_meet_is_located() {
    let (sweep, result) = swept(CUSP, &[]);
    let plane = Plane::new(("h", -0.7, 0.7), ("a", -0.4, 1.0)).unwrap();
    let curve = curve(
        &sweep,
        row(&result, "x", "slope at the inflection"),
        &plane,
        1.0,
    );
    assert_eq!(ends(&curve), [&EndReason::Cusp, &EndReason::Border(1)]);
    assert_eq!(curve.ends[0].label, "CP1");
    let cusp = &curve.points[0];
    let off = (cusp.values[0] / 1.4).hypot(cusp.values[1] / 1.4);
    assert!(off <= cusp.error && cusp.error <= 1e-3, "{cusp:?}");
    // Peak, valley and inflection are one at x = 0.
    assert!(cusp.place[0].abs() < 1e-3, "{cusp:?}");
    assert_eq!(curve.points[curve.start].arclength, 0.0);
}

#[test]
fn a_closed_curve_comes_back_to_where_it_began() {
    let (sweep, result) = swept(CIRCLE, &[]);
    let plane = Plane::new(("u", -1.2, 1.3), ("v", -1.3, 1.2)).unwrap();
    let curve = curve(
        &sweep,
        row(&result, "x", "curvature at the centre"),
        &plane,
        0.3,
    );
    assert_on(&curve, |[u, v]| (u * u + v * v - 1.0) / (2.0 * 2.5));
    assert_eq!(ends(&curve), [&EndReason::Closed]);
    let length = curve.points.last().unwrap().arclength * 2.5;
    assert!(
        (length / std::f64::consts::TAU - 1.0).abs() < 1e-3,
        "{length}"
    );
}

#[test]
fn sweeps_over_one_parameter_lie_in_the_band_of_coulomb_friction() {
    let (sweep, result) = swept(COULOMB, &[]);
    let plane = Plane::new(("f_c", -0.03, 0.01), ("sigma2", 0.03, 0.07)).unwrap();
    let found = row(&result, "x", "curvature at the centre");
    let merger = curve(&sweep, found, &plane, 0.05);
    assert_eq!(
        ends(&merger),
        [&EndReason::Border(1), &EndReason::Border(1)]
    );
    let begins = &merger.points[merger.start];
    assert!((begins.values[0] - found.value).abs() <= found.error);
    for (sigma2, point) in [
        ("0.03", &merger.points[0]),
        ("0.07", merger.points.last().unwrap()),
    ] {
        let (_, result) = swept(COULOMB, &[&format!("system.parameters.sigma2={sigma2}")]);
        let alone = row(&result, "x", "curvature at the centre");
        // Both are on the border; the curve is steep there, so that its band along f_c is about as wide as across.
        let off = (alone.value - point.values[0]).abs();
        assert!(
            off <= 0.04 * point.error,
            "{} {:?}",
            alone.value,
            point.values
        );
    }
    // Between them f_c is nearly linear in σ.
    for sigma2 in [0.04, 0.06_f64] {
        let setting = format!("system.parameters.sigma2={sigma2}");
        let (_, result) = swept(COULOMB, &[&setting]);
        let alone = row(&result, "x", "curvature at the centre");
        let after = merger
            .points
            .partition_point(|point| point.values[1] < sigma2);
        let [a, b] = [&merger.points[after - 1], &merger.points[after]];
        let [s, t] = [a, b].map(|point| point.values[1].sqrt());
        let share = (sigma2.sqrt() - s) / (t - s);
        let along = (1.0 - share) * a.values[0] + share * b.values[0];
        let off = (alone.value - along).abs();
        assert!(
            off <= 0.04 * a.error.max(b.error),
            "{} {along}",
            alone.value
        );
    }
    // A factorisation serves several solves, and none is spent on corrections but a few at the beginning and the ends.
    let (points, work) = (merger.points.len(), merger.work);
    assert!(
        work.solves <= points + 8 && 2 * work.factorisations <= points,
        "{points}: {work:?}"
    );
    let told = [("followed", work), ("checked", merger.check_work)].map(|(how, work)| {
        let (solves, factorisations) = (work.solves, work.factorisations);
        format!(
            "{how} by {solves} solves, {factorisations} + {}",
            work.iterations
        )
    });
    insta::assert_snapshot!(format!("{points} points\n{}", told.join("\n")), @r"
    45 points
    followed by 46 solves, 18 + 165
    checked by 14 solves, 6 + 159
    ");

    // The kink of y is none where nothing jumps, at any noise; its slope follows from the equations.
    let kink = curve(&sweep, row(&result, "y", "slope at the kink"), &plane, 0.05);
    assert!(kink.points.iter().all(|point| point.values[0].abs() < 1e-9));
    assert!(
        kink.points
            .iter()
            .all(|point| point.status == BifurcationStatus::Located)
    );
    assert_eq!(kink.check_work.solves, 0);
    // So does how it changes with both parameters, which takes no solves beside the points.
    let (points, work) = (kink.points.len(), kink.work);
    assert!(work.solves <= points + 2, "{points}: {work:?}");
}

#[test]
fn with_a_linear_spring_friction_at_the_change_is_proportional_to_sigma_from_either_parameter() {
    let linear = COULOMB.replace("mu = 0.05", "mu = 0.0");
    let (sweep, result) = swept(&linear, &[]);
    let found = row(&result, "x", "curvature at the centre");
    let plane = Plane::new(("f_c", -0.03, 0.01), ("sigma2", 0.03, 0.07)).unwrap();
    let first = curve(&sweep, found, &plane, 0.05);
    let begins = &first.points[first.start];
    // States scale with σ, and forces with them.
    let ratio = begins.values[0] / begins.values[1].sqrt();
    let off = |[f_c, sigma2]: [f64; 2]| {
        let slope = 0.5 * ratio / sigma2.sqrt();
        (f_c - ratio * sigma2.sqrt()) / 0.04 / 1.0_f64.hypot(slope)
    };
    for point in &first.points {
        let off = off(point.values).abs();
        assert!(off <= begins.error + point.error, "{point:?}: {off:.1e}");
    }

    // The other parameter first, begun elsewhere.
    let held = first.points[first.points.len() / 4].values;
    let other = linear.replace("sigma2 = 0.05\n", "");
    let settings = [
        "sweep.parameter=sigma2".to_owned(),
        "sweep.from=0.03".to_owned(),
        "sweep.to=0.07".to_owned(),
        format!("system.parameters.f_c={}", held[0]),
    ];
    let (sweep, result) = swept(&other, &settings.each_ref().map(String::as_str));
    let found = row(&result, "x", "curvature at the centre");
    let plane = Plane::new(("sigma2", 0.03, 0.07), ("f_c", -0.03, 0.01)).unwrap();
    let second = curve(&sweep, found, &plane, held[0]);
    assert_eq!(
        ends(&second),
        [&EndReason::Border(0), &EndReason::Border(0)]
    );
    for point in &second.points {
        let off = off([point.values[1], point.values[0]]).abs();
        assert!(off <= begins.error + point.error, "{point:?}: {off:.1e}");
    }
}

/// Root c of ∫ (c - y²/2) exp(c y² - y⁴/4) dy: p''(0) of the marginal of x, in units of b σ² = 1.
fn split_of_x() -> f64 {
    let curvature = |c: f64| -> f64 {
        let at = |k: i32| f64::from(k) * 1e-3;
        let of = |y: f64| (c - 0.5 * y * y) * (c * y * y - 0.25 * y.powi(4)).exp();
        (-6000..=6000).map(|k| of(at(k))).sum()
    };
    let (mut low, mut high) = (0.1, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if curvature(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

#[test]
fn curves_of_energy_dependent_damping_are_those_of_its_exact_density() {
    let (sweep, result) = swept(RAYLEIGH, &[]);
    let plane = Plane::new(("a", -0.02, 0.06), ("sigma2", 0.01, 0.04)).unwrap();
    let split = curve(
        &sweep,
        row(&result, "x", "curvature at the centre"),
        &plane,
        0.02,
    );
    let c = split_of_x();
    assert_on(&split, |[a, sigma2]| {
        let exact = c * (0.1 * sigma2).sqrt();
        let slope = 0.5 * exact / sigma2 * 0.03 / 0.08;
        (a - exact) / 0.08 / 1.0_f64.hypot(slope)
    });
    let plane = Plane::new(("a", -0.02, 0.06), ("b", 0.05, 0.2)).unwrap();
    let opens = curve(
        &sweep,
        row(&result, "xy", "lower curvature at the centre"),
        &plane,
        0.1,
    );
    assert_on(&opens, |[a, _]| a / 0.08);
}

#[test]
fn a_start_outside_of_the_box_and_another_plane_are_refused() {
    let (sweep, result) = swept(CUSP, &[]);
    let found = row(&result, "x", "slope at the inflection");
    let start = CurveStart::from_row(found, 1.0, sweep.problem.subject()).unwrap();
    let never = Cancellation::new();
    let refused = |solved: &Plane, followed: &Plane, start: &CurveStart| {
        let source = sweep.source_in(solved, &never).unwrap();
        let options = CurveOptions::default();
        let observer = &mut |_: [f64; 2]| ();
        follow(
            &source,
            followed,
            &sweep.detector(),
            start,
            &options,
            &never,
            observer,
        )
        .unwrap_err()
    };
    let high = Plane::new(("h", 0.0, 1.0), ("a", 1.2, 2.0)).unwrap();
    let error = refused(&high, &high, &start);
    assert!(
        matches!(&error, CurveError::Outside { parameter, .. } if parameter == "a"),
        "{error}"
    );
    let other = Plane::new(("h", 0.0, 1.0), ("sigma2", 0.05, 1.2)).unwrap();
    let error = refused(&other, &high, &start);
    assert!(matches!(error, CurveError::OtherPlane { .. }), "{error}");
    let away = CurveStart {
        values: [0.9, 1.5],
        ..start
    };
    let error = refused(&high, &high, &away);
    assert!(matches!(error, CurveError::NoStart { .. }), "{error}");
    let unknown = Plane::new(("h", 0.0, 1.0), ("b", 0.0, 2.0)).unwrap();
    let error = sweep.source_in(&unknown, &never).err().unwrap();
    assert!(error.to_string().contains("`b`"), "{error}");
}

#[test]
fn a_cancelled_curve_says_so() {
    let (sweep, result) = swept(CUSP, &[]);
    let found = row(&result, "x", "slope at the inflection");
    let start = CurveStart::from_row(found, 1.0, sweep.problem.subject()).unwrap();
    let plane = Plane::new(("h", -0.7, 0.7), ("a", 0.2, 1.6)).unwrap();
    let cancellation = Cancellation::new();
    let source = sweep.source_in(&plane, &cancellation).unwrap();
    let mut met = 0;
    let mut observer = |_: [f64; 2]| {
        met += 1;
        if met == 5 {
            cancellation.cancel();
        }
    };
    let (options, detector) = (CurveOptions::default(), sweep.detector());
    let curve = follow(
        &source,
        &plane,
        &detector,
        &start,
        &options,
        &cancellation,
        &mut observer,
    );
    let curve = curve.unwrap();
    assert!(curve.is_interrupted());
    assert_eq!(curve.points.len(), 5);
}

#[test]
fn the_program_follows_a_row_of_a_run_and_says_what_is_wrong() {
    let room = Room::new();
    let at = |name: &str| room.at(name);
    let (file, run) = (at("cusp.toml"), at("run"));
    std::fs::write(&file, CUSP).unwrap();
    // At its first value the system is symmetric, and at no other.
    assert!(
        pbif(&[
            "sweep",
            &file,
            "--out",
            &run,
            "--quiet",
            "--set",
            "sweep.from=0"
        ])
        .status
        .success()
    );
    let fold = |more: &[&str]| {
        let mut arguments = vec![
            "curve",
            run.as_str(),
            "--quiet",
            "--first-from",
            "-0.7",
            "--first-to",
            "0.7",
        ];
        arguments.extend(more);
        pbif(&arguments)
    };
    let output = fold(&[
        "--row", "PB1", "--second", "a", "--from", "0.2", "--to", "1.6",
    ]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let said = words(&output);
    assert!(
        said.contains("EP1") && said.contains("border of the box in a"),
        "{said}"
    );
    let table = room.read("run/curves/PB1-a/curves.csv");
    let mut lines = table.lines();
    assert!(
        lines
            .next()
            .unwrap()
            .starts_with("curve,label,h,a,error,edge_h,edge_a,observable,method,indicator,")
    );
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        let [h, a, error] = [2, 3, 4].map(|k| cells[k].parse::<f64>().unwrap());
        assert!(off_the_fold([h, a], [1.4, 1.4]).abs() <= error, "{line}");
    }
    for file in ["curve.json", "figures/curve.svg", "figures/curve.png"] {
        assert!(room.holds(&format!("run/curves/PB1-a/{file}")), "{file}");
    }
    // The run is as it was, and a second curve keeps the first.
    assert!(pbif(&["verify", &run]).status.success());
    let again = [
        "--second", "a", "--from", "0.2", "--to", "1.6", "--step", "0.1",
    ];
    assert_eq!(fold(&again).status.code(), Some(0));
    assert!(room.holds("run/curves/PB1-a/previous/1/curves.csv"));

    let refusals: [(&[&str], &str); 6] = [
        (
            &["--row", "PB7", "--second", "a", "--from", "0", "--to", "2"],
            "no P-bifurcation `PB7`",
        ),
        (
            &["--second", "b", "--from", "0", "--to", "2"],
            "there is no parameter `b`",
        ),
        (
            &["--second", "h", "--from", "0", "--to", "2"],
            "the second parameter is the swept one",
        ),
        (
            &["--second", "a", "--from", "1.2", "--to", "2"],
            "PB1 is not in the box: a is 1 there",
        ),
        (
            &["--second", "a", "--from", "1", "--to", "1"],
            "the box has no extent in a",
        ),
        (
            &["--second", "a", "--from", "x", "--to", "1"],
            "allowed: a number",
        ),
    ];
    for (arguments, wanted) in refusals {
        let output = fold(arguments);
        let said = words(&output);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(wanted), "{said}");
    }
    // A run of another version is not read.
    let manifest = room.read("run/run.json");
    let version = format!("\"version\": \"{}\"", env!("CARGO_PKG_VERSION"));
    std::fs::write(
        at("run/run.json"),
        manifest.replace(&version, "\"version\": \"99.0.0\""),
    )
    .unwrap();
    let output = fold(&["--second", "a", "--from", "0.2", "--to", "1.6"]);
    let said = words(&output);
    assert!(
        output.status.code() == Some(2) && said.contains("99.0.0"),
        "{said}"
    );
}

/// The density of dx = (a x - x³) dt + σ dW splits at a = 0, whatever σ is.
#[test]
fn sampled_curves_hold_the_exact_one_in_their_bands_or_say_that_samples_are_few() {
    let text = |method: &str, cells: usize| {
        format!(
            r#"
[system]
model = "bistable"
[system.parameters]
sigma2 = 0.5
[sweep]
parameter = "a"
from = -1.0
to = 1.0
points = 5
[cells]
x = {{ from = -3, to = 3, count = {cells} }}
[method]
{method}
"#
        )
    };
    let plane = Plane::new(("a", -1.0, 1.0), ("sigma2", 0.3, 0.9)).unwrap();
    let options = CurveOptions {
        largest_step: 0.05,
        ..CurveOptions::default()
    };
    let followed = |method: &str, cells: usize| {
        let never = Cancellation::new();
        let (sweep, _) = swept(&text(method, cells), &[]);
        let start = CurveStart {
            values: [0.0, 0.5],
            observable: 0,
            kind: pbif::topology::IndicatorKind::CURVATURE,
            place: vec![0.0],
        };
        let source = sweep.source_in(&plane, &never).unwrap();
        let (detector, observer) = (sweep.detector(), &mut |_: [f64; 2]| ());
        follow(
            &source, &plane, &detector, &start, &options, &never, observer,
        )
    };
    for (method, cells) in [
        ("kind = \"sgcm\"\nsamples = 4000", 60),
        ("kind = \"monte-carlo\"\nerror = 0.01", 24),
    ] {
        let curve = followed(method, cells).unwrap();
        let borders = [&EndReason::Border(1), &EndReason::Border(1)];
        assert_eq!(ends(&curve), borders, "{method}");
        for point in &curve.points {
            let off = 0.5 * point.values[0].abs();
            assert!(
                off <= point.error && point.error < 0.1,
                "{method}: {point:?}"
            );
            // What is known to a tenth of the box is not located.
            assert_eq!(point.status, BifurcationStatus::Unresolved, "{method}");
            assert!(
                point.parts.sampling > 0.5 * point.error,
                "{method}: {point:?}"
            );
        }
    }
    let few = followed("kind = \"sgcm\"\nsamples = 32", 60);
    let says = |curve: &Curve| ends(curve) == [&EndReason::Sampling, &EndReason::Sampling];
    match few {
        Ok(curve) => assert!(says(&curve), "{:?}", ends(&curve)),
        Err(error) => assert!(matches!(error, CurveError::TooFewSamples), "{error}"),
    }
}

#[test]
fn a_sweep_file_names_the_curves_that_its_sweep_is_followed_by() {
    let room = Room::new();
    let at = |name: &str| room.at(name);
    let (file, run) = (at("cusp.toml"), at("run"));
    let section =
        "[curve]\nparameter = \"a\"\nfrom = 1.6\nto = 0.2\nfirst_from = -0.7\nfirst_to = 0.7\n";
    std::fs::write(&file, format!("{CUSP}{section}")).unwrap();
    let sweep = |more: &[&str]| {
        let mut arguments = vec!["sweep", file.as_str(), "--quiet", "--out", run.as_str()];
        arguments.extend(more);
        pbif(&arguments)
    };
    let output = sweep(&[]);
    assert_eq!(output.status.code(), Some(0), "{}", words(&output));
    assert!(
        words(&output).contains("border of the box in a"),
        "{}",
        words(&output)
    );
    let table = |name: &str| room.read(&format!("{name}/curves.csv"));
    let followed = table("run/curves/PB1-a");
    assert!(pbif(&["verify", &run]).status.success());
    // The same by the command that says it, and by the one that leaves it to the file.
    for (name, more) in [
        (
            "said",
            &[
                "--row", "PB1", "--second", "a", "--from", "0.2", "--to", "1.6",
            ][..],
        ),
        ("left", &[][..]),
    ] {
        let out = at(name);
        let arguments = ["curve", &run, "--quiet", "--out", &out];
        let output = pbif(&[&arguments, more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", words(&output));
        assert!(table(name) == followed, "{name}");
    }
    // Complete, nothing is solved.
    let output = sweep(&["--resume"]);
    assert_eq!(
        words(&output).matches("nothing was solved").count(),
        2,
        "{}",
        words(&output)
    );
    let refusals = [
        ("curve.parameter=b", "no parameter `b`"),
        (
            "curve.parameter=h",
            "the second parameter of the curve is the swept one",
        ),
        (
            "curve.from=0.9",
            "the sweep holds `a` at 1, and the box of the curves goes from 0.2 to 0.9",
        ),
        ("curve.first_to=-0.7", "goes from -0.7 to -0.7 along `h`"),
        ("curve.step=0.5", "from 0.0001 to 0.25"),
        (
            "curve.rows=[\"PB7\"]",
            "the sweep has no P-bifurcation `PB7`",
        ),
        ("curve.second=a", "unknown key `curve.second`"),
        (
            "map.parameter=a",
            "a file has `[map]` or `[curve]`, not both",
        ),
    ];
    for (setting, says) in refusals {
        let output = sweep(&["--set", setting]);
        assert_eq!(
            output.status.code(),
            Some(2),
            "{setting}: {}",
            words(&output)
        );
        assert!(words(&output).contains(says), "{says}:\n{}", words(&output));
    }
    std::fs::write(
        &file,
        format!("{CUSP}[curve]\nparameter = \"a\"\nfrom = 0.2\n"),
    )
    .unwrap();
    assert!(words(&sweep(&[])).contains("missing key `curve.to`"));
    std::fs::write(&file, CUSP).unwrap();
    for (more, says) in [
        (&[][..], "which is the second parameter of the plane?"),
        (
            &["--second", "a", "--from", "0.2"][..],
            "from where to where does the box go in `a`?",
        ),
    ] {
        let output = pbif(&[&["curve", &file, "--quiet"], more].concat());
        assert_eq!(output.status.code(), Some(2));
        assert!(words(&output).contains(says), "{}", words(&output));
    }
}

#[test]
fn curves_of_another_section_or_run_are_kept_apart_from_the_new_ones() {
    let room = Room::new();
    let at = |name: &str| room.at(name);
    let (file, run) = (at("cusp.toml"), at("run"));
    let section = "[curve]\nparameter = \"a\"\nfrom = 0.8\nto = 1.2\nstep = 0.1\n";
    std::fs::write(&file, format!("{CUSP}{section}")).unwrap();
    let sweep = |more: &[&str]| pbif(&[&["sweep", &file, "--out", &run], more].concat());
    let json = |name: &str| serde_json::from_str::<serde_json::Value>(&room.read(name)).unwrap();
    let to = |name: &str| {
        let curve = json(&format!("{name}/curves/PB1-a/curve.json"));
        curve["box"][1]["to"].as_f64()
    };
    let ended = |output: &std::process::Output, code: i32| {
        assert_eq!(output.status.code(), Some(code), "{}", words(output));
        words(output)
    };
    // Two shards put together follow the curves of their file; the same again solves nothing.
    for shard in ["1/2", "2/2"] {
        ended(&sweep(&["--shard", shard, "--quiet"]), 0);
    }
    ended(&pbif(&["merge", &run, "--quiet"]), 0);
    assert_eq!(to("run"), Some(1.2));
    let again = ended(&pbif(&["merge", &run]), 0);
    assert_eq!(again.matches("nothing was solved").count(), 2, "{again}");
    // Another section: the run stays, and its curves are followed anew beside the earlier ones.
    let other = ["--resume", "--set", "curve.to=1.1"];
    let said = ended(&sweep(&other), 0);
    for says in ["is complete: nothing was solved", "1.2", "followed anew"] {
        assert!(said.contains(says), "{says}: {said}");
    }
    assert_eq!(to("run"), Some(1.1));
    let earlier = json("run/curves/PB1-a/previous/1/curve.json");
    assert_eq!(earlier["box"][1]["to"].as_f64(), Some(1.2));
    // Drawn again they are the same rows; with other settings, rows may be others.
    ended(
        &pbif(&["detect", &run, "--set", "figures.at=[0.3]", "--quiet"]),
        0,
    );
    assert_eq!((to("run"), to("run/previous/1")), (Some(1.1), Some(1.1)));
    ended(
        &pbif(&["detect", &run, "--set", "detect.confidence=0.9", "--quiet"]),
        0,
    );
    assert!(!room.holds("run/curves"));
    assert_eq!(to("run/previous/2"), Some(1.1));
    // A new run has none but its own.
    ended(&sweep(&["--set", "sweep.points=9", "--quiet"]), 0);
    assert_eq!(to("run"), Some(1.2));
    std::fs::write(&file, CUSP).unwrap();
    ended(&sweep(&["--quiet"]), 0);
    assert!(!room.holds("run/curves"));
    assert_eq!(to("run/previous/4"), Some(1.2));
}

/// With linear damping the density is exp(-(2κ/σ²)(y²/2 + V)): peaks of the joint density are zeros of the spring's
/// force.
const TILTED: &str = r#"
[system.equations]
x = "y"
y = "-0.5 y + h + a x - x^3"
[system.noise]
y = "sqrt(0.2)"
[system.parameters]
a = 1.0
h = 0.3
[sweep]
parameter = "h"
from = 0.25
to = 0.5
points = 6
[cells]
x = { from = -2.2, to = 2.4, count = 80 }
y = { from = -2.6, to = 2.6, count = 60 }
[detect]
marginals = []
joint = [["x", "y"]]
[locate]
relative_tolerance = 1e-3
"#;

#[test]
fn the_fold_of_a_joint_density_is_followed_along_that_of_the_force() {
    let (sweep, result) = swept(TILTED, &[]);
    let plane = Plane::new(("h", 0.1, 0.6), ("a", 0.7, 1.2)).unwrap();
    let curve = curve(
        &sweep,
        row(&result, "xy", "slope at the shoulder"),
        &plane,
        1.0,
    );
    assert_eq!(ends(&curve), [&EndReason::Border(1), &EndReason::Border(1)]);
    for point in &curve.points {
        let off = off_the_fold(point.values, [0.5, 0.5]).abs();
        assert!(
            off <= point.error && point.error < 0.02,
            "{point:?}: {off:.1e}"
        );
    }
    // On the line a = 1 at h = 2/√27.
    let at_one = &curve.points[curve.start].values;
    assert!((at_one[0] - 0.384_900).abs() < 1e-3, "{at_one:?}");
}
