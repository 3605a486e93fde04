//! Located values on systems with known answers that are not built in: what is called located must be so. The random
//! sweeps are ignored by default (`cargo test --release --test truth located:: -- --ignored --nocapture`); their
//! results stand in docs/location.md.

use std::sync::Arc;

use pbif::cancellation::Cancellation;
use pbif::continuation::{BifurcationStatus, Doubt, LocateOptions, Located, SweepResult, sweep};
use pbif::density::Observable;
use pbif::method::{GeneratorMethodOptions, GeneratorSource, Problem};
use pbif::space::{Axis, CellSpace};
use pbif::system::{
    AxisDescription, Family, Interpretation, Lanes, Model, Noise, ParameterDescription, Path,
    System, TypedModel,
};
use pbif::topology::{DetectOptions, PersistenceDetector};

/// Drift of a system with one parameter.
type Drift = fn(f64, &[f64], &mut [f64]);

/// A system by its drift, with white noise on its last axis.
struct ByDrift {
    axes: usize,
    theta: f64,
    drift: Drift,
    noise: [Noise; 1],
}

impl System for ByDrift {
    fn dimension(&self) -> usize {
        self.axes
    }
    fn drift(&self, _time: f64, states: &[Lanes], drift: &mut [Lanes]) {
        let (mut state, mut slope) = (vec![0.0; self.axes], vec![0.0; self.axes]);
        for lane in 0..states[0].len() {
            for axis in 0..self.axes {
                state[axis] = states[axis][lane];
            }
            (self.drift)(self.theta, &state, &mut slope);
            for axis in 0..self.axes {
                drift[axis][lane] = slope[axis];
            }
        }
    }
    fn noises(&self) -> &[Noise] {
        &self.noise
    }
}

fn model(axes: usize, sigma2: f64, drift: Drift) -> Model {
    let names = ["x", "y"].into_iter().take(axes);
    let described: Vec<AxisDescription> = names
        .map(|name| AxisDescription::new(name, name, "coordinate"))
        .collect();
    Model::new("by_drift", "A system by its drift", move |values| {
        Arc::new(ByDrift {
            axes,
            theta: values[0],
            drift,
            noise: [Noise::constant(axes - 1, sigma2.sqrt())],
        })
    })
    .with_axes(described)
    .with_parameters([ParameterDescription::new(
        "theta",
        "θ",
        "the swept parameter",
    )])
}

/// One sweep of the last observable of a system: the marginal of its only axis, or the joint density of two.
fn rows(
    model: Model,
    ends: (f64, f64),
    points: usize,
    axes: Vec<Axis>,
) -> (SweepResult, Vec<Located>) {
    let observable = match axes.len() {
        1 => Observable::Marginal(0),
        _ => Observable::Joint(0, 1),
    };
    rows_of(
        Arc::new(model),
        &[observable],
        ends,
        points,
        axes,
        &LocateOptions::default(),
    )
}

fn rows_of(
    model: Arc<Model>,
    observables: &[Observable],
    ends: (f64, f64),
    points: usize,
    axes: Vec<Axis>,
    locate: &LocateOptions,
) -> (SweepResult, Vec<Located>) {
    let path = Path::parameter("theta", ends.0, ends.1);
    let family = Family::new(model, &[], path).unwrap();
    let space = CellSpace::new(axes).unwrap();
    let problem = Problem::new(family, space, observables.to_vec()).unwrap();
    let options = GeneratorMethodOptions::default();
    let source = GeneratorSource::new(&problem, &options).unwrap();
    let looks = points * observables.len();
    let detector = PersistenceDetector::new(DetectOptions::default(), looks);
    let result = sweep(
        &source,
        &detector,
        points,
        locate,
        &Cancellation::new(),
        &mut (),
    )
    .unwrap();
    let rows = result.bifurcations().cloned().collect();
    (result, rows)
}

/// The rows of each of these observables.
fn each_of<const N: usize>(rows: &[Located], observables: [Observable; N]) -> [Vec<Located>; N] {
    observables.map(|observable| {
        let own = rows.iter().filter(|row| row.observable == observable);
        own.cloned().collect()
    })
}

