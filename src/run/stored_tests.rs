//! A run written and read back: densities bit for bit, whatever they carry, and what is said of broken files.

use super::*;
use crate::continuation::{
    CellCheck, Finding, MethodPart, Point, PointStatus, SolveReport, Subject,
};
use crate::density::{Density, EstimatedDensity, Kink, Moments, Observable, Structure, Variants};
use crate::space::{Axis, CellSpace, Grading};
use crate::system::examples::coulomb;

const OBSERVABLES: [Observable; 2] = [Observable::Marginal(1), Observable::Joint(0, 1)];

fn subject(observables: &[Observable]) -> Subject {
    Subject {
        family: coulomb(),
        observables: observables.to_vec(),
        cell_check: CellCheck::Needless,
    }
}

fn space() -> CellSpace {
    let grading = Grading {
        at: vec![0.0],
        smallest: 0.1,
    };
    let x = Axis::uniform(-1.0, 1.0, 3).unwrap();
    let y = Axis::graded(-2.0, 2.0, 6, &grading).unwrap();
    CellSpace::new(vec![x, y]).unwrap()
}

/// Numbers without a short decimal form, negative zero and subnormal numbers among them.
fn awkward(seed: usize, count: usize) -> Vec<f64> {
    let number = |index: usize| match (seed + index) % 11 {
        0 => -0.0,
        1 => f64::MIN_POSITIVE / 3.0,
        k => {
            (k as f64 + 0.1).powf(std::f64::consts::PI) / 7.0
                * if k % 2 == 0 { 1.0 } else { -1e-17 }
        }
    };
    (0..count).map(number).collect()
}

/// A point with `replicates` jackknife replicates, or a second scheme, and with or without kinks.
fn point(value: f64, replicates: Option<usize>, kinks: usize) -> Point {
    let space = space();
    let densities = OBSERVABLES.map(|observable| {
        let axes: Vec<Axis> = observable
            .axes()
            .iter()
            .map(|&a| space.axes()[a].clone())
            .collect();
        let cells: usize = axes.iter().map(Axis::count).product();
        let (axis, bins) = match observable {
            Observable::Marginal(_) => (0, 1),
            Observable::Joint(..) => (1, 3),
        };
        let kink = |number: usize| Kink {
            axis,
            at: number as f64 / 3.0,
            jump: awkward(number, bins),
        };
        EstimatedDensity {
            observable,
            density: Density {
                axes,
                values: awkward(1, cells),
            },
            standard_error: awkward(2, cells),
            variants: match replicates {
                Some(0) => Variants::None,
                Some(count) => Variants::Jackknife((0..count).map(|r| awkward(r, cells)).collect()),
                None => Variants::Scheme(awkward(5, cells)),
            },
            structure: Structure {
                centre: Some(vec![0.1 + 0.2; observable.axes().len()]),
                kinks: (0..kinks).map(kink).collect(),
                profile: None,
            },
            negligible: 0.25,
        }
    });
    Point {
        value,
        report: SolveReport {
            status: PointStatus::NotConverged,
            iterations: 7,
            residual: 1.0 / 3e13,
            solver_error: 2.0 / 3e9,
            escape_rate: 0.1 + 0.2,
            edge_mass: vec![1e-5 / 3.0],
            own: MethodPart {
                factorisations: 2,
                negative_mass: 1e-300,
                numerical_diffusion: vec![0.1 / 3.0, 0.2 / 3.0],
                map_step: Some(6.25 / 3.0),
                time_step_bias: Some(1e-3 / 7.0),
            },
            findings: vec![
                Finding::NotConverged { error: 1e-3 / 7.0 },
                Finding::SurfaceOffFaces { axis: 1, at: -0.1 },
            ],
            ..SolveReport::solved("sgcm")
        },
        moments: vec![
            Moments {
                mean: -1.0 / 3.0,
                standard_deviation: 2.0 / 3.0
            };
            2
        ],
        densities: densities.to_vec(),
        detections: Vec::new(),
        distance: None,
        seconds: 0.25,
    }
}

