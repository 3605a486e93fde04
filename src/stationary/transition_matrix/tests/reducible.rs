//! Chains with transient cells, several classes, or none that keeps its mass.

use proptest::prelude::*;

use super::*;
use crate::stationary::transition_matrix::sampled_chain::Random;

/// Two-cell classes {0, 1} and {4, 5}; cells 2 and 3 send mass to either.
fn two_wells(left_leak: f64, right_leak: f64) -> TransitionMatrix {
    let entries = [
        (0, 0, 0.5 - left_leak),
        (1, 0, 0.5),
        (0, 1, 1.0),
        (5, 4, 1.0),
        (4, 5, 0.5),
        (5, 5, 0.5 - right_leak),
        (1, 2, 0.4),
        (3, 2, 0.6),
        (2, 3, 0.5),
        (4, 3, 0.5),
    ];
    transitions(6, &entries)
}

#[test]
fn several_classes_share_the_initial_mass() {
    // From 2: to the left at once 0.4, right 0.6·0.5 = 0.3, back 0.3; left share 0.4/0.7 = 4/7. From 3: 2/7.
    let guess = [0.0, 0.0, 0.5, 0.5, 0.0, 0.0];
    let options = Options::new(Solver::MultilevelAggregation, 1e-10);
    let found = solve(&two_wells(0.0, 0.0), &grid(&[6]), Some(&guess), &options).unwrap();
    let Outcome::SeveralClasses { classes, escaped } = found else {
        panic!("{found:?}");
    };
    assert_eq!(classes.len(), 2);
    assert_eq!(escaped, 0.0);
    let left = classes
        .iter()
        .find(|class| class.representative < 2)
        .unwrap();
    let right = classes
        .iter()
        .find(|class| class.representative > 3)
        .unwrap();
    assert!((left.share - 3.0 / 7.0).abs() < 1e-6, "{left:?}");
    assert!((right.share - 4.0 / 7.0).abs() < 1e-6, "{right:?}");
    assert_eq!((left.cells, right.cells), (2, 2));
    assert_eq!(left.centre, vec![1.0]);
    assert_eq!(left.escape_per_step, 0.0);
}

#[test]
fn classes_that_leak_about_equally_slowly_are_both_reported() {
    let options = Options::new(Solver::MultilevelAggregation, 1e-10);
    let both = solve(&two_wells(0.01, 0.02), &grid(&[6]), None, &options).unwrap();
    let Outcome::SeveralClasses { classes, escaped } = both else {
        panic!("{both:?}");
    };
    assert_eq!(classes.len(), 2);
    assert!(escaped == 0.0 && classes[0].escape_per_step < classes[1].escape_per_step);
    // Eigenvalue of [[0.49, 1], [0.5, 0]].
    let exact = 1.0 - (0.49 + (0.49_f64.powi(2) + 2.0).sqrt()) / 2.0;
    assert!((classes[0].escape_per_step / exact - 1.0).abs() < 1e-2);
    let one = steady(
        &two_wells(0.0, 0.2),
        &grid(&[6]),
        None,
        Solver::MultilevelAggregation,
        1e-12,
    );
    assert_eq!(one.info.class_cells, 2);
    assert!((one.mass[0] - 2.0 / 3.0).abs() < 1e-12);
}

#[test]
fn transient_cells_hold_nothing() {
    let matrix = transitions(
        5,
        &[
            (1, 0, 1.0),
            (2, 1, 1.0),
            (3, 2, 0.5),
            (2, 2, 0.5),
            (2, 3, 1.0),
            (1, 4, 1.0),
        ],
    );
    for solver in Solver::ALL {
        let found = steady(&matrix, &grid(&[5]), None, solver, 1e-12);
        assert_eq!(found.mass[..2], [0.0, 0.0]);
        assert_eq!((found.info.class_cells, found.info.transient_cells), (2, 3));
        assert!((found.mass[2] - 2.0 / 3.0).abs() < 1e-12);
    }
}

#[test]
fn a_doomed_edge_cell_is_no_class_but_part_of_the_quasi_steady_state() {
    // Cells 0 and 1 exchange mass; 1 also feeds cell 2, which loses 90 % to the sink, and 3, which loses all.
    // Nothing feeds 4, which keeps 30 %.
    let leak = 1e-3;
    let entries = [
        (1, 0, 0.5),
        (0, 0, 0.5),
        (0, 1, 0.5),
        (1, 1, 0.5 - 2.0 * leak),
        (2, 1, leak),
        (3, 1, leak),
        (2, 2, 0.1),
        (4, 4, 0.3),
    ];
    let matrix = transitions(5, &entries);
    for solver in Solver::ALL {
        let found = steady(&matrix, &grid(&[5]), None, solver, 1e-12);
        // λ of [[0.5, 0.5], [0.5, 0.5 - 2 leak]]; downstream p_2 = leak p_1/(λ - 0.1), p_3 = leak p_1/λ.
        let kept = 0.5 - leak + (0.25 + leak * leak).sqrt();
        assert!(
            (1.0 - found.info.escape_per_step - kept).abs() < 1e-13,
            "{solver:?}"
        );
        assert!((found.mass[2] / (leak * found.mass[1] / (kept - 0.1)) - 1.0).abs() < 1e-8);
        assert!((found.mass[3] / (leak * found.mass[1] / kept) - 1.0).abs() < 1e-8);
        assert_eq!(found.mass[4], 0.0);
        assert_eq!(found.info.class_cells, 4);
    }
}

