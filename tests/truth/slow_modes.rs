//! Decay rates and frequencies of slow modes against closed forms and another discretisation.

use std::sync::Arc;

use pbif::cancellation::Cancellation;
use pbif::generator::GeneratorOptions;
use pbif::spectrum::{SlowModes, Steady, slow_modes};
use pbif::stationary::generator::RateOptions;
use pbif::system::Model;

use crate::common::numbers::{Numbers, given};
use crate::common::room::Room;
use crate::common::steady::{even_cells, masses, model, random_linear};

/// The slowest modes of a model on even cells.
fn modes(model: &Arc<Model>, axes: &[(f64, f64, usize)], wanted: usize) -> SlowModes {
    let (system, space) = (model.system_with(&[]).unwrap(), even_cells(axes));
    let steady = Steady {
        masses: &masses(&*system, &space),
        closed: &vec![[false; 2]; axes.len()],
        phase: None,
    };
    let settings = (&GeneratorOptions::default(), &RateOptions::default());
    let never = Cancellation::new();
    slow_modes(&system, &space, wanted, steady, settings, &never).unwrap()
}

/// Whether each mode is an exact one, decay rate and frequency, each another one, within its error, which must be
/// small; and whether none of those is missing that are as slow and oscillate no faster than `fastest`.
#[track_caller]
fn hold(
    what: &str,
    found: &SlowModes,
    exact: &[(f64, f64)],
    (largest, fastest): (f64, f64),
) -> f64 {
    println!("{what}: {:?}", found.work);
    let mut left: Vec<(f64, f64)> = exact.to_vec();
    let mut worst = 0.0f64;
    for mode in &found.modes {
        let away = |(decay, frequency): &(f64, f64)| {
            (mode.decay.0 - decay).hypot(mode.frequency.0 - frequency)
        };
        let nearest = (0..left.len()).min_by(|&a, &b| away(&left[a]).total_cmp(&away(&left[b])));
        let (decay, frequency) = left.remove(nearest.unwrap());
        let size = decay.hypot(frequency);
        let off = ((mode.decay.0 - decay) / mode.decay.1).abs();
        let other = match mode.frequency.1 {
            0.0 => (mode.frequency.0 - frequency).abs() / (1e-9 * size),
            error => ((mode.frequency.0 - frequency) / error).abs(),
        };
        println!(
            "  {:.9} ± {:.1e} ({off:.2}), {:.9} ± {:.1e} ({other:.2}); exact {decay:.9}, {frequency:.9}",
            mode.decay.0, mode.decay.1, mode.frequency.0, mode.frequency.1
        );
        worst = worst.max(off).max(other);
        assert!(mode.decay.1 <= largest * size, "{what}: {mode:?}");
    }
    let slowest = found
        .modes
        .last()
        .map_or(0.0, |mode| mode.decay.0 - mode.decay.1);
    let missing = left
        .iter()
        .find(|(decay, frequency)| *decay < 0.999 * slowest && *frequency < fastest);
    assert_eq!(missing, None, "{what}: {found:?}");
    assert!(worst <= 1.0, "{what}");
    worst
}

#[test]
fn a_linear_state_has_the_multiples_of_its_rate() {
    let model = model(&[("x", "-0.7 x")], &[("x", "0.5")]);
    let spread = 0.5 / 1.4f64.sqrt();
    let found = modes(&model, &[(-6.0 * spread, 6.0 * spread, 120)], 4);
    let exact = [0.7, 1.4, 2.1, 2.8].map(|rate| (rate, 0.0));
    assert_eq!(found.modes.len(), 4);
    hold("linear", &found, &exact, (1e-3, 1.0));
}

