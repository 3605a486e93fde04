//! Assembly of the generator: the fluxes of all grid lines, then the columns of the matrix.
//!
//! Lines are independent of one another and so are columns: both run in parallel, and the result does not
//! depend on how many threads there are.

use std::sync::Arc;

use rayon::prelude::*;

use super::columns::{AxisRates, LineRates};
use super::geometry::{AxisGeometry, End, strides};
use super::modes::ModeAxis;
use super::sampler::{LineSampler, quadrature_points};
use super::scheme::{Dissipation, REACH, Window};
use super::{AdvectiveScheme, Generator, GeneratorError, GeneratorOptions};
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

/// As [`assemble`], with all or half of the dissipation of advective fluxes, for what changes in time: what makes good
/// the flux through walls is that of a steady state, and is left out. What the two differ by is an error of functions
/// of the generator, its eigenvalues among them, to first order.
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
    let axes = (0..space.dimension()).map(geometry).collect();
    let [lines] = lines_by([axes], system, space)?;
    lines.generator()
}

/// The generators by some schemes, as they are along the lines of the grid: the drift is sampled once for all, and
/// columns are laid out of those that need them.
///
/// # Errors
/// As [`assemble`].
pub(crate) fn assemble_lines<const N: usize>(
    system: &dyn System,
    space: &CellSpace,
    schemes: [AdvectiveScheme; N],
) -> Result<[LineRates; N], GeneratorError> {
    check(system, space)?;
    let of_scheme = |scheme| {
        let geometry = |axis| AxisGeometry::new(system, axis, space, scheme);
        (0..space.dimension()).map(geometry).collect()
    };
    lines_by(schemes.map(of_scheme), system, space)
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
    let axes = (0..space.dimension()).map(geometry).collect();
    let [lines] = lines_by([axes], system, space)?;
    lines.generator()
}

/// What moves along the lines of a grid, by axes whose stencils alone differ.
pub(super) fn lines_by<const N: usize>(
    axes: [Vec<AxisGeometry>; N],
    system: &dyn System,
    space: &CellSpace,
) -> Result<[LineRates; N], GeneratorError> {
    let mut all = axes.map(|axes| LineRates::new(axes, space.n_cells()));
    for axis in 0..space.dimension() {
        let of_axis = all.each_ref().map(|lines| lines.axes.as_slice());
        let Some(first) = of_axis.first() else {
            continue;
        };
        let strides = strides(first);
        let found = match &first[axis].modes {
            Some(modes) => {
                modes.check(system, axis, first[axis].ends == [End::Wall; 2])?;
                let blocks = Arc::new(axis_blocks(system, first, &strides, axis, modes)?);
                [(); N].map(|()| AxisRates::Blocks(Arc::clone(&blocks)))
            }
            None => axis_fluxes(system, of_axis, &strides, axis)?.map(AxisRates::Fluxes),
        };
        for (lines, rates) in all.iter_mut().zip(found) {
            lines.rates.push(rates);
        }
    }
    Ok(all)
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

/// Flux weights of all lines along an axis, `lines × (count + 1)` windows, by each of several axes whose stencils alone
/// differ. Line `outer · stride + inner` starts at cell `outer · stride · count + inner`.
fn axis_fluxes<const N: usize>(
    system: &dyn System,
    axes: [&[AxisGeometry]; N],
    strides: &[usize],
    axis: usize,
) -> Result<[Vec<Window>; N], GeneratorError> {
    let mut all = [(); N].map(|()| Vec::new());
    let Some(&first) = axes.first() else {
        return Ok(all);
    };
    let count = first[axis].count();
    let cells: usize = first.iter().map(AxisGeometry::count).product();
    let quadrature = quadrature_points(&first[axis]);
    let lines = cells / count;
    all.iter_mut()
        .for_each(|fluxes| *fluxes = vec![[0.0; 2 * REACH]; lines * (count + 1)]);
    let mut tasks: Vec<[&mut [Window]; N]> = Vec::with_capacity(lines);
    let mut each = all.each_mut().map(|fluxes| fluxes.chunks_mut(count + 1));
    for _ in 0..lines {
        tasks.push(
            each.each_mut()
                .map(|chunks| chunks.next().unwrap_or_default()),
        );
    }
    tasks.into_par_iter().enumerate().try_for_each_init(
        || LineSampler::new(system, axis),
        |sampler, (number, fluxes)| {
            sampler.state = line_start(first, strides, axis, number);
            sampler.sample(&first[axis].nodes, &quadrature)?;
            for (other, geometry) in first.iter().enumerate() {
                let cell = cell_on(first, strides, axis, number, other);
                for face in geometry.turns_beside(cell).filter(|_| other != axis) {
                    let (plane, nodes) = (geometry.edges[face], &geometry.nodes);
                    let beside = [nodes[face - 1], nodes[face]];
                    sampler.correct((other, plane), beside, &first[axis].nodes, &quadrature)?;
                }
            }
            sampler.line.prepare(&first[axis]);
            for (axes, fluxes) in axes.iter().zip(fluxes) {
                sampler.line.fluxes(&axes[axis], fluxes);
                if fluxes.iter().flatten().any(|weight| !weight.is_finite()) {
                    return Err(GeneratorError::Overflow { axis });
                }
            }
            Ok::<(), GeneratorError>(())
        },
    )?;
    Ok(all)
}

/// Blocks of all lines along an axis of modes: `lines × count × count` rates, the line's number as in [`axis_fluxes`].
fn axis_blocks(
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

/// The cell on another axis that a line along an axis goes through.
fn cell_on(
    axes: &[AxisGeometry],
    strides: &[usize],
    axis: usize,
    number: usize,
    other: usize,
) -> usize {
    let (outer, inner) = (number / strides[axis], number % strides[axis]);
    let first = outer * strides[axis] * axes[axis].count() + inner;
    first / strides[other] % axes[other].count()
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
    fn lines_by_two_schemes_are_those_of_each_and_their_products_those_of_the_matrices() {
        let (x, y) = (space().axes()[0].clone(), space().axes()[1].clone());
        let modes = CellSpace::new(vec![x, y, Axis::modes(-0.5, 0.5, 4).unwrap()]).unwrap();
        let schemes = [AdvectiveScheme::Upwind5, AdvectiveScheme::Central4];
        for space in [space(), modes] {
            let both = assemble_lines(&*dahl(), &space, schemes).unwrap();
            for (scheme, lines) in schemes.into_iter().zip(both) {
                let generator = assemble(&*dahl(), &space, &GeneratorOptions { scheme }).unwrap();
                let same = lines.generator().unwrap();
                assert_eq!(same.matrix, generator.matrix);
                assert_eq!(same.escape, generator.escape);
                let x: Vec<f64> = (0..space.n_cells())
                    .map(|cell| (cell as f64).sin())
                    .collect();
                let mut product = vec![0.0; x.len()];
                for (column, weight) in generator.matrix.outer_iterator().zip(&x) {
                    for (row, rate) in column.iter() {
                        product[row] += rate * weight;
                    }
                }
                assert_eq!(lines.product(&x), product);
            }
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
