//! Journals that are cut, damaged and of other sweeps.

use super::record::Found;
use super::*;
use crate::bytes::{Reader, Writer};
use crate::continuation::{
    CheckedBy, CheckedIndicator, Finding, Measure, Solution, SolveReport, every_finding,
};
use std::sync::Arc;

use crate::density::{
    Density, EstimatedDensity, Extremum, Kink, Observable, Profile, SlopeJump, Structure, Turn,
    Variants,
};
use crate::space::{Axis, CellSpace};
use crate::system::examples::coulomb;
use crate::topology::IndicatorKind;

const SWEEP: &str = "title = \"t\"\n[sweep]\npoints = 3\n[figures]\nat = [0.0]\n";

fn profile() -> Profile {
    Profile {
        extrema: vec![Extremum {
            place: 0.1,
            is_peak: true,
            density: 0.3,
            gathered_error: 1e-12,
        }],
        turns: vec![Turn {
            place: -0.1,
            is_largest: false,
            slope: 0.7,
            error: 1e-13,
        }],
        jumps: vec![SlopeJump {
            place: 0.2,
            slopes: [0.1, -0.3],
            error: 1e-14,
        }],
        curvature: Some((-1.0 / 3.0, 1e-9)),
    }
}

fn space() -> CellSpace {
    let x = Axis::uniform(-1.0, 1.0, 2).unwrap();
    CellSpace::new(vec![x, Axis::uniform(0.0, 3.0, 3).unwrap()]).unwrap()
}

fn density(observable: Observable, variants: fn(Vec<f64>) -> Variants) -> EstimatedDensity {
    let space = space();
    let axes: Vec<Axis> = (observable.axes().iter())
        .map(|&axis| space.axes()[axis].clone())
        .collect();
    let cells = axes.iter().map(Axis::count).product();
    let values: Vec<f64> = (0..cells).map(|cell| 1.0 / (cell as f64 + 3.0)).collect();
    EstimatedDensity {
        observable,
        density: Density {
            axes,
            values: values.clone(),
        },
        standard_error: vec![f64::MIN_POSITIVE; cells],
        variants: variants(values),
        structure: Structure {
            centre: Some(vec![-0.0; 1]),
            kinks: vec![Kink {
                axis: 0,
                at: 0.1,
                jump: vec![0.3],
            }],
            profile: Some(Arc::new(profile())),
        },
        negligible: 1e-9,
    }
}

fn record(value: f64) -> Record {
    let mut report = SolveReport::solved("sgcm");
    report.findings = every_finding();
    report.residual = f64::NAN;
    let measures = [("a", None, ""), ("b_x", Some(1e-300), "x^2/t")];
    report.measures = Vec::from(measures.map(|(name, error, unit)| Measure {
        name: name.to_owned(),
        value: 0.1,
        error,
        unit: unit.to_owned(),
    }));
    let mut solution = Found::from(Solution::without_density(report));
    solution.densities = vec![
        density(Observable::Marginal(0), Variants::Scheme),
        density(Observable::Joint(0, 1), |one| {
            Variants::Jackknife(vec![one; 3])
        }),
    ];
    Record {
        value,
        seconds: 0.5,
        solved: Ok(solution),
        memory: vec![1, 2, 3],
    }
}

fn words(record: &Record) -> String {
    let of = |solution: &Found| format!("{:?} {:?}", solution.report, solution.densities);
    let solved = record.solved.as_ref().map(of);
    format!(
        "{} {} {solved:?} {:?}",
        record.value, record.seconds, record.memory
    )
}

fn open(folder: &Path, sweep: &str) -> Result<Journal, RunError> {
    Journal::open(folder, sweep, &coulomb(), &["sgcm"])
}

/// A journal of so many solves.
fn written(folder: &Path, solves: usize) {
    let mut journal = Journal::create(folder, SWEEP).unwrap();
    for solve in 0..solves {
        journal.add(&record(solve as f64), &coulomb()).unwrap();
    }
}

#[test]
fn solves_come_back_bit_for_bit_and_go_on() {
    let folder = tempfile::tempdir().unwrap();
    written(folder.path(), 2);
    let mut journal = open(folder.path(), SWEEP).unwrap();
    for (index, stored) in journal.stored.iter().enumerate() {
        assert_eq!(words(stored), words(&record(index as f64)));
    }
    let failed = Record {
        solved: Err("no".to_owned()),
        ..record(2.0)
    };
    journal.add(&failed, &coulomb()).unwrap();
    let checks = checks();
    for check in &checks {
        journal.add_check(check).unwrap();
    }
    let journal = open(folder.path(), SWEEP).unwrap();
    assert_eq!(journal.solves(), 3);
    assert_eq!(words(&journal.stored[2]), words(&failed));
    assert_eq!(journal.checks, checks);
}

