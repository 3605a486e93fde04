//! The functions that formulas may call, with their spellings and numbers of arguments.

/// A function of the language.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[allow(missing_docs)] // each is the function of its name; the reference is in the module's documentation
pub enum Function {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Exp,
    Log,
    Log10,
    Sqrt,
    Cbrt,
    Abs,
    Sign,
    Step,
    Floor,
    Min,
    Max,
    Hypot,
    Atan2,
    Pow,
    If,
}

/// Every spelling; the first of a function is the one that is printed.
const SPELLINGS: &[(&str, Function)] = &[
    ("sin", Function::Sin),
    ("cos", Function::Cos),
    ("tan", Function::Tan),
    ("asin", Function::Asin),
    ("acos", Function::Acos),
    ("atan", Function::Atan),
    ("sinh", Function::Sinh),
    ("cosh", Function::Cosh),
    ("tanh", Function::Tanh),
    ("exp", Function::Exp),
    ("log", Function::Log),
    ("ln", Function::Log),
    ("log10", Function::Log10),
    ("sqrt", Function::Sqrt),
    ("cbrt", Function::Cbrt),
    ("abs", Function::Abs),
    ("sign", Function::Sign),
    ("sgn", Function::Sign),
    ("step", Function::Step),
    ("floor", Function::Floor),
    ("min", Function::Min),
    ("max", Function::Max),
    ("hypot", Function::Hypot),
    ("atan2", Function::Atan2),
    ("pow", Function::Pow),
    ("if", Function::If),
];

impl Function {
    /// The function of a name as it is written in a formula.
    pub(crate) fn named(name: &str) -> Option<Self> {
        let entry = SPELLINGS.iter().find(|(spelling, _)| *spelling == name)?;
        Some(entry.1)
    }

    /// All names of functions, other spellings included.
    pub(crate) fn names() -> impl Iterator<Item = &'static str> {
        SPELLINGS.iter().map(|(name, _)| *name)
    }

    /// The name that is printed.
    pub fn name(self) -> &'static str {
        let entry = SPELLINGS.iter().find(|(_, function)| *function == self);
        entry.map_or("", |(name, _)| name)
    }

    /// Fewest and most arguments; `None` where there is no most.
    pub(crate) fn arguments(self) -> (usize, Option<usize>) {
        match self {
            Self::Min | Self::Max => (2, None),
            Self::Hypot | Self::Atan2 | Self::Pow => (2, Some(2)),
            Self::If => (3, Some(3)),
            _ => (1, Some(1)),
        }
    }

    /// How a call is written, for messages.
    pub(crate) fn example(self) -> String {
        match self {
            Self::Min | Self::Max => format!("{}(a, b, …)", self.name()),
            Self::Hypot => "hypot(x, y)".to_owned(),
            Self::Atan2 => "atan2(y, x)".to_owned(),
            Self::Pow => "pow(base, exponent)".to_owned(),
            Self::If => "if(condition, value, otherwise)".to_owned(),
            _ => format!("{}(x)", self.name()),
        }
    }
}
