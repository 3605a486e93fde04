//! Levels of measures as a file has them.

use crate::continuation::measure::{DEVIATION, MEAN};
use crate::density::Observable;
use crate::method::columns_of_family;
use crate::sweep_file::diagnostic::Diagnostic;
use crate::sweep_file::draft::Draft;
use crate::sweep_file::names::quotable;
use crate::sweep_file::reader::Reader;
use crate::system::{Family, MeasureLevel};

/// What the names of numbers begin with that a table of the file asks for.
const ASKED_BY: [(&str, &str); 6] = [
    ("decay_", "[relaxation]"),
    ("frequency_", "[relaxation]"),
    ("spectral_", "[spectrum]"),
    ("correlation_time", "[spectrum]"),
    ("exponent", "[exponent]"),
    ("divergence", "[exponent]"),
];

/// Checks `[levels]`: each is of a number that the sweep has, with an error.
pub(super) fn read(
    reader: &mut Reader<'_>,
    draft: &Draft,
    family: &Family,
    observables: &[Observable],
) -> Vec<MeasureLevel> {
    let derived = draft.measures.iter().flatten();
    let derived = derived.flat_map(|measure| measure.columns(family, observables));
    let columns = columns_of_family(family).into_iter().chain(derived);
    let names = columns.map(|column| column.kind.name(&column.of));
    let averages = family.averages();
    let moments = averages.flat_map(|name| [&MEAN, &DEVIATION].map(|kind| kind.name(name)));
    let known: Vec<String> = names.chain(moments).collect();
    let mut levels = Vec::new();
    for (measure, level) in &draft.levels {
        if known.contains(measure) {
            levels.push(MeasureLevel {
                measure: measure.clone(),
                level: *level,
            });
            continue;
        }
        let title = format!(
            "`{}` is no number of this sweep that has an error",
            quotable(measure)
        );
        let asked = ASKED_BY.iter().find(|(word, _)| measure.starts_with(word));
        let remedy = match asked {
            Some((_, table)) => format!(
                "add the table {table}, which asks for such numbers, or take one of {}",
                known.join(", ")
            ),
            None => format!("take one of {}", known.join(", ")),
        };
        let diagnostic = Diagnostic::new(title).remedy(remedy);
        let place = reader.key_place(&["levels", measure]);
        reader.report(diagnostic.at(place, "this number"));
    }
    levels
}
