//! Files of one room do not use each other in circles. A `mod.rs`, or a file with a folder of its own, holds what the
//! files below it share: that these use it does not count. What it uses itself counts, as of any other file.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::architecture::{code, sources};

/// Code of files without their unit tests, by the file's path below `src`.
type Files = BTreeMap<String, String>;
/// The files that each file uses.
type Uses = BTreeMap<String, BTreeSet<String>>;

/// The segments of the module that a file is.
fn module(file: &str) -> Vec<String> {
    let name = file.strip_suffix(".rs").unwrap_or(file);
    let name = name.strip_suffix("/mod").unwrap_or(name);
    name.split('/').map(str::to_owned).collect()
}

/// The parts of a list that commas part, those in braces left whole.
fn parts(list: &str) -> Vec<&str> {
    let (mut parts, mut depth, mut start) = (Vec::new(), 0, 0);
    for (index, c) in list.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(list[start..index].trim());
                start = index + 1;
            }
            _ => {}
        }
    }
    parts.push(list[start..].trim());
    parts.retain(|part| !part.is_empty());
    parts
}

/// All paths of a tree of uses, each with the name that it gets.
fn expand(prefix: &str, tree: &str, into: &mut Vec<(String, String)>) {
    for part in parts(tree) {
        if let Some((head, rest)) = part.split_once('{') {
            let inner = rest.strip_suffix('}').unwrap();
            expand(&format!("{prefix}{head}"), inner, into);
        } else {
            let (path, name) = part.split_once(" as ").unwrap_or((part, part));
            let path = format!("{prefix}{path}");
            let path = path.strip_suffix("::self").unwrap_or(&path);
            let name = if name == "self" { path } else { name };
            let name = name.rsplit("::").next().unwrap();
            into.push((path.to_owned(), name.to_owned()));
        }
    }
}

/// A path that a file names, the name that it gets there, and whether the file only hands it on.
type Named = (String, String, bool);

/// What each file names.
type Names = BTreeMap<String, Vec<Named>>;

fn words(code: &str) -> impl Iterator<Item = &str> {
    let is_name = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    code.split(move |c| !is_name(c))
        .map(|word| word.trim_end_matches(':'))
}

/// What `use` names in a file, and the paths that it writes out elsewhere: from the root, from itself, from a module
/// of its own, or from a name that `use` brought.
fn paths(code: &str) -> Vec<Named> {
    let (mut used, mut handed_on, mut rest) = (Vec::new(), Vec::new(), String::new());
    for statement in code.split(';') {
        let tree = statement
            .rsplit_once("use ")
            .filter(|(_, tree)| !tree.contains('('));
        let Some((before, tree)) = tree else {
            rest += statement;
            rest.push(';');
            continue;
        };
        rest += before;
        let visibility = before.lines().next_back().unwrap_or_default();
        let is_handed_on = visibility.trim_start().starts_with("pub");
        let into = if is_handed_on {
            &mut handed_on
        } else {
            &mut used
        };
        let tree = tree.split_whitespace().collect::<Vec<_>>().join(" ");
        expand("", &tree, into);
    }
    // Texts in quotation marks name nothing.
    let plain = rest.lines().flat_map(|line| line.split('"').step_by(2));
    let at_home: BTreeSet<&str> = plain
        .flat_map(words)
        .flat_map(|word| word.split("::"))
        .collect();
    let is_used = |name: &str| at_home.contains(name);
    let own = used.into_iter().map(|(path, name)| (path, name, false));
    let others = handed_on.into_iter().map(|(path, name)| {
        let is_only_handed_on = !is_used(&name);
        (path, name, is_only_handed_on)
    });
    let mut found: Vec<Named> = own.chain(others).collect();
    let brought: BTreeMap<String, String> = found
        .iter()
        .map(|(path, name, _)| (name.clone(), path.clone()))
        .collect();
    for word in words(&rest) {
        let Some((head, tail)) = word.split_once("::") else {
            continue;
        };
        if ["crate", "super", "self"].contains(&head) {
            found.push((word.to_owned(), String::new(), false));
        } else if let Some(path) = brought.get(head) {
            found.push((format!("{path}::{tail}"), String::new(), false));
        } else if code.contains(&format!("mod {head};")) {
            found.push((format!("self::{word}"), String::new(), false));
        }
    }
    found
}

/// A path as segments from the root of the crate.
fn absolute(from: &[String], path: &str) -> Vec<String> {
    let mut segments: Vec<&str> = path.split("::").collect();
    let mut place = from.to_vec();
    match segments[0] {
        "crate" => {
            place.clear();
            segments.remove(0);
        }
        "self" => {
            segments.remove(0);
        }
        _ => {}
    }
    while segments.first() == Some(&"super") {
        place.pop();
        segments.remove(0);
    }
    place.extend(segments.into_iter().map(str::to_owned));
    place
}

