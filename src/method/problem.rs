//! What a source of densities is made for.

use std::sync::{Arc, OnceLock};

use super::MethodError;
use super::measures::{DerivedMeasure, columns_of_family};
use crate::continuation::{CellCheck, Subject, Want};
use crate::density::{DensityError, Observable, Projection, QuantityMoments, layout_axis};
use crate::space::{Axis, CellSpace};
use crate::system::{AtPhase, BoundQuantity, Family};

/// What quantities need at one value of the path.
#[derive(Debug)]
pub(super) struct Maps {
    /// One an observable that has a quantity: the map, and a coarser one where the masses carry no noise.
    pub(super) watched: Vec<Option<(Projection, Option<Projection>)>>,
    /// One a quantity that is averaged.
    pub(super) averaged: Vec<AveragedMap>,
    /// The quantities that can be watched, in their order.
    pub(super) bound: Vec<BoundQuantity>,
    /// Of each of them whether its bins end where its values do.
    pub(super) own_ends: Vec<[bool; 2]>,
}

/// What turns masses into the moments of a quantity.
#[derive(Debug)]
pub(super) struct AveragedMap {
    pub(super) quantity: BoundQuantity,
    pub(super) moments: QuantityMoments,
    /// Where the masses carry no noise: the same with coarser sub-cells, and the quantity at the nodes of all cells.
    pub(super) judge: Option<(QuantityMoments, Vec<f64>)>,
}

/// The maps where they are the same along a whole path.
pub(super) type Fixed = Arc<OnceLock<Arc<Maps>>>;

/// Systems along a path, the cells on which they are solved, and what is watched: three things that fit together.
#[derive(Debug, Clone)]
pub struct Problem {
    subject: Subject,
    space: CellSpace,
    /// Those of the family's quantities, in their order.
    bins: Vec<Axis>,
    fixed: Fixed,
}

impl Problem {
    /// Puts the three together.
    ///
    /// # Errors
    /// [`MethodError::Dimension`] when the cells have another number of axes than the model, and
    /// [`MethodError::Density`] when an observable names an axis that does not exist.
    pub fn new(
        family: Family,
        space: CellSpace,
        observables: Vec<Observable>,
    ) -> Result<Self, MethodError> {
        Self::watching(family, space, observables, Vec::new())
    }

    /// As [`Problem::new`], with bins for the family's quantities, in their order: observables may name those that have
    /// bins.
    ///
    /// # Errors
    /// As [`Problem::new`].
    pub fn watching(
        family: Family,
        space: CellSpace,
        observables: Vec<Observable>,
        bins: Vec<Axis>,
    ) -> Result<Self, MethodError> {
        let (axes, cells) = (family.model().axes.len(), space.dimension());
        if axes != cells {
            return Err(MethodError::Dimension { axes, cells });
        }
        // An axis at a phase has the cells of the axis.
        let own = family.quantities().iter().map(|quantity| quantity.phase());
        let cells = |(at, bins): (Option<AtPhase>, Axis)| match at {
            Some(at) => space.axes()[at.axis].clone(),
            None => bins,
        };
        let bins: Vec<Axis> = own.zip(bins).map(cells).collect();
        let known = axes + bins.len().min(family.quantities().len());
        for &observable in &observables {
            let beyond = observable.axes().into_iter().find(|&axis| axis >= known);
            if let Some(axis) = beyond {
                let dimension = known;
                return Err(DensityError::Axis { axis, dimension }.into());
            }
            match observable {
                Observable::Joint(axis, other) if axis == other => {
                    return Err(DensityError::RepeatedAxis { axis }.into());
                }
                _ if observable.axes().into_iter().all(|axis| axis < axes) => {
                    Projection::new(&space, observable)?;
                }
                _ => {}
            }
        }
        let measures = columns_of_family(&family);
        let subject = Subject {
            family,
            observables,
            measures,
            cell_check: CellCheck::Needless,
        };
        Ok(Self {
            subject,
            space,
            bins,
            fixed: Fixed::default(),
        })
    }

    /// The systems and what is watched of them.
    pub fn subject(&self) -> &Subject {
        &self.subject
    }

    /// The systems along the path.
    pub fn family(&self) -> &Family {
        &self.subject.family
    }

