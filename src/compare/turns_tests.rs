//! A forced Duffing oscillator by all methods, generator and Monte Carlo bin by bin at two phases.

use std::sync::Arc;

use super::solve::Sources;
use super::{Method, Task, agreement, pairs, uniform_cells};
use crate::cancellation::Cancellation;
use crate::density::Observable;
use crate::method::{GeneratorMethodOptions, MonteCarloOptions, Problem, SgcmOptions};
use crate::space::{Axis, CellSpace};
use crate::system::{AtPhase, Family, Path, Quantity, TypedModel};

#[test]
fn methods_agree_on_a_forced_duffing_oscillator_at_two_phases() {
    let model = TypedModel::new("duffing", "Forced Duffing oscillator", ["x", "y"])
        .with_equation("x", "y")
        .with_equation("y", "-0.2 y + x - x^3 + F cos(1.3 t)")
        .with_noise("y", [format!("{}", 0.12_f64.sqrt())])
        .with_parameters(["F"]);
    let model = model.build().unwrap();
    let family = Family::new(Arc::clone(&model), &[], Path::parameter("F", 0.4, 0.4)).unwrap();
    let quantities = [0.0, 0.25]
        .map(|phase| Arc::new(Quantity::at_phase(&model, AtPhase { axis: 0, phase }).unwrap()));
    let family = family.with_quantities(quantities.to_vec());
    let axes = vec![
        Axis::uniform(-3.2, 3.2, 80).unwrap(),
        Axis::uniform(-4.2, 4.2, 80).unwrap(),
        Axis::fourier(0.0, 1.0, 8).unwrap(),
    ];
    let bins = vec![axes[0].clone(); 2];
    let observables = vec![
        Observable::Marginal(0),
        Observable::Marginal(3),
        Observable::Marginal(4),
    ];
    let space = CellSpace::new(axes).unwrap();
    let problem = Problem::watching(family, space, observables, bins).unwrap();
    let task = Task {
        problem: &problem,
        at: &[0.4],
        generator: GeneratorMethodOptions::default(),
        sgcm: SgcmOptions {
            samples: 300,
            ..SgcmOptions::default()
        },
        monte_carlo: MonteCarloOptions {
            error: 0.01,
            ..MonteCarloOptions::default()
        },
    };
    // Fewer cells than a comparison has, for the sake of time.
    let common = uniform_cells(problem.space(), 36).unwrap();
    let never = Cancellation::new();
    let sources = Sources::new(&task, &common, &never).unwrap();
    let mut solved = vec![
        sources.generator(0.4).unwrap(),
        sources.monte_carlo(0.4).unwrap(),
    ];
    solved.extend(sources.sgcm(0.4).unwrap());
    assert!(solved.iter().all(|one| one.status.is_resolved()));
    for found in agreement::of_marginals(&solved) {
        let words = format!("{found:?}");
        assert!(found.bins > 20, "{words}");
        assert!(found.beyond <= 2 && found.worst < 5.5, "{words}");
        assert!(found.share() > 0.9, "{words}");
    }
    let all = pairs(&task, &common, 0.4, &solved).unwrap();
    // Six pairs of methods, three densities each. Flat cells spread the density by h²/12 with every map step.
    assert_eq!(all.len(), 18);
    for pair in &all {
        let is_flat = [Some(pair.first), pair.second].contains(&Some(Method::Sgcm));
        let apart = &pair.distances.total_variation;
        assert!(apart.value < if is_flat { 0.1 } else { 0.03 }, "{apart:?}");
    }
    // Moments at the phases, and the amplitude, within both errors: of Monte Carlo, and of cells with slopes.
    let both = |name: &str, other: usize| {
        [0, other].map(|which: usize| {
            let report = &solved[which].report;
            let known = report.measure(name).zip(report.error_of(name));
            known.unwrap_or_else(|| panic!("{name} is not known"))
        })
    };
    let names = [
        "mean_x_phase_0",
        "sd_x_phase_0",
        "mean_x_phase_1_4",
        "sd_x_phase_1_4",
        "amplitude_x",
    ];
    let slope = solved
        .iter()
        .position(|one| one.method == Method::SgcmSlope);
    for other in [1, slope.unwrap()] {
        for name in names {
            let [(one, error), (another, sampling)] = both(name, other);
            let apart = (one - another) / f64::hypot(error, sampling);
            let words = format!("{name}: {one} {error:e}, {another} {sampling:e}");
            assert!(apart.abs() < 4.0, "{words}");
            assert!(error < 0.05 && sampling < 0.05, "{words}");
        }
    }
}
