//! A run written and read back: densities bit for bit, whatever they carry, and what is said of broken files.

mod faults;
mod one_axis;
mod range_ends;
mod unfinished;

use super::store::write_store;
use super::zarr::StoredArray;
use super::*;
use crate::continuation::measure::{
    DEVIATION, EDGE_MASS, ESCAPE_RATE, FACTORISATIONS, MAP_STEP, MEAN, NEGATIVE_MASS,
    NUMERICAL_DIFFUSION, TIME_STEP_BIAS,
};
use crate::continuation::{CellCheck, Finding, Measure, Point, PointStatus, SolveReport, Subject};

use crate::density::{Density, EstimatedDensity, Kink, Observable, Structure, Variants};
use crate::space::{Axis, CellSpace, Grading};
use crate::system::test_families::coulomb;

const OBSERVABLES: [Observable; 2] = [Observable::Marginal(1), Observable::Joint(0, 1)];

fn subject(observables: &[Observable]) -> Subject {
    Subject {
        family: coulomb(),
        observables: observables.to_vec(),
        measures: Vec::new(),
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
                ..Structure::default()
            },
            // A number that readers of JSON may take for its neighbour.
            negligible: 4.806865314961215e-8,
            truncation: Default::default(),
        }
    });
    Point {
        value,
        report: SolveReport {
            status: PointStatus::NotConverged,
            iterations: 7,
            residual: 1.0 / 3e13,
            solver_error: 2.0 / 3e9,
            measures: measures(true),
            findings: vec![
                Finding::NotConverged { error: 1e-3 / 7.0 },
                Finding::SurfaceOffFaces { axis: 1, at: -0.1 },
            ],
            ..SolveReport::solved("sgcm")
        },
        densities: densities.to_vec(),
        detections: Vec::new(),
        distance: None,
        seconds: 0.25,
    }
}

/// Those of a table's row, in the order of its columns.
fn measures(solved: bool) -> Vec<Measure> {
    let mut measures = vec![
        ESCAPE_RATE.measure("", 0.1 + 0.2),
        NEGATIVE_MASS.measure("", 1e-300),
    ];
    if solved {
        measures.push(EDGE_MASS.measure("", 1e-5 / 3.0));
        for axis in ["x", "y"] {
            measures.push(MEAN.measure(axis, -1.0 / 3.0));
            measures.push(DEVIATION.measure(axis, 2.0 / 3.0));
        }
        measures.push(MAP_STEP.measure("", 6.25 / 3.0));
    }
    measures.push(FACTORISATIONS.measure("", 2.0));
    if solved {
        measures.push(NUMERICAL_DIFFUSION.measure("x", 0.1 / 3.0));
        measures.push(NUMERICAL_DIFFUSION.measure("y", 0.2 / 3.0));
    }
    measures.push(TIME_STEP_BIAS.measure("", 1e-3 / 7.0));
    measures
}

/// A point without a steady state.
fn without_density(value: f64) -> Point {
    let mut point = point(value, Some(0), 0);
    point.report.status = PointStatus::NoSteadyState;
    point.report.measures = measures(false);
    point.densities = Vec::new();
    point
}

const RESOLVED: &str = "title = \"t\"\nfrom = 0.30000000000000004\n";

fn write(folder: &std::path::Path, points: &[Point]) {
    let mut run = RunFolder::at(folder);
    for point in points {
        run.add_points(&subject(&OBSERVABLES), std::slice::from_ref(point))
            .unwrap();
    }
    let densities = points.iter().filter(|point| !point.densities.is_empty());
    let densities =
        densities.map(|point| (point.value, &point.densities[..], &point.report.fields[..]));
    let store = folder.join("densities.zarr");
    write_store(&store, &coulomb(), &densities.collect::<Vec<_>>()).unwrap();
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
    let mut text = format!("{:?} {:?}\n", point.value, point.report);
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
        let assert_read = || {
            let mut found = read(folder.path()).unwrap();
            for wanted in points {
                let place = found.iter().position(|point| point.value == wanted.value);
                let found = found.remove(place.unwrap());
                assert!(bits(&found) == bits(wanted), "{}", wanted.value);
            }
            assert!(found.is_empty());
        };
        assert_read();
        as_early_versions_did(&folder.path().join("densities.zarr"));
        assert_read();
    }
}

