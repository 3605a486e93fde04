//! Equations typeset as MathML, which browsers draw themselves: fractions, roots, powers, subscripts, Greek letters.
//!
//! ```text
//! formula as typed ── syntax tree ──┐
//!                                   ├──► Laid (how tightly it holds together, its sign) ──► Element
//! line as people write it ──────────┘
//! ```

mod laid;
mod stated;
mod typed;

use std::fmt;

use super::language::{FormulaError, parse};

pub use stated::stated;

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
    typed::laid(text, &parse(text)?).map(laid::Laid::element)
}

/// The layout of `left = right + factor noise + …`, an equation with formulas as they are typed.
///
/// `left` is a name with primes or without, and each noise a name, with its amplitude before it.
///
/// # Errors
/// What is wrong with a formula, and where.
pub fn equation(
    left: &str,
    right: &str,
    noises: &[(&str, String)],
) -> Result<Element, FormulaError> {
    let mut sum = typed::laid(right, &parse(right)?)?;
    for (amplitude, noise) in noises {
        let noise = laid::Laid::name(noise).called(vec![laid::Laid::name("t")]);
        let term = typed::laid(amplitude, &parse(amplitude)?)?.times(noise);
        sum = sum.plus(term);
    }
    let name = left.trim_end_matches('\'');
    let name = laid::Laid::name(name).primed(left.len() - name.len());
    Ok(name.related("=", sum).element())
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
