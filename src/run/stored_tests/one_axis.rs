//! Densities of systems with one axis, solved and read back: by quadrature at some values, on cells at others.

use crate::cancellation::Cancellation;
use crate::continuation::{DensitySource, Point};
use crate::density::{EstimatedDensity, Observable};
use crate::method::{GeneratorMethodOptions, GeneratorSource, Problem};
use crate::run::store::write_store;
use crate::run::{Manifest, RunFolder, StoredRun};
use crate::space::{Axis, CellSpace};
use crate::system::{Family, Path, TypedModel};

/// dx = (a x³ - x) dt + 0.3 dW on [-2, 2]: the drift points outward at the ends from a = 1/4 on, so that there is no
/// steady state without flux, and cells let the little out that comes so far.
fn source(space: &CellSpace) -> GeneratorSource {
    let model = TypedModel::new("outward", "A system that the ends may push out", ["x"])
        .with_equation("x", "a x^3 - x")
        .with_noise("x", ["0.3"])
        .with_parameters(["a"])
        .build()
        .unwrap();
    let path = Path::parameter("a", 0.2, 0.3);
    let family = Family::new(model, &[], path).unwrap();
    let problem = Problem::new(family, space.clone(), vec![Observable::Marginal(0)]).unwrap();
    GeneratorSource::new(&problem, &GeneratorMethodOptions::default()).unwrap()
}

fn solved(source: &GeneratorSource, values: &[f64]) -> Vec<Point> {
    let mut session = source.open(&Cancellation::default());
    let solve = |&value: &f64| Point::undetected(value, session.solve(value).unwrap());
    values.iter().map(solve).collect()
}

/// Every number of a density bit for bit: numbers are printed with all digits that tell them apart.
fn words(density: &EstimatedDensity) -> String {
    format!("{density:?}")
}

#[test]
fn values_by_quadrature_and_on_cells_come_back_as_they_were_solved() {
    let axis = Axis::uniform(-2.0, 2.0, 80).unwrap();
    let space = CellSpace::new(vec![axis]).unwrap();
    let source = source(&space);
    // The first value says what is written beside the array of densities.
    for values in [[0.2, 0.3, 0.22, 0.28], [0.3, 0.2, 0.28, 0.22]] {
        let points = solved(&source, &values);
        for point in &points {
            let density = &point.densities[0];
            let by_quadrature = point.value < 0.25;
            assert_eq!(density.is_by_quadrature(), by_quadrature, "{}", point.value);
            assert_eq!(density.structure.profile.is_some(), by_quadrature);
        }
        let folder = tempfile::tempdir().unwrap();
        let mut run = RunFolder::at(folder.path());
        for point in &points {
            run.add_points(source.subject(), std::slice::from_ref(point))
                .unwrap();
        }
        let densities = points
            .iter()
            .map(|point| (point.value, &point.densities[..], &point.report.fields[..]));
        let store = folder.path().join("densities.zarr");
        let densities: Vec<_> = densities.collect();
        write_store(&store, &source.subject().family, &densities).unwrap();
        let text = crate::sweep_file::SweepText::default();
        let manifest = Manifest::start("title = \"t\"\n", text, 1, 2).unwrap();
        run.write_manifest(&manifest).unwrap();
        let stored = StoredRun::open(folder.path()).unwrap();
        let found = stored.points(source.subject(), (&space, &[]), &["generator"]);
        let found = found.unwrap();
        assert_eq!(found.len(), points.len());
        for point in &points {
            let same = found.iter().find(|one| one.value == point.value).unwrap();
            assert_eq!(words(&same.densities[0]), words(&point.densities[0]));
        }
    }
}
