//! What a system's equations imply for a density that is watched: its centre of symmetry, and its kinks.

mod kink;
mod moving;
mod smoothness;
mod undriven;

use std::sync::Arc;

use crate::density::{Kink, Observable, Structure};
use crate::space::CellSpace;
use crate::system::{self, SwitchingSurface, System, proved_symmetry, symmetry_over_a_period};
pub(super) use kink::intensity_beside;
use kink::kink;
pub(super) use moving::{MovingSurfaces, moving_surfaces};
use smoothness::{Break, break_at};

/// The switching surfaces with a kink of the density somewhere along a sweep, given systems along it. Where the drift
/// across a surface is continuous (as Dahl's is), the density is smooth there.
pub(super) fn kinked_surfaces(
    systems: &[Arc<dyn System>],
    space: &CellSpace,
) -> Vec<SwitchingSurface> {
    let Some(first) = systems.first() else {
        return Vec::new();
    };
    let evenly = vec![1.0; space.n_cells()];
    let jumps = |system: &Arc<dyn System>, surface: SwitchingSurface| {
        let found = kink(system.as_ref(), space, &evenly, &[surface.axis], surface);
        found.map_or(0.0, |kink| kink.jump_at(0).abs())
    };
    let mut surfaces = first.facts().switching_surfaces.clone();
    surfaces.retain(|&surface| {
        let width = space.axes()[surface.axis].to() - space.axes()[surface.axis].from();
        let largest = systems.iter().map(|system| jumps(system, surface));
        largest.fold(0.0, f64::max) * width > Kink::ROUNDING
    });
    surfaces
}

/// The same, with those across which no noise acts. What they make of a density is read from it, which a sampled one
/// does not allow.
pub(super) fn all_kinked_surfaces(
    systems: &[Arc<dyn System>],
    space: &CellSpace,
) -> Vec<SwitchingSurface> {
    let mut surfaces = kinked_surfaces(systems, space);
    let declared = systems
        .first()
        .map(|system| &system.facts().switching_surfaces);
    let others = declared.into_iter().flatten().copied();
    surfaces.extend(others.filter(|&surface| {
        let along = systems.iter();
        let jumping = along.filter(|system| undriven::jumps(system.as_ref(), space, surface));
        let known: Vec<bool> = jumping
            .map(|system| undriven::is_known(system.as_ref(), space, surface))
            .collect();
        !known.is_empty() && known.iter().all(|&known| known)
    }));
    surfaces
}

/// The switching surfaces across which no noise acts and on which a force bends or turns.
pub(super) fn turning_surfaces(system: &dyn System, space: &CellSpace) -> Vec<SwitchingSurface> {
    let turns = |surface: &SwitchingSurface| {
        let found = break_at(system, space, *surface);
        matches!(found, Break::Curvature | Break::Bend)
    };
    let mut surfaces = system.facts().switching_surfaces.clone();
    surfaces.retain(|surface| {
        let is_carried = space.axes()[surface.axis].is_modes();
        !is_carried && !undriven::is_driven(system, *surface) && turns(surface)
    });
    surfaces
}

/// The places of the switching surfaces across an axis that stay where they are all along the sweep, and at which
/// faces serve.
pub(crate) fn fixed_surfaces(
    systems: &[Arc<dyn System>],
    axis: usize,
    space: &CellSpace,
) -> Vec<f64> {
    let Some((first, others)) = systems.split_first() else {
        return Vec::new();
    };
    let surfaces = first.facts().switching_surfaces.iter();
    let stays = |surface: &&SwitchingSurface| {
        let mut others = others.iter();
        others.all(|system| {
            let mut surfaces = system.facts().surfaces_on(axis);
            surfaces.any(|one| one == surface.at)
        })
    };
    let on_axis = surfaces.filter(|surface| surface.axis == axis);
    on_axis
        .filter(stays)
        .filter(|surface| wants_face(systems, **surface, space))
        .map(|surface| surface.at)
        .collect()
}

/// Whether a face serves at a switching surface. Across an axis without noise a curvature of the drift that jumps, as
/// that of x |x|, moves the third derivative of a density alone: faces would spoil the cells for what is sharper.
pub(crate) fn wants_face(
    systems: &[Arc<dyn System>],
    surface: SwitchingSurface,
    space: &CellSpace,
) -> bool {
    let is_smoother = |system: &Arc<dyn System>| {
        let system = system.as_ref();
        !undriven::is_driven(system, surface)
            && break_at(system, space, surface) == Break::Curvature
    };
    !systems.iter().all(is_smoother)
}

/// Whether the lower and upper end of each axis is a wall that the system cannot pass, all along the sweep, or belongs
/// to a series.
pub(super) fn closed_ends(systems: &[Arc<dyn System>], space: &CellSpace) -> Vec<[bool; 2]> {
    let ranges = space.ranges();
    let axes = space.axes().iter().enumerate();
    axes.map(|(axis, cells)| {
        if cells.is_modes() {
            return [true; 2];
        }
        let walls = systems
            .iter()
            .map(|system| system::closed_ends(system.as_ref(), axis, &ranges));
        walls
            .reduce(|one, other| [one[0] && other[0], one[1] && other[1]])
            .unwrap_or_default()
    })
    .collect()
}

/// Whether noise dies at the lower and upper end of each axis of cells, for one of the systems along the sweep.
pub(super) fn natural_ends(systems: &[Arc<dyn System>], space: &CellSpace) -> Vec<[bool; 2]> {
    let ranges = space.ranges();
    let axes = space.axes().iter().enumerate();
    axes.map(|(axis, cells)| {
        let systems = systems.iter().filter(|_| !cells.is_modes());
        let natural = systems.map(|system| system::natural_ends(system.as_ref(), axis, &ranges));
        natural
            .reduce(|one, other| [one[0] || other[0], one[1] || other[1]])
            .unwrap_or_default()
    })
    .collect()
}

