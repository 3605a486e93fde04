//! What the page is told of a plane of two parameters: its regions, the curves between them, and the points where these
//! meet, as they stand in the tables of a map.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

use super::ExploreError;
use crate::continuation::Subject;
use crate::continuation::curve::Plane;
use crate::continuation::map::{PlaneState, Seed, flooded};
use crate::run::{MapTables, Rows};
use crate::sweep_file::Sweep;

/// Columns and rows of the picture of the regions.
const PICTURE: [usize; 2] = [240, 240];

/// The plane of a sweep with a second parameter.
#[derive(Debug, Serialize)]
pub(super) struct PlaneScene {
    /// The swept parameter and the second one.
    sides: [Side; 2],
    /// What its map found; `None` of a live page, which has none yet.
    pub(super) found: Option<PlaneFound>,
}

#[derive(Debug, Serialize)]
struct Side {
    name: String,
    symbol: String,
    from: f64,
    to: f64,
}

/// What a map found.
#[derive(Debug, Serialize)]
pub(super) struct PlaneFound {
    /// Nodes that were solved.
    nodes: usize,
    /// Of every watched density.
    regions: Vec<Regions>,
    curves: Vec<CurveTold>,
    points: Vec<SpecialPoint>,
}

/// The regions of one watched density.
#[derive(Debug, Serialize)]
struct Regions {
    /// Signatures in words; empty where there is no density.
    kinds: Vec<String>,
    size: [usize; 2],
    /// The kind of every pixel, a byte each, in base64; rows from the lower end of the second parameter upward.
    pixels: String,
    places: Vec<Place>,
}

/// Where there is room for the words of a region.
#[derive(Debug, Serialize)]
struct Place {
    kind: usize,
    /// In the box with sides of length one.
    at: [f64; 2],
    share: f64,
}

/// A curve from end to end.
#[derive(Debug, Serialize)]
struct CurveTold {
    name: String,
    /// Number among the observables.
    observable: Option<usize>,
    method: String,
    /// Both parameters, the error as a share of the sides of the box, and the way to the edge of the band.
    points: Vec<[f64; 5]>,
    statuses: Vec<String>,
    labels: Vec<String>,
}

/// A point of codimension two.
#[derive(Debug, Serialize)]
struct SpecialPoint {
    label: String,
    kind: String,
    at: [f64; 2],
    /// A share of the sides of the box.
    error: f64,
    status: String,
    observable: String,
    curves: String,
}

impl PlaneScene {
    /// The plane of a sweep with `[map]`, with what the tables of a map say of it; `None` without the section.
    pub(super) fn new(
        sweep: &Sweep,
        tables: Option<&MapTables>,
    ) -> Result<Option<Self>, ExploreError> {
        let map = sweep.settings.map.as_ref();
        let plane = map.and_then(|map| map.plane(&sweep.settings.family));
        let scene = plane.map(|plane| Self::of(&plane, sweep, tables));
        scene.transpose()
    }

    /// The same of the box of a plane, with what tables say of it.
    pub(super) fn of(
        plane: &Plane,
        sweep: &Sweep,
        tables: Option<&MapTables>,
    ) -> Result<Self, ExploreError> {
        let family = &sweep.settings.family;
        let symbol = |name: &str| {
            let mut parameters = family.model().parameters.iter();
            let known = parameters.find(|parameter| parameter.name == name);
            known
                .map_or(name, |parameter| parameter.symbol.as_str())
                .to_owned()
        };
        let sides = plane.sides().each_ref().map(|side| Side {
            name: side.parameter.clone(),
            symbol: symbol(&side.parameter),
            from: side.from,
            to: side.to,
        });
        let subject = sweep.problem.subject();
        let scene = Self { sides, found: None };
        let found = tables.map(|tables| scene.found_in(tables, subject));
        Ok(Self {
            found: found.transpose()?,
            ..scene
        })
    }

    /// States as the nodes of a table.
    pub(super) fn nodes_of(states: &[PlaneState], plane: &Plane, subject: &Subject) -> Rows {
        let names = subject.observables.iter();
        let names: Vec<String> = names
            .map(|one| format!("signature_{}", one.name(&subject.family)))
            .collect();
        let row = |state: &PlaneState| {
            let sides = plane.sides().iter().zip(state.values);
            let values = sides.map(|(side, value)| (side.parameter.clone(), value.to_string()));
            let found = state.point.detections.iter();
            let found = found.map(|detection| detection.signature.to_string());
            let level = ("level".to_owned(), "0".to_owned());
            let cells = values
                .chain([level])
                .chain(names.iter().cloned().zip(found));
            cells.collect()
        };
        states.iter().map(row).collect()
    }

    fn found_in(&self, tables: &MapTables, subject: &Subject) -> Result<PlaneFound, ExploreError> {
        let observables = subject.observables.iter();
        let names: Vec<String> = observables.map(|one| one.name(&subject.family)).collect();
        let curves = self.curves(&tables.curves, &names)?;
        let regions = names.iter().enumerate();
        let regions = regions.map(|(number, name)| {
            let lines = curves
                .iter()
                .filter(|curve| curve.observable == Some(number));
            let line = |curve: &CurveTold| {
                let points = curve.points.iter();
                points
                    .map(|point| self.share([point[0], point[1]]))
                    .collect()
            };
            self.regions(&tables.nodes, name, &lines.map(line).collect::<Vec<_>>())
        });
        Ok(PlaneFound {
            nodes: tables.nodes.len(),
            regions: regions.collect::<Result<_, _>>()?,
            points: self.points(&tables.codimension_two)?,
            curves,
        })
    }

