//! Maps through the program: made, cut into shards, drawn, refused in words.

use super::maps::{CUSP, RAYLEIGH};
use super::support::off_the_fold;
use crate::common::room::Room;

#[test]
fn a_map_in_shards_is_the_map_in_one_piece() {
    let room = Room::new();
    room.write("plane.toml", RAYLEIGH);
    room.solved("sweep plane.toml --quiet --out one");
    let shard = |number: &str| {
        let line = format!("sweep plane.toml --quiet --out out --shard {number} --resume");
        room.done(&line)
    };
    shard("3/3").says(&["shard 3 of 3 of a map"]);
    // What is missing is named.
    room.refused("merge out", &["1/3 (not begun)", "--shard 1/3"]);
    room.refused("merge out --partial", &["for the shards of a sweep"]);
    shard("1/3");
    shard("2/3");
    shard("2/3").says(&["the shard is complete"]);
    let file = "out/shards/1-of-3/map.shard.json";
    let whole = room.read(file);
    room.write(file, format!("{whole}\n"));
    room.refused("merge out --quiet", &[file, "is changed"]);
    room.write(file, whole);
    room.solved("merge out --quiet");

    // The nodes are the same, and so are the curves, to the tolerance of the solver.
    assert_eq!(room.read("out/map.csv"), room.read("one/map.csv"));
    let [whole, merged] = ["one", "out"].map(|name| room.table(&format!("{name}/curves.csv")).0);
    assert_eq!(whole.len(), merged.len());
    for (one, other) in whole.iter().zip(&merged) {
        let [a, b] = [one, other].map(|row| row.numbers(["a", "sigma2"]));
        let off = ((a[0] - b[0]) / 0.08).hypot((a[1] - b[1]) / 0.02);
        let names = ["curve", "label"];
        assert_eq!(one.texts(names), other.texts(names));
        assert!(off < 1e-7, "{one:?} {other:?}: {off:.1e}");
    }
    // Shards of another sweep do not fit.
    room.done("sweep plane.toml --quiet --out out --shard 2/3 sweep.points=6");
    room.refused("merge out --quiet", &["sweep.points"]);
}

#[test]
#[rustfmt::skip]
fn the_program_makes_maps_and_says_what_is_wrong_with_them() {
    let room = Room::new();
    room.write("cusp.toml", CUSP);
    let sweep = "sweep cusp.toml --quiet --out out";
    room.run(sweep).says(&["map of h and a", "C2 "]);
    room.holds_all(
        "out",
        "map.json map.csv curves.csv codimension_two.csv codimension_two.tex",
    );
    room.holds_all("out", "densities/x.csv figures/map_x.svg figures/map_x.png");
    let table = room.read("out/map.csv");
    assert!(
        table.starts_with("h,a,signature_x,status,level,reason,findings\n"),
        "{table}"
    );
    assert!(table.lines().any(|line| line.contains(",2 peaks,")));
    let curves = room.read("out/curves.csv");
    assert!(curves.starts_with("curve,label,h,a,error,"));
    assert!(curves.lines().any(|line| line.starts_with("C2,start,")));

    // Drawn again from what is stored, to the same picture.
    let pictures = || ["again/map_x.svg", "out/figures/map_x.svg"].map(|name| room.read(name));
    room.done("plot out --quiet --out again --format svg,csv --only map_x");
    let [again, first] = pictures();
    assert_eq!(again, first);
    assert!(room.read("again/map_x.csv").contains("curve 2,"));
    room.done("plot out --quiet --style single,dark");
    let [again, other] = pictures();
    assert_ne!(again, other);
    for (more, words) in [
        ("--at 0.1", "`--at` is for the run of a sweep"),
        ("--only map_y", "no figure `map_y`, only map_x"),
        ("cells.x.count=9", "cannot be set for a stored run"),
    ] {
        room.refused(&format!("plot out --quiet {more}"), &[words]);
    }
    // What was altered is not drawn.
    for file in ["out/plane.json", "out/map.json"] {
        let whole = room.read(file);
        room.write(file, format!("{whole}\n"));
        for line in [
            "plot out --quiet --out more",
            "explore out --html more.html",
        ] {
            room.refused(line, &[file, "is changed"]);
        }
        room.write(file, whole);
    }
    // Complete, there is nothing to go on with; of another sweep it is refused.
    room.done(&format!("{sweep} --resume"))
        .says(&["the map is complete"]);
    for (more, words) in [
        ("--resume map.points=6", ["is of another sweep", "map.points"]),
        ("--shard 1/20", ["from 1 to 10", "along its second parameter"]),
        ("map.parameter=h", ["is the swept one, `h`", "`sigma2`"]),
        ("map.parameter=b", ["no parameter `b`", ""]),
        ("map.to=-0.4", ["from -0.4 to -0.4 along `a`", ""]),
        ("map.depth=9", ["`map.depth` cannot be `9`", "from 0 to 8"]),
    ] {
        room.refused(&format!("{sweep} {more}"), &words);
    }
    room.change("cusp.toml", "to = 1.0, ", "");
    room.refused(sweep, &["missing key `map.to`"]);
}

