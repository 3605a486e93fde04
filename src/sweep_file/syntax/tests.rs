use super::*;
use toml::de::DeTable;

fn message(text: &str) -> String {
    let (_, errors) = DeTable::parse_recoverable(text);
    let (found, _) = findings(text, &errors, 0, 0);
    let report = super::super::Report::new(Default::default(), found, 0);
    report.to_string()
}

#[test]
fn slips_are_named() {
    for (text, words) in [
        (
            "model = coulomb",
            "`coulomb` is a string and must be quoted",
        ),
        ("title = trial", "`trial` is a string and must be quoted"),
        ("title = infinite well", "`infinite well` is a string"),
        ("a = [x, \"y\"]", "`x` is a string"),
        ("model = “coulomb”", "quotation mark of print"),
        ("model = ‘coulomb’", "quotation mark of print"),
        ("from = −0.02", "`−` (U+2212) is not the minus sign"),
        ("from = –0.02", "is not the minus sign"),
        ("a = [−1, 2]", "is not the minus sign"),
        ("to = 0,01", "a comma stands inside a number"),
        ("points = 1,000", "a comma stands inside a number"),
        (
            "x = { from = -5,5, to = 5 }",
            "a comma stands inside a number",
        ),
        ("points = 7;", "`;` stands behind a value"),
        ("points: 7", "`:` stands behind a key"),
        ("to = 1/100", "`1/100` is a computation"),
        ("to = 2*3.14", "`2*3.14` is a computation"),
        ("points\u{a0}= 7", "an invisible character (U+00A0)"),
        ("\u{200b}points = 7", "an invisible character (U+200B)"),
        ("α = 1", "did you mean `alpha`?"),
        ("θ = 1", "did you mean `theta`? Formulas read `θ` so, too"),
        (
            "kapp\u{430} = 1",
            "`а` (U+0430) looks like `a`, and is a letter of another alphabet",
        ),
        ("kappa =", "`kappa` has no value"),
        ("p = { from = , to = 1 }", "`from` has no value"),
        ("sigma² = 1", "did you mean `sigma2`?"),
        ("p = { µ = 1 }", "did you mean `mu`?"),
        ("points = １１", "can stand in a string only"),
        ("title = \"$\\alpha$\"", "a backslash between `\"`"),
        ("a = 1\na = 2", "a key or table stands once"),
        ("[a]\n[a]", "a key or table stands once"),
        ("[a\nb = 1", "unclosed table"),
        ("x = { a = 1 }\nx.b = 2", "between the braces"),
    ] {
        let text = message(text);
        assert!(text.contains(words), "{words} not in\n{text}");
        assert!(
            text.contains("not valid TOML") && text.contains("1 error"),
            "{text}"
        );
    }
}

#[test]
fn nesting_is_bounded() {
    for text in [
        format!("a = {}", "[".repeat(100_000)),
        format!("a = {}", "{ a = ".repeat(50_000)),
        format!("a{} = 1", ".a".repeat(100_000)),
    ] {
        let text = message(&text);
        assert!(text.contains("recurs") && text.len() < 2000, "{text}");
    }
}

#[test]
fn errors_are_named_once_a_line_and_counted_beyond_the_first() {
    let text = message("= = =\n= = =\n");
    assert!(text.contains("2 errors"), "{text}");
    let many = "= = =\n".repeat(1000);
    let (_, errors) = DeTable::parse_recoverable(&many);
    let (found, further) = findings(&many, &errors, 0, 0);
    assert_eq!(found.len(), MOST_SHOWN);
    assert_eq!(further, 1000 - MOST_SHOWN);
}
