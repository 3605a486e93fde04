//! How often regions are visited, as columns.

use crate::continuation::measure::{SOJOURN, TIME_SHARE, VISITS};
use crate::continuation::{Finding, Measure, MeasureColumn, SolveReport};
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

/// Adds the numbers of visits that are known to a report, and a finding where it is not known how often the region is
/// entered: endlessly often where noise acts across its border.
pub(in crate::method) fn add_visits(
    report: &mut SolveReport,
    (number, question): (usize, &VisitsQuestion),
    found: Option<&Visits>,
    is_endless: bool,
) {
    let known = found.into_iter();
    (report.measures).extend(known.flat_map(|visits| measures(question, visits)));
    if found.is_none_or(|visits| visits.entries.is_none()) {
        report.findings.push(Finding::NoVisits {
            visits: number,
            is_endless,
        });
    }
}

/// The numbers that are known, as measures.
fn measures(question: &VisitsQuestion, visits: &Visits) -> Vec<Measure> {
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
