//! What is wrong with a text that is not TOML, in the words of somebody who writes a sweep file: the parser knows what
//! it expected, here it is said what was typed.

use std::ops::Range;

use toml::de::Error;

use super::diagnostic::{Diagnostic, Place};
use super::names::quotable;
use super::report::MOST_SHOWN;
use crate::formula::language::{ascii_spelling, foreign_letter, is_invisible};

/// A slip: what stands there, and what to write.
type Slip = (String, String);

/// What is said of syntax errors: of the first one in a line (the others mostly follow from it), of at most
/// [`MOST_SHOWN`] lines; and how many more lines have errors. `offset` moves the places: the text may stand behind a
/// key.
pub(super) fn findings(
    text: &str,
    errors: &[Error],
    source: usize,
    offset: usize,
) -> (Vec<Diagnostic>, usize) {
    let mut found = Vec::new();
    let mut further = 0;
    // The end of the last line that has been looked at.
    let mut seen = None;
    for error in errors {
        let span = error.span().unwrap_or(0..0);
        if seen.is_some_and(|end| span.start <= end) {
            continue;
        }
        let spot = Spot::new(text, span);
        seen = Some(spot.span.start + spot.rest.len());
        match found.len() {
            MOST_SHOWN => further += 1,
            _ => found.push(spot.diagnostic(error.message(), source, offset)),
        }
    }
    (found, further)
}

/// Where the parser stopped.
struct Spot<'t> {
    /// The bytes that it blames.
    span: Range<usize>,
    /// The line up to the span.
    before: &'t str,
    /// What it blames, to the end of the line at most.
    blamed: &'t str,
    /// The line from the span on.
    rest: &'t str,
}

impl<'t> Spot<'t> {
    fn new(text: &'t str, span: Range<usize>) -> Self {
        let start = floor(text, span.start);
        let end = floor(text, span.end).max(start);
        let line_start = text[..start].rfind('\n').map_or(0, |newline| newline + 1);
        let line_end = text[start..]
            .find('\n')
            .map_or(text.len(), |newline| start + newline);
        Self {
            span: start..end,
            before: &text[line_start..start],
            blamed: &text[start..end.min(line_end)],
            rest: &text[start..line_end],
        }
    }

    fn diagnostic(&self, message: &str, source: usize, offset: usize) -> Diagnostic {
        let place = Place {
            source,
            span: self.span.start + offset..self.span.end + offset,
        };
        let slips = [
            Self::character,
            Self::comma_in_number,
            Self::punctuation,
            Self::backslash,
            Self::structure,
            Self::nothing,
            Self::computation,
            Self::word,
        ];
        match slips.iter().find_map(|slip| slip(self, message)) {
            Some((words, remedy)) => Diagnostic::new(format!("not valid TOML: {words}"))
                .at(&place, "")
                .remedy(remedy),
            None => Diagnostic::new(format!("not valid TOML: {message}")).at(&place, message),
        }
    }

    /// A character that looks like one of the keyboard, or stands for a name.
    fn character(&self, _: &str) -> Option<Slip> {
        // The blame may begin in front of it, or be empty.
        let looked_at = match self.blamed {
            "" => self.rest.chars().take(1).collect::<String>(),
            blamed => blamed.chars().take(80).collect(),
        };
        let c = looked_at.chars().find(|c| !c.is_ascii())?;
        let code = format!("U+{:04X}", c as u32);
        Some(match c {
            '“' | '”' | '„' | '‟' | '‘' | '’' | '‚' | '‛' | '«' | '»' | '´' | '＂' => {
                (
                    format!("`{c}` is a quotation mark of print"),
                    "write the straight one of the keyboard: `\"`".to_owned(),
                )
            }
            '−' | '–' | '—' | '‐' | '‑' | '‒' | '―' | '－' | '﹣' => (
                format!("`{c}` ({code}) is not the minus sign of the keyboard"),
                "write `-`".to_owned(),
            ),
            c if c.is_whitespace() || is_invisible(c) => (
                format!("an invisible character ({code}) stands here"),
                "delete it, or write a plain space".to_owned(),
            ),
            c if ascii_spelling(c).is_some() && self.is_key() => {
                let word = self.rest.split(['=', '.', ' ', '\t', ']']).next();
                let word = word.unwrap_or_default();
                let spelt: String = word
                    .chars()
                    .map(|c| ascii_spelling(c).map_or(c.to_string(), str::to_owned))
                    .collect();
                let before = self.before.rsplit(['{', '[', ',', '.', ' ', '\t']).next();
                let before = before.unwrap_or_default();
                (
                    format!("`{c}` cannot stand in a key"),
                    format!(
                        "names are in ASCII: did you mean `{before}{spelt}`? Formulas read `{c}` so, too"
                    ),
                )
            }
            c => foreign_letter(&c.to_string()).unwrap_or((
                format!("`{c}` ({code}) can stand in a string only"),
                "write names and numbers with the letters and digits of ASCII".to_owned(),
            )),
        })
    }

