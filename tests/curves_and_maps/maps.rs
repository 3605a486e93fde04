//! Maps of regimes over two parameters, against signatures and curves that are known exactly.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::common::cusp::off_the_fold;
use crate::common::pbif;
use crate::common::room::{Room, words};
use crate::common::sweeps::prepared;
use pbif::cancellation::Cancellation;
use pbif::continuation::BifurcationStatus;
use pbif::continuation::curve::CurvePoint;
use pbif::continuation::map::{MapNode, MapProgress, RegimeMap};
use pbif::run::MapCheckpoint;
use pbif::sweep_file::SweepFile;
use pbif::topology::Signature;

/// Additive noise: peaks of the density are zeros of the drift, and there are two where 27 h² < 4 a³.
const CUSP: &str = r#"
[system.equations]
x = "h + a x - x^3"
[system.noise]
x = "sqrt(sigma2)"
[system.parameters]
a = 0.0
h = 0.0
sigma2 = 0.1
[sweep]
parameter = "h"
from = -0.5
to = 0.5
points = 11
[map]
parameter = "a"
from = -0.4
to = 1.0
depth = 1
[cells]
x = { from = -2.5, to = 2.5, count = 200 }
"#;

/// With damping -a + bH the crater opens at a = 0, and x splits at a = 0.540903 √(b σ²).
const RAYLEIGH: &str = r#"
[system]
model = "rayleigh"
[system.parameters]
b = 0.1
[sweep]
parameter = "a"
from = -0.02
to = 0.06
points = 5
[map]
parameter = "sigma2"
from = 0.01
to = 0.03
points = 4
depth = 1
[cells]
x = { from = -2.8, to = 2.8, count = 50 }
y = { from = -2.8, to = 2.8, count = 50 }
[detect]
marginals = ["x"]
joint = [["x", "y"]]
[locate]
relative_tolerance = 1e-3
"#;

fn mapped(text: &str, settings: &[&str]) -> RegimeMap {
    let never = Cancellation::new();
    let sweep = prepared(text, settings);
    sweep.map(&never, &|_| ()).unwrap().unwrap()
}

#[test]
fn a_tilted_double_well_has_two_peaks_within_the_cusp_and_one_outside() {
    let map = mapped(CUSP, &[]);
    let coarse = map.nodes.iter().filter(|node| node.level == 0).count();
    assert_eq!(coarse, 121);
    // Refined where the fold passes, and only there.
    assert!((150..300).contains(&map.nodes.len()), "{}", map.nodes.len());
    for node in &map.nodes {
        let [h, a] = node.values;
        let two = a > 0.0 && 27.0 * h * h < 4.0 * a.powi(3);
        // A shallow peak is counted a little after its birth.
        let late = a > -0.05 && off_the_fold(node.values, [1.0, 1.4]).abs() < 0.03;
        let peaks = if two { 2 } else { 1 };
        assert!(
            late || node.signatures == [Signature::of_peaks(peaks)],
            "{node:?}"
        );
    }
    // Both branches of the fold, each once, and nothing else.
    assert_eq!(map.curves.len(), 2, "{:?}", map.untraced);
    for curve in &map.curves {
        for point in &curve.points {
            // In the cusp itself the distance is that of the point.
            let off = match point.values[1] < 0.01 {
                true => point.values[0].abs(),
                false => off_the_fold(point.values, [1.0, 1.4]).abs(),
            };
            let near_cusp = point.values[1] < 0.01 && off < 1e-3;
            assert!(
                near_cusp || off <= 1e-4 && off <= point.error,
                "{point:?}: {off:.1e}"
            );
        }
        let highest = curve.points.iter().map(|point| point.values[0].abs());
        assert!((highest.fold(0.0, f64::max) - 0.3849).abs() < 1e-3);
        // All but perhaps the cusp.
        let located = |point: &&CurvePoint| point.status == BifurcationStatus::Located;
        assert!(curve.points.iter().filter(located).count() + 1 >= curve.points.len());
    }
    let sides: f64 = map
        .curves
        .iter()
        .map(|curve| curve.points[curve.start].values[0].signum())
        .sum();
    assert_eq!(sides, 0.0);
    assert!(map.untraced.is_empty(), "{:?}", map.untraced);
    // They meet in one point.
    let cusps = map.codimension_two();
    assert_eq!(cusps.len(), 1, "{cusps:?}");
    let off = cusps[0].values[0].hypot(cusps[0].values[1] / 1.4);
    assert!(off <= cusps[0].error && off < 1e-3, "{:?}", cusps[0]);
    assert_eq!(
        (cusps[0].label.as_str(), cusps[0].curves.as_slice()),
        ("CP1", &[0, 1][..])
    );

    // ∫ 2 · 2 (a/3)^{3/2} da up to 1, over the box of 1 by 1.4.
    let exact = 1.6 / 3.0_f64.powf(1.5) / 1.4;
    let picture = map.regions(0, [280, 280]).unwrap();
    let two = picture
        .regions
        .iter()
        .filter(|one| one.signature == Some(Signature::of_peaks(2)));
    let two: Vec<_> = two.filter(|region| region.share > 1e-3).collect();
    assert_eq!(two.len(), 1);
    assert!(
        (two[0].share - exact).abs() < 0.01,
        "{} {exact}",
        two[0].share
    );
    let [h, a] = two[0].inside;
    assert!(27.0 * h * h < 4.0 * a.powi(3));

    // A density of each regime.
    let peaks = map.samples.iter().map(|sample| {
        let values = &sample.density.values;
        values
            .windows(3)
            .filter(|three| three[1] > three[0] && three[1] >= three[2])
            .count()
    });
    assert_eq!(peaks.collect::<Vec<_>>(), [1, 2]);
}

