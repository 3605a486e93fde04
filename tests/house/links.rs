//! Links of the pages lead somewhere: files beside them exist, and so do the headings that they name.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The pages that are read.
pub(super) fn pages() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut folders = vec![root.to_owned(), root.join("python")];
    let mut found = Vec::new();
    let mut open = vec![root.join("docs"), root.join("examples")];
    while let Some(folder) = open.pop() {
        let inside = std::fs::read_dir(&folder).unwrap();
        let inside = inside.map(|entry| entry.unwrap().path());
        open.extend(inside.filter(|path| path.is_dir()));
        folders.push(folder);
    }
    for folder in folders {
        let inside = std::fs::read_dir(folder).unwrap();
        let inside = inside.map(|entry| entry.unwrap().path());
        found.extend(inside.filter(|path| path.extension().is_some_and(|one| one == "md")));
    }
    found.sort();
    found
}

/// The text of a page without its code, which holds brackets that are no links.
pub(super) fn prose(text: &str) -> String {
    let mut is_fenced = false;
    let mut kept = String::new();
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            is_fenced = !is_fenced;
        } else if !is_fenced && !line.starts_with("    ") {
            let outside = line.split('`').step_by(2);
            kept.extend(outside.flat_map(|part| [part, "`"]));
            kept.push('\n');
        }
    }
    kept
}

/// Where the links of a page lead.
fn targets(text: &str) -> Vec<String> {
    let text = prose(text);
    let parts = text.split("](").skip(1);
    let target = |part: &str| part.split([')', ' ']).next().unwrap_or_default().to_owned();
    parts.map(target).collect()
}

/// The name of a heading in an address, as hosts of repositories make it.
fn anchor(heading: &str) -> String {
    let letter = |c: char| match c {
        ' ' => Some('-'),
        '-' | '_' => Some(c),
        c if c.is_alphanumeric() => Some(c.to_ascii_lowercase()),
        _ => None,
    };
    heading.trim().chars().filter_map(letter).collect()
}

/// The names of all headings of a page; of equal ones the second has a number.
fn anchors(text: &str) -> Vec<String> {
    let mut seen: BTreeMap<String, usize> = BTreeMap::new();
    let mut is_fenced = false;
    let mut found = Vec::new();
    for line in text.lines() {
        is_fenced ^= line.starts_with("```");
        let heading = line.trim_start_matches('#');
        if is_fenced || heading.len() == line.len() || !heading.starts_with(' ') {
            continue;
        }
        let name = anchor(heading);
        let count = seen.entry(name.clone()).or_default();
        found.push(match *count {
            0 => name,
            count => format!("{name}-{count}"),
        });
        *count += 1;
    }
    found
}

#[test]
fn headings_have_the_names_that_hosts_give_them() {
    let page = "# What `pbif` does: a + b\n## Size\n```\n# no heading\n```\n## Size\n";
    assert_eq!(anchors(page), ["what-pbif-does-a--b", "size", "size-1"]);
    let page = "See [a](b.md#c), ![x](d.png) and `[no](link)`.\n\n    p[0](x)\n";
    assert_eq!(targets(page), ["b.md#c", "d.png"]);
}

#[test]
fn links_of_pages_lead_somewhere() {
    let mut broken = Vec::new();
    let mut count = 0;
    for page in pages() {
        let text = std::fs::read_to_string(&page).unwrap();
        for target in targets(&text) {
            if target.contains("://") || target.starts_with("mailto:") {
                continue;
            }
            count += 1;
            let (file, heading) = target.split_once('#').unwrap_or((&target, ""));
            let beside = page.parent().unwrap().join(file);
            let led = if file.is_empty() { &page } else { &beside };
            let is_there = led.exists();
            let has_heading = || {
                let text = std::fs::read_to_string(led).unwrap_or_default();
                heading.is_empty() || anchors(&text).iter().any(|one| one == heading)
            };
            if !is_there || !has_heading() {
                broken.push(format!("{}: {target}", page.display()));
            }
        }
    }
    assert!(count > 100, "only {count} links were read");
    assert!(broken.is_empty(), "lead nowhere:\n{}", broken.join("\n"));
}

/// From where a reader begins, every page can be reached.
#[test]
fn the_index_leads_to_every_page() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    let index = std::fs::read_to_string(docs.join("index.md")).unwrap();
    let led: Vec<PathBuf> = targets(&index)
        .iter()
        .map(|target| docs.join(target.split('#').next().unwrap_or_default()))
        .collect();
    for page in pages().iter().filter(|page| page.starts_with(&docs)) {
        let is_index = page.ends_with("index.md");
        assert!(
            is_index || led.contains(page),
            "{} is not in docs/index.md",
            page.display()
        );
    }
}
