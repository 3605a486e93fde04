//! The layout of an equation as people write it, such as `z' = y - (λ |y| / f_c) z,   |z| ≤ f_c/λ`. Built-in models
//! state theirs so.
//!
//! Unlike formulas, such lines hold relations, bars, primes, functions that are defined in words, and words. What
//! cannot be read is shown as it stands.

use super::laid::{Fence, Laid};
use super::{DEEPEST, Element, LONGEST};
use crate::formula::language::Function;

/// Signs between the two sides of a statement, and after a word.
const RELATIONS: [char; 9] = ['=', '≤', '≥', '<', '>', '∝', ':', '≠', ','];
const RAISED: &str = "⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺ⁿ";
const LINED: &str = "0123456789-+n";

/// Lays out a line of a model's [`equations`](crate::system::Model::equations).
///
/// ```
/// let friction = pbif::formula::mathml::stated("f_c/λ").to_string();
/// assert_eq!(friction, "<mfrac><msub><mi>f</mi><mi>c</mi></msub><mi>λ</mi></mfrac>");
/// ```
pub fn stated(line: &str) -> Element {
    if line.len() > LONGEST {
        return Laid::words(line).element();
    }
    let mut reader = Reader::new(line);
    let mut whole: Option<Laid> = None;
    while let Some(piece) = reader.piece() {
        whole = Some(match whole {
            Some(before) => before.beside(piece),
            None => piece,
        });
    }
    let whole = whole.filter(|laid| !laid.is_too_deep());
    whole.unwrap_or_else(|| Laid::words(line)).element()
}

struct Reader {
    letters: Vec<char>,
    at: usize,
    depth: usize,
    /// Within bars a bar closes.
    in_bars: bool,
}

impl Reader {
    fn new(line: &str) -> Self {
        Self {
            letters: line.chars().collect(),
            at: 0,
            depth: 0,
            in_bars: false,
        }
    }

    fn next(&self) -> Option<char> {
        self.letters.get(self.at).copied()
    }

    fn take(&mut self, wanted: char) -> bool {
        let found = self.next() == Some(wanted);
        self.at += usize::from(found);
        found
    }

    /// Passes blanks; how many.
    fn blanks(&mut self) -> usize {
        self.run(char::is_whitespace).len()
    }

    fn run(&mut self, belongs: impl Fn(char) -> bool) -> String {
        let rest = self.letters.get(self.at..).unwrap_or(&[]);
        let run: String = rest.iter().take_while(|&&c| belongs(c)).collect();
        self.at += run.chars().count();
        run
    }

    /// The next part of a line: a sum, a relation or words.
    fn piece(&mut self) -> Option<Laid> {
        self.blanks();
        let next = self.next()?;
        if RELATIONS.contains(&next) {
            self.at += 1;
            let sign = Laid::sign(&next.to_string());
            return Some(match (next, self.blanks()) {
                (',', 2..) => sign.beside(Laid::words("\u{2003}")),
                _ => sign,
            });
        }
        let mut words = Vec::new();
        while let Some(word) = self.word() {
            self.at += word.chars().count();
            self.blanks();
            words.push(word);
        }
        if !words.is_empty() {
            // Blanks at the ends of a text are not drawn unless they are of the kind that does not break.
            return Some(Laid::words(&format!("\u{a0}{}\u{a0}", words.join(" "))));
        }
        let begin = self.at;
        let sum = self.sum();
        if sum.is_some() {
            return sum;
        }
        let rest: String = self.letters.get(begin..)?.iter().collect();
        self.at = self.letters.len();
        Some(Laid::words(&rest))
    }

    /// The word that stands here: letters that are no symbol, no function and no differential.
    fn word(&self) -> Option<String> {
        let rest = self.letters.get(self.at..)?;
        let word: String = rest
            .iter()
            .take_while(|c| c.is_alphabetic() && !RAISED.contains(**c))
            .collect();
        let length = word.chars().count();
        let is_symbol = length < 2
            || is_differential(&word)
            || matches!(rest.get(length), Some('(' | '[' | '_' | '\''));
        (!is_symbol).then_some(word)
    }

    fn sum(&mut self) -> Option<Laid> {
        self.blanks();
        let negative = self.minus();
        let first = self.product()?;
        let mut sum = if negative { first.negated() } else { first };
        loop {
            self.blanks();
            if self.take('+') {
                sum = sum.plus(self.product()?);
            } else if self.minus() {
                sum = sum.minus(self.product()?);
            } else {
                return Some(sum);
            }
        }
    }

