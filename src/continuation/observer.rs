//! What a sweep tells its caller while it runs.

use super::{CheckedIndicator, Point};

/// What is kept of a solve that checked a located value, so that a sweep that goes on need not repeat it.
#[derive(Debug, Clone, PartialEq)]
pub struct KeptCheck {
    /// What was seen.
    pub seen: CheckedIndicator,
    /// What the solve has left in the session of its check ([`Session::memory`](super::Session::memory)); `None` where
    /// that is not known: what is solved later then starts afresh.
    pub left: Option<Vec<u8>>,
}

/// Receives every point as soon as it is done, and may stop the sweep with an error, or by cancelling
/// it ([`Cancellation`](crate::cancellation::Cancellation)). All methods have defaults.
pub trait Observer {
    /// The sweep starts; `planned` is the number of given parameter values.
    fn begin(&mut self, planned: usize) {
        let _ = planned;
    }

    /// A point is done. `done` counts all points so far and `remaining` the given values still to come;
    /// points that refine a bracket come on top of those.
    ///
    /// # Errors
    /// An error (a full disk, say) ends the sweep and is handed to its caller.
    fn point(
        &mut self,
        point: &Point,
        done: usize,
        remaining: usize,
    ) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        let _ = (point, done, remaining);
        Ok(())
    }

    /// A located value is being checked, and this was seen.
    ///
    /// # Errors
    /// As [`Observer::point`].
    fn checked(
        &mut self,
        check: &KeptCheck,
    ) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        let _ = check;
        Ok(())
    }

    /// What earlier checks of the same sweep saw: asked for once, when the first value is checked. It is taken for
    /// seen, not solved again.
    fn kept_checks(&mut self) -> Vec<KeptCheck> {
        Vec::new()
    }
}

/// An observer that does nothing.
impl Observer for () {}
