//! Detection of one joint density with its marginals: the work of the detector at one point of a sweep.

#![allow(clippy::expect_used)] // A bench may stop at a wrong constant of its own.

use criterion::{Criterion, criterion_group, criterion_main};
use pbif::density::{Density, EstimatedDensity, Observable};
use pbif::space::Axis;
use pbif::topology::{DetectOptions, Detector, PersistenceDetector};

/// A ring over `count × count` cells with noise of about 5 %, or (one axis) a section through it.
fn noisy_ring(count: usize, dimension: u32) -> EstimatedDensity {
    let axis = Axis::uniform(-3.0, 3.0, count).expect("a valid axis");
    let cells = count.pow(dimension);
    let value = |cell: usize| {
        let second = if dimension == 2 {
            axis.centre(cell % count)
        } else {
            0.0
        };
        let first = axis.centre(cell / count.pow(dimension - 1));
        let ring = (-4.0 * (first.hypot(second) - 1.5).powi(2)).exp();
        // Weyl's sequence: noise enough for thousands of small peaks.
        ring * (1.0 + 0.1 * ((cell as f64 * 0.618_033_988_749_895).fract() - 0.5))
    };
    let values: Vec<f64> = (0..cells).map(value).collect();
    EstimatedDensity {
        observable: if dimension == 2 {
            Observable::Joint(0, 1)
        } else {
            Observable::Marginal(0)
        },
        standard_error: values.iter().map(|value| 0.03 * value + 1e-4).collect(),
        variants: pbif::density::Variants::None,
        structure: pbif::density::Structure::default(),
        negligible: pbif::density::NEGLIGIBLE,
        truncation: Default::default(),
        density: Density {
            axes: vec![axis; dimension as usize],
            values,
        },
    }
}

fn detection(criterion: &mut Criterion) {
    let detector = PersistenceDetector::new(DetectOptions::default(), 200);
    for count in [100, 1000] {
        let (joint, marginal) = (noisy_ring(count, 2), noisy_ring(count, 1));
        let mut group = criterion.benchmark_group("detect");
        group.sample_size(if count > 500 { 10 } else { 50 });
        group.bench_function(
            format!("joint_{count}x{count}_and_two_marginals"),
            |bencher| {
                bencher.iter(|| {
                    let found =
                        [&joint, &marginal, &marginal].map(|density| detector.detect(density));
                    found.map(|detection| detection.signature)
                });
            },
        );
        group.finish();
    }
}

criterion_group!(benches, detection);
criterion_main!(benches);
