//! The values of a quantity over one sub-cell, and the bins that they fall into.
//!
//! A quantity is taken as quadratic in a sub-cell. The sub-cell is cut into pieces in which it is linear: the values of
//! a linear function over a box have a trapezoid for their density, whose integral over each bin is known, so that no
//! mass jumps from bin to bin as that of a point would.

use crate::MAX_DIMENSION;
use crate::space::Axis;

/// Parts of a sub-cell along each axis, where a quantity depends on one axis, two, and so on. What the bend of level
/// lines does to a bin falls with their square.
const PIECES: [usize; MAX_DIMENSION] = [4, 4, 2, 1];

/// One number for each axis that takes part.
pub(super) type PerAxis = [f64; MAX_DIMENSION];

/// A quantity over a sub-cell: its value at the centre with first and second differences from end to end.
#[derive(Debug, Clone)]
pub(super) struct SubCellValues {
    axes: usize,
    centre: f64,
    /// Its change from end to end along each axis.
    pub(super) change: PerAxis,
    /// Its second derivative times both lengths, for each pair of axes.
    bend: [PerAxis; MAX_DIMENSION],
    lowest: f64,
    highest: f64,
}

impl SubCellValues {
    pub(super) fn new(centre: f64, axes: usize) -> Self {
        Self {
            axes,
            centre,
            change: [0.0; MAX_DIMENSION],
            bend: [[0.0; MAX_DIMENSION]; MAX_DIMENSION],
            lowest: centre,
            highest: centre,
        }
    }

    /// Adds what is seen at the middles of the two ends of an axis.
    pub(super) fn add_ends(&mut self, axis: usize, low: f64, high: f64) {
        self.change[axis] = high - low;
        self.bend[axis][axis] = 4.0 * (low + high - 2.0 * self.centre);
        self.lowest = self.lowest.min(low).min(high);
        self.highest = self.highest.max(low).max(high);
    }

    /// Adds what is seen at the middles of the four edges at which two axes end: both low, one high, the other high,
    /// both high.
    pub(super) fn add_corners(&mut self, (one, other): (usize, usize), corners: [f64; 4]) {
        let [both_low, first, second, both_high] = corners;
        let twist = both_high - first - second + both_low;
        self.bend[one][other] = twist;
        self.bend[other][one] = twist;
    }

    /// Its mean, to fourth order.
    pub(super) fn mean(&self) -> f64 {
        let bends = (0..self.axes).map(|axis| self.bend[axis][axis]);
        self.centre + bends.sum::<f64>() / 24.0
    }

    /// Whether nothing that was looked at lies beyond the lower and the upper end of bins.
    fn is_within(&self, bins: &Axis) -> (bool, bool) {
        let last = bins.count() - 1;
        (
            self.lowest >= bins.from() - ROUNDING * bins.width(0),
            self.highest <= bins.to() + ROUNDING * bins.width(last),
        )
    }

    /// The shares of the sub-cell's mass in the bins that its values fall into, those of one bin together. Where none
    /// of the values that were looked at lies beyond an end, nothing does.
    pub(super) fn shares(&self, bins: &Axis, shares: &mut Vec<Share>) {
        shares.clear();
        let within = self.is_within(bins);
        let parts = PIECES[self.axes.clamp(1, MAX_DIMENSION) - 1];
        // Where all of it lies within one bin, or it is linear, pieces would tell nothing more.
        let bent = self.bend.iter().flatten().any(|bend| *bend != 0.0);
        let parts = if bent && self.crosses_an_edge(bins) {
            parts
        } else {
            1
        };
        for number in 0..parts.pow(self.axes as u32) {
            self.piece(number, parts).add_shares(bins, within, shares);
        }
    }

    /// Whether an edge of bins, or an end, may lie among its values.
    fn crosses_an_edge(&self, bins: &Axis) -> bool {
        let bends: f64 = self.bend.iter().flatten().map(|bend| bend.abs()).sum();
        let changes: f64 = self.change.iter().map(|change| change.abs()).sum();
        let reach = 0.5 * changes + 0.125 * bends;
        let ends = [self.centre - reach, self.centre + reach].map(|value| bins.find(value));
        !matches!(ends, [Some(low), Some(high)] if low == high)
    }

