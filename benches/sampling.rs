//! Trajectory steps a second: `sample_transitions` on the Coulomb oscillator, and the ladder of kernels that leads
//! there from a scalar loop.
//!
//! Read `thrpt`: an element is one integrator step of one trajectory. Build with `cargo bench --bench sampling`. The
//! last group has compiled steps without random numbers and cells: what arithmetic allows. Figures are in docs/sgcm.md.
#![allow(missing_docs)] // criterion's macros make undocumented items

use std::hint::black_box;
use std::sync::Arc;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use multiversion::multiversion;
use pbif::cancellation::Cancellation;
use pbif::sampling::{Integrator, SamplingOptions, sample_transitions};
use pbif::space::{Axis, CellSpace};
use pbif::system::{LANES, Lanes, StepScheme, System, SystemError, registry};
use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

/// The library's own transform, so that the ladder measures the code that is used.
#[path = "../src/sampling/normal.rs"]
#[allow(dead_code, unused_imports)] // its unit tests run with the library's
mod normal;

const STEPS: usize = 1000;
const STEP: f64 = 0.01;
const KAPPA: f64 = 0.01;
const MU: f64 = 0.01;
const FRICTION: f64 = 0.02;
const SIGMA: f64 = 0.1;

fn coulomb() -> Result<Arc<dyn System>, SystemError> {
    let values = [
        ("kappa", KAPPA),
        ("mu", MU),
        ("f_c", FRICTION),
        ("sigma2", SIGMA * SIGMA),
    ];
    registry::find("coulomb").and_then(|model| model.system_with(&values))
}

fn sampling(criterion: &mut Criterion) {
    let Ok(system) = coulomb() else {
        return;
    };
    let axes = Axis::uniform(-3.0, 3.0, 50).map(|axis| vec![axis.clone(), axis]);
    let Ok(space) = axes.and_then(CellSpace::new) else {
        return;
    };
    let seeds: Vec<usize> = (0..space.n_cells()).collect();
    let mut group =
        criterion.benchmark_group("sample_transitions, 50×50 cells × 2000 samples × 100 steps");
    group
        .sample_size(10)
        .throughput(Throughput::Elements(2500 * 2000 * 100));
    for integrator in Integrator::ALL {
        for threads in [1, 2] {
            let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(threads).build() else {
                continue;
            };
            let options = SamplingOptions {
                map_step: 1.0,
                time_step: STEP,
                samples: 2000,
                groups: 8,
                seed: 1,
                integrator,
                keep_starts: false,
            };
            let run =
                || sample_transitions(&*system, &space, &seeds, &options, &Cancellation::new());
            let name = format!("{}, {threads} threads", integrator.name());
            group.bench_function(name, |bencher| {
                bencher.iter(|| pool.install(|| black_box(run())))
            });
        }
    }
    group.finish();
}

/// Velocity after an Euler-Maruyama step.
#[inline(always)]
fn kicked(x: f64, y: f64, normal: f64) -> f64 {
    let sign = if y > 0.0 { 1.0 } else { 0.0 } - if y < 0.0 { 1.0 } else { 0.0 };
    let force = -KAPPA * y - x * (1.0 + MU * x * x) - FRICTION * sign;
    y + STEP * force + SIGMA * 0.1 * normal
}

fn scalar(mut normal: impl FnMut() -> f64) -> f64 {
    let (mut x, mut y) = (0.5, 0.0);
    for _ in 0..STEPS * LANES {
        (x, y) = (x + STEP * y, kicked(x, y, normal()));
    }
    x
}

/// Box and Muller's textbook formula, one normal of the two.
fn textbook(random: &mut impl Rng) -> f64 {
    let mut uniform = || (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
    let (radius, angle) = (1.0 - uniform(), uniform());
    (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * angle).cos()
}

/// xoshiro256+ in every lane, two words a call.
#[inline(always)]
fn lanes(state: &mut [[u64; LANES]; 4]) -> Lanes {
    let ([s0, s1, s2, s3], mut x, mut y) = (state, [0.5; LANES], [0.0; LANES]);
    let (mut first, mut second) = ([0.0; LANES], [0.0; LANES]);
    for _ in 0..STEPS / 2 {
        for lane in 0..LANES {
            let mut words = [s0[lane], s1[lane], s2[lane], s3[lane]];
            let (radius, angle) = (word(&mut words), word(&mut words));
            [s0[lane], s1[lane], s2[lane], s3[lane]] = words;
            (first[lane], second[lane]) = normal::normal_pair(radius, angle);
        }
        for normals in [&first, &second] {
            for lane in 0..LANES {
                let velocity = kicked(x[lane], y[lane], normals[lane]);
                (x[lane], y[lane]) = (x[lane] + STEP * y[lane], velocity);
            }
        }
    }
    x
}

#[inline(always)]
fn word(state: &mut [u64; 4]) -> u64 {
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

#[inline(never)]
fn baseline(state: &mut [[u64; LANES]; 4]) -> Lanes {
    lanes(state)
}

#[multiversion(targets = "simd")]
fn best_instructions(state: &mut [[u64; LANES]; 4]) -> Lanes {
    lanes(state)
}

fn ladder(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("Euler-Maruyama kernels, 1 thread");
    group.throughput(Throughput::Elements((STEPS * LANES) as u64));
    let mut xoshiro = Xoshiro256PlusPlus::seed_from_u64(1);
    group.bench_function("scalar, xoshiro256++ and textbook Box-Muller", |bencher| {
        bencher.iter(|| black_box(scalar(|| textbook(&mut xoshiro))));
    });
    group.bench_function("scalar, xoshiro256++ and StandardNormal", |bencher| {
        bencher.iter(|| black_box(scalar(|| StandardNormal.sample(&mut xoshiro))));
    });
    let mut state = [[0; LANES]; 4].map(|words: [u64; LANES]| words.map(|_| xoshiro.next_u64()));
    group.bench_function("64 lanes, baseline instructions", |bencher| {
        bencher.iter(|| black_box(baseline(&mut state)));
    });
    group.bench_function("64 lanes, multiversion", |bencher| {
        bencher.iter(|| black_box(best_instructions(&mut state)));
    });
    group.finish();
}

/// Steps in one loop with the drift, with increments that are given.
fn compiled(criterion: &mut Criterion) {
    let Ok(system) = coulomb() else {
        return;
    };
    let Some(steps) = system.compiled_steps() else {
        return;
    };
    let mut group = criterion.benchmark_group("compiled steps with given increments, 1 thread");
    let normals = [[0.7; LANES], [-0.7; LANES]].repeat(8);
    group.throughput(Throughput::Elements((normals.len() * LANES) as u64));
    let mut states = [[0.5; LANES], [0.0; LANES]];
    for scheme in [StepScheme::Heun, StepScheme::Splitting] {
        group.bench_function(format!("{scheme:?}"), |bencher| {
            bencher.iter(|| {
                let increment = SIGMA * STEP.sqrt();
                steps.advance(scheme, STEP, increment, &mut states, black_box(&normals));
            });
        });
    }
    group.finish();
}

criterion_group!(benches, sampling, ladder, compiled);
criterion_main!(benches);
