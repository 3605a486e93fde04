//! Names of axes, observables and the swept parameter, for files and for LaTeX.

use super::latex::mathematics;
use crate::density::Observable;
use crate::system::Model;

/// Turns axes and observables of a model into the words of the tables.
#[derive(Debug, Clone, Copy)]
pub struct Naming<'a> {
    /// The model whose names are used.
    pub model: &'a Model,
    /// The swept parameter.
    pub parameter: &'a str,
}

impl<'a> Naming<'a> {
    /// Name of an axis, for example `y`.
    pub fn axis(&self, axis: usize) -> &'a str {
        self.model
            .axes
            .get(axis)
            .map_or("?", |axis| axis.name.as_str())
    }

    /// Name of an observable: the names of its axes run together, for example `xy`.
    pub fn observable(&self, observable: Observable) -> String {
        match observable {
            Observable::Marginal(axis) => self.axis(axis).to_owned(),
            Observable::Joint(first, second) => {
                format!("{}{}", self.axis(first), self.axis(second))
            }
        }
    }

    /// Symbol of the swept parameter with `_{}` and `^{}`; its name where the model knows none.
    pub fn parameter_symbol(&self) -> &str {
        let parameters = self.model.parameters.iter();
        parameters
            .clone()
            .find(|parameter| parameter.name == self.parameter)
            .map_or(self.parameter, |parameter| &parameter.symbol)
    }

    /// The swept parameter as LaTeX mathematics, for example `f_{c}` or `\alpha`.
    pub fn parameter_latex(&self) -> String {
        mathematics(self.parameter_symbol())
    }

    /// An observable as LaTeX mathematics, for example `(x, \dot{x})`.
    pub fn observable_latex(&self, observable: Observable) -> String {
        let symbol = |axis: usize| {
            self.model
                .axes
                .get(axis)
                .map_or("?".into(), |axis| mathematics(&axis.symbol))
        };
        match observable {
            Observable::Marginal(axis) => symbol(axis),
            Observable::Joint(first, second) => format!("({}, {})", symbol(first), symbol(second)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::registry;

    #[test]
    fn names_and_symbols_of_the_coulomb_model() {
        let naming = Naming {
            model: &registry::find("coulomb").unwrap(),
            parameter: "f_c",
        };
        assert_eq!(naming.observable(Observable::Joint(0, 1)), "xy");
        assert_eq!(naming.parameter_latex(), "f_{c}");
        assert_eq!(
            naming.observable_latex(Observable::Joint(0, 1)),
            "(x, \\dot{x})"
        );
    }

    #[test]
    fn every_symbol_of_every_model_is_mathematics_that_compiles() {
        for model in registry::models() {
            for parameter in &model.parameters {
                let parameter = &parameter.name;
                let naming = Naming { model, parameter };
                let text = naming.parameter_latex();
                assert!(
                    text.is_ascii() && !text.contains(['$', '%', '&', '#']),
                    "{text}"
                );
                assert_eq!(
                    text.matches('{').count(),
                    text.matches('}').count(),
                    "{text}"
                );
                // One subscript at most, for two in a row are an error.
                assert!(text.matches('_').count() <= 1, "{text}");
            }
            for axis in 0..model.axes.len() {
                let text = Naming {
                    model,
                    parameter: "",
                }
                .observable_latex(Observable::Marginal(axis));
                assert!(text.is_ascii(), "{text}");
            }
        }
    }
}
