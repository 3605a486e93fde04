//! Parts of captions, ready to be pasted: of which system a figure is, by which method, what is marked.

use crate::continuation::curve::{EndReason, Plane};
use crate::continuation::{BifurcationStatus, Label, Located, SweepResult};
use crate::density::Observable;
use crate::figure::canvas::look::{DECADES, Look};
use crate::figure::canvas::symbols;
use crate::figure::parts::names;
use crate::space::Axis;
use crate::system::{self, Family, Model};
use crate::topology::Between;

/// The caption of a figure of a sweep, from what is seen in it and what is marked in it; empty parts are left out.
pub(crate) fn of_sweep(result: &SweepResult, seen: String, marked: &[String]) -> String {
    let family = &result.subject.family;
    let mut solved = result.points.iter();
    let solved = solved.find(|point| !point.densities.is_empty());
    let method = solved.map(|point| {
        let watched = point.densities.iter();
        let watched = watched.map(|one| (one.observable, one.density.axes.clone()));
        solved_by(family, point.report.method, watched)
    });
    let subject = [seen, system_of(family), method.unwrap_or_default()];
    let parts = subject.iter().chain(marked);
    let parts: Vec<&str> = parts
        .filter(|part| !part.is_empty())
        .map(String::as_str)
        .collect();
    format!("{} {}\n", parts.join(" "), version())
}

/// At which shares of a maximum contours are drawn.
pub(crate) fn contours(look: &Look) -> &'static str {
    if look.is_logarithmic {
        "0.1, 1, 10 and 50 %"
    } else {
        "10, 30, 50, 70 and 90 %"
    }
}

/// What is said of logarithmic colours, after another sentence; nothing of linear ones.
pub(crate) fn floor(look: &Look) -> String {
    if look.is_logarithmic {
        format!(
            " Colours are logarithmic; what is below 10^-{DECADES} of the largest density has the colour of the floor."
        )
    } else {
        String::new()
    }
}

/// What computed it.
pub(crate) fn version() -> String {
    format!("Computed with pbif {}.", env!("CARGO_PKG_VERSION"))
}

/// `p(x, y)`.
pub(crate) fn density(family: &Family, observable: Observable) -> String {
    let symbols = observable.symbols(family).into_iter().map(in_letters);
    format!("p({})", symbols.collect::<Vec<_>>().join(", "))
}

