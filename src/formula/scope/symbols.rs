//! The names of a system before anything is written with them.

use std::collections::HashMap;

use crate::formula::graph::Symbol;
use crate::formula::language::{Function, canonical_name, check_name};
use crate::formula::limits;

/// What a name is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// A coordinate of the state.
    State,
    /// A parameter.
    Parameter,
    /// A named definition.
    Definition,
}

impl Role {
    fn plural(self) -> &'static str {
        match self {
            Self::State => "states",
            Self::Parameter => "parameters",
            Self::Definition => "definitions",
        }
    }

    /// The role in words, with its article.
    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::State => "a state",
            Self::Parameter => "a parameter",
            Self::Definition => "a definition",
        }
    }
}

/// Why a name cannot be given.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SymbolError {
    /// Not a name.
    #[error(
        "`{name}` is not a name: names have Latin and Greek letters, digits and `_`, and begin with a letter"
    )]
    Malformed {
        /// What was given, shortened if it is long.
        name: String,
    },
    /// A name longer than `limits::NAME_LENGTH`.
    #[error(
        "a name of {length} characters; at most {} are allowed",
        limits::NAME_LENGTH
    )]
    Long {
        /// Its length in characters.
        length: usize,
    },
    /// A name that the language has for itself.
    #[error("`{name}` is {meaning} and cannot name anything else")]
    Reserved {
        /// The name.
        name: String,
        /// What it is.
        meaning: &'static str,
    },
    /// A name given twice.
    #[error("`{name}` is already {}{}", .role.words(), spelling(.name, .first))]
    Taken {
        /// The name as given now.
        name: String,
        /// The name as given first, which may be spelled in another way.
        first: String,
        /// What it was given to first.
        role: Role,
    },
    /// More names of one kind than allowed.
    #[error("there are more than {most} {}", .role.plural())]
    TooMany {
        /// What they are.
        role: Role,
        /// How many are allowed.
        most: usize,
    },
    /// Definitions longer than `limits::DEFINITION_BYTES` together.
    #[error(
        "the definitions have more than {} bytes together",
        limits::DEFINITION_BYTES
    )]
    LongDefinitions,
}

fn spelling(name: &str, first: &str) -> String {
    if name == first {
        String::new()
    } else {
        format!(" (spelled `{first}`)")
    }
}

/// States, parameters and definitions by name.
#[derive(Debug, Clone, Default)]
pub struct Symbols {
    states: Vec<String>,
    parameters: Vec<String>,
    definitions: Vec<(String, String)>,
    definition_bytes: usize,
    taken: HashMap<String, (Role, String)>,
}

impl Symbols {
    /// Coordinates and parameters of these names.
    #[cfg(test)]
    pub(in crate::formula) fn of(states: &[&str], parameters: &[&str]) -> Self {
        let mut symbols = Self::default();
        for name in states {
            symbols.add_state(name).unwrap();
        }
        for name in parameters {
            symbols.add_parameter(name).unwrap();
        }
        symbols
    }

    /// Adds a coordinate of the state; they are numbered in the order in which they are added.
    ///
    /// # Errors
    /// Why the name cannot be given.
    pub fn add_state(&mut self, name: &str) -> Result<Symbol, SymbolError> {
        self.take(name, Role::State, self.states.len(), limits::STATES)?;
        self.states.push(name.to_owned());
        Ok(Symbol::State(self.states.len() - 1))
    }

    /// Adds a coordinate of the state that no formula can name; it is shown as this.
    pub(crate) fn add_unnamed_state(&mut self, shown: &str) -> Symbol {
        self.states.push(shown.to_owned());
        Symbol::State(self.states.len() - 1)
    }

    /// Adds a parameter; they are numbered in the order in which they are added.
    ///
    /// # Errors
    /// Why the name cannot be given.
    pub fn add_parameter(&mut self, name: &str) -> Result<Symbol, SymbolError> {
        self.take(
            name,
            Role::Parameter,
            self.parameters.len(),
            limits::PARAMETERS,
        )?;
        self.parameters.push(name.to_owned());
        Ok(Symbol::Parameter(self.parameters.len() - 1))
    }

    /// Gives a formula a name. The formula is read by [`Scope::new`](super::Scope::new).
    ///
    /// # Errors
    /// Why the name cannot be given.
    pub fn define(&mut self, name: &str, formula: &str) -> Result<(), SymbolError> {
        let bytes = self.definition_bytes.saturating_add(formula.len());
        if bytes > limits::DEFINITION_BYTES {
            return Err(SymbolError::LongDefinitions);
        }
        self.take(
            name,
            Role::Definition,
            self.definitions.len(),
            limits::DEFINITIONS,
        )?;
        self.definition_bytes = bytes;
        self.definitions.push((name.to_owned(), formula.to_owned()));
        Ok(())
    }

    /// Names of the states, as given.
    pub(crate) fn states(&self) -> &[String] {
        &self.states
    }

    /// Names of the parameters, as given.
    pub(crate) fn parameters(&self) -> &[String] {
        &self.parameters
    }

    /// Names and formulas of the definitions, as given.
    pub(crate) fn definitions(&self) -> &[(String, String)] {
        &self.definitions
    }

    /// The name of a symbol, as given.
    pub(crate) fn name(&self, symbol: Symbol) -> &str {
        let name = match symbol {
            Symbol::State(state) => self.states.get(state),
            Symbol::Parameter(number) => self.parameters.get(number),
            Symbol::Time => return TIME,
        };
        name.map_or("?", String::as_str)
    }

    /// What a name was given to.
    pub(super) fn role(&self, canonical: &str) -> Option<Role> {
        self.taken.get(canonical).map(|(role, _)| *role)
    }

    fn take(
        &mut self,
        name: &str,
        role: Role,
        count: usize,
        most: usize,
    ) -> Result<(), SymbolError> {
        let length = name.chars().count();
        if length > limits::NAME_LENGTH {
            return Err(SymbolError::Long { length });
        }
        if !check_name(name) {
            return Err(SymbolError::Malformed {
                name: name.to_owned(),
            });
        }
        let canonical = canonical_name(name);
        if let Some(meaning) = reservation(&canonical) {
            return Err(SymbolError::Reserved {
                name: name.to_owned(),
                meaning,
            });
        }
        if let Some((role, first)) = self.taken.get(&canonical) {
            let (name, first) = (name.to_owned(), first.clone());
            return Err(SymbolError::Taken {
                name,
                first,
                role: *role,
            });
        }
        if count >= most {
            return Err(SymbolError::TooMany { role, most });
        }
        self.taken.insert(canonical, (role, name.to_owned()));
        Ok(())
    }
}

/// The name of time.
pub(super) const TIME: &str = "t";

/// Names that cannot be given. The constants `pi` and `e` can.
fn reservation(canonical: &str) -> Option<&'static str> {
    if canonical == TIME {
        Some("time")
    } else if canonical == "if" {
        Some("a choice by comparison")
    } else {
        Function::named(canonical).map(|_| "a function")
    }
}