/// Whether a density is one over a whole period of the forcing, or at one phase of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Moment {
    Mean,
    Phase,
}

/// Structure of the density of an observable; `masses` are those of all cells, `surfaces` those with a kink.
pub(super) fn structure(
    system: &dyn System,
    space: &CellSpace,
    masses: &[f64],
    observable: Observable,
    surfaces: &[SwitchingSurface],
    moment: Moment,
) -> Structure {
    let axes = observable.axes();
    let mut kinks: Vec<Kink> = Vec::new();
    let mut known = Vec::new();
    for &surface in surfaces {
        let found = match undriven::is_driven(system, surface) {
            true => kink(system, space, masses, &axes, surface),
            false => undriven::kink(system, space, masses, &axes, surface),
        };
        known.extend(found.is_some().then_some((surface.axis, surface.at)));
        kinks.extend(found);
    }
    let mut centre = centre(system, space, &axes, moment);
    let declared = &system.facts().switching_surfaces;
    let others = (declared.iter())
        .filter(|one| !known.contains(&(one.axis, one.at)))
        .filter_map(|one| {
            let axis = axes.iter().position(|&axis| axis == one.axis)?;
            let jump = match (
                break_at(system, space, *one),
                undriven::is_driven(system, *one),
            ) {
                (Break::Bend, _) | (Break::Curvature, true) | (Break::Jump, false) => Vec::new(),
                (Break::None, _) | (Break::Curvature, false) | (Break::Jump, true) => return None,
            };
            let at = one.at;
            Some(Kink { axis, at, jump })
        });
    kinks.extend(others);
    // A slope that jumps at the centre by nobody knows how much: its curvature there says nothing, and persistence
    // judges.
    let is_torn = |centre: &Vec<f64>| {
        let mut unknown = declared
            .iter()
            .filter(|one| !known.contains(&(one.axis, one.at)));
        unknown.any(|one| {
            let place = axes.iter().position(|&axis| axis == one.axis);
            let on_centre = place
                .is_some_and(|place| space.axes()[one.axis].is_same_place(one.at, centre[place]));
            on_centre && undriven::jumps(system, space, *one)
        })
    };
    if centre.as_ref().is_some_and(is_torn) {
        centre = None;
    }
    let ranges = space.ranges();
    let own_end = |&axis: &usize| match space.axes()[axis].is_modes() {
        true => [true; 2],
        false => system::closed_ends(system, axis, &ranges),
    };
    Structure {
        centre,
        kinks,
        ..Structure::default()
    }
    .with_own_ends(axes.iter().map(own_end))
}

/// The point of symmetry, where all axes that are kept are reflected.
fn centre(
    system: &dyn System,
    space: &CellSpace,
    axes: &[usize],
    moment: Moment,
) -> Option<Vec<f64>> {
    let ends: Vec<(f64, f64)> = space
        .axes()
        .iter()
        .map(|axis| (axis.from(), axis.to()))
        .collect();
    let symmetry = match moment {
        Moment::Mean => symmetry_over_a_period(system, &ends)?,
        Moment::Phase => proved_symmetry(system, &ends)?,
    };
    let all = axes.iter().all(|&axis| symmetry.reflected[axis]);
    all.then(|| axes.iter().map(|&axis| symmetry.centre[axis]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Axis;
    use crate::system::registry;

    #[test]
    fn coulomb_friction_makes_the_slope_of_log_p_jump_by_four_friction_levels_over_the_noise() {
        let model = registry::find("coulomb").unwrap();
        let with_friction = |f_c| {
            let given = [
                ("kappa", 0.01),
                ("alpha", 1.0),
                ("mu", 0.01),
                ("f_c", f_c),
                ("sigma2", 0.01),
            ];
            model.system_with(&given).unwrap()
        };
        let system = with_friction(-0.02);
        let axis = |count| Axis::uniform(-2.0, 2.0, count).unwrap();
        let space = CellSpace::new(vec![axis(6), axis(10)]).unwrap();
        let masses = vec![1.0 / 60.0; 60];
        let without = with_friction(0.0);
        assert!(kinked_surfaces(std::slice::from_ref(&without), &space).is_empty());
        let surfaces = kinked_surfaces(&[without, system.clone()], &space);
        assert_eq!(surfaces.len(), 1);
        for (observable, place, bins) in [
            (Observable::Marginal(1), 0, 1),
            (Observable::Joint(0, 1), 1, 6),
            (Observable::Joint(1, 0), 0, 6),
        ] {
            let structure = structure(
                system.as_ref(),
                &space,
                &masses,
                observable,
                &surfaces,
                Moment::Mean,
            );
            let [kink] = structure.kinks.as_slice() else {
                panic!("one kink");
            };
            assert_eq!((kink.axis, kink.at, kink.jump.len()), (place, 0.0, bins));
            // p'(0+)/p(0) = -2 f_c/σ² = 4 above, -4 below.
            assert!(kink.jump.iter().all(|jump| (jump - 8.0).abs() < 1e-9));
            assert_eq!(structure.centre, Some(vec![0.0; observable.axes().len()]));
        }
        let x = Observable::Marginal(0);
        let of_x = structure(system.as_ref(), &space, &masses, x, &surfaces, Moment::Mean);
        assert!(of_x.kinks.is_empty());
    }
}
