//! Settings of the generator method and their defaults.

use crate::continuation::CellCheck;
use crate::generator::AdvectiveScheme;
use crate::method::Problem;
use crate::method::report::ESCAPE_LIMIT;
use crate::method::structure::{MovingSurfaces, moving_surfaces};
use crate::space::{Axis, CellSpace};

/// Settings of the generator method.
#[derive(Debug, Clone, PartialEq)]
pub struct GeneratorMethodOptions {
    /// How advective fluxes are reconstructed.
    pub scheme: AdvectiveScheme,
    /// Gigabytes that factors may take; beyond, a smaller factorisation preconditions.
    pub memory_limit: f64,
    /// L1 error at which the solver stops.
    pub solver_tolerance: f64,
    /// Largest share of the mass that may leave Ω within one relaxation time before there is said to be no
    /// steady state.
    pub escape_limit: f64,
    /// Change of the watched densities that more modes would make, relative to their largest values, where it is known
    /// to be too large: every point then says so, and no change is called located.
    pub change_by_modes: Option<f64>,
}

impl GeneratorMethodOptions {
    /// On finer cells: a scheme of high order shows there what the cells of this space do.
    pub(crate) fn cell_check(problem: &Problem) -> CellCheck {
        let space = problem.space();
        let finer = finer_axes(space);
        let pairs = finer.iter().zip(space.axes());
        let cut = pairs.filter(|(_, axis)| !axis.is_modes());
        let ratios = cut.map(|(finer, axis)| finer.count() as f64 / axis.count() as f64);
        CellCheck::OnFinerCells {
            ratio: ratios.fold(FINER[0], f64::min),
            follows: followed_surfaces(problem).map(|surfaces| surfaces.axis),
        }
    }
}

/// Cells an axis of the finer grid over those of this one, with up to two axes that are cut into cells and with more,
/// of which the phase of a forcing is one.
const FINER: [f64; 2] = [1.5, 1.25];

/// The axes of the grid that checks what is found on this one.
pub(super) fn finer_axes(space: &CellSpace) -> Vec<Axis> {
    let factor = finer_factor(space);
    let axes = space.axes().iter();
    axes.map(|axis| axis.refined(factor)).collect()
}

/// The switching surfaces with which finer cells move: quantities are formulas of coordinates that stay where they are.
pub(super) fn followed_surfaces(problem: &Problem) -> Option<MovingSurfaces> {
    let space = problem.space();
    let mut axes = problem.observables().iter().flat_map(|one| one.axes());
    if space.axes().len() < 2 || axes.any(|axis| axis >= space.axes().len()) {
        return None;
    }
    let family = problem.family();
    let mut found = moving_surfaces(&family.along().ok()?, space)?;
    // Between the ends and the middle they may lie farther off than there.
    let (from, to) = family.ends();
    for share in (0..=SAMPLED).map(|step| f64::from(step) / f64::from(SAMPLED)) {
        let system = family.at(from + share * (to - from)).ok()?;
        let by = system.facts().surfaces_on(found.axis).next()? - found.places[0];
        let [least, most] = &mut found.displacements;
        (*least, *most) = (least.min(by), most.max(by));
    }
    let cells = &space.axes()[found.axis];
    let [least, most] = found.displacements;
    (most - least <= cells.to() - cells.from()).then_some(found)
}

/// Values along a sweep at which it is asked how far surfaces move.
const SAMPLED: u32 = 16;

/// Which of the factors is meant.
pub(super) fn finer_factor(space: &CellSpace) -> f64 {
    // A phase multiplies cells as a third axis does.
    let many = |axis: &&Axis| !axis.is_modes() || axis.is_phase();
    FINER[usize::from(space.axes().iter().filter(many).count() > 2)]
}

impl Default for GeneratorMethodOptions {
    fn default() -> Self {
        Self {
            scheme: AdvectiveScheme::default(),
            memory_limit: 8.0,
            // Far below the error of any grid; every digit costs iterations.
            solver_tolerance: 1e-8,
            escape_limit: ESCAPE_LIMIT,
            change_by_modes: None,
        }
    }
}