#[test]
fn without_a_lasting_class_there_is_no_steady_state() {
    let options = Options::new(Solver::MultilevelAggregation, 1e-10);
    let escape =
        |matrix: &TransitionMatrix, n: usize| match solve(matrix, &grid(&[n]), None, &options)
            .unwrap()
        {
            Outcome::NoneInside { escape_per_step } => escape_per_step,
            other => panic!("{other:?}"),
        };
    // A drift straight through the cells: nothing ever returns.
    let through = transitions(4, &[(1, 0, 1.0), (2, 1, 1.0), (3, 2, 1.0)]);
    assert_eq!(escape(&through, 4), 1.0);
    // The longest-lived class keeps 45 %.
    let brief = transitions(4, &[(0, 0, 0.45), (1, 0, 0.1), (3, 2, 0.3), (2, 3, 0.3)]);
    assert!((escape(&brief, 4) - 0.55).abs() < 1e-12);
    // A single class of two cells, one of which leaks nothing by itself: λ² = 0.2.
    let pair = transitions(2, &[(1, 0, 1.0), (0, 1, 0.2)]);
    assert!((escape(&pair, 2) - (1.0 - 0.2_f64.sqrt())).abs() < 1e-9);
    assert_eq!(escape(&transitions(2, &[]), 2), 1.0);
}

#[test]
fn a_subset_of_the_cells_of_a_space_is_enough() {
    let mut matrix = transitions(2, &[(0, 0, 0.7), (1, 0, 0.3), (0, 1, 0.1), (1, 1, 0.9)]);
    matrix.cells = vec![3, 7];
    let found = steady(
        &matrix,
        &grid(&[5, 2]),
        None,
        Solver::MultilevelAggregation,
        1e-12,
    );
    assert_eq!(found.mass.len(), 10);
    assert!((found.mass[3] - 0.25).abs() < 1e-12 && (found.mass[7] - 0.75).abs() < 1e-12);
}

/// Which cells each cell reaches, itself included, by closure of the graph (Warshall).
fn reachable(n: usize, entries: &[(usize, usize, f64)]) -> Vec<Vec<bool>> {
    let mut reach: Vec<Vec<bool>> = (0..n).map(|i| (0..n).map(|j| i == j).collect()).collect();
    entries
        .iter()
        .for_each(|entry| reach[entry.1][entry.0] = true);
    for middle in 0..n {
        let onward = reach[middle].clone();
        for row in reach.iter_mut().filter(|row| row[middle]) {
            row.iter_mut()
                .zip(&onward)
                .for_each(|(to, more)| *to |= more);
        }
    }
    reach
}

/// Share of a uniform start that ends in each class: (1 - P_TT)ᵀ h = 1ᵀ P_CT for the transient cells T.
fn absorption(n: usize, entries: &[(usize, usize, f64)], class: &[usize]) -> f64 {
    let mut equations = nalgebra::DMatrix::<f64>::identity(n, n);
    let mut right = nalgebra::DVector::zeros(n);
    class.iter().for_each(|&cell| right[cell] = 1.0);
    let reach = reachable(n, entries);
    for &(target, source, probability) in entries {
        let transient = (0..n).any(|cell| reach[source][cell] && !reach[cell][source]);
        if transient {
            equations[(source, target)] -= probability;
        }
    }
    equations.lu().solve(&right).unwrap().sum() / n as f64
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn closed_classes_and_their_shares_agree_with_brute_force(
        seed in 0u64..1_000_000, n in 2usize..30, targets in 1usize..3,
    ) {
        let mut random = Random(seed);
        let share = 1.0 / targets as f64;
        let mut entries = Vec::new();
        for source in 0..n {
            for _ in 0..targets {
                entries.push(((random.uniform() * n as f64) as usize, source, share));
            }
        }
        let reach = reachable(n, &entries);
        let mut closed: Vec<Vec<usize>> = (0..n)
            .filter(|&cell| (0..n).all(|to| !reach[cell][to] || reach[to][cell]))
            .map(|cell| (0..n).filter(|&to| reach[cell][to]).collect())
            .collect();
        closed.sort();
        closed.dedup();
        let options = Options::new(Solver::MultilevelAggregation, 1e-10);
        match solve(&transitions(n, &entries), &grid(&[n]), None, &options).unwrap() {
            Outcome::Steady(state) => {
                prop_assert_eq!(closed.len(), 1);
                for cell in 0..n {
                    prop_assert_eq!(state.mass[cell] > 0.0, closed[0].contains(&cell));
                }
            }
            Outcome::SeveralClasses { classes, escaped } => {
                prop_assert_eq!(classes.len(), closed.len());
                prop_assert!(escaped == 0.0);
                for class in classes {
                    let cells = closed.iter().find(|cells| cells.contains(&class.representative));
                    let cells = cells.unwrap();
                    prop_assert_eq!(class.cells, cells.len());
                    prop_assert!((class.share - absorption(n, &entries, cells)).abs() < 1e-5);
                }
            }
            other => prop_assert!(false, "{:?}", other),
        }
    }
}
