//! A line, on one axis, with a place on every border of some regions.

use super::pocket::pockets_on_line;
use super::{PassageError, near_border};
use crate::generator::{MESH_DEPTH, MESH_PLACES, Mesh, Reach};
use crate::numerics::narrowed;
use crate::system::{BoundQuantity, LANES};

/// Halvings of a bracket of a border.
const HALVINGS: usize = 200;

/// A line with a place on every border of some regions.
pub(super) struct Bordered {
    pub(super) line: Mesh,
}

/// Where a region is on a line, element by element.
pub(super) struct Inside(pub(super) Vec<bool>);

impl Bordered {
    /// The line of a system with places on the borders of regions (negative inside) and at some places where processes
    /// start; `None` where it has no end.
    pub(super) fn new(
        reach: &Reach<'_>,
        regions: &[&BoundQuantity],
        starts: &[f64],
    ) -> Option<Self> {
        let (breaks, rough) = Self::breaks(reach, regions, starts)?;
        let beside = |&start: &f64| near_border::places(start, &breaks, &rough.places);
        let finer: Vec<f64> = starts.iter().flat_map(beside).collect();
        let line = reach.finer_mesh(MESH_PLACES, MESH_DEPTH, &breaks, &finer)?;
        Some(Self { line })
    }

    /// The same with places at which functions are wanted that no process starts at.
    pub(super) fn with_places(
        reach: &Reach<'_>,
        regions: &[&BoundQuantity],
        places: &[f64],
    ) -> Option<Self> {
        let (breaks, _) = Self::breaks(reach, regions, places)?;
        let line = reach.mesh(MESH_PLACES, MESH_DEPTH, &breaks)?;
        Some(Self { line })
    }

    /// The places that a line needs, and a line on which borders were looked for.
    fn breaks(
        reach: &Reach<'_>,
        regions: &[&BoundQuantity],
        more: &[f64],
    ) -> Option<(Vec<f64>, Mesh)> {
        let mut rough = reach.mesh(MESH_PLACES, MESH_DEPTH, more)?;
        let all_pockets = |region: &&BoundQuantity| pockets_on_line(&rough.places, region);
        let pockets: Vec<f64> = regions.iter().flat_map(all_pockets).collect();
        let mut breaks = more.to_vec();
        if !pockets.is_empty() {
            breaks.extend(pockets);
            rough = reach.mesh(MESH_PLACES, MESH_DEPTH, &breaks)?;
        }
        for region in regions {
            let inside: Vec<bool> = is_inside(region, &rough.places);
            for (places, sides) in rough.places.windows(2).zip(inside.windows(2)) {
                if sides[0] != sides[1] {
                    breaks.push(border(region, (places[0], places[1]), sides[0]));
                }
            }
        }
        Some((breaks, rough))
    }

    pub(super) fn inside(&self, region: &BoundQuantity) -> Inside {
        let pairs = self.line.places.windows(2);
        let middles: Vec<f64> = pairs.map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        Inside(is_inside(region, &middles))
    }

    /// The region in which a process ends.
    ///
    /// # Errors
    /// [`PassageError::Nowhere`] and [`PassageError::Everywhere`].
    pub(super) fn target(&self, until: &BoundQuantity) -> Result<Inside, PassageError> {
        let until = self.inside(until);
        if until.0.iter().all(|inside| !inside) {
            return Err(PassageError::Nowhere);
        }
        if until.0.iter().all(|inside| *inside) {
            return Err(PassageError::Everywhere);
        }
        Ok(until)
    }

    /// The places of a part of a region.
    pub(super) fn places_of_part(&self, part: &BoundQuantity, whole: &Inside) -> Vec<bool> {
        let inside = self.inside(part).0.into_iter().zip(&whole.0);
        Inside(inside.map(|(part, whole)| part && *whole).collect()).places()
    }

    /// The places of two regions, of which both have some, and none in common.
    ///
    /// # Errors
    /// [`PassageError::Nowhere`], [`PassageError::Start`], [`PassageError::Overlap`].
    pub(super) fn apart(
        &self,
        regions: [&BoundQuantity; 2],
    ) -> Result<[Vec<bool>; 2], PassageError> {
        let [first, second] = regions.map(|region| self.inside(region));
        let is_empty = |region: &Inside| region.0.iter().all(|inside| !inside);
        if is_empty(&second) {
            return Err(PassageError::Nowhere);
        }
        if is_empty(&first) {
            return Err(PassageError::Start);
        }
        let mut pairs = first.0.iter().zip(&second.0);
        match pairs.any(|(one, other)| *one && *other) {
            true => Err(PassageError::Overlap),
            false => Ok([first.places(), second.places()]),
        }
    }
}

impl Inside {
    /// Places that belong to it, its borders among them.
    pub(super) fn places(&self) -> Vec<bool> {
        let count = self.0.len();
        let beside = |place: usize| {
            let below = place > 0 && self.0[place - 1];
            below || (place < count && self.0[place])
        };
        (0..=count).map(beside).collect()
    }
}

fn is_inside(region: &BoundQuantity, places: &[f64]) -> Vec<bool> {
    let mut all = Vec::with_capacity(places.len());
    for batch in places.chunks(LANES) {
        let mut states = [batch[0]; LANES];
        states[..batch.len()].copy_from_slice(batch);
        let values = region.values(&[states]);
        all.extend(values[..batch.len()].iter().map(|value| *value < 0.0));
    }
    all
}

/// Where a region begins or ends between two places, of which the first is inside or not.
fn border(region: &BoundQuantity, ends: (f64, f64), first: bool) -> f64 {
    let is_first = |middle: f64| (region.at(&[middle]) < 0.0) == first;
    narrowed(ends, HALVINGS, is_first).1
}
