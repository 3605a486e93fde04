//! The steady state of a system on cells and modes, and trajectories beside it, which share only the drift with it.

use std::ops::Range;
use std::sync::Arc;

use pbif::generator::{AdvectiveScheme, GeneratorOptions, assemble};
use pbif::space::{Axis, CellSpace};
use pbif::stationary::generator::{RateOptions, RateSolver};
use pbif::system::{Interpretation, LANES, Lanes, Model, System, TypedModel};
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256Plus;
use rand_xoshiro::rand_core::SeedableRng;
use rayon::prelude::*;

use super::numbers::Numbers;

/// A model by its equations and the amplitudes of its noises.
pub(crate) fn model(equations: &[(&str, &str)], noise: &[(&str, &str)]) -> Arc<Model> {
    typed(equations, noise).build().unwrap()
}

/// The same, in Itô's reading where noise depends on the state.
pub(crate) fn ito_model(equations: &[(&str, &str)], noise: &[(&str, &str)]) -> Arc<Model> {
    let model = typed(equations, noise).with_interpretation(Interpretation::Ito);
    model.build().unwrap()
}

fn typed(equations: &[(&str, &str)], noise: &[(&str, &str)]) -> TypedModel {
    let names: Vec<&str> = equations.iter().map(|(axis, _)| *axis).collect();
    let mut model = TypedModel::new("model", "Model", names);
    for (axis, drift) in equations {
        model = model.with_equation(*axis, *drift);
    }
    for (axis, amplitude) in noise {
        model = model.with_noise(*axis, [*amplitude]);
    }
    model
}

/// Even cells from, to and how many along each axis.
pub(crate) fn even_cells(axes: &[(f64, f64, usize)]) -> CellSpace {
    let axes = axes.iter();
    let axes = axes.map(|&(from, to, count)| Axis::uniform(from, to, count).unwrap());
    CellSpace::new(axes.collect()).unwrap()
}

/// Masses or unknowns of the steady state by the usual settings.
pub(crate) fn masses(system: &dyn System, space: &CellSpace) -> Vec<f64> {
    let generator = assemble(system, space, &GeneratorOptions::default()).unwrap();
    let mut solver = RateSolver::new(space.clone(), RateOptions::default());
    let steady = solver.solve(&generator.matrix, &generator.escape, None);
    let steady = steady.unwrap();
    assert!(steady.info.converged);
    steady.mass
}

/// Unknowns at the nodes, Σ = 1.
pub(crate) fn solve(system: &dyn System, space: &CellSpace, scheme: AdvectiveScheme) -> Vec<f64> {
    let generator = assemble(system, space, &GeneratorOptions { scheme }).unwrap();
    let options = RateOptions {
        tolerance: 1e-12,
        ..RateOptions::default()
    };
    let mut solver = RateSolver::new(space.clone(), options);
    let steady = solver
        .solve(&generator.matrix, &generator.escape, None)
        .unwrap();
    assert!(steady.info.converged);
    let total: f64 = steady.mass.iter().sum();
    steady.mass.iter().map(|unknown| unknown / total).collect()
}

/// Means of functions of the state.
pub(crate) fn means<const Q: usize>(
    space: &CellSpace,
    unknowns: &[f64],
    look: impl Fn(&[f64]) -> [f64; Q],
) -> [f64; Q] {
    let mut sums = [0.0; Q];
    for (cell, unknown) in unknowns.iter().enumerate() {
        let node = |axis: usize| space.axes()[axis].nodes()[space.position(cell, axis)];
        let state: Vec<f64> = (0..space.dimension()).map(node).collect();
        for (sum, value) in sums.iter_mut().zip(look(&state)) {
            *sum += unknown * value;
        }
    }
    sums
}

const TIME_STEP: f64 = 0.01;

