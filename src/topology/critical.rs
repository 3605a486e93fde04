//! Critical points of a density between its cells, and how certain the height of one above another is.
//!
//! A candidate (the cell of a peak, saddle or basin) is followed by Newton's method along those principal directions in
//! which the density is curved. Along a rim of constant height nothing is curved, and the point stays on the rim where
//! it was. On a plane where the derivative jumps from rising to falling (or back) the point stays on the plane; in an
//! outermost cell, where the density rises toward the end of the range, as at a wall, it is at the end.

use super::FeatureKind;
use super::field::{Curvature, Field, Jet, Stencil};
use crate::density::{EstimatedDensity, WIGGLE};
use crate::numerics::sort_ascending;

/// Most steps of Newton's method.
const MOST_STEPS: usize = 12;
/// Longest way from the centre of the candidate's cell, in cells, and least number of steps on the longest way. Along a
/// trench that lies across the cells the lowest of them may be several cells away from the lowest point.
const FARTHEST: f64 = 6.0;
/// The same as a share of the range, where a crest is so level that its highest cell may be anywhere.
const MOST_OF_RANGE: f64 = 0.1;
/// A direction whose curvature is a smaller share of the larger one is flat, as along a rim.
pub(super) const FLAT: f64 = 0.02;
/// A flat direction is followed all the same where a rougher reconstruction agrees on its curvature to this share.
const CERTAIN: f64 = 0.3;
/// Up to so many cells from each other two points share their errors; from twice as many on they share none.
const ONE_ERROR: f64 = 4.0;
/// A step that is a smaller share of a cell ends the search.
const SETTLED: f64 = 1e-6;
/// Root of the sum of the squares of the weights of a slope in the middle of eight even cells, in inverse widths.
const CENTRAL: f64 = 2.029;
/// Times its error that a slope may be where it is none.
const UNCERTAIN: f64 = 3.0;
/// Share of a height by which the density may change over a cell where the search has ended.
const ROUNDED: f64 = 0.01;

/// A critical point.
#[derive(Debug, Clone)]
pub(super) struct Critical {
    /// One coordinate an axis.
    pub(super) position: Vec<f64>,
    /// Value and derivatives there.
    pub(super) jet: Jet,
    /// Whether it lies on a plane with a jump of the derivative, or at an end of the range, one value an axis.
    held: Vec<bool>,
    /// The same, or in an outermost cell.
    pinned: Vec<bool>,
    /// Whether it lies at an end of a range, toward which the density rises.
    pub(super) is_at_end: bool,
    /// Widths of the cell, in units of the axes.
    cell: [f64; 2],
    /// The same in units of the coordinates.
    width: [f64; 2],
    fine: Stencil,
    rough: Stencil,
}

impl Critical {
    /// The critical point of the given kind in or beside a cell.
    pub(super) fn near(
        field: &Field<'_>,
        centre: &[f64],
        kind: FeatureKind,
        values: &[f64],
    ) -> Option<Self> {
        let mut position = centre.to_vec();
        let pinned: Vec<bool> = (0..centre.len())
            .map(|k| {
                let mut holds_at = |at: Option<f64>, holds: &dyn Fn(&[f64]) -> bool| {
                    at.is_some_and(|at| {
                        position[k] = at;
                        let holds = holds(&position);
                        if !holds {
                            position[k] = centre[k];
                        }
                        holds
                    })
                };
                let end = field.end_near(k, centre[k]);
                let plane = field.plane_near(k, centre[k]);
                holds_at(end, &|at| rises_to_end(field, at, k, kind, values))
                    || holds_at(plane, &|at| holds(field, at, k, kind, values))
            })
            .collect();
        let is_at_end = (0..centre.len())
            .any(|k| pinned[k] && field.end_near(k, centre[k]) == Some(position[k]));
        let mut reach = None;
        for _ in 0..MOST_STEPS {
            let jet = field.stencil(&position, 0)?.jet(values);
            let reach = reach.get_or_insert_with(|| reach_from(field, centre, &jet, &pinned));
            let rough = || Some(field.stencil(&position, 1)?.jet(values));
            let step = step(&jet, &rough, kind, &pinned);
            let mut longest: f64 = 0.0;
            for k in 0..position.len() {
                let longest_step = reach[k] / FARTHEST;
                let limited = step[k].clamp(-longest_step, longest_step);
                longest = longest.max(limited.abs() / field.cell_width(k, centre[k]));
                let unit = field.unit(k);
                let (low, high) = field.side(k, centre[k], reach[k] * unit);
                position[k] = (position[k] + limited * unit).clamp(low, high);
            }
            if longest < SETTLED {
                break;
            }
        }
        let fine = field.stencil(&position, 0)?;
        let (mut cell, mut width) = ([0.0; 2], [0.0; 2]);
        let held = pinned.clone();
        let mut pinned = pinned;
        for (k, axis) in field.axes().iter().enumerate() {
            cell[k] = field.cell_width(k, centre[k]);
            width[k] = cell[k] * field.unit(k);
            // In the outermost cells the density need not be level: what rises up to the end is highest there.
            let aside = (position[k] - axis.from()).min(axis.to() - position[k]);
            pinned[k] |= aside <= width[k];
        }
        Some(Self {
            cell,
            width,
            is_at_end,
            jet: fine.jet(values),
            rough: field.stencil(&position, 1)?,
            fine,
            position,
            held,
            pinned,
        })
    }

