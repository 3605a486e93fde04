//! Names of axes, observables and the swept parameter, for files and for LaTeX.

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

impl Naming<'_> {
    /// Name of an axis, for example `y`.
    pub fn axis(&self, axis: usize) -> &'static str {
        self.model.axes.get(axis).map_or("?", |axis| axis.name)
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
            .map_or(self.parameter, |parameter| parameter.symbol)
    }

    /// The swept parameter as LaTeX mathematics, for example `f_{c}` or `\alpha`.
    pub fn parameter_latex(&self) -> String {
        latex(self.parameter_symbol())
    }

    /// An observable as LaTeX mathematics, for example `(x, \dot{x})`.
    pub fn observable_latex(&self, observable: Observable) -> String {
        let symbol = |axis: usize| {
            self.model
                .axes
                .get(axis)
                .map_or("?".into(), |a| latex(a.symbol))
        };
        match observable {
            Observable::Marginal(axis) => symbol(axis),
            Observable::Joint(first, second) => format!("({}, {})", symbol(first), symbol(second)),
        }
    }
}

/// Greek letters and dotted letters as LaTeX commands.
fn latex(symbol: &str) -> String {
    const COMMANDS: &[(char, &str)] = &[
        ('α', "\\alpha"),
        ('β', "\\beta"),
        ('γ', "\\gamma"),
        ('δ', "\\delta"),
        ('ε', "\\varepsilon"),
        ('ζ', "\\zeta"),
        ('η', "\\eta"),
        ('θ', "\\theta"),
        ('κ', "\\kappa"),
        ('λ', "\\lambda"),
        ('μ', "\\mu"),
        ('ν', "\\nu"),
        ('ξ', "\\xi"),
        ('ρ', "\\rho"),
        ('σ', "\\sigma"),
        ('τ', "\\tau"),
        ('φ', "\\varphi"),
        ('ω', "\\omega"),
        ('ẋ', "\\dot{x}"),
        ('ẏ', "\\dot{y}"),
        ('ż', "\\dot{z}"),
    ];
    let command = |letter: char| {
        let known = COMMANDS.iter().find(|(known, _)| *known == letter);
        known.map_or(letter.to_string(), |(_, command)| (*command).to_owned())
    };
    symbol.chars().map(command).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::registry;

    #[test]
    fn names_and_symbols_of_the_coulomb_model() {
        let naming = Naming {
            model: registry::find("coulomb").unwrap(),
            parameter: "f_c",
        };
        assert_eq!(naming.observable(Observable::Joint(0, 1)), "xy");
        assert_eq!(naming.parameter_latex(), "f_{c}");
        assert_eq!(
            naming.observable_latex(Observable::Joint(0, 1)),
            "(x, \\dot{x})"
        );
        assert_eq!(latex("σ^{2}"), "\\sigma^{2}");
    }
}
