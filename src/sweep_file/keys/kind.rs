//! Kinds of values: what a key takes, in words and as a test.

use super::super::names::list;
use super::super::value::Plain;
use super::field::{PERIODIC, end_of, ends_of};
use super::in_file::AUTO;
use crate::figure::FigureWidth;
use crate::system::registry;

/// Condition on a number, in words and as a test. Numbers are always finite.
#[derive(Debug, Clone, Copy)]
pub(in crate::sweep_file) struct Condition {
    /// Words that complete "a finite number".
    words: &'static str,
    /// The test.
    holds: fn(f64) -> bool,
}

pub(super) const ANY: Condition = Condition {
    words: "",
    holds: |_| true,
};
pub(super) const POSITIVE: Condition = Condition {
    words: " greater than zero",
    holds: |value| value > 0.0,
};
pub(super) const NOT_NEGATIVE: Condition = Condition {
    words: " that is not negative",
    holds: |value| value >= 0.0,
};
pub(super) const OPEN_UNIT: Condition = Condition {
    words: " between 0 and 1, both excluded",
    holds: |value| value > 0.0 && value < 1.0,
};
pub(super) const SHARE: Condition = Condition {
    words: " from 0 to below 1",
    holds: |value| (0.0..1.0).contains(&value),
};
pub(super) const TEXT: Condition = Condition {
    words: " from 4 to 72",
    holds: |value| (4.0..=72.0).contains(&value),
};
pub(super) const LINE: Condition = Condition {
    words: " from 0.1 to 10",
    holds: |value| (0.1..=10.0).contains(&value),
};
pub(super) const DPI: Condition = Condition {
    words: " from 36 to 1200",
    holds: |value| (36.0..=1200.0).contains(&value),
};
pub(super) const STEP: Condition = Condition {
    words: " from 0.0001 to 0.25",
    holds: |value| (1e-4..=0.25).contains(&value),
};
pub(super) const UP_TO_ONE: Condition = Condition {
    words: " above 0, at most 1",
    holds: |value| value > 0.0 && value <= 1.0,
};

/// Whether XML, and with it a figure, can hold a character.
fn is_printable(c: char) -> bool {
    matches!(c, '\t' | '\n' | '\r') || !(c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}'))
}

/// The names of built-in models.
pub(in crate::sweep_file) fn models() -> Vec<&'static str> {
    let models = registry::models().iter();
    models.map(|model| model.name.as_str()).collect()
}

/// The names of widths of figures.
fn widths() -> Vec<&'static str> {
    FigureWidth::NAMED
        .into_iter()
        .filter_map(FigureWidth::name)
        .collect()
}

