//! Settings of first passages and of walls.

use super::*;

#[test]
fn a_passage_may_end_in_one_of_several_regions() {
    let text = WALLED.replace("[\"reflecting\", \"open\"]", "\"reflecting\"")
        + "[regions]\nfar = \"x > 8\"\n[passage]\nout = { start = { x = 2, v = 0 }, until = [\"far\", \"x < 0.5\"] }\n";
    let settings = parse(&text, &[]).unwrap();
    let labels = |settings: &Settings| {
        let question = &settings.family.questions.passages[0];
        let all = (0..question.exits.len()).map(|part| question.exit_label(part));
        all.collect::<Vec<_>>()
    };
    assert_eq!(labels(&settings), ["far", "2"]);
    assert_eq!(
        settings.family.questions.passages[0].until.text(),
        "(far) or (x < 0.5)"
    );
    let written = settings.to_toml();
    assert!(
        written.contains(r#"until = ["far", "x < 0.5"]"#),
        "{written}"
    );
    assert_eq!(labels(&parse(&written, &[]).unwrap()), ["far", "2"]);
    // What is wrong with a part is told once.
    let wrong = parse(&text.replace("x < 0.5", "x < q"), &[])
        .unwrap_err()
        .to_string();
    assert!(
        wrong.contains("`q`") && wrong.contains("1 error"),
        "{wrong}"
    );
    let none = parse(&text.replace("[\"far\", \"x < 0.5\"]", "[]"), &[]);
    assert!(none.unwrap_err().to_string().contains("list of strings"));
}

#[test]
fn rates_between_two_states_are_of_two_regions_by_the_generator() {
    let passage = "[passage]\nout = { from = \"x < 1\", to = \"x > 8\", switching = \"on\" }\n";
    let text = format!("{WALLED}{passage}");
    let settings = parse(&text, &[]).unwrap();
    assert!(settings.family.questions.passages[0].switching);
    let again = parse(&settings.to_toml(), &[]).unwrap();
    assert!(again.family.questions.passages[0].switching);
    let refused = |text: &str, sets: &[&str]| parse(text, sets).unwrap_err().to_string();
    let sampled = refused(&text, &["method.kind=monte-carlo"]);
    assert!(
        sampled.contains("by `generator`, not by `monte-carlo`"),
        "{sampled}"
    );
    let state = refused(
        &text.replace("from = \"x < 1\"", "start = { x = 1, v = 0 }"),
        &[],
    );
    assert!(state.contains("not from one region to another"), "{state}");
}

#[test]
fn transitions_are_between_two_regions_and_reactive_fields_have_their_numbers() {
    let passage = |more: &str| {
        let ends = "from = \"x < 1\", to = \"x > 8\"";
        format!("{WALLED}[passage]\nout = {{ {ends}, {more} }}\n")
    };
    let of = |text: &str| {
        let settings = parse(text, &[]).unwrap();
        // Written and read again, everything is still there.
        let again = parse(&settings.to_toml(), &[]).unwrap();
        let [one, other] = [settings, again].map(|settings| {
            let question = settings.family.questions.passages[0].clone();
            let fields = question.fields.into_iter().map(|field| field.name);
            (
                question.transitions.map(|either| either.text().to_owned()),
                fields.collect::<Vec<_>>(),
            )
        });
        assert_eq!(one, other);
        one
    };
    let either = Some("(x < 1) or (x > 8)".to_owned());
    assert_eq!(
        of(&passage("transitions = \"on\"")),
        (either.clone(), Vec::new())
    );
    let fields = passage("fields = [\"reactive-current\", \"reactive-density\", \"committor\"]");
    let names = [
        "committor",
        "reactive_density",
        "reactive_current_x",
        "reactive_current_v",
    ];
    let names = names.map(|name| format!("out_{name}")).to_vec();
    assert_eq!(of(&fields), (either, names));
    assert_eq!(of(&passage("fields = [\"committor\"]")).0, None);
    let refused = |text: &str, sets: &[&str]| parse(text, sets).unwrap_err().to_string();
    let asked = passage("transitions = \"on\"");
    let sampled = parse(&asked, &["method.kind=monte-carlo"]).unwrap();
    assert!(sampled.family.questions.passages[0].transitions.is_some());
    for (text, method) in [
        (&fields, "monte-carlo"),
        (&fields, "sgcm"),
        (&asked, "sgcm"),
    ] {
        let refused = refused(text, &[&format!("method.kind={method}")]);
        assert!(refused.contains("by `generator`"), "{refused}");
        assert!(refused.contains(&format!("not by `{method}`")), "{refused}");
    }
    let state = refused(
        &asked.replace("from = \"x < 1\"", "start = { x = 1, v = 0 }"),
        &[],
    );
    assert!(state.contains("not from one region to another"), "{state}");
    let basin = asked.replace("x < 1", "peak 1 of x");
    assert!(refused(&basin, &[]).contains("between regions that are found"));
}

/// A half line.
const WALLED: &str = r#"
[system.equations]
x = "-c"
v = "-v"
[system.noise]
x = "sqrt(2)"
[system.bounds]
x = ["reflecting", "open"]
[sweep]
parameter = "c"
from = 1
to = 2
points = 3
[cells]
x = { from = 0, to = 9, count = 50 }
v = { from = -1, to = 1, count = 50 }
"#;

#[test]
fn walls_stand_where_cells_end_and_are_written_again() {
    let settings = parse(WALLED, &[]).unwrap();
    let wall = (0.0, f64::INFINITY);
    let walls = |settings: &Settings| {
        settings
            .family
            .walls()
            .clone()
            .into_iter()
            .collect::<Vec<_>>()
    };
    assert_eq!(walls(&settings), [(0, wall)]);
    assert!(settings.to_toml().contains(r#"x = ["reflecting", "open"]"#));
    assert_eq!(
        walls(&parse(&settings.to_toml(), &[]).unwrap()),
        [(0, wall)]
    );
    let pair = r#"["reflecting", "open"]"#;
    let both = WALLED.replace(pair, r#""reflecting""#);
    assert_eq!(walls(&parse(&both, &[]).unwrap()), [(0, (0.0, 9.0))]);
    let refused = |text: &str, sets: &[&str]| parse(text, sets).unwrap_err().to_string();
    let absorbing = refused(&WALLED.replace("open", "absorbing"), &[]);
    assert!(absorbing.contains("[passage] exit"), "{absorbing}");
    let still = refused(
        &WALLED.replace(&format!("x = {pair}"), &format!("v = {pair}")),
        &[],
    );
    assert!(still.contains("no noise acts on `v`"), "{still}");
    let open = refused(&WALLED.replace("from = 0, to = 9, ", ""), &[]);
    assert!(open.contains("give `cells.x.from`"), "{open}");
    // The end without a wall may be found.
    let found = parse(&WALLED.replace("to = 9, ", ""), &[]).unwrap();
    assert_eq!(walls(&found), [(0, wall)]);
    let cells = refused(WALLED, &["method.kind=sgcm"]);
    assert!(cells.contains("walls that reflect"), "{cells}");
    let unknown = refused(
        &WALLED.replace(&format!("x = {pair}"), &format!("z = {pair}")),
        &[],
    );
    assert!(unknown.contains("no axis `z`"), "{unknown}");
    let word = refused(&WALLED.replace("open", "closed"), &[]);
    assert!(word.contains("closed"), "{word}");
    for (given, misspelt, meant) in [
        (pair, r#""reflectin""#, "reflecting"),
        (pair, r#""perodic""#, "periodic"),
        ("\"open\"", r#""opne""#, "open"),
        ("\"reflecting\"", r#""reflectng""#, "reflecting"),
    ] {
        let told = refused(&WALLED.replace(given, misspelt), &[]);
        let meant = format!("did you mean `{meant}`?");
        assert!(told.contains(&meant), "{misspelt}: {told}");
    }
}

#[cfg(feature = "figures")]
#[test]
fn single_figures_of_what_is_asked_for_can_be_named() {
    let asked = "[spectrum]\nof = [\"v\"]\n\
                 [passage]\nout = { from = \"x < 1\", to = \"x > 8\", fields = [\"committor\", \"reactive-current\"] }\n";
    let text = format!("{WALLED}{asked}");
    let drawn = |name: &str| parse(&text, &[&format!("figures.draw=[\"{name}\"]")]);
    for name in [
        "spectrum_v",
        "field_out_committor",
        "field_out_committor_1.5",
        "field_out_reactive_current",
    ] {
        drawn(name).unwrap();
    }
    for name in ["spectrum_x", "field_out_mean_time"] {
        let wrong = drawn(name).unwrap_err().to_string();
        assert!(wrong.contains("there is no figure"), "{wrong}");
    }
}