/// Sums n₁λ₁ + n₂λ₂ of the eigenvalues of a stable matrix, the slowest first, pairs once.
fn sums([a, b, c, d]: [f64; 4], wanted: usize) -> Vec<(f64, f64)> {
    let (trace, determinant) = (a + d, a * d - b * c);
    let discriminant = 0.25 * trace * trace - determinant;
    let root = discriminant.abs().sqrt();
    let mut all = Vec::new();
    for first in 0..40 {
        for second in 0..40 {
            let (n, m) = (f64::from(first), f64::from(second));
            if first + second == 0 {
                continue;
            }
            let (rate, frequency) = match discriminant < 0.0 {
                true => (-0.5 * trace * (n + m), (n - m) * root),
                false => (-(0.5 * trace + root) * n - (0.5 * trace - root) * m, 0.0),
            };
            if frequency >= 0.0 {
                all.push((rate, frequency));
            }
        }
    }
    all.sort_by(|a, b| {
        (a.0 * (1.0 + 1e-9))
            .total_cmp(&b.0)
            .then(a.1.total_cmp(&b.1))
    });
    all.sort_by(|a, b| {
        let is_same = (a.0 - b.0).abs() < 1e-9 * a.0;
        if is_same {
            a.1.total_cmp(&b.1)
        } else {
            a.0.total_cmp(&b.0)
        }
    });
    all.truncate(wanted);
    all
}

#[test]
fn an_oscillator_has_the_sums_of_its_two() {
    for damping in [0.2_f64, 0.05] {
        let drift = format!("-x - {} y", 2.0 * damping);
        let model = model(&[("x", "y"), ("y", &drift)], &[("y", "0.4")]);
        let spread = 0.4 / (4.0 * damping).sqrt();
        let axis = (-6.0 * spread, 6.0 * spread, 80);
        let found = modes(&model, &[axis, axis], 6);
        assert_eq!(found.modes.len(), 6);
        let exact = sums([0.0, 1.0, -1.0, -2.0 * damping], 40);
        hold(&format!("damping {damping}"), &found, &exact, (5e-2, 2.5));
    }
}

/// Rows of modes stand so near to each other that a model at a real shift tells none of them.
#[test]
fn a_lightly_damped_oscillator_has_the_sums_of_its_two() {
    for damping in [0.01_f64, 0.003] {
        let drift = format!("-x - {} y", 2.0 * damping);
        let model = model(&[("x", "y"), ("y", &drift)], &[("y", "0.1")]);
        let spread = 0.1 / (4.0 * damping).sqrt();
        let axis = (-6.0 * spread, 6.0 * spread, 100);
        let found = modes(&model, &[axis, axis], 4);
        assert_eq!(found.modes.len(), 4);
        let exact = sums([0.0, 1.0, -1.0, -2.0 * damping], 40);
        hold(&format!("damping {damping}"), &found, &exact, (5e-2, 3.5));
        assert!(found.work.factorisations <= 20, "{:?}", found.work);
        assert!(found.work.passes <= 600, "{:?}", found.work);
    }
}

const DAMPED: &str = r#"
[system.equations]
x = "y"
y = "-x - 2 zeta y"
[system.noise]
y = "0.4"
[system.parameters]
zeta = 1.0
[cells]
x = { from = -1.6, to = 1.6, count = 36 }
y = { from = -1.6, to = 1.6, count = 36 }
[sweep]
parameter = "zeta"
from = 0.945
to = 1.055
points = 6
[locate]
tolerance = 2e-4
[relaxation]
modes = 2
"#;

/// At critical damping neither of the two modes is known well, and their discriminant is.
#[test]
fn the_damping_at_which_two_modes_become_a_pair_is_located() {
    let room = Room::new();
    room.write("damped.toml", DAMPED);
    room.solved("sweep damped.toml --out run --quiet figures.draw=[]");
    let row = &room.table("run/bifurcations.csv").0[1];
    assert_eq!(row.texts(["label", "status"]), ["SB1", "located"]);
    let [value, error] = ["value", "error"].map(|column| row.number(column));
    assert!(
        (value - 1.0).abs() <= error && error < 1e-3,
        "{value} ± {error}"
    );
}

