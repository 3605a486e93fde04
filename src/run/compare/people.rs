//! Tables for people: rounded to what is known, as plain text, Markdown and LaTeX.

use super::rows::factorisations;
use super::{ComparedRun, partner};
use crate::compare::{ComparedMeasure, ComparedValue, Distance, Method, Pair, Solved};
use crate::method::passage_columns;
use crate::run::latex::escape;
use crate::run::{format_number, format_with_error};

/// A table with a caption.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct CompareTable {
    /// What it shows.
    pub caption: String,
    /// Names of the columns.
    pub header: Vec<String>,
    /// The rows, a word a column.
    pub rows: Vec<Vec<String>>,
}

/// Two significant digits, powers of ten where plain decimals would be long.
fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits = format!("{value:.1e}");
    let number: f64 = digits.parse().unwrap_or(value);
    if (1e-3..1e5).contains(&number.abs()) {
        format_number(number)
    } else {
        digits
    }
}

/// A count as `1.2e8` when it is long.
fn count(value: f64) -> String {
    if value < 1e5 {
        format!("{value:.0}")
    } else {
        format!("{value:.1e}")
    }
}

fn megabytes(bytes: f64) -> String {
    match bytes {
        bytes if bytes < 1e6 => "< 1".to_owned(),
        bytes => format!("{:.0}", bytes / 1e6),
    }
}

/// A distance with its error, and in brackets what noise alone would make; a star marks what exceeds all errors.
fn distance(distance: &Distance) -> String {
    let (value, error) = if distance.error > 0.0 {
        let (value, error) = format_with_error(distance.value, distance.error);
        (value, format!(" ± {error}"))
    } else {
        (short(distance.value), String::new())
    };
    let noise = if distance.noise > 0.0 {
        format!(" ({})", short(distance.noise))
    } else {
        String::new()
    };
    let star = if distance.is_significant() { "*" } else { "" };
    format!("{value}{error}{noise}{star}")
}

fn work(solved: &Solved) -> String {
    match solved.work.steps {
        0 => format!("{} LU", factorisations(solved)),
        steps => format!("{} steps", count(steps as f64)),
    }
}

fn methods(run: &ComparedRun<'_>) -> CompareTable {
    let observables = &run.comparison.subject.observables;
    let known = |value: &ComparedValue| value.pairs.iter().any(|pair| pair.second.is_none());
    let exact = run.comparison.values.iter().any(known);
    let words = [
        run.family().parameter(),
        "method",
        "status",
        "seconds",
        "work",
        "MB",
        "cells",
        "samples",
    ];
    let mut header: Vec<String> = words.iter().map(|&word| word.to_owned()).collect();
    if exact {
        let names = observables.iter().map(|&one| one.name(run.family()));
        header.extend(names.map(|name| format!("TV to exact {name}")));
    }
    let mut rows = Vec::new();
    for value in &run.comparison.values {
        for solved in &value.solved {
            let mut row = vec![
                format_number(value.value),
                solved.method.name().to_owned(),
                solved.status.word().to_owned(),
                short(solved.work.seconds()),
                work(solved),
                solved.work.bytes.map_or_else(String::new, megabytes),
                solved.work.cells.to_string(),
                match solved.work.samples {
                    0 => String::new(),
                    samples => samples.to_string(),
                },
            ];
            if exact {
                row.extend(observables.iter().map(|&observable| {
                    let found = value.pair(solved.method, None, observable);
                    found.map_or(String::new(), |found| short(found.total_variation.value))
                }));
            }
            rows.push(row);
        }
    }
    CompareTable {
        caption: "Time, work and memory at each value. LU: factorisations; samples: a cell (SGCM), trajectories (Monte Carlo)".to_owned(),
        header,
        rows,
    }
}

fn pairs(
    run: &ComparedRun<'_>,
    caption: &str,
    choose: impl Fn(&Pair) -> &Distance,
) -> CompareTable {
    let observables = &run.comparison.subject.observables;
    let mut header = vec![run.family().parameter().to_owned(), "pair".to_owned()];
    header.extend(observables.iter().map(|&one| one.name(run.family())));
    let mut rows = Vec::new();
    for value in &run.comparison.values {
        let mut order: Vec<(Method, Option<Method>)> = Vec::new();
        for pair in &value.pairs {
            if !order.contains(&(pair.first, pair.second)) {
                order.push((pair.first, pair.second));
            }
        }
        for (first, second) in order {
            let mut row = vec![
                format_number(value.value),
                format!("{}, {}", first.name(), partner(second)),
            ];
            row.extend(observables.iter().map(|&observable| {
                let mut pairs = value.pairs.iter();
                let wanted = (first, second, observable);
                pairs
                    .find(|pair| (pair.first, pair.second, pair.observable) == wanted)
                    .map_or(String::new(), |pair| distance(choose(pair)))
            }));
            rows.push(row);
        }
    }
    CompareTable {
        caption: format!(
            "{caption} between two methods, ± its standard error, in brackets what sampling noise alone makes; * differs by more than noise, three errors and grid error"
        ),
        header,
        rows,
    }
}

