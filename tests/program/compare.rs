//! `pbif compare` through the program: what it writes, and that the methods stand to each other as the exact density
//! says.

use crate::common::room::{Printed, Room};
use crate::common::table::Row;

/// A Coulomb oscillator that forgets three times as fast as the shipped one; at f_c = 0 its density is known, and the
/// same.
const SMALL: &str = "system.parameters.kappa=0.03 system.parameters.sigma2=0.03 sweep.from=-0.01 \
                     cells.x={from=-3.6,to=3.6,count=60} cells.y={from=-3.6,to=3.6,count=60} method.samples=600 \
                     method.error=0.006";

fn compare(room: &Room, settings: &str) -> Printed {
    room.run(&format!(
        "compare sweeps/coulomb_fc.toml --out out {SMALL} {settings}"
    ))
}

const METHODS: [&str; 4] = ["generator", "sgcm", "sgcm-slope", "monte-carlo"];

#[test]
fn methods_stand_to_each_other_as_the_exact_density_says() {
    let room = Room::new();
    let printed = compare(&room, "figures.at=[0.0]").ends(0);
    let methods = room.table("out/compare.csv").0;
    let by = |name: &str| methods.iter().find(|row| &row["method"] == name).unwrap();
    let [generator, plain, slope, _] = METHODS.map(|name| by(name).number("tv_exact_xy"));
    // The cells add a diffusion of up to h²/(12Δt) = 0.0017 to each axis beside a noise of 0.015 on one: about 20 % in
    // variance, 0.37 times as much in total variation. The correction takes out most of it, and the generator has an
    // error of the grid alone.
    assert!((0.04..0.12).contains(&plain), "{plain}");
    assert!(slope < plain / 3.0, "{slope} {plain}");
    assert!(generator < slope / 3.0, "{generator} {slope}");
    for name in METHODS {
        let row = by(name);
        assert_eq!(&row["status"], "solved");
        let [seconds, bytes, work] = row.numbers(["seconds", "bytes", "work"]);
        assert!(seconds > 0.0 && bytes > 1e5 && (work > 0.0 || name == "generator"));
    }
    assert_eq!(by("sgcm").number("map_step"), 1.0);
    assert_eq!(by("sgcm")["work"], by("sgcm-slope")["work"]);

    let distances = room.table("out/distances.csv").0;
    let pair = |first: &str, second: &str, observable: &str| -> &Row {
        let wanted = [first, second, observable];
        let names = ["first", "second", "observable"];
        let found = distances.iter().find(|row| row.texts(names) == wanted);
        found.unwrap_or_else(|| panic!("{wanted:?}"))
    };
    // Six pairs of methods and four with the exact density, three observables each.
    assert_eq!(distances.len(), 30);
    for observable in ["x", "y", "xy"] {
        let sampled = pair("generator", "monte-carlo", observable);
        assert_eq!(&sampled["tv_significant"], "false", "{sampled:?}");
        let [tv, noise] = sampled.numbers(["tv", "tv_noise"]);
        // Bins of a marginal err together, so that one run may be twice as far off as its noise says.
        assert!(tv < 2.5 * noise && tv > 0.3 * noise, "{sampled:?}");
        let truth = pair("monte-carlo", "exact", observable);
        let [tv, noise] = truth.numbers(["tv", "tv_noise"]);
        assert!(tv < 2.5 * noise, "{truth:?}");
        let paper = pair("generator", "sgcm", observable);
        assert_eq!(&paper["tv_significant"], "true", "{paper:?}");
    }

    let agreement = room.table("out/agreement.csv").0;
    assert_eq!(agreement.len(), 2);
    for row in &agreement {
        let [bins, share] = row.numbers(["bins", "share"]);
        assert!(bins > 30.0 && share > 0.95, "{row:?}");
    }

    let accuracy = room.table("out/accuracy.csv").0;
    assert!(accuracy.iter().all(|row| &row["reference"] == "exact"));
    let of = |name: &'static str| accuracy.iter().filter(move |row| &row["method"] == name);
    for name in METHODS {
        assert_eq!(of(name).count(), 3, "{name}");
    }
    // By cells: the generator's error falls with at least the third order of the number of cells an axis.
    let generator = of("generator").map(|row| row.numbers(["cells", "tv"]));
    let mut generator: Vec<[f64; 2]> = generator.collect();
    generator.sort_by(|a, b| a[0].total_cmp(&b[0]));
    assert!(generator[0][1] > 8.0 * generator[2][1], "{generator:?}");

    let files = "compare.md compare.tex compare.json densities.csv figures/marginals.svg figures/joint_xy.png \
                 figures/time_to_accuracy.svg";
    room.holds_all("out", files);
    let words: Vec<&str> = files.split_whitespace().collect();
    printed
        .says(&["generator and Monte Carlo agree"])
        .says(&words);
    let json = room.json("out/compare.json");
    assert_eq!(json["methods"].as_array().unwrap().len(), 4);
    assert_eq!(json["common_cells"], serde_json::json!([50, 50]));
}

#[test]
fn an_earlier_comparison_is_kept_and_numbers_repeat_on_any_threads() {
    let room = Room::new();
    let few = "figures.at=[0.005] figures.formats=[\"svg\"] system.parameters.kappa=0.1 system.parameters.sigma2=0.1 \
               method.error=0.03 method.samples=100 cells.x.count=30 cells.y.count=30";
    let tables =
        || ["densities.csv", "distances.csv"].map(|name| room.read(&format!("out/{name}")));
    compare(&room, few);
    let first = tables();
    room.write("out/mine.txt", "stays");
    let printed = compare(&room, &format!("{few} --quiet --threads 1"));
    assert!(printed.err.is_empty(), "{printed:?}");
    assert_eq!(first, tables());
    assert_eq!(first[0], room.read("out/previous/1/densities.csv"));
    room.holds_all("out/previous/1", "figures/marginals.svg");
    assert_eq!(room.read("out/mine.txt"), "stays");
    // Nothing half-made is left beside.
    let mut names = std::fs::read_dir(room.path("out")).unwrap();
    assert!(names.all(|name| !name.unwrap().file_name().to_string_lossy().starts_with('.')));
}

#[test]
fn bad_input_writes_nothing() {
    let room = Room::new();
    for (setting, words) in [
        ("figures.at=[]", "no value to compare at"),
        ("figures.at=[0.5]", "outside the sweep"),
        ("method.sample=3", "samples"),
    ] {
        compare(&room, setting).ends(2).says(&[words]);
        assert!(!room.holds("out"));
    }
}
