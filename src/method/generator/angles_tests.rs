//! Angles against quadrature: density, mean velocity and effective diffusion of a tilted washboard, a rotor with
//! friction, and places of the seam.

use std::sync::Arc;

use super::{GeneratorMethodOptions, GeneratorSource};
use crate::cancellation::Cancellation;
use crate::continuation::{DensitySource as _, SolveReport};
use crate::density::{Density, Observable};
use crate::method::Problem;
use crate::space::{Axis, CellSpace};
use crate::system::{Family, Interpretation, Model, Path, TypedModel};

const PI: f64 = std::f64::consts::PI;
const TAU: f64 = std::f64::consts::TAU;

/// Densities of all axes, and the report, at a value of `A`.
fn solved(model: &Arc<Model>, a: f64, axes: Vec<Axis>) -> (Vec<Density>, SolveReport) {
    let path = Path::parameter("A", a, a);
    let family = Family::new(Arc::clone(model), &[], path).unwrap();
    let observables = (0..axes.len()).map(Observable::Marginal).collect();
    let space = CellSpace::new(axes).unwrap();
    let problem = Problem::new(family, space, observables).unwrap();
    let source = GeneratorSource::new(&problem, &GeneratorMethodOptions::default()).unwrap();
    let mut session = source.open(&Cancellation::new());
    let solution = session.solve(a).unwrap();
    let densities = solution.densities.iter().map(|one| one.density.clone());
    (densities.collect(), solution.report.clone())
}

/// A number of the report with its error.
fn known(report: &SolveReport, name: &str) -> (f64, f64) {
    (
        report.measure(name).unwrap(),
        report.error_of(name).unwrap(),
    )
}

/// θ' = A - sin(θ - s) - 0.4 sin(2 θ - 2 s) with white noise of intensity 2 D.
pub(crate) fn washboard(shift: f64, d: f64) -> Arc<Model> {
    TypedModel::new("washboard", "Washboard", ["theta"])
        .with_equation(
            "theta",
            format!(
                "A - sin(theta - {shift}) - 0.4 sin(2 theta - {})",
                2.0 * shift
            ),
        )
        .with_noise("theta", [format!("{}", (2.0 * d).sqrt())])
        .with_angle("theta", TAU)
        .with_parameters(["A"])
        .build()
        .unwrap()
}

/// Steps of the quadrature over a turn, which errs by some 1e-9: far less than densities at this noise differ by.
const STEPS: usize = 2400;

/// Velocity and effective diffusion of a tilted washboard by Stratonovich's and Reimann's formulas (P. Reimann et al.,
/// Phys. Rev. E 65, 031104, 2002), with I±(x) = e^{±U(x)/D} ∫ e^{∓U(x ∓ z)/D} dz over a turn of z; the density ∝ I-.
pub(crate) fn exact(a: f64, d: f64) -> (f64, f64, Vec<f64>) {
    let step = TAU / STEPS as f64;
    // U/D, and its fall over a turn.
    let periodic = |k: usize| {
        let x = step * (k % STEPS) as f64;
        (-x.cos() - 0.2 * (2.0 * x).cos()) / d
    };
    let (periodic, tilt): (Vec<f64>, f64) = ((0..STEPS).map(periodic).collect(), a / d * step);
    let sum = |x: usize, sign: f64| -> f64 {
        // A periodic function of x alone; the sum over z is not periodic: by the trapezoid rule with Gregory's ends.
        let term = |z: usize| {
            let other = if sign > 0.0 { x + STEPS - z } else { x + z } % STEPS;
            (sign * (periodic[x] - periodic[other]) - tilt * z as f64).exp()
        };
        let weights = [
            95.0 / 288.0,
            317.0 / 240.0,
            23.0 / 30.0,
            793.0 / 720.0,
            157.0 / 160.0,
        ];
        let weight = |z: usize| {
            let from_end = z.min(STEPS - z);
            weights.get(from_end).copied().unwrap_or(1.0)
        };
        (0..=STEPS).map(|z| weight(z) * term(z) * step).sum()
    };
    let plus: Vec<f64> = (0..STEPS).map(|x| sum(x, 1.0)).collect();
    let minus: Vec<f64> = (0..STEPS).map(|x| sum(x, -1.0)).collect();
    let mean = |of: &dyn Fn(usize) -> f64| (0..STEPS).map(of).sum::<f64>() / STEPS as f64;
    let whole = mean(&|x| plus[x]);
    let velocity = d * (1.0 - (-a / d * TAU).exp()) / whole;
    let diffusion = d * mean(&|x| plus[x] * plus[x] * minus[x]) / whole.powi(3);
    let total: f64 = minus.iter().sum::<f64>() * step;
    (
        velocity,
        diffusion,
        minus.iter().map(|one| one / total).collect(),
    )
}

