//! The health of a sweep: what is left of the equation, what leaves the domain, negative masses, and how far
//! neighbouring densities are apart, over the parameter. What is zero all along is left out.

use crate::continuation::{Point, PointStatus};

use super::along::{self, Curve, Track};
use super::canvas::DrawError;
use super::canvas::page::Page;
use super::canvas::style::Stroke;
use super::sketch::{Sketch, SweepScene};
use super::told::Shows;

/// Height of a panel, in pixels.
const HEIGHT: f64 = 92.0;

/// A number of a point: title, whether decades matter, and how it is got.
type Number = (&'static str, bool, fn(&Point) -> Option<f64>);

/// The numbers of a point that tell how well it was solved.
const NUMBERS: [Number; 6] = [
    ("residual", true, |point| Some(point.report.residual)),
    ("solver error", true, |point| {
        Some(point.report.solver_error)
    }),
    ("escape rate", true, |point| {
        point.report.measure("escape_rate")
    }),
    ("negative mass", true, |point| {
        point.report.measure("negative_mass")
    }),
    ("edge mass", true, |point| point.report.edge_mass()),
    ("distance", false, |point| point.distance),
];

/// The figure of a sweep.
pub(super) fn sketches<'a>(scene: &'a SweepScene<'a>) -> Vec<Sketch<'a>> {
    vec![Sketch::new("health", || draw(scene)).showing(Shows::Health)]
}

/// Whether a point has a density to speak of.
fn is_solved(point: &Point) -> bool {
    !matches!(
        point.report.status,
        PointStatus::NoSteadyState | PointStatus::SeveralClasses
    )
}

/// The figure; `None` where there is nothing to tell.
fn draw(scene: &SweepScene<'_>) -> Result<Option<Page>, DrawError> {
    let track = |(title, is_logarithmic, number): &Number| {
        let points = scene.result.points.iter().filter(|point| is_solved(point));
        let places: Vec<(f64, f64)> = points
            .filter_map(|point| Some((point.value, number(point)?)))
            // Zero has no place on a logarithmic axis.
            .filter(|(_, value)| value.is_finite() && !(*is_logarithmic && *value == 0.0))
            .collect();
        let is_told = places.iter().any(|(_, value)| *value != 0.0);
        is_told.then(|| Track {
            title: (*title).to_owned(),
            is_logarithmic: *is_logarithmic,
            has_zero: !is_logarithmic,
            least: 0.0,
            share: 1.0,
            curves: vec![Curve {
                name: String::new(),
                stroke: Stroke::curve(0),
                places,
                errors: Vec::new(),
            }],
        })
    };
    let tracks: Vec<Track> = NUMBERS.iter().filter_map(track).collect();
    along::draw(scene, None, &tracks, HEIGHT)
}