#[test]
fn a_map_is_the_same_on_any_number_of_threads() {
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| mapped(RAYLEIGH, &["map.depth=0"]))
    };
    let (one, three) = (on(1), on(3));
    assert_eq!(one.nodes, three.nodes);
    assert_eq!(one.curves.len(), three.curves.len());
    for (a, b) in one.curves.iter().zip(&three.curves) {
        assert_eq!(a.points, b.points);
    }
    assert_eq!(one.untraced, three.untraced);
}

#[test]
fn the_map_of_energy_dependent_damping_has_its_two_curves() {
    let map = mapped(RAYLEIGH, &[]);
    let of = |name: &'static str| {
        let family = &map.subject.family;
        let curves = map.curves.iter();
        let curves = curves.filter(|curve| curve.observable.name(family) == name);
        curves.collect::<Vec<_>>()
    };
    let (split, opens) = (of("x"), of("xy"));
    assert_eq!((split.len(), opens.len()), (1, 1), "{:?}", map.untraced);
    for point in &split[0].points {
        let [a, sigma2] = point.values;
        let off = (a - 0.540_903 * (0.1 * sigma2).sqrt()) / 0.08;
        assert!(off.abs() <= 2.0 * point.error, "{point:?}: {off:.1e}");
    }
    for point in &opens[0].points {
        assert!((point.values[0] / 0.08).abs() <= point.error, "{point:?}");
    }
    let [a, b] = [0.01, 0.03].map(|sigma2: f64| 0.540_903 * (0.1 * sigma2).sqrt());
    let picture = map.regions(0, [200, 200]).unwrap();
    let one = picture
        .regions
        .iter()
        .find(|one| one.signature == Some(Signature::of_peaks(1)));
    // Nearly a trapezium.
    let share = (0.5 * (a + b) + 0.02) / 0.08;
    assert!(
        (one.unwrap().share - share).abs() < 0.02,
        "{} {share}",
        one.unwrap().share
    );
}

/// With nodes on f_c = 0, where y changes.
const COULOMB: &str = r#"
[system]
model = "coulomb"
[system.parameters]
kappa = 0.05
mu = 0.05
[sweep]
parameter = "f_c"
from = -0.03
to = 0.03
points = 7
[map]
parameter = "sigma2"
from = 0.03
to = 0.07
points = 5
depth = 0
[cells]
x = { from = -4.0, to = 4.0, count = 40, grade = { at = [0.0], smallest = 0.08 } }
y = { from = -4.0, to = 4.0, count = 40, grade = "auto" }
[detect]
marginals = ["x", "y"]
joint = []
[locate]
relative_tolerance = 2e-3
"#;

