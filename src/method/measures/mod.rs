//! Measures that are derived where they are asked for, from what a session has solved. A file each.

mod entropy;

use crate::continuation::{Measure, MeasureColumn, MeasureKind, Subject};
use crate::density::{EstimatedDensity, Observable};
use crate::system::Family;

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
}

impl DerivedMeasure {
    /// All of them.
    pub const ALL: [Self; 1] = [entropy::ENTROPY];

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

/// The measures that a subject asks for.
pub(super) fn derive(subject: &Subject, densities: &[EstimatedDensity]) -> Vec<Measure> {
    let solved = MeasureInput {
        family: &subject.family,
        densities,
    };
    let asked = |one: &&DerivedMeasure| subject.measures.iter().any(|of| of.kind == one.kind);
    let all = DerivedMeasure::ALL.iter().filter(asked);
    all.flat_map(|one| (one.derive)(one, &solved)).collect()
}
