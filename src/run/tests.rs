//! The files of a run, written and read back.

use super::points_table::read_points;
use super::zarr::StoredArray;
use super::*;
use crate::continuation::measure::{
    DEVIATION, EDGE_MASS, ESCAPE_RATE, FACTORISATIONS, MAP_STEP, MEAN, NEGATIVE_MASS,
    NUMERICAL_DIFFUSION, TIME_STEP_BIAS,
};
use crate::continuation::{
    CellCheck, Finding, Measure, MeasureColumn, MeasureKind, Point, PointStatus, SolveReport,
    Subject, SweepResult,
};
use crate::density::{Density, EstimatedDensity, Observable};
use crate::method::DerivedMeasure;
use crate::space::Axis;
use crate::system::test_families::coulomb;
use crate::topology::{Detection, Feature, FeatureErrors, FeatureKind, Signature, Verdict};

pub(super) fn subject() -> Subject {
    Subject {
        family: coulomb(),
        observables: vec![Observable::Marginal(0), Observable::Joint(0, 1)],
        measures: Vec::new(),
        cell_check: CellCheck::Needless,
    }
}

fn measures(solved: bool) -> Vec<Measure> {
    let mut measures = vec![
        ESCAPE_RATE.measure("", if solved { 0.0 } else { f64::NAN }),
        EDGE_MASS.measure("x", 0.0),
        EDGE_MASS.measure("y", 1e-5),
        NUMERICAL_DIFFUSION.measure("x", 1e-4),
        NUMERICAL_DIFFUSION.measure("y", 2e-4),
        MAP_STEP.measure("", 6.25),
    ];
    for axis in ["x", "y"].into_iter().filter(|_| solved) {
        measures.extend([MEAN.measure(axis, 0.0), DEVIATION.measure(axis, 1.0)]);
    }
    measures
}

