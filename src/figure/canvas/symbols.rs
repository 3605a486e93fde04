//! Markup of lettering, and numbers as a journal prints them.
//!
//! `_{…}` lowers, `^{…}` raises, and between two `$` letters are slanted, as variables are; digits, signs
//! and indices stay upright. A backslash takes a special character's meaning away.

/// Where a run of letters stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Script {
    /// On the line.
    Base,
    /// Lowered and smaller.
    Lower,
    /// Raised and smaller.
    Upper,
}

/// Letters that share a style.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Run {
    /// The letters.
    pub(crate) text: String,
    /// Where they stand.
    pub(crate) script: Script,
    /// Whether they are slanted.
    pub(crate) slanted: bool,
}

/// Takes markup apart; braces that do not match end with the text.
pub(crate) fn runs(markup: &str) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    let (mut script, mut variable) = (Script::Base, false);
    let mut letters = markup.chars().peekable();
    while let Some(letter) = letters.next() {
        let opens = matches!(letter, '_' | '^') && letters.peek() == Some(&'{');
        match letter {
            '\\' => {
                let escaped = letters.next();
                escaped
                    .into_iter()
                    .for_each(|c| push(&mut runs, c, script, false));
            }
            '$' => variable = !variable,
            '}' if script != Script::Base => script = Script::Base,
            _ if opens => {
                letters.next();
                script = if letter == '_' {
                    Script::Lower
                } else {
                    Script::Upper
                };
            }
            _ => {
                let slanted = variable && script == Script::Base && letter.is_alphabetic();
                push(&mut runs, letter, script, slanted);
            }
        }
    }
    runs
}

fn push(runs: &mut Vec<Run>, letter: char, script: Script, slanted: bool) {
    match runs.last_mut() {
        Some(run) if run.script == script && run.slanted == slanted => run.text.push(letter),
        _ => runs.push(Run {
            text: letter.to_string(),
            script,
            slanted,
        }),
    }
}

/// Text that markup must leave alone.
pub(crate) fn plain(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        if matches!(letter, '\\' | '$' | '_' | '^' | '}') {
            escaped.push('\\');
        }
        escaped.push(letter);
    }
    escaped
}

/// A unit such as `1/t^2`, with its powers raised.
pub(crate) fn unit(text: &str) -> String {
    let mut parts = text.split('^');
    let mut markup = plain(parts.next().unwrap_or_default());
    for part in parts {
        let digits = part.find(|letter: char| !letter.is_ascii_digit());
        let (power, rest) = part.split_at(digits.unwrap_or(part.len()));
        markup += &if power.is_empty() {
            plain("^")
        } else {
            format!("^{{{power}}}")
        };
        markup += &plain(rest);
    }
    markup
}

/// A number with a real minus sign and never a negative zero.
fn with_minus(digits: &str) -> String {
    match digits.strip_prefix('-') {
        Some(rest) if rest.chars().all(|c| matches!(c, '0' | '.')) => rest.to_owned(),
        Some(rest) => format!("−{rest}"),
        None => digits.to_owned(),
    }
}

/// A number with a fixed count of decimals; zero is `0`.
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    let digits = with_minus(&format!("{value:.decimals$}"));
    if digits.chars().all(|c| matches!(c, '0' | '.')) {
        return "0".to_owned();
    }
    digits
}

/// A value rounded to six significant digits, which drops what binary fractions add to `0.1 + 0.2`.
pub(crate) fn rounded(value: f64) -> f64 {
    rounded_to(value, 6)
}

/// The value with so many significant digits, without a negative zero.
pub(crate) fn rounded_to(value: f64, digits: usize) -> f64 {
    let decimals = digits.saturating_sub(1);
    let value = format!("{value:.decimals$e}").parse().unwrap_or(value);
    if value == 0.0 { 0.0 } else { value }
}

/// A single value, shortest form of six significant digits, as markup: `−0.02`, `1.5×10^{−7}`.
pub(crate) fn value(number: f64) -> String {
    let number = rounded(number);
    if number == 0.0 || (1e-4..1e6).contains(&number.abs()) {
        return with_minus(&format!("{number}"));
    }
    let digits = format!("{number:e}");
    match digits.split_once('e') {
        Some((mantissa, exponent)) => {
            format!("{}×10^{{{}}}", with_minus(mantissa), with_minus(exponent))
        }
        None => with_minus(&digits),
    }
}

/// A symbol with its slanted letters, as markup.
pub(crate) fn variable(symbol: &str) -> String {
    format!("${symbol}$")
}

/// `p(x)` or `p(x, ẋ)`, as markup.
pub(crate) fn density_of(symbols: &[String]) -> String {
    format!("$p$({})", symbols.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(markup: &str) -> Vec<(String, Script, bool)> {
        let runs = runs(markup).into_iter();
        runs.map(|run| (run.text, run.script, run.slanted))
            .collect()
    }

    #[test]
    fn scripts_and_slant_are_found() {
        let expected = vec![
            ("f".to_owned(), Script::Base, true),
            ("c".to_owned(), Script::Lower, false),
            (" = −0.02".to_owned(), Script::Base, false),
        ];
        assert_eq!(shape("$f_{c}$ = −0.02"), expected);
        let expected = vec![
            ("σ".to_owned(), Script::Base, true),
            ("2".to_owned(), Script::Upper, false),
        ];
        assert_eq!(shape("$σ^{2}$"), expected);
    }

    #[test]
    fn powers_of_units_are_raised() {
        let text = |letters: &str, script| (letters.to_owned(), script, false);
        let expected = vec![
            text("x_1", Script::Base),
            text("2", Script::Upper),
            text("/t", Script::Base),
        ];
        assert_eq!(shape(&unit("x_1^2/t")), expected);
        assert_eq!(shape(&unit("a^b")), vec![text("a^b", Script::Base)]);
    }

    #[test]
    fn plain_text_comes_through_unchanged() {
        for text in ["f_{c} costs $5^{2}", "a\\b", "", "x}_{"] {
            let joined: String = runs(&plain(text)).into_iter().map(|run| run.text).collect();
            assert_eq!(joined, text);
            assert!(
                runs(&plain(text))
                    .iter()
                    .all(|run| run.script == Script::Base)
            );
        }
    }

    #[test]
    fn a_bare_underscore_stays() {
        assert_eq!(shape("f_c"), vec![("f_c".to_owned(), Script::Base, false)]);
    }

    #[test]
    fn numbers_have_real_minus_signs_and_one_zero() {
        assert_eq!(fixed(-0.02, 3), "−0.020");
        assert_eq!(fixed(-1e-18, 2), "0");
        assert_eq!(value(-0.1 - 0.2), "−0.3");
        assert_eq!(value(-0.0), "0");
        assert_eq!(value(1.5e-7), "1.5×10^{−7}");
        assert_eq!(value(-2e9), "−2×10^{9}");
        assert_eq!(value(1234.5), "1234.5");
    }

    #[test]
    fn density_titles_name_their_symbols() {
        let symbols = vec![variable("x"), variable("ẋ")];
        assert_eq!(density_of(&symbols), "$p$($x$, $ẋ$)");
    }
}
