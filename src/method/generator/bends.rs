//! What schemes err alike beside a plane at which a force jumps, bends or turns, as that of a Hertz contact does.
//!
//! States cross the plane without noise, so that the density follows the force: where a derivative of the force is not
//! continuous, one of the density is not either, and every stencil that reaches across takes its slope along the axis
//! wrongly. To first order that is as if the force were another one in the cells beside the plane: f + δf, where δf is
//! by how much the stencil's derivative of ∫ f dx is off. What this force would change of the steady state is a part of
//! its error. Beside planes past which no stencil reaches it is `generator::spurious` that tells what a scheme adds.

use std::cmp::Ordering;

use super::session::{GeneratorSession, PointSolve, ROUGH};
use crate::generator::{AdvectiveScheme, spurious_at_breaks};
use crate::method::MethodError;
use crate::method::structure::turning_surfaces;
use crate::space::{Axis, CellSpace};
use crate::stationary::generator::RateError;
use crate::system::{SwitchingSurface, System};

/// Nodes on either side of a plane whose stencils reach across it.
const REACH: usize = 3;

/// Weights of a scheme's derivative at a node whose speed is above zero, from three nodes below it on.
fn weights(scheme: AdvectiveScheme) -> [f64; 7] {
    match scheme {
        AdvectiveScheme::Upwind5 => {
            [-2.0, 15.0, -60.0, 20.0, 30.0, -3.0, 0.0].map(|one| one / 60.0)
        }
        AdvectiveScheme::Central4 => [0.0, 1.0, -8.0, 0.0, 8.0, -1.0, 0.0].map(|one| one / 12.0),
        AdvectiveScheme::Central6 => [-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0].map(|one| one / 60.0),
    }
}

/// Positive nodes of Gauss's rule of eight on (-1, 1), with their weights.
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
];

/// What all schemes err alike beside a jump of the force, with what they differ by, over the latter: they take the
/// density from the same few cells there.
const SHARED_AT_JUMPS: f64 = 2.0;

impl GeneratorSession {
    /// What the second scheme changes, with what schemes err alike beside planes at which a force turns, bends or
    /// jumps; that has the sign with which both together are larger. Where nobody can tell what they err alike beside
    /// a jump, it is taken to be as large as what they differ by.
    pub(super) fn with_bends(
        &mut self,
        solved: &PointSolve,
        mut change: Vec<f64>,
    ) -> Result<Vec<f64>, MethodError> {
        let Some(lines) = &solved.second else {
            return Ok(change);
        };
        let (system, space) = (solved.system.as_ref(), self.source.problem.space());
        let mut surfaces = turning_surfaces(system, space);
        surfaces.retain(|surface| !lines.is_broken_at(surface.axis, surface.at));
        let unknowns = &solved.steady.mass;
        let scheme = self.source.options.scheme;
        let turning = spurious_flow((system, space), scheme, &surfaces, unknowns);
        let broken = match lines.has_breaks() {
            true => spurious_at_breaks(system, space, scheme, unknowns)
                .map_err(|error| self.source.refused(error))?,
            false => None,
        };
        let is_untold = broken.is_none() && lines.has_jumps();
        let twice = |change: Vec<f64>| {
            change
                .into_iter()
                .map(|one| SHARED_AT_JUMPS * one)
                .collect()
        };
        if is_untold {
            change = twice(change);
        }
        if let Some(flow) = sum(turning, broken) {
            let more = match self.solver.response(&flow, unknowns, None, ROUGH) {
                Err(RateError::Sensitivity) if !is_untold && lines.has_jumps() => {
                    return Ok(twice(change));
                }
                Err(RateError::Sensitivity) => return Ok(change),
                more => more?,
            };
            let together: f64 = change.iter().zip(&more).map(|(a, b)| a * b).sum();
            let sign = if together < 0.0 { -1.0 } else { 1.0 };
            let pairs = change.iter_mut().zip(more);
            pairs.for_each(|(change, more)| *change += sign * more);
        }
        Ok(change)
    }
}

/// The sum of what there is.
fn sum(one: Option<Vec<f64>>, other: Option<Vec<f64>>) -> Option<Vec<f64>> {
    match (one, other) {
        (Some(mut one), Some(other)) => {
            one.iter_mut().zip(other).for_each(|(a, b)| *a += b);
            Some(one)
        }
        (one, other) => one.or(other),
    }
}

