//! Curves of P-bifurcations in planes of two parameters, against curves that are known exactly and against sweeps over
//! one parameter.

use pbif::cancellation::Cancellation;
use pbif::continuation::BifurcationStatus;
use pbif::continuation::curve::{
    Curve, CurveError, CurveOptions, CurveStart, EndReason, Plane, follow,
};

use super::support::{assert_on, curve, curve_of, ends, followed, off_the_fold, row, stepping};
use crate::common::sweeps::{prepared, swept};

/// Additive noise: peaks of the density are zeros of the drift, and two of them fold where 27 h² = 4 a³.
pub(super) const CUSP: &str = r#"
system.equations = { x = "h + a x - x^3" }
system.noise = { x = "sqrt(sigma2)" }
system.parameters = { a = 1.0, h = 0.3, sigma2 = 0.1 }
sweep = { parameter = "h", from = 0.1, to = 0.6, points = 11 }
cells.x = { from = -2.5, to = 2.5, count = 300 }
"#;

/// One peak splits where u² + v² = 1.
const CIRCLE: &str = r#"
system.equations = { x = "(1 - u^2 - v^2) x - x^3" }
system.noise = { x = "1/2" }
system.parameters = { u = 0.0, v = 0.3 }
sweep = { parameter = "u", from = 0.2, to = 1.5, points = 6 }
cells.x = { from = -2.5, to = 2.5, count = 100 }
"#;

const COULOMB: &str = r#"
system.model = "coulomb"
system.parameters = { kappa = 0.05, mu = 0.05, sigma2 = 0.05 }
sweep = { parameter = "f_c", from = -0.03, to = 0.01, points = 5 }
cells.x = { from = -4.0, to = 4.0, count = 50, grade = { at = [0.0], smallest = 0.06 } }
cells.y = { from = -4.0, to = 4.0, count = 50, grade = "auto" }
detect = { marginals = ["x", "y"], joint = [] }
locate = { relative_tolerance = 1e-3 }
"#;

/// With damping -a + bH the density is exp(-(2/σ²)(-aH + bH²/2)): the crater opens at a = 0, and x splits at a = c √(b
/// σ²).
const RAYLEIGH: &str = r#"
system.model = "rayleigh"
system.parameters = { b = 0.1, sigma2 = 0.02 }
sweep = { parameter = "a", from = -0.02, to = 0.06, points = 5 }
cells.x = { from = -2.8, to = 2.8, count = 50 }
cells.y = { from = -2.8, to = 2.8, count = 50 }
locate = { relative_tolerance = 1e-3 }
"#;

/// With linear damping the density is exp(-(2κ/σ²)(y²/2 + V)): peaks of the joint density are zeros of the spring's
/// force.
const TILTED: &str = r#"
system.equations = { x = "y", y = "-0.5 y + h + a x - x^3" }
system.noise = { y = "sqrt(0.2)" }
system.parameters = { a = 1.0, h = 0.3 }
sweep = { parameter = "h", from = 0.25, to = 0.5, points = 6 }
cells.x = { from = -2.2, to = 2.4, count = 80 }
cells.y = { from = -2.6, to = 2.6, count = 60 }
detect = { marginals = [], joint = [["x", "y"]] }
locate = { relative_tolerance = 1e-3 }
"#;

/// Rows of x by their indicators.
const FOLD: (&str, &str) = ("x", "slope at the inflection");
const SPLIT: (&str, &str) = ("x", "curvature at the centre");

fn all_located(curve: &Curve) -> bool {
    let mut points = curve.points.iter();
    points.all(|point| point.status() == BifurcationStatus::Located)
}