    /// Whether every direction in which the density is curved is curved as a peak, or a crater, is: no direction the
    /// other way along which a cell's width changes the density by half the height that is asked about.
    pub(super) fn is_of_kind(&self, kind: FeatureKind, height: f64) -> bool {
        let sign = match kind {
            FeatureKind::Peak | FeatureKind::Ring => 1.0,
            FeatureKind::Crater => -1.0,
            FeatureKind::Valley => return true,
        };
        let bent = |curvature: f64, width: f64| sign * curvature * width * width > height;
        let along = |k: usize| !bent(self.jet.second[2 * k], self.cell[k]);
        match self.pinned[..] {
            [false] | [false, true] => along(0),
            [true, false] => along(1),
            [false, false] => self.jet.principal().iter().all(|one| {
                let width =
                    (self.cell[0] * one.direction[0]).hypot(self.cell[1] * one.direction[1]);
                !bent(one.value, width)
            }),
            _ => true,
        }
    }

    /// Whether the density is level: over a cell it changes by less than half the height that is asked about, and by no
    /// more than its slope is uncertain. Along a trench or a ridge the slope may be small everywhere, and yet lead on
    /// to the one place where it is zero.
    pub(super) fn is_level(&self, height: f64, estimated: &EstimatedDensity) -> bool {
        let values = &estimated.density.values;
        let rough = self.rough.jet(values);
        let second = estimated.variants.second_scheme();
        let second = second.map(|values| self.fine.jet(values));
        let free = (0..self.position.len()).filter(|&k| !self.pinned[k]);
        free.map(|k| {
            let slope = self.jet.first[k];
            let scheme = second.map_or(0.0, |second| (second.first[k] - slope).abs());
            let error = (rough.first[k] - slope).abs() + scheme;
            [slope.abs(), error].map(|slope| slope * self.cell[k])
        })
        .all(|[change, error]| change <= (0.5 * height).min(UNCERTAIN * error + ROUNDED * height))
    }

    /// Whether the density is curved to one side in every direction, as at no saddle of two axes.
    pub(super) fn is_extremum(&self) -> bool {
        let [lower, upper] = self.jet.principal().map(|one| one.value);
        let largest = lower.abs().max(upper.abs());
        self.pinned == [false, false]
            && lower * upper > 0.0
            && lower.abs().min(upper.abs()) > FLAT * largest
    }

    /// How far, along each axis, the point moves when the slope changes by what a rougher reconstruction makes of it
    /// (and by what is left of it where the search does not follow it), and by errors of the cells that are this large
    /// and independent of each other. Nothing along directions that are flat, and along axes on which a plane holds the
    /// point; flat is what is curved less than this share of the most curved.
    pub(super) fn shifts(&self, field: &Field<'_>, error: f64, flat: f64) -> ([f64; 2], [f64; 2]) {
        let rough = self.rough.jet(field.values()).first;
        let change = [0, 1].map(|k| rough[k] - self.jet.first[k]);
        let slopes = [0, 1].map(|k| match self.cell[k] {
            0.0 => 0.0,
            width => self.one_sided(k) * error / (std::f64::consts::SQRT_2 * width),
        });
        let free = |k: usize| !self.held.get(k).copied().unwrap_or(true);
        let principal = match [free(0), free(1)] {
            [true, true] => self.jet.principal().to_vec(),
            one => (0..2).filter(|&k| one[k]).map(|k| self.along(k)).collect(),
        };
        let largest = principal.iter().map(|one| one.value.abs());
        let largest = largest.fold(0.0, f64::max);
        let mut moved = ([0.0; 2], [0.0; 2]);
        for one in principal
            .iter()
            .filter(|one| one.value.abs() > flat * largest)
        {
            let [a, b] = one.direction;
            let away = change[0] * a + change[1] * b;
            let length = (away.abs() + self.jet.slope(one.direction).abs()) / one.value.abs();
            let independent = (slopes[0] * a).hypot(slopes[1] * b) / one.value.abs();
            // No farther than the range is long.
            for (k, part) in [a, b].into_iter().enumerate() {
                moved.0[k] += length.min(1.0) * part.abs() * field.unit(k);
                moved.1[k] += independent.min(1.0) * part.abs() * field.unit(k);
            }
        }
        moved
    }

