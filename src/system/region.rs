//! Regions of the state: inequalities, joined by `and`, `or` and `not`.
//!
//! A region is kept as its level, a function of the state that is negative inside: of `a < b` it is a - b, of
//! `one and other` the larger of two levels, of `one or other` the smaller one, of `not one` the level with the other
//! sign. So the border has a place on every line, to the last digit, and a region is a formula like any other.

mod level;

use std::ops::Range;
use std::sync::Arc;

use super::Model;
use super::quantity::{Quantity, QuantityFault, quantities};
use level::{given_span, written_level};

/// A region of the state of a model.
#[derive(Debug, Clone)]
pub struct Region {
    text: String,
    level: Arc<Quantity>,
}

impl Region {
    /// Its name.
    pub fn name(&self) -> &str {
        self.level.name()
    }

    /// The inequality, as given.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The level: negative inside, positive outside.
    pub fn level(&self) -> &Arc<Quantity> {
        &self.level
    }
}

/// What is wrong with a region.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionError {
    /// Its number among those that were given.
    pub index: usize,
    /// Bytes of its text, where the fault has a place there.
    pub span: Option<Range<usize>>,
    /// What is wrong with it.
    pub fault: RegionFault,
}

/// What is wrong with a region.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RegionFault {
    /// A part between `and`, `or` and `not` that says nothing.
    #[error("an inequality is missing")]
    Missing,
    /// A part that is neither an inequality nor the name of a region.
    #[error("`{text}` is neither an inequality nor the name of a region")]
    NoInequality {
        /// The part.
        text: String,
    },
    /// An equality: a set without inside.
    #[error("an equality has no inside")]
    Equality,
    /// More closing than opening parentheses, or fewer.
    #[error("the parentheses do not match")]
    Parentheses,
    /// A formula that is wrong.
    #[error("{0}")]
    Formula(QuantityFault),
}

impl RegionFault {
    /// What is allowed there.
    pub(crate) fn allowed(&self) -> Option<String> {
        match self {
            Self::Formula(fault) => fault.allowed(),
            _ => None,
        }
    }

    /// What to write instead.
    pub fn remedy(&self) -> Option<String> {
        match self {
            Self::Formula(fault) => fault.remedy(),
            Self::Equality => Some("write `abs(a - b) < c`".to_owned()),
            _ => Some(
                "write inequalities such as `x < -0.2` or `x^2 + y^2 > 4`, joined by `and`, `or` and `not`"
                    .to_owned(),
            ),
        }
    }
}

/// Reads regions: names with inequalities of a model's coordinates, parameters and definitions, and of the names of
/// other regions among those given.
///
/// # Errors
/// Everything that is wrong with them.
///
/// ```
/// use pbif::system::{regions, registry};
///
/// let model = registry::find("rayleigh")?;
/// let given = [("disc", "x^2 + y^2 < 4"), ("upper", "disc and not (y <= 0)")];
/// let read = regions(&model, &given).unwrap();
/// let upper = read[1].level().bind(&model.values(&[("a", 0.1), ("b", 0.5), ("sigma2", 1.0)])?).unwrap();
/// assert!(upper.at(&[0.0, 1.0]) < 0.0 && upper.at(&[0.0, -1.0]) > 0.0 && upper.at(&[0.0, 3.0]) > 0.0);
/// # Ok::<(), pbif::system::SystemError>(())
/// ```
pub fn regions(model: &Model, given: &[(&str, &str)]) -> Result<Vec<Region>, Vec<RegionError>> {
    let names: Vec<&str> = given.iter().map(|(name, _)| *name).collect();
    let (mut levels, mut errors) = (Vec::new(), Vec::new());
    for (index, (_, text)) in given.iter().enumerate() {
        match written_level(&names, text) {
            Ok(level) => levels.push(level),
            Err((span, fault)) => errors.push(RegionError {
                index,
                span: Some(span),
                fault,
            }),
        }
    }
    if !errors.is_empty() {
        return Err(errors);
    }
    let formulas = names.iter().zip(&levels);
    let formulas: Vec<(&str, Option<&str>)> = formulas
        .map(|(&name, (level, _))| (name, Some(level.as_str())))
        .collect();
    match quantities(model, &formulas) {
        Ok(read) => {
            let pairs = read.into_iter().zip(given);
            let region = |(level, (_, text)): (Arc<Quantity>, &(&str, &str))| Region {
                text: (*text).to_owned(),
                level,
            };
            Ok(pairs.map(region).collect())
        }
        Err(wrong) => Err(wrong
            .into_iter()
            .map(|error| RegionError {
                index: error.index,
                span: error
                    .fault
                    .span()
                    .and_then(|span| given_span(&levels[error.index].1, &span)),
                fault: RegionFault::Formula(error.fault),
            })
            .collect()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::registry;

    fn level(given: &[(&str, &str)], state: [f64; 2]) -> f64 {
        let model = registry::find("coulomb").unwrap();
        let values = [("kappa", 0.1), ("sigma2", 0.1), ("f_c", 0.25)];
        let read = regions(&model, given).unwrap();
        let bound = read[given.len() - 1]
            .level()
            .bind(&model.values(&values).unwrap());
        bound.unwrap().at(&state)
    }

    #[test]
    fn levels_are_negative_inside() {
        let one = |text: &str, state: [f64; 2]| level(&[("one", text)], state);
        assert_eq!(one("x < -0.2", [1.0, 0.0]), 1.2);
        assert_eq!(one("x >= y", [1.0, 3.0]), 2.0);
        assert_eq!(one("-1 < x < 2 f_c", [0.25, 0.0]), -0.25);
        assert_eq!(one("abs(x) > 2", [1.0, 0.0]), 1.0);
        assert_eq!(one("(x + y) y < 1", [1.0, 2.0]), 5.0);
        assert_eq!(one("x < 0 or y < 0 and x < 3", [1.0, -1.0]), -1.0);
        assert_eq!(one("(x < 0 or y < 0) and x < 3", [4.0, -1.0]), 1.0);
        assert_eq!(one("not(x < 0)", [1.0, 0.0]), -1.0);
        assert_eq!(one("not not (x < 0)", [1.0, 0.0]), 1.0);
        assert_eq!(
            level(&[("left", "x<0"), ("one", "left and y>0")], [-2.0, 1.0]),
            -1.0
        );
    }

    #[test]
    fn what_is_no_region_is_refused_in_its_place() {
        let model = registry::find("coulomb").unwrap();
        let wrong = |text: &str| {
            let error = regions(&model, &[("one", text)]).unwrap_err().remove(0);
            (error.span, error.fault.to_string())
        };
        for (text, span, word) in [
            ("", 0..0, "missing"),
            ("x < 1 and ", 10..10, "missing"),
            ("x", 0..1, "neither an inequality"),
            ("x < 1 or z2 > 3", 9..11, "z2"),
            ("x == 1", 2..3, "equality"),
            ("x < (1", 0..6, "parentheses"),
            ("x < 1) or y > 2", 5..6, "parentheses"),
            ("x < 1 <", 0..7, "missing"),
        ] {
            let (found, message) = wrong(text);
            assert_eq!(found, Some(span), "{text}");
            assert!(message.contains(word), "{text}: {message}");
        }
        assert!(wrong("f_c < 1").1.contains("no coordinate"));
    }
}
