//! The grading of an axis: its law, and the stretches between graded points that hold whole numbers of cells.

use crate::numerics::bisected;

/// Share of the cells that a graded axis spreads evenly over its range.
pub(super) const BULK_SHARE: f64 = 0.6;

/// Points toward which an axis is refined.
#[derive(Debug, Clone, PartialEq)]
pub struct Grading {
    /// The points, in the range (its ends included); a face falls on each.
    pub at: Vec<f64>,
    /// Wanted width of the cells at the points; the widths reached differ by a few per cent.
    pub smallest: f64,
}

/// Where cells graded as the cube of the distance from an end go over into even ones, as a share of the range.
const CUBIC_SHARE: f64 = 0.15;

/// The term that grades cells as the cube of the distance from an end: its width is zero.
pub(super) fn cubic_term((from, to): (f64, f64), count: usize, end: f64) -> (f64, f64, f64) {
    let bulk = count as f64 / (to - from);
    (bulk * (CUBIC_SHARE * (to - from)).powf(2.0 / 3.0), end, 0.0)
}

/// A stretch between two graded points (or ends) that holds a whole number of cells. A term is its amplitude, its
/// centre and its width: a sinh grading, or cells as the cube of the distance where the width is zero.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Piece {
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) first_cell: usize,
    pub(super) cells: usize,
    pub(super) bulk: f64,
    pub(super) terms: Vec<(f64, f64, f64)>,
    pub(super) raw_from: f64,
    pub(super) scale: f64,
    /// Cells that the law lacks, or has too many of: their density is largest in the middle, and zero with its slope
    /// at both ends.
    pub(super) more: f64,
}

impl Piece {
    /// Cell coordinate before it is scaled to a whole number of cells.
    pub(super) fn raw(bulk: f64, terms: &[(f64, f64, f64)], x: f64) -> f64 {
        let graded: f64 = terms
            .iter()
            .map(|&(amplitude, centre, width)| {
                if width == 0.0 {
                    return amplitude * (x - centre).cbrt();
                }
                amplitude * ((x - centre) / width).asinh()
            })
            .sum();
        bulk * x + graded
    }

    pub(super) fn new(
        ends: (f64, f64),
        cells: (usize, usize),
        bulk: f64,
        terms: &[(f64, f64, f64)],
    ) -> Self {
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
            more: 0.0,
        }
    }

    /// The same cells by the law times a scale, and what this lacks.
    pub(super) fn with_scale(self, scale: f64) -> Self {
        let span = Self::raw(self.bulk, &self.terms, self.to) - self.raw_from;
        Self {
            scale,
            more: self.cells as f64 - scale * span,
            ..self
        }
    }

    /// The share of the stretch that lies below a place.
    fn share(&self, x: f64) -> f64 {
        ((x - self.from) / (self.to - self.from)).clamp(0.0, 1.0)
    }

    /// Cell coordinate inside the piece: 0 at `from`, `cells` at `to`.
    pub(super) fn coordinate(&self, x: f64) -> f64 {
        let by_law = (Self::raw(self.bulk, &self.terms, x) - self.raw_from) * self.scale;
        if self.more == 0.0 {
            return by_law;
        }
        let share = self.share(x);
        by_law + self.more * share.powi(3) * (10.0 - 15.0 * share + 6.0 * share * share)
    }

    /// dx/du, the width of a cell that would lie evenly about `x`.
    pub(super) fn stretch(&self, x: f64) -> f64 {
        1.0 / (self.scale * Self::density(self.bulk, &self.terms, x) + self.density_of_more(x))
    }

    /// The derivative of what is added to the law.
    pub(super) fn density_of_more(&self, x: f64) -> f64 {
        let share = self.share(x);
        let bump = 30.0 * share * share * (1.0 - share).powi(2);
        self.more * bump / (self.to - self.from)
    }

    /// The derivative of the cell coordinate before it is scaled.
    pub(super) fn density(bulk: f64, terms: &[(f64, f64, f64)], x: f64) -> f64 {
        let graded: f64 = terms
            .iter()
            .map(|&(amplitude, centre, width)| {
                if width == 0.0 {
                    return amplitude / (3.0 * (x - centre).cbrt().powi(2));
                }
                amplitude / (x - centre).hypot(width)
            })
            .sum();
        bulk + graded
    }

    /// Whether all of its cells have one width.
    pub(super) fn is_even(&self) -> bool {
        self.terms.is_empty() && self.more == 0.0
    }

    /// The x with the given cell coordinate, by bisection (used once an edge).
    pub(super) fn inverse(&self, coordinate: f64) -> f64 {
        if self.is_even() {
            return self.from + (self.to - self.from) * coordinate / self.cells as f64;
        }
        let is_first = |middle: f64| self.coordinate(middle) < coordinate;
        bisected((self.from, self.to), 200, is_first)
    }
}

/// Amplitude, centre and width of each grading term, such that the cells at the points are about
/// `smallest` wide and the terms hold the cells that the bulk leaves.
pub(super) fn grading_terms(
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
