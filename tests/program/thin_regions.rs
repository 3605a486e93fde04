//! Regions that end a passage and are narrower than a cell.

use crate::common::room::{Room, assert_says};

/// A process on one axis that ends by entering a strip about 1, as wide as given, or below -1.5.
fn on_one_axis(strip: &str) -> String {
    format!(
        "[system.equations]
x = \"-a*x\"
[system.noise]
x = \"1\"
[sweep]
parameter = \"a\"
from = 1.0
to = 1.1
points = 2
[cells]
x = {{ from = -3, to = 3, count = 40 }}
[passage]
q = {{ start = {{ x = 0.4 }}, until = [\"{strip}\", \"x < -1.5\"] }}
[locate]
effort = 0.0
[figures]
draw = []
"
    )
}

#[test]
fn on_one_axis_a_strip_thinner_than_any_element_ends_a_process_as_all_beyond_its_border_does() {
    let room = Room::new();
    let numbers = |strip: &str, out: &str| {
        let text = on_one_axis(strip);
        room.write(
            "a.toml",
            text.replace("-1.5\"] }", "-1.5\"], fields = [\"mean-time\"] }"),
        );
        room.done(&format!("sweep a.toml --out {out}"));
        let row = &room.table(&format!("{out}/points.csv")).0[0];
        assert_eq!(&row["findings"], "");
        row.numbers(["q_mean", "q_sd", "q_rate", "q_1_share"])
    };
    let thin = numbers("1 < x < 1.001", "thin");
    let whole = numbers("x > 1", "whole");
    for (thin, whole) in thin.iter().zip(whole) {
        assert!((thin - whole).abs() < 1e-8, "{thin} is not {whole}");
    }
}

#[test]
fn a_part_of_a_target_between_the_nodes_is_told_and_leaves_no_numbers() {
    let room = Room::new();
    let two = on_one_axis("(x-1)^2 + (y-0.3)^2 < 0.0009")
        .replace("\"-a*x\"", "\"-a*x\"\ny = \"-a*y\"")
        .replace("x = \"1\"", "x = \"1\"\ny = \"1\"")
        .replace(
            "count = 40 }",
            "count = 40 }\ny = { from = -3, to = 3, count = 40 }",
        )
        .replace("x = 0.4", "x = 0.4, y = 0")
        .replace("\"x < -1.5\"", "\"x^2 + y^2 > 4\"");
    room.write("two.toml", two);
    let printed = room.done("sweep two.toml --out two");
    assert_says(
        &printed.text(),
        &["lies between the nodes of the cells", "use more cells"],
    );
    let row = &room.table("two/points.csv").0[0];
    assert_says(&row["findings"], &["passage-between"]);
    assert!(row["q_mean"].is_empty(), "{}", &row["q_mean"]);
}
