//! Sums cell masses over the axes that an observable does not keep, and divides by volume.

use std::sync::Arc;

use super::series_map::{SeriesMap, layout_axis};
use super::spread::{Averages, Coordinate, Detail, Spread};
use super::{Density, DensityError, Moments, Observable, cell_volumes};
use crate::space::{Axis, CellSpace};
use crate::system::BoundQuantity;

/// The map from the cells of a cell space to the cells of an observable, worked out once and applied to
/// as many mass vectors as wanted.
#[derive(Debug, Clone)]
pub struct Projection {
    axes: Vec<Axis>,
    sums: Sums,
    /// From what is summed to the cells of the observable, where that takes more than sums.
    spread: Option<Arc<Spread>>,
    /// The same for axes of modes.
    series: Option<Arc<SeriesMap>>,
    /// What the masses of all cells are multiplied by first, for a density at a phase.
    factors: Option<Arc<Vec<f64>>>,
    volumes: Vec<f64>,
}

/// Sums over the axes of a space that are not kept.
#[derive(Debug, Clone)]
struct Sums {
    /// Cell that each cell of the space adds to; length `n_cells`.
    targets: Vec<u32>,
    count: usize,
}

impl Sums {
    /// For axes that exist and differ, in the order wanted.
    fn new(space: &CellSpace, kept: &[usize]) -> Self {
        // What one step along each axis of the space adds to the number of the cell.
        let mut strides = vec![0; space.dimension()];
        let mut stride: u32 = 1;
        for &axis in kept.iter().rev() {
            strides[axis] = stride;
            // No overflow: a cell space has at most `CellSpace::LIMIT` cells.
            stride *= space.axes()[axis].count() as u32;
        }
        let mut targets = vec![0];
        for (axis, &stride) in space.axes().iter().zip(&strides) {
            let steps = |target: u32| (0..axis.count() as u32).map(move |i| target + i * stride);
            targets = targets.into_iter().flat_map(steps).collect();
        }
        Self {
            targets,
            count: stride as usize,
        }
    }

    fn of(&self, mass: &[f64]) -> Result<Vec<f64>, DensityError> {
        check_length(mass, self.targets.len())?;
        let mut sums = vec![0.0; self.count];
        for (&target, value) in self.targets.iter().zip(mass) {
            sums[target as usize] += value;
        }
        Ok(sums)
    }
}

impl Projection {
    /// Works out the map, for a cell space of 1 to 4 axes.
    ///
    /// # Errors
    /// [`DensityError::Axis`] or [`DensityError::RepeatedAxis`].
    pub fn new(space: &CellSpace, observable: Observable) -> Result<Self, DensityError> {
        let dimension = space.dimension();
        let kept = observable.axes();
        if let Some(&axis) = kept.iter().find(|&&axis| axis >= dimension) {
            return Err(DensityError::Axis { axis, dimension });
        }
        if kept.len() == 2 && kept[0] == kept[1] {
            return Err(DensityError::RepeatedAxis { axis: kept[0] });
        }
        let axes: Vec<Axis> = kept.iter().map(|&a| space.axes()[a].clone()).collect();
        Ok(Self {
            sums: Sums::new(space, &kept),
            spread: None,
            series: None,
            factors: None,
            volumes: cell_volumes(&axes),
            axes,
        })
    }

    /// The same at a place on an axis of the space that closes on itself, where the state spends the same time
    /// everywhere along it: the conditional density there. The coarser map leaves the last harmonic out.
    pub(crate) fn at_phase(
        mut self,
        space: &CellSpace,
        axis: usize,
        phase: f64,
        is_coarse: bool,
    ) -> Self {
        self.factors = Some(Arc::new(phase_factors(
            space,
            axis,
            phase,
            usize::from(is_coarse),
        )));
        self
    }

