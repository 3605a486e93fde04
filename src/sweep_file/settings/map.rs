//! The second parameter of a map of regimes.

use super::system::{check_range, known_parameter};
use crate::continuation::curve::{CurveOptions, Plane};
use crate::continuation::map::MapOptions;
use crate::sweep_file::diagnostic::Diagnostic;
use crate::sweep_file::draft::Draft;
use crate::sweep_file::reader::Reader;
use crate::system::{Family, Model, ParameterDescription};

/// A map of regimes over the swept and a second parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct MapSettings {
    /// The second parameter. A sweep of the first alone holds it at its value.
    pub parameter: String,
    /// Its lowest value.
    pub from: f64,
    /// Its highest value.
    pub to: f64,
    /// Values of it in the coarse grid.
    pub points: usize,
    /// How often cells of the coarse grid are halved at most.
    pub depth: usize,
    /// Whether curves are followed.
    pub curves: bool,
}

impl MapSettings {
    /// The box of the map: the swept range of a family's parameter, and the range of the second one; `None` where these
    /// make no box, which checked settings always do.
    pub fn plane(&self, family: &Family) -> Option<Plane> {
        let (low, high) = family.range();
        let first = (family.parameter(), low, high);
        Plane::new(first, (self.parameter.as_str(), self.from, self.to)).ok()
    }

    /// How the map is made, with so many values of the first parameter.
    pub(in crate::sweep_file) fn options(&self, points: usize, curves: CurveOptions) -> MapOptions {
        MapOptions {
            counts: [points, self.points],
            depth: self.depth,
            curves: self.curves.then_some(curves),
        }
    }
}

/// Checks `[map]`; `None` where there is none, or something is wrong with it.
pub(super) fn read(
    reader: &mut Reader<'_>,
    draft: &Draft,
    model: &Model,
    points: Option<usize>,
) -> Option<MapSettings> {
    reader.entry(&["map"])?;
    for key in ["parameter", "from", "to"] {
        reader.require(&["map", key]);
    }
    let name = draft.map.parameter.as_deref()?;
    let swept = draft.parameter.as_deref().unwrap_or_default();
    let parameter = is_second(reader, (model, swept), name, "map")?;
    let (from, to) = (draft.map.from?, draft.map.to?);
    for (key, value) in [("from", from), ("to", to)] {
        if let Some(place) = reader.place(&["map", key]) {
            let label = "the map goes here";
            if !check_range(reader, model, parameter, value, place, label) {
                return None;
            }
        }
    }
    if from == to || !(to - from).is_finite() {
        let diagnostic =
            Diagnostic::new(format!("the map goes from {from} to {to} along `{name}`"))
                .allowed("two different ends, in either order");
        reader.report(diagnostic.at(reader.place(&["map", "to"]), "no range"));
        return None;
    }
    let points = draft.map.points.or(points)?;
    Some(MapSettings {
        parameter: name.to_owned(),
        from: from.min(to),
        to: from.max(to),
        points,
        depth: draft.map.depth.unwrap_or(MapOptions::default().depth),
        curves: draft.map.curves.unwrap_or(true),
    })
}

/// The second parameter of a plane by its name under `section`; refuses one that the model does not have, and the swept
/// one.
pub(super) fn is_second<'m>(
    reader: &mut Reader<'_>,
    (model, swept): (&'m Model, &str),
    name: &str,
    section: &str,
) -> Option<&'m ParameterDescription> {
    let place = reader.place(&[section, "parameter"]);
    let parameter = known_parameter(reader, model, name, place)?;
    if swept != name {
        return Some(parameter);
    }
    let title = format!("the second parameter of the {section} is the swept one, `{name}`");
    let others = model.parameters.iter().map(|one| one.name.clone());
    let others: Vec<String> = others.filter(|one| one != name).collect();
    let diagnostic = Diagnostic::new(title).allowed(crate::sweep_file::names::list(&others));
    reader.report(diagnostic.at(place, "the same as `sweep.parameter`"));
    None
}
