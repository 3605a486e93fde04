//! Random systems under a periodic force, and with an angle, whose densities are exact, run as sweep files that leave
//! cells and harmonics to the program.
//!
//! - Under a force: u = h(x) = a x + e x² + x³ is linear, u' = -k u + A cos(w t) + √(2 D) ξ. At each phase u is normal,
//!   and p(x) = h'(x) N(h(x)) has peaks of its own, as has the density over the period.
//! - An angle: φ' = τ - U'(φ) with noise of the intensity s (1 + r cos(φ - ψ)), which carries a current. The test
//!   solves a p - (B p)'/2 = J by collocation at 161 places.
//! - A rotor: φ'' = -γ φ' - U'(φ) + √(2 γ T) ξ, p ∝ exp(-U/T).
//!
//! Changes are folds: where two extrema of p meet, the extremum of p' between them passes zero.

use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;

use super::{Dice, Found, Score, print_true, score_of};
use crate::common::sweeps::{rows, swept};
use pbif::continuation::Label;

/// p', or p'/p, of the density at one value of the sweep.
type Slope = Box<dyn Fn(f64) -> f64>;

/// A sweep file, and where the density that it watches changes.
struct Known {
    family: &'static str,
    text: String,
    /// As rows of the table name it.
    observable: String,
    truths: Vec<f64>,
}

/// Places in a range of x, one of them each extremum is looked for between; values of the sweep between which changes
/// are.
const PLACES: usize = 1500;
const VALUES: usize = 96;

/// Zeros of a slope, each with whether it is a maximum.
fn extrema(slope: &Slope, (from, to): (f64, f64)) -> Vec<(f64, bool)> {
    let at = |place: usize| from + (to - from) * (place as f64 + 0.31) / PLACES as f64;
    let slopes: Vec<f64> = (0..=PLACES).map(|place| slope(at(place))).collect();
    let found = (1..=PLACES).filter(|&place| (slopes[place - 1] > 0.0) != (slopes[place] > 0.0));
    found
        .map(|place| {
            let (mut low, mut high) = (at(place - 1), at(place));
            for _ in 0..40 {
                let middle = 0.5 * (low + high);
                match (slope(middle) > 0.0) == (slopes[place - 1] > 0.0) {
                    true => low = middle,
                    false => high = middle,
                }
            }
            (0.5 * (low + high), slopes[place - 1] > 0.0)
        })
        .collect()
}

/// Values at which two extrema meet. `None` where a bracket holds more than one change.
fn folds(at: &dyn Fn(f64) -> Slope, range: (f64, f64), (from, to): (f64, f64)) -> Option<Vec<f64>> {
    let count = |value: f64| extrema(&at(value), range).len();
    let value = |index: usize| from + (to - from) * index as f64 / VALUES as f64;
    let counts: Vec<usize> = (0..=VALUES).map(|index| count(value(index))).collect();
    let mut found = Vec::new();
    for index in 1..=VALUES {
        let (few, many) = (
            counts[index].min(counts[index - 1]),
            counts[index].max(counts[index - 1]),
        );
        if few == many {
            continue;
        }
        if many - few != 2 {
            return None;
        }
        let (mut low, mut high) = (value(index - 1), value(index));
        for _ in 0..7 {
            let middle = 0.5 * (low + high);
            match count(middle) == counts[index - 1] {
                true => low = middle,
                false => high = middle,
            }
        }
        found.push(fold(
            at,
            range,
            (low, high),
            counts[index] > counts[index - 1],
        ));
    }
    Some(found)
}

