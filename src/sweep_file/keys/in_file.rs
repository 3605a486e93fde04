//! Types of the program as a sweep file has them: numbers, texts, formulas, lists, and what is chosen by name.

use std::sync::Arc;

use super::super::draft::{Auto, ExponentKind, MethodKind, Modes};
use super::super::value::Plain;
use crate::figure::{ColourMap, ColourScale, FigureWidth, Format, Ground, Typeface};
use crate::generator::AdvectiveScheme;
use crate::method::{Correction, DerivedMeasure, Estimator, StepChoice};
use crate::sampling::Integrator;
use crate::stationary::Solver;
use crate::system::{ExponentMethod, FieldKind, Interpretation, Model, NoiseKind, Sides, registry};

/// A type of the program as the file has it.
pub(super) trait InFile: Sized {
    /// The value of the file.
    fn to_plain(&self) -> Plain;

    /// From a value of the right kind; `None` for any other.
    fn from_plain(plain: &Plain) -> Option<Self>;
}

impl InFile for String {
    fn to_plain(&self) -> Plain {
        Plain::Text(self.clone())
    }

    /// A text, or a formula: one that is a number alone need not be quoted.
    fn from_plain(plain: &Plain) -> Option<Self> {
        match plain {
            Plain::Text(text) => Some(text.clone()),
            Plain::Integer(_) | Plain::Number(_) => Some(plain.to_toml()),
            Plain::List(_) => None,
        }
    }
}

impl InFile for f64 {
    fn to_plain(&self) -> Plain {
        Plain::Number(*self)
    }

    fn from_plain(plain: &Plain) -> Option<Self> {
        plain.number()
    }
}

macro_rules! integers {
    ($($integer:ty),+) => {$(
        impl InFile for $integer {
            fn to_plain(&self) -> Plain {
                Plain::Integer(*self as i128)
            }

            fn from_plain(plain: &Plain) -> Option<Self> {
                match plain {
                    Plain::Integer(integer) => Self::try_from(*integer).ok(),
                    _ => None,
                }
            }
        }
    )+};
}
integers!(usize, u64);

/// Booleans are words.
pub(super) const SWITCH: [&str; 2] = ["on", "off"];

impl InFile for bool {
    fn to_plain(&self) -> Plain {
        Plain::Text(SWITCH[usize::from(!self)].to_owned())
    }

    fn from_plain(plain: &Plain) -> Option<Self> {
        plain.text().map(|word| word == SWITCH[0])
    }
}

/// The word for what is left to the program.
pub(super) const AUTO: &str = "auto";

impl InFile for Auto {
    fn to_plain(&self) -> Plain {
        Plain::Text(AUTO.to_owned())
    }

    fn from_plain(plain: &Plain) -> Option<Self> {
        (plain.text() == Some(AUTO)).then_some(Self)
    }
}

impl InFile for Modes {
    fn to_plain(&self) -> Plain {
        match self {
            Self::Auto => Auto.to_plain(),
            Self::Number(count) => count.to_plain(),
        }
    }

    fn from_plain(plain: &Plain) -> Option<Self> {
        match usize::from_plain(plain) {
            Some(count) => Some(Self::Number(count)),
            None => Auto::from_plain(plain).map(|Auto| Self::Auto),
        }
    }
}

impl InFile for StepChoice {
    fn to_plain(&self) -> Plain {
        match self {
            Self::Auto => Auto.to_plain(),
            Self::Fixed(value) => value.to_plain(),
        }
    }

    fn from_plain(plain: &Plain) -> Option<Self> {
        match plain.number() {
            Some(value) => Some(Self::Fixed(value)),
            None => Auto::from_plain(plain).map(|Auto| Self::Auto),
        }
    }
}

impl InFile for FigureWidth {
    fn to_plain(&self) -> Plain {
        match (self.name(), self.millimetres()) {
            (Some(name), _) => Plain::Text(name.to_owned()),
            (None, width) => Plain::Number(width.unwrap_or_default()),
        }
    }

    fn from_plain(plain: &Plain) -> Option<Self> {
        match plain.number() {
            Some(width) => Some(Self::Millimetres(width)),
            None => Self::parse(plain.text()?),
        }
    }
}

impl<T: InFile> InFile for Vec<T> {
    fn to_plain(&self) -> Plain {
        Plain::List(self.iter().map(T::to_plain).collect())
    }

    /// A list, or what would be its only entry.
    fn from_plain(plain: &Plain) -> Option<Self> {
        match plain.items() {
            Some(items) => items.iter().map(T::from_plain).collect(),
            None => Some(vec![T::from_plain(plain)?]),
        }
    }
}

impl InFile for [String; 2] {
    fn to_plain(&self) -> Plain {
        Plain::List(self.iter().map(String::to_plain).collect())
    }

    fn from_plain(plain: &Plain) -> Option<Self> {
        Vec::from_plain(plain)?.try_into().ok()
    }
}

impl InFile for Arc<Model> {
    fn to_plain(&self) -> Plain {
        Plain::Text(self.name.clone())
    }

    fn from_plain(plain: &Plain) -> Option<Self> {
        registry::find(plain.text()?).ok()
    }
}

/// What is chosen by name.
pub(super) trait Named: Copy + 'static {
    /// All choices.
    const CHOICES: &'static [Self];

    /// Name used in files.
    fn word(self) -> &'static str;

    /// The names of all choices.
    fn words() -> Vec<&'static str> {
        Self::CHOICES.iter().map(|choice| choice.word()).collect()
    }
}

macro_rules! named {
    ($($choice:ty),+) => {$(
        impl Named for $choice {
            const CHOICES: &'static [Self] = &Self::ALL;

            fn word(self) -> &'static str {
                self.name()
            }
        }

        impl InFile for $choice {
            fn to_plain(&self) -> Plain {
                Plain::Text(self.word().to_owned())
            }

            fn from_plain(plain: &Plain) -> Option<Self> {
                let word = plain.text()?;
                Self::CHOICES.iter().copied().find(|choice| choice.word() == word)
            }
        }
    )+};
}
named!(
    AdvectiveScheme,
    ColourMap,
    ColourScale,
    Correction,
    DerivedMeasure,
    Estimator,
    ExponentKind,
    ExponentMethod,
    Format,
    Ground,
    Integrator,
    Interpretation,
    MethodKind,
    FieldKind,
    NoiseKind,
    Sides,
    Solver,
    Typeface
);
