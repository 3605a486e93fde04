//! What kinks and bends beside a place do to the errors of cells there.

use super::CellCheck;
use super::grid::share_of_distance;
use crate::density::{EstimatedDensity, Kink};

/// The highest order of a scheme.
const ORDER: i32 = 5;

/// The order of which a scheme is sure beside a bend on faces of its cells.
const ORDER_AT_BEND: i32 = 2;

/// Cells on either side of a place that what is read there depends on.
const REACH: usize = 4;

/// By how much a distance to finer cells may be too small by chance there.
const CHANCE: f64 = 10.0;

/// The kinks beside a place, by what they do to the errors of cells there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kinks {
    /// None, or jumps on faces, whose sizes are known.
    None,
    /// A bend on a face of these cells and of finer ones: the order of a scheme that follows it is low.
    BendOnFace,
    /// One inside a cell, whose place in the cell differs from grid to grid, and the error with it.
    Cut,
}

impl Kinks {
    pub(super) fn near(estimated: &EstimatedDensity, place: &[f64]) -> Self {
        let of_one = |kink: &Kink| {
            let axis = estimated.density.axes.get(kink.axis)?;
            let cells = axis.find(kink.at).zip(axis.find(*place.get(kink.axis)?))?;
            let is_near = cells.0.abs_diff(cells.1) <= REACH;
            let is_blurred = kink.is_bend() && !estimated.is_by_quadrature();
            match (is_near, axis.has_face_at(kink.at)) {
                (true, false) => Some(Self::Cut),
                (true, true) if is_blurred => Some(Self::BendOnFace),
                _ => None,
            }
        };
        let near: Vec<Self> = estimated
            .structure
            .kinks
            .iter()
            .filter_map(of_one)
            .collect();
        match near.contains(&Self::Cut) {
            true => Self::Cut,
            false => near.first().copied().unwrap_or(Self::None),
        }
    }

    /// What is claimed of a distance to cells that are refined for so many times, from what is claimed where there are
    /// no kinks. Two grids may agree by chance; beside a bend on faces a third one tells, and order one is claimed.
    pub(super) fn share(self, times: u8, share: f64, check: CellCheck) -> f64 {
        match (self, times) {
            (Self::None, _) => share,
            (Self::BendOnFace, 2..) => share_of_distance(check, false),
            _ => CHANCE * share,
        }
    }

    /// What is claimed at least beside a distance to cells that are refined for so many times, of what a second scheme
    /// differs by on the coarser of them and on the finer ones: distances may be small by chance, and that is not. A
    /// third grid tells beside a bend on faces that errors fall with it.
    pub(super) fn by_schemes(self, times: u8, [coarser, finer]: [f64; 2]) -> f64 {
        match (self, times) {
            (Self::None, _) => 0.0,
            (Self::BendOnFace, 2..) => finer,
            _ => coarser,
        }
    }

    /// By how much a distance to finer cells may fall when these are refined once more: values that agree better than
    /// that do so by chance.
    pub(super) fn fall(self, check: CellCheck) -> f64 {
        let order = match self {
            Self::BendOnFace => ORDER_AT_BEND,
            Self::None | Self::Cut => ORDER,
        };
        match check {
            CellCheck::OnFinerCells { ratio, .. } => ratio.powi(order),
            CellCheck::Impossible | CellCheck::Needless => 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_third_grid_takes_the_place_of_chance_beside_a_bend_on_faces() {
        let check = CellCheck::OnFinerCells {
            ratio: 1.5,
            follows: None,
        };
        let claimed = share_of_distance(check, true);
        for (kinks, first, second, fall) in [
            (Kinks::None, 1.0, 1.0, 5),
            (Kinks::BendOnFace, CHANCE, 2.0, 2),
            (Kinks::Cut, CHANCE, CHANCE, 5),
        ] {
            assert_eq!(kinks.share(1, claimed, check), first, "{kinks:?}");
            assert_eq!(kinks.share(2, claimed, check), second, "{kinks:?}");
            let by_schemes = if kinks == Kinks::None { 0.0 } else { 3.0 };
            assert_eq!(kinks.by_schemes(1, [3.0, 1.0]), by_schemes);
            let is_told = kinks == Kinks::BendOnFace;
            assert_eq!(
                kinks.by_schemes(2, [3.0, 1.0]),
                if is_told { 1.0 } else { by_schemes }
            );
            assert_eq!(kinks.fall(check), 1.5_f64.powi(fall), "{kinks:?}");
        }
    }
}
