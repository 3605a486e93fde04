//! A curve as it was met: its points, and what its densities have in common.

use super::reading::Reading;
use super::{CurveWork, EndReason};

/// A point as it was met.
#[derive(Debug, Clone)]
pub(super) struct WalkPoint {
    pub(super) reading: Reading,
    /// The point of the curve, in the box with sides of length one.
    pub(super) foot: [f64; 2],
    /// Toward rising arclength, of length one.
    pub(super) tangent: [f64; 2],
    /// Error of the straight line from where it was read to the foot.
    pub(super) remainder: f64,
    pub(super) arclength: f64,
    /// The side of the box on whose end it lies.
    pub(super) border: Option<usize>,
}

/// A curve as it was met, without checks.
pub(super) struct Walked {
    pub(super) points: Vec<WalkPoint>,
    pub(super) start: usize,
    pub(super) ends: Vec<EndReason>,
    pub(super) work: CurveWork,
}

impl Walked {
    /// The places at which the slope of the densities of one axis jumps, as they are at the first point and at the
    /// last.
    pub(super) fn kinks(&self) -> [Vec<KinkAtEnd>; 2] {
        [self.points.first(), self.points.last()]
            .map(|node| node.map_or_else(Vec::new, KinkAtEnd::all_of))
    }

    /// The centre of symmetry of the densities of one axis, where all have the same, and the width of the cells there.
    pub(super) fn centre(&self) -> Option<(f64, f64)> {
        let mut centres = self
            .points
            .iter()
            .map(|node| node.reading.centre.as_deref());
        let Some(&[centre]) = centres.next()? else {
            return None;
        };
        let axis = self.points.first()?.reading.density.axes.first()?;
        let cell = axis.width(axis.find(centre)?);
        centres
            .all(|one| one == Some(&[centre]))
            .then_some((centre, cell))
    }
}

/// A place at which the slope of a density jumps, at the end of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct KinkAtEnd {
    pub(super) at: f64,
    /// Width of the cells there.
    pub(super) cell: f64,
    /// Whether the density rises away from it below, and above.
    pub(super) rises_away: [bool; 2],
}

impl KinkAtEnd {
    fn all_of(node: &WalkPoint) -> Vec<Self> {
        let density = &node.reading.density;
        let Some(axis) = density.axes.first() else {
            return Vec::new();
        };
        let found = node.reading.kinks.iter().filter_map(|&at| {
            let [below, above] = axis.cells_beside(at)?;
            let value = |cell: usize| density.values.get(cell).copied();
            let farther = [value(below.checked_sub(1)?)?, value(above + 1)?];
            Some(Self {
                at,
                cell: axis.width(above),
                rises_away: [farther[0] > value(below)?, farther[1] > value(above)?],
            })
        });
        found.collect()
    }
}

/// Whether a place is in the box with sides of length one.
pub(super) fn within(place: [f64; 2]) -> bool {
    place.iter().all(|part| (0.0..=1.0).contains(part))
}

/// How far two places are apart.
pub(super) fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
