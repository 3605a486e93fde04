//! How a key's value gets into a [`Draft`] and out of it.

use super::super::draft::{Draft, EndKind};
use super::super::names::nearest_name;
use super::super::value::Plain;
use super::in_file::InFile;

/// Getter and setter of a key. The second argument is the name that `<…>` stands for in the key's path.
#[derive(Debug, Clone, Copy)]
pub(in crate::sweep_file) struct Field {
    /// The value; `None` where there is none, or the chosen method has none.
    pub(in crate::sweep_file) get: fn(&Draft, &str) -> Option<Plain>,
    /// Takes a value of the key's kind.
    pub(in crate::sweep_file) set: fn(&mut Draft, &str, &Plain),
}

/// The entry of a name.
pub(super) fn entry_of<T: InFile>(entries: &[(String, T)], name: &str) -> Option<Plain> {
    let entry = entries.iter().find(|(known, _)| known == name)?;
    Some(entry.1.to_plain())
}

/// Takes the entry of a name.
pub(super) fn set_entry<T: InFile>(entries: &mut Vec<(String, T)>, name: &str, plain: &Plain) {
    if let Some(value) = T::from_plain(plain) {
        entries.retain(|(known, _)| known != name);
        entries.push((name.to_owned(), value));
    }
}

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

/// What happens at an end of an axis, where that is said in a word.
pub(in crate::sweep_file) fn end_of(plain: &Plain) -> Option<EndKind> {
    let mut all = EndKind::ALL.into_iter();
    all.find(|kind| plain.text() == Some(kind.name()))
}

/// What happens at both ends of an axis, where that is said in words.
pub(super) fn ends_of(plain: &Plain) -> Option<[EndKind; 2]> {
    match plain.items() {
        Some([lower, upper]) => Some([end_of(lower)?, end_of(upper)?]),
        Some(_) => None,
        None => end_of(plain).map(|both| [both; 2]),
    }
}

/// The word for an end of an axis, or for the whole axis, that was perhaps meant.
pub(in crate::sweep_file) fn nearest_bound(text: &str) -> Option<&'static str> {
    let words = EndKind::ALL.into_iter().map(EndKind::name);
    nearest_name(text, words.chain([PERIODIC]))
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
        entry_of(&draft.equations.bounds, name).or(ends).or(word)
    },
    set: |draft, name, plain| match (ends_of(plain), plain.text()) {
        (Some(ends), _) => {
            draft.equations.ends.retain(|(known, _)| known != name);
            draft.equations.ends.push((name.to_owned(), ends));
        }
        (None, Some(_)) => draft.equations.set_angle(name, std::f64::consts::TAU),
        (None, None) => set_entry(&mut draft.equations.bounds, name, plain),
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

/// A table of formulas or numbers by names.
macro_rules! entries {
    ($($field:ident).+) => {
        Field {
            get: |draft, name| super::field::entry_of(&draft.$($field).+, name),
            set: |draft, name, plain| super::field::set_entry(&mut draft.$($field).+, name, plain),
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
        let several = passage.exits.as_ref().map(InFile::to_plain);
        several.or(passage.until.as_ref().map(InFile::to_plain))
    },
    set: |draft, name, plain| {
        let passage = draft.passage_mut(name);
        match plain.items() {
            Some(_) => passage.exits = Vec::from_plain(plain),
            None => passage.until = plain.text().map(str::to_owned),
        }
    },
};

/// A field of a passage.
macro_rules! of_passage {
    ($($field:ident).+) => {
        Field {
            get: |draft, name| draft.passage(name)?.$($field).+.as_ref().map(InFile::to_plain),
            set: |draft, name, plain| draft.passage_mut(name).$($field).+ = InFile::from_plain(plain),
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

pub(super) use {always, entries, of_axis, of_bins, of_methods, of_passage, optional};
