//! The table of keys against itself and against its documentation.

use super::*;

const BEGIN: &str = "<!-- keys: begin -->\n";
const END: &str = "<!-- keys: end -->";

/// The table of `docs/sweep-file.md`.
fn markdown() -> String {
    let mut text = "| key | value | default | meaning |\n| --- | --- | --- | --- |\n".to_owned();
    for key in KEYS {
        let (words, default, meaning) = (key.allowed(), key.default_words(), key.meaning());
        text += &format!("| `{}` | {words} | {default} | {meaning} |\n", key.path);
    }
    text
}

/// `PBIF_BLESS=1 cargo test keys` writes the table anew.
#[test]
fn the_documentation_holds_the_table() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/sweep-file.md");
    let text = std::fs::read_to_string(path).unwrap();
    let (before, rest) = text.split_once(BEGIN).unwrap();
    let (table, after) = rest.split_once(END).unwrap();
    if std::env::var_os("PBIF_BLESS").is_some() {
        let fresh = format!("{before}{BEGIN}{}{END}{after}", markdown());
        std::fs::write(path, fresh).unwrap();
        return;
    }
    // Row by row, so that a failure shows the row.
    let fresh = markdown();
    for (written, row) in table.lines().zip(fresh.lines()) {
        assert_eq!(written, row);
    }
    assert_eq!(table.lines().count(), fresh.lines().count());
}

#[test]
fn paths_match_names_of_the_model() {
    let count = find(&["cells", "z", "count"]).unwrap();
    assert_eq!(count.path, "cells.<axis>.count");
    assert_eq!(count.name_in(&["cells", "z", "count"]), "z");
    assert!(find(&["cells", "z"]).is_none());
    assert!(find(&["sweep", "count"]).is_none());
}

#[test]
fn no_key_is_listed_twice() {
    for (index, key) in KEYS.iter().enumerate() {
        assert!(KEYS[..index].iter().all(|other| other.path != key.path));
    }
}

#[test]
fn methods_and_defaults_come_from_the_options() {
    let key = |path: &str| find(&path.split('.').collect::<Vec<_>>()).unwrap();
    assert!(
        key("method.seed")
            .meaning()
            .starts_with("sgcm, monte-carlo: ")
    );
    assert!(key("method.kind").meaning().starts_with("How"));
    assert!(key("method.escape_limit").meaning().starts_with("Largest"));
    assert_eq!(key("method.kind").default_words(), "`\"generator\"`");
    assert_eq!(
        key("method.solver_tolerance").default_words(),
        "`1e-8` by generator, `1e-10` by sgcm"
    );
    assert_eq!(key("locate.grid_check").default_words(), "`\"on\"`");
    assert_eq!(key("sweep.from").default_words(), "required");
}

/// What a setter takes, the getter gives: every key lives in a field of its own.
#[test]
fn every_key_gives_back_what_it_was_set_to() {
    for (index, key) in KEYS.iter().enumerate() {
        let value = example(key);
        assert!(key.kind.holds(&value), "{}: {value:?}", key.path);
        for method in key.methods() {
            let mut untouched = Draft::default();
            untouched.method.kind = method;
            let mut draft = untouched.clone();
            (key.field.set)(&mut draft, "x", &value);
            assert_eq!(
                (key.field.get)(&draft, "x"),
                Some(value.clone()),
                "{}",
                key.path
            );
            // Nothing else has changed.
            for (other, _) in KEYS.iter().enumerate().filter(|(other, _)| *other != index) {
                let key_field = KEYS[other].field;
                if key.path != "method.kind" {
                    let (before, after) = (
                        (key_field.get)(&untouched, "x"),
                        (key_field.get)(&draft, "x"),
                    );
                    assert_eq!(before, after, "{} changes {}", key.path, KEYS[other].path);
                }
            }
        }
    }
}

/// A value that no key has by default.
fn example(key: &Key) -> crate::sweep_file::value::Plain {
    use crate::sweep_file::value::Plain;
    let text = |text: &str| Plain::Text(text.to_owned());
    let of = |kind: Kind| match kind {
        Kind::Text | Kind::Printable => text("y"),
        Kind::Number(_) => Plain::Number(0.625),
        Kind::Integer(_, most) => Plain::Integer(most.min(77)),
        Kind::Count(..) => Plain::Integer(17),
        Kind::Step => Plain::Number(0.375),
        Kind::Width => text("slide"),
        Kind::Choice(names) => text(names().last().unwrap()),
        Kind::Model => text(crate::sweep_file::keys::models().last().unwrap()),
        Kind::Pair => Plain::List(vec![text("x"), text("y")]),
        Kind::Formula => text("2 x"),
        Kind::Formulas => Plain::List(vec![text("sqrt(D)")]),
        Kind::Bounds => Plain::List(vec![text("-a"), text("a")]),
        Kind::Regions => Plain::List(vec![text("x > 2"), text("x < -2")]),
        Kind::List(_) => unreachable!(),
    };
    match key.kind {
        // Points and dots of print have a least number.
        Kind::Number(_) if key.path == "figures.style.text" => Plain::Number(9.5),
        Kind::Number(_) if key.path == "figures.style.dpi" => Plain::Number(95.0),
        Kind::Number(_) if key.path == "curve.step" => Plain::Number(0.125),
        Kind::List(kind) => Plain::List(vec![of(*kind)]),
        kind => of(kind),
    }
}
