//! The density along the rim of a crater, as a function of the angle around a point inside.
//!
//! A rim may be level to a millionth part and have peaks all the same. Cells cannot show that: where a ridge runs
//! oblique to them its values wave from cell to cell. Along the crest itself, found on rays from inside by Newton's
//! method, the density is smooth, and what a rougher reconstruction and a second discretisation change of the height of
//! one point above another is small.

use std::collections::BTreeSet;

use super::enclosure::Enclosure;
use super::field::{Field, Jet, Stencil};
use crate::density::EstimatedDensity;
use crate::numerics::{ends_of, sort_descending};

/// Rays from the point inside.
const RAYS: usize = 120;
/// Points a cell at which a ray is looked at for where it is highest.
pub(super) const POINTS_A_CELL: f64 = 2.0;
/// Most steps of Newton's method on a ray.
const MOST_STEPS: usize = 8;
/// Jump of the crest from one ray to the next, in cells, beyond which it is not one curve.
pub(super) const LONGEST_JUMP: f64 = 4.0;

/// Cells on either side of the crest that belong to it.
const BESIDE: usize = 2;

/// A peak of the crest.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RimPeak {
    pub(super) position: Vec<f64>,
    pub(super) density: f64,
    /// The lower of the two lowest points that part it from higher ones; of the highest, the lowest point of the rim.
    pub(super) saddle: Vec<f64>,
    /// Height above that point.
    pub(super) height: f64,
    /// What cells and reconstruction may make of the height.
    pub(super) error: f64,
}

/// A point of the crest.
struct Crest {
    position: Vec<f64>,
    value: f64,
    rough: f64,
    scheme: f64,
}

/// The crest of a rim.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Summits {
    /// Its peaks, the highest first.
    pub(super) peaks: Vec<RimPeak>,
    /// Cells that the crest passes through, and those beside them.
    cells: BTreeSet<usize>,
}

impl Summits {
    /// Whether a cell lies on the crest, or beside it.
    pub(super) fn pass_through(&self, cell: usize) -> bool {
        self.cells.contains(&cell)
    }
}

/// The crest with its peaks; `None` where the rim cannot be followed on rays from the given point inside.
pub(super) fn summits(
    field: &Field<'_>,
    estimated: &EstimatedDensity,
    rim: &Enclosure,
    inside: &[f64],
) -> Option<Summits> {
    let crest = crest(field, estimated, rim, inside)?;
    let found = pairs(&crest.iter().map(|one| one.value).collect::<Vec<f64>>());
    // What differs by so much along the crest may differ so between any two of its points.
    let spread = |of: &dyn Fn(&Crest) -> f64| {
        let all = crest.iter().map(of);
        let (low, high) = ends_of(all);
        high - low
    };
    let error = spread(&|one| one.rough) + spread(&|one| one.scheme);
    // So may a share of the heights: what cells do to high peaks of a crest says nothing of low ones.
    let share = match crest.iter().all(|one| one.value > 0.0) {
        true => spread(&|one| one.rough / one.value) + spread(&|one| one.scheme / one.value),
        false => f64::INFINITY,
    };
    let peak = |(top, low): (usize, usize)| {
        let (top, low) = (&crest[top], &crest[low]);
        RimPeak {
            position: top.position.clone(),
            density: top.value,
            saddle: low.position.clone(),
            height: top.value - low.value,
            error: error.min(share * top.value),
        }
    };
    let axes = field.axes();
    let mut cells = BTreeSet::new();
    for one in &crest {
        let at = |k: usize| axes[k].find(one.position[k]).unwrap_or(0);
        let near =
            |k: usize| at(k).saturating_sub(BESIDE)..(at(k) + BESIDE + 1).min(axes[k].count());
        for row in near(0) {
            cells.extend(near(1).map(|column| row * axes[1].count() + column));
        }
    }
    Some(Summits {
        peaks: found.into_iter().map(peak).collect(),
        cells,
    })
}

