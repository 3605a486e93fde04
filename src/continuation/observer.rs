//! What a sweep tells its caller while it runs.

use super::{CheckedIndicator, Point};

/// Receives every point as soon as it is done, and may stop the sweep with an error, or by cancelling
/// it ([`Cancellation`](crate::cancellation::Cancellation)). Points are solved side by side: they come in the order in
/// which they are done, from whatever thread, one at a time. All methods have defaults.
pub trait Observer: Send {
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

    /// A stretch of the sweep is swept again on finer cells, because the cells leave a change in doubt there.
    fn closer_look(&mut self, stretch: [f64; 2]) {
        let _ = stretch;
    }

    /// Points of the same sweep that are solved already, by its shards for example: asked for once, before the first
    /// value is solved. They are taken as they are and not solved again, and what they say was detected is not detected
    /// again.
    fn known_points(&mut self) -> Vec<Point> {
        Vec::new()
    }

    /// What earlier checks of the same sweep saw, those of its shards for example: asked for once, before the first
    /// value is checked. It is taken for seen, not solved again.
    fn known_checks(&mut self) -> Vec<CheckedIndicator> {
        Vec::new()
    }
}

/// An observer that does nothing.
impl Observer for () {}
