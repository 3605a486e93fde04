//! Sweeps with closed-form densities, for tests that need a result but no solver.

use pbif::continuation::{
    BifurcationStatus, CellCheck, Doubt, Label, Located, Point, PointStatus, SolveReport, Subject,
    SweepResult,
};
use pbif::density::{Density, EstimatedDensity, Observable};
use pbif::space::Axis;
use pbif::system::{Family, Path, registry};
use pbif::topology::{Detection, Feature, FeatureErrors, FeatureKind, Signature, Verdict};

fn feature(kind: FeatureKind, position: Vec<f64>, density: f64) -> Feature {
    Feature {
        kind,
        position,
        density,
        persistence: density,
        standard_error: 0.0,
        significance: 10.0,
        verdict: Verdict::Present,
        partner: None,
        errors: FeatureErrors::default(),
    }
}

fn detection(features: Vec<Feature>) -> Detection {
    let count = |kind| {
        features
            .iter()
            .filter(|feature| feature.kind == kind)
            .count()
    };
    Detection {
        indicators: Vec::new(),
        is_seen: true,
        signature: Signature {
            peaks: count(FeatureKind::Peak),
            craters: count(FeatureKind::Crater),
            ..Signature::default()
        },
        features,
    }
}

fn point(value: f64, densities: Vec<EstimatedDensity>, detections: Vec<Detection>) -> Point {
    let status = match densities.is_empty() {
        true => PointStatus::NoSteadyState,
        false => PointStatus::Solved,
    };
    Point {
        value,
        report: SolveReport {
            status,
            ..SolveReport::solved("exact")
        },
        densities,
        detections,
        distance: None,
        seconds: 0.0,
    }
}

fn bifurcation(
    label: &str,
    band: (f64, f64),
    observable: Observable,
    status: BifurcationStatus,
) -> Label {
    let in_doubt = status != BifurcationStatus::Located;
    Label::Bifurcation(Box::new(Located {
        label: label.to_owned(),
        value: 0.5 * (band.0 + band.1),
        error: 0.5 * (band.1 - band.0),
        lower: band.0,
        upper: band.1,
        observable,
        before: Signature::of_peaks(1),
        after: Signature::of_peaks(2),
        zero: None,
        is_several: false,
        doubts: Vec::from_iter(in_doubt.then_some(Doubt::Stored(status))),
    }))
}

/// Scales values to ∫ = 1 and gives them a standard error that grows like their root.
fn estimated(
    observable: Observable,
    axes: Vec<Axis>,
    mut values: Vec<f64>,
    error: f64,
) -> EstimatedDensity {
    let volume = |cell: usize| match &axes[..] {
        [x] => x.width(cell),
        [x, y] => x.width(cell / y.count()) * y.width(cell % y.count()),
        _ => 0.0,
    };
    let mass: f64 = values
        .iter()
        .enumerate()
        .map(|(cell, value)| value * volume(cell))
        .sum();
    values.iter_mut().for_each(|value| *value /= mass);
    let standard_error = values.iter().map(|value| error * value.sqrt()).collect();
    EstimatedDensity {
        observable,
        density: Density { axes, values },
        standard_error,
        variants: pbif::density::Variants::None,
        structure: pbif::density::Structure::default(),
        negligible: pbif::density::NEGLIGIBLE,
        truncation: Default::default(),
    }
}

/// Features of a marginal with one peak, or two at ±`apart` with a valley.
fn marginal_features(apart: Option<f64>) -> Vec<Feature> {
    match apart {
        Some(apart) => vec![
            feature(FeatureKind::Peak, vec![-apart], 1.0),
            feature(FeatureKind::Peak, vec![apart], 1.0),
            feature(FeatureKind::Valley, vec![0.0], 0.5),
        ],
        None => vec![feature(FeatureKind::Peak, vec![0.0], 1.0)],
    }
}

