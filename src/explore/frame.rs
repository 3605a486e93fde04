//! What the page is told of one value of the parameter: how the solve went, and what the detector found. Arrays stand
//! elsewhere.

use serde_json::{Value, json};

use crate::continuation::measure::{DEVIATION, MEAN};
use crate::continuation::{Measure, Point};
use crate::density::{EstimatedDensity, Variants};
use crate::run::finding_in_words;
use crate::system::Family;
use crate::topology::{Detection, Feature, FeatureKind, Verdict};

/// One value of the parameter without its arrays. Numbers are those of `points.csv` and `features.csv`; `distance` is
/// Hellinger's to the value below.
pub(super) fn frame(point: &Point, family: &Family) -> Value {
    let report = &point.report;
    // Mean and standard deviation of every axis, and of every quantity that is averaged, then their errors.
    let moments = |name: &str| {
        let names = [&MEAN, &DEVIATION].map(|kind| kind.name(name));
        let [mean, deviation] = names.each_ref().map(|name| report.measure(name));
        let [mean_error, deviation_error] = names.each_ref().map(|name| report.error_of(name));
        Some(json!([mean?, deviation?, mean_error, deviation_error]))
    };
    let is_moment = |one: &&Measure| MEAN.has(one) || DEVIATION.has(one);
    let others = report.measures.iter().filter(|one| !is_moment(one));
    let numbers = |one: &Measure| json!([one.name, one.value, one.error, one.unit]);
    let findings = report.findings.iter();
    let findings = findings.map(|finding| finding_in_words(family, finding));
    let detections = point.detections.iter().enumerate();
    let found = detections.map(|(number, one)| marks(one, point.densities.get(number)));
    json!({
        "value": point.value,
        "status": report.status.word(),
        "method": report.method,
        "iterations": report.iterations,
        "residual": report.residual,
        "solver_error": report.solver_error,
        "distance": point.distance,
        "seconds": point.seconds,
        "findings": findings.collect::<Vec<_>>(),
        "moments": family.averages().filter_map(moments).collect::<Vec<_>>(),
        "measures": others.map(numbers).collect::<Vec<_>>(),
        "found": found.collect::<Vec<_>>(),
    })
}

/// What was found in one density: the counts in words, whether all that they count was seen, and the features that are
/// there, or may be.
fn marks(detection: &Detection, density: Option<&EstimatedDensity>) -> Value {
    let features = detection.features.iter();
    let shown = features.filter(|feature| feature.verdict != Verdict::Absent);
    let mut shown: Vec<Feature> = shown.cloned().collect();
    if let Some(density) = density {
        with_both_saddles(&mut shown, density);
    }
    let features = shown.iter().map(|feature| {
        json!({
            "kind": match feature.kind {
                FeatureKind::Peak => "peak",
                FeatureKind::Valley => "valley",
                FeatureKind::Crater => "crater",
                FeatureKind::Ring => "ring",
            },
            "at": feature.position,
            "density": feature.density,
            "persistence": feature.persistence,
            "certain": feature.verdict == Verdict::Present,
        })
    });
    json!({
        "words": detection.signature.to_string(),
        "seen": detection.is_seen,
        "features": features.collect::<Vec<_>>(),
    })
}

/// Adds the mirror images of saddles of a joint density that is symmetric about a centre: of two that are equally high
/// persistence names the one over which pieces join, and not the other, which closes a ring. A saddle in the same cell
/// as a summit is none to the eye, and is left out.
fn with_both_saddles(features: &mut Vec<Feature>, estimated: &EstimatedDensity) {
    let [across, along] = &estimated.density.axes[..] else {
        return;
    };
    let cell = |at: &[f64]| match at {
        [x, y] => across.find(*x).zip(along.find(*y)),
        _ => None,
    };
    let are_near = |a: &[f64], b: &[f64]| match (cell(a), cell(b)) {
        (Some(a), Some(b)) => a.0.abs_diff(b.0) <= 1 && a.1.abs_diff(b.1) <= 1,
        _ => true,
    };
    let peaks = features.iter().filter(|one| one.kind == FeatureKind::Peak);
    let summits: Vec<Vec<f64>> = peaks.map(|one| one.position.clone()).collect();
    features.retain(|one| {
        let is_free = |summit: &Vec<f64>| !are_near(summit, &one.position);
        one.kind != FeatureKind::Valley || summits.iter().all(is_free)
    });
    let Some([x, y]) = estimated.structure.centre.as_deref() else {
        return;
    };
    let saddles = features
        .iter()
        .filter(|one| one.kind == FeatureKind::Valley);
    let images = saddles.filter_map(|one| match one.position[..] {
        [a, b] => Some(Feature {
            position: vec![2.0 * x - a, 2.0 * y - b],
            ..one.clone()
        }),
        _ => None,
    });
    for image in images.collect::<Vec<_>>() {
        if features
            .iter()
            .all(|one| !are_near(&one.position, &image.position))
        {
            features.push(image);
        }
    }
}

/// Half-width of the band that is drawn around a density, one value a cell, and what it is in words: two standard
/// errors of sampling, or what a second discretisation differs by; nothing where the method states neither.
pub(super) fn band(density: &EstimatedDensity) -> Option<(Vec<f64>, &'static str)> {
    if density.is_noisy() {
        let twice = density.standard_error.iter().map(|error| 2.0 * error);
        return Some((twice.collect(), "± 2 standard errors of sampling"));
    }
    let Variants::Scheme(second) = &density.variants else {
        return None;
    };
    let values = density.density.values.iter().zip(second);
    let difference = values.enumerate();
    let difference =
        difference.map(|(cell, (value, second))| (value - second).abs() + density.truncated(cell));
    Some((
        difference.collect(),
        "± the difference to a second discretisation on the same cells, and what open ends may change",
    ))
}
