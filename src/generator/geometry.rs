//! One axis as the discretisation sees it: nodes, local widths, ends, and the stencil of every face.

use super::GeneratorOptions;
use super::modes::ModeAxis;
use super::scheme::{AdvectiveScheme, DAMPING_BESIDE_MODES, Dissipation, REACH, Window};
use super::smooth::{EVEN_OFFSETS, GAUSS};
use super::turns::{Turn, turn_at};
use crate::numerics::sort_descending;
use crate::space::{Axis, CellSpace, Series};
use crate::system::{System, closed_ends};

/// What lies beyond an end of the axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
    /// A value the coordinate never leaves: no flux.
    Wall,
    /// The sink: what flows out is lost, nothing comes in.
    Open,
}

/// How the flux through a face is formed. No stencil reaches past an end: the order falls there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FaceStencil {
    /// Weights of the flux function at the nodes.
    pub(super) central: Window,
    /// Weights of the density that, times the speed, damp what the grid cannot resolve.
    pub(super) dissipation: Window,
    /// Weights of the derivative at the face by the cell coordinate.
    pub(super) derivative: Window,
    /// Whether both neighbouring faces carry a derivative, so that the fourth-order correction applies.
    pub(super) corrected: bool,
}

/// An inner face on which a derivative of the density jumps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Break {
    /// Its number, that of the cell above it.
    pub(super) face: usize,
    /// Whether the slope of the density jumps, as it does with a force. Where a force bends it is the second derivative
    /// that jumps.
    pub(super) slope_jumps: bool,
    /// How the slope on either side is taken of the nodes, from the plane on, where it jumps and the scheme makes good
    /// what fluxes leave out there.
    pub(super) slope: Option<[f64; REACH]>,
}

/// An axis with its stencils.
#[derive(Debug, Clone)]
pub(super) struct AxisGeometry {
    /// Nodes, one a cell.
    pub(super) nodes: Vec<f64>,
    /// dx/du at the nodes.
    pub(super) widths: Vec<f64>,
    /// Edges, one more than cells.
    pub(super) edges: Vec<f64>,
    /// Offsets of the quadrature points of each cell from its node, in the cell coordinate.
    pub(super) inner_offsets: Vec<[f64; 4]>,
    /// dx/du at the edges.
    pub(super) face_widths: Vec<f64>,
    /// Lower and upper end.
    pub(super) ends: [End; 2],
    /// One a face, ends included (theirs are empty).
    pub(super) stencils: Vec<FaceStencil>,
    /// At the lower and upper end, if it is a wall that reflects and the scheme makes good what the flux through it
    /// leaves out: what of the rates along other axes, in the cells from the wall on, is added to those of the first.
    pub(super) along_walls: [Option<[f64; REACH]>; 2],
    /// Whether fluxes beside a wall depend on the scheme in their derivatives too.
    pub(super) has_wall_stencils: bool,
    /// Cells on either side that an entry of the matrix may reach.
    pub(super) reach: usize,
    /// Inner faces on which a derivative of the density jumps, past which no stencil of a flux reaches.
    pub(super) breaks: Vec<Break>,
    /// Inner faces of an axis with noise on which drifts along other axes bend, and the one along it does not jump.
    pub(super) bends: Vec<usize>,
    /// Of each face of an axis with noise, whether its stencil reaches across a switching surface: there the density
    /// has a kink, and its product with the fitted exponential has none.
    pub(super) is_across: Vec<bool>,
    /// Of an axis of modes, what tests them.
    pub(super) modes: Option<ModeAxis>,
}