    /// What is watched, in this order.
    pub fn observables(&self) -> &[Observable] {
        &self.subject.observables
    }

    /// The cells.
    pub fn space(&self) -> &CellSpace {
        &self.space
    }

    /// The same for a method of which this is known of its cells; a source says so of itself.
    #[must_use]
    pub(crate) fn checked_by(&self, cell_check: CellCheck) -> Self {
        let mut problem = self.clone();
        problem.subject.cell_check = cell_check;
        // What is worked out for one method is not for another.
        problem.fixed = Fixed::default();
        problem
    }

    /// The same with derived measures.
    #[must_use]
    pub(crate) fn measuring(mut self, measures: &[DerivedMeasure]) -> Self {
        let Subject {
            family,
            observables,
            ..
        } = &self.subject;
        let columns = measures
            .iter()
            .flat_map(|measure| measure.columns(family, observables));
        self.subject.measures = columns.chain(columns_of_family(family)).collect();
        self
    }

    /// The same with only what is wanted of it.
    #[must_use]
    pub(super) fn wanting(&self, want: &Want) -> Self {
        let mut problem = self.clone();
        if want.observables != self.subject.observables {
            problem.subject.observables.clone_from(&want.observables);
            problem.fixed = Fixed::default();
        }
        problem.subject.measures.clone_from(&want.measures);
        problem
    }

    /// The same in the coordinate in which the first switching surface across an axis does not move.
    ///
    /// # Errors
    /// [`MethodError::System`].
    pub(super) fn following_surface(mut self, axis: usize) -> Result<Self, MethodError> {
        self.subject.family = self.subject.family.following_surface(axis)?;
        self.fixed = Fixed::default();
        Ok(self)
    }

    /// The same without derived measures.
    #[must_use]
    pub(crate) fn without_measures(mut self) -> Self {
        self.subject.measures.clear();
        self
    }

    /// The bins of the family's quantities, in their order.
    pub fn bins(&self) -> &[Axis] {
        &self.bins
    }

    /// The family, and what the densities that are watched are laid out on.
    pub fn watched(&self) -> (&Family, Vec<(Observable, Vec<Axis>)>) {
        let watched = self.observables().iter();
        let watched = watched.map(|&one| (one, self.axes_of(one)));
        (self.family(), watched.collect())
    }

    /// What an observable's densities are laid out on.
    pub(crate) fn axes_of(&self, observable: Observable) -> Vec<Axis> {
        let all = || self.space.axes().iter().chain(&self.bins);
        let axes = observable.axes().into_iter();
        axes.filter_map(|axis| all().nth(axis).map(layout_axis))
            .collect()
    }

    /// What an observable at a phase of the forcing keeps, the phase, and the axis along which it runs; `None` for any
    /// other observable.
    pub(super) fn at_phase(&self, observable: Observable) -> Option<(Observable, f64, usize)> {
        let family = self.family();
        let (kept, phase) = family.at_phase(&observable.axes())?;
        let kept = match kept[..] {
            [axis] => Observable::Marginal(axis),
            [one, other] => Observable::Joint(one, other),
            _ => return None,
        };
        Some((kept, phase, family.model().phase_axis()?))
    }

    pub(super) fn fixed(&self) -> &Fixed {
        &self.fixed
    }

    /// The same on other cells, with the same bins.
    ///
    /// # Errors
    /// As [`Problem::new`].
    pub(crate) fn on(&self, space: CellSpace) -> Result<Self, MethodError> {
        let Subject {
            family,
            observables,
            measures,
            ..
        } = self.subject.clone();
        let mut problem = Self::watching(family, space, observables, self.bins.clone())?;
        problem.subject.measures = measures;
        Ok(problem)
    }

    /// The same with so many times as many bins.
    #[must_use]
    pub(super) fn with_finer_bins(mut self, factor: f64) -> Self {
        let own = self.subject.family.quantities().iter().zip(&self.bins);
        let finer = own.map(|(quantity, bins)| match quantity.phase() {
            Some(at) => self.space.axes()[at.axis].clone(),
            None => bins.refined(factor),
        });
        self.bins = finer.collect();
        self.fixed = Fixed::default();
        self
    }
}