fn agreement(run: &ComparedRun<'_>) -> CompareTable {
    let header = [
        run.family().parameter(),
        "marginal",
        "bins",
        "within 3 errors",
        "beyond all errors",
        "worst",
    ];
    let mut rows = Vec::new();
    for value in &run.comparison.values {
        for one in &value.agreement {
            rows.push(vec![
                format_number(value.value),
                one.observable.name(run.family()),
                one.bins.to_string(),
                format!("{:.1} %", 100.0 * one.share()),
                one.beyond.to_string(),
                format!("{:.1}", one.worst),
            ]);
        }
    }
    CompareTable {
        caption: "Generator and Monte Carlo, bin by bin, in standard errors of Monte Carlo"
            .to_owned(),
        header: header.map(str::to_owned).to_vec(),
        rows,
    }
}

fn passages(run: &ComparedRun<'_>) -> CompareTable {
    let parameter = run.family().parameter();
    let header = [
        parameter,
        "number",
        "generator",
        "Monte Carlo",
        "errors apart",
        "SGCM",
        "its errors apart",
    ];
    let columns = passage_columns(run.family());
    let in_words = |(value, error)| {
        let (value, error) = format_with_error(value, error);
        format!("{value} ± {error}")
    };
    let is_of_passage = |one: &ComparedMeasure| {
        let mut columns = columns.iter();
        columns.any(|column| column.kind.name(&column.of) == one.name)
    };
    let mut rows = Vec::new();
    for value in &run.comparison.values {
        for one in value.measures().into_iter().filter(is_of_passage) {
            rows.push(vec![
                format_number(value.value),
                one.name.clone(),
                in_words(one.generator),
                in_words(one.monte_carlo),
                format!("{:.1}", one.apart()),
                one.sgcm.map_or_else(String::new, in_words),
                one.sgcm_apart()
                    .map_or_else(String::new, |apart| format!("{apart:.1}")),
            ]);
        }
    }
    CompareTable {
        caption: "Times of first passage by generator, Monte Carlo and SGCM".to_owned(),
        header: header.map(str::to_owned).to_vec(),
        rows,
    }
}

/// The tables: methods, total variation, Hellinger distance, agreement of generator and Monte Carlo;
/// passages where there are some.
pub(crate) fn compare_tables(run: &ComparedRun<'_>) -> Vec<CompareTable> {
    let mut tables = vec![
        methods(run),
        pairs(run, "Total variation", |pair| {
            &pair.distances.total_variation
        }),
        pairs(run, "Hellinger distance", |pair| &pair.distances.hellinger),
        agreement(run),
    ];
    if !run.family().questions.passages.is_empty() {
        tables.push(passages(run));
    }
    tables
}

/// The tables as Markdown.
pub(super) fn compare_markdown(run: &ComparedRun<'_>) -> String {
    let line = |words: &[String]| format!("| {} |\n", words.join(" | ").replace('*', "\\*"));
    let mut text = String::new();
    for table in compare_tables(run) {
        text += &format!("{}.\n\n", table.caption.replace('*', "\\*"));
        text += &line(&table.header);
        text += &line(&vec!["---".to_owned(); table.header.len()]);
        for row in &table.rows {
            text += &line(row);
        }
        text.push('\n');
    }
    text
}

/// The tables as LaTeX with booktabs rules, each with its caption as a comment.
pub(super) fn compare_tex(run: &ComparedRun<'_>) -> String {
    let line = |words: &[String]| {
        let cells: Vec<String> = words.iter().map(|word| escape(word)).collect();
        format!("{} \\\\\n", cells.join(" & "))
    };
    let mut text = String::from("% needs \\usepackage{booktabs}\n");
    for table in compare_tables(run) {
        text += &format!("% {}\n", table.caption);
        let columns = "l".repeat(table.header.len());
        text += &format!("\\begin{{tabular}}{{{columns}}}\n\\toprule\n");
        text += &line(&table.header);
        text += "\\midrule\n";
        for row in &table.rows {
            text += &line(row);
        }
        text += "\\bottomrule\n\\end{tabular}\n\n";
    }
    text
}