    /// How many times as much the slope makes of errors of cells where the polynomial has nearly all of its cells on
    /// one side, in an outermost cell, as elsewhere.
    fn one_sided(&self, k: usize) -> f64 {
        let [held, pinned] = [&self.held, &self.pinned].map(|all| all.get(k).copied());
        match (held, pinned) {
            (Some(false), Some(true)) => {
                (self.fine.slope_weight(k) * self.width[k] / CENTRAL).max(1.0)
            }
            _ => 1.0,
        }
    }

    /// How far beyond an end of an axis that is not the system's own the density may go on rising: up to where the
    /// parabola of its logarithm at the end does. At least by a cell, and at most by as much as the range is long.
    pub(super) fn beyond_end(&self, field: &Field<'_>, k: usize) -> f64 {
        let axis = &field.axes()[k];
        let length = axis.to() - axis.from();
        let rate = self.jet.first[k].abs() / self.jet.value;
        let bend = self.jet.second[2 * k] / self.jet.value - rate * rate;
        let away = match bend < 0.0 {
            true => rate / -bend * field.unit(k),
            false => length,
        };
        away.max(self.width[k]).min(length)
    }

    /// The direction of an axis, with the curvature along it.
    fn along(&self, k: usize) -> Curvature {
        let mut direction = [0.0; 2];
        direction[k] = 1.0;
        Curvature {
            value: self.jet.second[2 * k],
            direction,
        }
    }

    /// Value of another variant of the density at the same place.
    pub(super) fn value(&self, values: &[f64]) -> f64 {
        self.fine.value(values)
    }

    /// What a rougher reconstruction and the second discretisation change of the value.
    pub(super) fn error(&self, estimated: &EstimatedDensity) -> f64 {
        let values = &estimated.density.values;
        let scheme = estimated.variants.second_scheme();
        let scheme = scheme.map_or(0.0, |second| {
            (self.value(second) - self.value(values)).abs()
        });
        self.roughness(values).abs() + scheme
    }

    /// Distance to another in cells; zero on one axis.
    fn cells_from(&self, other: &Self) -> f64 {
        let [first, second] = self.position[..] else {
            return 0.0;
        };
        let apart = [first - other.position[0], second - other.position[1]];
        (0..2)
            .map(|k| (apart[k] / self.width[k]).abs())
            .fold(0.0, f64::max)
    }

    /// What the rougher reconstruction changes of the value.
    fn roughness(&self, values: &[f64]) -> f64 {
        self.rough.value(values) - self.fine.value(values)
    }
}

/// Whether the density has an extremum across a plane with a jump of the derivative: slopes on both sides point to it,
/// or away from it.
fn holds(field: &Field<'_>, at: &[f64], k: usize, kind: FeatureKind, values: &[f64]) -> bool {
    let beside = |step: f64| {
        let mut point = at.to_vec();
        point[k] += step * 1e-9 * field.unit(k);
        Some(field.stencil(&point, 0)?.jet(values).first[k])
    };
    let (Some(below), Some(above)) = (beside(-1.0), beside(1.0)) else {
        return false;
    };
    match kind {
        FeatureKind::Peak | FeatureKind::Ring => below > 0.0 && above < 0.0,
        FeatureKind::Crater => below < 0.0 && above > 0.0,
        FeatureKind::Valley => below * above < 0.0,
    }
}

/// Whether the density rises toward an end of the range, where a peak and the pass from one peak to another are then
/// highest. A basin that is open to the end is no crater.
fn rises_to_end(
    field: &Field<'_>,
    at: &[f64],
    k: usize,
    kind: FeatureKind,
    values: &[f64],
) -> bool {
    let is_upper = at[k] > field.axes()[k].from();
    let slope = field.stencil(at, 0).map(|one| one.jet(values).first[k]);
    let outward = slope.map(|slope| if is_upper { slope } else { -slope });
    kind != FeatureKind::Crater && outward.is_some_and(|outward| outward > 0.0)
}