/// A point without a steady state.
fn without_density(value: f64) -> Point {
    let mut point = point(value, Some(0), 0);
    point.report.status = PointStatus::NoSteadyState;
    point.report.own.map_step = None;
    point.report.edge_mass = Vec::new();
    point.report.own.numerical_diffusion = Vec::new();
    point.moments = Vec::new();
    point.densities = Vec::new();
    point
}

const RESOLVED: &str = "title = \"t\"\nfrom = 0.30000000000000004\n";

fn write(folder: &std::path::Path, points: &[Point]) {
    let mut run = RunFolder::create(folder).unwrap();
    for point in points {
        run.add_point(&subject(&OBSERVABLES), point).unwrap();
    }
    let manifest =
        Manifest::start(RESOLVED, crate::sweep_file::SweepText::default(), 1, 2).unwrap();
    run.write_manifest(&manifest).unwrap();
}

fn read(folder: &std::path::Path) -> Result<Vec<Point>, RunError> {
    let run = StoredRun::open(folder)?;
    run.points(
        &subject(&OBSERVABLES),
        (&space(), &[]),
        &["generator", "sgcm"],
    )
}

/// Equality of bits: `==` would take -0.0 for 0.0.
fn bits(point: &Point) -> String {
    let numbers =
        |values: &[f64]| -> Vec<u64> { values.iter().map(|value| value.to_bits()).collect() };
    let mut text = format!("{:?} {:?} {:?}\n", point.value, point.report, point.moments);
    for one in &point.densities {
        let variants = match &one.variants {
            Variants::None => Vec::new(),
            Variants::Scheme(second) => vec![numbers(second)],
            Variants::Jackknife(replicates) => replicates.iter().map(|one| numbers(one)).collect(),
        };
        let jumps: Vec<_> = one
            .structure
            .kinks
            .iter()
            .map(|kink| numbers(&kink.jump))
            .collect();
        text += &format!(
            "{one:?} {:?} {:?}",
            numbers(&one.density.values),
            numbers(&one.standard_error)
        );
        text += &format!(" {variants:?} {jumps:?}\n");
    }
    text
}

#[test]
fn what_was_written_is_read_bit_for_bit() {
    // Replicates may fail, so their number varies; kinks vanish where the drift does not jump.
    let by_samples = [
        point(0.1 + 0.2, Some(3), 0),
        without_density(0.2),
        point(-1.0 / 3.0, Some(11), 1),
        point(1e-300, Some(0), 2),
        point(0.7, Some(8), 2),
    ];
    let by_schemes = [
        point(0.1, None, 2),
        point(-0.1, None, 0),
        point(0.2, Some(0), 1),
    ];
    for points in [&by_samples[..], &by_schemes] {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), points);
        let mut found = read(folder.path()).unwrap();
        for wanted in points {
            let place = found.iter().position(|point| point.value == wanted.value);
            let found = found.remove(place.unwrap());
            assert!(bits(&found) == bits(wanted), "{}", wanted.value);
        }
        assert!(found.is_empty());
    }
}

#[test]
fn a_store_in_its_final_order_holds_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let points = [point(-0.5, Some(3), 1), point(0.5, Some(9), 2)];
    write(folder.path(), &points);
    let mut store = DensityStore::new(&folder.path().join("densities.zarr"));
    let of = |point: &Point| (point.value, point.densities.clone());
    let densities = points.each_ref().map(of);
    let borrowed: Vec<_> = densities
        .iter()
        .map(|(value, d)| (*value, d.as_slice()))
        .collect();
    store.replace(&coulomb(), &borrowed).unwrap();
    let found = read(folder.path()).unwrap();
    for (found, wanted) in found.iter().zip(&points) {
        assert!(bits(found) == bits(wanted), "{}", wanted.value);
    }
    let left: Vec<_> = std::fs::read_dir(folder.path())
        .unwrap()
        .flatten()
        .collect();
    assert!(
        left.iter()
            .all(|entry| !entry.file_name().to_string_lossy().contains("zarr."))
    );
}