    /// Works out the map with bins of equal width along axes of modes, of which the masses are integrals of the series;
    /// the maps of all modes and of fewer (`is_coarse`) differ by what the last modes do to the density. Without such
    /// axes it is that of [`Projection::new`].
    ///
    /// # Errors
    /// [`DensityError::Axis`] or [`DensityError::RepeatedAxis`].
    pub fn of_series(
        space: &CellSpace,
        observable: Observable,
        is_coarse: bool,
    ) -> Result<Self, DensityError> {
        let nodes = Self::new(space, observable)?;
        let Some(series) = SeriesMap::new(space, observable, is_coarse) else {
            return Ok(nodes);
        };
        let axes: Vec<Axis> = nodes.axes.iter().map(layout_axis).collect();
        Ok(Self {
            series: Some(Arc::new(series)),
            volumes: cell_volumes(&axes),
            axes,
            ..nodes
        })
    }

    /// Works out the map for one or two coordinates of which some are quantities; `planes` are axes of the space with
    /// coordinates at which the derivative of the density jumps. The maps of two details differ by what sub-cells do to
    /// the density.
    ///
    /// # Errors
    /// [`DensityError::Axis`] or [`DensityError::Coordinates`].
    pub(crate) fn of_quantities(
        space: &CellSpace,
        coordinates: &[Coordinate],
        detail: Detail,
        planes: &[(usize, f64)],
    ) -> Result<Self, DensityError> {
        let dimension = space.dimension();
        let axes: Result<Vec<Axis>, DensityError> = coordinates
            .iter()
            .map(|coordinate| match coordinate {
                Coordinate::Axis(axis) => {
                    let known = space.axes().get(*axis).map(layout_axis);
                    known.ok_or(DensityError::Axis {
                        axis: *axis,
                        dimension,
                    })
                }
                Coordinate::Quantity(_, bins) => Ok(bins.clone()),
            })
            .collect();
        let axes = axes?;
        if !matches!(axes.len(), 1 | 2) {
            return Err(DensityError::Coordinates { given: axes.len() });
        }
        let spread = Spread::new(space, coordinates, detail, planes);
        Ok(Self {
            sums: Sums::new(space, spread.axes()),
            spread: Some(Arc::new(spread)),
            series: None,
            factors: None,
            volumes: cell_volumes(&axes),
            axes,
        })
    }

    /// Number of cells of the observable.
    pub(crate) fn n_cells(&self) -> usize {
        self.volumes.len()
    }

    /// Volumes of the observable's cells.
    pub(super) fn volumes(&self) -> &[f64] {
        &self.volumes
    }

    /// Masses of the observable's cells, from the masses of all cells of the space. What lies beyond the bins of a
    /// quantity is not among them.
    ///
    /// # Errors
    /// [`DensityError::Length`].
    pub fn masses(&self, mass: &[f64]) -> Result<Vec<f64>, DensityError> {
        let sums = match &self.factors {
            Some(factors) => self.sums.of(&times(mass, factors))?,
            None => self.sums.of(mass)?,
        };
        if let Some(series) = &self.series {
            return Ok(series.masses(sums));
        }
        let Some(spread) = &self.spread else {
            return Ok(sums);
        };
        let mut bins = vec![0.0; self.n_cells()];
        spread.add_masses(&sums, &mut bins);
        Ok(bins)
    }

    /// Density of the observable; ∫ equals the sum of `mass`, which is 1 by contract and not rescaled.
    ///
    /// # Errors
    /// [`DensityError::Length`].
    pub fn density(&self, mass: &[f64]) -> Result<Density, DensityError> {
        let mut values = self.masses(mass)?;
        for (value, volume) in values.iter_mut().zip(&self.volumes) {
            *value /= volume;
        }
        Ok(Density {
            axes: self.axes.clone(),
            values,
        })
    }
}

