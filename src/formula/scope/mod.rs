//! What names mean: states, parameters, time, constants, and named definitions that may use each other.

mod definitions;
mod meaning;
mod symbols;

use crate::formula::graph::{Expression, Graph, Symbol};
use crate::formula::language::{FormulaError, parse};

use definitions::Definitions;
use meaning::Meanings;

pub use definitions::{DefinitionError, DefinitionFault};
pub use symbols::{Role, SymbolError, Symbols};

/// The symbols of a system, its definitions, and the graph of everything written with them.
#[derive(Debug, Clone)]
pub struct Scope {
    symbols: Symbols,
    meanings: Meanings,
    definitions: Definitions,
    graph: Graph,
}

impl Scope {
    /// Reads all definitions, in whatever order they use each other.
    ///
    /// # Errors
    /// Everything that is wrong with them, each once: what is not a formula, and circles.
    pub fn new(symbols: Symbols) -> Result<Self, Vec<DefinitionError>> {
        let mut graph = Graph::default();
        let mut meanings = Meanings::new(&symbols);
        let definitions = Definitions::read(&symbols, &mut meanings, &mut graph)?;
        Ok(Self {
            symbols,
            meanings,
            definitions,
            graph,
        })
    }

    /// Reads a formula.
    ///
    /// # Errors
    /// What is wrong with it, and where.
    ///
    /// ```
    /// use pbif::formula::scope::{Scope, Symbols};
    ///
    /// let mut symbols = Symbols::default();
    /// symbols.add_parameter("kappa")?;
    /// let mut scope = Scope::new(symbols).map_err(|errors| errors[0].clone())?;
    /// let error = scope.formula("2 kapa + 1").unwrap_err();
    /// assert_eq!(error.span, 2..6);
    /// assert_eq!(error.to_string(), "unknown symbol `kapa`");
    /// assert_eq!(error.remedy().as_deref(), Some("did you mean `kappa`?"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn formula(&mut self, text: &str) -> Result<Expression, FormulaError> {
        let syntax = parse(text).map_err(|error| self.meanings.explain(error))?;
        self.meanings.expression(&mut self.graph, &syntax, text)
    }

    /// The symbol of a name in any spelling. Definitions and constants are not symbols.
    pub fn symbol(&self, name: &str) -> Option<Symbol> {
        self.meanings.symbol(name)
    }

    /// The expression of a definition.
    pub fn definition(&self, name: &str) -> Option<Expression> {
        self.meanings.definition(name)
    }

    /// Names of the definitions with their expressions, in the order in which they were given.
    pub(crate) fn definitions(&self) -> impl Iterator<Item = (&str, Expression)> {
        self.definitions.named(&self.symbols)
    }

    /// All names that were given.
    pub(crate) fn symbols(&self) -> &Symbols {
        &self.symbols
    }

    /// Adds a coordinate of the state that no formula can name, such as the phase of a forcing.
    pub(crate) fn add_state(&mut self, shown: &str) -> Symbol {
        self.symbols.add_unnamed_state(shown)
    }

    /// The graph of all expressions.
    pub fn graph(&self) -> &Graph {
        &self.graph
    }

    /// The graph, to derive new expressions.
    pub fn graph_mut(&mut self) -> &mut Graph {
        &mut self.graph
    }
}

#[cfg(test)]
mod tests;
