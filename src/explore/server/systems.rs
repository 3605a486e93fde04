//! The systems that a server shows: the one that it was started with, and those that its page has edited, each at an
//! address of its own, so that a browser's way back leads to the system before.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::super::ExploreError;
use super::super::live::Live;

/// Edited systems that are kept; the oldest gives way to a newer one.
const MOST_EDITED: usize = 8;

/// All systems of a server.
#[derive(Debug)]
pub(super) struct Systems {
    first: Arc<Shown>,
    edited: Mutex<Edited>,
}

/// The edited ones, the oldest first.
#[derive(Debug, Default)]
struct Edited {
    shown: Vec<Arc<Shown>>,
    /// How many there have been.
    count: u64,
}

/// A system and its page.
#[derive(Debug)]
pub(super) struct Shown {
    number: u64,
    pub(super) live: Live,
    pub(super) page: String,
}

impl Shown {
    fn new(number: u64, live: Live) -> Result<Self, ExploreError> {
        Ok(Self {
            number,
            page: live.page()?,
            live,
        })
    }
}

impl Systems {
    /// The system that a server is started with.
    ///
    /// # Errors
    /// As [`Live::page`].
    pub(super) fn new(live: Live) -> Result<Self, ExploreError> {
        Ok(Self {
            first: Arc::new(Shown::new(0, live)?),
            edited: Mutex::default(),
        })
    }

    fn edited(&self) -> MutexGuard<'_, Edited> {
        self.edited.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The system that a request is for, with what it asks of it: `solve` is of the first one, `2/solve` of the second
    /// that was edited. `None` where it has given way to newer ones, or has never been.
    pub(super) fn of<'r>(&self, path: &'r str) -> Option<(Arc<Shown>, &'r str)> {
        let Some((number, asked)) = path.split_once('/') else {
            return Some((self.first.clone(), path));
        };
        let number: u64 = number.parse().ok()?;
        let edited = self.edited();
        let found = edited.shown.iter().find(|one| one.number == number)?;
        Some((found.clone(), asked))
    }

    /// Adds a system; the folder of its page below the first one's.
    ///
    /// # Errors
    /// As [`Live::page`].
    pub(super) fn add(&self, live: Live) -> Result<String, ExploreError> {
        let mut edited = self.edited();
        let number = edited.count + 1;
        let shown = Shown::new(number, live)?;
        edited.count = number;
        if edited.shown.len() == MOST_EDITED {
            edited.shown.remove(0).live.stop();
        }
        edited.shown.push(Arc::new(shown));
        Ok(format!("{number}/"))
    }

    /// Cancels whatever is being solved.
    pub(super) fn stop(&self) {
        self.first.live.stop();
        for one in &self.edited().shown {
            one.live.stop();
        }
    }
}