fn words(rows: &[Located]) -> String {
    let lines = rows.iter().map(|row| {
        format!(
            "{:?} {} ± {} {} → {}, {}\n",
            row.status(),
            row.value,
            row.error,
            row.before,
            row.after,
            row.change()
        )
    });
    lines.collect()
}

/// Asserts that the rows are located at the truths, with errors within 1e-4 of the range.
fn assert_located(rows: &[Located], truths: &[f64], range: f64) {
    assert_eq!(rows.len(), truths.len(), "{}", words(rows));
    for (row, truth) in rows.iter().zip(truths) {
        assert_eq!(row.status(), BifurcationStatus::Located, "{}", words(rows));
        assert!(
            (row.value - truth).abs() <= row.error,
            "{truth}\n{}",
            words(rows)
        );
        assert!(row.error <= 1e-4 * range, "{}", words(rows));
    }
}

fn tilted(h: f64, state: &[f64], slope: &mut [f64]) {
    slope[0] = h + state[0] - state[0].powi(3);
}

#[test]
fn folds_beside_a_well_a_billion_times_as_deep_are_located() {
    let truth = (4.0f64 / 27.0).sqrt();
    for (sigma2, from, to) in [(0.03, -0.5, 0.5), (0.05, -0.5, 0.5), (0.25, 0.33, 0.5)] {
        let axes = vec![Axis::uniform(-1.9, 1.9, 200).unwrap()];
        let (_, rows) = rows(model(1, sigma2, tilted), (from, to), 41, axes);
        let truths = [-truth, truth];
        let inside: Vec<f64> = truths.into_iter().filter(|one| *one > from).collect();
        assert_located(&rows, &inside, to - from);
    }
}

#[test]
fn two_deep_wells_split_once() {
    fn drift(a: f64, state: &[f64], slope: &mut [f64]) {
        slope[0] = a * state[0] - state[0].powi(3);
    }
    let axes = vec![Axis::uniform(-2.2, 2.2, 200).unwrap()];
    let (result, rows) = rows(model(1, 0.01, drift), (-1.0, 1.0), 41, axes);
    // Nobody declared the symmetry: it is found.
    assert_located(&rows, &[0.0], 2.0);
    assert!(result.points.len() < 100, "{}", result.points.len());
}

#[test]
fn a_split_that_is_not_quite_symmetric_is_no_symmetric_one() {
    fn drift(a: f64, state: &[f64], slope: &mut [f64]) {
        slope[0] = 0.001 + a * state[0] - state[0].powi(3);
    }
    let axes = vec![Axis::uniform(-2.2, 2.2, 100).unwrap()];
    let (_, rows) = rows(model(1, 0.25, drift), (-1.0, 1.0), 41, axes);
    let truth = 3.0 * 0.0005f64.powf(2.0 / 3.0);
    assert_eq!(rows.len(), 1, "{}", words(&rows));
    assert!(
        (rows[0].value - truth).abs() <= rows[0].error,
        "{truth} {}",
        words(&rows)
    );
    assert!(rows[0].error < 1e-3, "{}", words(&rows));
}

#[test]
fn a_parameter_in_units_of_a_billion_has_the_same_row() {
    fn drift(a: f64, state: &[f64], slope: &mut [f64]) {
        slope[0] = 1e-9 * a * state[0] - state[0].powi(3);
    }
    let axes = vec![Axis::uniform(-2.2, 2.2, 100).unwrap()];
    let (_, rows) = rows(model(1, 0.25, drift), (-1e9, 1e9), 40, axes);
    assert_located(&rows, &[0.0], 2e9);
}

#[test]
fn a_ring_ends_around_a_peak_where_its_moat_does() {
    fn drift(c: f64, state: &[f64], slope: &mut [f64]) {
        let (x, y) = (state[0], state[1]);
        let energy = 0.5 * (x * x + y * y);
        slope[0] = y;
        slope[1] = -(c - energy + energy * energy) * y - x;
    }
    let axis = || Axis::uniform(-2.4, 2.4, 80).unwrap();
    let (_, rows) = rows(model(2, 0.4, drift), (-0.2, 0.5), 15, vec![axis(), axis()]);
    assert!(
        rows[0].after.to_string() == "peak in a ring",
        "{}",
        words(&rows)
    );
    assert_located(&rows, &[0.0, 0.25], 0.7);
}

