//! Contact sheets: every kind of figure in every style, for the eye. `cargo test --release --test figures -- --ignored
//! contact` writes them to `target/contact/`: a sheet a figure, with its prints labelled by their styles.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use pbif::cancellation::Cancellation;
use pbif::figure::{ColourMap, ColourScale, FigureStyle, FigureWidth, Figures, Ground, Typeface};
use pbif::job::{CompareJob, Start, carry_out};

use crate::common::room::{Room, shipped};
use crate::common::sweeps::prepared;

mod sheet;

use sheet::{Print, write_sheet};

/// What the sheets have prints of, as `--style` has it: the widths, then what changes in one of them.
const STYLES: [&str; 9] = [
    "own",
    "single",
    "one-and-a-half",
    "double",
    "slide",
    "single,serif,no-title",
    "single,dark",
    "single,grey",
    "single,log,cividis",
];

/// Pixels that a print is wide.
const WIDE: f64 = 480.0;

/// A run and the figures of it that the sheets show.
struct Shown {
    /// The folder of the run, and the beginning of the names of its sheets.
    run: &'static str,
    /// Lines that make it.
    lines: &'static [&'static str],
    /// The figures.
    names: &'static str,
}

const RUNS: [Shown; 8] = [
    Shown {
        run: "coulomb",
        lines: &[
            "sweep sweeps/coulomb_fc.toml --out coulomb sweep.points=17 cells.x.count=40 cells.y.count=60 \
             locate.grid_check=off figures.at=[-0.02,-0.01,0.0,0.01] figures.draw=[]",
        ],
        names: "diagram_x diagram_y marginals joint_xy joint_xy_-0.02 multiples_xy surface_xy surface_xy_-0.02 pairs_xy \
                section_xy conditional_xy peaks_x indicator_x indicator_xy homology_xy health measures",
    },
    Shown {
        run: "well",
        lines: &["sweep well.toml --out well"],
        names: "diagram_x spectrum_x spectrum_x_v spectrogram_x correlation_x survival_cross field_cross_mean_time \
                field_cross_committor field_cross_reactive_density field_cross_reactive_current measures \
                measures_cross_mean",
    },
    Shown {
        run: "line",
        lines: &["sweep line.toml --out line"],
        names: "diagram_x marginals indicator_x homology_x field_cross_committor field_cross_mean_time",
    },
    Shown {
        run: "forced",
        lines: &[
            "sweep sweeps/gallery/forced_duffing.toml --out forced sweep.points=5 cells.x.count=24 cells.y.count=24 locate.grid_check=off \
             'detect.marginals=[\"x @ mean\",\"x @ 8 phases\"]' 'detect.joint=[[\"x\",\"y @ phase 0\"]]' \
             locate.tolerance=0.3 figures.at=[0,0.5,1] figures.draw=[]",
        ],
        names: "phases_x period_x marginals diagram_x joint_x_phase_0_y_phase_0",
    },
    Shown {
        run: "pendulum",
        lines: &[
            "sweep sweeps/gallery/pendulum.toml --out pendulum sweep.points=7 cells.y.count=40 locate.tolerance=0.5 locate.grid_check=off \
             figures.at=[0,0.5,1] figures.draw=[]",
        ],
        names: "diagram_phi marginals joint_phi_y surface_phi_y measures",
    },
    Shown {
        run: "map",
        lines: &[
            "sweep sweeps/cusp.toml --out map sweep.points=11 map.points=11 map.depth=1 cells.x.count=60 \
             'figures.formats=[\"svg\"]'",
        ],
        names: "map_x",
    },
    Shown {
        run: "plane",
        lines: &[
            "sweep sweeps/rayleigh_plane.toml --out plane sweep.points=7 map.points=7 map.depth=0 \
             cells.x.count=40 cells.y.count=40 'figures.formats=[\"svg\"]'",
        ],
        names: "map_x map_xy",
    },
    Shown {
        run: "curve",
        lines: &[
            "sweep sweeps/tutorials/noise.toml --out swept figures.draw=[]",
            "curve swept --row PB1 --second tau --from 0.01 --to 0.3 --out curve",
        ],
        names: "curve",
    },
];

/// The folder of the sheets, empty.
fn sheets() -> PathBuf {
    let folder = shipped("target/contact");
    if folder.exists() {
        std::fs::remove_dir_all(&folder).unwrap();
    }
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Writes a sheet from the pages of one figure in every style.
fn write(folder: &Path, name: &str, prints: &[Print]) {
    assert!(!prints.is_empty(), "no {name}");
    write_sheet(prints, WIDE as f32, &folder.join(format!("{name}.png")));
}

/// Pixels to the inch at which a figure of that style is about as wide as a print.
fn resolution(style: &str) -> f64 {
    let word = style.split(',').next().unwrap_or_default();
    let width = FigureWidth::NAMED
        .into_iter()
        .find(|width| width.name() == Some(word));
    let millimetres = width.and_then(FigureWidth::millimetres).unwrap_or(150.0);
    (WIDE * 25.4 / millimetres).round()
}

/// The pages of a figure among the files of a folder.
fn pages(folder: &Path, name: &str) -> Vec<PathBuf> {
    let mut found = vec![folder.join(format!("{name}.png"))];
    found.extend((1..20).map(|page| folder.join(format!("{name}_page{page}.png"))));
    found.retain(|file| file.exists());
    found
}

/// A run's figures in every style; tells the kinds of figures that the run has, and those that are on a sheet.
fn of_run(room: &Room, shown: &Shown, folder: &Path) -> BTreeSet<String> {
    for line in shown.lines {
        room.solved(&format!("{line} --quiet"));
    }
    for style in STYLES {
        let (run, dpi) = (shown.run, resolution(style));
        let names: Vec<&str> = shown.names.split_whitespace().collect();
        let names = names.join(",");
        room.done(&format!(
            "plot {run} --only {names} --style {style} --format png --out prints/{run}/{style} figures.style.dpi={dpi}"
        ));
    }
    for name in shown.names.split_whitespace() {
        let of_style = |style: &&str| {
            let files = pages(&room.path(&format!("prints/{}/{style}", shown.run)), name);
            let style = (*style).to_owned();
            files
                .into_iter()
                .map(move |file| Print::read(&style, &file))
        };
        let prints: Vec<Print> = STYLES.iter().flat_map(of_style).collect();
        write(folder, &format!("{}-{name}", shown.run), &prints);
    }
    kinds(shown.names.split_whitespace())
}

/// What names begin with.
fn kinds<'a>(names: impl Iterator<Item = &'a str>) -> BTreeSet<String> {
    names
        .filter_map(|name| Some(name.split('_').next()?.to_owned()))
        .collect()
}

