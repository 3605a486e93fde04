//! How fast an angle turns in the steady state, and how its turns spread.
//!
//! Let Θ be the angle with its turns counted, dΘ = a dt + b dW, and p the density of the state. The mean velocity is
//! V = ∫ a p. The first moment of Θ at a state grows as V t p + r, where r, of integral zero, solves
//! Q r = -[(a - V) p - ∂(b² p)/∂θ]; the effective diffusion is half the rate at which the variance of Θ grows,
//! D = ∫ (b²/2) p + ∫ a r (G. A. Pavliotis and A. M. Stuart, *Multiscale Methods*, 2008, ch. 13). Along the
//! harmonics of the angle all integrals are sums over nodes.
//!
//! The error of both is what the second scheme changes (to first order, with the factors at hand), twice what the last
//! harmonics do (a fifth of them, as of means) or, where that is not small, a bound of what two of them add, what the
//! solver leaves, and what the ends of other ranges do. The last is as much as the mean along such an axis is shifted
//! by, times the slope of a along the axis to the end; for the diffusion times r/p at the end too.

use sprs::CsMat;

use super::last_modes::LastModes;
use crate::continuation::Measure;
use crate::continuation::measure::{TURN_DIFFUSION, VELOCITY};
use crate::density::Roughness;
use crate::generator::Generator;
use crate::method::MethodError;
use crate::method::lattice::for_all_nodes;
use crate::space::{Axis, CellSpace};
use crate::stationary::generator::RateSolver;
use crate::system::{LANES, System};

/// Relative error in L1 to which the first moment is solved, and what the second scheme changes of it.
const ACCURACY: f64 = 1e-9;
const ROUGH: f64 = 1e-2;

/// Times what the second scheme changes, which may err alike, and what the last harmonics do: those that are not there
/// may do as much.
const SAFETY: f64 = 2.0;

/// Share of a number up to which what the last harmonics change of it is known to first order.
const SMALL: f64 = 0.01;

/// A steady state by a solver that holds its factors.
pub(super) struct Steady<'a> {
    pub(super) system: &'a dyn System,
    pub(super) space: &'a CellSpace,
    /// The generator's unknowns, Σ = 1.
    pub(super) unknowns: &'a [f64],
    /// Estimated L1 error of the unknowns.
    pub(super) error: f64,
    /// The generator, the one by the second scheme, and by how much its unknowns differ.
    pub(super) first: &'a CsMat<f64>,
    pub(super) second: &'a Generator,
    pub(super) change: &'a [f64],
    /// By how much the ends of the ranges shift the mean of each axis.
    pub(super) shifts: &'a [f64],
}

