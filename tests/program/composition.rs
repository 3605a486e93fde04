//! The rooms of the library together, without a disk: a sweep file in memory, one value solved, its densities detected
//! in, a figure drawn to a string; then the file's sweep, which finds what is known.

use pbif::cancellation::Cancellation;
use pbif::continuation::{DensitySource as _, Point};
use pbif::figure::Figures;
use pbif::sweep_file::SweepFile;
use pbif::topology::Detector as _;

const FILE: &str = r#"
title = "two wells"
[system]
model = "bistable"
parameters = { sigma2 = 0.25 }
[sweep]
parameter = "a"
from = -1.0
to = 1.0
points = 11
[cells]
x = { range = "auto", count = 100 }
"#;

#[test]
fn from_a_text_to_a_figure_without_a_disk() {
    let file = SweepFile::parse("two wells", FILE);
    let sweep = file
        .validate()
        .unwrap()
        .prepare(&Cancellation::new())
        .unwrap();
    let source = sweep.source(&Cancellation::new()).unwrap();
    let mut session = source.open(&Cancellation::new());
    let solved = session.solve(0.8).unwrap();
    let detections: Vec<_> = {
        let detector = sweep.detector();
        let densities = solved.densities.iter();
        densities.map(|density| detector.detect(density)).collect()
    };
    assert_eq!(detections[0].signature.to_string(), "2 peaks");

    let found = sweep.run(&Cancellation::new(), &mut ()).unwrap();
    let change = found.bifurcations().next().unwrap();
    // One peak for a ≤ 0, two for a > 0.
    assert!(
        change.value.abs() <= 3.0 * change.error + 1e-6,
        "{change:?}"
    );
    let has_density = |point: &Point| !point.densities.is_empty();
    assert!(found.points.iter().all(has_density));

    let settings = &sweep.settings;
    let figures = Figures::of_sweep(&found, &settings.title, &settings.figures.at);
    let diagram = figures.draw("diagram_x").unwrap().remove(0);
    assert!(diagram.svg().starts_with("<svg") && diagram.svg().contains("two wells"));
}

#[test]
fn a_sweep_is_written_changed_and_read_again() {
    let mut file = SweepFile::parse("two wells", FILE);
    assert_eq!(file.get("sweep.points").as_deref(), Some("11"));
    assert_eq!(file.get("sweep.pionts"), None);
    let open = file.set("sweep.points", "21").validate().unwrap();
    assert_eq!((open.points, open.axes[0].range()), (21, None));
    let sweep = open.prepare(&Cancellation::new()).unwrap();
    let mut again = SweepFile::parse("again", &sweep.to_toml());
    assert_eq!(again.get("title").as_deref(), Some("\"two wells\""));
    // What was found is in the text: nothing is left to the program.
    let fixed = again.validate().unwrap().fixed().unwrap();
    assert_eq!(fixed.to_toml(), sweep.to_toml());
    assert_eq!(fixed.problem.space(), sweep.problem.space());
    // Settings can be changed in code as well, and written.
    let mut settings = again.set("title", "narrow").validate().unwrap();
    settings.axes[0].ends = [-1.0, 1.0].map(Some);
    let text = settings.to_toml();
    assert!(text.contains("title = \"narrow\"") && text.contains("from = -1.0, to = 1.0"));
}

#[test]
fn mistakes_are_reported_together_with_their_places() {
    let mut file = SweepFile::parse("two wells", &FILE.replace("points", "pionts"));
    let report = file.set("method.kind", "sgmc").validate().unwrap_err();
    let places: Vec<_> = report
        .diagnostics()
        .iter()
        .filter_map(|diagnostic| report.sources().locate(diagnostic.place()?))
        .map(|at| (at.source, at.line, at.column))
        .collect();
    let at = |source: &str, line, column| (source.to_owned(), line, column);
    assert_eq!(
        places,
        [
            at("two wells", 10, 1),
            at("set", 1, 15),
            at("two wells", 6, 2)
        ]
    );
    let text = report.to_string();
    assert!(
        text.contains("did you mean `points`?") && text.ends_with("3 errors"),
        "{text}"
    );
}