fn point(value: f64, solved: bool) -> Point {
    let x = Axis::uniform(-1.0, 1.0, 2).unwrap();
    let y = Axis::uniform(0.0, 3.0, 3).unwrap();
    let estimate = |observable, axes: Vec<Axis>, cells: usize| EstimatedDensity {
        standard_error: vec![0.5; cells],
        ..EstimatedDensity::new(
            observable,
            Density {
                axes,
                values: (0..cells).map(|cell| value + cell as f64).collect(),
            },
        )
    };
    let detection = Detection {
        indicators: Vec::new(),
        is_seen: true,
        signature: Signature {
            peaks: 2,
            craters: 1,
            ..Signature::default()
        },
        features: vec![Feature {
            kind: FeatureKind::Peak,
            position: vec![0.25, 1.5],
            density: 2.0,
            persistence: 1.0,
            standard_error: 0.1,
            significance: 3.0,
            verdict: Verdict::Present,
            partner: None,
            errors: FeatureErrors {
                position: vec![0.125, 0.0625],
                density: Some(0.5),
            },
        }],
    };
    let kept = |count: usize| if solved { count } else { 0 };
    Point {
        value,
        report: SolveReport {
            status: if solved {
                PointStatus::Solved
            } else {
                PointStatus::NoSteadyState
            },
            iterations: 7,
            residual: 1e-12,
            measures: measures(solved),
            findings: vec![
                Finding::Outside { share: 0.125 },
                Finding::EdgeMass {
                    axis: 1,
                    mass: 0.5,
                    range: [-8.0, 8.0],
                },
            ],
            ..SolveReport::solved("sgcm")
        },
        densities: [
            estimate(Observable::Marginal(0), vec![x.clone()], 2),
            estimate(Observable::Joint(0, 1), vec![x, y], 6),
        ][..kept(2)]
            .to_vec(),
        detections: vec![detection; kept(2)],
        distance: None,
        seconds: 0.25,
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

fn read_array(store: &std::path::Path, name: &str) -> (Vec<u64>, Vec<f64>) {
    let array = StoredArray::open(&store.join(name)).unwrap();
    let rows = (0..array.shape()[0]).flat_map(|index| array.row(index).unwrap());
    (array.shape().to_vec(), rows.collect())
}

#[test]
fn points_have_the_columns_of_the_contract_and_no_nan() {
    let points = [point(0.01, true), point(-0.02, false)];
    let text = points_csv(&subject(), &points).unwrap();
    let mut lines = text.lines();
    assert_eq!(
        lines.next().unwrap(),
        "f_c,status,method,iterations,residual,escape_rate,negative_mass,edge_mass,mean_x,sd_x,mean_y,sd_y,\
         peaks_x,peaks_xy,craters_xy,distance,seconds,map_step,factorisations,numerical_diffusion_x,numerical_diffusion_y,solver_error,time_step_bias,warnings,findings,rings_xy,\
         mean_x_error,sd_x_error,mean_y_error,sd_y_error"
    );
    let first = lines.next().unwrap();
    assert!(first.starts_with("-0.02,no-steady-state,sgcm,7,1e-12,,0,1e-5,,,,,,,,"));
    assert!(
        first.contains(",\"the trajectories spend 12.5 % of their time outside Ω: ")
            && first.ends_with(" [-8, 8]\",outside:0.125;edge-mass-y:0.5:-8:8,,,,,"),
        "{first}"
    );
    assert!(
        lines
            .next()
            .unwrap()
            .starts_with("0.01,solved,sgcm,7,1e-12,0,0,1e-5,0,1,0,1,2,2,1,")
    );
    assert!(!text.contains("NaN"));
}

#[test]
fn features_carry_both_coordinates_and_their_errors() {
    let text = features_csv(&subject(), &[point(0.01, true)]).unwrap();
    assert!(text.contains("0.01,xy,peak,0.25,2,1,3,1.5,0.1,present,0.125,0.5,0.0625\n"));
}

#[test]
fn the_store_reads_back_in_ascending_order_with_names() {
    let folder = tempfile::tempdir().unwrap();
    let mut run = RunFolder::at(folder.path());
    let mut points = Vec::new();
    for (value, solved) in [(0.01, true), (0.0, false), (-0.02, true)] {
        let point = point(value, solved);
        run.add_points(&subject(), std::slice::from_ref(&point))
            .unwrap();
        points.push(point);
    }
    let store = folder.path().join("densities.zarr");
    assert!(!store.exists());
    points.sort_by(|a, b| a.value.total_cmp(&b.value));
    run.finish(&result(points), "").unwrap();
    assert_eq!(read_array(&store, "f_c"), (vec![2], vec![-0.02, 0.01]));
    let (shape, values) = read_array(&store, "p_xy");
    assert_eq!(shape, [2, 2, 3]);
    assert_eq!(values[..2], [-0.02, 0.98]);
    assert_eq!(values[6..8], [0.01, 1.01]);
    assert_eq!(read_array(&store, "y").1, [0.5, 1.5, 2.5]);
    assert_eq!(read_array(&store, "y_edges").1, [0.0, 1.0, 2.0, 3.0]);
    assert_eq!(read_array(&store, "p_x_error").1, [0.5; 4]);
    let root: serde_json::Value =
        serde_json::from_slice(&std::fs::read(store.join("zarr.json")).unwrap()).unwrap();
    let names = &root["consolidated_metadata"]["metadata"]["p_xy"]["dimension_names"];
    assert_eq!(names, &serde_json::json!(["f_c", "x", "y"]));
}

#[test]
fn tables_grow_by_rows_and_end_in_ascending_order() {
    let folder = tempfile::tempdir().unwrap();
    let mut run = RunFolder::at(folder.path());
    let (mut points, mut before) = (Vec::new(), [String::new(), String::new()]);
    for value in [0.3, 0.1, 0.2, 0.25] {
        let point = point(value, value != 0.2);
        run.add_points(&subject(), std::slice::from_ref(&point))
            .unwrap();
        points.push(point);
        // What was written is never written again: the work of a point does not grow with their number.
        for (name, before) in ["points.csv", "features.csv"].iter().zip(&mut before) {
            let now = std::fs::read_to_string(folder.path().join(name)).unwrap();
            assert!(now.starts_with(before.as_str()), "{name}: {now}");
            *before = now;
        }
    }
    let rows = |text: &str| text.lines().skip(1).map(str::to_owned).collect::<Vec<_>>();
    let first = |rows: Vec<String>| -> Vec<String> {
        let value = |row: String| row.split(',').next().map(str::to_owned);
        rows.into_iter().filter_map(value).collect()
    };
    assert_eq!(first(rows(&before[0])), ["0.3", "0.1", "0.2", "0.25"]);
    points.sort_by(|a, b| a.value.total_cmp(&b.value));
    run.finish(&result(points), "").unwrap();
    for (name, before) in ["points.csv", "features.csv"].iter().zip(before) {
        let now = std::fs::read_to_string(folder.path().join(name)).unwrap();
        let mut wanted = rows(&before);
        wanted.sort();
        assert_eq!(rows(&now), wanted, "{name}");
    }
}

#[test]
fn every_earlier_run_is_kept_and_other_files_are_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("notes.txt"), "mine").unwrap();
    for text in ["first", "second", "third"] {
        let open = || JobFolder::open(folder.path(), Layout::SWEEP, false);
        let run = open().unwrap();
        std::fs::write(folder.path().join("run.json"), text).unwrap();
        std::fs::write(folder.path().join("points.csv"), text).unwrap();
        let error = open().unwrap_err();
        assert!(matches!(error, RunError::InUse { .. }), "{error}");
        assert_eq!(run.kept().is_some(), text != "first");
    }
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    assert_eq!(read("points.csv"), "third");
    assert_eq!(read("previous/1/points.csv"), "first");
    assert_eq!(read("previous/2/points.csv"), "second");
    assert_eq!(read("notes.txt"), "mine");
}

