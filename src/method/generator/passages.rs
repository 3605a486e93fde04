//! Times of first passage at the values of a sweep, and findings where there are none.

use std::sync::Arc;

use super::basins::{MOVED, with_inequalities};
use crate::cancellation::Cancellation;
use crate::continuation::{Finding, Measure, PassageFault, SolveReport, StateField};
use crate::density::EstimatedDensity;
use crate::generator::{GeneratorOptions, Reach};
use crate::method::measures::{add_visits, measures_of_passage, transition_measures};
use crate::method::{GeneratorMethodOptions, MethodError, Problem};
use crate::passage::{
    FieldTarget, KnownDensity, Passage, PassageError, PassageField, PassageMemory, Timed, field,
    field_on_line, reactive, reactive_on_line, timed_from, timed_on_line, transitions_on_line,
    visits,
};
use crate::space::CellSpace;
use crate::stationary::generator::{RateError, RateOptions};
use crate::system::{
    FieldKind, FieldQuestion, Model, ParameterValues, PassageQuestion, PassageStart, Region,
    System, VisitsQuestion,
};

/// Error at which times stop to be iterated, relative to their sum. Numbers have its square: they are put right by what
/// equations from both sides leave.
const TOLERANCE: f64 = 1e-4;

/// Adds the numbers of all passages at a value to a report, with findings where there are none. `density` is
/// the steady state, with what is watched of it, in which regions may be found. With a reach of one axis times are
/// those of a line. `memory` is what the passages of
/// another value have left, one a question.
///
/// # Errors
/// [`MethodError::Cancelled`], and errors of values that the family does not have.
pub(super) fn add_passages(
    report: &mut SolveReport,
    (problem, value): (&Problem, f64),
    (system, reach): (&Arc<dyn System>, Option<&Reach<'_>>),
    (density, watched): (Option<KnownDensity<'_>>, &[EstimatedDensity]),
    (options, memory): (&GeneratorMethodOptions, &[PassageMemory]),
    cancellation: &Cancellation,
) -> Result<(), MethodError> {
    let family = problem.family();
    let questions = &family.questions;
    let is_asked = !(questions.passages.is_empty() && questions.visits.is_empty());
    if !is_asked || problem.subject().measures.is_empty() {
        return Ok(());
    }
    let asked = Asked {
        system,
        reach,
        space: problem.space(),
        values: family.values_at(value)?,
        density,
        generator: GeneratorOptions {
            scheme: options.scheme,
        },
        rates: RateOptions {
            tolerance: TOLERANCE,
            memory_limit_bytes: (options.memory_limit * 1e9) as u64,
            ..RateOptions::default()
        },
        cancellation,
    };
    for (number, question) in questions.visits.iter().enumerate() {
        asked.add_visits(report, (number, question))?;
    }
    let passages = questions.passages.iter().zip(memory);
    for (passage, (question, memory)) in passages.enumerate() {
        let mut faults = Vec::new();
        let numbers = if question.has_basins() {
            asked.numbers_of_basins(question, memory, family.model(), watched)?
        } else {
            asked.numbers(question, memory)?
        };
        match numbers {
            Ok(measures) => report.measures.extend(measures),
            Err(fault) => faults.push(fault),
        }
        if let Some(either) = &question.transitions {
            match asked.transitions(question, either)? {
                Ok((measures, fields)) => {
                    report.measures.extend(measures);
                    report.fields.extend(fields);
                }
                Err(fault) => faults.push(fault),
            }
        }
        let own = question
            .fields
            .iter()
            .filter(|wanted| !wanted.kind.is_reactive());
        for wanted in own {
            match asked.field(wanted)? {
                Ok(field) => report.fields.push(field),
                Err(fault) => faults.push(fault),
            }
        }
        faults.dedup();
        let findings = faults.into_iter();
        report
            .findings
            .extend(findings.map(|fault| Finding::NoPassage { passage, fault }));
    }
    Ok(())
}

/// What passages at a value are solved with.
struct Asked<'a> {
    system: &'a Arc<dyn System>,
    /// Of a system with one axis, whose passages are those of a line.
    reach: Option<&'a Reach<'a>>,
    space: &'a CellSpace,
    values: ParameterValues,
    density: Option<KnownDensity<'a>>,
    generator: GeneratorOptions,
    rates: RateOptions,
    cancellation: &'a Cancellation,
}

/// An answer, or why there is none.
type Answer<T> = Result<Result<T, PassageFault>, MethodError>;

impl Asked<'_> {
    /// Adds how often a region is visited, or a finding where that is not known.
    fn add_visits(
        &self,
        report: &mut SolveReport,
        (number, question): (usize, &VisitsQuestion),
    ) -> Result<(), MethodError> {
        let Some(density) = self.density else {
            return Ok(());
        };
        let region = question.region.level().bind(&self.values)?;
        let found = visits((self.system.as_ref(), self.space), &region, density);
        let found = found.ok();
        let is_endless = found.is_some_and(|found| found.is_endless);
        add_visits(report, (number, question), found.as_ref(), is_endless);
        Ok(())
    }

    fn numbers(&self, question: &PassageQuestion, memory: &PassageMemory) -> Answer<Vec<Measure>> {
        let passage = Passage::bind(question, &self.values)?;
        let on_line = self.reach.and_then(|reach| timed_on_line(reach, &passage));
        if let Some(found) = on_line {
            return or_fault(found.map(|timed| measures(question, &timed)));
        }
        let settings = (&self.generator, &self.rates);
        let cells = (self.system, self.space);
        let found = timed_from(
            cells,
            &passage,
            self.density,
            settings,
            memory,
            self.cancellation,
        );
        or_fault(found.map(|timed| measures(question, &timed)))
    }

    /// The same between regions that are basins, whose ends are moved by their errors.
    fn numbers_of_basins(
        &self,
        question: &PassageQuestion,
        memory: &PassageMemory,
        model: &Model,
        watched: &[EstimatedDensity],
    ) -> Answer<Vec<Measure>> {
        let mut all = Vec::new();
        for moved in MOVED {
            let Some(typed) = with_inequalities(question, model, watched, moved) else {
                return Ok(Err(PassageFault::NoPeak));
            };
            match self.numbers(&typed, memory)? {
                Ok(numbers) => all.push(numbers),
                Err(fault) => return Ok(Err(fault)),
            }
        }
        Ok(Ok(with_moved_ends(all)))
    }

    /// The numbers of the transitions between the regions of a passage, and those fields of them that are wanted.
    fn transitions(
        &self,
        question: &PassageQuestion,
        either: &Region,
    ) -> Answer<(Vec<Measure>, Vec<StateField>)> {
        let (PassageStart::Region(from), Some(density)) = (&question.start, self.density) else {
            return Ok(Err(PassageFault::NoDensity));
        };
        let bind = |region: &Region| region.level().bind(&self.values);
        let target = FieldTarget {
            until: bind(either)?,
            exits: vec![bind(from)?, bind(&question.until)?],
            part: None,
        };
        let wanted = || {
            let all = question.fields.iter();
            all.filter(|wanted| wanted.kind.is_reactive())
        };
        let regions = [&target.exits[0], &target.exits[1]];
        let on_line = self
            .reach
            .and_then(|reach| transitions_on_line(reach, regions));
        let numbers = match on_line.transpose() {
            Ok(numbers) => numbers,
            Err(error) => return or_fault(Err(error)),
        };
        if let (Some(numbers), None) = (numbers, wanted().next()) {
            return Ok(Ok((transition_measures(question, numbers), Vec::new())));
        }
        let fields = self
            .reach
            .and_then(|reach| reactive_on_line(reach, self.space, regions));
        let stored = |density: &PassageField, current: &[PassageField]| {
            let field = |wanted: &FieldQuestion| {
                let field = match (wanted.kind, wanted.axis) {
                    (FieldKind::ReactiveDensity, _) => Some(density),
                    (FieldKind::ReactiveCurrent, Some(axis)) => current.get(axis),
                    _ => None,
                };
                Some(self.stored(&wanted.name, field?.clone()))
            };
            wanted().filter_map(field).collect()
        };
        if let (Some(numbers), Some(fields)) = (numbers, fields) {
            return or_fault(fields.map(|[density, current]| {
                let fields = stored(&density, &[current]);
                (transition_measures(question, numbers), fields)
            }));
        }
        let settings = (&self.generator, &self.rates);
        let cells = (self.system, self.space);
        let found = reactive(cells, &target, density, settings, self.cancellation);
        or_fault(found.map(|found| {
            let numbers = numbers.unwrap_or([found.flux, found.rate, found.duration]);
            let fields = stored(&found.density, &found.current);
            (transition_measures(question, numbers), fields)
        }))
    }

    /// A field as it is handed on.
    fn stored(&self, name: &str, found: PassageField) -> StateField {
        StateField {
            name: name.to_owned(),
            axes: self.space.axes().to_vec(),
            values: found.values,
            errors: found.errors,
        }
    }

    fn field(&self, wanted: &FieldQuestion) -> Answer<StateField> {
        let bind = |region: &Region| region.level().bind(&self.values);
        let target = FieldTarget {
            until: bind(&wanted.until)?,
            exits: wanted.exits.iter().map(bind).collect::<Result<_, _>>()?,
            part: wanted.part,
        };
        let on_line = self
            .reach
            .and_then(|reach| field_on_line(reach, self.space, &target));
        if let Some(found) = on_line {
            return or_fault(found.map(|found| self.stored(&wanted.name, found)));
        }
        let settings = (&self.generator, &self.rates);
        let found = field(
            self.system,
            self.space,
            &target,
            settings,
            self.cancellation,
        );
        or_fault(found.map(|found| self.stored(&wanted.name, found)))
    }
}

