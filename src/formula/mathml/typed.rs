//! The layout of a formula from its syntax tree.

use super::LONGEST;
use super::part::{Fence, Part};
use crate::formula::language::{FormulaError, Function, Operator, Syntax, SyntaxKind};

/// Lays a parsed formula out; one that is very long or deep stays the text that it is.
pub(super) fn lay_out(text: &str, syntax: &Syntax) -> Result<Part, FormulaError> {
    let as_it_is = || Part::words(text.trim());
    if text.len() > LONGEST {
        return Ok(as_it_is());
    }
    // Children stand before their parents, and each has one parent that takes it.
    let mut made: Vec<Option<Part>> = Vec::with_capacity(syntax.nodes.len());
    for node in &syntax.nodes {
        let part = lay_out_node(text, syntax, node.kind, &mut made);
        let Some(part) = part.filter(|part| !part.is_too_deep()) else {
            return Ok(as_it_is());
        };
        made.push(Some(part));
    }
    Ok(made.pop().flatten().unwrap_or_else(as_it_is))
}

fn lay_out_node(
    text: &str,
    syntax: &Syntax,
    kind: SyntaxKind,
    made: &mut [Option<Part>],
) -> Option<Part> {
    let mut of = |node: u32| made.get_mut(node as usize).and_then(Option::take);
    Some(match kind {
        SyntaxKind::Number(value) => Part::number(value),
        SyntaxKind::Name(start, end) => Part::name(text.get(start as usize..end as usize)?),
        SyntaxKind::Negate(inner) => of(inner)?.negated(),
        SyntaxKind::Binary(operator, left, right) => {
            let (left, right) = (of(left)?, of(right)?);
            binary(operator, left, right)
        }
        SyntaxKind::Call(function, first, count) => {
            let arguments = syntax.arguments_of(first, count).iter();
            let arguments: Option<Vec<Part>> = arguments.map(|&node| of(node)).collect();
            call(function, arguments?)?
        }
    })
}

fn binary(operator: Operator, left: Part, right: Part) -> Part {
    match operator {
        Operator::Add => left.plus(right),
        Operator::Subtract => left.minus(right),
        Operator::Multiply => left.times(right),
        Operator::Divide => left.over(right),
        Operator::Power => left.raise(right),
        Operator::Less => left.relate("<", right),
        Operator::LessOrEqual => left.relate("≤", right),
        Operator::Greater => left.relate(">", right),
        Operator::GreaterOrEqual => left.relate("≥", right),
        Operator::Equal => left.relate("=", right),
        Operator::NotEqual => left.relate("≠", right),
    }
}

fn call(function: Function, arguments: Vec<Part>) -> Option<Part> {
    let name = match function {
        Function::If => {
            let [condition, yes, no] = <[Part; 3]>::try_from(arguments).ok()?;
            return Some(Part::cases(condition, yes, no));
        }
        Function::Pow | Function::Hypot => {
            let [a, b] = <[Part; 2]>::try_from(arguments).ok()?;
            let squared = |one: Part| one.raise(Part::number(2.0));
            return Some(match function {
                Function::Pow => a.raise(b),
                _ => squared(a).plus(squared(b)).root(None),
            });
        }
        Function::Sqrt => return Some(sole(arguments)?.root(None)),
        Function::Cbrt => return Some(sole(arguments)?.root(Some("3"))),
        Function::Abs => return Some(sole(arguments)?.between(Fence::Bars)),
        Function::Floor => return Some(sole(arguments)?.between(Fence::Floor)),
        Function::Sign => "sgn",
        Function::Log => "ln",
        Function::Log10 => "log_10",
        Function::Asin => "arcsin",
        Function::Acos => "arccos",
        Function::Atan => "arctan",
        other => other.name(),
    };
    Some(Part::name(name).call(arguments))
}

fn sole(arguments: Vec<Part>) -> Option<Part> {
    arguments.into_iter().next()
}
