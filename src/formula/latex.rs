//! Text as LaTeX, so that pdflatex compiles whatever a table or a caption holds.

use crate::formula::language::subscript_digit;

/// Letters and signs that LaTeX writes in mathematics.
const MATHEMATICS: &[(char, &str)] = &[
    ('α', "\\alpha"),
    ('β', "\\beta"),
    ('γ', "\\gamma"),
    ('δ', "\\delta"),
    ('ε', "\\varepsilon"),
    ('ζ', "\\zeta"),
    ('η', "\\eta"),
    ('θ', "\\theta"),
    ('κ', "\\kappa"),
    ('λ', "\\lambda"),
    ('μ', "\\mu"),
    ('ν', "\\nu"),
    ('ξ', "\\xi"),
    ('π', "\\pi"),
    ('ρ', "\\rho"),
    ('σ', "\\sigma"),
    ('τ', "\\tau"),
    ('φ', "\\varphi"),
    ('χ', "\\chi"),
    ('ψ', "\\psi"),
    ('ω', "\\omega"),
    ('Γ', "\\Gamma"),
    ('Δ', "\\Delta"),
    ('Θ', "\\Theta"),
    ('Λ', "\\Lambda"),
    ('Σ', "\\Sigma"),
    ('Φ', "\\Phi"),
    ('Ψ', "\\Psi"),
    ('Ω', "\\Omega"),
    ('ẋ', "\\dot{x}"),
    ('ẏ', "\\dot{y}"),
    ('ż', "\\dot{z}"),
    ('→', "\\to"),
    ('←', "\\leftarrow"),
    ('↔', "\\leftrightarrow"),
    ('±', "\\pm"),
    ('×', "\\times"),
    ('·', "\\cdot"),
    ('−', "-"),
    ('≤', "\\le"),
    ('≥', "\\ge"),
    ('≠', "\\ne"),
    ('≈', "\\approx"),
    ('∞', "\\infty"),
    ('∂', "\\partial"),
    ('√', "\\surd"),
    ('°', "^\\circ"),
    ('²', "^2"),
    ('³', "^3"),
    ('⁻', "^-"),
    ('⁰', "^0"),
    ('¹', "^1"),
    ('⁴', "^4"),
    ('⁵', "^5"),
    ('⁶', "^6"),
    ('⁷', "^7"),
    ('⁸', "^8"),
    ('⁹', "^9"),
];

/// Letters from À to ž that LaTeX's default encoding of fonts (OT1) cannot make.
const NOT_IN_FONTS: &str = "ÐÞðþĄąĐđĘęĦħĮįĸĿŀŉŊŋŦŧŲų";

/// A symbol with `_{}` and `^{}` as LaTeX mathematics: its Greek and dotted letters and signs as commands, and digits
/// that are lowered as indices.
pub(crate) fn mathematics(symbol: &str) -> String {
    let mut text = String::new();
    let mut is_lowered = false;
    for letter in symbol.chars() {
        let digit = subscript_digit(letter);
        if digit.is_some() != is_lowered {
            text += if is_lowered { "}" } else { "_{" };
            is_lowered = !is_lowered;
        }
        let letter = digit.unwrap_or(letter);
        // A letter behind a command would become part of its name.
        if letter.is_ascii_alphabetic() && ends_in_command(&text) {
            text.push(' ');
        }
        match command(letter) {
            Some(command) => text += command,
            None => text.push(letter),
        }
    }
    if is_lowered {
        text.push('}');
    }
    text
}

fn ends_in_command(text: &str) -> bool {
    let before = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    before.len() < text.len() && before.ends_with('\\')
}

fn command(letter: char) -> Option<&'static str> {
    let known = MATHEMATICS.iter().find(|(known, _)| *known == letter);
    known.map(|(_, command)| *command)
}

/// Plain text for a cell of a table: special characters escaped, mathematical signs as mathematics, letters of
/// European languages as they are, and anything else by its code point.
pub(crate) fn escape(text: &str) -> String {
    text.chars().map(escape_letter).collect()
}

/// A text whose names stand for symbols, such as `f_c`: these as mathematics, the rest as [`escape`] has it.
#[cfg(feature = "figures")]
pub(crate) fn with_symbols(text: &str) -> String {
    let is_of_name = |c: char| c.is_alphanumeric() || c == '_';
    let mut made = String::new();
    let mut rest = text;
    while !rest.is_empty() {
        let length = rest.find(|c: char| !is_of_name(c)).unwrap_or(rest.len());
        let (name, after) = rest.split_at(length);
        match name.split_once('_') {
            Some((letters, lowered)) if !letters.is_empty() && !lowered.is_empty() => {
                let lowered = mathematics(&lowered.replace('_', ","));
                made += &format!("${}_{{{lowered}}}$", mathematics(letters));
            }
            _ if name.contains(|c| subscript_digit(c).is_some()) => {
                made += &format!("${}$", mathematics(name));
            }
            _ => made += &escape(name),
        }
        let sign = after.find(is_of_name).unwrap_or(after.len());
        made += &escape(&after[..sign]);
        rest = &after[sign..];
    }
    made
}

