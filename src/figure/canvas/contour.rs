//! Contours by marching squares on a rectilinear grid of points.
//!
//! Along the edges of the grid values are taken as linear; an ambiguous square (opposite corners above the
//! level) is decided by the mean of its corners. For a smooth function the places are right to O(h²).

/// Values at the points of a rectilinear grid.
#[derive(Debug, Clone, Copy)]
pub(crate) struct GridValues<'a> {
    /// Abscissas, ascending; length `n`.
    pub(crate) x: &'a [f64],
    /// Ordinates, ascending; length `m`.
    pub(crate) y: &'a [f64],
    /// `n × m` values, the ordinate fastest.
    pub(crate) values: &'a [f64],
}

/// Most points between two that are kept when a line is thinned.
const MOST_SKIPPED: usize = 64;

/// Marks an end of a contour piece that nothing joins.
const NONE: usize = usize::MAX;

impl GridValues<'_> {
    fn value(&self, i: usize, j: usize) -> f64 {
        self.values[i * self.y.len() + j]
    }

    /// The value at a point of the grid's rectangle, linear along each axis between neighbouring points.
    pub(crate) fn between(&self, (x, y): (f64, f64)) -> Option<f64> {
        let ((i, s), (j, t)) = (beside(self.x, x)?, beside(self.y, y)?);
        let low = (1.0 - s) * self.value(i, j) + s * self.value(i + 1, j);
        let high = (1.0 - s) * self.value(i, j + 1) + s * self.value(i + 1, j + 1);
        Some((1.0 - t) * low + t * high)
    }

    /// Number of the edge from point `(i, j)` to its neighbour along x (`along_x`) or y.
    fn edge(&self, i: usize, j: usize, along_x: bool) -> usize {
        2 * (i * self.y.len() + j) + usize::from(along_x)
    }

    /// Where the contour crosses an edge.
    fn crossing(&self, edge: usize, level: f64) -> (f64, f64) {
        let (point, along_x) = (edge / 2, edge % 2 == 1);
        let (i, j) = (point / self.y.len(), point % self.y.len());
        let (next_i, next_j) = if along_x { (i + 1, j) } else { (i, j + 1) };
        let (a, b) = (self.value(i, j), self.value(next_i, next_j));
        let share = (level - a) / (b - a);
        (
            self.x[i] + share * (self.x[next_i] - self.x[i]),
            self.y[j] + share * (self.y[next_j] - self.y[j]),
        )
    }

    /// The pieces of contour in the square with lower left point `(i, j)`, as pairs of edges.
    fn pieces(&self, i: usize, j: usize, level: f64) -> Vec<(usize, usize)> {
        let corners = [
            self.value(i, j),
            self.value(i + 1, j),
            self.value(i + 1, j + 1),
            self.value(i, j + 1),
        ];
        if corners.iter().any(|value| !value.is_finite()) {
            return Vec::new();
        }
        // Edges between consecutive corners: bottom, right, top, left.
        let edges = [
            self.edge(i, j, true),
            self.edge(i + 1, j, false),
            self.edge(i, j + 1, true),
            self.edge(i, j, false),
        ];
        let above = corners.map(|value| value > level);
        let crossed: Vec<usize> = (0..4).filter(|&k| above[k] != above[(k + 1) % 4]).collect();
        match crossed[..] {
            [one, other] => vec![(edges[one], edges[other])],
            [_, _, _, _] => {
                let middle_above = corners.iter().sum::<f64>() / 4.0 > level;
                // The corners unlike the middle are cut off: corner k lies between edges k - 1 and k.
                let cut = |k: usize| (edges[(k + 3) % 4], edges[k]);
                let odd = (0..4).filter(|&k| above[k] != middle_above);
                odd.map(cut).collect()
            }
            _ => Vec::new(),
        }
    }

    /// The contour of a level: polylines, closed ones with the first point repeated at the end.
    pub(crate) fn contour(&self, level: f64) -> Vec<Vec<(f64, f64)>> {
        let (n, m) = (self.x.len(), self.y.len());
        // Each crossed edge joins at most two pieces, one of either square beside it.
        let mut neighbours = vec![[NONE; 2]; 2 * n * m];
        for i in 0..n.saturating_sub(1) {
            for j in 0..m.saturating_sub(1) {
                for (one, other) in self.pieces(i, j, level) {
                    for (from, to) in [(one, other), (other, one)] {
                        let slot = usize::from(neighbours[from][0] != NONE);
                        neighbours[from][slot] = to;
                    }
                }
            }
        }
        let mut visited = vec![false; neighbours.len()];
        let ends = |edge: &usize| neighbours[*edge][0] != NONE && neighbours[*edge][1] == NONE;
        let inner = |edge: &usize| neighbours[*edge][1] != NONE;
        // Open lines first, from their ends; what then remains is closed.
        let starts = (0..neighbours.len()).filter(ends);
        let starts = starts.chain((0..neighbours.len()).filter(inner));
        let mut lines = Vec::new();
        for start in starts {
            if visited[start] {
                continue;
            }
            let edges = follow(start, &neighbours, &mut visited);
            lines.push(
                edges
                    .iter()
                    .map(|&edge| self.crossing(edge, level))
                    .collect(),
            );
        }
        lines
    }
}

