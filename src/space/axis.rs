//! One axis of a cell space: its edges, and finding the cell of a coordinate in constant time.
//!
//! A graded axis has the cell density (cells per unit length)
//! ρ(x) = ρ₀ + Σ_k B / √(w² + (x - c_k)²), a uniform bulk plus a sinh grading toward each point c_k.
//! Its integral, the *cell coordinate* u(x), is closed, so finding a cell costs a few logarithms, and a
//! face falls on every c_k. The bulk keeps a fixed share of the cells: too strong a grading starves it.

use super::SpaceError;

/// Share of the cells that a graded axis spreads evenly over its range.
const BULK_SHARE: f64 = 0.6;

/// Points toward which an axis is refined.
#[derive(Debug, Clone, PartialEq)]
pub struct Grading {
    /// The points, in the range (its ends included); a face falls on each.
    pub at: Vec<f64>,
    /// Wanted width of the cells at the points; the widths reached differ by a few per cent.
    pub smallest: f64,
}

/// The cells of one axis. Cell `i` is `[edges[i], edges[i + 1])`; the last one includes its upper edge.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    edges: Vec<f64>,
    /// Where the cell coordinate is half-way between a cell's edges, one a cell.
    nodes: Vec<f64>,
    pieces: Vec<Piece>,
}

/// A stretch between two graded points (or ends) that holds a whole number of cells.
#[derive(Debug, Clone, PartialEq)]
struct Piece {
    from: f64,
    to: f64,
    first_cell: usize,
    cells: usize,
    bulk: f64,
    terms: Vec<(f64, f64, f64)>,
    raw_from: f64,
    scale: f64,
}

impl Piece {
    /// Cell coordinate before it is scaled to a whole number of cells.
    fn raw(bulk: f64, terms: &[(f64, f64, f64)], x: f64) -> f64 {
        let graded: f64 = terms
            .iter()
            .map(|&(amplitude, centre, width)| amplitude * ((x - centre) / width).asinh())
            .sum();
        bulk * x + graded
    }

    fn new(ends: (f64, f64), cells: (usize, usize), bulk: f64, terms: &[(f64, f64, f64)]) -> Self {
        let raw_from = Self::raw(bulk, terms, ends.0);
        let span = Self::raw(bulk, terms, ends.1) - raw_from;
        Self {
            from: ends.0,
            to: ends.1,
            first_cell: cells.0,
            cells: cells.1,
            bulk,
            terms: terms.to_vec(),
            raw_from,
            scale: cells.1 as f64 / span,
        }
    }

    /// Cell coordinate inside the piece: 0 at `from`, `cells` at `to`.
    fn coordinate(&self, x: f64) -> f64 {
        (Self::raw(self.bulk, &self.terms, x) - self.raw_from) * self.scale
    }

    /// dx/du, the width of a cell that would lie evenly about `x`.
    fn stretch(&self, x: f64) -> f64 {
        let graded: f64 = self
            .terms
            .iter()
            .map(|&(amplitude, centre, width)| amplitude / (x - centre).hypot(width))
            .sum();
        1.0 / (self.scale * (self.bulk + graded))
    }

    /// The x with the given cell coordinate, by bisection (used once an edge).
    fn inverse(&self, coordinate: f64) -> f64 {
        if self.terms.is_empty() {
            return self.from + (self.to - self.from) * coordinate / self.cells as f64;
        }
        let (mut low, mut high) = (self.from, self.to);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if self.coordinate(middle) < coordinate {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }
}

impl Axis {
    /// Cells of equal width.
    ///
    /// # Errors
    /// [`SpaceError::Range`] or [`SpaceError::Count`].
    pub fn uniform(from: f64, to: f64, count: usize) -> Result<Self, SpaceError> {
        Self::check(from, to, count)?;
        let piece = Piece::new((from, to), (0, count), count as f64 / (to - from), &[]);
        Ok(Self::from_pieces(vec![piece]))
    }

