//! The probability that a passage still goes on over the time, at several parameter values, each with the band of its
//! error (`survival_safe`): the reliability of a structure, where a passage of at least three times is asked for.

use super::spectrum::{Chart, Line};
use super::{Drawn, Kind, Sketch, Sweep};
use crate::continuation::measure::PASSAGE_SURVIVAL;
use crate::continuation::{Point, SweepResult};
use crate::figure::canvas::symbols;
use crate::figure::parts::caption;
use crate::figure::print::Print;
use crate::system::{Family, PassageQuestion};

/// Fewer times are no curve.
const LEAST: usize = 3;

/// A figure of each passage with enough times.
pub(super) const KIND: Kind = Kind {
    names: &["survival"],
    usual: Some("survival"),
    sketches,
};

fn sketches<'a>(sweep: &Sweep<'a>) -> Vec<Sketch<'a>> {
    let passages = sweep.family().questions.passages.iter();
    let curves = passages.filter(|one| one.times.len() >= LEAST);
    let figures = curves.map(|passage| {
        let (result, chosen) = (sweep.result, sweep.chosen.clone());
        let name = format!("survival_{}", passage.name);
        Sketch::new(name, move |print| draw(result, &chosen, passage, print))
    });
    figures.collect()
}

/// Whether a measure is a probability that a figure of this kind shows.
pub(super) fn shows(family: &Family, measure: &str) -> bool {
    let passages = family.questions.passages.iter();
    let mut curves = passages.filter(|one| one.times.len() >= LEAST);
    let is_of = |passage: &PassageQuestion| {
        passage
            .times
            .iter()
            .any(|time| of(passage, *time) == measure)
    };
    curves.any(is_of)
}

/// The name of the probability that a passage lasts longer than a time.
fn of(passage: &PassageQuestion, time: f64) -> String {
    PASSAGE_SURVIVAL.name(&format!("{}_{time}", passage.name))
}

fn draw(
    result: &SweepResult,
    chosen: &[&Point],
    passage: &PassageQuestion,
    print: &Print<'_>,
) -> Drawn {
    let lines: Vec<Line> = chosen
        .iter()
        .map(|point| Line {
            value: point.value,
            places: survival(point, passage),
        })
        .filter(|line| !line.places.is_empty())
        .collect();
    let seen = format!(
        "Probability that the passage {} lasts longer than a time{}, each with the band of its error.",
        passage.name,
        caption::at(&result.subject.family, lines.iter().map(|line| line.value)),
    );
    let name = symbols::plain(&passage.name.replace('_', " "));
    let chart = Chart {
        abscissa: "time $t$".to_owned(),
        is_logarithmic: true,
        ordinate: format!("survival $S(t)$ ({name})"),
        is_over_decades: false,
        columns: ["time", "survival"].map(str::to_owned),
        seen,
    };
    chart.draw(result, &lines, print)
}

/// The logarithms of the times, and the probabilities with their errors.
fn survival(point: &Point, passage: &PassageQuestion) -> Vec<(f64, (f64, f64))> {
    let at = |time: &f64| {
        let name = of(passage, *time);
        let known = point.report.measures.iter().find(|one| one.name == name)?;
        let known = (known.value, known.error.unwrap_or(f64::NAN));
        Some((time.log10(), known))
    };
    passage.times.iter().filter_map(at).collect()
}