#[test]
fn the_fold_of_a_cusp_is_followed_within_its_error_whichever_parameter_is_first() {
    let plane = (("h", -0.7, 0.7), ("a", 0.2, 1.6));
    let first = curve_of(&swept(CUSP, ""), FOLD, plane, 1.0);
    assert_on(&first, 1e-4, |values| off_the_fold(values, [1.4, 1.4]));
    // At the lower end a = 0.2; at the upper one h = 0.7.
    assert_eq!(ends(&first), [&EndReason::Border(1), &EndReason::Border(0)]);
    let (low, high) = (
        &first.points[0].values,
        &first.points.last().unwrap().values,
    );
    assert!(low[1] == 0.2 && (low[0] - 2.0 * (0.2_f64 / 3.0).powf(1.5)).abs() < 1e-6);
    assert!(high[0] == 0.7 && (high[1] - 3.0 * 0.35_f64.powf(2.0 / 3.0)).abs() < 1e-6);
    assert!(all_located(&first));

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
    let other = "sweep.parameter=a sweep.from=0.5 sweep.to=1.2 system.parameters.h=0.2";
    let other = swept(&CUSP.replace("a = 1.0, ", ""), other);
    let second = curve_of(&other, FOLD, (plane.1, plane.0), 0.2);
    assert_on(&second, 1e-4, |[a, h]| off_the_fold([h, a], [1.4, 1.4]));
    let both =
        [&first, &second].map(|one| one.points.last().unwrap().arclength - one.points[0].arclength);
    assert!((both[0] - both[1]).abs() < 1e-3, "{both:?}");
}

#[test]
fn the_cusp_in_which_two_folds_meet_is_located() {
    let plane = (("h", -0.7, 0.7), ("a", -0.4, 1.0));
    let curve = curve_of(&swept(CUSP, ""), FOLD, plane, 1.0);
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
    let plane = (("u", -1.2, 1.3), ("v", -1.3, 1.2));
    let curve = curve_of(&swept(CIRCLE, ""), SPLIT, plane, 0.3);
    assert_on(&curve, 1e-4, |[u, v]| (u * u + v * v - 1.0) / (2.0 * 2.5));
    assert_eq!(ends(&curve), [&EndReason::Closed]);
    let length = curve.points.last().unwrap().arclength * 2.5;
    assert!(
        (length / std::f64::consts::TAU - 1.0).abs() < 1e-3,
        "{length}"
    );
}

#[test]
fn sweeps_over_one_parameter_lie_in_the_band_of_coulomb_friction() {
    let (sweep, result) = swept(COULOMB, "");
    let plane = Plane::new(("f_c", -0.03, 0.01), ("sigma2", 0.03, 0.07)).unwrap();
    let found = row(&result, SPLIT.0, SPLIT.1);
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
        let (_, result) = swept(COULOMB, &format!("system.parameters.sigma2={sigma2}"));
        let alone = row(&result, SPLIT.0, SPLIT.1);
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
        let (_, result) = swept(COULOMB, &format!("system.parameters.sigma2={sigma2}"));
        let alone = row(&result, SPLIT.0, SPLIT.1);
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
    followed by 46 solves, 17 + 148
    checked by 14 solves, 6 + 159
    ");

    // The kink of y is none where nothing jumps, at any noise; its slope follows from the equations.
    let kink = curve(&sweep, row(&result, "y", "slope at the kink"), &plane, 0.05);
    assert!(kink.points.iter().all(|point| point.values[0].abs() < 1e-9));
    assert!(all_located(&kink));
    assert_eq!(kink.check_work.solves, 0);
    // So does how it changes with both parameters, which takes no solves beside the points.
    let (points, work) = (kink.points.len(), kink.work);
    assert!(work.solves <= points + 2, "{points}: {work:?}");
}

#[test]
fn with_a_linear_spring_friction_at_the_change_is_proportional_to_sigma_from_either_parameter() {
    let linear = COULOMB.replace("mu = 0.05", "mu = 0.0");
    let plane = (("f_c", -0.03, 0.01), ("sigma2", 0.03, 0.07));
    let first = curve_of(&swept(&linear, ""), SPLIT, plane, 0.05);
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
    let other = linear.replace(", sigma2 = 0.05", "");
    let along = "sweep.parameter=sigma2 sweep.from=0.03 sweep.to=0.07";
    let held_there = format!("{along} system.parameters.f_c={}", held[0]);
    let plane = (("sigma2", 0.03, 0.07), ("f_c", -0.03, 0.01));
    let second = curve_of(&swept(&other, &held_there), SPLIT, plane, held[0]);
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
    let swept = swept(RAYLEIGH, "");
    let plane = (("a", -0.02, 0.06), ("sigma2", 0.01, 0.04));
    let split = curve_of(&swept, SPLIT, plane, 0.02);
    let c = split_of_x();
    assert_on(&split, 1e-4, |[a, sigma2]| {
        let exact = c * (0.1 * sigma2).sqrt();
        let slope = 0.5 * exact / sigma2 * 0.03 / 0.08;
        (a - exact) / 0.08 / 1.0_f64.hypot(slope)
    });
    let crater = ("xy", "lower curvature at the centre");
    let plane = (("a", -0.02, 0.06), ("b", 0.05, 0.2));
    let opens = curve_of(&swept, crater, plane, 0.1);
    assert_on(&opens, 1e-4, |[a, _]| a / 0.08);
}