#[test]
fn a_value_is_a_file_in_small_stores_and_where_few_values_have_numbers() {
    for (count, of_all) in [(3, vec!["0", "1", "2"]), (40, vec!["0"])] {
        let kinked = |index: usize| usize::from(index == 2);
        let points: Vec<Point> = (0..count)
            .map(|index| point(index as f64, None, kinked(index)))
            .collect();
        let stored: Vec<_> = (points.iter())
            .map(|point| (point.value, &point.densities[..], &[][..]))
            .collect();
        let folder = tempfile::tempdir().unwrap();
        let store = folder.path().join("store");
        write_store(&store, &coulomb(), &stored).unwrap();
        let chunks = |array: &str| {
            let names = std::fs::read_dir(store.join(array).join("c")).unwrap();
            let names = names.map(|entry| entry.unwrap().file_name().into_string().unwrap());
            let mut names: Vec<String> = names.collect();
            names.sort();
            names
        };
        for array in ["p_y", "p_y_error", "p_xy", "p_xy_second"] {
            assert_eq!(chunks(array), of_all, "{array} at {count} values");
        }
        assert_eq!(chunks("p_xy_kink_0"), ["2"], "one of {count} values");
        let kinks = StoredArray::open(&store.join("p_xy_kink_0")).unwrap();
        assert_eq!(
            (kinks.shape()[0], kinks.row(1).unwrap()),
            (count as u64, vec![])
        );
        assert_eq!(kinks.row(2).unwrap().len(), 3);
    }
}

/// Stores of early versions had a chunk a value, of eight replicates at most, and room for more values.
fn as_early_versions_did(store: &std::path::Path) {
    let names = std::fs::read_dir(store).unwrap().flatten();
    for folder in names.map(|entry| entry.path()).filter(|path| path.is_dir()) {
        let array = StoredArray::open(&folder).unwrap();
        let about = std::fs::read(folder.join("zarr.json")).unwrap();
        let mut about: serde_json::Value = serde_json::from_slice(&about).unwrap();
        let mut shape = array.shape().to_vec();
        let rows: Vec<Vec<f64>> = (0..shape[0])
            .map(|index| array.row(index).unwrap())
            .collect();
        std::fs::remove_dir_all(folder.join("c")).unwrap();
        let mut chunk = shape.clone();
        let rest: u64 = shape.iter().skip(1).product();
        let write = |name: &str, numbers: &[f64], length: u64| {
            let mut numbers = numbers.to_vec();
            numbers.resize(length as usize, f64::NAN);
            let bytes: Vec<u8> = numbers.iter().flat_map(|one| one.to_le_bytes()).collect();
            let path = folder.join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            // A chunk of NaN was not written.
            if numbers.iter().any(|number| !number.is_nan()) {
                std::fs::write(path, bytes).unwrap();
            }
        };
        let name = folder.file_name().unwrap().to_str().unwrap();
        let zeros = |count: usize| "/0".repeat(count);
        if shape.len() == 1 && !name.contains("_kink") {
            let is_swept = name == "f_c";
            chunk[0] = if is_swept { 1024 } else { shape[0] };
            shape[0] = if is_swept { 64 } else { shape[0] };
            write("c/0", &rows.concat(), chunk[0]);
        } else {
            chunk[0] = 1;
            shape[0] = 64;
            let is_replicates = name.ends_with("_replicate");
            let cells = if is_replicates { rest / shape[1] } else { rest };
            let length = if is_replicates { 8 * cells } else { cells };
            for (index, row) in rows.iter().enumerate() {
                for (second, part) in row.chunks(length as usize).enumerate() {
                    let second = if shape.len() > 1 {
                        format!("/{second}")
                    } else {
                        String::new()
                    };
                    let rest = zeros(shape.len().saturating_sub(2));
                    write(&format!("c/{index}{second}{rest}"), part, length);
                }
            }
            if is_replicates {
                chunk[1] = 8;
            }
        }
        about["shape"] = shape.into();
        about["chunk_grid"]["configuration"]["chunk_shape"] = chunk.into();
        std::fs::write(folder.join("zarr.json"), about.to_string()).unwrap();
    }
}
