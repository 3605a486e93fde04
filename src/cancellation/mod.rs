//! Asking long work to stop.
//!
//! Whoever starts long work keeps a [`Cancellation`] and hands clones of it on; every long loop below looks at it, so
//! that work ends within a fraction of a second of [`Cancellation::cancel`]. What ends in that way is an error of its
//! own kind, never a result that looks finished.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A token that is looked at by long work. Clones are the same token; once cancelled, it stays so.
///
/// ```
/// use pbif::cancellation::{Cancellation, Cancelled};
///
/// let cancellation = Cancellation::new();
/// let seen_by_the_work = cancellation.clone();
/// assert_eq!(seen_by_the_work.check(), Ok(()));
/// cancellation.cancel();
/// assert_eq!(seen_by_the_work.check(), Err(Cancelled));
/// ```
#[derive(Debug, Clone, Default)]
pub struct Cancellation(Arc<AtomicBool>);

impl Cancellation {
    /// A token that nobody has cancelled.
    pub fn new() -> Self {
        Self::default()
    }

    /// Asks all work that looks at this token to stop.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether it has been cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Goes on, unless it has been cancelled.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.is_cancelled() {
            return Err(Cancelled);
        }
        Ok(())
    }
}

/// Work ended early because its [`Cancellation`] was cancelled.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;