/// A number as captions have it.
pub(crate) fn number(value: f64) -> String {
    let value = symbols::rounded(value);
    if value == 0.0 || (1e-4..1e6).contains(&value.abs()) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

/// ` at f_c = -0.02, 0 and 0.01`.
pub(crate) fn at(family: &Family, values: impl Iterator<Item = f64>) -> String {
    let values = values.map(|value| number(names::not_of_rounding(family, value)));
    let values: Vec<String> = values.collect();
    let values = match values.as_slice() {
        [] => return String::new(),
        [rest @ .., last] if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        all => all.join(", "),
    };
    format!(" at {} = {values}", parameter(family))
}

/// The swept parameter as figures have it, in plain letters: `f_c`, `σ²`.
pub(crate) fn parameter(family: &Family) -> String {
    in_letters(family.symbol())
}

/// A symbol without its markup.
pub(crate) fn in_letters(symbol: &str) -> String {
    system::in_letters(symbol).replace(['$', '\\'], "")
}

/// A value to the second digit of its error.
pub(crate) fn to_digits_of_error(value: f64, error: f64) -> String {
    if !(error > 0.0 && error.is_finite()) {
        return number(value);
    }
    let decimals = (1.0 - error.log10().floor()).clamp(0.0, 15.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.chars().all(|c| matches!(c, '-' | '0' | '.')) {
        "0".to_owned()
    } else {
        text
    }
}

/// The system with its parameters.
pub(crate) fn system_of(family: &Family) -> String {
    system_in(family, "")
}

/// What ends the caption of a figure of a plane: the system, with the parameters that neither side of the plane
/// changes, how it was solved, as [`solved_by`] says it (may be empty), and what computed it.
pub(crate) fn of_plane(family: &Family, second: &str, solved_by: &str) -> String {
    let parts = [system_in(family, second), solved_by.to_owned(), version()];
    let parts = parts.into_iter().filter(|part| !part.is_empty());
    parts.collect::<Vec<_>>().join(" ")
}

/// A parameter as figures have it, in plain letters.
pub(crate) fn parameter_named(family: &Family, name: &str) -> String {
    in_letters(&names::symbol_of(family, name))
}

/// Why a curve ends, with the parameters as figures have them.
pub(crate) fn end(family: &Family, reason: &EndReason, plane: &Plane) -> String {
    match reason {
        EndReason::Border(side) => {
            let side = plane.sides().get(*side);
            let parameter = side.map(|side| parameter_named(family, &side.parameter));
            format!("border of the box in {}", parameter.unwrap_or_default())
        }
        reason => reason.words(plane),
    }
}

/// The system with its parameters but for one that is swept besides the family's own.
fn system_in(family: &Family, second: &str) -> String {
    let model = family.model();
    let equations = equations_of(model);
    let fixed: Vec<String> = family
        .fixed()
        .filter(|(name, _)| *name != second)
        .map(|(name, value)| {
            let symbol = in_letters(&names::symbol_of(family, name));
            format!("{symbol} = {}", number(value))
        })
        .collect();
    let fixed = if fixed.is_empty() {
        String::new()
    } else {
        format!(", with {}", fixed.join(", "))
    };
    match model.title.as_str() {
        "" => format!("System: {equations}{fixed}."),
        title => format!("System: {title} ({equations}){fixed}."),
    }
}

/// The equations in the symbols of the figure: typed ones typeset, and what their noises are.
fn equations_of(model: &Model) -> String {
    let Some(typed) = model.typed() else {
        let lines = model.equations.iter();
        let lines = lines.map(|line| in_symbols(model, line).replace("ẋ'", "ẍ"));
        // What says nothing but what the symbol means.
        let lines = lines.filter(|line| line != "x' = ẋ");
        return lines.collect::<Vec<_>>().join("; ");
    };
    let (mut lines, source) = (typed.typeset(), typed.source());
    let typed = source.equations().len() + source.definitions().len();
    lines.extend(model.equations.iter().skip(typed).cloned());
    let equations = lines.join("; ");
    let mut parameters = model.parameters.iter();
    match parameters.any(|one| in_letters(&one.symbol) == "σ²") {
        true => equations.replace("σ₂", "σ²"),
        false => equations,
    }
}

/// A formula or an inequality with the symbols that figures have for its states.
pub(crate) fn in_symbols(model: &Model, text: &str) -> String {
    let is_of_word =
        |letter: char| letter.is_alphabetic() || letter.is_ascii_digit() || letter == '_';
    let (mut made, mut rest) = (String::new(), text);
    while let Some(begin) = rest.find(is_of_word) {
        let after = &rest[begin..];
        let end = after
            .find(|letter| !is_of_word(letter))
            .unwrap_or(after.len());
        let word = &after[..end];
        let state = model.axes.iter().find(|axis| axis.name == word);
        made += &rest[..begin];
        made += &state.map_or_else(|| word.to_owned(), |axis| in_letters(&axis.symbol));
        rest = &after[end..];
    }
    made + rest
}

/// The method and the cells of what is watched.
pub(crate) fn solved_by(
    family: &Family,
    method: &str,
    watched: impl IntoIterator<Item = (Observable, Vec<Axis>)>,
) -> String {
    let mut axes: Vec<(usize, Axis)> = Vec::new();
    for (observable, own) in watched {
        for (number, axis) in observable.axes().into_iter().zip(own) {
            if axes.iter().all(|(known, _)| *known != number) {
                axes.push((number, axis));
            }
        }
    }
    axes.sort_by_key(|(number, _)| *number);
    let cells = axes.iter().map(|(number, axis)| {
        let (from, to) = (self::number(axis.from()), self::number(axis.to()));
        format!(
            "{} of {} in [{from}, {to}]",
            axis.count(),
            in_letters(family.axis_symbol(*number))
        )
    });
    let cells: Vec<String> = cells.collect();
    format!("Method: {method}; cells: {}.", cells.join(", "))
}

/// Which axes modes carry, and how many; nothing where all have cells.
pub(crate) fn modes(family: &Family, axes: &[Axis]) -> String {
    let carried = axes.iter().enumerate().filter(|(_, axis)| axis.is_modes());
    let words = carried.map(|(number, axis)| {
        let of = match axis.is_phase() {
            true => "the phase of the forcing".to_owned(),
            false => in_letters(family.axis_symbol(number)),
        };
        let kind = if axis.is_closed() {
            "harmonics"
        } else {
            "modes"
        };
        format!("{of} by {} {kind}", axis.mode_number())
    });
    match words.collect::<Vec<_>>().join(", ") {
        words if words.is_empty() => words,
        words => format!("Carried by modes: {words}."),
    }
}

/// A caption with a sentence before that of the version.
pub(crate) fn with_sentence(caption: &str, sentence: &str) -> String {
    match caption.rsplit_once(&version()) {
        Some((before, after)) if !sentence.is_empty() => {
            format!("{before}{sentence} {}{after}", version())
        }
        _ => caption.to_owned(),
    }
}

/// What is drawn between the cells of some observables.
pub(crate) fn between_cells(result: &SweepResult, is_shown: impl Fn(Observable) -> bool) -> String {
    let densities = result.points.iter().flat_map(|point| &point.densities);
    let mut shown = densities.filter(|one| is_shown(one.observable));
    if shown.any(|one| Between::new(one).is_some()) {
        "Between the cells the density is followed by parabolas with the averages of the cells."
            .to_owned()
    } else {
        String::new()
    }
}

/// The P- and D-bifurcations of a sweep, where they are marked.
pub(crate) fn bifurcations(result: &SweepResult) -> String {
    let family = &result.subject.family;
    let words = |row: &Located| {
        let status = match row.status() {
            BifurcationStatus::Located => String::new(),
            status => format!(", {}", status.word()),
        };
        let observable = density(family, row.observable);
        let error = format!("{:.1e}", row.error);
        format!(
            "{} at {} ± {error} ({observable}{status})",
            row.label,
            to_digits_of_error(row.value, row.error)
        )
    };
    let stability = |row: &Label| {
        let row = row.d_bifurcation()?;
        let (value, error) = (to_digits_of_error(row.value, row.error), row.error);
        Some(format!("{} at {value} ± {error:.1e}", row.label))
    };
    let of_shape: Vec<String> = result.bifurcations().map(words).collect();
    let of_stability: Vec<String> = result.labels.iter().filter_map(stability).collect();
    let named = [("P", of_shape), ("D", of_stability)].into_iter();
    let named = named.filter(|(_, rows)| !rows.is_empty());
    let sentences = named.map(|(letter, rows)| {
        format!(
            "{letter}-bifurcations, each in the band of its error: {}.",
            rows.join("; ")
        )
    });
    sentences.collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_of_built_in_models_have_one_name() {
        for (name, law) in [
            ("coulomb", "f_c sgn(ẋ)"),
            ("dahl", "z' = ẋ - (λ |ẋ|/f_c) z"),
        ] {
            let equations = equations_of(&system::registry::find(name).unwrap());
            assert!(
                equations.starts_with("ẍ = -κ ẋ - α x - μ x³"),
                "{equations}"
            );
            assert!(equations.contains(law), "{equations}");
            assert!(!equations.contains('y'), "{equations}");
        }
        let model = system::registry::find("coulomb").unwrap();
        assert_eq!(
            in_symbols(&model, "y > 2 and x y_2 < 3"),
            "ẋ > 2 and x y_2 < 3"
        );
    }

    #[test]
    fn values_have_the_digits_of_their_errors() {
        assert_eq!(to_digits_of_error(-0.00284863, 2.7e-6), "-0.0028486");
        assert_eq!(to_digits_of_error(2.3e-17, 4.5e-11), "0");
        assert_eq!(to_digits_of_error(0.25, 0.0), "0.25");
        assert_eq!(to_digits_of_error(12.34, 30.0), "12");
    }
}
