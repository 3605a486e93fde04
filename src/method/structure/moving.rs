//! Switching surfaces that move along a sweep.

use std::sync::Arc;

use super::wants_face;
use crate::space::CellSpace;
use crate::system::{self, System};

/// An axis of cells across which all switching surfaces move alike along a sweep.
#[derive(Debug, PartialEq)]
pub(in crate::method) struct MovingSurfaces {
    pub(in crate::method) axis: usize,
    /// How far they lie at least and at most from where they are in the middle of the sweep.
    pub(in crate::method) displacements: [f64; 2],
    /// Where they lie there.
    pub(in crate::method) places: Vec<f64>,
    /// Where they lie at both ends of the sweep.
    pub(in crate::method) left: Vec<f64>,
}

/// Share of a range by which surfaces move that move at all, and by which those that move alike differ at most.
const ROUNDING: f64 = 1e-9;

/// How far they move at most, as a share of the range: cells that move with them hold so much more.
const MOST: f64 = 0.5;

/// The first axis whose cells would have a face on a switching surface at every value of a sweep if its origin moved
/// along; given systems at the first end, in the middle, and at the last end. Axes whose coordinate is kept within
/// bounds or walls, is a filtered noise, has an end at which the noise dies, carries modes, or closes on itself, have
/// an origin of their own.
pub(in crate::method) fn moving_surfaces(
    systems: &[Arc<dyn System>],
    space: &CellSpace,
) -> Option<MovingSurfaces> {
    let [_, middle, _] = systems else {
        return None;
    };
    let axes = space.axes().iter().enumerate();
    let mut lines = axes.filter(|(axis, cells)| {
        let facts = middle.facts();
        let ranges = space.ranges();
        let mut all = systems.iter();
        let is_kept = facts.bounds(*axis).is_some()
            || facts.reflecting.contains_key(axis)
            || facts.filtered_noise.contains_key(axis)
            || all.any(|one| {
                let closed = system::closed_ends(one.as_ref(), *axis, &ranges);
                let natural = system::natural_ends(one.as_ref(), *axis, &ranges);
                closed != [false; 2] || natural != [false; 2]
            });
        !cells.is_modes() && !cells.is_closed() && !is_kept
    });
    lines.find_map(|(axis, cells)| {
        let places = |system: &Arc<dyn System>| system.facts().surfaces_on(axis).collect();
        let of: Vec<Vec<f64>> = systems.iter().map(places).collect();
        let [first, here, last] = &of[..] else {
            return None;
        };
        let small = ROUNDING * (cells.to() - cells.from());
        let displacement = |there: &Vec<f64>| {
            let by = there.first()? - here.first()?;
            let pairs = there.iter().zip(here);
            let mut apart = pairs.map(|(there, here)| (there - here - by).abs());
            (there.len() == here.len() && apart.all(|apart| apart <= small)).then_some(by)
        };
        let [below, above] = [displacement(first)?, displacement(last)?];
        let (least, most) = (below.min(above).min(0.0), below.max(above).max(0.0));
        let serves = systems.iter().any(|system| {
            let mut all = system.facts().switching_surfaces.iter();
            let one = std::slice::from_ref(system);
            all.any(|surface| {
                let is_inside = surface.axis == axis && cells.find(surface.at).is_some();
                is_inside && wants_face(one, *surface, space)
            })
        });
        let is_near = most - least <= MOST * (cells.to() - cells.from());
        (most - least > small && is_near && serves).then(|| MovingSurfaces {
            axis,
            displacements: [least, most],
            places: here.clone(),
            left: [&first[..], &last[..]].concat(),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Axis;
    use crate::system::{Family, Path, TypedModel};

    fn found(force: &str) -> Option<MovingSurfaces> {
        let model = TypedModel::new("belt", "A mass on a belt", ["x", "y"])
            .with_equation("x", "y")
            .with_equation("y", force)
            .with_noise("y", ["0.3"])
            .with_parameters(["v"])
            .build()
            .unwrap();
        let family = Family::new(model, &[], Path::parameter("v", 0.2, 1.0)).unwrap();
        let axis = || Axis::uniform(-4.0, 4.0, 40).unwrap();
        let space = CellSpace::new(vec![axis(), axis()]).unwrap();
        moving_surfaces(&family.along().unwrap(), &space)
    }

    #[test]
    fn surfaces_that_move_alike_are_found() {
        let moving = found("-x - y - sign(y - v)").unwrap();
        assert_eq!(moving.axis, 1);
        assert!((moving.displacements[0] + 0.4).abs() < 1e-12, "{moving:?}");
        assert!((moving.displacements[1] - 0.4).abs() < 1e-12, "{moving:?}");
        assert_eq!(found("-x - y - sign(y)"), None);
        assert_eq!(found("-x - y - sign(y - v) - sign(y)"), None);
        assert_eq!(found("-v x - y"), None);
    }
}
