//! Formulas on a tape against the same equations as compiled loops: the drift alone, and inside the sampling kernel
//! that draws a normal a step. Run with `cargo bench --bench formula`; figures are the fastest of many runs, in
//! nanoseconds an evaluation (or a step) a lane.
#![allow(missing_docs, clippy::print_stdout, clippy::unwrap_used)]

use std::hint::black_box;
use std::time::Instant;

use multiversion::multiversion;
use pbif::formula::scope::{Scope, Symbols};
use pbif::formula::tape::Tape;
use pbif::formula::{LANES, Lanes};

/// The transform of the sampling kernel.
#[path = "../src/sampling/normal.rs"]
#[allow(unused_imports)] // those of its own tests
mod normal;

type Drift<'a> = dyn Fn(&[Lanes], &mut [Lanes]) + 'a;

fn tape(states: &[&str], parameters: &[(&str, f64)], equations: &[&str]) -> Tape {
    let mut symbols = Symbols::default();
    for name in states {
        symbols.add_state(name).unwrap();
    }
    for (name, _) in parameters {
        symbols.add_parameter(name).unwrap();
    }
    let mut scope = Scope::new(symbols).unwrap();
    let read = |text: &&str| scope.formula(text).unwrap();
    let outputs: Vec<_> = equations.iter().map(read).collect();
    let values: Vec<f64> = parameters.iter().map(|(_, value)| *value).collect();
    let program = scope.compile(&outputs);
    let bind = fastest(100, || {
        for _ in 0..100 {
            black_box(program.bind(black_box(&values)).unwrap());
        }
    });
    if equations.len() > 1 {
        println!(
            "binding parameters takes {:.1} µs",
            bind * LANES as f64 / 1e3
        );
    }
    program.bind(&values).unwrap()
}

struct Coulomb {
    alpha: f64,
    kappa: f64,
    mu: f64,
    f_c: f64,
}

#[inline(always)]
fn sign(value: f64) -> f64 {
    let positive = if value > 0.0 { 1.0 } else { 0.0 };
    let negative = if value < 0.0 { 1.0 } else { 0.0 };
    positive - negative
}

#[multiversion(targets = "simd")]
fn coulomb(parameters: &Coulomb, states: &[Lanes], drift: &mut [Lanes]) {
    let ([x, y], [x_slope, y_slope]) = (states, drift) else {
        return;
    };
    let &Coulomb {
        alpha,
        kappa,
        mu,
        f_c,
    } = parameters;
    for lane in 0..x.len() {
        let (x, y) = (x[lane], y[lane]);
        x_slope[lane] = y;
        y_slope[lane] = -kappa * y - x * (alpha + mu * x * x) - f_c * sign(y);
    }
}

#[multiversion(targets = "simd")]
fn dahl(p: &[f64; 5], states: &[Lanes], drift: &mut [Lanes]) {
    let ([x, y, z], [x_slope, y_slope, z_slope]) = (states, drift) else {
        return;
    };
    let &[alpha, kappa, mu, lambda, f_c] = p;
    let saturation = lambda / f_c;
    for lane in 0..x.len() {
        let (x, y, z) = (x[lane], y[lane], z[lane]);
        x_slope[lane] = y;
        y_slope[lane] = -kappa * y - x * (alpha + mu * x * x) - lambda * z;
        z_slope[lane] = y - saturation * y.abs() * z;
    }
}

#[multiversion(targets = "simd")]
fn tristable(p: &[f64; 5], states: &[Lanes], drift: &mut [Lanes]) {
    let ([x, y], [x_slope, y_slope]) = (states, drift) else {
        return;
    };
    let &[c0, c1, c2, c3, w2] = p;
    for lane in 0..x.len() {
        let (x, y) = (x[lane], y[lane]);
        x_slope[lane] = y;
        let s = x * x;
        y_slope[lane] = -(c0 + s * (c1 + s * (c2 + s * c3))) * y - w2 * x;
    }
}

#[multiversion(targets = "simd")]
fn tanh_std(states: &[Lanes], drift: &mut [Lanes]) {
    let ([x, y], [x_slope, y_slope]) = (states, drift) else {
        return;
    };
    for lane in 0..x.len() {
        let (x, y) = (x[lane], y[lane]);
        x_slope[lane] = y;
        y_slope[lane] = -0.1 * y - x.sin() - 0.5 * (y / 0.01).tanh();
    }
}

