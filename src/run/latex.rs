//! Parameters and observables as LaTeX mathematics, for tables.

use crate::density::Observable;
pub(super) use crate::formula::latex::{escape, mathematics};
use crate::system::Family;

/// The swept parameter as LaTeX mathematics, for example `f_{c}` or `\alpha`.
pub(super) fn parameter(family: &Family) -> String {
    mathematics(family.symbol())
}

/// An observable as LaTeX mathematics, for example `x, \dot{x}`.
pub(super) fn observable(family: &Family, observable: Observable) -> String {
    let symbols = observable.symbols(family).into_iter().map(mathematics);
    symbols.collect::<Vec<_>>().join(", ")
}
