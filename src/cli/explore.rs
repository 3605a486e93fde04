//! `pbif explore`: the page of a stored run.

use super::args::ExploreArguments;
use super::stored::Stored;
use super::{CommandError, Outcome};
use crate::explore::StoredPage;
use crate::run::write_atomically;

/// Writes the page of a run and prints where it is.
///
/// # Errors
/// [`CommandError`] when the run cannot be read or the page not be written.
pub(super) fn run(arguments: &ExploreArguments) -> Result<Outcome, CommandError> {
    let stored = Stored::read(&arguments.run, &[], &[], arguments.quiet)?;
    let page = StoredPage::new(&stored.spec, &stored.result)?;
    let beside = arguments.run.join("explorer.html");
    let file = arguments.html.as_deref().unwrap_or(&beside);
    write_atomically(file, page.html().as_bytes())?;
    super::print(&text(&page, file))
}

/// Where the page is, how large, and what packing did to the densities.
fn text(page: &StoredPage, file: &std::path::Path) -> String {
    let megabytes = page.html().len() as f64 / 1e6;
    let digits = page.joint_bits().map_or(String::new(), |bits| {
        format!(", square roots of joint densities kept to {bits} bits")
    });
    format!(
        "page\n  {} ({megabytes:.2} MB{digits})\nopen it in a browser: it needs no network\n",
        file.display()
    )
}
