//! A part of a formula that has been laid out, and what its neighbours must know of it: its sign, and how tightly it
//! holds together.

use super::{Content, DEEPEST, Element};
use crate::formula::language::typeset_name;

const TIMES: &str = "\u{2062}";
const APPLIED_TO: &str = "\u{2061}";

/// How tightly a part holds together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Level {
    Relation,
    Sum,
    Product,
    /// A power or a fraction: a factor that needs no parentheses, but does as the base of a power.
    Factor,
    Atom,
}

/// A part of a formula.
#[derive(Debug, Clone)]
pub(super) struct Part {
    /// Side by side, without the sign.
    elements: Vec<Element>,
    /// Whether a minus stands before it: it is drawn in front of a whole product or fraction.
    negative: bool,
    level: Level,
}

fn operator(sign: &str) -> Element {
    Element::text("mo", sign)
}

impl Part {
    pub(super) fn new(element: Element, level: Level) -> Self {
        Self {
            elements: vec![element],
            negative: false,
            level,
        }
    }

    /// A name as it is printed: its Greek letter, and what is lowered.
    pub(super) fn name(name: &str) -> Self {
        let shown = typeset_name(name);
        let is_lowered = |c: char| ('₀'..='₉').contains(&c);
        let stem = shown.trim_end_matches(is_lowered);
        let (base, lowered) = match shown.split_once('_') {
            Some((base, rest)) if !base.is_empty() => (base, rest.replace('_', ",")),
            _ => {
                let digits = shown[stem.len()..].chars();
                let plain =
                    digits.filter_map(|c| char::from_u32(c as u32 - '₀' as u32 + '0' as u32));
                (stem, plain.collect())
            }
        };
        let base = Element::text("mi", base);
        if lowered.is_empty() {
            return Self::new(base, Level::Atom);
        }
        let is_number = lowered.chars().all(|c| c.is_ascii_digit());
        let lowered = Element::text(if is_number { "mn" } else { "mi" }, lowered);
        Self::new(Element::of("msub", vec![base, lowered]), Level::Atom)
    }

    /// A number in the fewest digits; very large and small ones with a power of ten.
    pub(super) fn number(value: f64) -> Self {
        let size = value.abs();
        let digits = if size == 0.0 || (1e-4..1e9).contains(&size) {
            format!("{size}")
        } else {
            format!("{size:e}")
        };
        let plain = |digits: &str| Self::new(Element::text("mn", digits), Level::Atom);
        let number = match digits.split_once('e') {
            Some((mantissa, exponent)) => {
                let (sign, power) = match exponent.strip_prefix('-') {
                    Some(power) => (true, power),
                    None => (false, exponent),
                };
                let power = Self {
                    negative: sign,
                    ..plain(power)
                };
                let power = plain("10").raise(power);
                match mantissa {
                    "1" => power,
                    mantissa => plain(mantissa).join("×", power),
                }
            }
            None => plain(&digits),
        };
        Self {
            negative: value < 0.0,
            ..number
        }
    }

    pub(super) fn words(text: &str) -> Self {
        Self::new(Element::text("mtext", text), Level::Atom)
    }

