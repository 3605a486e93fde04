//! The density between the cells as it is drawn: continuous, with the averages that the cells have, and with no peak
//! that the cells do not show.
//!
//! At the faces of the cells it has the value of the polynomials through the averages about them, those of `field`;
//! at a kink the mean of both sides, so that the slope jumps there. Within a cell it is the parabola with the values
//! at both faces and the cell's average (Colella and Woodward 1984, *J. Comput. Phys.* 54, 174). Where that would
//! turn in a cell between a lower and a higher one, a power takes its place, which is monotone and has the same
//! average. On a smooth density the error is of order three in the width of a cell. Joint densities are followed
//! along the second axis, then along the first.

use super::field::Field;
use super::reconstruction::{Weights, interpolating};
use super::shape::{Shape, Spot};
use crate::density::EstimatedDensity;
use crate::space::Axis;

/// A face is looked at from either side from this far, in widths of the cell: farther than two coordinates of one
/// place are apart.
const BESIDE: f64 = 1e-5;
/// Places so near to each other, in lengths of a window, are one.
const SAME: f64 = 1e-12;
/// A face beside an extremum may exceed the cells so many times as far as parabolas through three cells do.
const BEYOND: f64 = 2.0;

/// A density without sampling noise, to be looked at anywhere.
#[derive(Debug, Clone)]
pub(crate) struct Between<'a> {
    values: &'a [f64],
    axes: Vec<Faces<'a>>,
}

/// The faces of the cells of an axis.
#[derive(Debug, Clone)]
struct Faces<'a> {
    axis: &'a Axis,
    faces: Vec<Face>,
}

/// How the value at a face follows from the averages over the cells.
#[derive(Debug, Clone)]
struct Face {
    /// By the polynomials of either side, which are the same but at a kink.
    sides: [Weights; 2],
    /// By parabolas, the rough measure of how far a face may exceed the cells beside it.
    rough: Vec<Weights>,
    is_kink: bool,
}

impl<'a> Between<'a> {
    /// `None` for densities with sampling noise, whose cells are all that is known; for other numbers of axes than
    /// one and two, for axes with too few cells, and for values that are no numbers.
    pub(crate) fn new(estimated: &'a EstimatedDensity) -> Option<Self> {
        let values = &estimated.density.values;
        if estimated.is_noisy() || values.iter().any(|value| !value.is_finite()) {
            return None;
        }
        let field = Field::new(estimated)?;
        let cells: usize = field.axes().iter().map(Axis::count).product();
        if cells != values.len() {
            return None;
        }
        let axes = (0..field.axes().len()).map(|k| Faces::new(&field, k));
        Some(Self {
            values,
            axes: axes.collect::<Option<_>>()?,
        })
    }

    /// The values at places of a single axis; no numbers outside.
    pub(crate) fn curve(&self, places: &[f64]) -> Vec<f64> {
        match self.axes.as_slice() {
            [faces] => faces.shape(self.values).at(&faces.spots(places)),
            _ => Vec::new(),
        }
    }

    /// The values at all pairs of places of the two axes, those of the second axis fastest; no numbers outside.
    pub(crate) fn sheet(&self, first: &[f64], second: &[f64]) -> Vec<f64> {
        let [across, along] = self.axes.as_slice() else {
            return Vec::new();
        };
        let spots = [across.spots(first), along.spots(second)];
        let rows = self.values.chunks(along.axis.count());
        let rows: Vec<Vec<f64>> = rows.map(|row| along.shape(row).at(&spots[1])).collect();
        let mut sheet = vec![0.0; first.len() * second.len()];
        for j in 0..second.len() {
            let averages: Vec<f64> = rows.iter().map(|row| row[j]).collect();
            for (i, value) in across
                .shape(&averages)
                .at(&spots[0])
                .into_iter()
                .enumerate()
            {
                sheet[i * second.len() + j] = value;
            }
        }
        sheet
    }

    /// Averages over the cells of axis `along` where the other axis of two has the value `at`.
    pub(crate) fn section(&self, along: usize, at: f64) -> Vec<f64> {
        let [first, second] = self.axes.as_slice() else {
            return Vec::new();
        };
        let columns = second.axis.count();
        let value = |faces: &Faces<'_>, line: &[f64]| faces.shape(line).at(&faces.spots(&[at]))[0];
        match along {
            0 => self
                .values
                .chunks(columns)
                .map(|row| value(second, row))
                .collect(),
            _ => {
                let column = |j: usize| -> Vec<f64> {
                    self.values
                        .iter()
                        .skip(j)
                        .step_by(columns)
                        .copied()
                        .collect()
                };
                (0..columns).map(|j| value(first, &column(j))).collect()
            }
        }
    }

    /// The largest value at faces, middles and turning points of the cells.
    pub(crate) fn largest(&self) -> f64 {
        let values = match self.axes.as_slice() {
            [faces] => self.curve(&self.places(0, (faces.axis.from(), faces.axis.to()), 1)),
            [first, second] => self.sheet(&first.looks(), &second.looks()),
            _ => Vec::new(),
        };
        values.into_iter().fold(0.0, f64::max)
    }

    /// So many places evenly over a window of axis `k`, with its kinks, and of a single axis with the faces, middles
    /// and turning points of its cells: what is drawn through them shows what there is.
    pub(crate) fn places(&self, k: usize, (from, to): (f64, f64), even: usize) -> Vec<f64> {
        let Some(faces) = self.axes.get(k) else {
            return Vec::new();
        };
        let share = |i: usize| i as f64 / even.max(1) as f64;
        let mut places: Vec<f64> = (0..=even).map(|i| from + (to - from) * share(i)).collect();
        places.extend(faces.kinks());
        if self.axes.len() == 1 {
            places.extend(faces.looks());
            places.extend(faces.shape(self.values).turns());
        }
        places.retain(|&place| place >= from && place <= to);
        places.sort_by(f64::total_cmp);
        places.dedup_by(|a, b| (*a - *b).abs() <= SAME * (to - from));
        places
    }
}

