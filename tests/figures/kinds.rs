//! Figures drawn from closed-form densities. `PBIF_FIGURES=folder cargo test --test figures` keeps them for a look.

use std::path::{Path, PathBuf};

use pbif::continuation::{Measure, SweepResult};
use pbif::figure::{FigureError, FigureSettings, Figures, Format, write_figures};
use pbif::space::Axis;

use crate::common::closed_forms::{bistable, rayleigh, uniform};
use crate::texts::size;

/// The folder to draw into; kept where the environment names one.
fn folder(name: &str) -> (Option<tempfile::TempDir>, PathBuf) {
    match std::env::var_os("PBIF_FIGURES") {
        Some(folder) => (None, Path::new(&folder).join(name)),
        None => {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join(name);
            (Some(folder), path)
        }
    }
}

/// Draws diagrams, marginals, and joint densities together and each, into a folder; returns the files.
fn draw_all(
    result: &SweepResult,
    title: &str,
    at: &[f64],
    formats: &[Format],
    folder: &Path,
) -> Vec<PathBuf> {
    let figures = Figures::of_sweep(result, title, at);
    let figures = figures.draw_named(&["diagram", "marginals", "joint"]);
    write_figures(&figures, formats, folder).unwrap()
}

fn names(files: &[PathBuf]) -> Vec<String> {
    let name = |path: &PathBuf| path.file_name().unwrap().to_str().unwrap().to_owned();
    files.iter().map(name).collect()
}

/// Every `<text>` of an SVG without its markup.
fn texts(svg: &str) -> Vec<String> {
    let bare = |rest: &str| {
        let body = rest.split("</text>").next().unwrap();
        let body = body.split_once('>').unwrap().1;
        body.split('<')
            .map(|part| part.rsplit('>').next().unwrap())
            .collect()
    };
    svg.split("<text ").skip(1).map(bare).collect()
}

fn assert_shows(svg: &str, wanted: &[&str]) {
    let found = texts(svg);
    for wanted in wanted {
        assert!(
            found.iter().any(|text| text == wanted),
            "{wanted} not in {found:?}"
        );
    }
}

/// Size and RGB bytes of a PNG.
fn pixels(path: &Path) -> (u32, u32, Vec<u8>) {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    (info.width, info.height, pixels)
}

#[test]
fn a_bistable_sweep_gives_its_diagram_and_marginals() {
    let (_kept, folder) = folder("bistable");
    let at = [-0.5, 0.0, 0.5, 1.0];
    let files = draw_all(
        &bistable(),
        "Bistable, a title",
        &at,
        &Format::USUAL,
        &folder,
    );
    assert_eq!(
        names(&files),
        [
            "diagram_x.svg",
            "diagram_x.png",
            "marginals.svg",
            "marginals.png"
        ]
    );
    let svg = std::fs::read_to_string(&files[0]).unwrap();
    assert_shows(
        &svg,
        &[
            "Bistable, a title",
            "PB1",
            "a",
            "x",
            "p(x)",
            "−1.0",
            "0",
            "peak",
        ],
    );
    assert_shows(
        &svg,
        &["valley", "no steady state", "P-bifurcation, unresolved"],
    );
    assert_eq!(svg.matches("<image").count(), 2);
    let svg = std::fs::read_to_string(&files[2]).unwrap();
    assert_shows(&svg, &["a = −0.5", "a = 1", "p(x)"]);
    assert!(svg.contains("<polygon"), "bands of the standard error");
}

