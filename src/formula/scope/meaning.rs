//! From names to expressions.

use std::collections::HashMap;

use crate::formula::arithmetic::{Binary, Unary};
use crate::formula::graph::{Builder, Expression, Graph, Symbol};
use crate::formula::language::{
    Fault, FormulaError, Function, Known, Operator, Syntax, SyntaxKind, canonical_name, nearest,
};
use crate::formula::limits;

use super::symbols::{Symbols, TIME};

/// Numbers that have a name unless the name is given to something else.
const CONSTANTS: [(&str, f64); 2] = [("pi", std::f64::consts::PI), ("e", std::f64::consts::E)];
/// How many names of a kind a message lists.
const LISTED: usize = 20;

/// What a name stands for.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Meaning {
    Symbol(Symbol),
    Definition(Expression),
    Constant(f64),
}

/// What every name stands for, by canonical name. Definitions are added as they are read.
#[derive(Debug, Clone)]
pub(super) struct Meanings {
    by_name: HashMap<String, Meaning>,
    symbols: Symbols,
}

impl Meanings {
    pub(super) fn new(symbols: &Symbols) -> Self {
        let mut by_name = HashMap::new();
        for (name, value) in CONSTANTS {
            by_name.insert(name.to_owned(), Meaning::Constant(value));
        }
        by_name.insert(TIME.to_owned(), Meaning::Symbol(Symbol::Time));
        for (state, name) in symbols.states().iter().enumerate() {
            by_name.insert(canonical_name(name), Meaning::Symbol(Symbol::State(state)));
        }
        for (number, name) in symbols.parameters().iter().enumerate() {
            by_name.insert(
                canonical_name(name),
                Meaning::Symbol(Symbol::Parameter(number)),
            );
        }
        // A definition hides a constant even before it is read.
        for (name, _) in symbols.definitions() {
            by_name.remove(&canonical_name(name));
        }
        Self {
            by_name,
            symbols: symbols.clone(),
        }
    }

    pub(super) fn add_definition(&mut self, name: &str, expression: Expression) {
        self.by_name
            .insert(canonical_name(name), Meaning::Definition(expression));
    }

    pub(super) fn symbol(&self, name: &str) -> Option<Symbol> {
        match self.by_name.get(&canonical_name(name)) {
            Some(&Meaning::Symbol(symbol)) => Some(symbol),
            _ => None,
        }
    }

    pub(super) fn definition(&self, name: &str) -> Option<Expression> {
        match self.by_name.get(&canonical_name(name)) {
            Some(&Meaning::Definition(expression)) => Some(expression),
            _ => None,
        }
    }

    /// The expression of a formula whose names are all known.
    pub(super) fn expression(
        &self,
        graph: &mut Graph,
        syntax: &Syntax,
        text: &str,
    ) -> Result<Expression, FormulaError> {
        let mut names = Vec::new();
        for node in &syntax.nodes {
            if let SyntaxKind::Name(start, end) = node.kind {
                let span = start as usize..end as usize;
                let name = &text[span.clone()];
                let meaning = self.by_name.get(&canonical_name(name));
                names.push(*meaning.ok_or_else(|| self.unknown(name, span))?);
            }
        }
        let built = graph.build(|builder| lower(builder, syntax, &names));
        built.map_err(|_| FormulaError::new(0..text.len(), Fault::TooLarge))
    }

    /// The fault of a name that nothing defines.
    pub(super) fn unknown(&self, name: &str, span: std::ops::Range<usize>) -> FormulaError {
        let (mut known, mut all) = (Known::default(), Known::default());
        for name in self.names().chain([TIME]) {
            known.add(name);
            all.add(name);
        }
        CONSTANTS.iter().for_each(|(name, _)| all.add(name));
        Function::names().for_each(|name| all.add(name));
        let fault = Fault::Symbol {
            name: name.to_owned(),
            nearest: all.nearest(name),
            product: known.product(name),
            known: self.names_in_words(),
        };
        FormulaError::new(span, fault)
    }

    fn names(&self) -> impl Iterator<Item = &str> {
        let states = self.symbols.states().iter().map(String::as_str);
        let parameters = self.symbols.parameters().iter().map(String::as_str);
        let definitions = self
            .symbols
            .definitions()
            .iter()
            .map(|(name, _)| name.as_str());
        states.chain(parameters).chain(definitions)
    }

    fn names_in_words(&self) -> String {
        let definitions: Vec<String> = self
            .symbols
            .definitions()
            .iter()
            .map(|(name, _)| name.clone())
            .collect();
        let mut words = Vec::new();
        for (kind, names) in [
            ("states", self.symbols.states()),
            ("parameters", self.symbols.parameters()),
            ("definitions", &definitions[..]),
        ] {
            if names.is_empty() {
                continue;
            }
            let listed = names
                .iter()
                .take(LISTED)
                .cloned()
                .collect::<Vec<_>>()
                .join(", ");
            let more = if names.len() > LISTED { ", …" } else { "" };
            words.push(format!("{kind} {listed}{more}"));
        }
        words.push("time t".to_owned());
        words.push("constants pi, e".to_owned());
        words.join("; ")
    }

