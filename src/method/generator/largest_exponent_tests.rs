//! Exponents along densities against closed forms and trajectories.

use std::sync::Arc;

use super::largest_exponent::Angles;
use crate::cancellation::Cancellation;
use crate::exponent::{Exponent, largest};
use crate::method::GeneratorMethodOptions;
use crate::monte_carlo::{TangentRun, exponent_along_trajectories, relaxation};
use crate::sampling::{NormalStream, StreamKey};
use crate::space::{Axis, CellSpace};
use crate::system::{
    ExponentMethod, Family, Interpretation, LANES, Lanes, Path, System, TypedModel,
};

/// Equations of x and y, and pairs of an axis and the amplitude of a noise on it.
type Typed<'a> = ([&'a str; 2], &'a [(&'a str, &'a str)]);

/// A family in Itô's reading whose parameter is called `p`.
fn family(([x, y], noises): Typed<'_>, (from, to): (f64, f64)) -> Family {
    let mut model = TypedModel::new("own", "own", ["x", "y"])
        .with_equation("x", x)
        .with_equation("y", y)
        .with_interpretation(Interpretation::Ito)
        .with_parameters(["p"]);
    for (axis, amplitude) in noises {
        model = model.with_noise(*axis, [*amplitude]);
    }
    Family::new(model.build().unwrap(), &[], Path::parameter("p", from, to)).unwrap()
}

/// The exponent by harmonics of the angle, on so many cells of a box.
fn by_angles(typed: Typed<'_>, p: f64, ends: [f64; 2], cells: usize) -> Option<Exponent> {
    let family = family(typed, (p, p));
    let system = family.at(p).unwrap();
    let tangent = family
        .tangent(p, &system, (&ends, ExponentMethod::Modes))
        .unwrap();
    let axes = ends.map(|end| Axis::uniform(-end, end, cells).unwrap());
    let angles = Angles {
        tangent,
        options: &GeneratorMethodOptions::default(),
        cancellation: &Cancellation::new(),
    };
    angles
        .exponent(&CellSpace::new(axes.to_vec()).unwrap())
        .unwrap()
}

/// The exponent by pairs of neighbouring paths, and its standard error. No derivative of a formula is used.
fn by_paths(typed: Typed<'_>, p: f64, (dt, steps): (f64, usize)) -> (f64, f64) {
    const APART: f64 = 1e-6;
    let system = family(typed, (p, p)).at(p).unwrap();
    let mut normals = NormalStream::new(StreamKey {
        seed: 7,
        cell: 0,
        block: 0,
    });
    let mut one = [[0.1; LANES]; 2];
    let mut other = [[0.1 + APART; LANES], [0.1; LANES]];
    let mut sums = [0.0; LANES];
    for step in 0..steps {
        let mut kicks = vec![[0.0; LANES]; system.noises().len()];
        normals.fill(&mut kicks);
        kicks
            .iter_mut()
            .flatten()
            .for_each(|kick| *kick *= dt.sqrt());
        for path in [&mut one, &mut other] {
            *path = heun(&system, path, &kicks, dt);
        }
        for lane in 0..LANES {
            let apart = [0, 1].map(|axis| other[axis][lane] - one[axis][lane]);
            let ratio = apart[0].hypot(apart[1]) / APART;
            for axis in 0..2 {
                other[axis][lane] = one[axis][lane] + apart[axis] / ratio;
            }
            if 10 * step >= steps {
                sums[lane] += ratio.ln();
            }
        }
    }
    let time = 0.9 * dt * steps as f64;
    let mean = sums.iter().sum::<f64>() / LANES as f64 / time;
    let squares = sums
        .iter()
        .map(|sum| (sum / time - mean).powi(2))
        .sum::<f64>();
    (mean, (squares / (LANES * (LANES - 1)) as f64).sqrt())
}

/// A step of Heun's method in the drift; the noise is taken at its beginning, as Itô's reading wants it.
fn heun(system: &Arc<dyn System>, at: &[Lanes; 2], kicks: &[Lanes], dt: f64) -> [Lanes; 2] {
    let mut added = [[0.0; LANES]; 2];
    for (noise, kick) in system.noises().iter().zip(kicks) {
        let amplitudes = noise.amplitudes(0.0, at);
        for lane in 0..LANES {
            added[noise.axis][lane] += amplitudes[lane] * kick[lane];
        }
    }
    let (mut first, mut second) = ([[0.0; LANES]; 2], [[0.0; LANES]; 2]);
    system.drift(0.0, at, &mut first);
    let sum = |axis: usize, slopes: &[Lanes; 2], share: f64| -> Lanes {
        std::array::from_fn(|lane| {
            at[axis][lane] + added[axis][lane] + share * dt * slopes[axis][lane]
        })
    };
    let ahead = [sum(0, &first, 1.0), sum(1, &first, 1.0)];
    system.drift(0.0, &ahead, &mut second);
    let both =
        [0, 1].map(|axis| std::array::from_fn(|lane| first[axis][lane] + second[axis][lane]));
    [sum(0, &both, 0.5), sum(1, &both, 0.5)]
}

