//! What the page is told of one value of the parameter: how the solve went, and what the detector found. Arrays stand
//! elsewhere.

use serde::Serialize;

use crate::continuation::measure::{DEVIATION, MEAN};
use crate::continuation::{Measure, Point, SolveReport};
use crate::density::{EstimatedDensity, Variants};
use crate::run::finding_in_words;
use crate::system::Family;
use crate::topology::{Detection, Feature, FeatureKind, Verdict};

/// One value of the parameter without its arrays. Numbers are those of `points.csv` and `features.csv`.
#[derive(Debug, Serialize)]
pub(super) struct Frame {
    pub(super) value: f64,
    status: &'static str,
    method: &'static str,
    iterations: usize,
    residual: f64,
    solver_error: f64,
    /// Hellinger distance to the value below.
    distance: Option<f64>,
    seconds: f64,
    /// What must be known of this value, in sentences.
    findings: Vec<String>,
    /// Mean and standard deviation of every axis, and of every quantity that is averaged, then their errors.
    moments: Vec<(f64, f64, Option<f64>, Option<f64>)>,
    /// All other measures: name, value, error, unit.
    measures: Vec<(String, f64, Option<f64>, String)>,
    /// Of every watched density; empty where there is none.
    found: Vec<DetectionMarks>,
}

/// What was found in one density.
#[derive(Debug, Serialize)]
struct DetectionMarks {
    /// Counts in words.
    words: String,
    /// Whether all that the words count was seen.
    seen: bool,
    features: Vec<Mark>,
}

/// A peak, valley, crater or ring that is there, or may be.
#[derive(Debug, Clone, Serialize)]
struct Mark {
    kind: &'static str,
    at: Vec<f64>,
    density: f64,
    persistence: f64,
    certain: bool,
}

impl Frame {
    pub(super) fn new(point: &Point, family: &Family) -> Self {
        let report = &point.report;
        let moments = |name: &str| {
            let names = [&MEAN, &DEVIATION].map(|kind| kind.name(name));
            let [mean, deviation] = names.each_ref().map(|name| report.measure(name));
            let [mean_error, deviation_error] = names.each_ref().map(|name| report.error_of(name));
            Some((mean?, deviation?, mean_error, deviation_error))
        };
        let is_moment = |one: &&Measure| MEAN.has(one) || DEVIATION.has(one);
        let others = report.measures.iter().filter(|one| !is_moment(one));
        let numbers = |one: &Measure| (one.name.clone(), one.value, one.error, one.unit.clone());
        Self {
            value: point.value,
            status: report.status.word(),
            method: report.method,
            iterations: report.iterations,
            residual: report.residual,
            solver_error: report.solver_error,
            distance: point.distance,
            seconds: point.seconds,
            findings: sentences(report, family),
            moments: family.averages().filter_map(moments).collect(),
            measures: others.map(numbers).collect(),
            found: point
                .detections
                .iter()
                .enumerate()
                .map(|(number, detection)| {
                    DetectionMarks::new(detection, point.densities.get(number))
                })
                .collect(),
        }
    }
}

fn sentences(report: &SolveReport, family: &Family) -> Vec<String> {
    let findings = report.findings.iter();
    findings
        .map(|finding| finding_in_words(family, finding))
        .collect()
}

impl DetectionMarks {
    fn new(detection: &Detection, density: Option<&EstimatedDensity>) -> Self {
        let shown = |feature: &&Feature| feature.verdict != Verdict::Absent;
        let features = detection.features.iter().filter(shown);
        let mut features: Vec<Mark> = features.map(Mark::new).collect();
        if let Some(density) = density {
            with_both_saddles(&mut features, density);
        }
        Self {
            words: detection.signature.to_string(),
            seen: detection.is_seen,
            features,
        }
    }
}

/// Adds the mirror images of saddles of a joint density that is symmetric about a centre: of two that are equally high
/// persistence names the one over which pieces join, and not the other, which closes a ring. A saddle in the same cell
/// as a summit is none to the eye, and is left out.
fn with_both_saddles(marks: &mut Vec<Mark>, estimated: &EstimatedDensity) {
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
    let summits: Vec<Vec<f64>> = marks
        .iter()
        .filter(|mark| mark.kind == "peak")
        .map(|mark| mark.at.clone())
        .collect();
    marks.retain(|mark| {
        mark.kind != "valley" || summits.iter().all(|summit| !are_near(summit, &mark.at))
    });
    let Some([x, y]) = estimated.structure.centre.as_deref() else {
        return;
    };
    let saddles = marks.iter().filter(|mark| mark.kind == "valley");
    let images: Vec<Mark> = saddles
        .filter_map(|mark| match mark.at[..] {
            [a, b] => Some(Mark {
                at: vec![2.0 * x - a, 2.0 * y - b],
                ..mark.clone()
            }),
            _ => None,
        })
        .collect();
    for image in images {
        if marks.iter().all(|mark| !are_near(&mark.at, &image.at)) {
            marks.push(image);
        }
    }
}

impl Mark {
    fn new(feature: &Feature) -> Self {
        Self {
            kind: match feature.kind {
                FeatureKind::Peak => "peak",
                FeatureKind::Valley => "valley",
                FeatureKind::Crater => "crater",
                FeatureKind::Ring => "ring",
            },
            at: feature.position.clone(),
            density: feature.density,
            persistence: feature.persistence,
            certain: feature.verdict == Verdict::Present,
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
