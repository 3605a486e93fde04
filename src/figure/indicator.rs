//! The indicators of an observable over the parameter, with their errors and the line of zero that a bifurcation
//! crosses: a panel an indicator.

use crate::topology::{Indicator, IndicatorKind};

use super::along::{self, Curve, Track};
use super::canvas::DrawError;
use super::canvas::page::Page;
use super::canvas::style::Stroke;
use super::names;
use super::sketch::{Sketch, SweepScene};
use super::told::Shows;

/// Height of a panel, in pixels.
const HEIGHT: f64 = 170.0;
/// Errors of sampling are drawn this many standard errors long.
const ERRORS: f64 = 2.0;

/// A figure an observable that has a centre of symmetry.
pub(super) fn sketches<'a>(scene: &'a SweepScene<'a>) -> Vec<Sketch<'a>> {
    let observables = scene.result.subject.observables.iter().enumerate();
    observables
        .map(|(number, &observable)| {
            let name = format!("indicator_{}", names::file(scene.family(), observable));
            Sketch::new(name, move || draw(scene, number)).showing(Shows::Indicators(number))
        })
        .collect()
}

/// The figure; `None` without indicators.
fn draw(scene: &SweepScene<'_>, number: usize) -> Result<Option<Page>, DrawError> {
    let watched = scene.result.subject.observables[number];
    let mut kinds: Vec<IndicatorKind> = Vec::new();
    let all = || {
        scene.result.points.iter().filter_map(|point| {
            let detection = point.detections.get(number)?;
            Some((point.value, &detection.indicators))
        })
    };
    for indicator in all().flat_map(|(_, indicators)| indicators) {
        if !kinds.contains(&indicator.kind) {
            kinds.push(indicator.kind);
        }
    }
    let error = |one: &Indicator| one.systematic_error + ERRORS * one.sampling_error;
    let tracks: Vec<Track> = kinds
        .iter()
        .enumerate()
        .map(|(place, &kind)| {
            let own = all().filter_map(|(value, indicators)| {
                let indicator = indicators.iter().find(|one| one.kind == kind)?;
                Some((value, indicator))
            });
            let (places, errors) = own
                .filter(|(_, one)| one.value.is_finite())
                .map(|(value, one)| ((value, one.value), error(one)))
                .unzip();
            Track {
                title: kind.title().to_owned(),
                is_logarithmic: false,
                has_zero: true,
                least: 0.0,
                share: 1.0,
                curves: vec![Curve {
                    name: kind.name().to_owned(),
                    stroke: Stroke::curve(place),
                    places,
                    errors,
                }],
            }
        })
        .collect();
    along::draw(scene, Some(watched), &tracks, HEIGHT)
}
