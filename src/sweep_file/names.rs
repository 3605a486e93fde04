//! Names as people type them: the nearest known one, Greek letters by their names.

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
            c => match ascii_name(c) {
                Some(name) => text += name,
                None => text.push(c),
            },
        }
    }
    text
}

/// Names of the lower-case Greek letters.
const GREEK: [(char, &str); 25] = [
    ('α', "alpha"),
    ('β', "beta"),
    ('γ', "gamma"),
    ('δ', "delta"),
    ('ε', "epsilon"),
    ('ζ', "zeta"),
    ('η', "eta"),
    ('θ', "theta"),
    ('ι', "iota"),
    ('κ', "kappa"),
    ('λ', "lambda"),
    ('μ', "mu"),
    ('ν', "nu"),
    ('ξ', "xi"),
    ('ο', "omicron"),
    ('π', "pi"),
    ('ρ', "rho"),
    ('σ', "sigma"),
    ('ς', "sigma"),
    ('τ', "tau"),
    ('υ', "upsilon"),
    ('φ', "phi"),
    ('χ', "chi"),
    ('ψ', "psi"),
    ('ω', "omega"),
];

/// How a letter or digit that is not ASCII is spelt, where pbif's names spell it: Greek letters, the micro sign, raised
/// and lowered digits.
pub(super) fn ascii_name(c: char) -> Option<&'static str> {
    const DIGITS: [&str; 10] = ["0", "1", "2", "3", "4", "5", "6", "7", "8", "9"];
    let digit = match c {
        '⁰' => 0,
        '¹' => 1,
        '²' => 2,
        '³' => 3,
        '⁴'..='⁹' => c as usize - '⁰' as usize,
        '₀'..='₉' => c as usize - '₀' as usize,
        // Micro sign, and forms of epsilon, theta, kappa, rho and phi.
        'µ' => return Some("mu"),
        'ϵ' => return Some("epsilon"),
        'ϑ' => return Some("theta"),
        'ϰ' => return Some("kappa"),
        'ϱ' => return Some("rho"),
        'ϕ' => return Some("phi"),
        _ => {
            let lower = c.to_lowercase().next()?;
            let letter = GREEK.iter().find(|(letter, _)| *letter == lower);
            return letter.map(|(_, name)| *name);
        }
    };
    DIGITS.get(digit).copied()
}

/// The letter of the keyboard that a letter of another alphabet looks like.
pub(super) fn lookalike(c: char) -> Option<char> {
    const CYRILLIC: &str = "аеорсухіѕјԁһӏАВЕКМНОРСТХІЅЈ";
    const LATIN: &str = "aeopcyxisjdhlABEKMHOPCTXISJ";
    let place = CYRILLIC.chars().position(|known| known == c)?;
    LATIN.chars().nth(place)
}

/// Whether a character takes no room or turns the direction of writing.
pub(super) fn is_invisible(c: char) -> bool {
    matches!(c, '\u{ad}' | '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}')
}

/// Names in backquotes, separated by commas.
pub fn list<S: AsRef<str>>(names: &[S]) -> String {
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
    fn raised_and_lowered_digits_are_digits() {
        let spelt: String = "⁰¹²³⁴⁹₀₁₉".chars().filter_map(ascii_name).collect();
        assert_eq!(spelt, "012349019");
        assert_eq!(ascii_name('a'), None);
    }

    #[test]
    fn long_texts_are_cut_between_characters() {
        assert_eq!(quotable("short"), "short");
        let cut = quotable(&"µ".repeat(100));
        assert_eq!(cut.chars().count(), 61);
        assert_eq!(quotable("\u{8}eta\u{1b}[31m\u{202e}"), "␈eta␛[31m\u{fffd}");
    }
}