#[test]
fn every_svg_parses_and_every_png_has_its_size_three_times() {
    let (_kept, folder) = folder("rayleigh");
    let result = rayleigh(("rayleigh", "a"), 1.0, &uniform());
    let at = [-1.0, -0.5, 0.25, 1.0];
    let files = draw_all(&result, "", &at, &Format::USUAL, &folder);
    assert!(
        names(&files).contains(&"joint_xy_-0.5.png".to_owned()),
        "{files:?}"
    );
    assert_eq!(files.len(), 2 * (2 + 1 + 1 + 4));
    for pair in files.chunks(2) {
        let name = pair[1].display();
        let svg = std::fs::read_to_string(&pair[0]).unwrap();
        assert!(
            svg.len() < 300_000,
            "{name}: the SVG has {} bytes",
            svg.len()
        );
        let (size, _) = size(&roxmltree::Document::parse(&svg).unwrap());
        let (width, height, pixels) = pixels(&pair[1]);
        assert_eq!(
            [width, height],
            size.map(|length| (3.0 * length).round() as u32)
        );
        let coloured = pixels
            .chunks(3)
            .filter(|rgb| rgb[0].abs_diff(rgb[1]) > 30)
            .count();
        assert!(coloured > 3000, "{name}: {coloured}");
        let white = |x: u32, y: u32| pixels[(3 * (y * width + x)) as usize] == 255;
        let sides = (0..height).all(|y| white(0, y) && white(width - 1, y));
        let ends = (0..width).all(|x| white(x, 0) && white(x, height - 1));
        assert!(
            sides && ends,
            "something is cut off at the border of {name}"
        );
    }
}

#[test]
fn symbols_and_values_are_those_of_the_model() {
    let (_kept, folder) = folder("coulomb");
    let grading = pbif::space::Grading {
        at: vec![0.0],
        smallest: 0.02,
    };
    let graded = Axis::graded(-3.0, 3.0, 60, &grading).unwrap();
    let result = rayleigh(("coulomb", "f_c"), 0.02, &graded);
    let title = "Duffing oscillator with Coulomb friction: a title too long for one line of a figure & <more>";
    let files = draw_all(&result, title, &[-0.02, 0.0, 0.02], &Format::USUAL, &folder);
    let svg = std::fs::read_to_string(&files[0]).unwrap();
    let lowered =
        "<tspan font-style=\"oblique\">f</tspan><tspan dy=\"61\" font-size=\"202\">c</tspan>";
    assert!(svg.contains(lowered), "subscript of f_c");
    let joint = files
        .iter()
        .find(|file| file.ends_with("joint_xy_-0.02.svg"))
        .unwrap();
    let svg = std::fs::read_to_string(joint).unwrap();
    assert_shows(&svg, &["fc = −0.02", "ẋ", "p(x, ẋ)"]);
    let found = texts(&svg);
    assert!(
        !found.iter().any(|text| text.contains('-')),
        "hyphens for minus signs in {found:?}"
    );
}

#[test]
fn equal_results_give_equal_bytes() {
    let draw = || {
        let folder = tempfile::tempdir().unwrap();
        let result = rayleigh(("rayleigh", "a"), 1.0, &uniform());
        let files = draw_all(&result, "t", &[0.5], &Format::ALL, folder.path());
        let bytes = files.iter().map(|file| std::fs::read(file).unwrap());
        bytes.collect::<Vec<_>>()
    };
    assert_eq!(draw(), draw());
}

#[test]
fn without_densities_there_are_no_figures() {
    let folder = tempfile::tempdir().unwrap();
    let mut result = bistable();
    let drawn = |result: &SweepResult, at: f64| {
        names(&draw_all(result, "", &[at], &[Format::Svg], folder.path()))
    };
    // The point nearest to the wanted value has no density: no marginals, but a diagram of the others.
    assert_eq!(drawn(&result, -0.85), ["diagram_x.svg"]);
    for point in &mut result.points {
        point.densities.clear();
        point.detections.clear();
    }
    assert!(drawn(&result, 0.0).is_empty());
    result.points.clear();
    assert!(drawn(&result, 0.0).is_empty());
}

#[test]
fn a_single_point_is_drawn_too() {
    let folder = tempfile::tempdir().unwrap();
    let mut result = bistable();
    result.points.drain(..30);
    result.points.truncate(1);
    let files = draw_all(&result, "", &[0.0], &[Format::Svg], folder.path());
    assert_eq!(names(&files), ["diagram_x.svg", "marginals.svg"]);
}