/// Velocity and effective diffusion of the angle along an axis of harmonics, named `name`.
///
/// # Errors
/// Those of [`RateSolver::response`].
pub(super) fn rotation(
    steady: &Steady<'_>,
    (axis, name): (usize, &str),
    (solver, harmonics): (&mut RateSolver, &LastModes<'_>),
) -> Result<[Measure; 2], MethodError> {
    let along = Coefficients::new(steady, axis);
    // Schemes differ along cells alone: where there are none, what they are said to differ by is what a solve with a
    // neighbour's factors leaves, and it is in the solver's part.
    let none = vec![0.0; steady.unknowns.len()];
    let is_same = steady.second.matrix == *steady.first;
    let (u, change) = (steady.unknowns, if is_same { &none } else { steady.change });
    let velocity = sum(&along.drift, u);
    let turned = sum(&along.drift, change);
    let source = along.source(u, velocity);
    let first = solver.response(&source, u, None, ACCURACY)?;
    let diffusion = sum(&along.noise, u) + sum(&along.drift, &first);
    // What the second scheme changes of the right side and of the matrix.
    let mut answer = along.change_of_source((u, change), [velocity, turned]);
    add_difference(&steady.second.matrix, steady.first, &first, &mut answer);
    let moved = match answer.iter().any(|value| *value != 0.0) {
        true => solver.response(&answer, u, None, ROUGH)?,
        false => vec![0.0; u.len()],
    };
    let spread = sum(&along.noise, change) + sum(&along.drift, &moved);
    // Sums of changes may vanish by chance: what those of neighbouring layers of cells do alone is added.
    let faster: Vec<f64> = along.drift.iter().map(|a| a - velocity).collect();
    let rough = |differences: &[f64], values: &[f64]| {
        let (space, planes) = (steady.space, &[][..]);
        let roughness = Roughness {
            space,
            weights: u,
            differences,
            planes,
        };
        roughness.of(values)
    };
    let turned_by_layers = rough(change, &faster);
    let spread_by_layers = rough(change, &along.noise) + rough(&moved, &faster);
    let of_harmonics = by_harmonics(
        &along,
        (u, &first),
        [velocity, diffusion],
        (solver, harmonics),
    )?;
    let fastest = along.fastest(velocity);
    let left = steady.error + f64::EPSILON * (u.len() as f64).sqrt();
    let beyond = along.beyond((u, &first), velocity, steady.shifts);
    let errors = [
        SAFETY * turned.abs() + of_harmonics[0] + turned_by_layers + fastest * left + beyond[0],
        SAFETY * spread.abs()
            + of_harmonics[1]
            + spread_by_layers
            + fastest * size(&first) * (ACCURACY + left)
            + beyond[1],
    ];
    let measure = |value: f64, error: f64, kind: crate::continuation::MeasureKind| Measure {
        error: Some(error),
        ..kind.measure(name, value)
    };
    Ok([
        measure(velocity, errors[0], VELOCITY),
        measure(diffusion, errors[1], TURN_DIFFUSION),
    ])
}

/// What the last harmonics change of velocity and diffusion, as parts of their errors.
fn by_harmonics(
    along: &Coefficients<'_>,
    (u, first): (&[f64], &[f64]),
    [velocity, diffusion]: [f64; 2],
    (solver, harmonics): (&mut RateSolver, &LastModes<'_>),
) -> Result<[f64; 2], MethodError> {
    let fewer = harmonics.change(solver, u, u)?;
    let turned_by_fewer = sum(&along.drift, &fewer);
    let answer = along.change_of_source((u, &fewer), [velocity, turned_by_fewer]);
    let of_right_side = solver.response(&answer, u, None, ROUGH)?;
    let of_matrix = harmonics.change(solver, u, first)?;
    let spread_by_fewer = sum(&along.noise, &fewer)
        + sum(&along.drift, &of_right_side)
        + sum(&along.drift, &of_matrix);
    let speeds = along.drift.iter().zip(u).map(|(a, u)| (a * u).abs());
    let of_harmonics = [
        (turned_by_fewer, speeds.sum(), u),
        (spread_by_fewer, diffusion, first),
    ];
    // To first order a change is known where it is small.
    Ok(
        of_harmonics.map(|(change, size, answer): (f64, f64, &[f64])| {
            match change.abs() <= SMALL * size.abs() {
                true => SAFETY * change.abs(),
                false => (SAFETY * change.abs()).max(along.tail(answer, velocity)),
            }
        }),
    )
}

/// Drift and noise along the axis at all nodes.
struct Coefficients<'a> {
    space: &'a CellSpace,
    axis: usize,
    /// a.
    drift: Vec<f64>,
    /// b²/2.
    noise: Vec<f64>,
}

impl<'a> Coefficients<'a> {
    fn new(steady: &Steady<'a>, axis: usize) -> Self {
        let (system, space) = (steady.system, steady.space);
        let cells = space.n_cells();
        let (mut drift, mut noise) = (vec![0.0; cells], vec![0.0; cells]);
        let mut all = vec![[0.0; LANES]; space.dimension()];
        for_all_nodes(space, |first, states| {
            system.drift(0.0, states, &mut all);
            let count = LANES.min(cells - first);
            drift[first..first + count].copy_from_slice(&all[axis][..count]);
            for amplitudes in system
                .noises_on(axis)
                .map(|one| one.amplitudes(0.0, states))
            {
                for (slot, amplitude) in noise[first..first + count].iter_mut().zip(amplitudes) {
                    *slot += 0.5 * amplitude * amplitude;
                }
            }
        });
        Self {
            space,
            axis,
            drift,
            noise,
        }
    }

    fn axis(&self) -> &'a Axis {
        &self.space.axes()[self.axis]
    }

    /// (a - V) u - ∂(b² u)/∂θ.
    fn source(&self, u: &[f64], velocity: f64) -> Vec<f64> {
        let pairs = self.drift.iter().zip(u);
        let mut source: Vec<f64> = pairs.map(|(a, u)| (a - velocity) * u).collect();
        if self.noise.iter().any(|noise| *noise != 0.0) {
            let pairs = self.noise.iter().zip(u);
            let spread: Vec<f64> = pairs.map(|(noise, u)| 2.0 * noise * u).collect();
            let slopes = self.slopes(&spread);
            for (slot, slope) in source.iter_mut().zip(slopes) {
                *slot -= slope;
            }
        }
        source
    }

    /// What other unknowns, with another velocity, change of the source.
    fn change_of_source(
        &self,
        (u, change): (&[f64], &[f64]),
        [velocity, turned]: [f64; 2],
    ) -> Vec<f64> {
        let mut source = self.source(change, velocity);
        for (slot, u) in source.iter_mut().zip(u) {
            *slot -= turned * u;
        }
        source
    }

    /// ∂v/∂θ of values times widths at the nodes.
    fn slopes(&self, values: &[f64]) -> Vec<f64> {
        let count = self.axis().count();
        let matrix = self.axis().differentiation();
        let stride: usize = self.space.shape()[self.axis + 1..].iter().product();
        let mut slopes = vec![0.0; values.len()];
        for (cell, slot) in slopes.iter_mut().enumerate() {
            let position = cell / stride % count;
            let start = cell - position * stride;
            let row = &matrix[position * count..(position + 1) * count];
            let terms = row.iter().enumerate();
            *slot = terms.map(|(k, d)| d * values[start + k * stride]).sum();
        }
        slopes
    }

    fn fastest(&self, velocity: f64) -> f64 {
        let speeds = self.drift.iter().map(|a| (a - velocity).abs());
        speeds.fold(0.0, f64::max)
    }

    /// What may lie beyond the ends of other axes adds to the velocity and to the diffusion, from the density and the
    /// first moment in the last cells, and by how much it shifts the mean of each axis.
    fn beyond(&self, (u, first): (&[f64], &[f64]), velocity: f64, shifts: &[f64]) -> [f64; 2] {
        let mut added = [0.0; 2];
        let axes = self.space.axes().iter().zip(shifts).enumerate();
        for (index, (axis, &shift)) in axes.filter(|(_, (axis, _))| !axis.is_modes()) {
            let position = |cell: usize| self.space.position(cell, index);
            let places = u.iter().enumerate();
            let mean: f64 = places
                .map(|(cell, mass)| mass * axis.nodes()[position(cell)])
                .sum();
            let last = axis.count() - 1;
            let at_ends = [(0, axis.from()), (last, axis.to())].map(|(layer, end)| {
                let cells = (0..u.len()).filter(|&cell| position(cell) == layer);
                let [mass, speed, moment] = cells.fold([0.0; 3], |sums, cell| {
                    let speed = (self.drift[cell] - velocity) * u[cell];
                    [sums[0] + u[cell], sums[1] + speed, sums[2] + first[cell]]
                });
                let faster = (speed / mass / (end - mean)).abs();
                [faster, faster * (moment / mass).abs()]
            });
            for (slot, added) in added.iter_mut().enumerate() {
                let most = at_ends[0][slot].max(at_ends[1][slot]);
                *added += if most.is_finite() {
                    shift.abs() * most
                } else {
                    0.0
                };
            }
        }
        added
    }

    /// What the last two harmonics add to an average of the drift, at most; those that are left out add less.
    fn tail(&self, values: &[f64], velocity: f64) -> f64 {
        let (axis, count) = (self.axis(), self.axis().count());
        let shape = self.space.shape();
        let stride: usize = shape[self.axis + 1..].iter().product();
        let top = axis.mode_number();
        let mut total = 0.0;
        for block in (0..values.len()).step_by(stride * count) {
            for start in block..block + stride {
                let cells = (0..count).map(|k| start + k * stride);
                let fastest = cells
                    .clone()
                    .map(|cell| (self.drift[cell] - velocity).abs());
                let fastest = fastest.fold(0.0, f64::max);
                let line: Vec<f64> = cells.map(|cell| values[cell]).collect();
                let last = [top, top.saturating_sub(1).max(1)];
                let size: f64 = last.iter().map(|&k| harmonic(&line, k)).sum();
                total += 2.0 * fastest * size;
            }
        }
        total
    }
}

/// Magnitude of Σ v_j e^{-2πi k j/N}.
fn harmonic(values: &[f64], k: usize) -> f64 {
    let count = values.len() as f64;
    let (mut cosine, mut sine) = (0.0, 0.0);
    for (j, value) in values.iter().enumerate() {
        let angle = std::f64::consts::TAU * ((k * j) % values.len()) as f64 / count;
        cosine += value * angle.cos();
        sine += value * angle.sin();
    }
    f64::hypot(cosine, sine)
}

/// Adds (other - one) · vector.
fn add_difference(other: &CsMat<f64>, one: &CsMat<f64>, vector: &[f64], slots: &mut [f64]) {
    for (matrix, sign) in [(other, 1.0), (one, -1.0)] {
        for (column, x) in matrix.outer_iterator().zip(vector) {
            for (row, rate) in column.iter() {
                slots[row] += sign * rate * x;
            }
        }
    }
}

fn sum(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn size(values: &[f64]) -> f64 {
    values.iter().map(|value| value.abs()).sum()
}
