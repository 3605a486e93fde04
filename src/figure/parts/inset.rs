//! Small densities of one state of each regime, drawn into the regions of a map.

use crate::density::Density;
use crate::figure::canvas::heat::Picture;
use crate::figure::canvas::look::Look;
use crate::figure::canvas::page::{Page, Rectangle, Shape};
use crate::figure::canvas::style::{GREY, INK, PAPER, Stroke};
use crate::space::Axis;

/// Width and height of a small density, in pixels.
pub(crate) const SIZE: (f64, f64) = (50.0, 34.0);
/// Share of the largest value below which a density is not shown.
const FAINT: f64 = 2e-3;
/// Pixels of a joint density to a figure pixel.
const FINE: f64 = 2.0;

/// Draws a density into a rectangle.
pub(crate) fn draw(page: &Page, look: &Look, rect: Rectangle, density: &Density) {
    page.draw(&rect.corners(), Shape::Area(PAPER));
    match density.axes.as_slice() {
        [axis] => curve(page, rect, axis, density),
        [first, second] => map(page, look, rect, [first, second], density),
        _ => {}
    }
    page.draw(&rect.rim(), Shape::Line(Stroke::solid(GREY, 0.6)));
}

/// The cells of an axis in which a profile is not faint, first and last.
fn visible_cells(profile: &[f64]) -> (usize, usize) {
    let highest = profile.iter().copied().fold(0.0, f64::max);
    let mut cells = (0..profile.len()).filter(|&cell| profile[cell] > FAINT * highest);
    let first = cells.next().unwrap_or(0);
    (first, cells.next_back().unwrap_or(first))
}

fn curve(page: &Page, rect: Rectangle, axis: &Axis, density: &Density) {
    let (first, last) = visible_cells(&density.values);
    let range = (axis.edges()[first], axis.edges()[last + 1]);
    let panel = page.panel(rect, range, (0.0, 1.1 * density.maximum()));
    let points = (first..=last).map(|cell| (axis.centre(cell), density.values[cell].max(0.0)));
    panel.draw(
        &points.collect::<Vec<_>>(),
        Shape::Line(Stroke::solid(INK, 1.0)),
    );
}

fn map(page: &Page, look: &Look, rect: Rectangle, [first, second]: [&Axis; 2], density: &Density) {
    let columns = second.count();
    let across: Vec<f64> = density
        .values
        .chunks(columns)
        .map(|row| row.iter().copied().fold(0.0, f64::max))
        .collect();
    let up: Vec<f64> = (0..columns)
        .map(|k| {
            density
                .values
                .iter()
                .skip(k)
                .step_by(columns)
                .copied()
                .fold(0.0, f64::max)
        })
        .collect();
    let range = |axis: &Axis, profile: &[f64]| {
        let (first, last) = visible_cells(profile);
        (axis.edges()[first], axis.edges()[last + 1])
    };
    let (x, y) = (range(first, &across), range(second, &up));
    let size = [rect.width, rect.height].map(|length| (FINE * length).round().max(1.0) as usize);
    let highest = density.maximum();
    let picture = Picture::new(look, (size[0], size[1]), |column, row| {
        let at = |(from, to): (f64, f64), pixel: usize, count: usize| {
            from + (to - from) * (pixel as f64 + 0.5) / count as f64
        };
        let (i, j) = (
            first.find(at(x, column, size[0]))?,
            second.find(at(y, row, size[1]))?,
        );
        Some(density.values[i * columns + j] / highest)
    });
    let panel = page.panel(rect, x, y);
    panel.draw(&[(x.0, y.1), (x.1, y.0)], Shape::Image(picture));
}