/// By how much more mass enters each cell by the spurious forces beside some planes; `unknowns` are those of the steady
/// state. `None` where nothing flows, or nobody can tell how much.
fn spurious_flow(
    (system, space): (&dyn System, &CellSpace),
    scheme: AdvectiveScheme,
    surfaces: &[SwitchingSurface],
    unknowns: &[f64],
) -> Option<Vec<f64>> {
    let mut change = vec![0.0; unknowns.len()];
    for surface in surfaces {
        let others = (0..space.dimension()).filter(|&axis| axis != surface.axis);
        for axis in others.filter(|&axis| !space.axes()[axis].is_modes()) {
            let forces = spurious_forces((system, space), scheme, *surface, axis);
            add_flow(space, axis, &forces, unknowns, &mut change);
        }
    }
    let flows = change.iter().any(|&rate| rate != 0.0);
    let is_finite = change.iter().all(|rate| rate.is_finite());
    (flows && is_finite).then_some(change)
}

/// δf along an axis in all cells; zero but for those beside the plane.
fn spurious_forces(
    (system, space): (&dyn System, &CellSpace),
    scheme: AdvectiveScheme,
    surface: SwitchingSurface,
    axis: usize,
) -> Vec<f64> {
    let along = &space.axes()[surface.axis];
    let nodes = along.nodes();
    let above = nodes.partition_point(|&node| node < surface.at);
    let near = above.saturating_sub(REACH)..(above + REACH).min(nodes.len());
    let weights = weights(scheme);
    let force = |cell: usize| {
        let position = space.position(cell, surface.axis);
        if !near.contains(&position) {
            return 0.0;
        }
        let mut state = space.node(cell);
        let speed = system.drift_at(0.0, &state)[surface.axis];
        let mut at = |x: f64| {
            state[surface.axis] = x;
            system.drift_at(0.0, &state)[axis]
        };
        let mut slope = |direction| {
            derivative_of_integral(
                along,
                (position, direction),
                (&weights, surface.at),
                &mut at,
            )
        };
        // Where nothing moves both directions serve, so that mirror images stay that.
        let both = match speed.total_cmp(&0.0) {
            Ordering::Greater => [slope(1); 2],
            Ordering::Less => [slope(-1); 2],
            Ordering::Equal => [slope(1), slope(-1)],
        };
        let [Some(one), Some(other)] = both else {
            return 0.0;
        };
        0.5 * (one + other) - at(nodes[position])
    };
    (0..space.n_cells()).map(force).collect()
}

/// The stencil's derivative of ∫ f dx at a node, for a direction of the speed; `None` where it reaches beyond the ends.
fn derivative_of_integral(
    axis: &Axis,
    (position, direction): (usize, isize),
    (weights, plane): (&[f64], f64),
    force: &mut impl FnMut(f64) -> f64,
) -> Option<f64> {
    let nodes = axis.nodes();
    let mut sum = 0.0;
    for (place, &weight) in weights.iter().enumerate().filter(|(_, one)| **one != 0.0) {
        let offset = direction * (place as isize - REACH as isize);
        let node = *nodes.get(position.checked_add_signed(offset)?)?;
        sum += direction as f64 * weight * integral(nodes[position], node, plane, force);
    }
    Some(sum / axis.node_stretch(position))
}

/// ∫ f dx by Gauss's rule on either side of a plane.
fn integral(from: f64, to: f64, plane: f64, force: &mut impl FnMut(f64) -> f64) -> f64 {
    let middle = plane.clamp(from.min(to), from.max(to));
    let mut part = |from: f64, to: f64| {
        let (centre, half) = (0.5 * (from + to), 0.5 * (to - from));
        let values = GAUSS.iter().map(|(node, weight)| {
            let [below, above] = [-1.0, 1.0].map(|sign| force(centre + sign * half * node));
            weight * (below + above)
        });
        half * values.sum::<f64>()
    };
    part(from, middle) + part(middle, to)
}

/// Adds -∂(δf p)/∂x along an axis, by central differences; nothing flows through the ends.
fn add_flow(space: &CellSpace, axis: usize, forces: &[f64], unknowns: &[f64], change: &mut [f64]) {
    let along = &space.axes()[axis];
    let stride: usize = space.shape()[axis + 1..].iter().product();
    let flux = |cell: usize| {
        let stretch = along.node_stretch(space.position(cell, axis));
        forces[cell] * unknowns[cell] / stretch
    };
    for cell in 0..unknowns.len() {
        if space.position(cell, axis) + 1 < along.count() {
            let next = cell + stride;
            let across = 0.5 * (flux(cell) + flux(next));
            change[cell] -= across;
            change[next] += across;
        }
    }
}
