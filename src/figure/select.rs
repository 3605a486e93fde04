//! What of a sweep is drawn and what it is called: symbols, file names, points nearest to wanted values,
//! and the part of an axis where there is something to see.

use crate::continuation::{Point, SweepResult};
use crate::density::{Density, EstimatedDensity, Observable};
use crate::space::Axis;
use crate::system::Model;

use super::canvas::style::PNG_SCALE;
use super::canvas::symbols;

/// Share of the largest density below which a cell counts as empty.
const EMPTY: f64 = 1e-3;
/// Share of a window that is added at either end.
const BORDER: f64 = 0.04;

/// Symbols and names of a sweep.
#[derive(Clone, Copy)]
pub(super) struct Names<'a> {
    model: &'a Model,
    parameter: &'a str,
}

impl<'a> Names<'a> {
    pub(super) fn of(model: &'a Model, parameter: &'a str) -> Self {
        Self { model, parameter }
    }

    /// Symbol of the swept parameter, as markup; its name where the model does not know it.
    pub(super) fn parameter(&self) -> String {
        let mut parameters = self.model.parameters.iter();
        match parameters.find(|parameter| parameter.name == self.parameter) {
            Some(parameter) => symbols::variable(&parameter.symbol),
            None if self.parameter.chars().count() == 1 => symbols::variable(self.parameter),
            None => symbols::plain(self.parameter),
        }
    }

    /// Name of the swept parameter as plain text.
    pub(super) fn plain(&self) -> &'a str {
        self.parameter
    }

    /// Symbol of an axis, as markup.
    pub(super) fn axis(&self, axis: usize) -> String {
        match self.model.axes.get(axis) {
            Some(description) => symbols::variable(&description.symbol),
            None => symbols::variable(&format!("x_{{{}}}", axis + 1)),
        }
    }

    /// `p(x)` or `p(x, ẋ)`, as markup.
    pub(super) fn density(&self, observable: Observable) -> String {
        let symbols: Vec<String> = axes_of(observable)
            .iter()
            .map(|&axis| self.axis(axis))
            .collect();
        symbols::density_of(&symbols)
    }

    /// `α = −0.5`, as markup.
    pub(super) fn at(&self, value: f64) -> String {
        format!("{} = {}", self.parameter(), symbols::value(value))
    }

    /// Name of an observable in file names: `x`, `xy`.
    pub(super) fn file(&self, observable: Observable) -> String {
        let name = |&axis: &usize| match self.model.axes.get(axis) {
            Some(description) => safe(&description.name),
            None => format!("x{}", axis + 1),
        };
        axes_of(observable).iter().map(name).collect()
    }
}

/// Letters, digits, `.`, `-` and `_`; everything else becomes `_`.
pub(super) fn safe(name: &str) -> String {
    let letter = |c: char| match c {
        c if c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | '_') => c,
        _ => '_',
    };
    name.chars().map(letter).collect()
}

fn axes_of(observable: Observable) -> Vec<usize> {
    match observable {
        Observable::Marginal(axis) => vec![axis],
        Observable::Joint(first, second) => vec![first, second],
    }
}

/// The density of an observable at a point, if it has one that can be drawn.
pub(super) fn density(point: &Point, observable: usize) -> Option<&EstimatedDensity> {
    let estimated = point.densities.get(observable)?;
    let cells: usize = estimated.density.axes.iter().map(Axis::count).product();
    (cells == estimated.density.values.len()).then_some(estimated)
}

/// The computed points nearest to the wanted values, in that order, each once; without those that have no density.
pub(super) fn nearest<'a>(result: &'a SweepResult, at: &[f64]) -> Vec<&'a Point> {
    let mut chosen: Vec<usize> = Vec::new();
    for &wanted in at.iter().filter(|wanted| wanted.is_finite()) {
        let distance = |point: &Point| (point.value - wanted).abs();
        let points = result.points.iter().enumerate();
        let nearest = points.min_by(|(_, a), (_, b)| distance(a).total_cmp(&distance(b)));
        if let Some((index, point)) = nearest
            && !point.densities.is_empty()
            && !chosen.contains(&index)
        {
            chosen.push(index);
        }
    }
    chosen
        .into_iter()
        .map(|index| &result.points[index])
        .collect()
}

