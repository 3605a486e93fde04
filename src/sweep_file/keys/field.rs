//! How a key's value gets into a [`Draft`] and out of it.

use std::sync::Arc;

use super::super::draft::{Auto, Draft, EndKind, ExponentKind, MethodKind, Modes};
use super::super::value::Plain;
use crate::figure::{ColourMap, ColourScale, FigureWidth, Format, Ground, Typeface};
use crate::generator::AdvectiveScheme;
use crate::method::{Correction, DerivedMeasure, Estimator, StepChoice};
use crate::sampling::Integrator;
use crate::stationary::Solver;
use crate::system::{FieldKind, Interpretation, Model, NoiseKind, Sides, registry};

/// Getter and setter of a key. The second argument is the name that `<…>` stands for in the key's path.
#[derive(Debug, Clone, Copy)]
pub(in crate::sweep_file) struct Field {
    /// The value; `None` where there is none, or the chosen method has none.
    pub(in crate::sweep_file) get: fn(&Draft, &str) -> Option<Plain>,
    /// Takes a value of the key's kind.
    pub(in crate::sweep_file) set: fn(&mut Draft, &str, &Plain),
}

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

    fn from_plain(plain: &Plain) -> Option<Self> {
        plain.text().map(str::to_owned)
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

/// The text of a formula; one that is a number alone need not be quoted.
fn formula(plain: &Plain) -> Option<String> {
    match plain {
        Plain::Text(text) => Some(text.clone()),
        Plain::Integer(_) | Plain::Number(_) => Some(plain.to_toml()),
        Plain::List(_) => None,
    }
}

/// What the file says of a name in one of its tables of formulas.
pub(super) trait Formulas: Clone {
    fn written(&self) -> Plain;
    fn read(plain: &Plain) -> Option<Self>;
}

impl Formulas for String {
    fn written(&self) -> Plain {
        Plain::Text(self.clone())
    }

    fn read(plain: &Plain) -> Option<Self> {
        formula(plain)
    }
}

impl Formulas for Vec<String> {
    fn written(&self) -> Plain {
        Plain::List(self.iter().map(Formulas::written).collect())
    }

    fn read(plain: &Plain) -> Option<Self> {
        match plain.items() {
            Some(items) => items.iter().map(formula).collect(),
            None => Some(vec![formula(plain)?]),
        }
    }
}

impl Formulas for [String; 2] {
    fn written(&self) -> Plain {
        Plain::List(self.iter().map(Formulas::written).collect())
    }

    fn read(plain: &Plain) -> Option<Self> {
        Vec::read(plain)?.try_into().ok()
    }
}

/// The entry of a name.
pub(super) fn formulas_of<T: Formulas>(entries: &[(String, T)], name: &str) -> Option<Plain> {
    let entry = entries.iter().find(|(known, _)| known == name)?;
    Some(entry.1.written())
}

/// Takes the entry of a name.
pub(super) fn set_formulas<T: Formulas>(entries: &mut Vec<(String, T)>, name: &str, plain: &Plain) {
    if let Some(value) = T::read(plain) {
        entries.retain(|(known, _)| known != name);
        entries.push((name.to_owned(), value));
    }
}

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

    fn from_plain(plain: &Plain) -> Option<Self> {
        plain.items()?.iter().map(T::from_plain).collect()
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

/// A field of the draft that may be missing.
macro_rules! optional {
    ($($field:ident).+) => {
        Field {
            get: |draft, _| draft.$($field).+.as_ref().map(InFile::to_plain),
            set: |draft, _, plain| draft.$($field).+ = InFile::from_plain(plain),
        }
    };
}

/// A field of the draft that has a default.
macro_rules! always {
    ($($field:ident).+) => {
        Field {
            get: |draft, _| Some(InFile::to_plain(&draft.$($field).+)),
            set: |draft, _, plain| {
                if let Some(value) = InFile::from_plain(plain) {
                    draft.$($field).+ = value;
                }
            },
        }
    };
}

/// A field of an axis.
macro_rules! of_axis {
    ($field:ident) => {
        Field {
            get: |draft, name| draft.axis(name)?.$field.as_ref().map(InFile::to_plain),
            set: |draft, name, plain| draft.axis_mut(name).$field = InFile::from_plain(plain),
        }
    };
}

/// The word for an axis that closes on itself after 2π.
pub(super) const PERIODIC: &str = "periodic";

/// What happens at both ends of an axis, where that is said in words.
pub(super) fn ends_of(plain: &Plain) -> Option<[EndKind; 2]> {
    let kind = |plain: &Plain| EndKind::named(plain.text()?);
    match plain.items() {
        Some([lower, upper]) => Some([kind(lower)?, kind(upper)?]),
        Some(_) => None,
        None => kind(plain).map(|both| [both; 2]),
    }
}

/// Bounds of an axis: two formulas, or words for its ends, or the word for an angle.
pub(super) const BOUNDS: Field = Field {
    get: |draft, name| {
        let angle = draft.equations.angle(name);
        let word = angle.filter(|period| *period == std::f64::consts::TAU);
        let word = word.map(|_| Plain::Text(PERIODIC.to_owned()));
        let mut ends = draft.equations.ends.iter();
        let ends = ends.find(|(known, _)| known == name);
        let ends = ends.map(|(_, ends)| {
            Plain::List(ends.map(|end| Plain::Text(end.name().to_owned())).into())
        });
        formulas_of(&draft.equations.bounds, name).or(ends).or(word)
    },
    set: |draft, name, plain| match (ends_of(plain), plain.text()) {
        (Some(ends), _) => {
            draft.equations.ends.retain(|(known, _)| known != name);
            draft.equations.ends.push((name.to_owned(), ends));
        }
        (None, Some(_)) => draft.equations.set_angle(name, std::f64::consts::TAU),
        (None, None) => set_formulas(&mut draft.equations.bounds, name, plain),
    },
};

/// The period of an angle, where it is not 2π.
pub(super) const PERIOD: Field = Field {
    get: |draft, name| {
        let angle = draft.equations.angle(name);
        let own = angle.filter(|period| *period != std::f64::consts::TAU);
        own.map(Plain::Number)
    },
    set: |draft, name, plain| {
        if let Some(period) = plain.number() {
            draft.equations.set_angle(name, period);
        }
    },
};

/// A table of formulas by names.
macro_rules! formulas {
    ($field:ident) => {
        Field {
            get: |draft, name| super::field::formulas_of(&draft.equations.$field, name),
            set: |draft, name, plain| {
                super::field::set_formulas(&mut draft.equations.$field, name, plain)
            },
        }
    };
}

/// A field of the bins of a quantity.
macro_rules! of_bins {
    ($field:ident) => {
        Field {
            get: |draft, name| draft.bins(name)?.$field.as_ref().map(InFile::to_plain),
            set: |draft, name, plain| draft.bins_mut(name).$field = InFile::from_plain(plain),
        }
    };
}

/// What ends a passage: one region, or several.
pub(super) const UNTIL: Field = Field {
    get: |draft, name| {
        let passage = draft.passage(name)?;
        let several = passage.exits.as_ref().map(Formulas::written);
        several.or(passage.until.as_ref().map(Formulas::written))
    },
    set: |draft, name, plain| {
        let passage = draft.passage_mut(name);
        match plain.items() {
            Some(_) => passage.exits = Vec::read(plain),
            None => passage.until = plain.text().map(str::to_owned),
        }
    },
};

/// A field of a passage.
macro_rules! of_passage {
    ($field:ident) => {
        Field {
            get: |draft, name| draft.passage(name)?.$field.as_ref().map(InFile::to_plain),
            set: |draft, name, plain| draft.passage_mut(name).$field = InFile::from_plain(plain),
        }
    };
}

/// A field of the settings of some methods: set for all of them, got from the chosen one.
macro_rules! of_methods {
    ($field:ident: $($kind:ident $method:ident),+) => {
        Field {
            get: |draft, _| match draft.method.kind {
                $(MethodKind::$kind => Some(InFile::to_plain(&draft.method.$method.$field)),)+
                #[allow(unreachable_patterns)]
                _ => None,
            },
            set: |draft, _, plain| {
                $(if let Some(value) = InFile::from_plain(plain) {
                    draft.method.$method.$field = value;
                })+
            },
        }
    };
}

pub(super) use {always, formulas, of_axis, of_bins, of_methods, of_passage, optional};
