//! The exact density, where the model knows it, on cells.

use super::{CompareError, overlap::rebin_density};
use crate::density::{DensityError, EstimatedDensity, Observable, estimate};
use crate::method::MethodError;
use crate::space::{Axis, CellSpace};
use crate::system::{Family, System};

/// Nodes and weights of Gauss-Legendre quadrature with four points on [-½, ½], exact to degree seven.
fn quadrature() -> [(f64, f64); 4] {
    let root = 2.0 / 7.0 * 1.2f64.sqrt();
    let (near, far) = ((3.0 / 7.0 - root).sqrt(), (3.0 / 7.0 + root).sqrt());
    let (large, small) = ((18.0 + 30f64.sqrt()) / 72.0, (18.0 - 30f64.sqrt()) / 72.0);
    [
        (-0.5 * far, small),
        (-0.5 * near, large),
        (0.5 * near, large),
        (0.5 * far, small),
    ]
}

/// Exact mass of every cell given Ω, Σ = 1, by quadrature with four points an axis; `None` where the model does not
/// know the density.
pub fn exact_masses(system: &dyn System, space: &CellSpace) -> Option<Vec<f64>> {
    let points = quadrature();
    let dimension = space.dimension();
    let combinations = points.len().pow(dimension as u32);
    let mut masses = Vec::with_capacity(space.n_cells());
    let mut state = vec![0.0; dimension];
    // Relative to the density at Ω's centre: the constant is arbitrary, and may be far from one.
    let middle: Vec<f64> = space
        .axes()
        .iter()
        .map(|axis| 0.5 * (axis.from() + axis.to()))
        .collect();
    let level = system.exact_log_density(&middle)?;
    for cell in 0..space.n_cells() {
        let mut mass = 0.0;
        for combination in 0..combinations {
            let mut weight = space.volume(cell);
            let mut rest = combination;
            for (index, axis) in space.axes().iter().enumerate() {
                let (node, share) = points[rest % points.len()];
                rest /= points.len();
                let position = space.position(cell, index);
                state[index] = axis.centre(position) + node * axis.width(position);
                weight *= share;
            }
            mass += weight * (system.exact_log_density(&state)? - level).exp();
        }
        masses.push(mass);
    }
    let whole: f64 = masses.iter().sum();
    (whole > 0.0 && whole.is_finite()).then(|| masses.iter().map(|mass| mass / whole).collect())
}

/// The exact density of an observable at a parameter value, integrated over the cells of `space` and brought to those
/// of `common`; `None` where none is known, and for quantities.
///
/// # Errors
/// [`CompareError`] when the value is not allowed, or the observable names no axis.
pub(crate) fn exact_density(
    family: &Family,
    value: f64,
    space: &CellSpace,
    common: &CellSpace,
    observable: Observable,
) -> Result<Option<EstimatedDensity>, CompareError> {
    let system = family.at(value).map_err(MethodError::from)?;
    // The cells' own sub-cells would take part in what is called exact.
    if observable
        .axes()
        .iter()
        .any(|&axis| axis >= space.dimension())
    {
        return Ok(None);
    }
    let Some(masses) = exact_masses(system.as_ref(), space) else {
        return Ok(None);
    };
    let exact = estimate(space, observable, &masses, &[])?;
    Ok(Some(rebin_density(&exact, &axes_of(common, observable)?)?))
}

/// The axes of a cell space that an observable keeps.
fn axes_of(space: &CellSpace, observable: Observable) -> Result<Vec<Axis>, DensityError> {
    let dimension = space.dimension();
    let axes = observable.axes().into_iter();
    axes.map(|axis| {
        let known = space.axes().get(axis).cloned();
        known.ok_or(DensityError::Axis { axis, dimension })
    })
    .collect()
}

/// The axes that a density is brought to: those of the common cells, also at a phase. Quantities have the same bins by
/// every method.
pub(super) fn common_axes(
    family: &Family,
    common: &CellSpace,
    estimated: &EstimatedDensity,
) -> Vec<Axis> {
    let axes = estimated.observable.axes();
    let axes = match family.at_phase(&axes) {
        Some((kept, _)) => kept,
        None => axes,
    };
    let own = axes.into_iter().zip(&estimated.density.axes);
    own.map(|(axis, own)| common.axes().get(axis).unwrap_or(own).clone())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::registry;
    use statrs::function::erf::erf;

    #[test]
    fn exact_masses_of_a_linear_oscillator_are_gaussian() {
        let model = registry::find("coulomb").unwrap();
        let given = [
            ("alpha", 1.0),
            ("kappa", 0.1),
            ("mu", 0.0),
            ("f_c", 0.0),
            ("sigma2", 0.2),
        ];
        let system = model.system_with(&given).unwrap();
        // p ∝ exp(-(x² + y²)/2).
        let axis = Axis::uniform(-8.0, 8.0, 40).unwrap();
        let space = CellSpace::new(vec![axis.clone(), axis.clone()]).unwrap();
        let masses = exact_masses(system.as_ref(), &space).unwrap();
        let below = |edge: f64| 0.5 * erf(edge / 2f64.sqrt());
        let share = |cell: usize| below(axis.edges()[cell + 1]) - below(axis.edges()[cell]);
        for (cell, mass) in masses.iter().enumerate() {
            let expected = share(cell / 40) * share(cell % 40);
            // Quadrature errs by h⁸ max|p⁽⁸⁾|/(8!·441·64) relatively: below 1e-8 at h = 0.4.
            assert!((mass - expected).abs() < 1e-8, "{mass:e} {expected:e}");
        }
        let rubbing = model.system_with(&[("f_c", 0.1), ("kappa", 0.1), ("sigma2", 0.2)]);
        if let Ok(rubbing) = rubbing {
            assert!(exact_masses(rubbing.as_ref(), &space).is_none());
        }
    }
}
