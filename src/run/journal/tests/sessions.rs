//! Sessions that were stopped and go on from a journal, or are asked something else than before.

use super::*;

/// A source whose solutions tell all that its session was asked before, and what it recalls.
struct Diary {
    subject: Subject,
    count: Arc<Mutex<usize>>,
}

#[derive(Default)]
struct DiarySession {
    pages: Vec<u8>,
    count: Arc<Mutex<usize>>,
}

impl DensitySource for Diary {
    fn method(&self) -> &'static str {
        "diary"
    }

    fn subject(&self) -> &Subject {
        &self.subject
    }

    fn open(&self, _: &Cancellation) -> Box<dyn Session> {
        Box::new(DiarySession {
            count: self.count.clone(),
            ..DiarySession::default()
        })
    }
}

impl Session for DiarySession {
    fn solve(&mut self, value: f64) -> Result<Solution<'_>, SourceError> {
        *self.count.lock().unwrap() += 1;
        self.pages.push(value as u8);
        if value < 0.0 {
            return Err(SourceError::Method("negative".into()));
        }
        let mut report = SolveReport::solved("diary");
        report.iterations = self
            .pages
            .iter()
            .fold(7, |sum, &page| 31 * sum % 65_521 + page as usize);
        let mut solution = Solution::without_density(report);
        solution.sensitivity = Some(Box::new(DiaryAnswers(&mut self.pages)));
        Ok(solution)
    }

    fn memory(&self) -> Vec<u8> {
        self.pages.clone()
    }

    fn recall(&mut self, left: &[(f64, &[u8])]) -> Result<(), SourceError> {
        self.pages = left
            .last()
            .map(|(_, pages)| pages.to_vec())
            .unwrap_or_default();
        Ok(())
    }
}

struct DiaryAnswers<'s>(&'s mut Vec<u8>);

impl Sensitivity for DiaryAnswers<'_> {
    fn to_parameter(&mut self, name: &str) -> Result<Vec<Vec<f64>>, SourceError> {
        self.0.extend(name.bytes());
        let sum = self.0.iter().map(|&page| f64::from(page)).sum();
        Ok(vec![vec![sum]])
    }

    fn along_path(&mut self) -> Result<Vec<Vec<f64>>, SourceError> {
        Err(SourceError::Method("nobody knows".into()))
    }
}

fn diary(count: &Arc<Mutex<usize>>) -> Box<dyn DensitySource> {
    Box::new(Diary {
        subject: Subject {
            family: coulomb(),
            observables: Vec::new(),
            measures: Vec::new(),
            cell_check: CellCheck::Needless,
        },
        count: count.clone(),
    })
}

/// What a session gives at values, each followed by questions.
fn answers(session: &mut dyn Session, steps: &[(f64, &[&str])]) -> Vec<String> {
    let mut told = Vec::new();
    for (value, questions) in steps {
        match session.solve(*value) {
            Ok(mut solution) => {
                told.push(solution.report.iterations.to_string());
                for question in *questions {
                    let sensitivity = solution.sensitivity.as_mut().unwrap();
                    let answer = match *question {
                        "" => sensitivity.along_path(),
                        name => sensitivity.to_parameter(name),
                    };
                    told.push(format!("{answer:?}"));
                }
            }
            Err(error) => told.push(error.to_string()),
        }
    }
    told
}

const FIRST: [(f64, &[&str]); 5] = [
    (3.0, &["a"]),
    (1.0, &[]),
    (-1.0, &[]),
    (1.0, &["a", "", "bc"]),
    (2.0, &[]),
];
const SECOND: [(f64, &[&str]); 3] = [(3.0, &["a"]), (4.0, &[]), (1.0, &["c"])];

#[test]
fn sessions_that_were_stopped_anywhere_go_on_as_they_would_have() {
    let never = Cancellation::new();
    let count = Arc::default();
    let whole =
        [&FIRST[..], &SECOND].map(|steps| answers(diary(&count).open(&never).as_mut(), steps));
    for stop in 0..=FIRST.len() {
        let folder = tempfile::tempdir().unwrap();
        let journal = Journal::create(&folder.path().join(NAME), SWEEP).unwrap();
        let source = JournalledSource::new(diary(&count), &journal);
        let part = answers(source.open(&never).as_mut(), &FIRST[..stop]);
        assert_eq!(part, whole[0][..part.len()]);
        let journal = open(folder.path(), SWEEP).unwrap();
        assert_eq!(journal.solves(), stop);
        *count.lock().unwrap() = 0;
        let source = JournalledSource::new(diary(&count), &journal);
        // In another order of sessions, of which the second begins as the first.
        let second = answers(source.open(&never).as_mut(), &SECOND);
        let first = answers(source.open(&never).as_mut(), &FIRST);
        assert_eq!([first, second], whole);
        let solved = FIRST.len() - stop + if stop == 0 { 3 } else { 2 };
        assert_eq!((*count.lock().unwrap(), source.solves()), (solved, solved));
    }
}

