//! Assembly of the generator of the oscillator with Coulomb friction.

#![allow(
    clippy::unwrap_used,
    reason = "a bench that cannot be set up should stop"
)]

use criterion::{Criterion, criterion_group, criterion_main};
use pbif::generator::{GeneratorOptions, assemble};
use pbif::space::{Axis, CellSpace};
use pbif::system::registry;

fn assembly(criterion: &mut Criterion) {
    let values = [
        ("kappa", 0.01),
        ("mu", 0.01),
        ("f_c", 0.01),
        ("sigma2", 0.01),
    ];
    let model = registry::find("coulomb").unwrap();
    let system = model.system_with(&values).unwrap();
    let mut group = criterion.benchmark_group("assemble");
    group.sample_size(10);
    for count in [50, 100, 300, 1000] {
        let axis = Axis::uniform(-4.2, 4.2, count).unwrap();
        let space = CellSpace::new(vec![axis.clone(), axis]).unwrap();
        group.bench_function(format!("{count}x{count}"), |bencher| {
            bencher.iter(|| assemble(&*system, &space, &GeneratorOptions::default()).unwrap());
        });
    }
    group.finish();
}

criterion_group!(benches, assembly);
criterion_main!(benches);