/// dx = (ax - x³) dt + σ dW, σ² = 0.3: p ∝ exp(2/σ² (ax²/2 - x⁴/4)), two peaks at ±√a for a > 0.
pub(crate) fn bistable() -> SweepResult {
    let axis = Axis::uniform(-2.5, 2.5, 100).unwrap();
    let mut values: Vec<f64> = (0..=40).map(|k| -1.0 + 0.05 * f64::from(k)).collect();
    values.extend((1..8).map(|k| 0.1 * 0.5f64.powi(k)));
    values.sort_by(f64::total_cmp);
    let at = |a: f64| {
        if (-0.92..-0.78).contains(&a) {
            return point(a, Vec::new(), Vec::new());
        }
        let p = |x: &f64| (2.0 / 0.3 * (0.5 * a * x * x - 0.25 * x.powi(4))).exp();
        let values = axis.centres().iter().map(p).collect();
        let density = estimated(Observable::Marginal(0), vec![axis.clone()], values, 0.02);
        let features = marginal_features((a > 0.012).then(|| a.sqrt()));
        point(a, vec![density], vec![detection(features)])
    };
    let unresolved = BifurcationStatus::Unresolved;
    SweepResult {
        subject: Subject {
            family: along("bistable", "a", (-1.0, 1.0)),
            observables: vec![Observable::Marginal(0)],
            measures: Vec::new(),
            cell_check: CellCheck::Needless,
        },
        points: values.into_iter().map(at).collect(),
        labels: vec![bifurcation(
            "PB1",
            (-0.05, 0.07),
            Observable::Marginal(0),
            unresolved,
        )],
        checks: None,
        looks: Vec::new(),
        interrupted: false,
    }
}

/// Caughey and Ma: p ∝ exp(-(2/σ²)(-aH + H²/2)), H = (x² + y²)/2, σ² = 0.4: peak, for a > 0 crater.
/// Said to be of `model`, whose parameter is `scale` a. Peaks of the marginals are not exact, they are there to be
/// drawn.
pub(crate) fn rayleigh((model, parameter): (&str, &str), scale: f64, y: &Axis) -> SweepResult {
    let x = Axis::uniform(-3.0, 3.0, 60).unwrap();
    let observables = vec![
        Observable::Marginal(0),
        Observable::Marginal(1),
        Observable::Joint(0, 1),
    ];
    let at = |k: i32| {
        let a = -1.0 + 0.1 * f64::from(k);
        let p = |x: f64, y: f64| {
            let energy = 0.5 * (x * x + y * y);
            (-5.0 * (-a * energy + 0.5 * energy * energy)).exp()
        };
        let (xs, ys) = (x.centres(), y.centres());
        let cells: Vec<f64> = xs
            .iter()
            .flat_map(|&x| ys.iter().map(move |&y| p(x, y)))
            .collect();
        let m = ys.len();
        let along_x = (0..60).map(|i| (0..m).map(|j| cells[i * m + j] * y.width(j)).sum());
        let along_y = (0..m).map(|j| (0..60).map(|i| cells[i * m + j] * x.width(i)).sum());
        let densities = vec![
            estimated(observables[0], vec![x.clone()], along_x.collect(), 0.01),
            estimated(observables[1], vec![y.clone()], along_y.collect(), 0.0),
            estimated(observables[2], vec![x.clone(), y.clone()], cells, 0.0),
        ];
        let one = || {
            detection(marginal_features(
                (a > 0.36).then(|| 1.2 * (a - 0.35).sqrt()),
            ))
        };
        let both = match a > 0.0 {
            true => vec![
                feature(FeatureKind::Peak, vec![(2.0 * a).sqrt(), 0.0], 1.0),
                feature(FeatureKind::Crater, vec![0.0, 0.0], 0.2),
            ],
            false => vec![feature(FeatureKind::Peak, vec![0.0, 0.0], 1.0)],
        };
        point(scale * a, densities, vec![one(), one(), detection(both)])
    };
    let points = (0..=20).map(at).collect();
    let located = |label: &str, a: f64, observable: Observable| {
        bifurcation(
            label,
            ((a - 1e-4) * scale, (a + 1e-4) * scale),
            observable,
            BifurcationStatus::Located,
        )
    };
    let labels = vec![
        located("PB1", 0.0, observables[2]),
        located("PB2", 0.35, observables[0]),
        located("PB3", 0.36, observables[1]),
    ];
    SweepResult {
        subject: Subject {
            family: along(model, parameter, (-scale, scale)),
            observables,
            measures: Vec::new(),
            cell_check: CellCheck::Needless,
        },
        points,
        labels,
        checks: None,
        looks: Vec::new(),
        interrupted: false,
    }
}

/// A family of a model along one of its parameters, all others one half.
fn along(model: &str, parameter: &str, (from, to): (f64, f64)) -> Family {
    let model = registry::find(model).unwrap();
    let others = model.parameters.clone().into_iter();
    let others = others.filter(|other| other.name != parameter);
    let others: Vec<String> = others.map(|other| other.name).collect();
    let fixed: Vec<(&str, f64)> = others.iter().map(|name| (name.as_str(), 0.5)).collect();
    Family::new(model, &fixed, Path::parameter(parameter, from, to)).unwrap()
}

pub(crate) fn uniform() -> Axis {
    Axis::uniform(-3.0, 3.0, 60).unwrap()
}
