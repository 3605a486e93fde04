//! Warm starts, sensitivities, threads, predictions.

use sprs::CsMat;

use super::{distance, generators, space};
use crate::stationary::generator::dissection::{Dissection, Grid};
use crate::stationary::generator::prediction::predict;
use crate::stationary::generator::symbolic::Symbolic;
use crate::stationary::generator::{
    RateMethod, RateOptions, RateSolver, RateSteadyState, estimate, narrowing,
};

fn sweep(method: RateMethod, warm: bool) -> Vec<RateSteadyState> {
    let options = RateOptions {
        method: Some(method),
        ..RateOptions::default()
    };
    let mut solver = RateSolver::new(space(&[40, 40]), options);
    let mut states: Vec<RateSteadyState> = Vec::new();
    for step in 0..6 {
        let (matrix, escape) = generators::oscillator(40, 0.01 + 1e-4 * f64::from(step));
        let guess = states
            .last()
            .filter(|_| warm)
            .map(|state| state.mass.clone());
        if !warm {
            solver = RateSolver::new(space(&[40, 40]), options);
        }
        states.push(solver.solve(&matrix, &escape, guess.as_deref()).unwrap());
    }
    states
}

#[test]
fn warm_starts_give_the_cold_answer_with_less_work() {
    for method in RateMethod::ALL {
        let (cold, warm) = (sweep(method, false), sweep(method, true));
        for (a, b) in cold.iter().zip(&warm) {
            assert!(a.info.converged && b.info.converged);
            let error = distance(&a.mass, &b.mass);
            assert!(error < 1e-9, "{method:?} {error:e}");
        }
        let factorisations = |states: &[RateSteadyState]| -> usize {
            states.iter().map(|state| state.info.factorisations).sum()
        };
        assert!(factorisations(&warm) < factorisations(&cold), "{method:?}");
    }
}

#[test]
fn work_counters_are_as_they_were() {
    let lines = RateMethod::ALL.map(|method| {
        let count = |state: &RateSteadyState| {
            format!("{}+{}", state.info.factorisations, state.info.iterations)
        };
        let states = sweep(method, true);
        let counts: Vec<String> = states.iter().map(count).collect();
        format!("{}: {}", method.name(), counts.join(" "))
    });
    insta::assert_snapshot!(lines.join("\n"), @r"
    lu: 1+4 0+8 0+8 0+9 0+9 1+3
    lu-single: 1+3 0+8 0+8 0+9 1+3 0+8
    narrow-lu: 1+126 0+78 0+77 0+77 0+76 0+75
    narrow-lu-single: 1+126 0+78 0+77 0+77 0+76 0+75
    ");
}

#[test]
fn one_thread_and_two_give_the_same_bits() {
    let (matrix, escape) = generators::oscillator(90, 0.01);
    let solve = |threads: usize, method: RateMethod| {
        let options = RateOptions {
            method: Some(method),
            ..RateOptions::default()
        };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| {
            let mut solver = RateSolver::new(space(&[90, 90]), options);
            solver.solve(&matrix, &escape, None).unwrap()
        })
    };
    for method in RateMethod::ALL {
        let (one, two) = (solve(1, method), solve(2, method));
        let bits = |state: &RateSteadyState| -> Vec<u64> {
            state.mass.iter().map(|value| value.to_bits()).collect()
        };
        assert_eq!(bits(&one), bits(&two), "{method:?}");
        assert_eq!(one.info, two.info);
    }
}