/// The fold inside a narrow bracket, on the upper side of which there are more extrema, or on the lower one.
fn fold(
    at: &dyn Fn(f64) -> Slope,
    range: (f64, f64),
    (mut low, mut high): (f64, f64),
    is_birth: bool,
) -> f64 {
    let known = extrema(&at(if is_birth { high } else { low }), range);
    let pairs = known.windows(2).map(|pair| (pair[0], pair[1]));
    let nearest = pairs.min_by(|a, b| (a.1.0 - a.0.0).total_cmp(&(b.1.0 - b.0.0)));
    let ((left, is_maximum), (right, _)) = nearest.unwrap();
    let sign = if is_maximum { -1.0 } else { 1.0 };
    // The largest slope, or the negative of the smallest one, about the pair: above zero while there is one.
    let largest = |value: f64| {
        let slope = at(value);
        let (mut a, mut b) = (2.0 * left - right, 2.0 * right - left);
        let golden = 0.5 * (5_f64.sqrt() - 1.0);
        for _ in 0..60 {
            let (one, two) = (b - golden * (b - a), a + golden * (b - a));
            match sign * slope(one) > sign * slope(two) {
                true => b = two,
                false => a = one,
            }
        }
        sign * slope(0.5 * (a + b))
    };
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        match (largest(middle) > 0.0) == is_birth {
            true => high = middle,
            false => low = middle,
        }
    }
    0.5 * (low + high)
}

