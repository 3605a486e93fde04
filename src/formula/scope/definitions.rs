//! Named definitions: read in whatever order they need each other, circles refused.

use std::collections::HashMap;
use std::ops::Range;

use crate::formula::graph::{Expression, Graph};
use crate::formula::language::{FormulaError, Syntax, canonical_name, parse};

use super::meaning::{Meanings, names_in};
use super::symbols::Symbols;

/// What is wrong with a definition.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("definition `{name}`: {fault}")]
pub struct DefinitionError {
    /// The definition's name.
    pub name: String,
    /// What is wrong with it.
    pub fault: DefinitionFault,
}

/// What is wrong with a definition.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DefinitionFault {
    /// It is not a formula.
    #[error(transparent)]
    Formula(#[from] FormulaError),
    /// It needs itself.
    #[error("it needs itself: {}", .circle.join(" → "))]
    Circle {
        /// The names in the order in which they need each other; the first is also the last.
        circle: Vec<String>,
        /// Where in the definition's text the next of them stands.
        span: Range<usize>,
    },
}

impl DefinitionFault {
    /// Bytes of the definition's text.
    pub fn span(&self) -> Range<usize> {
        match self {
            Self::Formula(error) => error.span.clone(),
            Self::Circle { span, .. } => span.clone(),
        }
    }
}

/// A definition that has been parsed.
struct Parsed {
    syntax: Syntax,
    /// Definitions that it uses, each once, with a place where it is used.
    needs: Vec<(usize, Range<usize>)>,
}

/// The expressions of all definitions.
#[derive(Debug, Clone, Default)]
pub(super) struct Definitions {
    expressions: Vec<Expression>,
}

impl Definitions {
    pub(super) fn read(
        symbols: &Symbols,
        meanings: &mut Meanings,
        graph: &mut Graph,
    ) -> Result<Self, Vec<DefinitionError>> {
        let given = symbols.definitions();
        let numbers = given.iter().enumerate();
        let numbers: HashMap<String, usize> = numbers
            .map(|(number, (name, _))| (canonical_name(name), number))
            .collect();
        let mut errors = Vec::new();
        let mut parsed = Vec::new();
        for (name, text) in given {
            match parse(text) {
                Ok(syntax) => {
                    let needs = needs(&syntax, text, &numbers);
                    parsed.push(Some(Parsed { syntax, needs }));
                }
                Err(error) => {
                    let fault = meanings.explain(error).into();
                    errors.push(DefinitionError {
                        name: name.clone(),
                        fault,
                    });
                    parsed.push(None);
                }
            }
        }
        let order = order(symbols, &parsed, &mut errors);
        let mut expressions: Vec<Option<Expression>> = vec![None; given.len()];
        for number in order {
            let (Some(definition), Some((name, text))) = (&parsed[number], given.get(number))
            else {
                continue;
            };
            // What is wrong with a definition that it needs has been said.
            if definition
                .needs
                .iter()
                .any(|(needed, _)| expressions[*needed].is_none())
            {
                continue;
            }
            match meanings.expression(graph, &definition.syntax, text) {
                Ok(expression) => {
                    meanings.add_definition(name, expression);
                    expressions[number] = Some(expression);
                }
                Err(error) => {
                    errors.push(DefinitionError {
                        name: name.clone(),
                        fault: error.into(),
                    });
                }
            }
        }
        if !errors.is_empty() {
            return Err(errors);
        }
        Ok(Self {
            expressions: expressions.into_iter().flatten().collect(),
        })
    }

    pub(super) fn named<'a>(
        &'a self,
        symbols: &'a Symbols,
    ) -> impl Iterator<Item = (&'a str, Expression)> {
        let names = symbols.definitions().iter().map(|(name, _)| name.as_str());
        names.zip(self.expressions.iter().copied())
    }
}

fn needs(
    syntax: &Syntax,
    text: &str,
    numbers: &HashMap<String, usize>,
) -> Vec<(usize, Range<usize>)> {
    let mut needs: Vec<(usize, Range<usize>)> = Vec::new();
    let mut seen = std::collections::HashSet::new();
    for (name, span) in names_in(syntax, text) {
        if let Some(&number) = numbers.get(&canonical_name(name))
            && seen.insert(number)
        {
            needs.push((number, span));
        }
    }
    needs
}

/// How far a definition has been looked at.
#[derive(Clone, Copy, PartialEq)]
enum Visit {
    Unseen,
    OnPath,
    Done,
}

/// All definitions, each after those it needs. Circles are added to `errors`, each once.
fn order(
    symbols: &Symbols,
    parsed: &[Option<Parsed>],
    errors: &mut Vec<DefinitionError>,
) -> Vec<usize> {
    let mut progress = vec![Visit::Unseen; parsed.len()];
    let mut order = Vec::with_capacity(parsed.len());
    let needs_of = |number: usize| {
        parsed
            .get(number)
            .and_then(Option::as_ref)
            .map_or(&[][..], |parsed| &parsed.needs[..])
    };
    for start in 0..parsed.len() {
        if progress[start] != Visit::Unseen {
            continue;
        }
        // The path of definitions that are being looked at, each with the number of its next need.
        let mut path = vec![(start, 0)];
        progress[start] = Visit::OnPath;
        while let Some((number, next)) = path.last_mut() {
            let (number, needs) = (*number, needs_of(*number));
            let Some((needed, _)) = needs.get(*next) else {
                progress[number] = Visit::Done;
                order.push(number);
                path.pop();
                continue;
            };
            *next += 1;
            match progress[*needed] {
                Visit::Unseen => {
                    progress[*needed] = Visit::OnPath;
                    path.push((*needed, 0));
                }
                Visit::OnPath => errors.push(circle(symbols, parsed, &path, *needed)),
                Visit::Done => {}
            }
        }
    }
    order
}

/// The circle that closes when the last definition of the path needs `first`, which is on the path.
fn circle(
    symbols: &Symbols,
    parsed: &[Option<Parsed>],
    path: &[(usize, usize)],
    first: usize,
) -> DefinitionError {
    let name = |number: usize| symbols.definitions()[number].0.clone();
    let begin = path
        .iter()
        .position(|(number, _)| *number == first)
        .unwrap_or(0);
    let mut circle: Vec<String> = path[begin..]
        .iter()
        .map(|(number, _)| name(*number))
        .collect();
    circle.push(name(first));
    let second = path.get(begin + 1).map_or(first, |(number, _)| *number);
    let needs = parsed[first]
        .as_ref()
        .map_or(&[][..], |parsed| &parsed.needs[..]);
    let span = needs.iter().find(|(needed, _)| *needed == second);
    let span = span.map_or(0..0, |(_, span)| span.clone());
    let fault = DefinitionFault::Circle { circle, span };
    DefinitionError {
        name: name(first),
        fault,
    }
}
