//! Axes and parameters that several models share, so that a letter means the same in all of them
//! (the paper's Eq. (7): κ is the viscous damping, α the linear stiffness).

use super::{AxisDescription, ParameterDescription, ParameterRange};

/// An axis as it is declared here: name, symbol and meaning.
#[derive(Clone, Copy)]
pub(super) struct Axis(&'static str, &'static str, &'static str);

impl From<Axis> for AxisDescription {
    fn from(Axis(name, symbol, meaning): Axis) -> Self {
        Self::new(name, symbol, meaning)
    }
}

/// A parameter as it is declared here; what is left out is as in [`ParameterDescription::new`].
pub(super) struct Parameter {
    name: &'static str,
    symbol: &'static str,
    meaning: &'static str,
    default: Option<f64>,
    range: ParameterRange,
}

impl From<Parameter> for ParameterDescription {
    fn from(declared: Parameter) -> Self {
        Self {
            default: declared.default,
            range: declared.range,
            ..Self::new(declared.name, declared.symbol, declared.meaning)
        }
    }
}

const fn parameter(name: &'static str, symbol: &'static str, meaning: &'static str) -> Parameter {
    Parameter {
        name,
        symbol,
        meaning,
        default: None,
        range: ParameterRange::Any,
    }
}

/// Displacement of an oscillator.
pub(super) const X: Axis = Axis("x", "x", "displacement");

/// Velocity of an oscillator.
pub(super) const Y: Axis = Axis("y", "ẋ", "velocity");

/// Internal displacement of Dahl's friction law.
pub(super) const Z: Axis = Axis("z", "z", "internal displacement of the friction contact");

/// α, 1 unless given.
pub(super) const ALPHA: Parameter = Parameter {
    default: Some(1.0),
    ..parameter("alpha", "α", "linear stiffness")
};

/// κ, of either sign.
pub(super) const KAPPA: Parameter = parameter("kappa", "κ", "viscous damping");

/// μ, 0 unless given.
pub(super) const MU: Parameter = Parameter {
    default: Some(0.0),
    ..parameter("mu", "μ", "cubic stiffness")
};

/// λ > 0 of Dahl's law.
pub(super) const LAMBDA: Parameter = Parameter {
    range: ParameterRange::Positive,
    ..parameter("lambda", "λ", "stiffness of the friction contact")
};

/// f_c of Coulomb's law, of either sign.
pub(super) const COULOMB_LEVEL: Parameter = parameter(
    "f_c",
    "f_{c}",
    "friction level (negative: friction that feeds energy in)",
);

/// f_c > 0 of Dahl's law.
pub(super) const DAHL_LEVEL: Parameter = Parameter {
    range: ParameterRange::Positive,
    ..parameter("f_c", "f_{c}", "friction level")
};

/// σ² > 0.
pub(super) const SIGMA2: Parameter = Parameter {
    range: ParameterRange::Positive,
    ..parameter("sigma2", "σ^{2}", "noise intensity")
};

/// a of the bistable and Rayleigh models.
pub(super) const GROWTH: Parameter = parameter("a", "a", "linear growth rate about the origin");

/// b > 0 of the Rayleigh model.
pub(super) const SATURATION: Parameter = Parameter {
    range: ParameterRange::Positive,
    ..parameter("b", "b", "growth of the damping with the energy")
};