#[test]
fn sensitivity_agrees_with_central_differences() {
    let shape = [30, 30];
    let step = 1e-5;
    // A domain that mass leaves, so that the escape's derivative counts too.
    let at = |damping: f64| {
        let line = |diffusion: f64| generators::TestAxis {
            from: -1.2,
            to: 1.2,
            count: 30,
            diffusion,
            walls: false,
        };
        generators::generator(&[line(0.0), line(0.05)], |axis, state| {
            if axis == 0 {
                state[1]
            } else {
                -damping * state[1] - state[0] - 0.5 * state[0].powi(3)
            }
        })
    };
    let options = RateOptions {
        tolerance: 1e-13,
        ..RateOptions::default()
    };
    let mut solver = RateSolver::new(space(&shape), options);
    let mut state = |damping: f64| {
        let (matrix, escape) = at(damping);
        solver.solve(&matrix, &escape, None).unwrap()
    };
    let (below, above, middle) = (state(0.2 - step), state(0.2 + step), state(0.2));
    assert!(middle.info.escape_rate > 1e-6, "{:?}", middle.info);
    let halved = |a: &CsMat<f64>, b: &CsMat<f64>| (a - b).map(|rate| rate / (2.0 * step));
    let derivative = halved(&at(0.2 + step).0, &at(0.2 - step).0);
    let exact = solver.sensitivity(&derivative, &middle.mass).unwrap();
    let pairs = above.mass.iter().zip(&below.mass);
    let differences: Vec<f64> = pairs.map(|(a, b)| (a - b) / (2.0 * step)).collect();
    let size: f64 = exact.iter().map(|value| value.abs()).sum();
    let error = distance(&exact, &differences) / size;
    assert!(error < 1e-6, "{error:e}");
    assert!(exact.iter().sum::<f64>().abs() < 1e-12 * size);
}

#[test]
fn memory_is_predicted_from_the_geometry() {
    for shape in [[14, 12, 9], [60, 8, 1], [7, 7, 7]] {
        let lines = shape.map(|count| generators::TestAxis {
            from: -1.0,
            to: 1.0,
            count,
            diffusion: 1.0,
            walls: true,
        });
        // Both signs of the flow in every direction, so that the stencil has its full reach everywhere.
        let flow = |sign: f64| generators::generator(&lines, move |_, _| sign).0;
        let matrix = &flow(1.0) + &flow(-1.0).map(|rate| 1.5 * rate);
        let grid = Grid::new(&shape, &[3, 3, 3], 50);
        let symbolic = Symbolic::new(&matrix.to_csc(), Dissection::new(&grid));
        let predicted = predict(&grid).factor_entries;
        let ratio = symbolic.factor_entries() as f64 / predicted;
        assert!((0.97..=1.0).contains(&ratio), "{shape:?} {ratio}");
    }
}

#[test]
fn the_method_follows_from_the_memory() {
    let space = space(&[60, 60]);
    let chosen = |limit: u64| estimate(&space, &[3, 3], limit, None).map(|plan| plan.method);
    let needs = |method: RateMethod| {
        estimate(&space, &[3, 3], u64::MAX, Some(method))
            .unwrap()
            .peak_bytes
    };
    for method in RateMethod::ALL {
        assert_eq!(chosen(needs(method)), Ok(method));
    }
    assert!(chosen(needs(RateMethod::NarrowLuSingle) - 1).is_err());
}

#[test]
fn the_narrow_matrix_keeps_sums_drift_and_diffusion() {
    let space = space(&[20, 20]);
    let (matrix, _) = generators::oscillator(20, 0.01);
    let narrow = narrowing::narrow(&space, &matrix);
    assert_eq!(narrowing::reach(&space, &narrow), vec![1, 1]);
    let moments = |matrix: &CsMat<f64>, cell: usize| {
        let column = matrix.outer_view(cell).unwrap();
        let mut moments = [0.0; 3];
        for (row, &rate) in column.iter() {
            let along = (row % 20) as f64 - (cell % 20) as f64;
            let across = (row / 20) as f64 - (cell / 20) as f64;
            for (slot, weight) in moments.iter_mut().zip([1.0, along, across]) {
                *slot += rate * weight;
            }
        }
        moments
    };
    for cell in (1..19).flat_map(|row| 20 * row + 1..20 * row + 19) {
        let (wide, narrow) = (moments(&matrix, cell), moments(&narrow, cell));
        for (a, b) in wide.iter().zip(narrow) {
            assert!((a - b).abs() < 1e-11, "{cell} {wide:?} {narrow:?}");
        }
    }
}
