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

impl Parameter {
    const fn positive(self) -> Self {
        let range = ParameterRange::Positive;
        Self { range, ..self }
    }

    const fn not_negative(self) -> Self {
        let range = ParameterRange::NonNegative;
        Self { range, ..self }
    }

    /// With a value that is used where none is given.
    const fn or(self, value: f64) -> Self {
        let default = Some(value);
        Self { default, ..self }
    }
}

/// Of a friction law without internal states.
pub(super) const NO_STATES: [Axis; 0] = [];

/// Displacement of an oscillator.
pub(super) const X: Axis = Axis("x", "x", "displacement");

/// Velocity of an oscillator.
pub(super) const Y: Axis = Axis("y", "ẋ", "velocity");

/// Internal displacement of Dahl's friction law.
pub(super) const Z: Axis = Axis("z", "z", "internal displacement of the friction contact");

/// α, 1 unless given.
pub(super) const ALPHA: Parameter = parameter("alpha", "α", "linear stiffness").or(1.0);

/// κ, of either sign.
pub(super) const KAPPA: Parameter = parameter("kappa", "κ", "viscous damping");

/// μ, 0 unless given.
pub(super) const MU: Parameter = parameter("mu", "μ", "cubic stiffness").or(0.0);

/// λ > 0 of Dahl's law.
pub(super) const LAMBDA: Parameter =
    parameter("lambda", "λ", "stiffness of the friction contact").positive();

/// f_c of Coulomb's law, of either sign.
pub(super) const COULOMB_LEVEL: Parameter = parameter(
    "f_c",
    "f_{c}",
    "friction level (negative: friction that feeds energy in)",
);

/// f_c > 0 of Dahl's law.
pub(super) const DAHL_LEVEL: Parameter = parameter("f_c", "f_{c}", "friction level").positive();

/// f_s of Stribeck's law, of either sign.
pub(super) const STATIC_LEVEL: Parameter = parameter("f_s", "f_{s}", "friction level at rest");

/// f_s > 0 of the LuGre law.
pub(super) const STATIC_LEVEL_OF_BRISTLES: Parameter = STATIC_LEVEL.positive();

/// v_s > 0.
pub(super) const STRIBECK_VELOCITY: Parameter = parameter(
    "v_s",
    "v_{s}",
    "Stribeck velocity, over which the level falls from f_s to f_c",
)
.positive();

/// v_b, 0 unless given.
pub(super) const BELT_VELOCITY: Parameter = parameter(
    "v_b",
    "v_{b}",
    "velocity of the base on which the body rubs",
)
.or(0.0);

/// f_m of the cubic law.
pub(super) const LEAST_LEVEL: Parameter = parameter("f_m", "f_{m}", "least friction of sliding");

/// v_m > 0 of the cubic law.
pub(super) const LEAST_VELOCITY: Parameter = parameter(
    "v_m",
    "v_{m}",
    "velocity of sliding at which friction is least",
)
.positive();

/// η of the LuGre law, 0 unless given.
pub(super) const CONTACT_DAMPING: Parameter =
    parameter("eta", "η", "damping of the friction contact")
        .not_negative()
        .or(0.0);

/// f_b of the elasto-plastic law.
pub(super) const ELASTIC_LEVEL: Parameter = parameter(
    "f_b",
    "f_{b}",
    "friction force up to which the contact is elastic",
)
.not_negative();

/// f_t > 0 of the elasto-plastic law.
pub(super) const YIELDING_LEVEL: Parameter =
    parameter("f_t", "f_{t}", "rise of the force from there to sliding").positive();

/// λ of the Bouc-Wen law, of either sign.
pub(super) const HYSTERESIS_FORCE: Parameter =
    parameter("lambda", "λ", "force of the hysteretic state");

/// A > 0 of the Bouc-Wen law, 1 unless given.
pub(super) const HYSTERESIS_GROWTH: Parameter =
    parameter("A", "A", "rate of the hysteretic state before it yields")
        .positive()
        .or(1.0);

/// β > 0 of the Bouc-Wen law.
pub(super) const HYSTERESIS_LOSS: Parameter = parameter(
    "beta",
    "β",
    "loss of the hysteretic state, by which the loop is wide",
)
.positive();

/// γ of the Bouc-Wen law, 0 unless given.
pub(super) const HYSTERESIS_SHAPE: Parameter = parameter(
    "gamma",
    "γ",
    "shape of the loop: above 0 softening, below 0 hardening",
)
.or(0.0);

/// n > 0 of the Bouc-Wen law, 1 unless given.
pub(super) const SHARPNESS: Parameter = parameter("n", "n", "sharpness of yielding")
    .positive()
    .or(1.0);

/// The element of the Bliman-Sorine law that yields first.
pub(super) const FAST_FORCE: Axis = Axis("u", "u", "force of the fast friction element");

/// The element of the Bliman-Sorine law that yields last.
pub(super) const SLOW_FORCE: Axis = Axis("v", "v", "force of the slow friction element");

/// f₁ > 0.
pub(super) const FAST_LEVEL: Parameter =
    parameter("f_1", "f_{1}", "level of the fast friction element").positive();

/// f₂ > 0.
pub(super) const SLOW_LEVEL: Parameter =
    parameter("f_2", "f_{2}", "level of the slow friction element").positive();

/// ε > 0.
pub(super) const SLIDING_DISTANCE: Parameter = parameter(
    "epsilon",
    "ε",
    "distance over which the slow element yields",
)
.positive();

/// ρ > 0.
pub(super) const SWIFTNESS: Parameter = parameter(
    "rho",
    "ρ",
    "distance of the fast element as a share of the slow one's",
)
.positive();

/// σ² > 0.
pub(super) const SIGMA2: Parameter = parameter("sigma2", "σ^{2}", "noise intensity").positive();

/// a of the bistable and Rayleigh models.
pub(super) const GROWTH: Parameter = parameter("a", "a", "linear growth rate about the origin");

/// b > 0 of the Rayleigh model.
pub(super) const SATURATION: Parameter =
    parameter("b", "b", "growth of the damping with the energy").positive();
