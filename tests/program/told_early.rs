//! What `pbif check` tells before anything is solved: passages that have numbers at no value, parameters at which a
//! formula has no value, tables in a wrong place.

use crate::common::room::Room;

const SYSTEM: &str = "\
[system]
equations = { x = 'a x - x^3' }
noise = { x = 'sqrt(2 D)' }
parameters = { D = 0.1 }
[sweep]
parameter = 'a'
from = 0.5
to = 1.0
points = 3
[cells]
x = { from = -3, to = 3, count = 60 }
";

/// `pbif check` refuses a file, with these words.
fn refused(text: &str, words: &[&str]) -> String {
    let room = Room::new();
    room.write("a.toml", text);
    room.refused("check a.toml", words).text()
}

#[test]
fn passages_that_no_cell_knows() {
    let cases: [(&str, &[&str]); 5] = [
        (
            "start = { x = 0 }, until = 'x > 5'",
            &[
                "no cell is inside `x > 5`, where passage `out` ends, at any value of a",
                "a.toml:13:",
                "x from -3 to 3",
                "widen the ranges",
            ],
        ),
        (
            "from = 'x < -4', until = 'x > 2'",
            &[
                "no cell is inside `x < -4`, where passage `out` starts",
                "widen the ranges",
            ],
        ),
        (
            "start = { x = 0 }, until = 'x < 9'",
            &["passage `out` ends at once: all cells are inside `x < 9`, at every value of a"],
        ),
        (
            "start = { x = 4 }, until = 'x > 2'",
            &[
                "passage `out` starts at x = 4, outside of the cells",
                "a.toml:13:",
                "x from -3 to 3",
                "widen `cells.x`",
            ],
        ),
        (
            "start = { x = 2.5 }, until = 'x > 2'",
            &[
                "passage `out` starts inside `x > 2`, where it ends",
                "start outside",
            ],
        ),
    ];
    for (passage, words) in cases {
        let room = Room::new();
        room.write(
            "a.toml",
            format!("{SYSTEM}[passage]\nout = {{ {passage} }}\n"),
        );
        let said = room.done("check a.toml").says(words).text();
        assert!(said.contains("warning: "), "{said}");
    }
    let room = Room::new();
    // A region that holds cells at some of the values alone, and free trajectories, which know no cells.
    let moving = "[passage]\nout = { start = { x = 0 }, until = 'x > 4 a' }\n";
    let far =
        "[passage]\nout = { start = { x = 0 }, until = 'x > 5' }\n[method]\nkind = 'monte-carlo'\n";
    for passage in [moving, far] {
        room.write("a.toml", format!("{SYSTEM}{passage}"));
        let said = room.done("check a.toml").text();
        assert!(!said.contains("passage `out`"), "{said}");
    }
}

#[test]
fn a_passage_without_a_name_is_told_once() {
    let text = format!("{SYSTEM}[passage]\nstart = {{ x = 0 }}\nuntil = 'x > 2'\n");
    let said = refused(
        &text,
        &[
            "`start` stands in [passage] itself",
            "a.toml:13:1",
            "write [passage.out]",
        ],
    );
    assert!(said.contains("1 error"), "{said}");
    // A passage may be called after a key.
    let room = Room::new();
    room.write(
        "a.toml",
        format!("{SYSTEM}[passage.to]\nstart = {{ x = 0 }}\nuntil = 'x > 2'\n"),
    );
    room.done("check a.toml");
}

#[test]
fn parameters_without_a_value_of_a_formula_are_not_blamed_on_the_cells() {
    let cases: [(&str, &str, &[&str]); 2] = [
        (
            "from = 0.5",
            "sqrt(a) - x",
            &[
                "in √(a) at a = -0.5",
                "change `sweep.from` and `sweep.to`, or the formula",
            ],
        ),
        (
            "D = 0.1",
            "a - x",
            &[
                "in √(2 D) at D = -0.5",
                "change `system.parameters.D`, or the formula",
            ],
        ),
    ];
    for (old, equation, words) in cases {
        let (key, _) = old.split_once(" = ").unwrap();
        let text = SYSTEM
            .replace("a x - x^3", equation)
            .replace(old, &format!("{key} = -0.5"));
        let said = refused(&text, words);
        assert!(
            !said.contains("[cells]") && !said.contains("at x = "),
            "{said}"
        );
    }
    // Where the state takes part, it is told.
    let text = SYSTEM.replace("a x - x^3", "sqrt(a + x) - x");
    refused(&text, &["on the domain", "at x = -3", "[cells]"]);
}

#[test]
fn tables_for_noises_and_levels_without_their_table() {
    let text = SYSTEM.replace(
        "noise = { x = 'sqrt(2 D)' }",
        "noise = { x = { kind = 'white', amplitude = 1 } }",
    );
    refused(
        &text,
        &[
            "`system.noise.x` cannot be a table",
            "`kind = \"ornstein-uhlenbeck\"` in [system.noise]",
        ],
    );
    let text = format!("{SYSTEM}[levels]\ndecay_rate_1 = 0.3\n");
    refused(
        &text,
        &[
            "`decay_rate_1` is no number of this sweep",
            "add the table [relaxation]",
            "mean_x",
        ],
    );
}
