//! Exports, read back by a library of the format and byte by byte.

use super::*;
use crate::continuation::measure::{DEVIATION, MEAN};
use crate::continuation::{Measure, SolveReport};
use crate::density::{Density, Observable};
use crate::run::tests::subject;
use crate::space::Axis;

/// Densities of 2 and 2 × 3 cells whose values are their numbers.
fn point(value: f64, solved: bool) -> Point {
    let axes = [
        Axis::uniform(-1.0, 1.0, 2).unwrap(),
        Axis::uniform(0.0, 3.0, 3).unwrap(),
    ];
    let density = |observable: Observable| {
        let axes: Vec<Axis> = observable
            .axes()
            .iter()
            .map(|&axis| axes[axis].clone())
            .collect();
        let cells: usize = axes.iter().map(Axis::count).product();
        let values: Vec<f64> = (0..cells).map(|cell| value + cell as f64).collect();
        EstimatedDensity {
            standard_error: vec![0.25; cells],
            variants: Variants::Scheme(values.iter().map(|value| -value).collect()),
            ..EstimatedDensity::new(observable, Density { axes, values })
        }
    };
    let densities = subject().observables.into_iter().map(density);
    let mut report = SolveReport::solved("generator");
    for axis in ["x", "y"].into_iter().filter(|_| solved) {
        report.add(&MEAN, axis, 0.5);
        report.put(Measure {
            error: Some(0.25),
            ..DEVIATION.measure(axis, 2.0)
        });
    }
    Point {
        value,
        report,
        densities: densities.filter(|_| solved).collect(),
        detections: Vec::new(),
        distance: None,
        seconds: 0.0,
    }
}

fn result(points: Vec<Point>) -> SweepResult {
    SweepResult {
        subject: subject(),
        points,
        labels: Vec::new(),
        checks: None,
        looks: Vec::new(),
        interrupted: false,
    }
}

fn exported(format: ExportFormat) -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("export");
    let points = [point(0.125, true), point(0.25, false), point(0.5, true)];
    export(&result(points.to_vec()), "a title", format, &path).unwrap();
    (folder, path)
}

#[test]
fn netcdf_holds_every_array_with_its_dimensions() {
    let (_folder, path) = exported(ExportFormat::NetCdf);
    let mut file = netcdf3::FileReader::open(&path).unwrap();
    assert_eq!(
        file.data_set().get_global_attr_as_string("title"),
        Some("a title".to_owned())
    );
    let names = |array: &str| file.data_set().get_var(array).unwrap().dim_names();
    assert_eq!(names("p_xy"), ["f_c", "x", "y"]);
    assert_eq!(names("x_edges"), ["x_edges"]);
    let text = |name: &str| file.data_set().get_global_attr_as_string(name).unwrap();
    assert!(text("equations").contains("f_c"), "{}", text("equations"));
    assert!(text("parameters").contains("\"kappa\":"));
    assert!(text("changes").starts_with("label,parameter,value,error"));
    let p_x = file.data_set().get_var("p_x").unwrap();
    let least = p_x.get_attr_f64("valid_min");
    assert_eq!(least, Some(&[0.0][..]));
    let x = file.data_set().get_var("x").unwrap();
    assert_eq!(x.get_attr_as_string("bounds"), Some("x_bounds".to_owned()));
    assert_eq!(names("x_bounds"), ["x", "bounds"]);
    let mut read = |name: &str| file.read_var_f64(name).unwrap();
    assert_eq!(read("x_bounds"), [-1.0, 0.0, 0.0, 1.0]);
    assert_eq!(read("f_c"), [0.125, 0.5]);
    assert_eq!(read("x"), [-0.5, 0.5]);
    assert_eq!(read("y_edges"), [0.0, 1.0, 2.0, 3.0]);
    assert_eq!(read("p_x"), [0.125, 1.125, 0.5, 1.5]);
    assert_eq!(read("p_x_second"), [-0.125, -1.125, -0.5, -1.5]);
    assert_eq!(read("p_xy")[6..], [0.5, 1.5, 2.5, 3.5, 4.5, 5.5]);
    assert_eq!(read("p_xy_error"), [0.25; 12]);
    assert_eq!((read("mean_y"), read("sd_y")), (vec![0.5; 2], vec![2.0; 2]));
    assert_eq!(read("sd_y_error"), [0.25; 2]);
    assert!(read("mean_y_error").iter().all(|error| error.is_nan()));
}