/// The largest finite value; zero if there is none.
pub(super) fn largest<'a>(densities: impl IntoIterator<Item = &'a Density>) -> f64 {
    let values = densities
        .into_iter()
        .flat_map(|density| density.values.iter());
    values
        .copied()
        .filter(|value| value.is_finite())
        .fold(0.0, f64::max)
}

/// The part of axis number `axis` outside of which all of the densities are nearly empty; it ends at edges of cells.
pub(super) fn window(densities: &[&Density], axis: usize) -> Option<(f64, f64)> {
    let limit = EMPTY * largest(densities.iter().copied());
    let mut window: Option<(f64, f64)> = None;
    let mut whole: Option<(f64, f64)> = None;
    let join = |to: &mut Option<(f64, f64)>, part: (f64, f64)| {
        *to = Some(to.map_or(part, |(from, end)| (part.0.min(from), part.1.max(end))));
    };
    for density in densities {
        let Some(cells) = density.axes.get(axis) else {
            continue;
        };
        join(&mut whole, (cells.from(), cells.to()));
        let fastest: usize = density.axes[axis + 1..].iter().map(Axis::count).product();
        for (number, _) in density
            .values
            .iter()
            .enumerate()
            .filter(|(_, value)| **value > limit)
        {
            let cell = number / fastest % cells.count();
            join(&mut window, (cells.edges()[cell], cells.edges()[cell + 1]));
        }
    }
    let (whole, (from, to)) = (whole?, window?);
    let border = BORDER * (to - from);
    let first = densities
        .iter()
        .find_map(|density| density.axes.get(axis))?;
    let from = first
        .edges()
        .iter()
        .copied()
        .rfind(|&edge| edge <= from - border);
    let to = first
        .edges()
        .iter()
        .copied()
        .find(|&edge| edge >= to + border);
    Some((from.unwrap_or(whole.0), to.unwrap_or(whole.1)))
}

/// Pixels for a window of axes: one a cell where all are alike and uniform, else as many as a PNG shows.
pub(super) fn resolution(axes: &[&Axis], window: (f64, f64), length: f64) -> usize {
    let most = (length * PNG_SCALE).round().max(1.0) as usize;
    match axes {
        [first, rest @ ..] if first.is_uniform() && rest.iter().all(|axis| axis == first) => {
            let cells = (window.1 - window.0) / first.width(0);
            (cells.round() as usize).clamp(1, most)
        }
        _ => most,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn density(values: impl Fn(f64) -> f64) -> Density {
        let axis = Axis::uniform(-4.0, 4.0, 80).unwrap();
        let values = axis.centres().into_iter().map(values).collect();
        Density {
            axes: vec![axis],
            values,
        }
    }

    #[test]
    fn windows_hold_what_is_not_empty_and_end_at_edges() {
        let narrow = density(|x| (-8.0 * x * x).exp());
        let (from, to) = window(&[&narrow], 0).unwrap();
        // exp(-8 x²) = 1e-3 at x = 0.929.
        assert!(
            (0.95..1.2).contains(&-from) && (0.95..1.2).contains(&to),
            "{from} {to}"
        );
        assert!(narrow.axes[0].has_face_at(from) && narrow.axes[0].has_face_at(to));
        assert_eq!(
            resolution(&[&narrow.axes[0]], (from, to), 300.0),
            ((to - from) / 0.1).round() as usize
        );
        let wide = density(|_| 0.125);
        assert_eq!(window(&[&narrow, &wide], 0), Some((-4.0, 4.0)));
        assert_eq!(window(&[&density(|_| 0.0)], 0), None);
    }

    #[test]
    fn file_names_are_safe() {
        assert_eq!(safe("f_c/../ẋ"), "f_c_..__");
    }
}
