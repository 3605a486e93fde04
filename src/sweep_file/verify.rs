//! What is tried of a file's own equations once the domain is known: whether every formula is finite on it, and whether
//! what was read off the formulas holds.

use super::diagnostic::Diagnostic;
use super::document::Document;
use super::report::Report;
use super::settings::{AxisSettings, Settings, at_cells, formula_place};
use crate::system::contract::{self, ContractViolation, Quantity};
use crate::system::{FormulaHazard, FormulaPlace, TypedEquations};

impl Settings {
    /// Refuses equations that are not finite somewhere on the domain, at some value along the sweep, and declarations
    /// that do not hold. Built-in models are tried in their tests.
    ///
    /// # Errors
    /// A report with a state at which it shows.
    pub(super) fn check_equations(&self) -> Result<(), Report> {
        let Some(typed) = self.family.model().typed() else {
            return Ok(());
        };
        let ranges: Option<Vec<(f64, f64)>> = self.axes.iter().map(AxisSettings::range).collect();
        let Some(ranges) = ranges else {
            return Ok(());
        };
        self.check_finite(typed, &ranges, "on the domain")?;
        self.check_contract(&ranges)
    }

    /// Refuses formulas that are not finite somewhere in a box of states.
    pub(super) fn check_finite(
        &self,
        typed: &TypedEquations,
        ranges: &[(f64, f64)],
        which: &str,
    ) -> Result<(), Report> {
        let hazards = typed.hazards(ranges, &self.parameter_ranges());
        let mut shown: Vec<FormulaPlace> = Vec::new();
        let mut found = Vec::new();
        for hazard in hazards.iter().filter(|hazard| hazard.certain) {
            if !shown.contains(&hazard.place) {
                shown.push(hazard.place.clone());
                found.push(self.not_finite(hazard, which));
            }
        }
        if found.is_empty() {
            Ok(())
        } else {
            Err(Report::new(self.document.sources.clone(), found, 0))
        }
    }

    /// What each parameter takes along the sweep.
    fn parameter_ranges(&self) -> Vec<(f64, f64)> {
        let corners = self.corners();
        let (Some(first), Some(last)) = (corners.first(), corners.last()) else {
            return Vec::new();
        };
        let pairs = first.as_slice().iter().zip(last.as_slice());
        pairs.map(|(&a, &b)| (a, b)).collect()
    }

    fn not_finite(&self, hazard: &FormulaHazard, which: &str) -> Diagnostic {
        let axes = hazard.state.iter().enumerate();
        let axes = axes.map(|(axis, value)| (self.family.axis(axis), *value));
        let swept = self.family.parameter();
        let all = self.family.model().parameters.iter();
        let own = hazard.of_parameters.as_deref();
        let parameters = all.zip(&hazard.parameters).enumerate();
        let parameters = parameters.filter(|(number, (parameter, _))| match own {
            Some(own) => own.contains(number),
            None => parameter.name == swept,
        });
        let parameters = parameters.map(|(_, (one, value))| (one.name.as_str(), *value));
        let parameters: Vec<(&str, f64)> = parameters.collect();
        let values: Vec<String> = axes
            .filter(|_| own.is_none())
            .chain(parameters.iter().copied())
            .map(|(name, value)| format!("{name} = {}", short(value)))
            .collect();
        let (which, remedy) = match own {
            None => (
                format!(" {which}"),
                "change the formula, or leave that state out by `from` and `to` in [cells]"
                    .to_owned(),
            ),
            Some(_) => (String::new(), self.remedy_of_parameters(&parameters)),
        };
        let title = format!(
            "{} is not finite{which}: {} in {} at {}",
            hazard.place,
            hazard.kind.words(),
            hazard.part,
            values.join(", ")
        );
        let diagnostic = Diagnostic::new(title)
            .allowed("formulas that are finite for every state of the domain and every value of the sweep")
            .remedy(remedy);
        let place = formula_place(&self.document, &self.draft().equations, &hazard.place);
        diagnostic.at(place.as_ref(), hazard.kind.words())
    }

    /// What helps where parameters alone make a formula fail: the keys that give them their values.
    fn remedy_of_parameters(&self, parameters: &[(&str, f64)]) -> String {
        let map = self.map.as_ref();
        let key = |(name, _): &(&str, f64)| match map {
            _ if *name == self.family.parameter() => "`sweep.from` and `sweep.to`".to_owned(),
            Some(map) if *name == map.parameter => "`map.from` and `map.to`".to_owned(),
            _ => format!("`system.parameters.{name}`"),
        };
        let keys: Vec<String> = parameters.iter().map(key).collect();
        match keys.is_empty() {
            true => "change the formula".to_owned(),
            false => format!("change {}, or the formula", keys.join(", ")),
        }
    }

