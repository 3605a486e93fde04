//! Figures drawn from closed-form densities. `PBIF_FIGURES=folder cargo test --test figures` keeps them for a look.

use std::path::{Path, PathBuf};

use pbif::continuation::{
    BifurcationStatus, LabelledPoint, Point, PointStatus, PointType, SolveReport, SweepResult,
};
use pbif::density::{Density, EstimatedDensity, Observable};
use pbif::figure::{Format, draw_all};
use pbif::space::Axis;
use pbif::system::registry;
use pbif::topology::{Detection, Feature, FeatureKind, Signature, Verdict};

fn feature(kind: FeatureKind, position: Vec<f64>, density: f64) -> Feature {
    Feature {
        kind,
        position,
        density,
        persistence: density,
        standard_error: 0.0,
        significance: 10.0,
        verdict: Verdict::Present,
    }
}

fn detection(features: Vec<Feature>) -> Detection {
    let count = |kind| {
        features
            .iter()
            .filter(|feature| feature.kind == kind)
            .count()
    };
    Detection {
        signature: Signature {
            peaks: count(FeatureKind::Peak),
            craters: count(FeatureKind::Crater),
        },
        features,
    }
}

fn point(value: f64, densities: Vec<EstimatedDensity>, detections: Vec<Detection>) -> Point {
    let status = match densities.is_empty() {
        true => PointStatus::NoSteadyState,
        false => PointStatus::Solved,
    };
    Point {
        value,
        report: SolveReport {
            status,
            method: "exact",
            iterations: 0,
            residual: 0.0,
            escape_rate: 0.0,
            negative_mass: 0.0,
            edge_mass: Vec::new(),
            numerical_diffusion: Vec::new(),
            map_step: None,
            warnings: Vec::new(),
        },
        moments: Vec::new(),
        densities,
        detections,
        seconds: 0.0,
    }
}

fn bifurcation(
    label: &str,
    band: (f64, f64),
    observable: Observable,
    status: BifurcationStatus,
) -> LabelledPoint {
    LabelledPoint {
        label: label.to_owned(),
        kind: PointType::Bifurcation,
        value: 0.5 * (band.0 + band.1),
        error: 0.5 * (band.1 - band.0),
        lower: band.0,
        upper: band.1,
        observable: Some(observable),
        before: None,
        after: None,
        status: Some(status),
    }
}

/// Scales values to ∫ = 1 and gives them a standard error that grows like their root.
fn estimated(
    observable: Observable,
    axes: Vec<Axis>,
    mut values: Vec<f64>,
    error: f64,
) -> EstimatedDensity {
    let volume = |cell: usize| match &axes[..] {
        [x] => x.width(cell),
        [x, y] => x.width(cell / y.count()) * y.width(cell % y.count()),
        _ => 0.0,
    };
    let mass: f64 = values
        .iter()
        .enumerate()
        .map(|(cell, value)| value * volume(cell))
        .sum();
    values.iter_mut().for_each(|value| *value /= mass);
    let standard_error = values.iter().map(|value| error * value.sqrt()).collect();
    EstimatedDensity {
        observable,
        density: Density { axes, values },
        standard_error,
    }
}

/// Features of a marginal with one peak, or two at ±`apart` with a valley.
fn marginal_features(apart: Option<f64>) -> Vec<Feature> {
    match apart {
        Some(apart) => vec![
            feature(FeatureKind::Peak, vec![-apart], 1.0),
            feature(FeatureKind::Peak, vec![apart], 1.0),
            feature(FeatureKind::Valley, vec![0.0], 0.5),
        ],
        None => vec![feature(FeatureKind::Peak, vec![0.0], 1.0)],
    }
}

/// dx = (ax - x³) dt + σ dW, σ² = 0.3: p ∝ exp(2/σ² (ax²/2 - x⁴/4)), two peaks at ±√a for a > 0.
fn bistable() -> SweepResult {
    let axis = Axis::uniform(-2.5, 2.5, 100).unwrap();
    let mut values: Vec<f64> = (0..=40).map(|k| -1.0 + 0.05 * f64::from(k)).collect();
    values.extend((1..8).map(|k| 0.1 * 0.5f64.powi(k)));
    values.sort_by(f64::total_cmp);
    let at = |a: f64| {
        if (-0.92..-0.78).contains(&a) {
            return point(a, Vec::new(), Vec::new());
        }
        let p = |x: &f64| (2.0 / 0.3 * (0.5 * a * x * x - 0.25 * x.powi(4))).exp();
        let values = axis.centres().iter().map(p).collect();
        let density = estimated(Observable::Marginal(0), vec![axis.clone()], values, 0.02);
        let features = marginal_features((a > 0.012).then(|| a.sqrt()));
        point(a, vec![density], vec![detection(features)])
    };
    let unresolved = BifurcationStatus::Unresolved;
    SweepResult {
        parameter: "a".to_owned(),
        observables: vec![Observable::Marginal(0)],
        points: values.into_iter().map(at).collect(),
        labels: vec![bifurcation(
            "PB1",
            (-0.05, 0.07),
            Observable::Marginal(0),
            unresolved,
        )],
        interrupted: false,
    }
}

