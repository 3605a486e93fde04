//! What is said of the settings of an axis that a method cannot use, or that are of no use to it.

use std::sync::Arc;

use super::AxisSettings;
use super::along::{SweptSystems, filter};
use crate::sweep_file::diagnostic::Diagnostic;
use crate::sweep_file::draft::MethodKind;
use crate::sweep_file::reader::Reader;
use crate::sweep_file::typed_noise::{better_written, is_noise_with_memory};
use crate::system::System;

/// Cells an axis below which a density along it has no shape: a peak is a cell that is higher than both of its
/// neighbours.
const FEW_CELLS: usize = 4;

/// Says so where an axis has too few cells for any shape.
pub(super) fn warn_of_few_cells(
    reader: &mut Reader<'_>,
    name: &str,
    settings: &AxisSettings,
    method: MethodKind,
) {
    let count = settings.count.filter(|&count| count < FEW_CELLS);
    let (Some(count), None) = (count, settings.modes_by(method)) else {
        return;
    };
    let title = format!("{count} cells along `{name}` show no shape of a density");
    let found = Diagnostic::warning(title).remedy(format!(
        "give `cells.{name}.count` some tens, or leave it out: it is then found"
    ));
    let place = reader.place(&["cells", name, "count"]);
    reader.warn(found.at(place, "as many cells"));
}

/// Says so where a grading is given to an axis that no method of this file cuts into cells.
pub(super) fn warn_of_idle_grade(
    reader: &mut Reader<'_>,
    name: &str,
    settings: &AxisSettings,
    method: MethodKind,
) {
    let is_idle = settings.modes_by(method).is_some() && settings.count.is_none();
    let (true, Some(place)) = (is_idle, reader.place(&["cells", name, "grade"])) else {
        return;
    };
    let found = Diagnostic::warning(format!("the grading of `{name}` has no effect"))
        .at(place, "modes carry this axis in place of cells")
        .remedy(format!(
            "leave it out, or give `cells.{name}.count` to have cells instead of modes"
        ));
    reader.warn(found);
}

/// Reports cells along an axis that closes on itself: harmonics carry it.
pub(super) fn refuse_cells(reader: &mut Reader<'_>, name: &str) -> Option<()> {
    let keys = ["count", "grade"].into_iter();
    let mut given = keys.filter_map(|key| reader.place(&["cells", name, key]));
    let Some(place) = given.next() else {
        return Some(());
    };
    let title = format!("`{name}` closes on itself: harmonics carry it, not cells");
    let remedy = format!(
        "give `cells.{name}.modes`, the number of harmonics, or leave it out: it is then found"
    );
    reader.report(Diagnostic::new(title).at(place, "no cells").remedy(remedy));
    None
}

/// Reports modes on an axis that cannot have them: it has noise, or its range is not that of a bounded state.
pub(super) fn check_modes(
    reader: &mut Reader<'_>,
    name: &str,
    along: &SweptSystems<'_>,
    index: usize,
    range: Option<(f64, f64)>,
) -> Option<()> {
    let SweptSystems {
        family,
        corners: systems,
    } = along;
    let walled = |range| {
        systems
            .iter()
            .all(|system| system.facts().walls(index, range) == [true; 2])
    };
    let (why, remedy) = if along.relaxes(index) {
        // Its range is any that holds it.
        return Some(());
    } else if along.turn(index).is_some() {
        if range == along.bounds(index) {
            return Some(());
        }
        (
            "its range is one turn",
            "leave `from` and `to` out: the turn is known".to_owned(),
        )
    } else if filter(family, index).is_some() {
        if range == along.bounds(index) {
            return Some(());
        }
        (
            "the modes of noise have a range of their own",
            format!("leave `from` and `to` out, or give `cells.{name}.count` in place of modes"),
        )
    } else if systems.iter().any(|system| system.is_noisy(index)) {
        let with_memory = |system: &Arc<dyn System>| is_noise_with_memory(&**system, index);
        let remedy = match systems.iter().all(with_memory) {
            true => better_written(name),
            false => format!("give `cells.{name}.count`"),
        };
        ("noise drives it", remedy)
    } else if systems
        .iter()
        .any(|system| system.facts().bounds(index).is_none())
    {
        (
            "the model knows no bounds of it, and it does not relax linearly, as v does in v' = g - c v with a number \
             c > 0",
            match family.model().typed() {
                Some(_) => format!(
                    "give `cells.{name}.count`, or bounds of `{name}` in [system.bounds] that it never leaves"
                ),
                None => format!("give `cells.{name}.count`"),
            },
        )
    } else if !range.is_some_and(walled) {
        (
            "the state may leave the range",
            "leave the range out: the model knows the bounds".to_owned(),
        )
    } else {
        return Some(());
    };
    let diagnostic = Diagnostic::new(format!("axis `{name}` cannot have modes: {why}"))
        .allowed(
            "modes carry a state without noise that relaxes linearly or has bounds that the model knows, coloured \
             noise, an angle, or the phase of a forcing",
        )
        .remedy(remedy);
    let place = reader.place(&["cells", name, "modes"]);
    reader.report(diagnostic.at(place.or_else(|| reader.place(&["cells", name])), "refused"));
    None
}
