//! Regions of the state: inequalities, joined by `and`, `or` and `not`.
//!
//! A region is kept as its level, a function of the state that is negative inside: of `a < b` it is a - b, of
//! `one and other` the larger of two levels, of `one or other` the smaller one, of `not one` the level with the other
//! sign. So the border has a place on every line, to the last digit, and a region is a formula like any other.
//!
//! A region may also be found: the basin of a peak of a density, `peak 2 of x` or `peak 2 of xy`, or what lies within a
//! ring, `inside ring of xy`, whose borders are known where the density is.

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
    basin: Option<Basin>,
}

/// What is found in a density: the basin of a peak, or what lies within a ring or beyond it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Basin {
    /// What of the density.
    pub(crate) of: BasinOf,
    /// The axis of a marginal density, or both axes of a joint one.
    pub(crate) axes: (usize, Option<usize>),
}

/// What of a density a basin is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum BasinOf {
    /// Of a peak, counted from 1 in the order of places: up to the valleys around it.
    Peak(usize),
    /// Within the crest around the crater of a joint density.
    InsideRing,
    /// Beyond that crest.
    OutsideRing,
}

impl Basin {
    /// Reads `peak 2 of x`, `peak 2 of xy`, `inside ring of xy` and `outside ring of xy`; `None` of another text.
    fn read(model: &Model, text: &str) -> Option<Result<Self, RegionFault>> {
        let words: Vec<&str> = text.split_whitespace().collect();
        let (of, name) = match words[..] {
            ["peak", number, "of", name] => {
                let peak = number.parse().ok().filter(|&peak: &usize| peak > 0);
                (peak.map(BasinOf::Peak), name)
            }
            ["inside", "ring", "of", name] => (Some(BasinOf::InsideRing), name),
            ["outside", "ring", "of", name] => (Some(BasinOf::OutsideRing), name),
            _ => return None,
        };
        let axes = axes_of(model, name);
        let is_known = |of: &BasinOf, second: Option<usize>| {
            matches!(of, BasinOf::Peak(_)) || second.is_some()
        };
        Some(match of.zip(axes) {
            Some((of, axes)) if is_known(&of, axes.1) => Ok(Self { of, axes }),
            _ => Err(RegionFault::Basin {
                axes: model.axes.iter().map(|axis| axis.name.clone()).collect(),
            }),
        })
    }
}

/// The axis with a name, or both axes whose joint density has it.
fn axes_of(model: &Model, name: &str) -> Option<(usize, Option<usize>)> {
    let names: Vec<&str> = model.axes.iter().map(|axis| axis.name.as_str()).collect();
    if let Some(axis) = names.iter().position(|one| *one == name) {
        return Some((axis, None));
    }
    let pairs = (0..names.len()).flat_map(|one| (0..names.len()).map(move |other| (one, other)));
    let mut named = pairs
        .filter(|&(one, other)| one != other && joined_names(&[names[one], names[other]]) == name);
    named.next().map(|(one, other)| (one, Some(other)))
}

/// The name of the density of some axes: theirs run together, with `_` between them where one is longer than a letter.
pub(crate) fn joined_names(names: &[&str]) -> String {
    let is_letter = |name: &&str| name.chars().count() == 1;
    names.join(if names.iter().all(is_letter) { "" } else { "_" })
}

impl Region {
    /// The basin that it is, which has no level of its own: see [`Region::between`].
    pub(crate) fn basin(&self) -> Option<Basin> {
        self.basin
    }

