//! What the page is told of a plane of two parameters: its regions, the curves between them, and the points where these
//! meet.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

use crate::continuation::Subject;
use crate::continuation::curve::{
    CodimensionTwo, Curve, CurvePoint, LevelCurve, Plane, codimension_two, level_name,
};
use crate::continuation::map::{FloodedRegion, MapNode, PlaneState, Seed, flood};
use crate::density::Observable;
use crate::run::{curve_name, end_labels, point_labels};
use crate::sweep_file::Sweep;
use crate::system::Family;

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
    curves: Vec<PlaneCurve>,
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
    places: Vec<Anchor>,
}

/// Where there is room for the words of a region.
#[derive(Debug, Serialize)]
struct Anchor {
    kind: usize,
    /// In the box with sides of length one.
    at: [f64; 2],
    share: f64,
}

/// A curve from end to end.
#[derive(Debug, Serialize)]
struct PlaneCurve {
    name: String,
    /// Number among the observables; none of the curve of a level.
    observable: Option<usize>,
    method: String,
    /// Both parameters, the error as a share of the sides of the box, and the way to the edge of the band.
    points: Vec<[f64; 5]>,
    statuses: Vec<&'static str>,
    labels: Vec<String>,
}

/// A point of codimension two.
#[derive(Debug, Serialize)]
struct SpecialPoint {
    label: String,
    kind: &'static str,
    at: [f64; 2],
    /// A share of the sides of the box.
    error: f64,
    status: &'static str,
    observable: String,
    curves: String,
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
        Self { sides, found: None }
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
            .map(|(number, &observable)| self.regions(nodes, number, &lines(observable)))
            .collect();
        let told = curves.iter().enumerate().map(|(index, curve)| {
            let start = if index == 0 { start } else { "start" };
            PlaneCurve::new(subject, (index, curve), start)
        });
        let is_first = curves.is_empty();
        let of_levels = levels.iter().enumerate().map(|(index, curve)| {
            let start = if is_first && index == 0 {
                start
            } else {
                "start"
            };
            PlaneCurve::of_level((index, curve), start)
        });
        let told = told.chain(of_levels);
        let points = codimension_two(curves);
        let points = points
            .iter()
            .map(|one| SpecialPoint::new(&subject.family, one));
        let found = PlaneFound {
            nodes: nodes.len(),
            regions,
            curves: told.collect(),
            points: points.collect(),
        };
        Self {
            found: Some(found),
            ..self
        }
    }

    /// Where two values lie in the box with sides of length one.
    fn share(&self, values: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| (values[k] - self.sides[k].from) / (self.sides[k].to - self.sides[k].from))
    }

    fn regions(&self, nodes: &[MapNode], observable: usize, lines: &[Vec<[f64; 2]>]) -> Regions {
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
        let place = |region: &FloodedRegion| Anchor {
            kind: region.kind,
            at: region.inside,
            share: region.share,
        };
        Regions {
            kinds,
            size: PICTURE,
            pixels: STANDARD.encode(pixels),
            places: found.regions.iter().map(place).collect(),
        }
    }
}

impl PlaneCurve {
    fn new(subject: &Subject, (index, curve): (usize, &Curve), start: &str) -> Self {
        let mut observables = subject.observables.iter();
        Self {
            name: curve_name(index),
            observable: observables.position(|one| *one == curve.observable),
            method: curve.kind.name().to_owned(),
            labels: point_labels(curve, start),
            ..Self::through(&curve.points)
        }
    }

    /// The curve of a level, which is of no density.
    fn of_level((index, curve): (usize, &LevelCurve), start: &str) -> Self {
        let begun = (curve.start, start);
        Self {
            name: level_name(index),
            method: curve.words(),
            labels: end_labels(&curve.ends, begun, curve.points.len()),
            ..Self::through(&curve.points)
        }
    }

    /// The points alone.
    fn through(points: &[CurvePoint]) -> Self {
        let finite = |value: f64| if value.is_finite() { value } else { 0.0 };
        let point = |point: &CurvePoint| {
            let ([x, y], [to_x, to_y]) = (point.values, point.to_edge.map(finite));
            [x, y, finite(point.error), to_x, to_y]
        };
        let statuses = points.iter().map(|point| point.status().word());
        Self {
            name: String::new(),
            observable: None,
            method: String::new(),
            points: points.iter().map(point).collect(),
            statuses: statuses.collect(),
            labels: Vec::new(),
        }
    }
}

impl SpecialPoint {
    fn new(family: &Family, point: &CodimensionTwo) -> Self {
        let observables = point.observables.iter().map(|one| one.name(family));
        let curves = point.curves.iter().map(|&index| curve_name(index));
        Self {
            label: point.label.clone(),
            kind: point.kind.name(),
            at: point.values,
            error: point.error,
            status: point.status().word(),
            observable: observables.collect::<Vec<_>>().join(" "),
            curves: curves.collect::<Vec<_>>().join(" "),
        }
    }
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
