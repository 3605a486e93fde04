//! What a source of densities is made for.

use super::MethodError;
use crate::continuation::{CellCheck, Subject};
use crate::density::{Observable, Projection};
use crate::space::CellSpace;
use crate::system::Family;

/// Systems along a path, the cells on which they are solved, and what is watched: three things that fit together.
#[derive(Debug, Clone)]
pub struct Problem {
    subject: Subject,
    space: CellSpace,
}

impl Problem {
    /// Puts the three together.
    ///
    /// # Errors
    /// [`MethodError::Dimension`] when the cells have another number of axes than the model, and [`MethodError::Density`]
    /// when an observable names an axis that does not exist.
    pub fn new(
        family: Family,
        space: CellSpace,
        observables: Vec<Observable>,
    ) -> Result<Self, MethodError> {
        let (axes, cells) = (family.model().axes.len(), space.dimension());
        if axes != cells {
            return Err(MethodError::Dimension { axes, cells });
        }
        for &observable in &observables {
            Projection::new(&space, observable)?;
        }
        let subject = Subject {
            family,
            observables,
            cell_check: CellCheck::Needless,
        };
        Ok(Self { subject, space })
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
    pub fn checked_by(&self, cell_check: CellCheck) -> Self {
        let mut problem = self.clone();
        problem.subject.cell_check = cell_check;
        problem
    }

    /// The same on other cells.
    ///
    /// # Errors
    /// As [`Problem::new`].
    pub fn on(&self, space: CellSpace) -> Result<Self, MethodError> {
        let Subject {
            family,
            observables,
            ..
        } = self.subject.clone();
        Self::new(family, space, observables)
    }
}