#[test]
fn a_session_that_is_asked_something_else_than_before_answers_as_it_would_have() {
    let never = Cancellation::new();
    let count = Arc::default();
    let folder = tempfile::tempdir().unwrap();
    let journal = Journal::create(&folder.path().join(NAME), SWEEP).unwrap();
    answers(
        JournalledSource::new(diary(&count), &journal)
            .open(&never)
            .as_mut(),
        &FIRST,
    );
    let others: [&[(f64, &[&str])]; 3] = [
        &[(3.0, &["b"]), (1.0, &[])],
        &[(3.0, &[]), (1.0, &["a"])],
        &[(3.0, &["a", "d", "e"]), (1.0, &[]), (-1.0, &[])],
    ];
    for other in others {
        let whole = answers(diary(&count).open(&never).as_mut(), other);
        // The second time from what the first has added.
        for _ in 0..2 {
            let journal = open(folder.path(), SWEEP).unwrap();
            let source = JournalledSource::new(diary(&count), &journal);
            assert_eq!(answers(source.open(&never).as_mut(), other), whole);
        }
    }
}

#[test]
fn what_shards_have_solved_is_not_solved_and_a_sweep_is_written_at_once() {
    let never = Cancellation::new();
    let count = Arc::default();
    let folder = tempfile::tempdir().unwrap();
    let journal = Journal::create(&folder.path().join(NAME), SWEEP).unwrap();
    let point = Point {
        value: 3.0,
        report: SolveReport::solved("diary"),
        densities: vec![density(Observable::Joint(0, 1), Variants::Scheme)],
        detections: Vec::new(),
        distance: None,
        seconds: 1.5,
    };
    let known = point.densities.clone();
    let source = JournalledSource::of_sweep(diary(&count), &journal);
    let family = &source.subject().family;
    journal.write_known(family, &point, None).unwrap();
    // Of what a shard holds, the journal says where it is.
    let held = Point {
        value: 4.0,
        ..point
    };
    journal.write_known(family, &held, Some(2)).unwrap();
    let mut session = source.open(&never);
    let solution = session.solve(1.0).unwrap();
    assert_eq!(solution.report.iterations, 218);
    assert!(solution.sensitivity.is_none());
    drop(solution);
    assert_eq!(session.seconds(), None);
    assert_eq!((*count.lock().unwrap(), source.solves()), (1, 1));
    // While the session goes on.
    let journal = open(folder.path(), SWEEP).unwrap();
    assert_eq!(journal.solves(), 1);
    // Densities are found by the values of points.
    let look = Journal::look(folder.path()).unwrap().unwrap();
    let watched = |observable| Subject {
        observables: vec![observable],
        ..source.subject().clone()
    };
    let joint = watched(Observable::Joint(0, 1));
    let found =
        |subject: &Subject, space: &CellSpace, value| look.densities(subject, (space, &[]), value);
    assert_eq!(
        found(&joint, &space(), 3.0).unwrap(),
        Some(Held::Here(known))
    );
    assert_eq!(found(&joint, &space(), 4.0).unwrap(), Some(Held::In(2)));
    assert_eq!(found(&joint, &space(), 2.0).unwrap(), None);
    assert_eq!(
        found(source.subject(), &space(), 1.0).unwrap(),
        Some(Held::Here(Vec::new()))
    );
    let other = found(&watched(Observable::Marginal(0)), &space(), 3.0);
    assert!(matches!(other, Err(RunError::NotStored { stored, .. }) if stored == ["xy"]));
    let finer = CellSpace::new(vec![
        Axis::uniform(-1.0, 1.0, 4).unwrap(),
        space().axes()[1].clone(),
    ]);
    let other = found(&joint, &finer.unwrap(), 3.0);
    assert!(matches!(other, Err(RunError::Cells { axis, .. }) if axis == "x"));
    let source = JournalledSource::of_sweep(diary(&count), &journal);
    let mut session = source.open(&never);
    assert_eq!(session.solve(1.0).unwrap().report.iterations, 218);
    assert!(session.seconds().is_some());
    session.solve(2.0).unwrap();
    assert!(session.seconds().is_none());
    assert_eq!(journal.points(), 3);
    let stored = [1.0, 2.0, 3.0, 4.0].map(|value| source.is_stored(value));
    assert_eq!(stored, [true, false, true, true]);
}
