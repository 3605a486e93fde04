//! Journals that are cut, damaged and of other sweeps; sessions that go on from them.

mod sessions;

use super::kept::KeptSolution;
use super::*;
use crate::cancellation::Cancellation;
use crate::continuation::{
    CellCheck, DensitySource, Measure, Point, Sensitivity, Session, Solution, SolveReport, Subject,
    every_finding,
};
use crate::density::{
    Density, EstimatedDensity, Extremum, Kink, Observable, Profile, SlopeJump, Structure, Turn,
    Variants,
};
use crate::space::{Axis, CellSpace};
use crate::system::test_families::coulomb;
use kept::Kept;

const SWEEP: &str = "title = \"t\"\n[sweep]\npoints = 3\n[figures]\nat = [0.0]\n";

fn profile() -> Profile {
    Profile {
        extrema: vec![Extremum {
            place: 0.1,
            is_peak: true,
            density: 0.3,
            log_density: 0.3f64.ln(),
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
        ends: [Some(f64::INFINITY), None],
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
            is_spread: true,
            own_ends: vec![[true, false]],
        },
        negligible: 1e-9,
        truncation: Default::default(),
    }
}

fn kept() -> Kept {
    let mut report = SolveReport::solved("sgcm");
    report.findings = every_finding();
    report.residual = f64::from_bits(0x7ff8_0000_0000_0001);
    let measures = [("a", None, ""), ("b_x", Some(1e-300), "x^2/t")];
    report.measures = Vec::from(measures.map(|(name, error, unit)| Measure {
        name: name.to_owned(),
        value: -0.0,
        error,
        unit: unit.to_owned(),
    }));
    let solution = Solution {
        report,
        densities: vec![
            density(Observable::Marginal(0), Variants::Scheme),
            density(Observable::Joint(0, 1), |one| {
                Variants::Jackknife(vec![one; 3])
            }),
        ],
        sensitivity: None,
    };
    Kept {
        seconds: 0.5,
        solved: Ok(KeptSolution::of(&solution)),
        is_sensitive: true,
        answers: vec![(Question::AlongPath, Ok(vec![vec![f64::NEG_INFINITY]]))],
        memory: vec![1, 2, 255],
    }
}

fn open(folder: &Path, sweep: &str) -> Result<Journal, RunError> {
    Journal::open(&folder.join(NAME), sweep)
}

/// A journal of so many solves.
fn written(folder: &Path, solves: usize) {
    let journal = Journal::create(&folder.join(NAME), SWEEP).unwrap();
    for solve in 0..solves {
        journal.keep(&solve.to_string(), &kept()).unwrap();
    }
}

#[test]
fn solves_come_back_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    written(folder.path(), 2);
    let journal = open(folder.path(), SWEEP).unwrap();
    assert_eq!(journal.solves(), 2);
    let back: Kept = journal.known("1").unwrap().unwrap();
    assert!(back.is_sound());
    let bytes = |kept: &Kept| to_bytes(kept);
    assert_eq!(bytes(&back), bytes(&kept()));
    let solution = back.solved.unwrap().solution("sgcm");
    let bits = solution.report.residual.to_bits();
    assert_eq!(
        (bits, solution.report.method),
        (0x7ff8_0000_0000_0001, "sgcm")
    );
    assert_eq!(solution.report.findings, every_finding());
    let wanted = density(Observable::Marginal(0), Variants::Scheme);
    assert_eq!(solution.densities[0], wanted);
    assert!(journal.known::<Kept>("2").unwrap().is_none());
    // What one process has written another one finds; what is no solve is refused.
    journal.keep("2", &"no solve").unwrap();
    let journal = open(folder.path(), SWEEP).unwrap();
    let error = journal.known::<Kept>("2").unwrap_err();
    assert!(matches!(error, RunError::Journal { .. }), "{error}");
}

#[test]
fn a_density_that_does_not_fit_its_cells_is_refused() {
    let mut kept = kept();
    let mut solution = kept.solved.unwrap().solution("sgcm");
    solution.densities[1].standard_error.pop();
    kept.solved = Ok(KeptSolution::of(&solution));
    assert!(!kept.is_sound());
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
    let journal = open(folder.path(), SWEEP).unwrap();
    journal.keep("5", &kept()).unwrap();
    let journal = open(folder.path(), SWEEP).unwrap();
    let is_there = ["0", "1", "5"].map(|name| journal.known::<Kept>(name).unwrap().is_some());
    assert_eq!(is_there, [true, false, true]);
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