/// Kind of value a key takes.
#[derive(Debug, Clone, Copy)]
pub(in crate::sweep_file) enum Kind {
    /// A string.
    Text,
    /// A string that can be printed, and stand in a figure.
    Printable,
    /// A finite number.
    Number(Condition),
    /// An integer from the first to the second value.
    Integer(i128, i128),
    /// A number greater than zero, or "auto".
    Step,
    /// Millimetres, or the name of a width of figures.
    Width,
    /// An integer from the first to the second value, or "auto".
    Count(i128, i128),
    /// One of some strings.
    Choice(fn() -> Vec<&'static str>),
    /// The name of a model, built in or lent to this process.
    Model,
    /// Two strings.
    Pair,
    /// A formula: a string, or a number.
    Formula,
    /// A formula, or a list of formulas.
    Formulas,
    /// Two formulas, or what happens at both ends, or the word for an angle.
    Bounds,
    /// A string, or a list of some.
    Regions,
    /// A list of values of one kind.
    List(&'static Self),
}

impl Kind {
    /// What is allowed, in words.
    pub(in crate::sweep_file) fn words(self) -> String {
        match self {
            Self::Text => "a string".to_owned(),
            Self::Printable => "a string without control characters".to_owned(),
            Self::Number(condition) => format!("a finite number{}", condition.words),
            Self::Integer(least, most) if most == i128::from(i64::MAX) => {
                format!("an integer, {least} or more, at most {most}")
            }
            Self::Integer(least, most) => format!("an integer from {least} to {most}"),
            Self::Step => "a finite number greater than zero, or `\"auto\"`".to_owned(),
            Self::Count(least, most) => {
                format!("an integer from {least} to {most}, or `\"auto\"`")
            }
            Self::Choice(names) => format!("a string: {}", list(&names())),
            Self::Model => format!("a string: {}", list(&models())),
            Self::Width => format!(
                "a number of millimetres greater than zero, or a string: {}",
                list(&widths())
            ),
            Self::Pair => "a pair of strings, such as `[\"x\", \"y\"]`".to_owned(),
            Self::Formula => "a formula, such as `\"-k x + 2 y^3\"`".to_owned(),
            Self::Formulas => {
                "a formula, such as `\"sqrt(2 D)\"`, or a list of formulas".to_owned()
            }
            Self::Bounds => "two formulas, such as `[\"-a\", \"a\"]`, or `\"periodic\"`, or `\"reflecting\"`, or `[\"reflecting\", \"open\"]`".to_owned(),
            Self::Regions => {
                "a string, such as `\"abs(x) > 2\"`, or a list of strings".to_owned()
            }
            Self::List(Self::Number(condition)) => {
                let words = condition.words;
                format!("a list of finite numbers{words}, such as `[0.25, 0.5]`")
            }
            Self::List(Self::Text) => "a list of strings, such as `[\"x\", \"y\"]`".to_owned(),
            Self::List(Self::Pair) => {
                "a list of pairs of strings, such as `[[\"x\", \"y\"]]`".to_owned()
            }
            Self::List(Self::Choice(names)) => format!("a list of strings: {}", list(&names())),
            Self::List(_) => "a list".to_owned(),
        }
    }

    /// Whether a value is of this kind.
    pub(in crate::sweep_file) fn holds(self, plain: &Plain) -> bool {
        match self {
            Self::Text => plain.text().is_some(),
            Self::Printable => plain
                .text()
                .is_some_and(|text| text.chars().all(is_printable)),
            Self::Number(condition) => plain.number().is_some_and(condition.holds),
            Self::Integer(least, most) => {
                matches!(plain, Plain::Integer(value) if (least..=most).contains(value))
            }
            Self::Step => match plain.number() {
                Some(value) => value > 0.0,
                None => plain.text() == Some(AUTO),
            },
            Self::Width => match plain.number() {
                Some(value) => value > 0.0 && value.is_finite(),
                None => plain.text().is_some_and(|text| widths().contains(&text)),
            },
            Self::Count(least, most) => match plain {
                Plain::Integer(value) => (least..=most).contains(value),
                _ => plain.text() == Some(AUTO),
            },
            Self::Choice(names) => plain.text().is_some_and(|text| names().contains(&text)),
            Self::Model => plain
                .text()
                .is_some_and(|text| registry::find(text).is_ok()),
            Self::Pair => plain.items().is_some_and(|items| {
                items.len() == 2 && items.iter().all(|item| item.text().is_some())
            }),
            Self::Formula => matches!(plain, Plain::Text(_)) || plain.number().is_some(),
            Self::Formulas => match plain.items() {
                Some(items) => items.iter().all(|item| Self::Formula.holds(item)),
                None => Self::Formula.holds(plain),
            },
            Self::Bounds => match plain.items() {
                // A word for one end stands beside a word for the other, not beside a formula.
                Some(items) => {
                    let is_end = |item: &&Plain| end_of(item).is_some();
                    items.len() == 2
                        && items.iter().all(|item| Self::Formula.holds(item))
                        && items.iter().filter(is_end).count() != 1
                }
                None => plain.text() == Some(PERIODIC) || ends_of(plain).is_some(),
            },
            Self::Regions => match plain.items() {
                Some(items) => !items.is_empty() && items.iter().all(|item| item.text().is_some()),
                None => plain.text().is_some(),
            },
            Self::List(kind) => plain
                .items()
                .is_some_and(|items| items.iter().all(|item| kind.holds(item))),
        }
    }
}
