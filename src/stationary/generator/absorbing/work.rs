//! What solves of processes that end leave: what was done, and factors whose structure serves again.

use super::super::preconditioner::Preconditioner;

/// Structure and memory of factors, kept from one matrix to the next.
#[derive(Default)]
pub(crate) struct FactorMemory(pub(super) Option<Preconditioner>);

/// What was done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct AbsorbingWork {
    /// Factorisations.
    pub factorisations: usize,
    /// Passes of forward and backward substitution.
    pub passes: usize,
}

impl AbsorbingWork {
    /// Takes up what was done besides.
    pub(crate) fn add(&mut self, more: Self) {
        self.factorisations += more.factorisations;
        self.passes += more.passes;
    }
}
