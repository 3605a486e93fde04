//! What the page edits: the sweep file as it was typed, or one of the gallery, and the system that it makes.

use serde::Deserialize;
use serde_json::json;

use super::{Live, Stop, answer, read};
use crate::explore::ExploreError;
use crate::sweep_file::{Sweep, SweepFile, starting_files};

/// What messages call the text that was edited.
const NAME: &str = "edited.toml";

/// Asks for the page of a sweep file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct AskEdit {
    lane: String,
    ticket: u64,
    /// The sweep file.
    text: String,
}

impl Live {
    /// The sweep file that an editor begins with: as it was typed, or complete where keys were set on top of that.
    pub(super) fn typed(sweep: &Sweep) -> String {
        let typed = sweep.settings.typed();
        if typed.set.is_empty() && !typed.text.is_empty() {
            typed.text
        } else {
            sweep.to_toml()
        }
    }

    /// Makes the live side of a sweep file that was edited and gives it to `keep`, which says in which folder its page
    /// is.
    pub(in crate::explore) fn edit(
        &self,
        body: &[u8],
        keep: impl FnOnce(Self) -> Result<String, ExploreError>,
    ) -> Vec<u8> {
        answer(|| {
            let ask: AskEdit = read(body)?;
            let (lane, cancellation) = self.begin(&ask.lane, ask.ticket)?;
            let settings = SweepFile::parse(NAME, &ask.text).validate();
            let sweep = settings.and_then(|settings| settings.prepare(&cancellation));
            if cancellation.is_cancelled() {
                return Err(Stop::Stale);
            }
            lane.end();
            let sweep = sweep.map_err(|report| Stop::Refused(report.render(false)))?;
            let folder = keep(Self::new(&sweep));
            let folder = folder.map_err(|error| Stop::Refused(error.to_string()))?;
            // Where its page is, below the address that the server printed.
            Ok(json!({ "ticket": ask.ticket, "folder": folder }))
        })
    }

    /// The sweep files to start from.
    pub(in crate::explore) fn starts(&self, _body: &[u8]) -> Vec<u8> {
        answer(|| {
            let files = starting_files().iter();
            let told = files
                .map(|file| json!({ "name": file.name, "title": file.title(), "text": file.text }));
            Ok(told.collect())
        })
    }
}
