//! The program as its user drives it: lines as they are typed, run in a folder that goes with the test.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use super::table::Table;

/// The folder.
pub(crate) struct Room(tempfile::TempDir);

/// The words of a line. Those between single quotes are one, `sweeps/…` is a shipped sweep, and a word with `=` in it
/// is set by `--set`.
fn words_of(line: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    for (part, text) in line.split('\'').enumerate() {
        let parts = match part % 2 {
            0 => text.split_whitespace().collect(),
            _ => vec![text],
        };
        for word in parts {
            let is_set = words.last().is_some_and(|last| last == "--set");
            if word.contains('=') && !word.starts_with("--") && !is_set {
                words.push("--set".to_owned());
            }
            words.push(match word.strip_prefix("sweeps/") {
                Some(_) => shipped(word).to_str().unwrap().to_owned(),
                None => word.to_owned(),
            });
        }
    }
    words
}

/// The path of a file of this repository.
pub(crate) fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

impl Room {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Its files and folders by name.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    }

    pub(crate) fn holds(&self, name: &str) -> bool {
        self.path(name).exists()
    }

    /// Asserts that files are there, given by their names below a folder.
    pub(crate) fn holds_all(&self, folder: &str, names: &str) {
        for name in names.split_whitespace() {
            assert!(self.path(folder).join(name).is_file(), "no {folder}/{name}");
        }
    }

    pub(crate) fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), text).unwrap();
    }

    pub(crate) fn bytes(&self, name: &str) -> Vec<u8> {
        let bytes = std::fs::read(self.path(name));
        bytes.unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    pub(crate) fn read(&self, name: &str) -> String {
        String::from_utf8(self.bytes(name)).unwrap()
    }

    pub(crate) fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_slice(&self.bytes(name)).unwrap()
    }

    pub(crate) fn table(&self, name: &str) -> Table {
        Table::read(&self.path(name))
    }

    /// Replaces what a file says once.
    pub(crate) fn change(&self, name: &str, old: &str, new: &str) {
        let text = self.read(name);
        assert!(text.contains(old), "`{old}` not in {name}");
        self.write(name, text.replace(old, new));
    }

    /// The program with the words of a line, in this folder.
    pub(crate) fn command(&self, line: &str) -> Command {
        self.command_of(&words_of(line))
    }

    fn command_of(&self, words: &[String]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_pbif"));
        command.current_dir(self.0.path()).args(words);
        command
    }

    /// Runs a line, however it ends.
    pub(crate) fn run(&self, line: &str) -> Printed {
        Printed::of(line, self.command(line).output().unwrap())
    }

    /// Runs a line that must end well.
    pub(crate) fn done(&self, line: &str) -> Printed {
        self.run(line).ends(0)
    }

    /// Runs a line that must end with results, though some may be unresolved.
    pub(crate) fn solved(&self, line: &str) -> Printed {
        let printed = self.run(line);
        assert!(matches!(printed.code, Some(0 | 1)), "{printed:?}");
        printed
    }

    /// Runs a line that must be refused in these words.
    pub(crate) fn refused(&self, line: &str, words: &[&str]) -> Printed {
        self.run(line).ends(2).says(words)
    }

    /// Every file below a folder with its content, but those that `left_out` names as files or folders.
    pub(crate) fn files(&self, folder: &str, left_out: &[&str]) -> BTreeMap<String, Vec<u8>> {
        let root = self.path(folder);
        let (mut found, mut open) = (BTreeMap::new(), vec![root.clone()]);
        while let Some(folder) = open.pop() {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                let name = path.strip_prefix(&root).unwrap().to_str().unwrap();
                if left_out.contains(&name) {
                    continue;
                } else if path.is_dir() {
                    open.push(path);
                } else {
                    found.insert(name.to_owned(), std::fs::read(&path).unwrap());
                }
            }
        }
        found
    }
}

/// What a line printed, and how it ended.
#[derive(Debug)]
pub(crate) struct Printed {
    line: String,
    pub(crate) code: Option<i32>,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Printed {
    pub(crate) fn of(line: &str, output: Output) -> Self {
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        Self {
            line: line.to_owned(),
            code: output.status.code(),
            out: text(output.stdout),
            err: text(output.stderr),
        }
    }

    /// Results and messages.
    pub(crate) fn text(&self) -> String {
        format!("{}{}", self.out, self.err)
    }

    pub(crate) fn ends(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "{}:\n{}", self.line, self.text());
        self
    }

    pub(crate) fn says(self, words: &[&str]) -> Self {
        assert_says(&self.text(), words);
        self
    }
}

pub(crate) fn assert_says(text: &str, words: &[&str]) {
    for words in words {
        assert!(text.contains(words), "`{words}` not in\n{text}");
    }
}

/// Names and contents that must be equal; all differences are named.
pub(crate) fn assert_same(
    found: &BTreeMap<String, Vec<u8>>,
    wanted: &BTreeMap<String, Vec<u8>>,
    what: &str,
) {
    let names = found.keys().chain(wanted.keys());
    let different = names.filter(|name| found.get(*name) != wanted.get(*name));
    let different: Vec<_> = different.collect();
    assert!(different.is_empty(), "{what}: {different:?}");
}
