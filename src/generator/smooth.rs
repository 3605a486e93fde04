//! The part of a drift along a grid line that the grid resolves: a quadratic spline in the cell coordinate whose
//! coefficients are averages of the drift over cells, freed of what changes within a few of them.
//!
//! Averages are smoothed by [`PASSES`] passes of the weights ¼, ½, ¼, and what that, the averages and the spline take
//! off a parabola is put back: the spline differs from a drift that the grid resolves in fourth order of the cell
//! width, and makes a slope over some four cells of a jump. It need not follow the drift more closely than that, as
//! what is left of the drift at any point is fitted.

/// Places of the quadrature points in a cell, as a share of its lower and then its upper half.
pub(super) const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

/// Offsets of the quadrature points from the node of a cell of even width, in cells.
pub(super) const EVEN_OFFSETS: [f64; 4] = [
    0.5 * GAUSS[0] - 0.5,
    0.5 * GAUSS[1] - 0.5,
    0.5 * GAUSS[0],
    0.5 * GAUSS[1],
];

/// Passes of smoothing. With half or twice as many, densities with friction differ by a fraction of their errors
/// (docs/accuracy.md).
const PASSES: usize = 8;

/// Half the variance, in cells squared, of averages (1/12), passes (1/2 each) and spline (1/4) together.
const HALF_VARIANCE: f64 = 0.5 * (1.0 / 12.0 + 0.5 * PASSES as f64 + 0.25);

/// The smooth part along one line.
#[derive(Debug, Default, Clone)]
pub(super) struct SmoothPart {
    /// Coefficients of the spline: one a cell, and one beyond either end.
    coefficients: Vec<f64>,
    before: Vec<f64>,
}

impl SmoothPart {
    /// Follows a drift with these values at the quadrature points, four a cell. At an end of the line, where there is
    /// nothing beyond to smooth with, the average stays.
    pub(super) fn follow(&mut self, inner_drift: &[f64]) {
        let averages = inner_drift.chunks_exact(4);
        let averages = averages.map(|cell| 0.25 * cell.iter().sum::<f64>());
        self.coefficients.clear();
        self.coefficients.push(0.0);
        self.coefficients.extend(averages);
        self.coefficients.push(0.0);
        for _ in 0..PASSES {
            self.go_on_straight();
            self.add_bend(0.25);
        }
        self.go_on_straight();
        self.add_bend(-HALF_VARIANCE);
        self.go_on_straight();
    }

    /// Value at the node of a cell.
    pub(super) fn at_node(&self, cell: usize) -> f64 {
        self.at(cell, 0.0)
    }

    /// Values at places of a cell, given by their offsets from its node in the cell coordinate.
    pub(super) fn inside(&self, cell: usize, offsets: [f64; 4]) -> [f64; 4] {
        offsets.map(|offset| self.at(cell, offset))
    }

    /// Value in a cell, at an offset from its node in the cell coordinate.
    fn at(&self, cell: usize, offset: f64) -> f64 {
        let weights = [
            0.5 * (0.5 - offset).powi(2),
            0.75 - offset * offset,
            0.5 * (0.5 + offset).powi(2),
        ];
        let near = weights.iter().zip(&self.coefficients[cell..]);
        near.map(|(weight, coefficient)| weight * coefficient).sum()
    }

    /// Adds a multiple of its second difference to every coefficient of a cell.
    fn add_bend(&mut self, share: f64) {
        self.before.clone_from(&self.coefficients);
        let own = self.coefficients.iter_mut().skip(1);
        for (value, near) in own.zip(self.before.windows(3)) {
            *value += share * (near[0] - 2.0 * near[1] + near[2]);
        }
    }

    /// Coefficients beyond the ends that continue those of the outermost cells in a straight line.
    fn go_on_straight(&mut self) {
        let last = self.coefficients.len() - 1;
        let beyond = |own: f64, next: f64| 2.0 * own - next;
        // A line of one cell has no next one.
        let (second, before_last) = (2.min(last - 1), (last - 1).max(2) - 1);
        self.coefficients[0] = beyond(self.coefficients[1], self.coefficients[second]);
        self.coefficients[last] =
            beyond(self.coefficients[last - 1], self.coefficients[before_last]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The smooth part of a function of the cell coordinate, and its values at the quadrature points, on 32 cells.
    fn followed(drift: impl Fn(f64) -> f64) -> (SmoothPart, Vec<f64>) {
        let [near, far] = GAUSS.map(|share| 0.5 * share);
        let points = (0..32).flat_map(|cell| {
            [near, far, near + 0.5, far + 0.5].map(|place| f64::from(cell) + place)
        });
        let values: Vec<f64> = points.map(drift).collect();
        let mut smooth = SmoothPart::default();
        smooth.follow(&values);
        (smooth, values)
    }

    #[test]
    fn straight_lines_and_parabolas_are_smooth() {
        let (smooth, values) = followed(|u| 3.0 - 2.0 * u);
        for cell in 0..32 {
            for (found, value) in smooth
                .inside(cell, EVEN_OFFSETS)
                .iter()
                .zip(&values[4 * cell..])
            {
                assert!((found - value).abs() < 1e-12, "{cell}");
            }
        }
        let (smooth, values) = followed(|u| (u - 7.0) * (u - 7.0));
        for cell in 12..20 {
            for (found, value) in smooth
                .inside(cell, EVEN_OFFSETS)
                .iter()
                .zip(&values[4 * cell..])
            {
                assert!((found - value).abs() < 1e-11, "{cell}");
            }
        }
    }

    #[test]
    fn a_jump_is_left_out_and_nothing_else_far_from_it() {
        let (smooth, values) = followed(|u| 5.0 * (u - 16.0).signum());
        let rest = |cell: usize| {
            let pairs = smooth
                .inside(cell, EVEN_OFFSETS)
                .into_iter()
                .zip(&values[4 * cell..]);
            pairs
                .map(|(smooth, value)| value - smooth)
                .collect::<Vec<f64>>()
        };
        // The drift beside the jump is all in the rest.
        assert!(rest(16)[0] > 4.5 && rest(15)[3] < -4.5, "{:?}", rest(16));
        for cell in (0..4).chain(28..32) {
            assert!(
                rest(cell).iter().all(|rest| rest.abs() < 0.05),
                "{cell}: {:?}",
                rest(cell)
            );
        }
    }

    #[test]
    fn a_single_cell_is_its_average() {
        let mut smooth = SmoothPart::default();
        smooth.follow(&[1.0, 2.0, 3.0, 4.0]);
        assert!((smooth.at_node(0) - 2.5).abs() < 1e-15);
        assert!(
            smooth
                .inside(0, EVEN_OFFSETS)
                .iter()
                .all(|value| (value - 2.5).abs() < 1e-15)
        );
    }
}
