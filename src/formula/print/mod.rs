//! Expressions as text: one that reads back to the same expression, and one for people.

mod style;

use std::collections::HashMap;

use crate::formula::arithmetic::{Binary, Unary};
use crate::formula::graph::{Expression, Graph, Node};
use crate::formula::limits;
use crate::formula::scope::{Scope, Symbols};

use style::{Style, comparison, function_name, number};

/// The text would be longer than `limits::PRINTED_BYTES`; shared parts are written out at each place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "the expression written out has more than {} bytes",
    limits::PRINTED_BYTES
)]
pub struct TooLong;

impl Scope {
    /// The expression as a formula that reads back to the same expression, definitions written out.
    ///
    /// # Errors
    /// [`TooLong`].
    pub fn text(&self, expression: Expression) -> Result<String, TooLong> {
        let names = HashMap::new();
        Printer::new(self, Style::Plain, &names)
            .print(expression)
            .ok_or(TooLong)
    }

    /// The expression in Unicode for people, definitions by their names: `-(c₀ + c₁ x²) y - ω² x`. A very long one
    /// ends in `…`.
    pub fn typeset(&self, expression: Expression) -> String {
        let mut names = HashMap::new();
        for (name, defined) in self.definitions() {
            let simple = matches!(
                self.graph().node(defined),
                Node::Constant(_) | Node::Symbol(_)
            );
            // A definition is written out where it is itself what is printed.
            if !simple && defined != expression {
                names.entry(defined).or_insert(name);
            }
        }
        let mut printer = Printer::new(self, Style::Typeset, &names);
        match printer.print(expression) {
            Some(text) => text,
            None => printer.shortened(),
        }
    }
}

/// How tightly an expression holds together, and how tightly its place asks it to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Level {
    Comparison,
    Sum,
    Product,
    Power,
    Atom,
}

/// What is still to be written.
enum Item {
    Text(&'static str),
    /// Between two factors without a sign.
    Joint,
    Node(Expression, Level),
}

struct Printer<'a> {
    graph: &'a Graph,
    symbols: &'a Symbols,
    style: Style,
    names: &'a HashMap<Expression, &'a str>,
    written: String,
    /// The next comes last.
    ahead: Vec<Item>,
    joint: bool,
}

impl<'a> Printer<'a> {
    fn new(scope: &'a Scope, style: Style, names: &'a HashMap<Expression, &'a str>) -> Self {
        Self {
            graph: scope.graph(),
            symbols: scope.symbols(),
            style,
            names,
            written: String::new(),
            ahead: Vec::new(),
            joint: false,
        }
    }

    fn print(&mut self, expression: Expression) -> Option<String> {
        self.ahead.push(Item::Node(expression, Level::Comparison));
        while let Some(item) = self.ahead.pop() {
            match item {
                Item::Text(text) => self.write(text),
                Item::Joint => self.joint = true,
                Item::Node(node, level) => self.node(node, level),
            }
            if self.written.len() > limits::PRINTED_BYTES {
                return None;
            }
        }
        Some(std::mem::take(&mut self.written))
    }

    /// What has been written when it became too long.
    fn shortened(&mut self) -> String {
        let mut end = limits::PRINTED_BYTES.min(self.written.len());
        while !self.written.is_char_boundary(end) {
            end -= 1;
        }
        self.written.truncate(end);
        self.written.push('…');
        std::mem::take(&mut self.written)
    }

    fn write(&mut self, text: &str) {
        if std::mem::take(&mut self.joint) {
            let digit = text.starts_with(|c: char| c.is_ascii_digit());
            self.written.push(if digit { '·' } else { ' ' });
        }
        self.written.push_str(text);
    }

    /// Puts items ahead, in the order in which they are to be written.
    fn push<const N: usize>(&mut self, items: [Item; N]) {
        self.ahead.extend(items.into_iter().rev());
    }

