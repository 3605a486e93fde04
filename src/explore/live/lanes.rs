//! Lanes of requests: a newer one makes the older ones stale.

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::cancellation::Cancellation;

/// Lanes that are remembered; a page has a few.
const MOST_LANES: usize = 256;
/// Length of a lane's name at most, in bytes.
const LONGEST_NAME: usize = 64;

/// The newest request of every lane.
#[derive(Debug, Default)]
pub(super) struct Lanes {
    newest: Mutex<BTreeMap<String, Newest>>,
}

#[derive(Debug)]
struct Newest {
    ticket: u64,
    /// What stops its solve, while it is being solved.
    running: Option<Cancellation>,
}

/// A request's place in its lane.
#[derive(Debug)]
pub(super) struct Slot<'l> {
    lanes: &'l Lanes,
    name: &'l str,
    ticket: u64,
}

impl Lanes {
    fn lock(&self) -> MutexGuard<'_, BTreeMap<String, Newest>> {
        self.newest.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes the place of the older requests of a lane and cancels what is being solved of them; `None` where there is
    /// a newer one.
    pub(super) fn enter<'l>(&'l self, name: &'l str, ticket: u64) -> Option<Slot<'l>> {
        if name.len() > LONGEST_NAME {
            return None;
        }
        let mut newest = self.lock();
        if newest.len() >= MOST_LANES && !newest.contains_key(name) {
            newest.retain(|_, one| one.running.is_some());
        }
        if let Some(before) = newest.get(name) {
            if before.ticket >= ticket {
                return None;
            }
            if let Some(running) = &before.running {
                running.cancel();
            }
        }
        let running = None;
        newest.insert(name.to_owned(), Newest { ticket, running });
        Some(Slot {
            lanes: self,
            name,
            ticket,
        })
    }

    pub(super) fn cancel_all(&self) {
        for running in self.lock().values().filter_map(|one| one.running.as_ref()) {
            running.cancel();
        }
    }
}

impl Slot<'_> {
    /// Says what stops the solve that begins; false where a newer request has come.
    pub(super) fn begin(&self, cancellation: &Cancellation) -> bool {
        self.set(Some(cancellation.clone()))
    }

    /// Says that the solve has ended.
    pub(super) fn end(&self) {
        self.set(None);
    }

    fn set(&self, running: Option<Cancellation>) -> bool {
        let mut newest = self.lanes.lock();
        match newest.get_mut(self.name) {
            Some(one) if one.ticket == self.ticket => {
                one.running = running;
                true
            }
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_newer_request_stops_the_older_ones_of_its_lane() {
        let lanes = Lanes::default();
        let (first, other) = (Cancellation::new(), Cancellation::new());
        let one = lanes.enter("a", 1).unwrap();
        let beside = lanes.enter("b", 1).unwrap();
        assert!(one.begin(&first) && beside.begin(&other));
        let two = lanes.enter("a", 2).unwrap();
        assert!(first.is_cancelled() && !other.is_cancelled());
        // The older one came late to its session, or ends late.
        assert!(!one.begin(&Cancellation::new()));
        one.end();
        assert!(two.begin(&Cancellation::new()));
        assert!(lanes.enter("a", 2).is_none() && lanes.enter("a", 1).is_none());
        lanes.cancel_all();
        assert!(other.is_cancelled());
    }

    #[test]
    fn lanes_that_nobody_uses_are_forgotten() {
        let lanes = Lanes::default();
        for number in 0..10_000 {
            lanes.enter(&number.to_string(), 1).unwrap();
        }
        assert!(lanes.lock().len() <= MOST_LANES);
        assert!(lanes.enter(&"x".repeat(65), 1).is_none());
    }
}