impl<'a> Faces<'a> {
    fn new(field: &Field<'a>, k: usize) -> Option<Self> {
        let axis = &field.axes()[k];
        let count = axis.count();
        let face = |face: usize| {
            let at = axis.edges()[face];
            let line = |cells| Some(interpolating(axis, cells, at, 1)?.swap_remove(0));
            // The cells below and above; at an end of the range the one that there is.
            let below = face.saturating_sub(1);
            let above = face.min(count - 1);
            let below_at = at - if face == 0 { -1.0 } else { 1.0 } * BESIDE * axis.width(below);
            let above_at = at + if face == count { -1.0 } else { 1.0 } * BESIDE * axis.width(above);
            let windows = [field.window_at(k, below_at)?, field.window_at(k, above_at)?];
            let is_kink = windows[0] != windows[1];
            let roughly = match (is_kink, face) {
                (true, _) => vec![windows[0].end - 3, windows[1].start],
                (false, 0 | 1) => vec![0],
                (false, _) => vec![(face - 2).min(count - 3), (face - 1).min(count - 3)],
            };
            let rough = roughly.into_iter().map(|first| line(first..first + 3));
            let [below, above] = windows;
            Some(Face {
                rough: rough.collect::<Option<_>>()?,
                sides: [line(below)?, line(above)?],
                is_kink,
            })
        };
        Some(Self {
            axis,
            faces: (0..=count).map(face).collect::<Option<_>>()?,
        })
    }

    /// Where places lie.
    fn spots(&self, places: &[f64]) -> Vec<Spot> {
        let spot = |&place: &f64| {
            let cell = self.axis.find(place)?;
            let share = (place - self.axis.edges()[cell]) / self.axis.width(cell);
            Some((cell, share.clamp(0.0, 1.0)))
        };
        places.iter().map(spot).collect()
    }

    /// Coordinates of the kinks on faces.
    fn kinks(&self) -> impl Iterator<Item = f64> {
        let faces = self.faces.iter().zip(self.axis.edges());
        faces
            .filter(|(face, _)| face.is_kink)
            .map(|(_, &edge)| edge)
    }

    /// Faces and middles of the cells.
    fn looks(&self) -> Vec<f64> {
        let edges = self.axis.edges().windows(2);
        let mut looks: Vec<f64> = edges
            .flat_map(|edge| [edge[0], 0.5 * (edge[0] + edge[1])])
            .collect();
        looks.push(self.axis.to());
        looks
    }

    /// The shape of a density along the axis that has these averages.
    fn shape(&self, averages: &[f64]) -> Shape<'_> {
        let values = self.faces.iter().enumerate();
        let faces = values.map(|(number, face)| face.value(number, averages));
        Shape::new(self.axis, averages.to_vec(), faces.collect())
    }
}

impl Face {
    /// The value at face `number`: between those of the cells beside it, but where it is next to an extremum of
    /// theirs.
    fn value(&self, number: usize, averages: &[f64]) -> f64 {
        let value = 0.5 * (self.sides[0].apply(averages) + self.sides[1].apply(averages));
        let below = number.checked_sub(1).and_then(|below| averages.get(below));
        let beside = [below, averages.get(number)].map(Option::<&f64>::copied);
        let (low, high) = match beside {
            [Some(below), Some(above)] => (below.min(above), below.max(above)),
            [Some(one), None] | [None, Some(one)] => (one, one),
            [None, None] => return 0.0,
        };
        let bounds = [1.0, -1.0].map(|sign| {
            let end = if sign > 0.0 { high } else { low };
            if !self.may_exceed(number, averages, sign) {
                return end;
            }
            let rough = self
                .rough
                .iter()
                .map(|line| sign * (line.apply(averages) - end));
            end + sign * BEYOND * rough.fold(0.0, f64::max)
        });
        // What is nowhere negative stays so.
        let least = if low >= 0.0 {
            bounds[1].max(0.0)
        } else {
            bounds[1]
        };
        value.max(least).min(bounds[0])
    }

    /// Whether a cell beside the face is a peak (`sign` 1) or a valley (-1) of the averages on whose slope to the
    /// next one the face lies.
    fn may_exceed(&self, number: usize, averages: &[f64], sign: f64) -> bool {
        let at = |cell: Option<usize>| cell.and_then(|cell| averages.get(cell)).map(|v| sign * v);
        let cells = [
            at(number.checked_sub(2)),
            at(number.checked_sub(1)),
            at(Some(number)),
            at(Some(number + 1)),
        ];
        let [Some(below), Some(above)] = [cells[1], cells[2]] else {
            // At an end of the range the density goes on as it came.
            let [outer, inner] = if number == 0 {
                [cells[2], cells[3]]
            } else {
                [cells[1], cells[0]]
            };
            return outer.zip(inner).is_none_or(|(outer, inner)| outer >= inner);
        };
        let (top, other, outer) = if below >= above {
            (below, above, cells[0])
        } else {
            (above, below, cells[3])
        };
        // The extremum of a smooth density lies on the side of the higher neighbour.
        outer.is_some_and(|outer| outer <= top && (self.is_kink || outer <= other))
    }
}

#[cfg(test)]
#[path = "between_tests.rs"]
mod tests;