    /// One of its pieces, along each axis one of so many parts.
    fn piece(&self, mut number: usize, parts: usize) -> Piece {
        let mut piece = Piece {
            mean: self.centre,
            length: (parts as f64).recip(),
            ..Piece::default()
        };
        for offset in piece.offset.iter_mut().take(self.axes) {
            *offset = ((number % parts) as f64 + 0.5) * piece.length - 0.5;
            number /= parts;
        }
        piece.share = piece.length.powi(self.axes as i32);
        for axis in 0..self.axes {
            let offset = piece.offset[axis];
            let pairs = self.bend[axis].iter().zip(&piece.offset);
            let bent: f64 = pairs.map(|(bend, other)| bend * other).sum();
            let inside = self.bend[axis][axis] * piece.length * piece.length / 24.0;
            piece.mean += offset * (self.change[axis] + 0.5 * bent) + inside;
            piece.change[axis] = (self.change[axis] + bent) * piece.length;
        }
        piece
    }
}

/// Share of a bin's width below which a piece has one value.
const POINT: f64 = 1e-9;
/// Share of a bin's width by which a value may lie beyond the end of the bins from rounding.
const ROUNDING: f64 = 1e-6;

/// A share of a sub-cell's mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Share {
    pub(super) bin: usize,
    /// Of its mass, where that is spread evenly.
    pub(super) mass: f64,
    /// What the change of its density from end to end along each axis, over its mean, adds.
    pub(super) of_change: PerAxis,
}

/// A part of a sub-cell in which a quantity is linear.
#[derive(Debug, Default)]
struct Piece {
    /// Its centre, in lengths of the sub-cell from the centre of that.
    offset: PerAxis,
    /// Its length, in lengths of the sub-cell.
    length: f64,
    /// Its share of the sub-cell.
    share: f64,
    mean: f64,
    /// Change of the quantity from end to end along each axis.
    change: PerAxis,
}

impl Piece {
    /// The widths of the trapezoid, the larger first: those of the largest change, and of all others together.
    fn widths(&self) -> (f64, f64) {
        let largest = self.change.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        let squares: f64 = self.change.iter().map(|change| change * change).sum();
        let rest = (squares - largest * largest).max(0.0).sqrt();
        (largest.max(rest), largest.min(rest))
    }

    fn add_shares(&self, bins: &Axis, within: (bool, bool), shares: &mut Vec<Share>) {
        let (a, b) = self.widths();
        if !(self.mean.is_finite() && a.is_finite()) {
            return;
        }
        let ends = (bins.from(), bins.to());
        let last = bins.count() - 1;
        let mean = match within {
            (true, true) => self.mean.clamp(ends.0, ends.1),
            (true, false) => self.mean.max(ends.0),
            (false, true) => self.mean.min(ends.1),
            (false, false) => self.mean,
        };
        let reach = 0.5 * (a + b);
        let (low, high) = ((mean - reach).max(ends.0), (mean + reach).min(ends.1));
        let (Some(first), true) = (bins.find(low), low <= high) else {
            return;
        };
        if a <= POINT * bins.width(first) {
            self.add_share((first, 1.0, 0.0), shares);
            return;
        }
        let at = |edge: usize| match edge {
            0 if within.0 => (0.0, 0.0),
            edge if edge > last && within.1 => (1.0, 0.0),
            edge => trapezoid(bins.edges()[edge] - mean, a, b),
        };
        let mut below = at(first);
        for bin in first..=last {
            let above = at(bin + 1);
            self.add_share((bin, above.0 - below.0, below.1 - above.1), shares);
            below = above;
            if bins.edges()[bin + 1] >= high {
                break;
            }
        }
    }

