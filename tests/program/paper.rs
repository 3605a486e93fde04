//! What docs/paper.md says the shipped sweeps of the paper's examples find: shapes at the paper's values, and where
//! they change.

use crate::common::room::Room;
use crate::common::table::Row;

fn swept(name: &str, settings: &str) -> Room {
    let room = Room::new();
    room.solved(&format!(
        "sweep sweeps/{name}.toml --quiet --out run {settings}"
    ));
    room
}

/// Peaks of x, y and (x, y) and craters of (x, y) at values.
fn assert_shapes(room: &Room, parameter: &str, shapes: [(f64, [&str; 4]); 4]) {
    let points = room.table("run/points.csv").0;
    for (value, shape) in shapes {
        let is_near = |row: &&Row| (row.number(parameter) - value).abs() < 1e-9;
        let row = points.iter().find(is_near).unwrap();
        let found = row.texts(["peaks_x", "peaks_y", "peaks_xy", "craters_xy"]);
        assert_eq!(found, shape, "{parameter} = {value}");
    }
}

#[test]
fn the_first_example_has_the_shapes_of_the_paper_and_changes_where_the_page_says() {
    let room = swept("paper_example1", "");
    let shapes = [
        (-0.02, ["2", "2", "2", "1"]),
        (-0.01, ["2", "2", "2", "1"]),
        (0.0, ["1", "1", "1", "0"]),
        (0.01, ["1", "1", "1", "0"]),
    ];
    assert_shapes(&room, "f_c", shapes);
    let table = room.table("run/bifurcations.csv");
    // Values of the page; other grids and schemes move them by less than 1e-6 (stated errors: 1.0e-6 and 2.8e-7).
    for (observable, values) in [
        ("x", &[-0.002_848_5][..]),
        ("xy", &[-0.000_621_44, 0.0]),
        ("y", &[0.0]),
    ] {
        let mut found = table.changes(observable);
        found.sort_by(|a, b| a.number("value").total_cmp(&b.number("value")));
        assert_eq!(found.len(), values.len(), "{found:?}");
        for (row, value) in found.into_iter().zip(values) {
            assert!((row.number("value") - value).abs() < 3e-6, "{row:?}");
            assert_eq!(&row["status"], "located");
        }
    }
}

#[test]
fn the_second_example_has_the_shapes_of_the_paper() {
    let cells = "cells.x.count=40 cells.y.count=40 cells.z.count=8";
    let coarse =
        "sweep.points=4 locate.tolerance=3 locate.largest_distance=0.99 locate.grid_check=off";
    let room = swept("paper_example2", &format!("{cells} {coarse}"));
    let shapes = [
        (0.5, ["1", "1", "1", "0"]),
        (0.0, ["1", "1", "1", "0"]),
        (-0.5, ["2", "1", "2", "0"]),
        (-1.0, ["2", "1", "2", "0"]),
    ];
    assert_shapes(&room, "alpha", shapes);
}