    /// Cells graded toward points; see the module's text for the law.
    ///
    /// # Errors
    /// Any [`SpaceError`] that concerns an axis.
    pub fn graded(from: f64, to: f64, count: usize, grading: &Grading) -> Result<Self, SpaceError> {
        Self::check(from, to, count)?;
        let mut points = grading.at.clone();
        points.sort_by(f64::total_cmp);
        for (index, &at) in points.iter().enumerate() {
            let inside = at >= from && at <= to;
            if !inside || (index > 0 && points[index - 1] == at) {
                return Err(SpaceError::GradingPoint { at, from, to });
            }
        }
        if points.is_empty() {
            return Self::uniform(from, to, count);
        }
        let uniform = (to - from) / count as f64;
        let smallest = grading.smallest;
        if !(smallest > 0.0 && smallest < uniform) {
            return Err(SpaceError::GradingWidth { smallest, uniform });
        }
        let bulk = BULK_SHARE / uniform;
        let terms = grading_terms((from, to), count, bulk, &points, smallest);
        Self::split(from, to, count, bulk, &terms)
    }

    /// Cuts the axis at the graded points and gives each piece a whole number of cells.
    fn split(
        from: f64,
        to: f64,
        count: usize,
        bulk: f64,
        terms: &[(f64, f64, f64)],
    ) -> Result<Self, SpaceError> {
        let mut ends = vec![from];
        let inside = |at: &f64| *at > from && *at < to;
        ends.extend(terms.iter().map(|term| term.1).filter(inside));
        ends.push(to);
        let pieces = ends.len() - 1;
        if count < pieces {
            return Err(SpaceError::GradingCount {
                count,
                points: terms.len(),
            });
        }
        let origin = Piece::raw(bulk, terms, from);
        let total = Piece::raw(bulk, terms, to) - origin;
        let mut cuts = vec![0];
        for (index, &end) in ends.iter().enumerate().skip(1) {
            let share = (Piece::raw(bulk, terms, end) - origin) / total * count as f64;
            // Every piece before and after keeps at least one cell.
            let cut = (share.round() as usize).clamp(cuts[index - 1] + 1, count - (pieces - index));
            cuts.push(cut);
        }
        let piece = |index: usize| {
            let cells = (cuts[index], cuts[index + 1] - cuts[index]);
            Piece::new((ends[index], ends[index + 1]), cells, bulk, terms)
        };
        Ok(Self::from_pieces((0..pieces).map(piece).collect()))
    }

    fn check(from: f64, to: f64, count: usize) -> Result<(), SpaceError> {
        if !(from.is_finite() && to.is_finite() && from < to && (to - from).is_finite()) {
            return Err(SpaceError::Range { from, to });
        }
        if count < 2 {
            return Err(SpaceError::Count { count });
        }
        Ok(())
    }

    fn from_pieces(pieces: Vec<Piece>) -> Self {
        let mut edges = Vec::new();
        let mut nodes = Vec::new();
        for piece in &pieces {
            edges.push(piece.from);
            edges.extend((1..piece.cells).map(|cell| piece.inverse(cell as f64)));
            nodes.extend((0..piece.cells).map(|cell| piece.inverse(cell as f64 + 0.5)));
        }
        if let Some(last) = pieces.last() {
            edges.push(last.to);
        }
        Self {
            edges,
            nodes,
            pieces,
        }
    }

    /// The same axis with about `factor` times as many cells (fewer below 1, at least two a stretch between graded points), graded
    /// alike: faces stay on the points it is graded toward, and an even number of cells stays even, so that a face stays in the middle.
    pub fn refined(&self, factor: f64) -> Self {
        let finer = |cells: usize| {
            let odd = cells % 2;
            2 * (0.5 * (cells as f64 * factor - odd as f64)).round() as usize + odd
        };
        let mut first_cell = 0;
        let pieces = self.pieces.iter().map(|piece| {
            let least = if factor < 1.0 { 2 } else { piece.cells };
            let cells = finer(piece.cells).max(least);
            let counts = (first_cell, cells);
            first_cell += cells;
            Piece::new((piece.from, piece.to), counts, piece.bulk, &piece.terms)
        });
        Self::from_pieces(pieces.collect())
    }

    /// Number of cells.
    pub fn count(&self) -> usize {
        self.edges.len() - 1
    }

    /// The `count + 1` edges, ascending.
    pub fn edges(&self) -> &[f64] {
        &self.edges
    }

    /// Lower end of the range.
    pub fn from(&self) -> f64 {
        self.edges[0]
    }

    /// Upper end of the range.
    pub fn to(&self) -> f64 {
        self.edges[self.count()]
    }

    /// Width of a cell.
    pub fn width(&self, cell: usize) -> f64 {
        self.edges[cell + 1] - self.edges[cell]
    }

    /// Middle of a cell.
    pub fn centre(&self, cell: usize) -> f64 {
        0.5 * (self.edges[cell] + self.edges[cell + 1])
    }

