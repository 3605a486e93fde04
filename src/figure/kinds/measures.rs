//! Measures along the sweep, the numbers of a solved value, each with the band of its error: all below each other
//! (`measures`), or one by its name (`measures_sd_x`). What is zero all along is left out.

use super::{Drawn, Kind, Sketch};
use crate::continuation::SweepResult;
use crate::figure::canvas::style::Stroke;
use crate::figure::canvas::symbols;
use crate::figure::figures::Print;
use crate::figure::parts::along::{self, Curve, Track};
use crate::figure::parts::table::{self, number};

/// Height of a panel among others, and of one by itself, in pixels.
const AMONG: f64 = 92.0;
const SINGLE: f64 = 190.0;
/// Differences of less than this share of the largest measure of the same unit are rounding.
const ROUNDING: f64 = 1e-9;
/// A panel is as high as so many of the largest error, so that its band is seen whole.
const ERRORS: f64 = 2.4;

/// A sheet of all measures, then one figure each.
pub(super) const KIND: Kind = Kind {
    names: &["measures"],
    is_usual: false,
    sketches: |sweep| {
        let (result, all) = (sweep.result, measures(sweep.result));
        let singles = all.clone().into_iter().map(|one| {
            let name = format!("measures_{}", one.name);
            Sketch::new(name, move |print| {
                draw(result, std::slice::from_ref(&one), (SINGLE, print))
            })
        });
        let singles: Vec<Sketch<'_>> = singles.collect();
        let sheet = Sketch::new("measures", move |print| draw(result, &all, (AMONG, print)));
        std::iter::once(sheet).chain(singles).collect()
    },
};

/// A measure along the sweep.
#[derive(Clone)]
struct Along {
    name: String,
    unit: String,
    /// Parameter, value and error, which is zero where none is known.
    values: Vec<(f64, f64, f64)>,
    /// A range is no shorter: what differs by less is rounding.
    least: f64,
}

impl Along {
    fn largest(&self) -> f64 {
        let sizes = self.values.iter().map(|(_, value, _)| value.abs());
        sizes.fold(0.0, f64::max)
    }
}

/// The measures that are not zero all along, in the order in which the points have them.
fn measures(result: &SweepResult) -> Vec<Along> {
    let mut found: Vec<Along> = Vec::new();
    for point in &result.points {
        for one in point
            .report
            .measures
            .iter()
            .filter(|one| one.value.is_finite())
        {
            let value = (point.value, one.value, one.error.unwrap_or(0.0));
            match found.iter_mut().find(|known| known.name == one.name) {
                Some(known) => known.values.push(value),
                None => found.push(Along {
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
        found[number].least = ROUNDING * alike.map(Along::largest).fold(0.0, f64::max);
    }
    found
}

/// A panel each; `None` without a measure.
fn draw(result: &SweepResult, all: &[Along], (height, print): (f64, &Print<'_>)) -> Drawn {
    let track = |one: &Along| {
        let values = one.values.iter();
        let unit = if one.unit == "1" {
            String::new()
        } else {
            format!(" [{}]", one.unit)
        };
        let errors: Vec<f64> = values.clone().map(|(_, _, error)| *error).collect();
        Track {
            title: symbols::plain(&format!("{}{unit}", one.name)),
            is_logarithmic: false,
            has_zero: false,
            least: errors
                .iter()
                .fold(one.least, |least, error| least.max(ERRORS * error)),
            share: 1.0,
            curves: vec![Curve {
                name: String::new(),
                stroke: Stroke::curve(0),
                places: values.map(|(at, value, _)| (*at, *value)).collect(),
                errors,
            }],
        }
    };
    let tracks: Vec<Track> = all.iter().map(track).collect();
    let names: Vec<&str> = all.iter().map(|one| one.name.as_str()).collect();
    let parameter = result.subject.family.parameter();
    let seen = format!(
        "Measures of the steady state over {parameter}, each with the band of its error: {}.",
        names.join(", ")
    );
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
