//! What the systems along a sweep, or in a map's box, say of the range of each axis.

use std::sync::Arc;

use crate::space::NORMAL_RANGE;
use crate::sweep_file::draft::Draft;
use crate::system::{Family, ParameterValues, System};

/// Mean and standard deviation of an axis of coloured noise, the same all along the sweep.
pub(super) fn filter(family: &Family, axis: usize) -> Option<(f64, f64)> {
    let (from, to) = family.ends();
    let at = |value: f64| {
        family
            .at(value)
            .ok()?
            .facts()
            .filtered_noise
            .get(&axis)
            .copied()
    };
    at(from).filter(|one| at(to).as_ref() == Some(one))
}

/// What is swept, with the systems along the sweep, or along two sides of the map's box.
pub(super) struct SweptSystems<'a> {
    pub(super) family: &'a Family,
    pub(super) corners: Vec<Arc<dyn System>>,
}

impl<'a> SweptSystems<'a> {
    /// Of a family, with the corners that a file says.
    pub(super) fn new(family: &'a Family, draft: &Draft) -> Self {
        Self {
            family,
            corners: corners(family, draft),
        }
    }

    /// Whether a coordinate has no bounds and relaxes linearly, at all corners.
    pub(super) fn relaxes(&self, axis: usize) -> bool {
        let mut corners = self.corners.iter();
        let relaxes = |one: &Arc<dyn System>| {
            let facts = one.facts();
            facts.bounds(axis).is_none() && facts.relaxation_rates.contains_key(&axis)
        };
        !self.corners.is_empty() && corners.all(relaxes)
    }

    /// Whether an axis has bounds that are the same wherever along the sweep it is looked at.
    pub(super) fn has_still_bounds(&self, axis: usize) -> bool {
        let mut known = self.corners.iter().map(|one| one.facts().bounds(axis));
        let first = known.next().flatten();
        first.is_some() && known.all(|one| one == first)
    }

    /// The ends of a turn of an axis that closes on itself.
    pub(super) fn turn(&self, axis: usize) -> Option<(f64, f64)> {
        self.corners.first()?.facts().turns.get(&axis).copied()
    }

    /// The widest range that the model's bounds of an axis take at the corners; of coloured noise, what holds nearly
    /// all of it, and of what closes on itself a turn.
    pub(super) fn bounds(&self, axis: usize) -> Option<(f64, f64)> {
        if let Some((mean, deviation)) = filter(self.family, axis) {
            let half = NORMAL_RANGE * deviation;
            return Some((mean - half, mean + half));
        }
        if let Some(turn) = self.turn(axis) {
            return Some(turn);
        }
        let bounds: Option<Vec<(f64, f64)>> = self
            .corners
            .iter()
            .map(|one| one.facts().bounds(axis))
            .collect();
        let bounds = bounds?.into_iter();
        bounds.reduce(|one, other| (one.0.min(other.0), one.1.max(other.1)))
    }
}

/// Steps along a sweep at which systems are looked at: bounds may be wider between its ends.
const STEPS: usize = 8;

/// The systems along a sweep, its ends among them, or along two sides of the map's box; those that are not allowed are
/// refused elsewhere.
fn corners(family: &Family, draft: &Draft) -> Vec<Arc<dyn System>> {
    let (model, (from, to)) = (family.model(), family.ends());
    let at = |step: usize| match step {
        STEPS => to,
        step => from + (to - from) * step as f64 / STEPS as f64,
    };
    let ends: Vec<ParameterValues> = (0..=STEPS)
        .filter_map(|step| family.values_at(at(step)).ok())
        .collect();
    let map = &draft.map;
    let values = match (&map.parameter, map.from, map.to) {
        (Some(name), Some(low), Some(high)) => {
            let pairs = ends
                .iter()
                .flat_map(|end| [low, high].map(|value| (end, value)));
            let corners = pairs.filter_map(|(end, value)| model.with(end, name, value).ok());
            corners.collect()
        }
        _ => ends,
    };
    values.iter().map(|values| model.system(values)).collect()
}
