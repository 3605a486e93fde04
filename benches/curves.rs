//! A curve of a P-bifurcation at 100 × 100 cells: about 100 points of the change of x under Coulomb friction, in the
//! plane of friction level and noise, with its checks on finer cells and between closed ends of Ω.

// A bench may stop where it cannot go on, and speaks to who runs it.
#![allow(clippy::unwrap_used, clippy::print_stderr)]

use criterion::{Criterion, criterion_group, criterion_main};
use pbif::cancellation::Cancellation;
use pbif::continuation::curve::{Curve, CurveOptions, CurveStart, Plane, follow};
use pbif::sweep_file::{Sweep, SweepFile};
use pbif::topology::IndicatorKind;

const FILE: &str = include_str!("../sweeps/coulomb_plane.toml");

fn followed(sweep: &Sweep) -> Curve {
    let never = Cancellation::new();
    let plane = Plane::new(("f_c", -0.008, 0.004), ("sigma2", 0.005, 0.02)).unwrap();
    let source = sweep.source_in(&plane, &never).unwrap();
    let start = CurveStart {
        values: [-0.002_848_6, 0.01],
        observable: 0,
        kind: IndicatorKind::CURVATURE,
        place: vec![0.0],
    };
    let options = CurveOptions {
        largest_step: 0.0106,
        tolerance: 5e-3,
        ..CurveOptions::default()
    };
    let detector = sweep.detector();
    let observer = &mut |_: [f64; 2]| ();
    follow(
        &source, &plane, &detector, &start, &options, &never, observer,
    )
    .unwrap()
}

fn benchmark(criterion: &mut Criterion) {
    let settings = SweepFile::parse("coulomb_plane.toml", FILE).validate();
    let sweep = settings.unwrap().prepare(&Cancellation::new()).unwrap();
    let curve = followed(&sweep);
    let (points, work, checks) = (curve.points.len(), curve.work, curve.check_work);
    eprintln!("{points} points; following {work:?}; checking {checks:?}");
    let mut group = criterion.benchmark_group("curves");
    group.sample_size(10);
    let name = "change of x under Coulomb friction, 100x100";
    group.bench_function(name, |bencher| bencher.iter(|| followed(&sweep)));
}

criterion_group!(benches, benchmark);
criterion_main!(benches);
