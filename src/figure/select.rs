//! What of a sweep is drawn: points nearest to wanted values, and the part of an axis where there is something to see.

use crate::continuation::{Point, SweepResult};
use crate::density::{Density, EstimatedDensity};
use crate::space::Axis;

use super::canvas::style::PNG_SCALE;

/// Share of the largest density below which a cell counts as empty.
const EMPTY: f64 = 1e-3;
/// Most pixels of an embedded map along a side: more than are seen, however wide the page.
const MOST_PIXELS: f64 = 1200.0;
/// Share of a window that is added at either end.
const BORDER: f64 = 0.04;

/// Letters, digits, `.`, `-` and `_`; everything else becomes `_`.
pub(super) fn safe(name: &str) -> String {
    let letter = |c: char| match c {
        c if c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | '_') => c,
        _ => '_',
    };
    name.chars().map(letter).collect()
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
    let most = (length * PNG_SCALE).round().clamp(1.0, MOST_PIXELS) as usize;
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
