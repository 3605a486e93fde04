//! What solved points leave for later ones: the nearest is the best start.

/// Bytes that are kept; beyond, every second one is dropped.
const KEPT_BYTES: usize = 1 << 30;

/// Starts by the value at which they were solved, in the order in which they were.
#[derive(Debug)]
pub(super) struct Neighbours<T> {
    kept: Vec<(f64, T)>,
}

impl<T> Default for Neighbours<T> {
    fn default() -> Self {
        Self { kept: Vec::new() }
    }
}

impl<T> Neighbours<T> {
    /// The start nearest to a value. The last of equally near ones: it is the neighbour along a sweep.
    pub(super) fn nearest(&self, value: f64) -> Option<&T> {
        let distance = |start: &&(f64, T)| (start.0 - value).abs();
        let starts = self.kept.iter().rev();
        let nearest = starts.min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.map(|(_, start)| start)
    }

    /// All starts, in the order in which they were solved.
    pub(super) fn all(&self) -> impl Iterator<Item = &T> {
        self.kept.iter().map(|(_, start)| start)
    }

    /// The start that was kept last; it is there at any rate.
    pub(super) fn newest(&self) -> Option<&(f64, T)> {
        self.kept.last()
    }

    /// Keeps a start that takes about so many bytes, like all others.
    pub(super) fn keep(&mut self, value: f64, start: T, bytes: usize) {
        self.kept.push((value, start));
        if bytes.saturating_mul(self.kept.len()) > KEPT_BYTES {
            let last = self.kept.len() - 1;
            let mut index = 0;
            self.kept.retain(|_| {
                index += 1;
                index > last || index % 2 == 0
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_start_is_found_and_the_last_of_two_at_the_same_distance() {
        let mut starts = Neighbours::default();
        assert_eq!(starts.nearest(0.0), None);
        for value in [0.0, 1.0, 0.5] {
            starts.keep(value, value, 8);
        }
        assert_eq!(starts.nearest(0.9), Some(&1.0));
        assert_eq!(starts.nearest(0.75), Some(&0.5));
        assert_eq!(starts.nearest(0.25), Some(&0.5));
    }

    #[test]
    fn memory_is_bounded_and_the_newest_start_stays() {
        let mut starts = Neighbours::default();
        for index in 0..100 {
            starts.keep(f64::from(index), index, KEPT_BYTES / 8);
            assert!(starts.kept.len() <= 8);
            assert_eq!(starts.nearest(f64::from(index)), Some(&index));
        }
    }
}