    /// The middles of all cells, ascending.
    pub fn centres(&self) -> Vec<f64> {
        (0..self.count()).map(|cell| self.centre(cell)).collect()
    }

    /// Nodes of the cells, ascending: where the cell coordinate is half-way between a cell's edges. On a
    /// uniform axis these are the middles, on a graded one they differ from them in second order.
    pub fn nodes(&self) -> &[f64] {
        &self.nodes
    }

    /// Derivative dx/du of x by the cell coordinate (the local cell width) at the node of a cell.
    pub(crate) fn node_stretch(&self, cell: usize) -> f64 {
        self.piece_of(cell)
            .map_or(self.width(cell), |piece| piece.stretch(self.nodes[cell]))
    }

    /// Derivative dx/du of x by the cell coordinate at an edge, seen from the cell above (below at the last).
    pub(crate) fn edge_stretch(&self, edge: usize) -> f64 {
        let cell = edge.min(self.count() - 1);
        self.piece_of(cell)
            .map_or(self.width(cell), |piece| piece.stretch(self.edges[edge]))
    }

    fn piece_of(&self, cell: usize) -> Option<&Piece> {
        let holds = |piece: &&Piece| cell < piece.first_cell + piece.cells;
        self.pieces.iter().find(holds)
    }

    /// Whether all cells have the same width.
    pub fn is_uniform(&self) -> bool {
        self.pieces.iter().all(|piece| piece.terms.is_empty())
    }

    /// The cell that holds `x`; `None` outside the range and for values that are not numbers.
    pub fn find(&self, x: f64) -> Option<usize> {
        if !(x >= self.from() && x <= self.to()) {
            return None;
        }
        let piece = self.pieces.iter().find(|piece| x < piece.to);
        let piece = piece.or(self.pieces.last())?;
        let inside = (piece.coordinate(x).max(0.0) as usize).min(piece.cells - 1);
        let mut cell = piece.first_cell + inside;
        // The closed form and the stored edges may differ in the last digits.
        while cell > 0 && x < self.edges[cell] {
            cell -= 1;
        }
        while cell + 1 < self.count() && x >= self.edges[cell + 1] {
            cell += 1;
        }
        Some(cell)
    }

