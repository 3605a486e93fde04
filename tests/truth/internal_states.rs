//! States without noise that relax linearly (circuits, Maxwell elements), carried by Hermite modes: against exact
//! moments and densities, and through the sweep file.

use std::sync::Arc;

use crate::common::steady::solve;
use crate::common::sweeps::{measure, prepared, solved};
use nalgebra::{DMatrix, DVector};
use pbif::cancellation::Cancellation;
use pbif::continuation::PointStatus;
use pbif::density::Observable;
use pbif::generator::{
    AdvectiveScheme, GeneratorError, GeneratorOptions, assemble, unknown_moments,
};
use pbif::space::{Axis, CellSpace};
use pbif::sweep_file::SweepFile;
use pbif::system::{System, TypedModel, contract};

/// x'' + 0.3 x' + x + 0.5 v + 0.2 w = √0.3 ξ, v' = 0.5 x' - v, w' = 0.4 x - 2 w.
fn linear(axes: usize) -> Arc<dyn System> {
    let names = &["x", "y", "v", "w"][..axes];
    let force = ["-x - 0.3 y - 0.5 v", "-x - 0.3 y - 0.5 v - 0.2 w"][axes - 3];
    let mut model = TypedModel::new("linear", "Linear oscillator", names.iter().copied())
        .with_equation("x", "y")
        .with_equation("y", force)
        .with_equation("v", "0.5 y - v")
        .with_noise("y", ["sqrt(0.3)"]);
    if axes == 4 {
        model = model.with_equation("w", "0.4 x - 2 w");
    }
    model.build().unwrap().system_with(&[]).unwrap()
}

/// Covariances C of x' = A x with noise of intensity 0.3 on y: A C + C Aᵀ + 0.3 e_y e_yᵀ = 0.
fn covariances(system: &dyn System) -> DMatrix<f64> {
    let n = system.dimension();
    let unit = |axis: usize| {
        let mut state = vec![0.0; n];
        state[axis] = 1.0;
        DVector::from_vec(system.drift_at(0.0, &state))
    };
    let columns: Vec<DVector<f64>> = (0..n).map(unit).collect();
    let a = DMatrix::from_columns(&columns);
    let identity = DMatrix::<f64>::identity(n, n);
    let operator = identity.kronecker(&a) + a.kronecker(&identity);
    let mut right = DVector::zeros(n * n);
    right[n + 1] = -0.3;
    let solved = operator.lu().solve(&right).unwrap();
    DMatrix::from_column_slice(n, n, solved.as_slice())
}

/// Cells over eight standard deviations of x and y to either side, and modes for the others, `width` times as wide as
/// they are.
fn space(covariances: &DMatrix<f64>, cells: usize, modes: usize, width: f64) -> CellSpace {
    let axes = (0..covariances.nrows()).map(|axis| {
        let deviation = covariances[(axis, axis)].sqrt();
        match axis < 2 {
            true => Axis::uniform(-8.0 * deviation, 8.0 * deviation, cells).unwrap(),
            false => Axis::hermite(0.0, width * deviation, modes).unwrap(),
        }
    });
    CellSpace::new(axes.collect()).unwrap()
}

#[test]
fn second_moments_of_a_linear_oscillator_with_circuits_are_exact_with_three_modes() {
    // Three modes are closed for second moments, however wide: what is left is the cells', of fourth order, or nothing
    // but what the solver leaves, as a linear drift that is advected gives them exactly.
    let worst = |system: &dyn System, cells: usize, width: f64| {
        let exact = covariances(system);
        let space = space(&exact, cells, 3, width);
        let unknowns = solve(system, &space, AdvectiveScheme::Central6);
        let found = unknown_moments(&space, &unknowns).into_iter().enumerate();
        let errors = found.map(|(axis, (mean, variance))| {
            assert!(mean.abs() < 1e-9, "{axis} {mean}");
            (variance / exact[(axis, axis)] - 1.0).abs()
        });
        errors.fold(0.0, f64::max)
    };
    for (axes, [few, more]) in [(3, [48, 64]), (4, [36, 44])] {
        let system = linear(axes);
        for width in [0.8, 1.6] {
            let errors = [few, more].map(|cells| worst(&*system, cells, width));
            let order = (few as f64 / more as f64).powi(4);
            let words = format!("{axes} {width} {errors:?}");
            assert!(
                errors[0] < 3e-5 && errors[1] < f64::max(1.1 * order * errors[0], 1e-8),
                "{words}"
            );
        }
    }
}