/// What checks may have seen: a value, nothing, a failure.
fn checks() -> [KeptCheck; 3] {
    let check = |by, indicator: Option<f64>, failure: Option<&str>, left| KeptCheck {
        seen: CheckedIndicator {
            by,
            value: -0.0,
            observable: 1,
            kind: IndicatorKind::ALL[1],
            place: vec![0.1, f64::MIN_POSITIVE],
            indicator,
            failure: failure.map(str::to_owned),
        },
        left,
    };
    let (finer, closed) = (CheckedBy::FinerCells, CheckedBy::ClosedEnds);
    [
        check(finer, Some(0.1 + 0.2), None, Some(vec![1, 0, 255])),
        check(closed, None, None, Some(Vec::new())),
        check(finer, None, Some("no, \"never\""), None),
    ]
}

#[test]
fn a_journal_that_is_cut_anywhere_keeps_its_whole_records() {
    let folder = tempfile::tempdir().unwrap();
    written(folder.path(), 2);
    let path = folder.path().join(NAME);
    let whole = std::fs::read(&path).unwrap();
    let mut last = 2;
    for length in (0..whole.len()).rev().step_by(7) {
        std::fs::write(&path, &whole[..length]).unwrap();
        match open(folder.path(), SWEEP) {
            Ok(journal) => {
                assert!(journal.solves() <= last && journal.solves() < 2, "{length}");
                last = journal.solves();
            }
            // Without its first record it is of no sweep.
            Err(error) => assert!(
                matches!(error, RunError::Journal { .. }) && last == 0,
                "{error}"
            ),
        }
    }
    // What is behind a cut is written over.
    std::fs::write(&path, &whole[..whole.len() - 1]).unwrap();
    let mut journal = open(folder.path(), SWEEP).unwrap();
    journal.add(&record(5.0), &coulomb()).unwrap();
    let journal = open(folder.path(), SWEEP).unwrap();
    let values: Vec<f64> = journal.stored.iter().map(|record| record.value).collect();
    assert_eq!(values, [0.0, 5.0]);
}

#[test]
fn a_flipped_byte_ends_what_is_believed() {
    let folder = tempfile::tempdir().unwrap();
    written(folder.path(), 2);
    let path = folder.path().join(NAME);
    let whole = std::fs::read(&path).unwrap();
    for place in (0..whole.len()).step_by(11) {
        let mut bytes = whole.clone();
        bytes[place] ^= 0x10;
        std::fs::write(&path, &bytes).unwrap();
        if let Ok(journal) = open(folder.path(), SWEEP) {
            assert!(journal.solves() < 2, "{place}");
        }
    }
}

#[test]
fn another_sweep_is_refused_with_every_difference() {
    let folder = tempfile::tempdir().unwrap();
    written(folder.path(), 1);
    let other = SWEEP.replace("points = 3", "points = 4\nto = 1.5");
    let error = open(folder.path(), &other).unwrap_err().to_string();
    for words in [
        "sweep.points = 3 there, 4 here",
        "sweep.to = not given there, 1.5 here",
    ] {
        assert!(error.contains(words), "{error}");
    }
    let drawn_otherwise = SWEEP.replace("\"t\"", "\"u\"").replace("[0.0]", "[1.0]");
    assert_eq!(open(folder.path(), &drawn_otherwise).unwrap().solves(), 1);
    let error = open(&folder.path().join("nowhere"), SWEEP).unwrap_err();
    assert!(matches!(error, RunError::NoJournal { .. }));
}

#[test]
fn a_finding_without_numbers_is_kept_in_words() {
    let told = vec![Finding::Told("as it was; told:1".to_owned())];
    let mut one = record(0.0);
    if let Ok(solution) = &mut one.solved {
        solution.report.findings = told.clone();
    }
    let mut writer = Writer::new();
    one.write(&mut writer, &coulomb());
    let content = writer.finish();
    let back = Record::read(&mut Reader::new(&content), &coulomb(), &["sgcm"]).unwrap();
    assert_eq!(back.solved.unwrap().report.findings, told);
}
