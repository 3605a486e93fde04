//! Measures that are derived where they are asked for, from what a session has solved. A file each.

mod balance;
mod entropy;
mod forcing;
mod passage;
mod rotation;
mod slow_modes;
mod spectra;
mod visits;

pub(crate) use passage::passage_columns;
pub(super) use passage::{
    formula_measures, measures as measures_of_passage, switching_measures, transition_measures,
};
pub(super) use slow_modes::measures as measures_of_slow_modes;
pub(super) use spectra::{measures as measures_of_spectrum, signal_to_noise};
pub(super) use visits::add_visits;

pub(super) use balance::broken;

use crate::continuation::measure::{DIVERGENCE, EXPONENT};
use crate::continuation::{Measure, MeasureColumn, MeasureKind, Subject};
use crate::density::{EstimatedDensity, Observable};
use crate::space::CellSpace;
use crate::system::{Family, MeasureLevel, Questions, System};

/// The columns of exponents, where a family asks for them.
fn exponent_columns(family: &Family) -> impl Iterator<Item = MeasureColumn> {
    let wanted: &[MeasureKind] = match (
        &family.questions.fixed_point,
        family.questions.largest_exponent,
    ) {
        (Some(_), _) => &[EXPONENT],
        (None, Some(_)) => &[EXPONENT, DIVERGENCE],
        (None, None) => &[],
    };
    wanted.iter().map(|&kind| MeasureColumn {
        kind,
        of: String::new(),
    })
}

/// A measure that is derived when it is asked for.
#[derive(Debug, Clone, Copy)]
pub struct DerivedMeasure {
    /// Its word, unit and meaning.
    pub kind: MeasureKind,
    /// What its numbers are of, a name each.
    of: fn(&Family, &[Observable]) -> Vec<String>,
    /// The numbers that can be told.
    derive: fn(&DerivedMeasure, &MeasureInput<'_>) -> Vec<Measure>,
}

/// What a session has solved at a value.
struct MeasureInput<'a> {
    family: &'a Family,
    densities: &'a [EstimatedDensity],
    cells: Option<&'a Cells<'a>>,
}

/// The weights of all cells, and what goes with them.
pub(super) struct Cells<'a> {
    pub(super) system: &'a dyn System,
    pub(super) space: &'a CellSpace,
    /// Masses, or a generator's unknowns, whose sums are more accurate; Σ = 1.
    pub(super) weights: &'a [f64],
    pub(super) others: Others<'a>,
    /// Ends that nothing passes, by axes.
    pub(super) closed: &'a [[bool; 2]],
    /// Mass that leaves per unit time.
    pub(super) escape_rate: f64,
    /// Share of the mass that lies beyond the ends of the ranges.
    pub(super) beyond: f64,
}

/// Other estimates of the weights, from which errors follow.
#[derive(Clone, Copy)]
pub(super) enum Others<'a> {
    None,
    /// By a second scheme.
    Second(&'a [f64]),
    /// Without one group of samples each.
    Replicates(&'a [Vec<f64>]),
}

impl DerivedMeasure {
    /// All of them.
    pub(crate) const ALL: [Self; 2] = [entropy::ENTROPY, balance::BALANCE];

    /// Its word in files.
    pub fn name(self) -> &'static str {
        self.kind.word
    }

    /// Its columns in tables.
    pub(crate) fn columns(
        &self,
        family: &Family,
        observables: &[Observable],
    ) -> Vec<MeasureColumn> {
        let column = |of| MeasureColumn {
            kind: self.kind,
            of,
        };
        let names = (self.of)(family, observables).into_iter();
        names.map(column).collect()
    }
}

/// The columns of what a family itself asks for: passages, slow modes, spectra, and the exponent of a fixed point; and
/// those of its angles, and of its answer to a forcing.
pub(crate) fn columns_of_family(family: &Family) -> Vec<MeasureColumn> {
    let passages = passage_columns(family).into_iter();
    let asked = passages.chain(slow_modes::columns(family));
    let asked = asked.chain(visits::columns(family));
    let asked = asked.chain(spectra::columns(family));
    let columns = asked.chain(exponent_columns(family));
    let columns = columns.chain(rotation::rotation_columns(family));
    columns.chain(forcing::forcing_columns(family)).collect()
}

/// Whether something that is asked of a steady state has an error of its own by what leaves through the ends of the
/// ranges.
pub(super) fn ask_for_ends(subject: &Subject) -> bool {
    let questions = &subject.family.questions;
    let is_asked = !(questions.visits.is_empty() && questions.passages.is_empty());
    let mut columns = subject.measures.iter();
    columns.any(|column| is_asked || column.kind == entropy::ENTROPY.kind)
}

/// Of what a family asks for, that without which some measures have no numbers.
pub(crate) fn questions_about(family: &Family, asked: &[MeasureLevel]) -> Questions {
    let is_it = |column: MeasureColumn| {
        let name = column.kind.name(&column.of);
        asked.iter().any(|one| one.measure == name)
    };
    let mut questions = family.questions.clone();
    questions.passages.retain(|question| {
        let mut columns = passage::columns(question).into_iter();
        columns.any(is_it)
    });
    for passage in &mut questions.passages {
        passage.fields.clear();
    }
    if !visits::columns(family).any(is_it) {
        questions.visits.clear();
    }
    if !slow_modes::columns(family).any(is_it) {
        questions.slow_modes = 0;
    }
    if !spectra::columns(family).any(is_it) {
        questions.spectrum = None;
    }
    if !exponent_columns(family).any(is_it) {
        questions.largest_exponent = None;
    }
    questions
}

/// The measures that a subject asks for.
pub(super) fn derive(
    subject: &Subject,
    densities: &[EstimatedDensity],
    cells: Option<&Cells<'_>>,
) -> Vec<Measure> {
    let solved = MeasureInput {
        family: &subject.family,
        densities,
        cells,
    };
    let asked = |one: &&DerivedMeasure| subject.measures.iter().any(|of| of.kind == one.kind);
    let all = DerivedMeasure::ALL.iter().filter(asked);
    all.flat_map(|one| (one.derive)(one, &solved)).collect()
}
