//! A store of densities that is settled while something else is done: brought to the disk, and what stood in its place
//! before removed.
//!
//! A store has a file a density; waiting for all of them takes as long as drawing all figures, and the one waits for
//! the disk while the other computes.

use std::path::{Path, PathBuf};
use std::thread::JoinHandle;

use super::RunError;
use super::atomic::sync_all;
use super::exchange::Leftover;

/// Work that goes on beside.
#[derive(Debug)]
pub(super) struct Settling {
    store: PathBuf,
    /// `None` where there was no thread to be had.
    thread: Option<JoinHandle<Result<(), RunError>>>,
}

impl Settling {
    /// Begins. What was there before is removed only when the new store is on the disk.
    pub(super) fn begin(store: &Path, before: Option<Leftover>) -> Self {
        let place = vec![store.to_owned()];
        let work = move || {
            let synced = sync_all(&place);
            drop(before);
            synced
        };
        Self {
            store: store.to_owned(),
            thread: std::thread::Builder::new().spawn(work).ok(),
        }
    }

    /// Waits until all is done.
    ///
    /// # Errors
    /// As [`sync_all`].
    pub(super) fn end(self) -> Result<(), RunError> {
        match self.thread.map(JoinHandle::join) {
            Some(Ok(settled)) => settled,
            // It has not begun, or ended early.
            None | Some(Err(_)) => sync_all(&[self.store]),
        }
    }
}