    fn node(&mut self, expression: Expression, level: Level) {
        if let Some(name) = self.names.get(&expression) {
            let name = self.style.name(name);
            return self.write(&name);
        }
        let node = self.graph.node(expression);
        if self.level(node) < level {
            self.write("(");
            self.ahead.push(Item::Text(")"));
        }
        match node {
            Node::Constant(value) => {
                let text = number(value.value(), self.style, self.symbols);
                self.write(&text);
            }
            Node::Symbol(symbol) => {
                let name = self.style.name(self.symbols.name(symbol));
                self.write(&name);
            }
            Node::Unary(Unary::Negate, a) => {
                self.push([Item::Text("-"), Item::Node(a, Level::Product)]);
            }
            Node::Unary(Unary::Abs, a) if self.style == Style::Typeset => {
                let inner = Item::Node(a, Level::Comparison);
                self.push([Item::Text("|"), inner, Item::Text("|")]);
            }
            Node::Unary(operation, a) => {
                let name = function_name(operation, self.style);
                let inner = Item::Node(a, Level::Comparison);
                self.push([Item::Text(name), Item::Text("("), inner, Item::Text(")")]);
            }
            Node::Binary(operation, a, b) => self.binary(operation, a, b),
            Node::Select(condition, yes, no) => {
                let [condition, yes, no] =
                    [condition, yes, no].map(|part| Item::Node(part, Level::Comparison));
                let comma = || Item::Text(", ");
                self.push([
                    Item::Text("if("),
                    condition,
                    comma(),
                    yes,
                    comma(),
                    no,
                    Item::Text(")"),
                ]);
            }
        }
    }

    fn level(&self, node: Node) -> Level {
        match node {
            Node::Constant(value) if value.value().is_sign_negative() => Level::Sum,
            Node::Unary(Unary::Negate, _) => Level::Sum,
            Node::Constant(_) | Node::Symbol(_) | Node::Unary(..) | Node::Select(..) => Level::Atom,
            Node::Binary(operation, ..) => match operation {
                Binary::Add | Binary::Subtract => Level::Sum,
                Binary::Multiply | Binary::Divide => Level::Product,
                Binary::Power => Level::Power,
                Binary::Min | Binary::Max | Binary::Hypot | Binary::Atan2 => Level::Atom,
                _ => Level::Comparison,
            },
        }
    }

    fn binary(&mut self, operation: Binary, a: Expression, b: Expression) {
        let infix = |left: Level, sign: &'static str, right: Level| {
            [Item::Node(a, left), Item::Text(sign), Item::Node(b, right)]
        };
        match operation {
            Binary::Add => self.push(infix(Level::Sum, " + ", Level::Product)),
            Binary::Subtract => self.push(infix(Level::Sum, " - ", Level::Product)),
            Binary::Multiply if self.style == Style::Plain => {
                self.push(infix(Level::Product, "*", Level::Power));
            }
            Binary::Multiply => {
                // `a/b c` could be read in two ways; `a (b c)` is as well written without parentheses.
                let left = if self.is(a, Binary::Divide) {
                    Level::Power
                } else {
                    Level::Product
                };
                let right = if self.is(b, Binary::Multiply) {
                    Level::Product
                } else {
                    Level::Power
                };
                self.push([Item::Node(a, left), Item::Joint, Item::Node(b, right)]);
            }
            Binary::Divide => self.push(infix(Level::Product, "/", Level::Power)),
            Binary::Power => match self.superscript(b) {
                Some(exponent) => {
                    self.push([Item::Node(a, Level::Atom), Item::Text(exponent)]);
                }
                None => self.push(infix(Level::Atom, "^", Level::Atom)),
            },
            Binary::Min | Binary::Max | Binary::Hypot | Binary::Atan2 => {
                let name = match operation {
                    Binary::Min => "min(",
                    Binary::Max => "max(",
                    Binary::Hypot => "hypot(",
                    _ => "atan2(",
                };
                let [a, b] = [a, b].map(|part| Item::Node(part, Level::Comparison));
                self.push([Item::Text(name), a, Item::Text(", "), b, Item::Text(")")]);
            }
            _ => {
                let sign = comparison(operation, self.style);
                self.push(infix(Level::Sum, sign, Level::Sum));
            }
        }
    }

    fn is(&self, expression: Expression, operation: Binary) -> bool {
        !self.names.contains_key(&expression)
            && matches!(self.graph.node(expression), Node::Binary(own, ..) if own == operation)
    }

    /// The exponent as a superscript, if it is a small integer and people are to read it.
    fn superscript(&self, exponent: Expression) -> Option<&'static str> {
        let value = self.graph.as_constant(exponent)?;
        (self.style == Style::Typeset)
            .then(|| style::superscript(value))
            .flatten()
    }
}

#[cfg(test)]
mod tests;
