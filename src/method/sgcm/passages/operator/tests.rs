//! Operators against what is known of them: probabilities sum to one, and linear functions do not spread.

use super::super::krylov::solve;
use super::super::map::Sampler;
use super::super::moments::{Asked, SPENT};
use super::*;
use crate::cancellation::Cancellation;
use crate::monte_carlo::{CellPaths, CellRun, PassageTarget};
use crate::numerics::dot;
use crate::sampling::Integrator;
use crate::space::{Axis, CellSpace};
use crate::system::{TypedModel, regions};

/// The map of dx = -x dt + dW/√2 from 0 until x > 1, and its cells.
fn map(cells: usize) -> (CellSpace, PassageMap) {
    let model = TypedModel::new("pulled", "Pulled", vec!["x"]).with_equation("x", "-x");
    let model = model.with_noise("x", ["sqrt(0.5)"]).build().unwrap();
    let region = regions(&model, &[("out", "x > 1")]).unwrap().remove(0);
    let until = region.level().bind(&model.values(&[]).unwrap()).unwrap();
    let system = model.system_with(&[]).unwrap();
    let space = CellSpace::new(vec![Axis::uniform(-2.0, 2.0, cells).unwrap()]).unwrap();
    let (run, never) = (
        CellRun {
            map_step: 0.1,
            time_step: 0.02,
            integrator: Integrator::StochasticHeun,
            seed: 3,
            groups: 16,
            batches: 2,
        },
        Cancellation::new(),
    );
    let target = PassageTarget {
        until: &until,
        exits: &[],
    };
    let paths = CellPaths::new(&*system, &space, target, None, run, &never).unwrap();
    let asked = Asked {
        map_step: 0.1,
        exits: 0,
        looks: vec![0.0],
    };
    let sampler = Sampler {
        paths: &paths,
        space: &space,
        groups: 16,
        asked: &asked,
        has_region: false,
    };
    let map = sampler.starting_at(&paths, &[0.0]).unwrap();
    (space, map)
}

#[test]
fn probabilities_sum_to_one_whatever_is_counted() {
    let (space, map) = map(30);
    let weights = vec![vec![1.0, 0.0]; map.cells.len()];
    for merge in [1, 2] {
        let layout = Layout::new(&space, &map, merge);
        for counted in [Counted::All, Counted::Without(3), Counted::Coarse] {
            let operator = Operator::new(&map, counted, &layout, &weights);
            let one: Vec<f64> = (0..operator.rows()).flat_map(|_| [1.0, 0.0]).collect();
            let after = operator.apply(&one);
            let ended = &operator.told[ENDED];
            for ((after, ended), one) in after.iter().zip(ended).zip(&one) {
                assert!(
                    (after + ended - one).abs() < 1e-12,
                    "{after} + {ended}, {one}"
                );
            }
            // Weights are the other side of the same sum.
            let start = &operator.start;
            let goes_on = dot(&start.weights, &one);
            assert!((goes_on + start.told[ENDED] - 1.0).abs() < 1e-12);
            let twice = operator.applied_to_weights(&start.weights);
            assert!((dot(&twice, &one) - dot(&start.weights, &after)).abs() < 1e-12);
        }
    }
}

#[test]
fn cells_shorten_the_time_of_flat_functions_and_not_of_linear_ones() {
    // By quadrature: 10.428; numerical diffusion of h²/(12 Δt) = 0.05 beside 1/4 makes flat functions too short by far.
    let (space, map) = map(16);
    let weights = vec![vec![1.0, 0.0]; map.cells.len()];
    let layout = Layout::new(&space, &map, 1);
    let mean = |operator: &Operator| {
        let solved = solve(operator, &operator.told[SPENT], &Cancellation::new()).unwrap();
        assert!(solved.residual < 1e-8, "{}", solved.residual);
        // The largest eigenvalue is that of a process which ends about once in the mean time.
        let rate = -(-solved.loss).ln_1p() / map.asked.map_step;
        let mean = operator.start.told[SPENT] + dot(&operator.start.weights, &solved.function);
        assert!((rate * mean - 1.0).abs() < 0.1, "{rate} {mean}");
        mean
    };
    let mut operator = Operator::new(&map, Counted::All, &layout, &weights);
    let linear = mean(&operator);
    // Sampling errs by some 3 %.
    assert!((linear / 10.428 - 1.0).abs() < 0.12, "{linear}");
    let is_flat = |number: usize| number.is_multiple_of(4);
    for (number, value) in operator.blocks.iter_mut().enumerate() {
        *value = if is_flat(number) { *value } else { 0.0 };
    }
    let even = |(number, value): (usize, &mut f64)| {
        *value = if number.is_multiple_of(2) {
            *value
        } else {
            0.0
        };
    };
    operator.told[SPENT].iter_mut().enumerate().for_each(even);
    let flat = mean(&operator);
    assert!(flat < 0.85 * linear, "{flat} {linear}");
}
