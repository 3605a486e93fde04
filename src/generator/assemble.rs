//! Assembly of the generator: the fluxes of all grid lines, then the columns of the matrix.
//!
//! Lines are independent of one another and so are columns: both run in parallel, and the result does not
//! depend on how many threads there are.

use rayon::prelude::*;

use super::columns::{AxisRates, columns};
use super::geometry::{AxisGeometry, End};
use super::modes::ModeAxis;
use super::sampler::{LineSampler, quadrature_points};
use super::scheme::{Dissipation, REACH, Window};
use super::{Generator, GeneratorError, GeneratorOptions};
use crate::MAX_DIMENSION;
use crate::space::CellSpace;
use crate::system::System;

/// Assembles the generator of an autonomous system on a cell space of the same dimension.
///
/// An end of the range that the system declares never to leave (`Facts::bounds`) is a wall without flux;
/// what flows or diffuses out through any other end is lost and counted in [`Generator::escape`]. An axis of modes
/// ([`crate::space::Axis::modes`]) lies between two such ends, and no noise drives it; one of Hermite modes
/// ([`crate::space::Axis::hermite`]) is white noise behind a linear filter, or a state that relaxes linearly
/// ([`Facts::relaxation_rates`](crate::system::Facts::relaxation_rates)), and nothing leaves along it. An
/// axis that closes on itself ([`crate::space::Axis::fourier`]) is one turn
/// ([`Facts::turns`](crate::system::Facts::turns)), with or without noise.
///
/// # Errors
/// Any [`GeneratorError`] but [`GeneratorError::System`].
pub fn assemble(
    system: &dyn System,
    space: &CellSpace,
    options: &GeneratorOptions,
) -> Result<Generator, GeneratorError> {
    assemble_within(system, system, space, options)
}

/// As [`assemble`], with all or half of the dissipation of advective fluxes. What the two differ by is an error of
/// functions of the generator, its eigenvalues among them, to first order.
///
/// # Errors
/// As [`assemble`].
pub(crate) fn assemble_damped(
    system: &dyn System,
    space: &CellSpace,
    options: &GeneratorOptions,
    dissipation: Dissipation,
) -> Result<Generator, GeneratorError> {
    check(system, space)?;
    let geometry = |axis| AxisGeometry::damped(system, axis, space, options, dissipation);
    assemble_on(
        (0..space.dimension()).map(geometry).collect(),
        system,
        space,
    )
}

/// As [`assemble`], with the walls of another system: so a derivative by a parameter that moves a wall is
/// taken with Ω and its ends held.
pub(super) fn assemble_within(
    walls: &dyn System,
    system: &dyn System,
    space: &CellSpace,
    options: &GeneratorOptions,
) -> Result<Generator, GeneratorError> {
    check(system, space)?;
    let geometry = |axis| AxisGeometry::new(walls, axis, space, options.scheme);
    assemble_on(
        (0..space.dimension()).map(geometry).collect(),
        system,
        space,
    )
}

fn assemble_on(
    axes: Vec<AxisGeometry>,
    system: &dyn System,
    space: &CellSpace,
) -> Result<Generator, GeneratorError> {
    for (axis, geometry) in axes.iter().enumerate() {
        if let Some(modes) = &geometry.modes {
            modes.check(system, axis, geometry.ends == [End::Wall; 2])?;
        }
    }
    let strides = strides(&axes);
    let rates: Result<Vec<AxisRates>, GeneratorError> = (0..axes.len())
        .map(|axis| match &axes[axis].modes {
            Some(modes) => axis_blocks(system, &axes, &strides, axis, modes).map(AxisRates::Blocks),
            None => axis_fluxes(system, &axes, &strides, axis).map(AxisRates::Fluxes),
        })
        .collect();
    columns(&axes, &strides, &rates?, space.n_cells())
}

pub(super) fn check(system: &dyn System, space: &CellSpace) -> Result<(), GeneratorError> {
    let (axes, dimension) = (space.dimension(), system.dimension());
    if axes != dimension {
        return Err(GeneratorError::Dimension { axes, dimension });
    }
    system.facts().autonomous()?;
    for (channel, noise) in system.noises().iter().enumerate() {
        let axis = noise.axis;
        if axis >= dimension {
            return Err(GeneratorError::NoiseAxis {
                channel,
                axis,
                dimension,
            });
        }
    }
    Ok(())
}

/// Distance in cell numbers between neighbours along each axis.
pub(super) fn strides(axes: &[AxisGeometry]) -> Vec<usize> {
    let mut strides = vec![1; axes.len()];
    for axis in (1..axes.len()).rev() {
        strides[axis - 1] = strides[axis] * axes[axis].count();
    }
    strides
}

