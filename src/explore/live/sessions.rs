//! Sessions that are kept warm: those that were used last.

use super::bound::Bound;
use crate::cancellation::Cancellation;
use crate::continuation::{DensitySource as _, Session, Solution, SourceError};

/// Sessions that are kept: the shown state, its preview, the sweep, and the parameter that moved before.
const MOST: usize = 4;

/// A session remembers what it has solved, about so many bytes a cell each time, and solves the next from the nearest;
/// before it has so much in all, it begins anew.
const REMEMBERED: usize = 16;
const MOST_REMEMBERED: usize = 64 << 20;
/// Solves of a session at least, however many cells it has: the first takes longer than all others.
const FEWEST_SOLVES: usize = 32;

/// Solves after which a session on so many cells begins anew.
fn solves_on(cells: usize) -> usize {
    (MOST_REMEMBERED / (REMEMBERED * cells.max(1))).max(FEWEST_SOLVES)
}

/// Open sessions, the one used last at the end.
#[derive(Default)]
pub(super) struct Sessions {
    open: Vec<Open>,
}

struct Open {
    key: Vec<u64>,
    session: Box<dyn Session>,
    cancellation: Cancellation,
    /// Solves before it begins anew.
    left: usize,
}

/// Why there is no solution.
#[derive(Debug)]
pub(super) enum Solving {
    /// A newer request has come.
    Stale,
    /// No session can be opened, for people.
    Open(String),
    /// The solve was given up.
    Source(SourceError),
}

impl Sessions {
    /// Solves in the session that knows these parameters, or in a new one. `begin` is told what cancels the solve and
    /// says whether it is still wanted.
    pub(super) fn solve(
        &mut self,
        bound: &Bound,
        begin: impl Fn(&Cancellation) -> bool,
    ) -> Result<Solution<'static>, Solving> {
        let known = self.open.iter().position(|open| open.key == bound.key);
        let known = known.map(|index| self.open.remove(index));
        // A session that was cancelled does not work any more.
        let usable = known.filter(|open| !open.cancellation.is_cancelled() && open.left > 0);
        let mut open = match usable {
            Some(open) if begin(&open.cancellation) => open,
            Some(open) => {
                self.open.push(open);
                return Err(Solving::Stale);
            }
            None => {
                let cancellation = Cancellation::new();
                if !begin(&cancellation) {
                    return Err(Solving::Stale);
                }
                // Factors are large: room is made before more are computed.
                let surplus = (self.open.len() + 1).saturating_sub(MOST);
                self.open.drain(..surplus);
                let source = bound.sweep.source(&cancellation);
                let source = source.map_err(|error| match error {
                    SourceError::Interrupted => Solving::Stale,
                    error => Solving::Open(error.to_string()),
                })?;
                Open {
                    key: bound.key.clone(),
                    session: source.open(&cancellation),
                    cancellation,
                    left: solves_on(bound.sweep.problem.space().n_cells()),
                }
            }
        };
        open.left -= 1;
        let solution = open.session.solve(bound.value).map(Solution::detached);
        if !open.cancellation.is_cancelled() {
            self.open.push(open);
        }
        solution.map_err(Solving::Source)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_sessions_remember_is_bounded() {
        for cells in [1, 400, 10_000, 1_000_000] {
            let solves = solves_on(cells);
            let bytes = solves * cells * REMEMBERED;
            assert!(
                bytes <= MOST_REMEMBERED || solves == FEWEST_SOLVES,
                "{cells}: {solves}"
            );
        }
        assert_eq!(solves_on(10_000), 419);
    }
}
