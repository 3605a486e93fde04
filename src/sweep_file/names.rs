//! Names as people type them: the nearest known one, Greek letters by their names.

use crate::formula::language::{ascii_spelling, is_invisible, lookalike};

/// The name nearest to `given`, if one is near enough to be a slip of the pen.
pub(super) fn nearest_name<'n>(
    given: &str,
    names: impl IntoIterator<Item = &'n str>,
) -> Option<&'n str> {
    let given = plain(given);
    let scored = names.into_iter().map(|name| {
        let likeness = strsim::normalized_damerau_levenshtein(&given, &plain(name));
        (likeness, name)
    });
    let best = scored.max_by(|one, other| one.0.total_cmp(&other.0))?;
    (best.0 >= 0.5).then_some(best.1)
}

/// A name in the characters that names of pbif are made of: `σ²` is `sigma2`, `map-step` `map_step`.
fn plain(name: &str) -> String {
    let mut text = String::new();
    for c in name.chars().flat_map(char::to_lowercase) {
        match c {
            '-' | ' ' => text.push('_'),
            '^' | '{' | '}' | '"' | '\'' => {}
            c if is_invisible(c) => {}
            c => match ascii_spelling(c) {
                Some(name) => text += name,
                None => text.push(lookalike(c).unwrap_or(c)),
            },
        }
    }
    text
}

/// Names in backquotes, separated by commas.
pub(crate) fn list<S: AsRef<str>>(names: &[S]) -> String {
    let quoted: Vec<String> = names
        .iter()
        .map(|name| format!("`{}`", name.as_ref()))
        .collect();
    quoted.join(", ")
}

/// A text as a message may quote it: the beginning alone of a long one, signs in place of what a terminal would obey.
pub(super) fn quotable(text: &str) -> String {
    const MOST: usize = 60;
    let sign = |c: char| match c as u32 {
        code @ 0..0x20 => char::from_u32(0x2400 + code).unwrap_or(c),
        _ if c.is_control() || is_invisible(c) => char::REPLACEMENT_CHARACTER,
        _ => c,
    };
    let mut shown: String = text.chars().take(MOST).map(sign).collect();
    if text.chars().nth(MOST).is_some() {
        shown.push('…');
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_near_names_are_offered() {
        let parameters = ["alpha", "kappa", "mu", "f_c", "sigma2"];
        for (given, expected) in [
            ("kapa", Some("kappa")),
            ("α", Some("alpha")),
            ("Α", Some("alpha")),
            ("κ", Some("kappa")),
            // Greek mu, micro sign, and one with an invisible neighbour.
            ("\u{3bc}", Some("mu")),
            ("\u{b5}", Some("mu")),
            ("mu\u{200b}", Some("mu")),
            ("σ²", Some("sigma2")),
            // Cyrillic letters.
            ("k\u{430}pp\u{430}", Some("kappa")),
            ("sigma^2", Some("sigma2")),
            ("f_{c}", Some("f_c")),
            ("zzzz", None),
        ] {
            assert_eq!(nearest_name(given, parameters), expected, "{given}");
        }
        assert_eq!(
            nearest_name("map-step", ["map_step", "samples"]),
            Some("map_step")
        );
    }

    #[test]
    fn long_texts_are_cut_between_characters() {
        assert_eq!(quotable("short"), "short");
        let cut = quotable(&"µ".repeat(100));
        assert_eq!(cut.chars().count(), 61);
        assert_eq!(quotable("\u{8}eta\u{1b}[31m\u{202e}"), "␈eta␛[31m\u{fffd}");
    }
}