/// How far along each axis, in its units, a critical point may lie from the cell that shows it. Along a crest or a
/// trench that crosses cells obliquely, their values wave by κh²/8, with the curvature κ across it and the width h of
/// cells there: as much as the crest itself changes over h √(κ/κ') / 2, with the curvature κ' along it. A plane with a
/// jump of the derivative holds a point on a line of cells, whose values do not wave.
fn reach_from(field: &Field<'_>, centre: &[f64], jet: &Jet, pinned: &[bool]) -> [f64; 2] {
    let cells: Vec<f64> = (0..centre.len())
        .map(|k| field.cell_width(k, centre[k]))
        .collect();
    let mut reach = [0, 1].map(|k| FARTHEST * cells.get(k).copied().unwrap_or_default());
    if pinned != [false, false] {
        return reach;
    }
    let mut principal = jet.principal();
    sort_ascending(&mut principal, |one| one.value.abs());
    let [along, across] = principal;
    let width = (cells[0] * across.direction[0]).hypot(cells[1] * across.direction[1]);
    let wave = 0.5 * width * (across.value / along.value).abs().sqrt();
    for (k, axis) in field.axes().iter().enumerate() {
        let most = MOST_OF_RANGE * (axis.to() - axis.from()) / field.unit(k);
        let away = wave * along.direction[k].abs();
        // No wave is known where nothing is curved, or an axis lies across a crest that is level.
        if !away.is_nan() {
            reach[k] = reach[k].max(away.min(most));
        }
    }
    reach
}

/// Newton's step in units of the axes, along the directions that are curved as the kind wants.
fn step(
    jet: &Jet,
    rough: &dyn Fn() -> Option<Jet>,
    kind: FeatureKind,
    pinned: &[bool],
) -> [f64; 2] {
    let suits = |curvature: f64| match kind {
        FeatureKind::Peak | FeatureKind::Ring => curvature < 0.0,
        FeatureKind::Crater => curvature > 0.0,
        FeatureKind::Valley => true,
    };
    let along = |k: usize| {
        let curvature = jet.second[2 * k];
        let mut step = [0.0; 2];
        // Along one axis a valley is a minimum.
        let fits = if pinned.len() == 1 && kind == FeatureKind::Valley {
            curvature > 0.0
        } else {
            suits(curvature)
        };
        if fits {
            step[k] = -jet.first[k] / curvature;
        }
        step
    };
    match *pinned {
        [false] => along(0),
        [false, true] => along(0),
        [true, false] => along(1),
        [false, false] => {
            let principal = jet.principal();
            let largest = principal
                .iter()
                .map(|one| one.value.abs())
                .fold(0.0, f64::max);
            let mut step = [0.0; 2];
            for one in principal {
                let certain = || {
                    let rough = rough().map_or(f64::NAN, |rough| rough.curvature(one.direction));
                    (rough - one.value).abs() < CERTAIN * one.value.abs()
                };
                if suits(one.value) && (one.value.abs() > FLAT * largest || certain()) {
                    let length = -jet.slope(one.direction) / one.value;
                    step[0] += length * one.direction[0];
                    step[1] += length * one.direction[1];
                }
            }
            step
        }
        _ => [0.0; 2],
    }
}

/// Height of one critical point above another with its error: what a rougher reconstruction and the second
/// discretisation change. Points within a few cells of each other share much of their errors; of those that are far
/// apart the errors may cancel by chance only, as along a level moat.
pub(super) fn height_above(
    high: &Critical,
    low: &Critical,
    estimated: &EstimatedDensity,
) -> (f64, f64) {
    let values = &estimated.density.values;
    let height = |values: &[f64]| high.value(values) - low.value(values);
    let found = height(values);
    let rough = (high.roughness(values) - low.roughness(values)).abs();
    let scheme = estimated.variants.second_scheme();
    let scheme = scheme.map_or(0.0, |values| (height(values) - found).abs());
    let far = high.cells_from(low);
    let far = ((far - ONE_ERROR) / ONE_ERROR).clamp(0.0, 1.0);
    let each = high.error(estimated) + low.error(estimated);
    // A density is nowhere negative: where the lower one is, both are a wiggle of the scheme unless the upper one is
    // clearly higher.
    let wiggle = WIGGLE * low.value(values).min(0.0).abs();
    (found, (rough + scheme).max(far * each) + wiggle)
}
