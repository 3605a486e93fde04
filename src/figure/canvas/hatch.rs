//! Hatching, for where there is no density to show.

use super::page::{Page, Shape};
use super::style::{BLANK, HATCH, Stroke};

/// Distance of the strokes along the abscissa, in pixels.
const SPACING: f64 = 7.0;

/// Hatches the rectangle between two abscissas and two ordinates (upper first), in pixels.
pub(crate) fn draw(page: &Page, (left, right): (f64, f64), (top, bottom): (f64, f64)) {
    let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
    page.draw(&corners, Shape::Area(BLANK));
    for stroke in strokes((left, right), (top, bottom)) {
        page.draw(&stroke, Shape::Line(Stroke::solid(HATCH, 0.7)));
    }
}

/// The parts inside the rectangle of the lines x + y = k · spacing.
fn strokes((left, right): (f64, f64), (top, bottom): (f64, f64)) -> Vec<[(f64, f64); 2]> {
    let first = ((left + top) / SPACING).ceil() as i64;
    let last = ((right + bottom) / SPACING).floor() as i64;
    (first..=last)
        .map(|number| {
            let sum = number as f64 * SPACING;
            let from = (sum - bottom).max(left);
            let to = (sum - top).min(right);
            [(from, sum - from), (to, sum - to)]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_stay_inside_and_reach_the_border() {
        let strokes = strokes((10.0, 55.0), (3.0, 40.0));
        assert!(strokes.len() > 8);
        for [from, to] in strokes {
            for (x, y) in [from, to] {
                assert!(
                    (10.0..=55.0).contains(&x) && (3.0..=40.0).contains(&y),
                    "{x} {y}"
                );
            }
            assert!(from.0 == 10.0 || from.1 == 40.0);
            assert!(to.0 == 55.0 || to.1 == 3.0);
        }
    }
}
