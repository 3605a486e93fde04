//! A folder for the files of one test, which goes with it, and what the program printed.

use std::process::Output;

/// The folder.
pub(crate) struct Room(tempfile::TempDir);

impl Room {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// The path of a file in it, as the program takes it.
    pub(crate) fn at(&self, name: &str) -> String {
        self.0.path().join(name).to_str().unwrap().to_owned()
    }

    /// The text of a file in it.
    pub(crate) fn read(&self, name: &str) -> String {
        let text = std::fs::read_to_string(self.0.path().join(name));
        text.unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    pub(crate) fn holds(&self, name: &str) -> bool {
        self.0.path().join(name).exists()
    }
}

/// What was printed, results and messages.
pub(crate) fn words(output: &Output) -> String {
    let both = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes));
    both.concat()
}