/// The least eigenvalues above zero of dx = -U'(x) dt + √(2D) dW by a chain of states with rates that keep detailed
/// balance, to second order in their distance, counted by the signs of a symmetric matrix (Sturm).
fn of_chain(
    potential: impl Fn(f64) -> f64,
    diffusion: f64,
    (from, to): (f64, f64),
    count: usize,
    wanted: usize,
) -> Vec<f64> {
    let step = (to - from) / count as f64;
    let at = |place: f64| potential(from + step * place);
    let rate =
        |a: f64, b: f64| diffusion / step.powi(2) * (0.5 * (at(a) - at(b)) / diffusion).exp();
    let mut diagonal = vec![0.0; count];
    let mut beside = Vec::new();
    for state in 0..count - 1 {
        let (own, next) = (state as f64 + 0.5, state as f64 + 1.5);
        let (up, down) = (rate(own, next), rate(next, own));
        diagonal[state] += up;
        diagonal[state + 1] += down;
        beside.push(up * down);
    }
    let below = |value: f64| {
        let mut pivot = diagonal[0] - value;
        let mut signs = usize::from(pivot < 0.0);
        for state in 1..count {
            pivot = diagonal[state] - value - beside[state - 1] / pivot;
            signs += usize::from(pivot < 0.0);
        }
        signs
    };
    let one = |number: usize| {
        let (mut low, mut high) = (0.0, 1e6);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if below(middle) > number {
                high = middle
            } else {
                low = middle
            }
        }
        0.5 * (low + high)
    };
    (1..=wanted).map(one).collect()
}

#[test]
fn a_double_well_has_a_slow_mode() {
    for noise in [0.5f64, 0.35, 0.25] {
        let model = model(&[("x", "x - x^3")], &[("x", &noise.to_string())]);
        let found = modes(&model, &[(-2.2, 2.2, 160)], 4);
        let potential = |x: f64| 0.25 * x.powi(4) - 0.5 * x * x;
        let of = |count| of_chain(potential, 0.5 * noise * noise, (-2.2, 2.2), count, 4);
        let pairs = of(2000).into_iter().zip(of(4000));
        let exact: Vec<(f64, f64)> = pairs.map(|(a, b)| ((4.0 * b - a) / 3.0, 0.0)).collect();
        assert_eq!(found.modes.len(), 4);
        hold(&format!("noise {noise}"), &found, &exact, (1e-2, 1.0));
    }
}

#[test]
fn errors_hold_on_random_linear_systems() {
    let (count, seed) = (given("PBIF_RANDOM_SYSTEMS", 6), given("PBIF_FUZZ_SEED", 1));
    let mut numbers = Numbers(seed);
    let (mut worst, mut all, mut asked) = (0.0f64, 0, 0);
    for system in 0..count {
        let Some(linear) = random_linear(&mut numbers, system, 60) else {
            continue;
        };
        let matrix = linear.matrix;
        let found = modes(&linear.model, &linear.axes, 5);
        let known = found.modes.len();
        // Where both eigenvalues almost coincide, modes of higher order are hardly known.
        assert!(known > 0, "{matrix:?}: {found:?}");
        all += known;
        let exact = sums(matrix, 80);
        let fastest = 2.0 * (matrix[0] * matrix[3] - matrix[1] * matrix[2]).sqrt();
        asked += 5;
        worst = worst.max(hold(
            &format!("{matrix:?} {:?}", linear.amplitudes),
            &found,
            &exact,
            (0.1, fastest),
        ));
    }
    println!("{all} of {asked} modes, off by at most {worst:.2} of the error");
    assert!(10 * all > 8 * asked);
}

/// A random oscillator with one well or two and a box about it: drift of the velocity, amplitude of its noise, ends.
fn random_oscillator(numbers: &mut Numbers) -> (String, f64, [f64; 2]) {
    let mut between =
        |from: f64, to: f64| from + (to - from) * numbers.below(1_000_000) as f64 * 1e-6;
    let (stiffness, cubic) = (between(-1.0, 1.5), between(0.3, 1.0));
    let (damping, more, heat) = (between(0.1, 1.5), between(0.0, 0.6), between(0.15, 0.6));
    // Where the potential is sixteen times the heat above its lowest.
    let lowest = -stiffness.min(0.0).powi(2) / (4.0 * cubic);
    let root = (stiffness.powi(2) + 4.0 * cubic * (16.0 * heat + lowest)).sqrt();
    let far = ((root - stiffness) / cubic).sqrt();
    (
        format!("-({stiffness}) x - {cubic} x^3 - {damping} y - {more} x^2 y"),
        (2.0 * damping * heat).sqrt(),
        [far, (32.0 * heat).sqrt()],
    )
}

