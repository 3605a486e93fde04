//! Times of first passage that a family asks for, as columns.

use crate::continuation::measure::{
    PASSAGE_BACK, PASSAGE_DEVIATION, PASSAGE_KRAMERS, PASSAGE_MEAN, PASSAGE_MELNIKOV,
    PASSAGE_QUANTILE, PASSAGE_RATE, PASSAGE_SHARE, PASSAGE_SURVIVAL, PASSAGE_THERE,
    TRANSITION_FLUX, TRANSITION_RATE, TRANSITION_TIME,
};
use crate::continuation::{Measure, MeasureColumn, MeasureKind};
use crate::passage::WithError;
use crate::spectrum::EscapeFormulas;
use crate::system::{Family, PassageQuestion};

/// The columns of all passages.
pub(crate) fn passage_columns(family: &Family) -> Vec<MeasureColumn> {
    let of_one = |question| {
        let rates = formula_columns(question).filter(|_| is_particle(family));
        columns(question).into_iter().chain(rates)
    };
    family.questions.passages.iter().flat_map(of_one).collect()
}

/// The columns of a passage: mean, standard deviation, rate, shares of exits, probabilities and quantiles.
pub(in crate::method) fn columns(question: &PassageQuestion) -> Vec<MeasureColumn> {
    let column = |kind: MeasureKind, of: String| MeasureColumn { kind, of };
    let name = &question.name;
    let moments = [PASSAGE_MEAN, PASSAGE_DEVIATION, PASSAGE_RATE];
    let moments = moments.map(|kind| column(kind, name.clone()));
    let at = |kind, number: &f64| column(kind, format!("{name}_{number}"));
    let exits = (0..question.exits.len()).map(|part| {
        let label = question.exit_label(part);
        column(PASSAGE_SHARE, format!("{name}_{label}"))
    });
    let times = question.times.iter().map(|time| at(PASSAGE_SURVIVAL, time));
    let shares = question
        .quantiles
        .iter()
        .map(|share| at(PASSAGE_QUANTILE, share));
    let moments = moments.into_iter().chain(exits);
    let numbers = moments.chain(times).chain(shares);
    let numbers = numbers.chain(rates_between(question));
    numbers.chain(transition_columns(question)).collect()
}

/// Whether the equations are those of a damped particle in a potential at an end of the path.
fn is_particle(family: &Family) -> bool {
    let (from, to) = family.ends();
    [from, to]
        .into_iter()
        .any(|end| family.particle_at(end).is_some())
}

/// The columns of the rates over a barrier by formulas, beside those between two states.
fn formula_columns(question: &PassageQuestion) -> impl Iterator<Item = MeasureColumn> {
    columns_if(
        question.switching,
        question,
        [PASSAGE_KRAMERS, PASSAGE_MELNIKOV],
    )
}

/// The columns of some measures of a passage where they are asked for.
fn columns_if<const N: usize>(
    is_asked: bool,
    question: &PassageQuestion,
    kinds: [MeasureKind; N],
) -> impl Iterator<Item = MeasureColumn> {
    let kinds = kinds.into_iter().filter(move |_| is_asked);
    kinds.map(|kind| MeasureColumn {
        kind,
        of: question.name.clone(),
    })
}

/// The rates over a barrier by formulas as measures.
pub(in crate::method) fn formula_measures(
    question: &PassageQuestion,
    rates: &EscapeFormulas,
) -> Vec<Measure> {
    let pairs = formula_columns(question).zip([rates.kramers, rates.melnikov]);
    pairs
        .map(|(column, rate)| column.kind.measure(&column.of, rate))
        .collect()
}

/// The columns of the rates between two states.
fn rates_between(question: &PassageQuestion) -> impl Iterator<Item = MeasureColumn> {
    columns_if(question.switching, question, [PASSAGE_THERE, PASSAGE_BACK])
}

/// The columns of transitions between two regions.
fn transition_columns(question: &PassageQuestion) -> impl Iterator<Item = MeasureColumn> {
    let kinds = [TRANSITION_FLUX, TRANSITION_RATE, TRANSITION_TIME];
    columns_if(question.transitions.is_some(), question, kinds)
}

/// Transitions between two regions as measures: flux, rate and duration.
pub(in crate::method) fn transition_measures(
    question: &PassageQuestion,
    numbers: [WithError; 3],
) -> Vec<Measure> {
    with_errors(transition_columns(question), numbers.into_iter())
}

/// The rates between two states as measures, there and back.
pub(in crate::method) fn switching_measures(
    question: &PassageQuestion,
    rates: [WithError; 2],
) -> Vec<Measure> {
    with_errors(rates_between(question), rates.into_iter())
}

/// The numbers of a passage as measures, from the order of its columns.
pub(in crate::method) fn measures(
    question: &PassageQuestion,
    numbers: impl Iterator<Item = WithError>,
) -> Vec<Measure> {
    with_errors(columns(question).into_iter(), numbers)
}

/// Numbers as measures of columns, in their order.
fn with_errors(
    columns: impl Iterator<Item = MeasureColumn>,
    numbers: impl Iterator<Item = WithError>,
) -> Vec<Measure> {
    let pairs = columns.zip(numbers);
    let one = |(column, (value, error)): (MeasureColumn, WithError)| Measure {
        error: Some(error),
        ..column.kind.measure(&column.of, value)
    };
    pairs.map(one).collect()
}