    /// A fault of the grammar, with what is known of names.
    pub(super) fn explain(&self, error: FormulaError) -> FormulaError {
        let Fault::NotAFunction { name, .. } = error.fault else {
            return error;
        };
        let canonical = canonical_name(&name);
        let is = match self.by_name.get(&canonical) {
            Some(Meaning::Constant(_)) => Some("a constant"),
            Some(Meaning::Symbol(Symbol::Time)) => Some("time"),
            _ => self.symbols.role(&canonical).map(super::Role::words),
        };
        let nearest = nearest(&name, Function::names()).map(str::to_owned);
        FormulaError::new(error.span, Fault::NotAFunction { name, is, nearest })
    }
}

/// Builds the expression; `names` has the meanings of the names in their order.
fn lower(builder: &mut Builder<'_>, syntax: &Syntax, names: &[Meaning]) -> Expression {
    let mut names = names.iter();
    let mut made: Vec<Expression> = Vec::with_capacity(syntax.nodes.len());
    let zero = builder.constant(0.0);
    for node in &syntax.nodes {
        let of = |node: u32| made.get(node as usize).copied().unwrap_or(zero);
        let expression = match node.kind {
            SyntaxKind::Number(value) => builder.constant(value),
            SyntaxKind::Name(..) => match names.next() {
                Some(&Meaning::Symbol(symbol)) => builder.symbol(symbol),
                Some(&Meaning::Definition(expression)) => expression,
                Some(&Meaning::Constant(value)) => builder.constant(value),
                None => zero,
            },
            SyntaxKind::Negate(inner) => builder.negate(of(inner)),
            SyntaxKind::Binary(operator, left, right) => {
                binary(builder, operator, of(left), of(right))
            }
            SyntaxKind::Call(function, first, count) => {
                let arguments = syntax.arguments_of(first, count).iter();
                let arguments: Vec<Expression> = arguments.map(|&node| of(node)).collect();
                call(builder, function, &arguments).unwrap_or(zero)
            }
        };
        made.push(expression);
    }
    made.last().copied().unwrap_or(zero)
}

fn binary(
    builder: &mut Builder<'_>,
    operator: Operator,
    left: Expression,
    right: Expression,
) -> Expression {
    match operator {
        Operator::Add => builder.add(left, right),
        Operator::Subtract => builder.subtract(left, right),
        Operator::Multiply => builder.multiply(left, right),
        Operator::Divide => builder.divide(left, right),
        Operator::Power => builder.power(left, right),
        Operator::Less => builder.binary(Binary::Less, left, right),
        Operator::LessOrEqual => builder.binary(Binary::LessOrEqual, left, right),
        Operator::Greater => builder.binary(Binary::Less, right, left),
        Operator::GreaterOrEqual => builder.binary(Binary::LessOrEqual, right, left),
        Operator::Equal => builder.binary(Binary::Equal, left, right),
        Operator::NotEqual => builder.binary(Binary::NotEqual, left, right),
    }
}

/// The grammar has counted the arguments.
fn call(builder: &mut Builder<'_>, function: Function, of: &[Expression]) -> Option<Expression> {
    let unary = match function {
        Function::Sin => Unary::Sin,
        Function::Cos => Unary::Cos,
        Function::Tan => Unary::Tan,
        Function::Asin => Unary::Asin,
        Function::Acos => Unary::Acos,
        Function::Atan => Unary::Atan,
        Function::Sinh => Unary::Sinh,
        Function::Cosh => Unary::Cosh,
        Function::Tanh => Unary::Tanh,
        Function::Exp => Unary::Exp,
        Function::Log => Unary::Log,
        Function::Log10 => Unary::Log10,
        Function::Sqrt => Unary::Sqrt,
        Function::Cbrt => Unary::Cbrt,
        Function::Abs => Unary::Abs,
        Function::Sign => Unary::Sign,
        Function::Step => Unary::Step,
        Function::Floor => Unary::Floor,
        Function::Min => return folded(builder, Binary::Min, of),
        Function::Max => return folded(builder, Binary::Max, of),
        Function::Hypot => return folded(builder, Binary::Hypot, of),
        Function::Atan2 => return folded(builder, Binary::Atan2, of),
        Function::Pow => return folded(builder, Binary::Power, of),
        Function::If => {
            let &[condition, yes, no] = of else {
                return None;
            };
            return Some(builder.select(condition, yes, no));
        }
    };
    Some(builder.unary(unary, *of.first()?))
}

fn folded(builder: &mut Builder<'_>, operation: Binary, of: &[Expression]) -> Option<Expression> {
    let (&first, rest) = of.split_first()?;
    Some(
        rest.iter()
            .fold(first, |value, &next| builder.binary(operation, value, next)),
    )
}

/// Names in a formula that stand for definitions are looked up by these.
pub(super) fn names_in<'a>(
    syntax: &'a Syntax,
    text: &'a str,
) -> impl Iterator<Item = (&'a str, std::ops::Range<usize>)> + 'a {
    let name = |kind: SyntaxKind| match kind {
        SyntaxKind::Name(start, end) => Some(start as usize..end as usize),
        _ => None,
    };
    let spans = syntax.nodes.iter().filter_map(move |node| name(node.kind));
    spans
        .map(|span| (&text[span.clone()], span))
        .take(limits::FORMULA_BYTES)
}
