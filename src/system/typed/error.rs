//! What can be wrong with a model made of typed equations.

use std::fmt;
use std::ops::Range;

use crate::MAX_DIMENSION;
use crate::formula::language::FormulaError;
use crate::formula::limits;
use crate::formula::scope::SymbolError;
use crate::system::ColouredNoiseError;
use crate::system::PHASE_AXIS;

/// Where a formula of a model stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FormulaPlace {
    /// The equation of an axis.
    Equation {
        /// The axis.
        axis: String,
    },
    /// The amplitude of a noise.
    Noise {
        /// The axis.
        axis: String,
        /// The Wiener process, counted from 0 over the whole model.
        process: usize,
    },
    /// A definition.
    Definition {
        /// Its name.
        name: String,
    },
    /// A bound of an axis.
    Bound {
        /// The axis.
        axis: String,
    },
    /// The period in time.
    Period,
}

impl fmt::Display for FormulaPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Equation { axis } => write!(f, "the equation of `{axis}`"),
            Self::Noise { axis, process } => {
                write!(f, "the amplitude of noise {} on `{axis}`", process + 1)
            }
            Self::Definition { name } => write!(f, "the definition of `{name}`"),
            Self::Bound { axis } => write!(f, "a bound of `{axis}`"),
            Self::Period => f.write_str("the period"),
        }
    }
}

/// Why typed equations do not make a model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TypedModelError {
    /// No axes, or more than the methods have.
    #[error("{given} axes; a model has 1 to {MAX_DIMENSION}")]
    Axes {
        /// How many are given.
        given: usize,
    },
    /// A name that cannot be given: reserved, given twice, malformed.
    #[error(transparent)]
    Name(#[from] SymbolError),
    /// An equation, a noise or a bound of an axis that the model does not have.
    #[error("{place}: the model has no axis of that name; its axes are {}", .known.join(", "))]
    UnknownAxis {
        /// What is given for the axis.
        place: FormulaPlace,
        /// The axes.
        known: Vec<String>,
    },
    /// An axis without an equation.
    #[error("axis `{axis}` has no equation; write 0 for a coordinate that only noise moves")]
    MissingEquation {
        /// The axis.
        axis: String,
    },
    /// An equation, a bound or an amplitude of one noise that is given twice.
    #[error("{place} is given twice")]
    Doubled {
        /// What is given twice.
        place: FormulaPlace,
    },
    /// A formula that cannot be read.
    #[error("{place}:\n{}", .error.drawn(.text))]
    Formula {
        /// Where it stands.
        place: FormulaPlace,
        /// The formula.
        text: String,
        /// What is wrong with it, with the bytes of the text.
        error: Box<FormulaError>,
    },
    /// A definition that needs itself.
    #[error("{place}: it needs itself: {}", .circle.join(" → "))]
    Circle {
        /// The definition.
        place: FormulaPlace,
        /// The names in the order in which they need each other; the first is also the last.
        circle: Vec<String>,
        /// Where in the definition's text the next of them stands, in bytes.
        span: Range<usize>,
    },
    /// One Wiener process in several equations.
    #[error(
        "noise {} drives {}: one noise in several equations makes noises that are correlated between axes, \
         which the methods do not know; give each axis noises of its own", .process + 1, .axes.join(" and ")
    )]
    SharedNoise {
        /// The Wiener process, counted from 0 over the whole model.
        process: usize,
        /// The axes where its amplitude is not zero.
        axes: Vec<String>,
    },
    /// A noise that is read in two ways.
    #[error(
        "a noise on `{axis}` has an amplitude that depends on `{axis}`, so that Itô's and Stratonovich's readings \
         differ; say which is meant"
    )]
    Interpretation {
        /// The axis.
        axis: String,
    },
    /// Coloured noise that is to be read in Itô's way.
    #[error(
        "a noise on `{axis}` has an amplitude that depends on `{axis}`: coloured noise goes to white noise in Stratonovich's reading \
         only, never in Itô's"
    )]
    ColouredIto {
        /// The axis.
        axis: String,
    },
    /// Noise that cannot be coloured.
    #[error(transparent)]
    Coloured(#[from] ColouredNoiseError),
    /// A Stratonovich noise whose amplitude may jump where the coordinate that it drives moves through.
    #[error(
        "an amplitude may jump where {argument} = 0: Stratonovich's reading then has no drift correction; \
         use an amplitude without jumps, or Itô's reading"
    )]
    JumpingNoise {
        /// What is zero where it may jump.
        argument: String,
    },
    /// A formula that is not periodic in time or in an angle.
    #[error("{place}: {fault}")]
    Periodic {
        /// Where it stands.
        place: FormulaPlace,
        /// What is wrong.
        fault: PeriodFault,
    },
    /// States or time in a bound or a period.
    #[error("{place} contains `{symbol}`; it may contain parameters and numbers only")]
    NotOfParameters {
        /// Where it stands.
        place: FormulaPlace,
        /// A symbol that may not stand there.
        symbol: String,
    },
    /// A default outside the range of its parameter.
    #[error("the default of parameter `{parameter}` is {value}; it must be {allowed}")]
    Default {
        /// The parameter.
        parameter: String,
        /// Its default.
        value: f64,
        /// The range in words.
        allowed: &'static str,
    },
    /// What follows from the formulas, derivatives for example, has no room.
    #[error(
        "the formulas and their derivatives have more than {} different parts",
        limits::NODES
    )]
    TooLarge,
    /// More intermediate results at one time than a tape keeps.
    #[error(
        "the formulas keep more than {} intermediate results at one time",
        limits::REGISTERS
    )]
    TooWide,
}