/// The style of these words.
fn styled(words: &str) -> FigureStyle {
    let mut style = FigureStyle {
        dpi: resolution(words),
        ..FigureStyle::default()
    };
    for word in words.split(',') {
        let width = FigureWidth::NAMED.into_iter();
        let colours = ColourMap::ALL.into_iter();
        style.width = width
            .clone()
            .find(|one| one.name() == Some(word))
            .unwrap_or(style.width);
        style.colours = colours
            .clone()
            .find(|one| one.name() == word)
            .unwrap_or(style.colours);
        match word {
            "serif" => style.font = Typeface::Serif,
            "dark" => style.ground = Ground::Dark,
            "log" => style.scale = ColourScale::Log,
            "no-title" => style.title = false,
            _ => {}
        }
    }
    style
}

/// The figures of a comparison, which is solved once, in every style.
fn of_comparison(folder: &Path) {
    let text = std::fs::read_to_string(shipped("sweeps/coulomb_fc.toml")).unwrap();
    let small = "figures.at=[0.005,-0.01] method.samples=300 method.error=0.02 \
                 cells.x={from=-3.6,to=3.6,count=40} cells.y={from=-3.6,to=3.6,count=40}";
    let sweep = prepared(&text, small);
    let home = tempfile::tempdir().unwrap();
    let mut job = CompareJob::new(&sweep).unwrap();
    let never = Cancellation::new();
    let done = carry_out(
        &mut job,
        &home.path().join("c"),
        Start::Anew,
        &never,
        &|_| {},
    );
    let found = done.unwrap().unwrap().found;
    let title = &sweep.settings.title;
    let drawn = STYLES.map(|style| {
        let figures = Figures::of_comparison(&found, title).with_style(&styled(style));
        (style, figures.draw_all())
    });
    for name in Figures::of_comparison(&found, title).names() {
        let mut prints = Vec::new();
        for (style, figures) in &drawn {
            let of_name = figures
                .iter()
                .filter(|figure| figure.name.starts_with(&name));
            for figure in of_name {
                let file = home.path().join("print.png");
                std::fs::write(&file, figure.png().unwrap()).unwrap();
                prints.push(Print::read(*style, &file));
            }
        }
        write(folder, &format!("compare-{name}"), &prints);
    }
}

/// The figure of a friction law in every style.
fn of_friction(room: &Room, folder: &Path, law: &str) {
    let print = |style: &str| {
        let (out, dpi) = (format!("prints/{law}/{style}"), resolution(style));
        room.done(&format!(
            "systems {law} --plot --style {style} --format png --out {out} figures.style.dpi={dpi}"
        ));
        Print::read(style, &room.path(&format!("{out}/friction_{law}.png")))
    };
    write(folder, &format!("friction-{law}"), &STYLES.map(print));
}

/// The kinds of figures of sweeps, as the table of docs/figures.md has them.
fn kinds_of_sweeps() -> BTreeSet<String> {
    let page = std::fs::read_to_string(shipped("docs/figures.md")).unwrap();
    let section = page.split("## What there is").nth(1).unwrap();
    let section = section.split("\n## ").next().unwrap();
    let rows = section.lines().filter(|line| line.starts_with("| `"));
    let cells = rows.filter_map(|line| line.split('|').nth(1));
    kinds(cells.flat_map(|cell| cell.split('`').skip(1).step_by(2)))
}

/// A sheet of every figure that a run, a map, curves, a comparison and a friction law have, in nine styles.
#[test]
#[ignore = "writes sheets to be looked at"]
fn contact_sheets_at_length() {
    let (folder, room) = (sheets(), Room::new());
    for file in ["well", "line"] {
        let text = std::fs::read(shipped(&format!("tests/figures/contact/{file}.toml"))).unwrap();
        room.write(&format!("{file}.toml"), text);
    }
    let mut shown = BTreeSet::new();
    for run in &RUNS {
        shown.append(&mut of_run(&room, run, &folder));
    }
    of_comparison(&folder);
    of_friction(&room, &folder, "coulomb");
    of_friction(&room, &folder, "lugre");
    for kind in kinds_of_sweeps() {
        assert!(shown.contains(&kind), "no sheet of {kind}: {shown:?}");
    }
}