#[test]
fn the_density_of_a_linear_oscillator_with_a_circuit_converges_exponentially_in_the_modes() {
    let system = linear(3);
    let exact = covariances(&*system);
    let distance = |modes: usize| {
        let space = space(&exact, 60, modes, 1.3);
        let unknowns = solve(&*system, &space, AdvectiveScheme::Upwind5);
        let nodes = space.axes()[0].nodes();
        let normal = |x: f64| (-0.5 * x * x / exact[(0, 0)]).exp();
        let sum: f64 = nodes.iter().map(|&x| normal(x)).sum();
        let mut found = vec![0.0; nodes.len()];
        for (cell, unknown) in unknowns.iter().enumerate() {
            found[space.position(cell, 0)] += unknown;
        }
        let differences = found.iter().zip(nodes);
        let differences = differences.map(|(found, &x)| (found - normal(x) / sum).abs());
        0.5 * differences.sum::<f64>()
    };
    let distances = [2, 3, 4, 5, 6, 8].map(distance);
    // A mode more takes at least a half of the error away, down to what the cells leave.
    let floor = distances[5];
    assert!(floor < 2e-4, "{distances:?}");
    for pair in distances.windows(2) {
        assert!(pair[1] < 0.5 * pair[0] + 1.5 * floor, "{distances:?}");
    }
    assert!(distances[0] > 20.0 * floor, "{distances:?}");
}

#[test]
fn what_relaxes_is_read_off_the_formulas() {
    let rate = |drift: &str, noise: Option<&str>| {
        let mut model = TypedModel::new("m", "M", ["x", "v"])
            .with_equation("x", "-x^3 - v")
            .with_equation("v", drift)
            .with_parameters(["c"])
            .with_noise("x", ["1"]);
        if let Some(noise) = noise {
            model = model.with_noise("v", [noise]);
        }
        let model = model.build().unwrap();
        let system = model.system_with(&[("c", 0.7)]).unwrap();
        let verified = contract::verify(&*system, &[(-2.0, 2.0); 2]);
        assert!(verified.is_ok(), "{drift}: {verified:?}");
        system.facts().relaxation_rates.get(&1).copied()
    };
    assert_eq!(rate("x - c v", None), Some(0.7));
    assert_eq!(rate("abs(x) x - 2 (c + 1) (v - x^2)", None), Some(3.4));
    assert_eq!(rate("x - v/c", None), Some(1.0 / 0.7));
    for other in ["x + c v", "x", "x - x^2 v", "x - v^3", "x - abs(v)"] {
        assert_eq!(rate(other, None), None, "{other}");
    }
    assert_eq!(rate("x - c v", Some("0.1")), None);
}

#[test]
fn hermite_modes_need_a_state_that_relaxes() {
    let model = TypedModel::new("m", "M", ["x", "v"])
        .with_equation("x", "-x - v")
        .with_equation("v", "x - v^3")
        .with_noise("x", ["1"]);
    let system = model.build().unwrap().system_with(&[]).unwrap();
    let cells = Axis::uniform(-3.0, 3.0, 20).unwrap();
    let modes = Axis::hermite(0.0, 1.0, 4).unwrap();
    let space = CellSpace::new(vec![cells, modes]).unwrap();
    let refused = assemble(&*system, &space, &GeneratorOptions::default());
    assert!(matches!(refused, Err(GeneratorError::Filter { axis: 1 })));
}

