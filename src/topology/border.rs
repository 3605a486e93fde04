//! Borders of what is found in a joint density: of the basin of a peak, along the valleys that part it from other
//! peaks, and of the inside of a ring, along its crest.
//!
//! A valley is followed from its saddle downhill on either side, in units of the standard deviations of the axes; a
//! crest is looked for on rays from a point inside. Either is a function: of the distance along the valley, and of the
//! angle around the point. Beyond its ends a valley goes on as it went last.

use std::f64::consts::{PI, TAU};

use super::closed::Cover;
use super::field::{Field, Jet};
use super::rim::{LONGEST_JUMP, POINTS_A_CELL, top_of_ray};
use super::valley::{Node, Trace, Valley, between, with_errors_beside};
use super::{Detection, Feature, FeatureKind, Verdict};
use crate::density::EstimatedDensity;
use crate::numerics::sort_ascending;

/// Rays on which a crest is looked for.
const RAYS: usize = 60;

/// Part of the direction of a line along an axis that is rounding.
const ALONG_AXIS: f64 = 1e-9;

/// Standard deviations from a saddle within which most states lie, and by how many a border may be off a straight line
/// there.
const MOST_STATES: f64 = 3.0;
const STRAIGHT: f64 = 0.02;

/// Rays on either side of one whose errors are taken for its own.
const BESIDE: usize = 2;

/// Standard deviations within which the first coordinates of two peaks are the same: which peak is the first must not
/// hang on the cells.
const SAME_COLUMN: f64 = 0.1;

/// Share of the mass of a basin that may lie in cells which climb to another peak than the border says.
const MISPLACED: f64 = 0.05;

/// A border as a function, with the side on which what it bounds lies.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct DensityBorder {
    /// The saddle, or the point inside a ring.
    origin: [f64; 2],
    /// Units of the two coordinates.
    units: [f64; 2],
    /// The direction of a valley at its saddle, in these units; none of a crest, which runs around the origin.
    direction: Option<[f64; 2]>,
    nodes: Vec<Node>,
    /// 1 where what is bounded lies below the function, else -1.
    side: f64,
}

impl DensityBorder {
    /// The border as an inequality of two coordinates, moved outward by so many of its errors.
    pub(crate) fn inequality(&self, [x, y]: [&str; 2], moved: f64) -> String {
        let part = |k: usize, name: &str| {
            let (origin, unit) = (self.origin[k], self.units[k]);
            format!("(({name} - ({origin:?}))/{unit:?})")
        };
        let (x, y) = (part(0, x), part(1, y));
        let [along, across] = match self.direction {
            Some([a, b]) => [
                format!("(({a:?})*{x} + ({b:?})*{y})"),
                format!("(({a:?})*{y} - ({b:?})*{x})"),
            ],
            None => [format!("atan2({y}, {x})"), format!("hypot({x}, {y})")],
        };
        let across = match self.direction {
            // Of a line along the second axis only the first coordinate tells, and the other way round.
            Some([0.0, _]) => format!("-{x}"),
            Some([_, 0.0]) => y,
            _ => across,
        };
        let nodes: Vec<(f64, f64)> = (self.nodes.iter())
            .map(|node| (node.along, node.across + self.side * moved * node.error))
            .collect();
        let function = broken_line(&along, &nodes);
        let sign = if self.side > 0.0 { '<' } else { '>' };
        format!("{across} {sign} {function}")
    }

    /// The same, as a straight line where it is one along an axis, as far as most states lie. An oscillator whose
    /// motion passes the line has boundary layers there that are known for such lines alone.
    fn straightened(mut self) -> Self {
        let Some(axis) = self
            .direction
            .and_then(|one| one.iter().position(|part| part.abs() < ALONG_AXIS))
        else {
            return self;
        };
        let near = self
            .nodes
            .iter()
            .filter(|node| node.along.abs() <= MOST_STATES);
        let off = near
            .map(|node| node.across.abs() + node.error)
            .fold(0.0, f64::max);
        if off > STRAIGHT {
            return self;
        }
        let mut direction = [1.0; 2];
        direction[axis] = 0.0;
        self.direction = Some(direction);
        self.nodes = vec![Node {
            along: 0.0,
            across: 0.0,
            error: off,
        }];
        self
    }