fn escape_letter(letter: char) -> String {
    match letter {
        '&' | '%' | '$' | '#' | '_' | '{' | '}' => format!("\\{letter}"),
        '\\' => "\\textbackslash{}".to_owned(),
        '~' => "\\textasciitilde{}".to_owned(),
        '^' => "\\textasciicircum{}".to_owned(),
        // In the default encoding of fonts these print as something else.
        '<' | '>' | '|' => format!("${letter}$"),
        '"' => "''".to_owned(),
        '–' => "--".to_owned(),
        '—' => "---".to_owned(),
        '’' => "'".to_owned(),
        _ if letter.is_control() => " ".to_owned(),
        _ if letter.is_ascii() || is_in_fonts(letter) => letter.to_string(),
        _ => match command(letter) {
            Some(command) => format!("${command}$"),
            None => format!("\\texttt{{U+{:04X}}}", u32::from(letter)),
        },
    }
}

/// Accented and European letters. LaTeX has read UTF-8 since 2018.
fn is_in_fonts(letter: char) -> bool {
    ('À'..='ž').contains(&letter) && letter.is_alphabetic() && !NOT_IN_FONTS.contains(letter)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn special_characters_are_escaped_and_signs_become_mathematics() {
        for (text, expected) in [
            (
                "2 peaks → 1 peak, 95 % of f_c",
                "2 peaks $\\to$ 1 peak, 95 \\% of f\\_c",
            ),
            ("a&b #1 {x} $", "a\\&b \\#1 \\{x\\} \\$"),
            (
                "\\~^",
                "\\textbackslash{}\\textasciitilde{}\\textasciicircum{}",
            ),
            ("θ < 3 ± 1", "$\\theta$ $<$ 3 $\\pm$ 1"),
            ("Itô, Caughey–Ma", "Itô, Caughey--Ma"),
            ("x⁻¹", "x$^-$$^1$"),
            ("峰 đ", "\\texttt{U+5CF0} \\texttt{U+0111}"),
        ] {
            assert_eq!(escape(text), expected);
        }
    }

    #[test]
    fn commands_in_mathematics_end_where_they_should() {
        assert_eq!(mathematics("σ^{2}"), "\\sigma^{2}");
        assert_eq!(mathematics("αx_{ω}t"), "\\alpha x_{\\omega}t");
        assert_eq!(mathematics("f_{c}"), "f_{c}");
        assert_eq!(mathematics("ω₁₂t₀"), "\\omega_{12}t_{0}");
    }

    #[test]
    #[cfg(feature = "figures")]
    fn names_of_symbols_become_mathematics() {
        assert_eq!(
            with_symbols("p(x, ẋ) at f_c = -0.02, with σ² = 5 %"),
            "p(x, $\\dot{x}$) at $f_{c}$ = -0.02, with $\\sigma$$^2$ = 5 \\%"
        );
        assert_eq!(with_symbols("_ a_ _b"), "\\_ a\\_ \\_b");
        assert_eq!(with_symbols("√(2 D) ξ₁(t)"), "$\\surd$(2 D) $\\xi_{1}$(t)");
    }

    #[test]
    fn no_text_breaks_a_table() {
        // Every character of the basic plane: what comes out is ASCII or a letter that LaTeX's fonts hold, with
        // balanced braces and dollars and no bare column or comment sign.
        for letter in (0..=0xffff).filter_map(char::from_u32) {
            let text = escape(&letter.to_string());
            let bare = text
                .replace("\\{", "")
                .replace("\\}", "")
                .replace("\\$", "");
            let count = |sign| bare.matches(sign).count();
            assert_eq!(count('{'), count('}'), "{text}");
            assert!(count('$') % 2 == 0, "{text}");
            for sign in ['&', '%', '#', '_'] {
                assert!(
                    !text.contains(sign) || text == format!("\\{sign}"),
                    "{text}"
                );
            }
            let known = |c: char| c.is_ascii() && !c.is_control() || ('À'..='ž').contains(&c);
            assert!(text.chars().all(known), "{text}");
        }
    }
}
