//! What is said of the axes and parameters of a model: names, symbols, meaning, and the values that are allowed.

/// Name of the axis of a forcing's phase: that of time in formulas.
pub(crate) const PHASE_AXIS: &str = "t";

/// One axis of a model's state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AxisDescription {
    /// Name used in files and on the command line, for example `y`.
    pub name: String,
    /// Symbol for figures; `_{}` and `^{}` set subscripts and superscripts, for example `ẋ`.
    pub symbol: String,
    /// Meaning in words.
    pub meaning: String,
    /// Whether modes carry it unless a file says otherwise: the density along it is smooth inside its bounds and no
    /// noise drives it, or it relaxes linearly without noise, or it is white noise behind a filter, or it closes on
    /// itself.
    pub by_modes: bool,
    /// Whether it is an angle: it closes on itself after a turn, so that its mean says nothing.
    pub is_angle: bool,
}

impl AxisDescription {
    /// An axis with its name, symbol and meaning.
    pub fn new(
        name: impl Into<String>,
        symbol: impl Into<String>,
        meaning: impl Into<String>,
    ) -> Self {
        Self {
            name: name.into(),
            symbol: symbol.into(),
            meaning: meaning.into(),
            by_modes: false,
            is_angle: false,
        }
    }

    /// The axis of the phase of a forcing, in periods.
    pub(crate) fn phase() -> Self {
        Self::new(PHASE_AXIS, "t/T", "phase of the forcing, in periods").carried_by_modes()
    }

    /// The same as an angle, which harmonics carry.
    #[must_use]
    pub(crate) fn closing(self) -> Self {
        Self {
            is_angle: true,
            ..self.carried_by_modes()
        }
    }

    /// The axis of an internal state that modes carry; a series in place of cells. The state has no noise, and either
    /// bounds, with a smooth density between them, or it relaxes linearly.
    #[must_use]
    pub(crate) fn carried_by_modes(self) -> Self {
        Self {
            by_modes: true,
            ..self
        }
    }
}

/// Values a parameter may take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ParameterRange {
    /// Any finite number.
    Any,
    /// Zero or more.
    NonNegative,
    /// More than zero.
    Positive,
}

impl ParameterRange {
    /// Whether `value` is finite and in the range.
    pub fn contains(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Any => true,
                Self::NonNegative => value >= 0.0,
                Self::Positive => value > 0.0,
            }
    }

    /// The range in words.
    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::Any => "a finite number",
            Self::NonNegative => "a finite number, zero or more",
            Self::Positive => "a finite number greater than zero",
        }
    }
}

/// One parameter of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterDescription {
    /// Name used in files, for example `f_c`.
    pub name: String,
    /// Symbol for figures, with `_{}` and `^{}`, for example `f_{c}`.
    pub symbol: String,
    /// Meaning in words.
    pub meaning: String,
    /// Value used when a file leaves the parameter out; `None` if it must be given.
    pub default: Option<f64>,
    /// Values it may take.
    pub range: ParameterRange,
}

impl ParameterDescription {
    /// A parameter with its name, symbol and meaning; it must be given and may be any number.
    pub fn new(
        name: impl Into<String>,
        symbol: impl Into<String>,
        meaning: impl Into<String>,
    ) -> Self {
        Self {
            name: name.into(),
            symbol: symbol.into(),
            meaning: meaning.into(),
            default: None,
            range: ParameterRange::Any,
        }
    }

    /// The parameter with a value that is used where none is given.
    #[must_use]
    pub fn with_default(self, value: f64) -> Self {
        Self {
            default: Some(value),
            ..self
        }
    }

    /// The parameter with the values it may take.
    #[must_use]
    pub fn within(self, range: ParameterRange) -> Self {
        Self { range, ..self }
    }
}

/// A symbol without its markup: `f_{c}` becomes `f_c`, `σ^{2}` σ².
pub(crate) fn in_letters(symbol: &str) -> String {
    let raised = symbol.replace("^{2}", "²").replace("^{3}", "³");
    raised.replace(['{', '}'], "")
}