    /// Whether one of the edges is `at`, to a millionth of the cell's width.
    pub fn has_face_at(&self, at: f64) -> bool {
        self.find(at).is_some_and(|cell| {
            let tolerance = 1e-6 * self.width(cell);
            (at - self.edges[cell]).abs() <= tolerance
                || (self.edges[cell + 1] - at).abs() <= tolerance
        })
    }
}

/// Amplitude, centre and width of each grading term, such that the cells at the points are about
/// `smallest` wide and the terms hold the cells that the bulk leaves.
fn grading_terms(
    (from, to): (f64, f64),
    count: usize,
    bulk: f64,
    points: &[f64],
    smallest: f64,
) -> Vec<(f64, f64, f64)> {
    let wanted = (1.0 - BULK_SHARE) * count as f64;
    let peak = 1.0 / smallest - bulk;
    let terms = |width: f64| -> Vec<(f64, f64, f64)> {
        points.iter().map(|&at| (peak * width, at, width)).collect()
    };
    let cells = |width: f64| {
        let terms = terms(width);
        Piece::raw(0.0, &terms, to) - Piece::raw(0.0, &terms, from)
    };
    // The number of cells grows with the width; bisect its logarithm.
    let (mut low, mut high) = (1e-12 * smallest, 1e3 * (to - from));
    for _ in 0..200 {
        let middle = (low * high).sqrt();
        if cells(middle) < wanted {
            low = middle;
        } else {
            high = middle;
        }
    }
    terms((low * high).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn uniform_edges_are_exact_at_the_ends_and_symmetric() {
        let axis = Axis::uniform(-3.0, 3.0, 50).unwrap();
        assert_eq!(axis.from(), -3.0);
        assert_eq!(axis.to(), 3.0);
        assert_eq!(axis.edges()[25], 0.0);
        assert!(axis.has_face_at(0.0));
        assert!(!Axis::uniform(-3.0, 3.0, 51).unwrap().has_face_at(0.0));
    }

    #[test]
    fn grading_reaches_the_width_and_keeps_the_bulk() {
        let grading = Grading {
            at: vec![0.0],
            smallest: 0.002,
        };
        let axis = Axis::graded(-4.0, 4.0, 100, &grading).unwrap();
        let cell = axis.find(0.0).unwrap();
        assert!(axis.has_face_at(0.0));
        let narrowest = axis.width(cell);
        assert!((narrowest / 0.002 - 1.0).abs() < 0.15, "{narrowest}");
        let widest = (0..100).map(|i| axis.width(i)).fold(0.0, f64::max);
        assert!(widest <= 0.08 / BULK_SHARE, "{widest}");
    }

    #[test]
    fn nodes_lie_inside_and_stretches_integrate_to_the_width() {
        let grading = Grading {
            at: vec![0.0],
            smallest: 0.01,
        };
        let axis = Axis::graded(-4.0, 4.0, 200, &grading).unwrap();
        for cell in 0..axis.count() {
            let (from, to) = (axis.edges()[cell], axis.edges()[cell + 1]);
            assert!(from < axis.nodes()[cell] && axis.nodes()[cell] < to);
            // Simpson's rule for the integral of dx/du over a cell.
            let ends = axis.edge_stretch(cell) + axis.edge_stretch(cell + 1);
            let width = (ends + 4.0 * axis.node_stretch(cell)) / 6.0;
            assert!(
                (width / axis.width(cell) - 1.0).abs() < 1e-5,
                "{cell}: {width}"
            );
        }
    }

    #[test]
    fn faces_fall_on_several_graded_points() {
        let grading = Grading {
            at: vec![0.7, -1.3],
            smallest: 0.01,
        };
        let axis = Axis::graded(-2.0, 3.0, 64, &grading).unwrap();
        assert_eq!(axis.count(), 64);
        assert!(axis.has_face_at(0.7) && axis.has_face_at(-1.3));
    }

    #[test]
    fn bad_axes_are_refused() {
        assert!(matches!(
            Axis::uniform(1.0, 1.0, 5),
            Err(SpaceError::Range { .. })
        ));
        assert!(matches!(
            Axis::uniform(0.0, f64::NAN, 5),
            Err(SpaceError::Range { .. })
        ));
        assert!(matches!(
            Axis::uniform(0.0, 1.0, 1),
            Err(SpaceError::Count { .. })
        ));
        let outside = Grading {
            at: vec![2.0],
            smallest: 0.01,
        };
        assert!(matches!(
            Axis::graded(0.0, 1.0, 10, &outside),
            Err(SpaceError::GradingPoint { .. })
        ));
        let wide = Grading {
            at: vec![0.5],
            smallest: 0.5,
        };
        assert!(matches!(
            Axis::graded(0.0, 1.0, 10, &wide),
            Err(SpaceError::GradingWidth { .. })
        ));
    }

    #[test]
    fn cells_can_be_graded_toward_the_ends() {
        let grading = Grading {
            at: vec![-1.0, 1.0],
            smallest: 0.02,
        };
        let axis = Axis::graded(-1.0, 1.0, 20, &grading).unwrap();
        assert_eq!((axis.count(), axis.from(), axis.to()), (20, -1.0, 1.0));
        for (cell, mirrored) in (0..10).zip((10..20).rev()) {
            assert!((axis.width(cell) - axis.width(mirrored)).abs() < 1e-12);
            assert!(cell == 0 || axis.width(cell) > axis.width(cell - 1));
        }
        assert!(axis.width(0) < 0.03, "{}", axis.width(0));
    }

    proptest! {
        #[test]
        fn every_point_is_found_in_the_cell_whose_edges_hold_it(
            from in -10.0..0.0f64, length in 0.1..20.0f64, count in 4usize..200,
            place in 0.05..0.95f64, ratio in 0.01..0.9f64, inside in 0.0..1.0f64,
        ) {
            let to = from + length;
            let grading = Grading {
                at: vec![from + place * length],
                smallest: ratio * length / count as f64,
            };
            for axis in [Axis::uniform(from, to, count).unwrap(),
                         Axis::graded(from, to, count, &grading).unwrap()] {
                prop_assert_eq!(axis.count(), count);
                prop_assert!(axis.edges().windows(2).all(|pair| pair[0] < pair[1]));
                let x = from + inside * length;
                let cell = axis.find(x).unwrap();
                prop_assert!(axis.edges()[cell] <= x && x <= axis.edges()[cell + 1]);
                prop_assert_eq!(axis.find(to), Some(count - 1));
                prop_assert_eq!(axis.find(to + 1.0), None);
                prop_assert_eq!(axis.find(f64::NAN), None);
            }
        }
    }
}