impl AxisGeometry {
    /// The axis number `index` of a grid for a system.
    pub(super) fn new(
        system: &dyn System,
        index: usize,
        space: &CellSpace,
        scheme: AdvectiveScheme,
    ) -> Self {
        let axis = &space.axes()[index];
        let count = axis.count();
        let damping = damping(space);
        let noisy = system.is_noisy(index);
        // Where no noise acts, a derivative of the density jumps with the drift or its slope.
        let breaks = match noisy || axis.is_modes() {
            true => Vec::new(),
            false => breaks(system, index, space, scheme),
        };
        let kinks = match noisy && !axis.is_modes() {
            true => surface_faces(system, index, axis),
            false => Vec::new(),
        };
        let bends = kinks.iter().copied().filter(|&face| {
            let found = turn_at(system, (index, face), space);
            found.own != Turn::Jump && found.others == Turn::Bend
        });
        let is_across = |face: usize| kinks.iter().any(|kink| kink.abs_diff(face) < REACH);
        let end = |wall: bool| if wall { End::Wall } else { End::Open };
        let ranges = space.ranges();
        let mut stencils: Vec<FaceStencil> = (0..=count)
            .map(|face| stencil(scheme, damping, (face, count), &breaks))
            .collect();
        let walls = reflecting_walls(system, index, axis);
        let mut along_walls = [None; 2];
        let faces = [1, count.saturating_sub(1)];
        for ((is_wall, face), along) in walls.into_iter().zip(faces).zip(&mut along_walls) {
            let is_smooth = count >= 2 * REACH && !is_across(face);
            if let Some(found) = scheme.beside_wall().filter(|_| is_wall && is_smooth) {
                let found = if face == 1 { found } else { found.mirrored() };
                *along = Some(found.along);
                stencils[face] = FaceStencil {
                    central: found.central,
                    dissipation: found.dissipation.map(|weight| damping * weight),
                    derivative: found.derivative,
                    // The flux through the wall itself is nothing.
                    corrected: true,
                };
            }
        }
        Self {
            nodes: axis.nodes().to_vec(),
            widths: (0..count).map(|cell| axis.node_stretch(cell)).collect(),
            edges: axis.edges().to_vec(),
            inner_offsets: (0..count).map(|cell| inner_offsets(axis, cell)).collect(),
            face_widths: (0..=count).map(|face| axis.edge_stretch(face)).collect(),
            ends: closed_ends(system, index, &ranges).map(end),
            stencils,
            along_walls,
            has_wall_stencils: walls.contains(&true),
            reach: match (axis.is_modes(), noisy) {
                (true, _) => count - 1,
                (false, true) => REACH,
                (false, false) if !breaks.is_empty() => REACH,
                (false, false) => scheme.reach(),
            },
            breaks,
            bends: bends.collect(),
            is_across: (0..=count).map(is_across).collect(),
            modes: ModeAxis::new(axis),
        }
    }

    /// Faces of a cell on which a derivative of the flux along the axis jumps.
    pub(super) fn turns_beside(&self, cell: usize) -> impl Iterator<Item = usize> {
        let breaks = self.breaks.iter().map(|one| one.face);
        let faces = breaks.chain(self.bends.iter().copied());
        faces.filter(move |&face| face == cell || face == cell + 1)
    }

    /// Whether something is added for what fluxes through walls or breaks leave out.
    pub(super) fn has_sides(&self) -> bool {
        let is_at_wall = self.along_walls.iter().any(Option::is_some);
        is_at_wall || self.breaks.iter().any(|at| at.slope.is_some())
    }

    /// As [`Self::new`], with all or half of the dissipation of the fluxes, for what changes in time.
    pub(super) fn damped(
        system: &dyn System,
        index: usize,
        space: &CellSpace,
        options: &GeneratorOptions,
        dissipation: Dissipation,
    ) -> Self {
        let mut geometry = Self::new(system, index, space, options.scheme);
        geometry.along_walls = [None; 2];
        if dissipation == Dissipation::Half {
            let weights = geometry.stencils.iter_mut();
            let weights = weights.flat_map(|one| &mut one.dissipation);
            weights.for_each(|weight| *weight *= 0.5);
        }
        geometry
    }

    /// Number of cells.
    pub(super) fn count(&self) -> usize {
        self.nodes.len()
    }
}

/// Which ends of an axis of cells are walls that reflect what noise drives against them.
fn reflecting_walls(system: &dyn System, index: usize, axis: &Axis) -> [bool; 2] {
    let facts = system.facts();
    let at = facts.reflecting.get(&index);
    let at = at.filter(|_| system.is_noisy(index) && !axis.is_modes());
    at.map_or([false; 2], |(low, high)| {
        let [lower, upper] = facts.walls(index, (axis.from(), axis.to()));
        [lower && low.is_finite(), upper && high.is_finite()]
    })
}

/// The four quadrature points of a cell, ascending: two Gauss points in either half.
pub(super) fn inner_points([from, node, to]: [f64; 3]) -> [f64; 4] {
    let point = |from: f64, to: f64, share: f64| from + share * (to - from);
    let [near, far] = GAUSS;
    [
        point(from, node, near),
        point(from, node, far),
        point(node, to, near),
        point(node, to, far),
    ]
}

