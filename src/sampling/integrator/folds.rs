//! Coordinates that are folded back: between walls that reflect, and into one turn of an axis that closes on itself.

use crate::system::{Lanes, System};

/// One turn of an axis that closes on itself.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WholeTurn {
    pub(crate) axis: usize,
    from: f64,
    pub(crate) length: f64,
}

impl WholeTurn {
    /// Those of a system.
    pub(crate) fn of(system: &dyn System) -> Vec<Self> {
        let turns = system.facts().turns.iter();
        let turn = |(&axis, &(from, to)): (&usize, &(f64, f64))| Self {
            axis,
            from,
            length: to - from,
        };
        turns.map(turn).collect()
    }

    /// Whole turns from the one that is looked at to the one in which a coordinate is.
    pub(crate) fn number(&self, x: f64) -> f64 {
        ((x - self.from) / self.length).floor()
    }

    pub(super) fn fold(&self, states: &mut [Lanes]) {
        for x in &mut states[self.axis] {
            *x -= self.length * self.number(*x);
        }
    }
}

/// Walls of an axis at which paths are reflected, infinite where there is none. A path between walls is the image of a
/// free path of the system that goes on beyond them as in a mirror: folded back, with the drift turned round.
pub(super) struct Mirror {
    pub(super) axis: usize,
    from: f64,
    to: f64,
}

pub(super) fn mirrors(system: &dyn System) -> Vec<Mirror> {
    let walls = system.facts().reflecting.iter();
    walls
        .map(|(&axis, &(from, to))| Mirror { axis, from, to })
        .collect()
}

impl Mirror {
    /// The image of a coordinate between the walls, and whether it is turned round.
    pub(super) fn image(&self, x: f64) -> (f64, bool) {
        // A step that passes both walls is of no use for anything; it ends at a wall.
        if x < self.from {
            ((2.0 * self.from - x).min(self.to), true)
        } else if x > self.to {
            ((2.0 * self.to - x).max(self.from), true)
        } else {
            (x, false)
        }
    }

    pub(super) fn fold(&self, states: &mut [Lanes]) {
        for x in &mut states[self.axis] {
            *x = self.image(*x).0;
        }
    }
}
