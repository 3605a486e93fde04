//! The peak diagram of a marginal: where its peaks and valleys lie, and how high they are, over the parameter.

use crate::density::Observable;
use crate::topology::FeatureKind;

use super::along::{self, Curve, Track};
use super::branches::{Branch, branches};
use super::canvas::DrawError;
use super::canvas::page::Page;
use super::canvas::style::Stroke;
use super::sketch::{Sketch, SweepScene};
use super::told::Shows;
use super::{names, select};

/// Height of a panel, in pixels.
const HEIGHT: f64 = 170.0;
/// Heights that differ by more than this factor are drawn on a logarithmic axis.
const LOGARITHMIC: f64 = 30.0;

/// The range of places as a share of where the density is, at least: a peak that stays where it is moves by rounding
/// alone.
const LEAST: f64 = 0.02;

/// A peak diagram an observed marginal.
pub(super) fn sketches<'a>(scene: &'a SweepScene<'a>) -> Vec<Sketch<'a>> {
    let observables = scene.result.subject.observables.iter().enumerate();
    observables
        .filter(|(_, observable)| matches!(observable, Observable::Marginal(_)))
        .map(|(number, &observable)| {
            let name = format!("peaks_{}", names::file(scene.family(), observable));
            Sketch::new(name, move || draw(scene, number)).showing(Shows::Peaks(number))
        })
        .collect()
}

/// The figure; `None` without a peak.
fn draw(scene: &SweepScene<'_>, number: usize) -> Result<Option<Page>, DrawError> {
    let result = scene.result;
    let watched = result.subject.observables[number];
    let Observable::Marginal(axis) = watched else {
        return Ok(None);
    };
    let densities = result.points.iter();
    let densities: Vec<_> = densities
        .filter_map(|point| Some(&select::density(point, number)?.density))
        .collect();
    let Some(window) = select::window(&densities, 0) else {
        return Ok(None);
    };
    let kinds = [
        (FeatureKind::Peak, "peak", 0),
        (FeatureKind::Valley, "valley", 1),
    ];
    let (mut places, mut heights) = (Vec::new(), Vec::new());
    for (kind, name, colour) in kinds {
        for branch in branches(&result.points, number, kind, window) {
            let curve = |places: Vec<(f64, f64)>| Curve {
                name: name.to_owned(),
                stroke: Stroke::curve(colour),
                places,
                errors: Vec::new(),
            };
            heights.push(curve(heights_of(scene, number, &branch)));
            places.push(curve(branch.places));
        }
    }
    let values = heights
        .iter()
        .flat_map(|curve| &curve.places)
        .map(|place| place.1);
    let (low, high) = values.fold((f64::INFINITY, 0.0), |(low, high), value: f64| {
        (f64::min(low, value), f64::max(high, value))
    });
    let family = scene.family();
    let track = |title: String, curves: Vec<Curve>, is_logarithmic: bool, least: f64| Track {
        title,
        is_logarithmic,
        has_zero: false,
        least,
        share: 1.0,
        curves,
    };
    let is_logarithmic = low > 0.0 && high > LOGARITHMIC * low;
    let tracks = [
        track(
            names::axis(family, axis),
            places,
            false,
            LEAST * (window.1 - window.0),
        ),
        track(
            names::density(family, watched),
            heights,
            is_logarithmic,
            0.0,
        ),
    ];
    along::draw(scene, Some(watched), &tracks, HEIGHT)
}

/// The densities at the places of a branch.
fn heights_of(scene: &SweepScene<'_>, number: usize, branch: &Branch) -> Vec<(f64, f64)> {
    let height = |&(value, position): &(f64, f64)| {
        let point = scene
            .result
            .points
            .iter()
            .find(|point| point.value == value)?;
        let features = point.detections.get(number)?.features.iter();
        let mut own = features.filter(|one| one.kind == branch.kind);
        let feature = own.find(|one| one.position.first() == Some(&position))?;
        Some((value, feature.density))
    };
    branch.places.iter().filter_map(height).collect()
}