/// Holds an exponent against another value that is known to an error.
fn assert_near(found: Option<Exponent>, (value, error): (f64, f64), most: f64) {
    let found = found.unwrap();
    let off = (found.value - value).abs();
    assert!(
        off <= found.error + error && found.error <= most,
        "{} ± {} for {value} ± {error}",
        found.value,
        found.error
    );
}

#[test]
fn oscillators_of_constant_derivatives_have_the_exponent_of_the_linear_equation_whatever_their_density()
 {
    // Damping alone: all solutions decay like e^{-ζt}.
    let linear: Typed<'_> = (["y", "-x - 0.4*y"], &[("y", "p")]);
    assert_near(by_angles(linear, 0.5, [3.4, 3.4], 28), (-0.2, 1e-9), 1e-5);
    // Noise in the stiffness, beside additive noise that keeps the density wide. Its tails are heavy: about 2e-3 of the
    // mass leaves the box per unit time, which is most of the stated error.
    let typed: Typed<'_> = (["y", "-x - 0.1*y"], &[("y", "p*x"), ("y", "0.3")]);
    let family = family(typed, (0.4, 0.4));
    let system = family.at(0.4).unwrap();
    let tangent = family
        .tangent(0.4, &system, (&[1.0, 1.0], ExponentMethod::Modes))
        .unwrap();
    let exact = largest(&tangent.linear().unwrap()).unwrap();
    let found = by_angles(typed, 0.4, [4.5, 4.5], 32);
    assert_near(found, (exact.value, 1e-12), 5e-3);
}

#[test]
fn exponents_along_densities_are_those_of_neighbouring_paths() {
    // Duffing and van der Pol: -0.16283 by another program.
    let cubic: Typed<'_> = (["y", "-x + p*y - x^3 - x^2*y"], &[("y", "0.4")]);
    assert_near(
        by_angles(cubic, -0.2, [2.2, 2.2], 48),
        (-0.16283, 5e-5),
        1e-3,
    );
    // With noise in the stiffness too; and the normal form of Hopf with shear.
    let parametric: Typed<'_> = (cubic.0, &[("y", "0.5*x"), ("y", "0.2")]);
    let shear: Typed<'_> = (
        ["x - (x^2+y^2)*(x - p*y)", "y - (x^2+y^2)*(y + p*x)"],
        &[("x", "1"), ("y", "1")],
    );
    for (typed, p, end, step) in [(parametric, -0.1, 2.4, 0.02), (shear, 1.0, 2.3, 0.01)] {
        let (value, deviation) = by_paths(typed, p, (step, 30_000));
        let found = by_angles(typed, p, [end; 2], 40);
        assert_near(found, (value, 3.0 * deviation + 0.01 * value.abs()), 0.05);
    }
}

/// Noise at the temperature a half; nothing blurs the angle beside the saddle.
#[test]
fn a_chaotic_double_well_has_the_exponent_of_neighbouring_paths() {
    assert_double_well(0.3, 25_000, 40);
}

#[test]
#[ignore = "a minute: longer paths, and weaker than chaos too"]
fn a_double_well_has_the_exponent_of_neighbouring_paths_on_either_side_of_chaos_at_length() {
    for damping in [0.3, 0.8] {
        assert_double_well(damping, 100_000, 48);
    }
}

fn assert_double_well(damping: f64, steps: usize, cells: usize) {
    let drift = format!("x - x^3 - {damping}*y");
    let amplitude = format!("{}", damping.sqrt());
    let noises = [("y", amplitude.as_str())];
    let typed: Typed<'_> = (["y", &drift], &noises);
    let (value, deviation) = by_paths(typed, 0.0, (0.01, steps));
    let found = by_angles(typed, 0.0, [2.7, 3.6], cells);
    assert_near(found, (value, 3.0 * deviation), 5e-3);
}