/// Modes on some cells an axis have those on more within both errors.
fn assert_oscillators_hold_on_finer_cells((count, seed): (u64, u64), cells: [usize; 2]) {
    let mut numbers = Numbers(seed);
    let (mut worst, mut all) = (0.0f64, 0);
    for _ in 0..count {
        let (drift, amplitude, ends) = random_oscillator(&mut numbers);
        let model = model(
            &[("x", "y"), ("y", &drift)],
            &[("y", &amplitude.to_string())],
        );
        let of = |cells: usize| modes(&model, &ends.map(|end| (-end, end, cells)), 4).modes;
        let [coarse, fine] = cells.map(of);
        assert!(!coarse.is_empty(), "{drift}");
        for mode in &coarse {
            let gap = |other: &pbif::spectrum::SlowMode| {
                let of = |one: (f64, f64), two: (f64, f64)| {
                    (one.0 - two.0).abs() / (one.1 + two.1 + 1e-12)
                };
                of(mode.decay, other.decay).max(of(mode.frequency, other.frequency))
            };
            let nearest = fine.iter().map(gap).fold(f64::INFINITY, f64::min);
            // The slowest that are told on few cells may be more than are asked for on many.
            let is_last = fine
                .last()
                .is_none_or(|last| mode.decay.0 + mode.decay.1 >= last.decay.0);
            assert!(
                nearest <= 1.0 || is_last,
                "{drift}, {amplitude}: {mode:?} among {fine:?}"
            );
            if nearest <= 1.0 {
                (worst, all) = (worst.max(nearest), all + 1);
            }
        }
    }
    println!("{all} modes of {count} oscillators, off by at most {worst:.2} of both errors");
    assert!(all as u64 >= 2 * count);
}

#[test]
fn errors_hold_on_random_oscillators() {
    assert_oscillators_hold_on_finer_cells((1, 11), [48, 72]);
}

#[test]
#[ignore = "takes half a minute"]
fn errors_hold_on_thirty_random_oscillators_at_length() {
    assert_oscillators_hold_on_finer_cells((30, 5), [60, 110]);
}

/// The rates between two regions, there and back, of a system that asks for them in its file.
fn between(text: &str) -> [(f64, f64); 2] {
    measured(text, ["go_switching_rate", "go_return_rate"])
        .map(|found| (found.value, found.error.unwrap()))
}

/// Measures at the first value of a sweep.
fn measured<const N: usize>(text: &str, names: [&str; N]) -> [pbif::continuation::Measure; N] {
    use pbif::continuation::DensitySource;
    use pbif::method::{GeneratorMethodOptions, GeneratorSource};
    use pbif::sweep_file::SweepFile;
    let never = Cancellation::new();
    let sweep = SweepFile::parse("two.toml", text).validate();
    let sweep = sweep.unwrap_or_else(|report| panic!("{report}"));
    let sweep = sweep.prepare(&never);
    let sweep = sweep.unwrap_or_else(|report| panic!("{report}"));
    let options = GeneratorMethodOptions::default();
    let source = GeneratorSource::new(&sweep.problem, &options).unwrap();
    let from = sweep.problem.family().ends().0;
    let report = source.open(&never).solve(from).unwrap().report;
    names.map(|name| {
        let found = report.measures.iter().find(|one| one.name == name);
        found
            .unwrap_or_else(|| panic!("{name}: {:?}", report.findings))
            .clone()
    })
}

/// A tilted double well whose noise is swept from a value on.
fn tilted_well(noise: f64, more: &str) -> String {
    format!(
        r#"
[system.equations]
x = "x - x^3 + 0.1"
[system.noise]
x = "s"
[system.parameters]
s = {noise}
[sweep]
parameter = "s"
from = {noise}
to = 0.4
points = 2
[cells]
x = {{ from = -2.4, to = 2.4, count = 160 }}
{more}
"#
    )
}

