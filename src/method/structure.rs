//! What a system's equations imply for a density that is watched: its centre of symmetry, and its kinks.
//!
//! On a plane where the drift across it jumps by Δa and the slope of b² by Δ(b²)', flux and density are continuous, so the derivative of
//! log p across the plane jumps by (2 Δa - Δ(b²)')/b²: the jump law. Where axes are summed over, Δa is the mean over
//! the mass beside the plane.

use std::sync::Arc;

use crate::density::{Kink, Observable, Structure};
use crate::space::CellSpace;
use crate::system::{SwitchingSurface, System, proved_symmetry};

/// Distance from the plane, in widths of the cell beside it, at which the drift on either side is taken.
const BESIDE: f64 = 1e-6;
/// Times that distance, for slopes of the noise.
const FARTHER: f64 = 100.0;

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
    let mut surfaces = first.switching_surfaces();
    surfaces.retain(|&surface| {
        let width = space.axes()[surface.axis].to() - space.axes()[surface.axis].from();
        let largest = systems.iter().map(|system| jumps(system, surface));
        largest.fold(0.0, f64::max) * width > Kink::ROUNDING
    });
    surfaces
}

/// Whether the lower and upper end of each axis is a wall that the system cannot pass, all along the sweep, or belongs to a series.
pub(super) fn closed_ends(systems: &[Arc<dyn System>], space: &CellSpace) -> Vec<[bool; 2]> {
    let axes = space.axes().iter().enumerate();
    axes.map(|(axis, cells)| {
        if cells.is_modes() {
            return [true; 2];
        }
        let range = (cells.from(), cells.to());
        let walls = systems.iter().map(|system| system.walls(axis, range));
        walls
            .reduce(|one, other| [one[0] && other[0], one[1] && other[1]])
            .unwrap_or_default()
    })
    .collect()
}

/// Structure of the density of an observable; `masses` are those of all cells, `surfaces` those with a kink.
pub(super) fn structure(
    system: &dyn System,
    space: &CellSpace,
    masses: &[f64],
    observable: Observable,
    surfaces: &[SwitchingSurface],
) -> Structure {
    let axes = observable.axes();
    let jumps = surfaces.iter();
    let mut kinks: Vec<Kink> = jumps
        .filter_map(|surface| kink(system, space, masses, &axes, *surface))
        .collect();
    let centre = centre(system, space, &axes);
    let known: Vec<(usize, f64)> = surfaces.iter().map(|one| (one.axis, one.at)).collect();
    let declared = system.switching_surfaces().into_iter();
    let others = declared
        .filter(|one| !known.contains(&(one.axis, one.at)))
        .filter_map(|one| {
            let axis = axes.iter().position(|&axis| axis == one.axis)?;
            let jump = match break_at(system, space, one) {
                Break::None | Break::Jump => return None,
                Break::Bend => Vec::new(),
            };
            let at = one.at;
            Some(Kink { axis, at, jump })
        });
    kinks.extend(others);
    Structure { centre, kinks }
}

/// How smooth a system is across a surface on which the jump law asks for no kink of the density.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
enum Break {
    /// As smooth as elsewhere.
    None,
    /// Drift or noise across it bends, or its curvature jumps.
    Bend,
    /// The drift across it jumps: the jump law tells of it.
    Jump,
}

/// Distance between states from which values, slopes and curvatures on one side of a surface are taken, as a share of the range.
const APART: f64 = 1e-5;
/// A jump of a value or of a slope that is a smaller share of the values, in units of the range, is rounding.
const ROUNDING: f64 = 1e-6;
/// The same of a curvature: smooth functions may turn fast.
const SMOOTH: f64 = 0.1;

fn break_at(system: &dyn System, space: &CellSpace, surface: SwitchingSurface) -> Break {
    let axis = &space.axes()[surface.axis];
    if axis.find(surface.at).is_none() {
        return Break::None;
    }
    let step = APART * (axis.to() - axis.from());
    // On the middle of the other axes, and at two places aside.
    let worst = [0.31, 0.5, 0.73].into_iter().map(|share| {
        let ends = space.axes().iter();
        let mut state: Vec<f64> = ends
            .map(|one| one.from() + share * (one.to() - one.from()))
            .collect();
        let mut across = |offset: f64| {
            state[surface.axis] = surface.at + offset;
            // What moves other axes bends a density in higher derivatives only.
            let own = |channel: &usize| system.noise_axes()[*channel] == surface.axis;
            let channels = (0..system.noise_axes().len()).filter(own);
            let mut values = vec![system.drift_at(0.0, &state)[surface.axis]];
            values.extend(channels.map(|one| system.amplitude_at(one, 0.0, &state).powi(2)));
            values
        };
        let far = 0.25 / APART;
        let mut side = |sign: f64| [1.0, 2.0, 3.0, far].map(|k| across(sign * k * step));
        let (above, below) = (side(1.0), side(-1.0));
        let of = |side: &[Vec<f64>; 4], which: usize| [0, 1, 2, 3].map(|k| side[k][which]);
        let found =
            (0..above[0].len()).map(|which| how_smooth(of(&above, which), of(&below, which)));
        found.fold(
            Break::None,
            |worst, one| if one > worst { one } else { worst },
        )
    });
    worst.fold(
        Break::None,
        |worst, one| if one > worst { one } else { worst },
    )
}

