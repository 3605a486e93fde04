//! A quick look at where the mass is: the generator on few cells.

use super::GeneratorSource;
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