type Words = [[u64; LANES]; 4];

#[inline(always)]
fn next_word(state: &mut [u64; 4]) -> u64 {
    let result = state[0].wrapping_add(state[3]);
    let shifted = state[1] << 17;
    state[2] ^= state[0];
    state[3] ^= state[1];
    state[1] ^= state[2];
    state[0] ^= state[3];
    state[2] ^= shifted;
    state[3] = state[3].rotate_left(45);
    result
}

/// The library's stream of normals.
#[multiversion(targets = "simd")]
fn fill(state: &mut Words, normals: &mut [Lanes]) {
    for rows in normals.chunks_mut(2) {
        let [first, second] = rows else { return };
        let [s0, s1, s2, s3] = &mut *state;
        for lane in 0..LANES {
            let mut words = [s0[lane], s1[lane], s2[lane], s3[lane]];
            let (radius, angle) = (next_word(&mut words), next_word(&mut words));
            [s0[lane], s1[lane], s2[lane], s3[lane]] = words;
            (first[lane], second[lane]) = normal::normal_pair(radius, angle);
        }
    }
}

/// The library's two integrators with additive noise on the second axis.
#[multiversion(targets = "simd")]
fn euler(drift: &Drift<'_>, states: &mut [Lanes], normals: &[Lanes]) {
    let mut work = [[0.0; LANES]; 4];
    let start = &mut work[..states.len()];
    for normal in normals {
        drift(states, start);
        for axis in 0..states.len() {
            for lane in 0..LANES {
                let kick = if axis == 1 { 0.01 * normal[lane] } else { 0.0 };
                states[axis][lane] += 0.01 * start[axis][lane] + kick;
            }
        }
    }
}

#[multiversion(targets = "simd")]
fn heun(drift: &Drift<'_>, states: &mut [Lanes], normals: &[Lanes]) {
    let mut work = [[[0.0; LANES]; 4]; 4];
    let dimension = states.len();
    let [increments, predictor, start, end] = &mut work;
    let (increments, predictor) = (&mut increments[..dimension], &mut predictor[..dimension]);
    let (start, end) = (&mut start[..dimension], &mut end[..dimension]);
    for normal in normals {
        increments.iter_mut().for_each(|sum| sum.fill(0.0));
        for lane in 0..LANES {
            increments[1][lane] += 0.01 * normal[lane];
        }
        drift(states, start);
        for axis in 0..dimension {
            for lane in 0..LANES {
                predictor[axis][lane] =
                    states[axis][lane] + (0.01 * start[axis][lane] + increments[axis][lane]);
            }
        }
        drift(predictor, end);
        for axis in 0..dimension {
            for lane in 0..LANES {
                let mean = 0.005 * (start[axis][lane] + end[axis][lane]);
                states[axis][lane] += mean + increments[axis][lane];
            }
        }
    }
}

fn start(dimension: usize) -> Vec<Lanes> {
    let lane = |axis: usize, lane: usize| 0.37 * (lane as f64 * 0.11 + axis as f64).sin();
    (0..dimension)
        .map(|axis| std::array::from_fn(|number| lane(axis, number)))
        .collect()
}

/// Nanoseconds a lane and call, the fastest of many short runs.
fn fastest(calls: usize, mut run: impl FnMut()) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..60 {
        let begin = Instant::now();
        run();
        best = best.min(begin.elapsed().as_secs_f64());
    }
    best * 1e9 / (calls * LANES) as f64
}

fn drift_alone(drift: &Drift<'_>, dimension: usize) -> f64 {
    let states = start(dimension);
    let mut slopes = vec![[0.0; LANES]; dimension];
    fastest(2000, || {
        for _ in 0..2000 {
            drift(black_box(&states), black_box(&mut slopes));
        }
    })
}

