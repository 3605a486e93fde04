//! The health of a sweep: what is left of the equation, what leaves the domain, negative masses, and how far
//! neighbouring densities are apart, over the parameter. What is zero all along is left out.

use crate::continuation::{Point, PointStatus, SweepResult};

use super::{Drawn, Kind, Sketch};
use crate::figure::canvas::style::Stroke;
use crate::figure::parts::along;
use crate::figure::parts::caption;
use crate::figure::parts::table::{self, number as number_of};
use crate::figure::parts::track::{Curve, Track};
use crate::figure::print::Print;

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
        point.report.measure("escape_rate").or(Some(0.0))
    }),
    ("negative mass", true, |point| {
        point.report.measure("negative_mass").or(Some(0.0))
    }),
    ("edge mass", true, |point| {
        point.report.edge_mass().or(Some(0.0))
    }),
    (DISTANCE, false, |point| point.distance),
];

/// The distance to the density before, as it is drawn and as the table has it.
const DISTANCE: &str = "distance a step";

/// The steps of the parameter along a sweep.
struct Steps {
    values: Vec<f64>,
    /// Their median.
    usual: f64,
}

impl Steps {
    fn new(result: &SweepResult) -> Self {
        let values: Vec<f64> = result.points.iter().map(|point| point.value).collect();
        let mut steps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
        steps.sort_by(f64::total_cmp);
        let usual = steps.get(steps.len() / 2).copied();
        Self {
            values,
            usual: usual.unwrap_or(1.0),
        }
    }

    /// The step to a point.
    fn before(&self, point: &Point) -> f64 {
        let number = self.values.partition_point(|value| *value < point.value);
        let before = number.checked_sub(1).map(|before| self.values[before]);
        before.map_or(self.usual, |before| point.value - before)
    }
}

/// The figure of a sweep.
pub(super) const KIND: Kind = Kind {
    names: &["health"],
    usual: None,
    sketches: |sweep| {
        let result = sweep.result;
        vec![Sketch::new("health", move |print| draw(result, print))]
    },
};

/// Whether a point has a density to speak of.
fn is_solved(point: &Point) -> bool {
    !matches!(
        point.report.status,
        PointStatus::NoSteadyState | PointStatus::SeveralClasses
    )
}

/// The figure; `None` where there is nothing to tell.
fn draw(result: &SweepResult, print: &Print<'_>) -> Drawn {
    let steps = Steps::new(result);
    // Values that were added lie nearer to each other, and so do their densities.
    let per_step = |point: &Point, title: &str| match title {
        DISTANCE => steps.usual / steps.before(point),
        _ => 1.0,
    };
    let track = |(title, is_logarithmic, number): &Number| {
        let points = result.points.iter().filter(|point| is_solved(point));
        let places: Vec<(f64, f64)> = points
            .filter_map(|point| Some((point.value, number(point)? * per_step(point, title))))
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
    let parameter = result.subject.family.parameter();
    let seen = format!(
        "How well each value of {} was solved: what is left of the equation, what leaves the domain, and the Hellinger \
         distance between neighbouring densities, times the usual step of the parameter over the one between them.",
        caption::parameter(&result.subject.family)
    );
    let columns = NUMBERS.map(|(title, ..)| title.replace(' ', "_"));
    let columns: Vec<&str> = [parameter, "status"]
        .into_iter()
        .chain(columns.iter().map(String::as_str))
        .collect();
    let rows = result.points.iter().map(|point| {
        let named = [
            number_of(point.value),
            point.report.status.word().to_owned(),
        ];
        // Mass at an edge that is below zero by rounding is none.
        let numbers = NUMBERS.map(|(title, _, number)| match number(point) {
            Some(mass) if title == "edge mass" => Some(number_of(mass.max(0.0))),
            other => other.map(|value| number_of(value * per_step(point, title))),
        });
        let numbers = numbers.into_iter().map(Option::unwrap_or_default);
        named.into_iter().chain(numbers).collect()
    });
    let table = table::table(&columns, rows);
    let texts = (seen, table);
    along::draw((result, print), None, (&tracks, HEIGHT), texts)
}
