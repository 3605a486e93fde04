//! A shard: a contiguous part of a sweep, one of several that are solved by processes that know nothing of each other.

use std::fmt;
use std::ops::RangeInclusive;

/// One of several contiguous parts of a sweep, counted from 1.
///
/// Neighbouring shards share the value at their border, so that every two neighbouring values belong to one shard: what
/// lies between them is looked for there.
///
/// ```
/// use pbif::continuation::Shard;
///
/// let shards = [1, 2].map(|number| Shard::new(number, 2).unwrap());
/// assert_eq!(shards[0].places(5), Some(0..=2));
/// assert_eq!(shards[1].places(5), Some(2..=4));
/// assert_eq!(shards[1].to_string(), "2/2");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    number: usize,
    of: usize,
}

impl Shard {
    /// All of a sweep.
    pub(crate) const WHOLE: Self = Self { number: 1, of: 1 };

    /// Shard `number` of `of`; `None` unless 1 ≤ `number` ≤ `of`.
    pub fn new(number: usize, of: usize) -> Option<Self> {
        (1..=of).contains(&number).then_some(Self { number, of })
    }

    /// Its number, from 1.
    pub(crate) fn number(self) -> usize {
        self.number
    }

    /// How many shards there are.
    pub fn of(self) -> usize {
        self.of
    }

    /// The places of its values among `points` given values; `None` where there are more shards than steps between
    /// values.
    pub fn places(self, points: usize) -> Option<RangeInclusive<usize>> {
        let steps = points.checked_sub(1)?;
        let border = |number: usize| (number as u128 * steps as u128 / self.of as u128) as usize;
        (self.of <= steps).then(|| border(self.number - 1)..=border(self.number))
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}/{}", self.number, self.of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_cover_every_step_once_and_none_is_much_longer_than_another() {
        for points in 2..40 {
            for of in 1..points {
                let places = |number| Shard::new(number, of).unwrap().places(points).unwrap();
                let mut at = 0;
                for number in 1..=of {
                    let (first, last) = places(number).into_inner();
                    assert_eq!(first, at);
                    let steps = last - first;
                    assert!(steps >= (points - 1) / of && steps <= (points - 1).div_ceil(of));
                    at = last;
                }
                assert_eq!(at, points - 1);
            }
            assert_eq!(Shard::new(1, points).unwrap().places(points), None);
        }
        assert_eq!((Shard::new(0, 3), Shard::new(4, 3)), (None, None));
        assert_eq!(Shard::WHOLE.places(0), None);
    }
}