#[test]
fn chunks_that_are_linked_are_those_that_would_be_written() {
    let points = [
        point(0.5, Some(9), 2),
        point(-0.5, Some(3), 1),
        point(0.25, None, 2),
    ];
    let folder = tempfile::tempdir().unwrap();
    let places = ["grown", "whole"].map(|name| folder.path().join(name));
    let mut sorted = points
        .each_ref()
        .map(|point| (point.value, point.densities.as_slice()));
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (place, grown) in places.iter().zip([true, false]) {
        let mut store = DensityStore::new(place);
        for point in points.iter().filter(|_| grown) {
            store
                .append(&coulomb(), point.value, &point.densities)
                .unwrap();
        }
        store.replace(&coulomb(), &sorted).unwrap();
    }
    let [grown, whole] = places.map(|place| {
        let (mut open, mut files) = (vec![place.clone()], std::collections::BTreeMap::new());
        while let Some(folder) = open.pop() {
            for entry in std::fs::read_dir(folder).unwrap().flatten() {
                match entry.file_type().unwrap().is_dir() {
                    true => open.push(entry.path()),
                    false => {
                        let name = entry.path().strip_prefix(&place).unwrap().to_owned();
                        files.insert(name, std::fs::read(entry.path()).unwrap());
                    }
                }
            }
        }
        files
    });
    assert!(grown.len() > 20 && grown == whole);
}

#[test]
fn runs_of_earlier_versions_load_without_what_they_lack() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &[point(0.5, None, 2)]);
    let store = folder.path().join("densities.zarr");
    for name in [
        "p_y_second",
        "p_xy_second",
        "p_y_kink_0",
        "p_y_kink_1",
        "p_xy_kink_0",
        "p_xy_kink_1",
    ] {
        std::fs::remove_dir_all(store.join(name)).unwrap();
    }
    let edit = |name: &str, change: fn(String) -> String| {
        let path = folder.path().join(name);
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(path, change(text)).unwrap();
    };
    edit("points.csv", |text| {
        text.replace(",solver_error", ",unknown")
            .replace(",findings", ",unknown")
    });
    edit("run.json", |text| {
        let mut manifest: serde_json::Map<_, _> = serde_json::from_str(&text).unwrap();
        manifest.remove("sweep_file").unwrap();
        serde_json::to_string(&manifest).unwrap()
    });
    let run = StoredRun::open(folder.path()).unwrap();
    assert!(
        run.resolved().contains("from = 0.30000000000000004"),
        "{}",
        run.resolved()
    );
    let found = read(folder.path()).unwrap();
    // What was told is kept, though its numbers are not known.
    let Finding::Told(told) = &found[0].report.findings[0] else {
        panic!("{:?}", found[0].report.findings);
    };
    assert!(told.starts_with("the solver stopped before its tolerance"));
    assert!(told.contains("; no face of y falls on the switching surface at -0.1"));
    assert_eq!(found[0].densities[1].variants, Variants::None);
    assert!(found[0].densities[1].structure.kinks.is_empty());
    assert_eq!(
        found[0].densities[1].density,
        point(0.5, None, 2).densities[1].density
    );
}