#[test]
fn every_curve_is_followed_once_and_its_work_is_as_it_was() {
    let map = mapped(COULOMB, &[]);
    let family = &map.subject.family;
    let told = map.curves.iter().map(|curve| {
        let observable = curve.observable.name(family);
        format!("{} of {observable}", curve.kind.name())
    });
    assert_eq!(
        told.collect::<Vec<_>>(),
        ["slope at the kink of y", "curvature at the centre of x"],
        "{:?}",
        map.untraced
    );
    // Whatever was followed is there: nothing twice.
    let solves = map
        .curves
        .iter()
        .map(|curve| curve.work.solves + curve.check_work.solves);
    assert_eq!(solves.sum::<usize>(), map.work.curves.solves);
    let told = [map.work.nodes, map.work.curves].map(|work| {
        let (solves, factorisations) = (work.solves, work.factorisations);
        format!("{solves} solves, {factorisations} + {}", work.iterations)
    });
    insta::assert_snapshot!(told.join("\n"), @r"
    35 solves, 15 + 330
    102 solves, 38 + 466
    ");
}

/// Dahl's z lies within f_c/λ, which the second parameter moves.
const DAHL: &str = r#"
[system]
model = "dahl"
[system.parameters]
kappa = 0.1
mu = 1.0
lambda = 0.1
sigma2 = 0.05
[sweep]
parameter = "alpha"
from = -0.2
to = 0.1
points = 2
[map]
parameter = "f_c"
from = 0.03
to = 0.08
points = 2
depth = 0
curves = "off"
[cells]
x = { from = -2.0, to = 2.0, count = 24 }
y = { from = -2.0, to = 2.0, count = 20 }
z = { modes = 4 }
[detect]
marginals = ["x"]
joint = []
"#;

#[test]
fn an_axis_of_modes_holds_its_state_at_every_corner_of_a_map() {
    let map = mapped(DAHL, &[]);
    assert_eq!(map.nodes.len(), 4);
    assert!(
        map.nodes.iter().all(|node| node.status.is_resolved()),
        "{:?}",
        map.nodes
    );
    let sweep = prepared(DAHL, &[]);
    let z = &sweep.problem.space().axes()[2];
    assert!((z.from() + 0.8).abs() < 1e-12 && (z.to() - 0.8).abs() < 1e-12);
}

#[test]
fn a_cancelled_map_keeps_what_was_done_and_says_so() {
    let cancellation = Cancellation::new();
    let sweep = prepared(CUSP, &[]);
    let seen = AtomicUsize::new(0);
    let observer = |told: &MapProgress<'_>| {
        if let MapProgress::Solved { .. } = told
            && seen.fetch_add(1, Ordering::Relaxed) == 30
        {
            cancellation.cancel();
        }
    };
    let map = sweep.map(&cancellation, &observer).unwrap().unwrap();
    assert!(map.interrupted);
    assert!((30..100).contains(&map.nodes.len()), "{}", map.nodes.len());
    assert!(map.curves.is_empty() && map.untraced.is_empty());
    assert!(map.regions(0, [40, 40]).is_some());
}

#[test]
fn a_map_goes_on_from_what_was_solved_and_solves_only_what_it_must() {
    let cancellation = Cancellation::new();
    let sweep = prepared(CUSP, &[]);
    let solved = AtomicUsize::new(0);
    let count = |told: &MapProgress<'_>| {
        if let MapProgress::Solved { .. } = told {
            solved.fetch_add(1, Ordering::Relaxed);
        }
    };
    let whole = sweep.map(&cancellation, &count).unwrap().unwrap();
    assert_eq!(solved.swap(0, Ordering::Relaxed), whole.nodes.len());
    // As after an interrupt: of the coarse grid the lower seven rows, and a node that is of no lattice.
    let mut known: Vec<MapNode> = whole.nodes.iter().take(77).cloned().collect();
    known.retain(|node| node.level == 0);
    known.push(MapNode {
        values: [0.0123, 0.0456],
        ..known[0].clone()
    });
    let again = sweep
        .map_from(&known, &cancellation, &count)
        .unwrap()
        .unwrap();
    let anew = solved.load(Ordering::Relaxed);
    // Those that are far from a change are taken as they are.
    assert!(anew < whole.nodes.len(), "{anew} of {}", whole.nodes.len());
    let told = |map: &RegimeMap| -> Vec<([f64; 2], usize, Vec<Signature>)> {
        let nodes = map.nodes.iter();
        nodes
            .map(|node| (node.values, node.level, node.signatures.clone()))
            .collect()
    };
    assert_eq!(told(&again), told(&whole));
    assert_eq!(again.curves.len(), whole.curves.len());
    assert!(again.untraced.is_empty(), "{:?}", again.untraced);
}