    /// Where two values lie in the box with sides of length one.
    fn share(&self, values: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| (values[k] - self.sides[k].from) / (self.sides[k].to - self.sides[k].from))
    }

    fn values(
        &self,
        row: &std::collections::BTreeMap<String, String>,
    ) -> Result<[f64; 2], ExploreError> {
        let [first, second] = self.sides.each_ref().map(|side| number(row, &side.name));
        Ok([first?, second?])
    }

    /// The values of both parameters that make the coarse grid of a map, ascending, at most so many of each; both ends
    /// are among them.
    pub(super) fn grid(&self, nodes: &Rows, most: usize) -> Result<[Vec<f64>; 2], ExploreError> {
        let mut sides = [Vec::new(), Vec::new()];
        for row in nodes.iter().filter(|row| word(row, "level") == "0") {
            let values = self.values(row)?;
            (0..2).for_each(|k| sides[k].push(values[k]));
        }
        Ok(sides.map(|mut values: Vec<f64>| {
            values.sort_by(f64::total_cmp);
            values.dedup();
            thinned(&values, most)
        }))
    }

    fn regions(
        &self,
        nodes: &Rows,
        name: &str,
        lines: &[Vec<[f64; 2]>],
    ) -> Result<Regions, ExploreError> {
        let mut kinds: Vec<String> = Vec::new();
        let mut seeds = Vec::new();
        let mut finest = 0;
        let column = format!("signature_{name}");
        for row in nodes {
            let words = word(row, &column);
            let known = kinds.iter().position(|kind| kind == words);
            let kind = known.unwrap_or_else(|| {
                kinds.push(words.to_owned());
                kinds.len() - 1
            });
            finest = finest.max(number(row, "level")? as i32);
            let place = self.share(self.values(row)?);
            seeds.push(Seed { place, kind });
        }
        let coarse = self.grid(nodes, usize::MAX)?;
        let widest = coarse.map(|values| 1.0 / (values.len().max(2) - 1) as f64);
        let smallest = widest[0].max(widest[1]) / f64::from(1 << finest.min(30));
        let found = flooded(PICTURE, lines, &seeds, smallest);
        let kind = |&region: &usize| {
            found
                .regions
                .get(region)
                .map_or(0, |one| one.kind.min(255) as u8)
        };
        let pixels: Vec<u8> = found.pixels.iter().map(kind).collect();
        let place = |region: &crate::continuation::map::FloodedRegion| Place {
            kind: region.kind,
            at: region.inside,
            share: region.share,
        };
        Ok(Regions {
            kinds,
            size: PICTURE,
            pixels: STANDARD.encode(pixels),
            places: found.regions.iter().map(place).collect(),
        })
    }

    fn curves(&self, rows: &Rows, names: &[String]) -> Result<Vec<CurveTold>, ExploreError> {
        let mut curves: Vec<CurveTold> = Vec::new();
        for row in rows {
            let name = word(row, "curve");
            if curves.last().is_none_or(|curve| curve.name != name) {
                curves.push(CurveTold {
                    name: name.to_owned(),
                    observable: names.iter().position(|one| one == word(row, "observable")),
                    method: word(row, "method").to_owned(),
                    points: Vec::new(),
                    statuses: Vec::new(),
                    labels: Vec::new(),
                });
            }
            let [x, y] = self.values(row)?;
            let [to_x, to_y] = (self.sides.each_ref())
                .map(|side| number(row, &format!("edge_{}", side.name)).unwrap_or(0.0));
            let error = number(row, "error").unwrap_or(0.0);
            if let Some(curve) = curves.last_mut() {
                curve.points.push([x, y, error, to_x, to_y]);
                curve.statuses.push(word(row, "status").to_owned());
                curve.labels.push(word(row, "label").to_owned());
            }
        }
        Ok(curves)
    }

    fn points(&self, rows: &Rows) -> Result<Vec<SpecialPoint>, ExploreError> {
        let point = |row| {
            let of = |column: &str| word(row, column).to_owned();
            Ok(SpecialPoint {
                label: of("label"),
                kind: of("kind"),
                at: self.values(row)?,
                error: number(row, "error").unwrap_or(0.0),
                status: of("status"),
                observable: of("observable"),
                curves: of("curves"),
            })
        };
        rows.iter().map(point).collect()
    }
}

fn word<'r>(row: &'r std::collections::BTreeMap<String, String>, column: &str) -> &'r str {
    row.get(column).map_or("", String::as_str)
}

fn number(
    row: &std::collections::BTreeMap<String, String>,
    column: &str,
) -> Result<f64, ExploreError> {
    let text = word(row, column);
    let number = text.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| ExploreError::MapTable {
        column: column.to_owned(),
        value: text.to_owned(),
    })
}

/// So many values at most, evenly over all, both ends among them.
fn thinned(values: &[f64], most: usize) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    let step = last.div_ceil(most.max(2) - 1).max(1);
    let mut kept: Vec<f64> = values.iter().copied().step_by(step).collect();
    if !last.is_multiple_of(step) {
        kept.push(values[last]);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_stay_when_values_are_thinned() {
        let values: Vec<f64> = (0..40).map(f64::from).collect();
        for most in [2, 3, 7, 21, 39, 40, 100, usize::MAX] {
            let kept = thinned(&values, most);
            assert!(kept.len() <= most && kept.first() == Some(&0.0) && kept.last() == Some(&39.0));
            assert!(kept.windows(2).all(|pair| pair[0] < pair[1]), "{kept:?}");
        }
        assert_eq!(thinned(&values, usize::MAX), values);
        assert_eq!(thinned(&[1.0], 5), [1.0]);
        assert!(thinned(&[], 5).is_empty());
    }
}
