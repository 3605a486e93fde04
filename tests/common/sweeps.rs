//! Sweep files as text, made ready to run, and what their sweeps find.

use pbif::cancellation::Cancellation;
use pbif::continuation::{DensitySource as _, Located, Solution, SweepResult};
use pbif::sweep_file::{Settings, Sweep, SweepFile};

/// The settings of a file with this text, with keys set by words `key=value`.
pub(crate) fn settings(text: &str, words: &str) -> Settings {
    let words: Vec<&str> = words.split_whitespace().collect();
    let mut file = SweepFile::parse("sweep.toml", text);
    file.set_all("--set", &words).validate().unwrap()
}

/// The same as a sweep.
pub(crate) fn prepared(text: &str, words: &str) -> Sweep {
    settings(text, words).prepare(&Cancellation::new()).unwrap()
}

/// The same run.
pub(crate) fn swept(text: &str, words: &str) -> (Sweep, SweepResult) {
    let sweep = prepared(text, words);
    let result = sweep.run(&Cancellation::new(), &mut ()).unwrap();
    (sweep, result)
}

/// One value of a file's range solved alone; the last one, where none is given.
pub(crate) fn solved(text: &str, words: &str, value: Option<f64>) -> (Sweep, Solution<'static>) {
    let (sweep, never) = (prepared(text, words), Cancellation::new());
    let value = value.unwrap_or(sweep.problem.family().ends().1);
    let source = sweep.source(&never).unwrap();
    let solution = source.open(&never).solve(value).unwrap().detached();
    (sweep, solution)
}

/// The rows of an observable.
pub(crate) fn rows<'a>(result: &'a SweepResult, observable: &str) -> Vec<&'a Located> {
    let family = &result.subject.family;
    let rows = result.bifurcations();
    rows.filter(|row| row.observable.name(family) == observable)
        .collect()
}

/// A measure of a solution, and its error.
pub(crate) fn measure(solution: &Solution<'_>, name: &str) -> (f64, f64) {
    let found = solution.report.measures.iter().find(|one| one.name == name);
    let found = found.unwrap_or_else(|| panic!("no measure {name}"));
    (found.value, found.error.unwrap())
}
