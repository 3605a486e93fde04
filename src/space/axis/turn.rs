//! Axes whose ends are one place: cells over one turn of an angle, and places that are told up to whole turns.

use super::Axis;
use crate::space::SpaceError;

impl Axis {
    /// Cells of equal width over one turn, of which the first follows the last: densities along an angle are laid out
    /// on them.
    ///
    /// # Errors
    /// [`SpaceError::Range`] or [`SpaceError::Count`].
    pub(crate) fn turn(from: f64, to: f64, count: usize) -> Result<Self, SpaceError> {
        Ok(Self {
            closes: true,
            ..Self::uniform(from, to, count)?
        })
    }

    /// The same place within the turn from the lower end, which belongs to it, to the upper one; on an axis that does
    /// not close on itself the place as it is.
    pub(crate) fn wrapped(&self, x: f64) -> f64 {
        if !self.is_closed() || (self.from()..self.to()).contains(&x) {
            return x;
        }
        let length = self.to() - self.from();
        let inside = self.from() + (x - self.from()).rem_euclid(length);
        // Rounding may make a whole turn of a small negative number.
        if inside < self.to() {
            inside
        } else {
            self.from()
        }
    }

    /// How far one place lies above another: on an axis that closes on itself the shorter way round.
    pub(crate) fn apart(&self, one: f64, other: f64) -> f64 {
        let apart = one - other;
        if !self.is_closed() {
            return apart;
        }
        let length = self.to() - self.from();
        apart - length * (apart / length).round()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_come_back_after_a_turn() {
        let turn = Axis::turn(-1.0, 1.0, 8).unwrap();
        for (x, inside) in [(0.25, 0.25), (1.0, -1.0), (-1.25, 0.75), (7.5, -0.5)] {
            assert_eq!(turn.wrapped(x), inside);
        }
        assert!(turn.wrapped(-1.0 - 1e-17) < 1.0);
        assert!((turn.apart(0.9, -0.9) + 0.2).abs() < 1e-15);
        let line = Axis::uniform(-1.0, 1.0, 8).unwrap();
        assert_eq!((line.wrapped(3.0), line.apart(0.9, -0.5)), (3.0, 1.4));
        assert!(turn.is_closed() && !line.is_closed() && !turn.is_modes());
        assert!(turn.refined(2.0).is_closed() && turn != line);
    }
}