/// The edges that a contour crosses from `start` on, until it ends or closes.
fn follow(start: usize, neighbours: &[[usize; 2]], visited: &mut [bool]) -> Vec<usize> {
    let mut line = vec![start];
    visited[start] = true;
    let mut at = start;
    loop {
        let next = neighbours[at]
            .iter()
            .copied()
            .find(|&next| next != NONE && !visited[next]);
        let Some(next) = next else {
            break;
        };
        visited[next] = true;
        line.push(next);
        at = next;
    }
    if line.len() > 2 && neighbours[at].contains(&start) {
        line.push(start);
    }
    line
}

/// The place of the two neighbours of a coordinate that is clamped to the range of the places, and its share of the way
/// to the second; `None` of fewer than two places.
pub(crate) fn beside(places: &[f64], at: f64) -> Option<(usize, f64)> {
    let last = places.len().checked_sub(2)?;
    let above = places.partition_point(|&place| place <= at);
    let below = above.saturating_sub(1).min(last);
    let (a, b) = (places[below], places[below + 1]);
    Some((below, ((at - a) / (b - a)).clamp(0.0, 1.0)))
}

/// A line without the points that lie within `alike` pixels of the chord between those that are kept; `place` gives
/// the pixels of a point.
pub(crate) fn simplify(
    line: &[(f64, f64)],
    alike: f64,
    place: impl Fn(&(f64, f64)) -> (f64, f64),
) -> Vec<(f64, f64)> {
    let at: Vec<(f64, f64)> = line.iter().map(place).collect();
    let is_straight = |from: usize, to: usize| {
        let (dx, dy) = (at[to].0 - at[from].0, at[to].1 - at[from].1);
        let length = dx.hypot(dy);
        at[from + 1..to].iter().all(|point| {
            let (x, y) = (point.0 - at[from].0, point.1 - at[from].1);
            // A line that comes back on itself is not its chord.
            (x * dy - y * dx).abs() <= alike * length
                && (0.0..=length * length).contains(&(x * dx + y * dy))
        })
    };
    let mut kept: Vec<usize> = Vec::new();
    for point in 0..line.len() {
        let from = match kept[..] {
            [.., from, _] => from,
            _ => {
                kept.push(point);
                continue;
            }
        };
        if is_straight(from, point) && point - from <= MOST_SKIPPED {
            kept.pop();
        }
        kept.push(point);
    }
    kept.into_iter().map(|point| line[point]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid_of(count: usize, f: impl Fn(f64, f64) -> f64) -> (Vec<f64>, Vec<f64>) {
        let axis: Vec<f64> = (0..count)
            .map(|i| -2.0 + 4.0 * i as f64 / (count - 1) as f64)
            .collect();
        let values = axis.iter().flat_map(|&x| axis.iter().map(move |&y| (x, y)));
        let values = values.map(|(x, y)| f(x, y)).collect();
        (axis, values)
    }

    /// Largest distance of the contour exp(-r²) = exp(-1) from the unit circle.
    fn circle_error(count: usize) -> f64 {
        let (axis, values) = grid_of(count, |x, y| (-x * x - y * y).exp());
        let grid = GridValues {
            x: &axis,
            y: &axis,
            values: &values,
        };
        let lines = grid.contour((-1.0f64).exp());
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0].first(), lines[0].last());
        let turns: f64 = lines[0]
            .windows(2)
            .map(|pair| pair[0].0 * pair[1].1 - pair[0].1 * pair[1].0)
            .sum();
        assert!((turns.abs() / 2.0 - std::f64::consts::PI).abs() < 0.1);
        lines[0]
            .iter()
            .map(|(x, y)| (x.hypot(*y) - 1.0).abs())
            .fold(0.0, f64::max)
    }

    #[test]
    fn a_circle_is_found_with_second_order() {
        let (coarse, fine) = (circle_error(41), circle_error(81));
        // Linear interpolation errs by at most h²/8 max|f''| / |f'|, here h²/8 · 2e⁻¹/(2e⁻¹) = h²/8.
        assert!(coarse < 1.3 * 0.1f64.powi(2) / 8.0, "{coarse}");
        let order = (coarse / fine).log2();
        assert!(order > 1.7, "{order}");
    }

    #[test]
    fn thinned_lines_stay_where_they_are() {
        let at = |k: usize| (0.01 * k as f64 * std::f64::consts::TAU).sin_cos();
        let circle: Vec<(f64, f64)> = (0..=100).map(at).collect();
        let few = simplify(&circle, 0.01, |&point| point);
        assert!(few.len() < 40, "{}", few.len());
        assert_eq!((few[0], few.last()), (circle[0], circle.last()));
        // A chord of a unit circle that is 0.01 away in the middle spans 2 acos(0.99) = 0.28.
        assert!(few.len() > 20, "{}", few.len());
        for pair in few.windows(2) {
            let middle = (0.5 * (pair[0].0 + pair[1].0), 0.5 * (pair[0].1 + pair[1].1));
            assert!((middle.0.hypot(middle.1) - 1.0).abs() < 0.011);
        }
        let back = [(0.0, 0.0), (2.0, 0.0), (1.0, 0.0)];
        assert_eq!(simplify(&back, 0.01, |&point| point), back);
        assert_eq!(simplify(&[], 0.01, |&point| point), []);
    }

    #[test]
    fn a_saddle_is_cut_by_its_mean_and_open_lines_end_at_the_border() {
        let (axis, values) = grid_of(2, |x, y| x * y);
        let grid = GridValues {
            x: &axis,
            y: &axis,
            values: &values,
        };
        let lines = grid.contour(1.0);
        assert_eq!(lines.len(), 2);
        for line in lines {
            assert_eq!(line.len(), 2);
            // Each line cuts off one of the corners (2, 2) and (-2, -2), where x y = 4; on the border x y = 1.
            assert!(line[0].0 * line[1].0 > 0.0);
            assert!(line.iter().all(|(x, y)| (x * y - 1.0).abs() < 1e-12));
        }
    }

    #[test]
    fn a_ring_has_two_closed_contours_and_gaps_have_none() {
        let ring = |x: f64, y: f64| (-(x.hypot(y) - 1.0).powi(2) / 0.05).exp();
        let (axis, mut values) = grid_of(61, ring);
        let grid = GridValues {
            x: &axis,
            y: &axis,
            values: &values,
        };
        let lines = grid.contour(0.5);
        assert_eq!(lines.len(), 2);
        assert!(lines.iter().all(|line| line.first() == line.last()));
        values.fill(f64::NAN);
        let empty = GridValues {
            values: &values,
            ..GridValues {
                x: &axis,
                y: &axis,
                values: &values,
            }
        };
        assert!(empty.contour(0.5).is_empty());
    }
}
