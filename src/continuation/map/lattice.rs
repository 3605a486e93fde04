//! The places of a map: a coarse grid whose cells may be halved, all on one lattice of whole numbers.

use std::ops::RangeInclusive;

/// A place: whole numbers along the first and the second parameter.
pub(super) type At = [usize; 2];

/// A square cell of the lattice that is not halved further: its lower corner, and its length.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Leaf {
    pub(super) corner: At,
    pub(super) size: usize,
}

/// The lattice of the finest places.
#[derive(Debug, Clone)]
pub(super) struct Lattice {
    counts: [usize; 2],
    depth: usize,
}

impl Lattice {
    /// At least 2 coarse values along each side, halved `depth` times.
    pub(super) fn new(counts: [usize; 2], depth: usize) -> Self {
        Self {
            counts: counts.map(|count| count.max(2)),
            depth: depth.min(20),
        }
    }

    pub(super) fn depth(&self) -> usize {
        self.depth
    }

    /// Length of a coarse cell.
    pub(super) fn coarse(&self) -> usize {
        1 << self.depth
    }

    /// The last place along a side.
    pub(super) fn last(&self, side: usize) -> usize {
        (self.counts[side] - 1) * self.coarse()
    }

    /// The place in the box with sides of length one.
    pub(super) fn share(&self, at: At) -> [f64; 2] {
        [0, 1].map(|side| at[side] as f64 / self.last(side) as f64)
    }

    /// The place of the lattice at a place of the box with sides of length one; `None` beside all of them.
    pub(super) fn at(&self, place: [f64; 2]) -> Option<At> {
        let at = [0, 1].map(|side| (place[side] * self.last(side) as f64).round());
        let off = [0, 1].map(|side| (at[side] - place[side] * self.last(side) as f64).abs());
        let inside = (0..2).all(|side| (0.0..=self.last(side) as f64).contains(&at[side]));
        (inside && off.iter().all(|off| *off < 1e-6)).then(|| at.map(|part| part as usize))
    }

    /// How often a coarse cell was halved where this place first is a corner.
    pub(super) fn level(&self, at: At) -> usize {
        let fineness = at.iter().map(|part| part.trailing_zeros() as usize);
        self.depth - fineness.min().unwrap_or(0).min(self.depth)
    }

    /// All coarse rows.
    pub(super) fn rows(&self) -> RangeInclusive<usize> {
        0..=self.counts[1] - 1
    }

    /// Strips of some coarse rows, each in the order in which it is walked: to and fro.
    pub(super) fn strips(&self, of: RangeInclusive<usize>, rows: usize) -> Vec<Vec<At>> {
        let step = self.coarse();
        let all: Vec<usize> = of.collect();
        let strip = |rows: &[usize]| {
            let walked = rows.iter().enumerate().flat_map(|(turn, &row)| {
                (0..self.counts[0]).map(move |column| {
                    let column = match turn % 2 {
                        0 => column,
                        _ => self.counts[0] - 1 - column,
                    };
                    [column * step, row * step]
                })
            });
            walked.collect()
        };
        all.chunks(rows).map(strip).collect()
    }

    /// The coarse cells between some rows.
    pub(super) fn cells(&self, rows: &RangeInclusive<usize>) -> Vec<Leaf> {
        let size = self.coarse();
        let columns = 0..self.counts[0] - 1;
        let cells =
            columns.flat_map(|i| (*rows.start()..*rows.end()).map(move |j| [i * size, j * size]));
        cells.map(|corner| Leaf { corner, size }).collect()
    }

    /// Lower and upper corner of a cell in the box with sides of length one.
    pub(super) fn corners(&self, leaf: Leaf) -> [[f64; 2]; 2] {
        [leaf.corner, leaf.corner.map(|part| part + leaf.size)].map(|at| self.share(at))
    }
}

impl Leaf {
    /// All places of the lattice on its border, where there may be nodes.
    pub(super) fn border(self) -> impl Iterator<Item = At> {
        let ([i, j], size) = (self.corner, self.size);
        (0..=size).flat_map(move |along| {
            [
                [i + along, j],
                [i + along, j + size],
                [i, j + along],
                [i + size, j + along],
            ]
        })
    }

    /// Its four halves of half the length.
    pub(super) fn halves(self) -> [Self; 4] {
        let ([i, j], size) = (self.corner, self.size / 2);
        [[0, 0], [size, 0], [0, size], [size, size]].map(|[x, y]| Self {
            corner: [i + x, j + y],
            size,
        })
    }

    /// The places that halving it needs: its middle and those of its sides.
    pub(super) fn middles(self) -> [At; 5] {
        let ([i, j], size, half) = (self.corner, self.size, self.size / 2);
        [
            [i + half, j],
            [i, j + half],
            [i + half, j + half],
            [i + size, j + half],
            [i + half, j + size],
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_are_walked_to_and_fro_and_hold_every_coarse_place_once() {
        let lattice = Lattice::new([4, 5], 2);
        let strips = lattice.strips(lattice.rows(), 2);
        assert_eq!(strips.len(), 3);
        assert_eq!(strips[0][3..5], [[12, 0], [12, 4]]);
        assert_eq!(strips[2].len(), 4);
        let mut all = strips.concat();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 20);
        assert_eq!(lattice.share([12, 16]), [1.0, 1.0]);
        assert_eq!(lattice.at(lattice.share([3, 5])), Some([3, 5]));
        assert_eq!(lattice.at([0.51, 0.5]), None);
        assert_eq!(lattice.at([1.25, 0.5]), None);
        for strip in &strips {
            for pair in strip.windows(2) {
                let apart = pair[0][0].abs_diff(pair[1][0]) + pair[0][1].abs_diff(pair[1][1]);
                assert_eq!(apart, 4);
            }
        }
    }

    #[test]
    fn halves_fill_a_cell_and_middles_are_their_corners() {
        let lattice = Lattice::new([3, 3], 2);
        let cell = lattice.cells(&lattice.rows())[1];
        assert_eq!((cell.corner, cell.size), ([0, 4], 4));
        let corner = |at: &At| {
            cell.halves()
                .iter()
                .any(|half| half.border().any(|one| one == *at))
        };
        assert!(cell.middles().iter().all(corner));
        assert!(cell.middles().iter().all(|&at| lattice.level(at) == 1));
        assert_eq!(lattice.level([4, 4]), 0);
        assert_eq!(lattice.level([4, 3]), 2);
        assert_eq!(lattice.corners(cell), [[0.0, 0.5], [0.5, 1.0]]);
    }
}