    fn fence(self, open: &str, close: &str) -> Self {
        let inner = Element::of("mrow", self.signed());
        // A fence that may stretch becomes taller than need be about every letter that hangs below the line.
        let stretchy = if inner.is_tall() { "true" } else { "false" };
        let mark = |sign: &str, form: &'static str| {
            operator(sign).with("form", form).with("stretchy", stretchy)
        };
        let (before, after) = (mark(open, "prefix"), mark(close, "postfix"));
        let row = vec![before, inner, after];
        Self::new(Element::of("mrow", row), Level::Atom)
    }

    pub(super) fn between(self, fence: Fence) -> Self {
        let (open, close) = match fence {
            Fence::Parentheses => ("(", ")"),
            Fence::Brackets => ("[", "]"),
            Fence::Bars => ("|", "|"),
            Fence::Floor => ("⌊", "⌋"),
        };
        self.fence(open, close)
    }

    /// In parentheses where it holds together less tightly than asked.
    fn at_least(self, level: Level) -> Self {
        if self.level < level || self.negative {
            self.between(Fence::Parentheses)
        } else {
            self
        }
    }

    fn signed(self) -> Vec<Element> {
        let minus = self.negative.then(|| operator("−").with("form", "prefix"));
        minus.into_iter().chain(self.elements).collect()
    }

    fn begins_with_number(&self) -> bool {
        let mut first = self.elements.first();
        while let Some(Element {
            tag: "msup",
            content: Content::Elements(inner),
            ..
        }) = first
        {
            first = inner.first();
        }
        first.is_some_and(|one| one.tag == "mn")
    }

    /// Whether it would be read as a mixed number, such as 2½, beside another part without a sign between them.
    fn is_mixed_with(&self, other: &Self) -> bool {
        let tag = |element: Option<&Element>| element.map(|one| one.tag);
        tag(self.elements.last()) == Some("mn") && tag(other.elements.first()) == Some("mfrac")
    }

    /// Beside another part, with a sign between them.
    fn join(mut self, sign: &str, other: Self) -> Self {
        self.elements.push(operator(sign));
        self.elements.extend(other.elements);
        self.level = Level::Product;
        self
    }

    pub(super) fn negated(self) -> Self {
        let inner = self.at_least(Level::Product);
        Self {
            negative: true,
            ..inner
        }
    }

    pub(super) fn plus(self, other: Self) -> Self {
        self.add("+", other)
    }

    pub(super) fn minus(self, other: Self) -> Self {
        self.add("−", other)
    }

    fn add(self, sign: &str, other: Self) -> Self {
        let left = if self.level < Level::Sum {
            self.between(Fence::Parentheses)
        } else {
            self
        };
        let mut elements = left.signed();
        elements.push(operator(sign));
        elements.extend(other.at_least(Level::Product).elements);
        Self {
            elements,
            negative: false,
            level: Level::Sum,
        }
    }

    pub(super) fn times(self, other: Self) -> Self {
        let negative = self.negative && self.level >= Level::Product;
        let left = if negative {
            Self {
                negative: false,
                ..self
            }
        } else {
            self.at_least(Level::Product)
        };
        let right = other.at_least(Level::Product);
        let product = if right.begins_with_number() || left.is_mixed_with(&right) {
            left.join("·", right)
        } else {
            let mut product = left;
            product
                .elements
                .push(operator(TIMES).with("rspace", "0.14em"));
            product.elements.extend(right.elements);
            product.level = Level::Product;
            product
        };
        Self {
            negative,
            ..product
        }
    }

    pub(super) fn over(self, other: Self) -> Self {
        let negative = self.negative && self.level >= Level::Product;
        let above = if negative {
            self.elements
        } else {
            self.signed()
        };
        let parts = vec![Element::row(above), Element::row(other.signed())];
        let fraction = Self::new(Element::of("mfrac", parts), Level::Factor);
        Self {
            negative,
            ..fraction
        }
    }

    pub(super) fn raise(self, exponent: Self) -> Self {
        let base = self.at_least(Level::Atom);
        let parts = vec![Element::row(base.elements), Element::row(exponent.signed())];
        Self::new(Element::of("msup", parts), Level::Factor)
    }

    /// Its root, of this degree.
    pub(super) fn root(self, degree: Option<&str>) -> Self {
        let inner = Element::row(self.signed());
        let root = match degree {
            None => Element::of("msqrt", vec![inner]),
            Some(degree) => Element::of("mroot", vec![inner, Element::text("mn", degree)]),
        };
        Self::new(root, Level::Atom)
    }

    /// Its derivative in time, of this order: with dots above.
    pub(super) fn derivative(self, order: usize) -> Self {
        let dots = match order {
            0 => return self,
            1 => "˙".to_owned(),
            2 => "¨".to_owned(),
            more => "˙".repeat(more),
        };
        let parts = vec![Element::row(self.elements), Element::text("mo", dots)];
        let element = Element::of("mover", parts).with("accent", "true");
        Self::new(element, Level::Atom)
    }

    /// A function at these arguments.
    pub(super) fn call(self, arguments: Vec<Self>) -> Self {
        let inside = Self::list(arguments).between(Fence::Parentheses);
        self.apply(inside)
    }

    /// A function beside what it is applied to, fences included.
    pub(super) fn apply(self, inside: Self) -> Self {
        let mut elements = self.elements;
        elements.push(operator(APPLIED_TO));
        elements.extend(inside.elements);
        Self::new(Element::of("mrow", elements), Level::Atom)
    }

    /// Parts with commas between them.
    pub(super) fn list(parts: Vec<Self>) -> Self {
        let mut elements = Vec::new();
        for (number, part) in parts.into_iter().enumerate() {
            if number > 0 {
                elements.push(operator(","));
            }
            elements.extend(part.signed());
        }
        Self {
            elements,
            negative: false,
            level: Level::Relation,
        }
    }

    /// Parts side by side as they are.
    pub(super) fn beside(self, other: Self) -> Self {
        let mut elements = self.signed();
        elements.extend(other.signed());
        Self {
            elements,
            negative: false,
            level: Level::Relation,
        }
    }

    pub(super) fn relate(self, sign: &str, other: Self) -> Self {
        let mut elements = self.signed();
        elements.push(operator(sign));
        elements.extend(other.signed());
        Self {
            elements,
            negative: false,
            level: Level::Relation,
        }
    }

    /// One value where a condition holds, another where not.
    pub(super) fn cases(condition: Self, yes: Self, no: Self) -> Self {
        let cell = |parts: Vec<Element>| Element::of("mtd", parts);
        let gap = || Element::text("mtext", "\u{2003}if ");
        let mut holds = vec![gap()];
        holds.extend(condition.signed());
        let rows = vec![
            Element::of("mtr", vec![cell(yes.signed()), cell(holds)]),
            Element::of(
                "mtr",
                vec![
                    cell(no.signed()),
                    cell(vec![Element::text("mtext", "\u{2003}otherwise")]),
                ],
            ),
        ];
        let brace = operator("{")
            .with("form", "prefix")
            .with("stretchy", "true");
        let row = vec![brace, Element::of("mtable", rows)];
        Self::new(Element::of("mrow", row), Level::Factor)
    }

    /// Whether it is nested deeper than a browser lays out.
    pub(super) fn is_too_deep(&self) -> bool {
        self.elements.iter().any(|one| one.is_deeper_than(DEEPEST))
    }

    pub(super) fn element(self) -> Element {
        Element::row(self.signed())
    }
}

/// What stands around a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fence {
    Parentheses,
    Brackets,
    Bars,
    Floor,
}