/// What masses of all cells are multiplied by, so that their sums along an axis that closes on itself are the density
/// at a place on it, with so many of the last harmonics left out. A cell of such an axis stands for the place at its
/// beginning, where states were looked at.
pub(crate) fn phase_factors(
    space: &CellSpace,
    axis: usize,
    phase: f64,
    left_out: usize,
) -> Vec<f64> {
    let along = &space.axes()[axis];
    let weights = if along.is_modes() {
        let harmonics = along.mode_number().saturating_sub(left_out);
        along.weights_at(phase, harmonics)
    } else {
        let count = along.count();
        let turns = (phase - along.from()) / (along.to() - along.from());
        let nearest = (turns * count as f64).round() as usize % count;
        let weight = |cell| if cell == nearest { count as f64 } else { 0.0 };
        (0..count).map(weight).collect()
    };
    let cells = 0..space.n_cells();
    cells
        .map(|cell| weights[space.position(cell, axis)])
        .collect()
}

/// Products of two lists, one by one.
pub(crate) fn times(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a * b).collect()
}

/// Mean and standard deviation of a quantity from the masses of cells, worked out once and applied to as many mass
/// vectors as wanted.
#[derive(Debug, Clone)]
pub(crate) struct QuantityMoments {
    sums: Sums,
    averages: Arc<Averages>,
}

impl QuantityMoments {
    /// Works out the map; see [`Projection::of_quantities`].
    pub(crate) fn new(
        space: &CellSpace,
        quantity: &BoundQuantity,
        detail: Detail,
        planes: &[(usize, f64)],
    ) -> Self {
        let averages = Averages::new(space, quantity, detail, planes);
        Self {
            sums: Sums::new(space, averages.axes()),
            averages: Arc::new(averages),
        }
    }

    /// A state next to which the quantity, or its square, is no number or beyond the range of numbers: there is no mean
    /// then.
    pub(crate) fn undefined(&self) -> Option<&[f64]> {
        self.averages.undefined()
    }

    /// The moments for the masses of all cells of the space, Σ = 1; not a number where the quantity is
    /// [`Self::undefined`].
    ///
    /// # Errors
    /// [`DensityError::Length`].
    pub(crate) fn of(&self, mass: &[f64]) -> Result<Moments, DensityError> {
        let [mean, square] = self.averages.of(&self.sums.of(mass)?);
        let variance = square - mean * mean;
        Ok(Moments {
            mean,
            // Rounding must not make a root of a negative number; what is no number must not become zero.
            standard_deviation: if variance < 0.0 { 0.0 } else { variance.sqrt() },
        })
    }

    /// What a coarser map changes of the moments, were its changes in all layers of cells of one sign: the largest over
    /// the axes. In the tails, where cells are wide against the scale on which the density falls, polynomials through
    /// the masses err from cell to cell, and their sums by both maps may agree.
    ///
    /// # Errors
    /// [`DensityError::Length`].
    pub(crate) fn change_of_layers(
        &self,
        coarser: &Self,
        mass: &[f64],
        own: &Moments,
    ) -> Result<Moments, DensityError> {
        let [fine, coarse] = [self, coarser].map(|map| {
            let sums = map.sums.of(mass)?;
            Ok::<_, DensityError>(map.averages.layers(&sums))
        });
        let spread = own.standard_deviation.max(f64::MIN_POSITIVE);
        let mut most = Moments {
            mean: 0.0,
            standard_deviation: 0.0,
        };
        for (fine, coarse) in fine?.iter().zip(&coarse?) {
            let (mut mean, mut square) = (0.0, 0.0);
            for (a, b) in fine.iter().zip(coarse) {
                mean += (b[0] - a[0]).abs();
                square += (b[1] - a[1] - 2.0 * own.mean * (b[0] - a[0])).abs();
            }
            most.mean = most.mean.max(mean);
            most.standard_deviation = most.standard_deviation.max(0.5 * square / spread);
        }
        Ok(most)
    }
}

/// One value a cell, or an error.
pub(super) fn check_length(values: &[f64], wanted: usize) -> Result<(), DensityError> {
    let given = values.len();
    if given == wanted {
        Ok(())
    } else {
        Err(DensityError::Length { given, wanted })
    }
}

#[cfg(test)]
mod tests;
