//! Names that a sweep file gives, beside the names that a run gives to columns and arrays: what would be called alike
//! is refused before anything is solved, with the place of the name.

use crate::common::room::Room;
use pbif::run::check_names;
use pbif::sweep_file::{SweepFile, starting_files};
use pbif::system::registry;

/// A system of two axes, watched alone and together; `swept` is in its first equation.
fn two_axes([one, other]: [&str; 2], swept: &str, more: &str) -> String {
    format!(
        "[system.equations]\n{one} = \"{swept} {one} - {one}^3\"\n{other} = \"{one} - {other}\"\n\
         [system.noise]\n{one} = \"1\"\n{other} = \"1\"\n\
         [system.parameters]\nspare = 1.0\n\
         [sweep]\nparameter = \"{swept}\"\nfrom = 0.5\nto = 1.0\npoints = 3\n\
         [cells]\n{one} = {{ from = -3.0, to = 3.0, count = 20 }}\n{other} = {{ from = -3.0, to = 3.0, count = 20 }}\n\
         {more}\n"
    )
}

/// What `pbif check` says of a sweep file that it refuses.
fn refused(text: &str) -> String {
    let room = Room::new();
    room.write("mine.toml", text);
    let output = room.run("check mine.toml");
    let said = output.text();
    assert_eq!(output.code, Some(2), "{text}\n{said}");
    said
}

