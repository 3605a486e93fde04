//! The sweep file itself: read, set, checked.

use std::path::Path;

use super::document::Document;
use super::report::Report;
use super::settings::Settings;
use super::text::{self, SweepText, Text};

/// A sweep file, and what was set on top of it. What is wrong with either is told by [`SweepFile::validate`], all at
/// once.
#[derive(Debug, Clone)]
pub struct SweepFile {
    document: Document,
}

impl SweepFile {
    /// Reads a file.
    ///
    /// # Errors
    /// A report when it cannot be read, or is not text in UTF-8.
    pub fn read(file: &Path) -> Result<Self, Report> {
        let text = text::read(file)?;
        Ok(Self {
            document: Document::parse(&file.display().to_string(), &text),
        })
    }

    /// Takes a text; messages name it `name`.
    pub fn parse(name: &str, text: &str) -> Self {
        Self {
            document: Document::parse(name, &Text::beginning(text)),
        }
    }

    /// The same of a complete sweep file that was made of what somebody typed.
    #[must_use]
    pub(crate) fn made_of(mut self, typed: SweepText) -> Self {
        self.document.typed = Some(typed);
        self
    }

    /// Sets a key, such as `sweep.points`, on top of the file. The value is TOML, or a bare word.
    pub fn set(&mut self, key: &str, value: &str) -> &mut Self {
        self.document.set("set", &format!("{key} = {value}"));
        self
    }

    /// Sets keys written as `KEY=VALUE`, in this order; messages call them `name`.
    pub fn set_all<S: AsRef<str>>(
        &mut self,
        name: &str,
        settings: impl IntoIterator<Item = S>,
    ) -> &mut Self {
        for setting in settings {
            self.document.set(name, setting.as_ref());
        }
        self
    }

    /// Takes a section out, as if it were not there.
    pub(crate) fn remove(&mut self, section: &str) -> &mut Self {
        self.document.remove(section);
        self
    }

    /// Takes `[map]` out: what is left is a sweep of the first parameter alone, which holds the second one, if the file
    /// does not say where, in the middle of the map.
    pub(crate) fn without_map(&mut self) -> &mut Self {
        let number = |key: &str| self.get(key)?.parse::<f64>().ok();
        let name = self.get("map.parameter");
        let name = name.map(|name| name.trim_matches('"').to_owned());
        let held = name.map(|name| format!("system.parameters.{name}"));
        let ends = number("map.from").zip(number("map.to"));
        if let Some((held, (from, to))) = held.zip(ends)
            && self.get(&held).is_none()
        {
            self.set(&held, &format!("{:?}", 0.5 * (from + to)));
        }
        self.remove("map")
    }

    /// What the file, or what was set on top of it, says of a key, as TOML; `None` where it says nothing.
    pub fn get(&self, key: &str) -> Option<String> {
        let path: Vec<&str> = key.split('.').collect();
        let plain = self.document.root.find(&path)?.node.plain()?;
        Some(plain.to_toml())
    }

    /// Checks everything and fills in the defaults. Nothing is run for that.
    ///
    /// # Errors
    /// A report of everything that is wrong.
    pub fn validate(&self) -> Result<Settings, Report> {
        Settings::read(&self.document)
    }
}
