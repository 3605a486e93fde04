//! docs/validation.md holds what examples/validation.rs prints: a part of its tables is computed again.

#[allow(
    dead_code,
    reason = "only the tables that are quick to compute are used here"
)]
#[path = "../../examples/validation.rs"]
mod example;

/// Cells of a row of a Markdown table.
fn cells(row: &str) -> Vec<&str> {
    row.trim_matches('|').split('|').map(str::trim).collect()
}

/// The page's table under a heading of the given words.
fn table(heading: &str) -> Vec<Vec<String>> {
    let page = include_str!("../../docs/validation.md");
    let (_, rest) = page.split_once(&format!("\n## {heading}\n")).unwrap();
    let section = rest.split("\n## ").next().unwrap();
    let rows = section.lines().filter(|line| line.starts_with('|'));
    rows.map(|row| cells(row).into_iter().map(str::to_owned).collect())
        .collect()
}

/// Equal as text, or as numbers up to one unit in the last of two digits.
fn same(printed: &str, computed: &str) -> bool {
    match (printed.parse::<f64>(), computed.parse::<f64>()) {
        (Ok(a), Ok(b)) => (a - b).abs() <= 0.1 * a.abs().max(b.abs()),
        _ => printed == computed,
    }
}

/// Every computed row stands in the table.
fn assert_printed(heading: &str, computed: &[String]) {
    let table = table(heading);
    assert!(!computed.is_empty());
    for row in computed {
        let row = cells(row);
        let is_row = |printed: &Vec<String>| {
            printed.len() == row.len() && printed.iter().zip(&row).all(|(a, b)| same(a, b))
        };
        assert!(table.iter().any(is_row), "{heading}: no row {row:?}");
    }
}

#[test]
fn the_page_holds_what_the_example_computes() {
    assert_printed("Generator", &example::generator_rows(40, 1).unwrap());
    let heading = "Slope law at the switching surface";
    assert_printed(heading, &example::slope_rows(&[0.01]).unwrap());
    assert_printed("SGCM", &example::sgcm_rows(&[(6, 100, 2000, 0.5)]).unwrap());
    assert_printed(
        "Monte Carlo",
        &example::monte_carlo_rows(&[4], &[0.02]).unwrap(),
    );
}
