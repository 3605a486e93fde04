//! Equations as lines of text and as their layouts: what a model shows of itself.

use super::{Interpretation, TypedModel};
use crate::formula::mathml::{self, Element};

/// Name of the amplitude of the noise of built-in models, the root of their parameter σ². That it is so goes without
/// saying in what they show.
pub(in crate::system) const AMPLITUDE: &str = "σ";

/// A line of a model's equations, and the same typeset.
pub(in crate::system) type Statement = (String, Element);

/// `left = right + amplitude noise(t) + …`; left may be a name with primes, and another relation stand between.
pub(in crate::system) fn equation(
    left: &str,
    relation: &str,
    right: &str,
    noises: &[(String, String)],
) -> Statement {
    let mut line = format!("{left} {relation} {right}");
    for (amplitude, noise) in noises {
        line.push_str(&format!(" + {amplitude} {noise}(t)"));
    }
    let layout = mathml::equation(left, relation, right, noises);
    let layout = layout.unwrap_or_else(|_| mathml::words(&line));
    (line, layout)
}

/// That noises are white and of unit intensity: of one noise, or of `several` that are independent; with how they are
/// read.
pub(in crate::system) fn white(noise: &str, several: bool, lag: &str, read: &str) -> Statement {
    let (names, delta) = if several {
        ([format!("{noise}_i"), format!("{noise}_j")], "δ_ij ")
    } else {
        ([noise.to_owned(), noise.to_owned()], "")
    };
    let [one, other] = &names;
    let line = format!("E[{one}(t) {other}(t+{lag})] = {delta}δ({lag}){read}");
    let layout = mathml::correlation([one, other], delta.trim_end(), lag, read);
    (line, layout)
}

/// The line with absolute values between bars.
pub(super) fn with_bars(mut statement: Statement) -> Statement {
    let line = &mut statement.0;
    while let Some(begin) = line.find("abs(") {
        let mut depth = 0;
        let end = line[begin..].find(|c| {
            depth += i32::from(c == '(') - i32::from(c == ')');
            c == ')' && depth == 0
        });
        let Some(length) = end else { break };
        line.replace_range(begin + length..=begin + length, "|");
        line.replace_range(begin..begin + "abs(".len(), "|");
    }
    statement
}

impl TypedModel {
    /// The equations axis by axis, the definitions, and what the noises are.
    pub(super) fn statements(&self) -> Vec<Statement> {
        let mut statements = Vec::new();
        for axis in &self.axes {
            let own = self.equations.iter().filter(|(name, _)| *name == axis.name);
            for (name, drift) in own {
                let left = format!("{name}'");
                statements.push(equation(&left, "=", drift, &self.noises_of(name)));
            }
        }
        for (name, formula) in &self.definitions {
            if !self.is_compiled() || name != AMPLITUDE {
                statements.push(equation(name, "=", formula, &[]));
            }
        }
        if self.is_compiled() {
            // Bounds that are alike on both sides.
            let bounds = self.bounds.iter();
            let alike = bounds.filter(|(_, lower, upper)| lower.strip_prefix('-') == Some(upper));
            statements.extend(
                alike.map(|(name, _, upper)| equation(&format!("abs({name})"), "≤", upper, &[])),
            );
            statements = statements.into_iter().map(with_bars).collect();
        }
        if !self.processes.is_empty() {
            let read = match self.interpretation {
                Some(Interpretation::Ito) => ", read as Itô",
                Some(Interpretation::Stratonovich) => ", read as Stratonovich",
                None => "",
            };
            statements.push(white("ξ", !self.is_compiled(), "τ", read));
        }
        statements
    }

    /// Amplitudes and names of the noises on an axis, as they are shown.
    fn noises_of(&self, axis: &str) -> Vec<(String, String)> {
        let processes = self.processes.iter().enumerate();
        let noises = processes.flat_map(|(number, process)| {
            let driven = process.iter().filter(|(driven, _)| driven == axis);
            driven.map(move |(_, amplitude)| {
                if self.is_compiled() {
                    (amplitude.clone(), "ξ".to_owned())
                } else {
                    (format!("({amplitude})"), format!("ξ_{}", number + 1))
                }
            })
        });
        noises.collect()
    }
}
