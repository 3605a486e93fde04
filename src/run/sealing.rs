//! A run that was killed when all of it was there, but its checksums: it is sealed by whoever opens it next.

use std::path::Path;

use super::Layout;
use super::lock::FolderLock;
use super::{checksums, journal, research_object};

/// Seals a complete run whose journal still stands beside it: the journal goes last. Nothing happens where another
/// process writes to the run, or the folder cannot be written to: whoever comes next may.
pub(super) fn seal_after_kill(run: &Path) {
    let part = run.join(journal::NAME);
    if !part.is_file() {
        return;
    }
    let Ok(_lock) = FolderLock::take(run) else {
        return;
    };
    let is_sealed = run.join(checksums::NAME).is_file();
    let seal =
        || research_object::write(run).and_then(|()| checksums::write(run, Layout::SWEEP.entries));
    if is_sealed || seal().is_ok() {
        let _ = std::fs::remove_file(part);
    }
}
