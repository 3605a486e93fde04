//! The arrays of `densities.zarr`: names, dimensions and meaning. What writes the store and what reads it both take
//! them from here.
//!
//! | array | dimensions | content |
//! | --- | --- | --- |
//! | `f_c` (the parameter) | parameter | its values |
//! | `x`, `x_edges` | cells of the axis, edges | centres and edges of the cells |
//! | `p_x`, `p_xy` | parameter, axes … | density; attribute `centre_of_symmetry` where the system declares one, `own_ends` where ends are the system's own, `formulas` of quantities |
//! | `p_x_error` | as `p_x` | standard error, with what open ends of the ranges may have changed (generator) |
//! | `p_x_second` | as `p_x` | density by a second discretisation (generator) |
//! | `range_ends` | parameter, density, number | what the ends of the ranges may have changed of each density (generator) |
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
use crate::density::{EstimatedDensity, Kink, Observable, Variants};
use crate::system::Family;

/// What the array of the parameter is, in words.
const SWEPT: &str = "swept parameter";
/// Name of the dimension of replicates.
const REPLICATE: &str = "replicate";

/// Attribute of a density.
pub(super) const CENTRE: &str = "centre_of_symmetry";

/// Attribute of a density: of each axis whether its ends are the system's own; none where no end is.
pub(super) const OWN_ENDS: &str = "own_ends";

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

/// What the array of [`EndNumber`]s is, in words.
const RANGE_ENDS_WORDS: &str = "what ends of the ranges may have changed of each density";
/// The name of that array. Its two dimensions beside the parameter are called after the attributes that name what
/// stands along them.
pub(super) const RANGE_ENDS: &str = "range_ends";
/// Attribute: densities by their arrays, in the order in which their numbers stand.
pub(super) const RANGE_ENDS_DENSITIES: &str = "densities";
/// Attribute: the words of the numbers of a density, in their order.
pub(super) const RANGE_ENDS_NUMBERS: &str = "numbers";

/// A number that a density has at a value of the parameter because its ranges have ends: with those of all densities
/// it stands in one array, since an array of its own takes two files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum EndNumber {
    /// The share by which all of a density may have been changed.
    Share,
    /// The density at open ends.
    Level,
}

// The words are the endings of the arrays that each of them had in earlier versions.
words! { EndNumber, pub(super) word: Share: "truncated", Level: "end_level" }

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

    /// The numbers of all densities that the ends of the ranges leave, by the names of the densities.
    pub(super) fn range_ends(family: &Family, densities: &[String]) -> Self {
        let numbers = EndNumber::ALL.map(EndNumber::word);
        let dimensions = vec![
            (family.parameter().to_owned(), 1),
            (
                along_range_ends(RANGE_ENDS_DENSITIES),
                densities.len() as u64,
            ),
            (along_range_ends(RANGE_ENDS_NUMBERS), numbers.len() as u64),
        ];
        Self::new(
            RANGE_ENDS.to_owned(),
            dimensions,
            RANGE_ENDS_WORDS.to_owned(),
        )
        .attribute(RANGE_ENDS_DENSITIES, json!(densities))
        .attribute(RANGE_ENDS_NUMBERS, json!(numbers))
    }

    /// Whether it has a row for every value of the parameter.
    pub(super) fn is_along(&self, family: &Family) -> bool {
        let first = self.dimensions.first();
        first.is_some_and(|(name, _)| name == family.parameter())
    }

    /// One of the parts of a density, but its kinks; of replicates so many.
    pub(super) fn part(part: DensityPart, family: &Family, estimate: &EstimatedDensity) -> Self {
        let observable = estimate.observable;
        let long_name = part.long_name(&words(family, observable));
        let mut layout = Self::of_cells(family, estimate, part.name(family, observable), long_name);
        match (part, &estimate.variants) {
            (DensityPart::Density, _) => return layout.with_facts(family, estimate),
            (DensityPart::Replicates, Variants::Jackknife(all)) => {
                let count = all.len() as u64;
                layout.dimensions.insert(1, (REPLICATE.to_owned(), count));
            }
            _ => {}
        }
        layout
    }

    /// What is known of a density besides its values.
    fn with_facts(self, family: &Family, estimate: &EstimatedDensity) -> Self {
        let layout = self.attribute(NEGLIGIBLE, json!(estimate.negligible));
        let layout = match formulas(family, estimate.observable) {
            Some(formulas) => layout.attribute(FORMULAS, formulas),
            None => layout,
        };
        let own_ends = &estimate.structure.own_ends;
        let layout = match own_ends.is_empty() {
            true => layout,
            false => layout.attribute(OWN_ENDS, json!(own_ends)),
        };
        match &estimate.structure.centre {
            Some(centre) => layout.attribute(CENTRE, json!(centre)),
            None => layout,
        }
    }

    /// The kink of the given number.
    pub(super) fn kink(
        family: &Family,
        estimate: &EstimatedDensity,
        kink: &Kink,
        number: usize,
    ) -> Self {
        let name = format!(
            "{}{number}",
            DensityPart::Kinks.name(family, estimate.observable)
        );
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

/// What is stored of a density, an array each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum DensityPart {
    /// The density itself.
    Density,
    /// Its standard error.
    Error,
    /// The density by a second discretisation.
    Second,
    /// By how much closed ends, and modes that are not there, may change the density.
    Closed,
    /// The densities without one group of samples each.
    Replicates,
    /// Its kinks, an array each.
    Kinks,
}

words! {
    DensityPart, ending: Density: "", Error: "_error", Second: "_second", Closed: "_closed",
    Replicates: "_replicate", Kinks: "_kink_"
}

impl DensityPart {
    /// Name of its array; of kinks without their numbers.
    pub(super) fn name(self, family: &Family, observable: Observable) -> String {
        format!("p_{}{}", observable.name(family), self.ending())
    }

    /// What it is, before the words for the density.
    fn before(self) -> &'static str {
        match self {
            Self::Density => "",
            Self::Error => "standard error of the ",
            Self::Second => "second discretisation of the ",
            Self::Closed => "what closed ends may change of the ",
            Self::Replicates => "replicates of the ",
            Self::Kinks => "kinks of the ",
        }
    }

    /// What it is, as the store says it.
    fn long_name(self, density: &str) -> String {
        match self {
            Self::Second => format!("{density} by a second discretisation"),
            Self::Closed => format!("what closed ends of the ranges may change of the {density}"),
            Self::Replicates => format!("{density} without one group of samples each"),
            part => format!("{}{density}", part.before()),
        }
    }
}

/// Name of a dimension of the array of [`EndNumber`]s.
fn along_range_ends(what: &str) -> String {
    format!("{RANGE_ENDS}_{what}")
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
        Named::new(RANGE_ENDS, RANGE_ENDS_WORDS),
    ];
    let along = [RANGE_ENDS_DENSITIES, RANGE_ENDS_NUMBERS].map(along_range_ends);
    names.extend(along.map(|name| Named::new(name, RANGE_ENDS_WORDS)));
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
        let named = |part: DensityPart| {
            let what = format!("{}{density_of}", part.before());
            Named {
                is_numbered: part == DensityPart::Kinks,
                ..Named::new(part.name(family, observable), what)
            }
        };
        names.extend(DensityPart::ALL.map(named));
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