/// A linear system under a force, seen through a curve. One of its numbers is swept.
fn forced(seed: u64) -> Option<Known> {
    let mut dice = Dice::new(seed);
    let (a, k, w) = (
        dice.between(0.1, 0.8),
        dice.between(0.4, 2.0),
        dice.between(0.3, 3.0),
    );
    let e = (3.0 * a).sqrt() * dice.between(0.15, 0.7);
    let deviation = dice.between(0.25, 0.8);
    let d = k * deviation * deviation;
    let force = deviation * dice.between(1.0, 3.5) * k.hypot(w);
    let numbers = [("a", a), ("k", k), ("w", w), ("D", d), ("A", force)];
    let swept = dice.one_of([0, 2, 3, 4, 4]);
    let eighth = dice.one_of([0, 1, 2, 3, 8, 8, 8, 8]);
    let (name, middle) = numbers[swept];
    // The curve has to rise everywhere: e² < 3 a.
    let least = if swept == 0 { 1.05 * e * e / 3.0 } else { 0.0 };
    let ends = ((0.2 * middle).max(least), 2.5 * middle);
    let slope_at = move |value: f64| -> Slope {
        let mut numbers = numbers.map(|(_, number)| number);
        numbers[swept] = value;
        let [a, k, w, d, force] = numbers;
        let variance = d / k;
        let parts = if eighth == 8 { 240 } else { 1 };
        let means: Vec<f64> = (0..parts)
            .map(|part| {
                let phase = if parts == 1 {
                    eighth as f64 / 8.0
                } else {
                    f64::from(part) / f64::from(parts)
                };
                (k * (TAU * phase).cos() + w * (TAU * phase).sin()) * force / (k * k + w * w)
            })
            .collect();
        Box::new(move |x| {
            let (u, rise, bend) = (
                a * x + e * x * x + x.powi(3),
                a + 2.0 * e * x + 3.0 * x * x,
                2.0 * e + 6.0 * x,
            );
            let of = |mean: &f64| {
                let density = (-0.5 * (u - mean).powi(2) / variance).exp();
                (
                    density,
                    density * (bend / rise - (u - mean) * rise / variance),
                )
            };
            let (sum, slope) = means
                .iter()
                .map(of)
                .fold((0.0, 0.0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
            slope / sum
        })
    };
    let reach = (2.5_f64.sqrt() * 6.0 * deviation + 2.5 * force / k.hypot(0.2 * w)).cbrt() + 0.8;
    let truths = folds(&slope_at, (-reach, reach), ends)?;
    let watched = match eighth {
        8 => "x @ mean".to_owned(),
        _ => format!("x @ phase {eighth}/8"),
    };
    let rise = format!("(a + {} x + 3 x^2)", 2.0 * e);
    let parameters = numbers.map(|(name, number)| format!("{name} = {number}\n"));
    Some(Known {
        family: "forced, one axis and the phase",
        text: format!(
            "[system.equations]\nx = \"(-k (a x + {e} x^2 + x^3) + A cos(w t))/{rise}\"\n\
             [system.noise]\ninterpretation = \"stratonovich\"\nx = \"sqrt(2 D)/{rise}\"\n[system.parameters]\n{}\
             [sweep]\nparameter = \"{name}\"\nfrom = {}\nto = {}\npoints = 15\n\
             [detect]\nmarginals = [\"{watched}\"]\n",
            parameters.concat(),
            ends.0,
            ends.1
        ),
        observable: match eighth {
            8 => "x".to_owned(),
            _ => format!("x_phase_{}", ["0", "1_8", "1_4", "3_8"][eighth]),
        },
        truths,
    })
}

/// U' = Σ c sin(n φ + shift), as a formula and as numbers.
struct Wave(Vec<(f64, f64, f64)>);

impl Wave {
    fn random(dice: &mut Dice) -> Self {
        let first = (dice.between(0.4, 1.2), 1.0, 0.0);
        let more = [2.0, 3.0].map(|n| (dice.between(0.1, 0.7) / n, n, dice.between(-3.1, 3.1)));
        Self([first, more[0], more[1]].to_vec())
    }
    fn at(&self, phi: f64, b: f64) -> f64 {
        let of = |(index, &(c, n, shift)): (usize, &(f64, f64, f64))| {
            let b = if index == 1 { b } else { 1.0 };
            b * c * (n * phi + shift).sin()
        };
        self.0.iter().enumerate().map(of).sum()
    }
    /// With the second wave b times as high.
    fn text(&self) -> String {
        let [one, two, three] = [0, 1, 2]
            .map(|index| self.0[index])
            .map(|(c, n, shift)| format!("{c} sin({n} phi + ({shift}))"));
        format!("{one} + b * {two} + {three}")
    }
}

/// An angle that a torque drives, with noise that differs from place to place.
fn driven(seed: u64) -> Option<Known> {
    let mut dice = Dice::new(seed);
    let wave = Wave::random(&mut dice);
    let (r, psi) = (dice.between(-0.6, 0.6), dice.between(-3.1, 3.1));
    let numbers = [
        ("tau", dice.between(0.2, 1.0)),
        ("b", dice.between(0.5, 2.0)),
        ("s", dice.between(0.25, 1.2)),
    ];
    let swept = dice.one_of([0, 1, 1, 2]);
    let (name, middle) = numbers[swept];
    let ends = match swept {
        2 => (0.5 * middle, 2.0 * middle),
        _ => (middle - 1.5, middle + 1.5),
    };
    let text = wave.text();
    let slope_at = move |value: f64| -> Slope {
        let mut numbers = numbers.map(|(_, number)| number);
        numbers[swept] = value;
        let [tau, b, s] = numbers;
        circle(&|phi| tau - wave.at(phi, b), &|phi| {
            s * (1.0 + r * (phi - psi).cos())
        })
    };
    let truths = folds(&slope_at, (0.0, TAU), ends)?;
    let parameters = numbers.map(|(name, number)| format!("{name} = {number}\n"));
    Some(Known {
        family: "an angle under a torque",
        text: format!(
            "[system.equations]\nphi = \"tau - ({text})\"\n\
             [system.noise]\ninterpretation = \"ito\"\nphi = \"sqrt(s (1 + {r} cos(phi - ({psi}))))\"\n\
             [system.bounds]\nphi = \"periodic\"\n[system.parameters]\n{}\
             [sweep]\nparameter = \"{name}\"\nfrom = {}\nto = {}\npoints = 15\n",
            parameters.concat(),
            ends.0,
            ends.1
        ),
        observable: "phi".to_owned(),
        truths,
    })
}

/// p' of the density on a circle with this drift and this intensity of the noise (Itô).
fn circle(drift: &dyn Fn(f64) -> f64, intensity: &dyn Fn(f64) -> f64) -> Slope {
    const NODES: usize = 161;
    let node = |index: usize| TAU * index as f64 / NODES as f64;
    let derivative = |row: usize, column: usize| match row == column {
        true => 0.0,
        false => {
            let sign = if (row + column).is_multiple_of(2) {
                0.5
            } else {
                -0.5
            };
            sign / (0.5 * (node(row) - node(column))).sin()
        }
    };
    // The density at the nodes and, last, the current.
    let matrix = DMatrix::from_fn(NODES + 1, NODES + 1, |row, column| match (row, column) {
        (NODES, NODES) => 0.0,
        (NODES, _) => TAU / NODES as f64,
        (_, NODES) => -1.0,
        _ => {
            let along = if row == column { drift(node(row)) } else { 0.0 };
            along - 0.5 * derivative(row, column) * intensity(node(column))
        }
    });
    let mut right = DVector::zeros(NODES + 1);
    right[NODES] = 1.0;
    let density = matrix.lu().solve(&right).unwrap();
    let terms = (1..=NODES / 2).map(|n| {
        let sum = |of: fn(f64) -> f64| -> f64 {
            let nodes = 0..NODES;
            nodes
                .map(|index| density[index] * of(n as f64 * node(index)))
                .sum()
        };
        let factor = 2.0 * n as f64 / NODES as f64;
        (factor * sum(f64::cos), factor * sum(f64::sin))
    });
    let terms: Vec<(f64, f64)> = terms.collect();
    Box::new(move |phi| {
        let of = |(n, (cosine, sine)): (usize, &(f64, f64))| {
            let (at, along) = ((n + 1) as f64 * phi).sin_cos();
            sine * along - cosine * at
        };
        terms.iter().enumerate().map(of).sum()
    })
}

/// A rotor with friction and noise in a potential of three waves.
fn rotor(seed: u64) -> Option<Known> {
    let mut dice = Dice::new(seed);
    let wave = Wave::random(&mut dice);
    let (gamma, temperature) = (dice.between(0.3, 1.5), dice.between(0.3, 1.0));
    let middle = dice.between(0.5, 2.0);
    let ends = (middle - 1.5, middle + 1.5);
    let text = wave.text();
    let slope_at = move |b: f64| -> Slope {
        let terms = Wave(wave.0.clone());
        Box::new(move |phi| -terms.at(phi, b))
    };
    let truths = folds(&slope_at, (0.0, TAU), ends)?;
    Some(Known {
        family: "a rotor",
        text: format!(
            "[system.equations]\nphi = \"v\"\nv = \"-{gamma} v - ({text})\"\n\
             [system.noise]\nv = \"sqrt(2 * {gamma} * {temperature})\"\n\
             [system.bounds]\nphi = \"periodic\"\n[system.parameters]\nb = {middle}\n\
             [sweep]\nparameter = \"b\"\nfrom = {}\nto = {}\npoints = 11\n\
             [detect]\nmarginals = [\"phi\"]\njoint = []\n",
            ends.0, ends.1
        ),
        observable: "phi".to_owned(),
        truths,
    })
}

/// Runs systems; prints what was not wholly right.
fn run(
    make: fn(u64) -> Option<Known>,
    seeds: std::ops::Range<u64>,
    scores: &mut Vec<(&'static str, Score)>,
) {
    let moved = crate::common::numbers::given("OTHER_SEEDS", 0);
    for seed in seeds {
        let Some(known) = make(seed + moved) else {
            continue;
        };
        let (_, result) = swept(&known.text, "");
        let failures = result.labels.iter().filter_map(|label| match label {
            Label::Failure { lower, upper, .. } => Some([*lower, *upper]),
            _ => None,
        });
        let found = Found {
            rows: rows(&result, &known.observable)
                .into_iter()
                .cloned()
                .collect(),
            failures: failures.collect(),
        };
        score_of(
            known.family,
            (&known.text, &known.truths),
            seed,
            &found,
            scores,
        );
    }
}

#[test]
fn what_is_located_of_angles_and_under_forces_holds_the_truth() {
    let mut scores = Vec::new();
    run(forced, 11_000..11_003, &mut scores);
    run(driven, 11_200..11_203, &mut scores);
    print_true(&scores);
}

#[test]
#[ignore = "prints the table of docs/location.md"]
fn turning_in_full() {
    let mut scores = Vec::new();
    run(forced, 11_000..11_040, &mut scores);
    run(driven, 11_200..11_240, &mut scores);
    run(rotor, 11_400..11_415, &mut scores);
    print_true(&scores);
}
