//! Slow modes from a sweep file to tables and figures.

use crate::common::numbers::assert_holds;
use crate::common::room::Room;

/// dx = -k x dt + √2 dW.
const FILE: &str = r#"title = "relaxation"
[system.equations]
x = "-k x"
[system.noise]
x = "sqrt(2)"
[system.parameters]
k = 0.5
[sweep]
parameter = "k"
from = 0.5
to = 1.0
points = 5
[cells]
x = { from = -8.0, to = 8.0, count = 160 }
[relaxation]
modes = 2
[levels]
decay_rate_1 = 0.8
[figures]
formats = ["svg"]
draw = ["measures_decay_rate_1"]
"#;

#[test]
fn a_sweep_has_its_slow_modes_and_the_value_at_which_a_rate_is_met() {
    let room = Room::new();
    room.write("a.toml", FILE);
    room.done("sweep a.toml --out run");
    let table = room.table("run/points.csv");
    for row in &table.0 {
        let [k] = row.numbers(["k"]);
        assert_holds(row.numbers(["decay_rate_1", "decay_rate_1_error"]), k, 1e-4);
        assert_holds(
            row.numbers(["decay_rate_2", "decay_rate_2_error"]),
            2.0 * k,
            1e-2,
        );
        assert_eq!(row.numbers(["decay_frequency_1"]), [0.0]);
    }
    let rows = room.table("run/bifurcations.csv");
    let row = rows.0.iter().find(|row| &row["label"] == "LV1").unwrap();
    assert_holds(row.numbers(["value", "error"]), 0.8, 1e-3);
    room.holds_all("run", "figures/measures_decay_rate_1.svg");
    room.done("verify run");
}

#[test]
fn other_methods_have_no_slow_modes() {
    let room = Room::new();
    room.write("a.toml", FILE);
    for method in ["sgcm", "monte-carlo"] {
        let line = format!("check a.toml method.kind=\"{method}\"");
        room.refused(
            &line,
            &["slow modes are worked out by `generator`", "[relaxation]"],
        );
    }
}
