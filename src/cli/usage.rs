//! What is added to messages about words of the command line.

use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue, ErrorKind};

/// A message about a word `key=value` that stands alone, with how a key of the sweep file is set.
pub(super) fn with_tip(mut error: clap::Error) -> clap::Error {
    if error.kind() != ErrorKind::UnknownArgument {
        return error;
    }
    let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidArg) else {
        return error;
    };
    let is_key = |(key, _): (&str, &str)| {
        let part = |part: &str| !part.is_empty() && !part.starts_with('-');
        key.contains('.') && key.split('.').all(part)
    };
    if word.split_once('=').is_some_and(is_key) {
        let tip = format!("a key of the sweep file is set by `--set '{word}'`");
        let tips = ContextValue::StyledStrs(vec![StyledStr::from(tip)]);
        error.insert(ContextKind::Suggested, tips);
    }
    error
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::Arguments;
    use clap::Parser as _;

    fn said(words: &[&str]) -> String {
        let words = ["pbif"].iter().chain(words);
        let error = Arguments::try_parse_from(words).map(|_| ()).unwrap_err();
        with_tip(error).to_string()
    }

    #[test]
    fn a_key_without_its_option_is_told_of_it() {
        let tip = "a key of the sweep file is set by `--set 'cells.x.count=30'`";
        let text = said(&["sweep", "a.toml", "cells.x.count=30"]);
        assert!(text.contains(tip), "{text}");
        for other in ["nothing", "--cells.x=3", "a=b"] {
            let text = said(&["sweep", "a.toml", other]);
            assert!(!text.contains("a key of the sweep file"), "{text}");
        }
    }
}
