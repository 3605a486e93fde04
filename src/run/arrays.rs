//! The arrays of `densities.zarr`: names, dimensions and meaning. What writes the store and what reads it both take
//! them from here.
//!
//! | array | dimensions | content |
//! | --- | --- | --- |
//! | `f_c` (the parameter) | parameter | its values |
//! | `x`, `x_edges` | cells of the axis, edges | centres and edges of the cells |
//! | `p_x`, `p_xy` | parameter, axes … | density; attribute `centre_of_symmetry` where the system declares one, `formulas` of quantities |
//! | `p_x_error` | as `p_x` | standard error, with what open ends of the ranges may have changed (generator) |
//! | `p_x_second` | as `p_x` | density by a second discretisation (generator) |
//! | `p_x_truncated` | parameter | share by which the ends of the ranges may have changed all of `p_x` (generator) |
//! | `p_x_closed` | as `p_x` | by how much closed ends may change `p_x` besides; where enough leaves (generator) |
//! | `p_x_replicate` | parameter, replicate, axes … | densities without one group of samples each (SGCM) |
//! | `exit_mean_time`, `exit_committor` | parameter, axes … | field of the passage `exit` over the state where it starts |
//! | `exit_mean_time_error` | as `exit_mean_time` | its error |
//! | `p_y_kink_0` | parameter; for a joint density also the other axis | jump of ∂(log p)/∂(axis) across a plane; attributes `axis`, `at`; zero with the attribute `bends` where only higher derivatives jump |
//!
//! Kinks are numbered in the order in which they first occur. NaN stands for what is not there at a parameter value. A
//! symmetry is that of the equations all along a sweep, hence an attribute.

use serde_json::{Map, Value, json};

use super::columns::Named;
use crate::continuation::StateField;
use crate::density::{EstimatedDensity, Kink, Observable};
use crate::system::Family;

/// What the array of the parameter is, in words.
const SWEPT: &str = "swept parameter";
/// Name of the dimension of replicates.
const REPLICATE: &str = "replicate";

/// Attribute of a density.
pub(super) const CENTRE: &str = "centre_of_symmetry";

/// Attribute of a density of quantities: their names and formulas.
pub(super) const FORMULAS: &str = "formulas";

/// The formulas of the quantities of an observable; `None` where it has none.
pub(super) fn formulas(family: &Family, observable: Observable) -> Option<Value> {
    let axes = observable.axes().into_iter();
    let quantities = axes.filter_map(|axis| family.quantity(axis));
    let named = quantities.map(|one| (one.name().to_owned(), json!(one.formula())));
    let named: Map<String, Value> = named.collect();
    (!named.is_empty()).then_some(Value::Object(named))
}

/// Attribute of a density: share of its maximum below which values are what the solver leaves.
pub(super) const NEGLIGIBLE: &str = "negligible";

/// Attributes of a kink: name of the axis on which the plane stands, and its coordinate.
pub(super) const KINK_AXIS: &str = "axis";
/// See [`KINK_AXIS`].
pub(super) const KINK_AT: &str = "at";
/// Whether the slope bends there and does not jump: see [`Kink::is_bend`].
pub(super) const KINK_BENDS: &str = "bends";

/// One array of the store.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layout {
    pub(super) name: String,
    /// Names with lengths.
    pub(super) dimensions: Vec<(String, u64)>,
    pub(super) attributes: Map<String, Value>,
}

impl Layout {
    fn new(name: String, dimensions: Vec<(String, u64)>, long_name: String) -> Self {
        let mut attributes = Map::new();
        attributes.insert("long_name".to_owned(), long_name.into());
        Self {
            name,
            dimensions,
            attributes,
        }
    }

    fn attribute(mut self, name: &str, value: Value) -> Self {
        self.attributes.insert(name.to_owned(), value);
        self
    }

    /// The swept parameter.
    pub(super) fn parameter(family: &Family) -> Self {
        Self::line(family.parameter().to_owned(), SWEPT)
    }

    /// Centres and edges of an axis.
    pub(super) fn axis(name: &str) -> [Self; 2] {
        [
            Self::line(name.to_owned(), "centres of the cells"),
            Self::line(edges(name), "edges of the cells"),
        ]
    }

    /// A coordinate.
    fn line(name: String, words: &str) -> Self {
        Self::new(name.clone(), vec![(name, 1)], words.to_owned())
    }

