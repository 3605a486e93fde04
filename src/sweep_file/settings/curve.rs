//! The curves that are followed from what a sweep has located.

use super::map::is_second;
use super::system::check_range;
use crate::continuation::curve::CurveOptions;
use crate::sweep_file::diagnostic::Diagnostic;
use crate::sweep_file::draft::Draft;
use crate::sweep_file::reader::Reader;
use crate::system::Family;

/// Curves in the plane of the swept and a second parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveSettings {
    /// The second parameter; the sweep holds it at a value in the box.
    pub parameter: String,
    /// Its lowest value.
    pub from: f64,
    /// Its highest value.
    pub to: f64,
    /// Lowest and highest value of the swept parameter.
    pub first: (f64, f64),
    /// Labels of the rows that are followed; `None` for every row that an indicator has located.
    pub rows: Option<Vec<String>>,
    /// Longest step between points, as a share of the sides of the box.
    pub step: f64,
    /// Whether the curves that start from points of codimension two are followed too.
    pub branches: bool,
}

/// Checks `[curve]`; `None` where there is none, or something is wrong with it.
pub(super) fn read(
    reader: &mut Reader<'_>,
    draft: &Draft,
    family: &Family,
) -> Option<CurveSettings> {
    let section = reader.entry(&["curve"])?;
    if reader.entry(&["map"]).is_some() {
        let diagnostic = Diagnostic::new("a file has `[map]` or `[curve]`, not both")
            .at(
                &section.key_place,
                "curves of rows; `[map]` follows every curve of its box",
            )
            .remedy("remove one of both; `pbif curve FILE` follows a row of a file with `[map]`");
        reader.report(diagnostic);
        return None;
    }
    for key in ["parameter", "from", "to"] {
        reader.require(&["curve", key]);
    }
    let curve = &draft.curve;
    let name = curve.parameter.as_deref()?;
    is_second(reader, (family.model(), family.parameter()), name, "curve")?;
    let (from, to) = (curve.from?, curve.to?);
    let (low, high) = family.range();
    let first = (
        curve.first_from.unwrap_or(low),
        curve.first_to.unwrap_or(high),
    );
    let ends = [
        (name, "from", from),
        (name, "to", to),
        (family.parameter(), "first_from", first.0),
        (family.parameter(), "first_to", first.1),
    ];
    for (parameter, key, value) in ends {
        let mut known = family.model().parameters.iter();
        let known = known.find(|one| one.name == parameter);
        if let (Some(known), Some(place)) = (known, reader.place(&["curve", key])) {
            check_range(
                reader,
                family.model(),
                known,
                value,
                place,
                "the box goes here",
            )
            .then_some(())?;
        }
    }
    let (from, to) = (from.min(to), from.max(to));
    check_side(reader, name, (from, to), "to")?;
    check_side(reader, family.parameter(), first, "first_to")?;
    check_held(reader, (draft, family), name, (from, to))?;
    let usual = CurveOptions::default();
    Some(CurveSettings {
        parameter: name.to_owned(),
        from,
        to,
        first,
        rows: curve.rows.clone().filter(|rows| !rows.is_empty()),
        step: curve.step.unwrap_or(usual.largest_step),
        branches: curve.branches.unwrap_or(usual.branches),
    })
}

/// Longest side of the box, in units of the value that the sweep holds. What is nearer to a curve than 1e-4 of the
/// sides is on it, and what is so near to an end of the box is at that end: that is a tenth of the value then.
const LONGEST: f64 = 1e3;

/// Refuses a side of the box without length; the key is that of its upper end.
fn check_side(
    reader: &mut Reader<'_>,
    parameter: &str,
    (from, to): (f64, f64),
    key: &str,
) -> Option<()> {
    let length = to - from;
    if length > 0.0 && length.is_finite() {
        return Some(());
    }
    let diagnostic = Diagnostic::new(format!(
        "the box of the curves goes from {from} to {to} along `{parameter}`"
    ))
    .allowed("a lower and a higher value");
    reader.report(diagnostic.at(reader.place(&["curve", key]), "no range"));
    None
}

/// Refuses a box that the sweep does not run through, or in which the value that it holds is lost.
fn check_held(
    reader: &mut Reader<'_>,
    (draft, family): (&Draft, &Family),
    name: &str,
    (from, to): (f64, f64),
) -> Option<()> {
    let (_, held) = family.fixed().find(|(known, _)| *known == name)?;
    // Places in the box are shares of its sides.
    let is_lost = held != 0.0 && to - from > LONGEST * held.abs();
    if (from..=to).contains(&held) && !is_lost {
        return Some(());
    }
    let mut title = format!(
        "the sweep holds `{name}` at {held}, and the box of the curves goes from {from:?} to {to:?}"
    );
    if is_lost {
        title += ": on so long a side that value is not told from others";
    }
    let (allowed, remedy) = match is_lost {
        true => (
            format!("a side of at most {:?}", LONGEST * held.abs()),
            "follow the curve in steps: in a shorter box first, from a sweep at a value near its end then",
        ),
        false => (
            format!("ends on either side of {held}"),
            "the curves start from the rows of the sweep: widen the box, or sweep at a value in it",
        ),
    };
    let diagnostic = Diagnostic::new(title).allowed(allowed).remedy(remedy);
    // Of both ends the one that would have to be moved.
    let ends = [("from", draft.curve.from), ("to", draft.curve.to)];
    let is_first = held < from || is_lost && from.abs() > to.abs();
    let short = if is_first { from } else { to };
    let key = ends.iter().find(|(_, end)| *end == Some(short));
    let place = key.and_then(|(key, _)| reader.place(&["curve", key]));
    reader.report(diagnostic.at(place, "the box ends here"));
    None
}