#[test]
fn a_quantity_is_not_called_as_a_pair_of_axes_is() {
    let detect = "[detect]\nmarginals = [\"x\", \"xy = x + y\"]\njoint = [[\"x\", \"y\"]]";
    let said = refused(&two_axes(["x", "y"], "a", detect));
    for words in [
        "two arrays of densities.zarr would be called `p_xy`: the marginal density of xy, and the joint density of x and y",
        "mine.toml:18",
        "give `xy` another name",
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
    assert!(said.contains("1 error"), "{said}");
}

#[test]
fn a_swept_parameter_is_not_called_as_a_column_or_an_array_is() {
    let swept = [
        ("x_edges", "edges of the cells of x"),
        ("p_x", "marginal density of x"),
        ("p_x_error", "standard error of the marginal density of x"),
        ("p_x_second", "second discretisation"),
        ("p_x_replicate", "replicates of the"),
        ("p_x_kink_0", "kinks of the"),
        ("replicate", "densities.zarr"),
        ("status", "points.csv"),
        ("mean_x", "points.csv"),
        ("sd_x", "points.csv"),
        ("peaks_xy", "points.csv"),
        ("findings", "points.csv"),
        ("position_2", "features.csv"),
        ("verdict", "features.csv"),
        ("failure", "checks.csv"),
        ("entropy_xy", "points.csv"),
    ];
    let measured = "[detect]\njoint = [[\"x\", \"y\"]]\nmeasures = [\"entropy\"]";
    for (name, reason) in swept {
        let said = refused(&two_axes(["x", "y"], name, measured));
        let remedy = format!("give `{name}` another name");
        for words in [reason, &remedy, "mine.toml:10", "parameter = "] {
            assert!(said.contains(words), "{name}: {words}: {said}");
        }
    }
}

#[test]
fn an_axis_is_not_called_as_a_key_or_an_array_is() {
    for (name, reason) in [
        ("x_edges", "edges of the cells of x"),
        ("p_x", "marginal density of x"),
        ("p_x_kink_3", "kinks of the marginal density of x"),
        ("sd_x", "arrays of an export"),
        ("accuracy", "`cells.accuracy` is a key"),
        ("kind", "`system.noise.kind` is a key"),
        ("interpretation", "`system.noise.interpretation` is a key"),
    ] {
        let said = refused(&two_axes(["x", name], "a", ""));
        assert!(
            said.contains(reason) && said.contains("mine.toml:3"),
            "{name}: {said}"
        );
    }
    // Without an array of the same name they are names like others.
    for names in [["x", "z_edges"], ["p_q", "y"], ["error", "count"]] {
        let text = two_axes(names, "a", "");
        let settings = SweepFile::parse("mine.toml", &text).validate().unwrap();
        check_names(&settings).unwrap();
    }
}

#[test]
fn a_second_parameter_is_not_called_as_a_column_of_its_tables_is() {
    let plane = |section: &str, name: &str| {
        let more = format!("[{section}]\nparameter = \"{name}\"\nfrom = 0.5\nto = 1.5");
        two_axes(["x", "y"], "a", &more)
            .replace("spare = 1.0", &format!("{name} = 1.0"))
            .replace("- y\"", &format!("- {name} y\""))
    };
    for (name, file) in [
        ("level", "map.csv"),
        ("density", "a table in densities"),
        ("arclength", "curves.csv"),
        ("edge_a", "curves.csv"),
        ("place", "codimension_two.csv"),
    ] {
        let said = refused(&plane("map", name));
        let words = format!("columns of {file} would be called `{name}`");
        assert!(
            said.contains(&words) && said.contains("mine.toml:18"),
            "{said}"
        );
    }
    assert!(refused(&plane("curve", "slope")).contains("curves.csv"));
    let levels = format!("{}\n[levels]\nmean_x = 0.1", plane("curve", "measure"));
    let said = refused(&levels);
    assert!(
        said.contains("columns of levels.csv would be called `measure`"),
        "{said}"
    );
    let fine = SweepFile::parse("mine.toml", &plane("curve", "measure"));
    check_names(&fine.validate().unwrap()).unwrap();
    let fine = SweepFile::parse("mine.toml", &plane("map", "status_2"))
        .validate()
        .unwrap();
    check_names(&fine).unwrap();
}

#[test]
fn a_second_parameter_of_the_command_is_not_called_as_a_column_is() {
    let room = Room::new();
    let text = "system.equations = { x = \"a x - slope x^3\" }\nsystem.noise = { x = \"0.5\" }\n\
                system.parameters = { slope = 1.0 }\n\
                sweep = { parameter = \"a\", from = -0.5, to = 0.6, points = 5 }\n\
                cells.x = { from = -2.5, to = 2.5, count = 60 }\nfigures = { formats = [] }\n";
    room.write("mine.toml", text);
    room.done("sweep mine.toml --quiet --out run");
    let words = [
        "columns of curves.csv would be called `slope`",
        "give `slope` another name",
    ];
    room.refused("curve run --second slope --from 0.5 --to 2", &words);
    assert!(!room.holds("run/curves"));
}

#[test]
fn a_swept_parameter_of_a_comparison_is_not_called_as_a_column_of_its_tables_is() {
    let room = Room::new();
    for (name, file) in [
        ("bytes", "compare.csv"),
        ("tv_noise", "distances.csv"),
        ("share", "agreement.csv"),
        ("generator", "measures.csv"),
        ("tv", "distances.csv"),
        ("reference", "accuracy.csv"),
    ] {
        let text = two_axes(["x", "y"], name, "");
        // A sweep has no such column.
        let settings = SweepFile::parse("mine.toml", &text).validate().unwrap();
        check_names(&settings).unwrap();
        room.write("mine.toml", text);
        let column = format!("columns of {file} would be called `{name}`");
        let remedy = format!("give `{name}` another name");
        room.refused("compare mine.toml", &[&column, &remedy, "mine.toml:10"]);
    }
    assert_eq!(room.names(), ["mine.toml"]);
}

#[test]
fn every_name_that_is_alike_is_told_once() {
    let detect = "[detect]\nmarginals = [\"x\", \"xy = x + y\", \"x_error = 2 x\"]\njoint = [[\"x\", \"y\"]]";
    let said = refused(&two_axes(["x", "y"], "status", detect));
    assert!(said.contains("3 errors"), "{said}");
    for name in ["xy", "x_error", "status"] {
        assert!(
            said.contains(&format!("give `{name}` another name")),
            "{said}"
        );
    }
}

#[test]
fn no_parameter_of_a_model_or_of_the_gallery_is_called_as_a_column_is() {
    for model in registry::models() {
        for swept in &model.parameters {
            let value = swept.default.unwrap_or(1.0);
            let given = model.parameters.iter().filter(|one| one.name != swept.name);
            let given: Vec<String> = given
                .map(|one| format!("{} = {:?}", one.name, one.default.unwrap_or(1.0)))
                .collect();
            let text = format!(
                "[system]\nmodel = \"{}\"\n[system.parameters]\n{}\n[sweep]\nparameter = \"{}\"\nfrom = {value:?}\nto = {:?}\npoints = 2\n",
                model.name,
                given.join("\n"),
                swept.name,
                value + 0.5,
            );
            let settings = SweepFile::parse("model.toml", &text).validate().unwrap();
            check_names(&settings).unwrap();
        }
    }
    for file in starting_files() {
        let settings = SweepFile::parse(file.name, file.text).validate().unwrap();
        check_names(&settings).unwrap();
    }
}

#[test]
fn what_is_averaged_is_exported_under_its_own_name() {
    let room = Room::new();
    let more = "[detect]\nmarginals = [\"x\", \"H = x^2\"]\njoint = []\n[watch]\npower = \"y^2\"";
    room.write("mine.toml", two_axes(["x", "y"], "a", more));
    room.solved("sweep mine.toml --out run --quiet locate.grid_check=off");
    room.done("export run --format netcdf --out run.nc");
    let archive = room.bytes("run.nc");
    let holds = |name: &str| {
        archive
            .windows(name.len())
            .any(|bytes| bytes == name.as_bytes())
    };
    assert!(holds("mean_power") && holds("sd_power") && holds("p_H"));
    assert!(!holds("mean_H"));
}
