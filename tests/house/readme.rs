//! The Rust lines of the README and of the library's page are those of the examples, which are compiled and run.

use std::path::Path;

/// A line without indentation and comment.
fn plain(line: &str) -> &str {
    line.split("   //").next().unwrap_or_default().trim()
}

#[test]
fn the_library_is_shown_by_lines_of_the_examples() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let examples: String = std::fs::read_dir(root.join("examples"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.is_file())
        .map(|path| std::fs::read_to_string(path).unwrap())
        .collect();
    // A statement may stand on several lines there.
    let squeezed = |text: &str| text.replace([' ', '\n', ','], "");
    let examples = squeezed(&examples);
    let read = |name: &str| std::fs::read_to_string(root.join(name)).unwrap();
    let readme = read("README.md");
    let (_, section) = readme.split_once("## In a program\n").unwrap();
    let (section, _) = section.split_once("\n## ").unwrap();
    for (text, least) in [(section, 4), (&read("docs/library.md"), 20)] {
        let code = text.lines().filter(|line| line.starts_with("    "));
        let mut seen = 0;
        for line in code.map(plain) {
            assert!(examples.contains(&squeezed(line)), "no example has\n{line}");
            seen += 1;
        }
        assert!(seen >= least);
    }
}
