//! The formula of a level from the text of a region.

use std::ops::Range;

use super::RegionFault;

/// What was read, or what is wrong and where.
pub(super) type Read<T = ()> = Result<T, (Range<usize>, RegionFault)>;

/// A piece of a level that was copied: where it stands there, and where in the text.
pub(super) type Piece = (Range<usize>, usize);

/// Where a span of a level stands in the text.
pub(super) fn given_span(pieces: &[Piece], span: &Range<usize>) -> Option<Range<usize>> {
    let holds = |piece: &&Piece| piece.0.contains(&span.start);
    let (copied, from) = pieces.iter().find(holds)?;
    let start = from + span.start - copied.start;
    Some(start..(from + span.end.min(copied.end) - copied.start).max(start))
}

/// The formula of the level of a region, with its pieces, or what is wrong and where; `names` are those of regions.
pub(super) fn written_level(names: &[&str], text: &str) -> Read<(String, Vec<Piece>)> {
    let mut level = LevelWriter {
        names,
        whole: text,
        written: String::new(),
        pieces: Vec::new(),
    };
    level.any_of(0..text.len())?;
    Ok((level.written, level.pieces))
}

/// A level in the making.
struct LevelWriter<'a> {
    names: &'a [&'a str],
    whole: &'a str,
    written: String,
    pieces: Vec<Piece>,
}

impl LevelWriter<'_> {
    /// Parts joined by `or`.
    fn any_of(&mut self, span: Range<usize>) -> Read {
        self.joined(span, "or", "min(", |level, part| {
            level.joined(part, "and", "max(", Self::one)
        })
    }

    fn joined(
        &mut self,
        span: Range<usize>,
        word: &str,
        function: &str,
        each: impl Fn(&mut Self, Range<usize>) -> Read,
    ) -> Read {
        let parts = self.split(&span, word)?;
        if let [part] = parts.as_slice() {
            return each(self, part.clone());
        }
        self.written += function;
        for (index, part) in parts.into_iter().enumerate() {
            if index > 0 {
                self.written += ", ";
            }
            each(self, part)?;
        }
        self.written += ")";
        Ok(())
    }

    /// A part without `and` or `or` outside of parentheses.
    fn one(&mut self, span: Range<usize>) -> Read {
        let span = self.trimmed(span);
        let text = &self.whole[span.clone()];
        if text.is_empty() {
            return Err((span, RegionFault::Missing));
        }
        let after = text.strip_prefix("not");
        if let Some(rest) = after.filter(|rest| !rest.starts_with(is_of_name)) {
            self.written += "-(";
            self.one(span.end - rest.len()..span.end)?;
            self.written += ")";
            return Ok(());
        }
        let sides = self.sides(&span)?;
        if sides.len() == 1 {
            let inner = text
                .strip_prefix('(')
                .and_then(|text| text.strip_suffix(')'));
            if inner.is_some() {
                self.written += "(";
                self.any_of(span.start + 1..span.end - 1)?;
                self.written += ")";
                return Ok(());
            }
            if self.names.contains(&text) {
                self.copy(span);
                return Ok(());
            }
            let text = text.to_owned();
            return Err((span, RegionFault::NoInequality { text }));
        }
        let chained = sides.len() > 2;
        self.written += if chained { "max(" } else { "" };
        for (index, pair) in sides.windows(2).enumerate() {
            self.written += if index > 0 { ", " } else { "" };
            let [(first, is_less), (second, _)] = pair else {
                continue;
            };
            let (less, more) = if *is_less {
                (first, second)
            } else {
                (second, first)
            };
            for (side, between) in [(less, "("), (more, ") - (")] {
                let side = self.trimmed(side.clone());
                if side.is_empty() {
                    return Err((span, RegionFault::Missing));
                }
                self.written += between;
                self.copy(side);
            }
            self.written += ")";
        }
        self.written += if chained { ")" } else { "" };
        Ok(())
    }

    /// Copies a part of the text.
    fn copy(&mut self, span: Range<usize>) {
        let start = self.written.len();
        self.written += &self.whole[span.clone()];
        self.pieces.push((start..self.written.len(), span.start));
    }

    fn trimmed(&self, span: Range<usize>) -> Range<usize> {
        let text = &self.whole[span.clone()];
        let start = span.end - text.trim_start().len();
        start..(span.start + text.trim_end().len()).max(start)
    }

    /// The parts of a span between a word, outside of parentheses.
    fn split(&self, span: &Range<usize>, word: &str) -> Read<Vec<Range<usize>>> {
        let mut parts = Vec::new();
        let mut from = span.start;
        let mut before = ' ';
        for (at, character) in self.outside(span)? {
            let rest = &self.whole[at..span.end];
            let begins = !is_of_name(before) && rest.starts_with(word);
            before = character;
            if begins && !rest[word.len()..].starts_with(is_of_name) {
                parts.push(from..at);
                from = at + word.len();
            }
        }
        parts.push(from..span.end);
        Ok(parts)
    }

    /// The sides of an inequality, each with whether it is the smaller one of it and the next.
    fn sides(&self, span: &Range<usize>) -> Read<Vec<(Range<usize>, bool)>> {
        let mut sides = Vec::new();
        let mut from = span.start;
        for (at, character) in self.outside(span)? {
            if at < from {
                continue;
            }
            let is_less = match character {
                '<' | '≤' => true,
                '>' | '≥' => false,
                '=' | '≠' | '!' => {
                    return Err((at..at + character.len_utf8(), RegionFault::Equality));
                }
                _ => continue,
            };
            sides.push((from..at, is_less));
            from = at + character.len_utf8();
            if self.whole[from..span.end].starts_with('=') {
                from += 1;
            }
        }
        sides.push((from..span.end, true));
        Ok(sides)
    }

    /// The characters of a span outside of parentheses.
    fn outside(&self, span: &Range<usize>) -> Read<Vec<(usize, char)>> {
        let mut depth = 0_i32;
        let mut found = Vec::new();
        for (at, character) in self.whole[span.clone()].char_indices() {
            match character {
                '(' => depth += 1,
                ')' => {
                    depth -= 1;
                    if depth == 0 {
                        found.push((span.start + at, character));
                    }
                }
                _ if depth == 0 => found.push((span.start + at, character)),
                _ => {}
            }
            if depth < 0 {
                let at = span.start + at;
                return Err((at..at + 1, RegionFault::Parentheses));
            }
        }
        match depth {
            0 => Ok(found),
            _ => Err((span.clone(), RegionFault::Parentheses)),
        }
    }
}

/// Whether a character may stand in a name.
fn is_of_name(character: char) -> bool {
    character.is_alphanumeric() || character == '_'
}