/// An oscillator with random coefficients, and a box about it.
fn random(number: u64) -> (String, [String; 2], [f64; 2]) {
    let unit = |place: u64| crate::sampling::unit(crate::sampling::mix(97 * number + place));
    let between = |place: u64, low: f64, high: f64| low + (high - low) * unit(place);
    let (stiffness, cubic) = (between(1, -1.0, 1.0), between(2, 0.5, 1.0));
    let (damping, more) = (between(3, 0.2, 1.0), between(4, 0.0, 1.0));
    let (additive, parametric) = (between(5, 0.4, 1.0), between(6, -0.3, 0.3).max(0.0));
    let heat = (additive.powi(2) + 2.0 * parametric.powi(2)) / (2.0 * damping);
    // Where the potential is twelve times the heat above its lowest.
    let lowest = stiffness.min(0.0).powi(2) / (4.0 * cubic);
    let square = (-stiffness
        + (stiffness.powi(2) + 4.0 * cubic * (12.0 * heat - lowest))
            .max(0.0)
            .sqrt())
        / cubic;
    (
        format!("-{stiffness}*x - {cubic}*x^3 - {damping}*y - {more}*x^2*y").replace("--", "+"),
        [format!("{additive}"), format!("{parametric}*x")],
        [square.max(1.0).sqrt(), (24.0 * heat).sqrt()],
    )
}

/// No exponent contradicts the one of paths beyond both errors, and most are known.
#[test]
#[ignore = "takes minutes"]
fn exponents_of_random_oscillators_are_not_contradicted_by_paths() {
    let mut unknown = 0;
    for number in 0..20 {
        let (drift, [additive, parametric], ends) = random(number);
        let noises = [("y", additive.as_str()), ("y", parametric.as_str())];
        let typed: Typed<'_> = (["y", &drift], &noises);
        let Some(found) = by_angles(typed, 0.0, ends, 48) else {
            unknown += 1;
            continue;
        };
        let (value, deviation) = by_paths(typed, 0.0, (0.01, 60_000));
        let error = found.error + 4.0 * deviation + 2e-3 * value.abs();
        assert!(
            (found.value - value).abs() <= error,
            "{number}: {} ± {} for {value} ± {deviation}: {drift}",
            found.value,
            found.error
        );
    }
    assert!(unknown <= 5, "{unknown}");
}

/// The exponent by small deviations from trajectories of so many steps.
fn by_trajectories(typed: Typed<'_>, ends: [f64; 2], steps: f64) -> Exponent {
    let (family, never) = (family(typed, (0.0, 0.0)), Cancellation::new());
    let system = family.at(0.0).unwrap();
    let by = ExponentMethod::Trajectories;
    let tangent = family.tangent(0.0, &system, (&[1.0, 1.0], by)).unwrap();
    let axes = ends.map(|end| Axis::uniform(-end, end, 24).unwrap());
    let space = CellSpace::new(axes.to_vec()).unwrap();
    let relaxed = relaxation(system.as_ref(), &space, 3, &never).unwrap();
    let run = TangentRun::of_steps(steps, &relaxed, 3);
    let both = (system.as_ref(), &tangent);
    let starts = relaxed.settled_states();
    let found = exponent_along_trajectories(both, &space, starts, &run, &never);
    let [exponent, _] = found.unwrap().unwrap();
    Exponent {
        value: exponent.value,
        error: exponent.error(),
    }
}

/// Exponents of some random oscillators by modes, where they are told, and by trajectories, each within both errors.
fn assert_agreement(numbers: std::ops::Range<u64>, cells: usize, steps: f64) {
    for number in numbers {
        let (drift, [additive, parametric], ends) = random(number);
        let noises = [("y", additive.as_str()), ("y", parametric.as_str())];
        let typed: Typed<'_> = (["y", &drift], &noises);
        let followed = by_trajectories(typed, ends, steps);
        let size = followed.value.abs().max(0.1);
        assert!(followed.error < 0.3 * size, "{number}: {followed:?}");
        if let Some(found) = by_angles(typed, 0.0, ends, cells) {
            let off = (found.value - followed.value).abs();
            assert!(
                off <= found.error + followed.error,
                "{number}: {found:?} by modes, {followed:?} by trajectories: {drift}"
            );
        }
    }
}

#[test]
fn modes_and_trajectories_agree_within_their_errors() {
    assert_agreement(0..1, 32, 3e6);
}

#[test]
#[ignore = "takes minutes"]
fn modes_and_trajectories_agree_on_more_random_oscillators_at_length() {
    assert_agreement(20..24, 48, 2e7);
}

/// The middle of the range is a state of rest that nothing leaves, and whose own exponent is above zero (L. Arnold,
/// Random Dynamical Systems, chapter 9: noise on the stiffness alone): paths from there would tell that one.
#[test]
fn paths_do_not_start_where_nothing_moves() {
    let noises = [("y", "0.5 x")];
    let typed: Typed<'_> = (["y", "-x + 0.3 y - x^3 - x^2 y"], &noises);
    let ends = [2.5, 3.5];
    let followed = by_trajectories(typed, ends, 3e6);
    let found = by_angles(typed, 0.0, ends, 32).unwrap();
    assert!(followed.value + followed.error < 0.0, "{followed:?}");
    let off = (found.value - followed.value).abs();
    assert!(
        off <= found.error + followed.error,
        "{found:?} by modes, {followed:?} by trajectories"
    );
}
