//! A density as figures show it: at which points, in which part of its axes, followed between its cells where it has no
//! sampling noise, else cell by cell.

use crate::continuation::{Point, SweepResult};
use crate::density::{Density, EstimatedDensity};
use crate::figure::canvas::style::PNG_SCALE;
use crate::space::Axis;
use crate::topology::Between;

/// Share of the largest density below which a cell counts as empty.
const EMPTY: f64 = 1e-3;
/// Most pixels of an embedded map along a side: more than are seen, however wide the page.
const MOST_PIXELS: f64 = 1200.0;
/// Share of a window that is added at either end.
const BORDER: f64 = 0.04;
/// Points of a curve over its window, beside those that its cells add.
const POINTS: usize = 300;
/// Pixels of a map to a figure pixel.
const FINE: f64 = 0.5 * PNG_SCALE;
/// Most pixels of a map along a side.
const MOST: f64 = 900.0;

/// A density with what is known of it between its cells.
#[derive(Debug, Clone)]
pub(crate) struct View<'a> {
    estimated: &'a EstimatedDensity,
    /// `None` where the cells are drawn as they are.
    pub(crate) between: Option<Between<'a>>,
    /// The largest value that is drawn.
    pub(crate) largest: f64,
}

impl<'a> View<'a> {
    pub(crate) fn new(estimated: &'a EstimatedDensity) -> Self {
        let between = Between::new(estimated);
        let cells = largest([&estimated.density]);
        Self {
            largest: between.as_ref().map_or(cells, Between::largest).max(cells),
            between,
            estimated,
        }
    }

    /// Its cells.
    pub(crate) fn density(&self) -> &'a Density {
        &self.estimated.density
    }

    /// The same cell by cell.
    pub(crate) fn by_cells(estimated: &'a EstimatedDensity) -> Self {
        Self {
            largest: largest([&estimated.density]),
            between: None,
            estimated,
        }
    }

    /// Coordinates and values of a marginal in a window: one a cell where it has noise.
    pub(crate) fn curve(&self, window: (f64, f64)) -> Vec<(f64, f64)> {
        let density = &self.estimated.density;
        let places = match &self.between {
            Some(between) => {
                let places = between.places(0, window, POINTS);
                let values = between.curve(&places);
                places.into_iter().zip(values).collect()
            }
            None => {
                let centres = density.axes[0].centres().into_iter();
                let places = centres.zip(density.values.iter().copied());
                places.collect::<Vec<_>>()
            }
        };
        let is_shown = |(place, value): &(f64, f64)| {
            *place >= window.0 && *place <= window.1 && value.is_finite()
        };
        places.into_iter().filter(is_shown).collect()
    }

    /// The values of a marginal at places; no numbers outside.
    pub(crate) fn along(&self, places: &[f64]) -> Vec<f64> {
        if let Some(between) = &self.between {
            return between.curve(places);
        }
        let density = &self.estimated.density;
        let value = |&place: &f64| {
            let cell = density.axes[0].find(place);
            cell.map_or(f64::NAN, |cell| density.values[cell])
        };
        places.iter().map(value).collect()
    }

    /// Pixels of a map of so many figure pixels along axis `k`.
    pub(crate) fn resolution(&self, k: usize, window: (f64, f64), length: f64) -> usize {
        match (&self.between, self.estimated.density.axes.get(k)) {
            (None, Some(axis)) => cell_resolution(&[axis], window, length),
            _ => resolution(length),
        }
    }

    /// The values at all pairs of places of both axes, those of the second axis fastest; no numbers outside.
    pub(crate) fn sheet(&self, x: &[f64], y: &[f64]) -> Vec<f64> {
        if let Some(between) = &self.between {
            return between.sheet(x, y);
        }
        let [across, up] = &self.estimated.density.axes[..] else {
            return vec![f64::NAN; x.len() * y.len()];
        };
        let columns: Vec<Option<usize>> = x.iter().map(|&x| across.find(x)).collect();
        let rows: Vec<Option<usize>> = y.iter().map(|&y| up.find(y)).collect();
        let value = |column: &Option<usize>, row: &Option<usize>| match (column, row) {
            (Some(i), Some(j)) => self.estimated.density.values[i * up.count() + j],
            _ => f64::NAN,
        };
        columns
            .iter()
            .flat_map(|column| rows.iter().map(move |row| value(column, row)))
            .collect()
    }
}

