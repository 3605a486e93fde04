//! One axis of a cell space: its edges, and finding the cell of a coordinate in constant time.
//!
//! A graded axis has the cell density (cells per unit length)
//! ρ(x) = ρ₀ + Σ_k B / √(w² + (x - c_k)²), a uniform bulk plus a sinh grading toward each point c_k.
//! Its integral, the *cell coordinate* u(x), is closed, so finding a cell costs a few logarithms, and a
//! face falls on every c_k. The bulk keeps a fixed share of the cells: too strong a grading starves it.
//!
//! An *axis of modes* carries a series in place of cells (`series.rs`, `hermite.rs`): its nodes are those of a Gauss
//! rule, and its "cells" hold the weights, so that sums over cells are the rule.

use self::even::{even, is_bend};
use super::SpaceError;
use super::grading::{BULK_SHARE, Grading, Piece, cubic_term, grading_terms};
use super::series::Series;

/// The cells of one axis. Cell `i` is `[edges[i], edges[i + 1])`; the last one includes its upper edge.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Axis {
    edges: Vec<f64>,
    /// Where the cell coordinate is half-way between a cell's edges, one a cell.
    nodes: Vec<f64>,
    pieces: Vec<Piece>,
    series: Option<Series>,
    /// Bins over which a series is laid out, over their usual number.
    #[cfg_attr(feature = "serde", serde(default = "once"))]
    layout: f64,
    /// Whether its ends are one place.
    closes: bool,
}

/// A finer axis has a mode more for each so many: one alone shows little of an error that falls as a power of their
/// number.
const MODES_A_FINER_MODE: usize = 4;

/// The usual number, as a factor.
fn once() -> f64 {
    1.0
}

impl Axis {
    /// Whether every cell has its edges, its node and, but for modes, its piece: what was read from a file may not.
    pub(crate) fn is_sound(&self) -> bool {
        let ascending = self.edges.windows(2).all(|pair| pair[0] < pair[1]);
        let mut cells = 0;
        let joined = self.pieces.iter().all(|piece| {
            let follows = piece.first_cell == cells && piece.cells > 0;
            cells = cells.saturating_add(piece.cells);
            follows
        });
        let held = if self.is_modes() { 0 } else { self.nodes.len() };
        ascending && self.edges.len() == self.nodes.len() + 1 && joined && cells == held
    }

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

    /// Cells whose distance from the marked ends (lower, upper) grows as the cube of their number there, and whose
    /// width is even elsewhere: for densities that are as the cube root of the distance from an end.
    ///
    /// # Errors
    /// As [`Axis::uniform`].
    pub(crate) fn toward_ends(
        from: f64,
        to: f64,
        count: usize,
        ends: [bool; 2],
    ) -> Result<Self, SpaceError> {
        Self::check(from, to, count)?;
        let marked = [from, to]
            .into_iter()
            .zip(ends)
            .filter(|(_, marked)| *marked);
        let terms: Vec<_> = marked
            .map(|(end, _)| cubic_term((from, to), count, end))
            .collect();
        let bulk = count as f64 / (to - from);
        Ok(Self::from_pieces(vec![Piece::new(
            (from, to),
            (0, count),
            bulk,
            &terms,
        )]))
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
        Ok(Self::from_pieces(even((0..pieces).map(piece).collect())))
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
            series: None,
            layout: 1.0,
            closes: false,
        }
    }

    /// The same axis with about `factor` times as many cells (fewer below 1, at least two a stretch between graded
    /// points), graded alike: faces stay on the points it is graded toward, and an even number of cells stays even, so
    /// that a face stays in the middle. An axis of modes gets a quarter more of them, at least one (none below 1), and
    /// `factor` times as many bins over which its series is laid out.
    pub(crate) fn refined(&self, factor: f64) -> Self {
        if self.is_modes() {
            let more = (self.mode_number() / MODES_A_FINER_MODE).max(1);
            let count = self.mode_number() + if factor > 1.0 { more } else { 0 };
            let finer = self.with_modes(count.min(self.most_modes()));
            let layout = self.layout * factor.max(1.0);
            return finer.map_or_else(|_| self.clone(), |axis| Self { layout, ..axis });
        }
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
        Self {
            closes: self.closes,
            ..Self::from_pieces(even(pieces.collect()))
        }
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

    /// Derivative dx/du of x by the cell coordinate (the local cell width) at the node of a cell; the weight of a node
    /// of modes.
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

    /// The same at a place; `None` outside of the range.
    pub(crate) fn stretch_at(&self, x: f64) -> Option<f64> {
        let cell = self.find(x)?;
        let piece = self.piece_of(cell);
        Some(piece.map_or(self.width(cell), |piece| piece.stretch(x)))
    }

    /// Whether a cell and those around it up to the next graded place have one width.
    pub(crate) fn has_even_cells(&self, cell: usize) -> bool {
        self.piece_of(cell).is_none_or(Piece::is_even)
    }

    /// Distance of a place from the node of its cell, in the cell coordinate: -½ and ½ at the edges.
    pub(crate) fn offset(&self, cell: usize, x: f64) -> f64 {
        match self.piece_of(cell) {
            Some(piece) => piece.coordinate(x) - (cell - piece.first_cell) as f64 - 0.5,
            None => (x - self.nodes[cell]) / self.width(cell),
        }
    }

    fn piece_of(&self, cell: usize) -> Option<&Piece> {
        let holds = |piece: &&Piece| cell < piece.first_cell + piece.cells;
        self.pieces.iter().find(holds)
    }

    /// Whether all cells have the same width, but for what faces on given places ask for.
    pub(crate) fn is_uniform(&self) -> bool {
        let is_even = |piece: &Piece| piece.terms.iter().all(|term| is_bend(term, self));
        !self.is_modes() && self.pieces.iter().all(is_even)
    }
}

mod displaced;
mod even;
mod faces;
mod modes;
mod place;
#[cfg(test)]
mod tests;
mod turn;
