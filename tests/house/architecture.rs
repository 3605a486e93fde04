//! Holds the direction of dependencies between modules: reads the `use crate::` lines and paths of every source
//! file and checks that each module uses only those that stand before it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The modules that each module may use. The order is the one of the table in `src/lib.rs`.
#[rustfmt::skip]
const ALLOWED: &[(&str, &[&str])] = &[
    ("cancellation", &[]),
    ("bytes", &[]),
    ("numerics", &[]),
    ("formula", &[]),
    ("system", &["numerics", "formula"]),
    ("exponent", &["system"]),
    ("space", &["numerics"]),
    ("sampling", &["numerics", "cancellation", "system", "space"]),
    ("monte_carlo", &["numerics", "cancellation", "system", "space", "sampling"]),
    ("density", &["numerics", "bytes", "system", "space"]),
    ("generator", &["numerics", "system", "space", "density"]),
    ("stationary", &["numerics", "cancellation", "space", "sampling"]),
    ("passage", &["numerics", "cancellation", "system", "space", "density", "generator", "stationary"]),
    ("spectrum", &["numerics", "cancellation", "system", "space", "generator", "stationary"]),
    ("topology", &["numerics", "space", "density"]),
    ("continuation", &["numerics", "cancellation", "system", "exponent", "space", "density", "topology", "bytes"]),
    ("method", &[
        "numerics", "cancellation", "system", "exponent", "space", "sampling", "monte_carlo", "generator", "stationary", "passage",
        "spectrum", "density", "topology", "continuation", "bytes"
    ]),
    ("compare", &[
        "numerics", "cancellation", "system", "space", "sampling", "monte_carlo", "density", "continuation", "method"
    ]),
    ("figure", &["numerics", "formula", "system", "space", "density", "topology", "continuation", "compare"]),
    ("sweep_file", &[
        "numerics", "formula", "cancellation", "system", "exponent", "space", "sampling", "generator", "stationary", "density",
        "topology", "continuation", "method", "figure"
    ]),
    ("run", &[
        "formula", "system", "space", "density", "topology", "continuation", "compare", "sweep_file", "bytes",
        "cancellation", "method"
    ]),
    ("job", &["cancellation", "continuation", "compare", "figure", "sweep_file", "run"]),
    ("explore", &[
        "cancellation", "formula", "system", "space", "monte_carlo", "density", "topology", "continuation",
        "sweep_file", "run"
    ]),
    ("cli", &[
        "cancellation", "system", "exponent", "space", "sampling", "monte_carlo", "generator", "stationary", "density",
        "topology", "continuation", "method", "compare", "run", "figure", "sweep_file", "job",
        "explore"
    ]),
];

pub(crate) fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// The part of a file before its unit tests, without comments: tests may use anything.
pub(crate) fn code(text: &str) -> String {
    let body = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
    body.lines()
        .filter(|line| !line.trim_start().starts_with("//"))
        .collect::<Vec<_>>()
        .join("\n")
}

/// Names that follow `crate::`, those in braces (`use crate::{a, b}`) included.
fn used(code: &str) -> Vec<String> {
    let name = |text: &str| -> String {
        text.chars()
            .take_while(|c| c.is_alphanumeric() || *c == '_')
            .collect()
    };
    let mut names = Vec::new();
    for rest in code.split("crate::").skip(1) {
        if let Some(list) = rest.strip_prefix('{') {
            let list = list.split(';').next().unwrap_or_default();
            let mut depth = 0;
            let mut start = true;
            for (index, c) in list.char_indices() {
                if depth == 0 && start && c.is_alphabetic() {
                    names.push(name(&list[index..]));
                    start = false;
                }
                match c {
                    '{' => depth += 1,
                    '}' => depth -= 1,
                    ',' if depth == 0 => start = true,
                    _ => {}
                }
            }
        } else {
            names.push(name(rest));
        }
    }
    names
}

/// Modules used by each module, each with a file that uses it.
fn dependencies() -> BTreeMap<String, BTreeMap<String, PathBuf>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&root, &mut files);
    let mut map: BTreeMap<String, BTreeMap<String, PathBuf>> = BTreeMap::new();
    for file in files {
        let relative = file.strip_prefix(&root).unwrap().to_owned();
        let mut parts = relative.components();
        let module = parts
            .next()
            .unwrap()
            .as_os_str()
            .to_string_lossy()
            .into_owned();
        let is_test = relative
            .with_extension("")
            .iter()
            .any(|part| part == "tests");
        if parts.next().is_none() || is_test {
            continue;
        }
        let uses = map.entry(module).or_default();
        for name in used(&code(&std::fs::read_to_string(&file).unwrap())) {
            uses.entry(name).or_insert_with(|| relative.clone());
        }
    }
    map
}

#[test]
fn modules_use_only_those_before_them() {
    let found = dependencies();
    let mut wrong = Vec::new();
    for (module, uses) in &found {
        let allowed = ALLOWED.iter().find(|(name, _)| name == module);
        let (_, allowed) = allowed.unwrap_or_else(|| panic!("no rule for module `{module}`"));
        for (name, file) in uses {
            let is_module = found.contains_key(name);
            if is_module && name != module && !allowed.contains(&name.as_str()) {
                wrong.push(format!("{module} uses {name} (in {})", file.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_rule_has_no_cycle_and_the_reader_sees_dependencies() {
    for (index, (module, allowed)) in ALLOWED.iter().enumerate() {
        for name in *allowed {
            let place = ALLOWED.iter().position(|(other, _)| other == name).unwrap();
            assert!(
                place < index,
                "{module} may use {name}, which stands after it"
            );
        }
    }
    // The reader must see the forms in which dependencies are written.
    let text = "use crate::{space::{Axis, CellSpace}, density};\nlet a = crate::run::x;\nuse crate::system::System;";
    assert_eq!(used(text), ["space", "density", "run", "system"]);
    assert!(dependencies()["continuation"].contains_key("density"));
}

#[test]
fn the_citation_is_of_this_version() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let citation = std::fs::read_to_string(root.join("CITATION.cff")).unwrap();
    let version = format!("\nversion: {}\n", env!("CARGO_PKG_VERSION"));
    assert!(citation.contains(&version), "{citation}");
}

#[test]
fn comments_keep_to_120_characters() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    for folder in ["src", "tests", "examples", "benches"] {
        sources(&root.join(folder), &mut files);
    }
    let mut wrong = Vec::new();
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap();
        for (number, line) in text.lines().enumerate() {
            // A word that long, such as an address, cannot be broken.
            let mut words = line.split_whitespace();
            let is_breakable = words.all(|word| word.chars().count() < 100);
            // Neither can a row of a table.
            let said = line.trim_start().trim_start_matches(['/', '!']);
            let is_comment = line.trim_start().starts_with("//") && !said.starts_with(" |");
            if is_comment && is_breakable && line.chars().count() > 120 {
                wrong.push(format!("{}:{}", file.display(), number + 1));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