    /// The states between two coordinates of an axis, either of which may be missing; of the same name.
    ///
    /// # Errors
    /// [`RegionFault`] for an axis that the model does not have, or without an end.
    pub fn between(
        &self,
        model: &Model,
        axis: usize,
        ends: [Option<f64>; 2],
    ) -> Result<Self, RegionFault> {
        let name = model.axes.get(axis).map_or("", |axis| axis.name.as_str());
        let [lower, upper] = ends;
        let parts = [
            lower.map(|end| format!("{name} > {end:?}")),
            upper.map(|end| format!("{name} < {end:?}")),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        self.within(model, &parts)
    }

    /// The states for which all of some inequalities hold; of the same name.
    ///
    /// # Errors
    /// [`RegionFault`] without any, or of one that is wrong.
    pub(crate) fn within(
        &self,
        model: &Model,
        inequalities: &[String],
    ) -> Result<Self, RegionFault> {
        let text = inequalities.join(" and ");
        let read = regions(model, &[(self.name(), &text)]);
        let wrong = |errors: Vec<RegionError>| {
            errors
                .into_iter()
                .next()
                .map_or(RegionFault::Missing, |error| error.fault)
        };
        let mut read = read.map_err(wrong)?;
        read.pop().ok_or(RegionFault::Missing)
    }

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
    /// What is found in no density: a basin of no peak, along no axis, a ring along one.
    #[error(
        "a region that is found is `peak N of AXIS`, with peaks counted from 1 along an axis: {}; or `peak N of`, \
         `inside ring of` or `outside ring of` and the name of a joint density, as {}",
        axes.join(", "), axes.get(..2).map_or_else(|| "xy".to_owned(), |two| joined_names(&[&two[0], &two[1]]))
    )]
    Basin {
        /// The axes that there are.
        axes: Vec<String>,
    },
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
            Self::Basin { axes } => Some(format!(
                "write `peak 1 of {}`",
                axes.first().map_or("x", String::as_str)
            )),
            Self::NoInequality { text } if text.starts_with("peak ") || text.contains("ring of") => Some(
                "a region that is found stands alone: give it a region of its own, without `and`, `or` and `not`"
                    .to_owned(),
            ),
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
    let basins: Vec<_> = given
        .iter()
        .map(|(_, text)| Basin::read(model, text))
        .collect();
    // What is found has no formula that could stand in another.
    let typed = given
        .iter()
        .zip(&basins)
        .filter(|(_, basin)| basin.is_none());
    let names: Vec<&str> = typed.map(|((name, _), _)| *name).collect();
    let (mut levels, mut errors) = (Vec::new(), Vec::new());
    for (index, (_, text)) in given.iter().enumerate() {
        match &basins[index] {
            None => {}
            Some(Ok(basin)) => {
                // The level says no more than on which states it depends.
                let axes = std::iter::once(basin.axes.0).chain(basin.axes.1);
                let names = axes.map(|axis| model.axes[axis].name.as_str());
                levels.push((names.collect::<Vec<_>>().join(" + "), Vec::new()));
                continue;
            }
            Some(Err(fault)) => {
                let (span, fault) = (Some(0..text.len()), fault.clone());
                errors.push(RegionError { index, span, fault });
                continue;
            }
        }
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
    // Those with formulas may stand in each other.
    let (typed, found): (Vec<usize>, Vec<usize>) =
        (0..given.len()).partition(|&index| basins[index].is_none());
    let groups = [typed]
        .into_iter()
        .chain(found.into_iter().map(|one| vec![one]));
    let mut all = vec![None; given.len()];
    for group in groups.filter(|group| !group.is_empty()) {
        let formulas: Vec<(&str, Option<&str>)> = (group.iter())
            .map(|&index| (given[index].0, Some(levels[index].0.as_str())))
            .collect();
        match quantities(model, &formulas) {
            Ok(read) => {
                let pairs = group.into_iter().zip(read);
                pairs.for_each(|(index, level)| all[index] = Some(level));
            }
            Err(wrong) => errors.extend(wrong.into_iter().map(|error| {
                let index = group[error.index];
                let span = error.fault.span();
                RegionError {
                    index,
                    span: span.and_then(|span| given_span(&levels[index].1, &span)),
                    fault: RegionFault::Formula(error.fault),
                }
            })),
        }
    }
    if !errors.is_empty() {
        return Err(errors);
    }
    let read = all.into_iter().zip(given).zip(basins);
    let read = read.filter_map(|((level, (_, text)), basin)| {
        Some(Region {
            text: (*text).to_owned(),
            level: level?,
            basin: basin.and_then(Result::ok),
        })
    });
    Ok(read.collect())
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
    fn basins_of_peaks_are_read_and_stand_in_no_formula() {
        let model = registry::find("coulomb").unwrap();
        let read = regions(&model, &[("left", "peak  1 of x"), ("far", "y > 2")]).unwrap();
        let basin = |of: BasinOf, axes| Some(Basin { of, axes });
        assert_eq!(read[0].basin(), basin(BasinOf::Peak(1), (0, None)));
        for (text, of) in [
            ("peak 3 of xy", BasinOf::Peak(3)),
            ("inside ring of xy", BasinOf::InsideRing),
            ("outside  ring of xy", BasinOf::OutsideRing),
        ] {
            let read = regions(&model, &[("one", text)]).unwrap();
            assert_eq!(read[0].basin(), basin(of, (0, Some(1))), "{text}");
        }
        assert_eq!(
            (read[0].name(), read[0].text(), read[1].basin()),
            ("left", "peak  1 of x", None)
        );
        let between = read[0].between(&model, 0, [None, Some(-0.25)]).unwrap();
        assert_eq!(
            (between.name(), between.text(), between.basin()),
            ("left", "x < -0.25", None)
        );
        let both = read[0]
            .between(&model, 1, [Some(-1e-20), Some(2.0)])
            .unwrap();
        assert_eq!(both.text(), "y > -1e-20 and y < 2.0");
        assert!(read[0].between(&model, 0, [None, None]).is_err());
        for (text, word) in [
            ("peak 0 of x", "counted from 1"),
            ("peak 1 of q", "along an axis: x, y"),
            ("inside ring of x", "as xy"),
        ] {
            let error = regions(&model, &[("one", text)]).unwrap_err().remove(0);
            assert!(error.fault.to_string().contains(word), "{}", error.fault);
        }
        for text in ["left and y > 0", "left < 1"] {
            let given = [("left", "peak 1 of x"), ("one", text)];
            assert_eq!(regions(&model, &given).unwrap_err()[0].index, 1);
        }
        let joined = regions(&model, &[("one", "peak 1 of x and y > 0")]).unwrap_err();
        assert!(joined[0].fault.remedy().unwrap().contains("stands alone"));
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