#[test]
fn densities_are_above_zero_and_keep_their_integral() {
    let mut one = point(0.5, true).densities.remove(0);
    one.density.values = vec![-0.25, 1.25];
    one.standard_error = vec![0.125, 0.25];
    assert_eq!(one.above_zero(), [vec![0.0, 1.0], vec![0.1, 0.2]]);
    one.density.values = vec![0.25, 0.5];
    assert_eq!(one.above_zero(), [vec![0.25, 0.5], vec![0.125, 0.25]]);
}

#[test]
fn netcdf_says_what_it_cannot_hold() {
    let array = |name: &str, values: Vec<f64>| NamedArray::line(name, values, String::new());
    let twice = NamedArray {
        dimensions: vec![("x".to_owned(), 1)],
        ..array("other", vec![0.0])
    };
    for (second, word) in [(array("x", vec![0.0; 2]), "`x`"), (twice, "two lengths")] {
        let data = DataSet {
            attributes: Vec::new(),
            arrays: vec![array("x", vec![0.0; 2]), second],
        };
        let folder = tempfile::tempdir().unwrap();
        let error = netcdf::write(&data, &folder.path().join("export.nc")).unwrap_err();
        assert!(error.to_string().contains(word), "{error}");
        assert_eq!(folder.path().read_dir().unwrap().count(), 0);
    }
}

#[test]
fn tables_have_a_row_a_cell() {
    let (_folder, path) = exported(ExportFormat::Csv);
    let table = |name: &str| std::fs::read_to_string(path.join(name)).unwrap();
    assert_eq!(
        table("p_x.csv"),
        "f_c,x,p_x,p_x_error\n0.125,-0.5,0.125,0.25\n0.125,0.5,1.125,0.25\n0.5,-0.5,0.5,0.25\n0.5,0.5,1.5,0.25\n"
    );
    let joint = table("p_xy.csv");
    assert!(joint.starts_with(
        "f_c,x,y,p_xy,p_xy_error\n0.125,-0.5,0.5,0.125,0.25\n0.125,-0.5,1.5,1.125,0.25\n"
    ));
    assert_eq!(joint.lines().count(), 1 + 12);
}

#[test]
fn tables_of_fields_have_a_row_a_cell_where_the_field_is_known() {
    let folder = tempfile::tempdir().unwrap();
    let axes = point(0.0, true).densities[1].density.axes.clone();
    let mut points = [point(0.125, true), point(0.5, true)];
    points[1]
        .report
        .fields
        .push(crate::continuation::StateField {
            name: "exit_committor".to_owned(),
            axes,
            values: vec![0.0, 0.25, 0.5, f64::NAN, 0.75, 1.0],
            errors: vec![0.125; 6],
        });
    export(
        &result(points.to_vec()),
        "",
        ExportFormat::Csv,
        folder.path(),
    )
    .unwrap();
    let table = std::fs::read_to_string(folder.path().join("exit_committor.csv")).unwrap();
    assert!(table.starts_with(
        "f_c,x,y,exit_committor,exit_committor_error\n0.5,-0.5,0.5,0,0.125\n0.5,-0.5,1.5,0.25,0.125\n"
    ));
    assert_eq!(table.lines().count(), 1 + 5);
}

#[test]
fn a_run_without_densities_has_nothing_to_export() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("export");
    let points = [point(0.25, false)];
    let error = export(&result(points.to_vec()), "", ExportFormat::NetCdf, &path).unwrap_err();
    assert!(matches!(error, RunError::NothingToExport));
    assert!(!path.exists());
}

#[test]
fn what_a_solver_leaves_below_zero_is_zero_and_the_run_keeps_it() {
    let mut one = point(0.5, true);
    one.densities[0].density.values = vec![-1e-18, -0.0];
    let data = DataSet::new(&result(vec![one]), "").unwrap();
    let p_x = data
        .arrays
        .iter()
        .find(|array| array.name == "p_x")
        .unwrap();
    assert!(p_x.values.iter().all(|value| *value == 0.0), "{p_x:?}");
}
