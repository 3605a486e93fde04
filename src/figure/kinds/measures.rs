//! Measures along the sweep, the numbers of the process at each value, each with the band of its error: all below each
//! other (`measures`), or one by its name (`measures_sd_x`). What is zero all along is left out.

use super::{Drawn, Kind, Sketch, survival};
use crate::continuation::measure::{
    EDGE_MASS, ESCAPE_RATE, FACTORISATIONS, MAP_STEP, NEGATIVE_MASS, NUMERICAL_DIFFUSION,
};
use crate::continuation::{Label, LevelCrossing, Measure, MeasureKind, SweepResult};
use crate::figure::canvas::style::{FRAME_LINE, GREY, Stroke};
use crate::figure::parts::along;
use crate::figure::parts::caption;
use crate::figure::parts::measure_names::Named;
use crate::figure::parts::table::{self, number};
use crate::figure::parts::track::{Curve, Track};
use crate::figure::print::Print;

/// Height of a panel among others, and of one by itself, in pixels.
const AMONG: f64 = 92.0;
const SINGLE: f64 = 190.0;
/// Differences of less than this share of the largest measure of the same unit are rounding.
const ROUNDING: f64 = 1e-9;
/// A panel is as high as so many of the largest error, so that its band is seen whole.
const ERRORS: f64 = 2.4;
/// A measure that grows by more than this has a logarithmic axis.
const DECADES: f64 = 50.0;
/// Dashes of a level, and of the line from where it is crossed.
const LEVEL: &[f64] = &[6.0, 3.0];
const DROP: &[f64] = &[1.5, 2.0];

/// A sheet of all measures, then one figure each.
pub(super) const KIND: Kind = Kind {
    names: &["measures"],
    usual: None,
    sketches: |sweep| {
        let (result, all) = (sweep.result, measures(sweep.result));
        let singles = all.clone().into_iter().map(|one| {
            let name = format!("measures_{}", one.name);
            Sketch::new(name, move |print| {
                draw(result, std::slice::from_ref(&one), (SINGLE, print))
            })
        });
        let singles: Vec<Sketch<'_>> = singles.collect();
        // A survival curve is no panel of many numbers.
        let family = sweep.family();
        let is_on_sheet = |one: &MeasureSeries| {
            let levels = &family.questions.levels;
            !survival::shows(family, &one.name)
                || levels.iter().any(|level| level.measure == one.name)
        };
        let all: Vec<MeasureSeries> = all.into_iter().filter(is_on_sheet).collect();
        let sheet = Sketch::new("measures", move |print| draw(result, &all, (AMONG, print)));
        std::iter::once(sheet).chain(singles).collect()
    },
};

/// A measure along the sweep.
#[derive(Clone)]
struct MeasureSeries {
    name: String,
    unit: String,
    /// Parameter, value and error, which is not a number where none is known.
    values: Vec<(f64, f64, f64)>,
    /// A range is no shorter: what differs by less is rounding.
    least: f64,
}

impl MeasureSeries {
    /// Whether it is known to be positive, and changes by more than a linear axis shows.
    fn is_over_decades(&self) -> bool {
        // Where no error is known the value itself is to be positive.
        let is_positive = self
            .values
            .iter()
            .all(|(_, value, error)| *value > error.max(0.0));
        let values = self.values.iter().map(|(_, value, _)| *value);
        let least = values.fold(f64::INFINITY, f64::min);
        is_positive && self.largest() > DECADES * least
    }

    fn largest(&self) -> f64 {
        let sizes = self.values.iter().map(|(_, value, _)| value.abs());
        sizes.fold(0.0, f64::max)
    }
}

/// What tells of cells and solvers instead of the process: `health` and tables have it.
const OF_SOLVERS: [MeasureKind; 6] = [
    ESCAPE_RATE,
    NEGATIVE_MASS,
    EDGE_MASS,
    MAP_STEP,
    FACTORISATIONS,
    NUMERICAL_DIFFUSION,
];

/// The measures of the process that are not zero all along, in the order in which the points have them; others where
/// levels of them are asked for.
fn measures(result: &SweepResult) -> Vec<MeasureSeries> {
    let levels = &result.subject.family.questions.levels;
    let is_of_solver = |one: &Measure| {
        OF_SOLVERS.iter().any(|kind| kind.has(one))
            && levels.iter().all(|level| level.measure != one.name)
    };
    let mut found: Vec<MeasureSeries> = Vec::new();
    for point in &result.points {
        let shown = point.report.measures.iter();
        for one in shown.filter(|one| one.value.is_finite() && !is_of_solver(one)) {
            let value = (point.value, one.value, one.error.unwrap_or(f64::NAN));
            match found.iter_mut().find(|known| known.name == one.name) {
                Some(known) => known.values.push(value),
                None => found.push(MeasureSeries {
                    name: one.name.clone(),
                    unit: one.unit.clone(),
                    values: vec![value],
                    least: 0.0,
                }),
            }
        }
    }
    found.retain(|one| one.largest() > 0.0);
    for number in 0..found.len() {
        let unit = &found[number].unit;
        let alike = found.iter().filter(|one| one.unit == *unit && unit != "1");
        found[number].least = ROUNDING * alike.map(MeasureSeries::largest).fold(0.0, f64::max);
    }
    found
}

