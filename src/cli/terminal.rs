//! What is shown on a terminal: texts of others without the power to drive it.

/// A text whose control characters are pictures of themselves: names of folders and what stands in files of others may
/// hold codes that move the cursor, name windows or write over lines. Ends of lines, tabs, and where `styled` the codes
/// of colours stay.
pub(super) fn harmless(text: &str, styled: bool) -> String {
    let mut shown = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(character) = rest.chars().next() {
        let length = if styled { colour(rest) } else { 0 };
        let length = if rest.starts_with("\r\n") { 2 } else { length };
        if length > 0 {
            shown += &rest[..length];
            rest = &rest[length..];
            continue;
        }
        shown.push(picture(character));
        rest = &rest[character.len_utf8()..];
    }
    shown
}

/// Bytes of the code of a colour at the beginning of a text.
fn colour(text: &str) -> usize {
    let Some(code) = text.strip_prefix("\u{1b}[") else {
        return 0;
    };
    let end = code.find(|c: char| !c.is_ascii_digit() && c != ';');
    match end {
        Some(end) if code[end..].starts_with('m') => end + 3,
        _ => 0,
    }
}

fn picture(character: char) -> char {
    match character {
        '\n' | '\t' => character,
        '\0'..='\u{1f}' => char::from_u32(0x2400 + character as u32).unwrap_or('\u{fffd}'),
        '\u{7f}' => '\u{2421}',
        // Further controls, and what turns the direction of writing.
        '\u{80}'..='\u{9f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => '\u{fffd}',
        character => character,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_ends_of_lines_tabs_and_colours_of_the_programs_own_pass() {
        let colours = "\u{1b}[1;31mred\u{1b}[0m";
        for (text, plain, styled) in [
            ("a\tb\r\nσ² → κ\n", "a\tb\r\nσ² → κ\n", "a\tb\r\nσ² → κ\n"),
            (
                "over\rwritten\u{7}\u{7f}",
                "over␍written␇␡",
                "over␍written␇␡",
            ),
            (colours, "␛[1;31mred␛[0m", colours),
            (
                "\u{1b}]0;title\u{1b}[2J\u{1b}[1",
                "␛]0;title␛[2J␛[1",
                "␛]0;title␛[2J␛[1",
            ),
            (
                "\u{9b}2J \u{202e}txt",
                "\u{fffd}2J \u{fffd}txt",
                "\u{fffd}2J \u{fffd}txt",
            ),
        ] {
            assert_eq!(harmless(text, false), plain);
            assert_eq!(harmless(text, true), styled);
        }
    }
}
