//! All findings in one input, drawn together in the order of the text.

use std::fmt;

use annotate_snippets::Renderer;

use super::diagnostic::{Diagnostic, Sources};

/// Most findings that are shown; more are counted.
pub(super) const MOST_SHOWN: usize = 20;

/// Everything found in a text, with the texts it was found in. Never empty when it is an error.
///
/// [`Display`](fmt::Display) shows it as a terminal without colours would, [`Debug`] alike, so that a `main` that
/// returns it as an error shows what a user needs.
#[derive(Clone, Default)]
pub struct Report {
    sources: Sources,
    diagnostics: Vec<Diagnostic>,
    /// Findings beyond those that are kept.
    further: usize,
}

impl Report {
    pub(super) fn new(sources: Sources, diagnostics: Vec<Diagnostic>, further: usize) -> Self {
        Self {
            sources,
            diagnostics,
            further,
        }
    }

    /// The texts.
    pub fn sources(&self) -> &Sources {
        &self.sources
    }

    /// The findings, in the order in which they were found.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// Whether nothing was found.
    pub fn is_empty(&self) -> bool {
        self.diagnostics.is_empty()
    }

    /// The first findings in the order of their places; escape codes only when `styled`.
    pub fn render(&self, styled: bool) -> String {
        let mut ordered: Vec<&Diagnostic> = self.diagnostics.iter().collect();
        ordered.sort_by_key(|diagnostic| {
            let place = diagnostic.place();
            place.map_or((0, 0), |place| (place.source, place.span.start))
        });
        let renderer = if styled {
            Renderer::styled()
        } else {
            Renderer::plain()
        };
        let mut text = String::new();
        for diagnostic in ordered.iter().take(MOST_SHOWN) {
            text += &renderer.render(&[diagnostic.group(&self.sources)]);
            text += "\n\n";
        }
        let hidden = ordered.len().saturating_sub(MOST_SHOWN) + self.further;
        if hidden > 0 {
            text += &format!("and {hidden} more\n\n");
        }
        text
    }

    /// How many errors there are, in words.
    pub(crate) fn count(&self) -> String {
        match self.diagnostics.len() + self.further {
            1 => "1 error".to_owned(),
            errors => format!("{errors} errors"),
        }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}{}", self.render(false), self.count())
    }
}

impl fmt::Debug for Report {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "\n{self}")
    }
}

impl std::error::Error for Report {}

impl From<Diagnostic> for Report {
    fn from(diagnostic: Diagnostic) -> Self {
        Self::new(Sources::default(), vec![diagnostic], 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep_file::diagnostic::{Location, Place};

    fn place(source: usize, start: usize, end: usize) -> Place {
        Place {
            source,
            span: start..end,
        }
    }

    #[test]
    fn line_column_allowed_and_remedy_are_shown_without_escapes() {
        let mut sources = Sources::default();
        let source = sources.add("a.toml", "title = \"t\"\npionts = 3\n");
        let place = place(source, 12, 18);
        let location = Location {
            source: "a.toml".to_owned(),
            line: 2,
            column: 1,
        };
        assert_eq!(sources.locate(&place), Some(location));
        let diagnostic = Diagnostic::new("unknown key `pionts`")
            .at(&place, "not a key")
            .nearest("pionts", ["points", "from"]);
        let report = Report::new(sources, vec![diagnostic], 0);
        let text = report.to_string();
        for words in [
            "a.toml:2:1",
            "not a key",
            "`points`, `from`",
            "did you mean `points`?",
            "1 error",
        ] {
            assert!(text.contains(words), "{words} not in\n{text}");
        }
        assert!(!text.contains('\u{1b}'));
        assert!(report.render(true).contains('\u{1b}'));
    }

    #[test]
    fn findings_come_in_the_order_of_the_text() {
        let mut sources = Sources::default();
        let source = sources.add("a.toml", "one = 1\ntwo = 2\n");
        let found = [("second", 8), ("first", 0)]
            .map(|(title, start)| Diagnostic::new(title).at(&place(source, start, start + 3), ""));
        let text = Report::new(sources, found.to_vec(), 0).to_string();
        assert!(text.find("first") < text.find("second"));
        assert!(text.contains("2 errors"));
    }

    #[test]
    fn many_findings_are_counted() {
        let found = (0..30).map(|number| Diagnostic::new(format!("finding {number}.")));
        let text = Report::new(Sources::default(), found.collect(), 5).to_string();
        assert!(text.contains("finding 19.") && !text.contains("finding 20."));
        assert!(text.contains("and 15 more") && text.contains("35 errors"));
    }
}
