//! Quick looks at the generator on few cells: where the mass is, and how fast deviations die out.

use super::GeneratorSource;
use super::relaxation::Relaxation;
use crate::cancellation::Cancellation;
use crate::method::{GeneratorMethodOptions, Problem};
use crate::space::{Axis, CellSpace};
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

/// Fewer cells.
pub(super) struct Coarseness {
    /// Cells of an axis there over those here.
    share: f64,
    /// Factor by which a relaxation time may be off there.
    pub(super) off: f64,
}

/// What is tried, from the fewest cells on.
pub(super) const COARSE: [Coarseness; 2] = [
    Coarseness {
        share: 0.3,
        off: 5.0,
    },
    Coarseness {
        share: 0.5,
        off: 1.5,
    },
];

/// Unknowns up to which a relaxation time is worked out on the cells themselves, and the same where axes have modes,
/// whose fronts are larger.
const FEW: usize = 5000;
const FEW_WITH_MODES: usize = 8000;

/// Least and most modes with which it is worked out on fewer cells: many are for the shape of a density along them.
const LEAST_MODES: usize = 3;
const MOST_MODES: usize = 8;

/// Time in which deviations from the steady state die out, on fewer cells an axis, with half as many modes, eight at
/// most: many times as fast as on all of them. `None` where all of them are few enough, or so few have no steady state
/// to show.
pub(super) fn rough_relaxation(
    source: &GeneratorSource,
    value: f64,
    coarseness: &Coarseness,
    cancellation: &Cancellation,
) -> Option<f64> {
    let space = source.problem.space();
    let few = if space.axes().iter().any(Axis::is_modes) {
        FEW_WITH_MODES
    } else {
        FEW
    };
    if space.n_cells() <= few {
        return None;
    }
    let fewer = |axis: &Axis| match axis.is_modes() {
        true => axis
            .with_modes(
                (axis.mode_number() / 2).clamp(LEAST_MODES.min(axis.mode_number()), MOST_MODES),
            )
            .ok(),
        false => Some(axis.refined(coarseness.share)),
    };
    let axes: Option<Vec<Axis>> = space.axes().iter().map(fewer).collect();
    let problem = source.problem.on(CellSpace::new(axes?).ok()?);
    let fewer = GeneratorSource::new(&problem.ok()?, &source.options).ok()?;
    let system = fewer.system_at(value).ok()?;
    let generator = fewer.assemble(system.as_ref(), fewer.options.scheme).ok()?;
    let mut solver = fewer.solver(cancellation);
    let steady = solver
        .solve(&generator.matrix, &generator.escape, None)
        .ok()?;
    let relaxation = Relaxation::compute(&mut solver, &steady.mass, None)?;
    steady.info.converged.then_some(relaxation.time)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::density::Observable;
    use crate::system::{Path, registry};

    #[test]
    fn fewer_cells_and_modes_have_the_same_relaxation_time() {
        let given = [
            ("kappa", 0.02),
            ("mu", 1.0),
            ("lambda", 0.06),
            ("f_c", 0.05),
            ("sigma2", 0.02),
        ];
        let path = Path::parameter("alpha", 0.5, -1.0);
        let family = Family::new(registry::find("dahl").unwrap(), &given, path).unwrap();
        let bound = 0.05 / 0.06;
        let axes = vec![
            Axis::uniform(-2.3, 2.3, 48).unwrap(),
            Axis::uniform(-2.8, 2.8, 48).unwrap(),
            Axis::modes(-bound, bound, 6).unwrap(),
        ];
        let space = CellSpace::new(axes).unwrap();
        let problem = Problem::new(family, space, vec![Observable::Marginal(0)]).unwrap();
        let options = GeneratorMethodOptions::default();
        let source = GeneratorSource::new(&problem, &options).unwrap();
        for value in [0.5, -0.25, -1.0] {
            let system = source.system_at(value).unwrap();
            let generator = source.assemble(system.as_ref(), options.scheme).unwrap();
            let mut solver = source.solver(&Cancellation::new());
            let steady = solver
                .solve(&generator.matrix, &generator.escape, None)
                .unwrap();
            let exact = Relaxation::compute(&mut solver, &steady.mass, None).unwrap();
            for coarseness in &COARSE {
                let rough = rough_relaxation(&source, value, coarseness, &Cancellation::new());
                let ratio = rough.unwrap() / exact.time;
                // What is made of it allows for more.
                let allowed = 1.0 + 0.5 * (coarseness.off - 1.0);
                assert!(
                    ratio < allowed && ratio > 1.0 / allowed,
                    "{value}: {ratio} of {}",
                    exact.time
                );
            }
        }
    }
}