/// The file in which a path ends, names that a `mod.rs` hands on followed to where they stand; none for a path that
/// only names a folder, as what is used of it is written elsewhere.
fn resolve(names: &Names, path: &[String], depth: usize) -> Option<String> {
    for length in (1..=path.len()).rev() {
        let base = path[..length].join("/");
        let of_module = [format!("{base}.rs"), format!("{base}/mod.rs")];
        let Some(file) = of_module.into_iter().find(|name| names.contains_key(name)) else {
            continue;
        };
        let handed_on = path.get(length).and_then(|wanted| {
            let mut all = names[&file].iter();
            all.find(|(_, name, _)| name == wanted)
        });
        return match handed_on {
            Some((to, ..)) if depth < 6 => {
                let mut next = absolute(&path[..length], to);
                next.extend_from_slice(&path[length + 1..]);
                resolve(names, &next, depth + 1)
            }
            _ => (length < path.len() || !file.ends_with("mod.rs")).then_some(file),
        };
    }
    None
}

fn uses(files: &Files) -> Uses {
    let room = |file: &str| file.split('/').next().unwrap().to_owned();
    let mut uses = Uses::new();
    // Each file is read once, however many others name it.
    let names: Names = (files.iter())
        .map(|(file, code)| (file.clone(), paths(code)))
        .collect();
    for (file, named) in &names {
        let own = module(file);
        let named = named.iter().filter(|(.., is_handed_on)| !is_handed_on);
        for (path, ..) in named {
            let to = resolve(&names, &absolute(&own, path), 0);
            let to = to.filter(|to| to != file && room(to) == room(file));
            let to = to.filter(|to| !own.starts_with(&module(to)));
            uses.entry(file.clone()).or_default().extend(to);
        }
    }
    uses
}

/// A circle of files, each of which uses the next.
fn circle(uses: &Uses) -> Option<Vec<String>> {
    fn follow(uses: &Uses, trail: &mut Vec<String>, done: &mut BTreeSet<String>) -> bool {
        let file = trail.last().unwrap().clone();
        for next in uses.get(&file).into_iter().flatten() {
            if let Some(place) = trail.iter().position(|one| one == next) {
                trail.drain(..place);
                return true;
            }
            if !done.contains(next) {
                trail.push(next.clone());
                if follow(uses, trail, done) {
                    return true;
                }
                trail.pop();
            }
        }
        done.insert(file);
        false
    }
    let mut done = BTreeSet::new();
    uses.keys().find_map(|file| {
        let mut trail = vec![file.clone()];
        follow(uses, &mut trail, &mut done).then_some(trail)
    })
}

#[test]
fn files_of_a_room_do_not_use_each_other_in_circles() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = Vec::new();
    sources(&root, &mut found);
    let file = |path: &std::path::PathBuf| {
        let name = path.strip_prefix(&root).unwrap().to_str().unwrap();
        let is_test = name.contains("tests/") || name.contains("tests.rs");
        let text = std::fs::read_to_string(path).unwrap();
        (!is_test && name.contains('/')).then(|| (name.to_owned(), code(&text)))
    };
    let uses = uses(&found.iter().filter_map(file).collect());
    assert!(uses["continuation/walk.rs"].contains("continuation/point.rs"));
    assert_eq!(circle(&uses), None);
}

#[test]
#[rustfmt::skip]
fn the_reader_sees_circles_through_a_list_of_modules() {
    let files = |user: &str| -> Files {
        let all = [
            ("a/mod.rs", "mod kinds;\nmod user;"),
            ("a/kinds/mod.rs", "mod one;\nconst ALL: [Kind; 1] = [one::KIND];"),
            ("a/kinds/one.rs", "use crate::a::user::Page;\nuse super::Kind;"),
            ("a/kinds/two.rs", "pub struct Two;"),
            ("a/user.rs", user),
        ];
        all.map(|(name, text)| (name.to_owned(), text.to_owned()))
            .into()
    };
    assert_eq!(circle(&uses(&files("use super::kinds;"))), None);
    assert_eq!(circle(&uses(&files("use super::kinds::two::Two;"))), None);
    for user in [
        "use super::kinds::ALL;",
        "use super::kinds;\nfn f() {\n    kinds::ALL\n}",
    ] {
        assert_eq!(circle(&uses(&files(user))).unwrap().len(), 3, "{user}");
    }
    let direct = "use super::kinds::{self};\nfn f() {\n    kinds::one::f()\n}";
    assert_eq!(circle(&uses(&files(direct))).unwrap().len(), 2);
}

#[test]
fn the_reader_sees_circles() {
    let files = |c: &str| -> Files {
        let all = [
            ("a/mod.rs", "mod b;\nmod c;\npub use b::{One as B, Two};"),
            ("a/b.rs", "use super::c::{C, D};\npub struct One;"),
            ("a/c.rs", c),
        ];
        all.map(|(name, text)| (name.to_owned(), text.to_owned()))
            .into()
    };
    assert_eq!(circle(&uses(&files("use crate::x::Y;"))), None);
    for c in [
        "use super::B;",
        "use crate::a::{B};",
        "fn c() {\n    super::b::f()\n}",
    ] {
        assert_eq!(circle(&uses(&files(c))).unwrap().len(), 2, "{c}");
    }
}