const HARVESTER: &str = r#"
[system.equations]
x = "y"
y = "a x - x^3 - 0.3 y - 0.5 v"
v = "0.5 y - v/tau"
[system.noise]
y = "sqrt(2 D)"
[system.parameters]
tau = 1
D = 0.15
[sweep]
parameter = "a"
from = -0.3
to = 0.5
points = 5
[cells]
x = { from = -2.4, to = 2.4, count = 40 }
y = { from = -2.8, to = 2.8, count = 40 }
"#;

fn file(text: &str) -> SweepFile {
    SweepFile::parse("harvester.toml", text)
}

#[test]
fn a_typed_circuit_is_carried_by_modes_and_the_prepared_file_gives_the_same_sweep() {
    let never = Cancellation::new();
    let mut by_modes = file(HARVESTER);
    by_modes.set("detect.joint", "[]");
    let sweep = by_modes.validate().unwrap().prepare(&never).unwrap();
    let axis = &sweep.problem.space().axes()[2];
    assert!(axis.is_modes() && (3..=10).contains(&axis.count()));
    let written = sweep.to_toml();
    let again = file(&written).validate().unwrap().fixed().unwrap();
    assert_eq!(again.problem.space(), sweep.problem.space());
    // x is watched, and its peak becomes two; on cells along v the same, with more error.
    let found = sweep.run(&never, &mut ()).unwrap();
    let of_x = |found: &pbif::continuation::SweepResult| {
        let mut rows = found.bifurcations();
        let row = rows
            .find(|row| row.observable == Observable::Marginal(0))
            .unwrap();
        (row.value, row.error)
    };
    let (value, error) = of_x(&found);
    let cells = format!("{HARVESTER}v = {{ from = -1.6, to = 1.6, count = 28 }}\n");
    let mut by_cells = file(&cells);
    by_cells
        .set("locate.grid_check", "off")
        .set("sweep.points", "3");
    by_cells.set("detect.joint", "[]");
    let by_cells = by_cells.validate().unwrap().prepare(&never).unwrap();
    assert!(!by_cells.problem.space().axes()[2].is_modes());
    let (other, width) = of_x(&by_cells.run(&never, &mut ()).unwrap());
    let words = format!("{value} ± {error}, {other} ± {width}");
    assert!(
        width < 3e-3 && (value - other).abs() <= error + width,
        "{words}"
    );
}

#[test]
fn values_that_do_not_relax_keep_cells() {
    let never = Cancellation::new();
    let carried = |text: &str| {
        let mut sweep = file(text);
        sweep.set("cells.accuracy", "0.1");
        let sweep = sweep.validate().unwrap().prepare(&never).unwrap();
        sweep.problem.space().axes()[2].is_modes()
    };
    assert!(carried(HARVESTER));
    let with_cells = format!("{HARVESTER}v = {{ from = -2.0, to = 2.0, count = 12 }}\n");
    assert!(!carried(&with_cells));
    // A formula of the state is worked out from the series.
    let watched = format!("{HARVESTER}[watch]\npower = \"v^2\"\n");
    assert!(carried(&watched));
    // v grows on its own: no modes, and the message says why.
    let growing = HARVESTER.replace("tau = 1", "tau = -1") + "v = { modes = 4 }\n";
    let refused = file(&growing).validate().unwrap_err().to_string();
    assert!(refused.contains("does not relax linearly"), "{refused}");
}

/// Dahl's z' = y - (λ/f_c) |y| z has ⟨z z'⟩ = 0 in a steady state, whatever the rest of the system does.
#[test]
fn means_of_formulas_with_a_friction_state_keep_its_balance() {
    let words = "cells.x.count=60 cells.y.count=60 detect.marginals=[\"x\"] detect.joint=[] figures.at=[] \
                 watch.power=\"z*y\" watch.loss=\"abs(y)*z^2\" watch.square=\"z^2\"";
    let text = include_str!("../../sweeps/dahl_alpha.toml");
    let (_, solution) = solved(text, words, None);
    let known = |name: &str| measure(&solution, name);
    let ratio = 0.06 / 0.05;
    let ((power, of_power), (loss, of_loss)) = (known("mean_power"), known("mean_loss"));
    let off = (power - ratio * loss).abs();
    let error = of_power + ratio * of_loss;
    assert!(
        off <= error && error < 3e-2 * power,
        "{power} {loss}: {off:e} of {error:e}"
    );
    // The same number by the moments of the axis itself.
    let ((mean, _), (deviation, error), (square, of_square)) =
        (known("mean_z"), known("sd_z"), known("mean_square"));
    let off = (square - mean * mean - deviation * deviation).abs();
    assert!(
        off <= of_square + 2.0 * deviation * error,
        "{square}: {off:e}"
    );
}