#[test]
fn a_fold_of_a_joint_density_is_located() {
    fn drift(h: f64, state: &[f64], slope: &mut [f64]) {
        let (x, y) = (state[0], state[1]);
        slope[0] = y;
        slope[1] = -y - x.powi(3) + x + h;
    }
    let axes = vec![
        Axis::uniform(-2.6, 2.6, 100).unwrap(),
        Axis::uniform(-3.2, 3.2, 80).unwrap(),
    ];
    let (_, rows) = rows(model(2, 0.5, drift), (-0.5, 0.5), 16, axes);
    let truth = (4.0f64 / 27.0).sqrt();
    assert_located(&rows, &[-truth, truth], 1.0);
}

#[test]
fn two_folds_within_one_step_that_undo_each_other_are_both_located() {
    // Zeros of the slope at θ = x³ - k x, whose turns lie 4/3 (k/3)^(1/2) k apart: a ninth of a step.
    fn drift(theta: f64, state: &[f64], slope: &mut [f64]) {
        slope[0] = theta - 0.1 + 0.02 * state[0] - state[0].powi(3);
    }
    let axes = vec![Axis::uniform(-1.9, 1.9, 200).unwrap()];
    let (result, rows) = rows(model(1, 0.3, drift), (-0.5, 0.513), 41, axes);
    let fold = 2.0 * (0.02f64 / 3.0).powf(1.5);
    assert_located(&rows, &[0.1 - fold, 0.1 + fold], 1.013);
    assert!(result.points.len() < 65, "{}", result.points.len());
}

/// x and y independent of each other, each with a drift that is odd and whose curvature jumps at zero.
fn with_quadratic_friction() -> Arc<Model> {
    TypedModel::new("quadratic", "Quadratic friction", ["x", "y"])
        .with_equation("x", "-x - 0.5 x abs(x)")
        .with_equation("y", "theta y - 0.6 y abs(y) - 0.4 y^3")
        .with_noise("x", ["0.6"])
        .with_noise("y", ["0.7"])
        .with_parameters(["theta"])
        .build()
        .unwrap()
}

#[test]
fn a_split_at_a_place_where_the_curvature_of_the_drift_jumps_is_held_by_its_error() {
    let axis = |cells| Axis::uniform(-2.7, 2.7, cells).unwrap();
    let watched = [Observable::Marginal(1), Observable::Joint(0, 1)];
    let (_, rows) = rows_of(
        with_quadratic_friction(),
        &watched,
        (-0.713, 0.687),
        8,
        vec![axis(60), axis(60)],
        &LocateOptions::default(),
    );
    for rows in each_of(&rows, watched) {
        assert_eq!(rows.len(), 1, "{}", words(&rows));
        assert!(rows[0].value.abs() <= rows[0].error, "{}", words(&rows));
        assert!(rows[0].value.abs() < 5e-3, "{}", words(&rows));
    }
}