/// From values at one, two and three steps on either side of a surface, and far away.
fn how_smooth(above: [f64; 4], below: [f64; 4]) -> Break {
    let size = above
        .iter()
        .chain(&below)
        .fold(0.0_f64, |max, one| max.max(one.abs()));
    // On the surface, in units of the range; away from it.
    let value = |f: [f64; 4]| 3.0 * f[0] - 3.0 * f[1] + f[2];
    let slope = |f: [f64; 4]| (-2.5 * f[0] + 4.0 * f[1] - 1.5 * f[2]) / APART;
    let curvature = |f: [f64; 4]| (f[0] - 2.0 * f[1] + f[2]) / (APART * APART);
    if (value(above) - value(below)).abs() > ROUNDING * size {
        Break::Jump
    } else if (slope(above) + slope(below)).abs() > ROUNDING * size
        || (curvature(above) - curvature(below)).abs() > SMOOTH * size
    {
        Break::Bend
    } else {
        Break::None
    }
}

/// The point of symmetry, where all axes that are kept are reflected.
fn centre(system: &dyn System, space: &CellSpace, axes: &[usize]) -> Option<Vec<f64>> {
    let ends: Vec<(f64, f64)> = space
        .axes()
        .iter()
        .map(|axis| (axis.from(), axis.to()))
        .collect();
    let symmetry = proved_symmetry(system, &ends)?;
    let all = axes.iter().all(|&axis| symmetry.reflected[axis]);
    all.then(|| axes.iter().map(|&axis| symmetry.centre[axis]).collect())
}

/// The kink that a surface makes in the density of the given axes, if it stands on one of them and noise acts across it.
fn kink(
    system: &dyn System,
    space: &CellSpace,
    masses: &[f64],
    axes: &[usize],
    surface: SwitchingSurface,
) -> Option<Kink> {
    let place = axes.iter().position(|&axis| axis == surface.axis)?;
    let axis = &space.axes()[surface.axis];
    let cell = axis.find(surface.at)?;
    let step = BESIDE * axis.width(cell);
    let noise: Vec<usize> = (0..system.noise_axes().len())
        .filter(|&channel| system.noise_axes()[channel] == surface.axis)
        .collect();
    let other = beside_axis(space, axes, surface.axis);
    let bins = bins(space, axes, surface.axis);
    let (mut sums, mut weights) = (vec![0.0; bins], vec![0.0; bins]);
    for index in beside(space, surface) {
        let mut state = space.centre(index);
        let drop = surface.drift_jump(system, &state, step)[surface.axis];
        let mut intensity_at = |offset: f64| {
            state[surface.axis] = surface.at + offset;
            let square = |&channel: &usize| system.amplitude_at(channel, 0.0, &state).powi(2);
            noise.iter().map(square).sum::<f64>()
        };
        let intensity = intensity_at(0.0);
        let slope = slope_jump(&mut intensity_at, step * FARTHER);
        // Without mass beside the plane every state counts alike, and little.
        let weight = masses[index].max(0.0) + f64::MIN_POSITIVE.sqrt();
        let bin = other.map_or(0, |axis| space.position(index, axis));
        if intensity > 0.0 {
            sums[bin] += weight * (2.0 * drop - slope) / intensity;
        }
        weights[bin] += weight;
    }
    let jump: Vec<f64> = sums.iter().zip(&weights).map(|(s, w)| s / w).collect();
    let is_kink = !noise.is_empty() && jump.iter().all(|jump| jump.is_finite());
    is_kink.then_some(Kink {
        axis: place,
        at: surface.at,
        jump,
    })
}

/// The axis along which a kink of a joint density is told. Along an axis of modes nodes are no bins: the mean of all holds for each.
fn beside_axis(space: &CellSpace, axes: &[usize], across: usize) -> Option<usize> {
    let mut others = axes.iter().copied();
    others.find(|&axis| axis != across && !space.axes()[axis].is_modes())
}

/// Values that a kink is told by.
fn bins(space: &CellSpace, axes: &[usize], across: usize) -> usize {
    beside_axis(space, axes, across).map_or(1, |axis| space.axes()[axis].count())
}

/// Jump of the slope of a continuous function at zero, to the second order of a distance.
fn slope_jump(of: &mut impl FnMut(f64) -> f64, distance: f64) -> f64 {
    let mut side = |sign: f64| {
        let [near, middle, far] = [1.0, 2.0, 3.0].map(|k| of(sign * k * distance));
        (-2.5 * near + 4.0 * middle - 1.5 * far) / distance
    };
    side(1.0) + side(-1.0)
}

/// Cells of the space on both sides of a surface (those that hold it, where it falls into cells).
fn beside(space: &CellSpace, surface: SwitchingSurface) -> Vec<usize> {
    let Some(beside) = space.axes()[surface.axis].cells_beside(surface.at) else {
        return Vec::new();
    };
    (0..space.n_cells())
        .filter(|&index| beside.contains(&space.position(index, surface.axis)))
        .collect()
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
            let structure = structure(system.as_ref(), &space, &masses, observable, &surfaces);
            let [kink] = structure.kinks.as_slice() else {
                panic!("one kink");
            };
            assert_eq!((kink.axis, kink.at, kink.jump.len()), (place, 0.0, bins));
            // p'(0+)/p(0) = -2 f_c/σ² = 4 above, -4 below.
            assert!(kink.jump.iter().all(|jump| (jump - 8.0).abs() < 1e-9));
            assert_eq!(structure.centre, Some(vec![0.0; observable.axes().len()]));
        }
        let x = Observable::Marginal(0);
        let of_x = structure(system.as_ref(), &space, &masses, x, &surfaces);
        assert!(of_x.kinks.is_empty());
    }
}