#[test]
#[rustfmt::skip]
fn what_sweeps_locate_is_marked_in_the_plane_that_they_lie_in() {
    let room = Room::new();
    room.write("map.toml", CUSP);
    let lines = CUSP.lines().filter(|line| !line.starts_with("map = "));
    room.write("line.toml", lines.collect::<Vec<_>>().join("\n"));
    room.solved("sweep map.toml --quiet --out plane");
    let line = |out: &str, settings: &str| {
        room.solved(&format!("sweep line.toml --quiet --out {out} {settings}"))
    };
    line("over_h", "system.parameters.a=0.6");
    let along_a = "sweep.parameter=a sweep.from=0.3 sweep.to=0.9";
    line("over_a", &format!("{along_a} system.parameters.h=0.2"));
    let draw = "plot plane --quiet --out pictures --format svg,csv,txt";
    let said = room
        .done(&format!("{draw} --with over_h --with over_a"))
        .text();
    // Both branches are crossed at a = 0.6, one at h = 0.2; the sweeps end where the curves pass.
    assert_eq!(
        said.matches("within the errors of both").count(),
        3,
        "{said}"
    );
    let read = |name: &str| room.read(&format!("pictures/{name}"));
    let table = read("map_x.csv");
    let rows: Vec<&str> = table
        .lines()
        .filter_map(|line| line.strip_prefix("row PB"))
        .collect();
    assert_eq!(rows.len(), 3, "{table}");
    for row in rows {
        let cells: Vec<&str> = row.split(',').collect();
        let values = [1, 2].map(|k| cells[k].parse().unwrap());
        assert!(off_the_fold(values, [1.0, 1.4]).abs() < 1e-4, "{row}");
    }
    let caption = read("map_x.txt");
    assert!(
        caption.contains("sweeps over h at a = 0.6, over a at h = 0.2"),
        "{caption}"
    );
    assert!(caption.contains("Method: generator; cells: "), "{caption}");
    let marked = read("map_x.svg");
    room.done(draw);
    assert_ne!(read("map_x.svg"), marked);

    // What does not lie in the plane is refused.
    for (settings, words) in [
        ("system.parameters.sigma2=0.2", "it has sigma2 = 0.2, and the plane has sigma2 = 0.1"),
        ("system.parameters.a=1.5", "it holds a = 1.5, and the box goes from -0.4 to 1"),
        ("sweep.from=0.6 sweep.to=0.7", "its h goes from 0.6 to 0.7"),
        ("sweep.parameter=sigma2 sweep.from=0.1 sweep.to=0.2", "it sweeps sigma2"),
        ("'system.equations.x=\"h + a x - x^5\"'", "its equations are not those of the plane"),
    ] {
        line("other", &format!("{settings} sweep.points=3"));
        room.refused(&format!("{draw} --with other"), &[words]);
    }
    let of_a_run = room.run("plot over_h --with over_a");
    of_a_run.says(&["`--with` marks sweeps in the figure of a plane"]);
}

/// Four wells that are rotated: exp(-U/0.565) has a crater with four peaks, two of which have a tenth of the height of
/// the others.
const FOUR_WELLS: &str = r#"
[system.equations]
x = "-0.57*eta*x + 0.135*eta*y + 0.135*theta*x - 0.57*theta*y - 1.96764*x*(x^2 - 1) + 0.45522*y*(y^2 - 0.948)"
y = "-0.135*eta*x - 0.778*eta*y - 0.778*theta*x - 0.135*theta*y - 0.46602*x*(x^2 - 1) - 2.623416*y*(y^2 - 0.948)"
[system.noise]
x = "0.802558409089332"
y = "0.937624658378821"
[system.parameters]
eta = -0.1402
[sweep]
parameter = "theta"
from = -0.75
to = -0.5
points = 3
[cells]
x = 41
y = 44
[detect]
marginals = []
joint = [["x", "y"]]
[map]
parameter = "eta"
from = -0.2
to = -0.1
points = 3
depth = 0
"#;

#[test]
fn a_map_says_of_its_nodes_what_a_sweep_says_of_its_points() {
    let room = Room::new();
    room.write("wells.toml", FOUR_WELLS);
    let words = [
        "the cells of x are too wide for the noise",
        "at 9 of 9 nodes the cells are too wide to count by",
    ];
    room.run("sweep wells.toml --out out").ends(1).says(&words);
    let nodes = room.table("out/map.csv").0;
    assert_eq!(nodes.len(), 9);
    for node in &nodes {
        let [signature, findings] = node.texts(["signature_xy", "findings"]);
        assert!(findings.contains("wide-cells-x:"), "{findings}");
        // Errors of high peaks are none of low ones: all are counted.
        assert_eq!(signature, "crater with 4 peaks");
    }
    let said = &room.json("out/map.json");
    assert_eq!(said["nodes_with_wide_cells"], 9);
    let drawn = room.read("out/figures/map_xy.svg");
    assert!(drawn.contains("cells too wide to count by"));
    // Drawn again from what is stored, to the same picture.
    room.done("plot out --quiet --out again --format svg");
    assert_eq!(room.read("again/map_xy.svg"), drawn);
}
