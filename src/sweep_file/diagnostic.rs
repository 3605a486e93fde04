//! What the program says of bad input: where it stands, what is allowed, the nearest valid name, the remedy.
//!
//! A text that a value can come from (the sweep file, or one `--set` argument) is a *source*; a [`Place`] is a
//! span of one of them. All findings are collected and drawn together.

use std::ops::Range;

use annotate_snippets::{AnnotationKind, Element, Group, Level, Origin, Renderer, Snippet};

/// A span of bytes in one of the [`Sources`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// Number of the source.
    pub source: usize,
    /// Bytes of its text.
    pub span: Range<usize>,
}

/// The texts that were read: source 0 is the file, the others are `--set` arguments in their order.
#[derive(Debug, Clone, Default)]
pub struct Sources {
    names: Vec<String>,
    texts: Vec<String>,
}

impl Sources {
    /// Adds a text and returns its number.
    pub fn add(&mut self, name: &str, text: &str) -> usize {
        self.names.push(name.to_owned());
        self.texts.push(text.to_owned());
        self.names.len() - 1
    }

    fn get(&self, source: usize) -> Option<(&str, &str)> {
        Some((self.names.get(source)?, self.texts.get(source)?))
    }
}

/// One finding.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnostic {
    title: String,
    place: Option<Place>,
    label: String,
    allowed: Option<String>,
    remedy: Option<String>,
}

impl Diagnostic {
    /// A finding about the input as a whole.
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            place: None,
            label: String::new(),
            allowed: None,
            remedy: None,
        }
    }

    /// Where it stands, with a few words beside the caret.
    pub fn at(mut self, place: &Place, label: impl Into<String>) -> Self {
        self.place = Some(place.clone());
        self.label = label.into();
        self
    }

    /// What is allowed there.
    pub fn allowed(mut self, words: impl Into<String>) -> Self {
        self.allowed = Some(words.into());
        self
    }

    /// What to do.
    pub fn remedy(mut self, words: impl Into<String>) -> Self {
        self.remedy = Some(words.into());
        self
    }

    /// Adds "did you mean" where one of `names` is near `given`, and lists the names as allowed.
    pub fn nearest<'n>(mut self, given: &str, names: impl IntoIterator<Item = &'n str>) -> Self {
        let names: Vec<&str> = names.into_iter().collect();
        if let Some(name) = nearest_name(given, names.iter().copied()) {
            self.remedy = Some(format!("did you mean `{name}`?"));
        }
        self.allowed = (!names.is_empty()).then(|| list(&names));
        self
    }

    fn group<'a>(&'a self, sources: &'a Sources) -> Group<'a> {
        let mut elements: Vec<Element<'a>> = Vec::new();
        let place = self.place.as_ref();
        if let Some((place, (name, text))) =
            place.and_then(|place| Some((place, sources.get(place.source)?)))
        {
            let end = place.span.end.min(text.len());
            let start = place.span.start.min(end);
            if start == end && start == 0 {
                elements.push(Origin::path(name).into());
            } else {
                let annotation = AnnotationKind::Primary.span(start..end);
                let annotation = annotation.label(self.label.as_str());
                let snippet = Snippet::source(text).path(name).annotation(annotation);
                elements.push(snippet.into());
            }
        }
        if let Some(allowed) = &self.allowed {
            elements.push(Level::NOTE.message(format!("allowed: {allowed}")).into());
        }
        if let Some(remedy) = &self.remedy {
            elements.push(Level::HELP.message(remedy.as_str()).into());
        }
        Group::with_title(Level::ERROR.primary_title(self.title.as_str())).elements(elements)
    }
}

/// Everything found wrong, with the texts it was found in. Never empty when it is an error.
#[derive(Debug, Clone, Default)]
pub struct Report {
    /// The texts.
    pub sources: Sources,
    /// The findings.
    pub diagnostics: Vec<Diagnostic>,
}

impl From<Diagnostic> for Report {
    fn from(diagnostic: Diagnostic) -> Self {
        Self {
            sources: Sources::default(),
            diagnostics: vec![diagnostic],
        }
    }
}

impl Report {
    /// The report as text, in the order of the places; escape codes only when `styled`.
    pub fn render(&self, styled: bool) -> String {
        let mut ordered: Vec<&Diagnostic> = self.diagnostics.iter().collect();
        ordered.sort_by_key(|diagnostic| {
            let place = diagnostic.place.as_ref();
            place.map_or((0, 0), |place| (place.source, place.span.start))
        });
        let renderer = if styled {
            Renderer::styled()
        } else {
            Renderer::plain()
        };
        let mut text = String::new();
        for diagnostic in ordered {
            text += &renderer.render(&[diagnostic.group(&self.sources)]);
            text += "\n\n";
        }
        let errors = match self.diagnostics.len() {
            1 => "1 error".to_owned(),
            errors => format!("{errors} errors"),
        };
        text + &format!("{errors}; nothing was run or written\n")
    }
}

/// The name nearest to `given`, if one is near enough to be a slip of the pen.
pub(super) fn nearest_name<'n>(
    given: &str,
    names: impl IntoIterator<Item = &'n str>,
) -> Option<&'n str> {
    let given = given.to_lowercase().replace('-', "_");
    let scored = names.into_iter().map(|name| {
        let plain = name.to_lowercase().replace('-', "_");
        (strsim::normalized_damerau_levenshtein(&given, &plain), name)
    });
    let best = scored.max_by(|one, other| one.0.total_cmp(&other.0))?;
    (best.0 >= 0.5).then_some(best.1)
}

/// Names in backquotes, separated by commas.
pub fn list<S: AsRef<str>>(names: &[S]) -> String {
    let quoted: Vec<String> = names
        .iter()
        .map(|name| format!("`{}`", name.as_ref()))
        .collect();
    quoted.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn report_shows_line_column_allowed_and_remedy_without_escapes() {
        let mut sources = Sources::default();
        let source = sources.add("a.toml", "title = \"t\"\npionts = 3\n");
        let place = Place {
            source,
            span: 12..18,
        };
        let diagnostic = Diagnostic::new("unknown key `pionts`")
            .at(&place, "not a key")
            .nearest("pionts", ["points", "from"]);
        let report = Report {
            sources,
            diagnostics: vec![diagnostic],
        };
        let text = report.render(false);
        for words in [
            "a.toml:2:1",
            "not a key",
            "`points`, `from`",
            "did you mean `points`?",
        ] {
            assert!(text.contains(words), "{words} not in\n{text}");
        }
        assert!(!text.contains('\u{1b}'));
        assert!(report.render(true).contains('\u{1b}'));
    }

    #[test]
    fn only_near_names_are_offered() {
        assert_eq!(
            nearest_name("kapa", ["alpha", "kappa", "mu"]),
            Some("kappa")
        );
        assert_eq!(
            nearest_name("map-step", ["map_step", "samples"]),
            Some("map_step")
        );
        assert_eq!(nearest_name("zzzz", ["alpha", "kappa"]), None);
    }

    #[test]
    fn findings_come_in_the_order_of_the_text() {
        let mut report = Report::default();
        let source = report.sources.add("a.toml", "one = 1\ntwo = 2\n");
        for (title, start) in [("second", 8), ("first", 0)] {
            let place = Place {
                source,
                span: start..start + 3,
            };
            report
                .diagnostics
                .push(Diagnostic::new(title).at(&place, ""));
        }
        let text = report.render(false);
        assert!(text.find("first") < text.find("second"));
        assert!(text.contains("2 errors"));
    }
}
