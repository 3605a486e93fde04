//! What the page is told of a plane of two parameters: its regions, the curves between them, and the points where these
//! meet.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use crate::continuation::Subject;
use crate::continuation::curve::{
    CodimensionTwo, Curve, CurvePoint, LevelCurve, Plane, codimension_two, level_name,
};
use crate::continuation::map::{MapNode, PlaneState, Seed, flood};
use crate::density::Observable;
use crate::run::{curve_name, end_labels, point_labels};
use crate::sweep_file::Sweep;
use crate::system::Family;

/// Columns and rows of the picture of the regions.
const PICTURE: [usize; 2] = [240, 240];

/// The plane of a sweep with a second parameter.
pub(super) struct PlaneScene {
    plane: Plane,
    /// Symbols of the swept parameter and the second one.
    symbols: [String; 2],
    /// What its map found; null of a live page, which has none yet.
    pub(super) found: Value,
}

impl PlaneScene {
    /// The plane of a sweep with `[map]`; `None` without the section.
    pub(super) fn new(sweep: &Sweep) -> Option<Self> {
        let map = sweep.settings.map.as_ref();
        let plane = map.and_then(|map| map.plane(&sweep.settings.family));
        plane.map(|plane| Self::of(&plane, sweep.problem.family()))
    }

    /// The box of a plane.
    pub(super) fn of(plane: &Plane, family: &Family) -> Self {
        let sides = plane.sides().each_ref();
        Self {
            plane: plane.clone(),
            symbols: sides.map(|side| family.symbol_of(&side.parameter).to_owned()),
            found: Value::Null,
        }
    }

    /// What the page is told of it.
    pub(super) fn told(&self) -> Value {
        let sides = self.plane.sides().iter().zip(&self.symbols);
        let sides = sides.map(|(side, symbol)| {
            json!({ "name": side.parameter, "symbol": symbol, "from": side.from, "to": side.to })
        });
        json!({ "sides": sides.collect::<Vec<_>>(), "found": self.found })
    }

    /// The same with what was found there; `start` is the label of the row that the first curve was begun at, if it
    /// was.
    pub(super) fn with(
        self,
        subject: &Subject,
        nodes: &[MapNode],
        (curves, levels, start): (&[Curve], &[LevelCurve], &str),
    ) -> Self {
        let lines = |observable: Observable| -> Vec<Vec<[f64; 2]>> {
            let of = curves.iter().filter(|curve| curve.observable == observable);
            let line = |curve: &Curve| {
                let points = curve.points.iter();
                points.map(|point| self.share(point.values)).collect()
            };
            of.map(line).collect()
        };
        let observables = subject.observables.iter().enumerate();
        let regions = observables
            .map(|(number, &observable)| self.regions(nodes, number, &lines(observable)));
        let told = curves.iter().enumerate().map(|(index, curve)| {
            let start = if index == 0 { start } else { "start" };
            let mut observables = subject.observables.iter();
            // The number among the observables.
            let observable = observables.position(|one| *one == curve.observable);
            let labels = point_labels(curve, start);
            let words = (curve_name(index), curve.kind.name().to_owned());
            curve_told(words, observable, &curve.points, &labels)
        });
        let is_first = curves.is_empty();
        let of_levels = levels.iter().enumerate().map(|(index, curve)| {
            let start = if is_first && index == 0 {
                start
            } else {
                "start"
            };
            let labels = end_labels(&curve.ends, (curve.start, start), curve.points.len());
            curve_told(
                (level_name(index), curve.words()),
                None,
                &curve.points,
                &labels,
            )
        });
        let points = codimension_two(curves);
        let points = points.iter().map(|one| point_told(&subject.family, one));
        let found = json!({
            // Nodes that were solved.
            "nodes": nodes.len(),
            "regions": regions.collect::<Vec<_>>(),
            "curves": told.chain(of_levels).collect::<Vec<_>>(),
            "points": points.collect::<Vec<_>>(),
        });
        Self { found, ..self }
    }

    /// Where two values lie in the box with sides of length one.
    fn share(&self, values: [f64; 2]) -> [f64; 2] {
        let sides = self.plane.sides();
        [0, 1].map(|k| (values[k] - sides[k].from) / (sides[k].to - sides[k].from))
    }

