//! What passages leave from one value of a sweep to the next: structure and memory of factors, by grids.
//!
//! Numbers do not depend on it: a factorisation takes over what is made from the pattern of a matrix alone.

use std::sync::{Mutex, PoisonError};

use crate::stationary::generator::FactorMemory;

/// What the passages of one question leave, to be handed to the same question at the next value.
#[derive(Default)]
pub(crate) struct PassageMemory {
    /// Of the sweep's cells, and of the fewer cells by which errors are made.
    pub(super) grids: [GridMemory; 3],
}

/// What is left on one grid.
#[derive(Default)]
pub(super) struct GridMemory(Mutex<FactorMemory>);

impl GridMemory {
    /// What was left, which is nothing from now on.
    pub(super) fn take(&self) -> FactorMemory {
        std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Leaves something.
    pub(super) fn put(&self, memory: FactorMemory) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = memory;
    }
}
