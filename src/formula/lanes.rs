//! The batch that formulas, systems and samplers run on.

/// Number of states that are advanced together. Kernels work on whole batches, so that arithmetic
/// fills vector registers and the cost of a virtual call is shared by this many states.
pub const LANES: usize = 64;

/// One coordinate of a batch of [`LANES`] states.
pub type Lanes = [f64; LANES];
