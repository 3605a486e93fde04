//! Lines along a vector field of two components on a rectilinear grid, evenly spread: a line ends where another one is
//! near, and a new one begins where none is.

use super::contour::GridValues;
use crate::numerics::sort_descending;

/// Squares along each axis, each of which one line may enter.
const SQUARES: usize = 26;
/// Length of a step, and of the shortest and the longest line, over the width of the grid.
const STEP: f64 = 0.004;
const SHORTEST: f64 = 0.08;
const LONGEST: f64 = 3.0;
/// Where the field is weaker than this share of its largest size no line goes.
const WEAKEST: f64 = 0.01;

/// A vector field; values that are not finite end lines.
#[derive(Debug, Clone, Copy)]
pub(crate) struct VectorGrid<'a> {
    /// Components along abscissa and ordinate, per unit of each.
    pub(crate) components: [GridValues<'a>; 2],
}

impl VectorGrid<'_> {
    fn lengths(&self) -> (f64, f64) {
        let GridValues { x, y, .. } = self.components[0];
        let length = |all: &[f64]| match all {
            [first, .., last] => last - first,
            _ => 0.0,
        };
        (length(x), length(y))
    }

    /// The field at a point of the unit square, in lengths of it.
    fn at(&self, (s, t): (f64, f64)) -> Option<(f64, f64)> {
        let GridValues { x, y, .. } = self.components[0];
        let (width, height) = self.lengths();
        let point = (x.first()? + s * width, y.first()? + t * height);
        let [u, v] = self.components.map(|one| one.between(point));
        let (u, v) = (u? / width, v? / height);
        (u.is_finite() && v.is_finite()).then_some((u, v))
    }

    /// Size of the field at each point of the grid, with lengths in those of the grid.
    pub(crate) fn sizes(&self) -> Vec<f64> {
        let (width, height) = self.lengths();
        let [u, v] = self.components.map(|one| one.values);
        let pairs = u.iter().zip(v);
        pairs.map(|(u, v)| (u / width).hypot(v / height)).collect()
    }

    /// The lines, each along the field.
    pub(crate) fn streamlines(&self) -> Vec<Vec<(f64, f64)>> {
        let finite = self.sizes().into_iter().filter(|size| size.is_finite());
        let least = WEAKEST * finite.fold(0.0, f64::max);
        let middle = |square: usize| (square as f64 + 0.5) / SQUARES as f64;
        let squares = (0..SQUARES * SQUARES)
            .map(|square| (middle(square / SQUARES), middle(square % SQUARES)));
        let size = |at: (f64, f64)| self.at(at).map_or(0.0, |(u, v)| u.hypot(v));
        let mut seeds: Vec<((f64, f64), f64)> = squares.map(|at| (at, size(at))).collect();
        seeds.retain(|seed| seed.1 > least && least > 0.0);
        // The strongest first; of equal ones the one that comes first.
        sort_descending(&mut seeds, |one| one.1);
        let mut taken = vec![false; SQUARES * SQUARES];
        let mut lines = Vec::new();
        for (seed, _) in seeds {
            if taken[square(seed)] {
                continue;
            }
            let mut own = vec![square(seed)];
            let mut back = self.follow(seed, -1.0, (least, &taken), &mut own);
            let forth = self.follow(seed, 1.0, (least, &taken), &mut own);
            back.reverse();
            back.push(seed);
            back.extend(forth);
            if back.len() as f64 * STEP < SHORTEST {
                continue;
            }
            own.into_iter().for_each(|square| taken[square] = true);
            lines.push(back.into_iter().map(|at| self.place(at)).collect());
        }
        lines
    }

    /// Points along the field, or against it, up to where it ends or another line is near.
    fn follow(
        &self,
        start: (f64, f64),
        way: f64,
        (least, taken): (f64, &[bool]),
        own: &mut Vec<usize>,
    ) -> Vec<(f64, f64)> {
        let step = |at: (f64, f64), by: f64| {
            let (u, v) = self.at(at)?;
            let size = u.hypot(v);
            let scale = way * by / size;
            (size > least).then_some((scale * u, scale * v))
        };
        let (mut at, mut points) = (start, Vec::new());
        let mut last = square(start);
        while (points.len() as f64) * STEP < 0.5 * LONGEST {
            // The midpoint rule.
            let half = step(at, 0.5 * STEP);
            let moved = half.and_then(|(u, v)| step((at.0 + u, at.1 + v), STEP));
            let Some((u, v)) = moved else { break };
            at = (at.0 + u, at.1 + v);
            if !(0.0..=1.0).contains(&at.0) || !(0.0..=1.0).contains(&at.1) {
                break;
            }
            let here = square(at);
            if here != last {
                // A line that comes round to itself is closed.
                if taken[here] || own.contains(&here) {
                    break;
                }
                own.push(here);
                last = here;
            }
            points.push(at);
        }
        points
    }

    fn place(&self, (s, t): (f64, f64)) -> (f64, f64) {
        let GridValues { x, y, .. } = self.components[0];
        let (width, height) = self.lengths();
        let first = |all: &[f64]| all.first().copied().unwrap_or_default();
        (first(x) + s * width, first(y) + t * height)
    }
}

/// The square that a point of the unit square lies in.
fn square((s, t): (f64, f64)) -> usize {
    let of = |share: f64| ((share * SQUARES as f64) as usize).min(SQUARES - 1);
    of(s) * SQUARES + of(t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_go_round_a_rotation_at_even_radii_and_one_way() {
        let places: Vec<f64> = (0..41).map(|k| f64::from(k) / 20.0 - 1.0).collect();
        let field = |of: fn(f64, f64) -> f64| -> Vec<f64> {
            let all = places
                .iter()
                .flat_map(|&x| places.iter().map(move |&y| (x, y)));
            all.map(|(x, y)| of(x, y)).collect()
        };
        let (u, v) = (field(|_, y| -y), field(|x, _| x));
        let grid = |values| GridValues {
            x: &places,
            y: &places,
            values,
        };
        let lines = VectorGrid {
            components: [grid(&u), grid(&v)],
        }
        .streamlines();
        assert!(lines.len() > 5, "{}", lines.len());
        for line in &lines {
            let radius = |point: &(f64, f64)| point.0.hypot(point.1);
            for pair in line.windows(2) {
                // 0.008 of the square's side a step.
                assert!((radius(&pair[0]) - radius(&pair[1])).abs() < 1e-3);
                let turned = pair[0].0 * pair[1].1 - pair[0].1 * pair[1].0;
                assert!(turned > 0.0);
            }
        }
    }
}