#[test]
fn tables_for_people_round_to_the_error() {
    use crate::continuation::{Doubt, ErrorParts, Label, Located, Zero};
    use crate::topology::IndicatorKind;
    let zero = Zero {
        indicator: IndicatorKind::CURVATURE,
        place: vec![0.0],
        slope: -1.0,
        parts: ErrorParts::default(),
        is_settled: false,
    };
    let row = Label::Bifurcation(Box::new(Located {
        label: "PB1".into(),
        value: -0.012345678,
        error: 0.00045,
        lower: -0.0127,
        upper: -0.0119,
        observable: Observable::Marginal(1),
        before: Signature::of_peaks(2),
        after: Signature::of_peaks(1),
        zero: Some(zero),
        is_several: false,
        doubts: vec![Doubt::Jump],
    }));
    let end = Label::End {
        label: "EP1".into(),
        value: -0.03,
    };
    let rows = [end, row];
    insta::assert_snapshot!(bifurcations_markdown(&coulomb(), &rows), @r"
    | label | f_c | bracket | observable | before | after | change | status |
    | --- | --- | --- | --- | --- | --- | --- | --- |
    | PB1 | -0.01235 ± 0.00045 | [-0.01270, -0.01190] | y | 2 peaks | 1 peak | symmetric merger | unresolved |
    ");
    insta::assert_snapshot!(bifurcations_tex(&coulomb(), &rows), @r"
    % needs \usepackage{booktabs}
    \begin{tabular}{lllllll}
    \toprule
    label & $f_{c}$ & density & below & above & change & status \\
    \midrule
    PB1 & $-0.01235 \pm 0.00045$ & $p(\dot{x})$ & 2 peaks & 1 peak & symmetric merger & unresolved \\
    \bottomrule
    \end{tabular}
    ");
    let csv = bifurcations_csv(&coulomb(), &rows).unwrap();
    assert_eq!(
        csv.lines().next().unwrap(),
        "label,parameter,value,error,lower,upper,observable,before,after,status,change,method,error_solver,error_grid,error_sampling,error_leak,reason"
    );
    assert!(
        csv.contains("PB1,f_c,-0.012345678,0.00045,-0.0127,-0.0119,y,2 peaks,1 peak,unresolved")
    );
    let json: serde_json::Value =
        serde_json::from_str(&bifurcations_json(&coulomb(), &rows).unwrap()).unwrap();
    assert_eq!(json[1]["value"], -0.012345678);
    assert!(json[0]["observable"].is_null());
}

#[test]
fn derived_measures_and_errors_of_moments_are_the_last_columns_and_are_read_back() {
    let kind = MeasureKind {
        word: "spread",
        follows: false,
        unit: "1",
        meaning: "",
    };
    let of = "xy".to_owned();
    let subject = Subject {
        measures: vec![MeasureColumn { kind, of }],
        ..subject()
    };
    let mut known = point(0.01, true);
    let measure = Measure {
        error: Some(0.25),
        ..kind.measure("xy", 1.5)
    };
    known.report.measures.push(measure.clone());
    let deviation = Measure {
        error: Some(0.125),
        ..DEVIATION.measure("y", 3.0)
    };
    known.report.put(deviation.clone());
    let text = points_csv(&subject, &[known, point(0.02, false)]).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let name = &measure.name;
    let errors = "mean_x_error,sd_x_error,mean_y_error,sd_y_error";
    assert!(lines[0].ends_with(&format!(",rings_xy,{name},{name}_error,{errors}")));
    assert!(lines[1].ends_with(",1.5,0.25,,,,0.125") && lines[2].ends_with(",,,,,,"));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("points.csv");
    std::fs::write(&path, &text).unwrap();
    let read = read_points(&path, &subject, &["sgcm"], true).unwrap();
    assert!(read[0].report.measures.contains(&measure));
    assert!(read[0].report.measures.contains(&deviation));
    assert_eq!(read[1].report.measure(name), None);
}

#[test]
fn every_measure_has_its_row_in_the_documents() {
    let page = include_str!("../../docs/run-folder.md");
    let derived = DerivedMeasure::ALL.map(|one| one.kind);
    let known = [
        ESCAPE_RATE,
        NEGATIVE_MASS,
        EDGE_MASS,
        MEAN,
        DEVIATION,
        MAP_STEP,
        FACTORISATIONS,
        NUMERICAL_DIFFUSION,
        TIME_STEP_BIAS,
    ];
    for kind in known.into_iter().chain(derived) {
        let is_row = |line: &&str| line.starts_with(&format!("| `{}", kind.word));
        let row = page.lines().find(is_row).unwrap_or(kind.word);
        let unit = kind.unit.replace("{}", "x");
        assert!(
            row.ends_with(&format!("` | {unit} | {} |", kind.meaning)),
            "{row}"
        );
    }
}
