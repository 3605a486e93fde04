//! How often regions are visited, as columns.

use crate::continuation::measure::{SOJOURN, TIME_SHARE, VISITS};
use crate::continuation::{Measure, MeasureColumn};
use crate::passage::Visits;
use crate::system::{Family, VisitsQuestion};

/// Three columns a region.
pub(super) fn columns(family: &Family) -> impl Iterator<Item = MeasureColumn> {
    let asked = family.questions.visits.iter();
    asked.flat_map(|question| {
        [TIME_SHARE, VISITS, SOJOURN].map(|kind| MeasureColumn {
            kind,
            of: question.name.clone(),
        })
    })
}

/// The numbers that are known, as measures.
pub(in crate::method) fn measures(question: &VisitsQuestion, visits: &Visits) -> Vec<Measure> {
    let [rate, length] = match visits.entries {
        Some(entries) => entries.map(Some),
        None => [None; 2],
    };
    let all = [
        (TIME_SHARE, Some(visits.time_share)),
        (VISITS, rate),
        (SOJOURN, length),
    ];
    let known = all.into_iter().filter_map(|(kind, known)| {
        let (value, error) = known?;
        Some(Measure {
            error: Some(error),
            ..kind.measure(&question.name, value)
        })
    });
    known.collect()
}
