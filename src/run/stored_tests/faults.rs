//! What is said of stored runs that are broken, of earlier versions, or of something else.

use super::*;

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