#[test]
fn a_tilted_washboard_turns_and_spreads_as_quadrature_says_wherever_the_seam_is() {
    for (a, d) in [(0.2, 0.3), (0.9, 0.15), (1.4, 0.1), (0.5, 2.0)] {
        let (velocity, diffusion, density) = exact(a, d);
        for shift in [0.0, 1.0, 2.9] {
            let axes = vec![Axis::fourier(-PI, PI, 40).unwrap()];
            let (found, report) = solved(&washboard(shift, d), a, axes);
            let (v, v_error) = known(&report, "velocity_theta");
            let (s, s_error) = known(&report, "diffusion_theta");
            assert!(
                (v - velocity).abs() < 1e-9,
                "{a} {d} {shift}: {v} {velocity}"
            );
            assert!(
                (v - velocity).abs() < v_error + 1e-9 && v_error < 1e-6,
                "{a} {d} {shift}: {v} {velocity} {v_error:e}"
            );
            assert!(
                (s - diffusion).abs() < 1e-8,
                "{a} {d} {shift}: {s} {diffusion}"
            );
            assert!(
                (s - diffusion).abs() < s_error + 1e-8 && s_error < 1e-5,
                "{a} {d} {shift}: {s} {diffusion} {s_error:e}"
            );
            assert_eq!(report.measure("mean_theta"), None);
            let axis = &found[0].axes[0];
            assert!(axis.is_closed() && axis.count() == 120);
            for (bin, value) in found[0].values.iter().enumerate() {
                // Between the points of the quadrature.
                let at = |k: f64| {
                    let x = axis.edges()[bin] + k * axis.width(bin) - shift;
                    let place = x.rem_euclid(TAU) / TAU * STEPS as f64;
                    let low = place.floor();
                    let share = place - low;
                    let node = |k: i64| density[(low as i64 + k).rem_euclid(STEPS as i64) as usize];
                    // Cubic between the points.
                    let p = [node(-1), node(0), node(1), node(2)];
                    p[1] + 0.5
                        * share
                        * (p[2] - p[0]
                            + share
                                * (2.0 * p[0] - 5.0 * p[1] + 4.0 * p[2] - p[3]
                                    + share * (3.0 * (p[1] - p[2]) + p[3] - p[0])))
                };
                let mean = (at(0.0) + 4.0 * at(0.5) + at(1.0)) / 6.0;
                assert!(
                    (value - mean).abs() < 2e-5,
                    "{a} {d} {shift} {bin}: {value} {mean}"
                );
            }
        }
    }
}

#[test]
fn few_harmonics_say_so() {
    for (harmonics, a, d) in [(5, 0.9, 0.15), (6, 1.4, 0.1), (8, 0.5, 0.1), (10, 0.2, 0.1)] {
        let (velocity, diffusion, _) = exact(a, d);
        let axes = vec![Axis::fourier(-PI, PI, harmonics).unwrap()];
        let (_, report) = solved(&washboard(0.4, d), a, axes);
        for (name, exact) in [("velocity_theta", velocity), ("diffusion_theta", diffusion)] {
            let (value, error) = known(&report, name);
            let off = (value - exact).abs();
            assert!(
                off < error,
                "{name} {harmonics} {a} {d}: {value} {exact} {error:e}"
            );
        }
    }
}

