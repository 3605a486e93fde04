//! Widths of cells that do not jump where stretches with whole numbers of cells meet.
//!
//! Each stretch between faces on given places has a whole number of cells, which a common law of widths does not give
//! by itself. Stretched one by one, widths jump where they meet, and what is differenced there is of order one. The law
//! is bent a little over the whole range instead, so that it gives whole numbers everywhere.

use nalgebra::{DMatrix, DVector};

use super::Axis;
use crate::space::grading::Piece;

/// Most by which the law may be bent anywhere, as a factor of the width of cells.
const MOST: f64 = 1.3;

/// Width of a bend at least, as a share of the range: gradings are narrower.
const WIDE: f64 = 0.2;

/// Places between ends at which that is looked at, beside the ends of all stretches.
const LOOKED_AT: usize = 64;

/// Difference of widths where stretches meet, relative, below which they are even.
const EVEN: f64 = 1e-9;

/// The same stretches by a law that gives each its number of cells: one that is bent over the whole range, or, where it
/// would have to be bent too much, one with more or fewer cells in the middle of each stretch. They are as they were
/// where they follow from no common law, are even, or neither serves.
pub(super) fn even(pieces: Vec<Piece>) -> Vec<Piece> {
    let even = match are_uneven(&pieces) {
        true => bent(&pieces).or_else(|| with_more(&pieces)),
        false => None,
    };
    even.unwrap_or(pieces)
}

/// Whether stretches follow from a common law, but not with one scale.
fn are_uneven(pieces: &[Piece]) -> bool {
    let [first, rest @ ..] = pieces else {
        return false;
    };
    let is_common = |one: &Piece| one.bulk == first.bulk && one.terms == first.terms;
    let is_even = |one: &Piece| (one.scale / first.scale - 1.0).abs() <= EVEN;
    rest.iter().all(is_common) && !rest.iter().all(is_even)
}

/// The stretches by the common law with one scale; what it lacks of whole cells is added about the middle of each.
fn with_more(pieces: &[Piece]) -> Option<Vec<Piece>> {
    let cells: f64 = pieces.iter().map(|one| one.cells as f64).sum();
    let span: f64 = pieces.iter().map(|one| one.cells as f64 / one.scale).sum();
    let scale = cells / span;
    let made: Vec<Piece> = pieces
        .iter()
        .map(|one| one.clone().with_scale(scale))
        .collect();
    let is_gentle = |piece: &Piece| {
        (0..=LOOKED_AT).all(|k| {
            let x = piece.from + (piece.to - piece.from) * k as f64 / LOOKED_AT as f64;
            let law = scale * Piece::density(piece.bulk, &piece.terms, x);
            is_little(1.0 + piece.density_of_more(x) / law)
        })
    };
    made.iter().all(is_gentle).then_some(made)
}

/// Whether a term of a law is a bend of it, and no grading.
pub(super) fn is_bend(term: &(f64, f64, f64), axis: &Axis) -> bool {
    term.2 >= WIDE * (axis.to() - axis.from())
}

fn bent(pieces: &[Piece]) -> Option<Vec<Piece>> {
    let first = pieces.first()?;
    let (scale, bends) = bends(first, pieces)?;
    let bulk = scale * first.bulk;
    let mut terms: Vec<Term> = Vec::new();
    let own = first.terms.iter();
    let own = own.map(|&(size, at, wide)| (scale * size, at, wide));
    for term in own.chain(bends) {
        let is_same = |one: &&mut Term| one.1 == term.1 && one.2 == term.2;
        match terms.iter_mut().find(is_same) {
            Some(same) => same.0 += term.0,
            None => terms.push(term),
        }
    }
    let made = pieces.iter().map(|one| {
        let (ends, cells) = ((one.from, one.to), (one.first_cell, one.cells));
        Piece::new(ends, cells, bulk, &terms)
    });
    is_gentle(first, pieces, (bulk, &terms)).then(|| made.collect())
}

/// A bend of the law of widths: its size, its middle and its width.
type Term = (f64, f64, f64);

/// What the law of the first stretch is multiplied by, and bends about the middle of each stretch but the longest, as
/// wide as the stretch, with which every stretch holds its cells. `None` where there are no such bends.
fn bends(first: &Piece, pieces: &[Piece]) -> Option<(f64, Vec<Term>)> {
    let length = |piece: &Piece| piece.to - piece.from;
    let longest = pieces.iter().map(length).fold(0.0, f64::max);
    let longest = pieces.iter().position(|piece| length(piece) == longest)?;
    let others = pieces.iter().enumerate().filter(|one| one.0 != longest);
    let bend = |piece: &Piece| (1.0, 0.5 * (piece.from + piece.to), length(piece));
    let bends: Vec<Term> = others.map(|(_, piece)| bend(piece)).collect();
    let rows = pieces.len();
    let held = DMatrix::from_fn(rows, rows, |piece, unknown| {
        let of = |x: f64| match unknown.checked_sub(1) {
            None => Piece::raw(first.bulk, &first.terms, x),
            Some(bend) => Piece::raw(0.0, &bends[bend..=bend], x),
        };
        of(pieces[piece].to) - of(pieces[piece].from)
    });
    let wanted = DVector::from_fn(rows, |piece, _| pieces[piece].cells as f64);
    let found = held.lu().solve(&wanted)?;
    let sizes = found.iter().skip(1);
    let bends = bends.iter().zip(sizes);
    let bends = bends.map(|(&(_, at, wide), &size)| (size, at, wide));
    Some((found[0], bends.collect()))
}

