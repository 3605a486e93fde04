//! What other schemes say of a point.

use crate::generator::AdvectiveScheme;

/// What the second scheme says of a point.
pub(super) struct Second {
    /// By how much its unknowns differ, with what all schemes err alike where a force turns; nothing in a check.
    pub(super) change: Vec<f64>,
    /// The same without what all schemes err alike.
    pub(super) by_scheme: Vec<f64>,
    /// Its solution; `None` in a check.
    pub(super) solved: Option<SecondSolve>,
}

/// A solution by the second scheme.
pub(super) struct SecondSolve {
    pub(super) unknowns: Vec<f64>,
    pub(super) masses: Vec<f64>,
}

impl Second {
    pub(super) fn unknowns(&self) -> Option<&[f64]> {
        Some(&self.solved.as_ref()?.unknowns)
    }

    pub(super) fn masses(&self) -> Option<&[f64]> {
        Some(&self.solved.as_ref()?.masses)
    }
}

/// The scheme whose difference to the given one stands for its error.
pub(super) fn companion(scheme: AdvectiveScheme) -> AdvectiveScheme {
    match scheme {
        AdvectiveScheme::Upwind5 | AdvectiveScheme::Central6 => AdvectiveScheme::Central4,
        AdvectiveScheme::Central4 => AdvectiveScheme::Central6,
    }
}

/// The scheme that is neither the given one nor its companion. Schemes of three sorts (biased upwind, central of fourth
/// and of sixth order) do not err alike by chance: of the default one, what its dissipation does is told by the central
/// scheme of sixth order.
pub(super) fn third(scheme: AdvectiveScheme) -> AdvectiveScheme {
    match scheme {
        AdvectiveScheme::Upwind5 => AdvectiveScheme::Central6,
        AdvectiveScheme::Central4 | AdvectiveScheme::Central6 => AdvectiveScheme::Upwind5,
    }
}