fn crest(
    field: &Field<'_>,
    estimated: &EstimatedDensity,
    rim: &Enclosure,
    inside: &[f64],
) -> Option<Vec<Crest>> {
    let values = &estimated.density.values;
    let second = estimated.variants.second_scheme();
    let at = |direction: [f64; 2], s: f64| -> Vec<f64> {
        (0..2)
            .map(|k| inside[k] + s * direction[k] * field.unit(k))
            .collect()
    };
    let cell = (0..2)
        .map(|k| field.cell_width(k, inside[k]))
        .fold(0.0, f64::max);
    let mut radius = None;
    let mut points = Vec::with_capacity(RAYS);
    let mut first = 0.0;
    for ray in 0..=RAYS {
        let angle = std::f64::consts::TAU * ray as f64 / RAYS as f64;
        let direction = [angle.cos(), angle.sin()];
        let start = match radius {
            Some(radius) => radius,
            None => highest_on_ray(field, rim, &|s| at(direction, s), cell, values)?,
        };
        let place = |s| at(direction, s);
        let jet = |at: &[f64]| field.jet(at);
        let s = top_of_ray(field, &place, direction, (start, cell), &jet)?;
        if radius.is_some_and(|radius: f64| (s - radius).abs() > LONGEST_JUMP * cell) {
            return None;
        }
        if ray == 0 {
            first = s;
        }
        if ray == RAYS {
            // Around once: the curve must close.
            return ((s - first).abs() < cell).then_some(points);
        }
        radius = Some(s);
        let position = at(direction, s);
        let fine: Stencil = field.stencil(&position, 0)?;
        let value = fine.value(values);
        points.push(Crest {
            rough: field.stencil(&position, 1)?.value(values) - value,
            scheme: second.map_or(0.0, |second| fine.value(second) - value),
            position,
            value,
        });
    }
    None
}

/// Where on a ray the rim's cells are highest.
fn highest_on_ray(
    field: &Field<'_>,
    rim: &Enclosure,
    at: &dyn Fn(f64) -> Vec<f64>,
    cell: f64,
    values: &[f64],
) -> Option<f64> {
    let points = (1..).map(|point| f64::from(point) * cell / POINTS_A_CELL);
    let inside = points.map_while(|s| Some((s, field.cell_at(&at(s))?)));
    inside
        .filter(|&(_, cell)| rim.is_rim(cell))
        .max_by(|a, b| values[a.1].total_cmp(&values[b.1]))
        .map(|(s, _)| s)
}

/// The maximum along a ray beside the place that it starts at, by Newton's method.
pub(super) fn top_of_ray(
    field: &Field<'_>,
    at: &dyn Fn(f64) -> Vec<f64>,
    direction: [f64; 2],
    (start, cell): (f64, f64),
    jet: &dyn Fn(&[f64]) -> Option<Jet>,
) -> Option<f64> {
    let mut s = start;
    for _ in 0..MOST_STEPS {
        let position = at(s);
        field.cell_at(&position)?;
        let jet = jet(&position)?;
        let (slope, bend) = (jet.slope(direction), jet.curvature(direction));
        // Where it is not curved downward the top lies uphill.
        let step = if bend < 0.0 {
            -slope / bend
        } else {
            slope.signum() * cell
        };
        let step = step.clamp(-cell, cell);
        s += step;
        if step.abs() < 1e-7 * cell {
            return (s > 0.0).then_some(s);
        }
    }
    None
}

/// Maxima of values around a circle, the highest first, each with the minimum where it merges with a higher one; the
/// highest with the lowest.
fn pairs(values: &[f64]) -> Vec<(usize, usize)> {
    let count = values.len();
    let mut order: Vec<usize> = (0..count).collect();
    sort_descending(&mut order, |&place| values[place]);
    let mut top: Vec<Option<usize>> = vec![None; count];
    let mut found = Vec::new();
    let relabel = |top: &mut Vec<Option<usize>>, from: usize, to: usize| {
        for slot in top.iter_mut().filter(|slot| **slot == Some(from)) {
            *slot = Some(to);
        }
    };
    for &index in &order {
        let neighbours = [(index + count - 1) % count, (index + 1) % count].map(|n| top[n]);
        match neighbours {
            [None, None] => top[index] = Some(index),
            [Some(one), None] | [None, Some(one)] => top[index] = Some(one),
            [Some(a), Some(b)] if a == b => top[index] = Some(a),
            [Some(a), Some(b)] => {
                let (elder, younger) = if values[a] >= values[b] {
                    (a, b)
                } else {
                    (b, a)
                };
                found.push((younger, index));
                relabel(&mut top, younger, elder);
                top[index] = Some(elder);
            }
        }
    }
    if let (Some(&highest), Some(&lowest)) = (order.first(), order.last()) {
        found.push((highest, lowest));
    }
    sort_descending(&mut found, |one| values[one.0]);
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maxima_around_a_circle_have_their_minima() {
        let values = [3.0, 1.0, 2.0, 0.0, 2.5, 1.5, 1.8, 1.7];
        // 3 at 0 is the highest; 2.5 merges with it over 1.5; 2 with 3 over 1; 1.8 with 3 over 1.7.
        assert_eq!(pairs(&values), [(0, 3), (4, 5), (2, 1), (6, 7)]);
    }
}