/// Caughey and Ma: p ∝ exp(-(2/σ²)(-aH + H²/2)), H = (x² + y²)/2, σ² = 0.4: peak, for a > 0 crater.
/// The parameter is `scale` a. Peaks of the marginals are not exact, they are there to be drawn.
fn rayleigh(parameter: &str, scale: f64, y: &Axis) -> SweepResult {
    let x = Axis::uniform(-3.0, 3.0, 60).unwrap();
    let observables = vec![
        Observable::Marginal(0),
        Observable::Marginal(1),
        Observable::Joint(0, 1),
    ];
    let at = |k: i32| {
        let a = -1.0 + 0.1 * f64::from(k);
        let p = |x: f64, y: f64| {
            let energy = 0.5 * (x * x + y * y);
            (-5.0 * (-a * energy + 0.5 * energy * energy)).exp()
        };
        let (xs, ys) = (x.centres(), y.centres());
        let cells: Vec<f64> = xs
            .iter()
            .flat_map(|&x| ys.iter().map(move |&y| p(x, y)))
            .collect();
        let m = ys.len();
        let along_x = (0..60).map(|i| (0..m).map(|j| cells[i * m + j] * y.width(j)).sum());
        let along_y = (0..m).map(|j| (0..60).map(|i| cells[i * m + j] * x.width(i)).sum());
        let densities = vec![
            estimated(observables[0], vec![x.clone()], along_x.collect(), 0.01),
            estimated(observables[1], vec![y.clone()], along_y.collect(), 0.0),
            estimated(observables[2], vec![x.clone(), y.clone()], cells, 0.0),
        ];
        let one = || {
            detection(marginal_features(
                (a > 0.36).then(|| 1.2 * (a - 0.35).sqrt()),
            ))
        };
        let both = match a > 0.0 {
            true => vec![
                feature(FeatureKind::Peak, vec![(2.0 * a).sqrt(), 0.0], 1.0),
                feature(FeatureKind::Crater, vec![0.0, 0.0], 0.2),
            ],
            false => vec![feature(FeatureKind::Peak, vec![0.0, 0.0], 1.0)],
        };
        point(scale * a, densities, vec![one(), one(), detection(both)])
    };
    let points = (0..=20).map(at).collect();
    let located = |label: &str, a: f64, observable: Observable| {
        bifurcation(
            label,
            ((a - 1e-4) * scale, (a + 1e-4) * scale),
            observable,
            BifurcationStatus::Located,
        )
    };
    let labels = vec![
        located("PB1", 0.0, observables[2]),
        located("PB2", 0.35, observables[0]),
        located("PB3", 0.36, observables[1]),
    ];
    SweepResult {
        parameter: parameter.to_owned(),
        observables: observables.clone(),
        points,
        labels,
        interrupted: false,
    }
}

fn uniform() -> Axis {
    Axis::uniform(-3.0, 3.0, 60).unwrap()
}

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
    let model = registry::find("bistable").unwrap();
    let at = [-0.5, 0.0, 0.5, 1.0];
    let files = draw_all(
        &bistable(),
        model,
        "Bistable, a title",
        &at,
        &Format::ALL,
        &folder,
    )
    .unwrap();
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
    let model = registry::find("rayleigh").unwrap();
    let result = rayleigh("a", 1.0, &uniform());
    let at = [-1.0, -0.5, 0.25, 1.0];
    let files = draw_all(&result, model, "", &at, &Format::ALL, &folder).unwrap();
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
        let tree = resvg::usvg::Tree::from_str(&svg, &resvg::usvg::Options::default()).unwrap();
        let (width, height, pixels) = pixels(&pair[1]);
        assert_eq!(width, (3.0 * tree.size().width()).round() as u32);
        assert_eq!(height, (3.0 * tree.size().height()).round() as u32);
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
    let model = registry::find("coulomb").unwrap();
    let grading = pbif::space::Grading {
        at: vec![0.0],
        smallest: 0.02,
    };
    let graded = Axis::graded(-3.0, 3.0, 60, &grading).unwrap();
    let result = rayleigh("f_c", 0.02, &graded);
    let title = "Duffing oscillator with Coulomb friction: a title too long for one line of a figure & <more>";
    let files = draw_all(
        &result,
        model,
        title,
        &[-0.02, 0.0, 0.02],
        &Format::ALL,
        &folder,
    )
    .unwrap();
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
    let model = registry::find("rayleigh").unwrap();
    let draw = || {
        let folder = tempfile::tempdir().unwrap();
        let result = rayleigh("a", 1.0, &uniform());
        let files = draw_all(&result, model, "t", &[0.5], &Format::ALL, folder.path()).unwrap();
        let bytes = files.iter().map(|file| std::fs::read(file).unwrap());
        bytes.collect::<Vec<_>>()
    };
    assert_eq!(draw(), draw());
}

#[test]
fn without_densities_there_are_no_figures() {
    let folder = tempfile::tempdir().unwrap();
    let model = registry::find("bistable").unwrap();
    let mut result = bistable();
    let drawn = |result: &SweepResult, at: f64| {
        names(&draw_all(result, model, "", &[at], &[Format::Svg], folder.path()).unwrap())
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
    let model = registry::find("bistable").unwrap();
    let files = draw_all(&result, model, "", &[0.0], &[Format::Svg], folder.path()).unwrap();
    assert_eq!(names(&files), ["diagram_x.svg", "marginals.svg"]);
}