#[test]
fn noise_that_depends_on_the_angle_spreads_it_by_its_harmonic_mean() {
    // Without force, by Stratonovich's reading, Θ is a monotonic function of a Wiener process: y = ∫ dθ/b
    // has unit diffusion ½, a turn of θ is ∮ dθ/b of y, and so D = ½ (2π / ∮ dθ/b)²; ∮ dθ/(1 + c cos θ) = 2π/√(1 - c²).
    let model = TypedModel::new("free", "Free rotation", ["theta"])
        .with_equation("theta", "0")
        .with_noise("theta", ["1 + A cos(theta)"])
        .with_interpretation(Interpretation::Stratonovich)
        .with_angle("theta", TAU)
        .with_parameters(["A"])
        .build()
        .unwrap();
    let (_, report) = solved(&model, 0.6, vec![Axis::fourier(-PI, PI, 40).unwrap()]);
    let (v, _) = known(&report, "velocity_theta");
    let (s, error) = known(&report, "diffusion_theta");
    assert!(v.abs() < 1e-10, "{v}");
    assert!(
        (s - 0.5 * (1.0 - 0.36)).abs() < 1e-9 && error < 1e-6,
        "{s} {error:e}"
    );
}

/// Torques, and mean velocities of [`driven_rotor`] by a product of Hermite and Fourier modes, 40 × 25, of another
/// program.
const ROTOR_VELOCITIES: [(f64, f64); 3] = [(0.0, 0.0), (0.5, 0.328_288_1), (1.0, 1.694_755_1)];

fn driven_rotor() -> Arc<Model> {
    TypedModel::new("rotor", "Rotor", ["theta", "y"])
        .with_equation("theta", "y")
        .with_equation("y", "-0.5 y - sin(theta) + A")
        .with_noise("y", ["sqrt(0.6)"])
        .with_angle("theta", TAU)
        .with_parameters(["A"])
        .build()
        .unwrap()
}

#[test]
fn a_rotor_without_torque_spreads_evenly_and_a_driven_one_turns_as_known() {
    let model = driven_rotor();
    for (torque, velocity) in ROTOR_VELOCITIES {
        let axes = vec![
            Axis::fourier(-PI, PI, 12).unwrap(),
            Axis::uniform(-5.5, 7.5, 90).unwrap(),
        ];
        let (_, report) = solved(&model, torque, axes);
        let (v, error) = known(&report, "velocity_theta");
        assert!((v - velocity).abs() < 3e-6, "{torque}: {v}");
        assert!(
            (v - velocity).abs() < error + 1e-7,
            "{torque}: {v} {error:e}"
        );
        let (s, error) = known(&report, "diffusion_theta");
        assert!(s > 0.0 && error < 0.01 * s, "{torque}: {s} {error:e}");
    }
}

#[test]
fn a_free_rotor_has_einsteins_diffusion_and_terminal_velocity() {
    // y' = -g y + A + √(2 g T) ξ: V = A/g, D = T/g, whatever the angle.
    let model = TypedModel::new("rotor", "Rotor", ["theta", "y"])
        .with_equation("theta", "y")
        .with_equation("y", "-0.5 y + A")
        .with_noise("y", ["sqrt(0.6)"])
        .with_angle("theta", 1.0)
        .with_parameters(["A"])
        .build()
        .unwrap();
    let axes = vec![
        Axis::fourier(-0.5, 0.5, 3).unwrap(),
        Axis::uniform(-5.0, 6.0, 80).unwrap(),
    ];
    let (_, report) = solved(&model, 0.4, axes);
    let (v, v_error) = known(&report, "velocity_theta");
    let (s, s_error) = known(&report, "diffusion_theta");
    assert!(
        (v - 0.8).abs() < v_error + 1e-9 && v_error < 1e-3,
        "{v} {v_error:e}"
    );
    assert!(
        (s - 1.2).abs() < s_error + 1e-9 && s_error < 1e-2,
        "{s} {s_error:e}"
    );
}

#[test]
fn means_of_a_rotor_with_few_harmonics_have_an_error_of_these() {
    let model = driven_rotor();
    // The mean of the velocity is that of the angle.
    for (torque, velocity) in &ROTOR_VELOCITIES[1..] {
        for harmonics in [6, 8] {
            let axes = vec![
                Axis::fourier(-PI, PI, harmonics).unwrap(),
                Axis::uniform(-5.5, 7.5, 90).unwrap(),
            ];
            let (_, report) = solved(&model, *torque, axes);
            let (mean, error) = known(&report, "mean_y");
            assert!(
                (mean - velocity).abs() < error + 1e-7,
                "{torque}, {harmonics}: {mean} {error:e}"
            );
        }
    }
}
