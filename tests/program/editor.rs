//! The editor of the live page: what an edited sweep file makes, and what is said of one that makes nothing.

use serde_json::{Value, json};

use super::explorer::scene;
use super::live::{Served, status};

const LINE: &str = include_str!("../../sweeps/bistable.toml");

/// A well without a barrier at c = 0, typed.
const TYPED: &str = r#"title = "Edited"
[system.equations]
x = "c x - x^5"
[system.noise]
x = "0.4"
[sweep]
parameter = "c"
from = -1
to = 1
points = 5
[cells]
x = { from = -2, to = 2, count = 40 }
"#;

/// Asks for the page of a text.
fn edit(served: &Served, from: &str, ticket: u64, text: &str) -> Value {
    let body = json!({"lane": "e", "ticket": ticket, "text": text}).to_string();
    let (code, answer) = served.post(&format!("{from}edit"), &body);
    assert_eq!(code, 200, "{answer}");
    answer
}

#[test]
fn an_edited_system_has_a_page_of_its_own_and_is_solved() {
    let served = Served::of(LINE, "cells.x.count=40");
    let first = scene(&served.page(""));
    // Keys were set on top of the file: the editor begins with all of them.
    let typed = first["typed"].as_str().unwrap();
    assert!(typed.contains("count = 40"), "{typed}");
    let answer = edit(&served, "", 1, TYPED);
    assert_eq!(answer["done"]["folder"], "1/", "{answer}");
    let page = scene(&served.page("1/"));
    assert_eq!(
        (&page["title"], &page["typed"]),
        (&json!("Edited"), &json!(TYPED))
    );
    assert_eq!(page["swept"]["name"], "c");
    // Each page asks for its own system.
    let solve = |folder: &str, name: &str| {
        let values = json!({ name: 0.3 });
        let body = json!({"lane": "a", "ticket": 1, "moving": name, "values": values});
        served.post(&format!("{folder}solve"), &body.to_string()).1
    };
    for (folder, own, other) in [("", "a", "c"), ("1/", "c", "a")] {
        assert!(solve(folder, own)["done"].is_object(), "{folder} {own}");
        assert!(
            solve(folder, other)["refused"].is_string() || solve(folder, other)["stale"] == true
        );
    }
    // An older ticket of the same lane is stale.
    assert_eq!(edit(&served, "", 1, TYPED)["stale"], true);
}

#[test]
fn a_wrong_text_is_refused_with_its_place() {
    let served = Served::of(LINE, "cells.x.count=40");
    for (ticket, (wrong, says)) in (1..).zip([
        (
            "x = \"c x - z^5\"",
            ["edited.toml:3:12", "^ here", "unknown symbol `z`"],
        ),
        ("x = \"c x - \"", ["edited.toml:3:", "^", "error"]),
        ("= 3", ["edited.toml:3:", "^", "error"]),
    ]) {
        let text = TYPED.replace("x = \"c x - x^5\"", wrong);
        let answer = edit(&served, "", ticket, &text);
        let told = answer["refused"].as_str().unwrap_or_default();
        assert!(says.iter().all(|words| told.contains(words)), "{told}");
        assert!(!told.contains('\u{1b}'), "{told}");
    }
    assert_eq!(status(&served.page("1/")), 404);
    let (_, answer) = served.post("edit", r#"{"lane":"e","ticket":9}"#);
    assert!(answer["refused"].is_string(), "{answer}");
}

#[test]
fn old_systems_give_way_and_all_of_the_gallery_can_be_begun_with() {
    let served = Served::of(LINE, "cells.x.count=40");
    let (_, answer) = served.post("starts", "{}");
    let starts = answer["done"].as_array().unwrap();
    let names = starts.iter().map(|start| start["name"].as_str().unwrap());
    assert!(
        names.eq(pbif::sweep_file::starting_files()
            .iter()
            .map(|file| file.name))
    );
    for number in 1..=9 {
        let folder = if number == 1 { "" } else { "1/" };
        let answer = edit(&served, folder, number, TYPED);
        assert_eq!(answer["done"]["folder"], format!("{number}/"));
    }
    for (folder, code) in [
        ("", 200),
        ("1/", 404),
        ("2/", 200),
        ("9/", 200),
        ("10/", 404),
        ("x/", 404),
    ] {
        assert_eq!(status(&served.page(folder)), code, "{folder}");
    }
}