/// Time averages of the lanes of one batch of trajectories by stochastic Heun, without the first tenth.
fn batch<const Q: usize>(
    system: &dyn System,
    steps: usize,
    seed: u64,
    look: impl Fn(&[f64]) -> [f64; Q],
) -> Vec<[f64; Q]> {
    let mut random = Xoshiro256Plus::seed_from_u64(seed);
    let (axes, noise) = (system.dimension(), &system.noises()[0]);
    let amplitude = noise.additive().unwrap() * TIME_STEP.sqrt();
    let mut states: Vec<Lanes> = vec![[0.1; LANES]; axes];
    let (mut start, mut end) = (states.clone(), states.clone());
    let (mut sums, mut looks) = (vec![[0.0; Q]; LANES], 0.0);
    for number in 0..steps {
        system.drift(0.0, &states, &mut start);
        let mut ahead = states.clone();
        for lane in 0..LANES {
            let normal: f64 = StandardNormal.sample(&mut random);
            for axis in 0..axes {
                ahead[axis][lane] += TIME_STEP * start[axis][lane];
            }
            ahead[noise.axis][lane] += amplitude * normal;
            states[noise.axis][lane] += amplitude * normal;
        }
        system.drift(0.0, &ahead, &mut end);
        for axis in 0..axes {
            for lane in 0..LANES {
                states[axis][lane] += 0.5 * TIME_STEP * (start[axis][lane] + end[axis][lane]);
            }
        }
        if number > steps / 10 && number % 8 == 0 {
            looks += 1.0;
            for (lane, sums) in sums.iter_mut().enumerate() {
                let state: Vec<f64> = states.iter().map(|axis| axis[lane]).collect();
                for (sum, value) in sums.iter_mut().zip(look(&state)) {
                    *sum += value;
                }
            }
        }
    }
    let averages = sums.into_iter().map(|sums| sums.map(|sum| sum / looks));
    averages.collect()
}

/// Means and standard errors from independent lanes of batches, by their seeds.
pub(crate) fn by_trajectories<const Q: usize>(
    system: &dyn System,
    steps: usize,
    seeds: Range<u64>,
    look: impl Fn(&[f64]) -> [f64; Q] + Sync,
) -> [(f64, f64); Q] {
    let batches = seeds.into_par_iter();
    let rows = batches.flat_map_iter(|seed| batch(system, steps, seed, &look));
    let rows: Vec<[f64; Q]> = rows.collect();
    let n = rows.len() as f64;
    std::array::from_fn(|index| {
        let mean = rows.iter().map(|row| row[index]).sum::<f64>() / n;
        let squares: f64 = rows.iter().map(|row| (row[index] - mean).powi(2)).sum();
        (mean, (squares / (n * (n - 1.0))).sqrt())
    })
}

/// A linear system of two states that settles.
pub(crate) struct Linear {
    /// x' = a x + b y + noise, y' = c x + d y + noise, and the amplitudes of the noises.
    pub(crate) matrix: [f64; 4],
    pub(crate) amplitudes: [f64; 2],
    pub(crate) model: Arc<Model>,
    /// So many cells on six standard deviations of x and of y to either side.
    pub(crate) axes: [(f64, f64, usize); 2],
}

/// An oscillator where the number is even, or two states that relax and drive each other; nothing where one of them
/// hardly settles.
pub(crate) fn random_linear(numbers: &mut Numbers, number: u64, cells: usize) -> Option<Linear> {
    let mut between =
        |from: f64, to: f64| from + (to - from) * numbers.below(1_000_000) as f64 * 1e-6;
    let is_oscillator = number.is_multiple_of(2);
    let matrix = match is_oscillator {
        true => [0.0, 1.0, -between(0.3, 3.0), -between(0.1, 1.5)],
        false => [
            -between(0.4, 2.0),
            between(-1.5, 1.5),
            -between(-0.2, 1.5),
            -between(0.4, 2.0),
        ],
    };
    let of_x = if is_oscillator {
        0.0
    } else {
        between(0.2, 0.8)
    };
    let amplitudes = [of_x, between(0.2, 0.8)];
    let [a, b, c, d] = matrix;
    let (trace, determinant) = (a + d, a * d - b * c);
    if determinant < 0.1 {
        return None;
    }
    // Stationary variances: A S + S Aᵀ = -N.
    let [p, q] = amplitudes.map(|amplitude| amplitude * amplitude);
    let factor = -1.0 / (2.0 * trace * determinant);
    let xx = factor * (p * (determinant + d * d) + q * b * b);
    let yy = factor * (q * (determinant + a * a) + p * c * c);
    let equations = [[a, b], [c, d]].map(|[x, y]| format!("{x} * x + ({y}) * y"));
    let words = amplitudes.map(|amplitude| amplitude.to_string());
    let noise = [("x", words[0].as_str()), ("y", words[1].as_str())];
    let noise = &noise[usize::from(is_oscillator)..];
    Some(Linear {
        matrix,
        amplitudes,
        model: model(&[("x", &equations[0]), ("y", &equations[1])], noise),
        axes: [xx, yy].map(|variance| (-6.0 * variance.sqrt(), 6.0 * variance.sqrt(), cells)),
    })
}
