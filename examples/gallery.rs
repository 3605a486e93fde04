//! Runs the sweeps of `sweeps/gallery/` and writes `docs/gallery.md` with a picture of each.
//!
//! Run with `cargo run --release --example gallery`; it takes about a minute.

#![allow(clippy::print_stdout)] // An example talks to its reader.

use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

use pbif::cancellation::Cancellation;
use pbif::continuation::SweepResult;
use pbif::continuation::curve::{CurveOrigin, CurveTree, Plane};
use pbif::figure::Figures;
use pbif::job::{FirstRow, curve_rows};
use pbif::sweep_file::{StartingFile, Sweep, SweepFile, starting_files};

const BEGINNING: &str = "# Gallery\n\n\
    Systems from the literature as sweep files, in `sweeps/gallery/`. Each is a starting file too: `pbif new mine.toml --like NAME` writes a copy\n\
    to change. Values that are known exactly, and densities against exact ones or free trajectories, are checked in `tests/truth/gallery.rs`.\n\
    This page is written by `cargo run --release --example gallery`.\n";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    let images = docs.join("images/gallery");
    std::fs::create_dir_all(&images)?;
    let mut page = BEGINNING.to_owned();
    for file in starting_files() {
        let start = Instant::now();
        page += &section(file, &images)?;
        println!("{}: {:.1} s", file.name, start.elapsed().as_secs_f64());
    }
    std::fs::write(docs.join("gallery.md"), page)?;
    Ok(())
}

/// What is said of one system; its picture is written beside the page.
fn section(file: &StartingFile, images: &Path) -> Result<String, Box<dyn std::error::Error>> {
    let never = Cancellation::new();
    let sweep = SweepFile::parse(file.name, file.text)
        .validate()?
        .prepare(&never)?;
    let found = sweep.run(&never, &mut ())?;
    let family = sweep.problem.family();
    let mut text = format!("\n## {}\n\n", file.title());
    let comments = file.text.lines().map_while(|line| line.strip_prefix('#'));
    for line in comments.take_while(|line| !line.contains("Look first")) {
        writeln!(text, "{}", line.trim())?;
    }
    let model = family.model();
    let equations = match model.typed() {
        Some(typed) => typed.typeset(),
        None => model.equations.clone(),
    };
    if !equations.is_empty() {
        for line in equations {
            writeln!(text, "    {line}")?;
        }
    }
    let subject = &found.subject;
    let parameter = family.parameter();
    writeln!(
        text,
        "\n| {parameter} | observable | change, {parameter} ascending | status |\n| ---: | --- | --- | --- |"
    )?;
    for row in &found.labels {
        let Some(words) = row.words(&subject.family) else {
            continue;
        };
        writeln!(
            text,
            "| {:.4} ± {:.1e} | {} | {} → {}, {} | {} |",
            row.value(),
            row.error(),
            words.of,
            words.before,
            words.after,
            words.change,
            words.status.word()
        )?;
    }
    let figures = Figures::of_sweep(&found, file.title(), &[]);
    let is_forced = family.model().axes.iter().any(|axis| axis.name == "t");
    let (kind, drawn) = match (&family.questions.spectrum, is_forced) {
        (Some(_), true) => ("measures_signal_to_noise", "Signal-to-noise ratio"),
        (Some(_), false) => ("spectrogram", "Spectrum"),
        (None, _) => ("diagram", "Density"),
    };
    let name = format!("{kind}_{}", family.axis(0));
    for figure in figures.draw(&name)? {
        let picture = format!("{}.svg", file.name);
        std::fs::write(images.join(&picture), figure.svg())?;
        let words = format!("{drawn} of {} against {parameter}", family.axis(0));
        writeln!(text, "\n![{words}](images/gallery/{picture})")?;
    }
    text += &stability(&sweep, &found, file, images)?;
    writeln!(text, "\n`pbif sweep sweeps/gallery/{}.toml`", file.name)?;
    Ok(text)
}

/// The picture of the curves of a fixed point in two parameters, where the file asks for them.
fn stability(
    sweep: &Sweep,
    found: &SweepResult,
    file: &StartingFile,
    images: &Path,
) -> Result<String, Box<dyn std::error::Error>> {
    let family = sweep.problem.family();
    let (Some(curve), Some(_)) = (&sweep.settings.curve, &family.questions.fixed_point) else {
        return Ok(String::new());
    };
    let (parameter, (from, to)) = (family.parameter(), curve.first);
    let plane = Plane::new(
        (parameter, from, to),
        (&curve.parameter, curve.from, curve.to),
    )?;
    let mut text = String::new();
    // The lines of a fixed point follow from the equations, and are in every figure of the plane.
    let none = CurveTree::default();
    let rows = curve_rows(sweep, found, false)?.into_iter();
    for row in rows.filter(|row| matches!(row, FirstRow::Stability(_))) {
        let origin = CurveOrigin::from(row);
        let followed = (&plane, &none);
        let figures = Figures::of_curves(followed, (&origin, &[]), family, file.title());
        for figure in figures.draw("curve")? {
            let picture = format!("{}_curve.svg", file.name);
            std::fs::write(images.join(&picture), figure.svg())?;
            let words = format!("Curves in the plane of {parameter} and {}", curve.parameter);
            writeln!(text, "\n![{words}](images/gallery/{picture})")?;
        }
    }
    Ok(text)
}