/// An oscillator with a preloaded spring, whose force jumps at x = 0: p ∝ exp(-(2c/σ²)(y²/2 + x²/2 + θ|x|)) has two
/// peaks at x = ±|θ| below zero, one above.
#[test]
fn a_spring_whose_preload_changes_its_sign_splits_the_density_there() {
    let model = TypedModel::new("preload", "A preloaded spring", ["x", "y"])
        .with_equation("x", "y")
        .with_equation("y", "-x - theta sign(x) - 0.5 y")
        .with_noise("y", ["0.7"])
        .with_parameters(["theta"])
        .build()
        .unwrap();
    let axes = [(-4.0, 4.0, 48), (-3.5, 3.5, 40)];
    let axes = axes.map(|(from, to, count)| Axis::uniform(from, to, count).unwrap());
    let watched = [Observable::Marginal(0), Observable::Joint(0, 1)];
    let (result, rows) = rows_of(
        model,
        &watched,
        (-0.53, 0.61),
        8,
        axes.to_vec(),
        &LocateOptions::default(),
    );
    for (observable, rows) in each_of(&rows, watched).into_iter().enumerate() {
        // The kink's slope follows from the equations: its sign is that of the preload on any cells.
        assert_located(&rows, &[0.0], 1.14);
        assert!(rows[0].value.abs() < 1e-9, "{}", words(&rows));
        let kink = &result.points[7].densities[observable].structure.kinks[0];
        let (theta, middle) = (result.points[7].value, kink.jump.len() / 2);
        let exact = -4.0 * theta * 0.5 / 0.49;
        // Its size is read from cells a quarter as wide as the density along y: differences of second order, (h/σ_y)² =
        // 0.06 of it.
        let share = kink.jump_at(middle) / exact;
        assert!((share - 1.0).abs() < 0.06, "{share}");
    }
}

#[test]
fn a_peak_that_opens_to_a_ring_away_from_a_centre_is_located() {
    // p depends on the energy alone, and falls with it for θ < -1/4 b: the wells at x = ± 1 are peaks, and bottoms of
    // rings after that.
    fn drift(a: f64, state: &[f64], slope: &mut [f64]) {
        let (x, y) = (state[0], state[1]);
        let energy = 0.5 * y * y - 0.5 * x * x + 0.25 * x.powi(4);
        slope[0] = y;
        slope[1] = (a - 0.1 * energy) * y + x - x.powi(3);
    }
    let axis = || Axis::uniform(-2.5, 2.5, 80).unwrap();
    let (_, rows) = rows(
        model(2, 0.02, drift),
        (-0.06, -0.01),
        6,
        vec![axis(), axis()],
    );
    assert_eq!(rows.len(), 1, "{}", words(&rows));
    assert_eq!(rows[0].before.to_string(), "2 peaks");
    assert_eq!(rows[0].after.to_string(), "2 rings");
    let found = &rows[0];
    assert!(
        (found.value + 0.025).abs() <= found.error,
        "{}",
        words(&rows)
    );
    assert!(found.error < 1e-4, "{}", words(&rows));
}

/// The rows of a sweep of θ over a system with one axis whose noise bends, in Itô's sense.
fn with_bent_noise(drift: &str, noise: &str, (from, to): (f64, f64)) -> Vec<Located> {
    let model = TypedModel::new("bent", "Noise that bends", ["x"])
        .with_equation("x", drift)
        .with_noise("x", [noise])
        .with_interpretation(Interpretation::Ito)
        .with_parameters(["theta"])
        .build()
        .unwrap();
    let axes = vec![Axis::uniform(from, to, 200).unwrap()];
    let options = LocateOptions::default();
    let watched = [Observable::Marginal(0)];
    rows_of(model, &watched, (-1.013, 0.987), 41, axes, &options).1
}

#[test]
fn births_at_a_bend_of_the_noise_are_located_beside_it() {
    let noise = "sqrt(0.198 (1 + 0.973 abs(x + 0.135)))";
    let rows = with_bent_noise("theta + 0.36 x - x^3", noise, (-2.81, 2.86));
    // Two pairs of changes, each within one step: zeros of θ + 0.36 x - x³ ∓ 0.198 · 0.973/2 that turn, or lie at the
    // bend.
    let jump = 0.5 * 0.198 * 0.973;
    let turn = 2.0 * 0.12f64.powf(1.5);
    let at_bend = 0.36 * 0.135 - 0.135f64.powi(3);
    let mut truths = [turn - jump, jump - turn, at_bend - jump, at_bend + jump];
    truths.sort_by(f64::total_cmp);
    for row in &rows {
        let held = truths
            .iter()
            .any(|truth| (row.value - truth).abs() <= row.error);
        assert!(held, "{truths:?}\n{}", words(&rows));
    }
    assert_eq!(rows.len(), 4, "{truths:?}\n{}", words(&rows));
}

