//! Spelling of names: Greek letters and subscript digits have ASCII twins, and both are the same symbol.
//!
//! `α` is `alpha`, the micro sign `µ` is the letter `μ` is `mu`, `c₀` is `c0`, and `c_0` is `c0` too.

/// Greek letters, their variants in Unicode, and their names. The first character of a name is how it is shown.
const GREEK: &[(&str, &str)] = &[
    ("α", "alpha"),
    ("β", "beta"),
    ("γ", "gamma"),
    ("δ", "delta"),
    ("εϵ", "epsilon"),
    ("ζ", "zeta"),
    ("η", "eta"),
    ("θϑ", "theta"),
    ("ι", "iota"),
    ("κϰ", "kappa"),
    ("λ", "lambda"),
    ("μ\u{b5}", "mu"),
    ("ν", "nu"),
    ("ξ", "xi"),
    ("ο", "omicron"),
    ("πϖ", "pi"),
    ("ρϱ", "rho"),
    ("σς", "sigma"),
    ("τ", "tau"),
    ("υ", "upsilon"),
    ("φϕ", "phi"),
    ("χ", "chi"),
    ("ψ", "psi"),
    ("ω", "omega"),
    ("Α", "Alpha"),
    ("Β", "Beta"),
    ("Γ", "Gamma"),
    ("Δ\u{2206}", "Delta"),
    ("Ε", "Epsilon"),
    ("Ζ", "Zeta"),
    ("Η", "Eta"),
    ("Θϴ", "Theta"),
    ("Ι", "Iota"),
    ("Κ", "Kappa"),
    ("Λ", "Lambda"),
    ("Μ", "Mu"),
    ("Ν", "Nu"),
    ("Ξ", "Xi"),
    ("Ο", "Omicron"),
    ("Π", "Pi"),
    ("Ρ", "Rho"),
    ("Σ", "Sigma"),
    ("Τ", "Tau"),
    ("Υ", "Upsilon"),
    ("Φ", "Phi"),
    ("Χ", "Chi"),
    ("Ψ", "Psi"),
    ("Ω\u{2126}", "Omega"),
];

const SUBSCRIPTS: [char; 10] = ['₀', '₁', '₂', '₃', '₄', '₅', '₆', '₇', '₈', '₉'];
const SUPERSCRIPTS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];

fn greek_name(letter: char) -> Option<&'static str> {
    let entry = GREEK.iter().find(|(letters, _)| letters.contains(letter))?;
    Some(entry.1)
}

/// The digit that a subscript character stands for.
pub(crate) fn subscript_digit(character: char) -> Option<char> {
    let digit = SUBSCRIPTS.iter().position(|&sub| sub == character)?;
    char::from_digit(digit as u32, 10)
}

/// The digit that a superscript character stands for.
pub(crate) fn is_superscript_digit(character: char) -> Option<i32> {
    let digit = SUPERSCRIPTS.iter().position(|&sup| sup == character)?;
    Some(digit as i32)
}

/// How a letter or digit that is not ASCII is spelt, where pbif's names spell it: Greek letters in either case, the
/// micro sign, raised and lowered digits.
#[cfg(feature = "store")]
pub(crate) fn ascii_spelling(character: char) -> Option<&'static str> {
    const DIGITS: [&str; 10] = ["0", "1", "2", "3", "4", "5", "6", "7", "8", "9"];
    let digit = |of: &[char]| of.iter().position(|&known| known == character);
    let digit = digit(&SUBSCRIPTS).or_else(|| digit(&SUPERSCRIPTS));
    digit
        .and_then(|digit| DIGITS.get(digit).copied())
        .or_else(|| {
            let lower = character.to_lowercase().next()?;
            greek_name(lower)
        })
}

/// The letter of the keyboard that a letter of another alphabet looks like.
pub(crate) fn lookalike(character: char) -> Option<char> {
    const CYRILLIC: &str = "аеорсухіѕјԁһӏАВЕКМНОРСТХІЅЈ";
    const LATIN: &str = "aeopcyxisjdhlABEKMHOPCTXISJ";
    let place = CYRILLIC.chars().position(|known| known == character)?;
    LATIN.chars().nth(place)
}

/// The first letter of another alphabet that looks like one of the keyboard, in words, and what to write.
pub(crate) fn foreign_letter(text: &str) -> Option<(String, String)> {
    let (found, letter) = text.chars().find_map(|c| Some((c, lookalike(c)?)))?;
    let code = found as u32;
    Some((
        format!(
            "`{found}` (U+{code:04X}) looks like `{letter}`, and is a letter of another alphabet"
        ),
        format!("write the `{letter}` of the keyboard"),
    ))
}

