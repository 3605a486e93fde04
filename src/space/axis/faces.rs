//! Faces laid on places inside of cells.

use super::{Axis, even::even};
use crate::space::grading::Piece;

impl Axis {
    /// The same axis with faces on these places: the stretch around each is cut there, and its cells are shared out to
    /// both sides, so that they stay as many and become a little wider on one side than on the other. Places that faces
    /// lie on already, or beyond the range, change nothing; no more does a place in a stretch of one cell.
    pub(crate) fn with_faces_on(&self, places: &[f64]) -> Self {
        // Ends that are one place have cells of one width on either side.
        if self.is_modes() || self.closes {
            return self.clone();
        }
        let mut inside: Vec<f64> = places.to_vec();
        inside.retain(|&at| self.is_inside_cell(at));
        if inside.is_empty() {
            return self.clone();
        }
        let mut pieces = self.pieces.clone();
        for at in inside {
            let holds = |piece: &Piece| piece.from < at && at < piece.to && piece.cells > 1;
            let Some(index) = pieces.iter().position(holds) else {
                continue;
            };
            let whole = pieces[index].clone();
            let below = whole.coordinate(at).round() as usize;
            let below = below.clamp(1, whole.cells - 1);
            let part = |ends, first: usize, cells| {
                let counts = (whole.first_cell + first, cells);
                Piece::new(ends, counts, whole.bulk, &whole.terms)
            };
            let halves = [
                part((whole.from, at), 0, below),
                part((at, whole.to), below, whole.cells - below),
            ];
            pieces.splice(index..=index, halves);
        }
        Self {
            closes: self.closes,
            ..Self::from_pieces(even(pieces))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Grading;

    #[test]
    fn faces_are_laid_on_places_and_cells_stay_as_many() {
        let grading = Grading {
            at: vec![0.0],
            smallest: 0.05,
        };
        let axes = [
            Axis::uniform(-5.09, 5.07, 45).unwrap(),
            Axis::graded(-2.0, 3.0, 40, &grading).unwrap(),
        ];
        for axis in axes {
            let laid = axis.with_faces_on(&[0.651, -0.651, 0.0, 7.0]);
            assert_eq!(laid.count(), axis.count());
            assert!(laid.is_sound());
            for at in [0.651, -0.651, 0.0] {
                assert!(!laid.is_inside_cell(at), "{at}");
            }
            for cell in 0..axis.count() {
                let share = laid.width(cell) / axis.width(axis.find(laid.centre(cell)).unwrap());
                assert!((0.7..1.4).contains(&share), "cell {cell}: {share}");
            }
            assert_eq!(laid.with_faces_on(&[0.0, 0.651]), laid);
        }
    }
}
