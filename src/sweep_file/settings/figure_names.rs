//! Which figures are drawn: their names are known to a program that draws them.

use crate::continuation::{CellCheck, Subject, SweepResult};
use crate::density::Observable;
use crate::figure::Figures;
use crate::sweep_file::diagnostic::Diagnostic;
use crate::sweep_file::draft::Draft;
use crate::sweep_file::names::{list, quotable};
use crate::sweep_file::reader::Reader;
use crate::system::Family;

/// Refuses names in `figures.draw` that no figure of this sweep can have.
pub(super) fn check(
    reader: &mut Reader<'_>,
    draft: &Draft,
    family: &Family,
    observables: &[Observable],
) {
    let nothing = SweepResult {
        subject: Subject {
            family: family.clone(),
            observables: observables.to_vec(),
            cell_check: CellCheck::Needless,
            measures: Vec::new(),
        },
        points: Vec::new(),
        labels: Vec::new(),
        checks: Default::default(),
        looks: Vec::new(),
        interrupted: false,
    };
    let figures = Figures::of_sweep(&nothing, "", &[]);
    let (known, kinds) = (figures.names(), figures.kinds());
    let items = reader.items(&["figures", "draw"]);
    for (name, item) in draft.figures.names().iter().zip(items) {
        // A figure at one value is named after one that there is: `joint_xy_0.5`. A kind that this sweep has nothing of
        // draws nothing; the defaults name three of them.
        let is_at_value = |figure: &String| {
            let value = name.strip_prefix(figure.as_str());
            value.is_some_and(|value| value.starts_with('_'))
        };
        if figures.check(&[name]).is_ok() || known.iter().any(is_at_value) {
            continue;
        }
        let diagnostic = Diagnostic::new(format!("there is no figure `{}`", quotable(name)))
            .at(&item.place, "unknown figure")
            .nearest(
                name,
                known
                    .iter()
                    .map(String::as_str)
                    .chain(kinds.iter().copied()),
            )
            .allowed(format!(
                "kinds of figures ({}), or one figure of a kind: {}",
                list(kinds),
                list(&known)
            ));
        reader.report(diagnostic);
    }
}