fn kernel(
    drift: &Drift<'_>,
    dimension: usize,
    step: fn(&Drift<'_>, &mut [Lanes], &[Lanes]),
) -> f64 {
    let mut states = start(dimension);
    let mut words: Words = std::array::from_fn(|word| {
        std::array::from_fn(|lane| {
            0x9e37_79b9_7f4a_7c15_u64.wrapping_mul((64 * word + lane + 1) as u64)
        })
    });
    let mut normals = [[0.0; LANES]; 16];
    fastest(16 * 60, || {
        for _ in 0..60 {
            fill(&mut words, &mut normals);
            step(drift, &mut states, &normals);
        }
        for axis in states.iter_mut() {
            axis.iter_mut().for_each(|x| *x = x.clamp(-2.0, 2.0));
        }
    })
}

fn compare(name: &str, dimension: usize, compiled: &Drift<'_>, tape: &Tape) {
    let on_tape = |states: &[Lanes], slopes: &mut [Lanes]| tape.run(0.0, states, slopes);
    println!(
        "{name}: {} instructions, {} registers",
        tape.instructions(),
        tape.registers()
    );
    type Measure<'a> = &'a dyn Fn(&Drift<'_>) -> f64;
    let rows: [(&str, Measure<'_>); 3] = [
        ("drift alone", &|drift| drift_alone(drift, dimension)),
        ("Euler-Maruyama kernel", &|drift| {
            kernel(drift, dimension, euler)
        }),
        ("Heun kernel", &|drift| kernel(drift, dimension, heun)),
    ];
    for (what, measure) in rows {
        // By turns, so that a busy machine is unkind to both.
        let (mut a, mut b) = (f64::INFINITY, f64::INFINITY);
        for _ in 0..3 {
            a = a.min(measure(compiled));
            b = b.min(measure(&on_tape));
        }
        println!(
            "  {what:24} compiled {a:6.3} ns   tape {b:6.3} ns   speed {:5.1} %",
            100.0 * a / b
        );
    }
}

fn main() {
    let parameters = Coulomb {
        alpha: 1.0,
        kappa: 0.01,
        mu: 0.01,
        f_c: 0.02,
    };
    let values = [("alpha", 1.0), ("kappa", 0.01), ("mu", 0.01), ("f_c", 0.02)];
    compare(
        "Coulomb-Duffing",
        2,
        &|states, slopes| coulomb(&parameters, states, slopes),
        &tape(
            &["x", "y"],
            &values,
            &["y", "-kappa y - x (alpha + mu x^2) - f_c sign(y)"],
        ),
    );
    let values = [
        ("alpha", -1.0),
        ("kappa", 0.02),
        ("mu", 1.0),
        ("lambda", 0.06),
        ("f_c", 0.05),
    ];
    compare(
        "Dahl-Duffing",
        3,
        &|states, slopes| dahl(&[-1.0, 0.02, 1.0, 0.06, 0.05], states, slopes),
        &tape(
            &["x", "y", "z"],
            &values,
            &[
                "y",
                "-kappa y - alpha x - mu x^3 - lambda z",
                "y - lambda/f_c abs(y) z"
                    .replace("/f_c abs", "/f_c*abs")
                    .as_str(),
            ],
        ),
    );
    let values = [
        ("c0", 0.1),
        ("c1", -1.0),
        ("c2", 1.3),
        ("c3", -0.2),
        ("w", 1.0),
    ];
    compare(
        "tristable",
        2,
        &|states, slopes| tristable(&[0.1, -1.0, 1.3, -0.2, 1.0], states, slopes),
        &tape(
            &["x", "y"],
            &values,
            &["y", "-(c0 + c1 x^2 + c2 x^4 + c3 x^6) y - w^2 x"],
        ),
    );
    compare(
        "pendulum with tanh friction (compiled: std)",
        2,
        &|states, slopes| tanh_std(states, slopes),
        &tape(
            &["x", "y"],
            &[],
            &["y", "-0.1 y - sin(x) - 0.5 tanh(y/0.01)"],
        ),
    );
    let operations = "x + y;x*y;x/y;sqrt(x);sign(x);min(x, y);if(x < y, x, y);exp(x);log(x);sin(x);cos(x);tanh(x);\
                      atan2(y, x);hypot(x, y);x^1.3;x^7;tan(x)";
    for text in operations.split(';') {
        let tape = tape(&["x", "y"], &[], &[text]);
        let states = start(2);
        let mut out = [[0.0; LANES]];
        let time = fastest(2000, || {
            for _ in 0..2000 {
                tape.run(0.0, black_box(&states), black_box(&mut out))
            }
        });
        println!("{text:18} {time:6.3} ns");
    }
}