/// Flux weights of all lines along an axis: `lines × (count + 1)` windows. Line `outer · stride + inner` starts at
/// cell `outer · stride · count + inner`.
pub(super) fn axis_fluxes(
    system: &dyn System,
    axes: &[AxisGeometry],
    strides: &[usize],
    axis: usize,
) -> Result<Vec<Window>, GeneratorError> {
    let count = axes[axis].count();
    let cells: usize = axes.iter().map(AxisGeometry::count).product();
    let mut fluxes = vec![[0.0; 2 * REACH]; cells / count * (count + 1)];
    let quadrature = quadrature_points(&axes[axis]);
    fluxes
        .par_chunks_mut(count + 1)
        .enumerate()
        .try_for_each_init(
            || LineSampler::new(system, axis),
            |sampler, (number, fluxes)| {
                sampler.state = line_start(axes, strides, axis, number);
                sampler.sample(&axes[axis].nodes, &quadrature)?;
                sampler.line.fluxes(&axes[axis], fluxes);
                if fluxes.iter().flatten().any(|weight| !weight.is_finite()) {
                    return Err(GeneratorError::Overflow { axis });
                }
                Ok::<(), GeneratorError>(())
            },
        )?;
    Ok(fluxes)
}

/// Blocks of all lines along an axis of modes: `lines × count × count` rates, the line's number as in [`axis_fluxes`].
pub(super) fn axis_blocks(
    system: &dyn System,
    axes: &[AxisGeometry],
    strides: &[usize],
    axis: usize,
    modes: &ModeAxis,
) -> Result<Vec<f64>, GeneratorError> {
    let count = axes[axis].count();
    let cells: usize = axes.iter().map(AxisGeometry::count).product();
    let mut blocks = vec![0.0; cells * count];
    blocks
        .par_chunks_mut(count * count)
        .enumerate()
        .try_for_each_init(
            || LineSampler::new(system, axis),
            |sampler, (number, rates)| {
                sampler.state = line_start(axes, strides, axis, number);
                sampler.sample(&axes[axis].nodes, &[])?;
                let line = &sampler.line;
                modes.rates(axis, &axes[axis].nodes, &line.drift, &line.diffusion, rates)
            },
        )?;
    Ok(blocks)
}

/// Nodes of the first cell of a line along an axis.
pub(super) fn line_start(
    axes: &[AxisGeometry],
    strides: &[usize],
    axis: usize,
    number: usize,
) -> [f64; MAX_DIMENSION] {
    let (outer, inner) = (number / strides[axis], number % strides[axis]);
    let first = outer * strides[axis] * axes[axis].count() + inner;
    let mut state = [0.0; MAX_DIMENSION];
    for (index, geometry) in axes.iter().enumerate() {
        state[index] = geometry.nodes[first / strides[index] % geometry.count()];
    }
    state
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::{Axis, Grading};
    use crate::system::test_families::OneState;
    use crate::system::test_families::built_in;

    fn dahl() -> std::sync::Arc<dyn System> {
        let values = [
            ("kappa", 0.1),
            ("lambda", 0.2),
            ("f_c", 0.1),
            ("sigma2", 0.2),
        ];
        built_in("dahl", &values)
    }

    fn space() -> CellSpace {
        let grading = Grading {
            at: vec![0.0],
            smallest: 0.02,
        };
        let x = Axis::uniform(-2.0, 2.0, 9).unwrap();
        let y = Axis::graded(-2.0, 2.0, 12, &grading).unwrap();
        // Fewer cells than a stencil is wide.
        let z = Axis::uniform(-0.5, 0.5, 3).unwrap();
        CellSpace::new(vec![x, y, z]).unwrap()
    }

    #[test]
    fn columns_sum_to_minus_the_escape_rate() {
        for scheme in super::super::AdvectiveScheme::ALL {
            let generator = assemble(&*dahl(), &space(), &GeneratorOptions { scheme }).unwrap();
            for (cell, column) in generator.matrix.outer_iterator().enumerate() {
                let sum: f64 = column.data().iter().sum();
                let size: f64 = column.data().iter().map(|value| value.abs()).sum();
                assert!((sum + generator.escape[cell]).abs() < 1e-14 * size);
                assert!(generator.escape[cell] >= 0.0);
            }
            assert!(generator.escape.iter().sum::<f64>() > 0.0);
        }
    }

    #[test]
    fn the_number_of_threads_does_not_matter() {
        let assembled = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| assemble(&*dahl(), &space(), &GeneratorOptions::default()).unwrap())
        };
        let (one, three) = (assembled(1), assembled(3));
        assert_eq!(one.matrix, three.matrix);
        assert_eq!(one.escape, three.escape);
    }

    #[test]
    fn what_has_no_generator_is_an_error() {
        let line = CellSpace::new(vec![Axis::uniform(-1.0, 1.0, 8).unwrap()]).unwrap();
        let options = GeneratorOptions::default();
        let broken = assemble(&OneState::new(1.0, f64::ln), &line, &options);
        assert!(matches!(
            broken,
            Err(GeneratorError::NotFinite { axis: 0, .. })
        ));
        let wrong = assemble(&*dahl(), &line, &options);
        let dimension = GeneratorError::Dimension {
            axes: 1,
            dimension: 3,
        };
        assert_eq!(wrong.err(), Some(dimension));
    }
}
