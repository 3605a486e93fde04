//! A density as figures show it: followed between its cells where it has no sampling noise, else cell by cell.

use crate::density::EstimatedDensity;
use crate::topology::Between;

use super::canvas::style::PNG_SCALE;
use super::select;

/// Points of a curve over its window, beside those that its cells add.
const POINTS: usize = 300;
/// Pixels of a map to a figure pixel.
const FINE: f64 = 0.5 * PNG_SCALE;
/// Most pixels of a map along a side.
const MOST: f64 = 900.0;

/// A density with what is known of it between its cells.
#[derive(Debug, Clone)]
pub(super) struct Shown<'a> {
    estimated: &'a EstimatedDensity,
    /// `None` where the cells are drawn as they are.
    pub(super) between: Option<Between<'a>>,
    /// The largest value that is drawn.
    pub(super) largest: f64,
}

impl<'a> Shown<'a> {
    pub(super) fn new(estimated: &'a EstimatedDensity) -> Self {
        let between = Between::new(estimated);
        let cells = select::largest([&estimated.density]);
        Self {
            largest: between.as_ref().map_or(cells, Between::largest).max(cells),
            between,
            estimated,
        }
    }

    /// The same cell by cell.
    pub(super) fn by_cells(estimated: &'a EstimatedDensity) -> Self {
        Self {
            largest: select::largest([&estimated.density]),
            between: None,
            estimated,
        }
    }

    /// Coordinates and values of a marginal in a window: one a cell where it has noise.
    pub(super) fn curve(&self, window: (f64, f64)) -> Vec<(f64, f64)> {
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
    pub(super) fn along(&self, places: &[f64]) -> Vec<f64> {
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
    pub(super) fn resolution(&self, k: usize, window: (f64, f64), length: f64) -> usize {
        match (&self.between, self.estimated.density.axes.get(k)) {
            (None, Some(axis)) => select::resolution(&[axis], window, length),
            _ => resolution(length),
        }
    }

    /// The values at all pairs of places of both axes, those of the second axis fastest; no numbers outside.
    pub(super) fn sheet(&self, x: &[f64], y: &[f64]) -> Vec<f64> {
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
pub(super) fn resolution(length: f64) -> usize {
    (FINE * length).round().clamp(1.0, MOST) as usize
}

/// The middles of so many pixels over a window.
pub(super) fn middles((from, to): (f64, f64), count: usize) -> Vec<f64> {
    let share = |pixel: usize| (pixel as f64 + 0.5) / count as f64;
    (0..count)
        .map(|pixel| from + (to - from) * share(pixel))
        .collect()
}
