//! What a system offers whose trajectories step in one loop with its drift.

use super::Lanes;

/// How trajectories of an oscillator x' = y, y' = F + b ξ, z' = G step. Laws without internal states have no z.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepScheme {
    /// Heun's predictor and corrector of all coordinates, the noise added to the predictor.
    Heun,
    /// The displacement moves by half a step, all else by a step of Heun's, the displacement by half a step again.
    Splitting,
}

/// Steps of an oscillator that are compiled in one loop with its drift.
///
/// A loop over arrays for every stage of a step loads and stores each number several times. In one loop a state stays
/// in a register from the drift at the start of a step to its end. What comes out must be the same to the bit as from
/// [`System::drift`](super::System::drift) in the order of operations that `pbif::sampling` has for every system;
/// tests hold every built-in model to that.
pub trait CompiledSteps: Send + Sync {
    /// Advances a batch by as many steps of length `time_step` as there are rows of `normals`. `increment` is the
    /// amplitude of the noise on the velocity, times √dt. Displacements of a splitting move by half a step before the
    /// first and after the last of the steps.
    fn advance(
        &self,
        scheme: StepScheme,
        time_step: f64,
        increment: f64,
        states: &mut [Lanes],
        normals: &[Lanes],
    );

    /// Adds the postprocessor of a splitting, (dt²/8) ∂F/∂x y, found by a difference over half a step of the
    /// displacement to either side, at `states` and times `sign` to the velocity in `shifted`, and likewise of internal
    /// states.
    fn shift(&self, time_step: f64, sign: f64, states: &[Lanes], shifted: &mut [Lanes]);
}
