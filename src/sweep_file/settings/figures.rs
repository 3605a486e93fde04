//! Where figures are drawn, in which formats and in what style.

use super::system::Swept;
use crate::continuation::evenly_spaced;
use crate::figure::{FigureStyle, Format};
use crate::sweep_file::diagnostic::{Diagnostic, Place};
use crate::sweep_file::draft::Draft;
use crate::sweep_file::names::list;
use crate::sweep_file::reader::Reader;
use crate::sweep_file::value::SpannedValue;

/// Checks `figures.at`; left out, it is both ends and two of the sweep's values between.
///
/// A value outside the sweep is refused, but where the file has it and the ends were set on top of the file: then it is
/// left out with a warning, so that a part of a sweep can be run without editing its figures too.
pub(super) fn read_at(reader: &mut Reader<'_>, draft: &Draft, swept: &Swept) -> Vec<f64> {
    let Some(values) = &draft.figures_at else {
        return by_itself(swept);
    };
    let (low, high) = swept.family.range();
    let items = reader.items(&["figures", "at"]);
    let is_inside = |value: f64| (low..=high).contains(&value);
    let is_moved = ["from", "to", "parameter"].iter().any(|key| {
        let place = reader.place(&["sweep", key]);
        place.is_some_and(Place::is_set)
    });
    let mut inside = Vec::new();
    let mut left_out: Vec<(f64, &SpannedValue)> = Vec::new();
    for (&value, item) in values.iter().zip(items) {
        if is_inside(value) {
            inside.push(value);
        } else if is_moved && !item.place.is_set() {
            left_out.push((value, item));
        } else {
            let name = swept.family.parameter();
            let diagnostic =
                Diagnostic::new(format!("`figures.at` has {value}, outside the sweep"))
                    .at(&item.place, format!("`{name}` never takes this value"))
                    .allowed(format!("numbers from {low} to {high}"));
            reader.report(diagnostic);
        }
    }
    let Some((_, first)) = left_out.first() else {
        return inside;
    };
    let names: Vec<String> = left_out
        .iter()
        .map(|(value, _)| value.to_string())
        .collect();
    let mut title = format!(
        "`figures.at` of the file has {}, outside the sweep from {low} to {high} that was set: left out",
        list(&names)
    );
    if inside.is_empty() {
        title += "; both ends and two values between are drawn instead";
        inside = by_itself(swept);
    }
    reader.warn(Diagnostic::warning(title).at(&first.place, "left out"));
    inside
}

/// Both ends and two of the sweep's values between.
fn by_itself(swept: &Swept) -> Vec<f64> {
    let values = evenly_spaced(swept.family.ends(), swept.points);
    let steps = values.len() - 1;
    let mut chosen = vec![0, (steps + 1) / 3, (2 * steps + 1) / 3, steps];
    chosen.dedup();
    chosen.into_iter().map(|index| values[index]).collect()
}

/// The formats that are listed, each once.
pub(super) fn each_once(listed: &[Format]) -> Vec<Format> {
    let mut formats = Format::ALL.to_vec();
    formats.retain(|format| listed.contains(format));
    formats
}

/// Refuses a width that has no room for the text.
pub(super) fn check_style(reader: &mut Reader<'_>, style: &FigureStyle) {
    let Some(width) = style.width.millimetres().filter(|_| !style.has_room()) else {
        return;
    };
    let (least, most) = style.widths();
    let text = style.text_points();
    let shown = if width < 1e6 {
        width.to_string()
    } else {
        format!("{width:e}")
    };
    let title = format!("figures {shown} mm wide have no room for text of {text} points");
    let key = |name| reader.place(&["figures", "style", name]);
    let diagnostic = Diagnostic::new(title)
        .allowed(format!("with such text, from {least:.0} to {most:.0} mm"))
        .remedy("choose another `figures.style.width`, or another `figures.style.text`");
    let diagnostic = diagnostic.at(key("width").or_else(|| key("text")), "no room");
    reader.report(diagnostic);
}