    /// The regions of one watched density.
    fn regions(&self, nodes: &[MapNode], observable: usize, lines: &[Vec<[f64; 2]>]) -> Value {
        let mut kinds: Vec<String> = Vec::new();
        let mut seeds = Vec::new();
        let mut finest = 0;
        for node in nodes {
            let words = node.signatures.get(observable);
            let words = words.map_or_else(String::new, ToString::to_string);
            let known = kinds.iter().position(|kind| *kind == words);
            let kind = known.unwrap_or_else(|| {
                kinds.push(words);
                kinds.len() - 1
            });
            finest = finest.max(node.level);
            let place = self.share(node.values);
            seeds.push(Seed { place, kind });
        }
        let coarse = coarse_grid(nodes, usize::MAX);
        let widest = coarse.map(|values| 1.0 / (values.len().max(2) - 1) as f64);
        let smallest = widest[0].max(widest[1]) / f64::from(1_u32 << finest.min(30));
        let found = flood(PICTURE, lines, &seeds, smallest);
        let kind = |&region: &usize| {
            let region = found.regions.get(region);
            region.map_or(0, |one| one.kind.min(255) as u8)
        };
        let pixels: Vec<u8> = found.pixels.iter().map(kind).collect();
        // Where there is room for the words of a region, in the box with sides of length one.
        let places = found
            .regions
            .iter()
            .map(|one| json!({ "kind": one.kind, "at": one.inside, "share": one.share }));
        json!({
            // Signatures in words; empty where there is no density.
            "kinds": kinds,
            "size": PICTURE,
            // The kind of every pixel, a byte each; rows from the lower end of the second parameter upward.
            "pixels": STANDARD.encode(pixels),
            "places": places.collect::<Vec<_>>(),
        })
    }
}

/// A curve from end to end, by its name and what it is; of a point both parameters, the error as a share of the sides
/// of the box, and the way to the edge of the band.
fn curve_told(
    (name, method): (String, String),
    observable: Option<usize>,
    points: &[CurvePoint],
    labels: &[String],
) -> Value {
    let finite = |value: f64| if value.is_finite() { value } else { 0.0 };
    let point = |point: &CurvePoint| {
        let ([x, y], [to_x, to_y]) = (point.values, point.to_edge.map(finite));
        [x, y, finite(point.error), to_x, to_y]
    };
    let statuses = points.iter().map(|point| point.status().word());
    json!({
        "name": name,
        "observable": observable,
        "method": method,
        "points": points.iter().map(point).collect::<Vec<_>>(),
        "statuses": statuses.collect::<Vec<_>>(),
        "labels": labels,
    })
}

/// A point of codimension two; its error is a share of the sides of the box.
fn point_told(family: &Family, point: &CodimensionTwo) -> Value {
    let observables = point.observables.iter().map(|one| one.name(family));
    let curves = point.curves.iter().map(|&index| curve_name(index));
    json!({
        "label": point.label,
        "kind": point.kind.name(),
        "at": point.values,
        "error": point.error,
        "status": point.status().word(),
        "observable": observables.collect::<Vec<_>>().join(" "),
        "curves": curves.collect::<Vec<_>>().join(" "),
    })
}

/// The values of both parameters that make the coarse grid of a map, ascending, at most so many of each; both ends are
/// among them.
pub(super) fn coarse_grid(nodes: &[MapNode], most: usize) -> [Vec<f64>; 2] {
    let coarse = nodes.iter().filter(|node| node.level == 0);
    [0, 1].map(|side| {
        let mut values: Vec<f64> = coarse.clone().map(|node| node.values[side]).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        thin_out(&values, most)
    })
}

/// States as the nodes of a map.
pub(super) fn nodes_of(states: &[PlaneState]) -> Vec<MapNode> {
    let node = |state: &PlaneState| MapNode {
        values: state.values,
        level: 0,
        status: state.point.report.status,
        signatures: (state.point.detections.iter())
            .map(|one| one.signature)
            .collect(),
        is_seen: true,
        reason: None,
        numbers: Vec::new(),
        findings: state.point.report.findings.clone(),
    };
    states.iter().map(node).collect()
}

/// So many values at most, evenly over all, both ends among them.
fn thin_out(values: &[f64], most: usize) -> Vec<f64> {
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
            let kept = thin_out(&values, most);
            assert!(kept.len() <= most && kept.first() == Some(&0.0) && kept.last() == Some(&39.0));
            assert!(kept.windows(2).all(|pair| pair[0] < pair[1]), "{kept:?}");
        }
        assert_eq!(thin_out(&values, usize::MAX), values);
        assert_eq!(thin_out(&[1.0], 5), [1.0]);
        assert!(thin_out(&[], 5).is_empty());
    }
}