    fn minus(&mut self) -> bool {
        self.take('-') || self.take('−')
    }

    fn product(&mut self) -> Option<Laid> {
        let mut product = self.power()?;
        loop {
            self.blanks();
            if self.take('/') {
                product = product.over(self.power()?);
            } else if self.take('*') || self.take('·') || self.begins_factor() {
                product = product.times(self.power()?);
            } else {
                return Some(product);
            }
        }
    }

    fn begins_factor(&self) -> bool {
        match self.next() {
            Some('|') => !self.in_bars,
            Some(c) => (c.is_alphanumeric() || "(√".contains(c)) && self.word().is_none(),
            None => false,
        }
    }

    fn power(&mut self) -> Option<Laid> {
        self.blanks();
        let base = self.atom()?;
        let raised = self.run(|c| RAISED.contains(c));
        if !raised.is_empty() {
            let lined = raised.chars().filter_map(|c| {
                let place = RAISED.chars().position(|own| own == c)?;
                LINED.chars().nth(place)
            });
            let exponent = Self::new(&lined.collect::<String>()).sum()?;
            return Some(base.raised(exponent));
        }
        match self.take('^') {
            true => Some(base.raised(self.atom()?)),
            false => Some(base),
        }
    }

    fn atom(&mut self) -> Option<Laid> {
        let next = self.next()?;
        match next {
            '0'..='9' => {
                let digits = self.run(|c| c.is_ascii_digit() || c == '.');
                digits.parse().ok().map(Laid::number)
            }
            '√' => {
                self.at += 1;
                Some(self.deeper(Self::atom)?.root(None))
            }
            '(' => {
                let mut inner = self.list('(', ')')?;
                let only = inner.pop()?;
                inner.is_empty().then_some(only)
            }
            '|' if !self.in_bars => {
                self.at += 1;
                self.in_bars = true;
                let inner = self.deeper(Self::sum);
                self.in_bars = false;
                self.take('|').then_some(inner?.between(Fence::Bars))
            }
            c if c.is_alphabetic() => self.symbol(),
            _ => None,
        }
    }

    /// A name with its primes, and what it is applied to where parentheses follow at once.
    fn symbol(&mut self) -> Option<Laid> {
        let letters = self.run(|c| c.is_alphabetic() && !RAISED.contains(c));
        let lowered = self.run(|c| c == '_' || ('₀'..='₉').contains(&c));
        let lowered = match lowered.as_str() {
            "_" => lowered + &self.run(|c| c.is_alphanumeric() && !RAISED.contains(c)),
            _ => lowered,
        };
        let name = match is_differential(&letters) && lowered.is_empty() {
            true => {
                let of: String = letters.chars().skip(1).collect();
                Laid::name("d").beside(Laid::name(&of)).whole()
            }
            false => Laid::name(&(letters + &lowered)),
        };
        let name = name.primed(self.run(|c| c == '\'').len());
        match self.next() {
            Some('(') => {
                let arguments = self.list('(', ')')?;
                Some(name.called(arguments))
            }
            Some('[') => {
                let inside = Laid::listed(self.list('[', ']')?).between(Fence::Brackets);
                Some(name.applied(inside))
            }
            _ => Some(name),
        }
    }

    /// Sums with commas between them, in these fences.
    fn list(&mut self, open: char, close: char) -> Option<Vec<Laid>> {
        if !self.take(open) {
            return None;
        }
        let in_bars = std::mem::take(&mut self.in_bars);
        let mut parts = Vec::new();
        loop {
            parts.push(self.deeper(Self::sum)?);
            self.blanks();
            if !self.take(',') {
                break;
            }
        }
        self.in_bars = in_bars;
        self.take(close).then_some(parts)
    }

    fn deeper(&mut self, read: impl Fn(&mut Self) -> Option<Laid>) -> Option<Laid> {
        if self.depth > DEEPEST {
            return None;
        }
        self.depth += 1;
        let found = read(self);
        self.depth -= 1;
        found
    }
}

/// Whether letters are a differential, such as `dx` or `dW`, and no function.
fn is_differential(letters: &str) -> bool {
    letters.starts_with('d') && letters.chars().count() == 2 && Function::named(letters).is_none()
}
