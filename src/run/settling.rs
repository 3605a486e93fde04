//! A store of densities that is brought to the disk while something else is done: the one waits while the other
//! computes.

use std::path::PathBuf;
use std::thread::JoinHandle;

use super::RunError;
use super::atomic::sync_all;

/// Work that goes on beside.
#[derive(Debug)]
pub(super) struct Settling {
    store: PathBuf,
    /// `None` where there was no thread to be had.
    thread: Option<JoinHandle<Result<(), RunError>>>,
}

impl Settling {
    /// Begins.
    pub(super) fn begin(store: PathBuf) -> Self {
        let place = vec![store.clone()];
        let work = move || sync_all(&place);
        Self {
            store,
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