/// Bouc and Wen's law as it is typed, n = 1: z yields at ±A/(b + c), and has ⟨z z'⟩ = 0 in a steady state.
const BOUC_WEN: &str = "[system.equations]\nx = \"y\"\ny = \"-0.1 y - a x - (1 - a) z\"\n\
     z = \"A y - b abs(y) z - c y abs(z)\"\n[system.noise]\ny = \"sqrt(0.1)\"\n\
     [system.parameters]\na = 0.1\nA = 1.2\nb = 0.5\nc = 0.3\n\
     [sweep]\nparameter = \"a\"\nfrom = 0.05\nto = 0.4\npoints = 2\n\
     [watch]\npower = \"z y\"\nloss = \"b abs(y) z^2 + c y z abs(z)\"\n";

#[test]
fn a_typed_state_of_hysteresis_has_its_bounds_and_modes_without_being_asked() {
    let cells = "cells.x={from=-6,to=6,count=30} cells.y={from=-3.4,to=3.4,count=30}";
    let (sweep, solution) = solved(BOUC_WEN, cells, None);
    let axis = &sweep.problem.space().axes()[2];
    assert!(axis.is_modes() && (axis.to() - 1.5).abs() < 1e-12 && axis.from() == -axis.to());
    let known = |name: &str| measure(&solution, name);
    let ((power, of_power), (loss, of_loss)) = (known("mean_power"), known("mean_loss"));
    let off = (1.2 * power - loss).abs();
    let error = 1.2 * of_power + of_loss;
    assert!(
        off <= error && off < 2e-2 * loss,
        "{power} {loss}: {off:e} of {error:e}"
    );
    // Where the bounds move along the sweep they are known as well, and cells carry the state.
    let moving = BOUC_WEN.replace(
        "parameter = \"a\"\nfrom = 0.05\nto = 0.4",
        "parameter = \"A\"\nfrom = 0.8\nto = 1.2",
    );
    let words = "cells.x={from=-6,to=6,count=12} cells.y={from=-3,to=3,count=12} cells.z.count=8";
    let axes = prepared(&moving, words);
    let axis = &axes.problem.space().axes()[2];
    assert!(!axis.is_modes() && (axis.to() - 1.5).abs() < 1e-12);
    // Also where they are widest between both ends.
    let between = moving
        .replace("b abs(y) z + ", "")
        .replace("b abs(y) z", "(0.3 + A^2) abs(y) z");
    let between = between
        .replace("A y - ", "y - ")
        .replace(" - c y abs(z)", "");
    let axes = prepared(&between.replace("from = 0.8", "from = -1.2"), words);
    assert!((axes.problem.space().axes()[2].to() - 1.0 / 0.3).abs() < 1e-12);
}

/// Factors mode by mode serve the steady state of this law, and not what another scheme changes of it: others are made.
#[test]
#[ignore = "ten seconds: factors of all modes together"]
fn what_factors_mode_by_mode_do_not_answer_others_do_at_length() {
    let words = "cells.x={from=-6,to=6,count=62} cells.y={from=-3.2,to=3.2,count=62,grade={at=[0.0],smallest=0.0413}} \
                 cells.z.modes=12 system.parameters.A=1 system.parameters.c=0.5";
    let (_, solution) = solved(BOUC_WEN, words, Some(0.05));
    assert_eq!(solution.report.status, PointStatus::Solved);
    let mut measures = solution.report.measures.iter();
    let factorisations = measures.find(|one| one.name == "factorisations").unwrap();
    assert!(factorisations.value > 1.0);
}