    /// The same for what lies on the other side.
    pub(crate) fn other_side(mut self) -> Self {
        self.side = -self.side;
        self
    }

    /// Whether a point lies on the side of what is bounded.
    fn holds(&self, at: [f64; 2]) -> bool {
        let [x, y] = [0, 1].map(|k| (at[k] - self.origin[k]) / self.units[k]);
        let (along, across) = match self.direction {
            Some([a, b]) => (a * x + b * y, a * y - b * x),
            None => (y.atan2(x), x.hypot(y)),
        };
        self.side * (across - between(&self.nodes, along, |node| node.across)) < 0.0
    }
}

/// A function that is linear between nodes, and goes on beyond them as it went last, as a formula.
fn broken_line(along: &str, nodes: &[(f64, f64)]) -> String {
    let slope = |pair: &[(f64, f64)]| (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0);
    let slopes: Vec<f64> = nodes.windows(2).map(slope).collect();
    let (Some(&(from, value)), Some(first), Some(last)) =
        (nodes.first(), slopes.first(), slopes.last())
    else {
        return nodes
            .first()
            .map_or_else(|| "0".to_owned(), |node| format!("({:?})", node.1));
    };
    // Every |u - u_i| bends the line by twice its factor; the mean of the first and the last slope is left.
    let bends: Vec<(f64, f64)> = (nodes[1..].iter().zip(slopes.windows(2)))
        .map(|(node, pair)| (node.0, 0.5 * (pair[1] - pair[0])))
        .collect();
    let mean = 0.5 * (first + last);
    let at_first: f64 = bends
        .iter()
        .map(|(at, bend)| bend * (from - at).abs())
        .sum();
    let constant = value - mean * from - at_first;
    let mut text = format!("({constant:?}) + ({mean:?})*{along}");
    for (at, bend) in bends.iter().filter(|(_, bend)| *bend != 0.0) {
        text.push_str(&format!(" + ({bend:?})*abs({along} - ({at:?}))"));
    }
    text
}

/// The borders between the basin of a peak of a joint density, counted from 1 in the order of their first coordinates,
/// and those of others; `None` without the peak, without another one, and where what lies within the borders is not
/// what climbs to the peak; nor across a seam of an angle.
pub(crate) fn basin(
    density: &EstimatedDensity,
    detection: &Detection,
    peak: usize,
) -> Option<Vec<DensityBorder>> {
    let field = field(density)?;
    let trace = Trace::new(&field, density)?;
    let peaks = peaks(trace.units[0], detection);
    let own = peak.checked_sub(1).filter(|&own| own < peaks.len())?;
    let climbs = trace.climbs(&peaks);
    let mut borders = Vec::new();
    for valley in trace.valleys(own, &climbs)? {
        let Valley {
            origin,
            direction,
            nodes,
            ..
        } = valley;
        let (units, direction) = (trace.units, Some(direction));
        let border = DensityBorder {
            origin,
            units,
            direction,
            nodes,
            side: 1.0,
        };
        let mut border = border.straightened();
        let at = peaks[own];
        if !border.holds(at) {
            border = border.other_side();
        }
        borders.push(border);
    }
    let is_beyond = |at: &[f64; 2]| !borders.iter().all(|one| one.holds(*at));
    let mut others = peaks.iter().enumerate().filter(|(peak, _)| *peak != own);
    if borders.is_empty() || !others.all(|(_, at)| is_beyond(at)) {
        return None;
    }
    let masses = density.density.masses();
    let (mut whole, mut misplaced) = (0.0, 0.0);
    for (cell, mass) in masses.iter().enumerate() {
        let centre = field.centre(cell);
        let is_within = borders.iter().all(|one| one.holds([centre[0], centre[1]]));
        let is_own = climbs[cell] == Some(own);
        whole += if is_own { *mass } else { 0.0 };
        misplaced += if is_own == is_within { 0.0 } else { *mass };
    }
    (misplaced <= MISPLACED * whole).then_some(borders)
}