/// Whether a character takes no room, or turns the direction of writing.
pub(crate) fn is_invisible(character: char) -> bool {
    matches!(character, '\u{ad}' | '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}')
}

/// Whether a name may begin with this character.
pub(crate) fn begins_name(character: char) -> bool {
    character.is_ascii_alphabetic() || greek_name(character).is_some()
}

/// Whether a name may go on with this character.
pub(crate) fn continues_name(character: char) -> bool {
    begins_name(character)
        || character.is_ascii_digit()
        || character == '_'
        || subscript_digit(character).is_some()
}

/// Whether a text is a name: a letter, then letters, digits, subscript digits and `_`.
pub(crate) fn check_name(text: &str) -> bool {
    let mut characters = text.chars();
    characters.next().is_some_and(begins_name) && characters.all(continues_name)
}

/// The ASCII spelling under which a name is known: `canonical_name("ω₀") == "omega0"`.
///
/// Greek letters become their names, subscript digits become digits, and one `_` between a letter and final
/// digits is dropped. Two names are the same symbol exactly when their canonical names agree.
pub(crate) fn canonical_name(text: &str) -> String {
    let mut name = String::with_capacity(text.len());
    for character in text.chars() {
        if let Some(letter) = greek_name(character) {
            name.push_str(letter);
        } else {
            name.push(subscript_digit(character).unwrap_or(character));
        }
    }
    let stem = name.trim_end_matches(|c: char| c.is_ascii_digit()).len();
    if stem < name.len()
        && let Some(before) = name[..stem].strip_suffix('_')
        && before.ends_with(|c: char| c.is_ascii_alphabetic())
    {
        name.remove(stem - 1);
    }
    name
}

/// A name as it is printed: `typeset_name("omega0") == "ω₀"`, `typeset_name("mu_k") == "μ_k"`.
pub(crate) fn typeset_name(name: &str) -> String {
    let parts = canonical_name(name);
    let parts = parts.split('_').map(typeset_part);
    parts.collect::<Vec<_>>().join("_")
}

fn typeset_part(part: &str) -> String {
    let (stem, digits) = part.split_at(part.trim_end_matches(|c: char| c.is_ascii_digit()).len());
    let mut shown = String::new();
    match GREEK.iter().find(|(_, name)| *name == stem) {
        Some((letters, _)) => shown.extend(letters.chars().next()),
        None => shown.push_str(stem),
    }
    let lower = |digit: char| match digit.to_digit(10) {
        Some(value) if !stem.is_empty() => SUBSCRIPTS[value as usize],
        _ => digit,
    };
    shown.extend(digits.chars().map(lower));
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spellings_of_one_symbol_agree() {
        for (spelling, name) in [
            ("α", "alpha"),
            ("μ", "mu"),
            ("\u{b5}", "mu"),
            ("ϕ", "phi"),
            ("Ω", "Omega"),
            ("\u{2126}", "Omega"),
            ("c₀", "c0"),
            ("c_0", "c0"),
            ("ω₁₂", "omega12"),
            ("f_c", "f_c"),
            ("a_1_2", "a_1_2"),
            ("k_max2", "k_max2"),
            ("μ_k", "mu_k"),
        ] {
            assert_eq!(canonical_name(spelling), name);
        }
    }

    #[cfg(feature = "store")]
    #[test]
    fn raised_and_lowered_digits_are_digits_and_letters_that_look_alike_are_told() {
        let spelt: String = "⁰¹²³⁴⁹₀₁₉".chars().filter_map(ascii_spelling).collect();
        assert_eq!(spelt, "012349019");
        assert_eq!(
            (ascii_spelling('a'), ascii_spelling('Α')),
            (None, Some("alpha"))
        );
        let (words, remedy) = foreign_letter("\u{430}lph\u{430}").unwrap();
        assert!(
            words.contains("U+0430") && remedy.contains("`a`"),
            "{words} {remedy}"
        );
        assert_eq!(foreign_letter("alphaα"), None);
    }

    #[test]
    fn names_are_shown_with_greek_letters_and_subscripts() {
        for (name, shown) in [
            ("alpha", "α"),
            ("omega0", "ω₀"),
            ("c_0", "c₀"),
            ("mu_k", "μ_k"),
            ("D1", "D₁"),
            ("alphabet", "alphabet"),
            ("a_1_2", "a_1_2"),
        ] {
            assert_eq!(typeset_name(name), shown);
            assert_eq!(canonical_name(&typeset_name(name)), canonical_name(name));
        }
    }

    #[test]
    fn names_begin_with_a_letter() {
        for name in ["x", "f_c", "ω₀", "c0"] {
            assert!(check_name(name), "{name}");
        }
        for name in ["", "0c", "_x", "x'", "x y", "₀", "é", "x\0"] {
            assert!(!check_name(name), "{name}");
        }
    }
}