/// Whether a bent law makes no cell much wider or narrower than the law of the first stretch does with as many cells.
fn is_gentle(first: &Piece, pieces: &[Piece], (bulk, terms): (f64, &[Term])) -> bool {
    let from = first.from;
    let to = pieces.last().map_or(first.to, |last| last.to);
    let mut places: Vec<f64> = pieces.iter().map(|one| one.from).collect();
    places.extend((0..=LOOKED_AT).map(|k| from + (to - from) * k as f64 / LOOKED_AT as f64));
    let total: f64 = pieces.iter().map(|one| one.cells as f64).sum();
    let law = |x: f64| Piece::raw(first.bulk, &first.terms, x);
    let even_law = total / (law(to) - law(from));
    places.iter().all(|&x| {
        let own = even_law * Piece::density(first.bulk, &first.terms, x);
        is_little(Piece::density(bulk, terms, x) / own)
    })
}

/// Whether cells become so many times as many by no more than the law may be bent; at an end where it has a cusp nobody
/// knows.
fn is_little(factor: f64) -> bool {
    (MOST.recip()..=MOST).contains(&factor) || factor.is_nan()
}

#[cfg(test)]
mod tests {
    use super::super::Axis;
    use crate::space::Grading;

    /// The largest change of width from cell to cell, relative.
    fn largest_change(axis: &Axis) -> f64 {
        let pairs = (1..axis.count()).map(|cell| (axis.width(cell) / axis.width(cell - 1)).ln());
        pairs.map(f64::abs).fold(0.0, f64::max)
    }

    #[test]
    fn widths_do_not_jump_at_places_that_faces_are_laid_on() {
        let axis = Axis::uniform(-5.09, 5.07, 45).unwrap();
        for places in [vec![0.651], vec![-2.3, 2.1], vec![-3.1, 0.2, 2.4]] {
            let laid = axis.with_faces_on(&places);
            for (cells, count) in [(laid.clone(), 45), (laid.refined(1.5), 67)] {
                assert!(cells.count().abs_diff(count) <= 2, "{}", cells.count());
                assert!(places.iter().all(|&at| !cells.is_inside_cell(at)));
                // Cells of one width in each stretch would jump by so much.
                let means = cells.pieces.iter();
                let means = means.map(|piece| (piece.to - piece.from) / piece.cells as f64);
                let means: Vec<f64> = means.collect();
                let jumps = means.windows(2).map(|pair| (pair[1] / pair[0]).ln().abs());
                let (change, jump) = (largest_change(&cells), jumps.fold(0.0, f64::max));
                assert!(change < 0.5 * jump, "{places:?}: {change} of {jump}");
            }
        }
    }

    /// The law would have to be bent too much over the whole range: the middle stretch holds nearly a cell more than
    /// the law gives it.
    #[test]
    fn widths_of_graded_cells_are_one_where_stretches_meet() {
        let grading = Grading {
            at: vec![-0.8, 0.8],
            smallest: 0.07,
        };
        let axis = Axis::graded(-4.6, 4.9, 54, &grading).unwrap();
        for cells in [axis.clone(), axis.refined(1.5), axis.displaced(0.3)] {
            let pairs = cells.pieces.windows(2);
            let jumps =
                pairs.map(|pair| pair[0].stretch(pair[0].to) / pair[1].stretch(pair[1].from) - 1.0);
            assert!(jumps.into_iter().all(|jump| jump.abs() < 1e-12));
            assert!(cells.pieces.iter().any(|piece| piece.more != 0.0));
            // Nodes and stretches are of one law: a cell is as wide as the stretch at its node, to second order.
            for cell in 0..cells.count() {
                let (width, at_node) = (cells.width(cell), cells.node_stretch(cell));
                assert!(
                    (width / at_node - 1.0).abs() < 0.05,
                    "{cell}: {width} {at_node}"
                );
            }
        }
    }

    #[test]
    fn stretches_that_are_even_stay_as_they_are() {
        let grading = Grading {
            at: vec![0.0],
            smallest: 0.05,
        };
        let axis = Axis::graded(-2.0, 2.0, 40, &grading).unwrap();
        let parts: Vec<usize> = axis.pieces.iter().map(|piece| piece.terms.len()).collect();
        assert_eq!(parts, [1, 1]);
    }
}
