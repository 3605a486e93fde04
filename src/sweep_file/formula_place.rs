//! Places inside a formula that stands in a sweep file: bytes of the formula are bytes of the file but for quotes and
//! escapes.

use std::ops::Range;

use super::diagnostic::{Place, Sources};

/// Longest piece of a formula that is marked, in bytes; a fault of the whole of a long one is shown at its beginning.
const MOST_MARKED: usize = 60;

/// The place of a part of a formula. `value` is the place of the string with its quotes; where the part cannot be told,
/// it is the whole.
pub(super) fn inside(sources: &Sources, value: &Place, part: &Range<usize>) -> Place {
    let text = sources.text(value.source).unwrap_or_default();
    let Some(raw) = text.get(value.span.clone()) else {
        return value.clone();
    };
    let span = match offsets(raw) {
        Some(starts) => {
            let at = |byte: usize| starts.get(byte).copied().unwrap_or(raw.len());
            // The end of the last character of the part, not the beginning of the next.
            value.span.start + at(part.start)..value.span.start + at(part.end)
        }
        None => value.span.clone(),
    };
    let mut end = span.end.min(span.start + MOST_MARKED);
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    Place {
        source: value.source,
        span: span.start..end.max(span.start),
    }
}

/// Where each byte of a string's value, and its end, stands in the string as TOML has it; `None` where that cannot be
/// told.
fn offsets(raw: &str) -> Option<Vec<usize>> {
    let (open, escapes) = match raw {
        _ if raw.starts_with("\"\"\"") => (3, true),
        _ if raw.starts_with("'''") => (3, false),
        _ if raw.starts_with('"') => (1, true),
        _ if raw.starts_with('\'') => (1, false),
        // A bare word that was set, or a number.
        _ => return Some((0..=raw.len()).collect()),
    };
    let close = raw.len().checked_sub(open)?;
    let mut at = open;
    // A line break directly behind three quotes is no part of the value.
    if open == 3 {
        let behind = raw.get(open..close)?;
        at += behind.len()
            - behind
                .strip_prefix("\r\n")
                .or(behind.strip_prefix('\n'))
                .unwrap_or(behind)
                .len();
    }
    let mut starts = Vec::new();
    while at < close {
        let c = raw.get(at..close)?.chars().next()?;
        let (read, meant) = match (c, escapes) {
            ('\\', true) => escape(raw.get(at..close)?)?,
            _ => (c.len_utf8(), c.len_utf8()),
        };
        starts.extend(std::iter::repeat_n(at, meant));
        at += read;
    }
    starts.push(close);
    Some(starts)
}

/// Bytes of an escape as written, and of the character that it stands for; `None` for one that swallows blanks.
fn escape(text: &str) -> Option<(usize, usize)> {
    let kind = text.chars().nth(1)?;
    let digits = match kind {
        'x' => 2,
        'u' => 4,
        'U' => 8,
        c if c.is_whitespace() => return None,
        _ => return Some((1 + kind.len_utf8(), 1)),
    };
    let code = u32::from_str_radix(text.get(2..2 + digits)?, 16).ok()?;
    Some((2 + digits, char::from_u32(code)?.len_utf8()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is marked of a value when a part of its formula is.
    fn marked(raw: &str, formula: &str, part: &str) -> String {
        let text = format!("y = {raw}\n");
        let mut sources = Sources::default();
        let source = sources.add("a.toml", &text);
        let value = Place {
            source,
            span: 4..4 + raw.len(),
        };
        let start = formula.find(part).unwrap();
        let place = inside(&sources, &value, &(start..start + part.len()));
        text[place.span].to_owned()
    }

    #[test]
    fn parts_are_found_behind_quotes_and_escapes() {
        for (raw, formula) in [
            ("\"-α x + kapa y\"", "-α x + kapa y"),
            ("'-α x + kapa y'", "-α x + kapa y"),
            ("\"\"\"\n-α x + kapa y\"\"\"", "-α x + kapa y"),
            ("\"-\\u03b1 x +\\tkapa y\"", "-α x +\tkapa y"),
        ] {
            assert_eq!(marked(raw, formula, "kapa"), "kapa", "{raw}");
        }
        // Where blanks are swallowed, the whole is marked.
        let folded = "\"\"\"x \\\n  + kapa\"\"\"";
        assert_eq!(marked(folded, "x + kapa", "kapa"), folded);
        let long = format!("\"{}\"", "é".repeat(100));
        assert!(marked(&long, &"é".repeat(100), &"é".repeat(100)).len() <= MOST_MARKED);
    }
}
