//! Names that a sweep file gives become names of columns and arrays, beside those of the program. No two columns of a
//! table, and no two arrays of a store, may have one name: the later would take the place of the earlier.

use super::columns::Named;
use super::{
    arrays, checks, codimension, compare, export, features_table, levels_table, map, points_table,
    spectra,
};
use crate::continuation::curve::Plane;
use crate::continuation::{MeasureColumn, asked_of};
use crate::density::Observable;
use crate::method::columns_of_family;
use crate::sweep_file::{Diagnostic, Place, Report, Settings};
use crate::system::Family;

/// Columns or arrays that stand together: what they are of, in words, and their names.
type Together = (&'static str, Vec<Named>);

/// Refuses a sweep file of which a run would have two columns of a table, or two arrays of a store, of one name.
///
/// # Errors
/// A report with the place of every name that has to be another one.
pub fn check_names(settings: &Settings) -> Result<(), Report> {
    check(settings, together(settings))
}

/// The same of a file by which methods are compared.
///
/// # Errors
/// As [`check_names`].
pub(crate) fn check_names_compared(settings: &Settings) -> Result<(), Report> {
    let tables = compare::column_names(&settings.family, &settings.observables);
    check(settings, tables)
}

fn check(settings: &Settings, together: Vec<Together>) -> Result<(), Report> {
    let given = settings.given_names();
    let mut changed: Vec<&str> = Vec::new();
    let mut found = Vec::new();
    for (kind, names) in together {
        for (index, later) in names.iter().enumerate() {
            let mut earlier = names[..index].iter();
            let clash = earlier.find_map(|one| Some((one, one.shared(later)?)));
            let Some((earlier, name)) = clash else {
                continue;
            };
            let own = own_name(name, &given);
            if own.is_some_and(|(own, _)| changed.contains(&own.as_str())) {
                continue;
            }
            changed.extend(own.map(|(own, _)| own.as_str()));
            found.push(diagnostic((kind, name), [earlier, later], own));
        }
    }
    if found.is_empty() {
        return Ok(());
    }
    Err(settings.refuse_all(found))
}

/// The name of the file's own that makes this name: the longest that is in it.
fn own_name<'g>(name: &str, given: &'g [(String, Place)]) -> Option<&'g (String, Place)> {
    let inside = given.iter().filter(|(given, _)| name.contains(given));
    inside.max_by_key(|(given, _)| given.len())
}

fn diagnostic(
    (kind, name): (&str, &str),
    both: [&Named; 2],
    own: Option<&(String, Place)>,
) -> Diagnostic {
    let mut title = format!("two {kind} would be called `{name}`");
    let what = both.map(|one| one.what.as_str());
    if what.iter().all(|what| !what.is_empty()) {
        title += &format!(": the {}, and the {}", what[0], what[1]);
    }
    let found = Diagnostic::new(title);
    match own {
        Some((own, place)) => found
            .at(place, "by this name")
            .remedy(format!("give `{own}` another name")),
        None => found.remedy("watch other quantities, or give them other names"),
    }
}

/// The names of everything that a run of the file writes, and of what `pbif export` makes of it.
fn together(settings: &Settings) -> Vec<Together> {
    let (family, observables) = (&settings.family, &settings.observables[..]);
    let map = settings.map.as_ref().and_then(|map| map.plane(family));
    if let Some(plane) = map {
        return of_map(family, observables, &plane);
    }
    let measures = settings.measures.iter().flatten();
    let measures: Vec<MeasureColumn> = measures
        .flat_map(|measure| measure.columns(family, observables))
        .chain(columns_of_family(family))
        .collect();
    let mut all = of_sweep(family, observables, &measures);
    let curve = settings.curve.as_ref().and_then(|curve| {
        let first = (family.parameter(), curve.first.0, curve.first.1);
        Plane::new(first, (curve.parameter.as_str(), curve.from, curve.to)).ok()
    });
    all.extend(curve.iter().flat_map(|plane| of_curves(family, plane)));
    all
}

fn of_sweep(
    family: &Family,
    observables: &[Observable],
    measures: &[MeasureColumn],
) -> Vec<Together> {
    let stored = arrays::names(family, observables);
    let moments = export::moments(family).map(|(name, what)| Named::new(name, what));
    let coordinates = arrays::names(family, observables);
    vec![
        ("arrays of densities.zarr", stored),
        (
            "columns of points.csv",
            points_table::columns(family, observables, measures, &[]).names(),
        ),
        (
            "columns of features.csv",
            features_table::columns(family).names(),
        ),
        (
            "columns of checks.csv",
            checks::columns(family, observables).names(),
        ),
        (
            "columns of spectra.csv",
            spectra::spectra_columns(family).names(),
        ),
        (
            "columns of correlations.csv",
            spectra::correlations_columns(family).names(),
        ),
        (
            "arrays of an export",
            coordinates.into_iter().chain(moments).collect(),
        ),
    ]
}

fn of_map(family: &Family, observables: &[Observable], plane: &Plane) -> Vec<Together> {
    let [first, second] = plane.sides().each_ref().map(|side| side.parameter.as_str());
    let nodes = map::columns(family, observables, [first, second]);
    let densities = observables.iter().map(|observable| {
        let names = map::density_columns(family, *observable, [first, second]);
        let names = names.into_iter().map(|name| Named::new(name, ""));
        ("columns of a table in densities", names.collect())
    });
    let mut all = vec![("columns of map.csv", nodes.names())];
    all.extend(densities);
    all.extend(of_curves(family, plane));
    all
}

fn of_curves(family: &Family, plane: &Plane) -> Vec<Together> {
    let levels = levels_table::columns(plane).names();
    let has_levels = !asked_of(family).is_empty();
    let levels = has_levels.then_some(("columns of levels.csv", levels));
    let others = [
        (
            "columns of curves.csv",
            codimension::several_columns(family, plane, 0).names(),
        ),
        (
            "columns of codimension_two.csv",
            codimension::columns(family, plane).names(),
        ),
    ];
    others.into_iter().chain(levels).collect()
}
