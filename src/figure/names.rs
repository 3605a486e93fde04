//! Names and symbols of a family of systems, as markup for lettering and for file names.

use super::canvas::symbols;
use super::select::safe;
use crate::density::Observable;
use crate::system::Family;

/// Symbol of the swept parameter.
pub(super) fn parameter(family: &Family) -> String {
    symbols::variable(family.symbol())
}

/// Symbol of an axis.
pub(super) fn axis(family: &Family, axis: usize) -> String {
    symbols::variable(family.axis_symbol(axis))
}

/// `p(x)` or `p(x, ẋ)`.
pub(super) fn density(family: &Family, observable: Observable) -> String {
    let symbols = observable.symbols(family).into_iter();
    let symbols: Vec<String> = symbols.map(symbols::variable).collect();
    symbols::density_of(&symbols)
}

/// `α = −0.5`.
pub(super) fn at(family: &Family, value: f64) -> String {
    format!("{} = {}", parameter(family), symbols::value(value))
}

/// Name of an observable in file names: `x`, `xy`.
pub(super) fn file(family: &Family, observable: Observable) -> String {
    safe(&observable.name(family))
}