#[test]
fn a_start_outside_of_the_box_and_another_plane_are_refused() {
    let (sweep, result) = swept(CUSP, "");
    let found = row(&result, FOLD.0, FOLD.1);
    let start = CurveStart::from_row(found, 1.0, sweep.problem.subject()).unwrap();
    let never = Cancellation::new();
    let refused = |solved: &Plane, plane: &Plane, start: &CurveStart| {
        let source = sweep.source_in(solved, &never).unwrap();
        let (options, watched) = (CurveOptions::default(), &mut |_: [f64; 2]| ());
        let found = follow(
            &source,
            plane,
            &sweep.detector(),
            start,
            &options,
            &never,
            watched,
        );
        found.unwrap_err()
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
    let (sweep, result) = swept(CUSP, "");
    let found = row(&result, FOLD.0, FOLD.1);
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
    let watched = &mut observer;
    let curve = follow(
        &source,
        &plane,
        &detector,
        &start,
        &options,
        &cancellation,
        watched,
    )
    .unwrap();
    assert!(curve.is_interrupted());
    assert_eq!(curve.points.len(), 5);
}

/// The density of dx = (a x - x³) dt + σ dW splits at a = 0, whatever σ is.
#[test]
fn sampled_curves_hold_the_exact_one_in_their_bands_or_say_that_samples_are_few() {
    let plane = Plane::new(("a", -1.0, 1.0), ("sigma2", 0.3, 0.9)).unwrap();
    let sampled = |method: &str, cells: usize| {
        let text = format!(
            "system.model = \"bistable\"\nsystem.parameters = {{ sigma2 = 0.5 }}\n\
             sweep = {{ parameter = \"a\", from = -1.0, to = 1.0, points = 5 }}\n\
             cells.x = {{ from = -3, to = 3, count = {cells} }}\nmethod = {{ {method} }}\n"
        );
        let start = CurveStart {
            values: [0.0, 0.5],
            observable: 0,
            kind: pbif::topology::IndicatorKind::CURVATURE,
            place: vec![0.0],
        };
        followed(&prepared(&text, ""), &plane, &start, &stepping(0.05))
    };
    for (method, cells) in [
        ("kind = \"sgcm\", samples = 4000", 60),
        ("kind = \"monte-carlo\", error = 0.01", 24),
    ] {
        let curve = sampled(method, cells).unwrap();
        let borders = [&EndReason::Border(1), &EndReason::Border(1)];
        assert_eq!(ends(&curve), borders, "{method}");
        for point in &curve.points {
            let off = 0.5 * point.values[0].abs();
            assert!(
                off <= point.error && point.error < 0.1,
                "{method}: {point:?}"
            );
            // What is known to a tenth of the box is not located.
            assert_eq!(point.status(), BifurcationStatus::Unresolved, "{method}");
            assert!(
                point.parts.sampling > 0.5 * point.error,
                "{method}: {point:?}"
            );
        }
    }
    let few = sampled("kind = \"sgcm\", samples = 32", 60);
    let says = |curve: &Curve| ends(curve) == [&EndReason::Sampling, &EndReason::Sampling];
    match few {
        Ok(curve) => assert!(says(&curve), "{:?}", ends(&curve)),
        Err(error) => assert!(matches!(error, CurveError::TooFewSamples), "{error}"),
    }
}

#[test]
fn the_fold_of_a_joint_density_is_followed_along_that_of_the_force() {
    let plane = (("h", 0.1, 0.6), ("a", 0.7, 1.2));
    let shoulder = ("xy", "slope at the shoulder");
    let curve = curve_of(&swept(TILTED, ""), shoulder, plane, 1.0);
    assert_eq!(ends(&curve), [&EndReason::Border(1), &EndReason::Border(1)]);
    assert_on(&curve, 0.02, |values| off_the_fold(values, [0.5, 0.5]));
    assert!(curve.points.iter().all(|point| point.error < 0.02));
    // On the line a = 1 at h = 2/√27.
    let at_one = &curve.points[curve.start].values;
    assert!((at_one[0] - 0.384_900).abs() < 1e-3, "{at_one:?}");
}