    /// Adds a share of the piece: bin, share, and the share's change by a shift of the quantity.
    fn add_share(&self, (bin, part, shifted): (usize, f64, f64), shares: &mut Vec<Share>) {
        let place = shares.iter().position(|one| one.bin == bin);
        let place = place.unwrap_or_else(|| {
            shares.push(Share {
                bin,
                mass: 0.0,
                of_change: [0.0; MAX_DIMENSION],
            });
            shares.len() - 1
        });
        let share = &mut shares[place];
        share.mass += self.share * part;
        for (axis, of_change) in share.of_change.iter_mut().enumerate() {
            let inside = self.length * self.change[axis] / 12.0 * shifted;
            *of_change += self.share * (self.offset[axis] * part + inside);
        }
    }
}

/// Mass below, and density at, an offset from the mean of the sum of two uniform variables of widths `a` ≥ `b`.
fn trapezoid(offset: f64, a: f64, b: f64) -> (f64, f64) {
    let t = offset.abs();
    let (inner, outer) = (0.5 * (a - b), 0.5 * (a + b));
    let (above, density) = if t >= outer {
        (0.0, 0.0)
    } else if t > inner {
        let left = outer - t;
        (left * left / (2.0 * a * b), left / (a * b))
    } else {
        (0.5 - t / a, 1.0 / a)
    };
    (if offset > 0.0 { 1.0 - above } else { above }, density)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the bins get of a square [-1/2, 1/2]² by a quantity q, with one density over it, as pieces see it.
    fn seen(q: impl Fn(f64, f64) -> f64, bins: &Axis) -> Vec<Share> {
        let mut values = SubCellValues::new(q(0.0, 0.0), 2);
        values.add_ends(0, q(-0.5, 0.0), q(0.5, 0.0));
        values.add_ends(1, q(0.0, -0.5), q(0.0, 0.5));
        values.add_corners(
            (0, 1),
            [q(-0.5, -0.5), q(0.5, -0.5), q(-0.5, 0.5), q(0.5, 0.5)],
        );
        let mut shares = Vec::new();
        values.shares(bins, &mut shares);
        shares
    }

    #[test]
    fn bent_level_lines_are_followed() {
        // Of a square about (1, 0), what lies within the circle of radius one: the mean over y of √(1 - y²) - 1/2.
        let side = 0.1;
        let q = |u: f64, v: f64| (1.0 + side * u).powi(2) + (side * v).powi(2);
        let bins = Axis::uniform(0.0, 2.0, 2).unwrap();
        let shares = seen(q, &bins);
        let half: f64 = 0.5 * side;
        let circle = (half * (1.0 - half * half).sqrt() + half.asin()) / side;
        let exact = 0.5 + (circle - 1.0) / side;
        let found = shares.iter().find(|share| share.bin == 0).unwrap();
        // The bend along the line moves it by side/24 on average, that across it by side/12 at most at an end of the
        // square: pieces leave a sixteenth of both.
        let left = (side / 24.0 + side / 12.0) / 16.0;
        assert!((found.mass - exact).abs() < left, "{} {exact}", found.mass);
        assert!((exact - 0.5).abs() > 5.0 * left);
        let total: f64 = shares.iter().map(|share| share.mass).sum();
        assert!((total - 1.0).abs() < 1e-14);
        // A density that rises along x puts more beyond the circle: u at its outer half has the mean 1/4.
        let outer = shares.iter().find(|share| share.bin == 1).unwrap();
        assert!((outer.of_change[0] - 0.125).abs() < 0.01, "{outer:?}");
    }

    #[test]
    fn twisted_level_lines_are_followed() {
        // Where u v > 0: half of the square, of which a linear quantity sees nothing.
        let bins = Axis::uniform(-0.9375, 1.0625, 2).unwrap();
        let shares = seen(|u, v| u * v, &bins);
        // ∫∫ [u v > c] = 2 (1/4 - c - c ln(1/(4c))) with c = 1/16.
        let exact = 2.0 * (0.25 - 0.0625 - 0.0625 * 4f64.ln());
        let above = shares.iter().find(|share| share.bin == 1).unwrap();
        assert!((above.mass - exact).abs() < 0.02, "{} {exact}", above.mass);
    }
}