    /// Whether it has a row for every value of the parameter.
    pub(super) fn is_along(&self, family: &Family) -> bool {
        let first = self.dimensions.first();
        first.is_some_and(|(name, _)| name == family.parameter())
    }

    /// The density itself.
    pub(super) fn density(family: &Family, estimate: &EstimatedDensity) -> Self {
        let words = words(family, estimate.observable);
        let layout = Self::of_cells(
            family,
            estimate,
            density(family, estimate.observable),
            words,
        );
        let layout = layout.attribute(NEGLIGIBLE, json!(estimate.negligible));
        let layout = match formulas(family, estimate.observable) {
            Some(formulas) => layout.attribute(FORMULAS, formulas),
            None => layout,
        };
        match &estimate.structure.centre {
            Some(centre) => layout.attribute(CENTRE, json!(centre)),
            None => layout,
        }
    }

    /// Its standard error.
    pub(super) fn error(family: &Family, estimate: &EstimatedDensity) -> Self {
        let long_name = format!(
            "standard error of the {}",
            words(family, estimate.observable)
        );
        Self::of_cells(
            family,
            estimate,
            error(family, estimate.observable),
            long_name,
        )
    }

    /// The density by a second discretisation.
    pub(super) fn second(family: &Family, estimate: &EstimatedDensity) -> Self {
        let long_name = format!(
            "{} by a second discretisation",
            words(family, estimate.observable)
        );
        Self::of_cells(
            family,
            estimate,
            second(family, estimate.observable),
            long_name,
        )
    }

    /// By how much closed ends may change the density.
    pub(super) fn closed(family: &Family, estimate: &EstimatedDensity) -> Self {
        let words = words(family, estimate.observable);
        let long_name = format!("what closed ends of the ranges may change of the {words}");
        let name = closed(family, estimate.observable);
        Self::of_cells(family, estimate, name, long_name)
    }

    /// The share by which the ends of the ranges may have changed all of the density.
    pub(super) fn truncated(family: &Family, estimate: &EstimatedDensity) -> Self {
        let words = words(family, estimate.observable);
        let long_name = format!("share by which ends of the ranges may have changed the {words}");
        let name = truncated(family, estimate.observable);
        Self::new(name, vec![(family.parameter().to_owned(), 1)], long_name)
    }

    /// The densities without one group of samples each.
    pub(super) fn replicates(family: &Family, estimate: &EstimatedDensity, count: usize) -> Self {
        let long_name = format!(
            "{} without one group of samples each",
            words(family, estimate.observable)
        );
        let name = replicates(family, estimate.observable);
        let mut layout = Self::of_cells(family, estimate, name, long_name);
        layout
            .dimensions
            .insert(1, (REPLICATE.to_owned(), count as u64));
        layout
    }

    /// The kink of the given number.
    pub(super) fn kink(
        family: &Family,
        estimate: &EstimatedDensity,
        kink: &Kink,
        number: usize,
    ) -> Self {
        let name = format!("{}{number}", kink_prefix(family, estimate.observable));
        let axes = estimate.observable.axes();
        let axis = axes.get(kink.axis).map_or("?", |&axis| family.axis(axis));
        let density = words(family, estimate.observable);
        let at = kink.at;
        let long_name =
            format!("jump of the slope along {axis} of the logarithm of the {density} at {at}");
        let mut layout = Self::of_cells(family, estimate, name, long_name);
        // The plane leaves the other axis, if there is one.
        layout.dimensions.remove(1 + kink.axis);
        let layout = layout
            .attribute(KINK_AXIS, axis.into())
            .attribute(KINK_AT, json!(kink.at));
        if kink.is_bend() {
            layout.attribute(KINK_BENDS, json!(true))
        } else {
            layout
        }
    }

    /// An array with one value a cell and parameter value; how many values the first dimension has is set when it is
    /// stored.
    fn of_cells(
        family: &Family,
        estimate: &EstimatedDensity,
        name: String,
        long_name: String,
    ) -> Self {
        let mut dimensions = vec![(family.parameter().to_owned(), 1)];
        let axes = estimate.observable.axes();
        for (&axis, cells) in axes.iter().zip(&estimate.density.axes) {
            dimensions.push((family.axis(axis).to_owned(), cells.count() as u64));
        }
        Self::new(name, dimensions, long_name)
    }

