//! A density along one axis that has given averages in the cells and values at the faces: within a cell a parabola,
//! or a power where a parabola would turn and the cells do not.

use crate::space::Axis;

/// The cell that holds a place, and the share of its width below it; `None` outside the range.
pub(super) type Spot = Option<(usize, f64)>;

/// A density along one axis: a value at every face, and an average in every cell.
pub(super) struct Shape<'a> {
    axis: &'a Axis,
    averages: Vec<f64>,
    faces: Vec<f64>,
}

impl<'a> Shape<'a> {
    /// The shape with these averages, and with these values at the faces where no cell turns twice.
    pub(super) fn new(axis: &'a Axis, averages: Vec<f64>, mut faces: Vec<f64>) -> Self {
        for (cell, &average) in averages.iter().enumerate() {
            // Of two faces that exceed a highest or lowest cell the nearer is as it is.
            let excess = [faces[cell] - average, faces[cell + 1] - average];
            let is_highest = neighbours(&averages, cell).all(|other| other <= average);
            let is_lowest = neighbours(&averages, cell).all(|other| other >= average);
            let both = |sign: f64| excess.iter().all(|excess| sign * excess > 0.0);
            if (is_highest && both(1.0)) || (is_lowest && both(-1.0)) {
                let nearer = usize::from(excess[1].abs() < excess[0].abs());
                faces[cell + nearer] = average;
            }
        }
        let mut shape = Self {
            axis,
            averages,
            faces,
        };
        shape.level_ends();
        shape
    }

    /// An end of the range lies on the other side of its cell's average than the inner face: the cell would turn there
    /// else.
    fn level_ends(&mut self) {
        let last = self.averages.len().saturating_sub(1);
        for (cell, end, inner) in [(0, 0, 1), (last, last + 1, last)] {
            let (average, beside) = (self.averages[cell], self.faces[inner]);
            if (self.faces[end] - average) * (beside - average) >= 0.0 {
                let least = if average >= 0.0 {
                    0.0
                } else {
                    f64::NEG_INFINITY
                };
                self.faces[end] = (2.0 * average - beside).max(least);
            }
        }
    }

    /// The values at some spots; no numbers outside.
    pub(super) fn at(&self, spots: &[Spot]) -> Vec<f64> {
        let value = |&spot: &Spot| spot.map_or(f64::NAN, |(cell, share)| self.within(cell, share));
        spots.iter().map(value).collect()
    }

    /// Rise over a cell, and the coefficient of its parabola: p(u) = lower face + u (rise + bend (1 - u)).
    fn parabola(&self, cell: usize) -> (f64, f64) {
        let (lower, upper) = (self.faces[cell], self.faces[cell + 1]);
        let bend = 6.0 * (self.averages[cell] - 0.5 * (lower + upper));
        (upper - lower, bend)
    }

    /// Whether the density turns inside a cell.
    fn turns_in(&self, cell: usize) -> bool {
        let (rise, bend) = self.parabola(cell);
        let average = self.averages[cell];
        let (one, other) = (self.faces[cell], self.faces[cell + 1]);
        let is_outside = average > one.max(other) || average < one.min(other);
        let beside = neighbours(&self.averages, cell);
        let is_extremum = beside
            .filter(|other| bend * (average - other) > 0.0)
            .count()
            == 2;
        bend.abs() > rise.abs() && (is_outside || is_extremum)
    }

    /// The value at a share of a cell.
    fn within(&self, cell: usize, share: f64) -> f64 {
        let (rise, bend) = self.parabola(cell);
        let lower = self.faces[cell];
        if bend.abs() <= rise.abs() || self.turns_in(cell) {
            let lowest = lower + 0.25 * (rise + bend).powi(2) / bend;
            if bend < 0.0 && lowest < 0.0 && self.turns_in(cell) && self.averages[cell] >= 0.0 {
                return self.notch(cell, share);
            }
            return lower + share * (rise + bend * (1.0 - share));
        }
        if rise == 0.0 {
            return lower;
        }
        // u^m has the average 1/(m + 1), and 1 - (1 - u)^m one minus that.
        let level = ((self.averages[cell] - lower) / rise).clamp(0.0, 1.0);
        let risen = if level < 0.5 {
            share.powf((1.0 - level) / level.max(f64::MIN_POSITIVE))
        } else {
            1.0 - (1.0 - share).powf(level / (1.0 - level).max(f64::MIN_POSITIVE))
        };
        lower + rise * risen
    }

    /// A valley that a parabola would make negative: (1 - u)^m and u^m have the average 1/(m + 1).
    fn notch(&self, cell: usize, share: f64) -> f64 {
        let (lower, upper) = (self.faces[cell], self.faces[cell + 1]);
        let power = (lower + upper) / self.averages[cell].max(f64::MIN_POSITIVE) - 1.0;
        lower * (1.0 - share).powf(power) + upper * share.powf(power)
    }

    /// Where the density turns inside cells.
    pub(super) fn turns(&self) -> Vec<f64> {
        let cells = (0..self.axis.count()).filter(|&cell| self.turns_in(cell));
        let place = |cell: usize| {
            let (rise, bend) = self.parabola(cell);
            let share = 0.5 * (1.0 + rise / bend);
            self.axis.edges()[cell] + share * self.axis.width(cell)
        };
        cells.map(place).collect()
    }
}

/// The averages beside a cell, one at an end.
fn neighbours(averages: &[f64], cell: usize) -> impl Iterator<Item = f64> {
    let below = cell.checked_sub(1).and_then(|below| averages.get(below));
    below.into_iter().chain(averages.get(cell + 1)).copied()
}
