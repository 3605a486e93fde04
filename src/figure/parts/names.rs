//! Names and symbols of a family of systems, as markup for lettering and for file names.

use crate::density::Observable;
use crate::figure::canvas::symbols;
use crate::system::{Family, Fluctuating};

/// What rounding leaves of a value, as a share of the sweep.
const ROUNDING: f64 = 1e-9;

/// Symbol of the swept parameter.
pub(crate) fn parameter(family: &Family) -> String {
    symbols::variable(family.symbol())
}

/// Symbol of an axis.
pub(crate) fn axis(family: &Family, axis: usize) -> String {
    symbols::variable(family.axis_symbol(axis))
}

/// Symbol of what fluctuates.
pub(crate) fn fluctuating(family: &Family, one: &Fluctuating) -> String {
    match one {
        Fluctuating::Axis(number, _) => axis(family, *number),
        Fluctuating::Quantity(quantity) => symbols::variable(quantity.symbol()),
    }
}

/// `p(x)` or `p(x, ẋ)`.
pub(crate) fn density(family: &Family, observable: Observable) -> String {
    let symbols = observable.symbols(family).into_iter();
    let symbols: Vec<String> = symbols.map(symbols::variable).collect();
    symbols::density_of(&symbols)
}

/// `α = −0.5`.
pub(crate) fn at(family: &Family, value: f64) -> String {
    let value = symbols::value(not_of_rounding(family, value));
    format!("{} = {value}", parameter(family))
}

/// A value of the parameter as figures have it: what is less than rounding leaves of the sweep's values is zero.
pub(crate) fn not_of_rounding(family: &Family, value: f64) -> f64 {
    let (from, to) = family.range();
    if value.abs() < ROUNDING * (to - from) {
        return 0.0;
    }
    value
}

/// Name of an observable in file names: `x`, `xy`.
pub(crate) fn file(family: &Family, observable: Observable) -> String {
    safe(&observable.name(family))
}

/// Name of the figure of one of several values: `joint_xy_-0.5`.
pub(crate) fn at_value(name: &str, family: &Family, value: f64) -> String {
    let value = symbols::rounded(not_of_rounding(family, value));
    format!("{name}_{}", safe(&value.to_string()))
}

/// Symbol of a parameter, swept or not.
pub(crate) fn symbol_of(family: &Family, name: &str) -> String {
    symbols::variable(family.symbol_of(name))
}

/// Whether a word names a figure: its whole name, the beginning of it up to a `_` (`joint` names `joint_xy_0.5`), or
/// `all`.
pub(crate) fn matches(word: &str, figure: &str) -> bool {
    let rest = figure.strip_prefix(word);
    word == "all" || rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('_'))
}

/// What a word ends with that names the sheets of a kind, and no figure of a single value: `joint_sheets`.
const SHEETS: &str = "_sheets";

/// The kind whose sheets a word names; `None` of a word that names other figures.
pub(crate) fn of_sheets(word: &str) -> Option<&str> {
    word.strip_suffix(SHEETS)
}

/// Letters, digits, `.`, `-` and `_`; everything else becomes `_`.
fn safe(name: &str) -> String {
    let letter = |c: char| match c {
        c if c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | '_') => c,
        _ => '_',
    };
    name.chars().map(letter).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_rounding_leaves_of_a_value_is_zero() {
        let family = crate::system::test_families::coulomb();
        assert_eq!(at_value("joint_xy", &family, 1.019e-17), "joint_xy_0");
        assert_eq!(at_value("joint_xy", &family, -0.005), "joint_xy_-0.005");
        assert!(at(&family, -1e-17).ends_with(" = 0"));
        assert!(at(&family, 1e-7).ends_with("10^{−7}"));
    }

    #[test]
    fn file_names_are_safe() {
        assert_eq!(safe("f_c/../ẋ"), "f_c_..__");
    }
}