#[test]
fn the_program_goes_on_with_a_map_that_was_killed() {
    let room = Room::new();
    let at = |name: &str| room.at(name);
    let (file, out) = (at("cusp.toml"), at("out"));
    std::fs::write(&file, CUSP).unwrap();
    let never = Cancellation::new();
    let sweep = prepared(CUSP, &[]);
    let nodes = Mutex::new(Vec::new());
    let observer = |told: &MapProgress<'_>| {
        if let MapProgress::Solved { node, .. } = told {
            nodes.lock().unwrap().push((*node).clone());
        }
    };
    sweep.map(&never, &observer).unwrap();
    let nodes = nodes.into_inner().unwrap();
    // What a kill leaves: the nodes so far, and nothing else.
    std::fs::create_dir(&out).unwrap();
    let checkpoint = MapCheckpoint::new(out.as_ref(), &sweep.to_toml());
    checkpoint.write(&nodes[..60]).unwrap();
    let output = pbif(&["sweep", &file, "--out", &out, "--resume"]);
    // On these cells the cusp itself is not known well enough to be located.
    assert!(output.status.code() <= Some(1), "{output:?}");
    let said = words(&output);
    assert!(said.contains("going on after 60 nodes"), "{said}");
    assert!(checkpoint.read().unwrap().is_empty());
    assert!(room.holds("out/map.csv"));
}

#[test]
fn a_map_in_shards_is_the_map_in_one_piece() {
    let room = Room::new();
    let at = |name: &str| room.at(name);
    let (file, one, out) = (at("plane.toml"), at("one"), at("out"));
    std::fs::write(&file, RAYLEIGH).unwrap();
    let run = |arguments: &[&str]| {
        let output = pbif(arguments);
        (output.status.code(), words(&output))
    };
    let read = |name: &str| std::fs::read_to_string(at(name)).unwrap();
    let (code, said) = run(&["sweep", &file, "--quiet", "--out", &one]);
    assert!(code <= Some(1), "{said}");
    let shard = |number: &str| {
        let words = [
            "sweep", &file, "--quiet", "--out", &out, "--shard", number, "--resume",
        ];
        let (code, said) = run(&words);
        assert_eq!(code, Some(0), "{said}");
        said
    };
    assert!(shard("3/3").contains("shard 3 of 3 of a map"));
    // What is missing is named.
    let (code, said) = run(&["merge", &out]);
    assert_eq!(code, Some(2), "{said}");
    assert!(
        said.contains("1/3 (not begun)") && said.contains("--shard 1/3"),
        "{said}"
    );
    let (code, said) = run(&["merge", &out, "--partial"]);
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("for the shards of a sweep"), "{said}");
    shard("1/3");
    shard("2/3");
    assert!(shard("2/3").contains("the shard is complete"));
    let (code, merged) = run(&["merge", &out, "--quiet"]);
    assert!(code <= Some(1), "{merged}");

    // The nodes are the same, and so are the curves, to the tolerance of the solver.
    assert_eq!(read("out/map.csv"), read("one/map.csv"));
    let curves = |name: &str| -> Vec<(String, [f64; 2])> {
        let table = read(name);
        let rows = table.lines().skip(1).map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            let values = [2, 3].map(|place| cells[place].parse::<f64>().unwrap());
            (cells[..2].join(" "), values)
        });
        rows.collect()
    };
    let (whole, merged) = (curves("one/curves.csv"), curves("out/curves.csv"));
    assert_eq!(whole.len(), merged.len());
    for (a, b) in whole.iter().zip(&merged) {
        let off = ((a.1[0] - b.1[0]) / 0.08).hypot((a.1[1] - b.1[1]) / 0.02);
        assert!(a.0 == b.0 && off < 1e-7, "{a:?} {b:?}: {off:.1e}");
    }
    // Shards of another sweep do not fit.
    let other = ["sweep", &file, "--quiet", "--out", &out, "--shard", "2/3"];
    let (code, said) = run(&[&other[..], &["--set", "sweep.points=6"]].concat());
    assert_eq!(code, Some(0), "{said}");
    let (code, said) = run(&["merge", &out, "--quiet"]);
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("sweep.points"), "{said}");
}

