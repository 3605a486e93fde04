//! Fields of passages beside the border of their target, across which they may jump: along a displacement, whose
//! equation has no noise, states that leave a region and states that enter it have different times and probabilities.
//! So values of either side are led on to the border, and none is taken between both sides.

use crate::figure::canvas::contour::beside;

/// Halvings that lead a line to the border.
const HALVINGS: usize = 24;

/// A field on the cells of two axes with the target of its passage.
pub(in crate::figure) struct FieldBorder<'t> {
    is_inside: Box<dyn Fn((f64, f64)) -> bool + 't>,
    /// Whether the middle of each cell is inside.
    inside: Vec<bool>,
    /// The values outside, then those inside, led on by straight lines to the cells of the other side beside them.
    led_on: [Vec<f64>; 2],
}

/// Values of cells of which some are inside, those of one side led on to the cells of the other side beside them.
fn led_on(
    [x, y]: [&[f64]; 2],
    (inside, values, largest): (&[bool], &[f64], f64),
    side: bool,
) -> Vec<f64> {
    let rows = y.len();
    // The value that two cells of the side tell of a cell beside them.
    let told = |axis: &[f64], at: usize, way: isize, number: &dyn Fn(usize) -> usize| {
        let cell = |steps: isize| {
            let place = at.checked_add_signed(steps * way)?;
            (place < axis.len() && inside[number(place)] == side).then_some(place)
        };
        let near = cell(1)?;
        let value = values[number(near)];
        let slope = cell(2).map_or(0.0, |far| {
            (value - values[number(far)]) / (axis[near] - axis[far])
        });
        Some((value + slope * (axis[at] - axis[near])).clamp(0.0, largest))
    };
    let led_on = (0..values.len()).map(|cell| {
        let (i, j) = (cell / rows, cell % rows);
        if inside[cell] == side {
            return values[cell];
        }
        let ways = [1, -1].into_iter().flat_map(|way| {
            let across = told(x, i, way, &|i| i * rows + j);
            [across, told(y, j, way, &|j| i * rows + j)]
        });
        let told: Vec<f64> = ways.flatten().collect();
        match told.len() {
            0 => values[cell],
            count => told.iter().sum::<f64>() / count as f64,
        }
    });
    led_on.collect()
}

impl<'t> FieldBorder<'t> {
    /// Of values at places along both axes, those of the second one fastest, which are no larger than `largest`.
    pub(in crate::figure) fn new(
        [x, y]: &[Vec<f64>; 2],
        (values, largest): (&[f64], f64),
        is_inside: impl Fn((f64, f64)) -> bool + 't,
    ) -> Self {
        let states = x.iter().flat_map(|&x| y.iter().map(move |&y| (x, y)));
        let inside: Vec<bool> = states.map(&is_inside).collect();
        let cells = (&inside[..], values, largest);
        Self {
            led_on: [false, true].map(|side| led_on([x.as_slice(), y.as_slice()], cells, side)),
            inside,
            is_inside: Box::new(is_inside),
        }
    }

    /// The values outside of the target, led on into it.
    pub(in crate::figure) fn outer(&self) -> &[f64] {
        &self.led_on[0]
    }

    /// The values that a place is between: those of its own side of the border.
    pub(in crate::figure) fn side(&self, [x, y]: &[Vec<f64>; 2], place: (f64, f64)) -> &[f64] {
        let around = beside(x, place.0).zip(beside(y, place.1));
        let Some(((i, _), (j, _))) = around else {
            return self.outer();
        };
        let rows = y.len();
        let corners = [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)];
        let held = corners.iter().filter(|(i, j)| self.inside[i * rows + j]);
        let is_inside = match held.count() {
            0 => false,
            4 => true,
            _ => (self.is_inside)(place),
        };
        &self.led_on[usize::from(is_inside)]
    }

    /// The parts of a line that lie outside of the target, up to its border.
    pub(in crate::figure) fn outside(&self, line: &[(f64, f64)]) -> Vec<Vec<(f64, f64)>> {
        let mut parts: Vec<Vec<(f64, f64)>> = Vec::new();
        let mut is_open = false;
        for (number, &place) in line.iter().enumerate() {
            let is_outside = !(self.is_inside)(place);
            let before = number.checked_sub(1).map(|number| line[number]);
            if let Some(before) = before.filter(|_| is_outside != is_open) {
                let (inner, outer) = if is_outside {
                    (before, place)
                } else {
                    (place, before)
                };
                let met = self.met(outer, inner);
                if is_outside {
                    parts.push(vec![met]);
                } else if let Some(part) = parts.last_mut() {
                    part.push(met);
                }
            } else if is_outside && !is_open {
                parts.push(Vec::new());
            }
            if is_outside && let Some(part) = parts.last_mut() {
                part.push(place);
            }
            is_open = is_outside;
        }
        parts
    }

    /// Where the way from a place outside to one inside meets the border.
    fn met(&self, mut outer: (f64, f64), mut inner: (f64, f64)) -> (f64, f64) {
        for _ in 0..HALVINGS {
            let middle = (0.5 * (outer.0 + inner.0), 0.5 * (outer.1 + inner.1));
            if (self.is_inside)(middle) {
                inner = middle;
            } else {
                outer = middle;
            }
        }
        outer
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::canvas::contour::GridValues;

    #[test]
    fn a_field_jumps_on_the_border_of_its_target_and_not_beside_it() {
        // q = 0.2 + 0.1 x outside of x > 0.5, and one inside.
        let axis: Vec<f64> = (0..10).map(|cell| -1.0 + 0.2 * f64::from(cell)).collect();
        let places = [axis.clone(), axis.clone()];
        let exact = |x: f64| if x > 0.5 { 1.0 } else { 0.2 + 0.1 * x };
        let values: Vec<f64> = (0..100).map(|cell| exact(axis[cell / 10])).collect();
        let border = FieldBorder::new(&places, (&values, 1.0), |(x, _)| x > 0.5);
        for number in 0..300 {
            let x = -0.95 + 0.0057 * f64::from(number);
            let [x_places, y_places] = &places;
            let grid = GridValues {
                x: x_places,
                y: y_places,
                values: border.side(&places, (x, 0.3)),
            };
            let found = grid.between((x, 0.3)).unwrap();
            assert!((found - exact(x)).abs() < 1e-12, "{x}: {found}");
        }
        // A line that goes in and comes back has two parts, which end on the border.
        let parts = border.outside(&[(0.0, 0.0), (0.7, 0.0), (0.7, 0.4), (0.2, 0.4)]);
        assert_eq!(parts.iter().map(Vec::len).collect::<Vec<_>>(), [2, 2]);
        assert!((parts[0][1].0 - 0.5).abs() < 1e-6 && (parts[1][0].0 - 0.5).abs() < 1e-6);
        assert_eq!(border.outside(&[(0.6, 0.0), (0.7, 0.0)]).len(), 0);
    }
}