#[test]
fn without_the_check_on_finer_cells_nothing_is_located() {
    let unchecked = LocateOptions {
        grid_check: false,
        tolerance: Some(2e-3),
        ..LocateOptions::default()
    };
    let model = TypedModel::new("wells", "An oscillator in a tilted well", ["x", "y"])
        .with_equation("x", "y")
        .with_equation("y", "theta + x - x^3 - y")
        .with_noise("y", ["0.7"])
        .with_parameters(["theta"])
        .build()
        .unwrap();
    let axes = [(-2.4, 2.4, 64), (-3.2, 3.2, 48)];
    let axes = axes.map(|(from, to, count)| Axis::uniform(from, to, count).unwrap());
    let (_, rows) = rows_of(
        model,
        &[Observable::Marginal(0)],
        (-0.5, 0.5),
        11,
        axes.to_vec(),
        &unchecked,
    );
    assert_eq!(rows.len(), 2, "{}", words(&rows));
    for row in &rows {
        assert_eq!(row.status(), BifurcationStatus::Unchecked);
        assert_eq!(row.reason(), Some(&Doubt::GridCheckOff));
        assert!(unchecked.is_met_by(BifurcationStatus::Unchecked));
        assert!(!LocateOptions::default().is_met_by(BifurcationStatus::Unchecked));
    }
}

/// A pair is born on a flank, and its peak then moves to a kink: nothing is counted there, although the slope beside it
/// passes zero.
#[test]
fn a_peak_that_reaches_a_kink_is_not_born_there() {
    let noise = "sqrt(0.3 (1 + 0.466 abs(x - 0.73)))";
    let rows = with_bent_noise("theta + 1.403 x - x^3", noise, (-3.13, 2.94));
    // Below the kink peaks are where θ + 1.403 x - x³ + 0.3 · 0.466/2 falls through zero.
    let turn = 2.0 / 3.0 * 1.403 * (1.403_f64 / 3.0).sqrt();
    let half = 0.5 * 0.3 * 0.466;
    assert_eq!(rows.len(), 2, "{}", words(&rows));
    for (row, truth) in rows.iter().zip([-turn - half, turn - half]) {
        assert_eq!(row.status(), BifurcationStatus::Located);
        assert!((row.value - truth).abs() <= row.error, "{}", words(&rows));
    }
}

#[test]
fn a_jump_that_moves_through_the_cells_leaves_no_value_located_but_what_cells_show_that_move_with_it()
 {
    // x and y are independent; y is driven away from θ, and has peaks at ±0.5 as long as θ lies between them: two of
    // y become one at θ = 0.5. Cells that hold the jump show peaks that come and go as it moves.
    let model = TypedModel::new("belt", "A force that jumps at θ", ["x", "y"])
        .with_equation("x", "-x")
        .with_equation("y", "-y + 0.5 sign(y - theta)")
        .with_noise("x", ["0.6"])
        .with_noise("y", ["0.5"])
        .with_parameters(["theta"])
        .build()
        .unwrap();
    let axis = || Axis::uniform(-3.1, 3.1, 70).unwrap();
    let ends = (0.111, 0.887);
    let (axes, options) = (vec![axis(), axis()], LocateOptions::default());
    let watched = [Observable::Marginal(1), Observable::Joint(0, 1)];
    let (_, rows) = rows_of(model, &watched, ends, 9, axes, &options);
    for rows in each_of(&rows, watched) {
        assert!(!rows.is_empty());
        for row in &rows {
            let status = row.status();
            if status == BifurcationStatus::Located {
                let is_right = (row.value - 0.5).abs() <= row.error;
                let counts = (row.before.peaks, row.after.peaks);
                assert!(is_right && counts == (2, 1), "{}", words(&rows));
                continue;
            }
            let jumps = matches!(row.reason(), Some(Doubt::JumpInsideCells(1, _)));
            let is_told = jumps || status != BifurcationStatus::Unresolved;
            let holds = (row.value - 0.5).abs() <= row.error;
            assert!(is_told || holds || row.zero.is_none(), "{}", words(&rows));
        }
    }
}
