//! The indicators of an observable over the parameter, with their errors and the line of zero that a bifurcation
//! crosses: a panel an indicator.

use crate::topology::{Indicator, IndicatorKind};

use super::{Drawn, Kind};
use crate::continuation::SweepResult;
use crate::figure::canvas::style::Stroke;
use crate::figure::parts::along;
use crate::figure::parts::caption;
use crate::figure::parts::table::{self, number as number_of};
use crate::figure::parts::track::{Curve, Track};
use crate::figure::print::Print;

/// Height of a panel, in pixels.
const HEIGHT: f64 = 170.0;
/// Errors of sampling are drawn this many standard errors long.
const ERRORS: f64 = 2.0;

/// A figure an observable that has a centre of symmetry.
pub(super) const KIND: Kind = Kind {
    names: &["indicator"],
    usual: None,
    sketches: |sweep| sweep.of_observables("indicator", draw),
};

/// The figure; `None` without indicators.
fn draw(result: &SweepResult, number: usize, print: &Print<'_>) -> Drawn {
    let (family, watched) = (&result.subject.family, result.subject.observables[number]);
    let mut kinds: Vec<IndicatorKind> = Vec::new();
    let all = || {
        let points = along::detections(result, number);
        points.map(|(value, detection)| (value, &detection.indicators))
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
                title: kind.traits().title.to_owned(),
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
    let seen = format!(
        "Indicators of P-bifurcations of the steady-state density {} over {}; a P-bifurcation is where one is zero and the features that are counted change, bands are \
         systematic errors and two standard errors of sampling.",
        caption::density(family, watched),
        caption::parameter(family)
    );
    let own = all().flat_map(|(value, all)| all.iter().map(move |one| (value, one)));
    let rows = own.map(|(value, one)| {
        let errors = [one.systematic_error, one.sampling_error].map(number_of);
        let (value, name) = (number_of(value), one.kind.name().to_owned());
        [vec![value, name, number_of(one.value)], errors.to_vec()].concat()
    });
    let parameter = family.parameter();
    let columns = [
        parameter,
        "indicator",
        "value",
        "systematic_error",
        "sampling_error",
    ];
    let table = table::table(&columns, rows);
    let texts = (seen, table);
    along::draw((result, print), Some(watched), (&tracks, HEIGHT), texts)
}