#[test]
fn a_rate_of_a_deep_well_does_not_give_its_number_to_a_faster_mode() {
    // By quadrature the exchange between the wells has a rate of 4e-15 at a noise of 0.1, and far less below.
    use pbif::continuation::DensitySource;
    use pbif::method::{GeneratorMethodOptions, GeneratorSource};
    use pbif::sweep_file::SweepFile;
    let never = Cancellation::new();
    for noise in [0.06, 0.1, 0.12] {
        let text = tilted_well(noise, "[relaxation]\nmodes = 1");
        let sweep = SweepFile::parse("deep.toml", &text).validate().unwrap();
        let sweep = sweep.prepare(&never).unwrap();
        let options = GeneratorMethodOptions::default();
        let source = GeneratorSource::new(&sweep.problem, &options).unwrap();
        let report = source.open(&never).solve(noise).unwrap().report;
        let told = report
            .measures
            .iter()
            .find(|one| one.name == "decay_rate_1");
        let (value, error) = told.map(|one| (one.value, one.error.unwrap())).unwrap();
        println!("{noise}: {value:e} ± {error:e}");
        assert!(value > 0.0 && error < 1e-2 * value && (value < 1e-9 || noise > 0.1));
        assert!(
            noise != 0.1 || (value > 3.5e-15 && value < 4.5e-15),
            "{value:e}"
        );
    }
}

#[test]
fn rates_of_the_rarer_state_hold_for_regions_that_reach_beyond_the_wells() {
    // The bottoms of the wells are a measure for all others: of the rates of states a border has no part.
    for noise in [0.25, 0.3, 0.35] {
        let of = |from: &str, to: &str| {
            let go = format!(
                "[passage]\ngo = {{ from = \"{from}\", to = \"{to}\", switching = \"on\" }}"
            );
            between(&tilted_well(noise, &go))
        };
        let bottoms = of("x < -0.7", "x > 0.7");
        for (from, to) in [("x < -0.5", "x > -0.45"), ("x < -0.2", "x > -0.1")] {
            for ((value, error), (better, rest)) in of(from, to).into_iter().zip(bottoms) {
                let off = (value - better).abs();
                println!(
                    "{noise} {from}: {value:e} ± {error:.1e}, {better:e}, {:.2}",
                    off / error
                );
                assert!(
                    off < error + rest,
                    "{noise} {from}: {value:e} ± {error:e}, {better:e}"
                );
            }
        }
    }
}

/// Duffing's well, ΔV = 1/4, with damping g from 0.5 on, at a temperature, on n × n cells; passages between two
/// regions.
fn well(temperature: f64, [x, y]: [f64; 2], n: usize, [left, right]: [&str; 2]) -> String {
    format!(
        r#"
[system.equations]
x = "y"
y = "x - x^3 - g y"
[system.noise]
y = "sqrt(2 g T)"
[system.parameters]
T = {temperature}
[sweep]
parameter = "g"
from = 0.5
to = 0.6
points = 2
[cells]
x = {{ from = -{x}, to = {x}, count = {n} }}
y = {{ from = -{y}, to = {y}, count = {n} }}
[passage]
go = {{ from = "{left}", to = "{right}", switching = "on" }}
"#
    )
}

#[test]
fn formulas_for_high_barriers_are_the_gap_but_for_what_they_leave_out() {
    // What Mel'nikov and Meshkov leave out is of the order of T/ΔV.
    let off = |temperature: f64, cells: usize| {
        let names = ["go_switching_rate", "go_kramers", "go_melnikov"];
        let text = well(temperature, [2.1, 1.6], cells, ["x < -0.5", "x > 0.5"]);
        let [rate, kramers, melnikov] = measured(&text, names);
        println!("T = {temperature}: {rate:?}, Kramers {kramers:?}, Mel'nikov {melnikov:?}");
        assert_eq!((kramers.error, melnikov.error), (None, None));
        assert!(kramers.value > melnikov.value);
        let share = rate.error.unwrap() / rate.value;
        (melnikov.value / rate.value - 1.0, share)
    };
    let both = [(0.06, 72), (0.03, 96)].map(|(temperature, cells)| {
        let (change, error) = off(temperature, cells);
        let left_out = temperature / 0.25;
        assert!(change.abs() < left_out + error, "{change} {error}");
        (change, error)
    });
    let [(high, _), (low, error)] = both;
    assert!(low < 0.8 * high + error, "{both:?}");
}

