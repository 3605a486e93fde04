//! Axes moved as a whole, and over a wider range.

use super::{Axis, even::is_bend};
use crate::space::grading::Piece;
use crate::space::{Grading, SpaceError};

impl Axis {
    /// The same cells, moved by a distance. Axes of modes and those that close on themselves stay where they are.
    pub(crate) fn displaced(&self, by: f64) -> Self {
        if self.is_modes() || self.closes {
            return self.clone();
        }
        let pieces = self.pieces.iter().map(|piece| {
            let terms = piece.terms.iter();
            let terms: Vec<_> = terms.map(|&(a, at, width)| (a, at + by, width)).collect();
            let ends = (piece.from + by, piece.to + by);
            let moved = Piece::new(ends, (piece.first_cell, piece.cells), piece.bulk, &terms);
            match piece.more == 0.0 {
                true => moved,
                false => moved.with_scale(piece.scale),
            }
        });
        Self::from_pieces(pieces.collect())
    }

    /// An axis over another range with as many cells a length as this one, which has faces on these places: graded
    /// toward them down to the smallest of its cells where it is graded, or else even but for the faces. What else it
    /// is graded toward stays, but for places that are left.
    ///
    /// # Errors
    /// As [`Axis::graded`].
    pub(crate) fn about(
        &self,
        (from, to): (f64, f64),
        places: &[f64],
        left: &[f64],
    ) -> Result<Self, SpaceError> {
        let a_length = self.count() as f64 / (self.to() - self.from());
        let count = (a_length * (to - from)).round() as usize;
        let widths = (0..self.count()).map(|cell| self.width(cell));
        let smallest = widths.fold(f64::INFINITY, f64::min);
        if self.is_uniform() || smallest >= (to - from) / count as f64 {
            return Ok(Self::uniform(from, to, count)?.with_faces_on(places));
        }
        let terms = self.pieces.first().map_or(&[][..], |piece| &piece.terms);
        let graded = terms
            .iter()
            .filter(|term| term.2 > 0.0 && !is_bend(term, self));
        let own = graded.map(|term| term.1);
        let near = |at: f64, all: &[f64]| all.iter().any(|one| (one - at).abs() < smallest);
        let own = own.filter(|&at| !near(at, places) && !near(at, left));
        let at = places.iter().copied().chain(own);
        let at: Vec<f64> = at.filter(|at| (from..=to).contains(at)).collect();
        Self::graded(from, to, count, &Grading { at, smallest })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moved_cells_are_as_wide_and_lie_elsewhere() {
        let grading = Grading {
            at: vec![0.5],
            smallest: 0.02,
        };
        let axis = Axis::graded(-2.0, 3.0, 50, &grading).unwrap();
        let moved = axis.displaced(0.7);
        assert!(moved.is_sound() && moved.has_face_at(1.2));
        for (one, other) in axis.edges().iter().zip(moved.edges()) {
            assert!((one + 0.7 - other).abs() < 1e-12);
        }
        for cell in 0..50 {
            assert_eq!(moved.find(moved.centre(cell)), Some(cell));
        }
    }

    #[test]
    fn a_wider_axis_has_as_fine_cells_and_faces_where_they_are_wanted() {
        let grading = Grading {
            at: vec![1.5],
            smallest: 0.02,
        };
        for axis in [
            Axis::graded(-4.0, 4.0, 100, &grading).unwrap(),
            Axis::uniform(-4.0, 4.0, 100).unwrap(),
        ] {
            let about = axis.about((-5.0, 4.5), &[0.333], &[1.5]).unwrap();
            assert!(about.has_face_at(0.333));
            assert_eq!((about.from(), about.to(), about.count()), (-5.0, 4.5, 119));
            let smallest = |axis: &Axis| {
                let widths = (0..axis.count()).map(|cell| axis.width(cell));
                widths.fold(f64::INFINITY, f64::min)
            };
            assert!((smallest(&about) / smallest(&axis) - 1.0).abs() < 0.1);
        }
    }
}
