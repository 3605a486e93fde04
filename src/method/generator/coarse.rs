//! Quick looks at the generator on few cells: where the mass is, and how fast deviations die out.

use super::GeneratorSource;
use super::relaxation::Relaxation;
use crate::cancellation::Cancellation;
use crate::method::{GeneratorMethodOptions, Problem};
use crate::space::CellSpace;
use crate::system::Family;

/// Sizes of the masses of all cells at a value of the path; `None` where the generator has no steady state to show.
pub(in crate::method) fn rough_masses(
    family: &Family,
    space: &CellSpace,
    value: f64,
    cancellation: &Cancellation,
) -> Option<Vec<f64>> {
    let options = GeneratorMethodOptions::default();
    let problem = Problem::new(family.clone(), space.clone(), Vec::new()).ok()?;
    let source = GeneratorSource::new(&problem, &options).ok()?;
    let system = family.at(value).ok()?;
    let generator = source.assemble(system.as_ref(), options.scheme).ok()?;
    let mut solver = source.solver(cancellation);
    let steady = solver
        .solve(&generator.matrix, &generator.escape, None)
        .ok()?;
    let sizes: Vec<f64> = steady.mass.iter().map(|mass| mass.abs()).collect();
    let whole: f64 = sizes.iter().sum();
    (whole.is_finite() && whole > 0.0).then(|| sizes.iter().map(|size| size / whole).collect())
}

/// Unknowns up to which a relaxation time is worked out on the cells themselves.
const FEW: usize = 20_000;

/// Time in which deviations from the steady state die out, on half as many cells an axis: a few times as fast as on all of them.
/// `None` where all of them are few enough, or half of them have no steady state to show.
pub(super) fn rough_relaxation(
    source: &GeneratorSource,
    value: f64,
    cancellation: &Cancellation,
) -> Option<f64> {
    let space = source.problem.space();
    if space.n_cells() <= FEW {
        return None;
    }
    let axes = space.axes().iter().map(|axis| axis.refined(0.5));
    let problem = source.problem.on(CellSpace::new(axes.collect()).ok()?);
    let half = GeneratorSource::new(&problem.ok()?, &source.options).ok()?;
    let system = half.system_at(value).ok()?;
    let generator = half.assemble(system.as_ref(), half.options.scheme).ok()?;
    let mut solver = half.solver(cancellation);
    let steady = solver
        .solve(&generator.matrix, &generator.escape, None)
        .ok()?;
    let relaxation = Relaxation::compute(&mut solver, &steady.mass, None)?;
    steady.info.converged.then_some(relaxation.time)
}
