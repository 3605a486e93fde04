//! `bifurcations.tex` of real runs is LaTeX that compiles with booktabs: environments and braces balanced, every row
//! with as many cells as the table has columns, nothing special outside mathematics.

use crate::common::room::Room;

fn table_of(sweep: &str) -> String {
    let room = Room::new();
    room.solved(&format!("sweep sweeps/{sweep} --quiet --out run"));
    room.read("run/bifurcations.tex")
}

/// The parts of a text between unescaped separators.
fn split(text: &str, separator: char) -> Vec<String> {
    let mut parts = vec![String::new()];
    let mut escaped = false;
    for letter in text.chars() {
        if letter == separator && !escaped {
            parts.push(String::new());
        } else {
            parts.last_mut().unwrap().push(letter);
        }
        escaped = letter == '\\' && !escaped;
    }
    parts
}

/// What pdflatex would stop at.
fn assert_compiles(text: &str) {
    // Comments may only be whole lines.
    let code: Vec<&str> = text.lines().filter(|line| !line.starts_with('%')).collect();
    let code = code.join("\n");
    assert!(text.contains("booktabs"));
    assert_eq!(split(&code, '%').len(), 1, "{code}");
    let mut depth = 0_i32;
    for brace in code.replace("\\{", "").replace("\\}", "").chars() {
        depth += i32::from(brace == '{') - i32::from(brace == '}');
        assert!(depth >= 0, "{code}");
    }
    assert_eq!(depth, 0, "{code}");
    let names = |command: &str| -> Vec<String> {
        let parts = code.split(command).skip(1);
        parts
            .map(|part| part.split('}').next().unwrap().to_owned())
            .collect()
    };
    assert_eq!(names("\\begin{"), ["tabular"]);
    assert_eq!(names("\\end{"), ["tabular"]);
    let columns = code
        .split("\\begin{tabular}{")
        .nth(1)
        .unwrap()
        .split('}')
        .next()
        .unwrap();
    assert!(columns.chars().all(|c| "lcr".contains(c)), "{columns}");
    let places = ["\\toprule", "\\midrule", "\\bottomrule", "\\end{tabular}"].map(|rule| {
        assert_eq!(code.matches(rule).count(), 1, "{rule}");
        code.find(rule).unwrap()
    });
    assert!(places.is_sorted());
    let rows = code
        .lines()
        .filter(|line| !line.starts_with("\\") || line.ends_with("\\\\"));
    for row in rows {
        let row = row
            .strip_suffix(" \\\\")
            .unwrap_or_else(|| panic!("no end of row: {row}"));
        let cells = split(row, '&');
        assert_eq!(cells.len(), columns.len(), "{row}");
        for cell in cells {
            let parts = split(&cell, '$');
            assert!(parts.len() % 2 == 1, "{cell}");
            for text in parts.iter().step_by(2) {
                assert!(
                    split(text, '_').len() == 1 && split(text, '#').len() == 1,
                    "{cell}"
                );
                assert!(
                    !text.replace("\\textasciicircum", "").contains('^'),
                    "{cell}"
                );
            }
            let known = |c: char| c.is_ascii() && !c.is_control() || ('À'..='ž').contains(&c);
            assert!(cell.chars().all(known), "{cell}");
        }
    }
}

#[test]
fn tables_of_all_kinds_of_rows_compile() {
    let coulomb = "cells.x.count=40 cells.y.count=40 sweep.points=5 locate.tolerance=5e-3";
    let eq8 = "cells.x.count=16 cells.y.count=16 cells.z.count=10 sweep.points=2";
    for (sweep, row) in [
        (format!("coulomb_fc.toml {coulomb}"), "PB1"),
        (format!("dahl_alpha_eq8.toml {eq8}"), "MX1"),
        ("bistable.toml sweep.points=9".to_owned(), "PB1"),
        (
            "bistable.toml sweep.points=3 sweep.to=-0.5 figures.at=[-1.0]".to_owned(),
            "",
        ),
    ] {
        let text = table_of(&sweep);
        assert!(text.contains(row), "{text}");
        assert_compiles(&text);
    }
}

#[test]
fn what_does_not_compile_is_found() {
    let good = "% needs \\usepackage{booktabs}\n\\begin{tabular}{ll}\n\\toprule\na & $b_{c}$ \\\\\n\\midrule\n\
                x & 2 $\\to$ 3 \\\\\n\\bottomrule\n\\end{tabular}\n";
    assert_compiles(good);
    for (old, new) in [
        ("2 $", "2 → $"),
        ("x &", "x_1 &"),
        ("x &", "x & y &"),
        ("x &", "95% &"),
        ("$\\to$", "$\\to"),
        ("{c}", "{c"),
        ("\\midrule\n", ""),
        ("\\end{tabular}", ""),
        ("3 \\\\", "3"),
    ] {
        let bad = good.replace(old, new);
        assert!(
            std::panic::catch_unwind(|| assert_compiles(&bad)).is_err(),
            "{bad}"
        );
    }
}