#[test]
fn the_program_makes_maps_and_says_what_is_wrong_with_them() {
    let room = Room::new();
    let at = |name: &str| room.at(name);
    let (file, out) = (at("cusp.toml"), at("out"));
    std::fs::write(&file, CUSP).unwrap();
    let sweep = |more: &[&str]| {
        let mut arguments = vec!["sweep", file.as_str(), "--quiet", "--out", out.as_str()];
        arguments.extend(more);
        pbif(&arguments)
    };
    let output = sweep(&[]);
    let text = words(&output);
    assert!(
        text.contains("map of h and a") && text.contains("C2 "),
        "{text}"
    );
    for name in [
        "map.json",
        "map.csv",
        "curves.csv",
        "codimension_two.csv",
        "codimension_two.tex",
        "densities/x.csv",
        "figures/map_x.svg",
        "figures/map_x.png",
    ] {
        assert!(room.holds(&format!("out/{name}")), "{name}");
    }
    let table = room.read("out/map.csv");
    assert!(
        table.starts_with("h,a,signature_x,status,level,reason\n"),
        "{table}"
    );
    assert!(table.lines().any(|line| line.contains(",2 peaks,")));
    let curves = room.read("out/curves.csv");
    assert!(curves.starts_with("curve,label,h,a,error,"));
    assert!(curves.lines().any(|line| line.starts_with("C2,start,")));

    // Drawn again from what is stored, to the same picture.
    let draw = |more: &[&str]| {
        let mut arguments = vec!["plot", out.as_str(), "--quiet"];
        arguments.extend(more);
        pbif(&arguments)
    };
    let (again, folder_of) = (at("again"), |name: &str| at(&format!("{name}/map_x.svg")));
    let output = draw(&["--out", &again, "--format", "svg,csv", "--only", "map_x"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let read = |path: String| std::fs::read_to_string(path).unwrap();
    assert_eq!(read(folder_of("again")), read(folder_of("out/figures")));
    assert!(read(at("again/map_x.csv")).contains("curve 2,"));
    let output = draw(&["--style", "single,dark"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert_ne!(read(folder_of("again")), read(folder_of("out/figures")));
    for (more, says) in [
        (&["--at", "0.1"][..], "`--at` is for the run of a sweep"),
        (&["--only", "map_y"][..], "no figure `map_y`, only map_x"),
        (
            &["--set", "cells.x.count=9"][..],
            "cannot be set for a stored run",
        ),
    ] {
        let output = draw(more);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        let text = words(&output);
        assert!(text.contains(says), "{says}:\n{text}");
    }

    let refused = |more: &[&str], says: &[&str]| {
        let output = sweep(more);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        let text = words(&output);
        for says in says {
            assert!(text.contains(says), "{says}:\n{text}");
        }
    };
    // Complete, there is nothing to go on with; of another sweep it is refused.
    let again = sweep(&["--resume"]);
    assert_eq!(again.status.code(), Some(0), "{again:?}");
    assert!(words(&again).contains("the map is complete"));
    refused(
        &["--resume", "--set", "map.points=6"],
        &["is of another sweep", "map.points"],
    );
    refused(
        &["--shard", "1/20"],
        &["from 1 to 10", "along its second parameter"],
    );
    refused(
        &["--set", "map.parameter=h"],
        &["is the swept one, `h`", "`sigma2`"],
    );
    refused(&["--set", "map.parameter=b"], &["no parameter `b`"]);
    refused(&["--set", "map.to=-0.4"], &["from -0.4 to -0.4 along `a`"]);
    refused(
        &["--set", "map.depth=9"],
        &["`map.depth` cannot be `9`", "from 0 to 8"],
    );
    std::fs::write(&file, CUSP.replace("to = 1.0\n", "")).unwrap();
    refused(&[], &["missing key `map.to`"]);
}

#[test]
fn what_sweeps_locate_is_marked_in_the_plane_that_they_lie_in() {
    let room = Room::new();
    let at = |name: &str| room.at(name);
    let (map, line) = (at("map.toml"), at("line.toml"));
    std::fs::write(&map, CUSP).unwrap();
    let (before, after) = CUSP.split_once("[map]").unwrap();
    let rest = &after[after.find("[cells]").unwrap()..];
    std::fs::write(&line, format!("{before}{rest}")).unwrap();
    let sweep = |file: &str, out: &str, settings: &[&str]| {
        let mut arguments = vec!["sweep", file, "--quiet", "--out", out];
        arguments.extend(settings.iter().flat_map(|one| ["--set", one]));
        pbif(&arguments)
    };
    let plane = at("plane");
    sweep(&map, &plane, &[]);
    let runs = [
        ("over_h", &["system.parameters.a=0.6"][..]),
        (
            "over_a",
            &[
                "sweep.parameter=a",
                "sweep.from=0.3",
                "sweep.to=0.9",
                "system.parameters.h=0.2",
            ][..],
        ),
    ];
    let with = runs.map(|(name, settings)| {
        let output = sweep(&line, &at(name), settings);
        assert!(output.status.code() < Some(2), "{}", words(&output));
        at(name)
    });
    let pictures = at("pictures");
    let draw = |more: &[&str]| {
        let mut arguments = vec![
            "plot",
            plane.as_str(),
            "--quiet",
            "--out",
            pictures.as_str(),
        ];
        arguments.extend(["--format", "svg,csv,txt"].iter().chain(more));
        pbif(&arguments)
    };
    let output = draw(&["--with", &with[0], "--with", &with[1]]);
    assert_eq!(output.status.code(), Some(0), "{}", words(&output));
    let said = words(&output);
    // Both branches are crossed at a = 0.6, one at h = 0.2; the sweeps end where the curves pass.
    assert_eq!(
        said.matches("within the errors of both").count(),
        3,
        "{said}"
    );
    let read = |name: &str| room.read(&format!("pictures/{name}"));
    let table = read("map_x.csv");
    let rows: Vec<[f64; 2]> = table
        .lines()
        .filter_map(|line| line.strip_prefix("row PB"))
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            [1, 2].map(|k| cells[k].parse().unwrap())
        })
        .collect();
    assert_eq!(rows.len(), 3, "{table}");
    for row in rows {
        assert!(off_the_fold(row, [1.0, 1.4]).abs() < 1e-4, "{row:?}");
    }
    let caption = read("map_x.txt");
    assert!(
        caption.contains("sweeps over h at a = 0.6, over a at h = 0.2"),
        "{caption}"
    );
    let marked = read("map_x.svg");
    assert_eq!(draw(&[]).status.code(), Some(0));
    assert_ne!(read("map_x.svg"), marked);

    // What does not lie in the plane is refused.
    let others = [
        (
            &["system.parameters.sigma2=0.2"][..],
            "it has sigma2 = 0.2, and the plane has sigma2 = 0.1",
        ),
        (
            &["system.parameters.a=1.5"][..],
            "it holds a = 1.5, and the box goes from -0.4 to 1",
        ),
        (
            &["sweep.from=0.6", "sweep.to=0.7"][..],
            "its h goes from 0.6 to 0.7",
        ),
        (
            &["sweep.parameter=sigma2", "sweep.from=0.1", "sweep.to=0.2"][..],
            "it sweeps sigma2",
        ),
        (
            &["system.equations.x='h + a x - x^5'"][..],
            "its equations are not those of the plane",
        ),
    ];
    for (settings, says) in others {
        let other = at("other");
        let settings: Vec<&str> = [settings, &["sweep.points=3"]].concat();
        assert!(
            sweep(&line, &other, &settings).status.code() < Some(2),
            "{settings:?}"
        );
        let output = draw(&["--with", &other]);
        assert_eq!(output.status.code(), Some(2), "{}", words(&output));
        assert!(words(&output).contains(says), "{says}:\n{}", words(&output));
    }
    let of_a_run = pbif(&["plot", &with[0], "--with", &with[1]]);
    assert!(words(&of_a_run).contains("`--with` marks sweeps in the figure of a plane"));
}

#[test]
fn a_noise_that_one_corner_does_not_allow_is_refused_or_told() {
    // Noise of negative intensity at the lower end of the second parameter.
    let text = CUSP.replace(
        "parameter = \"a\"\nfrom = -0.4\nto = 1.0",
        "parameter = \"sigma2\"\nfrom = -0.1\nto = 0.5",
    );
    let sweep = SweepFile::parse("map.toml", &text).validate().unwrap();
    let report = sweep.prepare(&Cancellation::new()).unwrap_err().to_string();
    assert!(report.contains("sqrt"), "{report}");
}