fn or_fault<T>(found: Result<T, PassageError>) -> Answer<T> {
    match found {
        Err(PassageError::Rate(RateError::Cancelled(cancelled))) => Err(cancelled.into()),
        found => Ok(found.map_err(|error| fault(&error))),
    }
}

fn measures(question: &PassageQuestion, timed: &Timed) -> Vec<Measure> {
    let moments = [timed.mean, timed.deviation, timed.rate];
    let more = timed.shares.iter().chain(&timed.survival);
    let more = more.chain(&timed.quantiles);
    measures_of_passage(question, moments.into_iter().chain(more.copied()))
}

/// The first of several readings of the same numbers, with what the others differ by in its errors.
fn with_moved_ends(all: Vec<Vec<Measure>>) -> Vec<Measure> {
    let mut readings = all.into_iter();
    let mut first = readings.next().unwrap_or_default();
    let others: Vec<Vec<Measure>> = readings.collect();
    for (place, measure) in first.iter_mut().enumerate() {
        let changes = others.iter().filter_map(|other| other.get(place));
        let most = changes.fold(0.0, |most: f64, other| {
            most.max((other.value - measure.value).abs())
        });
        measure.error = measure.error.map(|error| error + most);
    }
    first
}

fn fault(error: &PassageError) -> PassageFault {
    match error {
        PassageError::Nowhere => PassageFault::Nowhere,
        PassageError::Between => PassageFault::Between,
        PassageError::Everywhere => PassageFault::Everywhere,
        PassageError::Start => PassageFault::Start,
        PassageError::NoDensity => PassageFault::NoDensity,
        PassageError::Never => PassageFault::Never,
        PassageError::Rounding => PassageFault::Rounding,
        PassageError::Overlap => PassageFault::Overlap,
        PassageError::Generator(_) | PassageError::Space(_) | PassageError::Rate(_) => {
            PassageFault::Unsolved
        }
    }
}

/// Densities at nodes times cell widths from the masses of the cells of an axis, to sixth order of the widths; and what
/// fourth order differs by.
pub(super) fn at_nodes(masses: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let last = masses.len().saturating_sub(1);
    // Second differences; at an end those of the cell beside it.
    let seconds = |of: &[f64]| -> Vec<f64> {
        let at = |cell: usize| cell.clamp(1, last.max(2) - 1);
        let one = |cell: usize| match of.get(at(cell) - 1..=at(cell) + 1) {
            Some([before, own, after]) => before - 2.0 * own + after,
            _ => 0.0,
        };
        (0..of.len()).map(one).collect()
    };
    let second = seconds(masses);
    let change: Vec<f64> = seconds(&second)
        .iter()
        .map(|fourth| -3.0 * fourth / 640.0)
        .collect();
    let terms = masses.iter().zip(second).zip(&change);
    let nodes = terms.map(|((mass, second), change)| mass - second / 24.0 - change);
    (nodes.collect(), change)
}
