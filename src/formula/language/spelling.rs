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

fn subscript_digit(character: char) -> Option<char> {
    let digit = SUBSCRIPTS.iter().position(|&sub| sub == character)?;
    char::from_digit(digit as u32, 10)
}

/// The digit that a superscript character stands for.
pub(crate) fn is_superscript_digit(character: char) -> Option<i32> {
    let digit = SUPERSCRIPTS.iter().position(|&sup| sup == character)?;
    Some(digit as i32)
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