#[test]
fn the_slowest_mode_alone_is_the_first_of_several() {
    let tilted = model(&[("x", "x - x^3 + 0.1")], &[("x", "0.35")]);
    let duffing = model(&[("x", "y"), ("y", "x - x^3 - y/2")], &[("y", "0.3")]);
    let on_a_line = [(-2.2, 2.4, 160)];
    let in_a_plane = [(-2.1, 2.1, 48), (-1.8, 1.8, 48)];
    for (model, axes) in [(tilted, &on_a_line[..]), (duffing, &in_a_plane[..])] {
        let [alone, several] = [0, 2].map(|wanted| modes(&model, axes, wanted));
        println!("{:?}, {:?}", alone.work, several.work);
        let [one, first] = [&alone, &several].map(|found| found.modes[0]);
        assert_eq!((alone.modes.len(), one.frequency), (1, (0.0, 0.0)));
        assert!(
            (one.decay.0 - first.decay.0).abs() < 1e-4 * first.decay.0,
            "{one:?} {first:?}"
        );
        // Iterating alone leaves 1e-5 of the rate.
        let allowed = first.decay.1 + 1e-5 * first.decay.0;
        assert!(one.decay.1 <= allowed, "{one:?} {first:?}");
        // On three grids, at two shifts each.
        assert!(alone.work.factorisations <= 6 && alone.work.passes < several.work.passes);
    }
}

/// ∫ f over a range, by the midpoint rule.
fn integral(f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    let n = 4000;
    let h = (to - from) / f64::from(n);
    (0..n).map(|k| h * f(from + (f64::from(k) + 0.5) * h)).sum()
}

#[test]
fn a_tilted_well_is_left_at_the_rate_of_the_slowest_mode() {
    let rates = between(
        r#"
[system.equations]
x = "x - x^3 + 0.1"
[system.noise]
x = "sqrt(2 D)"
[sweep]
parameter = "D"
from = 0.04
to = 0.06
points = 2
[cells]
x = { from = -2.2, to = 2.4, count = 160 }
[passage]
go = { from = "x < -0.5", to = "x > 0.5", switching = "on" }
"#,
    );
    // The mean time from one bottom to the other: the time of leaving, and of going down, which is shorter by the order
    // of e^{-ΔU/D}. Shares are those of the probability on either side of the top.
    let (d, u) = (0.04, |x: f64| x.powi(4) / 4.0 - x * x / 2.0 - 0.1 * x);
    let time = |from: f64, to: f64, sign: f64| {
        let v = |x: f64| u(sign * x);
        let weighed = |y: f64| (v(y) / d).exp() * integral(|z| (-v(z) / d).exp(), -3.0, y);
        integral(weighed, from, to) / d
    };
    let exact = [
        1.0 / time(-0.9456, 1.0467, 1.0),
        1.0 / time(-1.0467, 0.9456, -1.0),
    ];
    for ((value, error), exact) in rates.into_iter().zip(exact) {
        println!("{value:.6e} ± {error:.1e}, by mean times {exact:.6e}");
        assert!((value - exact).abs() < 0.02 * exact + error && error < 0.02 * value);
    }
    let share = |from: f64, to: f64| integral(|x| (-u(x) / d).exp(), from, to);
    let top = -0.1010;
    let exact = share(-3.0, top) / share(top, 3.0);
    let [there, back] = rates;
    let ratio = back.0 / there.0;
    println!("shares {ratio:.6}, by quadrature {exact:.6}");
    assert!((ratio - exact).abs() < 5e-3 * exact);
}