fn crossings(result: &SweepResult) -> impl Iterator<Item = &LevelCrossing> {
    result.labels.iter().filter_map(|row| match row {
        Label::Level(crossing) => Some(&**crossing),
        _ => None,
    })
}

/// Lines at the levels of a measure, and down to the parameter's values at which they are crossed.
fn levels(result: &SweepResult, measure: &MeasureSeries) -> Vec<Curve> {
    let at = |end: Option<&(f64, f64, f64)>| end.map_or(0.0, |place| place.0);
    let (from, to) = (at(measure.values.first()), at(measure.values.last()));
    let values = measure.values.iter().map(|(_, value, _)| *value);
    let least = values.fold(f64::INFINITY, f64::min);
    let line = |name: String, dash: &'static [f64], places: [(f64, f64); 2]| Curve {
        name,
        stroke: Stroke::solid(GREY, FRAME_LINE).dashed(dash),
        places: places.to_vec(),
        errors: Vec::new(),
    };
    let asked = result.subject.family.questions.levels.iter();
    let own = asked.filter(|one| one.measure == measure.name);
    let lines = own.map(|one| {
        let name = format!("level {}", number(one.level));
        line(name, LEVEL, [(from, one.level), (to, one.level)])
    });
    let of_measure = crossings(result).filter(|one| one.asked.measure == measure.name);
    let drops = of_measure.map(|one| {
        let places = [(one.value, one.asked.level), (one.value, least)];
        line(String::new(), DROP, places)
    });
    lines.chain(drops).collect()
}

/// A panel each; `None` without a measure.
fn draw(result: &SweepResult, all: &[MeasureSeries], (height, print): (f64, &Print<'_>)) -> Drawn {
    let named = Named::new(&result.subject.family, &result.subject.observables);
    let track = |one: &MeasureSeries| {
        let values = one.values.iter();
        let errors: Vec<f64> = values.clone().map(|(_, _, error)| *error).collect();
        let mut curves = vec![Curve {
            name: String::new(),
            stroke: Stroke::curve(0),
            places: values.map(|(at, value, _)| (*at, *value)).collect(),
            errors: errors.clone(),
        }];
        curves.extend(levels(result, one));
        Track {
            title: named.title(&one.name) + &named.unit(&one.unit),
            is_logarithmic: one.is_over_decades(),
            has_zero: false,
            least: errors
                .iter()
                .fold(one.least, |least, error| least.max(ERRORS * error)),
            share: 1.0,
            curves,
        }
    };
    let tracks: Vec<Track> = all.iter().map(track).collect();
    let names: Vec<&str> = all.iter().map(|one| one.name.as_str()).collect();
    let in_words = |name: &str| caption::in_letters(&named.title(name));
    let words: Vec<String> = names.iter().map(|name| in_words(name)).collect();
    let parameter = result.subject.family.parameter();
    let symbol = caption::parameter(&result.subject.family);
    let mut seen = format!(
        "Measures of the steady state over {symbol}, each with the band of its error: {}.",
        words.join(", ")
    );
    for crossing in crossings(result).filter(|one| names.contains(&one.asked.measure.as_str())) {
        let way = if crossing.rises { "rises" } else { "falls" };
        let (value, error) = (crossing.value, crossing.error);
        let value = caption::to_digits_of_error(value, error);
        let measure = in_words(&crossing.asked.measure);
        let level = number(crossing.asked.level);
        let label = &crossing.label;
        seen += &format!(
            " {label}: {measure} {way} through {level} at {symbol} = {value} ± {error:.1e}."
        );
    }
    let rows = all.iter().flat_map(|one| {
        one.values.iter().map(|&(at, value, error)| {
            let [at, value, error] = [at, value, error].map(number);
            vec![at, one.name.clone(), value, error, one.unit.clone()]
        })
    });
    let columns = [parameter, "measure", "value", "error", "unit"];
    let texts = (seen, table::table(&columns, rows));
    along::draw((result, print), None, (&tracks, height), texts)
}
