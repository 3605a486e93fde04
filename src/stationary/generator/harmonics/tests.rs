//! Factors harmonic by harmonic against those of all nodes together, on forced oscillators.

use sprs::CsMat;

use crate::generator::{Generator, GeneratorOptions, assemble};
use crate::space::{Axis, CellSpace};
use crate::stationary::generator::tests::{
    assert_adjoint, assert_same_bits, difference_of_answers, distance, solve,
};
use crate::stationary::generator::{RateMethod, estimate};
use crate::system::TypedModel;

/// An oscillator y' = -g y + force + F cos(w t) with noise: force, ends of x and y, g, temperature, F, w.
type Case = (&'static str, [f64; 2], [f64; 4]);

/// Driven to a fifth of its standard deviation, and to twice it.
const WEAK: Case = ("-x", [4.5, 4.5], [0.5, 0.5, 0.1, 0.7]);
const STRONG: Case = ("-x", [4.5, 4.5], [0.5, 0.5, 0.8, 0.7]);
/// Two wells, of which the forcing lifts one and the other in turn.
const WELLS: Case = ("x - x^3", [2.2, 2.2], [0.3, 0.12, 0.2, 0.3]);
/// Near its resonance, driven to six deviations of its density.
const RESONANT: Case = ("-x - x^3", [2.2, 2.8], [0.1, 0.1, 0.25, 1.3]);

/// Cells along x and y, and harmonics of the phase.
fn space((_, reach, _): Case, cells: usize, harmonics: usize) -> CellSpace {
    let axis = |reach: f64| Axis::uniform(-reach, reach, cells).unwrap();
    let phase = Axis::fourier(0.0, 1.0, harmonics).unwrap();
    CellSpace::new(vec![axis(reach[0]), axis(reach[1]), phase]).unwrap()
}

fn generator(space: &CellSpace, (force, _, [g, t, f, w]): Case) -> Generator {
    let model = TypedModel::new("forced", "Forced", ["x", "y"])
        .with_equation("x", "y")
        .with_equation("y", format!("-g y + {force} + F cos(w t)"))
        .with_noise("y", ["sqrt(2 g T)"])
        .with_parameters(["g", "T", "F", "w"])
        .build()
        .unwrap();
    let values = [("g", g), ("T", t), ("F", f), ("w", w)];
    let system = model.system_with(&values).unwrap();
    assemble(&*system, space, &GeneratorOptions::default()).unwrap()
}

#[test]
fn all_harmonics_together_and_each_by_itself_have_the_same_steady_state() {
    // The stronger the forcing is against the spread, the more iterations.
    for (case, most) in [(WEAK, 20), (STRONG, 50), (WELLS, 70), (RESONANT, 170)] {
        for harmonics in [1, 4, 5] {
            let space = space(case, 16, harmonics);
            let generator = generator(&space, case);
            let whole = solve(&space, &generator, RateMethod::Lu);
            let each = solve(&space, &generator, RateMethod::Modewise);
            let error = distance(&whole.mass, &each.mass);
            assert!(error < 1e-8, "{case:?} {harmonics}: {error:e}");
            let iterations = each.info.iterations;
            assert!(iterations <= most, "{case:?} {harmonics}: {iterations}");
        }
    }
}

#[test]
fn without_a_forcing_the_average_is_the_whole_generator() {
    let (force, reach, [g, t, _, w]) = WEAK;
    let case = (force, reach, [g, t, 0.0, w]);
    let space = space(case, 20, 4);
    let generator = generator(&space, case);
    let each = solve(&space, &generator, RateMethod::Modewise);
    // What is left is the rounding of factors in single precision.
    assert!(each.info.iterations <= 6, "{:?}", each.info);
}

#[test]
fn answers_to_changes_are_the_same_and_the_transposed_factors_their_adjoint() {
    let space = space(STRONG, 16, 4);
    let ours = generator(&space, STRONG);
    let (force, reach, [g, t, f, w]) = STRONG;
    let other = generator(&space, (force, reach, [g, t, 1.0001 * f, w]));
    let change: CsMat<f64> = (&other.matrix - &ours.matrix).map(|rate| 1e4 * rate);
    let error = difference_of_answers(&space, &ours, &change);
    assert!(error < 1e-6, "{error:e}");
    for method in [RateMethod::Lu, RateMethod::LuSingle, RateMethod::Modewise] {
        assert_adjoint(&space, &ours, method);
    }
}

#[test]
fn one_thread_and_two_give_the_same_bits() {
    let space = space(STRONG, 24, 4);
    assert_same_bits(&space, &generator(&space, STRONG));
}

#[test]
fn harmonics_of_a_forced_oscillator_are_taken_one_by_one_and_of_one_axis_together() {
    let method = |space: &CellSpace| {
        let reach = vec![3; space.dimension() - 1];
        let reach = [reach, vec![16]].concat();
        estimate(space, &reach, 8 << 30, None).unwrap()
    };
    let oscillator = method(&space(WEAK, 100, 8));
    assert_eq!(oscillator.method, RateMethod::Modewise);
    let line = Axis::uniform(-2.0, 2.0, 160).unwrap();
    let phase = Axis::fourier(0.0, 1.0, 8).unwrap();
    let line = method(&CellSpace::new(vec![line, phase]).unwrap());
    assert_ne!(line.method, RateMethod::Modewise);
    // A plane's own factors, in single precision, for every node of the phase.
    let plane = CellSpace::new(space(WEAK, 100, 8).axes()[..2].to_vec()).unwrap();
    let plane = estimate(&plane, &[3, 3], 8 << 30, Some(RateMethod::LuSingle)).unwrap();
    assert!(oscillator.factor_bytes < 18 * plane.factor_bytes);
}