#[test]
fn a_figure_is_drawn_by_its_name() {
    let result = rayleigh(("rayleigh", "a"), 1.0, &uniform());
    let figures = Figures::of_sweep(&result, "t", &[-0.5, 0.5]);
    let names = figures.names();
    assert_eq!(
        names,
        [
            "diagram_x",
            "diagram_y",
            "marginals",
            "joint_xy",
            "multiples_xy",
            "joint_xy_-0.5",
            "joint_xy_0.5",
            "surface_xy",
            "surface_xy_-0.5",
            "surface_xy_0.5",
            "pairs_xy",
            "section_xy",
            "conditional_xy",
            "peaks_x",
            "peaks_y",
            "indicator_x",
            "indicator_y",
            "indicator_xy",
            "homology_x",
            "homology_y",
            "homology_xy",
            "health",
            "measures"
        ]
    );
    let all = figures.draw_all();
    assert!(all.len() > 12);
    for name in &names {
        let drawn = all.iter().filter(|figure| figure.name == *name).cloned();
        assert_eq!(figures.draw(name).unwrap(), drawn.collect::<Vec<_>>());
    }
    // A word names a kind, a whole name, or the beginning of names.
    let of = |words: &[&str]| {
        let drawn = figures.draw_named(words).into_iter();
        drawn.map(|figure| figure.name).collect::<Vec<_>>()
    };
    assert_eq!(
        of(&["diagram", "joint_xy_0.5"]),
        ["diagram_x", "diagram_y", "joint_xy_0.5"]
    );
    assert_eq!(of(&["surface_xy"]).len(), 3);
    // Sheets are named without the figures of single values, and those are drawn where nothing is named.
    assert_eq!(
        of(&["joint_sheets", "surface_sheets"]),
        ["joint_xy", "surface_xy"]
    );
    figures.check(&["joint_sheets"]).unwrap();
    assert!(figures.check(&["sheets"]).is_err());
    let usual = FigureSettings::default();
    let words: Vec<&str> = usual.names().iter().map(String::as_str).collect();
    assert_eq!(
        of(&words),
        ["diagram_x", "diagram_y", "marginals", "joint_xy"]
    );
    assert_eq!(of(&["all"]).len(), all.len());
    let unknown = figures
        .check(&["all", "joint", "joint_xy_0.7"])
        .unwrap_err();
    assert!(matches!(unknown, FigureError::Unknown { name, .. } if name == "joint_xy_0.7"));
    let error = figures.draw("diagram_z").unwrap_err();
    assert!(
        matches!(&error, FigureError::Unknown { known, .. } if *known == names),
        "{error}"
    );
    // Beside it what it shows, and the numbers behind it.
    let diagram = figures.draw("diagram_x").unwrap().remove(0);
    assert!(diagram.caption.contains("p(x) over a") && diagram.caption.contains("cells"));
    assert!(
        diagram
            .data
            .starts_with("a,axis,coordinate,density,standard_error\n")
    );
    let solved = result
        .points
        .iter()
        .filter(|point| !point.densities.is_empty());
    assert_eq!(
        diagram.data.lines().count(),
        1 + solved.count() * uniform().count()
    );
    // Without a density there is nothing to see, which is no error.
    let empty = SweepResult {
        points: Vec::new(),
        ..result.clone()
    };
    let figures = Figures::of_sweep(&empty, "t", &[0.5]);
    assert_eq!(figures.draw("diagram_x").unwrap(), []);
}

#[test]
fn captions_typeset_typed_equations_and_need_no_title() {
    let text = "\
[system]
equations = { x = 'alpha x - x^3' }
noise = { x = 'sqrt(2 D sigma2)' }
parameters = { D = 0.5, sigma2 = 1.0 }
[sweep]
parameter = 'alpha'
from = 0.5
to = 1.0
points = 3
[cells]
x = { from = -3, to = 3, count = 60 }
[spectrum]
of = ['x']
to = 3.0
";
    let (sweep, result) = crate::common::sweeps::swept(text, "");
    assert_eq!(sweep.settings.title, "Sweep of α");
    let figures = Figures::of_sweep(&result, "", &[]);
    let diagram = figures.draw("diagram_x").unwrap().remove(0);
    let system = "System: x' = α x - x³ + √(2 D σ²) ξ₁(t); E[ξ_i(t) ξ_j(t+τ)] = δ_ij δ(τ), with D = 0.5, σ² = 1.";
    assert!(diagram.caption.contains(system), "{}", diagram.caption);
    let spectra = figures.draw("spectrogram_x").unwrap().remove(0);
    assert!(
        spectra.caption.contains(" over α, with"),
        "{}",
        spectra.caption
    );
}