    /// Whether what is blamed stands where a key should.
    fn is_key(&self) -> bool {
        !self.before.contains('=') || self.before.trim_end().ends_with(['{', ','])
    }

    /// `0,5` or `1,000`: the parser stops at the comma, or behind the digits that follow.
    fn comma_in_number(&self, _: &str) -> Option<Slip> {
        let is_digit = |c: char| c.is_ascii_digit();
        let here = self
            .rest
            .strip_prefix(',')
            .map(|after| (self.before, after));
        let shortly_before = self.before.rsplit_once(',').map(|(before, after)| {
            let after = if after.is_empty() { self.rest } else { after };
            (before, after)
        });
        let mut parts = [here, shortly_before].into_iter().flatten();
        let is_number = |(before, after): (&str, &str)| {
            let digits = after.trim_start_matches(is_digit);
            before.ends_with(is_digit)
                && after.starts_with(is_digit)
                && !digits.starts_with(|c: char| c.is_alphabetic() || c == '_')
        };
        parts.any(is_number).then(|| {
            (
                "a comma stands inside a number".to_owned(),
                "numbers have a point before their decimals, `0.5`, and no commas between thousands, `1000`".to_owned(),
            )
        })
    }

    /// `;` behind a value, `:` behind a key.
    fn punctuation(&self, _: &str) -> Option<Slip> {
        if self.blamed.contains(';') || self.rest.starts_with(';') {
            return Some((
                "`;` stands behind a value".to_owned(),
                "delete it: a value ends with its line".to_owned(),
            ));
        }
        if self.is_key() && (self.rest.starts_with(':') || self.before.trim_end().ends_with(':')) {
            return Some((
                "`:` stands behind a key".to_owned(),
                "write `=` between key and value".to_owned(),
            ));
        }
        None
    }

    /// LaTeX or a path of Windows between double quotation marks.
    fn backslash(&self, message: &str) -> Option<Slip> {
        message.starts_with("missing escaped value").then(|| {
            (
                "a backslash between `\"` begins a code".to_owned(),
                "write `\\\\` for a backslash, or put the text between `'`, where it is itself: `'$\\alpha$'`"
                    .to_owned(),
            )
        })
    }

    /// What stands where a value should, around the place where the parser stopped.
    fn value(&self) -> Option<String> {
        let behind_key = self.before.find('=')? + 1;
        let start = self.before.rfind(['=', '[', ','])?.max(behind_key - 1) + 1;
        let end = self.rest.find(['#', ',', '}', ']']);
        let end = end.unwrap_or(self.rest.len());
        let value = format!("{}{}", &self.before[start..], &self.rest[..end]);
        let value = value.trim();
        (!value.contains('=')).then(|| value.to_owned())
    }

    /// A key without a value.
    fn nothing(&self, _: &str) -> Option<Slip> {
        let before = self.before.trim_end().strip_suffix('=')?;
        let key = before.rsplit(['{', ',', '=']).next().unwrap_or_default();
        self.value()?.is_empty().then(|| {
            (
                format!("`{}` has no value", quotable(key.trim())),
                "write it behind the `=`".to_owned(),
            )
        })
    }

    /// `1/3` or `2*pi`.
    fn computation(&self, _: &str) -> Option<Slip> {
        let value = self.value()?;
        let is_computation = value.starts_with(|c: char| c.is_ascii_digit() || "+-.(".contains(c))
            && value.contains(['/', '*', '^', '(']);
        is_computation.then(|| {
            (
                format!("`{}` is a computation", quotable(&value)),
                "write the number: a sweep file does not compute".to_owned(),
            )
        })
    }

    /// A string without its quotation marks.
    fn word(&self, _: &str) -> Option<Slip> {
        let value = self.value()?;
        let is_word = value.starts_with(char::is_alphabetic) && !value.contains(['"', '\'']);
        is_word.then(|| {
            let value = quotable(&value);
            (
                format!("`{value}` is a string and must be quoted"),
                format!("write `\"{value}\"`"),
            )
        })
    }

    /// Sound lines that do not fit together.
    fn structure(&self, message: &str) -> Option<Slip> {
        let remedy = match message {
            "duplicate key" => "a key or table stands once: join the two, or delete one",
            message if message.starts_with("cannot extend value of type inline table") => {
                "write the key between the braces of its table"
            }
            message if message.contains("recurs") => {
                "tables and lists stand at most four deep in a sweep file"
            }
            _ => return None,
        };
        let words = match message {
            "recursion limit" => "a key has too many parts (recursion limit)",
            message => message,
        };
        Some((words.to_owned(), remedy.to_owned()))
    }
}

/// The last boundary of characters at or before a byte.
fn floor(text: &str, byte: usize) -> usize {
    let mut byte = byte.min(text.len());
    while !text.is_char_boundary(byte) {
        byte -= 1;
    }
    byte
}

#[cfg(test)]
mod tests;
