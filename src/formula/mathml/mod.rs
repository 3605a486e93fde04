//! Equations typeset as MathML, which browsers draw themselves: fractions, roots, powers, subscripts, Greek letters.
//!
//! ```text
//! formula as typed ── syntax tree ──► Laid (how tightly it holds together, its sign) ──► Element
//! ```

mod part;
mod typed;

use std::fmt;

use super::language::{FormulaError, parse};
use part::{Fence, Part};

/// Longest text that is laid out, in bytes; what is longer is shown as it was written.
const LONGEST: usize = 4096;
/// Deepest nesting of elements; browsers lay out no more at once without trouble.
const DEEPEST: usize = 64;

/// An element of MathML Core: `<msup><mi>x</mi><mn>2</mn></msup>`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Element {
    /// Its name.
    pub tag: &'static str,
    /// Names and values of its attributes.
    pub attributes: Vec<(&'static str, &'static str)>,
    /// What stands in it.
    pub content: Content,
}

/// What stands in an element.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Content {
    /// Plain text, not escaped.
    Text(String),
    /// Further elements.
    Elements(Vec<Element>),
}

/// The layout of a formula of the language that [`super`] describes; names of functions and constants as in print:
/// `sgn`, `√`, `π`.
///
/// ```
/// use pbif::formula::mathml;
///
/// let root = mathml::formula("sqrt(2 D)")?.to_string();
/// assert!(root.starts_with("<msqrt>") && root.contains("<mn>2</mn>"), "{root}");
/// # Ok::<(), pbif::formula::language::FormulaError>(())
/// ```
///
/// # Errors
/// What is wrong with it, and where.
pub fn formula(text: &str) -> Result<Element, FormulaError> {
    typed::lay_out(text, &parse(text)?).map(Part::element)
}

/// The layout of `left = right + amplitude noise(t) + …`, an equation with formulas as they are typed.
///
/// `left` may be a name with primes, `relation` another sign than `=`; a noise is its amplitude and its name.
///
/// # Errors
/// What is wrong with a formula, and where.
pub(crate) fn equation(
    left: &str,
    relation: &str,
    right: &str,
    noises: &[(String, String)],
) -> Result<Element, FormulaError> {
    let of = |text: &str| typed::lay_out(text, &parse(text)?);
    let mut sum = of(right)?;
    for (amplitude, noise) in noises {
        sum = sum.plus(of(amplitude)?.times(at(noise, Part::name("t"))));
    }
    let name = left.trim_end_matches('\'');
    let left = of(name)?.derivative(left.len() - name.len());
    Ok(left.relate(relation, sum).element())
}

/// The layout of `E[one(t) other(t+lag)] = factor δ(lag)`, with words behind it.
pub(crate) fn correlation(
    [one, other]: [&str; 2],
    factor: &str,
    lag: &str,
    words: &str,
) -> Element {
    let time = || Part::name("t");
    let product = at(one, time()).times(at(other, time().plus(Part::name(lag))));
    let mean = Part::name("E").apply(product.between(Fence::Brackets));
    let mut delta = at("δ", Part::name(lag));
    if !factor.is_empty() {
        delta = Part::name(factor).times(delta);
    }
    let whole = mean.relate("=", delta);
    if words.is_empty() {
        return whole.element();
    }
    whole.beside(Part::words(words)).element()
}

/// Text that is no formula.
pub(crate) fn words(text: &str) -> Element {
    Part::words(text).element()
}

/// A function of time.
fn at(name: &str, time: Part) -> Part {
    Part::name(name).call(vec![time])
}

impl Element {
    fn text(tag: &'static str, text: impl Into<String>) -> Self {
        Self {
            tag,
            attributes: Vec::new(),
            content: Content::Text(text.into()),
        }
    }

    fn of(tag: &'static str, elements: Vec<Self>) -> Self {
        Self {
            tag,
            attributes: Vec::new(),
            content: Content::Elements(elements),
        }
    }

    fn with(mut self, name: &'static str, value: &'static str) -> Self {
        self.attributes.push((name, value));
        self
    }

    /// One element of several.
    fn row(mut elements: Vec<Self>) -> Self {
        match elements.len() {
            1 => elements.remove(0),
            _ => Self::of("mrow", elements),
        }
    }

    /// Whether it is higher than a line.
    fn is_tall(&self) -> bool {
        let Content::Elements(inner) = &self.content else {
            return false;
        };
        matches!(self.tag, "mfrac" | "mtable") || inner.iter().any(Self::is_tall)
    }

    /// Whether the innermost element lies deeper than so many.
    fn is_deeper_than(&self, levels: usize) -> bool {
        match &self.content {
            Content::Text(_) => false,
            _ if levels == 0 => true,
            Content::Elements(inner) => inner.iter().any(|one| one.is_deeper_than(levels - 1)),
        }
    }
}

/// As markup, without the `<math>` around it.
impl fmt::Display for Element {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "<{}", self.tag)?;
        for (name, value) in &self.attributes {
            write!(f, " {name}=\"{value}\"")?;
        }
        f.write_str(">")?;
        match &self.content {
            Content::Text(text) => {
                for letter in text.chars() {
                    match letter {
                        '&' => f.write_str("&amp;")?,
                        '<' => f.write_str("&lt;")?,
                        '>' => f.write_str("&gt;")?,
                        letter => write!(f, "{letter}")?,
                    }
                }
            }
            Content::Elements(inner) => inner.iter().try_for_each(|one| write!(f, "{one}"))?,
        }
        write!(f, "</{}>", self.tag)
    }
}

#[cfg(test)]
mod tests;