/// Pixels of a smooth map of so many figure pixels.
pub(crate) fn resolution(length: f64) -> usize {
    (FINE * length).round().clamp(1.0, MOST) as usize
}

/// The middles of so many pixels over a window.
pub(crate) fn middles((from, to): (f64, f64), count: usize) -> Vec<f64> {
    let share = |pixel: usize| (pixel as f64 + 0.5) / count as f64;
    (0..count)
        .map(|pixel| from + (to - from) * share(pixel))
        .collect()
}

/// The density of an observable at a point, if it has one that can be drawn.
pub(crate) fn density(point: &Point, observable: usize) -> Option<&EstimatedDensity> {
    let estimated = point.densities.get(observable)?;
    let cells: usize = estimated.density.axes.iter().map(Axis::count).product();
    (cells == estimated.density.values.len()).then_some(estimated)
}

/// The computed points nearest to the wanted values, in that order, each once; without those that have no density.
pub(crate) fn nearest<'a>(result: &'a SweepResult, at: &[f64]) -> Vec<&'a Point> {
    let mut chosen: Vec<usize> = Vec::new();
    for &wanted in at.iter().filter(|wanted| wanted.is_finite()) {
        let distance = |point: &Point| (point.value - wanted).abs();
        let points = result.points.iter().enumerate();
        let nearest = points.min_by(|(_, a), (_, b)| distance(a).total_cmp(&distance(b)));
        if let Some((index, point)) = nearest
            && !point.densities.is_empty()
            && !chosen.contains(&index)
        {
            chosen.push(index);
        }
    }
    chosen
        .into_iter()
        .map(|index| &result.points[index])
        .collect()
}

/// The largest finite value; zero if there is none.
pub(crate) fn largest<'a>(densities: impl IntoIterator<Item = &'a Density>) -> f64 {
    let values = densities
        .into_iter()
        .flat_map(|density| density.values.iter());
    values
        .copied()
        .filter(|value| value.is_finite())
        .fold(0.0, f64::max)
}

/// The part of axis number `axis` outside of which all of the densities are nearly empty; it ends at edges of cells.
pub(crate) fn window(densities: &[&Density], axis: usize) -> Option<(f64, f64)> {
    let limit = EMPTY * largest(densities.iter().copied());
    let mut window: Option<(f64, f64)> = None;
    let mut whole: Option<(f64, f64)> = None;
    let join = |to: &mut Option<(f64, f64)>, part: (f64, f64)| {
        *to = Some(to.map_or(part, |(from, end)| (part.0.min(from), part.1.max(end))));
    };
    for density in densities {
        let Some(cells) = density.axes.get(axis) else {
            continue;
        };
        join(&mut whole, (cells.from(), cells.to()));
        let fastest: usize = density.axes[axis + 1..].iter().map(Axis::count).product();
        for (number, _) in density
            .values
            .iter()
            .enumerate()
            .filter(|(_, value)| **value > limit)
        {
            let cell = number / fastest % cells.count();
            join(&mut window, (cells.edges()[cell], cells.edges()[cell + 1]));
        }
    }
    let (whole, (from, to)) = (whole?, window?);
    let border = BORDER * (to - from);
    let first = densities
        .iter()
        .find_map(|density| density.axes.get(axis))?;
    let from = first
        .edges()
        .iter()
        .copied()
        .rfind(|&edge| edge <= from - border);
    let to = first
        .edges()
        .iter()
        .copied()
        .find(|&edge| edge >= to + border);
    Some((from.unwrap_or(whole.0), to.unwrap_or(whole.1)))
}