#[test]
fn a_passage_with_a_curve_has_a_figure_of_its_survival() {
    let text = "\
[system]
equations = { x = '-x' }
noise = { x = 'sqrt(2 D)' }
[sweep]
parameter = 'D'
from = 0.2
to = 0.4
points = 3
[cells]
x = { from = -2, to = 2, count = 60 }
[passage]
out = { start = { x = 0 }, until = 'abs(x) > 1.5', survival = { from = 0.1, to = 10, count = 5 }, times = [1] }
";
    let (_, result) = crate::common::sweeps::swept(text, "");
    let figures = Figures::of_sweep(&result, "", &[0.2, 0.4]);
    let sheet = figures.draw("measures").unwrap().remove(0);
    assert!(sheet.data.contains("out_mean") && !sheet.data.contains("survival"));
    assert!(
        figures
            .names()
            .contains(&"measures_out_1_survival".to_owned())
    );
    let figure = figures.draw("survival_out").unwrap().remove(0);
    let mut rows = figure.data.lines();
    assert_eq!(rows.next(), Some("D,time,survival,error"));
    let rows: Vec<Vec<f64>> = rows
        .map(|row| row.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    // Even in logarithms, of three digits, and the one that is listed once.
    let times: Vec<f64> = rows.iter().map(|row| row[1]).collect();
    for (time, wanted) in times
        .iter()
        .zip([0.1, 0.316, 1.0, 3.16, 10.0].iter().cycle())
    {
        assert!((time / wanted - 1.0).abs() < 1e-12, "{times:?}");
    }
    assert_eq!(rows.len(), 10);
    for pair in rows.windows(2).filter(|pair| pair[0][0] == pair[1][0]) {
        assert!(pair[1][2] < pair[0][2] && pair[1][3] < 1e-3, "{pair:?}");
    }
    // What is drawn is what the table of points has.
    let measures = &result.points[0].report.measures;
    let listed = measures
        .iter()
        .find(|one| one.name == "out_1_survival")
        .unwrap();
    assert!((rows[2][2] / listed.value - 1.0).abs() < 1e-9);
    assert!(
        figure.caption.contains("the passage out lasts longer"),
        "{}",
        figure.caption
    );
}

#[test]
fn measures_are_told_in_words_and_those_of_solvers_are_not_among_them() {
    let mut result = bistable();
    let measure = |name: &str, unit: &str, value: f64| Measure {
        name: name.to_owned(),
        value,
        error: None,
        unit: unit.to_owned(),
    };
    for point in &mut result.points {
        point.report.measures = vec![
            measure("sd_x", "x", 1.0 + point.value.powi(2)),
            measure("decay_rate_1", "1/t", 2.0 + point.value),
            measure("edge_mass_x", "1", 1e-9),
            measure("factorisations", "1", 1.0),
        ];
    }
    let figures = Figures::of_sweep(&result, "", &[]);
    let names = figures.names();
    let measures: Vec<&String> = names
        .iter()
        .filter(|name| name.starts_with("measures"))
        .collect();
    assert_eq!(
        measures,
        ["measures", "measures_sd_x", "measures_decay_rate_1"]
    );
    let sheet = figures.draw("measures").unwrap().remove(0);
    assert_shows(
        &sheet.svg(),
        &["standard deviation of x", "decay rate 1 [1/t]"],
    );
    let caption = "error: standard deviation of x, decay rate 1. ";
    assert!(sheet.caption.contains(caption), "{}", sheet.caption);
    let unknown = "Open circles stand where no error is known.";
    assert!(sheet.caption.contains(unknown), "{}", sheet.caption);
}