    /// A field of a passage, and its error.
    pub(super) fn field(family: &Family, field: &StateField) -> [Self; 2] {
        let mut dimensions = vec![(family.parameter().to_owned(), 1)];
        for (number, cells) in field.axes.iter().enumerate() {
            dimensions.push((family.axis(number).to_owned(), cells.count() as u64));
        }
        let words = field_words(&field.name);
        let error = format!("error of the {words}");
        [
            Self::new(field.name.clone(), dimensions.clone(), words),
            Self::new(field_error(&field.name), dimensions, error),
        ]
    }

    /// Whether this is the array of that kink, whatever its number.
    pub(super) fn is_kink(&self, other: &Self) -> bool {
        let of = |layout: &Self| {
            let name = layout
                .name
                .trim_end_matches(|c: char| c.is_ascii_digit())
                .to_owned();
            (
                name,
                layout.attributes.get(KINK_AXIS).cloned(),
                layout.attributes.get(KINK_AT).cloned(),
                layout.attributes.contains_key(KINK_BENDS),
            )
        };
        self.attributes.contains_key(KINK_AT) && of(self) == of(other)
    }
}

/// Name of the edges of an axis.
pub(super) fn edges(axis: &str) -> String {
    format!("{axis}_edges")
}

/// Name of a density.
pub(super) fn density(family: &Family, observable: Observable) -> String {
    format!("p_{}", observable.name(family))
}

/// Name of its standard error.
pub(super) fn error(family: &Family, observable: Observable) -> String {
    density(family, observable) + "_error"
}

/// Name of its second discretisation.
pub(super) fn second(family: &Family, observable: Observable) -> String {
    density(family, observable) + "_second"
}

/// Name of what closed ends may change of it.
pub(super) fn closed(family: &Family, observable: Observable) -> String {
    density(family, observable) + "_closed"
}

/// Name of the share by which the ends may have changed all of it.
pub(super) fn truncated(family: &Family, observable: Observable) -> String {
    density(family, observable) + "_truncated"
}

/// Name of its replicates.
pub(super) fn replicates(family: &Family, observable: Observable) -> String {
    density(family, observable) + "_replicate"
}

/// Names of its kinks without their numbers.
pub(super) fn kink_prefix(family: &Family, observable: Observable) -> String {
    density(family, observable) + "_kink_"
}

/// Name of the error of a field.
pub(super) fn field_error(field: &str) -> String {
    format!("{field}_error")
}

/// What a field is, in words.
pub(super) fn field_words(field: &str) -> String {
    format!("field {field} over the state where the passage starts")
}

/// Every name that the store of densities may have, dimensions included.
pub(super) fn names(family: &Family, observables: &[Observable]) -> Vec<Named> {
    let mut names = vec![
        Named::new(family.parameter(), SWEPT),
        Named::new(REPLICATE, "groups of samples"),
    ];
    let mut known: Vec<&str> = Vec::new();
    let watched = observables.iter().flat_map(|observable| observable.axes());
    // Fields are over all axes.
    let of_fields = family.fields().next().map(|_| 0..family.model().axes.len());
    for axis in watched.chain(of_fields.into_iter().flatten()) {
        let axis = family.axis(axis);
        if !known.contains(&axis) {
            known.push(axis);
            names.push(Named::new(axis, format!("centres of the cells of {axis}")));
            names.push(Named::new(
                edges(axis),
                format!("edges of the cells of {axis}"),
            ));
        }
    }
    for field in family.fields() {
        let words = field_words(&field.name);
        names.push(Named::new(
            field_error(&field.name),
            format!("error of the {words}"),
        ));
        names.push(Named::new(field.name.as_str(), words));
    }
    for &observable in observables {
        let density_of = words(family, observable);
        let named = |name: fn(&Family, Observable) -> String, what: &str| {
            Named::new(name(family, observable), format!("{what}{density_of}"))
        };
        names.extend([
            named(density, ""),
            named(error, "standard error of the "),
            named(second, "second discretisation of the "),
            named(closed, "what closed ends may change of the "),
            named(truncated, "share by which ends may have changed the "),
            named(replicates, "replicates of the "),
            Named {
                is_numbered: true,
                ..named(kink_prefix, "kinks of the ")
            },
        ]);
    }
    names
}

fn words(family: &Family, observable: Observable) -> String {
    match observable {
        Observable::Marginal(axis) => format!("marginal density of {}", family.axis(axis)),
        Observable::Joint(first, second) => {
            let (first, second) = (family.axis(first), family.axis(second));
            format!("joint density of {first} and {second}")
        }
    }
}