#[test]
fn broken_runs_are_refused_with_their_place() {
    let folder = tempfile::tempdir().unwrap();
    assert!(matches!(
        StoredRun::open(folder.path()),
        Err(RunError::NotARun { .. })
    ));
    write(folder.path(), &[point(-0.5, None, 0), point(0.5, None, 0)]);
    let path = |name: &str| folder.path().join(name);
    let good = |name: &str| std::fs::read_to_string(path(name)).unwrap();
    let (table, manifest) = (good("points.csv"), good("run.json"));
    let with = |name: &str, text: String| {
        std::fs::write(path(name), text).unwrap();
        let error = read(folder.path()).unwrap_err();
        std::fs::write(path("points.csv"), &table).unwrap();
        std::fs::write(path("run.json"), &manifest).unwrap();
        error
    };
    for (old, new, column, value) in [
        ("\n0.5,not-converged", "\n0.5,fine", "status", "fine"),
        ("\n0.5,", "\nhalf,", "f_c", "half"),
        ("\n0.5,", "\ninf,", "f_c", "inf"),
        (
            "\n0.5,not-converged,sgcm,7",
            "\n0.5,not-converged,sgcm,-7",
            "iterations",
            "-7",
        ),
        (
            "\n0.5,not-converged,sgcm,7",
            "\n0.5,not-converged,magic,7",
            "method",
            "magic",
        ),
    ] {
        let error = with("points.csv", table.replace(old, new));
        let RunError::Row {
            line: 3,
            column: found,
            value: given,
            ..
        } = &error
        else {
            panic!("{error}");
        };
        assert_eq!((found.as_str(), given.as_str()), (column, value));
    }
    let (cut, _) = table.rsplit_once(",not-converged:").unwrap();
    assert!(
        matches!(with("points.csv", format!("{cut}\n")), RunError::Row { line: 3, column, .. } if column == "findings")
    );
    let error = with("points.csv", format!("{cut},outside:0.1;edge-mass-q:1\n"));
    assert!(
        matches!(&error, RunError::Row { line: 3, column, value, .. } if column == "findings" && value == "edge-mass-q:1"),
        "{error}"
    );
    let error = with("points.csv", table.replace("residual", "remainder"));
    assert!(matches!(error, RunError::Column { column, .. } if column == "residual"));
    let error = with("points.csv", table.replace("\n0.5,", "\n0.6,"));
    assert!(
        matches!(error, RunError::NoDensity { value: 0.6, .. }),
        "{error}"
    );
    let error = with(
        "run.json",
        manifest.replace("\"version\": \"0.", "\"version\": \"77."),
    );
    assert!(matches!(error, RunError::Version { .. }), "{error}");
    let error = with(
        "run.json",
        manifest.replace("0.30000000000000004\\n", "0.4\\n"),
    );
    assert!(matches!(error, RunError::Hash { .. }), "{error}");
    let error = with("run.json", manifest.replace("\"ending\"", "\"end\""));
    assert!(matches!(error, RunError::Manifest { .. }), "{error}");
    std::fs::remove_file(path("points.csv")).unwrap();
    assert!(
        matches!(read(folder.path()), Err(RunError::Read { path, .. }) if path.ends_with("points.csv"))
    );
}

#[test]
fn a_row_that_a_kill_left_without_its_end_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let points = [point(0.5, None, 0), point(-0.5, None, 0)];
    write(folder.path(), &points);
    let table = folder.path().join("points.csv");
    let text = std::fs::read_to_string(&table).unwrap();
    let last = text.trim_end().rfind('\n').unwrap() + 1;
    for cut in [last, last + 1, last + 9, text.len() - 1] {
        std::fs::write(&table, &text[..cut]).unwrap();
        let found = read(folder.path()).unwrap();
        assert_eq!(found.len(), 1, "{cut}");
        assert!(bits(&found[0]) == bits(&points[0]), "{cut}");
    }
}

#[test]
fn other_cells_and_other_observables_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &[point(0.5, None, 0)]);
    let run = StoredRun::open(folder.path()).unwrap();
    let points = |space: &CellSpace, observables: &[Observable]| {
        run.points(&subject(observables), (space, &[]), &["sgcm"])
            .unwrap_err()
    };
    let error = points(&space(), &[Observable::Marginal(0)]);
    assert!(
        matches!(&error, RunError::NotStored { observable, stored } if observable == "x" && stored == &["y", "xy"]),
        "{error}"
    );
    let other = Axis::uniform(-2.0, 2.0, 6).unwrap();
    let other = CellSpace::new(vec![space().axes()[0].clone(), other]).unwrap();
    let error = points(&other, &OBSERVABLES);
    assert!(
        matches!(&error, RunError::Cells { axis, .. } if axis == "y"),
        "{error}"
    );
    std::fs::remove_file(folder.path().join("densities.zarr/p_y/zarr.json")).unwrap();
    let error = points(&space(), &OBSERVABLES);
    assert!(matches!(&error, RunError::ReadStore { .. }), "{error}");
}