/// Offsets of the quadrature points of a cell from its node, in the cell coordinate.
fn inner_offsets(axis: &Axis, cell: usize) -> [f64; 4] {
    if axis.is_modes() || axis.has_even_cells(cell) {
        return EVEN_OFFSETS;
    }
    let edges = axis.edges();
    let points = inner_points([edges[cell], axis.nodes()[cell], edges[cell + 1]]);
    points.map(|x| axis.offset(cell, x))
}

/// Distance in cell numbers between neighbours along each axis.
pub(super) fn strides(axes: &[AxisGeometry]) -> Vec<usize> {
    let mut strides = vec![1; axes.len()];
    for axis in (1..axes.len()).rev() {
        strides[axis - 1] = strides[axis] * axes[axis].count();
    }
    strides
}

/// Inner faces of an axis on which a switching surface of the system lies.
pub(super) fn surface_faces(system: &dyn System, index: usize, axis: &Axis) -> Vec<usize> {
    let surfaces = system.facts().surfaces_on(index);
    (surfaces.filter_map(|at| axis.face_at(at)))
        .filter(|&face| face > 0 && face < axis.count())
        .collect()
}

/// Inner faces of an axis without noise on which what drives other axes jumps or bends most, each with as many cells as
/// a stencil takes on either side before the next one or an end. The others are left to stencils across them, and so
/// are those at which the drift along the axis itself is not smooth: what flows through them may stop there.
fn breaks(
    system: &dyn System,
    index: usize,
    space: &CellSpace,
    scheme: AdvectiveScheme,
) -> Vec<Break> {
    let axis = &space.axes()[index];
    let mut found: Vec<(f64, Break)> = surface_faces(system, index, axis)
        .into_iter()
        .filter(|face| (REACH..=axis.count().saturating_sub(REACH)).contains(face))
        .filter_map(|face| {
            let found = turn_at(system, (index, face), space);
            let jumps = found.others == Turn::Jump;
            let at = Break {
                face,
                slope_jumps: jumps,
                slope: scheme.slope().filter(|_| jumps),
            };
            let is_break = found.own == Turn::Smooth && found.others != Turn::Smooth;
            is_break.then_some((found.sharpness, at))
        })
        .collect();
    sort_descending(&mut found, |one| one.0);
    let mut kept: Vec<Break> = Vec::new();
    for (_, one) in found {
        if (kept.iter()).all(|other| other.face.abs_diff(one.face) >= REACH) {
            kept.push(one);
        }
    }
    kept.sort_unstable_by_key(|one| one.face);
    kept
}

/// Share of the upwind scheme's dissipation that the cells of a space need.
fn damping(space: &CellSpace) -> f64 {
    let mut series = space.axes().iter().map(Axis::series);
    if series.any(|series| matches!(series, Some(Series::Legendre))) {
        DAMPING_BESIDE_MODES
    } else {
        1.0
    }
}

/// The stencil of a face of so many cells. Stencils of fluxes do not reach past breaks, but for stretches of too few
/// cells.
fn stencil(
    scheme: AdvectiveScheme,
    damping: f64,
    (face, count): (usize, usize),
    breaks: &[Break],
) -> FaceStencil {
    let (below, above) = (face, count - face);
    let cells = below.min(above);
    let (central, dissipation) =
        beside_breaks(scheme, face, count, breaks).unwrap_or_else(|| scheme.symmetric(cells));
    let dissipation = dissipation.map(|weight| damping * weight);
    let derivative = match cells {
        0 => [0.0; 2 * REACH],
        1 => [0.0, 0.0, -1.0, 1.0, 0.0, 0.0],
        _ => [0.0, 1.0, -27.0, 27.0, -1.0, 0.0].map(|weight| weight / 24.0),
    };
    FaceStencil {
        central,
        dissipation,
        derivative,
        corrected: cells >= 2,
    }
}

/// Fluxes through a face that has a break on it, or so near that its stencil would reach past it.
fn beside_breaks(
    scheme: AdvectiveScheme,
    face: usize,
    count: usize,
    breaks: &[Break],
) -> Option<(Window, Window)> {
    let is_near = |at: &&Break| at.face.abs_diff(face) < REACH;
    breaks.iter().find(is_near)?;
    if face == 0 || face == count {
        return None;
    }
    let faces = || breaks.iter().map(|at| at.face);
    let below = face - faces().filter(|at| *at < face).max().unwrap_or(0);
    let above = faces().filter(|at| *at > face).min().unwrap_or(count) - face;
    match breaks.iter().find(|at| at.face == face) {
        Some(at) => Some(scheme.at_break(at.slope_jumps)),
        None => scheme.one_sided(below, above),
    }
}
