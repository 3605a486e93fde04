//! Axes and parameters that several models share, so that a letter means the same in all of them
//! (the paper's Eq. (7): κ is the viscous damping, α the linear stiffness).

use super::{AxisDescription, ParameterDescription, ParameterRange};

const fn parameter(
    name: &'static str,
    symbol: &'static str,
    meaning: &'static str,
) -> ParameterDescription {
    ParameterDescription {
        name,
        symbol,
        meaning,
        default: None,
        range: ParameterRange::Any,
    }
}

/// Displacement of an oscillator.
pub(super) const X: AxisDescription = AxisDescription {
    name: "x",
    symbol: "x",
    meaning: "displacement",
};

/// Velocity of an oscillator.
pub(super) const Y: AxisDescription = AxisDescription {
    name: "y",
    symbol: "ẋ",
    meaning: "velocity",
};

/// Internal displacement of Dahl's friction law.
pub(super) const Z: AxisDescription = AxisDescription {
    name: "z",
    symbol: "z",
    meaning: "internal displacement of the friction contact",
};

/// α, 1 unless given.
pub(super) const ALPHA: ParameterDescription = ParameterDescription {
    default: Some(1.0),
    ..parameter("alpha", "α", "linear stiffness")
};

/// κ, of either sign.
pub(super) const KAPPA: ParameterDescription = parameter("kappa", "κ", "viscous damping");

/// μ, 0 unless given.
pub(super) const MU: ParameterDescription = ParameterDescription {
    default: Some(0.0),
    ..parameter("mu", "μ", "cubic stiffness")
};

/// λ > 0 of Dahl's law.
pub(super) const LAMBDA: ParameterDescription = ParameterDescription {
    range: ParameterRange::Positive,
    ..parameter("lambda", "λ", "stiffness of the friction contact")
};

/// f_c of Coulomb's law, of either sign.
pub(super) const COULOMB_LEVEL: ParameterDescription = parameter(
    "f_c",
    "f_{c}",
    "friction level (negative: friction that feeds energy in)",
);

/// f_c > 0 of Dahl's law.
pub(super) const DAHL_LEVEL: ParameterDescription = ParameterDescription {
    range: ParameterRange::Positive,
    ..parameter("f_c", "f_{c}", "friction level")
};

/// σ² > 0.
pub(super) const SIGMA2: ParameterDescription = ParameterDescription {
    range: ParameterRange::Positive,
    ..parameter("sigma2", "σ^{2}", "noise intensity")
};

/// a of the bistable and Rayleigh models.
pub(super) const GROWTH: ParameterDescription =
    parameter("a", "a", "linear growth rate about the origin");

/// b > 0 of the Rayleigh model.
pub(super) const SATURATION: ParameterDescription = ParameterDescription {
    range: ParameterRange::Positive,
    ..parameter("b", "b", "growth of the damping with the energy")
};