/// The density between its cells; `None` for one that has a seam.
fn field(density: &EstimatedDensity) -> Option<Field<'_>> {
    Field::new(density).filter(|_| Cover::of(density).is_none())
}

/// Places of the peaks that are there, in the order of their first coordinates; of those that differ by less than a
/// tenth of its standard deviation in them, in the order of the second ones.
fn peaks(deviation: f64, detection: &Detection) -> Vec<[f64; 2]> {
    let mut all: Vec<[f64; 2]> = of_kind(detection, FeatureKind::Peak)
        .filter_map(|peak| peak.position.get(..2)?.try_into().ok())
        .collect();
    sort_ascending(&mut all, |one| one[0]);
    let is_near = |one: &[f64; 2], other: &[f64; 2]| other[0] - one[0] < SAME_COLUMN * deviation;
    for column in all.chunk_by_mut(is_near) {
        sort_ascending(column, |one| one[1]);
    }
    all
}

fn of_kind(detection: &Detection, kind: FeatureKind) -> impl Iterator<Item = &Feature> {
    let present = detection.features.iter();
    present.filter(move |one| one.kind == kind && one.verdict == Verdict::Present)
}

/// The crest around the crater of a joint density, whose inside it bounds; `None` without a crater, with several, and
/// where the highest places on rays from it are no single curve.
pub(crate) fn crest(density: &EstimatedDensity, detection: &Detection) -> Option<DensityBorder> {
    let field = field(density)?;
    let mut craters = of_kind(detection, FeatureKind::Crater);
    let (crater, None) = (craters.next()?, craters.next()) else {
        return None;
    };
    let origin: [f64; 2] = crater.position.get(..2)?.try_into().ok()?;
    let values = &density.density.values;
    let second = density.variants.second_scheme();
    let looks = [
        Some((0, values.as_slice())),
        Some((1, values.as_slice())),
        second.map(|one| (0, one)),
    ];
    let mut radii = Vec::new();
    for (level, values) in looks.into_iter().flatten() {
        let jet = |at: &[f64]| Some(field.stencil(at, level)?.jet(values));
        radii.push(radii_of(&field, origin, values, &jet)?);
    }
    let nodes = (0..=RAYS).map(|ray| {
        let own = radii[0][ray % RAYS];
        let off = radii[1..]
            .iter()
            .map(|other| (other[ray % RAYS] - own).abs());
        Node {
            along: angle(ray),
            across: own,
            error: off.sum(),
        }
    });
    let nodes = with_errors_beside(nodes.collect(), BESIDE);
    let units = [field.unit(0), field.unit(1)];
    Some(DensityBorder {
        origin,
        units,
        direction: None,
        nodes,
        side: 1.0,
    })
}

fn angle(ray: usize) -> f64 {
    -PI + TAU * ray as f64 / RAYS as f64
}

/// The distance of the crest on each ray, in units of the ranges.
fn radii_of(
    field: &Field<'_>,
    origin: [f64; 2],
    values: &[f64],
    jet: &dyn Fn(&[f64]) -> Option<Jet>,
) -> Option<Vec<f64>> {
    let width = |k: usize| field.cell_width(k, origin[k]);
    let cell = width(0).max(width(1));
    let mut radii: Vec<f64> = Vec::new();
    for ray in 0..RAYS {
        let direction = [angle(ray).cos(), angle(ray).sin()];
        let at = |s: f64| -> Vec<f64> {
            (0..2)
                .map(|k| origin[k] + s * direction[k] * field.unit(k))
                .collect()
        };
        let points = (1..).map(|point| f64::from(point) * cell / POINTS_A_CELL);
        let heights = points.map_while(|s| Some((s, values[field.cell_at(&at(s))?])));
        let (start, _) = heights.max_by(|a, b| a.1.total_cmp(&b.1))?;
        radii.push(top_of_ray(field, &at, direction, (start, cell), jet)?);
    }
    let jump = |ray: usize| (radii[ray] - radii[(ray + 1) % RAYS]).abs();
    let is_one = (0..RAYS).all(|ray| jump(ray) <= LONGEST_JUMP * cell);
    is_one.then_some(radii)
}

#[cfg(test)]
mod tests;
