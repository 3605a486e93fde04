//! Where a coordinate lies on an axis: its cell, and the faces beside it.

use super::Axis;

/// Distance, in widths of a cell, within which two coordinates are one place.
const SAME_PLACE: f64 = 1e-6;

impl Axis {
    /// The cell that holds `x`; `None` outside the range and for values that are not numbers.
    pub fn find(&self, x: f64) -> Option<usize> {
        if !(x >= self.from() && x <= self.to()) {
            return None;
        }
        let piece = self.pieces.iter().find(|piece| x < piece.to);
        let mut cell = match piece.or(self.pieces.last()) {
            Some(piece) => {
                let inside = (piece.coordinate(x).max(0.0) as usize).min(piece.cells - 1);
                piece.first_cell + inside
            }
            None => 0,
        };
        // The closed form and the stored edges may differ in the last digits.
        while cell > 0 && x < self.edges[cell] {
            cell -= 1;
        }
        while cell + 1 < self.count() && x >= self.edges[cell + 1] {
            cell += 1;
        }
        Some(cell)
    }

    /// The cell coordinate of `x`: 0 at the lower end, the number of cells at the upper one, one more a cell.
    pub(crate) fn coordinate(&self, x: f64) -> f64 {
        let piece = self.pieces.iter().find(|piece| x < piece.to);
        let piece = piece.or(self.pieces.last());
        piece.map_or(0.0, |piece| piece.first_cell as f64 + piece.coordinate(x))
    }

    /// Whether two coordinates are one place on this axis: to a millionth of the width of the cell that holds `at`.
    pub(crate) fn is_same_place(&self, at: f64, other: f64) -> bool {
        self.find(at)
            .is_some_and(|cell| (other - at).abs() <= SAME_PLACE * self.width(cell))
    }

    /// The face (number of the edge, the two ends included) that lies at `at`; see [`Axis::is_same_place`].
    pub(crate) fn face_at(&self, at: f64) -> Option<usize> {
        let cell = self.find(at)?;
        [cell, cell + 1]
            .into_iter()
            .find(|&face| self.is_same_place(at, self.edges[face]))
    }

    /// Whether a face lies at `at`.
    pub(crate) fn has_face_at(&self, at: f64) -> bool {
        self.face_at(at).is_some()
    }

    /// Whether `at` lies in the range, but inside a cell instead of on a face.
    pub(crate) fn is_inside_cell(&self, at: f64) -> bool {
        self.find(at).is_some() && !self.has_face_at(at)
    }

    /// The cells below and above `at`: both the same where it lies inside a cell or on an end, `None` outside the
    /// range.
    pub(crate) fn cells_beside(&self, at: f64) -> Option<[usize; 2]> {
        let cell = self.find(at)?;
        Some(match self.face_at(at) {
            Some(face) => [face.saturating_sub(1), face.min(self.count() - 1)],
            None => [cell, cell],
        })
    }
}