#[test]
fn rates_between_two_wells_alike_are_alike_wherever_borders_cut_cells() {
    for border in ["0.7", "0.715", "0.5"] {
        let [there, back] = between(&format!(
            r#"
[system.equations]
x = "x - x^3"
[system.noise]
x = "sqrt(2 D)"
[sweep]
parameter = "D"
from = 0.1
to = 0.12
points = 2
[cells]
x = {{ from = -2.4, to = 2.4, count = 120 }}
[passage]
go = {{ from = "x < -{border}", to = "x > {border}", switching = "on" }}
"#
        ));
        println!("{border}: {there:?} {back:?}");
        assert!((there.0 - back.0).abs() <= there.1 + back.1);
        assert!(there.1 < 1e-2 * there.0);
    }
}

#[test]
fn an_underdamped_well_is_left_as_often_as_paths_leave_it() {
    let inside = |side: &str| format!("y^2/2 - x^2/2 + x^4/4 < -0.1 and x {side} 0");
    let (left, right) = (inside("<"), inside(">"));
    let [there, back] = between(&well(0.06, [2.1, 1.8], 56, [&left, &right]));
    println!(
        "{:.5e} ± {:.1e} and back {:.5e} ± {:.1e}",
        there.0, there.1, back.0, back.1
    );
    assert!((there.0 - back.0).abs() <= there.1 + back.1);
    // Paths by the splitting of a kick between two halves of a step, counted at each other well's bottom: with ω = √2
    // there, (ω dt)²/12 = 4e-4 is what a step shifts.
    let (step, damping, t) = (0.05, 0.5, 0.06);
    let keep = f64::exp(-damping * step);
    let kick = (t * (1.0 - keep * keep)).sqrt();
    let (mut count, mut steps) = (0u32, 0u64);
    let mut dice = Numbers(5);
    let mut unit = move || (dice.next() >> 11) as f64 / (1u64 << 53) as f64;
    let (mut x, mut y, mut side) = (-1.0f64, 0.0f64, -1.0f64);
    let mut spare = None;
    while count < 2500 {
        let normal = spare.take().unwrap_or_else(|| {
            let (radius, angle) = (
                (-2.0 * (1.0 - unit()).ln()).sqrt(),
                std::f64::consts::TAU * unit(),
            );
            spare = Some(radius * angle.sin());
            radius * angle.cos()
        });
        y += 0.5 * step * (x - x.powi(3));
        x += 0.5 * step * y;
        y = keep * y + kick * normal;
        x += 0.5 * step * y;
        y += 0.5 * step * (x - x.powi(3));
        steps += 1;
        let energy = 0.5 * y * y - 0.5 * x * x + 0.25 * x.powi(4);
        if energy < -0.2 && x * side < 0.0 {
            side = -side;
            count += 1;
        }
    }
    let counted = f64::from(count) / (steps as f64 * step);
    println!("counted {counted:.5e} ± {:.1e}", counted / 50.0);
    // Two per cent of sampling, and four of what the regions are between which a path is counted.
    assert!((there.0 - counted).abs() < (3.0 * 0.02 + 0.04) * counted);
}

/// v' = -Δ sgn v + √(2D) ξ: beyond the gap Δ²/4D modes have all rates, and those of a range are its ends' doing (H.
/// Touchette, E. Van der Straeten and W. Just, Journal of Physics A 43, 2010).
#[test]
fn the_gap_of_dry_friction_lies_within_the_error_that_the_ends_make() {
    let model = model(&[("v", "-sign(v)")], &[("v", "0.8")]);
    for (half, cells) in [(8.0, 100), (15.0, 160)] {
        let found = modes(&model, &[(-half, half, cells)], 1);
        let [first] = found.modes[..] else {
            panic!("{half}: the slowest mode is known");
        };
        let off = first.decay.0 - 0.78125;
        // A wider range knows more: the ends change the rate by about D (π/b)².
        let ends = 0.32 * (std::f64::consts::PI / half).powi(2);
        assert!(
            off.abs() <= first.decay.1,
            "{half}: {off:e} of {:e}",
            first.decay.1
        );
        assert!(first.decay.1 < 3.0 * ends, "{half}: {:e}", first.decay.1);
    }
}