    /// What built-in models promise, tried of the equations of a file at both ends of the sweep.
    pub(super) fn check_contract(&self, ranges: &[(f64, f64)]) -> Result<(), Report> {
        let (from, to) = self.family.ends();
        for end in [from, to] {
            let Ok(values) = self.family.values_at(end) else {
                continue;
            };
            let tried = contract::verify_model(self.family.model(), &values, ranges);
            match tried {
                Ok(()) | Err(ContractViolation::SmoothSurface { .. }) => {}
                Err(violation) => {
                    let found = vec![self.diagnostic(&violation, end)];
                    return Err(Report::new(self.document.sources.clone(), found, 0));
                }
            }
        }
        Ok(())
    }
}

impl Settings {
    /// What does not hold of a file's own equations, in the names of the file.
    fn diagnostic(&self, violation: &ContractViolation, end: f64) -> Diagnostic {
        let swept = format!("{} = {}", self.family.parameter(), short(end));
        let at = |state: &[f64]| {
            let state = state.iter().enumerate();
            let words =
                state.map(|(axis, &x)| format!("{} = {}", self.family.axis(axis), short(x)));
            let words: Vec<String> = words.chain([swept.clone()]).collect();
            words.join(", ")
        };
        let name = |axis: &usize| self.family.axis(*axis);
        let outside = |axis: &usize| {
            format!(
                "leave `{}` out of [system.bounds] where the equations do not keep it inside; `from` and `to` in [cells] end the domain",
                name(axis)
            )
        };
        match violation {
            ContractViolation::Bounds { axis, from, to } => {
                let title = format!(
                    "the bounds of `{}`, from {from} to {to}, hold no value at {swept}",
                    name(axis)
                );
                let found = Diagnostic::new(title).remedy(
                    "the lower bound comes first, and both are numbers all along the sweep",
                );
                self.at_key("bounds", name(axis), found, "these bounds")
            }
            ContractViolation::BoundLeft {
                axis,
                bound,
                state,
                speed,
            } => {
                let title = format!(
                    "`{}` does not stay within its bound {}: it leaves with speed {} at {}",
                    name(axis),
                    short(*bound),
                    short(*speed),
                    at(state)
                );
                let found = Diagnostic::new(title).remedy(outside(axis));
                self.at_key("bounds", name(axis), found, "does not hold")
            }
            ContractViolation::BoundNoise {
                axis,
                bound,
                state,
                amplitude,
            } => {
                let title = format!(
                    "`{}` does not stay within its bound {}: noise of amplitude {} acts across it at {}",
                    name(axis),
                    short(*bound),
                    short(*amplitude),
                    at(state)
                );
                let found = Diagnostic::new(title).remedy(outside(axis));
                self.at_key("bounds", name(axis), found, "does not hold")
            }
            ContractViolation::NotFinite {
                quantity: Quantity::Noise(axis),
                state,
                ..
            } => {
                let title = format!(
                    "the noise on `{}` is too strong: the square of its amplitude is beyond the range of numbers at {}",
                    name(axis),
                    at(state)
                );
                let found = Diagnostic::new(title)
                    .remedy("use other units, in which numbers are nearer to 1");
                self.at_key("noise", name(axis), found, "this noise")
            }
            ContractViolation::Vanishing { axis } => {
                let title = format!(
                    "the noise on `{}` is too weak: the square of its amplitude is zero to all digits at {swept}",
                    name(axis)
                );
                let found = Diagnostic::new(title)
                    .remedy("use other units, in which numbers are nearer to 1");
                self.at_key("noise", name(axis), found, "this noise")
            }
            ContractViolation::Range { axis, from, to } => {
                let title = format!(
                    "the cells of `{0}` hold no state: within its bounds nothing lies from {from} to {to} at {swept}",
                    name(axis)
                );
                let found =
                    Diagnostic::new(title).remedy("let [cells] and [system.bounds] overlap");
                self.at_key("bounds", name(axis), found, "these bounds")
            }
            violation => {
                let title = format!(
                    "the equations do not keep what was read off them, at {swept}: {violation}"
                );
                at_system(&self.document, Diagnostic::new(title)).remedy("a smaller domain may do")
            }
        }
    }

    /// A finding about a key of a table of the file's equations.
    fn at_key(&self, table: &str, key: &str, diagnostic: Diagnostic, label: &str) -> Diagnostic {
        match self.document.root.find(&["system", table, key]) {
            Some(entry) => diagnostic.at(&entry.node.place, label),
            None => at_system(&self.document, diagnostic),
        }
    }
}

/// A finding about the file's equations.
fn at_system(document: &Document, diagnostic: Diagnostic) -> Diagnostic {
    let tables = [["system", "bounds"], ["system", "equations"]];
    let entry = tables.iter().find_map(|path| document.root.find(path));
    match entry {
        Some(entry) => diagnostic.at(&entry.key_place, "here"),
        None => at_cells(document, diagnostic),
    }
}

/// A number with as many digits as tell where it is.
pub(super) fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.4e}").parse().unwrap_or(value);
    // Zero of either sign is zero.
    (rounded + 0.0).to_string()
}