/// Why formulas have no period in time, or not that of an angle.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PeriodFault {
    /// The symbol stands outside sines and cosines.
    #[error("`{symbol}` stands outside of sin and cos in {part}")]
    Bare {
        /// Time or the angle.
        symbol: String,
        /// The part of the formula, typeset.
        part: String,
    },
    /// The argument of a sine or cosine is no straight line in the symbol.
    #[error(
        "in {part} the argument is not a constant frequency times `{symbol}`, plus what does not contain it"
    )]
    Bent {
        /// Time or the angle.
        symbol: String,
        /// The part of the formula, typeset.
        part: String,
    },
    /// A jump or kink depends on the symbol.
    #[error("{part} jumps or bends where `{symbol}` says so")]
    Torn {
        /// Time or the angle.
        symbol: String,
        /// The part of the formula, typeset.
        part: String,
    },
    /// A sine or cosine of an angle that has another period.
    #[error("{part} does not have the period {period} of `{symbol}`{}", in_turns(.turns))]
    Other {
        /// The angle.
        symbol: String,
        /// The part of the formula, typeset.
        part: String,
        /// The period that was given.
        period: f64,
        /// Waves of it in that period, where it is a number.
        turns: Option<f64>,
    },
    /// A period that is no positive number.
    #[error("the period of `{symbol}` is {period}; it must be a positive number")]
    NotPositive {
        /// The angle.
        symbol: String,
        /// What was given.
        period: f64,
    },
    /// Two frequencies of which no common period is known.
    #[error(
        "the frequencies {one} and {other} have no common period: no ratio of whole numbers up to {most} at all parameters"
    )]
    NoCommonPeriod {
        /// The one.
        one: String,
        /// The other.
        other: String,
        /// The largest of these numbers.
        most: i32,
    },
    /// There is no room for a phase.
    #[error(
        "the phase of a forcing is one axis more than the {axes} of the state; at most {MAX_DIMENSION} are possible"
    )]
    Axes {
        /// Axes of the state.
        axes: usize,
    },
}

fn in_turns(turns: &Option<f64>) -> String {
    turns.map_or(String::new(), |turns| {
        format!(": it has {turns} waves in it")
    })
}

impl PeriodFault {
    /// What to write instead.
    pub(crate) fn remedy(&self) -> String {
        match self {
            Self::Bare { symbol, .. } if symbol == PHASE_AXIS => {
                "write the forcing with sin and cos, as cos(w t) or sin(2 w t + 0.5): a density over a period needs one".to_owned()
            }
            Self::Bare { symbol, .. } => format!(
                "an angle comes back after a turn, and so must what depends on it: write sin({symbol}) or cos({symbol}); \
                 or leave its period out, for a coordinate on a line"
            ),
            Self::Bent { symbol, .. } => {
                format!("write a frequency of parameters alone, as in cos(w {symbol} + x)")
            }
            Self::Torn { .. } => {
                "use a smooth function, such as tanh(u/v) for sign(u) with a small v: the series over a period of what jumps does \
                 not end".to_owned()
            }
            Self::Other { symbol, .. } => format!(
                "write a whole number of waves a period, as sin(2 {symbol}) for an angle of period 2 pi, or give the period that \
                 the formulas have"
            ),
            Self::NotPositive { symbol, .. } => {
                format!("give `{symbol} = \"periodic\"` for 2 pi, or `{symbol} = {{ period = 1.0 }}`")
            }
            Self::NoCommonPeriod { .. } => {
                "write the one as a multiple of the other, as w t and 3/2 w t; two independent frequencies would need two phases".to_owned()
            }
            Self::Axes { .. } => "leave out a state that the others do not need".to_owned(),
        }
    }
}