/// The part of axis number `axis` outside of which each density has at most a share of its mass at either end, with a
/// border; it ends at edges of cells. `None` without mass.
pub(crate) fn holding(densities: &[&Density], axis: usize, share: f64) -> Option<(f64, f64)> {
    let mut held: Option<(f64, f64)> = None;
    for density in densities {
        let cells = density.axes.get(axis)?;
        let mut masses = vec![0.0; cells.count()];
        let fastest: usize = density.axes[axis + 1..].iter().map(Axis::count).product();
        for (number, mass) in density.masses().into_iter().enumerate() {
            if mass.is_finite() {
                masses[number / fastest % cells.count()] += mass.max(0.0);
            }
        }
        let all: f64 = masses.iter().sum();
        if all <= 0.0 {
            continue;
        }
        let end = |masses: &mut dyn Iterator<Item = (usize, &f64)>| {
            let mut outside = 0.0;
            let mut inside = masses.skip_while(|(_, mass)| {
                outside += **mass;
                outside <= share * all
            });
            inside.next().map(|(cell, _)| cell)
        };
        let first = end(&mut masses.iter().enumerate())?;
        let last = end(&mut masses.iter().enumerate().rev())?;
        let (from, to) = (cells.edges()[first], cells.edges()[last + 1]);
        held = Some(held.map_or((from, to), |(a, b)| (from.min(a), to.max(b))));
    }
    let (from, to) = held?;
    let border = BORDER * (to - from);
    let edges = densities.first()?.axes.get(axis)?.edges();
    let below = edges.iter().rfind(|&&edge| edge <= from - border);
    let above = edges.iter().find(|&&edge| edge >= to + border);
    let whole = (edges.first()?, edges.last()?);
    Some((*below.unwrap_or(whole.0), *above.unwrap_or(whole.1)))
}

/// Pixels for a window of axes: one a cell where all are alike and uniform, else as many as a PNG shows.
pub(crate) fn cell_resolution(axes: &[&Axis], window: (f64, f64), length: f64) -> usize {
    let most = (length * PNG_SCALE).round().clamp(1.0, MOST_PIXELS) as usize;
    match axes {
        [first, rest @ ..] if are_even(first) && rest.iter().all(|axis| axis == first) => {
            let cells = (window.1 - window.0) / first.width(0);
            (cells.round() as usize).clamp(1, most)
        }
        _ => most,
    }
}

/// Difference of the widths of cells, relative, that no pixel shows.
const ALIKE: f64 = 1e-4;

fn are_even(axis: &Axis) -> bool {
    let mut cells = 0..axis.count();
    axis.is_uniform() && cells.all(|cell| (axis.width(cell) / axis.width(0) - 1.0).abs() < ALIKE)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn density(values: impl Fn(f64) -> f64) -> Density {
        let axis = Axis::uniform(-4.0, 4.0, 80).unwrap();
        let values = axis.centres().into_iter().map(values).collect();
        Density {
            axes: vec![axis],
            values,
        }
    }

    #[test]
    fn windows_hold_what_is_not_empty_and_end_at_edges() {
        let narrow = density(|x| (-8.0 * x * x).exp());
        let (from, to) = window(&[&narrow], 0).unwrap();
        // exp(-8 x²) = 1e-3 at x = 0.929.
        assert!(
            (0.95..1.2).contains(&-from) && (0.95..1.2).contains(&to),
            "{from} {to}"
        );
        assert!(narrow.axes[0].has_face_at(from) && narrow.axes[0].has_face_at(to));
        assert_eq!(
            cell_resolution(&[&narrow.axes[0]], (from, to), 300.0),
            ((to - from) / 0.1).round() as usize
        );
        let wide = density(|_| 0.125);
        assert_eq!(window(&[&narrow, &wide], 0), Some((-4.0, 4.0)));
        assert_eq!(window(&[&density(|_| 0.0)], 0), None);
    }
}
