//! What is said of bad input: where it stands, what is allowed, the nearest valid name, the remedy.
//!
//! A text that a value can come from (the sweep file, or one value that was set on top of it) is a *source*; a
//! [`Place`] is a span of one of them. All findings are collected and drawn together, see [`Report`](super::Report).

use std::ops::Range;

use annotate_snippets::{AnnotationKind, Element, Group, Level, Origin, Snippet};

use super::names::{list, nearest_name};
use crate::formula::language::foreign_letter;

/// A span of bytes in one of the [`Sources`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// Number of the source.
    pub source: usize,
    /// Bytes of its text.
    pub span: Range<usize>,
}

impl Place {
    /// Whether it is of a value that was set on top of the file.
    pub(crate) fn is_set(&self) -> bool {
        self.source > 0
    }
}

/// The texts that were read: source 0 is the file, the others are values that were set, in their order.
#[derive(Debug, Clone, Default)]
pub struct Sources {
    names: Vec<String>,
    texts: Vec<String>,
}

/// Where something begins, as people count.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Location {
    /// The file, or how the value was set.
    pub source: String,
    /// Line, counted from 1.
    pub line: usize,
    /// Character of the line, counted from 1.
    pub column: usize,
}

impl Sources {
    /// Adds a text and returns its number.
    pub(super) fn add(&mut self, name: &str, text: &str) -> usize {
        self.names.push(name.to_owned());
        self.texts.push(text.to_owned());
        self.names.len() - 1
    }

    /// Names and texts in the order of their numbers.
    pub(super) fn all(&self) -> impl Iterator<Item = (&str, &str)> {
        let names = self.names.iter().map(String::as_str);
        names.zip(self.texts.iter().map(String::as_str))
    }

    fn get(&self, source: usize) -> Option<(&str, &str)> {
        Some((self.names.get(source)?, self.texts.get(source)?))
    }

    /// A text by its number.
    pub(super) fn text(&self, source: usize) -> Option<&str> {
        self.get(source).map(|(_, text)| text)
    }

    /// File, line and column of a place's beginning; `None` for a place of other sources.
    pub fn locate(&self, place: &Place) -> Option<Location> {
        let (name, text) = self.get(place.source)?;
        let before = text.get(..place.span.start)?;
        let line = before.rfind('\n').map_or(0, |end| end + 1);
        Some(Location {
            source: name.to_owned(),
            line: before.matches('\n').count() + 1,
            column: before[line..].chars().count() + 1,
        })
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
    is_warning: bool,
}

impl Diagnostic {
    /// An error in the input as a whole.
    pub(crate) fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            place: None,
            label: String::new(),
            allowed: None,
            remedy: None,
            is_warning: false,
        }
    }

    /// Something that is worth knowing but no error.
    pub(crate) fn warning(title: impl Into<String>) -> Self {
        Self {
            is_warning: true,
            ..Self::new(title)
        }
    }

    /// Where it stands, if that is known, with a few words beside the caret.
    pub(crate) fn at<'p>(
        mut self,
        place: impl Into<Option<&'p Place>>,
        label: impl Into<String>,
    ) -> Self {
        if let Some(place) = place.into() {
            self.place = Some(place.clone());
            self.label = label.into();
        }
        self
    }

    /// What is allowed there and what to do, as far as either is known.
    pub(super) fn advice(mut self, allowed: Option<String>, remedy: Option<String>) -> Self {
        self.allowed = allowed.or(self.allowed);
        self.remedy = remedy.or(self.remedy);
        self
    }

    /// What is allowed there.
    pub(crate) fn allowed(mut self, words: impl Into<String>) -> Self {
        self.allowed = Some(words.into());
        self
    }

    /// What to do.
    pub(crate) fn remedy(mut self, words: impl Into<String>) -> Self {
        self.remedy = Some(words.into());
        self
    }

    /// Adds "did you mean" where one of `names` is near `given`, and lists the names as allowed.
    pub(crate) fn nearest<'n>(
        mut self,
        given: &str,
        names: impl IntoIterator<Item = &'n str>,
    ) -> Self {
        let names: Vec<&str> = names.into_iter().collect();
        if let Some(name) = nearest_name(given, names.iter().copied()) {
            let foreign = foreign_letter(given).map(|(words, _)| format!(" {words}"));
            let foreign = foreign.unwrap_or_default();
            self.remedy = Some(format!("did you mean `{name}`?{foreign}"));
        }
        self.allowed = (!names.is_empty()).then(|| list(&names));
        self
    }

    /// What was found, in one sentence.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// Where it stands; `None` where it concerns the whole.
    pub fn place(&self) -> Option<&Place> {
        self.place.as_ref()
    }

    /// How the finding is drawn.
    pub(super) fn group<'a>(&'a self, sources: &'a Sources) -> Group<'a> {
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
        let level = if self.is_warning {
            Level::WARNING
        } else {
            Level::ERROR
        };
        Group::with_title(level.primary_title(self.title.as_str())).elements(elements)
    }
}
